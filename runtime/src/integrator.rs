//! Lie-group generalised-α for index-3 DAEs.
//!
//! Arnold and Brüls, "Convergence of the generalized-α scheme for constrained mechanical systems", Multibody Syst Dyn 18
//! (2007); on Lie groups: Brüls, Cardona, Arnold, Mech Mach Theory 48 (2012). With `u = h Δq`:
//!
//! ```text
//! q' = q ∘ exp(u)      u = h v + h² ((½ − β) a + β a')      v' = v + h ((1 − γ) a + γ a')
//! (1 − α_m) a' + α_m a = (1 − α_f) v̇' + α_f v̇
//! α_m = (2ρ − 1)/(ρ + 1)   α_f = ρ/(ρ + 1)   γ = ½ + α_f − α_m   β = ¼ (γ + ½)²       (Chung and Hulbert 1993)
//! ```
//!
//! Element states follow the first-order scheme of Jansen, Whiting and Hulbert (2000) with the same α_f:
//! `α_m = (3ρ − 1)/(2(ρ + 1))`, `γ = ½ + α_f − α_m`, so that rates are taken at the same instant.
//!
//! `a` belongs to the instant `t + (α_m − α_f) h`. Hence `a₀ = v̇₀ + (α_m − α_f) h v̈₀`, and after a change of the step
//! `a ← v̇ + (h_new/h_old)(a − v̇)`; else second order is lost. For λ the velocity's off-constraint part follows as well, with
//! h²: see [`Integrator::set_defect`].
//!
//! **Unknowns and scaling** (Bottasso, Dopico, Trainelli 2008): u in units of the model's length L (angles: 1), states in
//! their magnitude, `λ̂ = βh²λ/(m L²)`; dynamic rows by βh²; lengths among the constraints by L. The condition of the matrix
//! then does not grow as h falls.
//!
//! **Local error.** With `a = v̇ + Δ v̈`, `Δ = (α_m − α_f) h`, the Taylor series of the update against the motion's leaves
//! `u − u_exact = (β + ½(α_m − α_f) − 1/6) h³ v̈ + O(h⁴)`, and `h v̈ ≈ a' − a`. (For ρ = 1 this is Zienkiewicz and
//! Xie's estimate for Newmark's method, 1991.) The estimate e is filtered by the step's matrix,
//! `S [e_f; μ] = [c M e; G e]`, `c = (1 − α_m)/((1 − α_f)βh²)`: without stiffness this gives e back; modes which the step does not resolve
//! come out damped, as in Hosea and Shampine (1996). Global errors of second order follow as the tolerance to 2/3.

use crate::body::Weights;
use crate::dynamics::{Dynamics, MatrixPlan};
use crate::elements;
use crate::error::{Moment, RuntimeError};
use crate::linear::{LinearSolver, SparseLu};
use crate::model::Model;
use crate::rotation::{V3, inverse_tangent};
use crate::state::{State, move_pose};
use eng_system::code::Function;
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
/// Change below which an iteration that does not contract with a fresh matrix has come to rounding.
const STAGNATION: f64 = 1e-11;

/// Coefficients of the scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Weight of the old `a`.
    pub alpha_m: f64,
    /// Weight of the old v̇.
    pub alpha_f: f64,
    /// Of velocities.
    pub gamma: f64,
    /// Of positions.
    pub beta: f64,
    /// Weight of the old auxiliary rate of states.
    pub state_alpha_m: f64,
    /// Of states.
    pub state_gamma: f64,
    /// `β + ½(α_m − α_f) − 1/6`.
    pub error: f64,
}

impl Coefficients {
    /// For a spectral radius at infinite frequency in 0…1.
    pub fn new(rho: f64) -> Coefficients {
        let alpha_m = (2.0 * rho - 1.0) / (rho + 1.0);
        let alpha_f = rho / (rho + 1.0);
        let gamma = 0.5 + alpha_f - alpha_m;
        let beta = 0.25 * (gamma + 0.5) * (gamma + 0.5);
        let state_alpha_m = (3.0 * rho - 1.0) / (2.0 * (rho + 1.0));
        Coefficients {
            alpha_m,
            alpha_f,
            gamma,
            beta,
            state_alpha_m,
            state_gamma: 0.5 + alpha_f - state_alpha_m,
            error: beta + 0.5 * (alpha_m - alpha_f) - 1.0 / 6.0,
        }
    }

