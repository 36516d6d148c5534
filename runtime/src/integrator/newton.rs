//! One step: Newton's iteration with a kept matrix, the estimate of the local error, and the cause of a
//! failure.

use super::{Integrator, RESOLVED, Trial};
use crate::dynamics::Dynamics;
use crate::error::{Moment, RuntimeError};
use crate::field::Demand;
use crate::model::{Model, STEP_SHARE};
use eng_system::dense::{largest, largest_scaled};
use eng_system::system::{Origin, StateInfo};
use eng_system::{Dimension, DisplayUnit};

/// Contraction above which the matrix is computed again. A choice: at 0.3 two iterations win a digit. A
/// larger limit makes steps of many iterations, a smaller one gives up matrices that still serve.
const CONTRACTION_LIMIT: f64 = 0.3;
/// Contraction of the iteration, with or without secants, above which a step begins with a fresh matrix.
/// Samples use the kept matrix without secants, so they need the limit too. A fresh matrix costs about four
/// iterations. At 0.12 these four win nearly four digits, so waiting longer costs more than the matrix.
const RENEWAL: f64 = 0.12;
/// Least contraction that is assumed of an old matrix. A choice near [`RENEWAL`], which ends the use of a
/// matrix: if one ratio is smaller, the next ones may not be.
const OLD_CONTRACTION: f64 = 0.1;
/// Most iterations of a step, including those with fresh matrices. A choice: at the limit of the contraction,
/// 0.3, they win seven digits. A step that needs more is cheaper as two shorter ones.
const ITERATION_LIMIT: usize = 14;
/// Most halvings in a step. A correction is halved if it leads to values that are not finite or to larger
/// residuals. A choice: one correction halved as often is below rounding, and an ordinary step needs few.
const BACKTRACK_LIMIT: usize = 40;
/// Number of matrices in a step from which on residuals must decrease. With the first one of a step a
/// residual may grow on the way, because the equations of the motion mix rows of different stiffness. A
/// second one shows that the corrections do not lead on.
const TROUBLED: usize = 2;
/// Change of the scaled unknowns, as a share of the largest of them, that counts as rounding. It is some
/// units of the last place.
const ROUNDING: f64 = 1e-15;
/// Least motion in a step, in scaled unknowns, for the limit of rounding. At rest the increments are small,
/// but the positions to which they are added round all the same. A choice: with a motion of zero the limit
/// were zero, and the iterations at rest would never reach it. A limit for a motion of 1 would hide a slow
/// contraction far below the size of the model.
const LEAST_MOTION: f64 = 1e-3;
/// Share of a state's scale, or of its peak, that the error of one step may have at the usual tolerance. A
/// choice: the errors of hundreds of steps add up to less than a per cent of a state, as for accelerations
/// ([`STEP_SHARE`]).
pub const STATE_SHARE: f64 = 1e-5;
/// Least move that gives a secant, as a multiple of the noise of corrections. The difference of two
/// corrections is then right within a tenth at worst; a secant of noise would spoil later corrections.
const SECANT_MOVE: f64 = 10.0;
/// Change below which an iteration without contraction under a fresh matrix has reached rounding. A choice:
/// stiff constraints enlarge the rounding of an increment by some decades, and an error of 1e-11 of the
/// model's length is far below the tolerance of positions.
const STAGNATION: f64 = 1e-11;

/// The progress of Newton's iteration in a step.
struct Iteration {
    /// Three sizes of a correction, in scaled unknowns. `goal` ends the iteration. Below `noise` the ratio to
    /// the last correction is rounding. Below `floor` the correction itself is rounding.
    goal: f64,
    noise: f64,
    floor: f64,
    /// Largest change of the correction before, if it has the same matrix.
    last: Option<f64>,
    /// Number of matrices in this step.
    fills: usize,
    /// Whether the next iteration needs a new matrix.
    renew: bool,
    /// Largest change of the last correction, shortened by its halvings.
    step: f64,
    /// Largest scaled residual before the last correction.
    before: f64,
    /// Whether secants improve the corrections: only in steps with control of the error.
    learns: bool,
    /// Whether `plain` is the correction before the last move, with the same matrix.
    known: bool,
    /// Whether the prediction extrapolates with rates of change.
    smooth: bool,
    /// Whether a correction was applied.
    moved: bool,
    /// Number of halvings.
    backtracks: usize,
    /// The reason for values that are not finite.
    cause: Option<RuntimeError>,
}

