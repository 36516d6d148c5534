//! Eigenvalues and modes of the coupled system, linearised about a state of its motion.
//!
//! **Perturbed motion.** Along a motion of `M v̇ − Q(q, v, z, t) + Gᵀλ = 0`, `ż = f`, `Φ(q, t) = 0`, small moves u (rotations in ground
//! axes, see `axes`) obey
//!
//! ```text
//! M ü + D u̇ + K u + Gᵀδλ + F δz = 0        G u = 0        δż = f_q u + f_v u̇ + f_z δz
//! ```
//!
//! with the exact blocks of Newton's matrix: K holds the stiffness of the constraints `∂(Gᵀλ)/∂q`, the inertia of the frozen velocities and
//! accelerations, springs, films, gravity; time and with it every drive are held. `u = N x` with `GN = 0`, `NᵀMN = 1`. N changes
//! along the motion; of all bases that with `NᵀMṄ = 0` is taken, the one that turns least (in the mass norm): `[M Gᵀ; G 0][Ṅ; μ] = [0; −ĠN]`.
//! Then `NᵀMN̈ = −ṄᵀMṄ − NᵀṀṄ`, and
//!
//! ```text
//! ẍ + C ẋ + K_x x = −NᵀF δz        C = NᵀDN        K_x = NᵀKN + NᵀDṄ − ṄᵀMṄ − NᵀṀṄ
//! ```
//!
//! without an approximation so far. (Without the terms of Ṅ a body that turns about a pin would seem to be held there by springs.)
//!
//! **Frozen time.** These coefficients are held at their values of the moment, and `ξ̇ = A ξ`, `ξ = (x, ẋ, z)` solved for its
//! eigenvalues. That is exact where they are constant: at rest, in steady travel, and about steady rotation of rigid bodies of
//! revolution, which is tested (`constancy`). Else it is the picture of a moment, made only where it is asked for ([`Wanted::frozen`]) and marked as such:
//! good for motions fast against the change of the coefficients, modes of an engine well above its speed, and wrong for whirl and
//! its damping. Amplitudes of a flexible body are those in its own axes: the bending of a shaft that turns at Ω is seen from its body,
//! shifted by up to ±Ω.
//!
//! **Eigenvalues** `λ = −δ ± iω`: damped frequency ω/2π, undamped |λ|/2π, damping ratio −Re λ/|λ|. A double zero, such as that of a
//! rotation that nothing holds, splits by the root of the rounding error; all below that ([`LinearModes::resolution`]) are sought again
//! about zero, and those that nothing but rounding holds count as zeros (`slow`).

mod axes;
mod constancy;
mod eigen;
mod energies;
mod equations;
mod floquet;
mod outputs;
mod run;
mod slow;

pub use energies::{Part, Shares, parts_of, stores};
pub use equations::Equations;
pub use floquet::{Harmonics, Orbit, Repeating};
pub use run::run_linear;

use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::state::State;
use energies::{Ledger, parts};
use nalgebra::{Complex, DMatrix, DVector};
use outputs::{Direction, Probe};

/// Growth below this share of |λ| is rounding.
const GROWTH: f64 = 1e-9;
/// Numbers of a mode this close to the largest are as large: the first of them is made real.
const ALIKE: f64 = 1e-6;

/// Which modes are worked out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Most oscillations, and most motions without oscillation: the slowest of each; `None`: all.
    pub number: Option<u32>,
    /// Largest |λ| (rad/s); `None`: no limit.
    pub up_to: Option<f64>,
    /// Whether coefficients that change while bodies turn or move on are held at their values of the moment; else they are refused.
    pub frozen: bool,
}

/// What the coefficients of the linearised motion are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coefficients {
    /// Constant while the bodies turn and move, or nothing does.
    Constant,
    /// Held at their values of the moment.
    Frozen,
    /// They repeat, and the modes are those of a period.
    Periodic,
}

/// A motion `u(t) = Re (place e^{λt})` of the linearised system, scaled so that its kinetic energy has the peak of 1 J:
/// `½ |λ|² u* M u = 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// λ (1/s), its imaginary part not negative.
    pub value: Complex<f64>,
    /// Moves of every body in the order of the model's velocities: δr (m), small rotation (rad), both in ground axes, modal amplitudes.
    /// The largest, in the model's length and angles, is real and positive.
    pub place: DVector<Complex<f64>>,
    /// Where its energy is.
    pub shares: Shares,
    /// Amplitude of every channel (SI).
    pub outputs: Vec<Complex<f64>>,
    /// What is known of it beside, about a motion that repeats; place, shares and outputs are those at the begin of its period.
    pub repeating: Option<Repeating>,
}

