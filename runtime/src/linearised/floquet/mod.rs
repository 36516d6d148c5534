//! Modes about a motion that repeats, by the multipliers of its period.
//!
//! If bodies turn, the coefficients of the linearised motion change (see the head of [`super`]). About a
//! motion of the period T they repeat, `A(t + T) = A(t)`, and the solutions are `ξ(t) = e^{λt} p(t)` where p
//! has the period T (G. Floquet, 1883). Let X(t) be the solutions for unit starts, `Ẋ = A X`, and let N
//! return as N(0) Q, `Q = N(0)ᵀ M N(T)`. Then
//!
//! ```text
//! W = diag(Q, Q, 1) X(T)       W ξ(0) = μ ξ(0)       λ = ln μ / T + 2πi k/T
//! ```
//!
//! Ṅ depends only on position and velocity, so ẋ turns by the same Q. Without Q every multiplier would be
//! wrong.
//!
//! - `shooting` finds the motion by Newton's method, and `orbit` the equations along it. `march` integrates X
//!   and N by Radau IIA, and once more with steps of double length; the difference is the reported error.
//!   `multipliers` computes the eigenvalues of the product, small ones too, and `harmonics` finds k.
//! - **Neutral** multipliers belong to free rotation and sliding, and to the phase of a motion without a
//!   drive. They are 1 in double blocks, which split by the root of the error. Multipliers this near to 1 are
//!   counted and not listed. They count as neither stable nor unstable.
//! - The other multipliers decide stability: `Re λ` does not depend on k.

pub(crate) mod harmonics;
pub(crate) mod march;
pub(crate) mod multipliers;
mod orbit;
mod shooting;

pub use harmonics::Harmonics;

use super::constancy;
use super::{Coefficients, Found, LinearModes, Wanted, collected, complex};
use crate::error::RuntimeError;
use crate::rotation::V3;
use crate::simulation::Simulation;
use crate::transient::Observer;
use eng_system::system::{Extent, StepControl};
use harmonics::harmonics;
use multipliers::{Multiplier, multipliers};
use nalgebra::{Complex, DMatrix, DVector};
use orbit::{Round, period_of};
use shooting::repeating;
use std::f64::consts::TAU;

/// Largest distance from 1 that the difference of whole and halved steps can explain. A choice: a larger
/// difference comes from steps that are too long.
const MOST_SPLIT: f64 = 0.05;
/// Least distance from 1 of a multiplier that is not neutral. A choice: the root of an error of 1e-12.
const NEUTRAL: f64 = 1e-6;
/// Factor on the root of the error for the splitting of a double 1. A choice: the error is an estimate, and
/// its effect depends on the vectors of the block.
const SPLIT: f64 = 4.0;
/// Size of Wy − y, as a share of y, above which W does not keep the direction y. A choice far above the
/// errors of an integration.
const PHASE: f64 = 1e-2;

/// The repeating motion of the modes, with the errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// T (s).
    pub period: f64,
    /// Steps of the integration. The error is the difference from half as many.
    pub steps: usize,
    /// Gap of the state after a period, as a share of the permitted one (a thousandth of the smallest
    /// clearance, or of the position tolerance).
    pub gap: f64,
    /// `|Wy − y|/|y|` of the motion's own direction; `None` if a drive or a load over time holds the phase.
    pub phase: Option<f64>,
    /// Distance from 1 within which a multiplier counts as neutral.
    pub neutral: f64,
    /// Number of multipliers lost in rounding.
    pub lost: usize,
    /// Decay (1/s) above which multipliers are lost in rounding.
    pub reach: f64,
}

/// Further data of a mode about a repeating motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeating {
    /// Its frequency among `Im λ + 2πk/T`, and the certainty of this choice.
    pub harmonics: Harmonics,
    /// |Δλ| (1/s) between whole and halved steps.
    pub error: f64,
    /// Estimated error of λ (1/s) from the gap of the state after a period: the gap as a share of the model's
    /// size, times |λ|.
    pub missed: f64,
    /// Whether the steps resolve it: |λ| h ≤ 1.
    pub resolved: bool,
}

/// Distance of two logarithms of multipliers, up to conjugation and whole turns. Dimensionless.
fn distance(a: Complex<f64>, b: Complex<f64>) -> f64 {
    [b, b.conj()]
        .into_iter()
        .map(|b| {
            let im = (a.im - b.im).rem_euclid(TAU);
            libm::hypot(a.re - b.re, im.min(TAU - im))
        })
        .fold(f64::INFINITY, f64::min)
}

