//! The method Radau IIA with three stages on the Lie group, for tight tolerances.
//!
//! A step from the time t to t + h has three stages at t + c_i h, of which the last one is its end. With the
//! matrix A of the method (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.8), the
//! stages fulfil the equations of motion and the constraints of positions,
//!
//! ```text
//! u_i = h Σ A_ij u̇_j      v_i = T(u_i) u̇_i      v_i = v₀ + h Σ A_ij v̇_j      y_i = y₀ + h Σ A_ij ẏ_j
//! q_i = q₀ ∘ exp(u_i)     M(q_i) v̇_i + G(q_i)ᵀ λ_i = Q(q_i, v_i, y_i)        ẏ_i = f(q_i, v_i, y_i)      Φ(q_i) = 0
//! ```
//!
//! u is the increment of the positions from the beginning of the step (rotation vectors in body axes) and T the
//! tangent operator of the exponential. All rates follow from the unknowns u_i, y_i and λ_i by the inverse of A.
//! The stages have the third order in velocities. The velocity at the end is brought back to `Φ̇ = 0`, and
//! accelerations and multipliers come from the balance at the end. Then all of them have the fifth order
//! (`tests/convergence.rs`).
//!
//! **Newton's method.** With the stiffness K (which includes G and Gᵀ), the damping D and the mass M of the second
//! stage the matrix is `A⁻² ⊗ M/h² + A⁻¹ ⊗ D/h + I ⊗ K`. The real basis `B` of the eigenvectors of A⁻¹ divides it
//! into one system with the real eigenvalue μ and one with the complex eigenvalue,
//!
//! ```text
//! (μ²/h² M + μ/h D + K) z = r
//! ```
//!
//! The complex system is solved as a real one of twice the size, in which each entry a + bi is the block
//! `[a, −b; b, a]`.
//!
//! **Local error.** The embedded formula of third order of the same book, for positions and velocities,
//! `e_q = (h v₀ + Σ d_i u_i)/μ`, `e_v = (h v̇₀ + Σ d_i (v_i − v₀))/μ`, filtered by the real system:
//! `S [e; ·] = [(μ²/h² M + μ/h D) e_q + μ/h M e_v; 0]`. It is an error of the embedded formula, so the result is far
//! more exact. The error of a step is of the fourth order.

use super::newton::STATE_SHARE;
use super::{Integrator, Trial};
use crate::body::Weights;
use crate::dynamics::Dynamics;
use crate::error::{Moment, RuntimeError};
use crate::field::Demand;
use crate::linear::{BlockLu, LinearSolver, Pattern, PatternBuilder};
use crate::model::{Model, STEP_SHARE};
use crate::rotation::{V3, inverse_tangent, tangent, tangent_along};
use crate::state::move_pose;

