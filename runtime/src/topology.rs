//! Degrees of freedom and redundant constraints, from the rank of the constraints.
//!
//! The rank of the scaled G is computed at the assembled position and at two generic nearby positions that
//! satisfy the constraints. At a dead centre it drops locally, which is no redundancy. Drives, whose rows
//! depend on time, are released in the search for such positions.

use crate::assembly::at;
use crate::assembly::closing::{Numbers, close};
use crate::assembly::gradients::Gradients;
use crate::assembly::independent::{FEW, Independent};
use crate::assembly::rows::{Along, Rows};
use crate::body::{BodyKind, BodyModel};
use crate::error::{Massless, Moment, RedundantGroup, RuntimeError};
use crate::model::Model;
use crate::state::{State, move_pose};
use nalgebra::{DMatrix, DVector};

/// Share of a unit row below which a pivot counts as zero. A choice: positions are closed to 1e-10 and
/// elimination adds rounding; a row that is that near to others holds nothing in a real machine.
const RANK_LIMIT: f64 = 1e-8;
/// Share below which a message does not name a row. A choice above the rounding of a solution.
const SHARE_LIMIT: f64 = 1e-6;

/// Share of the largest principal moment of inertia below which one counts as zero. A choice: thin rods have
/// moments about their axis that are small on purpose, but not as small.
const NO_INERTIA: f64 = 1e-12;

/// Counts of velocities, equations and freedoms.
#[derive(Clone, Debug, PartialEq)]
pub struct TopologyReport {
    /// Velocities of all bodies.
    pub velocities: usize,
    /// Constraint equations.
    pub equations: usize,
    /// Independent ones.
    pub rank: usize,
    /// Degrees of freedom: velocities minus rank.
    pub freedom: usize,
    /// One group for each redundant equation.
    pub redundant: Vec<RedundantGroup>,
}

/// Counts the freedoms at an assembled state.
pub fn analyze(model: &Model, state: &State) -> Result<TopologyReport, RuntimeError> {
    let elements: Vec<usize> = model.constraining().collect();
    let rows = Rows::new(model, elements.clone());
    let mut best = Rank::of(model, &rows, state)?;
    if best.dependent.is_empty() {
        return Ok(best.report(model, &rows));
    }
    let mut resting = state.clone();
    resting.velocity.fill(0.0);
    let by_time = rows.rates(model, &at(&resting))?;
    let driven = |element: usize| {
        rows.owners
            .iter()
            .zip(by_time.iter())
            .any(|((e, _), rate)| *e == element && *rate != 0.0)
    };
    let held = Rows::new(
        model,
        elements.into_iter().filter(|e| !driven(*e)).collect(),
    );
    let mobility = vec![1.0; model.velocities];
    let scales = model.velocity_scales();
    let mut numbers = Numbers::new(7);
    let mut found = 0;
    // shares of the model's length, or rad: far enough to leave a singular position, and in shorter moves if
    // the loops do not close there. A choice
    for reach in [0.05, 0.05, 0.05, 0.01, 0.01, 0.002] {
        if found == 2 {
            break;
        }
        let increment: Vec<f64> = scales.iter().map(|s| s * reach * numbers.draw()).collect();
        let mut near = resting.clone();
        move_pose(model, &resting.pose, &increment, 1.0, &mut near.pose);
        // nearer than an assembly, so that the rank limit sees no open row
        if close(model, &held, &mobility, &mut near, 60)? < 1e-12 {
            found += 1;
            let rank = Rank::of(model, &rows, &near)?;
            if rank.dependent.len() < best.dependent.len() {
                best = rank;
            }
        }
    }
    Ok(best.report(model, &rows))
}

/// The error if masses and gradients of constraints determine no accelerations. `gradients` has a row for
/// each equation and columns scaled like velocities.
pub(crate) fn undetermined(
    model: &Model,
    gradients: &DMatrix<f64>,
    moment: Moment,
) -> RuntimeError {
    let name = |row: usize, share: f64| {
        let mut elements = model.elements.iter().enumerate();
        let (index, element) = elements.find(|(index, element)| {
            let rows = element.row..element.row + model.class(*index).rows.len();
            element.dynamic && rows.contains(&row)
        })?;
        Some(model.named_row(index, row - element.row, share))
    };
    let repeated: Vec<RedundantGroup> = dependencies(gradients)
        .into_iter()
        .filter_map(|(row, shares)| {
            let others = shares.iter().filter_map(|(r, share)| name(*r, *share));
            Some(RedundantGroup {
                redundant: name(row, 1.0)?,
                repeats: others.collect(),
            })
        })
        .collect();
    // if the equations are independent, the masses are the reason
    let massless = match repeated.is_empty() {
        true => model.bodies.iter().filter_map(massless).collect(),
        false => Vec::new(),
    };
    RuntimeError::Singular {
        moment,
        massless,
        repeated,
    }
}