    /// Derivatives by the increment of a step h.
    fn weights(&self, h: f64) -> Weights {
        Weights {
            acceleration: (1.0 - self.alpha_m) / ((1.0 - self.alpha_f) * self.beta * h * h),
            velocity: self.gamma / (self.beta * h),
        }
    }

    /// dẏ'/dy' of a step h.
    fn state_weight(&self, h: f64) -> f64 {
        (1.0 - self.state_alpha_m) / ((1.0 - self.alpha_f) * self.state_gamma * h)
    }
}

/// Counts of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: u64,
    /// Steps rejected by error control.
    pub rejected: u64,
    /// Steps whose Newton iteration failed.
    pub failed: u64,
    /// Newton iterations.
    pub iterations: u64,
    /// Factorisations of the step's matrix.
    pub factorizations: u64,
    /// Evaluations of the step's residual.
    pub residuals: u64,
}

/// What a trial of a step gave.
#[derive(Clone, Debug)]
pub enum Trial {
    /// Solved; the estimated local error in units of the tolerance.
    Solved {
        /// Error over tolerance.
        error: f64,
    },
    /// Not solved.
    Failed(Box<RuntimeError>),
}

/// The integrator between two accepted states.
#[derive(Debug)]
pub struct Integrator {
    /// Coefficients.
    pub coefficients: Coefficients,
    /// Last accepted state.
    pub current: State,
    /// State before it, for dense output.
    pub previous: State,
    /// Increment between them.
    pub increment: Vec<f64>,
    /// Trial of the next state.
    next: State,
    /// Auxiliary a, and the step it belongs to.
    pub auxiliary: Vec<f64>,
    /// Auxiliary rates of the states.
    pub state_auxiliary: Vec<f64>,
    /// The current velocity without, and only, the part that misses the constraints; see [`Integrator::set_defect`].
    pub base_velocity: Vec<f64>,
    /// See `base_velocity`.
    pub defect: Vec<f64>,
    /// Whether the two above belong to the current state.
    pub defect_known: bool,
    /// The step `auxiliary` belongs to (s).
    pub auxiliary_step: f64,
    /// Rates of v̇, λ and ẏ for the predictor.
    pub jerk: Vec<f64>,
    /// Rate of λ.
    pub multiplier_rate: Vec<f64>,
    /// Rate of ẏ.
    pub state_jerk: Vec<f64>,
    /// Largest magnitude of each state so far.
    pub state_peak: Vec<f64>,
    /// Tolerance of Newton's iteration, in scaled unknowns.
    pub newton_tolerance: f64,
    /// Counts.
    pub statistics: Statistics,
    plan: MatrixPlan,
    solver: Box<dyn LinearSolver>,
    values: Vec<f64>,
    /// The step of the kept factors; `None` where there are none.
    factored_step: Option<f64>,
    /// Contraction that the kept factors showed.
    contraction: Option<f64>,
    trial: Vec<f64>,
    start_velocity: Vec<f64>,
    start_auxiliary: Vec<f64>,
    start_state_auxiliary: Vec<f64>,
    next_auxiliary: Vec<f64>,
    next_state_auxiliary: Vec<f64>,
    residual: Vec<f64>,
    delta: Vec<f64>,
    correction: Vec<f64>,
    scales: Vec<f64>,
    mass_block: Vec<f64>,
    estimate: Vec<f64>,
}

