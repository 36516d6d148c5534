//! The steady motion of an engine at a position: its velocities and accelerations when only the stated
//! motions occur.
//!
//! The constraints leave freedoms. The following kinds of conditions give their velocities in this order.
//! Each kind decides only the freedoms that earlier kinds leave. If conditions of one kind contradict each
//! other, least squares decide.
//!
//! 1. velocities stated by `start` that are not zero;
//! 2. the rate of each eccentricity, seen from its shell: zero;
//! 3. modal rates: zero;
//! 4. the rate of the axis of each pin, seen from its shell: zero, where eccentricities leave it, as on one film;
//! 5. velocities that `start` states to be zero, without another component;
//! 6. velocities stated by `guess`;
//! 7. relative rates of dampers, then of springs (the rows of their forces' derivatives): zero;
//! 8. zeros beside another component of a stated vector;
//! 9. the remaining freedoms: least kinetic energy.
//!
//! Along a path that is known at all angles of a period ([`SteadyMotion::along_path`]) the velocities are
//! those of the path. The least scaled change makes the constraints, 1 and 5 hold.
//!
//! The zeros of a stated vector such as the velocity of a shaft come last for this reason: a shaft that is
//! stated to turn about the ground's axis alone tilts in its bearings, or with the block on its mounts, and
//! then turns about its own axis. Otherwise its pins would circle in their shells, or block and shaft about
//! the ground's axis, at the speed of the shaft.
//!
//! The deciding combinations of rows are chosen once, at the assembled position. At any other position the
//! same combinations give the velocities by a linear system. The steady acceleration is the rate of these
//! velocities along the motion itself.

use super::picking::{DETERMINED, free_of, split_above, unit_rows};
use super::source::{Source, stated};
use crate::assembly::at;
use crate::assembly::rows::{Along, Rows, pins};
use crate::error::RuntimeError;
use crate::flexible::Work;
use crate::model::Model;
use crate::state::{State, move_pose};
use eng_system::dense::largest_scaled;
use eng_system::system::Role;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Length (in scaled velocities) below which a row counts as empty. Rows of joints have a length of about one
/// in these units, so that a shorter one is only rounding. Divided by its length it would be an arbitrary
/// condition.
const EMPTY: f64 = 1e-12;
/// Along a path, a row counts only if earlier rows leave more than this share of it. The tilts of driven
/// shafts have less. The limit is a choice between these and rows that differ on purpose.
const TILTS: f64 = 1e-2;
/// Scaled increment of a position for differences of rates. It is about the cube root of the rounding unit:
/// the error of a central difference, the square of the increment, and that of rounding, 1e-16 over the
/// increment, are then 1e-10 or less.
const DIFFERENCE: f64 = 1e-5;
/// Time between two velocities for a difference quotient, as a part of the time in which the motion covers
/// the model's length or a radian. It is about the fifth root of the rounding unit, 7e-4: with differences of
/// fourth order the error of the quotient, the fourth power of the time, and that of rounding, 1e-16 over the
/// time, are then both about 1e-12 or less.
const APART: f64 = 5e-4;

#[derive(Clone, Debug)]
struct Level {
    source: Source,
    /// Factors of its rows.
    factors: Vec<f64>,
    /// The deciding combinations of the rows.
    pick: DMatrix<f64>,
}

/// The steady motion at all positions near the assembled one.
#[derive(Clone, Debug)]
pub struct SteadyMotion {
    constraints: Rows,
    factors: Vec<f64>,
    levels: Vec<Level>,
    /// Rows for the freedoms without another condition: space × mass, at the assembled position.
    rest: DMatrix<f64>,
    scales: Vec<f64>,
    /// The directions that the constraints leave free at the assembled position, in scaled velocities.
    pub free: DMatrix<f64>,
}

/// Conditions on velocities at a position: `rows · y + values = 0`, with the scaled velocities y.
pub struct Kept {
    /// H.
    pub rows: DMatrix<f64>,
    values: DVector<f64>,
    /// Factors of HHᵀ.
    square: LU<f64, Dyn, Dyn>,
}

impl Kept {
    /// The least change of scaled velocities that changes the rows by `wanted`.
    pub fn least(&self, wanted: &DVector<f64>) -> Result<DVector<f64>, NoMotion> {
        let solved = self.square.solve(wanted).ok_or(NoMotion::Singular)?;
        Ok(self.rows.tr_mul(&solved))
    }
}

