//! Eng's compiler turns syntax trees into a flat system and machine code.
//!
//! It opens no files: the host trait of [`eng_system`] reads them. It prints nothing and does not use the
//! runtime.

// Tests may call the standard library's functions, to compare with them.
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
// no input may end the library in a panic
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::todo
    )
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
