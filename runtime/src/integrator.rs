//! The generalised-α method on the Lie group, for differential-algebraic equations of index 3, and Radau IIA.
//!
//! Arnold and Brüls, "Convergence of the generalized-α scheme for constrained mechanical systems", Multibody
//! Syst Dyn 18 (2007); on Lie groups: Brüls, Cardona, Arnold, Mech Mach Theory 48 (2012). With `u = h Δq`:
//!
//! ```text
//! q' = q ∘ exp(u)      u = h v + h² ((½ − β) a + β a')      v' = v + h ((1 − γ) a + γ a')
//! (1 − α_m) a' + α_m a = (1 − α_f) v̇' + α_f v̇
//! α_m = (2ρ − 1)/(ρ + 1)   α_f = ρ/(ρ + 1)   γ = ½ + α_f − α_m   β = ¼ (γ + ½)²   (Chung, Hulbert 1993)
//! ```
//!
//! q is the pose, v the velocity, v̇ and λ the acceleration and the multipliers of the equations of motion, a
//! the auxiliary acceleration of the scheme, and h the step. A prime marks the end of the step. ρ is the
//! spectral radius at infinite frequency: at 1 the scheme has no numerical damping, at 0 the most.
//!
//! Element states follow the first-order scheme of Jansen, Whiting and Hulbert (2000) with the same α_f:
//! `α_m = (3ρ − 1)/(2(ρ + 1))`, `γ = ½ + α_f − α_m`, so rates belong to the same instant.
//!
//! `a` belongs to the instant `t + (α_m − α_f) h`. Hence `a₀ = v̇₀ + (α_m − α_f) h v̈₀`, and after a change
//! of the step `a ← v̇ + (h_new/h_old)(a − v̇)`. Otherwise the scheme loses its second order. For the order
//! of λ the part of the velocity normal to the constraints is rescaled too, with h²: see
//! [`Integrator::set_defect`].
//!
//! **Unknowns and scaling** (Bottasso, Dopico, Trainelli 2008): u in units of the model's length L (angles:
//! 1), states in units of their magnitude, `λ̂ = βh²sλ/(m L²)` with the largest mass m and the scale s of the
//! row (L for a length, 1 for an angle). Dynamic rows are multiplied by βh², and constraints are divided by
//! s. The condition of the matrix then does not grow as h decreases.
//!
//! **Local error.** With `a = v̇ + Δ v̈`, `Δ = (α_m − α_f) h`, the difference of the Taylor series of update
//! and motion is `u − u_exact = (β + ½(α_m − α_f) − 1/6) h³ v̈ + O(h⁴)`, and `h v̈ ≈ a' − a`. (For ρ = 1 this
//! is Zienkiewicz and Xie's estimate for Newmark's method, 1991.) The estimate e is filtered by the step's
//! matrix, `S [e_f; μ] = [(c M + γ/(βh) D) e; G e]`, `c = (1 − α_m)/((1 − α_f)βh²)`, with the matrix S of the
//! step, the mass M, the damping D and the gradients G of the constraints. e_f is the filtered estimate, and
//! μ is not used. Without stiffness this gives e back. Modes which the step does not resolve come out damped,
//! as in Hosea and Shampine (1996). Damping is also on the right side: a pin whose film's damping outweighs
//! its inertia moves with its velocity, and no force corrects an error of its position.
//!
//! The norm contains no multipliers, no accelerations, and no modes of flexible bodies with ωh > 1
//! ([`RESOLVED`]), because the series holds for none of these. The global error is of second order and
//! follows the tolerance to the power 2/3.

pub(crate) mod dense;
mod nearest;
mod newton;
pub(crate) mod radau;
mod saved;
mod variation;
mod vibration;

pub use newton::STATE_SHARE;
pub use variation::{StepDerivative, Variation};
pub use vibration::{Damped, Vibration};

use crate::body::Weights;
use crate::dynamics::Dynamics;
use crate::dynamics::MatrixPlan;
use crate::error::RuntimeError;
use crate::field::Demand;
use crate::linear::{BlockLu, LinearSolver};
use crate::model::Model;
use crate::state::{State, move_pose};
use eng_system::secants::Secants;
use eng_system::system::Method;
use radau::Radau;

/// The error norm contains a mode while ωh is below this (rad), which is six steps per period. For faster
/// modes the series of the estimate does not converge. Such a mode follows its load, and numerical damping
/// removes its ringing.
pub const RESOLVED: f64 = 1.0;

