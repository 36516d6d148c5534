//! Functions with some of their arguments: `wiebe(shape: 2)` where a function is due, and `fn burn = wiebe(shape: 2)`.

use super::Checker;
use super::call::slots_of_function;
use super::scope::Scope;
use super::types::{FunctionParameter, Signature, Solution, Type};
use crate::codes;
use eng_grammar::ast::{Argument, Expr, ExprKind, Function};
use eng_grammar::{Diagnostic, Span};
use std::sync::Arc;

impl<'p> Checker<'p> {
    /// The type of an expression where a function is due.
    pub(super) fn infer_function(&mut self, scope: &Scope<'p>, expr: &Expr) -> Type {
        let outer = std::mem::replace(&mut self.function_due, true);
        let found = self.infer_due(scope, expr, None);
        self.function_due = outer;
        found
    }

    /// The type of a call of a function where a function is due: the function of the arguments that the call does
    /// not give. A call with all arguments has the value of the function.
    pub(super) fn function_of_call(
        &mut self,
        scope: &Scope<'p>,
        span: Span,
        signature: &Signature,
        arguments: &[Argument],
    ) -> Type {
        let mut slots = slots_of_function(signature);
        let named = |name: &str| {
            let mut names = arguments.iter().filter_map(|a| a.name.as_ref());
            names.any(|given| given.text == name)
        };
        let by_place = arguments.iter().filter(|a| a.name.is_none()).count();
        let lacks = slots
            .iter()
            .enumerate()
            .any(|(at, slot)| !slot.optional && at >= by_place && !named(&slot.name));
        // a function that gives a function is called
        let gives_function = matches!(signature.result, Type::Function(_) | Type::Error);
        if !lacks || gives_function || arguments.is_empty() {
            let ty = self.call_of_function(scope, span, signature, arguments);
            return if lacks { Type::Error } else { ty };
        }
        if let Some(argument) = arguments.iter().find(|argument| argument.name.is_none()) {
            let message = Diagnostic::error(
                codes::MISSING_ARGUMENT,
                format!(
                    "some arguments of `{}` are given without their names",
                    signature.name
                ),
            )
            .at(argument.value.span, "for which parameter?");
            let names = signature.parameters.iter().map(|p| p.name.as_str());
            let names = crate::resolve::suggest::listing(names, 12);
            self.report(message.with_note(format!("it takes {names}")).with_help(
                "a function with some of its arguments states their names: `wiebe(shape: 2)`",
            ));
            return Type::Error;
        }
        for slot in &mut slots {
            slot.optional = true;
        }
        let mut solution = Solution::default();
        let name = &signature.name;
        if !self.arguments(scope, name, &slots, arguments, span, &mut solution) {
            return Type::Error;
        }
        let given = self.findings.calls.get(&span).cloned();
        let free = |at: usize| given.iter().all(|places| !places.contains(&(at as u32)));
        let parameters = signature.parameters.iter().enumerate();
        let rest: Vec<FunctionParameter> = parameters
            .filter(|(at, _)| free(*at))
            .map(|(_, parameter)| FunctionParameter {
                ty: parameter.ty.with(&solution),
                ..parameter.clone()
            })
            .collect();
        let result = signature.result.with(&solution);
        self.solved(span, solution);
        self.findings.bound.insert(span);
        Type::Function(Arc::new(Signature {
            name: signature.name.clone(),
            parameters: rest,
            result,
        }))
    }

    /// The signature of a definition `fn burn = wiebe(shape: 2)`.
    pub(super) fn bound_function(
        &mut self,
        scope: &Scope<'p>,
        function: &'p Function,
    ) -> Signature {
        let name = &function.name;
        // without a name, so that its calls report nothing more
        let none = Signature {
            name: String::new(),
            parameters: Vec::new(),
            result: Type::Error,
        };
        let Some(value) = &function.value else {
            return none;
        };
        let found = self.infer_function(scope, value);
        let wrong = match (&value.kind, found) {
            (_, Type::Error) => return none,
            (ExprKind::Call { .. }, Type::Function(signature)) => {
                return Signature {
                    name: name.text.clone(),
                    ..Signature::clone(&signature)
                };
            }
            (_, Type::Function(_)) => (
                "is defined without arguments",
                "this is a function by its name".to_owned(),
            ),
            (_, other) => (
                "has no parameters",
                format!("this is {}, not a function", self.describe(&other)),
            ),
        };
        let (title, label) = wrong;
        self.report(
            Diagnostic::error(codes::MISSING_ARGUMENT, format!("`{}` {title}", name.text))
                .at(value.span, label)
                .with_help(format!(
                    "write `fn {0}(x: …) = …`, or a function with some of its arguments: `fn {0} = wiebe(shape: 2)`",
                    name.text
                )),
        );
        none
    }
}
