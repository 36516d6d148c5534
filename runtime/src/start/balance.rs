//! Balance of all freedoms without a stated value, in the steady motion. It uses Newton's method with the
//! exact matrix, and applies the load in portions.
//!
//! Unknowns are increments of the positions, multipliers λ of the constraints and efforts σ of the held
//! directions:
//!
//! ```text
//! r = M v̇ − Q_v − Q_g − Σ JᵀW + Gᵀλ + Eᵀσ = (1 − s) r₀        Φ = 0        E: held directions
//! ```
//!
//! with the velocities and accelerations of the steady motion. M is the mass, Q_v the inertia of the
//! velocities, Q_g gravity, W the wrench at a marker with the Jacobian J of its twist, G the gradients of the
//! constraints Φ, and E the rows of the held directions. r₀ is the residual at the assembled position, which
//! solves s = 0. s grows to 1 in portions, which are halved if Newton's method fails. An iterate leaves
//! at least a quarter of the remaining film, because beyond the shell the film laws have no meaning. Where
//! the surface yields, a pin may leave this circle. It then moves by a quarter of the clearance at most. At
//! rest the search does not end at a position without stiffness, and it recognises a balance that is upside
//! down (`stability`).

mod describing;
mod holding;
mod stability;
pub(crate) mod turning;

use super::eccentricity::{end_ratios, film_ratios, half_widths, yielding};
use super::motion::SteadyMotion;
use super::picking::{DETERMINED, split_above, unit_rows};
use super::{Equilibrium, JournalStart, Obstacle};
use crate::assembly::rows::Rows;
use crate::body::Weights;
use crate::dynamics::Dynamics;
use crate::dynamics::MatrixPlan;
use crate::error::RuntimeError;
use crate::model::Model;
use crate::outputs::Watch;
use crate::state::{State, move_pose};
use describing::{locked, no_number, not_finite};
use eng_system::dense::largest_difference;
use eng_system::system::{Origin, Role};
pub use holding::Terms;
use nalgebra::{DMatrix, DVector};

/// Share of a freedom's inertia times the square of the rate of the motion, below which its stiffness counts as
/// zero, in a first search and in later ones. The first is a choice far above rounding. The friction of a
/// film that does not see a tilt gives the tilt a stiffness of some millionths, in which rounding is a large
/// move. The second limit leaves such freedoms in place.
const NEUTRAL: [f64; 2] = [1e-6, 1e-3];
/// Part of a film that an iterate must leave, and share of the clearance by which a pin may move outwards
/// where its shell yields. A choice: the force of a film grows without bound towards the shell, so its slope
/// at an iterate misleads a step that takes away most of the film. A larger part costs iterations until a
/// film is thin.
const LEFT: f64 = 0.25;
/// Largest move of an iterate, in the model's length or rad. A choice: 0.2 rad, some 11°, is about as far as
/// the linear equations of a mechanism describe it. Larger moves may end at another position of the joints;
/// smaller ones cost iterations.
const REACH: f64 = 0.2;
/// Iterations of a portion, in a first search and in later ones. After these the portion is halved. A choice:
/// Newton's method doubles the digits in each iteration once it is near, so 25 are for the way until there.
/// Later searches shorten their steps and need more.
const ITERATIONS: [usize; 2] = [25, 60];
/// Growth of the residual above which a step of a later search is too long. A choice above one, because the
/// residual of curved films may grow a little on the way to a balance.
const GROWTH: f64 = 1.5;
/// The factor that shortens such a step. A choice: with the limit [`LEAST_PART`] a whole step is shortened at
/// most six times.
const SHORTER: f64 = 0.3;
/// Least part of such a step. The seventh residual is accepted, so that the search can leave a place from
/// which every direction leads upwards.
const LEAST_PART: f64 = 1e-3;
/// The row of a moving part holds nothing of its own if other rows leave at most this share of it free.
/// Beside a drive the row of a leaning shaft leaves a ten-thousandth: its tilt. Held, this tilt would carry
/// the torque of the drive over the small angle, which is meganewton metres. The limit is ten times this.
const MOVES: f64 = 1e-3;
/// Smallest portion of the load: nine halvings of the whole are tried. A choice: a balance that follows the
/// load needs few portions, and each that fails costs all its iterations.
const PORTION: f64 = 1e-3;
/// Scaled effort above which a freedom without stiffness counts as loaded, in a first search and in later
/// ones. Later searches leave freedoms with some stiffness in place, so their limit is smaller: at 1e-6, the
/// first limit of [`NEUTRAL`], a load of 1e-12 would move such a freedom by about a millionth of the model's
/// length.
const UNHELD: [f64; 2] = [1e-6, 1e-12];
/// Move (m, or of a quaternion) up to which a balance counts as the stated position. A choice: far above the
/// goal of the iterations, and far below the distance of two balances.
const STAYS: f64 = 1e-6;
/// Most rounds in which velocities and accelerations are computed again. A choice: velocities change little
/// with the position, so each round moves the balance much less than the one before.
const ROUNDS: usize = 8;

