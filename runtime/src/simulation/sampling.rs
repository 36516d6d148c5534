//! Outputs of a simulation: at the last accepted state, and within the last step at times and cycle angles.

use super::{Energy, Simulation};
use crate::error::{Moment, RuntimeError};
use crate::state::State;

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

    fn copy_channels(&self, out: &mut [f64]) -> Result<(), RuntimeError> {
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
            self.completed.copy_from(&self.integrator.current);
            self.complete()?;
            self.evaluated = Some(key);
        }
        Ok(())
    }

    /// Projects and completes `self.completed` and evaluates the outputs there.
    fn complete(&mut self) -> Result<(), RuntimeError> {
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
            .and_then(|()| {
                self.outputs
                    .evaluate(&self.model, &self.dynamics, &self.completed)
            })
            .map_err(|error| self.at_moment(error))?;
        self.take_sampled_energy();
        Ok(())
    }

    /// Computes the energies of the completed state, at which the dynamics are placed. Works are Hermite's
    /// cubics over the last step, with the powers at its ends.
    pub(super) fn take_sampled_energy(&mut self) {
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
    /// The projection of the output changes the angle by the error of the interpolation. So the time is
    /// corrected until the projected state has the angle.
    pub fn sample_at_angle(
        &mut self,
        angle: f64,
        out: &mut [f64],
    ) -> Result<(f64, [f64; 2]), RuntimeError> {
        let (from, to) = (self.integrator.previous.time, self.integrator.current.time);
        let mut time = self.locate_angle(angle)?;
        for round in 0..4 {
            self.interpolate_at(time)?;
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
                    round == 0,
                )
                .map_err(|error| self.at_moment(error))?;
            let [now, rate] = self.cycle_of_completed()?.ok_or(RuntimeError::NoCycle)?;
            let miss = angle - now;
            let next = (time + miss / rate).clamp(from, to);
            if miss.abs() <= 1e-12 * angle.abs().max(1.0) || !next.is_finite() || next == time {
                break;
            }
            time = next;
        }
        let moment = Moment {
            time: self.completed.time,
            cycle_angle: Some(angle),
        };
        self.system
            .finish(
                &self.model,
                &mut self.dynamics,
                &mut self.integrator,
                &mut self.completed,
                moment,
            )
            .and_then(|()| {
                self.outputs
                    .evaluate(&self.model, &self.dynamics, &self.completed)
            })
            .map_err(|error| self.at_moment(error))?;
        self.take_sampled_energy();
        self.copy_channels(out)?;
        let cycle = self.cycle_of_completed()?.ok_or(RuntimeError::NoCycle)?;
        Ok((self.completed.time, cycle))
    }

    fn interpolate_at(&mut self, time: f64) -> Result<(), RuntimeError> {
        let (from, to) = (self.integrator.previous.time, self.integrator.current.time);
        if !(from..=to).contains(&time) {
            return Err(RuntimeError::OutsideStep { time, from, to });
        }
        self.evaluated = None;
        if time == to {
            self.completed.copy_from(&self.integrator.current);
        } else {
            let fraction = (time - from) / (to - from);
            self.integrator
                .interpolate(&self.model, fraction, &mut self.work, &mut self.completed);
        }
        self.completed.time = time;
        Ok(())
    }

    /// Cycle angle and rate at the state of the last outputs.
    pub fn sampled_cycle(&mut self) -> Result<Option<[f64; 2]>, RuntimeError> {
        let state = &self.completed;
        self.dynamics
            .place(&self.model, state.time, &state.pose, &state.velocity);
        self.cycle_of_completed()
    }

    /// Cycle angle and rate of `self.completed`, at which the dynamics are placed.
    fn cycle_of_completed(&mut self) -> Result<Option<[f64; 2]>, RuntimeError> {
        match &mut self.cycle {
            Some(cycle) => {
                cycle.evaluate(&self.model, &self.dynamics, &self.completed)?;
                Ok(Some(cycle.watched_values))
            }
            None => Ok(None),
        }
    }

    fn cycle_angle_at(&mut self, time: f64) -> Result<f64, RuntimeError> {
        self.interpolate_at(time)?;
        let state = &self.completed;
        self.dynamics
            .place(&self.model, state.time, &state.pose, &state.velocity);
        self.cycle_of_completed()?
            .map(|c| c[0])
            .ok_or(RuntimeError::NoCycle)
    }

    /// The time within the last step at which the cycle has an angle (rad), by false position (Illinois
    /// variant) on the dense output. For an angle outside it is the nearer end.
    pub fn locate_angle(&mut self, angle: f64) -> Result<f64, RuntimeError> {
        let (mut from, mut to) = (self.integrator.previous.time, self.integrator.current.time);
        let mut at_from = self.cycle_angle_at(from)? - angle;
        let mut at_to = self.cycle_angle_at(to)? - angle;
        if at_to == 0.0 || from == to {
            return Ok(to);
        }
        if at_from == 0.0 {
            return Ok(from);
        }
        if (at_from > 0.0) == (at_to > 0.0) {
            return Ok(if at_from.abs() < at_to.abs() {
                from
            } else {
                to
            });
        }
        let mut side = 0;
        for _ in 0..80 {
            let middle = (from * at_to - to * at_from) / (at_to - at_from);
            let middle = middle.clamp(from, to);
            let value = self.cycle_angle_at(middle)? - angle;
            if value.abs() < 1e-14 * angle.abs().max(1.0)
                || to - from <= 4.0 * f64::EPSILON * to.abs()
            {
                return Ok(middle);
            }
            if (value > 0.0) == (at_to > 0.0) {
                to = middle;
                at_to = value;
                if side == 1 {
                    at_from *= 0.5;
                }
                side = 1;
            } else {
                from = middle;
                at_from = value;
                if side == -1 {
                    at_to *= 0.5;
                }
                side = -1;
            }
        }
        Ok(0.5 * (from + to))
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
            .place(&self.model, state.time, &state.pose, &state.velocity);
        self.dynamics.gather(
            &self.model,
            &state.states,
            &state.multipliers,
            &state.rotations,
        );
        self.dynamics.evaluate(&self.model)?;
        self.dynamics.constraint_gradients(&self.model)?;
        self.dynamics.velocity_level(&self.model, &state.velocity)?;
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
        Ok((
            largest(&self.dynamics.constraints),
            largest(&self.dynamics.constraint_rates),
        ))
    }
}