/// The missing mass or inertia of a body.
fn massless(body: &BodyModel) -> Option<Massless> {
    let BodyKind::Rigid(rigid) = &body.kind else {
        return None;
    };
    let principal = rigid.inertia.symmetric_eigenvalues();
    let lacks = if rigid.mass <= 0.0 {
        "mass"
    } else if principal.min() <= NO_INERTIA * principal.max() {
        "inertia"
    } else {
        return None;
    };
    Some(Massless {
        origin: body.origin.clone(),
        lacks,
    })
}

/// Rows split into independent and dependent ones.
#[derive(Clone, Debug)]
struct Rank {
    /// Dependent rows with their shares of independent rows.
    dependent: Vec<(usize, Vec<(usize, f64)>)>,
}

impl Rank {
    fn of(model: &Model, rows: &Rows, state: &State) -> Result<Rank, RuntimeError> {
        let (mut values, mut matrix) = rows.gradients(model, &at(state), Along::Pose)?;
        rows.scale_gradients(model, &mut values, &mut matrix);
        Ok(Rank {
            dependent: dependent_rows(&matrix),
        })
    }

    fn report(&self, model: &Model, rows: &Rows) -> TopologyReport {
        let name = |row: usize, share: f64| {
            let (element, local) = rows.owners[row];
            model.named_row(element, local, share)
        };
        let redundant = self
            .dependent
            .iter()
            .map(|(row, shares)| RedundantGroup {
                redundant: name(*row, 1.0),
                repeats: shares.iter().map(|(r, share)| name(*r, *share)).collect(),
            })
            .collect();
        let rank = rows.len() - self.dependent.len();
        TopologyReport {
            velocities: model.velocities,
            equations: rows.len(),
            rank,
            freedom: model.velocities.saturating_sub(rank),
            redundant,
        }
    }
}

/// [`dependencies`] of the rows. Of many rows only those are analysed that are not clearly independent of the others.
pub fn dependent_rows(matrix: &Gradients) -> Vec<(usize, Vec<(usize, f64)>)> {
    let factor = (matrix.nrows() > FEW).then(|| Independent::of(matrix));
    let Some(Some(factor)) = factor else {
        return dependencies(&matrix.dense());
    };
    let part = factor.dependent_part();
    let found = dependencies(&matrix.select(&part).dense()).into_iter();
    found
        .map(|(row, shares)| {
            let shares = shares.into_iter();
            (
                part[row],
                shares.map(|(r, share)| (part[r], share)).collect(),
            )
        })
        .collect()
}

/// Expresses dependent rows by independent ones, by elimination with complete pivoting. Among equals early
/// rows come first.
pub fn dependencies(matrix: &DMatrix<f64>) -> Vec<(usize, Vec<(usize, f64)>)> {
    let (rows, columns) = matrix.shape();
    let mut unit = matrix.clone();
    for i in 0..rows {
        let size = unit.row(i).norm();
        if size > 0.0 {
            unit.row_mut(i).scale_mut(1.0 / size);
        }
    }
    let mut work = unit.clone();
    let mut free_rows: Vec<usize> = (0..rows).collect();
    let mut free_columns: Vec<usize> = (0..columns).collect();
    let (mut pivot_rows, mut pivot_columns) = (Vec::new(), Vec::new());
    loop {
        let mut best = (RANK_LIMIT, None);
        for (p, i) in free_rows.iter().enumerate() {
            for (q, j) in free_columns.iter().enumerate() {
                let size = work[(*i, *j)].abs();
                // a later row must be clearly larger, so that the first of two equal rows is the independent
                // one
                // a per cent, a choice: rows equal but for scaling and rounding differ by less
                if size > best.0 * 1.01 {
                    best = (size, Some((p, q)));
                }
            }
        }
        let Some((p, q)) = best.1 else { break };
        let (row, column) = (free_rows.remove(p), free_columns.remove(q));
        for i in &free_rows {
            let factor = work[(*i, column)] / work[(row, column)];
            if factor != 0.0 {
                for j in &free_columns {
                    let x = work[(row, *j)];
                    work[(*i, *j)] -= factor * x;
                }
                work[(*i, column)] = 0.0;
            }
        }
        pivot_rows.push(row);
        pivot_columns.push(column);
    }
    let rank = pivot_rows.len();
    if rank == 0 {
        // rows of zeros repeat no other row
        return free_rows.into_iter().map(|row| (row, Vec::new())).collect();
    }
    let square = DMatrix::from_fn(rank, rank, |i, j| unit[(pivot_rows[j], pivot_columns[i])]);
    let lu = square.lu();
    free_rows
        .into_iter()
        .map(|row| {
            let rhs = DVector::from_fn(rank, |i, _| unit[(row, pivot_columns[i])]);
            let mut shares: Vec<(usize, f64)> = lu
                .solve(&rhs)
                .map(|x| {
                    x.iter()
                        .enumerate()
                        .filter(|(_, share)| share.abs() > SHARE_LIMIT)
                        .map(|(i, share)| (pivot_rows[i], *share))
                        .collect()
                })
                .unwrap_or_default();
            shares.sort_by_key(|(row, _)| *row);
            (row, shares)
        })
        .collect()
}
