//! One step: Newton's iteration with a kept matrix, the estimate of the local error, and what failed.

use super::tangents::{constraints_along, wrenches_along};
use super::{Integrator, RESOLVED, STEP_SHARE, Trial};
use crate::dynamics::Dynamics;
use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use eng_system::system::Origin;

/// Contraction above which the matrix is taken anew.
const CONTRACTION_LIMIT: f64 = 0.3;
/// Contraction above which a step begins with a fresh matrix: it costs about four iterations.
const RENEWAL: f64 = 0.12;
/// Least contraction that an old matrix is trusted with.
const OLD_CONTRACTION: f64 = 0.1;
/// Iterations in all, with fresh matrices among them.
const ITERATION_LIMIT: usize = 14;
/// Halvings of an increment that leads to values that are not finite.
const BACKTRACK_LIMIT: usize = 12;
/// Change of the scaled unknowns that is rounding.
const ROUNDING: f64 = 1e-15;
/// Share of a state's scale, or of its peak, that the error of one step may have at the usual tolerance.
const STATE_SHARE: f64 = 1e-5;
/// Change below which an iteration that does not contract with a fresh matrix has come to rounding.
const STAGNATION: f64 = 1e-11;

impl Integrator {
    /// Tries a step h from the current state.
    pub fn try_step(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
        tolerance: Option<f64>,
        moment: Moment,
    ) -> Result<Trial, RuntimeError> {
        // Factors of another step serve while the scaled matrix is alike; contraction decides the rest.
        if self
            .factored_step
            .is_some_and(|old| !(0.6..=1.7).contains(&(h / old)))
            || self.contraction.is_some_and(|c| c > RENEWAL)
        {
            self.drop_factors();
        }
        self.rescale_states(model);
        self.predict(model, h, true);
        let mut smooth = true;
        let mut last_norm: Option<f64> = None;
        let mut fresh = false;
        let mut renew = self.factored_step.is_none();
        let mut backtracks = 0;
        let mut moved = false;
        let mut solved = false;
        // Whether the last evaluation was at the trial that is taken.
        let mut current = false;
        let goal = self.goal(h);
        let mut cause = None;
        let mut iteration = 0;
        while iteration < ITERATION_LIMIT {
            match self.evaluate(model, dynamics, h) {
                Ok(()) => {}
                Err(error @ RuntimeError::NotFinite { .. }) => {
                    cause = Some(error);
                    if moved && backtracks < BACKTRACK_LIMIT {
                        // Halve what was added last.
                        backtracks += 1;
                        for (x, step) in self.trial.iter_mut().zip(&mut self.correction) {
                            *step *= 0.5;
                            *x -= *step;
                        }
                        last_norm = None;
                        continue;
                    }
                    if !moved && smooth {
                        smooth = false;
                        self.predict(model, h, false);
                        continue;
                    }
                    break;
                }
                Err(error) => return Err(error),
            }
            if renew {
                match self.factor(model, dynamics, h) {
                    Ok(true) => {}
                    Ok(false) => break,
                    Err(error @ RuntimeError::NotFinite { .. }) => {
                        cause = Some(error);
                        break;
                    }
                    Err(error) => return Err(error),
                }
                fresh = true;
                renew = false;
                last_norm = None;
            }
            iteration += 1;
            self.statistics.iterations += 1;
            for (d, r) in self.correction.iter_mut().zip(&self.residual) {
                *d = -r;
            }
            self.solver.solve(&mut self.correction);
            let norm = self.correction.iter().fold(0.0_f64, |w, x| {
                if x.is_finite() {
                    w.max(x.abs())
                } else {
                    f64::INFINITY
                }
            });
            if !norm.is_finite() {
                if fresh {
                    break;
                }
                renew = true;
                continue;
            }
            if let Some(before) = last_norm {
                // Near rounding the ratio says nothing but that it is small.
                let rate = norm / before;
                let seen = if norm > 100.0 * ROUNDING {
                    rate
                } else {
                    rate.min(1e-3)
                };
                self.contraction = Some(self.contraction.map_or(seen, |c| c.max(seen)));
            }
            // The correction is the error of what was evaluated, if the matrix contracts.
            if norm <= goal && self.contraction.is_some_and(|c| c <= CONTRACTION_LIMIT) {
                solved = true;
                current = true;
                break;
            }
            for (x, d) in self.trial.iter_mut().zip(&self.correction) {
                *x += d;
            }
            moved = true;
            cause = None;
            if norm <= ROUNDING {
                solved = true;
                break;
            }
            if let Some(before) = last_norm {
                let rate = norm / before;
                // The first ratio flatters: what an old matrix does slowly shows only when the rest is gone.
                let expected = rate.max(self.contraction.unwrap_or(0.0)).max(if fresh {
                    0.0
                } else {
                    OLD_CONTRACTION
                });
                if expected < 0.9 && norm * expected / (1.0 - expected) <= goal {
                    solved = true;
                    break;
                }
                if rate >= 2.0 && fresh && norm > 1.0 {
                    break;
                }
                if rate > CONTRACTION_LIMIT {
                    if norm <= 100.0 * ROUNDING || (fresh && norm <= STAGNATION) {
                        solved = true;
                        break;
                    }
                    renew = true;
                }
            }
            last_norm = Some(norm);
        }
        if !solved {
            self.drop_factors();
            let error = match cause {
                Some(RuntimeError::NotFinite {
                    origin, outside, ..
                }) => RuntimeError::NotFinite {
                    origin,
                    outside,
                    moment,
                },
                _ => self.stalled(model, h, moment),
            };
            return Ok(Trial::Failed(Box::new(error)));
        }
        if !current {
            // v', v̇' and a' of the last increment.
            match self.evaluate(model, dynamics, h) {
                Ok(()) => {}
                Err(RuntimeError::NotFinite {
                    origin, outside, ..
                }) => {
                    return Ok(Trial::Failed(Box::new(RuntimeError::NotFinite {
                        origin,
                        outside,
                        moment,
                    })));
                }
                Err(error) => return Err(error),
            }
        }
        let error = match tolerance {
            Some(factor) => self.error(model, dynamics, h, factor)?,
            None => 0.0,
        };
        Ok(Trial::Solved { error })
    }

