//! The start of flexible bodies that turn in films: their motion is integrated until it repeats.
//!
//! The squeeze of its film carries a pin as much as the wedge, so the position of the pin depends on earlier
//! loads, and one angle alone does not determine the repeating motion. The motion with `ė = 0` does not
//! return after a period, because its zero rates are not derivatives of positions. So the whole motion is
//! integrated from the balance with the scheme of the steps (`ρ∞ = ½`, 2° per step), until a period changes
//! nothing. Anderson's method accelerates slow decay. With the states x_i at the beginnings of the last
//! periods and P(x_i) at their ends,
//!
//! ```text
//! x = Σ γ_i P(x_i)        Σ γ_i = 1        |Σ γ_i (P(x_i) − x_i)| least
//! ```
//!
//! A step takes over much of the steps before ([`Reused`]).
//!
//! Efforts keep the mean of each stated speed. They are critically damped and soft against all orders of the
//! period ([`mean_speeds`]). Element states do not change. The velocities at the start are central differences of
//! eighth order of the positions. Those of the scheme violate `Φ̇ = 0` by `C h² v̈`, which is as much as the
//! squeeze of a film. At the end position and velocities are projected to the stated values, so that
//! eccentricities, shapes and their rates change least. A body that turns in this projection carries its bending
//! along; its pins keep their places and rates in the shells all the same. (D. G. Anderson, J. ACM 12 (1965) 547.)

use super::super::{Balance, Place, Stop};
use super::mean_speeds::MeanSpeeds;
use super::path::{period_of, unwrap};
use super::reused::{Next, Reused};
use super::{NoOrbit, singular};
use crate::assembly::rows::pins;
use crate::dynamics::Dynamics;
use crate::error::RuntimeError;
use crate::field::Demand;
use crate::integrator::{Goal, Integrator};
use crate::linear::{BlockLu, LinearSolver, Pattern};
use crate::model::Model;
use crate::outputs::Watch;
use crate::start::Turning;
use crate::start::eccentricity::{
    eccentricities, eccentricity_rates, film_ratios, places_of_pins, rates_of_eccentricities,
    yielding,
};
use crate::start::motion::{SteadyMotion, modal};
use crate::state::{State, move_pose, offset};
use eng_system::dense::{largest, largest_difference};
use eng_system::significant::short;
use eng_system::system::Method;
use nalgebra::{DMatrix, DVector};
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Steps per turn, so 2° each. A choice: the eighth-order differences of the velocities then resolve all
/// orders of a load that matter, and the time of a start grows with this number.
const STEPS: f64 = 180.0;
/// ρ∞ of the scheme. A choice: shapes above the frequency of the steps decay in few periods, so that the
/// motion soon repeats. Towards one they keep ringing; towards zero the scheme damps slow shapes, too.
const RADIUS: f64 = 0.5;
/// Most periods. A choice: if even the accelerated motion changes after as many, it has another period or
/// none, and the start says so.
const PERIODS: usize = 40;
/// Number of periods after which the remaining deviation counts as linear. A choice: stiff shapes and films
/// lose their first deviation within a period or two, and combinations of such periods lead away.
const PLAIN: usize = 2;
/// Most periods in one combination. A choice: each may remove one slow decay, and periods before these belong
/// to another deviation.
const TOGETHER: usize = 8;
/// Change over a period, of a clearance or of the largest bending, below which the motion repeats. A choice:
/// it is twice the error that one step of a run may have at the usual tolerance, 1e-4 of a clearance, so a
/// nearer start would hardly show.
const REPEATS: f64 = 2e-4;
/// This change after [`PERIODS`] periods. A choice: a start whose bending is right within half a per cent
/// rings far less than one with bending from a balance. A larger change gives a warning.
const NEARLY: f64 = 5e-3;
/// Most iterations of a step. A choice: with a new matrix in nearly each, a step that needs more has no
/// solution.
const ITERATIONS: usize = 20;
/// Iterations with the first matrix, after which each has a new one. A choice: a matrix costs as much as
/// several evaluations.
const MATRIX: usize = 4;
/// Scaled correction at which a step is solved, as a share of the position tolerance. A choice: two decades
/// below the share that the error of a step of the run may have, so that errors of the iterations do not add
/// up over the steps of a period to a change of it.
const GOAL: f64 = 1e-3;
/// Weight of eccentricities and shapes relative to all others, in the projection to stated values. A choice:
/// its square, 1e8, leaves eight digits to the others in the matrix; then films and bending change by 1e-8 of
/// the way that frames may take instead.
const STIFF: f64 = 1e4;
/// Most rounds of this projection. A choice: they are Newton's method for small changes, whose error squares
/// from round to round.
const ROUNDS: usize = 5;
/// Share of the largest singular value of the changes over the last periods, below which a value is ignored.
/// A choice: changes of periods are as exact as the corrections of their steps, and a direction below this
/// share is their error, which the combination would enlarge.
const SAME: f64 = 1e-8;

