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
//! `S [e_f; μ] = [(c M + γ/(βh) D) e; G e]`, `c = (1 − α_m)/((1 − α_f)βh²)`: without stiffness this gives e back; modes which the step does not
//! resolve come out damped, as in Hosea and Shampine (1996). Damping stays on the right as well: a pin whose film's damping outweighs its
//! inertia goes where its velocity takes it, and no force brings back what a step misses of its place. Multipliers and accelerations are not in the norm, and neither are the modes of
//! flexible bodies with ωh > 1 ([`RESOLVED`]): the series holds for none of these. Global errors of second order follow as the tolerance to 2/3.

mod dense;
mod nearest;
mod newton;
mod tangents;

pub use tangents::constraints_along;

use crate::body::Weights;
use crate::dynamics::Dynamics;
use crate::dynamics::MatrixPlan;
use crate::error::RuntimeError;
use crate::linear::{BlockLu, LinearSolver};
use crate::model::Model;
use crate::state::{State, move_pose};

/// Share of the position tolerance that the error of one step may have. Accelerations and small reactions are two derivatives of the
/// positions: in an engine of film bearings they are then good to a per cent of their own swing, positions to far more.
pub const STEP_SHARE: f64 = 0.1;
/// A mode is in the error norm while ωh stays below this (rad): six steps a period. Beyond, the series of the estimate says nothing
/// about it; the scheme's numerical damping takes what rings there, and the mode follows its load.
pub const RESOLVED: f64 = 1.0;

/// Times its magnitude in the scaled system from which on a state has outgrown it.
const OUTGROWN: f64 = 10.0;

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

/// Where Newton's iteration ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Largest correction, in scaled unknowns.
    pub absolute: f64,
    /// Largest correction as a share of what the largest acceleration contributes to the increment of a step.
    pub relative: f64,
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
    /// Factorisations of them that the general method had to take over, since the start or the resumption.
    pub fallbacks: u64,
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
    /// Larger of each state's scale and its largest magnitude so far: errors are held to a share of it.
    pub state_peak: Vec<f64>,
    /// Where Newton's iteration ends.
    pub goal: Goal,
    /// Counts.
    pub statistics: Statistics,
    plan: MatrixPlan,
    solver: Box<dyn LinearSolver>,
    values: Vec<f64>,
    /// The step of the kept factors; `None` where there are none.
    factored_step: Option<f64>,
    /// Whether `values` are still the matrix of the kept factors.
    factored_values: bool,
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
    /// The correction that led to the trial, as far as it was taken.
    taken: Vec<f64>,
    scales: Vec<f64>,
    /// What rows and columns are multiplied by in the step last predicted.
    row_factors: Vec<f64>,
    column_factors: Vec<f64>,
    mass_block: Vec<f64>,
    estimate: Vec<f64>,
    damping_wrenches: Vec<f64>,
    /// The unknown, a velocity's or a state's, that governed the last estimate.
    governing: Option<usize>,
}

impl Integrator {
    /// An integrator at a consistent state with its accelerations.
    pub fn new(
        model: &Model,
        start: &State,
        rho: f64,
        goal: Goal,
    ) -> Result<Integrator, RuntimeError> {
        let plan = MatrixPlan::new(model);
        let solver = BlockLu::new(&plan.pattern);
        let size = plan.pattern.size;
        let mut scales = model.velocity_scales();
        let state_peak: Vec<f64> = start
            .states
            .iter()
            .zip(&model.state_scales)
            .map(|(y, scale)| y.abs().max(*scale))
            .collect();
        scales.extend(&state_peak);
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
            state_peak,
            goal,
            statistics: Statistics::default(),
            values: vec![0.0; plan.pattern.rows.len()],
            plan,
            solver: Box::new(solver),
            factored_step: None,
            factored_values: false,
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
            taken: vec![0.0; size],
            scales,
            row_factors: vec![0.0; size],
            column_factors: vec![0.0; size],
            mass_block: vec![0.0; width * width],
            estimate: vec![0.0; model.velocities],
            damping_wrenches: vec![0.0; model.wrenches],
            governing: None,
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

    /// Takes the magnitudes of states along that have outgrown theirs by far: rounding would stand in the way of their solution.
    fn rescale_states(&mut self, model: &Model) {
        for (scale, peak) in self.scales[model.velocities..]
            .iter_mut()
            .zip(&self.state_peak)
        {
            if *peak > OUTGROWN * *scale {
                *scale = *peak;
                self.factored_step = None;
                self.contraction = None;
            }
        }
    }

    /// Forgets the kept factors.
    pub fn drop_factors(&mut self) {
        self.factored_step = None;
        self.contraction = None;
    }

    /// Step (s), contraction and matrix of the kept factors: what [`Integrator::keep_factors`] makes them from again, to the same bits.
    /// `None` where there are none, or where another matrix was filled since.
    pub fn kept_factors(&self) -> Option<(f64, Option<f64>, &[f64])> {
        let step = self.factored_step?;
        self.factored_values
            .then_some((step, self.contraction, self.values.as_slice()))
    }

    /// Takes factors up as they were kept; counts nothing, for it was counted then. `false` where they can't be made.
    pub fn keep_factors(&mut self, step: f64, contraction: Option<f64>, values: &[f64]) -> bool {
        if values.len() != self.values.len() || self.solver.factor(values).is_err() {
            self.drop_factors();
            return false;
        }
        self.values.copy_from_slice(values);
        self.factored_values = true;
        self.factored_step = Some(step);
        self.contraction = contraction;
        true
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
        for i in 0..self.trial.len() {
            self.row_factors[i] = self.row_scale(model, i, h);
            self.column_factors[i] = self.column_scale(model, i, h);
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

    /// Places, velocities, accelerations, states, their rates and multipliers at the trial of a step h.
    fn take_trial(&mut self, model: &Model, h: f64) {
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
            self.next.multipliers[i] = self.trial[n + s + i] * self.column_factors[n + s + i];
        }
        move_pose(
            model,
            &self.current.pose,
            &self.delta[..n],
            1.0,
            &mut self.next.pose,
        );
    }

    /// Evaluates the scaled residual of a step h at the trial, after [`Integrator::predict`].
    pub fn evaluate(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
    ) -> Result<(), RuntimeError> {
        let (n, s) = (model.velocities, model.states);
        self.take_trial(model, h);
        self.statistics.residuals += 1;
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
        for (r, factor) in self.residual.iter_mut().zip(&self.row_factors) {
            *r *= factor;
        }
        Ok(())
    }

    /// Fills the scaled matrix at the trial last evaluated, after [`Integrator::predict`] of the same step.
    pub fn fill(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
    ) -> Result<(), RuntimeError> {
        self.factored_values = false;
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
        self.plan
            .runs
            .scale(&mut self.values, &self.row_factors, &self.column_factors);
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
        let before = self.solver.fallbacks();
        let factored = self.solver.factor(&self.values).is_ok();
        self.statistics.fallbacks += self.solver.fallbacks() - before;
        if factored {
            self.factored_values = true;
            self.factored_step = Some(h);
            Ok(true)
        } else {
            self.factored_step = None;
            Ok(false)
        }
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
}
