//! The acceleration-level system `[M Gᵀ; G 0][v̇; λ] = [Q; γ]` and the projections on position and velocity.
//!
//! All three have one matrix. With `[0; −Φ]` it gives the smallest move (in the mass norm) back to the
//! constraints, and with `[0; −Φ̇]` the smallest change of velocity. It is scaled like the step's matrix,
//! with the model's length and largest mass.
//!
//! **Outputs of a step.** The integrator's velocity violates `Φ̇ = 0` by `C h² v̈` along the constraints'
//! normals (see [`crate::integrator::Integrator::set_defect`]). Its equations of motion hold at that
//! velocity. Only there are its forces of second order without a large factor. The change x back to the
//! constraints is microns per second beside metres per second. But a film of damping d responds to it with
//! the force d x. Relative to the mass m that the film carries, this is an error of d/m x in the
//! acceleration, and d/m is 10⁵ to 10⁷ 1/s in a bearing.
//!
//! So loads use the velocity of the integrator. γ, the inertia of the motion and all recorded values use the
//! projected velocity. The matrix of the step, which contains the films, gives most of x
//! ([`crate::integrator::Integrator::nearest_change`]). So the recorded forces of the films are those in the
//! balance.

use crate::dynamics::Dynamics;
use crate::error::{Moment, RuntimeError};
use crate::integrator::Integrator;
use crate::linear::{Block, BlockLu, LinearSolver, Pattern, PatternBuilder};
use crate::model::Model;
use crate::state::{State, move_pose};
use crate::topology::undetermined;
use eng_system::dense::largest_scaled;
use nalgebra::DMatrix;

/// Largest |Φ| of an output, in m or rad. A choice: less than a nanometre is below every tolerance of
/// positions of a machine.
pub const POSITION_LIMIT: f64 = 1e-9;
/// Largest |Φ| (m or rad) at which the projection ends. A choice: about ten thousand roundings of a position
/// of a metre. If rounding is larger, [`POSITION_LIMIT`] counts after three corrections.
const POSITION_GOAL: f64 = 1e-12;
/// Most corrections of a position. A choice: after half of them the matrix is made again, so the other half
/// is Newton's method again.
const ATTEMPTS: usize = 12;
/// Most corrections of a velocity: the first hardly changes the films, and two more leave only rounding.
const VELOCITY_ROUNDS: usize = 6;
/// Largest |Φ̇| after the corrections, as a share of that before them. A choice: what is left is then far
/// below the error of the step that caused it.
const VELOCITY_GOAL: f64 = 1e-9;
/// Rounding of Φ̇, as a share of the model's speed: both are scaled to 1/s. A choice: about ten thousand
/// rounding units, because Φ̇ is a sum over links.
const VELOCITY_ROUNDING: f64 = 1e-12;
/// Distance of positions, as a share of the model's length or in rad, within which one matrix serves:
/// accelerations and multipliers then have errors of this share. A choice far below the error of a step.
const HERE: f64 = 1e-10;
/// Most refinements of a solution with the factors of a nearby position. A choice: each must win a digit, and
/// more of them would cost more than a new matrix.
const REFINEMENTS: usize = 6;
/// Largest change of a refinement as a part of the change before. One that wins less than a digit costs more than
/// a new matrix does over the others, or shows that only rounding is left. A choice.
const SETTLING: f64 = 0.1;
/// Change of a refinement, as a share of the solution, at which it may stagnate: refinements end at the rounding
/// of the matrix times its condition, and twelve digits are enough for an output. A choice.
const SETTLED: f64 = 1e-12;
/// Change of a refinement, as a share of the solution, that is rounding: some units of the last place.
const ROUNDING: f64 = 1e-15;
/// Corrections of a position and of accelerations beside a state that has both. Corrections with the factors
/// of this state leave a power of the factors' error, and a part of second order in the distance, which
/// changes no derivative. The last correction of a position removes rounding.
const BESIDE: (usize, usize) = (3, 2);