/// The reason for a missing balance.
#[derive(Clone, Debug, PartialEq)]
pub enum Stop {
    /// An obstacle in the model.
    Obstacle(Obstacle),
    /// The model cannot be evaluated.
    Error(RuntimeError),
}

impl From<RuntimeError> for Stop {
    fn from(error: RuntimeError) -> Stop {
        match error {
            RuntimeError::NotFinite {
                origin, because, ..
            } => Stop::Obstacle(Obstacle {
                origin: *origin,
                message: no_number(&because),
                carried: 0.0,
            }),
            other => Stop::Error(other),
        }
    }
}

/// Whether a balance is the position at which its search began. A quaternion and its negative are one
/// orientation.
fn stays(model: &Model, begin: &State, end: &State) -> bool {
    let near = |(a, b): (&f64, &f64), sign: f64| (a - sign * b).abs() <= STAYS;
    model.bodies.iter().all(|body| {
        let range = body.pose..body.pose + 7 + body.modes();
        let (Some(from), Some(to)) = (begin.pose.get(range.clone()), end.pose.get(range)) else {
            return false;
        };
        [1.0, -1.0].iter().any(|sign| {
            from.iter()
                .zip(to)
                .enumerate()
                .all(|(i, pair)| near(pair, if (3..7).contains(&i) { *sign } else { 1.0 }))
        })
    })
}

/// The search for the balance of one model.
#[derive(Debug)]
pub struct Balance<'a> {
    model: &'a Model,
    terms: Terms,
    /// Whether an earlier search found nothing. Then steps that enlarge the residual become shorter.
    again: bool,
    /// Half of the width of each film (m).
    half_widths: Vec<f64>,
    motion: SteadyMotion,
    dynamics: Dynamics,
    /// Angles, which a search at rest may turn by whole turns.
    watch: Watch,
    plan: MatrixPlan,
    values: Vec<f64>,
    /// `start` rows on positions.
    stated: Rows,
    /// Independent rows among [stated rows; fixed rows]: none follows from the others.
    holding: Vec<usize>,
    /// Rows of the directions held besides the stated positions, in scaled velocities.
    fixed: DMatrix<f64>,
    fixed_names: Vec<(Origin, bool)>,
    factors: Vec<f64>,
    /// Freedoms, in scaled velocities: constraints and holds leave them.
    movable: DMatrix<f64>,
    /// Rows of freedoms that nothing holds.
    neutral: DMatrix<f64>,
    freedoms: usize,
    /// Rate of the motion (1/s), its largest scaled velocity; 1 at rest.
    motion_rate: f64,
    /// Force times length (J) against which residuals are measured.
    unit: f64,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    /// Rows of the held directions at another angle of a turn, in scaled velocities.
    turned: Option<DMatrix<f64>>,
    /// Whether the inertia of the bending of turning bodies counts.
    softened: bool,
}

/// A position with its multipliers and efforts.
#[derive(Clone, Debug)]
struct Place {
    state: State,
    efforts: DVector<f64>,
}

/// A step of a later search, which may become shorter.
struct Taken {
    from: Place,
    step: DVector<f64>,
    part: f64,
    /// Residual before it.
    norm: f64,
}

