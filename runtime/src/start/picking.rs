//! Independent combinations of rows, and the directions that they leave free.

use crate::assembly::gradients::Gradients;
use crate::assembly::independent::Independent;
use nalgebra::DMatrix;

/// Singular value of unit rows below which a combination determines nothing. A choice between rounding, some
/// 1e-14 in repeated rows, and rows that tolerances of the text or a small tilt make different: a combination
/// kept by mistake is divided by its singular value, so a smaller limit gives velocities a million times too
/// large.
pub(super) const DETERMINED: f64 = 1e-6;

/// Rows, split by the directions that they determine in a space.
pub struct Picked {
    /// Independent combinations of the rows: rank × rows.
    pub pick: DMatrix<f64>,
    /// The directions that they leave free: space × rest, orthonormal.
    pub free: DMatrix<f64>,
}

/// Splits the space (columns of `matrix`) into the directions that its rows determine and the rest. `None` if
/// numbers are not finite.
pub fn split(matrix: &DMatrix<f64>) -> Option<Picked> {
    split_above(matrix, DETERMINED)
}

/// An orthonormal basis of the directions that rows leave free (space × rest): [`Picked::free`] of [`split`].
/// Many rows that are clearly independent need no singular values. `None` if numbers are not finite.
pub fn free_of(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    match Independent::alone(&Gradients::of(matrix)) {
        Some(factor) => Some(factor.basis()),
        None => split(matrix).map(|picked| picked.free),
    }
}

/// [`split`] with another limit: combinations of unit rows up to `least` determine nothing.
pub(super) fn split_above(matrix: &DMatrix<f64>, least: f64) -> Option<Picked> {
    let (rows, space) = matrix.shape();
    if rows == 0 || space == 0 {
        return Some(Picked {
            pick: DMatrix::zeros(0, rows),
            free: DMatrix::identity(space, space),
        });
    }
    // The decomposition gives as many right vectors as rows. Rows of zeros complete them to a basis of the
    // space.
    let padded = matrix.clone().resize(rows.max(space), space, 0.0);
    let svd = crate::singular::decompose(padded)?;
    let (left, right) = (svd.u?, svd.v_t?);
    let determined = |i: &usize| svd.singular_values[*i] > least;
    let strong: Vec<usize> = (0..space).filter(determined).collect();
    let weak: Vec<usize> = (0..space).filter(|i| !determined(i)).collect();
    Some(Picked {
        pick: DMatrix::from_fn(strong.len(), rows, |i, j| left[(j, strong[i])]),
        free: DMatrix::from_fn(space, weak.len(), |i, j| right[(weak[j], i)]),
    })
}

/// Divides each row by its length and returns the factors. Rows no longer than `least` are rounding and
/// become zero.
pub fn unit_rows(matrix: &mut DMatrix<f64>, least: f64) -> Vec<f64> {
    (0..matrix.nrows())
        .map(|i| {
            let size = matrix.row(i).norm();
            let factor = if size > least { 1.0 / size } else { 0.0 };
            matrix.row_mut(i).scale_mut(factor);
            factor
        })
        .collect()
}