/// Whether a constraint, a `start` or a `guess` requires a velocity that is not zero. Without one the steady motion
/// is rest, which is known without its equations: their effort grows with the cube of the freedoms.
pub fn is_moved(model: &Model, state: &State) -> Result<bool, RuntimeError> {
    let mut resting = state.clone();
    resting.velocity.fill(0.0);
    let demanded = rows_of(model, |e| model.elements[e].dynamic).rates(model, &at(&resting))?;
    let stated = rows_of(model, |e| {
        let role = &model.compiled.system.elements[e].role;
        matches!(role, Role::StartVelocity { .. })
    });
    let (missed, _) = stated.evaluate(model, &at(&resting), Along::Velocity)?;
    Ok(demanded
        .iter()
        .chain(missed.iter())
        .any(|rate| *rate != 0.0))
}

/// The reason for a missing steady motion.
#[derive(Clone, Debug, PartialEq)]
pub enum NoMotion {
    /// The mechanism is locked here, or numbers are not finite.
    Singular,
    /// Another error.
    Error(RuntimeError),
}

impl From<RuntimeError> for NoMotion {
    fn from(error: RuntimeError) -> NoMotion {
        NoMotion::Error(error)
    }
}

impl SteadyMotion {
    /// Chooses the sources of the velocities at an assembled state.
    pub fn new(model: &Model, state: &State) -> Result<SteadyMotion, NoMotion> {
        let pins = pins(model);
        let loads = |damping: bool| -> Vec<usize> {
            (0..model.elements.len())
                .filter(|e| {
                    let class = model.class(*e);
                    model.elements[*e].dynamic
                        && class.facts.applies_load
                        && class.facts.uses_twist == damping
                        && !pins.iter().any(|pin| pin.element == *e)
                })
                .collect()
        };
        let (dampers, springs) = (loads(true), loads(false));
        let [moving, still, beside, guessed] = stated(model, state)?;
        let sources = vec![
            moving,
            Source::Pins(pins.clone()),
            Source::Own(modal(model)),
            Source::Axes(pins),
            still,
            guessed,
            Source::Loads(dampers),
            Source::Loads(springs),
            beside,
        ];
        SteadyMotion::decide(model, state, sources, DETERMINED)
    }

    /// The conditions on velocities along a path. Stated zeros come after the shapes and frames of flexible
    /// bodies, because a sagging shaft turns about a tilted axis.
    pub fn along_path(model: &Model, state: &State) -> Result<SteadyMotion, NoMotion> {
        let flexible = model
            .bodies
            .iter()
            .filter(|b| b.modes() > 0)
            .flat_map(|b| b.velocity..b.velocity + b.width());
        let [moving, still, ..] = stated(model, state)?;
        let sources = vec![moving, Source::Own(flexible.collect()), still];
        // without this limit the tilts of a driven shaft would compensate a difference between drive and
        // stated speed
        SteadyMotion::decide(model, state, sources, TILTS)
    }

    /// A combination of the rows of a source counts only if earlier rows leave more than `least` of it.
    fn decide(
        model: &Model,
        state: &State,
        sources: Vec<Source>,
        least: f64,
    ) -> Result<SteadyMotion, NoMotion> {
        let mut motion = SteadyMotion {
            constraints: rows_of(model, |e| model.elements[e].dynamic),
            factors: Vec::new(),
            levels: Vec::new(),
            rest: DMatrix::zeros(0, model.velocities),
            scales: model.velocity_scales(),
            free: DMatrix::identity(model.velocities, model.velocities),
        };
        let (_, mut gradients) = motion.constraint_rows(model, state)?;
        motion.factors = unit_rows(&mut gradients, EMPTY);
        motion.free = free_of(&gradients).ok_or(NoMotion::Singular)?;
        let mut open = motion.free.clone();
        for source in sources {
            let (_, mut matrix) = motion.rows_of_source(model, state, &source)?;
            let factors = unit_rows(&mut matrix, EMPTY);
            let picked = split_above(&(&matrix * &open), least).ok_or(NoMotion::Singular)?;
            open = &open * picked.free;
            motion.levels.push(Level {
                source,
                factors,
                pick: picked.pick,
            });
        }
        motion.rest = open.transpose() * motion.mass(model, state);
        unit_rows(&mut motion.rest, 0.0);
        Ok(motion)
    }

