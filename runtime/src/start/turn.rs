//! The dry turn: turns the assembled machine through one period of its cycle by its geometry alone.
//!
//! Pins are in the middle of their shells, springs keep their length, and no force acts, so only joints and
//! drives determine the motion. The turn proceeds from position to position. Each time it takes a step along
//! the steady velocities ([`SteadyMotion`]) and then returns to the equations by the smallest change. If a
//! position cannot be reached, the mechanism locks there.

use super::motion::{SteadyMotion, is_moved};
use crate::assembled::Assembled;
use crate::assembly::closing::set_mobility;
use crate::assembly::rows::{self, Along, Rows, pins};
use crate::assembly::{at, chains, lock};
use crate::dynamics::Dynamics;
use crate::elements::Inputs;
use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::outputs::{Outputs, Watch};
use crate::state::{State, move_pose};
use eng_system::significant::short;
use eng_system::system::Extent;
use nalgebra::DVector;

/// Positions in a turn of 360°, so 10° between two. A choice of time against detail: lints of a turn see a
/// quantity there and on parabolas between, and a mechanism that would lock between two of them is followed
/// in halved steps.
const PLACES: f64 = 36.0;
/// Most turns, also for a longer cycle. A choice: a cycle of an engine has two turns, and the check of a text
/// should not take longer for a gear that repeats after a thousand.
const MOST_TURNS: f64 = 4.0;
/// Most halvings of a step. After these its position counts as out of reach. A choice: 10° become 0.16°. Near
/// a lock more of them would only find its angle more exactly.
const HALVINGS: usize = 6;
/// Size of a scaled row below which it is closed. A lock leaves far more open. It is about the rounding of
/// positions with some decades of room, and the iteration is quadratic, so a smaller limit costs no further
/// round as long as it is above rounding.
const CLOSED: f64 = 1e-9;
/// Share of the equations' size that is added to their diagonal, because rows of preferred positions of pins
/// repeat each other and the matrix would have no Cholesky factor. It changes steps by as little, and is far
/// above the rounding of a factor, 1e-16 times its rows.
const SOFT: f64 = 1e-12;
/// Largest share of a step, at the cycle's highest rate so far, by which the cycle may fall behind. The
/// measure is the trapezoidal rule over a step of 10° or less, which is exact to some per cent for the cycle
/// of a swinging body; at a lock the shortfall is the whole step.
const BEHIND: f64 = 0.2;
/// Share of the fastest body's angular speed below which a cycle is at rest. A smaller rate is rounding, or
/// the effect of a tumbling shaft.
const STANDS: f64 = 1e-6;

/// A position in a dry turn.
#[derive(Debug)]
pub struct Place<'a> {
    /// The model.
    pub model: &'a Model,
    /// Positions and steady velocities. Time advances with the cycle.
    pub state: &'a State,
    /// Cycle angle (rad).
    pub angle: f64,
}

/// The extent of a dry turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turned {
    /// The whole period.
    Whole,
    /// No turn: no body, no cycle and no drive, or a cycle at rest at the start.
    Not,
    /// No turn: the cycle is at rest, and no motion that the joints allow changes its angle.
    Held,
    /// Up to this cycle angle (rad), at which it reverses without a lock: the angle belongs to a swinging
    /// body.
    Back(f64),
}

/// Angle of the cycle (rad) within which a place is reached. Angles of some turns are rounded to 1e-15 rad,
/// and no result shows a smaller difference.
pub(crate) const REACHED: f64 = 1e-12;
/// Singular value, as a share of the largest, below which a combination of rows is only rounding: it would make
/// velocities arbitrarily large.
const RANK: f64 = 1e-12;
/// Velocities that the joints allow turn the cycle if they miss its wanted rate by less than this share of
/// it. Beside a drive that holds the cycle they miss it as a whole. The limit is a choice between rounding
/// and the whole.
const HELD: f64 = 1e-6;
/// Rounds in which the time of a position follows its angle. The correction of the angle by the loops is
/// small, and each round leaves a small part of the error of the one before. A choice: what is left after
/// four rounds is corrected at the next position.
const RETIMED: usize = 4;
/// Steps after which an angle of the cycle counts as out of reach. At 10° or less per step of the fastest
/// body these are at most 111 of its turns. A choice, so that a mistaken angle or moment ends with a message
/// and not in a long wait.
const MOST_STEPS: usize = 4000;

