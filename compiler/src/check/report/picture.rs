//! Figures: the arguments of a call, by the row of its kind in `eng_system::figure`.

use super::Reporter;
use super::channel::{Found, Places, are_modes, begins, not_one};
use super::value::Typed;
use crate::check::bound::{Called, Parameter};
use crate::check::mismatch::Due;
use crate::check::signal::Shape;
use crate::check::types::{Quantity, SignalRows, Type};
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{Expr, ExprKind, UnitExpr};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;
use eng_system::analysis::Extent;
use eng_system::expression::{Expression, Function, Member};
use eng_system::figure::{
    self, Argument, Figure, FigureRow, Given, Journals, Signals, Takes, Unplanned, Value, Vector,
};
use eng_system::recorded::{FREQUENCY, PHASE, Recorded};

/// Whether a signal has the frequencies of a response as rows.
fn of_response(ty: &Type) -> bool {
    let frequencies = |rows: &SignalRows| matches!(rows, SignalRows::Frequencies(_));
    matches!(ty, Type::Signal { rows, .. } if frequencies(rows))
}

impl<'a> Reporter<'a, '_> {
    /// A figure; `None` after a message.
    pub(super) fn figure(&mut self, expr: &'a Expr, display: Option<&UnitExpr>) -> Option<Figure> {
        let ExprKind::Call { callee, arguments } = &expr.kind else {
            self.no_picture(expr.span, None);
            return None;
        };
        let name = match &callee.kind {
            ExprKind::Name(name) => name.as_str(),
            _ => "",
        };
        let Some(row) = figure::kind(name) else {
            self.no_picture(callee.span, Some(name));
            return None;
        };
        let bound = self.checker.bound_to(&called(row), arguments, expr.span)?;
        let mut given = Given::default();
        // the signals of the first argument, which the others refer to
        let mut of = None;
        for argument in row.arguments {
            let Some(value) = bound.option(argument.name) else {
                continue;
            };
            let value = match argument.takes {
                Takes::Ordinates | Takes::OrdinatesOfRows => {
                    let mut panels = Vec::new();
                    let more = bound.more().filter(|_| argument.more);
                    for expr in std::iter::once(value).chain(more) {
                        let takes = argument.takes;
                        panels.push(self.panel((row, takes), expr, display, panels.first())?);
                    }
                    of = panels.first().map(|(typed, _)| typed.clone());
                    Value::Signals(panels.into_iter().map(|(_, signals)| signals).collect())
                }
                Takes::Amplitudes => {
                    let (typed, signals) = self.amplitudes(row.name, value, display)?;
                    of = Some(typed);
                    Value::Signals(vec![signals])
                }
                Takes::AmplitudesOfRuns | Takes::AmplitudesOfRunsOr(_) => {
                    let (typed, signals) = self.amplitudes(row.name, value, display)?;
                    let count = runs(&typed.members);
                    let enough = match argument.takes {
                        Takes::AmplitudesOfRunsOr(other) => {
                            count > 1 || bound.option(other).is_some()
                        }
                        _ => count > 1 && count == typed.members.len(),
                    };
                    self.of_runs(row.name, value, &typed, enough)?;
                    of = Some(typed);
                    Value::Signals(vec![signals])
                }
                Takes::Responses => Value::Signals(vec![self.responses(row, value, display)?]),
                Takes::Journals => Value::Journals(self.journals(row, value, display)?),
                Takes::Films => self.films(row, value, display)?,
                Takes::Vectors => {
                    let (vectors, column) = self.vectors(row, value)?;
                    let typed = Typed::signals(Vec::new(), true, &column, SignalRows::Samples);
                    let quantity = match vectors.iter().any(|vector| vector.load) {
                        true => "load".to_owned(),
                        false => last_name(column.path.trim_end_matches(".x")),
                    };
                    let shown = figure::Recorded {
                        quantity,
                        display: self.display(&typed, display, value)?,
                        dimension: column.dimension,
                    };
                    Value::Vectors(vectors, shown)
                }
                Takes::Changes(share) => {
                    let signals = self.changes(value, bound.option(share), display)?;
                    Value::Signals(vec![signals])
                }
                takes => self.option(row, argument, takes, (value, of.as_ref()))?,
            };
            given.state(argument.name, value);
        }
        match (row.plan)(&given) {
            Ok(figure) => {
                self.of_like_samples(&figure, expr.span)?;
                Some(figure)
            }
            Err(unplanned) => {
                let place = |name: &str| bound.option(name).unwrap_or(expr);
                match unplanned {
                    Unplanned::NoCycle(argument, what) => self.no_cycle(place(argument), what),
                    Unplanned::OtherAxis(argument, title, label) => self.diagnose(
                        Diagnostic::error(codes::DIMENSION, title).at(place(argument).span, label),
                    ),
                    Unplanned::Counts(argument, title) => self.diagnose(
                        Diagnostic::error(codes::REPORT_RUNS, title)
                            .at(place(argument).span, "one for all, or one for each"),
                    ),
                    // a required argument without a value has its message
                    Unplanned::Absent(_) => {}
                }
                None
            }
        }
    }

    /// Refuses signals over signals of a run with another number of samples, as far as the analyses state it.
    fn of_like_samples(&mut self, figure: &Figure, place: Span) -> Option<()> {
        for (x, y) in figure.picture.paired() {
            let (Some((a, of_a)), Some((b, of_b))) = (self.samples(x), self.samples(y)) else {
                continue;
            };
            // rounding may decide about the last sample
            if (of_a - of_b).abs() < 2.0 {
                continue;
            }
            let title = format!("{a} and {b} have different samples");
            self.diagnose(
                Diagnostic::error(codes::REPORT_RUNS, title)
                    .at(place, format!("{of_a:.0} of {a} against {of_b:.0} of {b}"))
                    .with_help(
                        "`resample(a, like: b)` gives the signal a at the samples of the signal b",
                    ),
            );
            return None;
        }
        Some(())
    }

    /// The run whose samples a signal has, and the number of samples as the analysis states it. There is one at the
    /// start and one at the end, also if the last distance is shorter.
    fn samples<'e>(&self, signal: &'e Expression) -> Option<(&'e str, f64)> {
        let run = run_of(signal)?;
        let (sample, duration) = self.models.plan(run)?.analysis.kind.sampling()?;
        match (sample, duration?) {
            (Extent::Time(part), Extent::Time(whole))
            | (Extent::Angle(part), Extent::Angle(whole)) => {
                // the distances may have rounding errors
                Some((run, (whole / part - 1e-6).ceil() + 1.0))
            }
            _ => None,
        }
    }

    fn no_picture(&mut self, span: Span, name: Option<&str>) {
        let known = || figure::KINDS.iter().map(|row| row.name);
        let message = Diagnostic::error(
            codes::REPORT_SHAPE,
            match name {
                Some(name) => format!("there is no figure `{name}`"),
                None => "a figure is a call: `figure name = history(…)`".to_owned(),
            },
        )
        .at(span, "draws nothing");
        let message = match name.and_then(|name| nearest(name, known())) {
            Some(near) => message.meant(span, near),
            None => message.with_note(format!("the figures are {}", listing(known(), 12))),
        };
        self.diagnose(message);
    }

    /// The value of an argument that refers to those before it.
    fn option(
        &mut self,
        row: &FigureRow,
        argument: &Argument,
        takes: Takes,
        (expr, of): (&'a Expr, Option<&Typed>),
    ) -> Option<Value> {
        let what = format!("`{}`", argument.name);
        let number = |value| Some(Value::Numbers(vec![value]));
        match takes {
            Takes::Word(words) => {
                let words: Vec<_> = words
                    .iter()
                    .enumerate()
                    .map(|(at, word)| (*word, at))
                    .collect();
                self.word(Some(expr), &what, &words)?.map(Value::Word)
            }
            Takes::Limit => self.limit(expr, &what).map(Value::Limit),
            Takes::Extent => self.extent(expr, of?, &what).map(Value::Extent),
            Takes::Share => number(self.share(expr, &what)?),
            Takes::Change => number(self.change(expr, &what)?),
            Takes::Count => number(f64::from(self.count(expr, &what)?)),
            Takes::Turn => {
                let angle = Quantity::hard(Dimension::ANGLE);
                let due = format!("{what}, an angle of the shaft,");
                let angle = self.constant(expr, &angle, &due)?;
                if !(angle > 0.0 && angle.is_finite()) {
                    self.refuse(expr, &what, "above zero")?;
                }
                number(angle)
            }
            Takes::Reference => number(self.reference(expr, of?)?),
            Takes::Orders => self.orders(expr).map(Value::Numbers),
            Takes::Signals(dimension) => {
                let of = self.signals(expr, (row.name, &what), dimension)?;
                let signals = self.shown(of, None, expr)?;
                Some(Value::Signals(vec![signals]))
            }
            Takes::LinearAnalyses => self.natural_modes(expr, of?).map(Value::Analyses),
            Takes::Moment => self.moment(expr, &what),
            // arguments by place that nothing refers back from
            Takes::Ordinates
            | Takes::OrdinatesOfRows
            | Takes::Amplitudes
            | Takes::AmplitudesOfRuns
            | Takes::AmplitudesOfRunsOr(_)
            | Takes::Responses
            | Takes::Journals
            | Takes::Films
            | Takes::Changes(_)
            | Takes::Vectors => None,
        }
    }

    /// Signals with their unit, as a figure takes them.
    pub(super) fn shown(
        &mut self,
        of: Typed,
        display: Option<&UnitExpr>,
        expr: &'a Expr,
    ) -> Option<Signals> {
        let first = of.members.first();
        Some(Signals {
            shown: figure::Recorded {
                quantity: last_name(first.map_or("", |member| &member.channel)),
                display: self.display(&of, display, expr)?,
                dimension: of.quantity().dim.base,
            },
            cycle: self.has_cycle(&of)?,
            repeats: self.repeats(&of),
            members: of.members,
        })
    }

    /// Signals of a panel, of the quantity of the first panel.
    fn panel(
        &mut self,
        (row, takes): (&FigureRow, Takes),
        expr: &'a Expr,
        display: Option<&UnitExpr>,
        first: Option<&(Typed, Signals)>,
    ) -> Option<(Typed, Signals)> {
        let name = row.name;
        let panel = self.expression(expr)?;
        self.shaped(
            expr,
            &panel,
            Shape::Signal,
            &format!("an argument of `{name}`"),
        )?;
        if takes == Takes::Ordinates || !of_response(&panel.ty) {
            self.checker.of_samples(expr, &panel.ty, name)?;
        }
        if let Some((first, _)) = first
            && panel.quantity().fits(&first.quantity()).is_err()
        {
            let names = [first, &panel].map(|panel| self.checker.quantity_name(&panel.quantity()));
            let [a, b] = names;
            self.diagnose(
                Diagnostic::error(
                    codes::LIST_ELEMENTS,
                    format!("the panels of a {name} share their axis: {a} and {b}"),
                )
                .at(expr.span, format!("this is {b}"))
                .with_help("draw two figures"),
            );
            return None;
        }
        // the unit of the first panel is that of all
        let display = display.filter(|_| first.is_none());
        let signals = self.shown(panel.clone(), display, expr)?;
        Some((panel, signals))
    }

    /// The signals of a figure of amplitudes, which have no zero of their own.
    fn amplitudes(
        &mut self,
        name: &str,
        expr: &'a Expr,
        display: Option<&UnitExpr>,
    ) -> Option<(Typed, Signals)> {
        let mut of = self.expression(expr)?;
        self.shaped(
            expr,
            &of,
            Shape::Signal,
            &format!("an argument of `{name}`"),
        )?;
        self.checker.of_samples(expr, &of.ty, name)?;
        if let Type::Signal { quantity, .. } = &mut of.ty {
            *quantity = quantity.difference();
        }
        let signals = self.shown(of.clone(), display, expr)?;
        Some((of, signals))
    }

    /// Reports a figure over the speed of the cycle that has too few runs, or no cycle.
    fn of_runs(&mut self, name: &str, first: &'a Expr, of: &Typed, enough: bool) -> Option<()> {
        if enough {
            return self.with_cycle(first, of, &format!("`{name}`"));
        }
        let sweep = super::channel::root_name(first).filter(|root| {
            let plans = self.models.named(root);
            plans.iter().any(|plan| !plan.analysis.point.is_empty())
        });
        let help = match sweep {
            Some(sweep) => format!("`{sweep}[*]` are all its runs"),
            None => "an analysis with an index has several: `analysis runup[s in 1000 rpm .. 6000 rpm by 250 rpm] = …`".to_owned(),
        };
        self.diagnose(
            Diagnostic::error(
                codes::REPORT_RUNS,
                format!("`{name}` needs one signal of several runs"),
            )
            .at(first.span, "from a single run, or several signals")
            .with_help(help),
        );
        None
    }

    /// Linear analyses of the model of some signals.
    fn natural_modes(&mut self, expr: &'a Expr, of: &Typed) -> Option<Vec<String>> {
        let help = "such as `coupled`, or of a sweep over the speed `whirl[*]`";
        let places = self.of_path(expr, "`modes` names linear analyses", help)?;
        let mut names = Vec::new();
        for place in &places.found {
            let plan = place.plan;
            let name = plan.analysis.origin.path.clone();
            if !are_modes(plan) || !place.path.is_empty() {
                self.diagnose(
                    Diagnostic::error(codes::REPORT_SHAPE, "`modes` names linear analyses")
                        .at(expr.span, help)
                        .with_note(if place.path.is_empty() {
                            format!("`{name}` gives samples")
                        } else {
                            "this is the analysis alone, and none of its columns".to_owned()
                        }),
                );
                return None;
            }
            let same = |member: &Member| {
                let own = self.models.plan(&member.analysis);
                own.is_some_and(|own| own.model == plan.model)
            };
            if !of.members.iter().all(same) {
                self.diagnose(
                    Diagnostic::error(
                        codes::REPORT_RUNS,
                        format!("`{name}` is of another model than the spectra"),
                    )
                    .at(expr.span, "modes of another model"),
                );
                return None;
            }
            names.push(name);
        }
        Some(names)
    }

    /// Orders: a plain number or a list of them, above zero.
    fn orders(&mut self, expr: &'a Expr) -> Option<Vec<f64>> {
        let items: Vec<&'a Expr> = match &expr.kind {
            ExprKind::List { items, unit: None } => items.iter().collect(),
            _ => vec![expr],
        };
        if items.is_empty() {
            self.refuse(expr, "the number of orders", "at least one")?;
        }
        let mut orders = Vec::new();
        for item in items {
            let order = self.constant(item, &Quantity::one(), "an order")?;
            if !(order > 0.0 && order.is_finite()) {
                self.refuse(item, "an order", "above zero")?;
            }
            orders.push(order);
        }
        Some(orders)
    }

    /// Outputs of frequency responses, as recorded, because only these have a phase.
    fn responses(
        &mut self,
        row: &FigureRow,
        expr: &'a Expr,
        display: Option<&UnitExpr>,
    ) -> Option<Signals> {
        let of = self.expression(expr)?;
        let what = format!("an argument of `{}`", row.name);
        self.shaped(expr, &of, Shape::Signal, &what)?;
        let recorded = |member: &Member| match &member.expression {
            Expression::Channel { path, .. } => !path.ends_with(PHASE) && path != FREQUENCY,
            _ => false,
        };
        let of_responses = of_response(&of.ty);
        if !of_responses || !of.members.iter().all(recorded) {
            let title = format!("`{}` takes outputs of `response` analyses", row.name);
            let label = match of_responses {
                true => "a number computed of them has no phase",
                false => "of another analysis",
            };
            self.diagnose(
                Diagnostic::error(codes::REPORT_SHAPE, title)
                    .at(expr.span, label)
                    .with_help(
                        "such as `shaken.mount.force.z`; the phase is drawn below by itself",
                    ),
            );
            return None;
        }
        self.shown(of, display, expr)
    }

    /// Journals, and their units, which the kind of figure decides.
    fn journals(
        &mut self,
        row: &FigureRow,
        expr: &'a Expr,
        display: Option<&UnitExpr>,
    ) -> Option<Journals> {
        let name = row.name;
        let title = format!("`{name}` takes journals");
        let places = self.of_path(expr, &title, "such as `run.main[1..5]`")?;
        if let Some(unit) = display {
            self.diagnose(
                Diagnostic::error(codes::DISPLAY, format!("{name}s are drawn in µm"))
                    .at(unit.span, "another unit")
                    .with_help("omit `as`"),
            );
            return None;
        }
        let mut journals = Vec::new();
        for place in &places.found {
            self.samples_at(expr, place, name)?;
            if place.journal().is_none() {
                let known = place.channels.journals.iter().map(|j| j.path.as_str());
                let message = Diagnostic::error(
                    codes::REPORT_SHAPE,
                    format!("`{}` is no journal", place.path),
                )
                .at(expr.span, format!("`{name}` draws {}", row.about))
                .with_note(match place.channels.journals.is_empty() {
                    true => "the model has no journal".to_owned(),
                    false => format!("its journals are {}", listing(known, 12)),
                });
                self.diagnose(message);
                return None;
            }
            journals.push((place.plan.analysis.origin.path.clone(), place.path.clone()));
        }
        Some(journals)
    }

    /// Journals whose films have cells.
    fn films(
        &mut self,
        row: &FigureRow,
        expr: &'a Expr,
        display: Option<&UnitExpr>,
    ) -> Option<Value> {
        if let Some(unit) = display {
            self.diagnose(
                Diagnostic::error(
                    codes::DISPLAY,
                    "cells of films are drawn in MPa, um or without a unit",
                )
                .at(unit.span, "another unit")
                .with_help("omit `as`"),
            );
            return None;
        }
        let journals = self.journals(row, expr, None)?;
        let places = self.places(expr)?;
        for place in &places.found {
            if place.journal().is_some_and(|journal| !journal.cells) {
                let title = format!("the law of `{}` has no cells", place.path);
                self.diagnose(
                    Diagnostic::error(codes::REPORT_SHAPE, title)
                        .at(expr.span, format!("`{}` draws {}", row.name, row.about))
                        .with_help("a law with a `field` has them"),
                );
                return None;
            }
        }
        let cycle = places.found.iter().all(|place| place.channels.cycle);
        Some(Value::Films(journals, cycle))
    }

    /// A number that is an angle or a time.
    fn moment(&mut self, expr: &'a Expr, what: &str) -> Option<Value> {
        let of = self.expression(expr)?.settled();
        self.shaped(expr, &of, Shape::Number, what)?;
        let (quantity, time) = (of.quantity(), Quantity::hard(Dimension::TIME));
        let by_time = quantity.dim.base != Dimension::ANGLE;
        if by_time && let Err(misfit) = quantity.fits(&time) {
            self.checker
                .misfit(expr, misfit, &quantity, &time, &Due::new(what));
            return None;
        }
        match of.members.as_slice() {
            [one] if !of.list => Some(Value::Moment(one.expression.clone(), by_time)),
            _ => {
                self.refuse(expr, what, "one moment")?;
                None
            }
        }
    }

    /// Recorded vectors or loads of journals, and the column of the first one's component along x.
    fn vectors(&mut self, row: &FigureRow, expr: &'a Expr) -> Option<(Vec<Vector>, Recorded)> {
        let title = format!("`{}` takes journals and recorded vectors", row.name);
        let help = "such as `run.main[1..5]` or `run.hinge.force`";
        let places = self.of_path(expr, &title, help)?;
        let mut vectors: Vec<Vector> = Vec::new();
        let mut column = None;
        for place in &places.found {
            let (vector, x) = self.vector(row, expr, place)?;
            if vectors
                .first()
                .is_some_and(|known| known.load != vector.load)
            {
                self.diagnose(
                    Diagnostic::error(
                        codes::LIST_ELEMENTS,
                        "loads of journals and other vectors need separate diagrams",
                    )
                    .at(expr.span, "both"),
                );
                return None;
            }
            vectors.push(vector);
            column.get_or_insert(x);
        }
        Some((vectors, column?))
    }

    /// Signals of samples, of a dimension if one is given.
    fn signals(
        &mut self,
        expr: &'a Expr,
        (name, what): (&str, &str),
        dimension: Option<Dimension>,
    ) -> Option<Typed> {
        let of = self.expression(expr)?;
        self.shaped(expr, &of, Shape::Signal, what)?;
        if dimension.is_some() || !of_response(&of.ty) {
            self.checker.of_samples(expr, &of.ty, name)?;
        }
        if let Some(dimension) = dimension {
            let (found, due) = (of.quantity(), Quantity::hard(dimension));
            if let Err(misfit) = found.fits(&due) {
                self.checker
                    .misfit(expr, misfit, &found, &due, &Due::new(what));
                return None;
            }
        }
        Some(of)
    }

    /// The vector at a place, or the load of a journal there, and the column of its component along x.
    fn vector(
        &mut self,
        row: &FigureRow,
        expr: &Expr,
        place: &Found<'a>,
    ) -> Option<(Vector, Recorded)> {
        self.samples_at(expr, place, row.name)?;
        let journal = place.journal();
        let load = journal.is_some();
        let [x, y] = match journal {
            Some(journal) => journal.force.each_ref().map(|path| place.column_at(path)),
            None => [".x", ".y"].map(|axis| place.column(axis)),
        };
        let (Some(x), Some(y)) = (x, y) else {
            let below = |column: &&Recorded| begins(&column.path, &place.path);
            let message = if place.columns().iter().filter(below).count() > 1 {
                not_one(place, expr.span)
            } else {
                no_vector(place, expr.span)
            };
            self.diagnose(message);
            return None;
        };
        let component = |column: &Recorded| {
            let channel = place.channel(&column.path);
            // the load on the shell is opposite to the force on the pin
            match load {
                true => Expression::Map(Function::Negate, Box::new(channel)),
                false => channel,
            }
        };
        let vector = Vector {
            load,
            x: component(x),
            y: component(y),
            turned_by: None,
            path: place.path.clone(),
            analysis: place.plan.analysis.origin.path.clone(),
        };
        Some((vector, x.clone()))
    }

    /// The places of a path. Gives a message with the expected form if an expression is no path.
    fn of_path(&mut self, expr: &'a Expr, title: &str, label: &str) -> Option<Places<'a>> {
        let known =
            super::channel::root_name(expr).is_some_and(|root| !self.models.named(root).is_empty());
        if known {
            return self.places(expr);
        }
        if self.is_constant(expr) {
            self.all_known(expr)?;
        }
        self.diagnose(
            Diagnostic::error(codes::REPORT_SHAPE, title).at(expr.span, label.to_owned()),
        );
        None
    }
}

