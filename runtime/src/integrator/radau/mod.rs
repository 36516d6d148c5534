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
//! (`tests/radau.rs`).
//!
//! This module has a trial step, and what later steps need of it. `stages` solves for the stages, `error` estimates the
//! error of the step, and `work` sums up its work.

pub(crate) mod coefficients;
mod error;
mod stages;
mod work;

use super::{Integrator, Trial};
use crate::dynamics::Dynamics;
use crate::error::{Moment, RuntimeError};
use crate::linear::{BlockLu, LinearSolver, Pattern, PatternBuilder};
use crate::model::Model;

/// Contraction above which a kept matrix is made again. A choice: at 0.2 three iterations win two digits, and a fresh matrix
/// costs about as much as these three.
const RENEWAL: f64 = 0.2;
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
    /// A list of the velocities' length.
    scratch: Vec<f64>,
    /// The share of the first two stages in the work of the loads and of the constraints, and in the loss in flexible bodies
    /// (J), of the last solved step.
    inner_work: [f64; 3],
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
            scratch: vec![0.0; n],
            inner_work: [0.0; 3],
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

    /// Keeps the stages of the accepted step h for the next prediction.
    pub(super) fn keep_stages(&mut self, model: &Model, h: f64) {
        if let Some(radau) = &mut self.radau {
            radau.keep(model, h);
        }
    }
}