/// Brings an assembled state to a moment of the motion that speeds and drives state, or to an angle of its cycle.
///
/// An angle is reached up to whole periods, in the sense in which the cycle turns, and time runs on. A cycle that
/// does not turn is turned by the joints alone, the shorter way, and time stays; with `still` that is always so.
///
/// # Errors
/// [`RuntimeError::Locked`] if the mechanism does not pass; [`RuntimeError::Options`] if the angle is not reached,
/// because a drive holds the cycle or it swings back before.
pub(crate) fn bring(
    model: &Model,
    state: &mut State,
    to: Extent,
    still: bool,
) -> Result<(), RuntimeError> {
    let cycle = model.compiled.system.cycle.as_ref();
    let Ok(motion) = SteadyMotion::new(model, state) else {
        // a mechanism that is locked: the balance reports it
        return Ok(());
    };
    let mut turning = Turning::new(model, motion, cycle.map(|cycle| cycle.element as usize))?;
    turning.still = still;
    let Some(velocity) = turning.velocity(state)? else {
        return Ok(());
    };
    state.velocity.copy_from_slice(&velocity);
    let [start, mut rate] = turning.cycle(state)?;
    let target = match (to, cycle) {
        (Extent::Time(_), _) => None,
        (Extent::Angle(angle), Some(cycle)) => {
            let period = model.slot(cycle.period);
            if rate.abs() <= STANDS * state.fastest_turn(model) {
                turning.still = true;
            }
            let away = angle - start;
            let short = away - period * libm::round(away / period);
            Some(if turning.still || short.abs() <= REACHED {
                start + short
            } else {
                let sense = rate.signum();
                let forward = sense * away;
                start + sense * (forward - period * libm::floor(forward / period))
            })
        }
        (Extent::Angle(_), None) => return Err(RuntimeError::NoCycle),
    };
    if target == Some(start) {
        return Ok(());
    }
    if let Some(target) = target
        && turning.still
    {
        let Some(velocity) = turning.velocity(state)? else {
            return Err(unreached(start, target));
        };
        state.velocity.copy_from_slice(&velocity);
        rate = 1.0;
    }
    let mut now = start;
    for _ in 0..MOST_STEPS {
        let left = match (to, target) {
            (_, Some(target)) if (target - now).abs() <= REACHED => return Ok(()),
            (_, Some(target)) => (target - now) / rate,
            (Extent::Time(end), None) if state.time >= end => return Ok(()),
            (Extent::Time(end), None) => end - state.time,
            (Extent::Angle(_), None) => return Ok(()),
        };
        let motion_rate = state.fastest_turn(model);
        let whole = std::f64::consts::TAU / PLACES / motion_rate.max(f64::MIN_POSITIVE);
        let mut step = left.clamp(-whole, whole);
        let mut reached = None;
        for _ in 0..HALVINGS {
            reached = turning.advance(state, step)?;
            if reached.is_some() {
                break;
            }
            step *= 0.5;
        }
        let Some((mut next, [mut angle, mut then])) = reached else {
            return Err(turning.locked(state, step, now)?);
        };
        // Closing the loops moved the cycle a little. Drives follow it in time; otherwise the twist of springs
        // between the cycle and a drive would grow from turn to turn.
        for _ in 0..RETIMED {
            let took = (angle - now) / (0.5 * (rate + then));
            let late = state.time + took - next.time;
            if turning.still || target.is_none() || !late.is_finite() || late == 0.0 {
                break;
            }
            match turning.moved(&next, 0.0, late)? {
                Some(found) => (next, [angle, then]) = found,
                None => break,
            }
        }
        *state = next;
        if target.is_some() && then * rate <= 0.0 {
            break;
        }
        (now, rate) = (angle, if turning.still { 1.0 } else { then });
    }
    Err(match target {
        Some(target) => unreached(now, target),
        None => RuntimeError::Options {
            message: format!(
                "`at` is too late: the motion is followed for {MOST_STEPS} steps of 10°, and they end at {} s; state an earlier `at`, or another `start`",
                short(state.time, 4)
            ),
        },
    })
}

fn unreached(now: f64, target: f64) -> RuntimeError {
    let (wanted, now) = (target.to_degrees(), now.to_degrees());
    RuntimeError::Options {
        message: format!(
            "the cycle does not reach {wanted:.3}°: a drive or the joints hold it at {now:.3}°"
        ),
    }
}

