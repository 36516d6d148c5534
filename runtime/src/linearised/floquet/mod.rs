//! Modes about a motion that repeats, by the multipliers of its period.
//!
//! Where bodies turn, the coefficients of the linearised motion change (see the head of [`super`]). About a motion of the period T they
//! repeat, `A(t + T) = A(t)`, and the motions are `ξ(t) = e^{λt} p(t)` with p of the period T (G. Floquet, 1883). With X(t) the solutions for
//! unit starts, `Ẋ = A X`, and N come back as N(0) Q, `Q = N(0)ᵀ M N(T)`,
//!
//! ```text
//! W = diag(Q, Q, 1) X(T)       W ξ(0) = μ ξ(0)       λ = ln μ / T + 2πi k/T
//! ```
//!
//! Ṅ depends on place and velocity alone, so ẋ turns by the same Q. Left out, every multiplier would be wrong.
//!
//! - `shooting`: the motion, by Newton's method; `orbit`: the equations along it; `march`: X and N by Radau IIA, once more with steps of double length, whose
//!   difference is the error that is told; `multipliers`: eigenvalues of the product, small ones too; `harmonics`: k.
//! - **Neutral** multipliers, of free turning and sliding and of the phase of a motion that no drive holds, are 1 in double blocks that split
//!   by the root of the error; what lies so near to 1 is counted and not listed, and judged neither stable nor unstable.
//! - Stability is that of the others: `Re λ` is the same whatever k.

mod harmonics;
mod march;
mod multipliers;
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

/// Most distance from 1 that the split of whole and halved steps may excuse.
const MOST_SPLIT: f64 = 0.05;
/// Least distance from 1 of a multiplier that is not neutral.
const NEUTRAL: f64 = 1e-6;
/// A double 1 splits by so many times the root of the error.
const SPLIT: f64 = 4.0;
/// Rest of Wy − y, as a share of y, above which y is no direction that stays.
const PHASE: f64 = 1e-2;

/// The motion about which modes are, and how well they are known.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// T (s).
    pub period: f64,
    /// Steps of the march; the error is the difference to half as many.
    pub steps: usize,
    /// What is left of the state after the period less the one before, as a share of what is allowed (a thousandth of the smallest
    /// clearance, or of the tolerance of places).
    pub gap: f64,
    /// `|Wy − y|/|y|` of the motion's own direction; `None` where a drive or a load over time holds the phase.
    pub phase: Option<f64>,
    /// Distance from 1 within which a multiplier counts as neutral.
    pub neutral: f64,
    /// Multipliers that were lost in rounding, and the decay (1/s) from which on they are.
    pub lost: usize,
    /// See `lost`.
    pub reach: f64,
}

/// What a mode about an orbit has beside its λ.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeating {
    /// Which of the frequencies `Im λ + 2πk/T` it is, and how sure that is.
    pub harmonics: Harmonics,
    /// |Δλ| (1/s) between whole and halved steps.
    pub error: f64,
    /// What the coefficients are off by, for the state does not come back exactly, moves λ by about so much
    /// (1/s): what is left, as a share of the model's size, times |λ|.
    pub missed: f64,
    /// Whether the steps resolve it: |λ| h ≤ 1.
    pub resolved: bool,
}

/// Distance of two logarithms of multipliers; those of conjugates and of whole turns are one.
fn distance(a: Complex<f64>, b: Complex<f64>) -> f64 {
    [b, b.conj()]
        .into_iter()
        .map(|b| {
            let im = (a.im - b.im).rem_euclid(TAU);
            libm::hypot(a.re - b.re, im.min(TAU - im))
        })
        .fold(f64::INFINITY, f64::min)
}

/// How well the motion's own direction comes back: `|Wy − y|/|y|`; `None` where the motion has no direction of its own.
fn phase(round: &Round, whole: &DMatrix<f64>) -> Option<f64> {
    let y = round.along();
    let p = round.first.freedoms();
    let pace = TAU / round.period;
    let size = |y: &DVector<f64>| {
        let rates = y.rows(p, p).norm() / pace;
        libm::hypot(y.rows(0, p).norm(), rates)
    };
    let (off, own) = (size(&(whole * &y - &y)), size(&y));
    (own > 0.0)
        .then(|| off / own)
        .filter(|share| *share < PHASE)
}

/// |Δ ln μ| between halved and whole steps.
fn uncertainty(multiplier: &Multiplier, coarse: &[Multiplier]) -> f64 {
    coarse
        .iter()
        .map(|c| distance(multiplier.logarithm, c.logarithm))
        .fold(f64::INFINITY, f64::min)
}

/// The eigenpair of a multiplier with the frequency of its largest harmonic, as a positive one.
///
/// `error`: |Δλ| between whole and halved steps (1/s); `of_state`: what is left of the state after the
/// period, as a share of the model's size.
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
        // a pair that the march itself has split
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