/// The factors for the projection of positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Factors {
    /// Made at the given state; [`AccelerationSystem::finish`] needs them.
    Made,
    /// The factors of the call before, which was at a nearby position.
    Kept,
    /// Made at the given state if its positions must move.
    IfNeeded,
}

/// The system with its factors.
#[derive(Debug)]
pub struct AccelerationSystem {
    pattern: Pattern,
    bodies: Vec<Block>,
    /// The places of the entries of Gᵀ, each with that of the same entry of G.
    transposed: Vec<[usize; 2]>,
    values: Vec<f64>,
    solver: Box<dyn LinearSolver>,
    rhs: Vec<f64>,
    mass: Vec<f64>,
    scales: Vec<f64>,
    moved: Vec<f64>,
    zeros: Vec<f64>,
    /// −Q: the forces and the velocity-dependent part of the inertia.
    forces: Vec<f64>,
    wanted_rates: Vec<f64>,
    change: Vec<f64>,
    wanted: Vec<f64>,
    correction: Vec<f64>,
    /// Whether the matrix belongs to a later position than its factors.
    stale: bool,
    /// The position of the factors.
    pose: Vec<f64>,
    /// Whether the states lie beside a state with factors: see [`AccelerationSystem::stand_beside`].
    beside: bool,
    /// The scaled accelerations and multipliers that were solved last.
    solved: Vec<f64>,
}

impl AccelerationSystem {
    /// Plans the system of a model and analyses its pattern.
    pub fn new(model: &Model) -> Result<AccelerationSystem, RuntimeError> {
        let size = model.velocities + model.rows;
        let mut builder = PatternBuilder::new(size);
        for body in &model.bodies {
            let range = body.velocity..body.velocity + body.width();
            builder.reserve(range.clone(), range);
        }
        for element in model.elements.iter().filter(|e| e.dynamic) {
            let count = model.compiled.system.classes[element.class].rows.len();
            let rows = model.velocities + element.row..model.velocities + element.row + count;
            for b in element
                .markers
                .iter()
                .filter_map(|m| model.markers[*m].body)
            {
                let body = &model.bodies[b];
                let range = body.velocity..body.velocity + body.width();
                builder.reserve(rows.clone(), range.clone());
                builder.reserve(range, rows.clone());
            }
        }
        let pattern = builder.finish();
        let bodies = model
            .bodies
            .iter()
            .map(|b| pattern.block(b.velocity, b.velocity..b.velocity + b.width()))
            .collect();
        let n = model.velocities;
        let transposed = pattern
            .places()
            .filter(|(_, row, column)| *row < n && *column >= n)
            .map(|(from, row, column)| [from, pattern.place(column, row)])
            .collect();
        let solver = BlockLu::new(&pattern);
        let mut scales = model.velocity_scales();
        scales.extend(model.row_scales().iter().map(|s| 1.0 / s));
        let width = model.bodies.iter().map(|b| b.width()).max().unwrap_or(0);
        Ok(AccelerationSystem {
            values: vec![0.0; pattern.count()],
            solver: Box::new(solver),
            rhs: vec![0.0; size],
            mass: vec![0.0; width * width],
            scales,
            moved: vec![0.0; model.poses],
            zeros: vec![0.0; model.velocities],
            forces: vec![0.0; model.velocities],
            wanted_rates: vec![0.0; model.rows],
            change: vec![0.0; model.velocities],
            wanted: vec![0.0; size],
            correction: vec![0.0; size],
            stale: false,
            pose: vec![0.0; model.poses],
            beside: false,
            solved: vec![0.0; size],
            pattern,
            bodies,
            transposed,
        })
    }

    /// From now on every state lies beside a state of another system, whose factors and solution
    /// [`AccelerationSystem::exchange_factors`] gives. Projections and accelerations then have a fixed number
    /// of corrections. So they are smooth in the distance of the states, and have the derivatives of exact
    /// solutions.
    pub fn stand_beside(&mut self) {
        self.beside = true;
    }