/// Turns a model through one period and shows each position to `visit`, beginning with the start. Without a
/// cycle it turns the part with the fastest drive once, with the angle counted from the start.
///
/// # Errors
///
/// [`RuntimeError::Locked`] with the cycle angle that the mechanism does not pass; errors of assembling and
/// evaluating.
pub fn turn(
    assembled: &Assembled,
    visit: &mut dyn FnMut(&Place<'_>) -> Result<(), RuntimeError>,
) -> Result<Turned, RuntimeError> {
    let model = assembled.model();
    if model.velocities == 0 {
        // a model without a body: the equations of its motion are empty
        return Ok(Turned::Not);
    }
    let mut state = assembled.state().clone();
    if !is_moved(model, &state)? {
        return Ok(Turned::Not);
    }
    let Ok(motion) = SteadyMotion::new(model, &state) else {
        return Ok(Turned::Not);
    };
    let cycle = model.compiled.system.cycle.as_ref();
    let mut turning = Turning::new(model, motion, cycle.map(|cycle| cycle.element as usize))?;
    let period = cycle.map_or(std::f64::consts::TAU, |cycle| model.slot(cycle.period));
    let Ok(velocity) = turning.motion.velocity(model, &state) else {
        return Ok(Turned::Not);
    };
    state.velocity.copy_from_slice(&velocity);
    if cycle.is_none() {
        turning.speed = driven(model, &state)?;
    }
    let [start, rate] = turning.cycle(&state)?;
    let stands = rate.abs() <= STANDS * state.fastest_turn(model);
    if stands && cycle.is_some() {
        return Ok(match turning.joints_hold_the_cycle(&state)? {
            true => Turned::Held,
            false => Turned::Not,
        });
    }
    if stands || !rate.is_finite() || !(period > 0.0 && period.is_finite()) {
        return Ok(Turned::Not);
    }
    let whole = std::f64::consts::TAU / PLACES / rate.abs();
    let turns = (period / std::f64::consts::TAU).min(MOST_TURNS);
    let places = libm::round(turns * PLACES) as usize;
    let (mut angle, mut now, mut highest) = (start, rate, rate.abs());
    visit(&Place {
        model,
        state: &state,
        angle,
    })?;
    for _ in 0..places {
        let (mut left, mut step, mut halved) = (whole, whole, 0);
        while left > 0.0 {
            let h = step.min(left);
            match turning.advance(&state, h)? {
                Some((next, [reached, then]))
                    if kept_up(reached - angle, 0.5 * (now + then) * h, highest * h) =>
                {
                    if then * rate < 0.0 {
                        return Ok(Turned::Back(reached));
                    }
                    state = next;
                    (angle, now, highest) = (reached, then, highest.max(then.abs()));
                    left -= h;
                    // the rest of a step below this is the rounding of the parts before it, not a step
                    if left < 1e-9 * whole {
                        left = 0.0;
                    }
                }
                _ if halved < HALVINGS => {
                    halved += 1;
                    step *= 0.5;
                }
                _ => return Err(turning.locked(&state, h, angle)?),
            }
        }
        visit(&Place {
            model,
            state: &state,
            angle,
        })?;
    }
    Ok(Turned::Whole)
}

/// The highest speed (rad/s) that a drive imposes on its first marker about its second one's z axis; 0
/// without a drive.
fn driven(model: &Model, state: &State) -> Result<f64, RuntimeError> {
    let mut rest = state.clone();
    rest.velocity.fill(0.0);
    let mut fastest: f64 = 0.0;
    for index in model.constraining() {
        let element = &model.elements[index];
        // a drive's rows change with time while nothing moves
        let rates = Rows::new(model, vec![index]).rates(model, &at(&rest))?;
        if let &[a, b] = element.markers.as_slice()
            && rates.iter().any(|rate| *rate != 0.0)
        {
            let [a, b] = [a, b].map(|m| rows::marker(model, m, &state.pose, &state.velocity));
            let relative = a.rotation * a.angular_velocity - b.rotation * b.angular_velocity;
            fastest = fastest.max(relative.dot(&b.rotation.column(2)).abs());
        }
    }
    Ok(fastest)
}

/// Whether the cycle has turned about as far as its rates before and after predict, as a share of a step at
/// its highest rate. If a cycle reverses, both are small. If a mechanism locks, the rate remains high and the
/// cycle falls behind.
fn kept_up(turned: f64, wanted: f64, step: f64) -> bool {
    (turned - wanted).abs() <= BEHIND * step
}

/// The state of a dry turn.
struct Turning<'a> {
    model: &'a Model,
    motion: SteadyMotion,
    rows: Rows,
    exact: Rows,
    mobility: Vec<f64>,
    dynamics: Dynamics,
    /// The outputs of the cycle, if there is one.
    outputs: Option<Outputs>,
    /// Without a cycle: the rate of the angle (rad/s).
    speed: f64,
    /// Whether time stays and the joints alone turn the cycle, by one radian in a unit of the step.
    still: bool,
    watch: Watch,
}

