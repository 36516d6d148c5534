//! Changes of velocity that leave the forces of stiff films and springs as they are.

use super::Integrator;
use crate::model::Model;

impl Integrator {
    /// A change x of the velocities with `G x = rates` (m/s, rad/s), the least one as the kept matrix of the step measures it:
    /// `S x + Gᵀμ = 0` with S the inertia, damping and stiffness of a step. Where a film's damping over a step outweighs the mass
    /// of what it carries, x keeps the film's velocity and moves what is free. G is that of the kept matrix, so that a part of
    /// `rates` remains.
    ///
    /// `false`, and `out` as it was, where no factors are kept or they give no number.
    pub fn nearest_change(&mut self, model: &Model, rates: &[f64], out: &mut [f64]) -> bool {
        if self.factored_step.is_none() {
            return false;
        }
        let first = model.velocities + model.states;
        self.correction.fill(0.0);
        for (i, rate) in rates.iter().enumerate() {
            self.correction[first + i] = rate / self.scales[first + i];
        }
        self.solver.solve(&mut self.correction);
        let changes = &self.correction[..model.velocities];
        if changes.iter().any(|x| !x.is_finite()) {
            return false;
        }
        for ((x, change), scale) in out.iter_mut().zip(changes).zip(&self.scales) {
            *x = change * scale;
        }
        true
    }
}