    /// Exchanges the factors with the system of a model of the same pattern, which also takes the scales. A
    /// second call gives the factors back. The other system solves with them by refinement, because they
    /// belong to a nearby position. If the refinement does not converge, it makes factors anew. So no factors
    /// serve a later position unless they are made there.
    pub fn exchange_factors(&mut self, other: &mut AccelerationSystem) {
        std::mem::swap(&mut self.solver, &mut other.solver);
        other.scales.copy_from_slice(&self.scales);
        other.solved.copy_from_slice(&self.solved);
        other.stale = true;
    }

    /// Makes the factors at the position of `dynamics`, and evaluates the gradients there.
    fn factor(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        moment: Moment,
    ) -> Result<(), RuntimeError> {
        self.fill(model, dynamics)?;
        self.stale = false;
        self.pose.copy_from_slice(dynamics.pose());
        let factored = self.solver.factor(&self.values);
        factored.map_err(|_| self.undetermined(model, moment))
    }

    /// Whether a position differs from that of the matrix by so little that the matrix serves.
    fn is_here(&self, model: &Model, pose: &[f64]) -> bool {
        !self.stale
            && model.bodies.iter().all(|body| {
                let near = |i: usize, size: f64| (pose[i] - self.pose[i]).abs() <= HERE * size;
                let (p, v) = (body.pose, body.velocity);
                (0..3).all(|i| near(p + i, model.length))
                    && (3..7).all(|i| near(p + i, 1.0))
                    && (0..body.modes()).all(|i| near(p + 7 + i, self.scales[v + 6 + i]))
            })
    }

    /// The error for a matrix without factors.
    fn undetermined(&self, model: &Model, moment: Moment) -> RuntimeError {
        let n = model.velocities;
        let mut gradients = DMatrix::zeros(model.rows, n);
        for (row, column, value) in self.pattern.entries(&self.values) {
            if row >= n && column < n {
                gradients[(row - n, column)] = value;
            }
        }
        undetermined(model, &gradients, moment)
    }

    /// Fills the matrix at the position of `dynamics`. The factors remain those of an earlier position.
    fn fill(&mut self, model: &Model, dynamics: &mut Dynamics) -> Result<(), RuntimeError> {
        self.stale = true;
        dynamics.constraint_gradients(model)?;
        self.values.fill(0.0);
        for (index, (body, block)) in model.bodies.iter().zip(&self.bodies).enumerate() {
            let mass = &mut self.mass[..body.width() * body.width()];
            mass.fill(0.0);
            dynamics.add_mass(model, index, mass);
            block.add(
                &mut self.values,
                mass,
                1.0 / (model.mass * model.length * model.length),
            );
        }
        let offset = model.velocities;
        let (pattern, values) = (&self.pattern, &mut self.values);
        // the entries of a body stand one after the other in a column of Gᵀ
        dynamics.body_gradients(model, |row, first, line| {
            let begin = pattern.place(first, offset + row);
            for (value, g) in values[begin..].iter_mut().zip(line) {
                *value += g;
            }
        });
        for [from, to] in &self.transposed {
            self.values[*to] = self.values[*from];
        }
        for (place, row, column) in self.pattern.places() {
            self.values[place] *= self.scales[column] * self.scales[row];
        }
        Ok(())
    }

    /// Solves with `self.rhs` (velocity rows scaled by s/(m L²), constraint rows by 1/s); returns scaled
    /// unknowns there.
    ///
    /// Factors of a nearby position serve, with refinement against the present matrix. If the refinement does
    /// not converge quickly, the matrix is factored.
    fn solve(&mut self, model: &Model, moment: Moment) -> Result<(), RuntimeError> {
        if !self.stale {
            self.solver.solve(&mut self.rhs);
            return Ok(());
        }
        self.wanted.copy_from_slice(&self.rhs);
        self.solver.solve(&mut self.rhs);
        let mut last = f64::INFINITY;
        for _ in 0..REFINEMENTS {
            let [size, change] = self.refine();
            if change <= ROUNDING * size {
                return Ok(());
            }
            let settling = change < SETTLING * last;
            if !settling {
                // either only rounding is left, or the factors belong to a position too far away
                if change <= SETTLED * size {
                    return Ok(());
                }
                break;
            }
            last = change;
        }
        let factored = self.solver.factor(&self.values);
        factored.map_err(|_| self.undetermined(model, moment))?;
        self.stale = false;
        self.rhs.copy_from_slice(&self.wanted);
        self.solver.solve(&mut self.rhs);
        Ok(())
    }

