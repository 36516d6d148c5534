//! One argument of a grid: its B-splines, the coefficients along it, and the weights at a value.

use super::{Argument, End, Ends};
use crate::table::spline::{Closing, moments, periodic_moments, pieces};
use crate::table::{CLOSURE, PAST_END};
use std::array::from_fn;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) name: String,
    /// Ends of the intervals; for a periodic argument the last is first + period.
    pub(super) knots: Vec<f64>,
    /// The four B-splines of each interval, in powers of the distance from its start: for each power, the factors of all four.
    basis: Vec<[[f64; 4]; 4]>,
    pub(super) ends: Ends,
    /// Distance of the coefficients of neighbouring B-splines.
    pub(super) stride: usize,
}

/// The lines of a row-major block of numbers along one of its indices.
pub(super) struct Lines {
    outer: usize,
    size: usize,
    pub(super) stride: usize,
}

impl Lines {
    pub(super) fn along(sizes: &[usize], index: usize) -> Lines {
        Lines {
            outer: sizes[..index].iter().product(),
            size: sizes[index],
            stride: sizes[index + 1..].iter().product(),
        }
    }

    /// First places of the lines.
    pub(super) fn starts(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.outer).flat_map(move |block| {
            (0..self.stride).map(move |k| block * self.size * self.stride + k)
        })
    }
}

/// Whether the last of the points is the first of the next period.
pub(super) fn is_closed(points: &[f64], period: f64) -> bool {
    match (points.first(), points.last()) {
        (Some(first), Some(last)) => last - first >= period * (1.0 - CLOSURE),
        _ => false,
    }
}

impl Axis {
    pub(super) fn new(argument: Argument) -> Axis {
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

    pub(super) fn domain(&self) -> (f64, f64) {
        match (self.knots.first(), self.knots.last()) {
            (Some(a), Some(b)) => (*a, *b),
            _ => (f64::NAN, f64::NAN),
        }
    }

    /// The coefficients of the splines along this argument, for every line of a block of numbers. The argument's
    /// size grows to two more than its knots.
    pub(super) fn interpolate(&self, numbers: &[f64], sizes: &[usize], index: usize) -> Vec<f64> {
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
    pub(super) fn weights(&self, x: f64, order: u8) -> Option<(usize, [f64; 4])> {
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
        let interval = points_up_to(&self.knots, x)
            .saturating_sub(1)
            .min(self.basis.len() - 1);
        let t = x - self.knots[interval];
        let [c0, c1, c2, c3] = &self.basis[interval];
        let weights = match order {
            0 => from_fn(|k| c0[k] + t * (c1[k] + t * (c2[k] + t * c3[k]))),
            1 => from_fn(|k| c1[k] + t * (2.0 * c2[k] + t * (3.0 * c3[k]))),
            2 => from_fn(|k| 2.0 * c2[k] + t * (6.0 * c3[k])),
            3 => c3.map(|factor| 6.0 * factor),
            _ => [0.0; 4],
        };
        (interval, weights)
    }
}

/// Number of points that are not above x. Of few points a count without branches is faster than a search.
fn points_up_to(points: &[f64], x: f64) -> usize {
    // a choice
    const FEW: usize = 64;
    if points.len() > FEW {
        return points.partition_point(|p| *p <= x);
    }
    points.iter().map(|p| u64::from(*p <= x)).sum::<u64>() as usize
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
/// of Cox and de Boor, on polynomials): for each power, the factors of all four.
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
    from_fn(|power| functions.map(|function| function[power]))
}

/// Adds (factor₀ + factor₁ t)/divisor × polynomial, whose degree is below three.
fn add_product(to: &mut [f64; 4], factor: [f64; 2], divisor: f64, polynomial: &[f64; 4]) {
    for (k, coefficient) in polynomial.iter().enumerate().take(3) {
        to[k] += factor[0] / divisor * coefficient;
        to[k + 1] += factor[1] / divisor * coefficient;
    }
}
