//! Channels by name: `unfired.main[1..5].force.x`, `runup[*].vertical[5]`.

use super::Reporter;
use super::recorded::{Channels, Journal};
use super::value::Typed;
use crate::check::types::{Kind, Quantity, SignalRows, Type};
use crate::codes;
use crate::elaborate::AnalysisPlan;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{Expr, ExprKind, IndexArgument, Name};
use eng_grammar::{Diagnostic, Span};
use eng_system::analysis::Rows;
use eng_system::expression::{Expression, Member};
use eng_system::recorded::Recorded;
use std::rc::Rc;

/// Largest number of indices that a message lists. A choice: they fit in a line or two.
const SHOWN_CHANNELS: usize = 12;

/// A part of a path.
pub(super) enum Step<'a> {
    Field(&'a Name),
    Index(&'a [IndexArgument], Span),
}

/// The name at the root of a path, and its steps; `None` if the expression is no path.
pub(super) fn steps(expr: &Expr) -> Option<(&str, Span, Vec<Step<'_>>)> {
    match &expr.kind {
        ExprKind::Name(name) => Some((name, expr.span, Vec::new())),
        ExprKind::Field { base, name } => {
            let (root, span, mut steps) = steps(base)?;
            steps.push(Step::Field(name));
            Some((root, span, steps))
        }
        ExprKind::Index { base, indices } => {
            let (root, span, mut steps) = steps(base)?;
            steps.push(Step::Index(indices, expr.span));
            Some((root, span, steps))
        }
        _ => None,
    }
}

/// The name at the root of a path.
pub(super) fn root_name(expr: &Expr) -> Option<&str> {
    steps(expr).map(|(root, ..)| root)
}

/// A place in the results of an analysis: the beginning that the paths of its channels share.
pub(super) struct Found<'a> {
    pub plan: &'a AnalysisPlan,
    pub channels: Rc<Channels>,
    /// The columns, if the kind of the analysis has columns of its own.
    pub own: Option<Rc<[Recorded]>>,
    pub path: String,
}

impl Found<'_> {
    /// The rows of a channel at the place.
    pub fn rows(&self) -> SignalRows {
        match self.plan.analysis.kind.rows() {
            Rows::Modes => SignalRows::Modes(self.plan.analysis.origin.path.as_str().into()),
            Rows::Frequencies => {
                SignalRows::Frequencies(self.plan.analysis.origin.path.as_str().into())
            }
            Rows::State => SignalRows::State,
            Rows::Samples | Rows::Cycle => SignalRows::Samples,
        }
    }

    /// The member for this place.
    pub fn member(&self, expression: Expression) -> Member {
        Member {
            analysis: self.plan.analysis.origin.path.clone(),
            channel: self.path.clone(),
            expression,
        }
    }

    /// A channel of the analysis.
    pub fn channel(&self, path: &str) -> Expression {
        Expression::Channel {
            analysis: self.plan.analysis.origin.path.clone(),
            path: path.to_owned(),
        }
    }

    /// The recorded channels of the analysis.
    pub fn columns(&self) -> &[Recorded] {
        match (&self.own, self.plan.analysis.kind.rows()) {
            (Some(own), _) => own,
            (None, Rows::Modes) => &self.channels.modes,
            (None, _) => &self.channels.samples,
        }
    }

    /// The column whose path is that of the place followed by `name`.
    pub fn column(&self, name: &str) -> Option<&Recorded> {
        self.column_at(&format!("{}{name}", self.path))
    }

    /// The column with a path.
    pub fn column_at(&self, path: &str) -> Option<&Recorded> {
        self.columns().iter().find(|column| column.path == path)
    }

    /// The journal at the place.
    pub fn journal(&self) -> Option<&Journal> {
        let mut journals = self.channels.journals.iter();
        journals.find(|journal| journal.path == self.path)
    }
}

/// Whether an analysis gives modes instead of samples.
pub(super) fn are_modes(plan: &AnalysisPlan) -> bool {
    plan.analysis.kind.rows() == Rows::Modes
}

/// Places of one or more analyses.
pub(super) struct Places<'a> {
    pub found: Vec<Found<'a>>,
    /// Whether the text has a range or `*`.
    pub list: bool,
}

