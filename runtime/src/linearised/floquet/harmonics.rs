//! The frequency of a mode among `Im λ + 2πk/T`.
//!
//! The multiplier does not determine k. `u(t) e^{−λt}` repeats, so it has harmonics. They are those of the
//! moves as seen from the ground: position and rotation of rigid bodies, and the moves of the markers of
//! flexible ones, weighted by mass and inertia. The harmonic with the largest share gives the frequency. For
//! a real multiplier the harmonics k and −k (−1 − k for a negative one) are one real motion, so their shares
//! are added.

use super::super::equations::Equations;
use super::multipliers::Multiplier;
use crate::chain::Placed;
use crate::dynamics::Dynamics;
use crate::model::Model;
use crate::rotation::V3;
use crate::state::State;
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;

/// Share above which a further harmonic is reported. A choice: smaller ones do not change the look of a mode.
const REPORTED: f64 = 0.1;

/// The harmonics of a mode's motion as the ground sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Harmonics {
    /// k of the largest: `Im λ = Im ln μ/T + 2πk/T`.
    pub leading: i32,
    /// Its share of the motion, 0…1. Below one half the frequency is ambiguous.
    pub share: f64,
    /// Frequencies (rad/s, positive) of further harmonics above a tenth, with their shares, the largest
    /// first.
    pub further: Vec<(f64, f64)>,
    /// Sense of rotation of the leading harmonic: 1 for a circle in the sense of the fastest body (forward
    /// whirl), −1 for a circle against it (backward whirl), 0 for a straight line. `None` if no body turns,
    /// or if the multiplier is real.
    pub whirl: Option<f64>,
}

/// Sense of a harmonic `Re (c e^{iωt})` about an axis of length 1, rows of c in threes along the ground's
/// axes: with `c = a + ib` it is `−2 sign(ω) Σ n·(a × b) / Σ (|a|² + |b|²)`, without the parts along n. It is
/// zero if nothing moves across n.
fn sense(c: &[Complex<f64>], axis: &V3, frequency: f64) -> f64 {
    let (mut around, mut whole) = (0.0, 0.0);
    for part in c.chunks_exact(3) {
        let [a, b] = [0, 1].map(|imaginary| {
            let of = |z: Complex<f64>| if imaginary == 1 { z.im } else { z.re };
            let v = V3::new(of(part[0]), of(part[1]), of(part[2]));
            v - axis * axis.dot(&v)
        });
        around -= 2.0 * axis.dot(&a.cross(&b));
        whole += a.norm_squared() + b.norm_squared();
    }
    if whole > 0.0 {
        libm::copysign(1.0, frequency) * around / whole
    } else {
        0.0
    }
}

/// Matrix from moves in ground axes (one for each velocity) to weighted moves as seen from the ground.
pub(super) fn seen(model: &Model, state: &State, equations: &Equations) -> DMatrix<f64> {
    let mut dynamics = Dynamics::new(model);
    dynamics.place(model, state.time, &state.pose, &state.velocity);
    let basis = &equations.basis;
    let columns = basis.ncols();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (index, body) in model.bodies.iter().enumerate() {
        let v = body.velocity;
        let mass = equations.mass[(v, v)].abs();
        let inertia = (v + 3..v + 6)
            .map(|i| equations.mass[(i, i)].abs())
            .sum::<f64>()
            / 3.0;
        let weights = |of: f64| [libm::sqrt(mass / of), libm::sqrt(inertia / of)];
        let own: Vec<usize> = (0..model.markers.len())
            .filter(|m| body.modes() > 0 && model.markers[*m].body == Some(index))
            .collect();
        if own.is_empty() {
            let [by_place, by_turn] = weights(1.0);
            for i in 0..6 {
                let weight = if i < 3 { by_place } else { by_turn };
                rows.push(basis.row(v + i).iter().map(|x| weight * x).collect());
            }
            continue;
        }
        let [by_place, by_turn] = weights(own.len() as f64);
        for marker in own {
            let frame = dynamics.frame(model, index);
            let axes = frame.rotation * Placed::new(&frame, &model.markers[marker]).orientation;
            let mut moves = vec![vec![0.0; columns]; 6];
            for k in 0..columns {
                let along = equations.in_body_axes(basis.column(k).into_owned());
                let part = &along.as_slice()[v..v + body.width()];
                let [x, y, z, a, b, c] = dynamics.marker_along(model, marker, part);
                // rotations are in the marker's axes
                let turned = axes * V3::new(a, b, c);
                for (i, x) in [x, y, z].into_iter().enumerate() {
                    moves[i][k] = by_place * x;
                    moves[3 + i][k] = by_turn * turned[i];
                }
            }
            rows.extend(moves);
        }
    }
    DMatrix::from_fn(rows.len(), columns, |i, k| rows[i][k])
}

