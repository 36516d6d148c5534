//! The command `eng` inside of the wheel.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command `eng` with arguments, of which the first is its name, and returns its exit code.
#[pyfunction]
pub fn cli(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| eng::cli::status(arguments))
}