/// The numbers of one index in a text.
enum Wanted {
    All,
    Some(Vec<i64>),
}

impl<'a> Reporter<'a, '_> {
    /// The places that a path names; `None` after a message.
    pub(super) fn places(&mut self, expr: &'a Expr) -> Option<Places<'a>> {
        let (name, root_span, steps) = steps(expr)?;
        let mut plans = self.models.named(name);
        let mut steps = steps.into_iter().peekable();
        let mut list = false;
        let sweep = plans.iter().any(|p| !p.analysis.point.is_empty());
        if sweep {
            let Some(Step::Index(indices, span)) = steps.peek() else {
                self.diagnose(
                    Diagnostic::error(
                        codes::INDEX,
                        format!("`{name}` is a sweep of {} runs", plans.len()),
                    )
                    .at(root_span, "which of them?")
                    .with_help(format!("`{name}[1]` is the first, `{name}[*]` are all")),
                );
                return None;
            };
            let (indices, span) = (*indices, *span);
            steps.next();
            let known: Vec<(Vec<i64>, &'a AnalysisPlan)> = plans
                .iter()
                .map(|p| {
                    (
                        numbers(p.analysis.origin.path.get(name.len()..).unwrap_or_default()),
                        *p,
                    )
                })
                .collect();
            let (chosen, many) = self.chosen(name, indices, span, &known)?;
            plans = chosen;
            list |= many;
        }
        let mut found = Vec::new();
        for plan in plans {
            let channels = self.models.channels(plan)?;
            found.push(Found {
                plan,
                own: channels.own(plan),
                channels,
                path: String::new(),
            });
        }
        for step in steps {
            match step {
                Step::Field(field) => {
                    for place in &mut found {
                        let path = if place.path.is_empty() {
                            field.text.clone()
                        } else {
                            format!("{}.{}", place.path, field.text)
                        };
                        if !place.columns().iter().any(|c| begins(&c.path, &path)) {
                            let message = no_channel(place, field);
                            self.diagnose(message);
                            return None;
                        }
                        place.path = path;
                    }
                }
                Step::Index(indices, span) => {
                    let mut next = Vec::new();
                    for place in found {
                        let known = indexed(&place);
                        if known.is_empty() {
                            self.diagnose(
                                Diagnostic::error(
                                    codes::INDEX,
                                    format!(
                                        "`{}` of `{}` has no index",
                                        place.path, place.plan.analysis.origin.path
                                    ),
                                )
                                .at(span, "indexed here"),
                            );
                            return None;
                        }
                        let (chosen, many) = self.chosen(&place.path, indices, span, &known)?;
                        list |= many;
                        next.extend(chosen.into_iter().map(|path| Found {
                            plan: place.plan,
                            channels: Rc::clone(&place.channels),
                            own: place.own.clone(),
                            path,
                        }));
                    }
                    found = next;
                }
            }
        }
        Some(Places { found, list })
    }

    /// The items with the given indices, in the order of the text, and whether the text means a list.
    fn chosen<T: Clone>(
        &mut self,
        what: &str,
        indices: &'a [IndexArgument],
        span: Span,
        known: &[(Vec<i64>, T)],
    ) -> Option<(Vec<T>, bool)> {
        let depth = known.first().map_or(0, |(numbers, _)| numbers.len());
        if indices.len() != depth {
            self.diagnose(
                Diagnostic::error(
                    codes::INDEX,
                    format!(
                        "`{what}` has {}, not {}",
                        if depth == 1 {
                            "one index".to_owned()
                        } else {
                            format!("{depth} indices")
                        },
                        indices.len()
                    ),
                )
                .at(span, "indexed here"),
            );
            return None;
        }
        let mut many = false;
        let mut wanted = Vec::new();
        for index in indices {
            match index {
                IndexArgument::All(_) => {
                    many = true;
                    wanted.push(Wanted::All);
                }
                IndexArgument::At(at) => {
                    let (numbers, range) = self.index(at)?;
                    many |= range;
                    wanted.push(Wanted::Some(numbers));
                }
            }
        }
        let matching: Vec<T> = match wanted.as_slice() {
            // in the order of the text
            [Wanted::Some(numbers)] => {
                let mut chosen = Vec::new();
                for number in numbers {
                    match known.iter().find(|(at, _)| at.as_slice() == [*number]) {
                        Some((_, thing)) => chosen.push(thing.clone()),
                        None => {
                            self.outside(what, &number.to_string(), span, known);
                            return None;
                        }
                    }
                }
                chosen
            }
            wanted => known
                .iter()
                .filter(|(at, _)| {
                    at.iter().zip(wanted).all(|(number, wanted)| match wanted {
                        Wanted::All => true,
                        Wanted::Some(numbers) => numbers.contains(number),
                    })
                })
                .map(|(_, thing)| thing.clone())
                .collect(),
        };
        if matching.is_empty() {
            let text = self.checker.sources.text(span).to_owned();
            self.outside(what, &text, span, known);
            return None;
        }
        Some((matching, many))
    }

    fn outside<T>(&mut self, what: &str, found: &str, span: Span, known: &[(Vec<i64>, T)]) {
        let names: Vec<String> = known
            .iter()
            .map(|(numbers, _)| {
                let numbers: Vec<String> = numbers.iter().map(i64::to_string).collect();
                numbers.join(", ")
            })
            .collect();
        self.diagnose(
            Diagnostic::error(
                codes::INDEX_OUTSIDE,
                format!("there is no `{what}` with the index {found}"),
            )
            .at(span, "outside")
            .with_note(format!(
                "it has {}",
                listing(names.iter().map(String::as_str), SHOWN_CHANNELS)
            )),
        );
    }

    /// The whole numbers of an index, and whether it is a range.
    pub(super) fn index(&mut self, at: &'a Expr) -> Option<(Vec<i64>, bool)> {
        let number = |reporter: &mut Self, expr: &'a Expr| -> Option<i64> {
            let value = reporter.constant(expr, &Quantity::one(), "an index")?;
            // a larger number is a mistake, and a list has no such index
            if value.fract() != 0.0 || value.abs() > 1e9 {
                reporter.diagnose(
                    Diagnostic::error(codes::INDEX, "an index is a whole number")
                        .at(expr.span, format!("this is {value}")),
                );
                return None;
            }
            Some(value as i64)
        };
        match &at.kind {
            ExprKind::Range { from, to, by } => {
                let (from, to) = (number(self, from)?, number(self, to)?);
                let by = match by {
                    Some(by) => number(self, by)?,
                    None => 1,
                };
                // a choice: as long as the longest list of a model
                if by < 1 || to < from || (to - from) / by > 100_000 {
                    self.diagnose(
                        Diagnostic::error(codes::RANGE, "this range has no place in it")
                            .at(at.span, "from the smaller to the larger index"),
                    );
                    return None;
                }
                Some(((from..=to).step_by(by as usize).collect(), true))
            }
            ExprKind::List { items, unit: None } => {
                let numbers: Option<Vec<i64>> = items.iter().map(|i| number(self, i)).collect();
                Some((numbers?, true))
            }
            _ => Some((vec![number(self, at)?], false)),
        }
    }

    /// The channels that a path names.
    pub(super) fn channels(&mut self, expr: &'a Expr) -> Option<Typed> {
        let places = self.places(expr)?;
        let mut members = Vec::new();
        let mut first: Option<Recorded> = None;
        for place in &places.found {
            let Some(column) = place.column("") else {
                let message = not_one(place, expr.span);
                self.diagnose(message);
                return None;
            };
            match &first {
                Some(first) if first.dimension != column.dimension => {
                    self.diagnose(
                        Diagnostic::error(
                            codes::LIST_ELEMENTS,
                            "the channels of a list are of one dimension",
                        )
                        .at(
                            expr.span,
                            format!("`{}` differs from `{}`", column.path, first.path),
                        ),
                    );
                    return None;
                }
                Some(_) => {}
                None => first = Some(column.clone()),
            }
            members.push(place.member(place.channel(&column.path)));
        }
        let first = first?;
        let rows = places.found.first()?.rows();
        let mut found = Typed::signals(members, places.list, &first, rows);
        if let Type::Signal { quantity, .. } = &mut found.ty {
            quantity.kind = self.kind_of(&first);
        }
        Some(found)
    }

    /// The kind of a column: points if its unit has a zero of its own, such as degC for temperatures.
    fn kind_of(&self, column: &Recorded) -> Kind {
        let display = &column.display;
        let unit = self.checker.program.units.get(&display.symbol);
        let point = unit.and_then(|unit| unit.point.as_deref());
        match point {
            Some(point) if display.offset != 0.0 => Kind::Point(point.into()),
            _ => Kind::Any,
        }
    }
}

