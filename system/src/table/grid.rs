//! Tables of two and three arguments: tensor products of cubic splines, C².
//!
//! The spline interpolates along each argument in turn, so its coefficients are those of the products of B-splines
//! (de Boor, A Practical Guide to Splines, ch. XVII): one number a point and four weights an argument, which takes a
//! 64th of the memory of polynomials by cells.

use super::spline::{Closing, moments, periodic_moments, pieces};
use super::{CLOSURE, MOST_ARGUMENTS, PAST_END};

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
        "the table is odd at an end of `{argument}`, but the value there is {value} in row {row}"
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

/// The numbers of a table of several arguments.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    axes: Vec<Axis>,
    /// Coefficients of the products of B-splines, the last argument fastest.
    coefficients: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq)]
struct Axis {
    name: String,
    /// Ends of the intervals; for a periodic argument the last is first + period.
    knots: Vec<f64>,
    /// The four B-splines of each interval, in powers of the distance from its start.
    basis: Vec<[[f64; 4]; 4]>,
    ends: Ends,
    /// Distance of the coefficients of neighbouring B-splines.
    stride: usize,
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
        self.sum(0, 0, &places)
    }

    /// The sum over the arguments from the `level`th on, with the coefficients from `start` on.
    #[inline]
    fn sum(&self, level: usize, start: usize, places: &[(usize, [f64; 4]); MOST_ARGUMENTS]) -> f64 {
        let (offset, [a, b, c, d]) = places[level];
        let from = start + offset;
        if level + 1 == self.axes.len() {
            return match self.coefficients.get(from..from + 4) {
                Some([p, q, r, s]) => a * p + b * q + c * r + d * s,
                _ => f64::NAN,
            };
        }
        let stride = self.axes[level].stride;
        let part = |k: usize| self.sum(level + 1, from + k * stride, places);
        a * part(0) + b * part(1) + c * part(2) + d * part(3)
    }
}