    /// Mass matrix in scaled velocities.
    pub fn mass(&self, model: &Model, state: &State) -> DMatrix<f64> {
        let mut mass = DMatrix::zeros(model.velocities, model.velocities);
        let mut work = Work::default();
        for body in &model.bodies {
            let width = body.width();
            let mut block = vec![0.0; width * width];
            body.add_mass(&body.frame(&state.pose), &mut work, &mut block);
            for i in 0..width {
                for j in 0..width {
                    let (row, column) = (body.velocity + i, body.velocity + j);
                    mass[(row, column)] +=
                        block[i * width + j] * self.scales[row] * self.scales[column];
                }
            }
        }
        mass
    }

    /// Scale of each velocity ([`Model::velocity_scales`]): a velocity (SI) is its scaled velocity (1/s)
    /// times it.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// Φ̇ at rest and G, columns scaled.
    fn constraint_rows(
        &self,
        model: &Model,
        state: &State,
    ) -> Result<(DVector<f64>, DMatrix<f64>), RuntimeError> {
        let mut resting = state.clone();
        resting.velocity.fill(0.0);
        let (_, mut matrix) = self
            .constraints
            .evaluate(model, &at(&resting), Along::Pose)?;
        self.scale_columns(&mut matrix);
        Ok((self.constraints.rates(model, &at(&resting))?, matrix))
    }

    pub(super) fn scale_columns(&self, matrix: &mut DMatrix<f64>) {
        for (mut column, scale) in matrix.column_iter_mut().zip(&self.scales) {
            column.scale_mut(*scale);
        }
    }

    /// Velocities at a position. In SI: m/s, rad/s in the body's axes, and modal rates.
    pub fn velocity(&self, model: &Model, state: &State) -> Result<Vec<f64>, NoMotion> {
        let (matrix, rhs, _) = self.equations(model, state)?;
        let y = matrix.lu().solve(&rhs).ok_or(NoMotion::Singular)?;
        if y.iter().any(|x| !x.is_finite()) {
            return Err(NoMotion::Singular);
        }
        Ok(y.iter().zip(&self.scales).map(|(y, s)| y * s).collect())
    }

    /// Derivative of the velocities with respect to the position (scaled), as far as the rows of the films
    /// need it: a pin that is displaced from its axis of rotation would circle in its shell.
    pub fn slopes(
        &self,
        model: &Model,
        state: &State,
        velocity: &[f64],
    ) -> Result<DMatrix<f64>, NoMotion> {
        let n = model.velocities;
        let (matrix, _, films) = self.equations(model, state)?;
        let mut rhs = DMatrix::zeros(n, n);
        if films.is_empty() {
            return Ok(rhs);
        }
        let mut pose = state.pose.clone();
        let mut increment = vec![0.0; n];
        for (first, level) in films {
            let mut rates = DMatrix::zeros(level.factors.len(), n);
            for j in 0..n {
                increment[j] = DIFFERENCE * self.scales[j];
                for sign in [1.0, -1.0] {
                    move_pose(model, &state.pose, &increment, sign, &mut pose);
                    let moved = level.source.film_rates(model, &pose, velocity);
                    for (i, rate) in moved.into_iter().flatten().enumerate() {
                        rates[(i, j)] += sign * rate / (2.0 * DIFFERENCE);
                    }
                }
                increment[j] = 0.0;
            }
            for (i, factor) in level.factors.iter().enumerate() {
                rates.row_mut(i).scale_mut(-factor);
            }
            rhs.rows_mut(first, level.pick.nrows())
                .copy_from(&(&level.pick * rates));
        }
        matrix.lu().solve(&rhs).ok_or(NoMotion::Singular)
    }

