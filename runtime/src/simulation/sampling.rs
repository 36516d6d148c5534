//! Outputs of a simulation: at the last accepted state, and within the last step at times and cycle angles.

use super::{Energy, Simulation};
use crate::acceleration::Factors;
use crate::error::{Moment, RuntimeError};
use crate::state::{State, move_pose};
use eng_system::dense::largest;

/// Largest part of a step h along which a sample follows its own rates. It then differs from the
/// interpolation by `½ (1e-4 h)² v̇`. A choice: this is below the error of the interpolation itself.
const SHORT: f64 = 1e-4;

/// Roundings of the time that may be between two steps. A choice above the two roundings by which a step ends
/// before a moment on both sides.
const ROUNDINGS: f64 = 8.0;

impl Simulation {
    /// Value of a channel at the last accepted state (SI). It uses projected positions and velocities. The
    /// integrator keeps its own.
    pub fn value(&mut self, channel: usize) -> Result<f64, RuntimeError> {
        self.evaluate_current()?;
        self.outputs
            .values
            .get(channel)
            .copied()
            .ok_or_else(|| RuntimeError::Options {
                message: format!("there is no channel {channel}"),
            })
    }

    /// Values of all channels at the last accepted state (SI), into as many numbers as there are channels.
    pub fn evaluate_channels(&mut self, out: &mut [f64]) -> Result<(), RuntimeError> {
        self.evaluate_current()?;
        self.copy_channels(out)
    }

    pub(super) fn copy_channels(&self, out: &mut [f64]) -> Result<(), RuntimeError> {
        if out.len() != self.outputs.values.len() {
            return Err(RuntimeError::Options {
                message: format!(
                    "room for {} channels, not {}",
                    out.len(),
                    self.outputs.values.len()
                ),
            });
        }
        out.copy_from_slice(&self.outputs.values);
        Ok(())
    }

    fn evaluate_current(&mut self) -> Result<(), RuntimeError> {
        let key = self.integrator.current.time.to_bits();
        if self.evaluated != Some(key) {
            let time = self.integrator.current.time;
            match self.behind_start()? {
                Some(behind) => self.completed.copy_from(&behind),
                None => self.completed.copy_from(&self.integrator.current),
            }
            self.complete()?;
            self.completed.time = time;
            self.evaluated = Some(key);
        }
        Ok(())
    }

    /// Projects and completes `self.completed` and evaluates the outputs there.
    pub(super) fn complete(&mut self) -> Result<(), RuntimeError> {
        self.evaluated = None;
        let moment = Moment {
            time: self.completed.time,
            cycle_angle: self.cycle_now.map(|c| c[0]),
        };
        self.system
            .complete(
                &self.model,
                &mut self.dynamics,
                &mut self.integrator,
                &mut self.completed,
                moment,
            )
            .map_err(|error| self.at_moment(error))?;
        self.evaluate_completed()
    }

    /// Evaluates the outputs and the energies of the completed state, at which the dynamics are placed.
    fn evaluate_completed(&mut self) -> Result<(), RuntimeError> {
        self.outputs
            .evaluate(&self.model, &self.dynamics, &self.completed)
            .map_err(|error| self.at_moment(error))?;
        self.compute_sampled_energy();
        Ok(())
    }

    /// Computes the energies of the completed state, at which the dynamics are placed. Works are Hermite's
    /// cubics over the last step, with the powers at its ends.
    pub(super) fn compute_sampled_energy(&mut self) {
        let [kinetic, gravity, strain, _] =
            self.dynamics.energy(&self.model, &self.completed.velocity);
        let to = self.integrator.current.time;
        let h = self.earlier_step;
        let s = if h > 0.0 {
            ((self.completed.time - (to - h)) / h).clamp(0.0, 1.0)
        } else {
            1.0
        };
        let value = s * s * (3.0 - 2.0 * s);
        let now = [
            self.energy.loads,
            self.energy.constraints,
            self.energy.damping,
        ];
        let [loads, constraints, damping] = std::array::from_fn(|i| {
            let before = self.energy_before[i];
            before
                + value * (now[i] - before)
                + h * s * (1.0 - s) * (1.0 - s) * self.earlier_powers[i]
                - h * s * s * (1.0 - s) * self.powers[i]
        });
        self.sampled_energy = Energy {
            kinetic,
            gravity,
            strain,
            damping,
            loads,
            constraints,
            start: self.energy.start,
        };
    }

