//! Vibrations that the steps do not follow, and the energy that the scheme's numerical damping takes from
//! them.
//!
//! The estimate of the error filters out modes that a step does not resolve, so that a stiff joint that
//! follows its load does not govern the steps. If such a mode is excited, the scheme damps it, and the
//! estimate does not show this. So this module sums the lost energy.
//!
//! For a mode of frequency ω the scheme multiplies the energy by `1 − κ (ωh)⁴` in a step, `κ = (γ − ½)³`,
//! while ωh is small (series of its amplification matrix; Chung and Hulbert 1993 give the matrix). With
//! `δ = v̇' − v̇` of a step, whose mean square over a period is `ω⁶h²A²/2`, the loss is `κ h² δᵀMδ`. For
//! large ωh this expression grows without bound. With the filter of the error, `S f = c M δ`, the expression
//! `κ h² δᵀM f` has the size of the loss again: all of it for ρ = 0.5, and a seventh of it for ρ = 0.8. So
//! the sum never exceeds the loss. f lies along the constraints, so accelerations that they prescribe do not
//! count.
//!
//! The terms `R = δᵀM f` and `F = fᵀM f` of a body give the frequency of its vibration, `ω² = c (R − F)/F`,
//! and the amplitude. `R − F` has the weight `(ωh)²/(c h² + (ωh)²)`: at 25 steps per period a sixtieth of the
//! loss counts as unresolved, and at three steps half of it.

use super::Integrator;
use crate::dynamics::Dynamics;
use crate::model::Model;
use eng_system::system::Origin;

/// Energy that a step may take from a body, as a share of the energy of its motion, without a look at the
/// vibration. A choice: a hundred million such steps take [`TAKEN`].
const NEGLIGIBLE: f64 = 1e-10;
/// Change of the accelerations, as a displacement and a share of the tolerance. Below it no vibration of the
/// step is above the tolerance, except one with more than 25 steps per period: its amplitude A has the change
/// ω²A ωh, and βh² of this is the share β(ωh)³ of A, about 5e-3 for ωh = 2π/25.
const UNSEEN: f64 = 5e-3;
/// Least ωh of a counted vibration, 125 steps per period. Below it rounding decides R − F, and a period loses
/// 3e-5 of its energy at ρ = 0.5.
const FOLLOWED: f64 = 0.05;
/// Share of the energy of a body's motion that the damping of the steps may take without a warning. A choice:
/// a message for less would describe what no figure shows.
const TAKEN: f64 = 1e-2;
/// Share of this energy that the damping may take from vibrations that the steps do not follow. A choice
/// between undisturbed mechanisms, which have 1e-5 at most, and [`TAKEN`].
const UNRESOLVED: f64 = 1e-3;
/// Least energy of a motion, as a share of the kinetic energy. A body that turns steadily has no swing of its
/// kinetic energy. A choice: with a smaller least, the rounding of that swing would be the whole.
const STEADY: f64 = 1e-6;

/// The losses of a body's vibrations by the damping of the steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration {
    /// Least and largest kinetic energy of a step so far (J).
    pub kinetic: [f64; 2],
    /// Most energy of a vibration above the tolerance (J), potential and kinetic.
    pub stored: f64,
    /// Energy that the steps took from vibrations above the tolerance (J), and its part from vibrations that
    /// the steps do not follow.
    pub taken: [f64; 2],
    /// Largest loss of the latter kind in one step (J), with the frequency of the vibration (rad/s) and the
    /// length of the step (s).
    pub worst: [f64; 3],
}

impl Default for Vibration {
    fn default() -> Vibration {
        Vibration {
            kinetic: [f64::INFINITY, 0.0],
            stored: 0.0,
            taken: [0.0; 2],
            worst: [0.0; 3],
        }
    }
}

impl Vibration {
    /// Energy of the body's motion (J): the swing of its kinetic energy, or the energy of its vibration if
    /// that is larger.
    fn energy(&self) -> f64 {
        let [least, most] = self.kinetic;
        (most - least).max(STEADY * most).max(self.stored)
    }

    /// The numbers of a checkpoint.
    pub fn numbers(&self) -> [f64; 8] {
        let ([a, b], [c, d], [e, f, g]) = (self.kinetic, self.taken, self.worst);
        [a, b, c, d, e, f, g, self.stored]
    }

    /// A vibration from the numbers of a checkpoint.
    pub fn from_numbers([a, b, c, d, e, f, g, stored]: [f64; 8]) -> Vibration {
        Vibration {
            kinetic: [a, b],
            stored,
            taken: [c, d],
            worst: [e, f, g],
        }
    }
}

/// A body whose vibration the steps damped away.
#[derive(Clone, Debug, PartialEq)]
pub struct Damped {
    /// The body.
    pub body: Origin,
    /// Least energy that the steps took (J).
    pub taken: f64,
    /// Energy of the body's motion (J).
    pub energy: f64,
    /// Frequency of the vibration (rad/s).
    pub frequency: f64,
    /// The step (s) that damped it most.
    pub step: f64,
}

