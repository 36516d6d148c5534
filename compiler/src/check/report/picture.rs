//! Figures.

use super::Reporter;
use super::arguments::{Form, Taken};
use super::channel::{are_modes, begins, not_one};
use super::function::difference;
use super::settings::{CAMPBELL, OVER, SPECTRUM};
use super::value::{Label, Member, Shape, Typed};
use crate::check::types::Quantity;
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{Expr, ExprKind, UnitExpr};
use eng_grammar::{Diagnostic, Span};
use eng_system::report::{self as plan, Expression, Figure, Function, Picture, Vector};
use eng_system::{Dimension, DisplayUnit};

static PICTURES: [Form; 7] = [
    Form::of_many("history", &["signals"], &["over"]),
    Form::new("spectrum", &["signals"], &SPECTRUM),
    Form::new("orbit", &["journals"], &["cycles"]),
    Form::new("polar", &["vectors"], &["turned_by", "cycles"]),
    Form::new(
        "order_track",
        &["signals", "orders"],
        &["window", "block", "overlap"],
    ),
    Form::new("waterfall", &["signals"], &SPECTRUM),
    Form::new("campbell", &["signals"], &CAMPBELL),
];

/// The form of a function that draws.
pub(super) fn form(name: &str) -> Option<&'static Form> {
    PICTURES.iter().find(|form| form.name == name)
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
        let Some(form) = form(name) else {
            self.no_picture(callee.span, Some(name));
            return None;
        };
        let taken = self.taken(form, arguments, expr.span)?;
        let first = taken.option(form.required.first()?)?;
        match name {
            "orbit" => self.orbit(first, &taken, display),
            "polar" => self.polar(first, &taken, display),
            "history" => self.history(first, &taken, display),
            _ => self.spectral(name, first, &taken, display),
        }
    }

    fn no_picture(&mut self, span: Span, name: Option<&str>) {
        let known = || PICTURES.iter().map(|form| form.name);
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
        taken: &Taken<'a>,
        display: Option<&UnitExpr>,
    ) -> Option<Figure> {
        let mut panels: Vec<Typed> = Vec::new();
        for expr in std::iter::once(&first).chain(&taken.more) {
            let panel = self.expression(expr)?;
            self.shaped(expr, &panel, Shape::Signal, "what a history shows")?;
            self.of_samples(expr, &panel, "history")?;
            if let Some(first) = panels.first()
                && panel.quantity.fits(&first.quantity).is_err()
            {
                let (a, b) = (
                    self.checker.quantity_name(&first.quantity),
                    self.checker.quantity_name(&panel.quantity),
                );
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
        let over = taken.option("over");
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
                panels
                    .into_iter()
                    .map(|panel| planned(panel.members))
                    .collect(),
                by_time,
            ),
        })
    }

    fn spectral(
        &mut self,
        name: &str,
        first: &'a Expr,
        taken: &Taken<'a>,
        display: Option<&UnitExpr>,
    ) -> Option<Figure> {
        let mut of = self.expression(first)?;
        self.shaped(first, &of, Shape::Signal, &format!("what `{name}` shows"))?;
        self.of_samples(first, &of, name)?;
        // an amplitude has no zero of its own
        of.quantity = difference(&of.quantity);
        let mut shown = self.display(&of, display, first)?;
        let quantity = quantity_text(&of);
        let enough = match name {
            "spectrum" => true,
            "order_track" => taken.option("block").is_some() || runs(&of.members) > 1,
            _ => runs(&of.members) > 1 && runs(&of.members) == of.members.len(),
        };
        if !enough {
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
            return None;
        }
        if name != "spectrum" {
            // it is over the speed of the cycle
            self.with_cycle(first, &of, &format!("`{name}`"))?;
        }
        if name == "order_track" {
            let orders = self.orders(taken.option("orders")?)?;
            let window = self.window(taken, &of)?;
            let block = match taken.option("block") {
                Some(expr) => {
                    let angle = Quantity::hard(Dimension::ANGLE);
                    let angle = self.constant(expr, &angle, "`block`, an angle of the shaft,")?;
                    if !(angle > 0.0 && angle.is_finite()) {
                        self.refuse(expr, "`block`", "above zero")?;
                    }
                    let overlap = self.overlap(taken)?;
                    Some((angle / std::f64::consts::TAU, overlap))
                }
                None => None,
            };
            return Some(Figure {
                quantity,
                display: shown,
                picture: Picture::OrderTrack {
                    members: planned(of.members),
                    orders,
                    window,
                    block,
                },
            });
        }
        let settings = self.spectrum_settings(taken, &of)?;
        let picture = match name {
            "spectrum" => Picture::Spectrum(planned(of.members), settings),
            "waterfall" => Picture::Waterfall(planned(of.members), settings),
            _ => {
                let orders = match taken.option("orders") {
                    Some(expr) => Some(self.orders(expr)?),
                    None => None,
                };
                let settings = self.campbell_settings(taken, settings, &of, &mut shown)?;
                let modes = match taken.option("modes") {
                    Some(expr) => self.natural_modes(expr, &of)?,
                    None => Vec::new(),
                };
                Picture::Campbell {
                    members: planned(of.members),
                    settings,
                    orders,
                    modes,
                }
            }
        };
        Some(Figure {
            quantity,
            display: shown,
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
                let own = self.models.plan(&member.label.analysis);
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
        taken: &Taken<'a>,
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
        let cycles = self.cycles(taken.option("cycles"))?;
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
        taken: &Taken<'a>,
        display: Option<&UnitExpr>,
    ) -> Option<Figure> {
        let help = "such as `run.main[1..5]` or `run.pin.force`";
        let places = self.of_path(first, "`polar` takes journals and recorded vectors", help)?;
        let turned = match taken.option("turned_by") {
            Some(expr) => {
                let turned = self.expression(expr)?;
                self.shaped(expr, &turned, Shape::Signal, "`turned_by`")?;
                let angle = Quantity::hard(Dimension::ANGLE);
                if let Err(misfit) = turned.quantity.fits(&angle) {
                    let due = crate::check::mismatch::Due::new("`turned_by`");
                    self.checker
                        .misfit(expr, misfit, &turned.quantity, &angle, &due);
                    return None;
                }
                if turned.list && turned.members.len() != places.found.len() {
                    self.tell(
                        Diagnostic::error(
                            codes::REPORT_RUNS,
                            format!(
                                "{} vectors are turned by {} angles",
                                places.found.len(),
                                turned.members.len()
                            ),
                        )
                        .at(expr.span, "one angle for all, or one for each"),
                    );
                    return None;
                }
                Some(turned)
            }
            None => None,
        };
        let mut vectors = Vec::new();
        let mut column = None;
        for (at, place) in places.found.iter().enumerate() {
            self.samples_at(first, place, "polar")?;
            let analysis = place.plan.analysis.origin.path.clone();
            let load = place.channels.journals.contains(&place.path);
            let vector = if load { ".force" } else { "" };
            let axis = |axis: &str| place.column(&format!("{vector}.{axis}"));
            let (Some(x), Some(y)) = (axis("x"), axis("y")) else {
                let several = place
                    .columns()
                    .iter()
                    .filter(|c| begins(&c.path, &place.path))
                    .count();
                let message = if several > 1 {
                    not_one(place, first.span)
                } else {
                    Diagnostic::error(
                        codes::REPORT_SHAPE,
                        format!("`{}` is no vector", place.path),
                    )
                    .at(first.span, "it has no x and y")
                };
                self.tell(message);
                return None;
            };
            let component = |path: &str| {
                let channel = Expression::Channel {
                    analysis: analysis.clone(),
                    path: path.to_owned(),
                };
                // what the pin gives the shell is against what it gets
                if load {
                    Expression::Map(Function::Negate, Box::new(channel))
                } else {
                    channel
                }
            };
            if let Some(known) = vectors.first().map(|vector: &Vector| vector.load)
                && known != load
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
            vectors.push(Vector {
                load,
                x: component(&x.path),
                y: component(&y.path),
                turned_by: turned.as_ref().and_then(|turned| {
                    let at = if turned.list { at } else { 0 };
                    turned.members.get(at).map(|m| m.expression.clone())
                }),
                path: place.path.clone(),
                analysis,
            });
            column.get_or_insert_with(|| x.clone());
        }
        let column = column?;
        let of = Typed {
            members: Vec::new(),
            list: true,
            shape: Shape::Signal,
            quantity: Quantity::hard(column.dimension),
            display: Some(column.display),
            level: None,
        };
        let display = self.display(&of, display, first)?;
        let cycles = self.cycles(taken.option("cycles"))?;
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

    /// The places of a path; says what is due where an expression is none.
    fn of_path(
        &mut self,
        expr: &'a Expr,
        title: &str,
        label: &str,
    ) -> Option<super::channel::Places<'a>> {
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

/// How many runs there are.
fn runs(members: &[Member]) -> usize {
    let mut analyses: Vec<&str> = members.iter().map(|m| m.label.analysis.as_str()).collect();
    analyses.sort_unstable();
    analyses.dedup();
    analyses.len()
}

pub(super) fn planned(members: Vec<Member>) -> Vec<plan::Member> {
    members
        .into_iter()
        .map(|member| plan::Member {
            analysis: member.label.analysis,
            channel: member.label.channel,
            expression: member.expression,
        })
        .collect()
}

/// What an axis shows: the last name of the first channel.
fn quantity_text(of: &Typed) -> String {
    let empty = Label::default();
    let label = of.members.first().map_or(&empty, |m| &m.label);
    last_name(&label.channel)
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