    /// Values of all channels at a time within the last step, from the dense output; returns cycle angle and
    /// rate there.
    pub fn sample_at(
        &mut self,
        time: f64,
        out: &mut [f64],
    ) -> Result<Option<[f64; 2]>, RuntimeError> {
        self.interpolate_at(time)?;
        self.complete()?;
        self.copy_channels(out)?;
        self.cycle_of_completed()
    }

    /// Values of all channels where the cycle has an angle (rad) within the last step; returns the time,
    /// cycle angle and rate.
    ///
    /// The projection of the output changes the angle by the error of the interpolation. So the projected state
    /// follows its own motion until it has the angle.
    pub fn sample_at_angle(
        &mut self,
        angle: f64,
        out: &mut [f64],
    ) -> Result<(f64, [f64; 2]), RuntimeError> {
        let (from, to) = (self.integrator.previous.time, self.integrator.current.time);
        let mut time = self.locate_angle(angle)?;
        self.interpolate_at(time)?;
        let mut factors = Factors::Made;
        for _ in 0..4 {
            let moment = Moment {
                time,
                cycle_angle: Some(angle),
            };
            // only positions decide the angle, so the factors of the first round serve all rounds
            self.system
                .project(
                    &self.model,
                    &mut self.dynamics,
                    &mut self.completed,
                    moment,
                    factors,
                )
                .map_err(|error| self.at_moment(error))?;
            factors = Factors::Kept;
            let [now, rate] = self.cycle_of_completed()?.ok_or(RuntimeError::NoCycle)?;
            let miss = angle - now;
            let next = (time + miss / rate).clamp(from, to);
            // angles of a turn are rounded to 1e-15, and no result shows a smaller difference
            if miss.abs() <= 1e-12 * angle.abs().max(1.0) || !next.is_finite() || next == time {
                break;
            }
            if (next - time).abs() > SHORT * (to - from) {
                self.interpolate_at(next)?;
            } else {
                self.follow_motion(next - time);
                self.completed.time = next;
            }
            time = next;
        }
        let moment = Moment {
            time: self.completed.time,
            cycle_angle: Some(angle),
        };
        let settles = self.completed.time < self.integrator.current.time;
        self.system
            .finish(
                &self.model,
                &mut self.dynamics,
                &mut self.integrator,
                &mut self.completed,
                (moment, settles),
            )
            .map_err(|error| self.at_moment(error))?;
        self.evaluate_completed()?;
        self.copy_channels(out)?;
        let cycle = self.cycle_of_completed()?.ok_or(RuntimeError::NoCycle)?;
        Ok((self.completed.time, cycle))
    }

    /// Moves the completed state along its rates for a time e (s), to first order: its positions differ from
    /// those of the interpolation by `½ e² v̇`.
    fn follow_motion(&mut self, e: f64) {
        let state = &mut self.completed;
        self.rest.copy_from_slice(&state.velocity);
        for (v, a) in state.velocity.iter_mut().zip(&state.acceleration) {
            *v += e * a;
        }
        for (y, rate) in state.states.iter_mut().zip(&state.rates) {
            *y += e * rate;
        }
        self.pose.copy_from_slice(&state.pose);
        move_pose(&self.model, &self.pose, &self.rest, e, &mut state.pose);
    }

    pub(super) fn interpolate_at(&mut self, time: f64) -> Result<(), RuntimeError> {
        let (from, to) = (self.integrator.previous.time, self.integrator.current.time);
        // a motion that starts again after a moment leaves a gap of some roundings of the time between
        // two steps
        let begin = from - ROUNDINGS * f64::EPSILON * from.abs();
        if !(begin..=to).contains(&time) {
            return Err(RuntimeError::OutsideStep { time, from, to });
        }
        self.evaluated = None;
        if time == to {
            self.completed.copy_from(&self.integrator.current);
        } else {
            let fraction = ((time - from) / (to - from)).max(0.0);
            self.integrator
                .interpolate(&self.model, fraction, &mut self.work, &mut self.completed);
        }
        // the velocities of a sample follow its loads
        self.completed.time = (self.kinks).beside_touch(&self.model, &self.dynamics, time)?;
        Ok(())
    }

