//! The derivative of a step by a parameter.
//!
//! A step from x to x' solves `R(x', x, p) = 0`, so that `A δx' = −(∂R/∂x δx + ∂R/∂p)` with the matrix A of
//! Newton's iteration (O. Brüls, P. Eberhard, Int. J. Numer. Meth. Engng 74 (2008) 1889). The residual
//! depends on the beginning x of a step through the recurrences of the scheme alone. So a first guess of δx'
//! follows from the derivatives of the recurrences, with δv̇, δλ and δẏ as they were at the beginning.
//! Corrections c remove the derivative ρ of the residual that the guess leaves,
//!
//! ```text
//! ρ = K [δq'; δy'; δλ'] + D δv' + M δv̇' + [0; δẏ'; 0] + ∂R/∂p      A c = −ρ
//! ```
//!
//! with the exact blocks K, D and M at the end of the step. A correction of an increment changes `δq'` by `T(u) c`, `δv'` and
//! `δv̇'` by the weights of the step. Increments and `δq` are in body axes for rotations.

use super::Integrator;
use crate::body::Weights;
use crate::dynamics::{Dynamics, MatrixPlan};
use crate::error::RuntimeError;
use crate::linear::{Block, BlockLu, LinearSolver};
use crate::model::Model;
use crate::rotation::{V3, exponential, logarithm, matrix, product, tangent};
use crate::state::{State, move_pose, offset_into};
use eng_system::dense::add_scaled;
use eng_system::significant::short;

/// Corrections of a derivative: the first is exact except for rounding, which the second removes.
const CORRECTIONS: usize = 2;

/// Derivatives by a parameter of all numbers that one step passes to the next one.
#[derive(Clone, Debug, Default)]
pub struct Variation {
    /// δq: displacements (ground axes), rotations (body axes), modal amplitudes.
    pub place: Vec<f64>,
    /// δv.
    pub velocity: Vec<f64>,
    /// δv̇.
    pub acceleration: Vec<f64>,
    /// δa of the auxiliary accelerations a of the scheme.
    pub auxiliary: Vec<f64>,
    /// The derivative of the part of the velocity that violates the constraints; see
    /// [`Integrator::set_defect`].
    pub defect: Vec<f64>,
    /// δy of the states.
    pub states: Vec<f64>,
    /// δẏ.
    pub rates: Vec<f64>,
    /// The derivatives of the auxiliary rates of the states.
    pub state_auxiliary: Vec<f64>,
    /// δλ.
    pub multipliers: Vec<f64>,
}

impl Variation {
    /// Derivatives that are all zero.
    pub fn new(model: &Model) -> Variation {
        let (n, s) = (vec![0.0; model.velocities], vec![0.0; model.states]);
        Variation {
            place: n.clone(),
            velocity: n.clone(),
            acceleration: n.clone(),
            auxiliary: n.clone(),
            defect: n,
            states: s.clone(),
            rates: s.clone(),
            state_auxiliary: s,
            multipliers: vec![0.0; model.rows],
        }
    }

    /// Adds a share of the difference of an integrator's numbers from those of another one.
    pub fn add_difference(
        &mut self,
        model: &Model,
        of: &Integrator,
        from: &Integrator,
        share: f64,
    ) {
        let (to, at) = (&of.current, &from.current);
        let mut move_between = vec![0.0; model.velocities];
        offset_into(model, &at.pose, &to.pose, &mut move_between);
        let differences = [
            (&mut self.velocity, &to.velocity, &at.velocity),
            (&mut self.acceleration, &to.acceleration, &at.acceleration),
            (&mut self.auxiliary, &of.auxiliary, &from.auxiliary),
            (&mut self.defect, &of.defect, &from.defect),
            (&mut self.states, &to.states, &at.states),
            (&mut self.rates, &to.rates, &at.rates),
            (
                &mut self.state_auxiliary,
                &of.state_auxiliary,
                &from.state_auxiliary,
            ),
            (&mut self.multipliers, &to.multipliers, &at.multipliers),
        ];
        for (sum, a, b) in differences {
            for (sum, (a, b)) in sum.iter_mut().zip(a.iter().zip(b)) {
                *sum += share * (a - b);
            }
        }
        // `move_between` is a rotation vector: near zero it is a change in body axes
        add_scaled(&mut self.place, share, &move_between);
    }

    /// Adds a multiple of other derivatives of the same state.
    pub fn add(&mut self, factor: f64, other: &Variation) {
        let pairs = [
            (&mut self.place, &other.place),
            (&mut self.velocity, &other.velocity),
            (&mut self.acceleration, &other.acceleration),
            (&mut self.auxiliary, &other.auxiliary),
            (&mut self.defect, &other.defect),
            (&mut self.states, &other.states),
            (&mut self.rates, &other.rates),
            (&mut self.state_auxiliary, &other.state_auxiliary),
            (&mut self.multipliers, &other.multipliers),
        ];
        for (sum, x) in pairs {
            add_scaled(sum, factor, x);
        }
    }

