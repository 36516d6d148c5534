//! Eigenvalues and modes of the coupled system, linearised about a state of its motion.
//!
//! **Perturbed motion.** A motion satisfies `M v̇ − Q(q, v, z, t) + Gᵀλ = 0`, `ż = f`, `Φ(q, t) = 0`. Small
//! moves u from it (rotations in ground axes, see `axes`) obey
//!
//! ```text
//! M ü + D u̇ + K u + Gᵀδλ + F δz = 0        G u = 0        δż = f_q u + f_v u̇ + f_z δz
//! ```
//!
//! with the exact blocks of Newton's matrix. K contains the stiffness of the constraints `∂(Gᵀλ)/∂q`, the
//! inertia of the frozen velocities and accelerations, springs, films and gravity. Time is held, and so is
//! every drive. `u = N x` with `GN = 0`, `NᵀMN = 1`. N changes along the motion. The basis with `NᵀMṄ = 0`
//! turns least (in the mass norm): `[M Gᵀ; G 0][Ṅ; μ] = [0; −ĠN]`. Then `NᵀMN̈ = −ṄᵀMṄ − NᵀṀṄ`, and
//!
//! ```text
//! ẍ + C ẋ + K_x x = −NᵀF δz        C = NᵀDN        K_x = NᵀKN + NᵀDṄ − ṄᵀMṄ − NᵀṀṄ
//! ```
//!
//! without an approximation so far. (Without the terms of Ṅ a body that turns about a pin would have a false
//! stiffness.)
//!
//! **Frozen time.** The coefficients are held at their values of the moment, and the eigenvalues of
//! `ξ̇ = A ξ`, `ξ = (x, ẋ, z)`, are computed. This is exact if the coefficients are constant: at rest, in
//! steady travel, and about the steady rotation of rigid bodies of revolution. `constancy` and `over_time` test it.
//! Otherwise the modes describe one moment. They are computed only on request ([`Wanted::frozen`]) and
//! marked. They are right for motions that are fast compared with the change of the coefficients, such as an
//! engine's modes well above its speed, and wrong for whirl and its damping. Amplitudes of a flexible body
//! are in its own axes, so the frequency of the bending of a shaft that turns at Ω is shifted by up to ±Ω.
//!
//! **Eigenvalues** `λ = −δ ± iω`: damped frequency ω/2π, undamped |λ|/2π, damping ratio −Re λ/|λ|. Rounding
//! splits a double zero, such as that of a free rotation, by the root of the rounding error. So all
//! eigenvalues below that root ([`LinearModes::resolution`]) are computed again about zero. Those that only
//! rounding holds count as zeros (`slow`).

mod axes;
mod constancy;
pub(crate) mod eigen;
mod energies;
mod equations;
pub(crate) mod floquet;
mod outputs;
mod over_time;
pub(crate) mod response;
mod run;
mod sides;
mod slow;
pub(crate) mod state_space;
mod variation;

pub use energies::{Part, Shares, parts_of, stores};
pub use equations::Equations;
pub use floquet::{Harmonics, Orbit, Repeating};
pub use response::{FrequencyResponse, run_response};
pub use run::run_linear;
pub use state_space::StateSpace;

use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::state::State;
use energies::{Ledger, parts};
use nalgebra::{Complex, DMatrix, DVector};
use outputs::{Direction, Probe};

/// Share of |λ| below which growth is rounding. A choice: eigenvalues of a balanced matrix have errors of
/// some 1e-13 of the largest.
const GROWTH: f64 = 1e-9;
/// Relative distance within which numbers of a mode count as equally large. The first of the largest is made
/// real, so that rounding does not decide the phase. A choice above the rounding of a vector.
const ALIKE: f64 = 1e-6;

/// The selection of modes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Number of the slowest oscillations, and of the slowest motions without oscillation; `None` means all.
    pub number: Option<u32>,
    /// Largest |λ| (rad/s); `None` means no limit.
    pub up_to: Option<f64>,
    /// Whether to hold changing coefficients at their values of the moment. Otherwise they are an error.
    pub frozen: bool,
}

/// The kind of coefficients of the linearised motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coefficients {
    /// Constant along the motion, or at rest.
    Constant,
    /// Held at their values of the moment.
    Frozen,
    /// Periodic, with the modes of a period.
    Periodic,
}

