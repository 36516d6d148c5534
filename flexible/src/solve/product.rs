//! A sparse symmetric matrix times several vectors.

use crate::sparse::SymmetricMatrix;

/// Vectors taken together: their entries of one row fill a cache line.
pub(crate) const TOGETHER: usize = 8;

/// `y = A x` for vectors stored one after the other; reads the matrix once for eight vectors. `x` and `y` have the same length,
/// a multiple of the matrix's size.
pub(crate) fn multiply(matrix: &SymmetricMatrix, x: &[f64], y: &mut [f64]) {
    let size = matrix.size();
    if size == 0 {
        return;
    }
    let mut packed = vec![[0.0f64; TOGETHER]; size];
    let mut product = vec![[0.0f64; TOGETHER]; size];
    for (x, y) in x.chunks(size * TOGETHER).zip(y.chunks_mut(size * TOGETHER)) {
        for (lane, x) in x.chunks_exact(size).enumerate() {
            for (packed, &x) in packed.iter_mut().zip(x) {
                packed[lane] = x;
            }
        }
        product.fill([0.0; TOGETHER]);
        for column in 0..size {
            let (rows, values) = matrix.column(column);
            let own = packed[column];
            let mut sum = [0.0f64; TOGETHER];
            for (&row, &value) in rows.iter().zip(values) {
                let row = row as usize;
                let other = &packed[row];
                for lane in 0..TOGETHER {
                    sum[lane] += value * other[lane];
                }
                if row != column {
                    let target = &mut product[row];
                    for lane in 0..TOGETHER {
                        target[lane] += value * own[lane];
                    }
                }
            }
            for (target, sum) in product[column].iter_mut().zip(sum) {
                *target += sum;
            }
        }
        for (lane, y) in y.chunks_exact_mut(size).enumerate() {
            for (y, product) in y.iter_mut().zip(&product) {
                *y = product[lane];
            }
        }
    }
}