    /// A state moved by a multiple of the derivative.
    pub fn moved(&self, model: &Model, from: &State, factor: f64, out: &mut State) {
        out.copy_from(from);
        move_pose(model, &from.pose, &self.place, factor, &mut out.pose);
        let changes = [
            (&mut out.velocity, &self.velocity),
            (&mut out.acceleration, &self.acceleration),
            (&mut out.states, &self.states),
            (&mut out.rates, &self.rates),
            (&mut out.multipliers, &self.multipliers),
        ];
        for (numbers, change) in changes {
            add_scaled(numbers, factor, change);
        }
    }
}

/// The exact matrices at the end of the last step.
#[derive(Debug)]
pub struct StepDerivative {
    plan: MatrixPlan,
    solver: Box<dyn LinearSolver>,
    bodies: Vec<Block>,
    /// K: the derivative by positions, states and multipliers.
    place: Vec<f64>,
    /// D times the weight of the velocities.
    velocity: Vec<f64>,
    /// A with the factors of rows and columns.
    matrix: Vec<f64>,
    /// Mass matrices of the bodies, one after the other.
    masses: Vec<f64>,
    row_factors: Vec<f64>,
    column_factors: Vec<f64>,
    weights: Weights,
    state_weight: f64,
    unknowns: Vec<f64>,
    product: Vec<f64>,
    rest: Vec<f64>,
}

impl StepDerivative {
    /// The matrices of a model, not yet filled.
    pub fn new(model: &Model) -> StepDerivative {
        let plan = MatrixPlan::new(model);
        let (size, count) = (plan.pattern.size(), plan.pattern.count());
        let bodies = model.bodies.iter();
        let masses = bodies.clone().map(|b| b.width() * b.width()).sum();
        StepDerivative {
            solver: Box::new(BlockLu::new(&plan.pattern)),
            bodies: bodies
                .map(|b| {
                    plan.pattern
                        .block(b.velocity, b.velocity..b.velocity + b.width())
                })
                .collect(),
            plan,
            place: vec![0.0; count],
            velocity: vec![0.0; count],
            matrix: vec![0.0; count],
            masses: vec![0.0; masses],
            row_factors: vec![0.0; size],
            column_factors: vec![0.0; size],
            weights: Weights {
                acceleration: 0.0,
                velocity: 1.0,
            },
            state_weight: 0.0,
            unknowns: vec![0.0; size],
            product: vec![0.0; size],
            rest: vec![0.0; size],
        }
    }

    /// Makes the matrices at the end of the last accepted step h (s), at which `dynamics` is evaluated.
    ///
    /// # Errors
    /// Derivatives that are not finite; a matrix without factors.
    pub fn make(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        step: &Integrator,
        h: f64,
    ) -> Result<(), RuntimeError> {
        let n = model.velocities;
        self.weights = step.coefficients.weights(h);
        self.state_weight = step.coefficients.state_weight(h);
        self.row_factors.copy_from_slice(&step.row_factors);
        self.column_factors.copy_from_slice(&step.column_factors);
        let (v, a) = (&step.current.velocity, &step.current.acceleration);
        let still = vec![0.0; n];
        let mut weights = Weights {
            acceleration: 0.0,
            velocity: 0.0,
        };
        self.plan
            .fill(model, dynamics, v, a, &still, weights, 0.0, &mut self.place)?;
        weights.velocity = self.weights.velocity;
        self.plan.fill(
            model,
            dynamics,
            v,
            a,
            &still,
            weights,
            0.0,
            &mut self.velocity,
        )?;
        self.matrix.copy_from_slice(&self.velocity);
        for (with, without) in self.velocity.iter_mut().zip(&self.place) {
            *with -= without;
        }
        self.masses.fill(0.0);
        let mut rest = self.masses.as_mut_slice();
        for (index, (body, block)) in model.bodies.iter().zip(&self.bodies).enumerate() {
            let (own, others) = rest.split_at_mut(body.width() * body.width());
            dynamics.add_mass(model, index, own);
            block.add(&mut self.matrix, own, self.weights.acceleration);
            rest = others;
        }
        for body in &model.bodies {
            self.turn_columns(body.velocity + 3, &step.increment);
        }
        let pattern = &self.plan.pattern;
        for k in n..n + model.states {
            self.matrix[pattern.place(k, k)] += self.state_weight;
        }
        self.plan
            .runs
            .scale(&mut self.matrix, &self.row_factors, &self.column_factors);
        let factored = self.solver.factor(&self.matrix);
        factored.map_err(|_| RuntimeError::Options {
            message: format!(
                "the gradients end at {} s: the matrix of this step is singular, so the motion has no derivative by a parameter; \
                 end the run before that, or leave out `gradients`",
                short(step.current.time, 6)
            ),
        })
    }