impl Integrator {
    /// An integrator at a consistent state with its accelerations.
    pub fn new(
        model: &Model,
        start: &State,
        rho: f64,
        newton_tolerance: f64,
    ) -> Result<Integrator, RuntimeError> {
        let plan = MatrixPlan::new(model);
        let solver = SparseLu::new(&plan.pattern).map_err(|e| RuntimeError::Malformed {
            what: e.to_string(),
        })?;
        let size = plan.pattern.size;
        let mut scales = model.velocity_scales();
        scales.extend(start.states.iter().map(|y| y.abs().max(1.0)));
        scales.extend(model.row_scales());
        let width = model.bodies.iter().map(|b| b.width()).max().unwrap_or(0);
        Ok(Integrator {
            coefficients: Coefficients::new(rho),
            current: start.clone(),
            previous: start.clone(),
            next: start.clone(),
            increment: vec![0.0; model.velocities],
            auxiliary: start.acceleration.clone(),
            state_auxiliary: start.rates.clone(),
            base_velocity: start.velocity.clone(),
            defect: vec![0.0; model.velocities],
            defect_known: false,
            auxiliary_step: 1.0,
            jerk: vec![0.0; model.velocities],
            multiplier_rate: vec![0.0; model.rows],
            state_jerk: vec![0.0; model.states],
            state_peak: start.states.iter().map(|y| y.abs()).collect(),
            newton_tolerance,
            statistics: Statistics::default(),
            values: vec![0.0; plan.pattern.rows.len()],
            plan,
            solver: Box::new(solver),
            factored_step: None,
            contraction: None,
            trial: vec![0.0; size],
            start_velocity: vec![0.0; model.velocities],
            start_auxiliary: vec![0.0; model.velocities],
            start_state_auxiliary: vec![0.0; model.states],
            next_auxiliary: vec![0.0; model.velocities],
            next_state_auxiliary: vec![0.0; model.states],
            residual: vec![0.0; size],
            delta: vec![0.0; size],
            correction: vec![0.0; size],
            scales,
            mass_block: vec![0.0; width * width],
            estimate: vec![0.0; model.velocities],
        })
    }

    /// Starts `a` with the rate of the accelerations, `a₀ = v̇₀ + (α_m − α_f) h v̈₀`, and v with its off-constraint part, both
    /// kept for h = 1 s and rescaled to each step. `normal_jerk` is the part of v̈₀ normal to the constraints.
    pub fn start(
        &mut self,
        jerk: &[f64],
        normal_jerk: &[f64],
        multiplier_rate: &[f64],
        state_jerk: &[f64],
    ) {
        let c = self.coefficients;
        self.jerk.copy_from_slice(jerk);
        self.multiplier_rate.copy_from_slice(multiplier_rate);
        self.state_jerk.copy_from_slice(state_jerk);
        self.auxiliary_step = 1.0;
        self.base_velocity.copy_from_slice(&self.current.velocity);
        for (d, x) in self.defect.iter_mut().zip(normal_jerk) {
            *d = -c.error * x;
        }
        self.defect_known = true;
        for (i, a) in self.auxiliary.iter_mut().enumerate() {
            *a = self.current.acceleration[i] + (c.alpha_m - c.alpha_f) * jerk[i];
        }
        for (i, a) in self.state_auxiliary.iter_mut().enumerate() {
            *a = self.current.rates[i] + (c.state_alpha_m - c.alpha_f) * state_jerk[i];
        }
    }

    /// Whether a step h needs [`Integrator::set_defect`] first: it differs from the last one.
    pub fn needs_defect(&self, h: f64) -> bool {
        h != self.auxiliary_step && !self.defect_known
    }

    /// Takes the part of the current velocity that is normal to the constraints in the mass norm.
    ///
    /// The position constraint holds at every step although the update misses the motion by `C h³ v̈`; the velocity makes up for it
    /// along the constraints' normals, `−C h² v̈`. When h changes at once, this part has to change with h², else the multipliers
    /// take the difference and drop to first order. (At the start it is set from v̈₀: the perturbed starting velocity of Arnold,
    /// Cardona, Brüls 2016.) The tangential part is never touched.
    pub fn set_defect(&mut self, defect: &[f64]) {
        self.defect.copy_from_slice(defect);
        for (i, b) in self.base_velocity.iter_mut().enumerate() {
            *b = self.current.velocity[i] - defect[i];
        }
        self.defect_known = true;
    }