    /// Tolerance of Newton's iteration in a step h: the stated one, but at most 1e-9 of what accelerations contribute. What is left
    /// of a correction has a sense (the matrix is old in the same way at every step) and adds up over time as a load would. Not
    /// below rounding.
    fn goal(&self, h: f64) -> f64 {
        let largest = |x: &[f64]| {
            x.iter()
                .zip(&self.scales)
                .fold(0.0_f64, |w, (x, s)| w.max((x / s).abs()))
        };
        let acceleration = largest(&self.current.acceleration);
        let moved = h * largest(&self.current.velocity);
        self.newton_tolerance
            .min(1e-9 * self.coefficients.beta * h * h * acceleration)
            .max(ROUNDING * moved.max(1.0))
    }

    /// The step's worst row as an error.
    fn stalled(&self, model: &Model, h: f64, moment: Moment) -> RuntimeError {
        let (worst, scaled) =
            self.residual
                .iter()
                .enumerate()
                .fold((0, 0.0_f64), |best, (i, x)| {
                    if x.abs() > best.1 { (i, x.abs()) } else { best }
                });
        let size = scaled / self.row_scale(model, worst, h);
        let (origin, equation, unit) = self.row_name(model, worst);
        RuntimeError::Newton {
            moment,
            step: h,
            origin: Box::new(origin),
            equation,
            size,
            unit,
        }
    }

    fn row_name(&self, model: &Model, row: usize) -> (Origin, String, &'static str) {
        const COMPONENTS: [&str; 6] = [
            "force x", "force y", "force z", "torque x", "torque y", "torque z",
        ];
        let first_row = model.velocities + model.states;
        if row < model.velocities {
            for body in &model.bodies {
                if (body.velocity..body.velocity + body.width()).contains(&row) {
                    let component = row - body.velocity;
                    let name = COMPONENTS.get(component).copied().unwrap_or("modal force");
                    let unit = if component < 3 { "N" } else { "N m" };
                    return (body.origin.clone(), format!("balance of {name}"), unit);
                }
            }
        } else if row < first_row {
            if let Some((origin, name)) = state_name(model, row - model.velocities) {
                return (
                    origin.clone(),
                    format!("der({name})"),
                    "SI units per second",
                );
            }
        } else if let Some((element, local)) = model.row_owner(row - first_row) {
            let named = model.named_row(element, local, 0.0);
            let unit = if named.is_length { "m" } else { "rad" };
            return (named.origin, named.equation, unit);
        }
        (Origin::default(), String::new(), "")
    }