    /// Changes the columns of a body's rotation from `δq'` to the increment u: `K T(u) − K` is added.
    fn turn_columns(&mut self, first: usize, increment: &[f64]) {
        let turn = tangent(&V3::new(
            increment[first],
            increment[first + 1],
            increment[first + 2],
        ));
        let pattern = &self.plan.pattern;
        // the three columns have the same rows
        for row in pattern.rows_of(first) {
            let places = [0, 1, 2].map(|i| pattern.place(*row, first + i));
            for j in 0..3 {
                let turned: f64 = (0..3).map(|i| self.place[places[i]] * turn[(i, j)]).sum();
                self.matrix[places[j]] += turned - self.place[places[j]];
            }
        }
    }

    /// The derivative at the end of the last step h (s), from the derivative `old` at its beginning.
    /// `partial` is ∂R/∂p (N, N m, rates of states, m, rad) at the end. `ratio` is h over the step of the old
    /// auxiliary numbers. `old.velocity` includes the change of its part normal to the constraints.
    pub fn advance(
        &mut self,
        model: &Model,
        step: &Integrator,
        (h, ratio): (f64, f64),
        old: &Variation,
        partial: &[f64],
    ) -> Variation {
        let c = step.coefficients;
        let (n, s) = (model.velocities, model.states);
        let mut new = Variation::new(model);
        let mut increment = vec![0.0; n];
        for i in 0..n {
            let dot = old.acceleration[i];
            let a = dot + ratio * (old.auxiliary[i] - dot);
            let next = (dot - c.alpha_m * a) / (1.0 - c.alpha_m);
            new.acceleration[i] = dot;
            new.auxiliary[i] = next;
            increment[i] = h * old.velocity[i] + h * h * ((0.5 - c.beta) * a + c.beta * next);
            new.velocity[i] = old.velocity[i] + h * ((1.0 - c.gamma) * a + c.gamma * next);
        }
        for i in 0..s {
            let dot = old.rates[i];
            let w = dot + ratio * (old.state_auxiliary[i] - dot);
            let next = (dot - c.state_alpha_m * w) / (1.0 - c.state_alpha_m);
            new.rates[i] = dot;
            new.state_auxiliary[i] = next;
            new.states[i] = old.states[i] + h * ((1.0 - c.state_gamma) * w + c.state_gamma * next);
        }
        new.multipliers.copy_from_slice(&old.multipliers);
        carry(
            model,
            &step.increment,
            &old.place,
            &increment,
            &mut new.place,
        );
        let still = vec![0.0; n];
        for _ in 0..CORRECTIONS {
            self.residual(model, &new, partial);
            for (x, factor) in self.rest.iter_mut().zip(&self.row_factors) {
                *x *= -factor;
            }
            self.solver.solve(&mut self.rest);
            for (x, factor) in self.rest.iter_mut().zip(&self.column_factors) {
                *x *= factor;
            }
            let (changes, others) = self.rest.split_at(n);
            let (states, multipliers) = others.split_at(s);
            let place = new.place.clone();
            carry(model, &step.increment, &still, changes, &mut new.place);
            add_scaled(&mut new.place, 1.0, &place);
            add_scaled(&mut new.velocity, self.weights.velocity, changes);
            add_scaled(&mut new.acceleration, self.weights.acceleration, changes);
            add_scaled(&mut new.auxiliary, 1.0 / (c.beta * h * h), changes);
            add_scaled(&mut new.states, 1.0, states);
            add_scaled(&mut new.rates, self.state_weight, states);
            add_scaled(&mut new.state_auxiliary, 1.0 / (c.state_gamma * h), states);
            add_scaled(&mut new.multipliers, 1.0, multipliers);
        }
        new
    }

