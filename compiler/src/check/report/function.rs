//! Functions of signals and numbers.

use super::Reporter;
use super::picture::no_vector;
use super::value::Typed;
use crate::check::bound::Bound;
use crate::check::signal::Shape;
use crate::check::types::{Quantity, SignalRows, Type};
use crate::codes;
use crate::functions::{self, BuiltIn, OfResults};
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{Argument, Expr, ExprKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;
use eng_system::expression::{
    Chosen, Expression, Filter, Function, Limit, Member, Operator, Part, Reduction,
};

/// Whether a function takes the rows of a signal. The functions of modes and of frequencies refuse other rows in their
/// own words.
fn takes(results: OfResults, rows: &SignalRows) -> bool {
    let frequencies = matches!(rows, SignalRows::Frequencies(_));
    match results {
        _ if rows.of_analysis().is_none() => true,
        OfResults::Each(_) | OfResults::Fold(_) | OfResults::Decibel => true,
        OfResults::Mode | OfResults::AtFrequency => true,
        OfResults::Reduce(reduction) => match reduction {
            Reduction::Minimum | Reduction::Maximum | Reduction::PeakToPeak => true,
            Reduction::MinimumAt(_) | Reduction::MaximumAt(_) => frequencies,
            Reduction::Mean | Reduction::RootMeanSquare => false,
        },
        _ => false,
    }
}

impl<'a> Reporter<'a, '_> {
    /// A call; `None` after a message.
    pub(super) fn call(
        &mut self,
        span: Span,
        name: &'a str,
        place: Span,
        arguments: &'a [Argument],
    ) -> Option<Typed> {
        let mut known = functions::of_reports();
        let Some(function) = known.find(|function| function.name == name) else {
            self.no_function(name, place);
            return None;
        };
        let bound = self.checker.bound(function, arguments, span, true)?;
        let first = bound.option(function.parameters.first()?)?;
        if function.results == OfResults::Length {
            return self.length(first, bound.option("floor"));
        }
        let of = self.expression(first)?;
        if let Type::Signal { rows, .. } = &of.ty
            && !takes(function.results, rows)
        {
            self.checker.of_samples(first, &of.ty, name)?;
        }
        match function.results {
            OfResults::Each(each) => self.each(function, each, first, of),
            OfResults::Fold(operator) if bound.more().next().is_none() => {
                self.fold(operator, first, of)
            }
            OfResults::Fold(operator) => self.extreme(function, operator, first, of, &bound, span),
            OfResults::Decibel => self.decibel(first, of, bound.option("reference")?),
            OfResults::Gradient => self.gradient(first, of, bound.option("parameter")?),
            results => {
                let what = format!("the argument of `{name}`");
                self.shaped(first, &of, Shape::Signal, &what)?;
                match results {
                    OfResults::Reduce(reduction) => {
                        self.reduced(reduction, bound.option("over"), first, of)
                    }
                    OfResults::Amplitude => self.amplitude(of, &bound),
                    OfResults::Mode => self.mode(first, of, bound.option("at")?),
                    OfResults::AtFrequency => self.at_frequency(first, of, bound.option("at")?),
                    OfResults::Filter => self.filtered(of, &bound),
                    OfResults::Last => {
                        let part = self.extent(bound.option("part")?, &of, "`part`")?;
                        Some(of.kept(|of| Expression::Last(Part::Extent(part), Box::new(of))))
                    }
                    OfResults::LastCycle => {
                        self.with_cycle(first, &of, "`last_cycle`")?;
                        let count = self.cycles(bound.option("cycles"))?.unwrap_or(1);
                        Some(of.kept(|of| Expression::Last(Part::Cycles(count), Box::new(of))))
                    }
                    OfResults::Resample => self.resampled(of, bound.option("like")?, span),
                    _ => None,
                }
            }
        }
    }

    fn amplitude(&mut self, of: Typed, bound: &Bound<'a>) -> Option<Typed> {
        let at = bound.option("at")?;
        let limit = self.limit(at, "`at`")?;
        if let Limit::Order(_) = limit {
            self.with_cycle(at, &of, "an order")?;
        }
        let window = self.window(bound, &of)?;
        let ty = Type::Scalar(of.quantity().difference());
        Some(of.mapped(ty, |of| Expression::Amplitude(limit, window, Box::new(of))))
    }

    fn mode(&mut self, first: &Expr, of: Typed, at: &'a Expr) -> Option<Typed> {
        let Type::Signal {
            rows: SignalRows::Modes(_),
            ..
        } = of.ty
        else {
            self.diagnose(
                Diagnostic::error(
                    codes::REPORT_SHAPE,
                    "`mode` takes a column of a `linear` analysis",
                )
                .at(first.span, "samples of a run, not modes"),
            );
            return None;
        };
        let chosen = self.chosen_mode(at)?;
        let ty = of.ty.row();
        Some(of.mapped(ty, |of| Expression::Mode(chosen, Box::new(of))))
    }

    fn at_frequency(&mut self, first: &Expr, of: Typed, at: &'a Expr) -> Option<Typed> {
        let Type::Signal {
            rows: SignalRows::Frequencies(_),
            ..
        } = of.ty
        else {
            self.diagnose(
                Diagnostic::error(
                    codes::REPORT_SHAPE,
                    "`at_frequency` takes a column of a `response` analysis",
                )
                .at(first.span, "no response")
                .with_help("for a part of a motion there is `amplitude(x, 160 Hz)`"),
            );
            return None;
        };
        let quantity = Quantity::hard(Dimension::ONE.over(Dimension::TIME));
        let frequency = self.constant(at, &quantity, "`at`")?;
        if !(frequency > 0.0 && frequency.is_finite()) {
            self.refuse(at, "`at`", "above zero")?;
        }
        let ty = of.ty.row();
        Some(of.mapped(ty, |of| Expression::AtFrequency(frequency, Box::new(of))))
    }

    fn filtered(&mut self, of: Typed, bound: &Bound<'a>) -> Option<Typed> {
        let filter = self.filter(bound, &of)?;
        let mut ty = of.ty.clone();
        if let (Some(_), Type::Signal { quantity, .. }) = (filter.from, &mut ty) {
            // without its mean a signal has no zero, so its unit is that of a difference
            *quantity = quantity.difference();
        }
        Some(of.mapped(ty, |of| Expression::Filter(filter, Box::new(of))))
    }

    fn resampled(&mut self, of: Typed, other: &'a Expr, span: Span) -> Option<Typed> {
        let like = self.expression(other)?;
        self.shaped(other, &like, Shape::Signal, "`like`")?;
        self.checker.of_samples(other, &like.ty, "resample")?;
        let (ty, display) = (of.ty.clone(), of.display.clone());
        // pair the members like the sides of an operator, then replace the operator
        let mut made = self.paired(Operator::Multiply, span, of.clone(), like, ty)?;
        for (at, member) in made.members.iter_mut().enumerate() {
            let inner = std::mem::replace(&mut member.expression, Expression::Number(0.0));
            if let Expression::Binary(_, signal, like) = inner {
                member.expression = Expression::Resample(signal, like);
            }
            let at = if of.list { at } else { 0 };
            if let Some(own) = of.members.get(at) {
                member.analysis.clone_from(&own.analysis);
                member.channel.clone_from(&own.channel);
            }
        }
        made.display = display;
        Some(made)
    }

    fn decibel(&mut self, first: &Expr, of: Typed, reference: &'a Expr) -> Option<Typed> {
        if of.shape() == Shape::Truth {
            self.shaped(first, &of, Shape::Number, "the argument of `decibel`")?;
        }
        let over = self.reference(reference, &of)?;
        let text = self.checker.sources.text(reference.span).to_owned();
        let ty = match &of.ty {
            Type::Signal { rows, .. } => Type::one().in_rows(rows),
            _ => Type::one(),
        };
        let mut made = of.mapped(ty, |of| Expression::Decibel(over, Box::new(of)));
        made.display = None;
        made.level = Some(text);
        Some(made)
    }

    fn no_function(&mut self, name: &str, place: Span) {
        if eng_system::figure::kind(name).is_some() {
            self.diagnose(
                Diagnostic::error(
                    codes::REPORT_SHAPE,
                    format!("`{name}` draws a figure, and gives no value"),
                )
                .at(place, "a signal or number is expected")
                .with_help(format!("write `figure name = {name}(…)`")),
            );
            return;
        }
        let known = || functions::of_reports().map(|function| function.name);
        let message = Diagnostic::error(
            codes::UNKNOWN_NAME,
            format!("reports have no function `{name}`"),
        )
        .at(place, "not known");
        let message = match nearest(name, known()) {
            Some(near) => message.meant(place, near),
            None => message.with_note(format!("they have {}", listing(known(), 30))),
        };
        self.diagnose(message);
    }

    /// A function of each number.
    fn each(
        &mut self,
        function: &BuiltIn,
        each: Function,
        expr: &Expr,
        of: Typed,
    ) -> Option<Typed> {
        if of.shape() == Shape::Truth {
            let what = format!("the argument of `{}`", function.name);
            self.shaped(expr, &of, Shape::Number, &what)?;
        }
        let ty = self.checker.applied(function, &[(expr, of.ty.clone())]);
        if ty.is_error() {
            return None;
        }
        let before = of.quantity().dim;
        let mut made = of.mapped(ty, |of| Expression::Map(each, Box::new(of)));
        if made.quantity().dim != before {
            made.display = None;
        }
        Some(made)
    }

    /// `min(a, b, …)`, row by row.
    fn extreme(
        &mut self,
        function: &BuiltIn,
        operator: Operator,
        first: &'a Expr,
        of: Typed,
        bound: &Bound<'a>,
        span: Span,
    ) -> Option<Typed> {
        let mut whole = of;
        for expr in bound.more() {
            let next = self.expression(expr)?;
            for (expr, side) in [(first, &whole), (expr, &next)] {
                if side.shape() == Shape::Truth {
                    let what = format!("an argument of `{}`", function.name);
                    self.shaped(expr, side, Shape::Number, &what)?;
                }
            }
            let sides = [(first, whole.ty.clone()), (expr, next.ty.clone())];
            let ty = self.checker.applied(function, &sides);
            if ty.is_error() {
                return None;
            }
            whole = self.paired(operator, span, whole, next, ty)?;
        }
        Some(whole)
    }

    /// The sum, the least or the largest number of a list.
    fn fold(&mut self, operator: Operator, expr: &Expr, of: Typed) -> Option<Typed> {
        if !of.list || of.shape() == Shape::Truth {
            self.diagnose(
                Diagnostic::error(
                    codes::REPORT_SHAPE,
                    "a list of numbers or signals is expected",
                )
                .at(expr.span, "one alone")
                .with_help(
                    "of a signal over its samples take `minimum`, `maximum`, `mean` or `rms`",
                ),
            );
            return None;
        }
        let quantity = of.quantity();
        if operator == Operator::Add && quantity.plus(&quantity, false).is_err() {
            let name = self.checker.quantity_name(&quantity);
            self.diagnose(
                Diagnostic::error(codes::OPERANDS, "points have differences, but no sum")
                    .at(expr.span, name),
            );
            return None;
        }
        if let (Operator::Add, Some((first, rest))) = (operator, of.members.split_first()) {
            for member in rest {
                self.of_one_frame(expr.span, &first.expression, &member.expression)?;
            }
        }
        let analysis = of.members.first()?.analysis.clone();
        let text = self.checker.sources.text(expr.span).to_owned();
        let members = of.members.into_iter().map(|m| m.expression).collect();
        Some(Typed {
            members: vec![Member {
                analysis,
                channel: text,
                expression: Expression::Fold(operator, members),
            }],
            list: false,
            level: None,
            ..of
        })
    }

    /// The length of a recorded vector.
    fn length(&mut self, expr: &'a Expr, floor: Option<&Expr>) -> Option<Typed> {
        if let Some(floor) = floor {
            self.diagnose(
                Diagnostic::error(
                    codes::UNKNOWN_ARGUMENT,
                    "`norm` of a recorded vector has no parameter `floor`",
                )
                .at(floor.span, "it is of equations alone"),
            );
            return None;
        }
        if !matches!(
            expr.kind,
            ExprKind::Name(_) | ExprKind::Field { .. } | ExprKind::Index { .. }
        ) || self.is_constant(expr)
        {
            self.diagnose(
                Diagnostic::error(
                    codes::REPORT_SHAPE,
                    "`norm` of a report takes a recorded vector",
                )
                .at(expr.span, "such as `run.main[1].force`"),
            );
            return None;
        }
        let places = self.places(expr)?;
        let mut members = Vec::new();
        let mut first = None;
        for place in &places.found {
            self.samples_at(expr, place, "norm")?;
            let mut sum: Option<Expression> = None;
            for axis in ["x", "y", "z"] {
                let Some(column) = place.column(&format!(".{axis}")) else {
                    continue;
                };
                first.get_or_insert_with(|| column.clone());
                let channel = place.channel(&column.path);
                let square = Expression::Binary(
                    Operator::Multiply,
                    Box::new(channel.clone()),
                    Box::new(channel),
                );
                sum = Some(match sum {
                    None => square,
                    Some(sum) => Expression::Binary(Operator::Add, Box::new(sum), Box::new(square)),
                });
            }
            let Some(sum) = sum else {
                self.diagnose(no_vector(place, expr.span));
                return None;
            };
            members.push(place.member(Expression::Map(Function::Sqrt, Box::new(sum))));
        }
        Some(Typed::signals(
            members,
            places.list,
            &first?,
            SignalRows::Samples,
        ))
    }

    /// A number of a signal.
    fn reduced(
        &mut self,
        reduction: Reduction,
        over: Option<&'a Expr>,
        expr: &'a Expr,
        of: Typed,
    ) -> Option<Typed> {
        let placed = matches!(reduction, Reduction::MinimumAt(_) | Reduction::MaximumAt(_));
        let of_response = matches!(
            of.ty,
            Type::Signal {
                rows: SignalRows::Frequencies(_),
                ..
            }
        );
        let by_time = match self.word(over, "`over`", &super::settings::OVER)? {
            // its rows are over frequency alone
            _ if of_response => true,
            Some(time) => {
                if !time {
                    self.with_cycle(over.unwrap_or(expr), &of, "a crank angle")?;
                }
                time
            }
            None => placed && !self.has_cycle(&of)?,
        };
        let (quantity, level) = (of.quantity(), of.level.clone());
        let place = match of_response {
            true => Quantity::hard(Dimension::ONE.over(Dimension::TIME)),
            false => place_of(by_time),
        };
        let (reduction, quantity) = match reduction {
            Reduction::MinimumAt(_) => (Reduction::MinimumAt(by_time), place),
            Reduction::MaximumAt(_) => (Reduction::MaximumAt(by_time), place),
            Reduction::PeakToPeak => (reduction, quantity.difference()),
            Reduction::RootMeanSquare => {
                let kind = Default::default();
                (reduction, Quantity { kind, ..quantity })
            }
            Reduction::Minimum | Reduction::Maximum | Reduction::Mean => (reduction, quantity),
        };
        let mut made = of.mapped(Type::Scalar(quantity), |of| {
            Expression::Reduce(reduction, Box::new(of))
        });
        if placed {
            let unit = match (of_response, by_time) {
                (true, _) => Some("Hz"),
                (false, true) => None,
                (false, false) => Some("deg"),
            };
            let unit = unit.and_then(|unit| self.checker.program.units.get(unit));
            made.display = unit.cloned().map(Into::into);
        }
        // the largest of levels is a level
        if matches!(
            reduction,
            Reduction::Minimum | Reduction::Maximum | Reduction::Mean
        ) {
            made.level = level;
        }
        Some(made)
    }

    /// A mode by its number, or by a frequency that it is near.
    fn chosen_mode(&mut self, expr: &'a Expr) -> Option<Chosen> {
        match self.limit(expr, "`at`")? {
            Limit::Frequency(frequency) => Some(Chosen::Near(frequency)),
            Limit::Order(number) => {
                // a choice far above the modes of any model
                if !(1.0..=1e6).contains(&number) || number.fract() != 0.0 {
                    self.refuse(expr, "the number of a mode", "a whole number from 1 on")?;
                }
                Some(Chosen::Number(number as u32))
            }
        }
    }

    fn filter(&mut self, bound: &Bound<'a>, of: &Typed) -> Option<Filter> {
        let (from, to) = (bound.option("from"), bound.option("to"));
        let mut limits = [None, None];
        for (limit, (expr, what)) in limits
            .iter_mut()
            .zip([(from, "the lower limit"), (to, "the upper limit")])
        {
            if let Some(expr) = expr {
                let found = self.limit(expr, what)?;
                if let Limit::Order(_) = found {
                    self.with_cycle(expr, of, "a limit that is an order")?;
                }
                *limit = Some(found);
            }
        }
        let [low, high] = limits;
        match (low, high, to) {
            (Some(Limit::Frequency(low)), Some(Limit::Frequency(high)), Some(expr))
            | (Some(Limit::Order(low)), Some(Limit::Order(high)), Some(expr))
                if low >= high =>
            {
                self.refuse(expr, "the upper limit", "above the lower one")?;
            }
            (Some(Limit::Frequency(_)), Some(Limit::Frequency(_)), _)
            | (Some(Limit::Order(_)), Some(Limit::Order(_)), _) => {}
            (Some(_), Some(_), Some(expr)) => {
                self.diagnose(
                    Diagnostic::error(
                        codes::OPERANDS,
                        "one limit is a frequency, the other an order",
                    )
                    .at(expr.span, "give both in Hz, or both as orders"),
                );
                return None;
            }
            _ => {}
        }
        let butterworth = match bound.option("butterworth") {
            Some(expr) => {
                let value = self.constant(expr, &Quantity::one(), "`butterworth`")?;
                // a choice: higher orders ring and lose their digits
                if !(1.0..=32.0).contains(&value) || value.fract() != 0.0 {
                    self.refuse(
                        expr,
                        "`butterworth`, the order of the filter,",
                        "a whole number from 1 to 32",
                    )?;
                }
                Some(value as u32)
            }
            None => None,
        };
        Some(Filter {
            from: low,
            to: high,
            butterworth,
        })
    }

    /// A count of cycles, if it is stated.
    pub(super) fn cycles(&mut self, expr: Option<&'a Expr>) -> Option<Option<u32>> {
        let Some(expr) = expr else {
            return Some(None);
        };
        self.count(expr, "`cycles`").map(Some)
    }

    /// A whole number from 1 to a million.
    pub(super) fn count(&mut self, expr: &'a Expr, what: &str) -> Option<u32> {
        let value = self.constant(expr, &Quantity::one(), what)?;
        if !(1.0..=1e6).contains(&value) || value.fract() != 0.0 {
            self.refuse(expr, what, "a whole number from 1 on")?;
        }
        Some(value as u32)
    }
}

/// The quantity of a place in a run: a time or an angle of the cycle.
fn place_of(by_time: bool) -> Quantity {
    Quantity::hard(match by_time {
        true => Dimension::TIME,
        false => Dimension::ANGLE,
    })
}
