//! A test of factors.

use super::{Pattern, Runs};

/// Backward error of the probe's solution above which factors are useless. A choice: Newton's method with
/// such factors still wins nine digits in an iteration; growth of pivots that spoils a factorisation goes far
/// beyond.
const BACKWARD_ERROR: f64 = 1e-9;
/// Size of the probe's solution above which the matrix counts as singular. In exact arithmetic the solution
/// is ones. A choice: errors of a regular matrix are rounding times its condition and far below.
const LARGEST: f64 = 1e9;

/// Solves `A x = A·1` and checks the solution.
#[derive(Clone, Debug, Default)]
pub(super) struct Probe {
    runs: Runs,
    ones: Vec<f64>,
    solution: Vec<f64>,
    product: Vec<f64>,
    magnitude: Vec<f64>,
}

impl Probe {
    /// A probe for matrices of a pattern.
    pub(super) fn new(pattern: &Pattern) -> Probe {
        let size = pattern.size();
        Probe {
            runs: Runs::new(pattern),
            ones: vec![1.0; size],
            solution: vec![0.0; size],
            product: vec![0.0; size],
            magnitude: vec![0.0; size],
        }
    }

    /// The right-hand side `A·1`, to be overwritten by the solution.
    pub(super) fn begin(&mut self, values: &[f64]) -> &mut [f64] {
        self.product.fill(0.0);
        self.magnitude.fill(0.0);
        let (sum, size) = (&mut self.product, &mut self.magnitude);
        self.runs.add_product(values, 1.0, &self.ones, sum, size);
        self.solution.copy_from_slice(&self.product);
        &mut self.solution
    }

    /// Whether the solution has a backward error below 1e-9 in every row and is below 1e9. Growing pivots
    /// fail the first test, and a singular matrix the second.
    pub(super) fn passes(&mut self, values: &[f64]) -> bool {
        let (sum, size) = (&mut self.product, &mut self.magnitude);
        self.runs
            .add_product(values, -1.0, &self.solution, sum, size);
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