/// Multiple of its magnitude in the scaled system above which a state needs a new magnitude. A choice: each
/// change costs a new matrix, and a state that is ten times its scale still has the digits that the others
/// have, but for one.
const OUTGROWN: f64 = 10.0;

/// Coefficients of the scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Weight of the old `a`.
    pub alpha_m: f64,
    /// Weight of the old v̇.
    pub alpha_f: f64,
    /// γ, for velocities.
    pub gamma: f64,
    /// β, for positions.
    pub beta: f64,
    /// Weight of the old auxiliary rate of states.
    pub state_alpha_m: f64,
    /// γ, for states.
    pub state_gamma: f64,
    /// `β + ½(α_m − α_f) − 1/6`.
    pub error: f64,
}

impl Coefficients {
    /// The coefficients for a spectral radius at infinite frequency in 0…1.
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

    /// Derivatives of velocity and acceleration with respect to the increment of a step h.
    fn weights(&self, h: f64) -> Weights {
        Weights {
            acceleration: (1.0 - self.alpha_m) / ((1.0 - self.alpha_f) * self.beta * h * h),
            velocity: self.gamma / (self.beta * h),
        }
    }

    /// dẏ'/dy' of a step h. In 1/s.
    fn state_weight(&self, h: f64) -> f64 {
        (1.0 - self.state_alpha_m) / ((1.0 - self.alpha_f) * self.state_gamma * h)
    }
}

/// The limits at which Newton's iteration ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Largest correction, in scaled unknowns.
    pub absolute: f64,
    /// Largest correction as a share of the contribution of the largest acceleration to the increment of a
    /// step.
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
    /// Factorisations by the general method, after a failure of the block method, since the start or the
    /// resumption.
    pub fallbacks: u64,
    /// Trials that passed a kink and were shortened to end at it.
    pub kinks: u64,
}

/// Outcome of a trial step.
#[derive(Clone, Debug)]
pub enum Trial {
    /// Solved, with the estimated local error in units of the tolerance.
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
    /// Auxiliary accelerations a.
    pub auxiliary: Vec<f64>,
    /// Auxiliary rates of the states.
    state_auxiliary: Vec<f64>,
    /// The current velocity without the part that violates the constraints; see [`Integrator::set_defect`].
    base_velocity: Vec<f64>,
    /// The part of the current velocity that violates the constraints.
    defect: Vec<f64>,
    /// Whether `base_velocity` and `defect` belong to the current state.
    defect_known: bool,
    /// The step `auxiliary` belongs to (s).
    auxiliary_step: f64,
    /// Rate of v̇, for the predictor.
    pub jerk: Vec<f64>,
    /// Rate of λ, for the predictor.
    pub multiplier_rate: Vec<f64>,
    /// Rate of ẏ, for the predictor.
    state_jerk: Vec<f64>,
    /// The larger of each state's scale and its largest magnitude so far. Errors are limited to a share of
    /// it.
    state_peak: Vec<f64>,
    /// The limits at which Newton's iteration ends.
    goal: Goal,
    /// Counts.
    pub statistics: Statistics,
    plan: MatrixPlan,
    solver: Box<dyn LinearSolver>,
    values: Vec<f64>,
    /// The step of the kept factors; `None` without factors.
    factored_step: Option<f64>,
    /// Whether `values` are still the matrix of the kept factors.
    factored_values: bool,
    /// Contraction observed with the kept factors.
    contraction: Option<f64>,
    /// Earlier moves, which show the error of the kept factors.
    secants: Secants,
    trial: Vec<f64>,
    start_velocity: Vec<f64>,
    start_auxiliary: Vec<f64>,
    start_state_auxiliary: Vec<f64>,
    next_auxiliary: Vec<f64>,
    next_state_auxiliary: Vec<f64>,
    residual: Vec<f64>,
    delta: Vec<f64>,
    correction: Vec<f64>,
    /// The last correction of the kept factors alone.
    plain: Vec<f64>,
    /// The applied part of the correction that led to the trial.
    taken: Vec<f64>,
    scales: Vec<f64>,
    /// Factors on rows and columns in the step last predicted.
    row_factors: Vec<f64>,
    column_factors: Vec<f64>,
    /// Mass matrices of the bodies one after the other, if `masses_known` at the last evaluated trial.
    masses: Vec<f64>,
    masses_known: bool,
    estimate: Vec<f64>,
    /// The unknown (a velocity or a state) that governed the last estimate.
    governing: Option<usize>,
    /// Vibrations of each body; see the module `vibration`.
    pub vibrations: Vec<Vibration>,
    /// Present if the steps are those of Radau IIA.
    radau: Option<Box<Radau>>,
}

