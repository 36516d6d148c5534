//! Tables: numbers from a CSV file of the model or from the text.

use super::value::{ScopeId, Value};
use super::{Elaborator, Eval};
use crate::codes;
use eng_grammar::ast::{self, ExprKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::table::{Extrapolation, Interpolation, Table, TableError};
use eng_system::{Dimension, DisplayUnit};

/// Points of a table.
pub(crate) struct Points {
    /// Arguments (SI).
    pub x: Vec<f64>,
    /// Values (SI).
    pub y: Vec<f64>,
    /// Display units of arguments and values in messages.
    pub units: (DisplayUnit, DisplayUnit),
    /// The file of the points, and the line of each.
    pub file: Option<(String, Vec<usize>)>,
}

/// The data of a table for lints (SI).
struct Measured<'p> {
    argument: &'p [f64],
    value: &'p [f64],
    /// The period of a closed spline.
    period: Option<f64>,
    is_pressure: bool,
    /// The place of the values.
    stated: Span,
}

fn pressure() -> Dimension {
    Dimension::MASS
        .over(Dimension::LENGTH)
        .over(Dimension::TIME)
        .over(Dimension::TIME)
}

impl<'a> Elaborator<'a, '_> {
    pub fn table_value(
        &mut self,
        table: &'a ast::Table,
        scope: ScopeId,
        module: u32,
    ) -> Eval<Value<'a>> {
        let argument = match table.parameters.first() {
            Some(p) => self.dimension_at(p.ty.span, scope)?,
            None => Dimension::ONE,
        };
        let result = match &table.result {
            Some(ty) => self.dimension_at(ty.span, scope)?,
            None => Dimension::ONE,
        };
        let source = &table.source;
        let (callee, arguments) = self.called(source)?;
        let ExprKind::Name(kind) = &callee.kind else {
            return self.not_a_source(source.span);
        };
        let mut interpolation = Interpolation::Cubic;
        let mut extrapolation = None;
        let mut period = None;
        let mut columns: Option<&'a ast::Expr> = None;
        let mut plain = Vec::new();
        for a in arguments {
            match a.name.as_ref().map(|n| n.text.as_str()) {
                None => plain.push(&a.value),
                Some("columns") => columns = Some(&a.value),
                Some("periodic") => {
                    let value = self.evaluate(&a.value, scope)?;
                    let s = self.as_scalar(value, a.value.span)?;
                    period = Some(self.structural(s, a.value.span)?);
                }
                Some("interpolation") => {
                    interpolation = match &a.value.kind {
                        ExprKind::Name(n) if n == "cubic" => Interpolation::Cubic,
                        ExprKind::Name(n) if n == "monotone" => Interpolation::Monotone,
                        _ => return self.checked(None, a.value.span, "no interpolation"),
                    }
                }
                Some("extrapolation") => {
                    extrapolation = match &a.value.kind {
                        ExprKind::Name(n) if n == "hold" => Some(Extrapolation::Hold),
                        ExprKind::Name(n) if n == "linear" => Some(Extrapolation::Linear),
                        _ => return self.checked(None, a.value.span, "no extrapolation"),
                    }
                }
                Some(_) => return self.checked(None, a.value.span, "no argument of a table"),
            }
        }
        let points = match (kind.as_str(), plain.as_slice()) {
            ("points", [xs, ys]) => {
                // the units of the text, for messages
                let unit = |e: &Self, list: &ast::Expr, dimension| {
                    e.literal_unit(list)
                        .unwrap_or_else(|| e.natural_unit(dimension))
                };
                Points {
                    x: self.numbers(xs, scope)?,
                    y: self.numbers(ys, scope)?,
                    units: (unit(self, xs, argument), unit(self, ys, result)),
                    file: None,
                }
            }
            ("csv", [file]) => {
                let columns = self.checked(columns, source.span, "`csv` without its columns")?;
                let text = |ty: Option<&ast::TypeExpr>| {
                    ty.map_or("a number", |t| self.sources.text(t.span))
                        .to_owned()
                };
                let due = [
                    (argument, text(table.parameters.first().map(|p| &p.ty))),
                    (result, text(table.result.as_ref())),
                ];
                self.read_csv(file, columns, module, &due)?
            }
            _ => return self.not_a_source(source.span),
        };
        let Points { x, y, units, file } = points;
        if let ([xs, ys], true) = (plain.as_slice(), x.len() != y.len()) {
            return Err(self.lengths(x.len(), xs.span, y.len(), ys.span));
        }
        self.refuse_below_zero(table, (result, &y, &units.1), (&plain, file.as_ref()))?;
        let measured = Measured {
            argument: &x,
            value: &y,
            period: period.filter(|_| matches!(interpolation, Interpolation::Cubic)),
            is_pressure: result == pressure(),
            stated: columns
                .or(plain.get(1).copied())
                .map_or(source.span, |e| e.span),
        };
        self.doubtful(table, &measured, &units);
        match Table::new(
            table.name.text.clone(),
            x,
            y,
            interpolation,
            extrapolation,
            period,
        ) {
            Ok(t) => {
                let place = super::location(table.name.span);
                self.tables.push(t.written(place, units.0));
                let index = self.tables.len() - 1;
                Ok(self.table_handle(index))
            }
            Err(error) => Err(self.report(
                Diagnostic::error(
                    codes::TABLE_POINTS,
                    format!("the points of table `{}` make no function", table.name.text),
                )
                .at(source.span, points_text(&error, &units, file.as_ref())),
            )),
        }
    }

    /// Refuses negative absolute pressures and temperatures. Cycle angles are points too, but may be
    /// negative.
    fn refuse_below_zero(
        &mut self,
        table: &ast::Table,
        (result, values, unit): (Dimension, &[f64], &DisplayUnit),
        (arguments, file): (&[&ast::Expr], Option<&(String, Vec<usize>)>),
    ) -> Eval<()> {
        let declared = table.result.as_ref().map(|t| self.sources.text(t.span));
        let named = declared.and_then(|name| self.program.dimensions.get(name));
        let is_point = named.is_some_and(|named| named.point_of.is_some());
        // a zero in a unit with a shifted zero, such as -273.15 degC, is rounded
        let largest = values
            .iter()
            .fold(0.0_f64, |most, value| most.max(value.abs()));
        let below = values.iter().position(|value| *value < -1e-9 * largest);
        let (true, Some(index)) = (is_point && result != Dimension::ANGLE, below) else {
            return Ok(());
        };
        let value = unit.text(values.get(index).copied().unwrap_or_default());
        let span = match arguments.get(1).map(|list| (&list.kind, list.span)) {
            Some((ExprKind::List { items, .. }, span)) => {
                items.get(index).map_or(span, |item| item.span)
            }
            Some((_, span)) => span,
            None => arguments.first().map_or(table.source.span, |e| e.span),
        };
        let place = match file.and_then(|(path, lines)| Some((path, lines.get(index)?))) {
            Some((path, line)) => format!("{path}:{line} holds {value}"),
            None => format!("this is {value}"),
        };
        Err(self.report(
            Diagnostic::error(
                codes::BELOW_ZERO,
                format!(
                    "table `{}` of {} goes below zero",
                    table.name.text,
                    declared.unwrap_or_default()
                ),
            )
            .at(span, place)
            .with_help("for gauge pressures name `barg`; for differences declare `Pressure` or `TemperatureDifference`"),
        ))
    }

    /// Lints on the points of a table.
    fn doubtful(
        &mut self,
        table: &ast::Table,
        points: &Measured<'_>,
        units: &(DisplayUnit, DisplayUnit),
    ) {
        let peak = points.value.iter().copied().fold(0.0, f64::max);
        if points.is_pressure && peak > MOST_PRESSURE {
            self.diagnostics.push(
                Diagnostic::warning(
                    codes::TABLE_PEAK,
                    format!("table `{}` reaches {}", table.name.text, units.1.text(peak)),
                )
                .at(table.name.span, "no engine part stands this pressure")
                .also(points.stated, format!("read in {}", units.1.symbol))
                .with_help("see which unit the numbers have: a column in pascal is `p [Pa]`"),
            );
        }
        let gap = points
            .period
            .and_then(|period| period_gap(points.argument, period));
        if let Some((last, next, usual)) = gap {
            self.diagnostics.push(
                Diagnostic::warning(
                    codes::PERIOD_GAP,
                    format!(
                        "the points of table `{}` leave out a part of its period",
                        table.name.text
                    ),
                )
                .at(
                    table.source.span,
                    format!(
                        "none from {} to {}, where the next period begins",
                        units.0.text(last),
                        units.0.text(next)
                    ),
                )
                .with_note(format!(
                    "elsewhere they are {} apart; the spline bridges the gap by a curve of its own",
                    units.0.text(usual)
                ))
                .with_help(
                    "state points over the whole period, or take `interpolation: monotone`, which stays between the two values",
                ),
            );
        }
    }

    pub fn not_a_source<T>(&mut self, span: Span) -> Eval<T> {
        self.checked(None, span, "neither `csv(…)` nor `points(…)`")
    }

    fn numbers(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<Vec<f64>> {
        let value = self.evaluate(expr, scope)?;
        let components = self.as_components(value, expr.span)?;
        components
            .into_iter()
            .map(|s| self.structural(s, expr.span))
            .collect()
    }
}