/// The start of the found motion.
pub(super) struct Followed {
    pub place: Place,
    pub velocity: Vec<f64>,
    pub turning: Turning,
}

/// The scheme between two states of the motion.
struct Follower {
    integrator: Integrator,
    dynamics: Dynamics,
    watch: Watch,
    solver: BlockLu,
    mean_speeds: MeanSpeeds,
    reused: Reused,
    step: f64,
    /// The last positions.
    behind: VecDeque<Vec<f64>>,
}

/// The beginning of a step, and the loads of the efforts.
struct Step<'a> {
    here: &'a State,
    pulled: &'a DVector<f64>,
}

/// The complete state at the beginning of a period, as offsets from a position: increments, velocities,
/// accelerations, the scheme's own accelerations, and the leads of kept speeds.
type Vector = Vec<f64>;

/// Replaces the rows of element states by those of constant states.
fn still_states(pattern: &Pattern, states: std::ops::Range<usize>, values: &mut [f64]) {
    for (place, row, column) in pattern.places() {
        if states.contains(&row) {
            values[place] = f64::from(u8::from(row == column));
        }
    }
}

fn no_step() -> NoOrbit {
    NoOrbit::Reason("a step along its motion has no solution".to_owned())
}

impl Follower {
    fn new(
        balance: &mut Balance,
        state: &State,
        period: f64,
        count: usize,
    ) -> Result<Follower, NoOrbit> {
        let model = balance.model;
        // this goal is unused: the iteration of `advance` replaces the integrator's, to hold element states
        // and add efforts
        let goal = Goal {
            absolute: GOAL * model.tolerance / model.length,
            relative: 0.0,
        };
        let method = Method::GeneralisedAlpha {
            rho_infinity: RADIUS,
        };
        let mut integrator = Integrator::new(model, state, method, goal)?;
        let still = vec![0.0; model.velocities];
        integrator.start(
            &still,
            &still,
            &vec![0.0; model.rows],
            &vec![0.0; model.states],
        );
        let solver = BlockLu::new(integrator.pattern());
        let reused = Reused::new(integrator.unknowns(), count);
        Ok(Follower {
            mean_speeds: MeanSpeeds::new(balance, state, period)?,
            integrator,
            dynamics: Dynamics::new(model),
            watch: Watch::new(model, |_| true),
            solver,
            reused,
            step: period / count as f64,
            behind: VecDeque::new(),
        })
    }

    /// Takes a step.
    fn advance(&mut self, balance: &mut Balance) -> Result<(), NoOrbit> {
        let model = balance.model;
        let (n, s) = (model.velocities, model.states);
        let h = self.step;
        let here = self.integrator.current.clone();
        let pulled = self.mean_speeds.pull(balance, &here, h)?
            * (self.integrator.coefficients.beta * h * h
                / (model.mass * model.length * model.length));
        self.integrator.predict(model, h, true);
        let mut trial = self.integrator.trial().to_vec();
        for i in 0..s {
            trial[n + i] = here.states[i] / self.integrator.state_scales(model)[i];
        }
        let step = Step {
            here: &here,
            pulled: &pulled,
        };
        let mut found = trial.clone();
        if !self.solve_reusing(balance, &step, &mut found) {
            found.copy_from_slice(&trial);
            self.solve(balance, &step, &mut found)?;
        }
        self.reused.end(&found);
        self.accept(balance)
    }

