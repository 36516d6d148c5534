//! Positions where a mechanism locks: its constraint equations depend on each other there, though not
//! elsewhere.
//!
//! There `yᵀ G = 0` for rows of unit length. The motion of the bodies that the rows of `y` join is then
//! undetermined, or the rows contradict each other. The least singular value of G measures the distance to
//! such a position, and its left vector shows the equations.

use super::at;
use super::chains;
use super::rows::{Along, Rows};
use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::state::State;

/// Least singular value of the rows, relative to the largest, below which a position counts as locked. A
/// choice: a motion that locks is stopped a fraction of a degree before the lock, where the value is small
/// and not zero.
const LOCKED: f64 = 1e-3;
/// Share of the largest entry of the left vector above which an equation belongs to the lock. A choice:
/// smaller ones only follow the motion of the loop.
const BELONGS: f64 = 0.2;
/// Most equations in a message. A choice: those of one joint.
const MOST: usize = 6;

/// The lock near a position of a motion, if there is one.
pub fn near(
    model: &Model,
    state: &State,
    moment: Moment,
) -> Result<Option<RuntimeError>, RuntimeError> {
    let rows = Rows::new(model, model.constraining().collect());
    let (mut values, mut matrix) = rows.evaluate(model, &at(state), Along::Pose)?;
    rows.scale(model, &mut values, &mut matrix);
    for i in 0..matrix.nrows() {
        let size = matrix.row(i).norm();
        if size > 0.0 {
            matrix.row_mut(i).scale_mut(1.0 / size);
        }
    }
    if matrix.is_empty() || matrix.nrows() > matrix.ncols() || matrix.iter().any(|x| !x.is_finite())
    {
        return Ok(None);
    }
    let Some(svd) = crate::singular::decompose(matrix) else {
        return Ok(None);
    };
    let Some(left) = svd.u else { return Ok(None) };
    let (index, least) = svd.singular_values.argmin();
    if least > LOCKED * svd.singular_values.amax() {
        return Ok(None);
    }
    let vector = left.column(index);
    let largest = vector.amax();
    let mut concerned: Vec<usize> = (0..rows.len())
        .filter(|i| vector[*i].abs() > BELONGS * largest)
        .collect();
    concerned.sort_by(|a, b| vector[*b].abs().total_cmp(&vector[*a].abs()).then(a.cmp(b)));
    // the closed chain of most concerned joints
    let chain = concerned
        .iter()
        .filter_map(|i| chains::through(model, rows.owners[*i].0, state))
        .min_by_key(|chain| chain.bodies.len());
    concerned.truncate(MOST);
    Ok(Some(RuntimeError::Locked {
        moment,
        rows: concerned
            .into_iter()
            .map(|i| {
                let (element, row) = rows.owners[i];
                model.named_row(element, row, vector[i])
            })
            .collect(),
        chain: chain.map(Box::new),
    }))
}
