//! Figures.

use super::Reporter;
use super::channel::{Found, Places, are_modes, begins, not_one};
use super::settings::OVER;
use super::value::Typed;
use crate::check::bound::Bound;
use crate::check::mismatch::Due;
use crate::check::signal::Shape;
use crate::check::types::{Quantity, Rows, Type};
use crate::codes;
use crate::functions::{self, BuiltIn, Drawing, OfResults};
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{Expr, ExprKind, UnitExpr};
use eng_grammar::{Diagnostic, Span};
use eng_system::recorded::Recorded;
use eng_system::report::{Expression, Figure, Function, Member, Picture, Vector};
use eng_system::{Dimension, DisplayUnit};

/// The functions that draw, each with its figure.
fn drawings() -> impl Iterator<Item = (&'static BuiltIn, Drawing)> {
    functions::of_reports().filter_map(|function| match function.results {
        OfResults::Draw(drawing) => Some((function, drawing)),
        _ => None,
    })
}

impl<'a> Reporter<'a, '_> {
    /// A figure; `None` where a message was given.
    pub(super) fn figure(&mut self, expr: &'a Expr, display: Option<&UnitExpr>) -> Option<Figure> {
        let ExprKind::Call { callee, arguments } = &expr.kind else {
            self.no_picture(expr.span, None);
            return None;
        };
        let name = match &callee.kind {
            ExprKind::Name(name) => name.as_str(),
            _ => "",
        };
        let Some((function, drawing)) = drawings().find(|(function, _)| function.name == name)
        else {
            self.no_picture(callee.span, Some(name));
            return None;
        };
        let bound = self.checker.bound(function, arguments, expr.span, true)?;
        let first = bound.option(function.parameters.first()?)?;
        match drawing {
            Drawing::Orbit => self.orbit(first, &bound, display),
            Drawing::Polar => self.polar(first, &bound, display),
            Drawing::History => self.history(first, &bound, display),
            Drawing::OrderTrack => self.order_track(first, &bound, display),
            Drawing::Spectrum | Drawing::Waterfall | Drawing::Campbell => {
                self.spectral(drawing, name, first, &bound, display)
            }
        }
    }

    fn no_picture(&mut self, span: Span, name: Option<&str>) {
        let known = || drawings().map(|(function, _)| function.name);
        let message = Diagnostic::error(
            codes::REPORT_SHAPE,
            "a figure is drawn by one of the functions that draw",
        )
        .at(span, "draws nothing");
        let message = match name.and_then(|name| nearest(name, known())) {
            Some(near) => message.meant(span, near),
            None => message.with_note(format!("these are {}", listing(known(), 12))),
        };
        self.tell(message);
    }

    fn history(
        &mut self,
        first: &'a Expr,
        bound: &Bound<'a>,
        display: Option<&UnitExpr>,
    ) -> Option<Figure> {
        let mut panels: Vec<Typed> = Vec::new();
        for expr in std::iter::once(first).chain(bound.more()) {
            let panel = self.expression(expr)?;
            self.shaped(expr, &panel, Shape::Signal, "what a history shows")?;
            self.checker.of_samples(expr, &panel.ty, "history")?;
            if let Some(first) = panels.first()
                && panel.quantity().fits(&first.quantity()).is_err()
            {
                let names =
                    [first, &panel].map(|panel| self.checker.quantity_name(&panel.quantity()));
                let [a, b] = names;
                self.tell(
                    Diagnostic::error(
                        codes::LIST_ELEMENTS,
                        format!("the panels of a history share their axis: {a} and {b}"),
                    )
                    .at(expr.span, format!("this is {b}"))
                    .with_help("draw two figures"),
                );
                return None;
            }
            panels.push(panel);
        }
        let mut cycle = true;
        for panel in &panels {
            cycle &= self.has_cycle(panel)?;
        }
        let over = bound.option("over");
        let by_time = match self.word(over, "`over`", &OVER)? {
            Some(false) if !cycle => {
                let panel = panels.first()?.clone();
                self.with_cycle(over.unwrap_or(first), &panel, "a crank angle")?;
                return None;
            }
            Some(time) => time,
            None => !cycle,
        };
        let shown = self.display(panels.first()?, display, first)?;
        let quantity = panels.first().map(quantity_text).unwrap_or_default();
        Some(Figure {
            quantity,
            display: shown,
            picture: Picture::History(
                panels.into_iter().map(|panel| panel.members).collect(),
                by_time,
            ),
        })
    }

    /// The signals of a figure of amplitudes, which have no zero of their own.
    fn amplitudes(&mut self, name: &str, first: &'a Expr) -> Option<Typed> {
        let mut of = self.expression(first)?;
        self.shaped(first, &of, Shape::Signal, &format!("what `{name}` shows"))?;
        self.checker.of_samples(first, &of.ty, name)?;
        if let Type::Signal { quantity, .. } = &mut of.ty {
            *quantity = quantity.difference();
        }
        Some(of)
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
        self.tell(
            Diagnostic::error(
                codes::REPORT_RUNS,
                format!("`{name}` shows one signal of several runs"),
            )
            .at(first.span, "of one run, or several of one")
            .with_help(help),
        );
        None
    }

    fn order_track(
        &mut self,
        first: &'a Expr,
        bound: &Bound<'a>,
        display: Option<&UnitExpr>,
    ) -> Option<Figure> {
        let of = self.amplitudes("order_track", first)?;
        let display = self.display(&of, display, first)?;
        let enough = bound.option("block").is_some() || runs(&of.members) > 1;
        self.of_runs("order_track", first, &of, enough)?;
        let orders = self.orders(bound.option("orders")?)?;
        let window = self.window(bound, &of)?;
        let block = match bound.option("block") {
            Some(expr) => {
                let angle = Quantity::hard(Dimension::ANGLE);
                let angle = self.constant(expr, &angle, "`block`, an angle of the shaft,")?;
                if !(angle > 0.0 && angle.is_finite()) {
                    self.refuse(expr, "`block`", "above zero")?;
                }
                let overlap = self.overlap(bound)?;
                Some((angle / std::f64::consts::TAU, overlap))
            }
            None => None,
        };
        Some(Figure {
            quantity: quantity_text(&of),
            display,
            picture: Picture::OrderTrack {
                members: of.members,
                orders,
                window,
                block,
            },
        })
    }

    fn spectral(
        &mut self,
        drawing: Drawing,
        name: &str,
        first: &'a Expr,
        bound: &Bound<'a>,
        display: Option<&UnitExpr>,
    ) -> Option<Figure> {
        let of = self.amplitudes(name, first)?;
        let mut display = self.display(&of, display, first)?;
        let quantity = quantity_text(&of);
        if drawing != Drawing::Spectrum {
            let count = runs(&of.members);
            self.of_runs(name, first, &of, count > 1 && count == of.members.len())?;
        }
        let settings = self.spectrum_settings(bound, &of)?;
        let picture = match drawing {
            Drawing::Spectrum => Picture::Spectrum(of.members, settings),
            Drawing::Waterfall => Picture::Waterfall(of.members, settings),
            _ => {
                let orders = match bound.option("orders") {
                    Some(expr) => Some(self.orders(expr)?),
                    None => None,
                };
                let settings = self.campbell_settings(bound, settings, &of, &mut display)?;
                let modes = match bound.option("modes") {
                    Some(expr) => self.natural_modes(expr, &of)?,
                    None => Vec::new(),
                };
                Picture::Campbell {
                    members: of.members,
                    settings,
                    orders,
                    modes,
                }
            }
        };
        Some(Figure {
            quantity,
            display,
            picture,
        })
    }

    /// Linear analyses of the model that a Campbell diagram is of.
    fn natural_modes(&mut self, expr: &'a Expr, of: &Typed) -> Option<Vec<String>> {
        let help = "such as `coupled`, or of a sweep over the speed `whirl[*]`";
        let places = self.of_path(expr, "`modes` names linear analyses", help)?;
        let mut names = Vec::new();
        for place in &places.found {
            let plan = place.plan;
            let name = plan.analysis.origin.path.clone();
            if !are_modes(plan) || !place.path.is_empty() {
                self.tell(
                    Diagnostic::error(codes::REPORT_SHAPE, "`modes` names linear analyses")
                        .at(expr.span, help)
                        .with_note(if place.path.is_empty() {
                            format!("`{name}` gives samples")
                        } else {
                            "the analysis alone, none of its columns".to_owned()
                        }),
                );
                return None;
            }
            let same = |member: &Member| {
                let own = self.models.plan(&member.analysis);
                own.is_some_and(|own| own.model == plan.model)
            };
            if !of.members.iter().all(same) {
                self.tell(
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

    fn orbit(
        &mut self,
        first: &'a Expr,
        bound: &Bound<'a>,
        display: Option<&UnitExpr>,
    ) -> Option<Figure> {
        let places = self.of_path(first, "`orbit` takes journals", "such as `run.main[1..5]`")?;
        if let Some(unit) = display {
            self.tell(
                Diagnostic::error(codes::DISPLAY, "orbits are drawn in µm")
                    .at(unit.span, "another unit")
                    .with_help("leave `as` away"),
            );
            return None;
        }
        let mut journals = Vec::new();
        for place in &places.found {
            self.samples_at(first, place, "orbit")?;
            if !place.channels.journals.contains(&place.path) {
                let known = place.channels.journals.iter().map(String::as_str);
                let message = Diagnostic::error(
                    codes::REPORT_SHAPE,
                    format!("`{}` is no journal", place.path),
                )
                .at(
                    first.span,
                    "`orbit` draws the path of a pin in its clearance",
                )
                .with_note(format!("journals are {}", listing(known, 12)));
                self.tell(message);
                return None;
            }
            journals.push((place.plan.analysis.origin.path.clone(), place.path.clone()));
        }
        let cycles = self.cycles(bound.option("cycles"))?;
        Some(Figure {
            quantity: "Eccentricity".to_owned(),
            display: DisplayUnit {
                symbol: "µm".to_owned(),
                scale: 1e-6,
                offset: 0.0,
            },
            picture: Picture::Orbit(journals, cycles),
        })
    }

    fn polar(
        &mut self,
        first: &'a Expr,
        bound: &Bound<'a>,
        display: Option<&UnitExpr>,
    ) -> Option<Figure> {
        let help = "such as `run.main[1..5]` or `run.pin.force`";
        let places = self.of_path(first, "`polar` takes journals and recorded vectors", help)?;
        let turned = match bound.option("turned_by") {
            Some(expr) => Some(self.turned_by(expr, places.found.len())?),
            None => None,
        };
        let mut vectors: Vec<Vector> = Vec::new();
        let mut column = None;
        for (at, place) in places.found.iter().enumerate() {
            let (mut vector, x) = self.vector(first, place)?;
            if vectors
                .first()
                .is_some_and(|known| known.load != vector.load)
            {
                self.tell(
                    Diagnostic::error(
                        codes::LIST_ELEMENTS,
                        "loads of journals and other vectors stand in diagrams of their own",
                    )
                    .at(first.span, "both"),
                );
                return None;
            }
            vector.turned_by = turned.as_ref().and_then(|turned| {
                let at = if turned.list { at } else { 0 };
                turned.members.get(at).map(|m| m.expression.clone())
            });
            vectors.push(vector);
            column.get_or_insert(x);
        }
        let column = column?;
        let of = Typed::signals(Vec::new(), true, &column, Rows::Samples);
        let display = self.display(&of, display, first)?;
        let cycles = self.cycles(bound.option("cycles"))?;
        let quantity = if vectors.iter().any(|vector| vector.load) {
            "load".to_owned()
        } else {
            last_name(column.path.trim_end_matches(".x"))
        };
        Some(Figure {
            quantity,
            display,
            picture: Picture::Polar(vectors, cycles),
        })
    }

    /// The angles that turn the axes of a polar diagram: one for all of its vectors, or one for each.
    fn turned_by(&mut self, expr: &'a Expr, vectors: usize) -> Option<Typed> {
        let turned = self.expression(expr)?;
        self.shaped(expr, &turned, Shape::Signal, "`turned_by`")?;
        let (found, angle) = (turned.quantity(), Quantity::hard(Dimension::ANGLE));
        if let Err(misfit) = found.fits(&angle) {
            let due = Due::new("`turned_by`");
            self.checker.misfit(expr, misfit, &found, &angle, &due);
            return None;
        }
        if turned.list && turned.members.len() != vectors {
            let angles = turned.members.len();
            self.tell(
                Diagnostic::error(
                    codes::REPORT_RUNS,
                    format!("{vectors} vectors are turned by {angles} angles"),
                )
                .at(expr.span, "one angle for all, or one for each"),
            );
            return None;
        }
        Some(turned)
    }

    /// The vector at a place, or the load of a journal there, and the column of its component along x.
    fn vector(&mut self, expr: &Expr, place: &Found<'a>) -> Option<(Vector, Recorded)> {
        self.samples_at(expr, place, "polar")?;
        let load = place.channels.journals.contains(&place.path);
        let vector = if load { ".force" } else { "" };
        let axis = |axis: &str| place.column(&format!("{vector}.{axis}"));
        let (Some(x), Some(y)) = (axis("x"), axis("y")) else {
            let below = |column: &&Recorded| begins(&column.path, &place.path);
            let message = if place.columns().iter().filter(below).count() > 1 {
                not_one(place, expr.span)
            } else {
                no_vector(place, expr.span)
            };
            self.tell(message);
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

    /// The places of a path; says what is due where an expression is none.
    fn of_path(&mut self, expr: &'a Expr, title: &str, label: &str) -> Option<Places<'a>> {
        let known =
            super::channel::root_name(expr).is_some_and(|root| !self.models.named(root).is_empty());
        if known {
            return self.places(expr);
        }
        if self.is_constant(expr) {
            self.all_known(expr)?;
        }
        self.tell(Diagnostic::error(codes::REPORT_SHAPE, title).at(expr.span, label.to_owned()));
        None
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

/// How many runs there are.
fn runs(members: &[Member]) -> usize {
    let mut analyses: Vec<&str> = members.iter().map(|m| m.analysis.as_str()).collect();
    analyses.sort_unstable();
    analyses.dedup();
    analyses.len()
}

/// What an axis shows: the last name of the first channel.
fn quantity_text(of: &Typed) -> String {
    let first = of.members.first();
    last_name(first.map_or("", |member| &member.channel))
}

/// `shell acceleration` of `shell_acceleration[5]`, `force x` of `main[5].force.x`.
fn last_name(path: &str) -> String {
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
