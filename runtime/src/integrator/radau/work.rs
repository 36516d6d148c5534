//! Work in a step: the quadrature of the method, of fifth order, with the powers at its stages.
//!
//! The first two stages are evaluated once more for it, before the end of the step is completed: so `dynamics` stand at the end
//! afterwards, where the next step begins. The powers at the end are those of its balance, which the simulation observes.

use super::coefficients::A;
use super::{Integrator, Radau};
use crate::dynamics::Dynamics;
use crate::error::RuntimeError;
use crate::field::Demand;
use crate::model::Model;

/// Weights of the stages in the quadrature.
const WEIGHTS: [f64; 3] = A[2];

/// Adds powers (W) over a part (s) of a step to works (J).
fn add(work: &mut [f64; 3], part: f64, powers: [f64; 3]) {
    for (sum, power) in work.iter_mut().zip(powers) {
        *sum += part * power;
    }
}

impl Integrator {
    /// Keeps the share of the first two stages in the work of the solved step h. The trial is at its end again afterwards.
    pub fn observe_stages(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
    ) -> Result<(), RuntimeError> {
        let Some(mut radau) = self.radau.take() else {
            return Ok(());
        };
        let work = self.work_of_inner_stages(&radau, model, dynamics, h);
        self.set_stage(&radau, 2, model, h);
        let done = work.map(|work| radau.inner_work = work);
        self.radau = Some(radau);
        done
    }

    fn work_of_inner_stages(
        &mut self,
        radau: &Radau,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
    ) -> Result<[f64; 3], RuntimeError> {
        let mut work = [0.0; 3];
        for (index, weight) in WEIGHTS.iter().take(2).enumerate() {
            self.set_stage(radau, index, model, h);
            self.evaluate_next(model, dynamics, Demand::Answers)?;
            let (loads, constraints) = dynamics.powers(model, &self.next.multipliers)?;
            let [.., lost] = dynamics.energy(model, &self.next.velocity);
            add(&mut work, h * weight, [loads, constraints, lost]);
        }
        Ok(work)
    }

    /// Work of the loads and of the constraints, and loss in flexible bodies (J), in the last solved step h, at whose end their
    /// powers are `at_end` (W). `None` if steps are not those of Radau IIA.
    pub fn work_of_stages(&self, h: f64, at_end: [f64; 3]) -> Option<[f64; 3]> {
        let mut work = self.radau.as_ref()?.inner_work;
        add(&mut work, h * WEIGHTS[2], at_end);
        Some(work)
    }
}
