//! Inputs that a program sets while the simulation runs, and steps up to given points of time.

use super::{Simulation, StepReport};
use crate::control::StepSize;
use crate::error::RuntimeError;
use crate::inputs::Point;
use eng_system::system::StepControl;
use std::ops::ControlFlow;

/// Distance of a point of time from the grid of fixed steps that is rounding, as a share of a step and of the
/// time. Points are sums of a few products, so they are some last places off the grid; a billionth of a step
/// is no step.
const ON_GRID: (f64, f64) = (1e-9, 4.0 * f64::EPSILON);

/// Shortest way of time: seconds, and a share of the time. Choices: a few of the shortest steps of error control, and a few last
/// places of a time.
const SHORTEST: (f64, f64) = (4e-14, 8.0 * f64::EPSILON);

impl Simulation {
    /// Sets an input (SI) from the present time on. A new value begins a jump: positions, velocities and states stay
    /// as they are, and accelerations are computed again at the next step.
    ///
    /// # Errors
    /// No such input; a value outside its limits or not finite; a rate of an input that has none; a jump of a cubic
    /// input after the start; an input that a function of time drives.
    pub fn set_input(&mut self, index: usize, point: Point) -> Result<(), RuntimeError> {
        let time = self.time();
        let started = self.integrator.statistics.steps > 0;
        let signals = self.dynamics.signals_mut();
        signals.set(&self.model, index, point, time, started)?;
        self.evaluated = None;
        Ok(())
    }

    /// The stated parameters with the values of inputs at the time of the last outputs; `None` without inputs.
    pub(crate) fn present_inputs(&self) -> Option<Vec<Option<f64>>> {
        let time = self.sampled_state().time;
        self.dynamics.signals().stated_at(time)
    }

    /// Refuses an input that a function of time drives, where the caller needs an input that may change.
    pub(crate) fn refuse_driven(&self, index: usize) -> Result<(), RuntimeError> {
        match self.dynamics.signals().is_driven(index) {
            true => self.dynamics.signals().refuse_driven(&self.model, index),
            false => Ok(()),
        }
    }

    /// Gives the value (SI) that an input has at the end of the next [`Simulation::advance`].
    ///
    /// # Errors
    /// As [`Simulation::set_input`]; an input that holds its value.
    pub fn aim_input(&mut self, index: usize, point: Point) -> Result<(), RuntimeError> {
        let time = self.time();
        let signals = self.dynamics.signals_mut();
        signals.aim(&self.model, index, point, time)
    }

    /// Refuses a time (s) to which [`Simulation::advance`] cannot go, and changes nothing.
    ///
    /// # Errors
    /// A time that is not later than the present one, or that is so near that numbers resolve no motion until then.
    pub fn may_advance(&self, to: f64) -> Result<(), RuntimeError> {
        let begin = self.time();
        if !to.is_finite() || to <= begin {
            return Err(RuntimeError::Options {
                message: format!(
                    "time goes forward: from {begin} s the simulation cannot advance to {to} s"
                ),
            });
        }
        let least = SHORTEST.0.max(SHORTEST.1 * to.abs());
        if to - begin < least {
            return Err(RuntimeError::Options {
                message: format!(
                    "from {begin} s to {to} s is too short for a step, because numbers resolve no motion in it: advance by {least:.1e} s or more"
                ),
            });
        }
        Ok(())
    }

    /// Steps up to a time (s), which no step crosses, or to the moment at which the condition of `stop` begins to hold
    /// ([`Simulation::stopped`]). Fixed steps keep their grid: a point on the grid is the
    /// grid's own number, so it cuts no step, and the bits are those of steps without this point.
    ///
    /// # Errors
    /// A time that is not later than the present one; those of a step. After a failed step the simulation stays at
    /// the end of the last accepted one.
    pub fn advance(&mut self, to: f64) -> Result<StepReport, RuntimeError> {
        self.advance_while(to, &mut |_| ControlFlow::Continue(()))
    }

