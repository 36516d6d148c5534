//! The lowest eigenvalues of `K x = λ M x`, proven complete by a Sturm count.
//!
//! `K` and `M` are symmetric and positive semidefinite, either may be singular (a free body, massless
//! freedoms), but not over the same motion. With a shift σ < 0, `K − σ M` is positive definite, and the
//! eigenvalues nearest σ are the lowest ones: a block Lanczos iteration finds them. Then `K − s M` is
//! factored with s just above the last one: its number of negative pivots is the number of eigenvalues below
//! s, whatever the iteration found.

use super::factor::Analysis;
use super::positive::Shifted;
use super::search::{Search, Start};
use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Which modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Modes {
    /// So many of the lowest, rigid ones counted.
    Count(usize),
    /// All with an eigenvalue (2π f)² below this, rad²/s².
    UpTo(f64),
}

/// How to look for them.
#[derive(Clone, Debug)]
pub struct EigenOptions {
    /// Order and structure of the factor, if the caller has them for the pattern of
    /// [`shifted`](super::shifted).
    pub analysis: Option<Arc<Analysis>>,
    /// Shift σ, below all eigenvalues, rad²/s²; else one is found.
    pub shift: Option<f64>,
    /// Vectors iterated together, at least 1.
    pub block: usize,
    /// Vectors held at once; else twice the modes and ten blocks. Fewer than the modes and four blocks are
    /// not possible.
    pub basis: Option<usize>,
    /// Residual of a mode in the inverse iteration, relative, at which it counts as found. The eigenvalue's
    /// relative error is about the square of it.
    pub tolerance: f64,
    /// Combinations of rows (row and coefficient) that every mode keeps at zero. They must not follow from
    /// each other.
    pub held: Vec<Vec<(u32, f64)>>,
    /// Blocks solved for, at most; else a number that is plenty for the modes.
    pub solves: Option<usize>,
}

impl Default for EigenOptions {
    fn default() -> Self {
        EigenOptions {
            analysis: None,
            shift: None,
            block: 8,
            basis: None,
            tolerance: 1e-9,
            held: Vec::new(),
            solves: None,
        }
    }
}

/// What a count by inertia showed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SturmCount {
    /// Eigenvalues below [`SturmCount::below`], all found. It may be more than the modes given, when the last
    /// one asked for has others as close to it as rounding.
    pub count: usize,
    /// The eigenvalue up to which nothing is missing, rad²/s².
    pub below: f64,
}

/// Modes.
#[derive(Clone, Debug)]
pub struct EigenSolution {
    /// Eigenvalues (2π f)², rad²/s², ascending. Those of rigid motions are rounding, of either sign.
    pub eigenvalues: Vec<f64>,
    /// Vectors one after the other, each of the matrices' size, `xᵀ M x = 1`, the largest component positive
    /// (the first of those within a millionth of the largest).
    pub vectors: Vec<f64>,
    /// `‖K x − λ M x‖ / (|λ − σ| ‖M x‖)` of each, without what the forces along held combinations balance.
    pub residuals: Vec<f64>,
    /// That none is missing.
    pub sturm: SturmCount,
    /// The shift σ used, rad²/s².
    pub shift: f64,
    /// Factorisations made.
    pub factorizations: usize,
    /// Blocks of vectors solved for.
    pub solves: usize,
}

/// Finds modes.
///
/// # Errors
/// [`FlexibleError::Matrix`] for matrices that don't fit, are not finite, or have negative masses;
/// [`FlexibleError::Singular`] when a motion has neither stiffness nor mass; [`FlexibleError::Numerical`]
/// when there are fewer modes than asked for, or the iteration or the count does not come out.
pub fn lowest_modes(
    stiffness: &SymmetricMatrix,
    mass: &SymmetricMatrix,
    request: Modes,
    options: &EigenOptions,
) -> Result<EigenSolution, FlexibleError> {
    lowest_modes_from(None, stiffness, mass, request, options)
}

/// As [`lowest_modes`], with a factor that is there already, of these matrices and of the analysis among the
/// options.
///
/// # Errors
/// As [`lowest_modes`].
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