    /// Corrects `self.rhs`, a solution for `self.wanted`, once by the factors. Returns the largest unknown and the largest change.
    fn refine(&mut self) -> [f64; 2] {
        self.pattern
            .multiply(&self.values, &self.rhs, &mut self.correction);
        for (c, w) in self.correction.iter_mut().zip(&self.wanted) {
            *c = w - *c;
        }
        self.solver.solve(&mut self.correction);
        let (mut size, mut change) = (0.0_f64, 0.0_f64);
        for (x, c) in self.rhs.iter_mut().zip(&self.correction) {
            *x += c;
            size = size.max(x.abs());
            change = change.max(c.abs());
        }
        [size, change]
    }

    /// Solves with `self.rhs` by corrections of the solution beside it. Returns `false` and leaves `self.rhs` if these do not
    /// become small quickly.
    fn correct_solved(&mut self) -> bool {
        self.wanted.copy_from_slice(&self.rhs);
        self.rhs.copy_from_slice(&self.solved);
        let mut last = f64::INFINITY;
        for _ in 0..BESIDE.1 {
            let [size, change] = self.refine();
            // NaN is no contraction
            let settles = change < SETTLING * last || change <= SETTLED * size;
            if !settles {
                self.rhs.copy_from_slice(&self.wanted);
                return false;
            }
            last = change;
        }
        true
    }

    /// Brings a state back to Φ = 0 and Φ̇ = 0 and computes its accelerations, multipliers and state rates.
    pub fn complete(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        integrator: &mut Integrator,
        state: &mut State,
        moment: Moment,
    ) -> Result<(), RuntimeError> {
        self.project(model, dynamics, state, moment, Factors::Made)?;
        let settles = state.time < integrator.current.time;
        self.finish(model, dynamics, integrator, state, (moment, settles))
    }

    /// Brings positions back to Φ = 0 and places `dynamics` there, with multipliers zero.
    pub fn project(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        state: &mut State,
        moment: Moment,
        factors: Factors,
    ) -> Result<(), RuntimeError> {
        let n = model.velocities;
        for attempt in 0..ATTEMPTS {
            dynamics.set_state(model, state, &[]);
            if self.beside && attempt == BESIDE.0 {
                return Ok(());
            }
            dynamics.evaluate_constraints(model)?;
            let (at, worst) =
                dynamics
                    .constraints()
                    .iter()
                    .enumerate()
                    .fold((0, 0.0_f64), |best, (i, x)| {
                        if x.abs() > best.1.abs() {
                            (i, *x)
                        } else {
                            best
                        }
                    });
            // the factors of the first position serve for small moves; larger moves get a second set
            let first = match factors {
                Factors::Made => true,
                Factors::Kept => false,
                Factors::IfNeeded => worst.abs() > POSITION_GOAL,
            };
            if (attempt == 0 && first) || attempt == ATTEMPTS / 2 {
                self.factor(model, dynamics, moment)?;
            }
            let within =
                worst.abs() <= POSITION_GOAL || (attempt >= 3 && worst.abs() <= POSITION_LIMIT);
            if within && !self.beside {
                return Ok(());
            }
            if attempt + 1 == ATTEMPTS
                && let Some((element, local)) = model.row_owner(at)
            {
                return Err(RuntimeError::Projection {
                    moment,
                    row: Box::new(model.named_row(element, local, worst)),
                });
            }
            self.rhs[..n].fill(0.0);
            for i in 0..model.rows {
                self.rhs[n + i] = -dynamics.constraints()[i] * self.scales[n + i];
            }
            self.solver.solve(&mut self.rhs);
            for (x, s) in self.rhs[..n].iter_mut().zip(&self.scales) {
                *x *= s;
            }
            move_pose(model, &state.pose, &self.rhs[..n], 1.0, &mut self.moved);
            state.pose.copy_from_slice(&self.moved);
        }
        Ok(())
    }