    /// Magnitudes of the states in the scaled system.
    pub fn state_scales(&self, model: &Model) -> &[f64] {
        &self.scales[model.velocities..model.velocities + model.states]
    }

    /// Sets the magnitudes of the states, from a checkpoint.
    pub fn set_state_scales(&mut self, model: &Model, scales: &[f64]) {
        self.scales[model.velocities..model.velocities + model.states].copy_from_slice(scales);
    }

    /// Forgets the kept factors.
    pub fn drop_factors(&mut self) {
        self.factored_step = None;
        self.contraction = None;
    }

    /// Unknowns of a step: scaled increments, states, multipliers.
    pub fn unknowns(&self) -> usize {
        self.trial.len()
    }

    /// The pattern of the step's matrix.
    pub fn pattern(&self) -> &crate::linear::Pattern {
        &self.plan.pattern
    }

    /// Values of the matrix last filled.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The last residual, scaled.
    pub fn last_residual(&self) -> &[f64] {
        &self.residual
    }

    /// Sets `a` of this step's beginning and the predicted unknowns (scaled) for a step h.
    ///
    /// With `smooth`, accelerations, multipliers and rates go on with their last rates of change; else they stay.
    pub fn predict(&mut self, model: &Model, h: f64, smooth: bool) {
        let c = self.coefficients;
        let ratio = h / self.auxiliary_step;
        let rate = if smooth { h } else { 0.0 };
        let (n, s) = (model.velocities, model.states);
        let state = &self.current;
        for i in 0..n {
            let v = if h == self.auxiliary_step || !self.defect_known {
                state.velocity[i]
            } else {
                self.base_velocity[i] + ratio * ratio * self.defect[i]
            };
            self.start_velocity[i] = v;
            let v_dot = state.acceleration[i];
            let a = v_dot + ratio * (self.auxiliary[i] - v_dot);
            self.start_auxiliary[i] = a;
            let next_dot = v_dot + rate * self.jerk[i];
            let next = ((1.0 - c.alpha_f) * next_dot + c.alpha_f * v_dot - c.alpha_m * a)
                / (1.0 - c.alpha_m);
            let u = h * v + h * h * ((0.5 - c.beta) * a + c.beta * next);
            self.trial[i] = u / self.scales[i];
        }
        for i in 0..s {
            let rate_now = state.rates[i];
            let w = rate_now + ratio * (self.state_auxiliary[i] - rate_now);
            self.start_state_auxiliary[i] = w;
            let next_rate = rate_now + rate * self.state_jerk[i];
            let next = ((1.0 - c.alpha_f) * next_rate + c.alpha_f * rate_now - c.state_alpha_m * w)
                / (1.0 - c.state_alpha_m);
            let y = state.states[i] + h * ((1.0 - c.state_gamma) * w + c.state_gamma * next);
            self.trial[n + i] = y / self.scales[n + i];
        }
        for i in 0..model.rows {
            let multiplier = state.multipliers[i] + rate * self.multiplier_rate[i];
            self.trial[n + s + i] = multiplier / self.multiplier_scale(model, i, h);
        }
    }

    fn multiplier_scale(&self, model: &Model, row: usize, h: f64) -> f64 {
        model.mass * model.length * model.length
            / (self.coefficients.beta * h * h * self.scales[model.velocities + model.states + row])
    }

    fn row_scale(&self, model: &Model, row: usize, h: f64) -> f64 {
        let scale = self.scales[row];
        if row < model.velocities {
            self.coefficients.beta * h * h * scale / (model.mass * model.length * model.length)
        } else if row < model.velocities + model.states {
            h / scale
        } else {
            1.0 / scale
        }
    }

    fn column_scale(&self, model: &Model, column: usize, h: f64) -> f64 {
        let first_row = model.velocities + model.states;
        if column < first_row {
            self.scales[column]
        } else {
            self.multiplier_scale(model, column - first_row, h)
        }
    }

    /// Sets the trial's unknowns (scaled).
    pub fn set_trial(&mut self, unknowns: &[f64]) {
        self.trial.copy_from_slice(unknowns);
    }

    /// The trial's unknowns (scaled).
    pub fn trial(&self) -> &[f64] {
        &self.trial
    }

