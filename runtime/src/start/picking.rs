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
pub(super) struct Picked {
    /// Independent combinations of the rows: rank × rows.
    pub pick: DMatrix<f64>,
    /// The directions that they leave free: space × rest, orthonormal.
    pub free: DMatrix<f64>,
}

/// Splits the space (columns of `matrix`) into the directions that its rows determine and the rest. `None` if
/// numbers are not finite.
pub(super) fn split(matrix: &DMatrix<f64>) -> Option<Picked> {
    split_above(matrix, DETERMINED)
}

/// An orthonormal basis of the directions that rows leave free (space × rest): [`Picked::free`] of [`split`].
/// Many rows that are clearly independent need no singular values. `None` if numbers are not finite.
pub(crate) fn free_of(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
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
pub(crate) fn unit_rows(matrix: &mut DMatrix<f64>, least: f64) -> Vec<f64> {
    (0..matrix.nrows())
        .map(|i| {
            let size = matrix.row(i).norm();
            let factor = if size > least { 1.0 / size } else { 0.0 };
            matrix.row_mut(i).scale_mut(factor);
            factor
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splits_a_space() {
        // the third row repeats the first two
        let rows = DMatrix::from_row_slice(
            3,
            4,
            &[1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0],
        );
        let picked = split(&rows).unwrap();
        assert_eq!((picked.pick.nrows(), picked.free.ncols()), (2, 2));
        assert!((&rows * &picked.free).amax() < 1e-14);
        // the combinations still determine the same directions as the rows
        let square = DMatrix::from_fn(4, 4, |i, j| {
            if i < 2 {
                (&picked.pick * &rows)[(i, j)]
            } else {
                picked.free[(j, i - 2)]
            }
        });
        assert!(square.determinant().abs() > 0.1);
        assert!(split(&DMatrix::from_element(1, 1, f64::NAN)).is_none());
        assert_eq!(split(&DMatrix::zeros(0, 3)).unwrap().free.ncols(), 3);
    }

    #[test]
    fn many_rows_leave_the_directions_of_singular_values() {
        // each row touches the next three columns; one repeats its neighbour
        let (rows, space) = (crate::assembly::independent::FEW + 10, 170);
        let mut matrix = DMatrix::from_fn(rows, space, |i, j| match j.checked_sub(i) {
            Some(0) => 1.0,
            Some(k) if k < 4 => libm::sin((3 * i + 7 * k) as f64),
            _ => 0.0,
        });
        let twice = matrix.row(6) * 2.0;
        matrix.set_row(7, &twice);
        unit_rows(&mut matrix, 0.0);
        let expected = split(&matrix).unwrap().free;
        let found = free_of(&matrix).unwrap();
        assert_eq!(found.shape(), (space, space - rows + 1));
        // the same projector on the same directions
        let projector = |basis: &DMatrix<f64>| basis * basis.transpose();
        assert!((projector(&found) - projector(&expected)).amax() < 1e-10);
        assert!(Independent::alone(&Gradients::of(&matrix)).is_some());
        // without a clear decision the singular values decide
        matrix[(7, 9)] += 9e-7;
        assert!(Independent::alone(&Gradients::of(&matrix)).is_none());
        assert_eq!(free_of(&matrix).unwrap().ncols(), space - rows + 1);
        matrix[(0, 0)] = f64::NAN;
        assert!(free_of(&matrix).is_none());
    }
}
