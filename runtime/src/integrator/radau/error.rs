//! The local error of a step: the embedded formula of third order of Hairer and Wanner's book, for positions and velocities.
//!
//! `e_q = (h v₀ + Σ d_i u_i)/μ`, `e_v = (h v̇₀ + Σ d_i (v_i − v₀))/μ`, filtered by the real system of Newton's method:
//! `S [e; ·] = [(μ²/h² M + μ/h D) e_q + μ/h M e_v; 0]`. It is an error of the embedded formula, so the result is far
//! more exact. The error of a step is of the fourth order.

use super::coefficients::{EMBEDDED, REAL, weighted};
use super::{Integrator, Radau};
use crate::dynamics::Dynamics;
use crate::error::RuntimeError;
use crate::field::Demand;
use crate::integrator::STATE_SHARE;
use crate::model::{Model, STEP_SHARE};

impl Integrator {
    /// The filtered error of the step's embedded formula, in units of the tolerance; see the head of this module.
    pub(super) fn error_of_stages(
        &mut self,
        radau: &mut Radau,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
        factor: f64,
    ) -> Result<f64, RuntimeError> {
        let (n, s) = (model.velocities, model.states);
        self.evaluate_next(model, dynamics, Demand::Answers)?;
        let stages = &radau.stages;
        let embedded =
            |rate: f64, changes: [f64; 3]| (h * rate + weighted(&EMBEDDED, changes)) / REAL;
        for k in 0..n {
            let start = &self.current;
            let place = embedded(start.velocity[k], [0, 1, 2].map(|j| stages[j].unknowns[k]));
            let gained = [0, 1, 2].map(|j| stages[j].velocity[k] - start.velocity[k]);
            let speed = embedded(start.acceleration[k], gained);
            self.estimate[k] = place;
            radau.scratch[k] = REAL / h * (REAL / h * place + speed);
        }
        self.correction.fill(0.0);
        self.fill_masses(model, dynamics);
        let mut masses = self.masses.as_slice();
        for body in &model.bodies {
            let (width, first) = (body.width(), body.velocity);
            let (mass, others) = masses.split_at(width * width);
            masses = others;
            for (i, row) in mass.chunks_exact(width).enumerate() {
                let product = row.iter().zip(&radau.scratch[first..]).map(|(m, x)| m * x);
                self.correction[first + i] = product.sum();
            }
        }
        let loads = &mut self.correction[..n];
        dynamics.add_damping_forces(model, &self.estimate, -REAL / h, loads)?;
        for k in 0..s {
            let changes = [0, 1, 2].map(|j| stages[j].unknowns[n + k]);
            self.correction[n + k] = REAL / h * embedded(self.current.rates[k], changes);
        }
        for (x, factor) in self.correction.iter_mut().zip(&self.row_factors) {
            *x *= factor;
        }
        self.solver.solve(&mut self.correction);
        let unit = model.length / (STEP_SHARE * model.tolerance * factor);
        let mut worst = 0.0_f64;
        self.governing = None;
        for (k, x) in self.correction[..n + s].iter().enumerate() {
            let error = match k.checked_sub(n) {
                None => x.abs() * unit,
                Some(state) => {
                    let peak = self.state_peak[state].max(self.next.states[state].abs());
                    (x * self.scales[k]).abs() / (STATE_SHARE * factor * peak)
                }
            };
            if !error.is_finite() {
                self.governing = Some(k);
                return Ok(f64::INFINITY);
            }
            if error > worst {
                worst = error;
                self.governing = Some(k);
            }
        }
        Ok(worst)
    }
}