/// A motion `u(t) = Re (place e^{λt})` of the linearised system, scaled so that its kinetic energy has the
/// peak of 1 J: `½ |λ|² u* M u = 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// λ (1/s), its imaginary part not negative.
    pub value: Complex<f64>,
    /// Moves of every body in the order of the model's velocities: δr (m), small rotation (rad), both in
    /// ground axes, modal amplitudes. The largest, in the model's length and angles, is real and positive.
    pub place: DVector<Complex<f64>>,
    /// The shares of its energy.
    pub shares: Shares,
    /// Amplitude of every channel (SI).
    pub outputs: Vec<Complex<f64>>,
    /// Uncertainty of λ (1/s) from slight changes of the coefficients, which were held.
    pub uncertain: f64,
    /// Further data about a repeating motion. Place, shares and outputs belong to the beginning of its
    /// period.
    pub repeating: Option<Repeating>,
}

impl Mode {
    /// Whether it oscillates.
    pub fn oscillates(&self) -> bool {
        self.value.im > 0.0
    }

    /// ω/2π (Hz); zero without oscillation.
    pub fn frequency(&self) -> f64 {
        self.value.im / std::f64::consts::TAU
    }

    /// |λ|/2π (Hz).
    pub fn undamped_frequency(&self) -> f64 {
        self.value.norm() / std::f64::consts::TAU
    }

    /// −Re λ/|λ|. Dimensionless; positive for a motion that decays.
    pub fn damping_ratio(&self) -> f64 {
        -self.value.re / self.value.norm()
    }

    /// −2π Re λ/ω: logarithm of the ratio of an amplitude to the one a period of the oscillation later. It is
    /// not a number for a motion without oscillation.
    pub fn logarithmic_decrement(&self) -> f64 {
        if self.oscillates() {
            -std::f64::consts::TAU * self.value.re / self.value.im
        } else {
            f64::NAN
        }
    }

    /// Whether it grows by more than its uncertainty. The zero of a free motion is double, and rounding splits it by its root
    /// with any sign; `slow` counts it as a zero, so it is no mode.
    pub fn grows(&self) -> bool {
        let uncertain = |r: &Repeating| r.error + r.missed;
        let error = self.repeating.as_ref().map_or(self.uncertain, uncertain);
        self.value.re > (GROWTH * self.value.norm()).max(error)
    }

    /// Index and share of the parts with the most kinetic energy, the largest first.
    pub fn leading(&self, most: usize) -> Vec<(usize, f64)> {
        let mut order: Vec<(usize, f64)> =
            self.shares.kinetic.iter().copied().enumerate().collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        order.truncate(most);
        order
    }
}

/// The modes of a linearised motion.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearModes {
    /// The moment of the linearisation.
    pub moment: Moment,
    /// Whether the modes belong to the motion or to one moment.
    pub coefficients: Coefficients,
    /// The rate of the cycle's angle there (rad/s), if the model has a cycle and the caller asked for it.
    pub cycle_speed: Option<f64>,
    /// Freedoms: coordinates x.
    pub freedoms: usize,
    /// States of elements: z.
    pub states: usize,
    /// The parts of [`Shares::kinetic`].
    pub parts: Vec<Part>,
    /// The paths of [`Shares::potential`] and [`Shares::lost`].
    pub stores: Vec<String>,
    /// Oscillations in the order of |λ|, then motions without oscillation in that order.
    pub modes: Vec<Mode>,
    /// Number of oscillations and of other motions outside the selection.
    pub left_out: [usize; 2],
    /// Number of zero eigenvalues. They belong to drift and rotation that nothing holds or drives.
    pub zeros: usize,
    /// Limit of |λ| (rad/s) below which an eigenvalue is computed about zero. It counts as zero if only
    /// rounding holds it.
    pub resolution: f64,
    /// Uncertainty of the eigenvalues, as a share of their size, from slight changes of the coefficients.
    pub variation: f64,
    /// The repeating motion, if the modes are those of its period.
    pub orbit: Option<Orbit>,
    /// The matrices of small motions about the same state, if the analysis names inputs and outputs.
    pub matrices: Option<StateSpace>,
}