    /// The conditions on the velocities of a path at a position.
    fn kept(&self, model: &Model, state: &State) -> Result<Kept, RuntimeError> {
        let (values, rows) = self.constraint_rows(model, state)?;
        let mut parts = vec![weighed(values, rows, &self.factors)];
        let mut count = self.factors.len();
        for level in self.kept_levels() {
            count += level.pick.nrows();
            let (values, rows) = self.rows_of_source(model, state, &level.source)?;
            let (values, rows) = weighed(values, rows, &level.factors);
            parts.push((&level.pick * values, &level.pick * rows));
        }
        let mut values = DVector::zeros(count);
        let mut rows = DMatrix::zeros(count, model.velocities);
        let mut next = 0;
        for (own, part) in parts {
            values.rows_mut(next, own.len()).copy_from(&own);
            rows.rows_mut(next, own.len()).copy_from(&part);
            next += own.len();
        }
        Ok(Kept {
            square: (&rows * rows.transpose()).lu(),
            values,
            rows,
        })
    }

    /// The velocities nearest to given ones (scaled) that satisfy the conditions at a position, and these
    /// conditions.
    pub fn nearest(
        &self,
        model: &Model,
        state: &State,
        preferred: &[f64],
    ) -> Result<(Vec<f64>, Kept), NoMotion> {
        let kept = self.kept(model, state)?;
        let mut y = DVector::from_fn(model.velocities, |i, _| preferred[i] / self.scales[i]);
        // the second pass removes the rounding of the first
        for _ in 0..2 {
            let missed = &kept.rows * &y + &kept.values;
            y -= kept.least(&missed)?;
        }
        if y.iter().any(|x| !x.is_finite()) {
            return Err(NoMotion::Singular);
        }
        let velocity = y.iter().zip(&self.scales).map(|(y, s)| y * s).collect();
        Ok((velocity, kept))
    }

    /// The violation of the constraints at a position, and their rows, in scaled increments.
    pub fn missed_places(
        &self,
        model: &Model,
        state: &State,
    ) -> Result<(DVector<f64>, DMatrix<f64>), RuntimeError> {
        let (values, mut matrix) = self.constraints.evaluate(model, &at(state), Along::Pose)?;
        self.scale_columns(&mut matrix);
        Ok(weighed(values, matrix, &self.factors))
    }

    /// The violation of the conditions on velocities at a position, and these rows, in scaled velocities.
    pub fn missed_rates(
        &self,
        model: &Model,
        state: &State,
        velocity: &[f64],
    ) -> Result<(DVector<f64>, DMatrix<f64>), RuntimeError> {
        let kept = self.kept(model, state)?;
        let y = DVector::from_fn(model.velocities, |i, _| velocity[i] / self.scales[i]);
        let missed = &kept.rows * y + &kept.values;
        Ok((missed, kept.rows))
    }

    fn kept_levels(&self) -> impl Iterator<Item = &Level> {
        self.levels.iter().filter(|l| {
            l.pick.nrows() > 0 && !matches!(l.source, Source::Own(_) | Source::Loads(_))
        })
    }

    /// The values of the conditions for the velocities of a state. In scaled velocities (1/s); zero if all
    /// hold.
    pub fn missed(&self, model: &Model, state: &State) -> Result<DVector<f64>, RuntimeError> {
        let rates = self.constraints.rates(model, &at(state))?;
        let mut out: Vec<f64> = rates
            .iter()
            .zip(&self.factors)
            .map(|(r, f)| r * f)
            .collect();
        for level in self.kept_levels() {
            let mut values = match &level.source {
                Source::Stated(rows, chosen) => rows.values(model, &at(state))?.select_rows(chosen),
                source => match source.film_rates(model, &state.pose, &state.velocity) {
                    Some(rates) => DVector::from_vec(rates),
                    None => continue,
                },
            };
            for (value, factor) in values.iter_mut().zip(&level.factors) {
                *value *= factor;
            }
            out.extend((&level.pick * values).iter());
        }
        Ok(DVector::from_vec(out))
    }

