//! Changes of velocity that keep the forces of stiff films, or bring them into balance.

use super::Integrator;
use crate::dynamics::Dynamics;
use crate::error::RuntimeError;
use crate::field::Demand;
use crate::model::Model;
use crate::state::State;

/// Corrections of a state between two steps; [`Integrator::settle`] has the errors after one, two and three.
const CORRECTIONS: usize = 2;
/// Length of a step, as a share of that of the kept matrix, below which its states need no correction. Such a
/// step leads across a jump of loads, where the interpolated accelerations balance no load. The share is a
/// choice.
const ACROSS: f64 = 1e-3;

impl Integrator {
    /// The change x of the velocities with `G x = rates` (m/s, rad/s) that is least in the kept matrix of the
    /// step: `S x + Gᵀμ = 0` with the inertia, damping and stiffness S of a step. If a film's damping over a
    /// step outweighs the mass that it carries, x hardly changes the film's velocity and moves free parts
    /// instead. G is that of the kept matrix, so a part of `rates` remains.
    ///
    /// Returns `false` and does not change `out` without kept factors, with those of Radau IIA, which may belong to a position far
    /// back, or if they give no number.
    pub fn nearest_change(&mut self, model: &Model, rates: &[f64], out: &mut [f64]) -> bool {
        if self.factored_step.is_none() || self.is_radau() {
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

    /// Brings a state within the last step into balance by its velocities, for its interpolated accelerations
    /// and multipliers.
    ///
    /// At the ends of a step `M v̇ + Gᵀλ = Q` holds to Newton's tolerance. In between the position is right
    /// to fourth order. But a film that outweighs the inertia of its pin responds to the error of the
    /// interpolated velocity with a false force. Newton's correction of the step there,
    /// `S u = −(M v̇ + Gᵀλ − Q)`, `G u = 0`, with the kept matrix, changes velocities by `γ/(βh) u`. Where
    /// inertia dominates, this is of third order in the step, like the interpolation. Positions do not
    /// change. Without kept factors, or if a correction is no number, nothing changes. `dynamics` must be placed at
    /// the state, and is placed there afterwards, with multipliers zero.
    ///
    /// Each correction leaves the error before it times the contraction of the kept matrix. On the paper's fired
    /// engine the largest error of an acceleration of the pins is 3.9e-3 of the swing after one correction and
    /// 2.4e-3 after two. A third changes no channel of the examples by more than its error at the default
    /// tolerance.
    pub fn settle(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        state: &mut State,
    ) -> Result<(), RuntimeError> {
        let length = self.current.time - self.previous.time;
        // the interpolation of Radau IIA is more exact than this correction
        let kept = (self.factored_step).filter(|step| length >= ACROSS * step && !self.is_radau());
        let Some(step) = kept else {
            return Ok(());
        };
        let (n, weight) = (model.velocities, self.coefficients.weights(step).velocity);
        for _ in 0..CORRECTIONS {
            dynamics.gather(model, &state.states, &state.multipliers, &state.rotations);
            dynamics.evaluate_for(model, Demand::Iterate)?;
            self.correction.fill(0.0);
            let rest = &mut self.correction[..n];
            dynamics.add_inertia(model, &state.velocity, &state.acceleration, rest);
            dynamics.add_forces(model, -1.0, rest);
            for i in 0..n {
                self.correction[i] *= -self.row_scale(model, i, step);
            }
            self.solver.solve(&mut self.correction);
            let changes = &self.correction[..n];
            if changes.iter().any(|x| !x.is_finite()) {
                break;
            }
            for ((v, change), scale) in state.velocity.iter_mut().zip(changes).zip(&self.scales) {
                *v += weight * scale * change;
            }
            dynamics.place_velocities(model, &state.velocity);
        }
        dynamics.gather(model, &state.states, &[], &state.rotations);
        Ok(())
    }
}
