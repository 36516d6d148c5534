//! The contract between Eng's compiler and its runtime.
//!
//! The crate holds the types that pass from one to the other, and the small products and secants that the
//! solvers of motions and of films share. It has no syntax, no files and no solver.

#![forbid(unsafe_code)]
#![deny(clippy::disallowed_methods)]
// no input may end the library in a panic
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable,
    clippy::todo
)]

pub mod analysis;
pub mod code;
pub mod delimited;
pub mod dense;
pub mod dimension;
pub mod elementary;
pub mod expression;
pub mod field;
pub mod figure;
pub mod flexible;
pub mod host;
pub mod input;
mod kinds;
pub mod layout;
pub mod lint;
pub mod mesh_files;
pub mod place;
pub mod recorded;
pub mod reduced;
pub mod report;
pub mod secants;
pub mod sentence;
pub mod significant;
pub mod stack;
pub mod surface;
pub mod system;
pub mod table;

pub use dimension::{Dimension, DisplayUnit};

/// Parts for the tests in `tests/` alone. No other crate may use them.
#[doc(hidden)]
pub mod internals {
    pub use crate::analysis::named::fits;
}
