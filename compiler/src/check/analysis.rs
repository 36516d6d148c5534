//! Analyses: what is done with a model.

use super::Checker;
use super::call::Slot;
use super::field::has_cycle;
use super::mismatch::Due;
use super::scope::Scope;
use super::types::{Quantity, Type};
use crate::codes;
use eng_grammar::ast::{Argument, Binder, Declaration, Expr, ExprKind, Form, Kind};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;

const EXAMPLE: &str =
    "for instance `analysis run = transient(Model(), duration: 1 s, sample: 1 ms)`";

const STATE_A_CYCLE: &str =
    "state the cycle in the model: `cycle angle = rotation(a, ground) { period = 720 deg }`";
/// What can be done with a model.
const ANALYSES: [&str; 4] = ["transient", "periodic", "linear", "assemble"];
/// How a motion can begin.
const STARTS: [&str; 2] = ["quasi_static", "assembled"];

impl<'p> Checker<'p> {
    pub(super) fn analysis(&mut self, scope: &Scope<'p>, declaration: &'p Declaration) {
        let scope = self.binders(scope, &declaration.index);
        let Form::Instance { value, block } = &declaration.form else {
            self.bad_analysis(
                declaration.name.span,
                "an analysis has a right side",
                "no `= …`",
            );
            return;
        };
        if let Some(block) = block
            && let Some(item) = block.items.first()
        {
            self.misplaced(
                item.span,
                "this",
                "at an analysis",
                "everything an analysis takes is an argument",
            );
        }
        let ExprKind::Call { callee, arguments } = &value.kind else {
            if !matches!(value.kind, ExprKind::Error) {
                self.bad_analysis(value.span, "an analysis is a call", "not a call");
            }
            return;
        };
        let name = match &callee.kind {
            ExprKind::Name(name) => name.as_str(),
            _ => "",
        };
        match name {
            "transient" | "periodic" | "linear" | "assemble" => {
                self.read_locals.clear();
                self.model_and_options(&scope, name, value.span, arguments);
                self.unread_indices(&declaration.index);
            }
            "static" => {
                self.not_built(callee.span, &format!("`{name}` analyses"));
            }
            _ => {
                let mut message = Diagnostic::error(
                    codes::ANALYSIS,
                    format!("there is no analysis `{}`", self.sources.text(callee.span)),
                )
                .at(
                    callee.span,
                    "`transient`, `periodic`, `linear` or `assemble`",
                );
                let near = match name {
                    "modes" | "modal" | "eigen" | "eigenmodes" => Some("linear"),
                    _ => crate::resolve::suggest::nearest(name, ANALYSES),
                };
                if let Some(near) = near {
                    message = message.meant(callee.span, near);
                } else {
                    message = message.with_help(EXAMPLE);
                }
                self.report(message);
            }
        }
    }

    /// Warns of an index that no argument reads: all points of the sweep are the same.
    fn unread_indices(&mut self, index: &[Binder]) {
        for binder in index {
            let name = &binder.name;
            if !self.read_locals.contains(&name.text) {
                self.report(
                    Diagnostic::warning(codes::UNUSED_LET, format!("`{}` is not used", name.text))
                        .at(name.span, "no argument reads it: all runs are the same")
                        .with_help("give it to a parameter of the model, or remove it"),
                );
            }
        }
    }

    fn bad_analysis(&mut self, span: Span, title: &str, label: &str) {
        self.report(
            Diagnostic::error(codes::ANALYSIS, title)
                .at(span, label)
                .with_help(EXAMPLE),
        );
    }

    fn model_and_options(
        &mut self,
        scope: &Scope<'p>,
        name: &str,
        span: Span,
        arguments: &[Argument],
    ) {
        let Some((first, rest)) = arguments.split_first() else {
            self.bad_analysis(span, &format!("`{name}` needs a model"), "of which model?");
            return;
        };
        let with_cycle = self.model_of(scope, first);
        let slot = |name: &str, ty: Type, optional: bool, unit: &str| Slot {
            name: name.to_owned(),
            ty,
            optional,
            span: None,
            unit: (!unit.is_empty()).then(|| unit.to_owned()),
            named_only: true,
        };
        let time = Type::Scalar(Quantity::hard(Dimension::TIME));
        let transient = name == "transient";
        let periodic = name == "periodic";
        let linear = name == "linear";
        let moves = transient || periodic || linear;
        // A time or an angle, which the cycle counts.
        let extents: &[&str] = match name {
            "transient" => &["duration", "sample"],
            "linear" => &["after", "over"],
            _ => &[],
        };
        let mut slots = Vec::new();
        if moves {
            slots = vec![
                slot("step", time, true, "us"),
                slot("tolerance", Type::one(), true, ""),
                slot("rho", Type::one(), true, ""),
            ];
        }
        if linear {
            let frequency = Type::Scalar(Quantity::hard(Dimension::ONE.over(Dimension::TIME)));
            slots.push(slot("number", Type::Int, true, ""));
            slots.push(slot("up_to", frequency, true, "Hz"));
            slots.push(slot("frozen", Type::Bool, true, ""));
        }
        if periodic {
            let angle = Type::Scalar(Quantity::hard(Dimension::ANGLE));
            slots.push(slot("sample", angle, true, "deg"));
            slots.push(slot("change", Type::one(), true, "%"));
            slots.push(slot("cycles", Type::Int, true, ""));
            if with_cycle == Some(false) {
                self.report(
                    Diagnostic::error(
                        codes::NO_CYCLE,
                        "`periodic` runs cycle by cycle, but the model has no cycle",
                    )
                    .at(first.value.span, "this model states none")
                    .with_help(STATE_A_CYCLE),
                );
            }
        }
        let mut others: Vec<Argument> = Vec::new();
        let mut given: Vec<(&str, Span)> = Vec::new();
        for argument in rest {
            let own = argument
                .name
                .as_ref()
                .filter(|n| extents.contains(&n.text.as_str()) || (moves && n.text == "start"));
            match own {
                Some(label) => {
                    if let Some((_, first)) = given.iter().find(|(n, _)| *n == label.text) {
                        self.report(
                            Diagnostic::error(
                                codes::ARGUMENT_TWICE,
                                format!("`{}` is given twice", label.text),
                            )
                            .at(argument.value.span, "again here")
                            .also(*first, "first here"),
                        );
                    }
                    given.push((&label.text, argument.value.span));
                    if label.text == "start" {
                        self.start_word(&argument.value);
                        continue;
                    }
                    // a turn of the fastest body, where there is no cycle
                    let cycle = if label.text == "over" {
                        None
                    } else {
                        with_cycle
                    };
                    self.extent(scope, name, &label.text, &argument.value, cycle);
                }
                None => others.push(argument.clone()),
            }
        }
        // Known to the common check, so that a misspelling finds them.
        for label in extents.iter().copied() {
            let present = label != "duration" || given.iter().any(|(n, _)| *n == label);
            slots.push(slot(
                label,
                Type::Scalar(Quantity::hard(Dimension::TIME)),
                present,
                "s",
            ));
        }
        if moves {
            slots.push(slot("start", Type::one(), true, ""));
        }
        let mut solution = super::types::Solution::default();
        self.arguments(scope, name, &slots, &others, span, &mut solution);
        let place = |wanted: &str| {
            rest.iter()
                .find(|a| a.name.as_ref().is_some_and(|n| n.text == wanted))
                .map(|a| a.value.span)
        };
        if let (Some(frozen), Some(over)) = (place("frozen"), place("over")) {
            self.report(
                Diagnostic::error(
                    codes::ANALYSIS,
                    "modes are those of a period or of a frozen moment, not of both",
                )
                .at(frozen, "for one moment")
                .also(over, "for a motion that repeats")
                .with_help("give one of the two, or none where the coefficients are constant"),
            );
        }
    }

