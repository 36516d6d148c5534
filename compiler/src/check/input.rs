//! Checks inputs: their types, the word of their interpolation, and functions of time as their arguments.

use super::Checker;
use super::mismatch::Due;
use super::types::{FunctionParameter, Quantity, Signature, Type};
use crate::codes;
use crate::resolve::suggest::nearest;
use eng_grammar::Diagnostic;
use eng_grammar::ast::{Binding, BindingKind, Expr};
use eng_system::Dimension;
use eng_system::input::Interpolation;

/// The word that declares a number that may change.
pub(super) fn word(binding: &Binding) -> &'static str {
    match binding.kind {
        BindingKind::Input => "input",
        _ => "param",
    }
}

impl<'p> Checker<'p> {
    /// Checks the type and the interpolation of an input.
    pub(super) fn input(&mut self, binding: &Binding, ty: &Type) {
        let number = |ty: &Type| matches!(ty, Type::Scalar(_) | Type::Error);
        let numbers = match ty {
            Type::List { element, .. } => number(element),
            ty => number(ty),
        };
        if !numbers {
            let found = self.describe(ty);
            let name = &binding.name;
            let message = Diagnostic::error(
                codes::INPUT,
                format!("the input `{}` is no number", name.text),
            )
            .at(name.span, format!("this is {found}"));
            self.report(match ty {
                Type::Int => message.with_help(format!(
                    "a number that may change has a type with a dimension: `input {}: 1 = …`",
                    name.text
                )),
                Type::Vector { .. } => message.with_help(
                    "give each component an input, and make the vector of them where it is used",
                ),
                _ => message.with_help(
                    "a program sets numbers, or lists of numbers; use a `const` for the structure",
                ),
            });
        }
        let Some(word) = &binding.interpolation else {
            return;
        };
        if Interpolation::named(&word.text).is_some() {
            return;
        }
        let known = || Interpolation::NAMED.iter().map(|(word, _)| *word);
        let message = Diagnostic::error(
            codes::INPUT,
            format!("there is no interpolation `{}` of an input", word.text),
        )
        .at(word.span, "`hold`, `linear` or `cubic`");
        self.report(match nearest(&word.text, known()) {
            Some(near) => message.meant(word.span, near),
            None => message.with_help(
                "`hold` keeps the last value, `linear` and `cubic` also take the value of the next point",
            ),
        });
    }

    /// Checks a function or table that gives the values of an input over time. Returns whether it fits.
    pub(super) fn over_time(
        &mut self,
        value: &Expr,
        given: &Signature,
        ty: &Type,
        due: &Due,
    ) -> bool {
        let wanted = Signature {
            name: String::new(),
            parameters: vec![FunctionParameter {
                name: String::new(),
                ty: Type::Scalar(Quantity::hard(Dimension::TIME)),
                optional: false,
                span: value.span,
            }],
            result: ty.clone(),
        };
        !self.function_for(value, &wanted, given, due).is_error()
    }
}