/// The next action after a correction.
enum Next {
    Iterate,
    /// Solved: this correction is below the goal. The last evaluation belongs to the trial before it.
    Met,
    /// Solved, but the trial with this correction has no evaluation yet.
    Foreseen,
    Failed,
}

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
        if let Some(mut radau) = self.radau.take() {
            let control = (tolerance, moment);
            let trial = self.try_radau(&mut radau, model, dynamics, h, control);
            self.radau = Some(radau);
            return trial;
        }
        // The rows are scaled by βh², so the matrix depends little on h, and factors of a similar step serve.
        // The contraction decides whether they are good enough.
        if self
            .factored_step
            // a choice: between these ratios the inertia in the matrix, which is scaled by 1/h², is at most a
            // factor of three off
            .is_some_and(|old| !(0.6..=1.7).contains(&(h / old)))
            || self.contraction.is_some_and(|c| c > RENEWAL)
            || self.secants.missed() > RENEWAL
        {
            self.drop_factors();
        }
        self.rescale_states(model);
        self.predict(model, h, true);
        let failed = |error| {
            Ok(Trial::Failed(Box::new(match error {
                RuntimeError::NotFinite {
                    origin, because, ..
                } => RuntimeError::NotFinite {
                    origin,
                    because,
                    moment,
                },
                other => other,
            })))
        };
        let mut iteration = Iteration {
            goal: self.goal(h),
            noise: self.noise(model, h),
            floor: self.floor(h),
            last: None,
            fills: 0,
            renew: self.factored_step.is_none(),
            step: 0.0,
            before: f64::INFINITY,
            learns: tolerance.is_some(),
            known: false,
            smooth: true,
            moved: false,
            backtracks: 0,
            cause: None,
        };
        match self.iterate(model, dynamics, h, &mut iteration)? {
            // The last correction is applied too. The remaining error is then smaller by one more
            // contraction.
            Next::Met => self.apply_trial(model, h),
            // computes v', v̇' and a' of the last increment
            Next::Foreseen => match self.evaluate(model, dynamics, h, Demand::Answers) {
                Ok(()) => {}
                Err(error @ RuntimeError::NotFinite { .. }) => return failed(error),
                Err(error) => return Err(error),
            },
            Next::Iterate | Next::Failed => {
                self.drop_factors();
                let cause = iteration.cause.take();
                return failed(cause.unwrap_or_else(|| self.stalled(model, h, moment)));
            }
        }
        let error = match tolerance {
            Some(factor) => self.error(model, dynamics, h, factor)?,
            None => 0.0,
        };
        Ok(Trial::Solved { error })
    }

    /// Iterates until the goal is met, is certain to be met, or cannot be met.
    fn iterate(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        h: f64,
        iteration: &mut Iteration,
    ) -> Result<Next, RuntimeError> {
        let mut count = 0;
        // a halving shortens one correction, so it allows one iteration more
        while count < ITERATION_LIMIT + iteration.backtracks {
            match self.evaluate(model, dynamics, h, Demand::Iterate) {
                Ok(()) => {}
                Err(error @ RuntimeError::NotFinite { .. }) => {
                    iteration.cause = Some(error);
                    if self.retreat(model, h, iteration) {
                        continue;
                    }
                    return Ok(Next::Failed);
                }
                Err(error) => return Err(error),
            }
            if self.led_away(iteration) {
                self.halve(iteration);
                // beyond a kink the old matrix has the wrong slope and would lead away again
                iteration.renew = true;
                continue;
            }
            if iteration.renew {
                match self.factor(model, dynamics, h) {
                    Ok(true) => {}
                    Ok(false) => return Ok(Next::Failed),
                    Err(error @ RuntimeError::NotFinite { .. }) => {
                        iteration.cause = Some(error);
                        return Ok(Next::Failed);
                    }
                    Err(error) => return Err(error),
                }
                iteration.fills += 1;
                iteration.renew = false;
                iteration.last = None;
                iteration.known = false;
            }
            count += 1;
            self.statistics.iterations += 1;
            let norm = self.correct(iteration);
            if !norm.is_finite() {
                if iteration.fills > 0 {
                    return Ok(Next::Failed);
                }
                iteration.renew = true;
                continue;
            }
            for (x, d) in self.trial.iter_mut().zip(&self.correction) {
                *x += d;
            }
            self.taken.copy_from_slice(&self.correction);
            iteration.step = norm;
            iteration.moved = true;
            iteration.cause = None;
            match self.judge(norm, iteration) {
                Next::Iterate => iteration.last = Some(norm),
                end => return Ok(end),
            }
        }
        Ok(Next::Failed)
    }

    /// Reacts to values that are not finite. It halves the last correction, or predicts without rates of
    /// change if there is no correction yet. Returns whether one of these was possible.
    fn retreat(&mut self, model: &Model, h: f64, iteration: &mut Iteration) -> bool {
        if iteration.moved && iteration.backtracks < BACKTRACK_LIMIT {
            self.halve(iteration);
            iteration.last = None;
            return true;
        }
        if !iteration.moved && iteration.smooth {
            iteration.smooth = false;
            iteration.known = false;
            self.predict(model, h, false);
            return true;
        }
        false
    }

    /// Whether the last correction led to larger residuals, in an iteration that needs several matrices.
    /// Otherwise it stores the size of the residuals. With a kink in a law, such as the flow `√Δp` of a
    /// valve, full corrections jump across the kink again and again. Halved corrections end on the side of
    /// the solution. Corrections at rounding are not halved, because their residuals are random.
    fn led_away(&self, iteration: &mut Iteration) -> bool {
        let size = largest(&self.residual);
        let larger = size > iteration.before
            && iteration.fills >= TROUBLED
            && iteration.step > iteration.goal.max(iteration.noise)
            && iteration.backtracks < BACKTRACK_LIMIT;
        if !larger {
            iteration.before = size;
        }
        larger
    }

    /// Undoes half of the last correction.
    fn halve(&mut self, iteration: &mut Iteration) {
        iteration.backtracks += 1;
        iteration.step *= 0.5;
        for (x, step) in self.trial.iter_mut().zip(&mut self.taken) {
            *step *= 0.5;
            *x -= *step;
        }
    }

    /// Solves for the correction with the help of secants, and returns its largest change.
    fn correct(&mut self, iteration: &mut Iteration) -> f64 {
        for (d, r) in self.correction.iter_mut().zip(&self.residual) {
            *d = -r;
        }
        self.solver.solve(&mut self.correction);
        if iteration.learns {
            if iteration.known && iteration.step > SECANT_MOVE * iteration.noise {
                (self.secants).add(&self.taken, &self.plain, &self.correction);
            }
            self.plain.copy_from_slice(&self.correction);
            iteration.known = true;
            self.secants.improve(&mut self.correction);
        }
        self.correction.iter().fold(0.0_f64, |w, x| {
            if x.is_finite() {
                w.max(x.abs())
            } else {
                f64::INFINITY
            }
        })
    }

    /// The next action after a correction of this size.
    fn judge(&mut self, norm: f64, iteration: &mut Iteration) -> Next {
        let goal = iteration.goal;
        let rate = iteration.last.map(|before| norm / before);
        if let Some(rate) = rate {
            // Near rounding the ratio itself is noise. It only shows that the contraction is strong.
            let seen = if norm > goal.max(iteration.noise) {
                rate
            } else {
                // a choice: as good as an exact matrix
                rate.min(1e-3)
            };
            self.contraction = Some(self.contraction.map_or(seen, |c| c.max(seen)));
        }
        // If the matrix contracts, the correction is the error of the evaluated trial.
        if norm <= goal && self.contraction.is_some_and(|c| c <= CONTRACTION_LIMIT) {
            return Next::Met;
        }
        if norm <= iteration.floor {
            return Next::Foreseen;
        }
        let Some(rate) = rate else {
            return Next::Iterate;
        };
        // The first ratio is too optimistic: slow components of an old matrix become visible only when the
        // fast ones have decayed.
        let least = if iteration.fills > 0 {
            0.0
        } else {
            OLD_CONTRACTION
        };
        let expected = rate.max(self.contraction.unwrap_or(0.0)).max(least);
        // the rest of a geometric series; above a ratio of 0.9, a choice, the iteration has no ratio to
        // extrapolate with
        if expected < 0.9 && norm * expected / (1.0 - expected) <= goal {
            return Next::Foreseen;
        }
        // with a fresh matrix, a correction that doubles and is larger than the model or a radian leads away
        if rate >= 2.0 && iteration.fills > 0 && norm > 1.0 {
            return Next::Failed;
        }
        if rate > CONTRACTION_LIMIT {
            if norm <= iteration.noise || (iteration.fills > 0 && norm <= STAGNATION) {
                return Next::Foreseen;
            }
            iteration.renew = true;
        }
        Next::Iterate
    }

    /// Goal of Newton's iteration in a step h, in scaled unknowns: a share of `βh² a`, the contribution of
    /// accelerations to the increment. The remaining error is not random, because the kept matrix makes the
    /// same error at every step. It adds up over time like a load of that share. The goal is never below
    /// rounding.
    pub(super) fn goal(&self, h: f64) -> f64 {
        let acceleration = self.largest(&self.current.acceleration);
        self.goal
            .absolute
            .min(self.goal.relative * self.coefficients.beta * h * h * acceleration)
            .max(self.floor(h))
    }

    /// Rounding of the increment of a step h, in scaled unknowns: that of the motion in the step. Positions
    /// that constraints hold round to 1e-16 of the model's length at any step, so their iterations stagnate
    /// above this value.
    pub(super) fn floor(&self, h: f64) -> f64 {
        ROUNDING * (h * self.largest(&self.current.velocity)).max(LEAST_MOTION)
    }

    /// Correction below which a ratio of corrections is meaningless. Positions that constraints hold round at
    /// any step. Without constraints only the motion in the step rounds, so a slow contraction far below the
    /// size of the model still counts.
    pub(super) fn noise(&self, model: &Model, h: f64) -> f64 {
        if model.rows > 0 {
            // two digits above rounding a ratio of corrections is right within a per cent
            100.0 * ROUNDING
        } else {
            100.0 * self.floor(h)
        }
    }

    /// Largest magnitude of velocities or accelerations, scaled.
    pub(super) fn largest(&self, x: &[f64]) -> f64 {
        largest_scaled(x, &self.scales)
    }

    /// The error for a step without solution. It names the row with the largest residual.
    pub(super) fn stalled(&self, model: &Model, h: f64, moment: Moment) -> RuntimeError {
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

    /// The owner of a row, its equation and the unit of its residual.
    fn row_name(&self, model: &Model, row: usize) -> (Origin, String, String) {
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
                    let equation = format!("balance of {name}");
                    return (body.origin.clone(), equation, unit.to_owned());
                }
            }
        } else if row < first_row {
            if let Some((origin, state)) = state_of(model, row - model.velocities) {
                let rate = state.dimension.over(Dimension::TIME);
                let unit = DisplayUnit::si(rate).symbol;
                return (origin.clone(), format!("der({})", state.name), unit);
            }
        } else if let Some((element, local)) = model.row_owner(row - first_row) {
            let named = model.named_row(element, local, 0.0);
            let unit = if named.is_length { "m" } else { "rad" };
            return (named.origin, named.equation, unit.to_owned());
        }
        (Origin::default(), String::new(), String::new())
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
        self.fill_masses(model, dynamics);
        let mut masses = self.masses.as_slice();
        for body in &model.bodies {
            let width = body.width();
            let (mass, others) = masses.split_at(width * width);
            masses = others;
            for i in 0..width {
                let product: f64 = (0..width)
                    .map(|j| mass[i * width + j] * self.estimate[body.velocity + j])
                    .sum();
                self.correction[body.velocity + i] = weight * product;
            }
        }
        let (loads, rows) = self.correction.split_at_mut(n);
        dynamics.constraints_along(model, &self.estimate, &mut rows[s..])?;
        dynamics.add_damping_forces(model, &self.estimate, -c.weights(h).velocity, loads)?;
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
        // States: the error of the scheme is about a sixth of the distance to the second-order extrapolation.
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

    /// The owner of the error that governed the last step's size: an element and the name of its state, or a
    /// body with the elements whose loads act on it: an error of a driven body is that of such a load.
    pub fn governing(&self, model: &Model) -> (Origin, Option<String>, Vec<String>) {
        let none = || (Origin::default(), None, Vec::new());
        let Some(index) = self.governing else {
            return none();
        };
        if let Some(state) = index.checked_sub(model.velocities) {
            return state_of(model, state).map_or_else(none, |(origin, state)| {
                (origin.clone(), Some(state.name.clone()), Vec::new())
            });
        }
        let mut bodies = model.bodies.iter().enumerate();
        let found =
            bodies.find(|(_, body)| (body.velocity..body.velocity + body.width()).contains(&index));
        found.map_or_else(none, |(body, own)| {
            (own.origin.clone(), None, loads_on(model, body))
        })
    }
}

/// Paths of the elements whose loads act on a body.
fn loads_on(model: &Model, body: usize) -> Vec<String> {
    let acts = |element: usize| {
        let own = &model.elements[element];
        own.dynamic
            && model.class(element).facts.applies_load
            && own
                .markers
                .iter()
                .any(|m| model.markers[*m].body == Some(body))
    };
    let path = |element: usize| model.compiled.system.elements[element].origin.path.clone();
    (0..model.elements.len())
        .filter(|e| acts(*e))
        .map(path)
        .collect()
}

/// The element that a state of the model belongs to, and the state.
fn state_of(model: &Model, state: usize) -> Option<(&Origin, &StateInfo)> {
    model.elements.iter().enumerate().find_map(|(index, e)| {
        let info = model
            .class(index)
            .states
            .get(state.checked_sub(e.state)?)
            .filter(|_| e.dynamic)?;
        let origin = &model.compiled.system.elements[index].origin;
        Some((origin, info))
    })
}