    /// `Model(arguments)`; whether the model has a cycle, if it is known.
    fn model_of(&mut self, scope: &Scope<'p>, argument: &Argument) -> Option<bool> {
        let value = &argument.value;
        let ExprKind::Call { callee, arguments } = &value.kind else {
            let ty = self.infer(scope, value);
            if let Type::Class(id) = ty
                && self.declaration(id).is_some_and(|d| d.kind == Kind::Model)
            {
                let text = self.sources.text(value.span).to_owned();
                self.report(
                    Diagnostic::error(codes::ANALYSIS, "a model needs its parentheses")
                        .at(value.span, "the model itself, not one made of it")
                        .with_help(format!("write `{text}()`"))
                        .with_fix("add the parentheses", value.span, format!("{text}()")),
                );
            } else if !ty.is_error() {
                let found = self.describe(&ty);
                self.bad_analysis(
                    value.span,
                    "an analysis begins with a model",
                    &format!("this is {found}"),
                );
            }
            return None;
        };
        match self.infer(scope, callee) {
            Type::Class(id) if self.declaration(id).is_some_and(|d| d.kind == Kind::Model) => {
                self.arguments_of_class(scope, id, arguments, value.span);
                self.declaration(id).map(has_cycle)
            }
            Type::Error => None,
            other => {
                let found = self.describe(&other);
                self.bad_analysis(
                    callee.span,
                    "an analysis begins with a model",
                    &format!("this is {found}"),
                );
                None
            }
        }
    }

    /// `quasi_static` or `assembled`.
    fn start_word(&mut self, value: &Expr) {
        let word = match &value.kind {
            ExprKind::Name(name) => name.as_str(),
            ExprKind::Error => return,
            _ => "",
        };
        if STARTS.contains(&word) {
            return;
        }
        let mut message = Diagnostic::error(
            codes::ANALYSIS,
            "`start` of an analysis is `quasi_static` or `assembled`",
        )
        .at(value.span, "neither of these words");
        message = match crate::resolve::suggest::nearest(word, STARTS) {
            Some(near) => message
                .meant(value.span, near),
            None => message.with_help(
                "`quasi_static`: pins and flexible bodies stand where the loads of the steady motion hold them; `assembled`: where the text and the joints put them",
            ),
        };
        self.report(message);
    }

    /// A time, or an angle of the cycle.
    fn extent(
        &mut self,
        scope: &Scope<'p>,
        analysis: &str,
        name: &str,
        value: &Expr,
        with_cycle: Option<bool>,
    ) {
        let ty = self.infer(scope, value);
        if ty.is_error() {
            return;
        }
        let due = Due {
            what: format!("`{name}` of `{analysis}`"),
            declared: None,
            unit: Some(if name == "sample" { "ms" } else { "s" }.to_owned()),
        };
        let time = Quantity::hard(Dimension::TIME);
        match ty.quantity() {
            Some(quantity) if quantity.dim.base == Dimension::ANGLE => {
                if with_cycle == Some(false) {
                    self.report(
                        Diagnostic::error(
                            codes::NO_CYCLE,
                            format!("`{name}` is an angle, but the model has no cycle"),
                        )
                        .at(value.span, "an angle of which cycle?")
                        .with_help(format!("give a time, or {STATE_A_CYCLE}")),
                    );
                }
            }
            Some(quantity) => {
                if let Err(misfit) = quantity.fits(&time) {
                    self.misfit(value, misfit, &quantity, &time, &due);
                }
            }
            None => self.wrong_type(value, &ty, &Type::Scalar(time), &due),
        }
    }
}
