//! Singular values and vectors, with a check of the decomposition.
//!
//! The decomposition of `nalgebra` is fast and usually right. But if rows repeat each other up to rounding,
//! it may give a wrong singular value: for two equal unit rows it gave √3 instead of √2. So [`decompose`]
//! multiplies the factors again. If the product is not the matrix, Jacobi's method replaces the
//! decomposition. It is slower and always converges.

use nalgebra::{DMatrix, DVector, Dyn, SVD};

/// A decomposition is wrong if its product misses the matrix by more than this share. Rounding alone gives
/// 1e-14 for hundreds of rows. A choice between that and a wrong value.
pub const WRONG: f64 = 1e-11;
/// The largest number of sweeps of Jacobi's method. About ten are enough. The limit is a choice.
const SWEEPS: usize = 60;

/// `A = U Σ Vᵀ` with orthonormal columns of U and rows of Vᵀ. Their number is that of the shorter side of A,
/// and the largest singular value comes first. `None` if A is empty or not finite.
pub fn decompose(matrix: DMatrix<f64>) -> Option<SVD<f64, Dyn, Dyn>> {
    if matrix.is_empty() || matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let found = matrix
        .clone()
        // a choice: an end for matrices on which the iteration does not converge, far above the two or three steps
        // that each value takes
        .try_svd(true, true, f64::EPSILON, 10_000)
        .filter(|found| is_of(&matrix, found));
    match found {
        Some(found) => Some(found),
        None => jacobi(&matrix),
    }
}

/// Whether the factors of a decomposition make a matrix.
pub fn is_of(matrix: &DMatrix<f64>, found: &SVD<f64, Dyn, Dyn>) -> bool {
    let (Some(left), Some(right)) = (&found.u, &found.v_t) else {
        return false;
    };
    let mut scaled = right.clone();
    for (mut row, value) in scaled.row_iter_mut().zip(found.singular_values.iter()) {
        row.scale_mut(*value);
    }
    // a comparison with NaN is false, so a decomposition with NaN is wrong
    (left * scaled - matrix).amax() <= WRONG * matrix.amax()
}

/// One-sided Jacobi: plane rotations make the columns of `W = A V` orthogonal, two at a time. The lengths of
/// the columns are then the singular values (G. H. Golub, C. F. Van Loan, Matrix Computations, 4th edition,
/// section 8.6.3).
pub fn jacobi(matrix: &DMatrix<f64>) -> Option<SVD<f64, Dyn, Dyn>> {
    let is_wide = matrix.nrows() < matrix.ncols();
    let mut work = if is_wide {
        matrix.transpose()
    } else {
        matrix.clone()
    };
    let (rows, columns) = work.shape();
    let mut turned = DMatrix::identity(columns, columns);
    // products below this are rounding errors of the whole matrix
    let rounding = f64::EPSILON * work.norm();
    let floor = rounding * rounding;
    let mut is_done = false;
    for _ in 0..SWEEPS {
        is_done = true;
        for p in 0..columns {
            for q in p + 1..columns {
                let (a, b) = (work.column(p).norm_squared(), work.column(q).norm_squared());
                let product = work.column(p).dot(&work.column(q));
                // ten rounding units: the rounding of a product of two columns
                if product.abs() <= (10.0 * f64::EPSILON * (a * b).sqrt()).max(floor) {
                    continue;
                }
                is_done = false;
                let zeta = (b - a) / (2.0 * product);
                let tangent = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
                let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
                for m in [&mut work, &mut turned] {
                    for i in 0..m.nrows() {
                        let (x, y) = (m[(i, p)], m[(i, q)]);
                        m[(i, p)] = cosine * (x - tangent * y);
                        m[(i, q)] = cosine * (y + tangent * x);
                    }
                }
            }
        }
        if is_done {
            break;
        }
    }
    if !is_done {
        return None;
    }
    let lengths: Vec<f64> = work.column_iter().map(|column| column.norm()).collect();
    let mut order: Vec<usize> = (0..columns).collect();
    order.sort_by(|a, b| lengths[*b].total_cmp(&lengths[*a]).then(a.cmp(b)));
    let largest = order.first().map_or(0.0, |first| lengths[*first]);
    let mut left = DMatrix::zeros(rows, columns);
    for (k, from) in order.iter().enumerate() {
        // a column of rounding errors alone has no direction of its own, so it takes one orthogonal to the
        // others
        let is_rounding = lengths[*from] <= columns as f64 * f64::EPSILON * largest;
        let column = match is_rounding {
            true => beside(&left.columns(0, k).into_owned()),
            false => work.column(*from) / lengths[*from],
        };
        left.column_mut(k).copy_from(&column);
    }
    let right = DMatrix::from_fn(columns, columns, |i, j| turned[(i, order[j])]);
    let values = DVector::from_fn(columns, |i, _| lengths[order[i]]);
    let (u, v_t) = match is_wide {
        true => (right, left.transpose()),
        false => (left, right.transpose()),
    };
    Some(SVD {
        u: Some(u),
        v_t: Some(v_t),
        singular_values: values,
    })
}

/// A unit vector orthogonal to orthonormal columns, of which there are fewer than rows. Of the parts of the
/// axes that are orthogonal to the columns, it takes the longest.
fn beside(columns: &DMatrix<f64>) -> DVector<f64> {
    let rows = columns.nrows();
    let mut best = DVector::zeros(rows);
    for axis in 0..rows {
        let mut rest = DVector::zeros(rows);
        rest[axis] = 1.0;
        // twice: the second pass removes the rounding error of the first
        for _ in 0..2 {
            let along = columns.tr_mul(&rest);
            rest -= columns * along;
        }
        if rest.norm_squared() > best.norm_squared() {
            best = rest;
        }
    }
    best.normalize()
}
