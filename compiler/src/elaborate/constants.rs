//! Numbers of constants at the top of the root module.

use super::value::{ScopeId, Value};
use super::{Elaborator, Eval};
use crate::typed::{Findings, TypedProgram};
use eng_grammar::ast::Expr;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::host::Host;

/// Evaluates expressions of constants, outside of every model.
pub(crate) struct Constants<'a, 'd> {
    elaborator: Elaborator<'a, 'd>,
    scope: ScopeId,
}

impl<'a, 'd> Constants<'a, 'd> {
    /// An evaluator for the root module; `None` for a program without modules.
    pub fn new(
        typed: &'a TypedProgram,
        sources: &'a mut SourceMap,
        host: &'a dyn Host,
        diagnostics: &'d mut Diagnostics,
    ) -> Option<Self> {
        let elaborator = Elaborator::new(typed, sources, host, diagnostics);
        let scope = *elaborator
            .module_scopes
            .get(typed.program.root() as usize)?;
        Some(Constants { elaborator, scope })
    }

    /// The number (SI) of an expression, or those of a list, given its findings. `None` after a reported
    /// error.
    pub fn numbers(&mut self, expr: &'a Expr, findings: Findings) -> Option<Vec<f64>> {
        self.elaborator.later.extend(findings);
        let found = self.known(expr).ok();
        self.elaborator.report_advised();
        found
    }

    fn known(&mut self, expr: &'a Expr) -> Eval<Vec<f64>> {
        let value = self.elaborator.evaluate(expr, self.scope)?;
        let values = match Elaborator::without_axes(value) {
            Value::List(values) => values,
            value => vec![value],
        };
        values
            .into_iter()
            .map(|value| {
                let scalar = self.elaborator.as_scalar(value, expr.span)?;
                self.elaborator.structural(scalar, expr.span)
            })
            .collect()
    }
}
