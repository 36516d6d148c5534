//! Small dense symmetric problems, and products with tall matrices. Matrices are stored by columns.

use super::ordering::out_of_memory;
use crate::error::FlexibleError;
use faer::diag::DiagMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::evd::{
    ComputeEigenvectors, SelfAdjointEvdParams, self_adjoint_evd, self_adjoint_evd_scratch,
};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, Auto, MatMut, MatRef, Par, Spec};

/// `Y −= X C`, C by columns.
pub(crate) fn subtract(length: usize, x: &[f64], coefficients: &[f64], y: &mut [f64]) {
    let inner = x.len().checked_div(length).unwrap_or(0);
    let columns = y.len().checked_div(length).unwrap_or(0);
    if inner * columns > 0 {
        matmul(
            MatMut::from_column_major_slice_mut(y, length, columns),
            Accum::Add,
            MatRef::from_column_major_slice(x, length, inner),
            MatRef::from_column_major_slice(coefficients, inner, columns),
            -1.0,
            Par::Seq,
        );
    }
}

/// Eigenvalues in ascending order, and the orthonormal eigenvectors, of a symmetric matrix of which the lower
/// triangle is read.
///
/// # Errors
/// When the iteration does not end (entries that are not finite), or memory runs out.
pub(crate) fn symmetric_eigen(
    size: usize,
    mut matrix: Vec<f64>,
) -> Result<(Vec<f64>, Vec<f64>), FlexibleError> {
    if size == 0 {
        return Ok((Vec::new(), Vec::new()));
    }
    // From 128 rows on the library would use the divide-and-conquer method, which loses half the digits of
    // matrices whose norm is far from one. So entries are scaled to about one, exactly, by a power of two,
    // and QR iteration is always used.
    let largest = matrix.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let scale = if largest.is_normal() {
        libm::ldexp(1.0, libm::ilogb(largest))
    } else {
        1.0
    };
    matrix.iter_mut().for_each(|entry| *entry /= scale);
    let mut method = <SelfAdjointEvdParams as Auto<f64>>::auto();
    method.recursion_threshold = usize::MAX;
    let method: Spec<SelfAdjointEvdParams, f64> = method.into();
    let mut values = vec![0.0; size];
    let mut vectors = vec![0.0; size * size];
    let mut memory = MemBuffer::try_new(self_adjoint_evd_scratch::<f64>(
        size,
        ComputeEigenvectors::Yes,
        Par::Seq,
        method,
    ))
    .map_err(|_| out_of_memory())?;
    self_adjoint_evd(
        MatRef::from_column_major_slice(&matrix, size, size),
        DiagMut::from_slice_mut(&mut values),
        Some(MatMut::from_column_major_slice_mut(
            &mut vectors,
            size,
            size,
        )),
        Par::Seq,
        MemStack::new(&mut memory),
        method,
    )
    .map_err(|_| FlexibleError::Numerical {
        problem: format!("the eigenvalues of a dense matrix of {size} rows don't converge"),
        advice: "check that all entries are finite".into(),
    })?;
    values.iter_mut().for_each(|value| *value *= scale);
    Ok((values, vectors))
}

/// The pairs θ, x of `M x = θ A x` with positive definite `A` (its lower triangle is read) and `M`, θ
/// descending, `xᵀ A x = 1`. With `A = K − σ M`, λ = σ + 1/θ are the eigenvalues of `K x = λ M x`; θ = 0
/// means motions without mass.
///
/// # Errors
/// [`FlexibleError::Singular`] when `A` is not positive definite; when memory runs out.
pub(crate) fn inverse_eigen(
    size: usize,
    mut shifted: Vec<f64>,
    mut mass: Vec<f64>,
) -> Result<(Vec<f64>, Vec<f64>), FlexibleError> {
    let mut memory = MemBuffer::try_new(cholesky_in_place_scratch::<f64>(
        size,
        Par::Seq,
        Default::default(),
    ))
    .map_err(|_| out_of_memory())?;
    if let Err(LltError::NonPositivePivot { index }) = cholesky_in_place(
        MatMut::from_column_major_slice_mut(&mut shifted, size, size),
        Default::default(),
        Par::Seq,
        MemStack::new(&mut memory),
        Default::default(),
    ) {
        return Err(super::factor::singular(index, None));
    }
    let lower = MatRef::from_column_major_slice(&shifted, size, size);
    // L⁻¹ M L⁻ᵀ: columns first, then rows
    let mut both = MatMut::from_column_major_slice_mut(&mut mass, size, size);
    solve_lower_triangular_in_place(lower, both.as_mut(), Par::Seq);
    solve_lower_triangular_in_place(lower, both.transpose_mut(), Par::Seq);
    let (mut values, mut vectors) = symmetric_eigen(size, mass)?;
    solve_upper_triangular_in_place(
        lower.transpose(),
        MatMut::from_column_major_slice_mut(&mut vectors, size, size),
        Par::Seq,
    );
    values.reverse();
    let vectors = vectors.rchunks(size.max(1)).flatten().copied().collect();
    Ok((values, vectors))
}

/// The inverse of a symmetric positive definite matrix, of which the lower triangle is read. A test of the
/// eigenvalues uses the matrix scaled to a unit diagonal. If the smallest eigenvalue is below `least` of the
/// largest, some combination of rows vanishes, and the result is the row with the largest part in it.
///
/// # Errors
/// As [`symmetric_eigen`].
pub(crate) fn positive_inverse(
    size: usize,
    matrix: &[f64],
    least: f64,
) -> Result<Result<Vec<f64>, usize>, FlexibleError> {
    if size == 0 {
        return Ok(Ok(Vec::new()));
    }
    let mut scales = Vec::with_capacity(size);
    for row in 0..size {
        let own = matrix.get(row * (size + 1)).copied().unwrap_or(0.0);
        if own.is_nan() || own <= 0.0 {
            return Ok(Err(row));
        }
        scales.push(1.0 / libm::sqrt(own));
    }
    let mut scaled = matrix.to_vec();
    for (line, x) in scaled.chunks_exact_mut(size.max(1)).zip(&scales) {
        for (entry, y) in line.iter_mut().zip(&scales) {
            *entry *= x * y;
        }
    }
    let (values, vectors) = symmetric_eigen(size, scaled)?;
    let largest = values.last().copied().unwrap_or(1.0);
    if values
        .first()
        .is_some_and(|value| *value <= least * largest)
    {
        let row = vectors
            .iter()
            .take(size)
            .enumerate()
            .fold((0, 0.0f64), |best, (row, x)| {
                if x.abs() > best.1 {
                    (row, x.abs())
                } else {
                    best
                }
            });
        return Ok(Err(row.0));
    }
    let mut inverse = vec![0.0; size * size];
    for (value, vector) in values.iter().zip(vectors.chunks_exact(size.max(1))) {
        let vector: Vec<f64> = vector.iter().zip(&scales).map(|(x, s)| x * s).collect();
        for (line, x) in inverse.chunks_exact_mut(size.max(1)).zip(&vector) {
            for (entry, y) in line.iter_mut().zip(&vector) {
                *entry += x * y / value;
            }
        }
    }
    Ok(Ok(inverse))
}