impl Integrator {
    /// An integrator at a consistent state with its accelerations.
    pub fn new(
        model: &Model,
        start: &State,
        method: Method,
        goal: Goal,
    ) -> Result<Integrator, RuntimeError> {
        let plan = MatrixPlan::new(model);
        let radau = match method {
            Method::Radau => Some(Box::new(Radau::new(model, &plan.pattern))),
            Method::GeneralisedAlpha { .. } => None,
        };
        let solver = BlockLu::new(&plan.pattern);
        let size = plan.pattern.size();
        let mut scales = model.velocity_scales();
        let state_peak: Vec<f64> = start
            .states
            .iter()
            .zip(&model.state_scales)
            .map(|(y, scale)| y.abs().max(*scale))
            .collect();
        scales.extend(&state_peak);
        scales.extend(model.row_scales());
        let masses = model.bodies.iter().map(|b| b.width() * b.width()).sum();
        Ok(Integrator {
            coefficients: Coefficients::new(method.rho_infinity()),
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
            values: vec![0.0; plan.pattern.count()],
            plan,
            solver: Box::new(solver),
            factored_step: None,
            factored_values: false,
            contraction: None,
            secants: Secants::new(size),
            trial: vec![0.0; size],
            start_velocity: vec![0.0; model.velocities],
            start_auxiliary: vec![0.0; model.velocities],
            start_state_auxiliary: vec![0.0; model.states],
            next_auxiliary: vec![0.0; model.velocities],
            next_state_auxiliary: vec![0.0; model.states],
            residual: vec![0.0; size],
            delta: vec![0.0; size],
            correction: vec![0.0; size],
            plain: vec![0.0; size],
            taken: vec![0.0; size],
            scales,
            row_factors: vec![0.0; size],
            column_factors: vec![0.0; size],
            masses: vec![0.0; masses],
            masses_known: false,
            estimate: vec![0.0; model.velocities],
            governing: None,
            vibrations: vec![Vibration::default(); model.bodies.len()],
            radau,
        })
    }

    /// Starts `a` with the rate of the accelerations, `a₀ = v̇₀ + (α_m − α_f) h v̈₀`, and v with its part
    /// normal to the constraints. Both are stored for h = 1 s and rescaled for each step. `normal_jerk` is
    /// the part of v̈₀ normal to the constraints.
    pub fn start(
        &mut self,
        jerk: &[f64],
        normal_jerk: &[f64],
        multiplier_rate: &[f64],
        state_jerk: &[f64],
    ) {
        self.base_velocity.copy_from_slice(&self.current.velocity);
        self.renew(jerk, normal_jerk, multiplier_rate, state_jerk);
    }