    /// Local error over tolerance, filtered; see the head of this module.
    fn error(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
        factor: f64,
    ) -> Result<f64, RuntimeError> {
        let c = self.coefficients;
        let (n, s) = (model.velocities, model.states);
        for i in 0..n {
            self.estimate[i] = c.error * h * h * (self.next_auxiliary[i] - self.start_auxiliary[i]);
        }
        self.correction.fill(0.0);
        let weight = c.weights(h).acceleration;
        for (index, body) in model.bodies.iter().enumerate() {
            let width = body.width();
            let mass = &mut self.mass_block[..width * width];
            mass.fill(0.0);
            dynamics.add_mass(model, index, mass);
            for i in 0..width {
                let product: f64 = (0..width)
                    .map(|j| mass[i * width + j] * self.estimate[body.velocity + j])
                    .sum();
                self.correction[body.velocity + i] = weight * product;
            }
        }
        constraints_along(
            model,
            dynamics,
            &self.estimate,
            &mut self.correction[n + s..],
        )?;
        std::mem::swap(&mut dynamics.wrenches, &mut self.damping_wrenches);
        let damped = wrenches_along(model, dynamics, &self.estimate);
        if damped.is_ok() {
            dynamics.add_forces(model, -c.weights(h).velocity, &mut self.correction[..n]);
        }
        std::mem::swap(&mut dynamics.wrenches, &mut self.damping_wrenches);
        damped?;
        for (x, factor) in self.correction.iter_mut().zip(&self.row_factors) {
            *x *= factor;
        }
        self.solver.solve(&mut self.correction);
        let unit = model.length / (STEP_SHARE * model.tolerance * factor);
        let mut worst = 0.0_f64;
        self.governing = None;
        for (i, (x, frequency)) in self.correction[..n]
            .iter()
            .zip(&model.frequencies)
            .enumerate()
        {
            let error = x.abs() * unit;
            if !error.is_finite() {
                self.governing = Some(i);
                return Ok(f64::INFINITY);
            }
            if frequency * h <= RESOLVED && error > worst {
                worst = error;
                self.governing = Some(i);
            }
        }
        // States: the scheme's own error is about a sixth of the distance to the extrapolation of second order.
        for i in 0..s {
            let extrapolated = self.current.states[i]
                + h * self.current.rates[i]
                + 0.5 * h * h * self.state_jerk[i];
            let scale = self.state_peak[i].max(self.next.states[i].abs());
            let miss = (self.next.states[i] - extrapolated).abs() / 6.0;
            let error = miss / (STATE_SHARE * factor * scale);
            if !error.is_finite() {
                self.governing = Some(n + i);
                return Ok(f64::INFINITY);
            }
            if error > worst {
                worst = error;
                self.governing = Some(n + i);
            }
        }
        Ok(worst)
    }

    /// Whose error governed the last step's size: an element and the name of its state, or a body.
    pub fn governing(&self, model: &Model) -> (Origin, Option<String>) {
        let Some(index) = self.governing else {
            return (Origin::default(), None);
        };
        if let Some(state) = index.checked_sub(model.velocities) {
            return state_name(model, state).map_or((Origin::default(), None), |(origin, name)| {
                (origin.clone(), Some(name.to_owned()))
            });
        }
        let body = model
            .bodies
            .iter()
            .find(|body| (body.velocity..body.velocity + body.width()).contains(&index));
        (body.map(|b| b.origin.clone()).unwrap_or_default(), None)
    }
}

/// The element that a state of the model belongs to, and the state's name.
fn state_name(model: &Model, state: usize) -> Option<(&Origin, &str)> {
    model.elements.iter().enumerate().find_map(|(index, e)| {
        let info = model
            .class(index)
            .states
            .get(state.checked_sub(e.state)?)
            .filter(|_| e.dynamic)?;
        let origin = &model.compiled.system.elements[index].origin;
        Some((origin, info.name.as_str()))
    })
}