    /// Cycle angle and rate at the state of the last outputs.
    pub fn sampled_cycle(&mut self) -> Result<Option<[f64; 2]>, RuntimeError> {
        if let Some(cycle) = &self.cycle {
            (self.dynamics).place_some(&self.model, &self.completed, cycle.markers());
        }
        self.cycle_of_completed()
    }

    /// Cycle angle and rate of `self.completed`, at which the dynamics are placed.
    pub(super) fn cycle_of_completed(&mut self) -> Result<Option<[f64; 2]>, RuntimeError> {
        match &mut self.cycle {
            Some(cycle) => {
                cycle.evaluate(&self.model, &self.dynamics, &self.completed)?;
                Ok(Some(cycle.watched_values))
            }
            None => Ok(None),
        }
    }

    /// Cycle angle and rate of the dense output at one end of the last step.
    fn cycle_at_end(&mut self, time: f64) -> Result<[f64; 2], RuntimeError> {
        self.interpolate_at(time)?;
        let cycle = self.cycle.as_ref().ok_or(RuntimeError::NoCycle)?;
        (self.dynamics).place_some(&self.model, &self.completed, cycle.markers());
        self.cycle_of_completed()?.ok_or(RuntimeError::NoCycle)
    }

    /// The time within the last step at which the cycle has an angle (rad), on the cubic over the step with
    /// angles and rates at its ends. This cubic and the angle of the dense output differ by an error of
    /// fourth order in the step. For an angle outside it is the nearer end.
    pub fn locate_angle(&mut self, angle: f64) -> Result<f64, RuntimeError> {
        let (from, to) = (self.integrator.previous.time, self.integrator.current.time);
        let ends = match self.cycle_at_ends {
            // all samples of a step share its ends
            Some(ends) => ends,
            None => [self.cycle_at_end(from)?, self.cycle_at_end(to)?],
        };
        self.cycle_at_ends = Some(ends);
        Ok(crossing(from, to, ends, angle))
    }

    /// The last accepted state projected on the constraints, with accelerations and multipliers of the
    /// acceleration-level system.
    pub fn output_state(&mut self) -> Result<&State, RuntimeError> {
        self.evaluate_current()?;
        Ok(&self.completed)
    }

    /// The state of the last outputs, anywhere in the last step: projected, with accelerations and
    /// multipliers.
    pub fn sampled_state(&self) -> &State {
        &self.completed
    }

    /// Largest |Φ| (m, rad) and |Φ̇| (m/s, rad/s) of the state of the last outputs.
    pub fn output_drift(&mut self) -> Result<(f64, f64), RuntimeError> {
        let state = &self.completed;
        self.dynamics
            .set_state(&self.model, state, &state.multipliers);
        self.dynamics.evaluate_constraints(&self.model)?;
        self.dynamics.rate_level(&self.model)?;
        Ok((
            largest(self.dynamics.constraints()),
            largest(self.dynamics.constraint_rates()),
        ))
    }
}

/// The time between `from` and `to` (s) at which a cubic has a value, by Newton's iteration within a bracket.
/// The cubic has a value and a rate (1/s) at each end. For a value beyond both ends it is the nearer end.
pub fn crossing(from: f64, to: f64, ends: [[f64; 2]; 2], value: f64) -> f64 {
    let h = to - from;
    let [[a, da], [b, db]] = ends;
    let (first, last) = (a - value, b - value);
    if last == 0.0 || h <= 0.0 {
        return to;
    }
    if first == 0.0 || (first > 0.0) == (last > 0.0) {
        return if first.abs() < last.abs() { from } else { to };
    }
    let at = |s: f64| {
        let rest = s * s * (3.0 - 2.0 * s);
        let miss = first + rest * (b - a) + h * s * (1.0 - s) * ((1.0 - s) * da - s * db);
        let slope = 6.0 * s * (1.0 - s) * (b - a)
            + h * ((1.0 - s) * (1.0 - 3.0 * s) * da + s * (3.0 * s - 2.0) * db);
        (miss, slope)
    };
    let (mut low, mut high) = (0.0, 1.0);
    let mut s = first / (first - last);
    // bisection alone would need 53 rounds
    for _ in 0..60 {
        let (miss, slope) = at(s);
        if miss == 0.0 {
            break;
        }
        if (miss > 0.0) == (last > 0.0) {
            high = s;
        } else {
            low = s;
        }
        let newton = s - miss / slope;
        let next = if low < newton && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if next == s {
            break;
        }
        s = next;
    }
    from + s * h
}