    /// After [`AccelerationSystem::project`]: velocities with |Φ̇| below 1e-9 of its first value or at rounding,
    /// accelerations, multipliers and rates.
    ///
    /// Loads belong to the given velocity, at which `dynamics` is placed: see the head of this module. A state within the last
    /// step is settled first ([`Integrator::settle`]).
    pub fn finish(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        integrator: &mut Integrator,
        state: &mut State,
        (moment, settles): (Moment, bool),
    ) -> Result<(), RuntimeError> {
        let n = model.velocities;
        if settles {
            integrator.settle(model, dynamics, state)?;
        }
        dynamics.evaluate(model)?;
        self.store_forces(model, dynamics, state);
        if !self.is_here(model, &state.pose) {
            self.fill(model, dynamics)?;
        }
        let speed = largest_scaled(&state.velocity, &self.scales);
        let rounding = VELOCITY_ROUNDING * speed;
        let (mut first, mut last, mut refined) = (0.0, f64::INFINITY, false);
        for round in 0..=VELOCITY_ROUNDS {
            dynamics.rate_level(model)?;
            let rates = dynamics.constraint_rates().iter().zip(&self.scales[n..]);
            let left = rates.fold(0.0_f64, |most, (rate, scale)| {
                most.max((rate * scale).abs())
            });
            if round == 0 {
                first = left;
            }
            // the first round hardly changes the films, so it always happens
            // less than a digit in a round is the end of the factors or rounding
            let progress = left <= SETTLING * last;
            let enough =
                left <= VELOCITY_GOAL * first || (!progress && (refined || left <= rounding));
            if (round > 1 && enough) || round == VELOCITY_ROUNDS {
                break;
            }
            // without progress above rounding the factors belong to a position too far away
            refined |= round > 1 && !progress;
            last = left;
            for (wanted, rate) in self
                .wanted_rates
                .iter_mut()
                .zip(dynamics.constraint_rates())
            {
                *wanted = -rate;
            }
            let kept = round == 0
                && integrator.nearest_change(model, &self.wanted_rates, &mut self.change);
            if !kept {
                self.rhs[..n].fill(0.0);
                for (i, wanted) in self.wanted_rates.iter().enumerate() {
                    self.rhs[n + i] = wanted * self.scales[n + i];
                }
                if refined {
                    self.solve(model, moment)?;
                } else {
                    // the next round removes the error of factors at a nearby position
                    self.solver.solve(&mut self.rhs);
                }
                for ((x, y), s) in self.change.iter_mut().zip(&self.rhs).zip(&self.scales) {
                    *x = y * s;
                }
            }
            for (v, x) in state.velocity.iter_mut().zip(&self.change) {
                *v += x;
            }
            dynamics.place_velocities(model, &state.velocity);
            dynamics.gather(model, &state.states, &[], &state.rotations);
        }
        dynamics.complete_accelerations(model, &state.velocity);
        dynamics.add_inertia(model, &state.velocity, &self.zeros, &mut self.forces);
        self.balance(model, dynamics, state, moment)
    }

    /// Accelerations, multipliers and state rates at a state, without moving it.
    pub fn accelerations(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        state: &mut State,
        moment: Moment,
    ) -> Result<(), RuntimeError> {
        dynamics.set_state(model, state, &[]);
        self.factor(model, dynamics, moment)?;
        self.accelerate(model, dynamics, state, moment)
    }

    /// The part of the state's velocity that violates the constraints. It is normal to them in the mass norm.
    pub fn velocity_defect(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        state: &State,
        moment: Moment,
        out: &mut [f64],
    ) -> Result<(), RuntimeError> {
        dynamics.set_state(model, state, &[]);
        self.factor(model, dynamics, moment)?;
        self.defect_here(model, dynamics, &state.velocity, out)
    }

