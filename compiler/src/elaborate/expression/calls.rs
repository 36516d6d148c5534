//! Calls of functions and tables, with the conditions of functions.

use super::super::partial::{Passed, all_arguments, joined};
use super::super::requirement::Part;
use super::super::scalar::{Flag, Scalar, Stage};
use super::super::slope::Differentiated;
use super::super::value::{BoundClass, ScopeId, TableValue, Value};
use super::super::{Elaborator, Entry, Eval, Lazy};
use crate::codes;
use crate::ir::Node;
use crate::typed::Callee;
use crate::typed::types::Solution;
use eng_grammar::ast::Expr;
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
        match self.callee_at(expr.span) {
            Some(Callee::BuiltIn(function)) => {
                return self.builtin(function, expr.span, arguments, scope);
            }
            Some(Callee::Modes(term)) => {
                return self.mode_set(term, expr.span, arguments, scope);
            }
            None => {}
        }
        let function = self.evaluate(callee, scope)?;
        match function {
            Value::Closure(_) | Value::Table(_) | Value::Partial(_) => {
                if self.typed.findings.bound.contains(&expr.span) {
                    return self.partial(function, arguments, expr.span, scope);
                }
                let places = self.call_at(expr.span)?;
                let mut passed = Vec::with_capacity(arguments.len());
                for (argument, place) in arguments.iter().zip(places.iter()) {
                    passed.push(Passed {
                        place: *place,
                        value: self.evaluate(&argument.value, scope)?,
                        span: argument.value.span,
                        scope,
                    });
                }
                self.apply(&function, passed, expr.span, scope)
            }
            Value::Definition(id)
                if self
                    .program
                    .declaration(id)
                    .is_some_and(|d| d.kind == ast::Kind::Record) =>
            {
                self.construct(id, expr.span, arguments, scope)
            }
            Value::Definition(_) | Value::Bound(_) => {
                let (class, given) = self.class_called(expr, scope)?;
                Ok(Value::Bound(Rc::new(BoundClass {
                    class: class.definition,
                    given,
                    named: None,
                })))
            }
            other => {
                let what = format!("{} is called", other.kind());
                self.checked(None, callee.span, &what)
            }
        }
    }

    /// Calls a function with the values of its arguments.
    pub fn apply(
        &mut self,
        function: &Value<'a>,
        passed: Vec<Passed<'a>>,
        call: Span,
        caller: ScopeId,
    ) -> Eval<Value<'a>> {
        match function {
            Value::Closure(closure) => {
                let here = self.solution_at(call, caller);
                let solution = joined(closure.solution.as_ref(), here);
                self.used_at(call, |e| e.applied(closure, solution, passed, call))
            }
            Value::Table(table) => self.look_up(*table, passed, call),
            Value::Partial(partial) => {
                let passed = all_arguments(partial, passed);
                match partial.order {
                    0 => self.apply(&partial.function, passed, call, caller),
                    order => {
                        let differentiated = Differentiated {
                            function: &partial.function,
                            call,
                            scope: caller,
                        };
                        let x = self.checked(passed.into_iter().next(), call, "no argument")?;
                        let x = self.as_scalar(x.value, x.span)?;
                        self.derivative(&differentiated, x, order)
                            .map(Value::Scalar)
                    }
                }
            }
            other => {
                let what = format!("{} is called", other.kind());
                self.checked(None, call, &what)
            }
        }
    }

    fn look_up(
        &mut self,
        table: TableValue,
        passed: Vec<Passed<'a>>,
        call: Span,
    ) -> Eval<Value<'a>> {
        let kinks = passed.iter().map(|a| (a.place as u8, a.span, a.scope));
        let kinks: Vec<_> = kinks.collect();
        let value = self.table_at(table, passed, call)?;
        for (place, of, scope) in kinks {
            self.note_kink(value.stage, value.node, place, of, call, scope)?;
        }
        Ok(Value::Scalar(value))
    }

    /// The value of a table at its arguments. No texts are noted for its kinks.
    pub fn table_at(
        &mut self,
        table: TableValue,
        passed: Vec<Passed<'a>>,
        call: Span,
    ) -> Eval<Scalar> {
        let mut given: Vec<Option<Scalar>> = vec![None; passed.len()];
        for argument in passed {
            let x = self.as_scalar(argument.value, argument.span)?;
            let place = given.get_mut(argument.place as usize);
            *self.checked(place, argument.span, "no such argument")? = Some(x);
        }
        let all: Option<Vec<Scalar>> = given.into_iter().collect();
        let all = self.checked(all, call, "an argument of a table is missing")?;
        Ok(self.graphs.table(table.handle, &all))
    }

    /// Calls a function of the text with values for the parameters at given places.
    pub fn applied(
        &mut self,
        closure: &super::super::value::Closure<'a>,
        solution: Option<Rc<Solution>>,
        passed: Vec<Passed<'a>>,
        call: Span,
    ) -> Eval<Value<'a>> {
        let function = closure.function;
        let module = self.scope(closure.scope).module;
        let inner = self.new_scope(Some(closure.scope), module, String::new());
        self.scopes[inner.0 as usize].solution = solution;
        for Passed { place, value, .. } in passed {
            let parameter = function.parameters.get(place as usize);
            let parameter = self.checked(parameter, call, "no such parameter")?;
            let value = self.declared(value, Some(&parameter.ty))?;
            self.define(inner, &parameter.name.text, Entry::Value(value));
        }
        for parameter in &function.parameters {
            let name = &parameter.name.text;
            if !self.scope(inner).entries.contains_key(name) {
                self.define(inner, name, Entry::Lazy(Lazy::Default(parameter)));
            }
        }
        for parameter in &function.parameters {
            self.count(&parameter.name.text, &parameter.ty, inner)?;
        }
        for parameter in &function.parameters {
            if matches!(parameter.ty.kind, ast::TypeExprKind::Array(..)) {
                let name = &parameter.name;
                let value = self.entry(inner, &name.text, name.span)?;
                let what = format!("`{}` of `{}`", name.text, function.name.text);
                self.of_stated_length(&value, &parameter.ty, inner, &what, call)?;
            }
        }
        for binding in &function.lets {
            self.define(
                inner,
                &binding.name.text,
                Entry::Lazy(Lazy::Binding(binding)),
            );
        }
        self.deeper(call, |e| {
            for requirement in &function.requirements {
                e.require_in_function(requirement, inner, call)?;
            }
            let value = function.value.as_ref();
            let value = e.checked(value, call, "a function without a value is called")?;
            let place = value.span;
            let value = e.evaluate(value, inner)?;
            let value = e.declared(value, function.result.as_ref())?;
            if let Some(ty) = &function.result {
                let what = format!("the value of `{}`", function.name.text);
                e.of_stated_length(&value, ty, inner, &what, place)?;
            }
            Ok(value)
        })
    }

    /// Evaluates an expression that counts only if a flag is true.
    pub(super) fn guarded<T>(
        &mut self,
        flag: Flag,
        f: impl FnOnce(&mut Self) -> Eval<T>,
    ) -> Eval<T> {
        self.context.guards.push((flag, self.scopes.len()));
        let result = f(self);
        self.context.guards.pop();
        result
    }

    /// Evaluates a `require` or `advise` of a function for one call. A condition of parameters alone is
    /// checked when they are set. Its element watches any other condition.
    pub(super) fn require_in_function(
        &mut self,
        requirement: &'a ast::Requirement,
        scope: ScopeId,
        call: Span,
    ) -> Eval<()> {
        // a function that is differentiated has been asked at the argument itself
        if self.context.unknowns > 0 {
            return Ok(());
        }
        let path = self.graphs.bind.owner.clone();
        let name = requirement.name.as_ref();
        let found = self.requirement(
            super::super::requirement::Requirement {
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
        let condition = super::super::scalar::CallCondition {
            advise: requirement.advise,
            name: name.map_or(String::new(), |name| name.text.clone()),
            flag,
            message,
            span: requirement.condition.span,
        };
        self.watched(condition, call)
    }

    /// Adds a condition of a call to the element, which watches it at every step.
    pub(in crate::elaborate) fn watched(
        &mut self,
        condition: super::super::scalar::CallCondition,
        call: Span,
    ) -> Eval<()> {
        let values = condition
            .message
            .parts
            .iter()
            .filter_map(|part| match part {
                Part::Value { value, .. } => Some((value.stage, value.node)),
                Part::Text(_) => None,
            });
        let seen: Vec<Node> = std::iter::once((condition.flag.stage, condition.flag.node))
            .chain(values)
            .filter(|(stage, _)| *stage == Stage::Motion)
            .map(|(_, node)| node)
            .collect();
        if let Some(element) = self.graphs.element.as_mut() {
            if crate::ir::differentiate::known_in_outputs_only(
                &element.graph,
                &seen,
                &super::super::scalar::PROVISIONAL,
            ) {
                return Err(self.report(
                    Diagnostic::error(
                        codes::LATE_ACCELERATION,
                        "the `require` of this function reads a value that can be used in outputs only",
                    )
                    .at(call, "its condition reads an acceleration, a reaction or an output of another element")
                    .also(condition.span, "its condition is watched at every step")
                    .with_help("use a function without `require`; if the value is an output of another element, call this function in the class of that element"),
                ));
            }
            element.call_conditions.push(condition);
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
                    "only parameters are allowed here, and this value changes with the motion",
                )
                .at(span, "depends on positions, velocities or time")
                .with_help("the equations of a class and outputs may read the motion"),
            )),
        }
    }
}
