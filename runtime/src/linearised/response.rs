//! Frequency response: the steady vibration of outputs under a sinusoidal input.
//!
//! With `u = Re e^{iωt}` the outputs of `ξ̇ = A ξ + B u`, `y = C ξ + D u` settle to `y = Re (H e^{iωt})`,
//!
//! ```text
//! H(ω) = C (iω − A)⁻¹ B + D
//! ```
//!
//! if no motion grows. A is balanced and brought to Hessenberg form once, `A = Q P Qᵀ`, so that each frequency takes
//! an elimination with one entry below the diagonal: O(n²) for n coordinates (A. J. Laub, IEEE Trans. Autom. Control
//! 26 (1981) 407).
//!
//! **Frequencies.** Equal ratios from the lowest to the highest. Between them a resonance of little damping would be
//! missed. So every natural frequency has points of its own about the peak of its amplitude, `|λ|√(1 − 2ζ²)`: up to 3 half
//! widths `ζ|λ|` every eighth of one, and farther away each distance is a tenth longer than the one before, until the
//! points lie as far apart as the others. So the amplitude of a resonance changes by at most a tenth from point to point.

use super::eigen::balance;
use super::{Coefficients, LinearModes, Mode, StateSpace, run_linear};
use crate::error::RuntimeError;
use crate::transient::Observer;
use eng_system::code::Compiled;
use eng_system::system::Response;
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;

/// Distance of the points about a peak, in half widths, and the number of them on each side, so up to 3 half
/// widths. A choice: within these the amplitude falls to a third.
const NEAR: (f64, u32) = (0.125, 24);
/// Ratio of the distances farther away. A choice: the amplitude then changes by at most a tenth from point to
/// point.
const FARTHER: f64 = 1.1;
/// Half width, as a share of |λ|, that places the points about a mode without damping. A choice: a real
/// resonance is wider.
const NARROWEST: f64 = 1e-6;
/// Frequencies nearer to each other than this share are one. A choice above the rounding of a frequency.
const ALIKE: f64 = 1e-12;
/// Share of |λ| below which a mode has no damping: its damping is rounding. A choice: eigenvalues of a
/// balanced matrix have errors of some 1e-13 of the largest.
const UNDAMPED: f64 = 1e-9;

/// A frequency response.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyResponse {
    /// The modes and matrices of the linearised motion.
    pub modes: LinearModes,
    /// Frequencies (Hz), increasing.
    pub frequencies: Vec<f64>,
    /// H of every output at each frequency (SI).
    pub outputs: Vec<Vec<Complex<f64>>>,
    /// Natural frequencies within the range that have no damping (Hz). The response has no bound there.
    pub undamped: Vec<f64>,
}

/// The response of an analysis. `observer` gets start, progress and warnings, and no samples.
///
/// # Errors
/// Those of [`run_linear`]; a motion that grows, so that no vibration is steady. With coefficients held at a moment growth
/// is no property of the motion, so the response is that of the held coefficients.
pub fn run_response(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    response: &Response,
    observer: &mut dyn Observer,
) -> Result<FrequencyResponse, RuntimeError> {
    let modes = run_linear(compiled, overrides, &response.about, observer)?;
    let frozen = modes.coefficients == Coefficients::Frozen;
    if let Some(mode) = modes.modes.iter().find(|mode| !frozen && mode.grows()) {
        let part = mode.leading(1).first().map(|(part, _)| *part);
        return Err(RuntimeError::Grows {
            moment: modes.moment,
            frequency: mode.frequency(),
            growth: mode.value.re,
            part: part.and_then(|part| modes.parts.get(part).map(ToString::to_string)),
        });
    }
    let (frequencies, undamped) = frequencies(&modes.modes, response.range, response.points);
    let outputs = match &modes.matrices {
        Some(matrices) => Transfer::new(matrices, 0).at_all(&frequencies),
        None => None,
    };
    let Some(outputs) = outputs else {
        return Err(RuntimeError::Eigenvalues {
            size: modes.freedoms,
            what: "the response is no number".to_owned(),
        });
    };
    Ok(FrequencyResponse {
        modes,
        frequencies,
        outputs,
        undamped,
    })
}

/// The frequencies (Hz) of a response, and the natural frequencies without damping among them.
fn frequencies(modes: &[Mode], [low, high]: [f64; 2], points: u32) -> (Vec<f64>, Vec<f64>) {
    let decades = libm::log10(high / low);
    let count = (decades * f64::from(points)).ceil().max(1.0) as u32;
    let mut all: Vec<f64> = (0..=count)
        .map(|k| low * libm::pow(high / low, f64::from(k) / f64::from(count)))
        .collect();
    if let Some(last) = all.last_mut() {
        *last = high;
    }
    // distance of two neighbours, as a share of their frequency
    let apart = libm::pow(high / low, 1.0 / f64::from(count)) - 1.0;
    let mut undamped = Vec::new();
    for mode in modes.iter().filter(|mode| mode.oscillates()) {
        let (size, ratio) = (mode.undamped_frequency(), mode.damping_ratio());
        if ratio.abs() < UNDAMPED && (low..=high).contains(&size) {
            undamped.push(size);
        }
        let ratio = ratio.max(NARROWEST);
        let peak = 1.0 - 2.0 * ratio * ratio;
        if peak <= 0.0 {
            continue;
        }
        let (middle, width) = (libm::sqrt(peak) * size, ratio * size);
        let (step, number) = NEAR;
        let mut distance = 0.0;
        let mut place = 0;
        // beyond this the other points are as near to each other
        while place <= number || distance * width * (FARTHER - 1.0) < apart * middle {
            all.extend([middle - distance * width, middle + distance * width]);
            place += 1;
            distance = match place <= number {
                true => step * f64::from(place),
                false => distance * FARTHER,
            };
        }
    }
    all.retain(|f| (low..=high).contains(f));
    all.sort_by(f64::total_cmp);
    all.dedup_by(|b, a| *b - *a <= ALIKE * *b);
    // at such a frequency itself the response has no bound
    let near = |f: f64| undamped.iter().any(|u| (f - u).abs() <= UNDAMPED * u);
    all.retain(|f| !near(*f));
    (all, undamped)
}