/// The message about wrong points, in their units and at their line.
fn points_text(
    error: &TableError,
    (x, y): &(DisplayUnit, DisplayUnit),
    file: Option<&(String, Vec<usize>)>,
) -> String {
    let place = |row: &usize| match file.and_then(|(path, lines)| Some((path, lines.get(row - 1)?)))
    {
        Some((path, line)) => format!("{path}:{line}"),
        None => format!("point {row}"),
    };
    match error {
        TableError::NotRising {
            row, before, after, ..
        } => format!(
            "the argument does not rise at {}: {} is followed by {}",
            place(row),
            x.text(*before),
            x.text(*after)
        ),
        TableError::NotPeriodic {
            row, first, last, ..
        } => format!(
            "the period closes at {}, but the values differ: {} and {}",
            place(row),
            y.text(*first),
            y.text(*last)
        ),
        TableError::PeriodTooShort { span, period, .. } => format!(
            "the points span {}, more than the period of {}",
            x.text(*span),
            x.text(*period)
        ),
        TableError::TooFew { count, .. } => {
            format!("at least 2 points are needed, there is {count}")
        }
        TableError::NotFinite { row, .. } => format!("{} is not a finite number", place(row)),
        other => other.to_string(),
    }
}

/// Pressure (Pa) far above that of pumps for fuel injection, which is some 3000 bar.
const MOST_PRESSURE: f64 = 1e9;

/// A warning reports a gap in a period that is longer than this many usual distances of the points and than
/// this share of the period.
const GAP_DISTANCES: f64 = 3.0;
const GAP_SHARE: f64 = 0.05;

/// The gap at the end of the period of a periodic table: the last argument, the first of the next period, and
/// the median distance of the points (all in the argument's unit).
fn period_gap(x: &[f64], period: f64) -> Option<(f64, f64, f64)> {
    let next = x.first()? + period;
    let last = *x.last()?;
    let mut distances: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    distances.sort_by(f64::total_cmp);
    let usual = *distances.get(distances.len() / 2)?;
    let gap = next - last;
    (gap > GAP_DISTANCES * usual && gap > GAP_SHARE * period).then_some((last, next, usual))
}
