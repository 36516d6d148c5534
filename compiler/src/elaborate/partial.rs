//! Functions with some of their arguments.

use super::binding::Stated;
use super::element::is_structural;
use super::value::{GivenValue, Partial, ScopeId, Value};
use super::{Elaborator, Eval};
use crate::typed::types::Solution;
use eng_grammar::{Span, ast};
use std::rc::Rc;

/// An argument of a call of a function.
pub(crate) struct Passed<'a> {
    /// Its parameter, by the place in the called function.
    pub place: u32,
    pub value: Value<'a>,
    pub span: Span,
    pub scope: ScopeId,
}

/// The arguments that a function has already, and those of its call, with their places in the inner function.
pub(super) fn all_arguments<'a>(partial: &Partial<'a>, passed: Vec<Passed<'a>>) -> Vec<Passed<'a>> {
    let given = partial.given.iter().map(|given| Passed {
        place: given.place,
        value: given.value.clone(),
        span: given.expr.span,
        scope: given.scope,
    });
    let mut all: Vec<Passed<'a>> = given.collect();
    all.extend(passed.into_iter().map(|argument| Passed {
        place: free_place(partial, argument.place),
        ..argument
    }));
    all
}

/// For a place among the parameters that have no argument yet: the place of this parameter in the inner function.
fn free_place(partial: &Partial<'_>, place: u32) -> u32 {
    let taken = |at: &u32| partial.given.iter().all(|given| given.place != *at);
    // each given argument moves the place by one at most
    let all = 0..=place + partial.given.len() as u32;
    all.filter(taken).nth(place as usize).unwrap_or(place)
}

/// The dimensions that a function has brought with it, and those found at its use.
pub(super) fn joined(
    brought: Option<&Rc<Solution>>,
    here: Option<Rc<Solution>>,
) -> Option<Rc<Solution>> {
    match (brought, here) {
        (Some(brought), Some(here)) => Some(Rc::new(Solution::clone(brought).and(&here))),
        (Some(brought), None) => Some(Rc::clone(brought)),
        (None, here) => here,
    }
}

impl<'a> Elaborator<'a, '_> {
    /// `wiebe(shape: 2)` where a function is due.
    pub(super) fn partial(
        &mut self,
        function: Value<'a>,
        arguments: &'a [ast::Argument],
        call: Span,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let function = self.with_solution(function, call, scope);
        let places = self.call_at(call)?;
        let (function, before) = match function {
            Value::Partial(partial) if partial.order == 0 => {
                (partial.function.clone(), partial.given.clone())
            }
            other => (other, Vec::new()),
        };
        let taken = Partial {
            function,
            order: 0,
            given: before,
        };
        let mut given = taken.given.clone();
        for (argument, place) in arguments.iter().zip(places.iter()) {
            let place = free_place(&taken, *place);
            let name = argument.name.as_ref().map(|name| name.text.clone());
            let structural = match &taken.function {
                Value::Closure(closure) => {
                    let parameter = closure.function.parameters.get(place as usize);
                    let parameter = self.checked(parameter, call, "no such parameter")?;
                    is_structural(&self.type_at(parameter.ty.span)?)
                }
                _ => false,
            };
            given.push(GivenValue {
                place,
                name: name.unwrap_or_default(),
                value: self.evaluate(&argument.value, scope)?,
                expr: &argument.value,
                scope,
                structural,
            });
        }
        Ok(Value::Partial(Rc::new(Partial { given, ..taken })))
    }

    /// A function with the dimensions of its variables that are found where it is passed on.
    pub(super) fn with_solution(
        &mut self,
        function: Value<'a>,
        place: Span,
        scope: ScopeId,
    ) -> Value<'a> {
        match function {
            Value::Closure(mut closure) => {
                let here = self.solution_at(place, scope);
                closure.solution = joined(closure.solution.as_ref(), here);
                Value::Closure(closure)
            }
            Value::Partial(partial) => {
                if self.solution_at(place, scope).is_none() {
                    return Value::Partial(partial);
                }
                let mut partial = Partial::clone(&partial);
                partial.function = self.with_solution(partial.function, place, scope);
                Value::Partial(Rc::new(partial))
            }
            other => other,
        }
    }

    /// A table or function as an argument of a class. Its numbers become parameters of the instance.
    pub(super) fn function_argument(&mut self, value: Value<'a>, path: &str) -> Eval<Value<'a>> {
        match value {
            Value::Table(mut table) => {
                // the handle is no constant of the code, so that instances with other tables share the code
                if let Some(known) = self.graphs.bind.graph.as_constant(table.handle) {
                    table.handle = self.graphs.bind.fixed(known);
                }
                Ok(Value::Table(table))
            }
            Value::Partial(partial) => {
                let mut partial = Partial::clone(&partial);
                partial.function = self.function_argument(partial.function, path)?;
                for given in &mut partial.given {
                    let path = format!("{path}.{}", given.name);
                    let value = given.value.clone();
                    given.value = match value {
                        value @ (Value::Table(_) | Value::Partial(_)) => {
                            self.function_argument(value, &path)?
                        }
                        value if given.structural => value,
                        value => {
                            let (span, scope) = (given.expr.span, given.scope);
                            let stated = Stated {
                                expr: given.expr,
                                dimension: self.dimension_at(span, scope)?,
                                limits: None,
                                span,
                                scope,
                            };
                            self.parameterise(value, &path, stated)?
                        }
                    };
                }
                Ok(Value::Partial(Rc::new(partial)))
            }
            other => Ok(other),
        }
    }
}
