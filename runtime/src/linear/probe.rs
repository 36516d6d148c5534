//! Whether factors can be trusted.

use super::Pattern;

/// Backward error of the probe's solution above which factors say nothing.
const BACKWARD_ERROR: f64 = 1e-9;
/// Size of the probe's solution, ones in exact arithmetic, above which the matrix counts as singular.
const LARGEST: f64 = 1e9;

/// Solves `A x = A·1` and looks at what comes out.
#[derive(Clone, Debug, Default)]
pub(super) struct Probe {
    solution: Vec<f64>,
    product: Vec<f64>,
    magnitude: Vec<f64>,
}

impl Probe {
    /// Room for a size.
    pub(super) fn new(size: usize) -> Probe {
        Probe {
            solution: vec![0.0; size],
            product: vec![0.0; size],
            magnitude: vec![0.0; size],
        }
    }

    /// The right-hand side `A·1`, to be overwritten by the solution.
    pub(super) fn begin(&mut self, pattern: &Pattern, values: &[f64]) -> &mut [f64] {
        self.product.fill(0.0);
        self.magnitude.fill(0.0);
        for (row, value) in pattern.rows.iter().zip(values) {
            self.product[*row] += value;
            self.magnitude[*row] += value.abs();
        }
        self.solution.copy_from_slice(&self.product);
        &mut self.solution
    }

    /// Whether the solution has a backward error below 1e-9 in every row, which growing pivots would not give, and stays below
    /// 1e9, which that of a singular matrix would not.
    pub(super) fn passes(&mut self, pattern: &Pattern, values: &[f64]) -> bool {
        for (c, x) in self.solution.iter().enumerate() {
            for k in pattern.columns[c]..pattern.columns[c + 1] {
                let row = pattern.rows[k];
                let term = values[k] * x;
                self.product[row] -= term;
                self.magnitude[row] += term.abs();
            }
        }
        self.product
            .iter()
            .zip(&self.magnitude)
            .all(|(r, m)| r.is_finite() && r.abs() <= BACKWARD_ERROR * m)
            && self
                .solution
                .iter()
                .all(|x| x.is_finite() && x.abs() < LARGEST)
    }
}