    /// [`AccelerationSystem::velocity_defect`] of the velocity at which `dynamics` is placed, with factors made there.
    fn defect_here(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        velocity: &[f64],
        out: &mut [f64],
    ) -> Result<(), RuntimeError> {
        dynamics.velocity_level(model, velocity)?;
        self.normal(model, dynamics.constraint_rates(), out);
        Ok(())
    }

    /// Takes the part that violates the constraints off the state's velocity, and computes accelerations, multipliers and state
    /// rates then. Both belong to one position, so one matrix is factored. `work` takes the removed part.
    pub fn tangential_accelerations(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        state: &mut State,
        moment: Moment,
        work: &mut [f64],
    ) -> Result<(), RuntimeError> {
        dynamics.set_state(model, state, &[]);
        self.factor(model, dynamics, moment)?;
        if model.rows > 0 {
            self.defect_here(model, dynamics, &state.velocity, work)?;
            for (v, off) in state.velocity.iter_mut().zip(&*work) {
                *v -= off;
            }
            dynamics.set_state(model, state, &[]);
        }
        self.accelerate(model, dynamics, state, moment)
    }

    /// Brings a state back to Φ = 0 and Φ̇ = 0, velocities by the smallest change in the mass norm.
    pub fn restore(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        state: &mut State,
        moment: Moment,
    ) -> Result<(), RuntimeError> {
        self.project(model, dynamics, state, moment, Factors::Made)?;
        let mut defect = vec![0.0; model.velocities];
        self.velocity_defect(model, dynamics, state, moment, &mut defect)?;
        for (v, off) in state.velocity.iter_mut().zip(&defect) {
            *v -= off;
        }
        Ok(())
    }

    /// The smallest x in the mass norm with `G x = rates`. It uses the last factors, so call it after
    /// `velocity_defect` or `accelerations`.
    pub fn normal(&mut self, model: &Model, rates: &[f64], out: &mut [f64]) {
        let n = model.velocities;
        self.rhs[..n].fill(0.0);
        for (i, rate) in rates.iter().enumerate() {
            self.rhs[n + i] = rate * self.scales[n + i];
        }
        self.solver.solve(&mut self.rhs);
        for (x, (y, s)) in out.iter_mut().zip(self.rhs[..n].iter().zip(&self.scales)) {
            *x = y * s;
        }
    }

    /// Computes accelerations from the present position, gathered inputs (multipliers zero) and factors.
    fn accelerate(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        state: &mut State,
        moment: Moment,
    ) -> Result<(), RuntimeError> {
        dynamics.evaluate(model)?;
        dynamics.velocity_level(model, &state.velocity)?;
        self.store_forces(model, dynamics, state);
        dynamics.add_inertia(model, &state.velocity, &self.zeros, &mut self.forces);
        self.balance(model, dynamics, state, moment)
    }

    /// Stores the loads and rates of the last evaluation of `dynamics`, with multipliers zero.
    fn store_forces(&mut self, model: &Model, dynamics: &Dynamics, state: &mut State) {
        self.forces.fill(0.0);
        dynamics.add_forces(model, -1.0, &mut self.forces);
        state.rates.copy_from_slice(dynamics.rates());
    }

    /// Solves for accelerations and multipliers with `self.forces`, which are −Q, and the γ of `dynamics`.
    fn balance(
        &mut self,
        model: &Model,
        dynamics: &Dynamics,
        state: &mut State,
        moment: Moment,
    ) -> Result<(), RuntimeError> {
        let n = model.velocities;
        let unit = model.mass * model.length * model.length;
        for i in 0..n {
            self.rhs[i] = -self.forces[i] * self.scales[i] / unit;
        }
        for i in 0..model.rows {
            self.rhs[n + i] = dynamics.constraint_accelerations()[i] * self.scales[n + i];
        }
        if !(self.beside && self.correct_solved()) {
            self.solve(model, moment)?;
        }
        self.solved.copy_from_slice(&self.rhs);
        for i in 0..n {
            state.acceleration[i] = self.rhs[i] * self.scales[i];
        }
        for i in 0..model.rows {
            state.multipliers[i] = self.rhs[n + i] * self.scales[n + i] * unit;
        }
        Ok(())
    }
}
