//! The motion that repeats, with the equations along it.
//!
//! A transient runs over the period from a state; at the stages of the march its states, completed at acceleration level, give the
//! equations. If the state after the period is not the one before, up to whole turns, Newton's shooting mends it:
//!
//! ```text
//! x₀ ← x₀ + (1 − W)⁺ (x_T − x₀)       W the monodromy matrix, in the coordinates N at the start
//! ```
//!
//! which finds unstable motions too. Directions that W leaves as they are (a free turn, the phase) stay: the inverse is that of the least
//! change.

use super::super::constancy;
use super::super::equations::Equations;
use super::super::run::turn_by;
use super::harmonics::{Sight, seen};
use super::march::{March, radau};
use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::rotation::{V3, logarithm, product};
use crate::simulation::Simulation;
use crate::state::{State, move_pose};
use crate::transient::{Advance, Observer, follow};
use eng_system::system::{Extent, StepControl};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Segments of the period: an odd number, see `multipliers`.
const SEGMENTS: usize = 7;
/// Most numbers (of ξ, times segments) of the matrix whose eigenvalues are sought.
const LARGEST: usize = 1400;
/// Steps of the march a turn of the fastest body, and least and most of them.
const PER_TURN: f64 = 256.0;
const LEAST: usize = 256;
const MOST: usize = 8192;
/// Rounds of the shooting.
const SHOTS: usize = 14;
/// Gap, as a share of what is allowed, below which no round is needed, and shrinkage at which another is no use.
const CLOSED: f64 = 1e-3;
const STALLED: f64 = 0.5;
/// Longest move of a round, as a share of the model's position tolerance, which is a thousandth of a clearance.
const STRIDE: f64 = 200.0;
/// Singular value of 1 − W, as a share of the largest, of a direction that stays.
const STAYS: f64 = 1e-7;
/// Rates are as large as moves times so many times 2π/T.
const RATES: f64 = 10.0;
/// Change of a body's spin, as a share of the largest, up to which the shooting finds the motion that was asked for.
const FREE: f64 = 0.02;
/// Change of the coefficients over the period, which the gap of the state explains.
const ALIKE: f64 = 0.02;

/// The period of a motion.
#[derive(Clone, Copy, Debug)]
pub(super) enum Period {
    /// A time (s).
    Time(f64),
    /// An angle of the cycle (rad).
    Cycle(f64),
}

/// What an analysis means by `over`, at a state of the motion.
pub(super) fn period_of(simulation: &Simulation, over: Extent) -> Result<Period, RuntimeError> {
    let refuse = |message: &str| {
        Err(RuntimeError::NoPeriod {
            message: message.to_owned(),
        })
    };
    match over {
        Extent::Time(time) => Ok(Period::Time(time)),
        Extent::Angle(angle) if simulation.cycle_angle().is_some() => Ok(Period::Cycle(angle)),
        Extent::Angle(angle) => {
            let state = simulation.sampled_state();
            let fastest = constancy::fastest(simulation.model(), state);
            if fastest <= 0.0 {
                return refuse("`over` is an angle, but no body turns");
            }
            Ok(Period::Time(angle / fastest))
        }
    }
}

/// The equations along one period, marched with whole and with halved steps.
pub(super) struct Round {
    pub start: State,
    pub moment: Moment,
    pub first: Equations,
    pub last: Equations,
    pub end: State,
    /// s.
    pub period: f64,
    /// Halved steps.
    pub steps: usize,
    pub fine: March,
    pub coarse: March,
    pub sights: Vec<Sight>,
}

/// What is left of x_T − x₀.
pub(super) struct Gap {
    /// In the coordinates ξ of the start.
    pub coordinates: DVector<f64>,
    /// As a share of what is allowed.
    pub share: f64,
    /// Index of the body that is farthest off, and its gap in words.
    worst: (Option<usize>, String),
}

fn power_of_two(count: f64) -> usize {
    let count = if count.is_finite() { count } else { 0.0 };
    (count.ceil() as usize)
        .clamp(LEAST, MOST)
        .next_power_of_two()
}

