//! Kinks of constraints: a velocity that a constraint requires must not jump there.
//!
//! A constraint requires `Φ = 0` and `Φ̇ = 0`. A drive along `max(0 s, t − 1 s) · 1 m/s` requires another
//! velocity after its kink than before it. The change of velocities needs an impulse, whose distribution and
//! loss of energy an impact law would have to state. Eng has no such laws. Steps across the kink would take a
//! velocity between both, and lose or gain momentum and energy. So the run ends there. If only the required
//! acceleration jumps, the motion starts again after the kink.
//!
//! Both sides are compared at one motion: Φ and Φ̇ of the element at the motion just before and just after
//! the kink, along the velocities and accelerations before it. The difference of a continuous value shrinks
//! with the distance of both.
//!
//! The place of the kink is the zero of its function. Where the rate of the function does not lead to it, as
//! at `(t − 1 s)³`, bisection finds the place. A function that only touches zero changes no sign, and requires
//! no jump.

use super::Simulation;
use crate::assembly::velocity::{NEARER, REMAINS};
use crate::error::{AccelerationJump, Moment, RuntimeError};
use crate::state::State;

/// Smallest jump of a required velocity that counts: as a share of the model's motion, and of the model's
/// length in a second. A smaller one is rounding, or an error of the text that no result shows. Both are
/// choices.
const VELOCITY: (f64, f64) = (1e-6, 1e-9);
/// Distances from a moment, in roundings of the time. The smaller one is that of steps that end there. The
/// larger one is a choice: a thousand times that, so that a slope and a jump differ.
const ROUNDINGS: [f64; 2] = [2048.0, 2.0];
/// Distance from a kink within a step, as a share of the step. Nearer to a corner, a rate such as that of
/// `acos(dot(a, b))` has few digits: at the angle x from the corner, the rounding ε of the cosine changes it
/// by `ε/x²` of itself. A hundred radians a second and steps of 0.1 ms are `x = 1e-6` there, so the rate is
/// known to 2e-4.
const WITHIN: f64 = 1e-4;
/// Largest deviation of the change of a kink's function from its rate, where the kink counts as passed. A
/// choice: a function with a zero of higher order deviates by more.
const STRAIGHT: f64 = 0.5;
/// Longest distance from a kink, as a share of the step, over which the rate of its function says where the
/// kink is. A choice: over a hundredth of a step a rate changes by about as much.
const SMOOTH: f64 = 1e-2;
/// Shortest distance from a kink (s). A choice above the rounding of times of a run of some seconds, 1e-16 s
/// a second, and below the time in which any load changes.
const SHORTEST: f64 = 1e-12;
/// Growth of the distance over which a kink is searched. A choice: 17 of them lead from 1e-12 s to a step of
/// 20 ms, and each costs two evaluations.
const WIDER: f64 = 4.0;
/// Places after the beginning of a step, in steps, up to which the motion before a kink is followed to find
/// it. A choice: the motion before the step may reach the kink later than the step did, because the step had
/// another acceleration behind it.
const ALONG: [f64; 4] = [0.5, 1.0, 1.5, 2.0];
/// Distance from a kink at which accelerations are compared, as a share of the step. A choice: near enough
/// for both slopes to be those at the kink, and far enough for differences of rates with some ten digits.
const APART: f64 = 1e-3;
/// Largest error of a position over a step h after a jump of an acceleration, as a share of h² times the
/// jump. [`Simulation::keep_acceleration_jump`] derives it.
const MOST_ERROR: f64 = 0.25;

/// Φ and Φ̇ of an element on the other side of a kink, less those on this side.
type Difference = Vec<[f64; 2]>;

impl Simulation {
    /// Refuses to continue from kinks at which a constraint requires a jump.
    pub(super) fn refuse_jumps_here(&mut self) -> Result<(), RuntimeError> {
        let factor = self.options.step.tolerance();
        let here = self.integrator.current.time;
        let kinks = self.kinks.constrains_here(here, factor);
        if kinks.is_empty() {
            return Ok(());
        }
        let base = self.integrator.current.clone();
        let found = kinks.into_iter().try_for_each(|kink| {
            self.place_kinks(&base)?;
            if self.kinks.is_moment(kink) {
                let moment = self.kinks.moment_at(kink, here);
                let rounding = f64::EPSILON * moment.abs().max(f64::MIN_POSITIVE);
                let distances = ROUNDINGS.map(|count| count * rounding);
                return self.refuse_jump(kink, &base, moment - here, distances);
            }
            let [to_kink, around] = self.kinks.times_to(kink, here, factor);
            // some roundings of the time
            let around = around.max(8.0 * f64::EPSILON * here.abs()).max(SHORTEST);
            let rate = self.kinks.rate(kink);
            let ends = [to_kink - around, to_kink + around];
            let step = (self.options.step.fixed()).unwrap_or(self.size.step);
            // over a long distance another zero of the function may bring the change that the rate says
            if around <= SMOOTH * step && self.passes(kink, &base, rate, ends)? {
                return self.refuse_jump(kink, &base, to_kink, [around, NEARER * around]);
            }
            let Some(found) = self.crossed_beside(kink, &base, factor)? else {
                return Ok(());
            };
            let distance = (WITHIN * step).max(SHORTEST);
            self.refuse_jump(kink, &base, found, [distance, NEARER * distance])
        });
        self.stand()?;
        found
    }