/// The parameters of a kind, as a call sees them.
fn called(row: &FigureRow) -> Called<'static> {
    let parameters = row.arguments.iter();
    Called {
        name: row.name,
        parameters: parameters
            .map(|argument| Parameter {
                name: argument.name,
                required: argument.by_place,
                by_place: argument.by_place,
                by_name: true,
            })
            .collect(),
        more: row.arguments.iter().any(|argument| argument.more),
        example: None,
    }
}

/// The message for a place that is no vector.
pub(super) fn no_vector(place: &Found<'_>, span: Span) -> Diagnostic {
    Diagnostic::error(
        codes::REPORT_SHAPE,
        format!("`{}` is no vector", place.path),
    )
    .at(span, "it has no x and y")
}

/// The run that has all samples of a signal; `None` if the signal is a part of one, or unknown.
fn run_of(signal: &Expression) -> Option<&str> {
    match signal {
        Expression::Channel { analysis, .. } => Some(analysis),
        Expression::Map(_, of) | Expression::Decibel(_, of) => run_of(of),
        Expression::Binary(_, left, right) => run_of(left).or_else(|| run_of(right)),
        _ => None,
    }
}

/// The number of runs.
fn runs(members: &[Member]) -> usize {
    let mut analyses: Vec<&str> = members.iter().map(|m| m.analysis.as_str()).collect();
    analyses.sort_unstable();
    analyses.dedup();
    analyses.len()
}

/// `shell acceleration` of `shell_acceleration[5]`, `force x` of `main[5].force.x`.
pub(super) fn last_name(path: &str) -> String {
    let plain: String = {
        let mut depth = 0;
        path.chars()
            .filter(|c| {
                match c {
                    '[' => depth += 1,
                    ']' => {
                        depth -= 1;
                        return false;
                    }
                    _ => {}
                }
                depth == 0
            })
            .collect()
    };
    let mut names: Vec<&str> = plain.split('.').collect();
    let count = names.len();
    let keep = match names.last() {
        Some(&("x" | "y" | "z")) => 2,
        _ => 1,
    };
    names.drain(..count.saturating_sub(keep));
    names.join(" ").replace('_', " ")
}