/// Error of the return of the motion's own direction: `|Wy − y|/|y|`; `None` if the motion has no direction
/// of its own. Dimensionless.
fn phase(round: &Round, whole: &DMatrix<f64>) -> Option<f64> {
    let y = round.along();
    let p = round.first.freedoms();
    let frequency = TAU / round.period;
    let size = |y: &DVector<f64>| {
        let rates = y.rows(p, p).norm() / frequency;
        libm::hypot(y.rows(0, p).norm(), rates)
    };
    let (off, own) = (size(&(whole * &y - &y)), size(&y));
    (own > 0.0)
        .then(|| off / own)
        .filter(|share| *share < PHASE)
}

/// |Δ ln μ| between halved and whole steps. Dimensionless.
fn uncertainty(multiplier: &Multiplier, coarse: &[Multiplier]) -> f64 {
    coarse
        .iter()
        .map(|c| distance(multiplier.logarithm, c.logarithm))
        .fold(f64::INFINITY, f64::min)
}

/// The eigenpair of a multiplier with the frequency of its largest harmonic, as a positive one.
///
/// `error` is |Δλ| between whole and halved steps (1/s). `of_state` is the gap of the state after a period,
/// as a share of the model's size.
fn found(
    multiplier: &Multiplier,
    round: &Round,
    axis: Option<V3>,
    error: f64,
    of_state: f64,
) -> Found {
    let own = harmonics(multiplier, &round.sights, round.period, axis);
    let shift = TAU * f64::from(own.leading) / round.period;
    let mut value = multiplier.logarithm / round.period + Complex::new(0.0, shift);
    let mut vector = multiplier.vectors[0].clone();
    if value.im < 0.0 {
        value = value.conj();
        vector = vector.map(|x| x.conj());
    }
    let p = round.first.freedoms();
    let rate = complex(&round.first.basis, &vector.rows(p, p).into_owned())
        + complex(&round.first.basis_rate, &vector.rows(0, p).into_owned());
    let h = round.period / round.steps as f64;
    Found {
        value,
        vector,
        rate,
        repeating: Some(Repeating {
            harmonics: own,
            error,
            missed: of_state * value.norm(),
            resolved: value.norm() * h <= 1.0,
        }),
    }
}

/// Modes about the repeating motion at or near the state of the last outputs.
pub(super) fn about_an_orbit(
    simulation: &mut Simulation,
    over: Extent,
    control: StepControl,
    wanted: Wanted,
    observer: &mut dyn Observer,
) -> Result<LinearModes, RuntimeError> {
    let period = period_of(simulation, over, observer)?;
    let (round, gap) = repeating(simulation, period, control, observer)?;
    let whole = Round::monodromy(&round.fine.segments);
    let phase = phase(&round, &whole);
    let model = simulation.model();
    let of_state = gap.share * model.tolerance / model.length;
    let neutral = (SPLIT * libm::sqrt(of_state.max(phase.unwrap_or(0.0)))).max(NEUTRAL);
    let all = multipliers(&round.fine.segments)?;
    let coarse = match &round.coarse {
        Some(march) => multipliers(&march.segments)?.found,
        None => Vec::new(),
    };
    let axis = constancy::axis(model, &round.start);
    let mut zeros = 0;
    let mut modes = Vec::new();
    for multiplier in &all.found {
        let value = harmonics::exponential(multiplier.logarithm);
        let error = uncertainty(multiplier, &coarse);
        // the error of the integration itself can split a double multiplier
        let split = (SPLIT * error).min(MOST_SPLIT);
        if (value - 1.0).norm() <= neutral.max(split) {
            zeros += if multiplier.real { 1 } else { 2 };
            continue;
        }
        let error = error / round.period;
        modes.push(found(multiplier, &round, axis, error, of_state));
    }
    let modes = collected(
        model,
        &round.start,
        round.moment,
        &round.first,
        wanted,
        modes,
    )?;
    let speed = match (simulation.cycle_rate(), period.angle) {
        (Some(rate), Some(angle)) => Some(libm::copysign(angle / round.period, rate)),
        (rate, _) => rate,
    };
    Ok(LinearModes {
        coefficients: Coefficients::Periodic,
        cycle_speed: speed,
        zeros,
        resolution: neutral / round.period,
        orbit: Some(Orbit {
            period: round.period,
            steps: round.steps,
            gap: gap.share,
            phase,
            neutral,
            lost: all.lost,
            reach: -all.floor / round.period,
        }),
        ..modes
    })
}
