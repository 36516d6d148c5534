//! Continuing with another tolerance, or from another state in place of the last outputs, for periodic analyses.

use super::{Simulation, goal};
use crate::control::FixedGrid;
use crate::error::{Moment, RuntimeError};
use crate::integrator::Vibration;
use crate::start::eccentricity::{film_ratios, yielding};
use crate::state::State;
use eng_system::system::StepControl;

/// Largest eccentricity ratio of a state to which a simulation leaps.
const WITHIN: f64 = 0.98;

/// A state at the end of a cycle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Time (s).
    pub time: f64,
    /// Poses of all bodies.
    pub pose: Vec<f64>,
    /// Their velocities.
    pub velocity: Vec<f64>,
    /// States of elements (SI).
    pub states: Vec<f64>,
}

impl Simulation {
    /// Continues with another factor on the tolerances of controlled steps. Vibrations that steps damped so far are
    /// forgotten.
    pub(crate) fn set_tolerance(&mut self, factor: f64) {
        self.options.step = StepControl::Tolerance(factor);
        self.integrator.set_goal(goal(&self.model, &self.options));
        self.integrator.vibrations.fill(Vibration::default());
    }

    /// Continues from a state at the cycle angle of the last outputs. Poses and velocities are brought back to the
    /// constraints. `false` if no motion can begin there, or if a field remembers the motion before. Then the motion
    /// goes on as it was.
    pub(crate) fn leap(&mut self, to: &Section) -> Result<bool, RuntimeError> {
        if self.model.memory > 0 {
            return Ok(false);
        }
        let mut next = self.completed.clone();
        next.time = to.time;
        next.pose.copy_from_slice(&to.pose);
        next.velocity.copy_from_slice(&to.velocity);
        next.states.copy_from_slice(&to.states);
        let moment = Moment {
            time: to.time,
            ..self.moment()
        };
        let restored = (self.system).restore(&self.model, &mut self.dynamics, &mut next, moment);
        let closed = || {
            let films = film_ratios(&self.model, &next.pose).into_iter();
            films
                .zip(yielding(&self.model))
                .any(|(ratio, yields)| ratio >= WITHIN && !yields)
        };
        if restored.is_err() || closed() {
            self.stand()?;
            return Ok(false);
        }
        let here = self.completed.clone();
        let energies = self.energy;
        let (steps, advised) = (self.size, self.advised.clone());
        if self.begin_in(next).is_err() {
            self.advised = advised;
            self.begin_in(here)?;
            self.size = steps;
            return Ok(false);
        }
        // a leap is no source of energy
        let stored = |of: &super::Energy| of.kinetic + of.gravity + of.strain;
        self.energy.start += stored(&self.energy) - stored(&energies);
        Ok(true)
    }

    fn begin_in(&mut self, state: State) -> Result<(), RuntimeError> {
        self.grid = FixedGrid::new(state.time);
        self.integrator.current = state;
        self.integrator.increment.fill(0.0);
        self.kinks.forget_moments(self.dynamics.signals());
        self.begin_anew()
    }
}