/// One period from a state.
fn round(
    simulation: &Simulation,
    state: &State,
    period: Period,
    control: StepControl,
    observer: &mut dyn Observer,
) -> Result<Round, RuntimeError> {
    let mut values = vec![0.0; simulation.model().compiled.system.channels.len()];
    let time = match period {
        Period::Time(time) => time,
        Period::Cycle(angle) => {
            let mut ahead = simulation.restarted(state.clone())?;
            turn_by(&mut ahead, angle, &mut values, observer)?;
            ahead.sampled_state().time - state.time
        }
    };
    let mut running = simulation.restarted(state.clone())?;
    running.evaluate_channels(&mut values)?;
    let model = running.model().clone();
    let start = running.sampled_state().clone();
    let moment = Moment {
        time: start.time,
        cycle_angle: running.sampled_cycle()?.map(|c| c[0]),
    };
    let first = Equations::new(&model, &start, moment)?;
    let steps = match control.fixed() {
        Some(h) => power_of_two(time / h),
        None => power_of_two(PER_TURN * constancy::fastest(&model, &start) * time / TAU),
    };
    let (pairs, h) = (steps / 2, time / steps as f64);
    let size = first.first_order_size().max(1);
    let mut segments = (LARGEST / size).clamp(1, SEGMENTS);
    segments -= usize::from(segments.is_multiple_of(2));
    let [c, d, _] = radau().places;
    // stages of two halved steps and of the whole one, in the order of time
    let offsets = [c, 2.0 * c, d, 1.0, 1.0 + c, 2.0 * d, 1.0 + d, 2.0];
    let mut fine = March::new(&first);
    let mut coarse = March::new(&first);
    let mut sights = Vec::with_capacity(steps);
    let mut last = first.clone();
    let no_step = || RuntimeError::Eigenvalues {
        size,
        what: "a step of the march has no solution".to_owned(),
    };
    let mut segment = 0;
    for pair in 0..pairs {
        let begin = start.time + 2.0 * pair as f64 * h;
        let mut along: Vec<Equations> = Vec::with_capacity(offsets.len());
        let mut views = Vec::with_capacity(2);
        for (place, offset) in offsets.iter().enumerate() {
            let end = start.time + time;
            let at = if pair + 1 == pairs && place + 1 == offsets.len() {
                end
            } else {
                (begin + offset * h).min(end)
            };
            while running.time() < at {
                running.step_no_longer(end, 2.0 * h)?;
            }
            running.sample_at(at, &mut values)?;
            let state = running.sampled_state();
            let equations = Equations::new(&model, state, moment)?;
            if place == 3 || place == 7 {
                views.push(seen(&model, state, &equations));
            }
            along.push(equations);
        }
        let [a, b, e, f, g, i, j, k] = along.as_slice() else {
            return Err(no_step());
        };
        for (half, (stages, view)) in [[a, e, f], [g, j, k]].into_iter().zip(&views).enumerate() {
            fine.step(stages, h).ok_or_else(no_step)?;
            let p = first.freedoms();
            sights.push(Sight {
                segment,
                time: (2 * pair + half + 1) as f64 * h,
                seen: view * &fine.turn * fine.solution.rows(0, p),
            });
        }
        coarse.step([b, i, k], 2.0 * h).ok_or_else(no_step)?;
        if pair + 1 == pairs {
            last = k.clone();
        } else if (pair + 1) * segments >= (segment + 1) * pairs {
            fine.end_segment();
            coarse.end_segment();
            segment += 1;
        }
        let advance = Advance::new(&running, (pair + 1) as f64 / pairs as f64);
        follow(&running, observer, &advance, false)?;
    }
    fine.close(&first);
    coarse.close(&first);
    for warning in running.take_warnings() {
        observer.warning(&warning);
    }
    Ok(Round {
        end: running.sampled_state().clone(),
        start,
        moment,
        first,
        last,
        period: time,
        steps,
        fine,
        coarse,
        sights,
    })
}

impl Round {
    /// `X_m … X_1`.
    pub fn monodromy(segments: &[DMatrix<f64>]) -> DMatrix<f64> {
        let mut all = segments.iter();
        let first = all.next().cloned().unwrap_or_else(|| DMatrix::zeros(0, 0));
        all.fold(first, |product, next| next * product)
    }

    /// Moves and rates as ξ at the start: x = NᵀM u, ẋ = NᵀM u̇.
    fn coordinates(
        &self,
        moves: &DVector<f64>,
        rates: &DVector<f64>,
        states: &[f64],
    ) -> DVector<f64> {
        let across = self.first.basis.transpose() * &self.first.mass;
        let (x, y) = (&across * moves, &across * rates);
        DVector::from_iterator(
            x.len() + y.len() + states.len(),
            x.iter().chain(y.iter()).chain(states).copied(),
        )
    }

    /// The direction of the motion itself, `(NᵀM v, NᵀM v̇, ż)`.
    pub fn along(&self) -> DVector<f64> {
        let ground = |x: &[f64]| self.first.in_ground_axes(DVector::from_column_slice(x));
        self.coordinates(
            &ground(&self.start.velocity),
            &ground(&self.start.acceleration),
            &self.start.rates,
        )
    }

