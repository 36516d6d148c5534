//! Functions of signals and numbers.

use super::Reporter;
use super::arguments::Form;
use super::picture;
use super::value::{Member, Shape, Typed};
use crate::check::types::{Quantity, Type};
use crate::codes;
use crate::resolve::suggest::nearest;
use eng_grammar::ast::{Argument, Expr, ExprKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;
use eng_system::report::{Chosen, Expression, Filter, Function, Limit, Operator, Part, Reduction};

/// Functions that the language has outside of reports too.
static PLAIN: [Form; 11] = [
    Form::new("abs", &["x"], &[]),
    Form::new("sqrt", &["x"], &[]),
    Form::new("sin", &["x"], &[]),
    Form::new("cos", &["x"], &[]),
    Form::new("tan", &["x"], &[]),
    Form::new("exp", &["x"], &[]),
    Form::new("log", &["x"], &[]),
    Form::new("norm", &["v"], &[]),
    Form::of_many("min", &["x"], &[]),
    Form::of_many("max", &["x"], &[]),
    Form::new("sum", &["x"], &[]),
];

/// Functions of signals.
static SIGNALS: [Form; 16] = [
    Form::new("minimum", &["signal"], &[]),
    Form::new("maximum", &["signal"], &[]),
    Form::new("minimum_at", &["signal"], &["over"]),
    Form::new("maximum_at", &["signal"], &["over"]),
    Form::new("mean", &["signal"], &[]),
    Form::new("rms", &["signal"], &[]),
    Form::new("peak_to_peak", &["signal"], &[]),
    Form::new("amplitude", &["signal", "at"], &["window"]),
    Form::new("mode", &["column", "at"], &[]),
    Form::new("low_pass", &["signal", "to"], &["butterworth"]),
    Form::new("high_pass", &["signal", "from"], &["butterworth"]),
    Form::new("band", &["signal", "from", "to"], &["butterworth"]),
    Form::new("last", &["signal", "part"], &[]),
    Form::new("last_cycle", &["signal"], &["cycles"]),
    Form::new("resample", &["signal", "like"], &[]),
    Form::new("decibel", &["x", "reference"], &[]),
];

/// Whether a name is a function that only reports have.
pub(super) fn is_of_signals(name: &str) -> bool {
    SIGNALS.iter().any(|form| form.name == name) || picture::form(name).is_some()
}

/// Functions that take the modes of a linear analysis, too.
const OF_MODES: [&str; 15] = [
    "abs",
    "sqrt",
    "sin",
    "cos",
    "tan",
    "exp",
    "log",
    "min",
    "max",
    "sum",
    "decibel",
    "minimum",
    "maximum",
    "peak_to_peak",
    "mode",
];

impl<'a> Reporter<'a, '_> {
    /// A call; `None` where a message was given.
    pub(super) fn call(
        &mut self,
        span: Span,
        name: &'a str,
        place: Span,
        arguments: &'a [Argument],
    ) -> Option<Typed> {
        let Some(form) = PLAIN.iter().chain(&SIGNALS).find(|f| f.name == name) else {
            self.no_function(name, place);
            return None;
        };
        let taken = self.taken(form, arguments, span)?;
        let first = taken.option(form.required.first()?)?;
        if name == "norm" {
            return self.magnitude(first);
        }
        let of = self.expression(first)?;
        if !OF_MODES.contains(&name) {
            self.of_samples(first, &of, name)?;
        }
        match name {
            "abs" | "sqrt" | "sin" | "cos" | "tan" | "exp" | "log" => self.mapped(name, first, of),
            "min" | "max" => self.extreme(name, first, of, &taken.more, span),
            "sum" => self.fold(Operator::Add, first, of),
            "amplitude" => {
                self.shaped(first, &of, Shape::Signal, "the argument of `amplitude`")?;
                let at = taken.option("at")?;
                let limit = self.limit(at, "`at`")?;
                if let Limit::Order(_) = limit {
                    self.with_cycle(at, &of, "an order")?;
                }
                let window = self.window(&taken, &of)?;
                let mut made = of.mapped(|e| Expression::Amplitude(limit, window, Box::new(e)));
                made.shape = Shape::Number;
                made.quantity = difference(&made.quantity);
                Some(made)
            }
            "mode" => {
                self.shaped(first, &of, Shape::Signal, "the argument of `mode`")?;
                if self.linear(&of).is_none() {
                    self.tell(
                        Diagnostic::error(
                            codes::REPORT_SHAPE,
                            "`mode` takes a column of a `linear` analysis",
                        )
                        .at(first.span, "samples of a run, not modes"),
                    );
                    return None;
                }
                let chosen = self.chosen_mode(taken.option("at")?)?;
                let mut made = of.mapped(|e| Expression::Mode(chosen, Box::new(e)));
                made.shape = Shape::Number;
                Some(made)
            }
            "low_pass" | "high_pass" | "band" => {
                self.shaped(
                    first,
                    &of,
                    Shape::Signal,
                    &format!("the argument of `{name}`"),
                )?;
                let (from, to) = (taken.option("from"), taken.option("to"));
                let poles = taken.option("butterworth");
                let filter = self.filter(from, to, poles, &of)?;
                let mut made = of.mapped(|e| Expression::Filter(filter, Box::new(e)));
                if filter.from.is_some() {
                    // the mean is gone, and with it the zero
                    made.quantity = difference(&made.quantity);
                }
                Some(made)
            }
            "last" => {
                self.shaped(first, &of, Shape::Signal, "the argument of `last`")?;
                let part = taken.option("part")?;
                let part = Part::Extent(self.extent(part, &of, "`part`")?);
                Some(of.mapped(|e| Expression::Last(part, Box::new(e))))
            }
            "last_cycle" => {
                self.shaped(first, &of, Shape::Signal, "the argument of `last_cycle`")?;
                self.with_cycle(first, &of, "`last_cycle`")?;
                let part = Part::Cycles(self.cycles(taken.option("cycles"))?.unwrap_or(1));
                Some(of.mapped(|e| Expression::Last(part, Box::new(e))))
            }
            "resample" => {
                let other = taken.option("like")?;
                let like = self.expression(other)?;
                self.shaped(first, &of, Shape::Signal, "what is resampled")?;
                self.shaped(other, &like, Shape::Signal, "`like`")?;
                self.of_samples(other, &like, "resample")?;
                let (quantity, display) = (of.quantity.clone(), of.display.clone());
                // paired as an operator's sides are, then given its own form
                let mut made = self.paired(
                    Operator::Add,
                    span,
                    of.clone(),
                    like,
                    Shape::Signal,
                    quantity,
                )?;
                for (at, member) in made.members.iter_mut().enumerate() {
                    let inner = std::mem::replace(&mut member.expression, Expression::Number(0.0));
                    if let Expression::Binary(_, signal, like) = inner {
                        member.expression = Expression::Resample(signal, like);
                    }
                    let at = if of.list { at } else { 0 };
                    if let Some(own) = of.members.get(at) {
                        member.label = own.label.clone();
                    }
                }
                made.display = display;
                Some(made)
            }
            "decibel" => {
                if of.shape == Shape::Truth {
                    self.shaped(first, &of, Shape::Number, "what is told in decibels")?;
                }
                let expr = taken.option("reference")?;
                let reference = self.reference(expr, &of)?;
                let text = self.checker.sources.text(expr.span).to_owned();
                let mut made = of.mapped(|e| Expression::Decibel(reference, Box::new(e)));
                made.quantity = Quantity::one();
                made.display = None;
                made.level = Some(text);
                Some(made)
            }
            _ => {
                self.shaped(
                    first,
                    &of,
                    Shape::Signal,
                    &format!("the argument of `{name}`"),
                )?;
                self.reduced(name, taken.option("over"), first, of)
            }
        }
    }

    fn no_function(&mut self, name: &str, place: Span) {
        if picture::form(name).is_some() {
            self.tell(
                Diagnostic::error(
                    codes::REPORT_SHAPE,
                    format!("`{name}` draws a figure, and gives no value"),
                )
                .at(place, "a signal or number is due")
                .with_help(format!("write `figure name = {name}(…)`")),
            );
            return;
        }
        let known = || PLAIN.iter().chain(&SIGNALS).map(|form| form.name);
        let message = Diagnostic::error(
            codes::UNKNOWN_NAME,
            format!("reports have no function `{name}`"),
        )
        .at(place, "not known");
        let message = match nearest(name, known()) {
            Some(near) => message.meant(place, near),
            None => message.with_note(format!(
                "they have {}",
                crate::resolve::suggest::listing(known(), 30)
            )),
        };
        self.tell(message);
    }

    /// A function of each sample or number.
    fn mapped(&mut self, name: &str, expr: &Expr, of: Typed) -> Option<Typed> {
        if of.shape == Shape::Truth {
            self.shaped(
                expr,
                &of,
                Shape::Number,
                &format!("the argument of `{name}`"),
            )?;
        }
        let argument = (expr, Type::Scalar(of.quantity.clone()));
        let one = Quantity::one();
        let (function, ty) = match name {
            "abs" => (Function::Abs, self.checker.magnitude(&argument)),
            "sqrt" => (Function::Sqrt, self.checker.root(&argument)),
            "exp" => {
                let ty = self.checker.plain_argument(name, &argument, false, one);
                (Function::Exp, ty)
            }
            "log" => {
                let ty = self.checker.plain_argument(name, &argument, false, one);
                (Function::Log, ty)
            }
            _ => {
                let ty = self.checker.plain_argument(name, &argument, true, one);
                let function = match name {
                    "sin" => Function::Sin,
                    "cos" => Function::Cos,
                    _ => Function::Tan,
                };
                (function, ty)
            }
        };
        let quantity = ty.quantity()?;
        let keeps = quantity.dim == of.quantity.dim;
        let mut made = of.mapped(|e| Expression::Map(function, Box::new(e)));
        made.quantity = quantity;
        if !keeps {
            made.display = None;
        }
        Some(made)
    }

    /// `min(list)`, or `min(a, b, …)` sample by sample.
    fn extreme(
        &mut self,
        name: &str,
        first: &'a Expr,
        of: Typed,
        more: &[&'a Expr],
        span: Span,
    ) -> Option<Typed> {
        let operator = if name == "min" {
            Operator::Minimum
        } else {
            Operator::Maximum
        };
        if more.is_empty() {
            return self.fold(operator, first, of);
        }
        let mut whole = of;
        for expr in more {
            let next = self.expression(expr)?;
            let joined = self.checker.join(
                (&Type::Scalar(whole.quantity.clone()), first.span),
                (&Type::Scalar(next.quantity.clone()), expr.span),
                &format!("the arguments of `{name}`"),
            );
            let quantity = joined.quantity()?;
            let shape = match (whole.shape, next.shape) {
                (Shape::Truth, _) | (_, Shape::Truth) => {
                    let (expr, odd) = if whole.shape == Shape::Truth {
                        (first, &whole)
                    } else {
                        (*expr, &next)
                    };
                    self.shaped(
                        expr,
                        odd,
                        Shape::Number,
                        &format!("an argument of `{name}`"),
                    )?;
                    return None;
                }
                (Shape::Number, Shape::Number) => Shape::Number,
                _ => Shape::Signal,
            };
            whole = self.paired(operator, span, whole, next, shape, quantity)?;
        }
        Some(whole)
    }

    /// One number of a list's.
    fn fold(&mut self, operator: Operator, expr: &Expr, of: Typed) -> Option<Typed> {
        if !of.list || of.shape == Shape::Truth {
            self.tell(
                Diagnostic::error(codes::REPORT_SHAPE, "a list of numbers or signals is due")
                    .at(expr.span, "one alone")
                    .with_help(
                        "of a signal over its samples take `minimum`, `maximum`, `mean` or `rms`",
                    ),
            );
            return None;
        }
        if operator == Operator::Add && of.quantity.plus(&of.quantity, false).is_err() {
            self.tell(
                Diagnostic::error(codes::OPERANDS, "points have differences, but no sum")
                    .at(expr.span, self.checker.quantity_name(&of.quantity)),
            );
            return None;
        }
        if let (Operator::Add, Some((first, rest))) = (operator, of.members.split_first()) {
            for member in rest {
                self.of_one_frame(expr.span, &first.expression, &member.expression)?;
            }
        }
        let analysis = of.members.first()?.label.analysis.clone();
        let text = self.checker.sources.text(expr.span).to_owned();
        let members = of.members.into_iter().map(|m| m.expression).collect();
        Some(Typed {
            members: vec![Member {
                label: super::value::Label {
                    analysis,
                    channel: text,
                },
                expression: Expression::Fold(operator, members),
            }],
            list: false,
            level: None,
            ..of
        })
    }

    /// The size of a recorded vector.
    fn magnitude(&mut self, expr: &'a Expr) -> Option<Typed> {
        if !matches!(
            expr.kind,
            ExprKind::Name(_) | ExprKind::Field { .. } | ExprKind::Index { .. }
        ) || self.is_constant(expr)
        {
            self.tell(
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
                let path = column.path.clone();
                first.get_or_insert_with(|| column.clone());
                let channel = Expression::Channel {
                    analysis: place.plan.analysis.origin.path.clone(),
                    path,
                };
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
                self.tell(
                    Diagnostic::error(
                        codes::REPORT_SHAPE,
                        format!("`{}` is no vector", place.path),
                    )
                    .at(expr.span, "it has no x and y"),
                );
                return None;
            };
            members.push(Member {
                label: places.label(place),
                expression: Expression::Map(Function::Sqrt, Box::new(sum)),
            });
        }
        Some(Typed::signals(members, places.list, &first?))
    }

    /// A number of a signal.
    fn reduced(
        &mut self,
        name: &str,
        over: Option<&'a Expr>,
        expr: &'a Expr,
        of: Typed,
    ) -> Option<Typed> {
        let by_time = match self.word(over, "`over`", &super::settings::OVER)? {
            Some(time) => {
                if !time {
                    self.with_cycle(over.unwrap_or(expr), &of, "a crank angle")?;
                }
                time
            }
            None => name.ends_with("_at") && !self.has_cycle(&of)?,
        };
        let reduction = match name {
            "minimum" => Reduction::Minimum,
            "maximum" => Reduction::Maximum,
            "mean" => Reduction::Mean,
            "rms" => Reduction::RootMeanSquare,
            "peak_to_peak" => Reduction::PeakToPeak,
            "minimum_at" => Reduction::MinimumAt(by_time),
            _ => Reduction::MaximumAt(by_time),
        };
        let level = of.level.clone();
        let mut made = of.mapped(|e| Expression::Reduce(reduction, Box::new(e)));
        made.shape = Shape::Number;
        match reduction {
            Reduction::MinimumAt(time) | Reduction::MaximumAt(time) => {
                let dimension = if time {
                    Dimension::TIME
                } else {
                    Dimension::ANGLE
                };
                made.quantity = Quantity::hard(dimension);
                made.display = None;
                if !time {
                    let degree = self.checker.program.units.get("deg");
                    made.display = degree.map(|unit| eng_system::DisplayUnit {
                        symbol: unit.symbol.clone(),
                        scale: unit.scale,
                        offset: unit.offset,
                    });
                }
            }
            Reduction::PeakToPeak => made.quantity = difference(&made.quantity),
            Reduction::RootMeanSquare => made.quantity.kind = Default::default(),
            // the largest of levels is a level
            _ => made.level = level,
        }
        Some(made)
    }

    /// A mode by its number, or by a frequency that it is near.
    fn chosen_mode(&mut self, expr: &'a Expr) -> Option<Chosen> {
        match self.limit(expr, "`at`")? {
            Limit::Frequency(frequency) => Some(Chosen::Near(frequency)),
            Limit::Order(number) => {
                if !(1.0..=1e6).contains(&number) || number.fract() != 0.0 {
                    self.refuse(expr, "the number of a mode", "a whole number from 1 on")?;
                }
                Some(Chosen::Number(number as u32))
            }
        }
    }

    fn filter(
        &mut self,
        from: Option<&'a Expr>,
        to: Option<&'a Expr>,
        poles: Option<&'a Expr>,
        of: &Typed,
    ) -> Option<Filter> {
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
                self.tell(
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
        let butterworth = match poles {
            Some(expr) => {
                let value = self.constant(expr, &Quantity::one(), "`butterworth`")?;
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
        let value = self.constant(expr, &Quantity::one(), "`cycles`")?;
        if !(1.0..=1e6).contains(&value) || value.fract() != 0.0 {
            self.refuse(expr, "`cycles`", "a whole number from 1 on")?;
        }
        Some(Some(value as u32))
    }
}

/// What the difference of two such quantities is.
pub(super) fn difference(quantity: &Quantity) -> Quantity {
    quantity
        .plus(quantity, true)
        .unwrap_or_else(|_| quantity.clone())
}