/// √6.
const ROOT: f64 = 2.449_489_742_783_178;
/// A.
const A: [[f64; 3]; 3] = [
    [
        (88.0 - 7.0 * ROOT) / 360.0,
        (296.0 - 169.0 * ROOT) / 1800.0,
        (-2.0 + 3.0 * ROOT) / 225.0,
    ],
    [
        (296.0 + 169.0 * ROOT) / 1800.0,
        (88.0 + 7.0 * ROOT) / 360.0,
        (-2.0 - 3.0 * ROOT) / 225.0,
    ],
    [(16.0 - ROOT) / 36.0, (16.0 + ROOT) / 36.0, 1.0 / 9.0],
];
/// A⁻¹.
const INVERSE: [[f64; 3]; 3] = [
    [
        2.0 + ROOT / 2.0,
        -1.2 + 29.0 * ROOT / 30.0,
        0.4 - 4.0 * ROOT / 15.0,
    ],
    [
        -1.2 - 29.0 * ROOT / 30.0,
        2.0 - ROOT / 2.0,
        0.4 + 4.0 * ROOT / 15.0,
    ],
    [-1.0 + 8.0 * ROOT / 3.0, -1.0 - 8.0 * ROOT / 3.0, 5.0],
];
/// c: the places of the stages in the step.
const NODES: [f64; 3] = [(4.0 - ROOT) / 10.0, (4.0 + ROOT) / 10.0, 1.0];
/// The real eigenvalue μ of A⁻¹, and the complex one.
const REAL: f64 = 3.637_834_252_744_496;
const COMPLEX: [f64; 2] = [2.681_082_873_627_752, 3.050_430_199_247_410_6];
/// The basis B of the eigenvectors, and its inverse: `B⁻¹ A⁻¹ B = [μ; α, −β; β, α]` with the complex eigenvalue α + βi.
const BASIS: [[f64; 3]; 3] = [
    [
        0.094_438_762_488_975_24,
        -0.141_255_295_020_954_2,
        -0.030_029_194_105_147_424,
    ],
    [
        0.250_213_122_965_333_3,
        0.204_129_352_293_799_93,
        0.382_942_112_757_261_9,
    ],
    [1.0, 1.0, 0.0],
];
const BASIS_INVERSE: [[f64; 3]; 3] = [
    [
        4.178_718_591_551_905,
        0.327_682_820_761_062_4,
        0.523_376_445_499_449_5,
    ],
    [
        -4.178_718_591_551_905,
        -0.327_682_820_761_062_4,
        0.476_623_554_500_550_45,
    ],
    [
        -0.502_872_634_945_786_9,
        2.571_926_949_855_605,
        -0.596_039_204_828_224_9,
    ],
];
/// d: the weights of the stages in the embedded formula.
const EMBEDDED: [f64; 3] = [
    (-13.0 - 7.0 * ROOT) / 3.0,
    (-13.0 + 7.0 * ROOT) / 3.0,
    -1.0 / 3.0,
];
/// The stages in the order of their evaluation. The second one is the last, because the matrix is filled there: it is the
/// one nearest to the middle of the step.
const ORDER: [usize; 3] = [0, 2, 1];
/// Most iterations of a step. A choice: at the limit of the contraction they win eight digits.
const ITERATIONS: usize = 12;
/// Contraction above which a kept matrix is made again. A choice: at 0.2 three iterations win two digits, and a fresh matrix
/// costs about as much as these three.
const RENEWAL: f64 = 0.2;
/// Contraction of a fresh matrix above which the step is too long. A choice: twelve iterations win less than four digits.
const FAILURE: f64 = 0.5;
/// Ratios of the step to that of the kept matrix between which the matrix serves. A choice, as for the generalised-α method.
const KEPT: std::ops::RangeInclusive<f64> = 0.6..=1.7;

/// Unknowns and rates of a stage.
#[derive(Clone, Debug)]
struct Stage {
    /// The increment u of the positions (m, rad), the change of the states from the beginning of the step (SI), and the
    /// multipliers (N, N m).
    unknowns: Vec<f64>,
    /// u̇.
    increment_rate: Vec<f64>,
    /// v.
    velocity: Vec<f64>,
    /// v̇.
    acceleration: Vec<f64>,
    /// ẏ.
    rates: Vec<f64>,
    /// The scaled residual.
    residual: Vec<f64>,
}

/// Accelerations, rates of states and multipliers of a stage of the step before.
#[derive(Clone, Debug)]
struct Before {
    acceleration: Vec<f64>,
    rates: Vec<f64>,
    multipliers: Vec<f64>,
}

/// The stages of a step, and the system with the complex eigenvalue.
#[derive(Debug)]
pub(super) struct Radau {
    stages: [Stage; 3],
    before: [Before; 3],
    /// The length of the step before (s); `None` if the motion begins anew.
    step_before: Option<f64>,
    solver: Box<dyn LinearSolver>,
    /// For each entry of the pattern, the four places of its block: row by row.
    places: Vec<[usize; 4]>,
    values: Vec<f64>,
    /// K, and the real and the imaginary part of the complex matrix.
    stiffness: Vec<f64>,
    parts: [Vec<f64>; 2],
    /// Right side and solution of the complex system.
    pairs: Vec<f64>,
    work: Vec<f64>,
}