/// Checks the points and the period of an argument.
fn check_points(index: usize, argument: &Argument) -> Result<(), GridError> {
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

/// Whether the last of the points is the first of the next period.
fn is_closed(points: &[f64], period: f64) -> bool {
    match (points.first(), points.last()) {
        (Some(first), Some(last)) => last - first >= period * (1.0 - CLOSURE),
        _ => false,
    }
}

/// Checks that the values close a period and are zero at odd ends, but for rounding errors of the largest.
fn check_values(
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

/// The lines of a row-major block of numbers along one of its indices.
struct Lines {
    outer: usize,
    size: usize,
    stride: usize,
}

impl Lines {
    fn along(sizes: &[usize], index: usize) -> Lines {
        Lines {
            outer: sizes[..index].iter().product(),
            size: sizes[index],
            stride: sizes[index + 1..].iter().product(),
        }
    }

    /// First places of the lines.
    fn starts(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.outer).flat_map(move |block| {
            (0..self.stride).map(move |k| block * self.size * self.stride + k)
        })
    }
}

impl Axis {
    fn new(argument: Argument) -> Axis {
        let mut knots = argument.points;
        if let (Ends::Periodic(period), Some(first)) = (argument.ends, knots.first().copied()) {
            if is_closed(&knots, period) {
                knots.pop();
            }
            knots.push(first + period);
        }
        let basis = (0..knots.len() - 1).map(|i| basis(&knots, i)).collect();
        Axis {
            name: argument.name,
            knots,
            basis,
            ends: argument.ends,
            stride: 0,
        }
    }

    fn domain(&self) -> (f64, f64) {
        match (self.knots.first(), self.knots.last()) {
            (Some(a), Some(b)) => (*a, *b),
            _ => (f64::NAN, f64::NAN),
        }
    }

    /// The coefficients of the splines along this argument, for every line of a block of numbers. The argument's
    /// size grows to two more than its knots.
    fn interpolate(&self, numbers: &[f64], sizes: &[usize], index: usize) -> Vec<f64> {
        let widths: Vec<f64> = self.knots.windows(2).map(|w| w[1] - w[0]).collect();
        let lines = Lines::along(sizes, index);
        let size = self.knots.len() + 2;
        let mut result = vec![0.0; lines.outer * size * lines.stride];
        let mut values = Vec::with_capacity(self.knots.len());
        for start in lines.starts() {
            values.clear();
            let line = (0..lines.size).map(|k| numbers[start + k * lines.stride]);
            values.extend(line.take(self.knots.len()));
            if matches!(self.ends, Ends::Periodic(_)) {
                // the point at the end of the period is the first, given or not
                values.truncate(self.knots.len() - 1);
                values.push(values[0]);
            }
            let (block, within) = (start / (lines.size * lines.stride), start % lines.stride);
            let to = block * size * lines.stride + within;
            for (k, coefficient) in self.line(&values, &widths).enumerate() {
                result[to + k * lines.stride] = coefficient;
            }
        }
        result
    }

    /// The coefficients of the B-splines through the values at the knots. The coefficient of a B-spline is the
    /// polar form of any polynomial piece in its support at its three inner knots (Ramshaw, Computer Aided
    /// Geometric Design 6 (1989) 323).
    fn line<'v>(&'v self, values: &'v [f64], widths: &'v [f64]) -> impl Iterator<Item = f64> + 'v {
        let secants: Vec<f64> = values
            .windows(2)
            .zip(widths)
            .map(|(w, h)| (w[1] - w[0]) / h)
            .collect();
        let moments = match self.ends {
            Ends::Periodic(_) => periodic_moments(widths, &secants),
            Ends::Each(ends) => moments(
                widths,
                &secants,
                ends.map(|end| match end {
                    End::Open | End::Hold | End::Linear => Closing::Free,
                    End::Even => Closing::Level,
                    End::Odd => Closing::Straight,
                }),
            ),
        };
        let pieces = pieces(values, widths, &secants, &moments);
        (0..self.knots.len() + 2).map(move |j| {
            let interval = j.saturating_sub(1).min(widths.len() - 1);
            let [a, b, c, d] = pieces[interval];
            let [u, v, w] = [j, j + 1, j + 2].map(|k| knot(&self.knots, k) - self.knots[interval]);
            a + b * (u + v + w) / 3.0 + c * (u * v + u * w + v * w) / 3.0 + d * (u * v * w)
        })
    }

    /// The interval of an argument and the weights of its four coefficients, for a derivative of the given
    /// order. `None` where there is no value.
    fn weights(&self, x: f64, order: u8) -> Option<(usize, [f64; 4])> {
        if !x.is_finite() {
            return None;
        }
        let (first, last) = self.domain();
        let ends = match self.ends {
            Ends::Periodic(period) => {
                let turns = ((x - first) / period).floor();
                return Some(self.inside((x - period * turns).clamp(first, last), order));
            }
            Ends::Each(ends) => ends,
        };
        if (first..=last).contains(&x) {
            return Some(self.inside(x, order));
        }
        let (x, negative) = mirrored(x, order, (first, last), ends);
        if (first..=last).contains(&x) {
            let (interval, weights) = self.inside(x, order);
            return Some((interval, weights.map(|w| if negative { -w } else { w })));
        }
        let (end, at) = if x < first {
            (ends[0], first)
        } else {
            (ends[1], last)
        };
        let (interval, weights) = match (end, order) {
            (End::Hold, 0) => self.inside(at, 0),
            (End::Linear, 1) => self.inside(at, 1),
            (End::Linear, 0) => {
                let (interval, value) = self.inside(at, 0);
                let (_, slope) = self.inside(at, 1);
                let along = |k: usize| value[k] + (x - at) * slope[k];
                (interval, [along(0), along(1), along(2), along(3)])
            }
            (End::Hold | End::Linear, _) => (self.inside(at, 0).0, [0.0; 4]),
            // a mirrored argument may miss the end by rounding
            _ if (x - at).abs() <= PAST_END * (last - first) => self.inside(x, order),
            _ => return None,
        };
        Some((interval, weights.map(|w| if negative { -w } else { w })))
    }

    /// The interval of an argument and its weights by the interval's polynomials.
    fn inside(&self, x: f64, order: u8) -> (usize, [f64; 4]) {
        let interval = self
            .knots
            .partition_point(|p| *p <= x)
            .saturating_sub(1)
            .min(self.basis.len() - 1);
        let t = x - self.knots[interval];
        let weights = self.basis[interval].map(|[c0, c1, c2, c3]| match order {
            0 => c0 + t * (c1 + t * (c2 + t * c3)),
            1 => c1 + t * (2.0 * c2 + t * (3.0 * c3)),
            2 => 2.0 * c2 + t * (6.0 * c3),
            3 => 6.0 * c3,
            _ => 0.0,
        });
        (interval, weights)
    }
}

