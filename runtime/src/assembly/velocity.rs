//! Velocities at the start.

use super::at;
use super::gradients::Gradients;
use super::rows::{Along, Rows, smallest_solution};
use crate::body::BodyModel;
use crate::error::RuntimeError;
use crate::flexible::Work;
use crate::model::Model;
use crate::state::State;
use eng_system::system::Role;
use nalgebra::{DMatrix, DVector};

/// Relative to the model's speed, a row that is left by more contradicts others.
const CONTRADICTION: f64 = 1e-8;

/// Velocities of smallest kinetic energy with `Φ̇ = 0` and the exact start rows. Guessed rows are fitted
/// first; the exact ones then correct by the smallest change.
pub fn assemble(model: &Model, state: &mut State) -> Result<(), RuntimeError> {
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
        let mut reduced = from_energy.after(matrix);
        let mut rhs = rhs.clone();
        let sizes = reduced
            .sizes()
            .map(|size| if size > 0.0 { size } else { 1.0 });
        reduced.scale(|i, _| 1.0 / sizes[i]);
        rhs.component_div_assign(&sizes);
        let x = smallest_solution(&reduced, &rhs).ok_or_else(|| RuntimeError::Malformed {
            what: "the start velocities are not finite".to_string(),
        })?;
        Ok(from_energy.of_vector(&x))
    };
    let mut v = DVector::zeros(model.velocities);
    if !guessed.is_empty() {
        let all = matrix.clone().above(guess_matrix);
        v = solve(&all, &(-stacked(&values, &guess_values)))?;
    }
    // Twice: the second pass takes the rounding of the first.
    for _ in 0..2 {
        let rest = &values + matrix.times(&v);
        v += solve(&matrix, &(-rest))?;
    }
    state.velocity.copy_from_slice(v.as_slice());

    let scales = model.velocity_scales();
    let speed = state
        .velocity
        .iter()
        .zip(&scales)
        .fold(0.0_f64, |w, (v, s)| w.max((v / s).abs()));
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
    open.truncate(6);
    Err(RuntimeError::StartVelocity {
        rows: open.into_iter().map(|(_, _, row)| row).collect(),
        chain: chain.map(Box::new),
    })
}

fn gradient_size(matrix: &Gradients, row: usize, scales: &[f64]) -> f64 {
    let entries = matrix.rows()[row].iter();
    entries.fold(0.0_f64, |w, (j, x)| w.max((x * scales[*j]).abs()))
}

fn stacked(above: &DVector<f64>, below: &DVector<f64>) -> DVector<f64> {
    let numbers = above.iter().chain(below.iter());
    DVector::from_iterator(above.len() + below.len(), numbers.copied())
}

/// Weight of modal rates against rigid motion.
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
