//! Tables of two and three arguments: tensor products of cubic splines, C².
//!
//! The spline interpolates along each argument in turn, so its coefficients are those of the products of B-splines
//! (de Boor, A Practical Guide to Splines, ch. XVII): one number for each point and four weights for each argument.
//! In three arguments this takes a 64th of the memory of polynomials by cells.

mod axis;
mod validity;

pub use validity::GridError;

use super::MOST_ARGUMENTS;
use super::corners::Corners;
use axis::Axis;
use validity::{check_points, check_values};

/// The continuation of a table beyond one end of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// None: there is no value.
    Open,
    /// The end value and zero slope.
    Hold,
    /// The end value and end slope.
    Linear,
    /// The mirror image: f(end + s) = f(end − s). The spline has zero slope there.
    Even,
    /// The mirror image with the other sign: f(end + s) = −f(end − s). The values at the end are zero.
    Odd,
}

/// The continuation of a table beyond both ends of an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ends {
    /// The function repeats with this period.
    Periodic(f64),
    /// Each end has its own continuation: before the first point, beyond the last.
    Each([End; 2]),
}

/// An argument of a grid: its name in messages, its points (rising), its ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// Name in messages.
    pub name: String,
    /// Points, rising, two at least.
    pub points: Vec<f64>,
    /// Continuation.
    pub ends: Ends,
}

/// The numbers of a table of several arguments.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    axes: Vec<Axis>,
    /// Coefficients of the products of B-splines, the last argument fastest.
    coefficients: Vec<f64>,
}

impl Grid {
    /// The spline through the values at all combinations of the arguments' points, the last argument fastest.
    ///
    /// An end that is neither even nor odd is free ("not a knot"), so the error is of fourth order in the
    /// distance of the points, up to the ends; three points make a parabola, two a line. With a period, the
    /// points at first + period may be given (with the values of the first) or left out.
    pub fn new(arguments: Vec<Argument>, values: Vec<f64>) -> Result<Grid, GridError> {
        if arguments.is_empty() || arguments.len() > MOST_ARGUMENTS {
            return Err(GridError::Arguments(arguments.len()));
        }
        for (index, argument) in arguments.iter().enumerate() {
            check_points(index, argument)?;
        }
        let mut sizes: Vec<usize> = arguments.iter().map(|a| a.points.len()).collect();
        let points = sizes
            .iter()
            .try_fold(1_usize, |n, size| n.checked_mul(*size));
        if points != Some(values.len()) {
            return Err(GridError::Count {
                points: points.unwrap_or(usize::MAX),
                values: values.len(),
            });
        }
        if let Some(row) = values.iter().position(|value| !value.is_finite()) {
            return Err(GridError::NotFinite { row });
        }
        let largest = values.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
        for (index, argument) in arguments.iter().enumerate() {
            check_values(argument, &sizes, index, &values, largest)?;
        }
        let mut coefficients = values;
        let mut axes = Vec::with_capacity(arguments.len());
        for (index, argument) in arguments.into_iter().enumerate() {
            let mut axis = Axis::new(argument);
            coefficients = axis.interpolate(&coefficients, &sizes, index);
            sizes[index] = axis.knots.len() + 2;
            axis.stride = 1;
            axes.push(axis);
        }
        for index in (0..axes.len().saturating_sub(1)).rev() {
            axes[index].stride = axes[index + 1].stride * sizes[index + 1];
        }
        Ok(Grid { axes, coefficients })
    }

    /// Number of its arguments.
    pub fn arguments(&self) -> usize {
        self.axes.len()
    }

    /// Name and domain of an argument; for a periodic one the domain is a period.
    pub fn argument(&self, index: usize) -> Option<(&str, (f64, f64))> {
        let axis = self.axes.get(index)?;
        Some((&axis.name, axis.domain()))
    }

    /// The period over an argument, if it has one.
    pub fn period(&self, index: usize) -> Option<f64> {
        match self.axes.get(index)?.ends {
            Ends::Periodic(period) => Some(period),
            Ends::Each(_) => None,
        }
    }

    /// See [`super::Table::kinks`].
    pub fn kinks(&self, index: usize, smooth: u8) -> Corners<'_> {
        // splines of third degree
        const INNER: u8 = 2;
        let Some(axis) = self.axes.get(index) else {
            return Corners::default();
        };
        let (period, ends) = match axis.ends {
            Ends::Periodic(period) => (Some(period), [INNER; 2]),
            Ends::Each(ends) => {
                let smooth_to = |end| match end {
                    End::Hold => 0,
                    End::Linear => 1,
                    // a mirror continues the spline
                    End::Even | End::Odd => INNER,
                    End::Open => u8::MAX,
                };
                (None, ends.map(smooth_to))
            }
        };
        Corners::new(&axis.knots, period, smooth, INNER, ends)
    }

    /// The first argument outside its points although it is a number and no continuation is stated.
    pub fn outside(&self, arguments: &[f64]) -> Option<usize> {
        let mut pairs = self.axes.iter().zip(arguments);
        pairs.position(|(axis, x)| x.is_finite() && axis.weights(*x, 0).is_none())
    }

    /// The value or a derivative of the given order in each argument; see [`super::Table::evaluate`].
    pub fn evaluate(&self, arguments: &[f64], orders: &[u8]) -> f64 {
        if arguments.len() != self.axes.len() || orders.len() != self.axes.len() {
            return f64::NAN;
        }
        let mut places = [(0, [0.0; 4]); MOST_ARGUMENTS];
        for (k, axis) in self.axes.iter().enumerate() {
            let Some((interval, weights)) = axis.weights(arguments[k], orders[k]) else {
                return f64::NAN;
            };
            places[k] = (interval * axis.stride, weights);
        }
        self.sum(&places[..self.axes.len()]).unwrap_or(f64::NAN)
    }

    /// The sum over all arguments. Those before the last are summed first, so that each sum adds four neighbouring numbers to four.
    fn sum(&self, places: &[(usize, [f64; 4])]) -> Option<f64> {
        let start = places.iter().map(|(offset, _)| offset).sum();
        let (last, others) = places.split_last()?;
        let terms = match others {
            [] => *self.four(start)?,
            [first] => self.along(0, start, &first.1)?,
            [first, second] => {
                let mut sum = [0.0; 4];
                for (k, weight) in second.1.iter().enumerate() {
                    let from = start + k * self.axes[1].stride;
                    add(&mut sum, *weight, &self.along(0, from, &first.1)?);
                }
                sum
            }
            _ => return None,
        };
        let [a, b, c, d] = last.1;
        Some(a * terms[0] + b * terms[1] + c * terms[2] + d * terms[3])
    }

    /// Four neighbouring coefficients along the last argument.
    fn four(&self, from: usize) -> Option<&[f64; 4]> {
        self.coefficients.get(from..)?.first_chunk()
    }

    /// The sum along an argument of four neighbours along the last one, from a place on.
    fn along(&self, argument: usize, from: usize, weights: &[f64; 4]) -> Option<[f64; 4]> {
        let mut sum = [0.0; 4];
        for (k, weight) in weights.iter().enumerate() {
            let neighbours = self.four(from + k * self.axes[argument].stride)?;
            add(&mut sum, *weight, neighbours);
        }
        Some(sum)
    }
}

/// Adds a multiple of four numbers to four others.
fn add(sum: &mut [f64; 4], weight: f64, numbers: &[f64; 4]) {
    for (sum, number) in sum.iter_mut().zip(numbers) {
        *sum += weight * number;
    }
}
