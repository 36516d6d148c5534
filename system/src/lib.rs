//! The contract between Eng's compiler and its runtime.
//!
//! This crate knows no syntax, no file and no solver: only what is handed from one to the other.

#![forbid(unsafe_code)]
// tests compare with the standard library's functions
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod analysis;
pub mod code;
pub mod dimension;
pub mod flexible;
pub mod host;
pub mod layout;
pub mod lint;
pub mod mesh_files;
pub mod place;
pub mod recorded;
pub mod reduced;
pub mod report;
pub mod system;
pub mod table;

pub use dimension::{Dimension, DisplayUnit};
