//! Velocities at the start.

use super::at;
use super::gradients::Gradients;
use super::independent::Independent;
use super::rows::{Along, Rows, pins, smallest_solution};
use crate::body::BodyModel;
use crate::error::RuntimeError;
use crate::flexible::Work;
use crate::model::Model;
use crate::state::{State, move_pose};
use eng_system::dense::largest_scaled;
use eng_system::system::Role;
use nalgebra::{DMatrix, DVector};

/// Relative to the model's speed, a row that is left by more contradicts others. A choice between the
/// rounding of a solution through nearly dependent rows and the digits in which a text may differ on purpose.
const CONTRADICTION: f64 = 1e-8;

/// Time after the start, or after a kink at the start, at which constraints and loads are on the side to which the
/// motion goes: a share of the time in which the motion covers the model's length or a radian. A choice: far above the
/// rounding of positions, 1e-16, and so short that nothing else changes.
pub(crate) const BEHIND: f64 = 1e-12;
/// The second distance from a kink as a share of the first one. A choice.
pub(crate) const NEARER: f64 = 0.25;
/// The least part of a difference that remains at the second distance if it is a jump. A choice: a difference without a
/// jump falls with the distance, to a quarter, and that of a root to a half.
pub(crate) const REMAINS: f64 = 0.5;
/// Rate of a constraint after the start that is a jump, as a share of the model's speed; the same of an acceleration or
/// the rate of a state, as a share of the largest one. A choice: without a jump they change by about 1e-12 over the time
/// [`BEHIND`].
pub(crate) const JUMP: f64 = 1e-6;
/// Most searches of the side to which the motion goes. A choice: each side may change the velocities and with
/// them the side of another constraint, but not for long.
const SIDES: usize = 4;

/// Velocities of the start; see `admissible`. A constraint may have a corner at the start, such as
/// `abs(angle)` at zero. Before its start a motion has no values, so the side to which it goes decides: the
/// state moves there by `BEHIND`, a hundredth of the gap that counts as closed.
pub fn assemble(model: &Model, state: &mut State) -> Result<(), RuntimeError> {
    admissible(model, state)?;
    let start = state.clone();
    for _ in 0..SIDES {
        let Some(behind) = behind_corner(model, &start, state)? else {
            return Ok(());
        };
        state.copy_from(&behind);
        admissible(model, state)?;
    }
    // no side is that of its own motion: the first step names the constraint that jumps
    state.copy_from(&start);
    Ok(())
}

/// A start just after a corner, along velocities at which a constraint requires other velocities there. `None`
/// if none does.
fn behind_corner(
    model: &Model,
    start: &State,
    moving: &State,
) -> Result<Option<State>, RuntimeError> {
    let system = &model.compiled.system;
    let has_corners = |element: &usize| {
        let class = model.class(*element);
        system.elements[*element].role == Role::Dynamic
            && class.kinks.iter().any(|kink| kink.constrains)
    };
    let elements: Vec<usize> = (0..model.elements.len()).filter(has_corners).collect();
    if elements.is_empty() {
        return Ok(None);
    }
    let rows = Rows::new(model, elements);
    let speed = model.largest(&moving.velocity);
    if speed == 0.0 {
        return Ok(None);
    }
    let behind = |share: f64| {
        let e = share * BEHIND / speed;
        let mut state = start.clone();
        let along: Vec<f64> = moving.velocity.iter().map(|v| e * v).collect();
        move_pose(model, &start.pose, &along, 1.0, &mut state.pose);
        state.velocity.copy_from_slice(&moving.velocity);
        state
    };
    let [far, near] = [1.0, NEARER].map(|share| rows.rates(model, &at(&behind(share))));
    let (far, near) = (far?, near?);
    let jumps = (0..rows.len()).any(|row| {
        let size = near[row].abs() / rows.scales[row];
        size > JUMP * speed && near[row].abs() >= REMAINS * far[row].abs()
    });
    Ok(jumps.then(|| behind(1.0)))
}