impl LinearModes {
    /// The oscillations.
    pub fn oscillations(&self) -> impl Iterator<Item = &Mode> {
        self.modes.iter().filter(|m| m.oscillates())
    }
}

/// The kind of the coefficients at a state, and a bound on the effect of their changes on each eigenvalue, as
/// a share of its size.
///
/// # Errors
/// When coefficients change and are not to be taken as `frozen`.
fn tested(
    model: &Model,
    state: &State,
    equations: &Equations,
    moment: Moment,
    frozen: bool,
) -> Result<(Coefficients, f64), RuntimeError> {
    let here = constancy::Here::new(model, state, equations);
    let refused = match constancy::varying(model, state, &here, moment, !frozen) {
        Err(bodies) => RuntimeError::Turning { moment, bodies },
        Ok(by_turning) => match constancy::leaving(model, state, &here, moment) {
            Some(body) => RuntimeError::Unsteady {
                moment,
                body: Box::new(body),
            },
            None => match over_time::over_time(model, state, &here, moment) {
                Ok(by_time) => return Ok((Coefficients::Constant, by_turning.max(by_time))),
                Err(found) => RuntimeError::OverTime {
                    moment,
                    elements: found.elements,
                    later: found.later,
                    change: found.change,
                },
            },
        },
    };
    if frozen {
        Ok((Coefficients::Frozen, 0.0))
    } else {
        Err(refused)
    }
}

/// Linearises about a state on the constraints, with its accelerations and multipliers.
///
/// # Errors
/// When constraints depend on each other there, when numbers are not finite, or when coefficients change
/// along the motion and `wanted` is not frozen.
pub fn linearise(
    model: &Model,
    state: &State,
    moment: Moment,
    wanted: Wanted,
) -> Result<LinearModes, RuntimeError> {
    let equations = Equations::of_both_sides(model, state, moment)?;
    let (coefficients, variation) = tested(model, state, &equations, moment, wanted.frozen)?;
    let p = equations.freedoms();
    let matrix = equations.first_order();
    let unknowns = matrix.nrows();
    let spectrum = eigen::spectrum(matrix)?;
    let size = spectrum.size.max(equations.rate_scale);
    let resolution = libm::sqrt(unknowns as f64 * f64::EPSILON) * size;
    let (unresolved, mut pairs): (Vec<_>, Vec<_>) = spectrum
        .pairs
        .into_iter()
        .partition(|pair| pair.value.norm() <= resolution);
    let unresolved = unresolved
        .iter()
        .map(|pair| if pair.value.im > 0.0 { 2 } else { 1 })
        .sum();
    let slow = slow::resolve(&equations, unresolved, resolution)?;
    let zeros = slow.zeros;
    pairs.extend(slow.pairs);
    let found = pairs
        .into_iter()
        .map(|pair| {
            let x = pair.vector.rows(0, p).into_owned();
            Found {
                value: pair.value,
                rate: complex(&equations.basis, &x) * pair.value
                    + complex(&equations.basis_rate, &x),
                vector: pair.vector,
                repeating: None,
            }
        })
        .collect();
    let mut modes = collected(model, state, moment, &equations, wanted, found)?;
    for mode in &mut modes.modes {
        mode.uncertain = variation * mode.value.norm();
    }
    Ok(LinearModes {
        coefficients,
        zeros,
        resolution,
        variation,
        ..modes
    })
}

/// An eigenvalue with its vector ξ and the rates of the moves u.
struct Found {
    value: Complex<f64>,
    vector: DVector<Complex<f64>>,
    rate: DVector<Complex<f64>>,
    repeating: Option<Repeating>,
}

fn complex(real: &DMatrix<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    let [a, b] = parts(x);
    (real * a).zip_map(&(real * b), Complex::new)
}

