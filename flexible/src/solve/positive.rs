//! A first factor of `K − σ M`: positive definite, with σ below all eigenvalues and near them.

use super::factor::{Analysis, Definiteness, Factorization, diagonal};
use super::pencil::shifted;
use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;
use std::sync::Arc;

/// First guess of |σ| over the typical ratio of the diagonals, itself about the largest eigenvalue. A choice:
/// seven digits above the rounding of a stiffness, so that the matrix with rigid motions is clearly positive
/// definite.
pub(super) const FIRST_SHIFT: f64 = 1e-9;
/// Factor on |σ| if the matrix factor is not positive definite: stiffnesses written with few digits have
/// slightly negative eigenvalues in place of their zeros. A choice: two rises reach [`LARGEST`].
const LARGER: f64 = 1e3;
/// |σ| over the typical ratio is not raised from here. A choice: a stiffness that is still not positive
/// definite has wrong signs, not few digits.
const LARGEST: f64 = 1e-3;

/// A positive definite `K − σ M`, factored.
#[derive(Debug)]
pub struct Shifted {
    /// σ (rad²/s²), negative.
    pub shift: f64,
    /// The factor.
    pub factor: Factorization,
}

impl Shifted {
    /// With a σ low enough, as near zero as the digits of the matrices allow.
    ///
    /// # Errors
    /// As [`Factorization::new`]; when no row has both mass and stiffness.
    pub fn new(
        stiffness: &SymmetricMatrix,
        mass: &SymmetricMatrix,
        analysis: &Arc<Analysis>,
    ) -> Result<Self, FlexibleError> {
        let typical = typical_ratio(stiffness, mass)?;
        first_shift(typical, |shift| {
            let matrix = shifted(stiffness, mass, shift)?;
            let factor = Factorization::new(analysis, &matrix, Definiteness::Positive)?;
            Ok(Shifted { shift, factor })
        })
    }
}

/// The result of the first shift σ that works; shifts are tried in the order of their distance from zero.
///
/// # Errors
/// The error of the last shift.
pub(super) fn first_shift<T>(
    typical: f64,
    mut factor: impl FnMut(f64) -> Result<T, FlexibleError>,
) -> Result<T, FlexibleError> {
    let mut shift = -FIRST_SHIFT * typical;
    loop {
        match factor(shift) {
            Err(FlexibleError::Singular { .. }) if shift > -LARGEST * typical => shift *= LARGER,
            result => return result,
        }
    }
}

/// The median of the ratios of the diagonals of stiffness and mass (rad²/s²), over rows that have both.
///
/// # Errors
/// When there is no such row.
pub(super) fn typical_ratio(
    stiffness: &SymmetricMatrix,
    mass: &SymmetricMatrix,
) -> Result<f64, FlexibleError> {
    let mut ratios: Vec<f64> = diagonal(stiffness)
        .iter()
        .zip(diagonal(mass))
        .map(|(stiffness, mass)| stiffness / mass)
        .filter(|ratio| ratio.is_finite() && *ratio > 0.0)
        .collect();
    let middle = ratios.len() / 2;
    if ratios.is_empty() {
        return Err(FlexibleError::Matrix {
            problem: "no row has both mass and stiffness: there are no modes".into(),
            advice: "give the materials densities".into(),
        });
    }
    let (_, typical, _) = ratios.select_nth_unstable_by(middle, f64::total_cmp);
    Ok(*typical)
}