    /// Evaluates the scaled residual of a step h at the trial, after [`Integrator::predict`].
    pub fn evaluate(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
    ) -> Result<(), RuntimeError> {
        let c = self.coefficients;
        let (n, s) = (model.velocities, model.states);
        for i in 0..n {
            let u = self.trial[i] * self.scales[i];
            let a = self.start_auxiliary[i];
            let v = self.start_velocity[i];
            let next = (u / h - v - (0.5 - c.beta) * h * a) / (c.beta * h);
            self.delta[i] = u;
            self.next_auxiliary[i] = next;
            self.next.velocity[i] = v + h * ((1.0 - c.gamma) * a + c.gamma * next);
            self.next.acceleration[i] = ((1.0 - c.alpha_m) * next + c.alpha_m * a
                - c.alpha_f * self.current.acceleration[i])
                / (1.0 - c.alpha_f);
        }
        for i in 0..s {
            let y = self.trial[n + i] * self.scales[n + i];
            let w = self.start_state_auxiliary[i];
            let next =
                ((y - self.current.states[i]) / h - (1.0 - c.state_gamma) * w) / c.state_gamma;
            self.next.states[i] = y;
            self.next_state_auxiliary[i] = next;
            self.next.rates[i] = ((1.0 - c.state_alpha_m) * next + c.state_alpha_m * w
                - c.alpha_f * self.current.rates[i])
                / (1.0 - c.alpha_f);
        }
        for i in 0..model.rows {
            self.next.multipliers[i] = self.trial[n + s + i] * self.multiplier_scale(model, i, h);
        }
        self.statistics.residuals += 1;
        move_pose(
            model,
            &self.current.pose,
            &self.delta[..n],
            1.0,
            &mut self.next.pose,
        );
        self.next.time = self.current.time + h;
        dynamics.place(model, self.next.time, &self.next.pose, &self.next.velocity);
        dynamics.gather(
            model,
            &self.next.states,
            &self.next.multipliers,
            &self.current.rotations,
        );
        dynamics.evaluate(model)?;
        self.residual.fill(0.0);
        dynamics.add_inertia(
            model,
            &self.next.velocity,
            &self.next.acceleration,
            &mut self.residual[..n],
        );
        dynamics.add_forces(model, -1.0, &mut self.residual[..n]);
        for i in 0..s {
            self.residual[n + i] = self.next.rates[i] - dynamics.rates[i];
        }
        self.residual[n + s..].copy_from_slice(&dynamics.constraints);
        for i in 0..self.residual.len() {
            self.residual[i] *= self.row_scale(model, i, h);
        }
        Ok(())
    }

    /// Fills the scaled matrix at the trial last evaluated.
    pub fn fill(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
    ) -> Result<(), RuntimeError> {
        for i in 0..model.velocities {
            self.delta[i] = self.trial[i] * self.scales[i];
        }
        self.plan.fill(
            model,
            dynamics,
            &self.next.velocity,
            &self.next.acceleration,
            &self.delta[..model.velocities],
            self.coefficients.weights(h),
            self.coefficients.state_weight(h),
            &mut self.values,
        )?;
        for column in 0..self.plan.pattern.size {
            let by_column = self.column_scale(model, column, h);
            for k in self.plan.pattern.columns[column]..self.plan.pattern.columns[column + 1] {
                self.values[k] *= by_column * self.row_scale(model, self.plan.pattern.rows[k], h);
            }
        }
        Ok(())
    }

