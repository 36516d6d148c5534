//! The effect of changed coefficients on the eigenvalues.
//!
//! Let `A X = X Λ` be the equations at the state, and A' those of another moment in the same coordinates, which
//! are `x' = P x` with `P = N'ᵀM'N`. In the modes the change is
//!
//! ```text
//! D = X⁻¹ (A' − A) X        δ = max_ij √|D_ij D_ji| / |λ_i|
//! ```
//!
//! D (n × n, 1/s): D_ii is the first-order change of λ_i by a lasting change of the coefficients. A periodic
//! change has the second-order effect `D_ij D_ji/(λ_i − λ_j + ikΩ)`, and `√(D_ij D_ji)` in resonance, which is its
//! largest (V. A. Yakubovich, V. M. Starzhinskii, Linear Differential Equations with Periodic Coefficients, 1975,
//! IV). So δ bounds the change of an eigenvalue as a share of its size, up to a factor near 1. The scaling of the
//! modes cancels in the product, so a soft direction counts beside a stiff one.
//!
//! The coordinates of both moments agree only if N' spans the same moves as N. The sine of the angle between them
//! is `√|NᵀM'N − PᵀP|`, and δ is at least this sine.

use super::eigen::spectrum;
use super::equations::Equations;
use nalgebra::{Complex, DMatrix};

/// Number of roundings of the terms of D below which there is no change. A choice: the terms are sums of
/// products of computed matrices, so their rounding is many units of the last place.
const ROUNDINGS: f64 = 100.0;
/// Largest error of `X⁻¹AX` as a share of an eigenvalue. Nearly parallel modes exceed it, and give no result.
/// A choice: eigenvalues are then right to the digits that are printed.
const MISSED: f64 = 1e-6;

/// The modes of the equations at a state.
pub(super) struct Modal<'a> {
    equations: &'a Equations,
    matrix: DMatrix<f64>,
    values: Vec<Complex<f64>>,
    /// X.
    right: DMatrix<Complex<f64>>,
    /// X⁻¹.
    left: DMatrix<Complex<f64>>,
    /// Rounding error of D.
    rounding: DMatrix<f64>,
    /// |λ| (rad/s) below which an eigenvalue counts as zero.
    resolution: f64,
}

fn complex(matrix: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
    matrix.map(|x| Complex::new(x, 0.0))
}

impl<'a> Modal<'a> {
    /// The modes of equations; `None` if they do not span all motions, as for a double zero.
    pub fn new(equations: &'a Equations) -> Option<Modal<'a>> {
        let matrix = equations.first_order();
        let n = matrix.nrows();
        let found = spectrum(matrix.clone()).ok()?;
        let (mut values, mut columns) = (Vec::new(), Vec::new());
        for pair in found.pairs {
            let vector = pair.vector.unscale(pair.vector.norm());
            let conjugate = (pair.value.im > 0.0).then(|| (pair.value.conj(), vector.conjugate()));
            values.push(pair.value);
            columns.push(vector);
            if let Some((value, vector)) = conjugate {
                values.push(value);
                columns.push(vector);
            }
        }
        let right = DMatrix::from_columns(&columns);
        let left = (right.shape() == (n, n))
            .then(|| right.clone().try_inverse())
            .flatten()?;
        let rounding = left.map(|x| x.norm()) * matrix.abs() * right.map(|x| x.norm());
        let resolution = libm::sqrt(n as f64 * f64::EPSILON) * found.size.max(equations.rate_scale);
        let modal = Modal {
            equations,
            values,
            left,
            right,
            rounding: rounding * (ROUNDINGS * f64::EPSILON),
            resolution,
            matrix,
        };
        let again = &modal.left * complex(&modal.matrix) * &modal.right;
        let met = modal.values.iter().enumerate().all(|(i, value)| {
            value.norm() <= modal.resolution
                || (again[(i, i)] - value).norm() <= MISSED * value.norm()
        });
        met.then_some(modal)
    }

    /// δ of the equations of another moment; infinite if their number of freedoms differs.
    pub fn change(&self, other: &Equations) -> f64 {
        let (p, n) = (self.equations.freedoms(), self.matrix.nrows());
        if other.freedoms() != p || other.first_order_size() != n {
            return f64::INFINITY;
        }
        let basis = &self.equations.basis;
        let turn = other.basis.transpose() * &other.mass * basis;
        let aside = basis.transpose() * &other.mass * basis - turn.transpose() * &turn;
        let mut whole = DMatrix::identity(n, n);
        for first in [0, p] {
            whole.view_mut((first, first), (p, p)).copy_from(&turn);
        }
        let Some(back) = whole.clone().try_inverse() else {
            return f64::INFINITY;
        };
        let change = back * other.first_order() * whole - &self.matrix;
        if change.iter().any(|x| !x.is_finite()) {
            return f64::INFINITY;
        }
        let seen = &self.left * complex(&change) * &self.right;
        let size = |i: usize, j: usize| (seen[(i, j)].norm() - self.rounding[(i, j)]).max(0.0);
        let mut largest = libm::sqrt(aside.amax());
        for (i, value) in self.values.iter().enumerate() {
            let most = (0..n).fold(0.0_f64, |most, j| most.max(size(i, j) * size(j, i)));
            let (most, value) = (libm::sqrt(most), value.norm());
            let share = if value > self.resolution {
                most / value
            } else if most <= self.resolution {
                0.0
            } else {
                f64::INFINITY
            };
            largest = largest.max(share);
        }
        largest
    }
}