    /// Solves a step from an extrapolation by Newton's method.
    fn solve(&mut self, balance: &Balance, step: &Step, trial: &mut [f64]) -> Result<(), NoOrbit> {
        let model = balance.model;
        let goal = GOAL * model.tolerance / model.length;
        let mut last = f64::INFINITY;
        for iteration in 0..ITERATIONS {
            self.evaluate(model, trial)?;
            if iteration == 0 || iteration >= MATRIX {
                self.factor(model)?;
            }
            let correction = self.correction(model, step);
            let (factor, size) = self.correct(balance, step, &correction, trial)?;
            // up to the position tolerance, corrections that are not even halved are rounding
            if factor == 1.0 && (size <= goal || (size <= 1e3 * goal && size >= 0.5 * last)) {
                return Ok(());
            }
            last = size;
        }
        Err(no_step())
    }

    /// Solves a step with the factors and secants of earlier ones; `false` if they lead to no solution.
    fn solve_reusing(&mut self, balance: &Balance, step: &Step, trial: &mut [f64]) -> bool {
        let model = balance.model;
        let goal = self.reused.rough() * GOAL * model.tolerance / model.length;
        self.reused.begin(trial);
        if let Some(found) = self.reused.found() {
            self.dynamics.begin_at(found);
        }
        for iteration in 0..ITERATIONS {
            if self.evaluate(model, trial).is_err() {
                break;
            }
            if self.reused.renews(iteration) {
                let regular = self.factor(model).is_ok();
                self.reused.factored(regular);
                if !regular {
                    break;
                }
            }
            let mut correction = self.correction(model, step);
            self.reused.improve(&mut correction);
            let Ok((part, size)) = self.correct(balance, step, &correction, trial) else {
                break;
            };
            if self.reused.applied(&correction, part, size, goal) == Next::Solved {
                if let Some(found) = self.reused.found_mut() {
                    self.dynamics.found(found);
                }
                return true;
            }
        }
        self.reused.factored(false);
        false
    }

    /// Evaluates the residual at unknowns.
    fn evaluate(&mut self, model: &Model, trial: &[f64]) -> Result<(), RuntimeError> {
        self.integrator.set_trial(trial);
        self.integrator
            .evaluate(model, &mut self.dynamics, self.step, Demand::Iterate)
    }

    /// Factors the matrix at the last evaluation.
    fn factor(&mut self, model: &Model) -> Result<(), NoOrbit> {
        let (n, s) = (model.velocities, model.states);
        self.integrator.fill(model, &mut self.dynamics, self.step)?;
        let mut values = self.integrator.values().to_vec();
        still_states(self.integrator.pattern(), n..n + s, &mut values);
        self.solver.factor(&values).map_err(|_| no_step())
    }

    /// The correction of the factors at the last evaluation.
    fn correction(&mut self, model: &Model, step: &Step) -> Vec<f64> {
        let (n, s) = (model.velocities, model.states);
        let mut correction: Vec<f64> = self.integrator.last_residual().iter().map(|r| -r).collect();
        correction[n..n + s].fill(0.0);
        for (r, p) in correction.iter_mut().zip(step.pulled.iter()) {
            *r += p;
        }
        self.solver.solve(&mut correction);
        correction
    }

