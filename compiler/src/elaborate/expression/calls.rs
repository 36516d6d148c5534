//! Calls of functions and tables, with what functions require.

use super::super::binding::Part;
use super::super::scalar::{Flag, Scalar, Stage};
use super::super::value::{ScopeId, TableValue, Value};
use super::super::{Elaborator, Entry, Eval, Lazy};
use crate::codes;
use crate::ir::Node;
use eng_grammar::ast::{Expr, ExprKind};
use eng_grammar::{Diagnostic, Span, ast};
use std::rc::Rc;

impl<'a> Elaborator<'a, '_> {
    pub(super) fn call(
        &mut self,
        expr: &'a Expr,
        callee: &'a Expr,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let function = match &callee.kind {
            ExprKind::Name(name) => match self.try_lookup(name, scope, callee.span)? {
                Some(value) => value,
                None => match super::super::builtin::find(name) {
                    Some(builtin) => Value::Builtin(builtin),
                    None => match crate::words::word(crate::words::Place::Modes, name) {
                        Some(term) => return self.mode_set(term, expr.span, arguments, scope),
                        None => return self.lookup(name, scope, callee.span),
                    },
                },
            },
            _ => self.evaluate(callee, scope)?,
        };
        match function {
            Value::Builtin(name) => self.builtin(name, expr.span, arguments, scope),
            Value::Closure(closure) => {
                let mut values = Vec::with_capacity(arguments.len());
                for argument in arguments {
                    let value = self.evaluate(&argument.value, scope)?;
                    values.push((argument.name.as_ref(), value));
                }
                self.apply(&closure, values, expr.span, scope)
            }
            Value::Table(table) => {
                let Some(first) = arguments.first() else {
                    return Err(self.internal(expr.span, "a table without its argument"));
                };
                let value = self.evaluate(&first.value, scope)?;
                let x = self.as_scalar(value, first.value.span)?;
                Ok(Value::Scalar(self.look_up_table(table, x)))
            }
            Value::Definition(id) => self.construct(id, expr.span, arguments, scope),
            other => Err(self.unfit(callee.span, "a function", &other)),
        }
    }

    pub fn look_up_table(&mut self, table: TableValue, x: Scalar) -> Scalar {
        self.bench.table(table.handle, x)
    }

    /// Calls a function of the text.
    pub fn apply(
        &mut self,
        closure: &super::super::value::Closure<'a>,
        values: Vec<(Option<&'a ast::Name>, Value<'a>)>,
        span: Span,
        caller: ScopeId,
    ) -> Eval<Value<'a>> {
        let solution = match &closure.solution {
            Some(handed_on) => Some(Rc::clone(handed_on)),
            None => self.solution_at(span, caller),
        };
        let function = closure.function;
        let module = self.scope(closure.scope).module;
        let inner = self.new_scope(Some(closure.scope), module, String::new());
        self.scopes[inner.0 as usize].solution = solution;
        let mut position = 0;
        for (name, value) in values {
            let parameter = match name {
                Some(name) => name.text.clone(),
                None => {
                    position += 1;
                    match function.parameters.get(position - 1) {
                        Some(p) => p.name.text.clone(),
                        None => {
                            return Err(self.internal(span, "too many arguments"));
                        }
                    }
                }
            };
            let ty = function
                .parameters
                .iter()
                .find(|p| p.name.text == parameter);
            let value = self.declared(value, ty.map(|p| &p.ty))?;
            self.define(inner, &parameter, Entry::Value(value));
        }
        for parameter in &function.parameters {
            if !self.scope(inner).entries.contains_key(&parameter.name.text) {
                if parameter.default.is_none() {
                    return Err(self.internal(
                        span,
                        &format!("argument `{}` is missing", parameter.name.text),
                    ));
                }
                self.define(
                    inner,
                    &parameter.name.text,
                    Entry::Lazy(Lazy::Default(parameter)),
                );
            }
        }
        for binding in &function.lets {
            self.define(
                inner,
                &binding.name.text,
                Entry::Lazy(Lazy::Binding(binding)),
            );
        }
        self.deeper(span, |e| {
            for requirement in &function.requirements {
                e.require_in_function(requirement, inner, span)?;
            }
            let value = e.evaluate(&function.value, inner)?;
            e.declared(value, function.result.as_ref())
        })
    }

    /// Evaluates what counts only where a flag is true.
    pub(super) fn guarded<T>(
        &mut self,
        flag: Flag,
        f: impl FnOnce(&mut Self) -> Eval<T>,
    ) -> Eval<T> {
        self.guards.push((flag, self.scopes.len()));
        let result = f(self);
        self.guards.pop();
        result
    }

    /// A `require` or `advise` of a function for one call: of parameters alone it is checked when they are set, else its element
    /// watches it.
    pub(super) fn require_in_function(
        &mut self,
        requirement: &'a ast::Requirement,
        scope: ScopeId,
        call: Span,
    ) -> Eval<()> {
        let path = self.bench.bind.owner.clone();
        let name = requirement.name.as_ref();
        let found = self.requirement(
            super::super::binding::Asked {
                advise: requirement.advise,
                name,
                condition: &requirement.condition,
                message: &requirement.message,
            },
            scope,
            &path,
            Some(super::super::location(call)),
        )?;
        let Some((flag, message)) = found else {
            return Ok(());
        };
        let values = message.parts.iter().filter_map(|part| match part {
            Part::Value { value, .. } => Some((value.stage, value.node)),
            Part::Text(_) => None,
        });
        let seen: Vec<Node> = std::iter::once((flag.stage, flag.node))
            .chain(values)
            .filter(|(stage, _)| *stage == Stage::Motion)
            .map(|(_, node)| node)
            .collect();
        if let Some(element) = self.bench.element.as_mut() {
            if crate::ir::differentiate::known_in_outputs_only(
                &element.graph,
                &seen,
                &super::super::scalar::PROVISIONAL,
            ) {
                return Err(self.report(
                    Diagnostic::error(
                        codes::LATE_ACCELERATION,
                        "a function that asks for a condition is given what is known in outputs only",
                    )
                    .at(call, "an acceleration, a reaction or an output of another element stands in its condition")
                    .also(requirement.condition.span, "its condition is watched at every step")
                    .with_help("call it in the class that knows the value, or a function without `require`"),
                ));
            }
            element.asked.push(super::super::scalar::Asked {
                advise: requirement.advise,
                name: name.map_or(String::new(), |name| name.text.clone()),
                flag,
                message,
                span: requirement.condition.span,
            });
        }
        Ok(())
    }

    /// The bind node of a number of parameters alone.
    pub fn bind_node(&mut self, value: Scalar, span: Span) -> Eval<crate::ir::Node> {
        match value.stage {
            Stage::Bind => Ok(value.node),
            Stage::Motion => Err(self.report(
                Diagnostic::error(
                    codes::MOTION,
                    "a value of the motion stands where only parameters can",
                )
                .at(span, "depends on positions, velocities or time")
                .with_help("what moves is known in classes and outputs"),
            )),
        }
    }
}
