//! Lints of literals, and the rule that a definition uses each lint name once.

use super::Checker;
use super::scope::{Scope, block_of};
use crate::codes;
use eng_grammar::ast::{Function, Item, ItemKind, Name, Statement, UnitExpr};
use eng_grammar::{Diagnostic, Span};

/// Angle (rad, about three turns) above which a literal was probably meant in degrees.
const MANY_TURNS: f64 = 20.0;

impl<'p> Checker<'p> {
    /// Reports a name that two `advise`s of one definition or function share.
    pub(super) fn names_of_lints(&mut self) {
        for module in &self.program.modules {
            self.lints_of(&module.file.items);
        }
    }

    fn lints_of(&mut self, items: &'p [Item]) {
        let mut here: Vec<&'p Name> = Vec::new();
        for item in items {
            match &item.kind {
                ItemKind::Statement(Statement::Require {
                    name: Some(name), ..
                }) => self.lint_named(name, &mut here),
                ItemKind::Function(function) => self.lints_of_function(function),
                ItemKind::Declaration(declaration) => {
                    if let Some(block) = block_of(declaration) {
                        self.lints_of(&block.items);
                    }
                }
                _ => {}
            }
        }
    }

    fn lints_of_function(&mut self, function: &'p Function) {
        let mut here = Vec::new();
        for requirement in &function.requirements {
            if let Some(name) = &requirement.name {
                self.lint_named(name, &mut here);
            }
        }
    }

    fn lint_named(&mut self, name: &'p Name, here: &mut Vec<&'p Name>) {
        if let Some(first) = here.iter().find(|known| known.text == name.text) {
            let first = first.span;
            self.defined_twice(&name.text, name.span, first);
        }
        here.push(name);
    }

    /// Warns of an angle of many turns, such as `180 rad`, unless the surrounding definition accepts it.
    pub(super) fn many_turns(
        &mut self,
        scope: &Scope<'p>,
        value: f64,
        unit: &UnitExpr,
        span: Span,
    ) {
        let [factor] = unit.factors.as_slice() else {
            return;
        };
        let plain = factor.name.text == "rad" && factor.numerator == 1 && factor.denominator == 1;
        if !plain || value.abs() <= MANY_TURNS || !self.turns_told.insert(span) {
            return;
        }
        let accepts = |item: &Item| {
            matches!(&item.kind, ItemKind::Statement(Statement::Accept(names))
            if names.iter().any(|name| name.text == eng_system::lint::TURNS))
        };
        let around = scope.definition.and_then(|id| self.declaration(id));
        if around
            .and_then(block_of)
            .is_some_and(|block| block.items.iter().any(accepts))
        {
            return;
        }
        let turns = value.abs() / std::f64::consts::TAU;
        self.report(
            Diagnostic::warning(
                codes::MANY_TURNS,
                format!("{value} rad are {turns:.1} turns: are degrees meant?"),
            )
            .at(span, "an angle of many turns")
            .with_help("write `deg`, or `rev` where turns are meant")
            .acceptable(eng_system::lint::TURNS),
        );
    }
}