impl<'a> Balance<'a> {
    /// Divides the freedoms into moving, held and balanced ones, at an assembled state.
    pub fn new(
        model: &'a Model,
        state: &State,
        terms: Terms,
        again: bool,
    ) -> Result<Balance<'a>, Stop> {
        let system = &model.compiled.system;
        let motion = SteadyMotion::new(model, state).map_err(|e| locked(model, e))?;
        let stated = Rows::new(
            model,
            (0..model.elements.len())
                .filter(|e| {
                    terms.positions
                        && system.elements[*e].role == Role::StartPosition { exact: true }
                        && !model.class(*e).rows.is_empty()
                })
                .collect(),
        );
        let (velocity, acceleration) = if terms.rest {
            (vec![0.0; model.velocities], vec![0.0; model.velocities])
        } else {
            motion.rates(model, state).map_err(|e| locked(model, e))?
        };
        let motion_rate = motion.motion_rate(&velocity);
        let motion_rate = if motion_rate > 0.0 { motion_rate } else { 1.0 };
        let plan = MatrixPlan::new(model);
        let mut balance = Balance {
            model,
            terms,
            again,
            half_widths: half_widths(model),
            dynamics: Dynamics::new(model),
            watch: Watch::new(model, |_| true),
            values: vec![0.0; plan.pattern.count()],
            plan,
            stated,
            holding: Vec::new(),
            fixed: DMatrix::zeros(0, model.velocities),
            fixed_names: Vec::new(),
            factors: Vec::new(),
            movable: DMatrix::zeros(model.velocities, 0),
            neutral: DMatrix::zeros(0, model.velocities),
            freedoms: 0,
            motion_rate,
            unit: model.mass * model.length * model.length * motion_rate * motion_rate,
            velocity,
            acceleration,
            motion,
            turned: None,
            softened: true,
        };
        (balance.fixed, balance.fixed_names) = balance.what_moves(state)?;
        let (_, mut rows) = balance.holds(state)?;
        // rows have a length of about one in scaled velocities: a shorter one is rounding
        balance.factors = unit_rows(&mut rows, 1e-12);
        let mut free = balance.motion.free.clone();
        for i in 0..rows.nrows() {
            let least = if i < balance.stated.len() {
                DETERMINED
            } else {
                MOVES
            };
            let left =
                split_above(&(rows.rows(i, 1) * &free), least).ok_or_else(|| not_finite(model))?;
            if left.pick.nrows() > 0 {
                balance.holding.push(i);
                free *= left.free;
            }
        }
        balance.freedoms = free.ncols();
        balance.find_neutral(state, &free, motion_rate)?;
        balance.movable = free;
        Ok(balance)
    }

    /// The state with its bodies moved as its loads push them, until the thinnest film has the eccentricity
    /// ratio `ratio`; `None` if no film becomes so thin.
    pub fn leaning(&mut self, state: &State, ratio: f64) -> Result<Option<State>, Stop> {
        let model = self.model;
        let place = Place {
            state: state.clone(),
            efforts: DVector::zeros(self.holding.len() + self.neutral.nrows()),
        };
        let residual = self
            .residual(&place)?
            .rows(0, model.velocities)
            .into_owned();
        let push = -(&self.movable * (self.movable.transpose() * residual));
        let size = push.amax();
        if !(size > 0.0 && size.is_finite()) {
            return Ok(None);
        }
        let scales = self.motion.scales().iter();
        let increment: Vec<f64> = scales
            .zip(&push)
            .map(|(scale, push)| scale * push / size)
            .collect();
        let mut leaning = state.clone();
        let mut thinnest = |factor: f64| {
            move_pose(model, &state.pose, &increment, factor, &mut leaning.pose);
            end_ratios(model, &self.half_widths, &leaning.pose)
                .into_iter()
                .fold(0.0, f64::max)
        };
        // begins with a move far below every clearance, which is doubled
        let (mut low, mut high) = (0.0, 1e-9);
        while thinnest(high) < ratio {
            (low, high) = (high, 2.0 * high);
            if high > REACH {
                return Ok(None);
            }
        }
        // 30 halvings leave 1e-9 of the interval, far less than a search needs to begin
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if thinnest(middle) < ratio {
                low = middle;
            } else {
                high = middle;
            }
        }
        thinnest(low);
        Ok(Some(leaning))
    }

    /// Scaled residual: balance, constraints, holds. Dimensionless. Shape: velocities, then constraint rows,
    /// then held rows. Its sign is that of r in the head of this module.
    fn residual(&mut self, place: &Place) -> Result<DVector<f64>, Stop> {
        if !self.terms.rest {
            let velocity = self.motion.velocity(self.model, &place.state);
            self.velocity = velocity.map_err(|e| locked(self.model, e))?;
        }
        self.imbalance(place)
    }

    /// The same residual with the present velocities. Shape and units are the same.
    fn imbalance(&mut self, place: &Place) -> Result<DVector<f64>, Stop> {
        let model = self.model;
        let (n, m) = (model.velocities, model.rows);
        let state = &place.state;
        self.dynamics
            .place(model, state.time, &state.pose, &self.velocity);
        self.dynamics
            .gather(model, &state.states, &state.multipliers, &state.rotations);
        self.dynamics.evaluate(model)?;
        let mut balance = vec![0.0; n];
        self.dynamics
            .add_inertia(model, &self.velocity, &self.acceleration, &mut balance);
        self.dynamics.add_forces(model, -1.0, &mut balance);
        if !self.softened {
            let mut softening = DMatrix::zeros(n, n);
            self.add_softening(state, -1.0, &mut softening);
            let mut shapes = DVector::zeros(n);
            for body in &model.bodies {
                for k in 0..body.modes() {
                    let i = body.velocity + 6 + k;
                    shapes[i] = state.pose[body.pose + 7 + k] / self.motion.scales()[i];
                }
            }
            let stiffer = softening * shapes;
            for i in 0..n {
                balance[i] += stiffer[i] * self.unit / self.motion.scales()[i];
            }
        }
        let (values, rows) = self.held(state)?;
        let mut out = DVector::zeros(n + m + rows.nrows());
        for i in 0..n {
            let held: f64 = (0..place.efforts.len())
                .map(|k| rows[(k, i)] * place.efforts[k])
                .sum();
            out[i] = balance[i] * self.motion.scales()[i] / self.unit + held;
        }
        for (i, scale) in model.row_scales().iter().enumerate() {
            out[n + i] = self.dynamics.constraints()[i] / scale;
        }
        for i in 0..rows.nrows() {
            out[n + m + i] = values[i];
        }
        Ok(out)
    }

    /// Fills the matrix of the step's equations at the position of the last residual.
    fn fill(&mut self, weights: Weights) -> Result<(), RuntimeError> {
        let model = self.model;
        self.plan.fill(
            model,
            &mut self.dynamics,
            &self.velocity,
            &self.acceleration,
            &vec![0.0; model.velocities],
            weights,
            1.0,
            &mut self.values,
        )
    }

    /// The scaled matrix at the position of the last residual. Velocities depend on the position
    /// ([`SteadyMotion::slopes`]).
    fn matrix(&mut self, state: &State) -> Result<DMatrix<f64>, Stop> {
        let model = self.model;
        let (n, m, s) = (model.velocities, model.rows, model.states);
        let by_velocity = |velocity: f64| Weights {
            acceleration: 0.0,
            velocity,
        };
        self.fill(by_velocity(1.0))?;
        let moving = self.values.clone();
        self.fill(by_velocity(0.0))?;
        let (_, rows) = self.held(state)?;
        let size = n + m + rows.nrows();
        let mut out = DMatrix::zeros(size, size);
        let scales = self.motion.scales();
        let row_scales = model.row_scales();
        let index = |i: usize| {
            if i < n {
                Some(i)
            } else if i < n + s {
                None
            } else {
                Some(i - s)
            }
        };
        let pattern = &self.plan.pattern;
        let mut damping = DMatrix::zeros(n, n);
        for (place, row, column) in pattern.places() {
            let (Some(r), Some(c)) = (index(row), index(column)) else {
                continue;
            };
            let value = self.values[place];
            if r < n && c < n {
                damping[(r, c)] = (moving[place] - value) * scales[r] * scales[c] / self.unit;
            }
            out[(r, c)] = match (r < n, c < n) {
                (true, true) => value * scales[r] * scales[c] / self.unit,
                (true, false) => value * scales[r] / row_scales[c - n],
                (false, true) => value * scales[c] / row_scales[r - n],
                (false, false) => 0.0,
            };
        }
        if !self.terms.rest {
            let slopes = self
                .motion
                .slopes(model, state, &self.velocity)
                .map_err(|e| locked(model, e))?;
            let follows = damping * slopes;
            for i in 0..n {
                for j in 0..n {
                    out[(i, j)] += follows[(i, j)];
                }
            }
        }
        for i in 0..rows.nrows() {
            for j in 0..n {
                out[(n + m + i, j)] = rows[(i, j)];
                out[(j, n + m + i)] = rows[(i, j)];
            }
        }
        if !self.softened {
            self.add_softening(state, -1.0, &mut out);
        }
        Ok(out)
    }

    /// Brings the positions, velocities and multipliers of a state into balance.
    pub fn solve(&mut self, state: &mut State) -> Result<Equilibrium, Stop> {
        if self.turns() {
            return self.turning(state);
        }
        if !self.rests() {
            return self.search(state);
        }
        let begin = state.clone();
        match self.search(state) {
            Ok(found) if found.unstable.is_none() || stays(self.model, &begin, state) => Ok(found),
            Ok(found) => {
                // Newton's method found another balance that is unstable; a stable one may exist
                let mut other = begin;
                match self.descend(&mut other) {
                    Ok(Some(stable)) if stable.unstable.is_none() => {
                        state.copy_from(&other);
                        Ok(stable)
                    }
                    Ok(_) | Err(Stop::Obstacle(_)) => Ok(found),
                    Err(error) => Err(error),
                }
            }
            Err(Stop::Obstacle(obstacle)) => {
                state.copy_from(&begin);
                match self.descend(state) {
                    Ok(Some(found)) => Ok(found),
                    Ok(None) | Err(Stop::Obstacle(_)) => Err(Stop::Obstacle(obstacle)),
                    Err(error) => Err(error),
                }
            }
            Err(error) => Err(error),
        }
    }

    /// Searches with the load in portions. Velocities depend on the position.
    fn search(&mut self, state: &mut State) -> Result<Equilibrium, Stop> {
        let (place, found) = self.balanced(state)?;
        self.adopt(state, &place, found)
    }

    /// The first position of the search.
    fn assembled(&mut self, state: &State) -> Result<Place, Stop> {
        let mut place = Place {
            state: state.clone(),
            efforts: DVector::zeros(self.holding.len() + self.neutral.nrows()),
        };
        // a hanging body has no stiffness except through the loads that carry it
        if self.rests() {
            self.carry(&mut place)?;
        } else {
            place.state.multipliers.fill(0.0);
        }
        Ok(place)
    }

    fn nothing_found(&self) -> Equilibrium {
        Equilibrium {
            freedoms: self.freedoms,
            ..Equilibrium::default()
        }
    }

    fn balanced(&mut self, state: &State) -> Result<(Place, Equilibrium), Stop> {
        let model = self.model;
        let mut place = self.assembled(state)?;
        let mut found = self.nothing_found();
        let goal = self.goal();
        for round in 0..ROUNDS {
            let before = place.state.pose.clone();
            self.load(&mut place, goal, &mut found, round == 0)?;
            if self.terms.rest {
                break;
            }
            let moved = largest_difference(&before, &place.state.pose);
            let (velocity, acceleration) = self
                .motion
                .rates(model, &place.state)
                .map_err(|e| locked(model, e))?;
            self.velocity = velocity;
            self.acceleration = acceleration;
            // a thousandth of the position tolerance: the next round would change nothing that a step of the
            // run resolves
            if !self.softened || (round > 0 && moved <= 1e-3 * model.tolerance) {
                break;
            }
        }
        Ok((place, found))
    }

    /// Searches by following the motion at rest; `None` if it reaches no balance.
    fn descend(&mut self, state: &mut State) -> Result<Option<Equilibrium>, Stop> {
        let mut place = Place {
            state: state.clone(),
            efforts: DVector::zeros(0),
        };
        let mut found = Equilibrium {
            portions: 1,
            ..Equilibrium::default()
        };
        let goal = self.goal();
        if !self.settle(&mut place, goal, &mut found)? {
            return Ok(None);
        }
        found.freedoms = self.freedoms;
        self.adopt(state, &place, found).map(Some)
    }

    /// Largest scaled move of the last iteration: a hundred-thousandth of the tolerance of positions, and at
    /// least the rounding of a position. The share is a choice, small enough that the rest of a search is
    /// invisible beside the error of a step, a tenth of the tolerance.
    fn goal(&self) -> f64 {
        (1e-5 * self.model.tolerance / self.model.length).max(1e-14)
    }

    /// Makes a balance the state, and returns its report.
    fn adopt(
        &mut self,
        state: &mut State,
        place: &Place,
        mut found: Equilibrium,
    ) -> Result<Equilibrium, Stop> {
        let model = self.model;
        found.journals = model
            .compiled
            .system
            .journals
            .iter()
            .zip(film_ratios(model, &place.state.pose))
            .map(|(journal, ratio)| JournalStart {
                path: model.compiled.system.elements[journal.element as usize]
                    .origin
                    .path
                    .clone(),
                ratio,
            })
            .collect();
        if let Some(obstacle) = self.unheld(place) {
            return Err(Stop::Obstacle(obstacle));
        }
        found.held = self.held_directions(place);
        found.idle = self.neutral.nrows();
        if self.rests() && found.held.is_empty() {
            found.unstable = self.unstable(place)?;
        }
        let velocity = self.velocity.clone();
        state.copy_from(&place.state);
        state.velocity.copy_from_slice(&velocity);
        Ok(found)
    }

    /// Applies the load in portions, with the present velocities and accelerations.
    fn load(
        &mut self,
        place: &mut Place,
        goal: f64,
        found: &mut Equilibrium,
        first: bool,
    ) -> Result<(), Stop> {
        let n = self.model.velocities;
        let offset = self.residual(place)?.rows(0, n).into_owned();
        let (mut done, mut portion) = (0.0_f64, 1.0_f64);
        while done < 1.0 {
            let next = (done + portion).min(1.0);
            let mut trial = place.clone();
            match self.newton(&mut trial, &(&offset * (1.0 - next)), goal, found)? {
                None => {
                    *place = trial;
                    done = next;
                    portion *= 2.0;
                    if first {
                        found.portions += 1;
                    }
                }
                Some((origin, message)) => {
                    portion *= 0.5;
                    if portion < PORTION {
                        return Err(Stop::Obstacle(Obstacle {
                            origin,
                            message,
                            carried: done,
                        }));
                    }
                }
            }
        }
        Ok(())
    }

    /// Newton's method. On failure it returns the obstacle.
    fn newton(
        &mut self,
        place: &mut Place,
        offset: &DVector<f64>,
        goal: f64,
        found: &mut Equilibrium,
    ) -> Result<Option<(Origin, String)>, Stop> {
        let model = self.model;
        let n = model.velocities;
        let mut last = f64::INFINITY;
        let mut worst = None;
        let mut taken: Option<Taken> = None;
        for _ in 0..ITERATIONS[usize::from(self.again)] {
            let mut residual = match self.residual(place) {
                Ok(residual) => residual,
                Err(Stop::Obstacle(obstacle)) => {
                    return Ok(Some((obstacle.origin, obstacle.message)));
                }
                Err(error) => return Err(error),
            };
            for i in 0..n {
                residual[i] -= offset[i];
            }
            worst = Some(self.worst(&residual));
            let norm = residual.norm();
            if let Some(taken) = &mut taken
                && norm > GROWTH * taken.norm
                && taken.part > LEAST_PART
            {
                taken.part *= SHORTER;
                *place = taken.from.clone();
                self.shift(place, &taken.step, taken.part);
                self.follow_turns(place)?;
                last = f64::INFINITY;
                continue;
            }
            let matrix = self.matrix(&place.state)?;
            let Some(step) = matrix.lu().solve(&(-residual)) else {
                break;
            };
            let size = step.rows(0, n).amax();
            if !size.is_finite() {
                break;
            }
            found.iterations += 1;
            let from = self.again.then(|| place.clone());
            let factor = self.advance(place, &step, size);
            self.follow_turns(place)?;
            taken = from.map(|from| Taken {
                from,
                step,
                part: factor,
                norm,
            });
            if factor == 1.0 {
                // near the goal, up to a hundredth of the position tolerance, moves that are not even halved
                // are rounding: Newton's method shrinks them far more
                if size <= goal || (size <= 1e3 * goal && size >= 0.5 * last) {
                    return Ok(None);
                }
                // whole steps that grow this much lead away; a smaller portion of the load begins nearer to
                // its balance. A choice above 2, because steps may grow a little before they shrink
                if size > 4.0 * last {
                    break;
                }
                last = size;
            } else {
                last = f64::INFINITY;
            }
        }
        // The obstacle is a film that has nearly vanished; without one, the row with the largest residual.
        let ratios = end_ratios(model, &self.half_widths, &place.state.pose);
        let yields = yielding(model);
        let thinnest = ratios
            .iter()
            .enumerate()
            .filter(|(journal, _)| !yields[*journal])
            .fold(None, |best: Option<(usize, f64)>, (i, r)| match best {
                Some((_, most)) if most >= *r => best,
                _ => Some((i, *r)),
            });
        if let Some((journal, ratio)) = thinnest
            // a choice: iterates leave a quarter of the film each, so only a search that ends against a shell
            // comes this near
            && ratio > 0.95
        {
            let element = model.compiled.system.journals[journal].element as usize;
            return Ok(Some((
                model.compiled.system.elements[element].origin.clone(),
                format!(
                    "its pin moves by {:.2} % of the clearance, and the film carries no more",
                    100.0 * ratio
                ),
            )));
        }
        Ok(Some(worst.unwrap_or_else(|| {
            (
                Origin::default(),
                "no part of the model can move to balance the loads".to_owned(),
            )
        })))
    }

    /// Moves by a step of Newton's method, scaled like its matrix and `size` large, as far as
    /// [`Self::allowed`]. Returns the part of the step.
    fn advance(&self, place: &mut Place, step: &DVector<f64>, size: f64) -> f64 {
        let scales = self.motion.scales();
        let increment: Vec<f64> = (0..scales.len()).map(|i| step[i] * scales[i]).collect();
        let mut pose = place.state.pose.clone();
        let factor = self.allowed(&place.state.pose, &increment, size, &mut pose);
        self.shift(place, step, factor);
        factor
    }

    /// Moves by a part of a step of Newton's method.
    fn shift(&self, place: &mut Place, step: &DVector<f64>, factor: f64) {
        let model = self.model;
        let (n, m) = (model.velocities, model.rows);
        let scales = self.motion.scales();
        let increment: Vec<f64> = (0..n).map(|i| step[i] * scales[i]).collect();
        let mut pose = place.state.pose.clone();
        move_pose(model, &place.state.pose, &increment, factor, &mut pose);
        place.state.pose.copy_from_slice(&pose);
        for (i, scale) in model.row_scales().iter().enumerate() {
            place.state.multipliers[i] += factor * step[n + i] * self.unit / scale;
        }
        for i in 0..place.efforts.len() {
            place.efforts[i] += factor * step[n + m + i];
        }
    }

    /// The part of an increment that leaves enough of every film and stays below [`REACH`].
    fn allowed(&self, pose: &[f64], increment: &[f64], size: f64, trial: &mut [f64]) -> f64 {
        let ratios = |pose: &[f64]| end_ratios(self.model, &self.half_widths, pose);
        let before = ratios(pose);
        let yields = yielding(self.model);
        let mut factor = (REACH / size).min(1.0);
        // 0.7 is a choice: a step is at most 30 % shorter than necessary. After 40 times 6e-7 of it is left, which
        // is as good as none.
        for _ in 0..40 {
            move_pose(self.model, pose, increment, factor, trial);
            let inside =
                before
                    .iter()
                    .zip(ratios(trial))
                    .zip(&yields)
                    .all(|((old, new), yields)| match yields {
                        _ if new <= *old => true,
                        true => new - old <= LEFT,
                        false => 1.0 - new >= LEFT * (1.0 - old),
                    });
            if inside {
                break;
            }
            factor *= 0.7;
        }
        factor
    }
}