/// Whether a path equals `start` or continues it.
pub(super) fn begins(path: &str, start: &str) -> bool {
    path.strip_prefix(start)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// The numbers of `[1,2]` at the start of a text.
fn numbers(text: &str) -> Vec<i64> {
    let inside = text
        .strip_prefix('[')
        .and_then(|rest| rest.split(']').next())
        .unwrap_or_default();
    inside
        .split(',')
        .filter_map(|number| number.trim().parse().ok())
        .collect()
}

/// The indices after a place, each with the path that ends with it, in the order of the channels.
fn indexed(place: &Found<'_>) -> Vec<(Vec<i64>, String)> {
    let mut known: Vec<(Vec<i64>, String)> = Vec::new();
    for column in place.columns() {
        let Some(rest) = column.path.strip_prefix(&place.path) else {
            continue;
        };
        let Some((index, _)) = rest.strip_prefix('[').and_then(|rest| rest.split_once(']')) else {
            continue;
        };
        let path = format!("{}[{index}]", place.path);
        if known.iter().all(|(_, other)| *other != path) {
            known.push((numbers(rest), path));
        }
    }
    known
}

/// The names that can follow a place.
fn next_names(place: &Found<'_>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for column in place.columns() {
        let rest = if place.path.is_empty() {
            Some(column.path.as_str())
        } else {
            column
                .path
                .strip_prefix(&place.path)
                .and_then(|rest| rest.strip_prefix('.'))
        };
        if let Some(name) = rest.and_then(|rest| rest.split(['.', '[']).next())
            && names.iter().all(|known| known != name)
        {
            names.push(name.to_owned());
        }
    }
    names
}

