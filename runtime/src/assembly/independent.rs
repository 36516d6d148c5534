//! The smallest solution of a system whose rows are clearly independent, without a dense decomposition.
//!
//! `x = Aᵀ (A Aᵀ)⁻¹ b`. Few rows of a mechanism touch the same body, so the Cholesky factor of `A Aᵀ` is kept within
//! its envelope: from the first entry of each row to the diagonal. A chain of n bodies costs as much as n times a
//! body. The squared matrix has the squared condition. So pivots must be above [`CLEAR`], and refinement against A
//! itself removes the error of the square (Å. Björck, Numerical Methods for Least Squares Problems, 1996, section
//! 6.6).

use crate::dense::dot;
use nalgebra::{DMatrix, DVector};

/// Share of the square of a row of unit length below which the row may depend on others.
const CLEAR: f64 = 1e-7;
/// Refinements, each of which removes a factor of the rounding of the square.
const REFINEMENTS: usize = 2;
/// Largest rest of the equations, of their right sides and solution.
const REST: f64 = 1e-12;

/// The smallest solution x of `A x = b`. `None` if the rows are not clearly independent; another method must decide
/// then.
pub fn solution(matrix: &DMatrix<f64>, rhs: &DVector<f64>) -> Option<DVector<f64>> {
    let rows = Rows::of(matrix)?;
    let factor = Envelope::of(&rows)?;
    let scaled = rhs.component_div(&rows.sizes);
    let mut solution = DVector::zeros(matrix.ncols());
    let mut rest = scaled.clone();
    for _ in 0..=REFINEMENTS {
        factor.solve(rest.as_mut_slice());
        rows.add_transposed(&rest, &mut solution);
        rest = rows.left(&scaled, &solution);
    }
    (rest.amax() <= REST * scaled.amax().max(solution.amax())).then_some(solution)
}

/// The rows of a matrix, of unit length, without zeros.
struct Rows {
    entries: Vec<Vec<(usize, f64)>>,
    sizes: DVector<f64>,
}

impl Rows {
    /// `None` if a row has no length.
    fn of(matrix: &DMatrix<f64>) -> Option<Rows> {
        let sizes = DVector::from_iterator(matrix.nrows(), matrix.row_iter().map(|row| row.norm()));
        if !sizes.iter().all(|size| *size > 0.0 && size.is_finite()) {
            return None;
        }
        let mut entries = vec![Vec::new(); matrix.nrows()];
        for (j, column) in matrix.column_iter().enumerate() {
            for (i, x) in column.iter().enumerate().filter(|(_, x)| **x != 0.0) {
                entries[i].push((j, x / sizes[i]));
            }
        }
        Some(Rows { entries, sizes })
    }

    /// `b − A x`.
    fn left(&self, rhs: &DVector<f64>, x: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(rhs.len(), |i, _| {
            rhs[i] - self.entries[i].iter().map(|(j, a)| a * x[*j]).sum::<f64>()
        })
    }

    /// `x += Aᵀ y`.
    fn add_transposed(&self, y: &DVector<f64>, x: &mut DVector<f64>) {
        for (row, y) in self.entries.iter().zip(y.iter()) {
            for (j, a) in row {
                x[*j] += a * y;
            }
        }
    }
}

/// The Cholesky factor of `A Aᵀ`: each row from its first entry to the diagonal.
struct Envelope {
    first: Vec<usize>,
    rows: Vec<Vec<f64>>,
}

impl Envelope {
    /// `None` without clearly positive pivots.
    fn of(matrix: &Rows) -> Option<Envelope> {
        let columns = matrix.entries.iter().flatten().map(|(j, _)| j + 1).max()?;
        // the rows so far that touch each column
        let mut touching: Vec<Vec<(usize, f64)>> = vec![Vec::new(); columns];
        let mut factor = Envelope {
            first: Vec::new(),
            rows: Vec::new(),
        };
        for (i, row) in matrix.entries.iter().enumerate() {
            let others = row.iter().filter_map(|(j, _)| touching[*j].first());
            let first = others.map(|(k, _)| *k).min().unwrap_or(i);
            let mut line = vec![0.0; i + 1 - first];
            for (j, a) in row {
                for (k, b) in &touching[*j] {
                    line[k - first] += a * b;
                }
                line[i - first] += a * a;
                touching[*j].push((i, *a));
            }
            for k in first..i {
                let from = first.max(factor.first[k]);
                let above = &factor.rows[k];
                let product = dot(
                    &line[from - first..k - first],
                    &above[from - factor.first[k]..],
                );
                line[k - first] = (line[k - first] - product) / above[k - factor.first[k]];
            }
            let pivot = line[i - first] - dot(&line[..i - first], &line[..i - first]);
            if pivot.is_nan() || pivot <= CLEAR {
                return None;
            }
            line[i - first] = libm::sqrt(pivot);
            factor.first.push(first);
            factor.rows.push(line);
        }
        Some(factor)
    }

    /// Solves in place.
    fn solve(&self, rhs: &mut [f64]) {
        for (i, (line, first)) in self.rows.iter().zip(&self.first).enumerate() {
            let sum = dot(&line[..i - first], &rhs[*first..i]);
            rhs[i] = (rhs[i] - sum) / line[i - first];
        }
        for (i, (line, first)) in self.rows.iter().zip(&self.first).enumerate().rev() {
            rhs[i] /= line[i - first];
            let own = rhs[i];
            for (x, a) in rhs[*first..i].iter_mut().zip(line) {
                *x -= a * own;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::closing::Numbers;

    /// Rows that touch two neighbours, as those of a chain.
    fn chain(rows: usize, numbers: &mut Numbers) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(5 * rows, 6 * rows);
        for i in 0..5 * rows {
            for j in (6 * (i / 5)).saturating_sub(6)..6 * (i / 5) + 6 {
                matrix[(i, j)] = numbers.draw();
            }
        }
        matrix
    }

    #[test]
    fn the_solution_is_that_of_singular_values() {
        let mut numbers = Numbers::new(3);
        for rows in [1, 2, 7, 20] {
            let matrix = chain(rows, &mut numbers);
            let rhs = DVector::from_fn(5 * rows, |_, _| numbers.draw());
            let found = solution(&matrix, &rhs).expect("independent rows");
            let svd = crate::singular::decompose(matrix.clone()).expect("numbers");
            let expected = svd.solve(&rhs, 0.0).expect("numbers");
            assert!((&found - &expected).amax() < 1e-10 * expected.amax());
        }
    }

    #[test]
    fn dependent_rows_are_left_to_another_method() {
        let mut numbers = Numbers::new(5);
        let mut matrix = chain(4, &mut numbers);
        let sum = matrix.row(0) + matrix.row(19);
        matrix.set_row(11, &sum);
        let rhs = DVector::from_element(20, 1.0);
        assert!(solution(&matrix, &rhs).is_none());
        // nearly dependent
        matrix[(11, 0)] += 1e-5;
        assert!(solution(&matrix, &rhs).is_none());
        assert!(solution(&DMatrix::zeros(2, 3), &DVector::zeros(2)).is_none());
    }
}