    /// Moves unknowns by a correction, as far as films allow. Returns the part of the correction, and its size.
    fn correct(
        &mut self,
        balance: &Balance,
        step: &Step,
        correction: &[f64],
        trial: &mut [f64],
    ) -> Result<(f64, f64), NoOrbit> {
        let model = balance.model;
        if correction.iter().any(|x| !x.is_finite()) {
            return Err(no_step());
        }
        let own = &correction[..model.velocities];
        let size = largest(own);
        let scales = model.velocity_scales();
        let mut pose = step.here.pose.clone();
        let taken = unscaled(trial, &scales);
        move_pose(model, &step.here.pose, &taken, 1.0, &mut pose);
        let increment = unscaled(correction, &scales);
        let part = balance.allowed(&pose.clone(), &increment, size, &mut pose);
        for (x, d) in trial.iter_mut().zip(correction) {
            *x += part * d;
        }
        self.integrator.set_trial(trial);
        Ok((part, size))
    }

    fn accept(&mut self, balance: &mut Balance) -> Result<(), NoOrbit> {
        let model = balance.model;
        let h = self.step;
        self.integrator.apply_trial(model, h);
        let time = self.integrator.current.time + h;
        self.integrator.accept(model, h, time);
        let now = &mut self.integrator.current;
        unwrap(model, &mut self.watch, &mut self.dynamics, now)?;
        self.mean_speeds.follow(balance, now, h)?;
        self.behind.push_front(now.pose.clone());
        // the present position and four before it, for differences of eighth order
        self.behind.truncate(5);
        Ok(())
    }

    /// Rates of the present positions, by central differences of eighth order from earlier and later ones. In
    /// SI: m/s, rad/s in the axes of the body, and modal rates.
    fn rates(&mut self, balance: &mut Balance) -> Result<Vec<f64>, NoOrbit> {
        // f' = (Σ w_k (f_k − f_−k))/h for k = 1…4
        const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
        let model = balance.model;
        let here = self.integrator.current.pose.clone();
        let before: Vec<Vec<f64>> = self.behind.iter().skip(1).cloned().collect();
        let mut rates = vec![0.0; model.velocities];
        for (weight, behind) in WEIGHTS.iter().zip(&before) {
            self.advance(balance)?;
            let after = offset(model, &here, &self.integrator.current.pose);
            let behind = offset(model, &here, behind);
            for (rate, (a, b)) in rates.iter_mut().zip(after.iter().zip(&behind)) {
                *rate += weight * (a - b) / self.step;
            }
        }
        Ok(rates)
    }

    /// Sets the time and all angles back to those of a state a period before.
    fn rewind(&mut self, first: &State) {
        self.mean_speeds.replaced();
        let now = &mut self.integrator.current;
        now.time = first.time;
        now.rotations.copy_from_slice(&first.rotations);
    }

    /// The complete state, as offsets from a position.
    fn read(&self, model: &Model, from: &State) -> Vector {
        let now = &self.integrator.current;
        let mut all = offset(model, &from.pose, &now.pose);
        all.extend(&now.velocity);
        all.extend(&now.acceleration);
        all.extend(&self.integrator.auxiliary);
        all.extend(&self.integrator.jerk);
        all.extend(&now.multipliers);
        all.extend(&self.integrator.multiplier_rate);
        all.extend(self.mean_speeds.ahead.iter());
        all.extend(self.mean_speeds.faster.iter());
        all
    }

    /// Sets the complete state from offsets; `false` if a pin would be outside its shell.
    fn write(&mut self, model: &Model, from: &State, all: &[f64]) -> bool {
        let n = model.velocities;
        let mut pose = from.pose.clone();
        move_pose(model, &from.pose, &all[..n], 1.0, &mut pose);
        if film_ratios(model, &pose)
            .iter()
            .zip(yielding(model))
            .any(|(ratio, yields)| *ratio >= WITHIN && !yields)
        {
            return false;
        }
        self.mean_speeds.replaced();
        let now = &mut self.integrator.current;
        now.pose.copy_from_slice(&pose);
        let mut rest = &all[n..];
        let mut take = |to: &mut [f64]| {
            let (own, others) = rest.split_at(to.len());
            to.copy_from_slice(own);
            rest = others;
        };
        take(&mut now.velocity);
        take(&mut now.acceleration);
        take(&mut self.integrator.auxiliary);
        take(&mut self.integrator.jerk);
        take(&mut now.multipliers);
        take(&mut self.integrator.multiplier_rate);
        take(self.mean_speeds.ahead.as_mut_slice());
        take(self.mean_speeds.faster.as_mut_slice());
        true
    }
}

