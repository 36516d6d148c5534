//! The lowest eigenvalues of `K x = λ M x`. A Sturm count proves that none is missing.
//!
//! `K` and `M` are symmetric and positive semidefinite. Either may be singular (a free body, massless
//! freedoms), but not for the same motion. With a shift σ < 0, `K − σ M` is positive definite, and the
//! eigenvalues nearest σ are the lowest ones: a block Lanczos iteration finds them. Then `K − s M` is
//! factored with s just above the last eigenvalue. The number of its negative pivots is the number of
//! eigenvalues below s. It does not depend on the iteration.

use super::factor::Analysis;
use super::positive::Shifted;
use super::search::{Search, Start};
use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The wanted modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Modes {
    /// This number of the lowest modes, including rigid ones.
    Count(usize),
    /// All modes with an eigenvalue (2π f)² below this, rad²/s².
    UpTo(f64),
}

/// Options of the search.
#[derive(Clone, Debug)]
pub struct EigenOptions {
    /// Order and structure of the factor, if the caller has them for the pattern of
    /// [`shifted`](super::shifted).
    pub analysis: Option<Arc<Analysis>>,
    /// Shift σ, below all eigenvalues, rad²/s². Without it the search chooses one.
    pub shift: Option<f64>,
    /// Vectors iterated together, at least 1.
    pub block: usize,
    /// Number of vectors in memory. The default is twice the modes plus ten blocks. The least possible number
    /// is the modes plus four blocks.
    pub basis: Option<usize>,
    /// A mode counts as found below this relative residual in the inverse iteration. The relative error of
    /// its eigenvalue is about the square of this.
    pub tolerance: f64,
    /// Combinations of rows (row and coefficient) that every mode keeps at zero. They must not follow from
    /// each other.
    pub held: Vec<Vec<(u32, f64)>>,
    /// The largest number of solved blocks. The default is ample for the wanted modes.
    pub solves: Option<usize>,
}

impl Default for EigenOptions {
    fn default() -> Self {
        EigenOptions {
            analysis: None,
            shift: None,
            block: 8,
            basis: None,
            // residual of an eigenpair as a share: the eigenvalue is then right to about its square, and the
            // shape to nine digits. A choice
            tolerance: 1e-9,
            held: Vec::new(),
            solves: None,
        }
    }
}

/// The result of a count by inertia.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SturmCount {
    /// Number of eigenvalues below [`SturmCount::below`]; all of them were found. It may exceed the number of
    /// returned modes, if other eigenvalues are as close to the last wanted one as the rounding error.
    pub count: usize,
    /// Up to this eigenvalue (rad²/s²) no mode is missing.
    pub below: f64,
}

/// Modes.
#[derive(Clone, Debug)]
pub struct EigenSolution {
    /// Eigenvalues (2π f)², rad²/s², ascending. Those of rigid motions are rounding errors of either sign.
    pub eigenvalues: Vec<f64>,
    /// Vectors one after the other, each of the matrices' size, `xᵀ M x = 1`, the largest component positive
    /// (the first of those within a millionth of the largest).
    pub vectors: Vec<f64>,
    /// `‖K x − λ M x‖ / (|λ − σ| ‖M x‖)` of each mode, without the part that forces along held combinations
    /// balance.
    pub residuals: Vec<f64>,
    /// The proof that none is missing.
    pub sturm: SturmCount,
    /// The used shift σ, rad²/s².
    pub shift: f64,
    /// Number of factorisations.
    pub factorizations: usize,
    /// Number of solved blocks of vectors.
    pub solves: usize,
}

/// Finds modes.
///
/// # Errors
/// [`FlexibleError::Matrix`] for matrices that don't fit, are not finite, or have negative masses;
/// [`FlexibleError::Singular`] when a motion has neither stiffness nor mass; [`FlexibleError::Numerical`]
/// when fewer modes exist than requested, or the iteration or the count fails.
pub fn lowest_modes(
    stiffness: &SymmetricMatrix,
    mass: &SymmetricMatrix,
    request: Modes,
    options: &EigenOptions,
) -> Result<EigenSolution, FlexibleError> {
    lowest_modes_from(None, stiffness, mass, request, options)
}

/// Like [`lowest_modes`], with an existing factor. The factor must belong to these matrices and to the
/// analysis in the options.
///
/// # Errors
/// Those of [`lowest_modes`].
pub(crate) fn lowest_modes_from(
    start: Option<Shifted>,
    stiffness: &SymmetricMatrix,
    mass: &SymmetricMatrix,
    request: Modes,
    options: &EigenOptions,
) -> Result<EigenSolution, FlexibleError> {
    let mut search = Search::new(stiffness, mass, options)?;
    match request {
        Modes::Count(0) => Ok(search.nothing(0.0)),
        Modes::Count(count) => search.run(count, None, start.map(Start::Positive)),
        Modes::UpTo(limit) => {
            if !limit.is_finite() || limit <= 0.0 {
                return Err(FlexibleError::Matrix {
                    problem: format!("modes up to the eigenvalue {limit}"),
                    advice: "give a positive frequency".into(),
                });
            }
            let (count, _, factor) = search.inertia(start.map(|start| start.factor), limit)?;
            if count == 0 {
                Ok(search.nothing(limit))
            } else {
                let memory = Start::Memory(factor.into_factor());
                search.run(count, Some(limit), Some(memory))
            }
        }
    }
}