/// The selected modes in their order, with shares and outputs at a state. The caller fills in coefficients,
/// zeros and resolution.
fn collected(
    model: &Model,
    state: &State,
    moment: Moment,
    equations: &Equations,
    wanted: Wanted,
    found: Vec<Found>,
) -> Result<LinearModes, RuntimeError> {
    let (oscillations, others): (Vec<_>, Vec<_>) =
        found.into_iter().partition(|pair| pair.value.im > 0.0);
    let mut kinds: [Vec<Found>; 2] = [oscillations, others];
    let ledger = Ledger::new(model, state, equations)?;
    let mut probe = Probe::new(model, state, moment)?;
    let mut modes = Vec::new();
    let mut left_out = [0; 2];
    for (kind, left_out) in kinds.iter_mut().zip(&mut left_out) {
        kind.sort_by(|a, b| {
            let key = |pair: &Found| [pair.value.norm(), pair.value.im, pair.value.re];
            let (a, b) = (key(a), key(b));
            a.iter()
                .zip(&b)
                .map(|(a, b)| a.total_cmp(b))
                .find(|o| o.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let most = wanted.number.map_or(usize::MAX, |n| n as usize);
        let limit = wanted.up_to.unwrap_or(f64::INFINITY);
        let kept = kind
            .iter()
            .take(most)
            .filter(|pair| pair.value.norm() <= limit);
        let before = modes.len();
        for pair in kept {
            modes.push(mode(model, equations, &ledger, &mut probe, pair)?);
        }
        *left_out = kind.len() - (modes.len() - before);
    }
    let p = equations.freedoms();
    Ok(LinearModes {
        moment,
        coefficients: Coefficients::Constant,
        cycle_speed: None,
        freedoms: p,
        states: equations.first_order_size() - 2 * p,
        parts: ledger.parts,
        stores: ledger.stores,
        modes,
        left_out,
        zeros: 0,
        resolution: 0.0,
        variation: 0.0,
        orbit: None,
        matrices: None,
    })
}

/// A mode with its shares and outputs from an eigenpair.
fn mode(
    model: &Model,
    equations: &Equations,
    ledger: &Ledger,
    probe: &mut Probe<'_>,
    pair: &Found,
) -> Result<Mode, RuntimeError> {
    let p = equations.freedoms();
    let value = pair.value;
    let coordinates = pair.vector.rows(0, p).into_owned();
    let mut place = complex(&equations.basis, &coordinates);
    let mut rate = pair.rate.clone();
    let mut states = pair
        .vector
        .rows(2 * p, pair.vector.len() - 2 * p)
        .into_owned();
    // scaled to 1 J with the largest number real; a mode in which only states move gets length one
    let size = coordinates.norm();
    // a choice above rounding: a mode of states alone moves no body
    let energetic = size > 1e-12 * states.norm();
    let length = if energetic {
        value.norm() * size / std::f64::consts::SQRT_2
    } else {
        states.norm()
    };
    let relative: Vec<f64> = if energetic {
        let scales = model.velocity_scales();
        place
            .iter()
            .zip(&scales)
            .map(|(x, s)| x.norm() / s)
            .collect()
    } else {
        states.iter().map(|z| z.norm()).collect()
    };
    let largest = relative.iter().fold(0.0_f64, |most, x| most.max(*x));
    let leader = relative
        .iter()
        .position(|x| *x >= (1.0 - ALIKE) * largest)
        .unwrap_or(0);
    let led = if energetic {
        place.get(leader)
    } else {
        states.get(leader)
    };
    let turn = led.map_or(Complex::new(1.0, 0.0), |x| {
        if x.norm() > 0.0 {
            x.conj() / x.norm()
        } else {
            Complex::new(1.0, 0.0)
        }
    });
    let factor = turn / length.max(f64::MIN_POSITIVE);
    place *= factor;
    rate *= factor;
    states *= factor;

    let shares = ledger.shares(model, equations, &place, &rate, value);
    let [x, y] = parts(&place).map(|x| equations.in_body_axes(x));
    let [vx, vy] = parts(&rate).map(|v| equations.in_body_axes(v));
    let [zx, zy] = parts(&states);
    let mut along = |x: DVector<f64>, v: DVector<f64>, z: DVector<f64>| {
        probe.along(&Direction {
            place: x.data.into(),
            velocity: v.data.into(),
            states: z.data.into(),
        })
    };
    let (real, imaginary) = (along(x, vx, zx)?, along(y, vy, zy)?);
    Ok(Mode {
        value,
        place,
        shares,
        outputs: real
            .into_iter()
            .zip(imaginary)
            .map(|(re, im)| Complex::new(re, im))
            .collect(),
        uncertain: 0.0,
        repeating: pair.repeating.clone(),
    })
}
