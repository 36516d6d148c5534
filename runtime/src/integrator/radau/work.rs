//! Work in a step: the quadrature of the method, of fifth order, with the powers of its stages.

use super::Integrator;
use super::coefficients::A;
use crate::dynamics::Dynamics;
use crate::error::RuntimeError;
use crate::field::Demand;
use crate::model::Model;

impl Integrator {
    /// Work of the loads and of the constraints, and loss in flexible bodies (J), in the last solved step h: the quadrature
    /// of fifth order with the powers of the stages.
    pub fn work_of_stages(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
    ) -> Result<[f64; 3], RuntimeError> {
        let Some(radau) = self.radau.take() else {
            return Ok([0.0; 3]);
        };
        let end = self.next.clone();
        let mut work = [0.0; 3];
        let mut done = Ok(());
        for (index, weight) in A[2].iter().enumerate() {
            match index {
                // the end has the multipliers of its balance
                2 => self.next.copy_from(&end),
                _ => self.set_stage(&radau, index, model, h),
            }
            done = self.evaluate_next(model, dynamics, Demand::Answers);
            let powers = dynamics.powers(model, &self.next.multipliers);
            match (&done, powers) {
                (Ok(()), Ok((loads, constraints))) => {
                    let [.., lost] = dynamics.energy(model, &self.next.velocity);
                    for (sum, power) in work.iter_mut().zip([loads, constraints, lost]) {
                        *sum += h * weight * power;
                    }
                }
                (Ok(()), Err(error)) => done = Err(error),
                (Err(_), _) => {}
            }
            if done.is_err() {
                break;
            }
        }
        self.radau = Some(radau);
        done.map(|()| work)
    }
}