    /// Sets `a` and the part of v normal to the constraints for another rate of the accelerations, as at the
    /// start. The velocity without that part must be known: see [`Integrator::set_defect`].
    pub fn renew(
        &mut self,
        jerk: &[f64],
        normal_jerk: &[f64],
        multiplier_rate: &[f64],
        state_jerk: &[f64],
    ) {
        let c = self.coefficients;
        if let Some(radau) = &mut self.radau {
            radau.begin_anew();
        }
        self.jerk.copy_from_slice(jerk);
        self.multiplier_rate.copy_from_slice(multiplier_rate);
        self.state_jerk.copy_from_slice(state_jerk);
        self.auxiliary_step = 1.0;
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

    /// Continues with the accelerations, multipliers and rates of another state at the same place. Their
    /// rates of change are zero. The velocity without its part normal to the constraints must be known: see
    /// [`Integrator::set_defect`].
    pub fn take_accelerations(&mut self, from: &State) {
        self.current
            .acceleration
            .copy_from_slice(&from.acceleration);
        self.current.multipliers.copy_from_slice(&from.multipliers);
        self.current.rates.copy_from_slice(&from.rates);
        let zeros = |count: usize| vec![0.0; count];
        let rates = zeros(self.jerk.len());
        let (of_rows, of_states) = (
            zeros(self.multiplier_rate.len()),
            zeros(self.state_jerk.len()),
        );
        self.renew(&rates, &rates, &of_rows, &of_states);
    }

    /// Sets the limits at which Newton's iteration ends.
    pub fn set_goal(&mut self, goal: Goal) {
        self.goal = goal;
    }

    /// Whether a step h needs [`Integrator::set_defect`] first, because it differs from the last step.
    pub fn needs_defect(&self, h: f64) -> bool {
        h != self.auxiliary_step && !self.defect_known && self.radau.is_none()
    }

    /// Sets the part of the current velocity that is normal to the constraints in the mass norm.
    ///
    /// The position constraint holds at every step although the update differs from the motion by `C h³ v̈`,
    /// where C is [`Coefficients::error`]. The velocity compensates for this along the constraints' normals,
    /// by `−C h² v̈`. When h changes, this part must change with h². Otherwise the multipliers take the
    /// difference and drop to first order. At the start this part comes from v̈₀: it is the perturbed
    /// starting velocity of Arnold, Cardona and Brüls (2016). The tangential part never changes.
    pub fn set_defect(&mut self, defect: &[f64]) {
        self.defect.copy_from_slice(defect);
        for (i, b) in self.base_velocity.iter_mut().enumerate() {
            *b = self.current.velocity[i] - defect[i];
        }
        self.defect_known = true;
    }

    /// The step to which the auxiliary accelerations belong (s).
    pub fn auxiliary_step(&self) -> f64 {
        self.auxiliary_step
    }

    /// Magnitudes of the states in the scaled system.
    pub fn state_scales(&self, model: &Model) -> &[f64] {
        &self.scales[model.velocities..model.velocities + model.states]
    }

    /// Updates the magnitude of every state that has become much larger than it. With the old magnitude,
    /// rounding would prevent the solution.
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
    /// With `smooth`, accelerations, multipliers and rates are extrapolated with their last rates of change.
    /// Otherwise they are kept constant.
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

    /// The end of the last trial.
    pub fn trial_state(&self) -> &State {
        &self.next
    }

    /// The end of the last trial.
    pub fn trial_state_mut(&mut self) -> &mut State {
        &mut self.next
    }

    /// The trial's unknowns (scaled).
    pub fn trial(&self) -> &[f64] {
        &self.trial
    }

    /// Computes positions, velocities, accelerations, states, their rates and multipliers at the trial of a
    /// step h.
    pub fn apply_trial(&mut self, model: &Model, h: f64) {
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

    /// Evaluates the scaled residual of a step h at the trial, after [`Integrator::predict`]. `demand` states how exactly
    /// fields are solved.
    pub fn evaluate(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
        demand: Demand,
    ) -> Result<(), RuntimeError> {
        self.apply_trial(model, h);
        self.next.time = self.current.time + h;
        self.evaluate_next(model, dynamics, demand)
    }

    /// Evaluates the scaled residual at the trial's state.
    fn evaluate_next(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        demand: Demand,
    ) -> Result<(), RuntimeError> {
        let (n, s) = (model.velocities, model.states);
        self.masses_known = false;
        self.statistics.residuals += 1;
        dynamics.place(model, self.next.time, &self.next.pose, &self.next.velocity);
        dynamics.gather(
            model,
            &self.next.states,
            &self.next.multipliers,
            &self.current.rotations,
        );
        dynamics.evaluate_for(model, demand)?;
        self.residual.fill(0.0);
        dynamics.add_inertia(
            model,
            &self.next.velocity,
            &self.next.acceleration,
            &mut self.residual[..n],
        );
        dynamics.add_forces(model, -1.0, &mut self.residual[..n]);
        for i in 0..s {
            self.residual[n + i] = self.next.rates[i] - dynamics.rates()[i];
        }
        self.residual[n + s..].copy_from_slice(dynamics.constraints());
        for (r, factor) in self.residual.iter_mut().zip(&self.row_factors) {
            *r *= factor;
        }
        Ok(())
    }

    /// Computes the mass matrices at the trial last evaluated.
    fn fill_masses(&mut self, model: &Model, dynamics: &mut Dynamics) {
        if self.masses_known {
            return;
        }
        self.masses.fill(0.0);
        let mut rest = self.masses.as_mut_slice();
        for (index, body) in model.bodies.iter().enumerate() {
            let (own, others) = rest.split_at_mut(body.width() * body.width());
            dynamics.add_mass(model, index, own);
            rest = others;
        }
        self.masses_known = true;
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
        self.secants.clear();
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

    /// Makes the trial the current state. `time` is the exact end of the step; a sum of steps would round
    /// differently.
    pub fn accept(&mut self, model: &Model, h: f64, time: f64) {
        let n = model.velocities;
        self.keep_stages(model, h);
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
