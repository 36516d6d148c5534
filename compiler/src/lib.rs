//! Eng's compiler: from syntax trees to a flat system and machine code.
//!
//! It does no I/O (files come through [`eng_system`]'s host trait) and knows no terminal; it never sees the runtime.

// tests compare with the standard library's functions
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod check;
mod codegen_error;
pub mod codes;
pub mod elaborate;
mod functions;
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