    /// The derivative ρ of the residual, into `rest`.
    fn residual(&mut self, model: &Model, new: &Variation, partial: &[f64]) {
        let (n, s) = (model.velocities, model.states);
        let pattern = &self.plan.pattern;
        self.unknowns[..n].copy_from_slice(&new.place);
        self.unknowns[n..n + s].copy_from_slice(&new.states);
        self.unknowns[n + s..].copy_from_slice(&new.multipliers);
        pattern.multiply(&self.place, &self.unknowns, &mut self.rest);
        self.unknowns.fill(0.0);
        for (x, v) in self.unknowns.iter_mut().zip(&new.velocity) {
            *x = v / self.weights.velocity;
        }
        pattern.multiply(&self.velocity, &self.unknowns, &mut self.product);
        add_scaled(&mut self.rest, 1.0, &self.product);
        add_scaled(&mut self.rest, 1.0, partial);
        add_scaled(&mut self.rest[n..n + s], 1.0, &new.rates);
        let mut masses = self.masses.as_slice();
        for body in &model.bodies {
            let (v, width) = (body.velocity, body.width());
            let (mass, others) = masses.split_at(width * width);
            masses = others;
            for (i, row) in mass.chunks_exact(width).enumerate() {
                let product: f64 = row
                    .iter()
                    .zip(&new.acceleration[v..])
                    .map(|(m, a)| m * a)
                    .sum();
                self.rest[v + i] += product;
            }
        }
    }

    /// The least change x of the velocities with `G x = rates`, in the measure of the step's matrix: see
    /// [`Integrator::nearest_change`].
    pub fn nearest_change(&mut self, model: &Model, rates: &[f64], out: &mut [f64]) {
        let (n, first) = (model.velocities, model.velocities + model.states);
        self.rest.fill(0.0);
        for (i, rate) in rates.iter().enumerate() {
            self.rest[first + i] = rate * self.row_factors[first + i];
        }
        self.solver.solve(&mut self.rest);
        for (x, (y, factor)) in out
            .iter_mut()
            .zip(self.rest[..n].iter().zip(&self.column_factors))
        {
            *x = y * factor;
        }
    }
}

/// The change of the pose `q ∘ exp(u)` for changes of q and u (rotations: `exp(−u) δq + T(u) δu`).
fn carry(model: &Model, increment: &[f64], place: &[f64], change: &[f64], out: &mut [f64]) {
    for (out, (place, change)) in out.iter_mut().zip(place.iter().zip(change)) {
        *out = place + change;
    }
    for body in &model.bodies {
        let k = body.velocity + 3;
        let vector = |from: &[f64]| V3::new(from[k], from[k + 1], from[k + 2]);
        let u = vector(increment);
        let back = matrix(&exponential(&-u));
        let turned = back * vector(place) + tangent(&u) * vector(change);
        out[k..k + 3].copy_from_slice(turned.as_slice());
    }
}

impl Integrator {
    /// The derivatives by time of all numbers that the last step passes on, at its beginning and at its end. Those of
    /// accelerations, multipliers and rates are the differences over the step.
    pub fn rates_of_change(&self, model: &Model) -> [Variation; 2] {
        [&self.previous, &self.current].map(|state| Variation {
            place: state.velocity.clone(),
            velocity: state.acceleration.clone(),
            acceleration: self.jerk.clone(),
            auxiliary: self.jerk.clone(),
            states: state.rates.clone(),
            rates: self.state_jerk.clone(),
            state_auxiliary: self.state_jerk.clone(),
            multipliers: self.multiplier_rate.clone(),
            ..Variation::new(model)
        })
    }

    /// Takes the last step of another integrator, with both ends moved by a multiple of derivatives there.
    pub fn stand_beside(
        &mut self,
        model: &Model,
        step: &Integrator,
        [before, now]: [&Variation; 2],
        factor: f64,
    ) {
        before.moved(model, &step.previous, factor, &mut self.previous);
        now.moved(model, &step.current, factor, &mut self.current);
        if factor == 0.0 {
            self.increment.copy_from_slice(&step.increment);
            return;
        }
        // exp(u*) = exp(−δq) exp(u) exp(δq'): only the changes are rounded, not u
        for body in &model.bodies {
            let v = body.velocity;
            for i in 0..body.width() {
                let change = now.place[v + i] - before.place[v + i];
                self.increment[v + i] = step.increment[v + i] + factor * change;
            }
            let vector = |from: &[f64]| V3::new(from[v + 3], from[v + 4], from[v + 5]);
            let u = vector(&step.increment);
            let from = exponential(&(vector(&before.place) * -factor));
            let to = exponential(&(vector(&now.place) * factor));
            let moved = logarithm(&product(&product(&from, &exponential(&u)), &to));
            self.increment[v + 3..v + 6].copy_from_slice(moved.as_slice());
        }
    }

    /// Exchanges the kept factors with another integrator of the same pattern. The other one also takes the
    /// scales. A second call gives the factors back.
    pub fn exchange_factors(&mut self, other: &mut Integrator) {
        std::mem::swap(&mut self.solver, &mut other.solver);
        std::mem::swap(&mut self.factored_step, &mut other.factored_step);
        other.scales.copy_from_slice(&self.scales);
    }
}