impl Radau {
    pub fn new(model: &Model, pattern: &Pattern) -> Radau {
        let (n, s, m) = (model.velocities, model.states, model.rows);
        let stage = Stage {
            unknowns: vec![0.0; n + s + m],
            increment_rate: vec![0.0; n],
            velocity: vec![0.0; n],
            acceleration: vec![0.0; n],
            rates: vec![0.0; s],
            residual: vec![0.0; n + s + m],
        };
        let before = Before {
            acceleration: vec![0.0; n],
            rates: vec![0.0; s],
            multipliers: vec![0.0; m],
        };
        let mut builder = PatternBuilder::new(2 * pattern.size());
        for (_, row, column) in pattern.places() {
            builder.reserve(2 * row..2 * row + 2, 2 * column..2 * column + 2);
        }
        let doubled = builder.finish();
        let place = |row: usize, column: usize| doubled.place(row, column);
        let places = pattern.places().map(|(_, row, column)| {
            let (r, c) = (2 * row, 2 * column);
            [
                place(r, c),
                place(r, c + 1),
                place(r + 1, c),
                place(r + 1, c + 1),
            ]
        });
        Radau {
            stages: std::array::from_fn(|_| stage.clone()),
            before: std::array::from_fn(|_| before.clone()),
            step_before: None,
            places: places.collect(),
            values: vec![0.0; doubled.count()],
            solver: Box::new(BlockLu::new(&doubled)),
            stiffness: vec![0.0; pattern.count()],
            parts: std::array::from_fn(|_| vec![0.0; pattern.count()]),
            pairs: vec![0.0; 2 * pattern.size()],
            work: vec![0.0; pattern.size()],
        }
    }

    /// Forgets the step before: the next prediction begins with the present accelerations.
    pub fn begin_anew(&mut self) {
        self.step_before = None;
    }

    /// The numbers on which later steps depend, for a checkpoint: of the step before, and of the complex matrix.
    pub fn numbers(&self) -> Vec<f64> {
        let mut numbers = vec![self.step_before.unwrap_or_default()];
        for before in &self.before {
            numbers.extend(&before.acceleration);
            numbers.extend(&before.rates);
            numbers.extend(&before.multipliers);
        }
        numbers.extend(&self.values);
        numbers
    }

    /// Takes the numbers of a checkpoint. `factored` says whether the matrix has factors. Returns `false` if it cannot be
    /// factored.
    pub fn set_numbers(&mut self, numbers: &[f64], factored: bool) -> bool {
        let Some((step, mut rest)) = numbers.split_first() else {
            return false;
        };
        self.step_before = (*step > 0.0).then_some(*step);
        let lists = self.before.iter_mut().flat_map(|before| {
            let Before {
                acceleration,
                rates,
                multipliers,
            } = before;
            [acceleration, rates, multipliers]
        });
        for list in lists.chain([&mut self.values]) {
            let Some((own, others)) = rest.split_at_checked(list.len()) else {
                return false;
            };
            list.copy_from_slice(own);
            rest = others;
        }
        rest.is_empty() && (!factored || self.solver.factor(&self.values).is_ok())
    }

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

    /// Moves the accelerations of the stages to those of the step before.
    fn keep(&mut self, model: &Model, h: f64) {
        let first = model.velocities + model.states;
        for (before, stage) in self.before.iter_mut().zip(&self.stages) {
            before.acceleration.copy_from_slice(&stage.acceleration);
            before.rates.copy_from_slice(&stage.rates);
            before.multipliers.copy_from_slice(&stage.unknowns[first..]);
        }
        self.step_before = Some(h);
    }
}

/// Three numbers of a list.
fn vector(list: &[f64], first: usize) -> V3 {
    V3::new(list[first], list[first + 1], list[first + 2])
}

/// Weights of the three stages in the value of their parabola at a place x; the stages are at [`NODES`].
fn extrapolation(x: f64) -> [f64; 3] {
    std::array::from_fn(|i| {
        let others = (0..3).filter(|j| *j != i);
        others.fold(1.0, |product, j| {
            product * (x - NODES[j]) / (NODES[i] - NODES[j])
        })
    })
}

/// Sum of weights times values.
fn weighted(weights: &[f64; 3], values: [f64; 3]) -> f64 {
    weights.iter().zip(values).map(|(w, x)| w * x).sum()
}

impl Integrator {
    /// Whether steps are those of Radau IIA.
    pub fn is_radau(&self) -> bool {
        self.radau.is_some()
    }

    /// The order of the estimated error of a step in its length.
    pub fn error_order(&self) -> f64 {
        if self.is_radau() { 4.0 } else { 3.0 }
    }

