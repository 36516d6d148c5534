//! The repeating motion.
//!
//! A round of `orbit` is one period from a state. If the state after it differs from the one before, up to
//! whole turns, Newton's shooting corrects the start:
//!
//! ```text
//! x₀ ← x₀ + (1 − W)⁺ (x_T − x₀)       W the monodromy matrix, in the coordinates N at the start
//! ```
//!
//! It finds unstable motions too. Directions that W does not change (a free turn, the phase) get no
//! correction: the inverse is that of the least change.
//!
//! **Steps.** If the steps are too long for fast oscillations in the state, W is wrong, and so is the
//! direction of a correction, however short it is. Then the number of steps is multiplied by four.
//!
//! **Period.** If the period is stated as an angle, the time for this angle from the first state on is only a
//! first guess of T, because the angle swings before the motion repeats. A part that a drive turns has no
//! freedom to close its gap, so T closes it. With the velocity v, the gap d of all moves, and the parts of
//! both outside all freedoms, `v' = v − NNᵀMv`,
//!
//! ```text
//! δT = −v'ᵀMd'/v'ᵀMv'       x₀ ← x₀ + (1 − W)⁺ (x_T + y δT − x₀)       y = (NᵀMv, NᵀMv̇, ż)
//! ```
//!
//! Without a drive v' = 0, and T is one of the unknowns: `(1 − W) δx − y δT = x_T − x₀`. A T that is stated
//! as a time is fixed.

use super::super::constancy;
use super::super::run::Stretch;
use super::orbit::{Period, Round, StepLengths, round};
use crate::acceleration::AccelerationSystem;
use crate::dynamics::Dynamics;
use crate::error::{NotBack, RuntimeError};
use crate::model::Model;
use crate::rotation::{V3, logarithm, product};
use crate::simulation::Simulation;
use crate::state::{State, move_pose};
use crate::transient::Observer;
use eng_system::dense::largest;
use eng_system::significant::short;
use eng_system::system::StepControl;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Most rounds of the shooting. A choice: each integrates a period, and Newton's method needs a few after the
/// length of moves has grown.
const SHOTS: usize = 20;
/// Gap, as a share of the permitted one, below which no further round is needed, and factor of shrinkage at
/// which another is useless. Choices.
const CLOSED: f64 = 1e-3;
const STALLED: f64 = 0.5;
/// Longest move of the first round, in position tolerances of the model: a fifth of a clearance, because a
/// position tolerance is a thousandth of it. A choice: films are far from linear over more.
const STRIDE: f64 = 200.0;
/// Factors on the longest move after a round with the predicted shrinkage, and after another round. Choices:
/// the second undoes more than one success.
const LONGER: f64 = 2.5;
const SHORTER: f64 = 0.25;
/// Length of a move in position tolerances for which the linear equations hold, those of films too: a
/// fiftieth of a clearance. A choice: after a longer move a failure may come from the curvature, and finer
/// steps would not help.
const SHORT: f64 = 20.0;
/// Share of the gap that no correction closes, above which no motion of the period is near. A choice: below
/// it the next round may close the rest.
const UNMENDED: f64 = 0.3;
/// Singular value of 1 − W, as a share of the largest, below which W does not change a direction. A choice:
/// the integration has errors of this order.
const STAYS: f64 = 1e-7;
/// Factor on 2π/T in the scale of rates relative to moves. A choice: a motion over a period contains orders
/// of about ten.
const RATES: f64 = 10.0;
/// Largest change of a body's spin, as a share of the largest spin, for which the found motion is the
/// requested one. A choice: bearings may let a shaft slip by some per cent in another motion.
const FREE: f64 = 0.02;
/// Largest change of the coefficients over the period that the gap of the state can explain. A choice: the
/// gap is at most a thousandth of a clearance, and films change by some times this share.
const ALIKE: f64 = 0.02;
/// Largest relative change of a period stated as an angle for which the found motion is the requested one. A
/// choice, that of [`FREE`].
const DETUNED: f64 = 0.02;
/// Part of the velocity outside all freedoms, as a share of the whole in the mass norm, above which a drive
/// acts. A choice above the rounding of a projection.
const DRIVEN: f64 = 1e-6;

/// The beginning of a round of the shooting.
struct Aim {
    state: State,
    /// Its period (s).
    time: f64,
    /// Share of Newton's step.
    factor: f64,
    /// Share of the gap that Newton's whole step leaves by the linear equations.
    left: f64,
}