    /// Refuses kinks within the last step at which a constraint requires a jump: kinks with the times (s) from
    /// its beginning. The motion is that before the step, because after a jump the step has a velocity
    /// between those of both sides.
    pub(super) fn refuse_jumps_within(
        &mut self,
        passed: &[(usize, f64)],
    ) -> Result<(), RuntimeError> {
        if passed.is_empty() {
            return Ok(());
        }
        let h = self.integrator.current.time - self.integrator.previous.time;
        let base = self.integrator.previous.clone();
        let found = passed.iter().try_for_each(|(kink, time)| {
            self.place_kinks(&base)?;
            let before = self.kinks.value(*kink);
            let mut place = None;
            for (end, part) in ALONG.into_iter().enumerate() {
                let ahead = if end == 0 { *time } else { part * h };
                if self.value_at(*kink, &base, ahead)? * before < 0.0 {
                    place = Some(self.between(*kink, &base, [0.0, ahead])?);
                    break;
                }
            }
            let Some(place) = place else { return Ok(()) };
            let distance = (WITHIN * h).min(0.5 * place);
            self.refuse_jump(*kink, &base, place, [distance, NEARER * distance])?;
            self.keep_acceleration_jump(*kink, &base, (place, h))
        });
        self.stand()?;
        found
    }

    /// Keeps a kink at a time (s) after a motion, within a fixed step h (s), if the acceleration that a
    /// constraint requires jumps there by a size that matters.
    ///
    /// The jump of Φ̈ is that of the slope of Φ̇, from two points on each side, at `−2d, −d, d, 2d` from the
    /// kink. The scheme integrates accelerations like a trapezoid. So after a jump `Δa` at the share s of the
    /// step, a motion that follows it errs by `h² Δa (1/4 − (1 − s)²/2)`, a quarter of `h² Δa` at most.
    fn keep_acceleration_jump(
        &mut self,
        kink: usize,
        base: &State,
        (place, h): (f64, f64),
    ) -> Result<(), RuntimeError> {
        if self.options.step.fixed().is_none() {
            return Ok(());
        }
        let element = self.kinks.element(kink);
        let mut jumps: Vec<Vec<f64>> = Vec::new();
        for distance in [APART * h, NEARER * APART * h] {
            let times = [-2.0, -1.0, 1.0, 2.0].map(|d| place + d * distance);
            let rates = times.map(|e| self.demands(element, base, e));
            let [Some(a), Some(b), Some(c), Some(d)] = &rates else {
                return Ok(());
            };
            let rows = 0..a.len();
            let jump = |row: usize| (d[row][1] - c[row][1] - b[row][1] + a[row][1]) / distance;
            jumps.push(rows.map(jump).collect());
        }
        let [far, near] = &jumps[..] else {
            return Ok(());
        };
        let limit = self.model.tolerance / self.model.length;
        let error_of = |jump: f64| MOST_ERROR * h * h * jump.abs();
        let errors = far.iter().zip(near).enumerate().map(|(row, (far, near))| {
            let remains = near.abs() >= REMAINS * far.abs();
            let error = error_of(*near) / self.model.row_scale(element, row);
            (row, if remains { error } else { 0.0 })
        });
        let most = errors.max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((row, error)) = most.filter(|(_, error)| *error > limit) else {
            return Ok(());
        };
        let named = |value: f64| Box::new(self.model.named_row(element, row, value));
        let jump = AccelerationJump {
            size: named(near[row].abs()),
            error: named(error_of(near[row])),
        };
        let end = self.moment();
        let passed = self.kinks.at_end(kink, end.time);
        self.keep_overlooked(&passed, (h, end), (error / limit, Some(jump)));
        Ok(())
    }

    /// The time (s) after a motion at which the function of a kink changes its sign, if it does so at most a
    /// step away. Its sizes before and after it must be above rounding.
    fn crossed_beside(
        &mut self,
        kink: usize,
        base: &State,
        factor: f64,
    ) -> Result<Option<f64>, RuntimeError> {
        let least = self.kinks.side(kink, base.time, factor);
        let reach = (self.options.step.fixed()).unwrap_or(self.size.step);
        let starts = self.integrator.statistics.steps == 0;
        let mut distance = SHORTEST;
        while distance < reach {
            distance = (WIDER * distance).min(reach);
            let ends = [if starts { 0.0 } else { -distance }, distance];
            let before = self.value_at(kink, base, ends[0])?;
            let behind = self.value_at(kink, base, ends[1])?;
            if before.abs() > least && behind.abs() > least && before * behind < 0.0 {
                return self.between(kink, base, ends).map(Some);
            }
        }
        Ok(None)
    }