fn no_channel(place: &Found<'_>, field: &Name) -> Diagnostic {
    let analysis = &place.plan.analysis.origin.path;
    let what = if place.path.is_empty() {
        format!("the results of `{analysis}` have no `{}`", field.text)
    } else {
        format!(
            "`{}` of `{analysis}` has no channel `{}`",
            place.path, field.text
        )
    };
    let message = Diagnostic::error(codes::NO_MEMBER, what).at(field.span, "not recorded");
    let known = next_names(place);
    if let Some(near) = nearest(&field.text, known.iter().map(String::as_str)) {
        return message.meant(field.span, near);
    }
    let indices = indexed(place);
    if known.is_empty() && !indices.is_empty() {
        return message.with_help(format!(
            "say which one: `{}`",
            indices.first().map_or("", |(_, path)| path.as_str())
        ));
    }
    message.with_note(format!(
        "it has {}",
        listing(known.iter().map(String::as_str), SHOWN_CHANNELS)
    ))
}

/// The message for a place with which the paths of several channels begin.
pub(super) fn not_one(place: &Found<'_>, span: Span) -> Diagnostic {
    let known = next_names(place);
    let indices = indexed(place);
    let what = if place.path.is_empty() {
        place.plan.analysis.origin.path.clone()
    } else {
        place.path.clone()
    };
    let message = Diagnostic::error(
        codes::REPORT_SHAPE,
        format!("`{what}` is not one channel but several"),
    )
    .at(span, "which of them?");
    match indices.first() {
        Some((_, first)) if known.is_empty() => {
            message.with_help(format!("for instance `{first}`, or `{what}[*]` for all"))
        }
        _ => message.with_note(format!(
            "it has {}",
            listing(known.iter().map(String::as_str), SHOWN_CHANNELS)
        )),
    }
}