impl<'a> Turning<'a> {
    fn new(
        model: &'a Model,
        motion: SteadyMotion,
        cycle: Option<usize>,
    ) -> Result<Turning<'a>, RuntimeError> {
        let exact = Rows::new(model, model.constraining().collect());
        let mut mobility = vec![0.0; model.velocities];
        for body in &model.bodies {
            set_mobility(body, 1.0, &mut mobility);
        }
        Ok(Turning {
            model,
            motion,
            rows: exact.clone().with(model, &pins(model)),
            exact,
            mobility,
            dynamics: Dynamics::new(model),
            outputs: cycle.map(|e| Outputs::watching(model, e)).transpose()?,
            speed: 0.0,
            still: false,
            watch: Watch::new(model, |_| true),
        })
    }

    /// Cycle angle (rad) and its rate (rad/s) at a state.
    fn cycle(&mut self, state: &State) -> Result<[f64; 2], RuntimeError> {
        let Some(outputs) = &mut self.outputs else {
            return Ok([self.speed * state.time, self.speed]);
        };
        self.dynamics
            .place(self.model, state.time, &state.pose, &state.velocity);
        outputs.evaluate(self.model, &self.dynamics, state)?;
        Ok(outputs.watched_values)
    }

    /// The velocities that lead on from a position; `None` if there are none. In SI; with `still` per unit of
    /// the step, in which the cycle turns by one radian.
    fn velocity(&mut self, state: &State) -> Result<Option<Vec<f64>>, RuntimeError> {
        if !self.still {
            if let Ok(found) = self.motion.velocity(self.model, state) {
                return Ok(Some(found));
            }
            // the loads that decided a freedom at the start may not act here, such as those of stops that have opened
            let Ok(motion) = SteadyMotion::new(self.model, state) else {
                return Ok(None);
            };
            let found = motion.velocity(self.model, state).ok();
            if found.is_some() {
                self.motion = motion;
            }
            return Ok(found);
        }
        // the least scaled velocities y with G y = 0 and a rate of the cycle of one
        let model = self.model;
        let scales = model.velocity_scales();
        let mut rest = state.clone();
        rest.velocity.fill(0.0);
        let (_, mut gradients) = self.exact.evaluate(model, &at(&rest), Along::Pose)?;
        let count = gradients.nrows();
        self.exact
            .scale(model, &mut DVector::zeros(count), &mut gradients);
        let still = self.cycle(&rest)?[1];
        let mut rows = gradients.insert_row(count, 0.0);
        for (i, scale) in scales.iter().enumerate() {
            rest.velocity[i] = *scale;
            rows[(count, i)] = self.cycle(&rest)?[1] - still;
            rest.velocity[i] = 0.0;
        }
        let wanted = DVector::from_fn(count + 1, |i, _| f64::from(u8::from(i == count)));
        let Some(svd) = crate::singular::decompose(rows.clone()) else {
            return Ok(None);
        };
        let least = RANK * svd.singular_values.amax();
        let Ok(y) = svd.solve(&wanted, least) else {
            return Ok(None);
        };
        // a drive that holds the cycle leaves no such velocity
        let missed = (rows * &y - wanted).amax();
        Ok((missed < HELD).then(|| (0..y.len()).map(|i| y[i] * scales[i]).collect()))
    }

    /// Whether no motion that the joints allow turns the cycle. Drives take no part, because they may begin later.
    fn joints_hold_the_cycle(mut self, state: &State) -> Result<bool, RuntimeError> {
        let model = self.model;
        let joints = model.constraining();
        let joints = joints.filter(|e| !model.class(*e).facts.rows_over_time);
        self.exact = Rows::new(model, joints.collect());
        self.still = true;
        Ok(self.velocity(state)?.is_none())
    }

    /// The position after `h` (s), with the cycle's angle and rate; `None` if the equations do not close.
    fn advance(&mut self, from: &State, h: f64) -> Result<Option<(State, [f64; 2])>, RuntimeError> {
        let time = if self.still { 0.0 } else { h };
        self.moved(from, h, time)
    }

    /// The position to which its velocities lead from another in `h` (s) while `time` (s) passes.
    fn moved(
        &mut self,
        from: &State,
        h: f64,
        time: f64,
    ) -> Result<Option<(State, [f64; 2])>, RuntimeError> {
        let model = self.model;
        let mut next = from.clone();
        next.time += time;
        move_pose(model, &from.pose, &from.velocity, h, &mut next.pose);
        // preferred positions need not close, so few rounds serve; the joints get more, and a step that does
        // not close in eight rounds is halved
        self.settle(&self.rows, &mut next, 4)?;
        if !self.settle(&self.exact, &mut next, 8)? {
            return Ok(None);
        }
        let Some(velocity) = self.velocity(&next)? else {
            return Ok(None);
        };
        next.velocity.copy_from_slice(&velocity);
        self.dynamics
            .place(model, next.time, &next.pose, &next.velocity);
        let inputs = Inputs {
            multipliers: &[],
            rotations: &from.rotations,
            memory: None,
            ..self.dynamics.inputs_at(&next)
        };
        let mut rotations = from.rotations.clone();
        self.watch.unwrap(model, &inputs, &mut rotations)?;
        next.rotations = rotations;
        let cycle = self.cycle(&next)?;
        Ok(Some((next, cycle)))
    }

    /// Brings a position back onto rows by the smallest changes, `x = Aᵀ (A Aᵀ)⁻¹ b`. Returns whether the
    /// rows close. Angles keep the turns of the position before, because the turns of a gear differ from
    /// wheel to wheel.
    fn settle(&self, rows: &Rows, state: &mut State, limit: usize) -> Result<bool, RuntimeError> {
        let model = self.model;
        let scales = model.velocity_scales();
        for last in (0..=limit).rev() {
            let (mut values, mut matrix) = rows.evaluate(model, &at(state), Along::Pose)?;
            rows.scale(model, &mut values, &mut matrix);
            if values.is_empty() || values.amax() < CLOSED {
                return Ok(true);
            }
            if last == 0 {
                break;
            }
            for (mut column, mobility) in matrix.column_iter_mut().zip(&self.mobility) {
                column.scale_mut(*mobility);
            }
            let mut normal = &matrix * matrix.transpose();
            let soft = SOFT * normal.diagonal().amax();
            for i in 0..normal.nrows() {
                normal[(i, i)] += soft;
            }
            let Some(factor) = normal.cholesky() else {
                return Ok(false);
            };
            let step = matrix.transpose() * factor.solve(&values);
            let increment: Vec<f64> = (0..step.len())
                .map(|i| -step[i] * self.mobility[i] * scales[i])
                .collect();
            // a correction as large as the model or a radian belongs to another position of the mechanism, or
            // to a lock
            if increment.iter().any(|x| !x.is_finite()) || step.amax() > 1.0 {
                return Ok(false);
            }
            let pose = state.pose.clone();
            move_pose(model, &pose, &increment, 1.0, &mut state.pose);
        }
        Ok(false)
    }

    /// The error for a lock beyond a position. It names the equations that remain open when the bodies are
    /// moved further and held.
    fn locked(&self, state: &State, h: f64, angle: f64) -> Result<RuntimeError, RuntimeError> {
        let model = self.model;
        let moment = Moment {
            time: state.time,
            cycle_angle: self.outputs.as_ref().map(|_| angle),
        };
        if let Some(locked) = lock::near(model, state, moment)? {
            return Ok(locked);
        }
        let mut beyond = state.clone();
        beyond.time += h;
        move_pose(model, &state.pose, &state.velocity, h, &mut beyond.pose);
        let (values, _) = self.exact.evaluate(model, &at(&beyond), Along::Pose)?;
        let mut open: Vec<usize> = (0..self.exact.len()).collect();
        let size = |i: usize| (values[i] / self.exact.scales[i]).abs();
        open.sort_by(|a, b| size(*b).total_cmp(&size(*a)).then(a.cmp(b)));
        // a message lists the three worst equations; a lock opens few, and its loop passes error on to all
        // others
        open.truncate(3);
        let chain = open
            .iter()
            .find_map(|i| chains::through(model, self.exact.owners[*i].0, state));
        Ok(RuntimeError::Locked {
            moment,
            rows: open
                .into_iter()
                .map(|i| {
                    let (element, row) = self.exact.owners[i];
                    model.named_row(element, row, values[i])
                })
                .collect(),
            chain: chain.map(Box::new),
        })
    }
}
