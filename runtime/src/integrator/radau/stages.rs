//! The stages of a step: their prediction, and Newton's method.
//!
//! With the stiffness K (which includes G and Gᵀ), the damping D and the mass M of the second stage the matrix of Newton's
//! method is `A⁻² ⊗ M/h² + A⁻¹ ⊗ D/h + I ⊗ K`. The real basis `B` of the eigenvectors of A⁻¹ divides it into one system with
//! the real eigenvalue μ and one with the complex eigenvalue,
//!
//! ```text
//! (μ²/h² M + μ/h D + K) z = r
//! ```
//!
//! The complex system is solved as a real one of twice the size, in which each entry a + bi is the block
//! `[a, −b; b, a]`.

use super::coefficients::{
    A, BASIS, BASIS_INVERSE, COMPLEX, INVERSE, NODES, REAL, extrapolation, weighted,
};
use super::{Integrator, Radau};
use crate::body::Weights;
use crate::dynamics::Dynamics;
use crate::error::RuntimeError;
use crate::field::Demand;
use crate::model::Model;
use crate::rotation::{V3, inverse_tangent, tangent};
use crate::state::move_pose;

/// The stages in the order of their evaluation. The second one is the last, because the matrix is filled there: it is the
/// one nearest to the middle of the step.
const ORDER: [usize; 3] = [0, 2, 1];
/// Most iterations of a step. A choice: at the limit of the contraction they win eight digits.
const ITERATIONS: usize = 12;
/// Contraction of a fresh matrix above which the step is too long. A choice: twelve iterations win less than four digits.
const FAILURE: f64 = 0.5;

impl Radau {
    /// Fills the doubled matrix with the blocks of the entries a + bi.
    fn double(&mut self) {
        let [real, imaginary] = &self.parts;
        for (places, (a, b)) in self.places.iter().zip(real.iter().zip(imaginary)) {
            for (place, value) in places.iter().zip([*a, -b, *b, *a]) {
                self.values[*place] = value;
            }
        }
    }

    /// Velocities, accelerations and rates of the stages of a step h from their unknowns.
    fn derive(&mut self, model: &Model, velocity: &[f64], h: f64) {
        let (n, s) = (model.velocities, model.states);
        for (row, i) in INVERSE.iter().zip(0..) {
            for k in 0..n + s {
                let sum: f64 = (0..3).map(|j| row[j] * self.stages[j].unknowns[k]).sum();
                match k.checked_sub(n) {
                    None => self.stages[i].increment_rate[k] = sum / h,
                    Some(state) => self.stages[i].rates[state] = sum / h,
                }
            }
        }
        for stage in &mut self.stages {
            stage.velocity.copy_from_slice(&stage.increment_rate);
            for body in &model.bodies {
                let k = body.velocity + 3;
                let turned =
                    tangent(&vector(&stage.unknowns, k)) * vector(&stage.increment_rate, k);
                stage.velocity[k..k + 3].copy_from_slice(turned.as_slice());
            }
        }
        for (row, i) in INVERSE.iter().zip(0..) {
            for k in 0..n {
                let sum: f64 = (0..3)
                    .map(|j| row[j] * (self.stages[j].velocity[k] - velocity[k]))
                    .sum();
                self.stages[i].acceleration[k] = sum / h;
            }
        }
    }
}

/// Three numbers of a list.
fn vector(list: &[f64], first: usize) -> V3 {
    V3::new(list[first], list[first + 1], list[first + 2])
}