/// An argument mirrored at even and odd ends until it is inside or beyond an end without mirror, and whether the
/// derivative of the given order changes its sign on the way.
fn mirrored(x: f64, order: u8, (first, last): (f64, f64), ends: [End; 2]) -> (f64, bool) {
    let odd = ends.map(|end| end == End::Odd);
    let mirrors = ends.map(|end| matches!(end, End::Even | End::Odd));
    let (mirrored, crossed) = match mirrors {
        [true, true] => {
            // the pieces between the images of the ends, from −∞ to ∞; every second one is turned round
            let length = last - first;
            let piece = ((x - first) / length).floor();
            let within = (x - first - piece * length).clamp(0.0, length);
            let is_uneven = |count: f64| (count % 2.0).abs() == 1.0;
            let x = if is_uneven(piece) {
                last - within
            } else {
                first + within
            };
            // mirrors passed at the first and at the last end; only their parity counts
            let count = piece.abs();
            let (near, far) = (((count + 1.0) / 2.0).floor(), (count / 2.0).floor());
            let passed = if piece < 0.0 {
                [near, far]
            } else {
                [far, near]
            };
            (x, passed.map(is_uneven))
        }
        [true, false] if x < first => (first + (first - x), [true, false]),
        [false, true] if x > last => (last - (x - last), [false, true]),
        _ => (x, [false, false]),
    };
    let mut negative = false;
    for (crossed, odd) in crossed.into_iter().zip(odd) {
        // every mirror turns the argument's direction, and an odd one the value
        negative ^= crossed && (odd != (order % 2 == 1));
    }
    (mirrored, negative)
}

/// A knot of the B-splines: the j-th of those with the first and last point three times each.
fn knot(knots: &[f64], j: usize) -> f64 {
    knots[j.saturating_sub(2).min(knots.len() - 1)]
}

/// The four B-splines that are not zero on an interval, in powers of the distance from its start (the recurrence
/// of Cox and de Boor, on polynomials).
fn basis(knots: &[f64], interval: usize) -> [[f64; 4]; 4] {
    let start = knots[interval];
    // distances of the knots around the interval from its start: 0 to 2 up to it, 3 to 5 from its end on
    let at = |k: usize| knot(knots, interval + k) - start;
    let mut functions = [[0.0; 4]; 4];
    functions[0][0] = 1.0;
    for degree in 1..=3 {
        let mut next = [[0.0; 4]; 4];
        for (r, function) in next.iter_mut().enumerate().take(degree + 1) {
            // each B-spline is its left neighbour of lower degree rising, plus its right neighbour falling
            if r > 0 {
                let (from, to) = (at(2 + r - degree), at(2 + r));
                add_product(function, [-from, 1.0], to - from, &functions[r - 1]);
            }
            if r < degree {
                let (from, to) = (at(3 + r - degree), at(3 + r));
                add_product(function, [to, -1.0], to - from, &functions[r]);
            }
        }
        functions = next;
    }
    functions
}