/// Velocities of smallest kinetic energy with `Φ̇ = 0` and the exact start rows. Guessed rows are fitted
/// first; the exact ones then correct by the smallest change. Pins keep their places in their shells as far
/// as all these rows allow.
fn admissible(model: &Model, state: &mut State) -> Result<(), RuntimeError> {
    state.velocity.fill(0.0);
    let system = &model.compiled.system;
    let of = |wanted: &dyn Fn(&Role) -> bool| -> Rows {
        Rows::new(
            model,
            (0..model.elements.len())
                .filter(|e| wanted(&system.elements[*e].role) && !model.class(*e).rows.is_empty())
                .collect(),
        )
    };
    let constraints = of(&|r| *r == Role::Dynamic);
    let exact = of(&|r| *r == Role::StartVelocity { exact: true });
    let guessed = of(&|r| *r == Role::StartVelocity { exact: false });

    let (_, gradients) = constraints.gradients(model, &at(state), Along::Pose)?;
    let by_time = constraints.rates(model, &at(state))?;
    let (exact_values, exact_matrix) = exact.gradients(model, &at(state), Along::Velocity)?;
    let (guess_values, guess_matrix) = guessed.gradients(model, &at(state), Along::Velocity)?;

    let (values, matrix) = (
        stacked(&by_time, &exact_values),
        gradients.above(exact_matrix.clone()),
    );
    let from_energy = InverseRoots::of(model, state);
    let solve = |matrix: &Gradients, rhs: &DVector<f64>| -> Result<DVector<f64>, RuntimeError> {
        let (reduced, sizes) = from_energy.after(matrix).unit_rows();
        let x = smallest_solution(&reduced, &rhs.component_div(&sizes)).ok_or_else(|| {
            RuntimeError::Malformed {
                what: "the start velocities are not finite".to_string(),
            }
        })?;
        Ok(from_energy.of_vector(&x))
    };
    let all = matrix.clone().above(guess_matrix);
    let mut v = DVector::zeros(model.velocities);
    if !guessed.is_empty() {
        v = solve(&all, &(-stacked(&values, &guess_values)))?;
    }
    // Twice: the second pass takes the rounding of the first.
    for _ in 0..2 {
        let rest = &values + matrix.times(&v);
        v += solve(&matrix, &(-rest))?;
    }
    v += keep_pins(model, state, &v, &all, &from_energy)?;
    state.velocity.copy_from_slice(v.as_slice());

    let scales = model.velocity_scales();
    let speed = largest_scaled(&state.velocity, &scales);
    let rates = constraints.rates(model, &at(state))?;
    let starts = exact.values(model, &at(state))?;
    let mut open = Vec::new();
    for (rows, values) in [(&constraints, &rates), (&exact, &starts)] {
        for (i, (element, row)) in rows.owners.iter().enumerate() {
            // Rows that state velocities have the dimension of a velocity, and their gradient gives its size
            // here.
            let scale = rows.scales[i].max(if std::ptr::eq(rows, &exact) {
                gradient_size(&exact_matrix, i, &scales)
            } else {
                0.0
            });
            let size = values[i].abs() / scale;
            // a model that hardly moves is compared with 1e-3 of its length in a second, because rates of
            // rounding contradict nothing
            if size.is_nan() || size > CONTRADICTION * speed.max(1e-3) {
                open.push((size, *element, model.named_row(*element, *row, values[i])));
            }
        }
    }
    if open.is_empty() {
        return Ok(());
    }
    open.sort_by(|a, b| b.0.total_cmp(&a.0));
    let chain = open
        .iter()
        .find_map(|(_, element, _)| super::chains::through(model, *element, state));
    // a choice: a message names the worst; the others follow from them
    open.truncate(6);
    Err(RuntimeError::StartVelocity {
        rows: open.into_iter().map(|(_, _, row)| row).collect(),
        chain: chain.map(Box::new),
    })
}

/// Rate of a pin in its shell, as a share of the model's speed, that counts as rest. A choice above the
/// rounding of velocities.
const RESTS: f64 = 1e-9;

/// The change of least kinetic energy that takes the rates of pins in their shells away, without a change of
/// other rows. Least energy alone would turn a crank that only films hold about its centre of mass, and its
/// pins would leave their shells. In SI: m/s, rad/s and modal rates.
fn keep_pins(
    model: &Model,
    state: &State,
    v: &DVector<f64>,
    others: &Gradients,
    from_energy: &InverseRoots,
) -> Result<DVector<f64>, RuntimeError> {
    let none = || DVector::zeros(model.velocities);
    let preferences = pins(model);
    if preferences.is_empty() {
        return Ok(none());
    }
    let (_, rates) = Rows::new(model, Vec::new())
        .with(model, &preferences)
        .gradients(model, &at(state), Along::Pose)?;
    // each pin has two rows of its place and two of its axis
    let places: Vec<usize> = (0..rates.nrows()).filter(|row| row % 4 < 2).collect();
    let rates = rates.select(&places);
    let left = rates.times(v);
    let speed = model.largest(v.as_slice());
    if left.amax() <= RESTS * speed * model.length {
        return Ok(none());
    }
    let malformed = || RuntimeError::Malformed {
        what: "the start velocities are not finite".to_string(),
    };
    let (kept, _) = from_energy.after(others).unit_rows();
    let rates = from_energy.after(&rates);
    let sizes = rates.sizes();
    let mut free = rates.dense();
    take_away(&kept, &mut free).ok_or_else(malformed)?;
    // the rest of a rate that the other rows determine is rounding
    for (mut row, size) in free.row_iter_mut().zip(sizes.iter()) {
        if row.norm() <= RESTS * size {
            row.fill(0.0);
        }
    }
    let x = smallest_solution(&Gradients::of(&free), &(-left)).ok_or_else(malformed)?;
    Ok(from_energy.of_vector(&x))
}