impl Integrator {
    /// Predicts the stages of a step h: accelerations, rates and multipliers continue the parabola through the stages of the
    /// step before, or the line with their last rates of change.
    pub(super) fn predict_stages(&mut self, radau: &mut Radau, model: &Model, h: f64) {
        let (n, s, m) = (model.velocities, model.states, model.rows);
        let state = &self.current;
        for (i, node) in NODES.iter().enumerate() {
            let stage = &mut radau.stages[i];
            let (multipliers, tau) = (&mut stage.unknowns[n + s..], node * h);
            let Some(step) = radau.step_before else {
                for k in 0..n {
                    stage.acceleration[k] = state.acceleration[k] + tau * self.jerk[k];
                }
                for k in 0..s {
                    stage.rates[k] = state.rates[k] + tau * self.state_jerk[k];
                }
                for k in 0..m {
                    multipliers[k] = state.multipliers[k] + tau * self.multiplier_rate[k];
                }
                continue;
            };
            let weights = extrapolation(1.0 + tau / step);
            let [a, b, c] = &radau.before;
            for k in 0..n {
                let values = [a.acceleration[k], b.acceleration[k], c.acceleration[k]];
                stage.acceleration[k] = weighted(&weights, values);
            }
            for k in 0..s {
                stage.rates[k] = weighted(&weights, [a.rates[k], b.rates[k], c.rates[k]]);
            }
            for k in 0..m {
                let values = [a.multipliers[k], b.multipliers[k], c.multipliers[k]];
                multipliers[k] = weighted(&weights, values);
            }
        }
        for (i, row) in A.iter().enumerate() {
            for k in 0..n {
                let gained = weighted(row, [0, 1, 2].map(|j| radau.stages[j].acceleration[k]));
                radau.stages[i].velocity[k] = state.velocity[k] + h * gained;
            }
            for k in 0..s {
                let gained = weighted(row, [0, 1, 2].map(|j| radau.stages[j].rates[k]));
                radau.stages[i].unknowns[n + k] = h * gained;
            }
        }
        for stage in &mut radau.stages {
            stage.increment_rate.copy_from_slice(&stage.velocity);
        }
        // with the rotation vectors of the first pass u̇ follows from v in the second one
        for pass in 0..2 {
            for (i, row) in A.iter().enumerate() {
                for k in 0..n {
                    let rates = [0, 1, 2].map(|j| radau.stages[j].increment_rate[k]);
                    radau.stages[i].unknowns[k] = h * weighted(row, rates);
                }
            }
            if pass > 0 {
                break;
            }
            for stage in &mut radau.stages {
                for body in &model.bodies {
                    let k = body.velocity + 3;
                    let rate =
                        inverse_tangent(&vector(&stage.unknowns, k)) * vector(&stage.velocity, k);
                    stage.increment_rate[k..k + 3].copy_from_slice(rate.as_slice());
                }
            }
        }
    }

    /// Sets the trial's state to a stage.
    pub(super) fn set_stage(&mut self, radau: &Radau, index: usize, model: &Model, h: f64) {
        let (n, s) = (model.velocities, model.states);
        let stage = &radau.stages[index];
        let next = &mut self.next;
        let increment = &stage.unknowns[..n];
        move_pose(model, &self.current.pose, increment, 1.0, &mut next.pose);
        next.velocity.copy_from_slice(&stage.velocity);
        next.acceleration.copy_from_slice(&stage.acceleration);
        next.rates.copy_from_slice(&stage.rates);
        next.multipliers.copy_from_slice(&stage.unknowns[n + s..]);
        for (y, (start, change)) in
            (next.states.iter_mut()).zip(self.current.states.iter().zip(&stage.unknowns[n..]))
        {
            *y = start + change;
        }
        // angles are followed from those of the last accepted state
        next.rotations.copy_from_slice(&self.current.rotations);
        next.time = self.current.time + NODES[index] * h;
    }