    /// The state after the period less the one before, whole turns left out.
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
                        (0..3, true) => format!("is {:.3e} m away", amount.abs()),
                        (0..3, false) => format!("is {:.3e} m/s faster or slower", amount.abs()),
                        (3..6, true) => format!("is turned by {:.3e}°", amount.abs().to_degrees()),
                        (3..6, false) => {
                            format!("turns by {:.3e} rad/s faster or slower", amount.abs())
                        }
                        (_, true) => format!("is bent otherwise (mode {})", place - 5),
                        (_, false) => format!("bends at another rate (mode {})", place - 5),
                    };
                    worst = (Some(index), text);
                }
            }
        }
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
        let (off, size) = (
            largest(&states),
            largest(&from.states).max(largest(&to.states)),
        );
        if size > 0.0 && off / (1e-3 * size) > share {
            share = off / (1e-3 * size);
            worst = (
                None,
                format!("a state of an element differs by {off:.3e} (SI)"),
            );
        }
        let ground = |x: Vec<f64>| self.first.in_ground_axes(DVector::from_vec(x));
        Gap {
            coordinates: self.coordinates(&ground(moves), &ground(rates), &states),
            share,
            worst,
        }
    }

    /// Newton's step of the shooting.
    fn mended(&self, model: &Model, gap: &Gap) -> Result<State, RuntimeError> {
        let p = self.first.freedoms();
        let size = gap.coordinates.len();
        let pace = TAU / self.period;
        let weight = |i: usize| if (p..2 * p).contains(&i) { pace } else { 1.0 };
        let whole = Round::monodromy(&self.fine.segments);
        let off = DMatrix::from_fn(size, size, |i, j| {
            (f64::from(u8::from(i == j)) - whole[(i, j)]) * weight(j) / weight(i)
        });
        let wanted = DVector::from_fn(size, |i, _| gap.coordinates[i] / weight(i));
        let decomposed = off.svd(true, true);
        let largest = decomposed.singular_values.amax();
        let solved = decomposed.solve(&wanted, STAYS * largest).map_err(|what| {
            RuntimeError::Eigenvalues {
                size,
                what: what.to_owned(),
            }
        })?;
        let step = DVector::from_fn(size, |i, _| solved[i] * weight(i));
        let (x, y) = (step.rows(0, p), step.rows(p, p));
        let moves = &self.first.basis * x;
        let rates = &self.first.basis * y + &self.first.basis_rate * x;
        let moves = self.first.in_body_axes(moves);
        let rates = self.first.in_body_axes(rates);
        let scales = model.velocity_scales();
        let farthest = moves
            .iter()
            .zip(&scales)
            .fold(0.0_f64, |w, (x, s)| w.max((x / s).abs()));
        let most = STRIDE * model.tolerance / model.length;
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
        Ok(state)
    }
}

/// The error of a motion that does not repeat.
fn not_repeating(
    model: &Model,
    round: &Round,
    (body, what): &(Option<usize>, String),
) -> RuntimeError {
    let origin = body.map(|b| Box::new(model.bodies[b].origin.clone()));
    let named = origin
        .as_ref()
        .map_or(String::new(), |o| format!("{} ", o.path));
    RuntimeError::NotRepeating {
        moment: round.moment,
        period: round.period,
        what: format!("{named}{what}"),
        origin,
    }
}

/// The repeating motion at or near the state of the last outputs.
pub(super) fn repeating(
    simulation: &Simulation,
    period: Period,
    control: StepControl,
    observer: &mut dyn Observer,
) -> Result<(Round, Gap), RuntimeError> {
    let model = simulation.model();
    let asked = simulation.sampled_state();
    let near = FREE * constancy::fastest(model, asked);
    let mut state = asked.clone();
    let mut before = f64::INFINITY;
    let mut shot = 0;
    loop {
        let found = round(simulation, &state, period, control, observer)?;
        let gap = found.gap(model);
        shot += 1;
        let stalled = gap.share > STALLED * before;
        if gap.share <= CLOSED || (gap.share <= 1.0 && (stalled || shot == SHOTS)) {
            let both = [&found.first, &found.last];
            if constancy::alike(model, both, TAU / found.period, ALIKE) {
                return Ok((found, gap));
            }
            let what = "the state repeats, but the forces about it do not: something depends on time with another period";
            return Err(not_repeating(model, &found, &(None, what.to_owned())));
        }
        if shot == SHOTS || !gap.share.is_finite() {
            return Err(not_repeating(model, &found, &gap.worst));
        }
        before = gap.share;
        state = found.mended(model, &gap)?;
        // where speeds are free, a motion of another speed has the period
        if near > 0.0 && constancy::change_of_spin(model, asked, &state) > near {
            return Err(not_repeating(model, &found, &gap.worst));
        }
    }
}