/// Adds (factor₀ + factor₁ t)/divisor × polynomial, whose degree is below three.
fn add_product(to: &mut [f64; 4], factor: [f64; 2], divisor: f64, polynomial: &[f64; 4]) {
    for (k, coefficient) in polynomial.iter().enumerate().take(3) {
        to[k] += factor[0] / divisor * coefficient;
        to[k + 1] += factor[1] / divisor * coefficient;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn argument(points: Vec<f64>, ends: Ends) -> Argument {
        Argument {
            name: "x".to_owned(),
            points,
            ends,
        }
    }

    fn even_steps(from: f64, to: f64, count: usize) -> Vec<f64> {
        let step = (to - from) / (count - 1) as f64;
        (0..count).map(|i| from + step * i as f64).collect()
    }

    /// A grid through the values of a function.
    fn sampled(arguments: Vec<Argument>, f: &dyn Fn(&[f64]) -> f64) -> Grid {
        let mut places: Vec<Vec<f64>> = vec![Vec::new()];
        for argument in &arguments {
            let extend = |place: &Vec<f64>| {
                let longer = |x: &f64| place.iter().copied().chain([*x]).collect();
                argument
                    .points
                    .iter()
                    .map(longer)
                    .collect::<Vec<Vec<f64>>>()
            };
            places = places.iter().flat_map(extend).collect();
        }
        let values = places.iter().map(|place| f(place)).collect();
        Grid::new(arguments, values).expect("a grid")
    }

    const OPEN: Ends = Ends::Each([End::Open; 2]);

    #[test]
    fn polynomials_of_third_degree_are_exact_with_all_derivatives() {
        // p(x) q(y) r(z), points at uneven distances
        let p = |x: f64| {
            [
                1.0 - 2.0 * x + 0.5 * x * x + 0.25 * x * x * x,
                -2.0 + x + 0.75 * x * x,
                1.0 + 1.5 * x,
            ]
        };
        let q = |y: f64| [0.3 + y * y * y, 3.0 * y * y, 6.0 * y];
        let r = |z: f64| [2.0 - z + z * z, -1.0 + 2.0 * z, 2.0];
        let grid = sampled(
            vec![
                argument(vec![-1.0, -0.4, 0.1, 0.9, 2.0], OPEN),
                argument(vec![0.0, 0.5, 0.7, 1.5], OPEN),
                argument(vec![-2.0, 0.0, 1.0], OPEN),
            ],
            &|v| p(v[0])[0] * q(v[1])[0] * r(v[2])[0],
        );
        for (x, y, z) in [
            (-0.9, 0.1, -1.7),
            (0.1, 0.6, 0.3),
            (1.7, 1.4, 0.99),
            (2.0, 1.5, 1.0),
        ] {
            for (i, j, k) in [
                (0, 0, 0),
                (1, 0, 0),
                (0, 1, 0),
                (0, 0, 1),
                (1, 1, 0),
                (2, 0, 1),
                (1, 1, 1),
                (2, 2, 2),
            ] {
                let exact = p(x)[i] * q(y)[j] * r(z)[k];
                let found = grid.evaluate(&[x, y, z], &[i as u8, j as u8, k as u8]);
                assert!(
                    (found - exact).abs() < 1e-11 * (1.0 + exact.abs()),
                    "{x} {y} {z}, {i}{j}{k}: {found} {exact}"
                );
            }
        }
    }

    /// A function with a period in its first argument, even and odd in its second, plain in its third.
    fn wave(v: &[f64]) -> f64 {
        libm::exp(libm::sin(v[0])) * libm::cos(v[1])
            + 0.3 * libm::cos(2.0 * v[0]) * libm::cos(3.0 * v[1]) * libm::exp(0.4 * v[2])
    }

    fn wave_grid(n: usize) -> Grid {
        use core::f64::consts::{FRAC_PI_2, TAU};
        sampled(
            vec![
                argument(
                    even_steps(0.0, TAU, 2 * n + 1)[..2 * n].to_vec(),
                    Ends::Periodic(TAU),
                ),
                argument(
                    even_steps(0.0, FRAC_PI_2, n + 1),
                    Ends::Each([End::Even, End::Odd]),
                ),
                argument(even_steps(-1.0, 1.0, n + 1), OPEN),
            ],
            &wave,
        )
    }

    fn largest_error(grid: &Grid) -> f64 {
        let mut worst = 0.0_f64;
        for k in 0..4000_u32 {
            // a sequence that fills the box evenly (Roberts: powers of the plastic number's inverse)
            let place = |g: f64| (0.5 + g * f64::from(k)) % 1.0;
            let v = [
                20.0 * place(0.8191725134) - 10.0,
                20.0 * place(0.6710436067) - 10.0,
                2.0 * place(0.5497004779) - 1.0,
            ];
            worst = worst.max((grid.evaluate(&v, &[0, 0, 0]) - wave(&v)).abs());
        }
        worst
    }

    #[test]
    fn the_error_is_of_fourth_order_with_every_kind_of_end() {
        let [coarse, fine] = [8, 16].map(|n| largest_error(&wave_grid(n)));
        let order = libm::log2(coarse / fine);
        assert!(
            fine < 2e-3 && order > 3.7,
            "{coarse:e} {fine:e}: order {order}"
        );
    }

    #[test]
    fn derivatives_agree_with_differences_and_join_at_mirrors_and_points() {
        let grid = wave_grid(8);
        for v in [
            [0.3, 0.2, 0.1],
            [-7.0, 4.0, -0.9],
            [11.0, -6.1, 0.7],
            [2.0, 1.7, 0.0],
        ] {
            for orders in [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]] {
                for (k, h) in [(0, 1e-5), (1, 1e-5), (2, 1e-5)] {
                    let at = |s: f64| {
                        let mut moved = v;
                        moved[k] += s;
                        grid.evaluate(&moved, &orders)
                    };
                    let mut raised = orders;
                    raised[k] += 1;
                    let exact = grid.evaluate(&v, &raised);
                    let difference = (at(h) - at(-h)) / (2.0 * h);
                    assert!(
                        (difference - exact).abs() < 1e-6,
                        "{v:?} {orders:?} {k}: {difference} {exact}"
                    );
                }
            }
        }
        // C² at points, at both mirrors and where the period closes
        use core::f64::consts::{FRAC_PI_2, TAU};
        for v in [
            [TAU, 0.4, 0.2],
            [TAU / 16.0, 0.4, 0.2],
            [0.3, 0.0, 0.2],
            [0.3, FRAC_PI_2, 0.2],
            [0.3, -FRAC_PI_2, 0.2],
            [0.3, 0.4, 0.25],
        ] {
            for k in 0..3 {
                for order in 0..3 {
                    let at = |s: f64| {
                        let (mut moved, mut orders) = (v, [0; 3]);
                        moved[k] += s;
                        orders[k] = order;
                        grid.evaluate(&moved, &orders)
                    };
                    let (left, right) = (at(-1e-9), at(1e-9));
                    assert!(
                        (left - right).abs() < 1e-6,
                        "{v:?} {k} {order}: {left} {right}"
                    );
                }
            }
        }
    }

    #[test]
    fn values_are_those_of_scipy() {
        // SciPy 1.17.1: make_interp_spline(k=3) along each axis in turn: not-a-knot; bc_type='periodic'; first
        // derivative zero at the first point and second derivative zero at the last
        use core::f64::consts::{PI, TAU};
        let arguments = vec![
            argument(vec![0.0, 0.7, 1.1, 2.0, 3.2, 4.0], OPEN),
            argument(vec![0.0, 0.9, 2.1, 3.0, 4.2], Ends::Periodic(5.0)),
            argument(vec![0.0, 0.4, 1.0, 1.5], Ends::Each([End::Even, End::Odd])),
        ];
        let grid = sampled(arguments, &|v| {
            let (a, b, c) = (v[0], TAU * v[1] / 5.0, PI * v[2]);
            (libm::sin(1.3 * a) + 0.2 * a) * libm::exp(libm::cos(b)) * libm::cos(c / 3.0)
                + 0.1 * a * libm::sin(2.0 * b) * libm::cos(c)
        });
        for (place, orders, exact) in [
            ([0.3, 1.2, 0.2], [0, 0, 0], 0.4825261014660062),
            ([3.7, 4.9, 1.3], [0, 0, 0], -0.12370704097264654),
            ([2.5, 12.4, 0.7], [0, 0, 0], 0.1497785841395977),
            ([1.5, 3.3, 0.9], [1, 0, 0], -0.18323118142635456),
            ([1.5, 3.3, 0.9], [0, 1, 1], -0.5252221721809751),
            ([0.1, 0.4, 1.45], [0, 2, 0], -0.013675673843286752),
            ([3.9, 2.2, 0.5], [2, 0, 1], -0.5328927818583504),
        ] {
            let found = grid.evaluate(&place, &orders);
            assert!((found - exact).abs() < 1e-13, "{place:?}: {found} {exact}");
        }
    }

    #[test]
    fn few_points_take_the_lowest_degree() {
        use End::{Even, Odd, Open};
        // ends, points, values, place, value there by hand
        let cases: [(_, &[f64], &[f64], f64, f64); 8] = [
            ([Open, Open], &[0.0, 2.0], &[1.0, 5.0], 0.5, 2.0),
            ([Open, Open], &[0.0, 1.0, 3.0], &[0.0, 1.0, 9.0], 2.0, 4.0),
            ([Even, Open], &[0.0, 2.0], &[0.0, 4.0], 1.0, 1.0),
            ([Open, Even], &[-2.0, 0.0], &[4.0, 0.0], -1.0, 1.0),
            ([Even, Even], &[0.0, 1.0], &[1.0, 0.0], 0.5, 0.5),
            ([Odd, Odd], &[0.0, 1.0], &[0.0, 0.0], 0.5, 0.0),
            // x³ − 3 x has slope zero at ±1 and no second derivative at 0
            ([Odd, Even], &[0.0, 1.0], &[0.0, -2.0], 0.5, -1.375),
            (
                [Odd, Even],
                &[0.0, 0.5, 1.0],
                &[0.0, -1.375, -2.0],
                0.25,
                0.015625 - 0.75,
            ),
        ];
        for (ends, points, values, x, exact) in cases {
            let made = Grid::new(
                vec![argument(points.to_vec(), Ends::Each(ends))],
                values.to_vec(),
            );
            let found = made.expect("a grid").evaluate(&[x], &[0]);
            assert!(
                (found - exact).abs() < 1e-14,
                "{ends:?} {points:?}: {found} {exact}"
            );
        }
        // x² (3 − 2x) by three points, free at one end and level at the other: any cubic is met
        for (ends, mirror) in [([Even, Open], 1.0), ([Open, Even], -1.0)] {
            let f = |x: f64| x * x * (3.0 - 2.0 * mirror * x);
            let mut points = [0.0, 0.7, 2.0].map(|x| mirror * x).to_vec();
            points.sort_by(f64::total_cmp);
            let grid = sampled(vec![argument(points, Ends::Each(ends))], &|v| f(v[0]));
            for x in [0.3, 1.5].map(|x| mirror * x) {
                assert!(
                    (grid.evaluate(&[x], &[0]) - f(x)).abs() < 1e-13,
                    "{ends:?} {x}"
                );
            }
        }
    }

    #[test]
    fn outside_follows_each_end() {
        let ends = |a, b| Ends::Each([a, b]);
        let grid = sampled(
            vec![
                argument(vec![0.0, 1.0, 2.0, 3.0], ends(End::Hold, End::Linear)),
                argument(vec![0.0, 1.0, 2.0], ends(End::Odd, End::Open)),
            ],
            &|v| (1.0 + v[0]) * v[1],
        );
        let value = |x, y| grid.evaluate(&[x, y], &[0, 0]);
        assert!((value(-5.0, 1.5) - 1.5).abs() < 1e-13);
        assert_eq!(grid.evaluate(&[-5.0, 1.5], &[1, 0]), 0.0);
        assert!((value(7.0, 1.5) - 12.0).abs() < 1e-12);
        assert!((grid.evaluate(&[7.0, 1.5], &[1, 1]) - 1.0).abs() < 1e-12);
        assert_eq!(grid.evaluate(&[7.0, 1.5], &[2, 0]), 0.0);
        assert!((value(2.0, -1.5) + 4.5).abs() < 1e-13);
        assert!(
            value(2.0, 2.1).is_nan() && value(2.0, -2.1).is_nan() && value(f64::NAN, 1.0).is_nan()
        );
        assert_eq!(grid.outside(&[2.0, 2.1]), Some(1));
        assert_eq!(grid.outside(&[20.0, 2.0 + 1e-12]), None);
        assert!(value(2.0, 2.0 + 1e-12).is_finite() && value(2.0, -2.0 - 1e-12).is_finite());
        assert!(grid.evaluate(&[1.0], &[0]).is_nan());
    }

    #[test]
    fn wrong_grids_are_refused() {
        let good = || argument(vec![0.0, 1.0], OPEN);
        let build =
            |arguments: Vec<Argument>, values: &[f64]| Grid::new(arguments, values.to_vec());
        assert!(matches!(build(vec![], &[]), Err(GridError::Arguments(0))));
        assert!(matches!(
            build(vec![good(), good()], &[1.0; 3]),
            Err(GridError::Count {
                points: 4,
                values: 3
            })
        ));
        assert!(matches!(
            build(vec![good(), argument(vec![1.0], OPEN)], &[1.0; 2]),
            Err(GridError::TooFew { count: 1, .. })
        ));
        for bad in [0.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                build(vec![good(), argument(vec![0.0, bad], OPEN)], &[1.0; 4]),
                Err(GridError::NotRising { index: 1, .. })
            ));
        }
        assert!(matches!(
            build(vec![good(), good()], &[1.0, 2.0, f64::NAN, 4.0]),
            Err(GridError::NotFinite { row: 2 })
        ));
        for period in [0.5, -1.0, f64::NAN] {
            assert!(matches!(
                build(
                    vec![good(), argument(vec![0.0, 1.0], Ends::Periodic(period))],
                    &[1.0; 4]
                ),
                Err(GridError::PeriodTooShort { index: 1, .. })
            ));
        }
        assert!(matches!(
            build(
                vec![good(), argument(vec![0.0, 1.0], Ends::Periodic(1.0))],
                &[1.0, 1.0, 1.0, 2.0]
            ),
            Err(GridError::NotPeriodic { row: 3, .. })
        ));
        let odd = Ends::Each([End::Odd, End::Open]);
        assert!(matches!(
            build(
                vec![argument(vec![0.0, 1.0], odd), good()],
                &[0.0, 0.1, 1.0, 1.0]
            ),
            Err(GridError::NotOdd { row: 1, .. })
        ));
    }
}