/// Largest eccentricity ratio of an accelerated state that is accepted. A choice: beyond it a combination has
/// left the range of the films, and the next period has to begin where the last one ended.
const WITHIN: f64 = 0.98;

/// Increments (SI) from scaled ones.
fn unscaled(unknowns: &[f64], scales: &[f64]) -> Vec<f64> {
    unknowns.iter().zip(scales).map(|(x, s)| x * s).collect()
}

/// Largest change from one state to another: of eccentricities as shares of their clearances, and of shapes
/// as shares of the largest shape of their body.
fn change(model: &Model, from: &State, to: &State) -> f64 {
    let films = eccentricities(model, &from.pose)
        .into_iter()
        .zip(eccentricities(model, &to.pose));
    let journals = &model.compiled.system.journals;
    let mut change = journals
        .iter()
        .zip(films)
        .fold(0.0_f64, |w, (journal, (a, b))| {
            w.max(libm::hypot(b[0] - a[0], b[1] - a[1]) / model.slot(journal.clearance))
        });
    for body in &model.bodies {
        let shapes = body.pose + 7..body.pose + 7 + body.modes();
        let (a, b) = (&from.pose[shapes.clone()], &to.pose[shapes]);
        let size = largest(b);
        let off = largest_difference(a, b);
        if size > 0.0 {
            change = change.max(off / size);
        }
    }
    change
}

/// The accelerated beginning of the next period, from the beginnings and ends of the last ones. The weights
/// make the entries comparable.
fn ahead(begins: &[Vector], ends: &[Vector], weights: &[f64]) -> Option<Vector> {
    let (last_end, last_begin) = (ends.last()?, begins.last()?);
    let count = ends.len() - 1;
    let off = |k: usize, i: usize| weights[i] * (ends[k][i] - begins[k][i]);
    let size = weights.len();
    let changes = DMatrix::from_fn(size, count, |i, k| off(k, i) - off(count, i));
    let wanted = DVector::from_fn(size, |i, _| -weights[i] * (last_end[i] - last_begin[i]));
    let svd = crate::singular::decompose(changes)?;
    let parts = svd.solve(&wanted, SAME * svd.singular_values.amax()).ok()?;
    let mut next = last_end.clone();
    for (end, part) in ends.iter().zip(parts.iter()) {
        for (x, (a, b)) in next.iter_mut().zip(end.iter().zip(last_end)) {
            *x += part * (a - b);
        }
    }
    next.iter().all(|x| x.is_finite()).then_some(next)
}

