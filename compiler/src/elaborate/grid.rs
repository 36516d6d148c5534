//! Tables of two and three arguments.

use super::table::Points;
use super::value::ScopeId;
use super::{Elaborator, Eval};
use crate::codes;
use eng_grammar::Diagnostic;
use eng_grammar::ast::{self, ExprKind};
use eng_system::DisplayUnit;
use eng_system::table::{Argument, End, Ends, GridError, Table};

/// Arguments of a file's rows that differ by less than this share of their span are one point of the grid. It
/// allows for numbers that were rounded in different ways.
const SAME_POINT: f64 = 1e-9;

/// A combination of arguments that the rows of a file lack or repeat.
enum Incomplete {
    /// These two rows have the same arguments.
    Twice(usize, usize),
    /// Number of combinations without a row, the grid's size, and the arguments of the first one.
    Missing(u128, u128, Vec<f64>),
}

impl<'a> Elaborator<'a, '_> {
    /// The continuation beyond the ends of an argument: `hold`, `[even, linear]`, `periodic(360 deg)`.
    pub(super) fn ends_of(&mut self, stated: Option<&'a ast::Expr>, scope: ScopeId) -> Eval<Ends> {
        let Some(expr) = stated else {
            return Ok(Ends::Each([End::Open; 2]));
        };
        let end = |expr: &ast::Expr| match &expr.kind {
            ExprKind::Name(word) => crate::words::end_of_table(word),
            _ => None,
        };
        if let ExprKind::Call { arguments, .. } = &expr.kind {
            let period =
                self.checked(arguments.first(), expr.span, "`periodic` without a period")?;
            return Ok(Ends::Periodic(
                self.structural_number(&period.value, scope)?,
            ));
        }
        let ends = match &expr.kind {
            ExprKind::List { items, .. } => match items.as_slice() {
                [first, last] => end(first).zip(end(last)).map(|(first, last)| [first, last]),
                _ => None,
            },
            _ => end(expr).map(|both| [both; 2]),
        };
        Ok(Ends::Each(self.checked(
            ends,
            expr.span,
            "no end of a table",
        )?))
    }

    /// A table of several arguments.
    pub(super) fn grid(
        &mut self,
        table: &'a ast::Table,
        mut points: Points,
        ends: Vec<Ends>,
    ) -> Eval<Table> {
        if points.file.is_some() {
            sorted(&mut points)
                .map_err(|incomplete| self.incomplete(table, &points, &incomplete))?;
        }
        let stated = points.arguments.iter().zip(&ends).zip(&points.units);
        for ((x, ends), unit) in stated {
            if let Ends::Periodic(period) = ends {
                let help = "state points over the whole period";
                self.doubtful_gap(table, x, *period, unit, help);
            }
        }
        let names = table.parameters.iter().map(|p| p.name.text.clone());
        let arguments = names
            .zip(&points.arguments)
            .zip(ends)
            .map(|((name, points), ends)| Argument {
                name,
                points: points.clone(),
                ends,
            })
            .collect();
        match Table::grid(table.name.text.clone(), arguments, points.values.clone()) {
            Ok(made) => Ok(made.written(super::location(table.name.span), points.units)),
            Err(error) => {
                let text = grid_text(&error, &points);
                Err(self.no_function(table, text))
            }
        }
    }

    fn incomplete(
        &mut self,
        table: &ast::Table,
        points: &Points,
        incomplete: &Incomplete,
    ) -> super::Reported {
        let at = |place: &[f64]| {
            let parts = table.parameters.iter().zip(place).zip(&points.units);
            let parts: Vec<String> = parts
                .map(|((parameter, x), unit)| {
                    format!("{} = {}", parameter.name.text, unit.text(*x))
                })
                .collect();
            parts.join(", ")
        };
        let (title, label) = match incomplete {
            Incomplete::Twice(first, second) => {
                let place: Vec<f64> = points
                    .arguments
                    .iter()
                    .filter_map(|column| column.get(*second).copied())
                    .collect();
                (
                    format!(
                        "the file of table `{}` gives a point twice",
                        table.name.text
                    ),
                    format!(
                        "{} repeats the arguments of {}: {}",
                        points.place(*second),
                        points.place(*first),
                        at(&place)
                    ),
                )
            }
            Incomplete::Missing(missing, all, place) => (
                format!("the grid of table `{}` is not complete", table.name.text),
                format!(
                    "{missing} of its {all} points have no row; the first is {}",
                    at(place)
                ),
            ),
        };
        self.report(
            Diagnostic::error(codes::GRID, title)
                .at(table.source.span, label)
                .with_note("the points of a table of several arguments are all combinations of the numbers of each argument")
                .with_help("a row for each combination, in any order"),
        )
    }
}

