//! Lints of literals, and the rule that a definition uses each lint name once.

use super::Checker;
use super::scope::Scope;
use crate::codes;
use eng_grammar::ast::{
    BindingKind, Block, Form, Function, Item, ItemKind, Kind, Name, Statement, UnitExpr,
};
use eng_grammar::{Diagnostic, Span};

/// Angle (rad, about three turns) above which a literal was probably meant in degrees. A choice: angles of a
/// text in radians are those of a turn or two.
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
                }) => self.name_once(&mut here, name),
                ItemKind::Function(function) => self.lints_of_function(function),
                ItemKind::Declaration(declaration) => {
                    if let Some(block) = declaration.block() {
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
                self.name_once(&mut here, name);
            }
        }
    }

    /// Whether a block accepts a lint. Notes the acceptance as one with effect.
    fn accepts(&mut self, block: &Block, lint: &str) -> bool {
        let names = block.items.iter().filter_map(|item| match &item.kind {
            ItemKind::Statement(Statement::Accept(names)) => Some(names),
            _ => None,
        });
        let accepting = names.flatten().find(|name| name.text == lint);
        self.findings
            .accepted
            .extend(accepting.map(|name| name.span));
        accepting.is_some()
    }

    /// Warns of values that have the name of a unit, at their declarations. After a number, such a name is the unit.
    /// The library is left out, because a user may define a unit with the name of one of its values.
    pub(super) fn values_named_like_units(&mut self) {
        for module in &self.program.modules {
            if !module.path.starts_with("std.") {
                for item in &module.file.items {
                    self.named_like_units(item, None);
                }
            }
        }
    }

    /// `around`: the block of the model or component around the item, which may accept the lint.
    fn named_like_units(&mut self, item: &'p Item, around: Option<&'p Block>) {
        match &item.kind {
            // an output is a channel first of all
            ItemKind::Binding(binding) if binding.kind != BindingKind::Output => {
                self.named_like_unit(&binding.name, around);
            }
            ItemKind::Function(function) => {
                let parameters = function.parameters.iter().map(|p| &p.name);
                for name in parameters.chain(function.lets.iter().map(|l| &l.name)) {
                    self.named_like_unit(name, around);
                }
            }
            ItemKind::Declaration(declaration) => {
                let Some(block) = declaration.block() else {
                    return;
                };
                let around = match declaration.kind {
                    Kind::Model | Kind::Component => Some(block),
                    _ => around,
                };
                if let Form::Class { parameters, .. } = &declaration.form {
                    for parameter in parameters {
                        self.named_like_unit(&parameter.name, around);
                    }
                }
                for inner in &block.items {
                    self.named_like_units(inner, around);
                }
            }
            _ => {}
        }
    }

    fn named_like_unit(&mut self, name: &Name, around: Option<&Block>) {
        if !self.program.units.contains_key(&name.text)
            || around.is_some_and(|block| self.accepts(block, eng_system::lint::UNIT_NAME))
        {
            return;
        }
        let text = &name.text;
        let message = Diagnostic::warning(codes::UNIT_NAME, format!("`{text}` is also a unit"))
            .at(name.span, "a value with the name of a unit")
            .with_note(format!(
                "after a number it is the unit: `2 N*{text}` does not read this value"
            ))
            .with_help(format!(
                "give it a longer name, or write spaces: `2 N * {text}`"
            ));
        self.report(match around {
            Some(_) => message.with_note(format!(
                "if you intend it: `accept {}` in this model or component",
                eng_system::lint::UNIT_NAME
            )),
            None => message,
        });
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
        if !plain || value.abs() <= MANY_TURNS || !self.turns_reported.insert(span) {
            return;
        }
        let around = scope.definition.and_then(|id| self.declaration(id));
        if around
            .and_then(eng_grammar::ast::Declaration::block)
            .is_some_and(|block| self.accepts(block, eng_system::lint::TURNS))
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