    /// The equations of the velocities: matrix and right side, and the first row of each level of films.
    #[allow(clippy::type_complexity)]
    fn equations(
        &self,
        model: &Model,
        state: &State,
    ) -> Result<(DMatrix<f64>, DVector<f64>, Vec<(usize, &Level)>), NoMotion> {
        let n = model.velocities;
        let mut films = Vec::new();
        let mut matrix = DMatrix::zeros(n, n);
        let mut rhs = DVector::zeros(n);
        let (values, gradients) = self.constraint_rows(model, state)?;
        let mut next = 0;
        let mut take = |rows: &DMatrix<f64>, values: &DVector<f64>| {
            for i in 0..rows.nrows() {
                if next < n {
                    matrix.row_mut(next).copy_from(&rows.row(i));
                    rhs[next] = -values[i];
                }
                next += 1;
            }
            next
        };
        let (values, gradients) = weighed(values, gradients, &self.factors);
        let mut first = take(&gradients, &values);
        for level in &self.levels {
            if level.pick.nrows() == 0 {
                continue;
            }
            let (values, rows) = self.rows_of_source(model, state, &level.source)?;
            let (values, rows) = weighed(values, rows, &level.factors);
            if matches!(level.source, Source::Pins(_) | Source::Axes(_)) {
                films.push((first, level));
            }
            first = take(&(&level.pick * rows), &(&level.pick * values));
        }
        if take(&self.rest, &DVector::zeros(self.rest.nrows())) != n {
            return Err(NoMotion::Singular);
        }
        Ok((matrix, rhs, films))
    }

    /// Velocities at a position, and their rates along the motion by one-sided differences of fourth order.
    /// Velocities in SI, their rates in SI per second.
    pub fn rates(&self, model: &Model, state: &State) -> Result<(Vec<f64>, Vec<f64>), NoMotion> {
        // f' = (−25 f₀ + 48 f₁ − 36 f₂ + 16 f₃ − 3 f₄)/12h
        const WEIGHTS: [f64; 5] = [-25.0, 48.0, -36.0, 16.0, -3.0];
        let velocity = self.velocity(model, state)?;
        let motion_rate = self.motion_rate(&velocity);
        if motion_rate == 0.0 {
            return Ok((velocity, vec![0.0; model.velocities]));
        }
        let h = APART / motion_rate;
        let mut rate = vec![0.0; model.velocities];
        let mut near = state.clone();
        let mut now = velocity.clone();
        for (i, weight) in WEIGHTS.iter().enumerate() {
            for (r, v) in rate.iter_mut().zip(&now) {
                *r += weight * v / (12.0 * h);
            }
            if i + 1 == WEIGHTS.len() {
                break;
            }
            let base = near.clone();
            let start = now;
            now = self.advance(model, &base, &start, h, &mut near)?;
        }
        Ok((velocity, rate))
    }

    /// Moves a position along the motion by h (s) in one fourth-order Runge–Kutta step. Returns the
    /// velocities there.
    pub fn advance(
        &self,
        model: &Model,
        from: &State,
        velocity: &[f64],
        h: f64,
        to: &mut State,
    ) -> Result<Vec<f64>, NoMotion> {
        let mut stage = |increment: &[f64], part: f64| -> Result<Vec<f64>, NoMotion> {
            to.time = from.time + part * h;
            move_pose(model, &from.pose, increment, part * h, &mut to.pose);
            self.velocity(model, to)
        };
        let k2 = stage(velocity, 0.5)?;
        let k3 = stage(&k2, 0.5)?;
        let k4 = stage(&k3, 1.0)?;
        let mean: Vec<f64> = (0..velocity.len())
            .map(|i| (velocity[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0)
            .collect();
        stage(&mean, 1.0)
    }

    /// The rate (1/s) at which the motion covers the model's length or a radian: the largest scaled velocity.
    pub fn motion_rate(&self, velocity: &[f64]) -> f64 {
        largest_scaled(velocity, &self.scales)
    }
}

/// Indices of all modal rates.
pub fn modal(model: &Model) -> Vec<usize> {
    model
        .bodies
        .iter()
        .flat_map(|b| b.velocity + 6..b.velocity + b.width())
        .collect()
}

pub(super) fn rows_of(model: &Model, wanted: impl Fn(usize) -> bool) -> Rows {
    Rows::new(
        model,
        (0..model.elements.len())
            .filter(|e| wanted(*e) && !model.class(*e).rows.is_empty())
            .collect(),
    )
}

fn weighed(
    mut values: DVector<f64>,
    mut rows: DMatrix<f64>,
    factors: &[f64],
) -> (DVector<f64>, DMatrix<f64>) {
    for (i, factor) in factors.iter().enumerate().take(rows.nrows()) {
        values[i] *= factor;
        rows.row_mut(i).scale_mut(*factor);
    }
    (values, rows)
}