impl Mode {
    /// Whether it oscillates.
    pub fn oscillates(&self) -> bool {
        self.value.im > 0.0
    }

    /// ω/2π (Hz); zero where it does not oscillate.
    pub fn frequency(&self) -> f64 {
        self.value.im / std::f64::consts::TAU
    }

    /// |λ|/2π (Hz).
    pub fn undamped_frequency(&self) -> f64 {
        self.value.norm() / std::f64::consts::TAU
    }

    /// −Re λ/|λ|.
    pub fn damping_ratio(&self) -> f64 {
        -self.value.re / self.value.norm()
    }

    /// Whether it grows, by more than it is uncertain.
    pub fn grows(&self) -> bool {
        let uncertain = |r: &Repeating| r.error + r.missed;
        let error = self.repeating.as_ref().map_or(0.0, uncertain);
        self.value.re > (GROWTH * self.value.norm()).max(error)
    }

    /// The parts with most kinetic energy, the largest first: index and share.
    pub fn leading(&self, most: usize) -> Vec<(usize, f64)> {
        let mut order: Vec<(usize, f64)> =
            self.shares.kinetic.iter().copied().enumerate().collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        order.truncate(most);
        order
    }
}

/// What the linearised motion consists of.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearModes {
    /// Where it was linearised.
    pub moment: Moment,
    /// Whether the modes are those of the motion, or the picture of a moment.
    pub coefficients: Coefficients,
    /// The rate of the cycle's angle there (rad/s), if there is a cycle and it was asked for.
    pub cycle_speed: Option<f64>,
    /// Freedoms: coordinates x.
    pub freedoms: usize,
    /// States of elements: z.
    pub states: usize,
    /// What [`Shares::kinetic`] counts.
    pub parts: Vec<Part>,
    /// What [`Shares::potential`] and [`Shares::lost`] count.
    pub stores: Vec<String>,
    /// Oscillations in the order of |λ|, then motions without oscillation in that order.
    pub modes: Vec<Mode>,
    /// Oscillations and others that were not asked for.
    pub left_out: [usize; 2],
    /// Eigenvalues that are zero: of drifting and turning that nothing holds or drives.
    pub zeros: usize,
    /// |λ| (rad/s) below which an eigenvalue is found about zero, and counts as zero where nothing but rounding holds it.
    pub resolution: f64,
    /// The motion that repeats, where the modes are those of its period.
    pub orbit: Option<Orbit>,
}

impl LinearModes {
    /// The oscillations.
    pub fn oscillations(&self) -> impl Iterator<Item = &Mode> {
        self.modes.iter().filter(|m| m.oscillates())
    }
}

/// Linearises about a state on the constraints, with its accelerations and multipliers.
///
/// # Errors
/// When constraints depend on each other there, numbers are not finite, or coefficients change while bodies turn or move on and
/// `wanted` does not take them as frozen.
pub fn linearise(
    model: &Model,
    state: &State,
    moment: Moment,
    wanted: Wanted,
) -> Result<LinearModes, RuntimeError> {
    let equations = Equations::new(model, state, moment)?;
    let bodies = constancy::varying(model, state, &equations, moment, !wanted.frozen);
    let coefficients = match bodies.as_slice() {
        [] => match constancy::leaving(model, state, &equations, moment) {
            None => Coefficients::Constant,
            Some(_) if wanted.frozen => Coefficients::Frozen,
            Some(body) => {
                return Err(RuntimeError::Unsteady {
                    moment,
                    body: Box::new(body),
                });
            }
        },
        _ if wanted.frozen => Coefficients::Frozen,
        _ => return Err(RuntimeError::Turning { moment, bodies }),
    };
    let p = equations.freedoms();
    let matrix = equations.first_order();
    let unknowns = matrix.nrows();
    let spectrum = eigen::spectrum(matrix)?;
    let size = spectrum.size.max(equations.pace);
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
    let modes = collected(model, state, moment, &equations, wanted, found)?;
    Ok(LinearModes {
        coefficients,
        zeros,
        resolution,
        ..modes
    })
}

/// An eigenvalue with its vector ξ and the rates of the moves u there.
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

/// The modes that are wanted, in order, with shares and outputs at a state. Coefficients, zeros and resolution are the caller's.
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
    let ledger = Ledger::new(model, state)?;
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
        orbit: None,
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
    // 1 J, and the largest number real; where nothing but states moves, of length one
    let size = coordinates.norm();
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
        repeating: pair.repeating.clone(),
    })
}
