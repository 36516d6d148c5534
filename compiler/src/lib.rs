//! Eng's compiler turns syntax trees into a flat system and machine code.
//!
//! It opens no files: the host trait of [`eng_system`] reads them. It prints nothing and does not use the
//! runtime.

#![deny(clippy::disallowed_methods)]
// no input may end the library in a panic
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable,
    clippy::todo
)]

pub mod check;
mod codegen_error;
pub mod codes;
pub mod elaborate;
pub mod functions;
pub mod generate;
pub mod ir;
#[cfg(feature = "jit")]
pub mod jit;
pub mod library;
pub mod models;
pub mod program;
pub mod resolve;
pub mod typed;
mod words;

/// Parts for the tests in `tests/` alone. No other crate may use them.
#[doc(hidden)]
pub mod internals {
    pub use crate::ir::differentiate::{time_derivative, uses_acceleration};
    pub use crate::resolve::suggest::listing;
    pub use crate::typed::types::{Dim, Kind, Misfit, Quantity};

    /// The names of all functions of the language, in the order of their table.
    pub fn function_names() -> impl Iterator<Item = &'static str> {
        crate::functions::all_names()
    }
}