    /// Newton's iteration. Returns whether it reached its goal.
    pub(super) fn iterate_stages(
        &mut self,
        radau: &mut Radau,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
    ) -> Result<bool, RuntimeError> {
        let (goal, floor, noise) = (self.goal(h), self.floor(h), self.noise(model, h));
        let (mut last, mut fresh): (Option<f64>, bool) = (None, false);
        for _ in 0..ITERATIONS {
            radau.derive(model, &self.current.velocity, h);
            for index in ORDER {
                self.set_stage(radau, index, model, h);
                self.evaluate_next(model, dynamics, Demand::Answers)?;
                radau.stages[index].residual.copy_from_slice(&self.residual);
            }
            if self.factored_step.is_none() {
                if !self.factor_stages(radau, model, dynamics, h)? {
                    return Ok(false);
                }
                (last, fresh) = (None, true);
            }
            self.statistics.iterations += 1;
            let norm = self.correct_stages(radau);
            if !norm.is_finite() {
                if fresh {
                    return Ok(false);
                }
                self.predict_stages(radau, model, h);
                self.drop_factors();
                continue;
            }
            let rate = last.map(|last| norm / last);
            if let Some(rate) = rate.filter(|_| norm > goal.max(noise)) {
                self.contraction = Some(self.contraction.map_or(rate, |c| c.max(rate)));
            }
            // the rest of a geometric series
            let left = |c: f64| c < 1.0 && norm * c / (1.0 - c) <= goal;
            if norm <= floor || self.contraction.or(rate).is_some_and(left) {
                radau.derive(model, &self.current.velocity, h);
                return Ok(true);
            }
            if rate.is_some_and(|rate| rate > FAILURE) {
                // only rounding is left
                if norm <= goal.max(noise) {
                    radau.derive(model, &self.current.velocity, h);
                    return Ok(true);
                }
                if fresh {
                    return Ok(false);
                }
                self.drop_factors();
            }
            last = Some(norm);
        }
        Ok(false)
    }

    /// Fills and factors both matrices at the stage that is evaluated, the second one.
    fn factor_stages(
        &mut self,
        radau: &mut Radau,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
    ) -> Result<bool, RuntimeError> {
        let [re, im] = COMPLEX;
        let weights = |square: f64, eigenvalue: f64| Weights {
            acceleration: square / (h * h),
            velocity: eigenvalue / h,
        };
        let none = weights(0.0, 0.0);
        let real = weights(REAL * REAL, REAL);
        let [first, second] = [weights(re * re - im * im, re), weights(2.0 * re * im, im)];
        let Radau {
            stages,
            stiffness,
            parts: [first_part, second_part],
            ..
        } = radau;
        let increment = &stages[1].unknowns[..model.velocities];
        let fills = [
            (none, 0.0, &mut *stiffness),
            (real, REAL / h, &mut self.values),
            (first, re / h, &mut *first_part),
            (second, im / h, &mut *second_part),
        ];
        for (weights, of_states, values) in fills {
            self.plan.fill(
                model,
                dynamics,
                &self.next.velocity,
                &self.next.acceleration,
                increment,
                weights,
                of_states,
                values,
            )?;
        }
        for (x, k) in second_part.iter_mut().zip(&*stiffness) {
            *x -= k;
        }
        for values in [&mut self.values, first_part, second_part] {
            (self.plan.runs).scale(values, &self.row_factors, &self.column_factors);
        }
        radau.double();
        self.statistics.factorizations += 1;
        self.contraction = None;
        let before = self.solver.fallbacks() + radau.solver.fallbacks();
        let factored =
            self.solver.factor(&self.values).is_ok() && radau.solver.factor(&radau.values).is_ok();
        self.statistics.fallbacks += self.solver.fallbacks() + radau.solver.fallbacks() - before;
        self.factored_values = factored;
        self.factored_step = factored.then_some(h);
        Ok(factored)
    }

    /// Solves for the correction of all stages and applies it. Returns its largest scaled change.
    fn correct_stages(&mut self, radau: &mut Radau) -> f64 {
        for k in 0..self.correction.len() {
            let residuals = [0, 1, 2].map(|j| -radau.stages[j].residual[k]);
            let [real, a, b] = BASIS_INVERSE.map(|row| weighted(&row, residuals));
            self.correction[k] = real;
            radau.pairs[2 * k] = a;
            radau.pairs[2 * k + 1] = b;
        }
        self.solver.solve(&mut self.correction);
        radau.solver.solve(&mut radau.pairs);
        let mut norm = 0.0_f64;
        for k in 0..self.correction.len() {
            let parts = [
                self.correction[k],
                radau.pairs[2 * k],
                radau.pairs[2 * k + 1],
            ];
            for (stage, row) in radau.stages.iter_mut().zip(&BASIS) {
                let change = weighted(row, parts);
                if !change.is_finite() {
                    return f64::INFINITY;
                }
                norm = norm.max(change.abs());
                stage.unknowns[k] += change * self.column_factors[k];
            }
        }
        norm
    }
}
