//! Rigid motions of a free structure: their removal from vectors and loads, and the fewest freedoms that hold
//! them.

use super::{applied, products};
use crate::error::FlexibleError;
use crate::solve::dense::{subtract, symmetric_eigen};
use crate::sparse::SymmetricMatrix;
use eng_system::significant::short;

/// Rigid motions R, orthonormal in the mass.
#[derive(Clone, Debug)]
pub struct Rigid {
    size: usize,
    /// See [`Rigid::residual`].
    residual: f64,
    /// See [`Rigid::noise`].
    noise: f64,
    /// R with `RᵀMR = I`.
    motions: Vec<f64>,
    /// `M R`.
    inertial: Vec<f64>,
}

impl Rigid {
    pub(super) fn new(
        stiffness: &SymmetricMatrix,
        mass: &SymmetricMatrix,
        mut motions: Vec<f64>,
    ) -> Result<Rigid, FlexibleError> {
        let size = mass.size();
        if size == 0 || !motions.len().is_multiple_of(size) {
            return Err(FlexibleError::Matrix {
                problem: format!(
                    "rigid motions of {} numbers for {size} freedoms",
                    motions.len()
                ),
                advice: String::new(),
            });
        }
        let residual = check_stretch(stiffness, &motions)?;
        let count = motions.len() / size;
        // Gram–Schmidt in the mass; the second pass removes the rounding of the first
        let mut inertial = Vec::new();
        for _ in 0..2 {
            inertial = applied(mass, &motions);
            for column in 0..count {
                let (before, rest) = motions.split_at_mut(column * size);
                let (inertial_before, inertial_rest) = inertial.split_at_mut(column * size);
                let (own, own_inertial) = (&mut rest[..size], &mut inertial_rest[..size]);
                let coefficients = products(size, inertial_before, own);
                subtract(size, before, &coefficients, own);
                subtract(size, inertial_before, &coefficients, own_inertial);
                let square: f64 = own
                    .iter()
                    .zip(own_inertial.iter())
                    .map(|(x, y)| x * y)
                    .sum();
                if !(square > 0.0 && square.is_finite()) {
                    return Err(FlexibleError::Structure {
                        problem: "a rigid motion of the structure has no mass".into(),
                        advice: "give the materials their density".into(),
                    });
                }
                let scale = 1.0 / libm::sqrt(square);
                for x in own.iter_mut().chain(own_inertial) {
                    *x *= scale;
                }
            }
        }
        let resisted = products(size, &motions, &applied(stiffness, &motions));
        let (values, _) = symmetric_eigen(count, resisted)?;
        let noise = values.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        Ok(Rigid {
            size,
            residual,
            noise,
            motions,
            inertial,
        })
    }

    /// Removes rigid motion from vectors: `u −= R RᵀM u`.
    pub fn remove(&self, vectors: &mut [f64]) {
        // the second pass removes the rounding of the first
        for _ in 0..2 {
            let coefficients = products(self.size, &self.inertial, vectors);
            subtract(self.size, &self.motions, &coefficients, vectors);
        }
    }

    /// Balances loads with the inertia of the rigid motion that they cause: `f −= M R Rᵀf`.
    pub fn balance(&self, loads: &mut [f64]) {
        for _ in 0..2 {
            let coefficients = products(self.size, &self.motions, loads);
            subtract(self.size, &self.inertial, &coefficients, loads);
        }
    }

    /// The largest `‖K r‖ / ‖|K| |r|‖` of a rigid motion r: the part of the forces freedom by freedom that
    /// does not cancel. It is about the rounding of the entries of K.
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// The largest |eigenvalue| of `RᵀKR` (rad²/s²). It is zero except for the rounding of K, and so
    /// estimates the effect of this rounding on every eigenvalue.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// The motions, one after the other, `RᵀMR = I`.
    pub fn motions(&self) -> &[f64] {
        &self.motions
    }

    /// Number of rigid motions.
    pub fn count(&self) -> usize {
        self.motions.len() / self.size
    }

    /// Freedoms that hold the rigid motions, one for each motion. Each is the freedom with the largest
    /// remaining motion (elimination with complete pivoting).
    pub fn holding_freedoms(&self) -> Vec<usize> {
        let count = self.count();
        let mut left = self.motions.clone();
        let mut open: Vec<usize> = (0..count).collect();
        let mut found = Vec::with_capacity(count);
        while !open.is_empty() {
            let mut best = (0.0, 0, 0);
            for (place, motion) in open.iter().enumerate() {
                for (freedom, x) in left[motion * self.size..(motion + 1) * self.size]
                    .iter()
                    .enumerate()
                {
                    if x.abs() > best.0 {
                        best = (x.abs(), place, freedom);
                    }
                }
            }
            let (_, place, freedom) = best;
            let pivot = open.remove(place);
            found.push(freedom);
            let value = left[pivot * self.size + freedom];
            for motion in &open {
                let factor = left[motion * self.size + freedom] / value;
                for i in 0..self.size {
                    let x = left[pivot * self.size + i];
                    left[motion * self.size + i] -= factor * x;
                }
                left[motion * self.size + freedom] = 0.0;
            }
        }
        found
    }
}

/// `‖K r‖ / ‖|K| |r|‖` of each motion r: the part of the forces, freedom by freedom, that does not cancel;
/// zero without forces.
pub fn residuals(stiffness: &SymmetricMatrix, motions: &[f64]) -> Vec<f64> {
    let size = stiffness.size();
    let mut sizes = stiffness.clone();
    sizes.values_mut().iter_mut().for_each(|x| *x = x.abs());
    let positive: Vec<f64> = motions.iter().map(|x| x.abs()).collect();
    let (forces, bounds) = (applied(stiffness, motions), applied(&sizes, &positive));
    let norm = |x: &[f64]| libm::sqrt(x.iter().map(|x| x * x).sum());
    forces
        .chunks_exact(size.max(1))
        .zip(bounds.chunks_exact(size.max(1)))
        .map(|(force, bound)| match norm(bound) {
            0.0 => 0.0,
            bound => norm(force) / bound,
        })
        .collect()
}

/// Refuses motions that the stiffness resists. Returns the largest of the [`residuals`].
fn check_stretch(stiffness: &SymmetricMatrix, motions: &[f64]) -> Result<f64, FlexibleError> {
    let mut worst = 0.0f64;
    for (number, share) in residuals(stiffness, motions).into_iter().enumerate() {
        worst = worst.max(share);
        // the forces of a rigid motion cancel up to the digits of the stiffness: matrices with seven digits
        // pass. A spring to the ground as soft as this share of the stiffness passes, too. A choice
        if share.is_nan() || share > 1e-6 {
            return Err(FlexibleError::Structure {
                problem: format!(
                    "the stiffness of the structure resists its rigid motion {}: {} of the forces remain",
                    number + 1,
                    short(share, 2)
                ),
                advice: "remove supports, springs and equations (MPC) to the ground from a free body; give matrices of another code with all their digits, and with the mesh and the units of the same run".into(),
            });
        }
    }
    Ok(worst)
}