    /// [`Simulation::advance`] as long as `watch` allows, which gets the time (s) after each step but the last. After a `Break`
    /// the simulation stays at the end of that step. To advance to the same time later gives the bits of one call.
    ///
    /// # Errors
    /// Those of [`Simulation::advance`].
    pub fn advance_while(
        &mut self,
        to: f64,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<StepReport, RuntimeError> {
        self.may_advance(to)?;
        let begin = self.time();
        let on_grid = self.options.step.fixed().and_then(|nominal| {
            let time = self.grid.point_near(to, nominal);
            let near = (ON_GRID.0 * nominal).max(ON_GRID.1 * to.abs());
            ((time - to).abs() <= near && time > begin).then_some(time)
        });
        let end = on_grid.unwrap_or(to);
        self.dynamics.signals_mut().towards(&self.model, end)?;
        // a step that ends on the grid by itself is not cut
        let most = if on_grid.is_some() {
            f64::INFINITY
        } else {
            end
        };
        let mut report = StepReport {
            time: begin,
            step: 0.0,
        };
        while self.time() < end {
            report = self.step_no_longer(most, f64::INFINITY)?;
            if self.stand_at_stop()? {
                report = self.report_of_stop(report);
                break;
            }
            // inputs have not arrived at the values of the next point
            if self.time() < end && watch(self.time()).is_break() {
                return Ok(report);
            }
        }
        self.dynamics.signals_mut().arrive();
        Ok(report)
    }

    /// Refuses a step without an end while an input has a value for the next point.
    pub(super) fn ends_known(&self) -> Result<(), RuntimeError> {
        if self.dynamics.signals().aims() {
            return Err(RuntimeError::Options {
                message: "an input has a value for its next point, whose time `step` does not know: call `advance` with this time in place of `step`".into(),
            });
        }
        Ok(())
    }

    /// Starts the motion again if an input jumps here: accelerations, multipliers, rates and their auxiliaries,
    /// and the first step, are made as at the start. Positions, velocities and states stay.
    pub(super) fn after_jumps(&mut self) -> Result<(), RuntimeError> {
        // the rates at the start do not include the values of the next point yet
        let unknown = self.integrator.statistics.steps == 0 && self.dynamics.signals().aims();
        if !unknown && !self.dynamics.signals().jumps(self.time()) {
            return Ok(());
        }
        self.kinks.forget_moments(self.dynamics.signals());
        self.begin_anew()?;
        self.dynamics.signals_mut().accept_jumps();
        Ok(())
    }

    /// Starts the motion again at the present state, because loads jump there.
    pub(super) fn begin_anew(&mut self) -> Result<(), RuntimeError> {
        let moment = self.moment();
        self.renewals += 1;
        // the constraints' compensation of the steps before, which does not depend on loads
        self.pass_defect(moment)?;
        let first = self.first_rates(moment)?;
        self.integrator.renew(
            &first.jerk,
            &self.work,
            &first.multiplier_rate,
            &first.state_jerk,
        );
        if let StepControl::Tolerance(factor) = self.options.step {
            self.size = StepSize::new(self.first_step(&first, factor));
        }
        self.stand()?;
        self.kinks
            .evaluate(&self.model, &self.dynamics, &self.integrator.current)?;
        self.kinks.accept(&self.model, 0.0, None);
        self.at_kink = None;
        self.observe_state()?;
        self.compute_energy();
        // the powers jump, and the dense output of the last step has other accelerations at its end
        self.earlier_step = 0.0;
        self.earlier_powers = self.powers;
        let current = &self.integrator.current;
        self.integrator.previous.copy_from(current);
        self.cycle_at_ends = None;
        self.evaluated = None;
        Ok(())
    }

    /// Checks limits and conditions of parameters that follow inputs, at the time of the dynamics.
    pub(super) fn check_inputs(&mut self) -> Result<(), RuntimeError> {
        let advice = self
            .dynamics
            .signals()
            .check(&self.model)
            .map_err(|cause| RuntimeError::Inputs {
                moment: self.moment(),
                cause: Box::new(cause),
            })?;
        for advice in advice {
            let known =
                |known: &super::Warning| known.name == advice.name && known.origin == advice.origin;
            let place = (advice.name.clone(), advice.origin.clone());
            if self.advised_inputs.contains(&place) || self.warnings.iter().any(known) {
                continue;
            }
            self.advised_inputs.push(place);
            self.warnings.push(super::Warning {
                name: advice.name,
                origin: advice.origin,
                message: advice.message,
                label: super::FAILS,
                moment: self.moment(),
            });
        }
        Ok(())
    }
}