/// The gap x_T − x₀.
pub(super) struct Gap {
    /// The gap in the coordinates ξ of the start.
    coordinates: DVector<f64>,
    /// The gap as a share of the permitted one.
    pub share: f64,
    /// δT (s) that closes the driven part; `None` without a drive.
    driven: Option<f64>,
    /// Share of the gap outside all freedoms, in the mass norm of the moves.
    given: f64,
    /// Index of the body with the largest gap, and this gap in words.
    worst: (Option<usize>, String),
}

impl Round {
    /// The state after the period minus the one before, without whole turns.
    fn gap(&self, model: &Model) -> Gap {
        let (from, to) = (&self.start, &self.end);
        let mut moves = vec![0.0; model.velocities];
        for body in &model.bodies {
            let (p, v) = (body.pose, body.velocity);
            for i in 0..3 {
                moves[v + i] = to.pose[p + i] - from.pose[p + i];
            }
            let quaternion =
                |s: &State| [s.pose[p + 3], s.pose[p + 4], s.pose[p + 5], s.pose[p + 6]];
            let [w, x, y, z] = quaternion(from);
            let mut turn = product(&[w, -x, -y, -z], &quaternion(to));
            if turn[0] < 0.0 {
                turn = turn.map(|q| -q);
            }
            let angle: V3 = logarithm(&turn);
            moves[v + 3..v + 6].copy_from_slice(angle.as_slice());
            for i in 0..body.modes() {
                moves[v + 6 + i] = to.pose[p + 7 + i] - from.pose[p + 7 + i];
            }
        }
        let difference =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| b - a).collect() };
        let rates = difference(&from.velocity, &to.velocity);
        let states = difference(&from.states, &to.states);
        let allowed = model.tolerance / model.length;
        let scales = model.velocity_scales();
        let mut share = 0.0;
        let mut worst = (None, "nothing".to_owned());
        for (index, body) in model.bodies.iter().enumerate() {
            for i in body.velocity..body.velocity + body.width() {
                let of_place = (moves[i] / scales[i]).abs() / allowed;
                let of_rate = (rates[i] / scales[i]).abs() / (allowed * RATES * TAU / self.period);
                let larger = of_place.max(of_rate);
                if larger.is_nan() || larger > share {
                    share = larger;
                    let place = i - body.velocity;
                    let moved = of_place >= of_rate;
                    let amount = if moved { moves[i] } else { rates[i] };
                    let text = match (place, moved) {
                        (0..3, true) => format!("is {} m away", short(amount.abs(), 3)),
                        (0..3, false) => {
                            format!("is {} m/s faster or slower", short(amount.abs(), 3))
                        }
                        (3..6, true) => {
                            format!("is turned by {}°", short(amount.abs().to_degrees(), 3))
                        }
                        (3..6, false) => {
                            format!("turns by {} rad/s faster or slower", short(amount.abs(), 3))
                        }
                        (_, true) => format!("is bent otherwise (mode {})", place - 5),
                        (_, false) => format!("bends at another rate (mode {})", place - 5),
                    };
                    worst = (Some(index), text);
                }
            }
        }
        let (off, size) = (
            largest(&states),
            largest(&from.states).max(largest(&to.states)),
        );
        // states may differ by a thousandth of their size, a choice beside the thousandth of a clearance of
        // positions
        if size > 0.0 && off / (1e-3 * size) > share {
            share = off / (1e-3 * size);
            worst = (
                None,
                format!("a state of an element differs by {} (SI)", short(off, 3)),
            );
        }
        let ground = |x: Vec<f64>| self.first.in_ground_axes(DVector::from_vec(x));
        let moves = ground(moves);
        let (driven, given) = self.detuning(&moves);
        Gap {
            driven,
            given,
            coordinates: self.coordinates(&moves, &ground(rates), &states),
            share,
            worst,
        }
    }

    /// δT (s) that closes the moves (ground axes) outside all freedoms, `None` without a drive; and the share
    /// of these moves in the mass norm.
    fn detuning(&self, moves: &DVector<f64>) -> (Option<f64>, f64) {
        let (basis, mass) = (&self.first.basis, &self.first.mass);
        let given = |x: &DVector<f64>| x - basis * (basis.transpose() * (mass * x));
        let velocity = self
            .first
            .in_ground_axes(DVector::from_column_slice(&self.start.velocity));
        let driven = given(&velocity);
        let loads = mass * &driven;
        let (square, whole) = (driven.dot(&loads), velocity.dot(&(mass * &velocity)));
        let off = given(moves);
        let change = (square > DRIVEN * DRIVEN * whole).then(|| -off.dot(&loads) / square);
        let size = |x: &DVector<f64>| x.dot(&(mass * x)).max(0.0);
        let share = match size(moves) {
            all if all > 0.0 => libm::sqrt(size(&off) / all),
            _ => 0.0,
        };
        (change, share)
    }

    /// Newton's step of the shooting. Moves that are not along the motion are limited to `reach` position
    /// tolerances. The period is fixed unless it is `free`.
    fn mended(
        &self,
        model: &Model,
        gap: &Gap,
        free: bool,
        reach: f64,
    ) -> Result<Aim, RuntimeError> {
        let p = self.first.freedoms();
        let size = gap.coordinates.len();
        let frequency = TAU / self.period;
        let weight = |i: usize| {
            if (p..2 * p).contains(&i) {
                frequency
            } else {
                1.0
            }
        };
        let whole = Round::monodromy(&self.fine.segments);
        let along = self.along();
        // without a drive the period is an unknown beside the state
        let sought = free && gap.driven.is_none();
        let given = gap.driven.filter(|_| free).unwrap_or(0.0);
        let off = DMatrix::from_fn(size, size + usize::from(sought), |i, j| {
            if j == size {
                -along[i] / (weight(i) * frequency)
            } else {
                (f64::from(u8::from(i == j)) - whole[(i, j)]) * weight(j) / weight(i)
            }
        });
        let wanted = DVector::from_fn(size, |i, _| {
            (gap.coordinates[i] + along[i] * given) / weight(i)
        });
        let decomposed =
            crate::singular::decompose(off.clone()).ok_or_else(|| RuntimeError::Eigenvalues {
                size,
                what: "the changes over a period are not finite".to_owned(),
            })?;
        let largest = decomposed.singular_values.amax();
        let solved = decomposed.solve(&wanted, STAYS * largest).map_err(|what| {
            RuntimeError::Eigenvalues {
                size,
                what: what.to_owned(),
            }
        })?;
        let left = if wanted.norm() > 0.0 {
            (&off * &solved - &wanted).norm() / wanted.norm()
        } else {
            0.0
        };
        let step = DVector::from_fn(size, |i, _| solved[i] * weight(i));
        let change = if sought {
            solved[size] / frequency
        } else {
            given
        };
        let (x, y) = (step.rows(0, p), step.rows(p, p));
        // a move along the motion itself cannot take a pin out of its film, so it is not limited
        let own = along.rows(0, p);
        let square = own.norm_squared();
        let forward = if square > 0.0 {
            own.dot(&x) / square
        } else {
            0.0
        };
        let aside = self
            .first
            .in_body_axes(&self.first.basis * (x - own * forward));
        let moves = &self.first.basis * x;
        let rates = &self.first.basis * y + &self.first.basis_rate * x;
        let moves = self.first.in_body_axes(moves);
        let rates = self.first.in_body_axes(rates);
        let farthest = model.largest(aside.as_slice());
        let most = reach * model.tolerance / model.length;
        let factor = if farthest > most {
            most / farthest
        } else {
            1.0
        };
        let mut state = self.start.clone();
        move_pose(
            model,
            &self.start.pose,
            moves.as_slice(),
            factor,
            &mut state.pose,
        );
        for (v, rate) in state.velocity.iter_mut().zip(rates.iter()) {
            *v += factor * rate;
        }
        for (z, change) in state
            .states
            .iter_mut()
            .zip(step.rows(2 * p, size - 2 * p).iter())
        {
            *z += factor * change;
        }
        // a long move violates the constraints in second order, so the state is projected
        let mut system = AccelerationSystem::new(model)?;
        system.restore(model, &mut Dynamics::new(model), &mut state, self.moment)?;
        Ok(Aim {
            state,
            time: self.period + factor * change,
            factor,
            left,
        })
    }
}

