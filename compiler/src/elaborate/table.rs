//! Tables: their points from a CSV file or from the text, and tables of one argument.

use super::value::{ScopeId, Value};
use super::{Elaborator, Eval, Reported};
use crate::codes;
use eng_grammar::ast::{self, ExprKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::table::{Extrapolation, Interpolation, Table, TableError};
use eng_system::{Dimension, DisplayUnit};

/// Points of a table (SI).
pub(super) struct Points {
    /// Arguments: of every value in a table of one argument and in a file, else once each.
    pub arguments: Vec<Vec<f64>>,
    pub values: Vec<f64>,
    /// Display units of the arguments in messages.
    pub units: Vec<DisplayUnit>,
    /// Display unit of the values in messages.
    pub unit: DisplayUnit,
    /// The file of the points, and the line of each value.
    pub file: Option<(String, Vec<usize>)>,
}

impl Points {
    /// The place of a value in messages; rows count from 0.
    pub fn place(&self, row: usize) -> String {
        match &self.file {
            Some((path, lines)) => match lines.get(row) {
                Some(line) => format!("{path}:{line}"),
                None => path.clone(),
            },
            None => format!("point {}", row + 1),
        }
    }
}

/// The source of a table: its word, its arguments without a name, and the columns of a file.
pub(super) struct Source<'a> {
    word: &'a str,
    plain: Vec<&'a ast::Expr>,
    columns: Option<&'a ast::Expr>,
}

impl Source<'_> {
    /// The place of the values.
    fn values(&self) -> Option<&ast::Expr> {
        match self.word {
            "points" => self.plain.last().copied(),
            _ => None,
        }
    }
}

