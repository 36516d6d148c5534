//! Names of inputs, channels and parameters in the arguments of an analysis. Elaboration checks whether they exist.

use super::Checker;
use super::scope::Scope;
use super::types::Type;
use crate::codes;
use eng_grammar::Diagnostic;
use eng_grammar::ast::{Expr, ExprKind, IndexArgument};

impl<'p> Checker<'p> {
    /// A list of names, or one name.
    pub(super) fn channel_names(&mut self, scope: &Scope<'p>, argument: &str, value: &Expr) {
        let items = match &value.kind {
            ExprKind::Error => return,
            ExprKind::List { items, unit: None } => items.as_slice(),
            _ => std::slice::from_ref(value),
        };
        if items.is_empty() {
            self.report(
                Diagnostic::error(codes::ANALYSIS, format!("`{argument}` is empty"))
                    .at(value.span, "no name")
                    .with_help(EXAMPLE),
            );
        }
        for item in items {
            if !self.is_channel_name(scope, item) {
                self.report(
                    Diagnostic::error(
                        codes::ANALYSIS,
                        format!("`{argument}` is a list of names of the model"),
                    )
                    .at(item.span, "this is no name")
                    .with_help(EXAMPLE),
                );
            }
        }
    }

    /// Whether an expression has the form of a name: `speed`, `main[1..5].force.x`, `gas[*]`.
    fn is_channel_name(&mut self, scope: &Scope<'p>, expr: &Expr) -> bool {
        match &expr.kind {
            ExprKind::Name(_) => true,
            ExprKind::Field { base, .. } => self.is_channel_name(scope, base),
            ExprKind::Index { base, indices } => {
                let all = |index: &IndexArgument| matches!(index, IndexArgument::All(_));
                let mut fits = indices.len() == 1 || !indices.iter().any(all);
                for index in indices {
                    if let IndexArgument::At(at) = index {
                        fits &= match self.infer(scope, at) {
                            Type::Int | Type::Error => true,
                            Type::List { element, .. } | Type::Range(element) => {
                                *element == Type::Int
                            }
                            _ => false,
                        };
                    }
                }
                fits && self.is_channel_name(scope, base)
            }
            _ => false,
        }
    }
}

const EXAMPLE: &str = "names are such as `brake` or `[speed, main[1..5].force]`";
