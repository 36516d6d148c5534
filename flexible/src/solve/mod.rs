//! Linear solutions and eigenvalues of large sparse symmetric matrices, and the order of their elimination.
//!
//! ```text
//! pattern ──ordering──▶ Ordering ──Analysis──▶ Factorization ──▶ solutions, number of negative pivots
//!                                                   └──eigen──▶ lowest modes, proven complete
//! ```
//!
//! Factors and solutions use several threads. The order of all sums is fixed, so the same matrices give the same bits,
//! whatever the number of threads.

mod coarsening;
pub(crate) mod dense;
mod dissection;
pub mod eigen;
mod elimination;
pub mod factor;
mod graph;
pub(crate) mod lanczos;
mod numeric;
pub mod ordering;
mod panels;
pub mod pencil;
pub mod positive;
mod random;
pub(crate) mod restrained;
mod search;
mod separator;
mod sturm;
mod substitution;

pub(crate) use eigen::lowest_modes_from;
pub use eigen::{EigenOptions, EigenSolution, Modes, SturmCount, lowest_modes};
pub use factor::{Analysis, Definiteness, Factorization};
pub use ordering::{Method, Ordering};
pub use pencil::shifted;
pub use positive::Shifted;
