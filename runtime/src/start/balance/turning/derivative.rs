//! Rates of periodic values, from the values at equal parts of the period.
//!
//! One trigonometric polynomial of the orders below N/2 passes through N values at `t_j = jT/N`, with N even.
//! (The part of order N/2 has no rate at the points.) Its rates there are `ẏ_j = Σ_k d(j − k) y_k` with
//! `d(0) = 0` and
//!
//! ```text
//! periodic      y(t + T) =  y(t):    d(l) = (π/T) (−1)^l cot(πl/N)
//! antiperiodic  y(t + T) = −y(t):    d(l) = (π/T) (−1)^l csc(πl/N)
//! ```
//!
//! A quaternion is antiperiodic if its body has made an odd number of turns. For smooth motions the error
//! decreases faster than any power of 1/N. Orders from N/2 on appear as lower ones. (L. N. Trefethen,
//! Spectral Methods in MATLAB, 2000, chapter 3; the second by the same sum over half-odd orders.)

use std::f64::consts::PI;

/// The sign of values after a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeats {
    /// The same sign.
    Same,
    /// The opposite sign.
    Opposite,
}

/// The derivative at the points of a period.
#[derive(Clone, Debug)]
pub struct PeriodicDerivative {
    /// d(l) for l = 0…N−1 (1/s).
    same: Vec<f64>,
    opposite: Vec<f64>,
}

impl PeriodicDerivative {
    /// The derivative for an even number of points over a period (s).
    pub fn new(points: usize, period: f64) -> PeriodicDerivative {
        let weights = |opposite: bool| -> Vec<f64> {
            (0..points)
                .map(|l| {
                    if l == 0 {
                        return 0.0;
                    }
                    let angle = PI * l as f64 / points as f64;
                    let sign = if l % 2 == 0 { 1.0 } else { -1.0 };
                    let numerator = if opposite { 1.0 } else { libm::cos(angle) };
                    sign * PI / period * numerator / libm::sin(angle)
                })
                .collect()
        };
        PeriodicDerivative {
            same: weights(false),
            opposite: weights(true),
        }
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.same.len()
    }

    /// Weight of the value at point k in the rate at point j. In 1/s.
    fn weight(&self, j: usize, k: usize, repeats: Repeats) -> f64 {
        let n = self.points();
        match (repeats, j >= k) {
            (Repeats::Same, _) => self.same[(n + j - k) % n],
            (Repeats::Opposite, true) => self.opposite[j - k],
            // after a whole period the sign changes: d(l − N) y = −d(l) y
            (Repeats::Opposite, false) => -self.opposite[n + j - k],
        }
    }

    /// Rates at all points of values at all points, `values[k]` and `rates[j]` of equal length.
    pub fn rates<V: AsRef<[f64]>>(&self, values: &[V], repeats: Repeats, rates: &mut [Vec<f64>]) {
        for (j, rate) in rates.iter_mut().enumerate() {
            rate.fill(0.0);
            for (k, value) in values.iter().enumerate() {
                let weight = self.weight(j, k, repeats);
                for (r, v) in rate.iter_mut().zip(value.as_ref()) {
                    *r += weight * v;
                }
            }
        }
    }
}

/// Values at twice as many points. Those in between come from the trigonometric polynomial through the
/// points, with Nyquist's order as a cosine, `y(t_{j+½}) = Σ_k (−1)^l cot(π(l + ½)/N)/N y_k` with
/// `l = j − k`.
pub fn refined<V: AsRef<[f64]>>(values: &[V]) -> Vec<Vec<f64>> {
    let n = values.len();
    let weights: Vec<f64> = (0..n)
        .map(|l| {
            let angle = PI * (l as f64 + 0.5) / n as f64;
            let sign = if l % 2 == 0 { 1.0 } else { -1.0 };
            sign * libm::cos(angle) / libm::sin(angle) / n as f64
        })
        .collect();
    let mut fine = Vec::with_capacity(2 * n);
    for (j, own) in values.iter().enumerate() {
        fine.push(own.as_ref().to_vec());
        let mut between = vec![0.0; own.as_ref().len()];
        for (k, value) in values.iter().enumerate() {
            let weight = weights[(n + j - k) % n];
            for (b, v) in between.iter_mut().zip(value.as_ref()) {
                *b += weight * v;
            }
        }
        fine.push(between);
    }
    fine
}