/// The statements of a table of one argument besides its points.
struct Options {
    interpolation: Interpolation,
    extrapolation: Option<Extrapolation>,
    /// The period (SI).
    period: Option<f64>,
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
        let mut due = Vec::with_capacity(table.parameters.len() + 1);
        let types = table.parameters.iter().map(|p| &p.ty);
        for ty in types.chain(table.result.as_ref()) {
            let dimension = self.dimension_at(ty.span, scope)?;
            due.push((dimension, self.sources.text(ty.span).to_owned()));
        }
        let (callee, arguments) = self.called(&table.source)?;
        let ExprKind::Name(word) = &callee.kind else {
            return self.not_a_source(table.source.span);
        };
        let named = |name: &str| {
            let is = |a: &&'a ast::Argument| a.name.as_ref().is_some_and(|n| n.text == name);
            arguments.iter().find(is).map(|a| &a.value)
        };
        let source = Source {
            word,
            plain: arguments
                .iter()
                .filter(|a| a.name.is_none())
                .map(|a| &a.value)
                .collect(),
            columns: named("columns"),
        };
        let points = self.points_of(table, &source, &due, (scope, module))?;
        self.refuse_below_zero(table, &source, &points, &due)?;
        let stated = source.columns.or(source.values());
        self.doubtful_peak(table, stated, &points, &due);
        let made = if table.parameters.len() == 1 {
            let options = self.options_of_curve(&named, scope)?;
            self.curve(table, points, options)?
        } else {
            let mut ends = Vec::with_capacity(table.parameters.len());
            for parameter in &table.parameters {
                ends.push(self.ends_of(named(&parameter.name.text), scope)?);
            }
            self.grid(table, points, ends)?
        };
        self.draft.tables.push(made);
        Ok(self.table_handle(self.draft.tables.len() - 1))
    }

    /// The points of a table from its source.
    fn points_of(
        &mut self,
        table: &'a ast::Table,
        source: &Source<'a>,
        due: &[(Dimension, String)],
        (scope, module): (ScopeId, u32),
    ) -> Eval<Points> {
        let place = table.source.span;
        match (source.word, source.plain.as_slice()) {
            ("points", lists) if lists.len() == due.len() => {
                // the units of the text, for messages
                let mut units: Vec<DisplayUnit> = lists
                    .iter()
                    .zip(due)
                    .map(|(list, (dimension, _))| {
                        self.literal_unit(list)
                            .unwrap_or_else(|| self.natural_unit(*dimension))
                    })
                    .collect();
                let mut numbers = Vec::with_capacity(lists.len());
                for list in lists {
                    numbers.push(self.numbers(list, scope)?);
                }
                if let ([x, y], [xs, ys]) = (numbers.as_slice(), lists)
                    && x.len() != y.len()
                {
                    return Err(self.lengths(x.len(), xs.span, y.len(), ys.span));
                }
                let unit = self.checked(units.pop(), place, "a table without values")?;
                Ok(Points {
                    values: self.checked(numbers.pop(), place, "a table without values")?,
                    arguments: numbers,
                    units,
                    unit,
                    file: None,
                })
            }
            ("csv", [file]) => {
                let columns = self.checked(source.columns, place, "`csv` without its columns")?;
                let mut read = self.read_csv(file, columns, module, due)?;
                let unit = read.units.pop();
                let values = read.numbers.pop();
                Ok(Points {
                    values: self.checked(values, columns.span, "no column of values")?,
                    arguments: read.numbers,
                    units: read.units,
                    unit: self.checked(unit, columns.span, "no column of values")?,
                    file: Some((read.path, read.lines)),
                })
            }
            _ => self.not_a_source(place),
        }
    }

    fn options_of_curve(
        &mut self,
        named: &dyn Fn(&str) -> Option<&'a ast::Expr>,
        scope: ScopeId,
    ) -> Eval<Options> {
        let word = |expr: &'a ast::Expr| match &expr.kind {
            ExprKind::Name(word) => word.as_str(),
            _ => "",
        };
        let interpolation = match named("interpolation").map(|e| (word(e), e.span)) {
            None | Some(("cubic", _)) => Interpolation::Cubic,
            Some(("monotone", _)) => Interpolation::Monotone,
            Some((_, place)) => return self.checked(None, place, "no interpolation"),
        };
        let extrapolation = match named("extrapolation").map(|e| (word(e), e.span)) {
            None => None,
            Some(("hold", _)) => Some(Extrapolation::Hold),
            Some(("linear", _)) => Some(Extrapolation::Linear),
            Some((_, place)) => return self.checked(None, place, "no extrapolation"),
        };
        let period = match named("periodic") {
            Some(expr) => Some(self.structural_number(expr, scope)?),
            None => None,
        };
        Ok(Options {
            interpolation,
            extrapolation,
            period,
        })
    }

    /// A number of the text, which parameters do not change.
    pub(super) fn structural_number(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<f64> {
        let value = self.evaluate(expr, scope)?;
        let number = self.as_scalar(value, expr.span)?;
        self.structural(number, expr.span)
    }

    /// A table of one argument.
    fn curve(&mut self, table: &'a ast::Table, points: Points, options: Options) -> Eval<Table> {
        let place = table.source.span;
        let x = self.checked(points.arguments.first(), place, "a table without arguments")?;
        let units = (
            self.checked(points.units.first(), place, "a table without arguments")?
                .clone(),
            points.unit.clone(),
        );
        if let (Interpolation::Cubic, Some(period)) = (options.interpolation, options.period) {
            let help = "state points over the whole period, or take `interpolation: monotone`, which stays between the two values";
            self.doubtful_gap(table, x, period, &units.0, help);
        }
        let name = table.name.text.clone();
        let made = Table::new(
            name,
            x.clone(),
            points.values.clone(),
            options.interpolation,
            options.extrapolation,
            options.period,
        );
        match made {
            Ok(made) => Ok(made.written(super::location(table.name.span), points.units)),
            Err(error) => {
                let text = points_text(&error, &units, &points);
                Err(self.no_function(table, text))
            }
        }
    }

    /// The error for points that make no function.
    pub(super) fn no_function(&mut self, table: &ast::Table, text: String) -> Reported {
        self.report(
            Diagnostic::error(
                codes::TABLE_POINTS,
                format!(
                    "the points of the table `{}` define no function",
                    table.name.text
                ),
            )
            .at(table.source.span, text),
        )
    }

    /// Refuses negative absolute pressures and temperatures. Cycle angles are points too, but may be
    /// negative.
    fn refuse_below_zero(
        &mut self,
        table: &ast::Table,
        source: &Source<'_>,
        points: &Points,
        due: &[(Dimension, String)],
    ) -> Eval<()> {
        let result = due.last().map_or(Dimension::ONE, |(result, _)| *result);
        let (values, unit) = (&points.values, &points.unit);
        let declared = table.result.as_ref().map(|t| self.sources.text(t.span));
        let named = declared.and_then(|name| self.program.dimensions.get(name));
        let is_point = named.is_some_and(|named| named.point_of.is_some());
        // a zero in a unit with a shifted zero, such as -273.15 degC, is rounded
        let largest = eng_system::dense::largest(values);
        let below = values.iter().position(|value| *value < -1e-9 * largest);
        let (true, Some(index)) = (is_point && result != Dimension::ANGLE, below) else {
            return Ok(());
        };
        let value = unit.text(values.get(index).copied().unwrap_or_default());
        let span = match source.values().map(|list| (&list.kind, list.span)) {
            Some((ExprKind::List { items, .. }, span)) if table.parameters.len() == 1 => {
                items.get(index).map_or(span, |item| item.span)
            }
            Some((_, span)) => span,
            None => source.plain.first().map_or(table.source.span, |e| e.span),
        };
        let place = match points.file {
            Some(_) => format!("{} holds {value}", points.place(index)),
            None => format!("this is {value}"),
        };
        Err(self.report(
            Diagnostic::error(
                codes::BELOW_ZERO,
                format!(
                    "table `{}` of {} falls below zero",
                    table.name.text,
                    declared.unwrap_or_default()
                ),
            )
            .at(span, place)
            .with_help("for gauge pressures name `barg`; for differences declare `Pressure` or `TemperatureDifference`"),
        ))
    }

    /// The lint on pressures that no engine part can carry.
    fn doubtful_peak(
        &mut self,
        table: &ast::Table,
        stated: Option<&ast::Expr>,
        points: &Points,
        due: &[(Dimension, String)],
    ) {
        let is_pressure = due.last().is_some_and(|(result, _)| *result == pressure());
        let peak = points.values.iter().copied().fold(0.0, f64::max);
        if is_pressure && peak > MOST_PRESSURE {
            let unit = &points.unit;
            self.diagnostics.push(
                Diagnostic::warning(
                    codes::TABLE_PEAK,
                    format!("table `{}` reaches {}", table.name.text, unit.text(peak)),
                )
                .at(table.name.span, "no engine part withstands this pressure")
                .also(
                    stated.map_or(table.source.span, |e| e.span),
                    format!("read in {}", unit.symbol),
                )
                .with_help("check the unit of the numbers: a column in pascal is `p [Pa]`"),
            );
        }
    }

    /// The lint on a part of a period without points.
    pub(super) fn doubtful_gap(
        &mut self,
        table: &ast::Table,
        x: &[f64],
        period: f64,
        unit: &DisplayUnit,
        help: &str,
    ) {
        let Some((last, next, usual)) = period_gap(x, period) else {
            return;
        };
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
                    unit.text(last),
                    unit.text(next)
                ),
            )
            .with_note(format!(
                "elsewhere they are {} apart; the spline bridges the gap by a curve of its own",
                unit.text(usual)
            ))
            .with_help(help),
        );
    }

    pub fn not_a_source<T>(&mut self, span: Span) -> Eval<T> {
        self.checked(None, span, "neither `csv(…)` nor `points(…)`")
    }

    /// The numbers of a list, or of lists in a list, in the order of the text.
    fn numbers(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<Vec<f64>> {
        let value = self.evaluate(expr, scope)?;
        let mut numbers = Vec::new();
        self.collect_numbers(value, expr.span, &mut numbers)?;
        Ok(numbers)
    }

    fn collect_numbers(&mut self, value: Value<'a>, place: Span, to: &mut Vec<f64>) -> Eval<()> {
        let nested =
            matches!(&value, Value::List(items) if matches!(items.first(), Some(Value::List(_))));
        if nested {
            let items: Vec<Value<'a>> = self.read(value, place)?;
            for item in items {
                self.collect_numbers(item, place, to)?;
            }
            return Ok(());
        }
        for component in self.as_components(value, place)? {
            to.push(self.structural(component, place)?);
        }
        Ok(())
    }
}

/// The message about wrong points, in their units and at their line.
fn points_text(error: &TableError, (x, y): &(DisplayUnit, DisplayUnit), points: &Points) -> String {
    let place = |row: &usize| points.place(row.saturating_sub(1));
    match error {
        TableError::NotRising {
            row, before, after, ..
        } => format!(
            "the argument does not increase at {}: {} is followed by {}",
            place(row),
            x.text(*before),
            x.text(*after)
        ),
        TableError::NotPeriodic {
            row, first, last, ..
        } => format!(
            "the period ends at {}, but the values differ: {} and {}",
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

/// Pressure (Pa) far above that of pumps for fuel injection, which is some 3000 bar. A choice: a wrong unit
/// is mostly wrong by a factor of a thousand or more (MPa for kPa, bar for Pa), so three times the highest
/// pressure finds it.
const MOST_PRESSURE: f64 = 1e9;

/// A warning reports a gap in a period that is longer than this many usual distances of the points and than
/// this share of the period. Choices: points of a measurement are not equally far apart, and a missing last
/// point makes a gap of one distance.
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
