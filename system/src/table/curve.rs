//! Tables of one argument: piecewise cubics.

use super::corners::Corners;
use super::spline::{Closing, moments, monotone_slopes, periodic_moments, pieces};
use super::{CLOSURE, PAST_END};

/// The interpolation between the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// Cubic spline, C² (natural ends, or periodic).
    Cubic,
    /// Monotone cubic (Fritsch–Carlson), C¹: no overshoot.
    Monotone,
}

/// The continuation outside the range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Extrapolation {
    /// The end value and zero slope.
    Hold,
    /// The end value and end slope.
    Linear,
}

/// The numbers of a table of one argument.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Ends of the intervals; for a periodic table the last is first + period.
    x: Vec<f64>,
    /// Coefficients of each interval in powers of (x − x_i).
    coefficients: Vec<[f64; 4]>,
    period: Option<f64>,
    interpolation: Interpolation,
    extrapolation: Option<Extrapolation>,
}

/// A table that cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// A column is shorter than the other.
    #[error("table {name} has {arguments} arguments but {values} values")]
    Lengths {
        /// Table.
        name: String,
        /// Arguments.
        arguments: usize,
        /// Values.
        values: usize,
    },
    /// Fewer than two points.
    #[error("table {name} has {count} points; at least 2 are needed")]
    TooFew {
        /// Table.
        name: String,
        /// Points.
        count: usize,
    },
    /// Arguments do not rise.
    #[error(
        "table {name}: the argument does not increase at row {row}: {before} is followed by {after}"
    )]
    NotRising {
        /// Table.
        name: String,
        /// Row, from 1.
        row: usize,
        /// Argument before.
        before: f64,
        /// Argument there.
        after: f64,
    },
    /// A value is not finite.
    #[error("table {name}: row {row} is not a finite number")]
    NotFinite {
        /// Table.
        name: String,
        /// Row, from 1.
        row: usize,
    },
    /// First and last value differ although they are the same point of the period.
    #[error(
        "table {name}: the period ends at row {row}, but the values differ: {first} and {last}"
    )]
    NotPeriodic {
        /// Table.
        name: String,
        /// Row, from 1.
        row: usize,
        /// First value.
        first: f64,
        /// Last value.
        last: f64,
    },
    /// The points span more than a period.
    #[error("table {name}: the points span {span}, more than the period {period}")]
    PeriodTooShort {
        /// Table.
        name: String,
        /// Span of the arguments.
        span: f64,
        /// Period.
        period: f64,
    },
}

impl Curve {
    /// Builds the interpolant through the points (x, y).
    ///
    /// With a period, the point at x₀ + period may be given (its value must then equal the first) or left
    /// out; the spline is periodic with all the derivatives it has. Without a stated extrapolation a value
    /// outside is NaN.
    pub fn new(
        name: &str,
        mut x: Vec<f64>,
        mut y: Vec<f64>,
        interpolation: Interpolation,
        extrapolation: Option<Extrapolation>,
        period: Option<f64>,
    ) -> Result<Curve, TableError> {
        if x.len() != y.len() {
            return Err(TableError::Lengths {
                name: name.into(),
                arguments: x.len(),
                values: y.len(),
            });
        }
        let count = x.len();
        let (Some(&first), Some(&last), true) = (x.first(), x.last(), count >= 2) else {
            return Err(TableError::TooFew {
                name: name.into(),
                count,
            });
        };
        if let Some(row) = x
            .iter()
            .zip(&y)
            .position(|(x, y)| !x.is_finite() || !y.is_finite())
        {
            return Err(TableError::NotFinite {
                name: name.into(),
                row: row + 1,
            });
        }
        if let Some((row, pair)) = x.windows(2).enumerate().find(|(_, w)| w[0] >= w[1]) {
            return Err(TableError::NotRising {
                name: name.into(),
                row: row + 2,
                before: pair[0],
                after: pair[1],
            });
        }
        if let Some(period) = period {
            let span = last - first;
            // also refuses a period that is not a positive number
            if !(span <= period * (1.0 + CLOSURE) && period.is_finite()) {
                return Err(TableError::PeriodTooShort {
                    name: name.into(),
                    span,
                    period,
                });
            }
            if span >= period * (1.0 - CLOSURE) {
                let largest = y.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
                if (y[count - 1] - y[0]).abs() > CLOSURE * largest {
                    return Err(TableError::NotPeriodic {
                        name: name.into(),
                        row: count,
                        first: y[0],
                        last: y[count - 1],
                    });
                }
                x[count - 1] = first + period;
                y[count - 1] = y[0];
            } else if first + period <= last {
                // the gap is smaller than the last digit of the arguments
                return Err(TableError::PeriodTooShort {
                    name: name.into(),
                    span,
                    period,
                });
            } else {
                x.push(first + period);
                y.push(y[0]);
            }
        }
        let widths: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
        let secants: Vec<f64> = y
            .windows(2)
            .zip(&widths)
            .map(|(w, h)| (w[1] - w[0]) / h)
            .collect();
        let coefficients = match interpolation {
            Interpolation::Cubic => {
                let moments = match period {
                    Some(_) => periodic_moments(&widths, &secants),
                    None => moments(&widths, &secants, [Closing::Straight; 2]),
                };
                pieces(&y, &widths, &secants, &moments)
            }
            Interpolation::Monotone => {
                let slopes = monotone_slopes(&secants, period.is_some());
                (0..widths.len())
                    .map(|i| {
                        let (h, d, s0, s1) = (widths[i], secants[i], slopes[i], slopes[i + 1]);
                        [
                            y[i],
                            s0,
                            (3.0 * d - 2.0 * s0 - s1) / h,
                            (s0 + s1 - 2.0 * d) / (h * h),
                        ]
                    })
                    .collect()
            }
        };
        Ok(Curve {
            x,
            coefficients,
            period,
            interpolation,
            extrapolation,
        })
    }