    fn factor(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
    ) -> Result<bool, RuntimeError> {
        self.fill(model, dynamics, h)?;
        self.statistics.factorizations += 1;
        self.contraction = None;
        if self.solver.factor(&self.values).is_ok() {
            self.factored_step = Some(h);
            Ok(true)
        } else {
            self.factored_step = None;
            Ok(false)
        }
    }

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
                Some(RuntimeError::NotFinite { origin, .. }) => {
                    RuntimeError::NotFinite { origin, moment }
                }
                _ => self.stalled(model, h, moment),
            };
            return Ok(Trial::Failed(Box::new(error)));
        }
        if !current {
            // v', v̇' and a' of the last increment.
            match self.evaluate(model, dynamics, h) {
                Ok(()) => {}
                Err(RuntimeError::NotFinite { origin, .. }) => {
                    return Ok(Trial::Failed(Box::new(RuntimeError::NotFinite {
                        origin,
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
            origin,
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
            let state = row - model.velocities;
            for (index, element) in model.elements.iter().enumerate().filter(|(_, e)| e.dynamic) {
                if let Some(info) = state
                    .checked_sub(element.state)
                    .and_then(|k| model.class(index).states.get(k))
                {
                    let origin = model.compiled.system.elements[index].origin.clone();
                    return (origin, format!("der({})", info.name), "SI units per second");
                }
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
        for (body, frame) in model.bodies.iter().zip(&dynamics.frames) {
            let width = body.width();
            let mass = &mut self.mass_block[..width * width];
            mass.fill(0.0);
            body.add_mass(frame, mass);
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
        for i in 0..self.correction.len() {
            self.correction[i] *= self.row_scale(model, i, h);
        }
        self.solver.solve(&mut self.correction);
        let unit = model.length / (model.tolerance * factor);
        let mut worst = 0.0_f64;
        for x in &self.correction[..n] {
            if !x.is_finite() {
                return Ok(f64::INFINITY);
            }
            worst = worst.max(x.abs() * unit);
        }
        // States: the scheme's own error is about a sixth of the distance to the extrapolation of second order.
        for i in 0..s {
            let extrapolated = self.current.states[i]
                + h * self.current.rates[i]
                + 0.5 * h * h * self.state_jerk[i];
            let scale = self.state_peak[i]
                .max(self.next.states[i].abs())
                .max(1e-300);
            worst = worst
                .max((self.next.states[i] - extrapolated).abs() / 6.0 / (1e-5 * factor * scale));
        }
        Ok(worst)
    }

    /// The body that moves the estimated error most.
    pub fn worst_body(&self, model: &Model) -> Origin {
        let mut worst = (0.0, Origin::default());
        for body in &model.bodies {
            for i in body.velocity..body.velocity + body.width() {
                let size = (self.estimate[i] / self.scales[i]).abs();
                if size > worst.0 {
                    worst = (size, body.origin.clone());
                }
            }
        }
        worst.1
    }

    /// Makes the trial the current state. `time` is where the step ends, to the last bit.
    pub fn accept(&mut self, model: &Model, h: f64, time: f64) {
        let n = model.velocities;
        self.statistics.steps += 1;
        self.next.time = time;
        self.next.rotations.copy_from_slice(&self.current.rotations);
        for i in 0..n {
            self.increment[i] = self.trial[i] * self.scales[i];
            self.jerk[i] = (self.next.acceleration[i] - self.current.acceleration[i]) / h;
        }
        for i in 0..model.rows {
            self.multiplier_rate[i] = (self.next.multipliers[i] - self.current.multipliers[i]) / h;
        }
        for i in 0..model.states {
            self.state_jerk[i] = (self.next.rates[i] - self.current.rates[i]) / h;
            self.state_peak[i] = self.state_peak[i].max(self.next.states[i].abs());
        }
        std::mem::swap(&mut self.previous, &mut self.current);
        std::mem::swap(&mut self.current, &mut self.next);
        std::mem::swap(&mut self.auxiliary, &mut self.next_auxiliary);
        std::mem::swap(&mut self.state_auxiliary, &mut self.next_state_auxiliary);
        self.auxiliary_step = h;
        self.defect_known = false;
    }

    /// The state at a fraction 0…1 of the last step: cubic in positions (rotations in the increment from the step's begin) and
    /// in velocities, from values and rates at both ends. Not projected.
    pub fn interpolate(&self, model: &Model, fraction: f64, work: &mut [f64], out: &mut State) {
        let (from, to) = (&self.previous, &self.current);
        let h = to.time - from.time;
        let s = fraction;
        let value = s * s * (3.0 - 2.0 * s);
        let rate_from = h * s * (1.0 - s) * (1.0 - s);
        let rate_to = -h * s * s * (1.0 - s);
        for body in &model.bodies {
            let v = body.velocity;
            for i in v..v + body.width() {
                work[i] = value * self.increment[i]
                    + rate_from * from.velocity[i]
                    + rate_to * to.velocity[i];
            }
            let theta = V3::new(
                self.increment[v + 3],
                self.increment[v + 4],
                self.increment[v + 5],
            );
            let end = inverse_tangent(&theta)
                * V3::new(to.velocity[v + 3], to.velocity[v + 4], to.velocity[v + 5]);
            for i in 0..3 {
                let k = v + 3 + i;
                work[k] = value * theta[i] + rate_from * from.velocity[k] + rate_to * end[i];
            }
        }
        move_pose(model, &from.pose, work, 1.0, &mut out.pose);
        let hermite =
            |a: f64, b: f64, da: f64, db: f64| a + value * (b - a) + rate_from * da + rate_to * db;
        for i in 0..model.velocities {
            out.velocity[i] = hermite(
                from.velocity[i],
                to.velocity[i],
                from.acceleration[i],
                to.acceleration[i],
            );
            out.acceleration[i] =
                from.acceleration[i] + s * (to.acceleration[i] - from.acceleration[i]);
        }
        for i in 0..model.states {
            out.states[i] = hermite(from.states[i], to.states[i], from.rates[i], to.rates[i]);
            out.rates[i] = from.rates[i] + s * (to.rates[i] - from.rates[i]);
        }
        for i in 0..model.rows {
            out.multipliers[i] =
                from.multipliers[i] + s * (to.multipliers[i] - from.multipliers[i]);
        }
        out.rotations.copy_from_slice(&to.rotations);
        out.time = from.time + s * h;
    }
}

/// `G x` for a vector of body velocities, by one tangent an element, at the place and the inputs of `dynamics`.
pub fn constraints_along(
    model: &Model,
    dynamics: &mut Dynamics,
    along: &[f64],
    out: &mut [f64],
) -> Result<(), RuntimeError> {
    for b in 0..dynamics.batches.len() {
        let class_index = dynamics.batches[b].class;
        let class = &model.compiled.system.classes[class_index];
        let layout = &class.layout;
        let rows = layout.rows as usize;
        if rows == 0 {
            continue;
        }
        let tape = class.tape as usize;
        let directions = layout.directions() as usize;
        let length = layout.residual_len() as usize;
        for pair in 0..dynamics.batches[b].pairs.len() {
            elements::call(
                model,
                class_index,
                Function::Linearize,
                dynamics.batches[b].inputs(pair),
                &mut dynamics.scratch.tape[..tape],
            )?;
            dynamics.scratch.tape[tape..tape + directions].fill([0.0; 2]);
            for lane in 0..2 {
                let element = &model.elements[dynamics.batches[b].pairs[pair][lane]];
                for (k, marker) in element.markers.iter().enumerate() {
                    let Some(body) = model.markers[*marker].body else {
                        continue;
                    };
                    let body = &model.bodies[body];
                    let width = body.width();
                    let x = &along[body.velocity..body.velocity + width];
                    for d in 0..6 {
                        let value = match dynamics.marker_jacobian(model, *marker) {
                            Some(j) => j[d * width..(d + 1) * width]
                                .iter()
                                .zip(x)
                                .map(|(j, x)| j * x)
                                .sum(),
                            None => 0.0,
                        };
                        let seed = tape + layout.pose_direction(k as u32) as usize + d;
                        dynamics.scratch.tape[seed][lane] = value;
                    }
                }
            }
            elements::call(
                model,
                class_index,
                Function::Tangent,
                &dynamics.scratch.tape[..tape + directions],
                &mut dynamics.scratch.outputs[..length],
            )?;
            for lane in 0..dynamics.batches[b].lanes(pair) {
                let element = &model.elements[dynamics.batches[b].pairs[pair][lane]];
                for i in 0..rows {
                    out[element.row + i] = dynamics.scratch.outputs[i][lane];
                }
            }
        }
    }
    Ok(())
}
