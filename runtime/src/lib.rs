//! Eng's runtime: state on the manifold, kinematic chain, assembly, integration, outputs.
//!
//! It works on a [`eng_system::code::Compiled`] model and knows no syntax, no names to be looked up, no files, no terminal: it
//! returns numbers and errors that carry the path and the place of what they concern. It holds no global state, and the same
//! input gives the same bits whatever the number of threads.
//!
//! | module | subject |
//! | --- | --- |
//! | [`model`], [`state`] | numbers of one parameter set; the state on R³ × SO(3) × Rⁿ |
//! | [`body`], [`chain`], [`shape`] | what depends on the kind of a body: inertia; markers and generalised forces |
//! | [`joint`] | what a class of elements holds |
//! | [`elements`], [`dynamics`] | calls of element code; residual and exact matrix |
//! | [`linear`] | sparse factorisation behind a trait |
//! | [`singular`] | singular values of dense matrices |
//! | [`assembly`], [`mod@topology`], [`mod@loose`] | start positions and velocities; freedom and redundancy; what nothing holds |
//! | [`mod@start`] | the quasi-static start of a turning engine |
//! | [`acceleration`] | projection of outputs, accelerations and reactions |
//! | [`integrator`], [`control`] | generalised-α on the Lie group; step sizes |
//! | [`linearised`] | eigenvalues and modes about a state |
//! | [`simulation`], [`transient`], [`periodic`], [`checkpoint`] | what a user holds |

#![forbid(unsafe_code)]
// tests compare with the standard library's functions
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
// Loops over the same index of several arrays read like the formulas they stand for.
#![allow(clippy::needless_range_loop)]

pub mod acceleration;
pub mod assembly;
pub mod body;
pub mod chain;
pub mod checkpoint;
pub mod control;
pub mod decay;
mod dense;
pub mod dynamics;
pub mod elements;
pub mod error;
pub mod flexible;
mod frame;
pub mod integrator;
pub mod joint;
pub mod linear;
pub mod linearised;
pub mod loose;
pub mod model;
pub mod outputs;
pub mod periodic;
pub mod rotation;
pub mod shape;
pub mod simulation;
pub mod singular;
pub mod start;
pub mod state;
pub mod topology;
pub mod transient;

pub use decay::{CycleReport, Mode};
pub use error::{
    Leaving, LeavingBody, Moment, NamedRow, RedundantGroup, RuntimeError, TurningBody, Varies,
};
pub use integrator::Statistics;
pub use linearised::{LinearModes, run_linear};
pub use periodic::{PeriodicSummary, Remedy, run_periodic};
pub use simulation::{CscView, Energy, Jump, Options, Pace, Simulation, Slow, StepReport, Warning};
pub use start::{StartReport, Turning, Unstable};
pub use topology::{TopologyReport, topology};
pub use transient::{Advance, Observer, RunSummary, Sample, Verdict, countable, run_transient};