    /// The time (s) after a motion, between two others, at which the function of a kink changes its sign.
    fn between(
        &mut self,
        kink: usize,
        base: &State,
        [mut low, mut high]: [f64; 2],
    ) -> Result<f64, RuntimeError> {
        let side = self.value_at(kink, base, low)?.signum();
        loop {
            let middle = 0.5 * (low + high);
            let done = middle <= low || middle >= high;
            if done || high - low <= f64::EPSILON * (base.time + high).abs() {
                return Ok(middle);
            }
            if side * self.value_at(kink, base, middle)? > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
    }

    /// The function of a kink at a time (s) after a motion.
    fn value_at(&mut self, kink: usize, base: &State, e: f64) -> Result<f64, RuntimeError> {
        let state = self.moved(base, e);
        self.place_kinks(&state)?;
        Ok(self.kinks.value(kink))
    }

    /// Evaluates the kink functions at a state.
    pub(super) fn place_kinks(&mut self, state: &State) -> Result<(), RuntimeError> {
        self.dynamics.set_state(&self.model, state, &[]);
        self.kinks.evaluate(&self.model, &self.dynamics, state)
    }

    /// Refuses a kink at a time (s) after a motion, if a constraint requires a jump there: its difference does
    /// not shrink from the larger distance (s) to the smaller one.
    fn refuse_jump(
        &mut self,
        kink: usize,
        base: &State,
        to_kink: f64,
        distances: [f64; 2],
    ) -> Result<(), RuntimeError> {
        let element = self.kinks.element(kink);
        let mut differences: Vec<Difference> = Vec::new();
        for distance in distances {
            // before its start a motion has no values
            let starts = self.integrator.statistics.steps == 0;
            let before = if starts { 0.0 } else { to_kink - distance };
            let ends = [before, to_kink + distance];
            let ends = ends.map(|e| self.demands(element, base, e));
            let [Some(before), Some(behind)] = ends else {
                // the next step reports values that are no numbers
                return Ok(());
            };
            let pairs = before.iter().zip(&behind);
            let difference = pairs.map(|(a, b)| [b[0] - a[0], b[1] - a[1]]);
            differences.push(difference.collect());
        }
        let [far, near] = &differences[..] else {
            return Ok(());
        };
        let motion_rate = base.motion_rate(&self.model);
        let least = [
            self.model.tolerance / self.model.length,
            VELOCITY.0 * motion_rate + VELOCITY.1,
        ];
        for order in 0..2 {
            let jumps = far.iter().zip(near).enumerate().map(|(row, (far, near))| {
                let remains = near[order].abs() >= REMAINS * far[order].abs();
                let size = near[order].abs() / self.model.row_scale(element, row);
                (row, if remains { size } else { 0.0 })
            });
            let most = jumps.max_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((row, _)) = most.filter(|(_, size)| *size > least[order]) {
                let by = near[row][order].abs();
                return Err(self.demanded(kink, base.time + to_kink, row, (order == 1, by)));
            }
        }
        Ok(())
    }

    /// Whether the function of a kink changes about as its rate says between two times (s) after a motion.
    /// The place of its zero then follows from the rate.
    fn passes(
        &mut self,
        kink: usize,
        base: &State,
        rate: f64,
        [before, behind]: [f64; 2],
    ) -> Result<bool, RuntimeError> {
        let starts = self.integrator.statistics.steps == 0;
        let before = if starts { 0.0 } else { before };
        let change = self.value_at(kink, base, behind)? - self.value_at(kink, base, before)?;
        let foreseen = rate * (behind - before);
        Ok((change - foreseen).abs() <= STRAIGHT * foreseen.abs())
    }

    /// Φ and Φ̇ of an element at a time e (s) after a motion, along its velocities and accelerations; `None`
    /// where they are no numbers.
    fn demands(&mut self, element: usize, base: &State, e: f64) -> Option<Difference> {
        let state = self.moved(base, e);
        self.dynamics.set_state(&self.model, &state, &[]);
        self.dynamics.evaluate_constraints(&self.model).ok()?;
        self.dynamics.rate_level(&self.model).ok()?;
        let first = self.model.elements[element].row;
        let rows = first..first + self.model.class(element).rows.len();
        let pairs = (self.dynamics.constraints()[rows.clone()].iter())
            .zip(&self.dynamics.constraint_rates()[rows]);
        Some(pairs.map(|(value, rate)| [*value, *rate]).collect())
    }

    fn demanded(
        &self,
        kink: usize,
        time: f64,
        row: usize,
        (velocity, by): (bool, f64),
    ) -> RuntimeError {
        let (origin, text) = self.kinks.place(&self.model, kink);
        let row = self.model.named_row(self.kinks.element(kink), row, by);
        RuntimeError::Demanded {
            moment: Moment {
                time,
                cycle_angle: self.cycle_now.map(|cycle| cycle[0]),
            },
            origin: Box::new(origin),
            text,
            row: Box::new(row),
            velocity,
        }
    }
}
