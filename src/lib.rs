//! Eng: engines as text.
#![forbid(unsafe_code)]

pub mod cli;
pub mod plot;
pub mod render;
pub mod results;
