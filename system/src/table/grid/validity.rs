//! Conditions on the points and values of a grid.

use super::axis::{Lines, is_closed};
use super::{Argument, End, Ends};
use crate::table::{CLOSURE, MOST_ARGUMENTS};

/// A grid of points that makes no function. Rows count the values from 0, the last argument fastest.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// A wrong number of arguments.
    #[error("a table has one to {MOST_ARGUMENTS} arguments, not {0}")]
    Arguments(usize),
    /// The number of values differs from that of the points.
    #[error("the grid has {points} points but {values} values")]
    Count {
        /// Points of the grid.
        points: usize,
        /// Values.
        values: usize,
    },
    /// An argument has fewer than two points.
    #[error("`{argument}` needs at least 2 points and has {count}")]
    TooFew {
        /// Argument.
        argument: String,
        /// Points.
        count: usize,
    },
    /// The points of an argument do not rise, or are no finite numbers.
    #[error("the points of `{argument}` do not rise: {before} is followed by {after}")]
    NotRising {
        /// Index of the argument.
        index: usize,
        /// Argument.
        argument: String,
        /// A point.
        before: f64,
        /// The point after it.
        after: f64,
    },
    /// A value is not finite.
    #[error("the value in row {row} is not a finite number")]
    NotFinite {
        /// Row.
        row: usize,
    },
    /// The points span more than a period.
    #[error("the points of `{argument}` span {span}, more than the period {period}")]
    PeriodTooShort {
        /// Index of the argument.
        index: usize,
        /// Argument.
        argument: String,
        /// Span of the points.
        span: f64,
        /// Period.
        period: f64,
    },
    /// First and last value differ although they are the same point of the period.
    #[error(
        "the period of `{argument}` closes at row {row}, but the values differ: {first} and {last}"
    )]
    NotPeriodic {
        /// Argument.
        argument: String,
        /// Row of the last value.
        row: usize,
        /// First value.
        first: f64,
        /// Last value.
        last: f64,
    },
    /// A value at an odd end is not zero.
    #[error(
        "the continuation of the table is odd at an end of `{argument}`, so the value there must be 0: row {row} has {value}"
    )]
    NotOdd {
        /// Argument.
        argument: String,
        /// Row of the value.
        row: usize,
        /// Value.
        value: f64,
    },
}

/// Checks the points and the period of an argument.
pub(super) fn check_points(index: usize, argument: &Argument) -> Result<(), GridError> {
    let name = || argument.name.clone();
    let points = &argument.points;
    let (Some(first), Some(last), true) = (points.first(), points.last(), points.len() > 1) else {
        return Err(GridError::TooFew {
            argument: name(),
            count: points.len(),
        });
    };
    // the comparison also refuses NaN
    let rise = |pair: &&[f64]| !(pair[0] < pair[1] && pair[0].is_finite() && pair[1].is_finite());
    if let Some(pair) = points.windows(2).find(rise) {
        return Err(GridError::NotRising {
            index,
            argument: name(),
            before: pair[0],
            after: pair[1],
        });
    }
    if let Ends::Periodic(period) = argument.ends {
        let span = last - first;
        let fits = span <= period * (1.0 + CLOSURE) && period.is_finite();
        // between the last point and the next period there must be a gap that the arguments resolve
        if !fits || (span < period * (1.0 - CLOSURE) && first + period <= *last) {
            return Err(GridError::PeriodTooShort {
                index,
                argument: name(),
                span,
                period,
            });
        }
    }
    Ok(())
}

/// Checks that the values close a period and are zero at odd ends, within rounding errors of the
/// largest.
pub(super) fn check_values(
    argument: &Argument,
    sizes: &[usize],
    index: usize,
    values: &[f64],
    largest: f64,
) -> Result<(), GridError> {
    let small = CLOSURE * largest;
    let lines = Lines::along(sizes, index);
    let last = argument.points.len() - 1;
    for start in lines.starts() {
        match argument.ends {
            Ends::Periodic(period) if is_closed(&argument.points, period) => {
                let row = start + last * lines.stride;
                if (values[row] - values[start]).abs() > small {
                    return Err(GridError::NotPeriodic {
                        argument: argument.name.clone(),
                        row,
                        first: values[start],
                        last: values[row],
                    });
                }
            }
            Ends::Periodic(_) => return Ok(()),
            Ends::Each(ends) => {
                for (end, row) in ends.into_iter().zip([start, start + last * lines.stride]) {
                    if end == End::Odd && values[row].abs() > small {
                        return Err(GridError::NotOdd {
                            argument: argument.name.clone(),
                            row,
                            value: values[row],
                        });
                    }
                }
            }
        }
    }
    Ok(())
}