    /// [`Integrator::try_step`] by Radau IIA. The caller completes the end of a solved trial
    /// ([`crate::simulation::Simulation`]).
    pub(super) fn try_radau(
        &mut self,
        radau: &mut Radau,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
        (tolerance, moment): (Option<f64>, Moment),
    ) -> Result<Trial, RuntimeError> {
        if self
            .factored_step
            .is_some_and(|old| !KEPT.contains(&(h / old)))
            || self.contraction.is_some_and(|c| c > RENEWAL)
        {
            self.drop_factors();
        }
        self.rescale_states(model);
        for i in 0..self.trial.len() {
            self.row_factors[i] = self.row_scale(model, i, h);
            self.column_factors[i] = self.column_scale(model, i, h);
        }
        self.predict_stages(radau, model, h);
        match self.iterate_stages(radau, model, dynamics, h) {
            Ok(true) => {}
            Ok(false) => {
                self.drop_factors();
                let stalled = self.stalled(model, h, moment);
                return Ok(Trial::Failed(Box::new(stalled)));
            }
            Err(RuntimeError::NotFinite {
                origin, because, ..
            }) => {
                self.drop_factors();
                return Ok(Trial::Failed(Box::new(RuntimeError::NotFinite {
                    origin,
                    because,
                    moment,
                })));
            }
            Err(error) => return Err(error),
        }
        let n = model.velocities;
        for i in 0..n {
            self.trial[i] = radau.stages[2].unknowns[i] / self.scales[i];
        }
        self.set_stage(radau, 2, model, h);
        let error = match tolerance {
            Some(factor) => self.error_of_stages(radau, model, dynamics, h, factor)?,
            None => 0.0,
        };
        Ok(Trial::Solved { error })
    }

    /// Predicts the stages of a step h: accelerations, rates and multipliers continue the parabola through the stages of the
    /// step before, or the line with their last rates of change.
    fn predict_stages(&mut self, radau: &mut Radau, model: &Model, h: f64) {
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
    fn set_stage(&mut self, radau: &Radau, index: usize, model: &Model, h: f64) {
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
        next.time = self.current.time + NODES[index] * h;
    }

    /// Newton's iteration. Returns whether it reached its goal.
    fn iterate_stages(
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

    /// The filtered error of the step's embedded formula, in units of the tolerance; see the head of this module.
    fn error_of_stages(
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
            radau.work[k] = REAL / h * (REAL / h * place + speed);
        }
        self.correction.fill(0.0);
        self.fill_masses(model, dynamics);
        let mut masses = self.masses.as_slice();
        for body in &model.bodies {
            let (width, first) = (body.width(), body.velocity);
            let (mass, others) = masses.split_at(width * width);
            masses = others;
            for (i, row) in mass.chunks_exact(width).enumerate() {
                let product = row.iter().zip(&radau.work[first..]).map(|(m, x)| m * x);
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

    /// Keeps the stages of the accepted step h for the next prediction.
    pub(super) fn keep_stages(&mut self, model: &Model, h: f64) {
        if let Some(radau) = &mut self.radau {
            radau.keep(model, h);
        }
    }
}

/// The second rate of a rotation vector θ with the rate w (rad/s) whose body has the angular acceleration a (rad/s², body axes):
/// `T(θ) ẅ = a − Ṫ w`.
pub(super) fn second_rate(theta: &V3, w: &V3, a: &V3) -> V3 {
    // `tangent_along` has the tangent of the other trivialisation, T(−θ)
    let turning = tangent_along(&-theta, w) * w;
    inverse_tangent(theta) * (a + turning)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_basis_divides_the_stages() {
        let product = |a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]| -> [[f64; 3]; 3] {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum())
            })
        };
        let near = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| {
            for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
                assert!((a - b).abs() < 1e-13, "{a} and not {b}");
            }
        };
        let one = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        near(product(&A, &INVERSE), one);
        near(product(&BASIS, &BASIS_INVERSE), one);
        let [a, b] = COMPLEX;
        let divided = [[REAL, 0.0, 0.0], [0.0, a, -b], [0.0, b, a]];
        near(product(&BASIS_INVERSE, &product(&INVERSE, &BASIS)), divided);
        for (row, node) in A.iter().zip(NODES) {
            assert!((row.iter().sum::<f64>() - node).abs() < 1e-15);
        }
    }

    #[test]
    fn the_second_rate_is_that_of_a_difference() {
        // θ(t) with constant second rate: the angular velocity is T(θ) θ̇
        let (theta, w, second) = (
            V3::new(0.3, -0.2, 0.5),
            V3::new(1.0, 2.0, -0.7),
            V3::new(0.4, 0.1, 0.9),
        );
        let speed = |t: f64| {
            let at = theta + w * t + second * (0.5 * t * t);
            tangent(&at) * (w + second * t)
        };
        let e = 1e-4;
        let a = (speed(e) - speed(-e)) / (2.0 * e);
        let found = second_rate(&theta, &w, &a);
        assert!((found - second).norm() < 1e-7, "{found:?}");
    }
}