/// The parts of the rows of `free` along the rows of `kept`, which have unit length, come off. `None` if a
/// number is not finite.
fn take_away(kept: &Gradients, free: &mut DMatrix<f64>) -> Option<()> {
    if kept.nrows() == 0 {
        return Some(());
    }
    if let Some(factor) = Independent::all(kept) {
        for mut row in free.row_iter_mut() {
            let mut rest = row.transpose();
            factor.free(&mut rest);
            row.tr_copy_from(&rest);
        }
        return Some(());
    }
    let svd = crate::singular::decompose(kept.dense())?;
    let right = svd.v_t.as_ref()?;
    // combinations below this only repeat others, as in [`super::independent`]
    let least = 1e-9 * svd.singular_values.amax();
    for (direction, size) in right.row_iter().zip(svd.singular_values.iter()) {
        if *size > least {
            let along = &*free * direction.transpose();
            *free -= along * direction;
        }
    }
    Some(())
}

/// The largest entry of a row in scaled velocities: the row's unit, times s.
fn gradient_size(matrix: &Gradients, row: usize, scales: &[f64]) -> f64 {
    let entries = matrix.rows()[row].iter();
    entries.fold(0.0_f64, |w, (j, x)| w.max((x * scales[*j]).abs()))
}

/// One vector above the other.
fn stacked(above: &DVector<f64>, below: &DVector<f64>) -> DVector<f64> {
    let numbers = above.iter().chain(below.iter());
    DVector::from_iterator(above.len() + below.len(), numbers.copied())
}

/// Weight of modal rates against rigid motion. A choice: where constraints let both move, shapes take 1e-8 of
/// the motion.
const VIBRATION: f64 = 1e8;

/// `L⁻ᵀ` of the mass matrix `M = L Lᵀ`, body by body: the first velocity of each body and its block.
struct InverseRoots(Vec<(usize, DMatrix<f64>)>);

impl InverseRoots {
    /// The inverse roots of all masses. A body whose mass matrix is not positive definite (a point mass) gets a small
    /// inertia for this purpose alone.
    fn of(model: &Model, state: &State) -> InverseRoots {
        let block = |body: &BodyModel| {
            let width = body.width();
            let mut mass = vec![0.0; width * width];
            body.add_mass(&body.frame(&state.pose), &mut Work::default(), &mut mass);
            let mut matrix = DMatrix::from_row_slice(width, width, &mass);
            // a choice: far below the inertia of real bodies, so that it changes no energy that counts
            let floor = 1e-9 * model.mass * model.length * model.length;
            for i in 3..6 {
                matrix[(i, i)] += floor;
            }
            // A body starts without vibration where the constraints let it.
            for i in 6..width {
                for j in 0..6 {
                    matrix[(i, j)] = 0.0;
                    matrix[(j, i)] = 0.0;
                }
                for j in 6..width {
                    matrix[(i, j)] *= VIBRATION;
                }
            }
            let inverse = matrix
                .cholesky()
                .and_then(|c| c.l().transpose().try_inverse())
                .unwrap_or_else(|| DMatrix::identity(width, width));
            (body.velocity, inverse)
        };
        InverseRoots(model.bodies.iter().map(block).collect())
    }

    /// `A L⁻ᵀ`.
    fn after(&self, matrix: &Gradients) -> Gradients {
        let mut out = Gradients::new(matrix.nrows(), matrix.ncols());
        for (i, row) in matrix.rows().iter().enumerate() {
            let mut rest = row.as_slice();
            for (first, block) in &self.0 {
                let own = rest.partition_point(|(j, _)| *j < first + block.nrows());
                let (own, others) = rest.split_at(own);
                rest = others;
                if own.is_empty() {
                    continue;
                }
                let line: Vec<f64> = (0..block.ncols())
                    .map(|k| own.iter().map(|(j, x)| x * block[(j - first, k)]).sum())
                    .collect();
                out.add(i, *first, &line);
            }
        }
        out
    }

    /// `L⁻ᵀ x`.
    fn of_vector(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(x.len());
        for (first, block) in &self.0 {
            let own = block * x.rows(*first, block.ncols());
            out.rows_mut(*first, block.nrows()).copy_from(&own);
        }
        out
    }
}