/// The observed moves at one time of the period, as a matrix on ξ at the beginning of the segment.
pub(super) struct Sight {
    /// Segment, from 0.
    pub segment: usize,
    /// Time since the beginning of the period (s).
    pub time: f64,
    /// Weighted moves × ξ.
    pub seen: DMatrix<f64>,
}

/// e^z by `libm`.
pub fn exponential(z: Complex<f64>) -> Complex<f64> {
    Complex::new(libm::cos(z.im), libm::sin(z.im)) * libm::exp(z.re)
}

/// `c_k = Σ_j u_j e^{−2πi jk/n}` in place, n a power of two (J. W. Cooley, J. W. Tukey, Math. Comput. 19
/// (1965) 297).
pub fn transform(values: &mut [Complex<f64>]) {
    let n = values.len();
    if n < 2 {
        return;
    }
    let bits = n.trailing_zeros();
    for i in 0..n {
        let j = i.reverse_bits() >> (usize::BITS - bits);
        if i < j {
            values.swap(i, j);
        }
    }
    let mut length = 2;
    while length <= n {
        let half = length / 2;
        for k in 0..half {
            let angle = -TAU * k as f64 / length as f64;
            let turn = Complex::new(libm::cos(angle), libm::sin(angle));
            for first in (k..n).step_by(length) {
                let (even, odd) = (values[first], values[first + half] * turn);
                values[first] = even + odd;
                values[first + half] = even - odd;
            }
        }
        length *= 2;
    }
}

/// Harmonics of a mode. `sights` are at equal distances over the period (s), and their number is a power of
/// two. `axis` is that of the fastest body.
pub(super) fn harmonics(
    mode: &Multiplier,
    sights: &[Sight],
    period: f64,
    axis: Option<V3>,
) -> Harmonics {
    let exponent = mode.logarithm / period;
    let turned: Vec<DVector<Complex<f64>>> = sights
        .iter()
        .map(|sight| {
            let v = &mode.vectors[sight.segment];
            let (re, im) = (v.map(|x| x.re), v.map(|x| x.im));
            let u = (&sight.seen * re).zip_map(&(&sight.seen * im), Complex::new);
            // the vectors of later segments are divided by the growth over the earlier segments
            let equal = period * sight.segment as f64 / mode.vectors.len() as f64;
            u * exponential(exponent * (equal - sight.time))
        })
        .collect();
    let count = turned.len();
    let mut sums = vec![0.0; count];
    let rows = turned.first().map_or(0, DVector::len);
    let mut line = vec![Complex::new(0.0, 0.0); count];
    for row in 0..rows {
        for (place, u) in line.iter_mut().zip(&turned) {
            *place = u[row];
        }
        transform(&mut line);
        for (sum, c) in sums.iter_mut().zip(&line) {
            *sum += c.norm_sqr();
        }
    }
    let half = (count as i32 - 1) / 2;
    let mut energies: Vec<(i32, f64)> = (-half..=half)
        .map(|k| (k, sums[k.rem_euclid(count as i32) as usize]))
        .collect();
    let whole: f64 = energies.iter().map(|(_, e)| e).sum();
    if whole <= 0.0 {
        return Harmonics {
            leading: 0,
            share: 1.0,
            further: Vec::new(),
            whirl: None,
        };
    }
    if mode.real {
        let mirror = |k: i32| if mode.logarithm.im > 0.0 { -1 - k } else { -k };
        let of = |k: i32| {
            energies
                .iter()
                .find(|(n, _)| *n == k)
                .map_or(0.0, |(_, e)| *e)
        };
        energies = (0..=half)
            .map(|k| {
                (
                    k,
                    if mirror(k) == k {
                        of(k)
                    } else {
                        of(k) + of(mirror(k))
                    },
                )
            })
            .collect();
    }
    energies.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let (leading, largest) = energies.first().copied().unwrap_or((0, whole));
    let signed = |k: i32| exponent.im + TAU * f64::from(k) / period;
    let frequency = |k: i32| signed(k).abs();
    let whirl = axis.filter(|_| !mode.real).map(|axis| {
        let share = |j: usize| {
            let turns = (j as f64 * f64::from(leading) / count as f64).fract();
            exponential(Complex::new(0.0, -TAU * turns))
        };
        let mut c = vec![Complex::new(0.0, 0.0); rows];
        for (j, u) in turned.iter().enumerate() {
            let factor = share(j);
            for (sum, x) in c.iter_mut().zip(u.iter()) {
                *sum += x * factor;
            }
        }
        sense(&c, &axis, signed(leading))
    });
    Harmonics {
        leading,
        share: largest / whole,
        further: energies
            .iter()
            .skip(1)
            .take_while(|(_, e)| *e > REPORTED * whole)
            .map(|(k, e)| (frequency(*k), e / whole))
            .collect(),
        whirl,
    }
}
