//! Mode sets: static and normal modes of a structure, and their sum as an orthonormal set.
//!
//! ```text
//! Structure (K, M over free freedoms) ──statics──▶ attachment, constraint modes ┐
//!                                     ──normal───▶ free, fixed, supported modes ┴─set─▶ ModeSet
//! ```
//!
//! Vectors are over the structure's free freedoms, one after the other.

pub mod given;
pub mod interface;
pub mod normal;
pub mod rigid;
pub mod set;
pub mod statics;

pub use normal::{Boundary, NormalModes};
pub use rigid::Rigid;
pub use set::{Candidate, Dropped, ModeSet};

use crate::error::FlexibleError;
use crate::solve::{Analysis, shifted};
use crate::sparse::{SymmetricMatrix, SymmetricOperator};
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use std::sync::{Arc, OnceLock};

/// Stiffness and mass over free freedoms, and the rigid motions of an unsupported body.
#[derive(Debug)]
pub struct Structure<'a> {
    /// K (N/m, N/rad, …).
    pub stiffness: &'a SymmetricMatrix,
    /// M (kg, …).
    pub mass: &'a SymmetricMatrix,
    /// The six rigid motions of a body that nothing holds; `None` for a supported one.
    pub rigid: Option<Rigid>,
    analysis: OnceLock<Arc<Analysis>>,
}

impl<'a> Structure<'a> {
    /// The structure of a supported body, whose K is not singular.
    pub fn supported(stiffness: &'a SymmetricMatrix, mass: &'a SymmetricMatrix) -> Self {
        Structure {
            stiffness,
            mass,
            rigid: None,
            analysis: OnceLock::new(),
        }
    }

    /// The structure of an unsupported body, with its six rigid motions as vectors one after the other.
    ///
    /// # Errors
    /// When the rigid motions have no mass, or stretch the structure: their strain energy is above 1e-6 of
    /// the sum of the energies of their components, each freedom taken alone.
    pub fn free(
        stiffness: &'a SymmetricMatrix,
        mass: &'a SymmetricMatrix,
        motions: Vec<f64>,
    ) -> Result<Self, FlexibleError> {
        let rigid = Rigid::new(stiffness, mass, motions)?;
        Ok(Structure {
            stiffness,
            mass,
            rigid: Some(rigid),
            analysis: OnceLock::new(),
        })
    }

    /// Order and structure of the factors of `K − σ M`, computed at the first use.
    ///
    /// # Errors
    /// When memory or indices run out.
    pub fn analysis(&self) -> Result<Arc<Analysis>, FlexibleError> {
        if let Some(analysis) = self.analysis.get() {
            return Ok(analysis.clone());
        }
        let pattern = shifted(self.stiffness, self.mass, 0.0)?;
        let found = Arc::new(Analysis::fill_reducing(&pattern)?);
        Ok(self.analysis.get_or_init(|| found).clone())
    }

    /// Number of free freedoms.
    pub fn size(&self) -> usize {
        self.stiffness.size()
    }
}

/// A unit load on the structure, as a row of a marker over the free freedoms. The same row gives the
/// displacement on which the load works. A constraint mode holds this displacement.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// `main[2].x`.
    pub label: String,
    /// Freedom and factor.
    pub entries: Vec<(u32, f64)>,
}

impl Load {
    /// The displacement on which the load works, for a vector of the structure. In m for a force and rad for
    /// a torque.
    pub fn displacement(&self, vector: &[f64]) -> f64 {
        self.entries
            .iter()
            .map(|(freedom, factor)| factor * vector.get(*freedom as usize).copied().unwrap_or(0.0))
            .sum()
    }

    /// The freedom, if the row is exactly one freedom with factor 1.
    pub fn plain(&self) -> Option<u32> {
        match self.entries.as_slice() {
            [(freedom, factor)] if *factor == 1.0 => Some(*freedom),
            _ => None,
        }
    }

    fn add_to(&self, vector: &mut [f64]) -> Result<(), FlexibleError> {
        for (freedom, factor) in &self.entries {
            match vector.get_mut(*freedom as usize) {
                Some(x) => *x += factor,
                None => {
                    return Err(FlexibleError::Matrix {
                        problem: format!(
                            "the load {} acts on freedom {}, of {}",
                            self.label,
                            freedom,
                            vector.len()
                        ),
                        advice: String::new(),
                    });
                }
            }
        }
        Ok(())
    }
}

/// `XᵀY` of vectors of a length, by columns: rows are those of X.
pub(crate) fn products(length: usize, x: &[f64], y: &[f64]) -> Vec<f64> {
    let count = |v: &[f64]| v.len().checked_div(length).unwrap_or(0);
    let (rows, columns) = (count(x), count(y));
    let mut out = vec![0.0; rows * columns];
    if !out.is_empty() {
        matmul(
            MatMut::from_column_major_slice_mut(&mut out, rows, columns),
            Accum::Replace,
            MatRef::from_column_major_slice(&x[..length * rows], length, rows).transpose(),
            MatRef::from_column_major_slice(&y[..length * columns], length, columns),
            1.0,
            Par::Seq,
        );
    }
    out
}

/// The operator on several vectors.
pub(crate) fn applied(operator: &dyn SymmetricOperator, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    if let Some(columns) = x.len().checked_div(operator.size()) {
        operator.apply(columns, x, &mut y);
    }
    y
}
