//! Eigenvalues and eigenvectors of a dense real matrix.

use crate::error::RuntimeError;
use faer::diag::DiagMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, EvdParams, evd_real, evd_scratch};
use faer::{Auto, MatMut, MatRef, Par, Spec};
use nalgebra::{Complex, DMatrix, DVector};

/// An eigenvalue with its vector: `A x = λ x`.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenpair {
    /// λ. Of a conjugate pair it is the one with positive imaginary part.
    pub value: Complex<f64>,
    /// x, not zero, of any length.
    pub vector: DVector<Complex<f64>>,
}

/// All eigenpairs, with one for each conjugate pair, and the size (greatest column sum) of the balanced
/// matrix. The method's rounding errors are relative to this size.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// The pairs in the order of the method.
    pub pairs: Vec<Eigenpair>,
    /// 1-norm of `D⁻¹AD`.
    pub size: f64,
}

/// Most sweeps of the balancing. A handful usually suffices. A choice: it only ends a loop. Scales that are
/// not yet the best cost digits, but the similarity is exact all the same.
const SWEEPS: usize = 40;

/// Balances the 1-norms of each row and column with powers of two: `A ← D⁻¹AD`. Returns D.
/// (B. N. Parlett, C. Reinsch, Numer. Math. 13 (1969) 293.) Powers of two cause no rounding.
pub(super) fn balance(matrix: &mut DMatrix<f64>) -> Vec<f64> {
    let n = matrix.nrows();
    let mut scales = vec![1.0; n];
    for _ in 0..SWEEPS {
        let mut changed = false;
        for i in 0..n {
            let (mut column, mut row) = (0.0, 0.0);
            for j in (0..n).filter(|j| *j != i) {
                column += matrix[(j, i)].abs();
                row += matrix[(i, j)].abs();
            }
            if column == 0.0 || row == 0.0 || !(column + row).is_finite() {
                continue;
            }
            let before = column + row;
            let mut factor = 1.0;
            while column < 0.5 * row {
                factor *= 2.0;
                column *= 2.0;
                row *= 0.5;
            }
            while column >= 2.0 * row {
                factor *= 0.5;
                column *= 0.5;
                row *= 2.0;
            }
            // the limit of the algorithm (B. N. Parlett, C. Reinsch, Numer. Math. 13 (1969) 293): less gain
            // is not worth a sweep
            if column + row < 0.95 * before {
                changed = true;
                scales[i] *= factor;
                matrix.column_mut(i).scale_mut(factor);
                matrix.row_mut(i).scale_mut(1.0 / factor);
            }
        }
        if !changed {
            break;
        }
    }
    scales
}

/// Solves `A x = λ x`.
///
/// # Errors
/// When an entry is not finite, memory runs out, or the iteration does not converge.
pub fn spectrum(mut matrix: DMatrix<f64>) -> Result<Spectrum, RuntimeError> {
    let n = matrix.nrows();
    let refuse = |what: &str| RuntimeError::Eigenvalues {
        size: n,
        what: what.to_owned(),
    };
    if n == 0 {
        return Ok(Spectrum {
            pairs: Vec::new(),
            size: 0.0,
        });
    }
    if matrix.iter().any(|x| !x.is_finite()) {
        return Err(refuse("an entry is not finite"));
    }
    let scales = balance(&mut matrix);
    let size = (0..n).fold(0.0_f64, |most, i| most.max(matrix.column(i).lp_norm(1)));
    let method: Spec<EvdParams, f64> = <EvdParams as Auto<f64>>::auto().into();
    let (mut real, mut imaginary) = (vec![0.0; n], vec![0.0; n]);
    let mut vectors = vec![0.0; n * n];
    let mut memory = MemBuffer::try_new(evd_scratch::<f64>(
        n,
        ComputeEigenvectors::No,
        ComputeEigenvectors::Yes,
        Par::Seq,
        method,
    ))
    .map_err(|_| refuse("memory runs out"))?;
    evd_real(
        MatRef::from_column_major_slice(matrix.as_slice(), n, n),
        DiagMut::from_slice_mut(&mut real),
        DiagMut::from_slice_mut(&mut imaginary),
        None,
        Some(MatMut::from_column_major_slice_mut(&mut vectors, n, n)),
        Par::Seq,
        MemStack::new(&mut memory),
        method,
    )
    .map_err(|_| refuse("the iteration does not end"))?;
    let mut pairs = Vec::new();
    let mut i = 0;
    while i < n {
        let entry = |column: usize, row: usize| vectors[column * n + row] * scales[row];
        // the two columns of a conjugate pair are the real and the imaginary part of its first vector
        let paired = imaginary[i] != 0.0 && i + 1 < n;
        let sign = if imaginary[i] < 0.0 { -1.0 } else { 1.0 };
        let vector = DVector::from_fn(n, |row, _| {
            let im = if paired {
                sign * entry(i + 1, row)
            } else {
                0.0
            };
            Complex::new(entry(i, row), im)
        });
        pairs.push(Eigenpair {
            value: Complex::new(real[i], imaginary[i].abs()),
            vector,
        });
        i += if paired { 2 } else { 1 };
    }
    Ok(Spectrum { pairs, size })
}