/// Turns the rows of a file into a grid. Each argument has its points once, in rising order. Values and lines have
/// the order of the points.
fn sorted(points: &mut Points) -> Result<(), Incomplete> {
    let axes: Vec<Vec<f64>> = points.arguments.iter().map(|x| distinct(x)).collect();
    // columns of noise make a grid of more points than memory holds, but their number fits into 128 bits
    let size: u128 = axes.iter().map(|axis| axis.len() as u128).product();
    let mut rows: Vec<(u128, usize)> = (0..points.values.len())
        .map(|row| {
            let columns = axes.iter().zip(&points.arguments);
            let place = columns.fold(0, |place, (axis, column)| {
                place * axis.len() as u128 + nearest(axis, column[row]) as u128
            });
            (place, row)
        })
        .collect();
    rows.sort_unstable();
    if let Some(pair) = rows.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(Incomplete::Twice(pair[0].1, pair[1].1));
    }
    let missing = size - rows.len() as u128;
    if missing > 0 {
        let first = (0..).zip(&rows).find(|(at, (place, _))| at != place);
        let mut rest = first.map_or(rows.len() as u128, |(at, _)| at);
        let mut place: Vec<f64> = axes
            .iter()
            .rev()
            .map(|axis| {
                let x = axis[(rest % axis.len() as u128) as usize];
                rest /= axis.len() as u128;
                x
            })
            .collect();
        place.reverse();
        return Err(Incomplete::Missing(missing, size, place));
    }
    points.values = rows.iter().map(|(_, row)| points.values[*row]).collect();
    if let Some((_, lines)) = &mut points.file {
        *lines = rows.iter().map(|(_, row)| lines[*row]).collect();
    }
    points.arguments = axes;
    Ok(())
}

/// The numbers of a column, each once, rising.
fn distinct(column: &[f64]) -> Vec<f64> {
    let mut numbers = column.to_vec();
    numbers.sort_by(f64::total_cmp);
    let span = match (numbers.first(), numbers.last()) {
        (Some(first), Some(last)) => last - first,
        _ => 0.0,
    };
    numbers.dedup_by(|next, kept| *next - *kept <= SAME_POINT * span);
    numbers
}

/// The index of the point that a number means.
fn nearest(axis: &[f64], x: f64) -> usize {
    let above = axis
        .partition_point(|point| *point <= x)
        .min(axis.len() - 1);
    let below = above.saturating_sub(1);
    if (x - axis[below]).abs() <= (axis[above] - x).abs() {
        below
    } else {
        above
    }
}

/// The message about a wrong grid, in its units and at its line.
fn grid_text(error: &GridError, points: &Points) -> String {
    let shown = |index: &usize, x: &f64| match points.units.get(*index) {
        Some(unit) => DisplayUnit::text(unit, *x),
        None => x.to_string(),
    };
    let unit = &points.unit;
    match error {
        GridError::NotRising {
            index,
            argument,
            before,
            after,
        } => format!(
            "the points of `{argument}` do not increase: {} is followed by {}",
            shown(index, before),
            shown(index, after)
        ),
        GridError::PeriodTooShort {
            index,
            argument,
            span,
            period,
        } => format!(
            "the points of `{argument}` span {}, more than the period of {}",
            shown(index, span),
            shown(index, period)
        ),
        GridError::NotPeriodic {
            argument,
            row,
            first,
            last,
        } => format!(
            "the period of `{argument}` ends at {}, but the values differ: {} and {}",
            points.place(*row),
            unit.text(*first),
            unit.text(*last)
        ),
        GridError::NotOdd {
            argument,
            row,
            value,
        } => format!(
            "the table is odd at an end of `{argument}`, so its value there is zero, but {} holds {}",
            points.place(*row),
            unit.text(*value)
        ),
        GridError::NotFinite { row } => format!("{} is not a finite number", points.place(*row)),
        GridError::Count { points, values } => {
            format!("the arguments make {points} points, but there are {values} values")
        }
        GridError::TooFew { .. } | GridError::Arguments(_) => error.to_string(),
    }
}
