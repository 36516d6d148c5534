//! States of classes: their rates and their scales.

use super::Checker;
use super::class::placing;
use super::member::Member;
use super::mismatch::Due;
use super::scope::Scope;
use super::types::Type;
use crate::codes;
use crate::program::DefinitionId;
use crate::resolve::suggest::nearest;
use crate::typed::lineage::levels;
use eng_grammar::ast::{
    Binding, BindingKind, Declaration, Expr, ExprKind, ItemKind, Kind, Name, Statement, UnaryOp,
};
use eng_grammar::{Diagnostic, Span};

impl<'p> Checker<'p> {
    /// Checks that every state has a rate and every rate a state. A class may give the rate of a state of its
    /// interface.
    pub(super) fn states_and_rates(&mut self, id: DefinitionId, declaration: &'p Declaration) {
        let texts = levels(self.program, id);
        let items = || texts.iter().flat_map(|level| &level.block.items);
        let mut rates: Vec<&'p Name> = Vec::new();
        for item in items() {
            let ItemKind::Statement(Statement::Rate { state, .. }) = &item.kind else {
                continue;
            };
            if let Some(first) = rates.iter().find(|rate| rate.text == state.text) {
                let first = first.span;
                self.defined_twice(&format!("der({})", state.text), state.span, first);
            }
            rates.push(state);
            let is_state = matches!(
                self.member(id, &state.text),
                Some(Member::Binding(binding)) if binding.kind == BindingKind::State
            );
            let known = !self.lacks_interface(Some(id));
            if known && !is_state && placing(declaration.kind, &item.kind).is_none() {
                let states: Vec<&str> = items()
                    .filter_map(|item| match &item.kind {
                        ItemKind::Binding(b) if b.kind == BindingKind::State => {
                            Some(b.name.text.as_str())
                        }
                        _ => None,
                    })
                    .collect();
                let mut message =
                    Diagnostic::error(codes::STATE, format!("there is no state `{}`", state.text))
                        .at(state.span, "a rate of what?");
                if let Some(near) = nearest(&state.text, states) {
                    message = message.meant(state.span, near);
                } else {
                    message = message.with_help(format!(
                        "for instance `state {}: Pressure = 1 bar`",
                        state.text
                    ));
                }
                self.report(message);
            }
        }
        if declaration.kind == Kind::Interface {
            return;
        }
        for item in items() {
            if let ItemKind::Binding(binding) = &item.kind
                && binding.kind == BindingKind::State
                && !rates.iter().any(|rate| rate.text == binding.name.text)
                && placing(declaration.kind, &item.kind).is_none()
            {
                let name = &binding.name.text;
                let message =
                    Diagnostic::error(codes::STATE, format!("the state `{name}` has no rate"))
                        .with_help(format!("write `der({name}) = …`"));
                let own = declaration
                    .block()
                    .is_some_and(|block| block.items.iter().any(|other| std::ptr::eq(other, item)));
                self.report(match own {
                    true => message.at(binding.name.span, "how does it change?"),
                    false => message
                        .at(declaration.name.span, format!("no `der({name})`"))
                        .also(binding.name.span, "the interface leaves it to the class"),
                });
            }
        }
    }

    /// Refuses a state that is no single number with a dimension. Whole numbers do not change steadily.
    pub(super) fn single_state(&mut self, binding: &Binding, ty: &Type) -> bool {
        let name = &binding.name.text;
        if let Some(index) = binding.index.first() {
            self.report(
                Diagnostic::error(codes::STATE, format!("the state `{name}` has an index"))
                    .at(index.name.span, "a state is a single number")
                    .with_help("write a state for each number, with a name and a rate of its own"),
            );
            return false;
        }
        if ty.is_error() || matches!(ty, Type::Scalar(_)) {
            return true;
        }
        let place = (binding.ty.as_ref().map(|ty| ty.span))
            .or(binding.value.as_ref().map(|value| value.span))
            .unwrap_or(binding.name.span);
        let help = match ty {
            Type::Int => format!("a number without a unit has the type 1: `state {name}: 1 = …`"),
            _ => "write a state for each number, with a name and a rate of its own".to_owned(),
        };
        self.report(
            self.mistyped(place, &format!("the state `{name}` is a single number"), ty)
                .with_help(help),
        );
        false
    }

    /// Checks the scale of a state, which is a difference of its values. A state that starts at zero must
    /// state a scale.
    pub(super) fn scale_of_state(&mut self, scope: &Scope<'p>, binding: &Binding, ty: &Type) {
        let name = &binding.name.text;
        if let Some(scale) = &binding.scale {
            let due =
                Due::new(format!("the scale of `{name}`")).declared(binding.name.span, "the state");
            let difference = match ty.quantity() {
                Some(quantity) => Type::Scalar(quantity.difference()),
                None => Type::Error,
            };
            self.expect(scope, scale, &difference, &due);
            return;
        }
        let Some(start) = &binding.value else {
            return;
        };
        let Some(unit) = self.written_zero(start) else {
            return;
        };
        let written = self.sources.text(start.span).to_owned();
        let one = format!(" scale 1{unit}");
        let end = Span::new(
            start.span.source,
            start.span.end as usize,
            start.span.end as usize,
        );
        self.report(
            Diagnostic::error(
                codes::STATE_SCALE,
                format!("the state `{name}` starts at zero and has no scale"),
            )
            .at(start.span, "has no size")
            .with_note("errors of a state are held to 1e-5 of its scale or its largest value so far; a start that is not zero is its own scale")
            .with_help(format!(
                "state the size from which it matters: `{written}{one}`"
            ))
            .with_fix("state a scale", end, one),
        );
    }

    /// The written unit (with its space) of an expression that is a literal zero.
    fn written_zero(&self, expr: &Expr) -> Option<String> {
        match &expr.kind {
            ExprKind::Number { value, unit, .. } if *value == 0.0 => match unit {
                None => Some(String::new()),
                Some(unit) => (self.program.unit(unit).ok()?.offset == 0.0)
                    .then(|| format!(" {}", self.sources.text(unit.span))),
            },
            ExprKind::Paren { inner, unit: None }
            | ExprKind::Unary {
                op: UnaryOp::Negate,
                operand: inner,
            } => self.written_zero(inner),
            _ => None,
        }
    }
}
