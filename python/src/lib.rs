//! The native part of the Python package `englang`, as the module `englang._native`.
//!
//! It translates calls, values and errors between Python and the library `eng`, and has no rules of its own. Its documentation
//! is for readers in Python; `englang/_native.pyi` states the types.
#![deny(clippy::undocumented_unsafe_blocks)]
// no input may end the interpreter in a panic
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable,
    clippy::todo
)]

mod analysis;
mod column;
mod command;
mod failure;
mod gradient;
mod model;
mod packing;
mod program;
mod quantities;
mod report;
mod run;
mod simulation;
mod table;
mod watch;

/// The native part of `englang`.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::analysis::Analysis;
    #[pymodule_export]
    use crate::column::Column;
    #[pymodule_export]
    use crate::command::cli;
    #[pymodule_export]
    use crate::gradient::Gradient;
    #[pymodule_export]
    use crate::model::{Channel, Input, Model, Parameter};
    #[pymodule_export]
    use crate::program::{Program, from_text, load};
    #[pymodule_export]
    use crate::quantities::si;
    #[pymodule_export]
    use crate::report::{Condition, Report};
    #[pymodule_export]
    use crate::run::Run;
    #[pymodule_export]
    use crate::simulation::{Reading, Simulation};
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "the name that Python expects")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
