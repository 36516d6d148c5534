//! Kinks of constraints: a velocity that a constraint demands must not jump there.
//!
//! A constraint demands `Φ = 0` and `Φ̇ = 0`. A drive along `max(0 s, t − 1 s) · 1 m/s` demands another velocity behind its kink
//! than before it. The change of velocities needs an impulse, whose distribution and loss of energy an impact law
//! would have to state. Eng has no such laws. Steps across the kink would take a velocity between both, and lose or gain
//! momentum and energy. So the run ends there. If only the demanded acceleration jumps, the motion starts again
//! behind the kink.
//!
//! Both sides are compared at one motion: Φ and Φ̇ of the element at the motion just before and just behind the kink, along the
//! velocities and accelerations before it. The difference of a continuous value shrinks with the distance of both.

use super::Simulation;
use crate::error::{Moment, RuntimeError};
use crate::state::State;

/// Smallest jump of a demanded velocity that counts: as a share of the model's motion, and of the model's length in a second. A
/// smaller one is rounding, or an error of the text that no result shows.
const VELOCITY: (f64, f64) = (1e-6, 1e-9);
/// The second distance from the kink as a share of the first one, and the least part of a difference that remains there if it is a
/// jump.
const NEARER: f64 = 0.25;
const REMAINS: f64 = 0.5;
/// Distances from a moment, in roundings of the time. The smaller one is that of steps that end there.
const ROUNDINGS: [f64; 2] = [2048.0, 2.0];
/// Distance from a kink within a step, as a share of the step.
const WITHIN: f64 = 1e-5;
/// Shortest distance from a kink (s).
const SHORTEST: f64 = 1e-12;

/// Φ and Φ̇ of an element on the other side of a kink, less those on this side.
type Difference = Vec<[f64; 2]>;

impl Simulation {
    /// Refuses to continue from kinks at which a constraint demands a jump.
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
            let [to_kink, around] = self.kinks.times_to(kink, here, factor);
            let (to_kink, distances) = if self.kinks.is_moment(kink) {
                let kink = self.kinks.moment_at(kink, here);
                let rounding = f64::EPSILON * kink.abs().max(f64::MIN_POSITIVE);
                (kink - here, ROUNDINGS.map(|count| count * rounding))
            } else {
                let around = around.max(8.0 * f64::EPSILON * here.abs()).max(SHORTEST);
                (to_kink, [around, NEARER * around])
            };
            self.refuse_jump(kink, &base, to_kink, distances)
        });
        self.stand()?;
        found
    }

    /// Refuses kinks within the last step at which a constraint demands a jump: kinks with the times (s) from its beginning.
    pub(super) fn refuse_jumps_within(
        &mut self,
        passed: &[(usize, f64)],
    ) -> Result<(), RuntimeError> {
        if passed.is_empty() {
            return Ok(());
        }
        let h = self.integrator.current.time - self.integrator.previous.time;
        let found = passed.iter().try_for_each(|(kink, time)| {
            let mut base = self.integrator.current.clone();
            (self.integrator).interpolate(&self.model, time / h, &mut self.work, &mut base);
            base.time = self.integrator.previous.time + time;
            self.place_kinks(&base)?;
            let [to_kink, _] = self.kinks.times_to(*kink, base.time, 1.0);
            let distances = [WITHIN * h, NEARER * WITHIN * h];
            self.refuse_jump(*kink, &base, to_kink.clamp(-h, h), distances)
        });
        self.stand()?;
        found
    }

    /// Evaluates the kink functions at a state.
    fn place_kinks(&mut self, state: &State) -> Result<(), RuntimeError> {
        self.place_at(state);
        self.kinks.evaluate(&self.model, &self.dynamics, state)
    }

    fn place_at(&mut self, state: &State) {
        self.dynamics
            .place(&self.model, state.time, &state.pose, &state.velocity);
        (self.dynamics).gather(&self.model, &state.states, &[], &state.rotations);
    }

    /// Refuses a kink at a time (s) behind a motion, if a constraint demands a jump there: its difference does not shrink
    /// from the larger distance (s) to the smaller one.
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
            let ends = [before, to_kink + distance].map(|e| self.demands(element, base, e));
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
        let scales = self.model.velocity_scales();
        let largest = |x: &[f64]| {
            let pairs = x.iter().zip(&scales);
            pairs.fold(0.0_f64, |w, (x, s)| w.max((x / s).abs()))
        };
        let pace = largest(&base.velocity).max(libm::sqrt(largest(&base.acceleration)));
        let least = [
            self.model.tolerance / self.model.length,
            VELOCITY.0 * pace + VELOCITY.1,
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

    /// Φ and Φ̇ of an element at a time e (s) behind a motion, along its velocities and accelerations; `None` where they are no
    /// numbers.
    fn demands(&mut self, element: usize, base: &State, e: f64) -> Option<Difference> {
        let state = self.moved(base, e);
        self.place_at(&state);
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