impl Integrator {
    /// Adds the losses of the step h (s) that was solved last. The caller accepts the step afterwards.
    /// `factor` is the factor on the tolerances.
    pub fn look_at_vibrations(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
        factor: f64,
    ) {
        // Radau IIA resolves each vibration that matters, because its error control contains all modes
        let Some(kept) = self.factored_step.filter(|_| !self.is_radau()) else {
            return;
        };
        let c = self.coefficients;
        let (n, stiffness) = (model.velocities, c.weights(h).acceleration);
        let tolerance = model.tolerance * factor / model.length;
        let damping = libm::pow(c.gamma - 0.5, 3.0) * h * h;
        for i in 0..n {
            self.estimate[i] = self.next.acceleration[i] - self.current.acceleration[i];
        }
        let moved = self.largest(&self.estimate) / stiffness;
        let mut seen = false;
        self.correction.fill(0.0);
        // the velocity of the increment, because the velocity of the scheme is far too large for a vibration
        // that is not resolved
        self.fill_masses(model, dynamics);
        let (trial, scales) = (&self.trial, &self.scales);
        let speed = |i: usize| trial[i] * scales[i] / h;
        let mut masses = self.masses.as_slice();
        for (index, body) in model.bodies.iter().enumerate() {
            let width = body.width();
            let (mass, others) = masses.split_at(width * width);
            masses = others;
            let (mut kinetic, mut most) = (0.0, 0.0);
            for (i, row) in mass.chunks_exact(width).enumerate() {
                let [mut momentum, mut changed] = [0.0; 2];
                for (j, m) in row.iter().enumerate() {
                    momentum += m * speed(body.velocity + j);
                    changed += m * self.estimate[body.velocity + j];
                }
                kinetic += 0.5 * momentum * speed(body.velocity + i);
                most += changed * self.estimate[body.velocity + i];
                self.correction[body.velocity + i] = stiffness * changed;
            }
            let vibration = &mut self.vibrations[index];
            let [least, largest] = vibration.kinetic;
            vibration.kinetic = [least.min(kinetic), largest.max(kinetic)];
            seen |= damping * most > NEGLIGIBLE * vibration.energy();
        }
        if !seen || moved < UNSEEN * tolerance {
            return;
        }
        for (x, row) in self.correction.iter_mut().zip(&self.row_factors) {
            *x *= row;
        }
        self.solver.solve(&mut self.correction);
        if self.correction[..n].iter().any(|x| !x.is_finite()) {
            return;
        }
        let mut masses = self.masses.as_slice();
        for (index, body) in model.bodies.iter().enumerate() {
            let width = body.width();
            let own = body.velocity..body.velocity + width;
            let filtered = &self.correction[own.clone()];
            let scales = &self.scales[own.clone()];
            let (mass, others) = masses.split_at(width * width);
            masses = others;
            let [mut all, mut followed, mut largest] = [0.0_f64; 3];
            for (i, row) in mass.chunks_exact(width).enumerate() {
                let product: f64 = (row.iter().zip(filtered).zip(scales))
                    .map(|((m, x), scale)| m * x * scale)
                    .sum();
                all += product * self.estimate[body.velocity + i];
                followed += product * filtered[i] * scales[i];
                largest = largest.max(filtered[i].abs());
            }
            let rest = all - followed;
            if !(rest > 0.0 && followed > 0.0) {
                continue;
            }
            // the kept factors belong to another step, and their stiffness has the factor of its square
            let frequency = libm::sqrt(stiffness * rest / followed) * h / kept;
            // the amplitude of δ is ω²A times ωh, at most 2 ω²A
            let turned = (frequency * h).min(2.0);
            if turned < FOLLOWED {
                continue;
            }
            let amplitude = largest * all / followed / (frequency * frequency * turned);
            if amplitude < tolerance {
                continue;
            }
            let vibration = &mut self.vibrations[index];
            // δᵀM δ of a single vibration is R²/F
            let speed = all / (frequency * turned);
            vibration.stored = vibration.stored.max(0.5 * speed * speed / followed);
            vibration.taken[0] += damping * all;
            vibration.taken[1] += damping * rest;
            if damping * rest > vibration.worst[0] {
                vibration.worst = [damping * rest, frequency, h];
            }
        }
    }

    /// The body that lost the largest share of its energy to the damping of the steps, if this share needs a
    /// warning.
    pub fn damped(&self, model: &Model) -> Option<Damped> {
        let share = |v: &Vibration| v.taken[1] / v.energy();
        let (body, vibration) = (model.bodies.iter().zip(&self.vibrations))
            .filter(|(_, v)| {
                v.taken[0] > TAKEN * v.energy() && v.taken[1] > UNRESOLVED * v.energy()
            })
            .max_by(|a, b| share(a.1).total_cmp(&share(b.1)))?;
        let [_, frequency, step] = vibration.worst;
        Some(Damped {
            body: body.origin.clone(),
            taken: vibration.taken[0],
            energy: vibration.energy(),
            frequency,
            step,
        })
    }
}