/// Frequencies (Hz) at which outputs that an input does not move are found: one in each decade of any
/// machine. Their digits are a choice, so that none is a zero of the response by chance.
const PROBED: [f64; 8] = [0.0123, 0.123, 1.23, 12.3, 123.0, 1.23e3, 1.23e4, 1.23e5];
/// Share of the product of the sizes of C and of the motion below which an output does not follow the motion.
/// A choice some decades above the rounding of a solution.
const UNMOVED: f64 = 1e-10;

impl StateSpace {
    /// Places of outputs and inputs among those of the matrices, where H is zero up to rounding at each of several
    /// frequencies.
    pub fn independent(&self) -> Vec<[usize; 2]> {
        let mut found = Vec::new();
        for input in 0..self.b.ncols() {
            let transfer = Transfer::new(self, input);
            let mut moved = vec![false; self.c.nrows()];
            for motion in PROBED.iter().filter_map(|f| transfer.motion(TAU * f)) {
                let outputs = transfer.outputs(&motion);
                for (output, (moved, h)) in moved.iter_mut().zip(outputs).enumerate() {
                    let size = transfer.c.row(output).norm() * motion.norm();
                    *moved |= h.norm() > UNMOVED * size;
                }
            }
            let unmoved = moved.iter().enumerate().filter(|(_, moved)| !**moved);
            found.extend(unmoved.map(|(output, _)| [output, input]));
        }
        found
    }
}

/// The matrices with A in Hessenberg form.
pub(crate) struct Transfer {
    hessenberg: DMatrix<f64>,
    b: DVector<f64>,
    c: DMatrix<f64>,
    d: DVector<f64>,
}

impl Transfer {
    /// The form of matrices with one of their inputs.
    pub fn new(matrices: &StateSpace, input: usize) -> Transfer {
        let mut a = matrices.a.clone();
        let mut b = matrices.b.column(input).into_owned();
        let mut c = matrices.c.clone();
        let scales = balance(&mut a);
        for (k, scale) in scales.iter().enumerate() {
            b[k] /= scale;
            c.column_mut(k).scale_mut(*scale);
        }
        if a.nrows() > 0 {
            let (q, hessenberg) = a.hessenberg().unpack();
            (a, b, c) = (hessenberg, q.tr_mul(&b), c * q);
        }
        Transfer {
            hessenberg: a,
            b,
            c,
            d: matrices.d.column(input).into_owned(),
        }
    }

    /// H at frequencies (Hz); `None` if one of its numbers is not finite.
    fn at_all(&self, frequencies: &[f64]) -> Option<Vec<Vec<Complex<f64>>>> {
        frequencies.iter().map(|f| self.at(TAU * f)).collect()
    }

    /// H at an angular frequency (rad/s).
    pub fn at(&self, omega: f64) -> Option<Vec<Complex<f64>>> {
        let outputs = self.outputs(&self.motion(omega)?);
        let finite = |h: &Complex<f64>| h.re.is_finite() && h.im.is_finite();
        outputs.iter().all(finite).then_some(outputs)
    }

    /// The outputs of a motion ξ.
    fn outputs(&self, x: &DVector<Complex<f64>>) -> Vec<Complex<f64>> {
        let rows = self.c.row_iter().zip(self.d.iter());
        rows.map(|(c, d)| {
            let moved = c.iter().zip(x.iter());
            moved.map(|(c, x)| *x * *c).sum::<Complex<f64>>() + *d
        })
        .collect()
    }

    /// `(iω − A)⁻¹ B` at an angular frequency (rad/s), by elimination with the larger of two rows as pivot; `None` at a
    /// frequency without damping.
    fn motion(&self, omega: f64) -> Option<DVector<Complex<f64>>> {
        let n = self.hessenberg.nrows();
        let mut matrix = self.hessenberg.map(|x| Complex::new(-x, 0.0));
        for k in 0..n {
            matrix[(k, k)].im += omega;
        }
        let mut x = self.b.map(|x| Complex::new(x, 0.0));
        for k in 0..n.saturating_sub(1) {
            if matrix[(k + 1, k)].norm() > matrix[(k, k)].norm() {
                for j in k..n {
                    matrix.swap((k, j), (k + 1, j));
                }
                x.swap_rows(k, k + 1);
            }
            if matrix[(k + 1, k)] == Complex::new(0.0, 0.0) {
                continue;
            }
            let factor = matrix[(k + 1, k)] / matrix[(k, k)];
            for j in k + 1..n {
                let above = matrix[(k, j)];
                matrix[(k + 1, j)] -= factor * above;
            }
            let above = x[k];
            x[k + 1] -= factor * above;
        }
        for k in (0..n).rev() {
            let mut rest = x[k];
            for j in k + 1..n {
                rest -= matrix[(k, j)] * x[j];
            }
            x[k] = rest / matrix[(k, k)];
        }
        let finite = |x: &Complex<f64>| x.re.is_finite() && x.im.is_finite();
        x.iter().all(finite).then_some(x)
    }
}