/// The error of a motion that does not repeat.
fn not_repeating(
    model: &Model,
    round: &Round,
    (body, what): &(Option<usize>, String),
    why: NotBack,
) -> RuntimeError {
    let origin = body.map(|b| Box::new(model.bodies[b].origin.clone()));
    let named = origin
        .as_ref()
        .map_or(String::new(), |o| format!("{} ", o.path));
    RuntimeError::NotRepeating {
        moment: round.moment,
        period: round.period,
        what: format!("{named}{what}"),
        why,
        origin,
    }
}

/// The reason why the search ended. If drives impose the gap, or no move closes it, the period is wrong.
/// Otherwise the start is too far from the motion.
fn why(gap: &Gap, left: f64, period: Period) -> NotBack {
    let imposed = gap.given > UNMENDED && !(period.free && gap.driven.is_some());
    if imposed || left > UNMENDED {
        NotBack::OtherPeriod
    } else {
        NotBack::TooFar
    }
}

/// The repeating motion at or near the state of the last outputs, with the steps that found it.
pub(super) fn repeating(
    simulation: &Simulation,
    period: Period,
    control: StepControl,
    observer: &mut dyn Observer,
) -> Result<(Round, Gap), RuntimeError> {
    let model = simulation.model();
    let asked = simulation.sampled_state();
    let near = FREE * constancy::fastest(model, asked);
    let mut lengths = StepLengths { control, finer: 1 };
    let mut aim = Aim {
        state: asked.clone(),
        time: period.time,
        factor: 1.0,
        left: 0.0,
    };
    let mut reach = STRIDE;
    let mut before: Option<(Round, Gap)> = None;
    for shot in 1..=SHOTS {
        // each round takes half of the remaining progress
        let done = |shot: usize| 1.0 - libm::exp2(-(shot as f64));
        let mut stretch = Stretch::new(observer, done(shot), done(shot + 1));
        let tried = round(
            simulation,
            &aim.state,
            aim.time,
            lengths,
            false,
            &mut stretch,
        );
        let found = match tried {
            Ok(found) => Some(found),
            Err(RuntimeError::Stopped(why)) => return Err(RuntimeError::Stopped(why)),
            // a step that is too long may end at a state without a motion
            Err(failed) if before.is_none() || shot == SHOTS => return Err(failed),
            Err(_) => None,
        };
        let found = found.map(|found| {
            let gap = found.gap(model);
            (found, gap)
        });
        let share = found.as_ref().map_or(f64::INFINITY, |(_, gap)| gap.share);
        let last = before.as_ref().map_or(f64::INFINITY, |(_, gap)| gap.share);
        let stalled = share > STALLED * last;
        if let Some((found, gap)) = &found {
            if share <= CLOSED || (share <= 1.0 && (stalled || shot == SHOTS)) {
                let both = [&found.first, &found.last];
                if !constancy::alike(model, both, TAU / found.period, ALIKE) {
                    let what = "the state repeats, but the forces about it do not: something depends on time with another period";
                    let worst = (None, what.to_owned());
                    return Err(not_repeating(model, found, &worst, NotBack::OtherPeriod));
                }
                let mut stretch = Stretch::new(observer, done(shot + 1), 1.0);
                let found = round(
                    simulation,
                    &aim.state,
                    aim.time,
                    lengths,
                    true,
                    &mut stretch,
                )?;
                let gap = found.gap(model);
                return Ok((found, gap));
            }
            if shot == SHOTS || (!share.is_finite() && before.is_none()) {
                let why = why(gap, aim.left, period);
                return Err(not_repeating(model, found, &gap.worst, why));
            }
        }
        if share < last {
            if aim.factor < 1.0 && share < (1.0 - 0.5 * aim.factor) * last {
                reach *= LONGER;
            }
            before = found;
        } else {
            // so short a correction is linear: if it fails, the steps of the march are too long for an
            // oscillation
            let finer = match &before {
                Some((found, _)) if reach <= SHORT => lengths.refined(found.steps),
                _ => None,
            };
            if let (Some(finer), Some((found, _))) = (finer, &before) {
                lengths = finer;
                reach = STRIDE;
                aim = Aim {
                    state: found.start.clone(),
                    time: found.period,
                    factor: 1.0,
                    left: 0.0,
                };
                before = None;
                continue;
            }
            reach *= SHORTER;
        }
        let Some((found, gap)) = &before else {
            break;
        };
        aim = found.mended(model, gap, period.free, reach)?;
        // if speeds are free, a motion at another speed may also have this period
        let other_speed = near > 0.0 && constancy::change_of_spin(model, asked, &aim.state) > near;
        if other_speed || (aim.time / period.time - 1.0).abs() > DETUNED {
            return Err(not_repeating(
                model,
                found,
                &gap.worst,
                NotBack::OtherPeriod,
            ));
        }
    }
    Err(RuntimeError::NoPeriod {
        message: "no motion that repeats was found".to_owned(),
    })
}
