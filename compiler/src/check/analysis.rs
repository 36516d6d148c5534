//! Checks analyses.

use super::Checker;
use super::call::Slot;
use super::mismatch::Due;
use super::scope::Scope;
use super::types::{Quantity, Type};
use crate::codes;
use crate::program::DefinitionId;
use crate::resolve::suggest::nearest;
use crate::typed::lineage::has_cycle;
use eng_grammar::ast::{Argument, Binder, Declaration, Expr, ExprKind, Form, Kind};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;
use eng_system::analysis::{self, Counted, KINDS, KindRow, Takes};
use eng_system::system::{Method, Start};

const EXAMPLE: &str =
    "for instance `analysis run = transient(Model(), duration: 1 s, sample: 1 ms)`";

const STATE_A_CYCLE: &str =
    "state the cycle in the model: `cycle angle = rotation(a, ground) { period = 720 deg }`";

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
                "an analysis has only arguments",
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
        match analysis::kind(name) {
            Some(kind) => {
                self.read_locals.clear();
                self.model_and_options(&scope, kind, value.span, arguments);
                self.unread_indices(&declaration.index);
            }
            None => self.no_kind(callee.span, name),
        }
    }

    /// There is no analysis of a name.
    fn no_kind(&mut self, callee: Span, name: &str) {
        let mut names: Vec<String> = KINDS
            .iter()
            .map(|kind| format!("`{}`", kind.name))
            .collect();
        let last = names.pop().unwrap_or_default();
        let mut message = Diagnostic::error(
            codes::ANALYSIS,
            format!("there is no analysis `{}`", self.sources.text(callee)),
        )
        .at(callee, format!("{} or {last}", names.join(", ")));
        let elsewhere = KINDS.iter().find(|kind| kind.also_called.contains(&name));
        let near = elsewhere.map(|kind| kind.name);
        let near = near.or_else(|| nearest(name, KINDS.iter().map(|kind| kind.name)));
        if let Some(near) = near {
            message = message.meant(callee, near);
        } else {
            message = message.with_help(EXAMPLE);
        }
        self.report(message);
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
        kind: &KindRow,
        span: Span,
        arguments: &[Argument],
    ) {
        let name = kind.name;
        let Some((first, rest)) = arguments.split_first() else {
            self.bad_analysis(span, &format!("`{name}` needs a model"), "of which model?");
            return;
        };
        let model = self.model_of(scope, first);
        let with_cycle = model.map(|model| has_cycle(self.program, model));
        if let Some(why) = kind.needs_cycle
            && with_cycle == Some(false)
        {
            self.report(
                Diagnostic::error(
                    codes::NO_CYCLE,
                    format!("`{name}` {why}, but the model has no cycle"),
                )
                .at(first.value.span, "this model states none")
                .with_help(STATE_A_CYCLE),
            );
        }
        let (given, others) = self.own_forms(scope, kind, rest, model);
        // all of them, so that a misspelling finds them
        let slots: Vec<Slot> = kind
            .arguments
            .iter()
            .map(|argument| Slot {
                name: argument.name.to_owned(),
                ty: plain_type(argument.takes),
                optional: !argument.required || given.contains(&argument.name),
                span: None,
                unit: (!argument.unit.is_empty()).then(|| argument.unit.to_owned()),
                named_only: true,
                given: None,
                over_time: false,
            })
            .collect();
        let mut solution = super::types::Solution::default();
        self.arguments(scope, name, &slots, &others, span, &mut solution);
        let place = |wanted: &str| {
            rest.iter()
                .find(|a| a.name.as_ref().is_some_and(|n| n.text == wanted))
                .map(|a| a.value.span)
        };
        for apart in kind.apart {
            if let (Some(one), Some(other)) = (place(apart.first.0), place(apart.second.0)) {
                self.report(
                    Diagnostic::error(codes::ANALYSIS, apart.title)
                        .at(one, apart.first.1)
                        .also(other, apart.second.1)
                        .with_help(apart.help),
                );
            }
        }
    }

    /// Checks the arguments that no plain type describes: times or angles, words. Gives their names, and the
    /// other arguments.
    fn own_forms(
        &mut self,
        scope: &Scope<'p>,
        kind: &KindRow,
        arguments: &[Argument],
        model: Option<DefinitionId>,
    ) -> (Vec<&'static str>, Vec<Argument>) {
        let with_cycle = model.map(|model| has_cycle(self.program, model));
        let mut others: Vec<Argument> = Vec::new();
        let mut given: Vec<(&'static str, Span)> = Vec::new();
        for argument in arguments {
            let named = |name: &str| argument.name.as_ref().is_some_and(|n| n.text == name);
            let row = kind.arguments.iter().find(|row| named(row.name));
            let Some((row, form)) = row.map(|row| (row, row.takes)) else {
                others.push(argument.clone());
                continue;
            };
            if !matches!(
                form,
                Takes::Extent(_)
                    | Takes::Start
                    | Takes::Method
                    | Takes::Names(_)
                    | Takes::Condition
            ) {
                others.push(argument.clone());
                continue;
            }
            let value = &argument.value;
            if let Some((_, first)) = given.iter().find(|(name, _)| *name == row.name) {
                self.report(
                    Diagnostic::error(
                        codes::ARGUMENT_TWICE,
                        format!("`{}` is given twice", row.name),
                    )
                    .at(value.span, "again here")
                    .also(*first, "first here"),
                );
            }
            given.push((row.name, value.span));
            match form {
                Takes::Extent(Counted::ByCycle) => {
                    self.extent(scope, kind.name, row, value, with_cycle);
                }
                // a turn of the fastest body, if there is no cycle
                Takes::Extent(Counted::ByFastest) => {
                    self.extent(scope, kind.name, row, value, None);
                }
                Takes::Names(_) => self.channel_names(scope, row.name, value),
                Takes::Condition => {
                    if let Some(model) = model {
                        self.stop_condition(scope, model, row.name, value);
                    }
                }
                Takes::Method => self.word_of(
                    value,
                    &Method::NAMED.map(|(word, _)| word),
                    "`integrator` of an analysis is `generalised_alpha` or `radau`",
                    "`generalised_alpha`: of second order, for machines with films and contacts; `radau`: of fifth order, for tight tolerances of smooth motions",
                ),
                _ => self.word_of(
                    value,
                    &Start::NAMED.map(|(word, _)| word),
                    "`start` of an analysis is `quasi_static` or `assembled`",
                    "`quasi_static`: pins and flexible bodies are where the loads of the steady motion hold them; `assembled`: where the text and the joints put them",
                ),
            }
        }
        (given.into_iter().map(|(name, _)| name).collect(), others)
    }

    /// A condition on the motion of a model. Its names are those of the model, and the indices of the analysis.
    fn stop_condition(&mut self, scope: &Scope<'p>, model: DefinitionId, name: &str, value: &Expr) {
        let inside = Scope {
            locals: scope.locals.clone(),
            ..Scope::of(model)
        };
        self.condition(&inside, value, &format!("`{name}` of an analysis"));
        // its level is checked together with those of the models
        self.stops.push((inside, value.clone()));
    }

    /// `Model(arguments)`: the model, if it is known.
    fn model_of(&mut self, scope: &Scope<'p>, argument: &Argument) -> Option<DefinitionId> {
        let value = &argument.value;
        let ExprKind::Call { callee, arguments } = &value.kind else {
            let ty = self.infer(scope, value);
            if let Type::Class(id) = ty
                && self.declaration(id).is_some_and(|d| d.kind == Kind::Model)
            {
                let text = self.sources.text(value.span).to_owned();
                self.report(
                    Diagnostic::error(codes::ANALYSIS, "a model needs its parentheses")
                        .at(value.span, "the name alone")
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
                self.arguments_of_class(scope, id, &[], arguments, value.span);
                Some(id)
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

    /// One of some words.
    fn word_of(&mut self, value: &Expr, known: &[&str], title: &str, help: &str) {
        let word = match &value.kind {
            ExprKind::Name(name) => name.as_str(),
            ExprKind::Error => return,
            _ => "",
        };
        if known.contains(&word) {
            return;
        }
        let mut message =
            Diagnostic::error(codes::ANALYSIS, title).at(value.span, "neither of these words");
        message = match nearest(word, known.iter().copied()) {
            Some(near) => message.meant(value.span, near),
            None => message.with_help(help),
        };
        self.report(message);
    }

    /// A time, or an angle of the cycle.
    fn extent(
        &mut self,
        scope: &Scope<'p>,
        analysis: &str,
        argument: &analysis::Argument,
        value: &Expr,
        with_cycle: Option<bool>,
    ) {
        let ty = self.infer(scope, value);
        if ty.is_error() {
            return;
        }
        let name = argument.name;
        let due = Due {
            what: format!("`{name}` of `{analysis}`"),
            declared: None,
            unit: Some(argument.unit.to_owned()),
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

/// The type of an argument for the common check of calls. It is not used for an argument with a form of its
/// own.
fn plain_type(takes: Takes) -> Type {
    let of = |dimension: Dimension| Type::Scalar(Quantity::hard(dimension));
    match takes {
        Takes::Number | Takes::Start | Takes::Method => Type::one(),
        // names have no type, and a condition has the names of its model
        Takes::Names(_) | Takes::Condition => Type::Error,
        Takes::Count => Type::Int,
        Takes::Time | Takes::Extent(_) => of(Dimension::TIME),
        Takes::Angle => of(Dimension::ANGLE),
        Takes::Frequency => of(Dimension::ONE.over(Dimension::TIME)),
        Takes::Switch => Type::Bool,
    }
}