impl Balance<'_> {
    /// Integrates the motion from a position until it repeats.
    pub(super) fn follow(&mut self, place: &Place) -> Result<Followed, NoOrbit> {
        let model = self.model;
        let mut first = place.state.clone();
        first.velocity.copy_from_slice(&self.velocity);
        first.acceleration.copy_from_slice(&self.acceleration);
        first.rates.fill(0.0);
        let (period, turns) = period_of(self, place)?;
        let count = libm::ceil(turns * STEPS) as usize;
        let weights = self.weights(&first, turns * TAU / period);
        let mut follower = Follower::new(self, &first, period, count)?;
        let start = first.clone();
        let (mut begins, mut ends) = (Vec::new(), Vec::new());
        let mut off = f64::INFINITY;
        let mut followed = 0;
        while followed < PERIODS && off > REPEATS {
            let begin = follower.read(model, &start);
            for _ in 0..count {
                follower.advance(self)?;
            }
            followed += 1;
            follower.rewind(&start);
            let now = &follower.integrator.current;
            let before = off;
            off = change(model, &first, now);
            follower.reused.changed(off);
            first.copy_from(now);
            if followed <= PLAIN || off <= REPEATS {
                continue;
            }
            // a period that changes this much more than the one before shows that the combination led away:
            // its periods no longer count. A choice above the growth that single periods of a decaying
            // vibration have
            if off > 4.0 * before {
                begins.clear();
                ends.clear();
            }
            begins.push(begin);
            ends.push(follower.read(model, &start));
            if ends.len() > TOGETHER {
                begins.remove(0);
                ends.remove(0);
            }
            if ends.len() > 1
                && let Some(next) = ahead(&begins, &ends, &weights)
                && follower.write(model, &start, &next)
            {
                first.copy_from(&follower.integrator.current);
            }
        }
        if off > NEARLY || off.is_nan() {
            return Err(NoOrbit::Reason(format!(
                "its motion on the films does not repeat: the {PERIODS}th period of {:.4} ms changes the bending by {} of itself",
                1e3 * period,
                short(off, 2)
            )));
        }
        let rates = follower.rates(self)?;
        let (state, velocity) =
            self.stated(&place.state, &first, rates, &mut follower.mean_speeds)?;
        Ok(Followed {
            place: Place {
                state,
                efforts: place.efforts.clone(),
            },
            velocity,
            turning: Turning::Followed {
                periods: followed,
                period,
                change: off,
            },
        })
    }

    /// Weights that make increments and velocities comparable: the largest shape of the body for shapes, the
    /// clearances for frames. In 1/m, 1/rad and one over an amplitude for increments; the same times s for
    /// velocities. `angular_velocity` (1/s) is that of the motion.
    fn weights(&self, state: &State, angular_velocity: f64) -> Vec<f64> {
        let model = self.model;
        let mut weights = vec![0.0; model.velocities];
        for body in &model.bodies {
            let shapes = &state.pose[body.pose + 7..body.pose + 7 + body.modes()];
            let size = largest(shapes);
            let v = body.velocity;
            // the position tolerance is a thousandth of the smallest clearance, or less
            weights[v..v + 3].fill(1e-3 / model.tolerance);
            weights[v + 3..v + 6].fill(1e-3 * model.length / model.tolerance);
            weights[v + 6..v + body.width()].fill(if size > 0.0 { 1.0 / size } else { 0.0 });
        }
        let rates: Vec<f64> = weights.iter().map(|w| w / angular_velocity).collect();
        weights.extend(rates);
        weights
    }

    /// Deviations and rows, in scaled increments, of stated positions and of parts with a kept mean speed.
    fn stated_or_kept(
        &mut self,
        state: &State,
        mean_speeds: &MeanSpeeds,
    ) -> Result<(DVector<f64>, DMatrix<f64>), Stop> {
        let (mut values, mut rows) = self.holds(state)?;
        let count = rows.nrows() - self.fixed.nrows();
        for (i, factor) in self.factors.iter().enumerate() {
            values[i] *= factor;
            rows.row_mut(i).scale_mut(*factor);
        }
        let stated: Vec<usize> = self
            .holding
            .iter()
            .copied()
            .filter(|i| *i < count)
            .collect();
        let moving = mean_speeds.rows(self, state)?;
        let (first, size) = (stated.len(), stated.len() + moving.nrows());
        let mut all = DMatrix::zeros(size, rows.ncols());
        all.rows_mut(0, first).copy_from(&rows.select_rows(&stated));
        all.rows_mut(first, moving.nrows()).copy_from(&moving);
        let mut off = DVector::zeros(size);
        off.rows_mut(0, first)
            .copy_from(&values.select_rows(&stated));
        off.rows_mut(first, moving.nrows())
            .copy_from(&mean_speeds.ahead);
        Ok((off, all))
    }

    /// Weight matrix of moves in scaled velocities, and the weighed rows of the eccentricities in it.
    /// Eccentricities and shapes are stiff.
    fn stiff(&self, state: &State) -> (DMatrix<f64>, DMatrix<f64>) {
        let model = self.model;
        let n = model.velocities;
        let mut films = eccentricity_rates(model, &pins(model), state);
        for (mut column, scale) in films.column_iter_mut().zip(self.motion.scales()) {
            column.scale_mut(*scale * STIFF / model.length);
        }
        let mut weight = films.tr_mul(&films) + DMatrix::identity(n, n);
        for i in modal(model) {
            weight[(i, i)] += STIFF * STIFF;
        }
        (weight, films)
    }

    /// The least weighted move, in scaled velocities, that changes rows by `wanted` and eccentricities by about
    /// `shifted` (m, or m/s for rates; x and y of each film). With the rows R, those of the eccentricities F, both
    /// weighed, and the weight W = I + FᵀF it has the least `|y|² + |F y − shifted|²`:
    ///
    /// ```text
    /// y = W⁻¹(Fᵀ shifted + Rᵀμ)        R W⁻¹Rᵀ μ = wanted − R W⁻¹Fᵀ shifted
    /// ```
    fn softest(
        &self,
        state: &State,
        rows: &DMatrix<f64>,
        wanted: &DVector<f64>,
        shifted: &DVector<f64>,
    ) -> Result<DVector<f64>, NoOrbit> {
        let (weight, films) = self.stiff(state);
        let found = weight.cholesky().and_then(|weight| {
            let own = weight.solve(&films.tr_mul(&(shifted * (STIFF / self.model.length))));
            let across = weight.solve(&rows.transpose());
            let factors = (rows * &across).lu().solve(&(wanted - rows * &own))?;
            Some(own + across * factors)
        });
        found.ok_or_else(|| {
            NoOrbit::Reason("the stated values cannot hold along its motion".to_owned())
        })
    }

    /// Projects a position of the motion and its velocities to the stated values, and the cycle to its angle
    /// at the first position. Eccentricities, shapes and their rates change least.
    fn stated(
        &mut self,
        from: &State,
        state: &State,
        mut rates: Vec<f64>,
        mean_speeds: &mut MeanSpeeds,
    ) -> Result<(State, Vec<f64>), NoOrbit> {
        let model = self.model;
        let n = model.velocities;
        let pins = pins(model);
        let places = |pose: &[f64]| DVector::from_vec(places_of_pins(model, &pins, pose));
        let rates_of = |pose: &[f64], rates: &[f64]| {
            DVector::from_vec(rates_of_eccentricities(model, &pins, pose, rates))
        };
        // a body that turns further carries its bending along, so that its pins leave their places in the shells
        let (place, rate) = (places(&state.pose), rates_of(&state.pose, &rates));
        let mut state = state.clone();
        for _ in 0..ROUNDS {
            mean_speeds.measure_cycle(self, from, &state)?;
            let (off, held) = self.stated_or_kept(&state, mean_speeds)?;
            let (missed, constraints) = self.motion.missed_places(model, &state)?;
            let count = constraints.nrows();
            let mut rows = DMatrix::zeros(count + held.nrows(), n);
            rows.rows_mut(0, count).copy_from(&constraints);
            rows.rows_mut(count, held.nrows()).copy_from(&held);
            let mut wanted = DVector::zeros(rows.nrows());
            wanted.rows_mut(0, count).copy_from(&-missed);
            wanted.rows_mut(count, off.len()).copy_from(&-off);
            let shifted = &place - places(&state.pose);
            let step = self.softest(&state, &rows, &wanted, &shifted)?;
            let own = mean_speeds.ahead.len();
            mean_speeds.ahead += held.rows(held.nrows() - own, own) * &step;
            let from = state.pose.clone();
            let increment = unscaled(step.as_slice(), self.motion.scales());
            move_pose(model, &from, &increment, 1.0, &mut state.pose);
        }
        let motion = SteadyMotion::along_path(model, &state).map_err(singular)?;
        let (missed, rows) = motion.missed_rates(model, &state, &rates)?;
        let shifted = rate - rates_of(&state.pose, &rates);
        let step = self.softest(&state, &rows, &-missed, &shifted)?;
        for (rate, (y, s)) in rates.iter_mut().zip(step.iter().zip(self.motion.scales())) {
            *rate += y * s;
        }
        Ok((state, rates))
    }
}