    /// Whether an argument has no value although it is a number.
    pub fn is_outside(&self, argument: f64) -> bool {
        self.period.is_none()
            && self.extrapolation.is_none()
            && argument.is_finite()
            && !self.within(argument)
    }

    /// First and last argument; for a periodic table one period.
    pub fn domain(&self) -> (f64, f64) {
        match (self.x.first(), self.x.last()) {
            (Some(a), Some(b)) => (*a, *b),
            _ => (f64::NAN, f64::NAN),
        }
    }

    /// Whether an argument is within the points, except for rounding errors.
    fn within(&self, argument: f64) -> bool {
        let (first, last) = self.domain();
        let past = PAST_END * (last - first);
        (first - past..=last + past).contains(&argument)
    }

    /// The period, if it has one.
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// See [`super::Table::kinks`].
    pub fn kinks(&self, smooth: u8) -> Corners<'_> {
        let inner = match self.interpolation {
            Interpolation::Cubic => 2,
            Interpolation::Monotone => 1,
        };
        // a natural spline has no second derivative at its ends
        let end = match self.extrapolation {
            Some(Extrapolation::Hold) => 0,
            Some(Extrapolation::Linear) => inner,
            None => u8::MAX,
        };
        Corners::new(&self.x, self.period, smooth, inner, [end; 2])
    }

    /// The value (order 0) or a derivative with respect to the argument; orders above 3 are zero.
    ///
    /// NaN for an argument that is not finite. NaN outside the domain if no extrapolation is stated, except within
    /// a billionth of the span, where the polynomial of the last interval counts. At a point the interval to its
    /// right counts.
    pub fn evaluate(&self, x: f64, order: u8) -> f64 {
        let (first, last) = self.domain();
        if !x.is_finite() {
            return f64::NAN;
        }
        let x = match self.period {
            Some(period) => {
                let turns = ((x - first) / period).floor();
                (x - period * turns).clamp(first, last)
            }
            None => x,
        };
        if x < first || x > last {
            let end = if x < first { first } else { last };
            return match (self.extrapolation, order) {
                (None, _) if self.within(x) => self.inside(x, order),
                (None, _) => f64::NAN,
                (Some(_), 2..) | (Some(Extrapolation::Hold), 1) => 0.0,
                (Some(Extrapolation::Hold), _) => self.inside(end, 0),
                (Some(Extrapolation::Linear), 1) => self.inside(end, 1),
                (Some(Extrapolation::Linear), _) => {
                    self.inside(end, 0) + self.inside(end, 1) * (x - end)
                }
            };
        }
        self.inside(x, order)
    }

    fn inside(&self, x: f64, order: u8) -> f64 {
        let interval = self
            .x
            .partition_point(|p| *p <= x)
            .saturating_sub(1)
            .min(self.coefficients.len().saturating_sub(1));
        let (Some([c0, c1, c2, c3]), Some(start)) =
            (self.coefficients.get(interval), self.x.get(interval))
        else {
            return f64::NAN;
        };
        let t = x - start;
        match order {
            0 => c0 + t * (c1 + t * (c2 + t * c3)),
            1 => c1 + t * (2.0 * c2 + t * (3.0 * c3)),
            2 => 2.0 * c2 + t * (6.0 * c3),
            3 => 6.0 * c3,
            _ => 0.0,
        }
    }
}
