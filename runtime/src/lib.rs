//! Eng's runtime: state on the manifold, kinematic chain, assembly, integration, outputs.
//!
//! It works on a [`eng_system::code::Compiled`] model. It has no syntax, looks up no names, opens no files
//! and prints nothing. It returns numbers, and errors with the path and the place of their subject. It holds
//! no global state, and the same input gives the same bits for any number of threads.

#![forbid(unsafe_code)]
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
// A loop over one index of several arrays reads like its formula.
#![allow(clippy::needless_range_loop)]

mod acceleration;
mod assembled;
pub mod assembly;
pub mod body;
pub mod chain;
mod checkpoint;
mod control;
mod decay;
pub mod dynamics;
mod elements;
mod equilibrium;
pub mod error;
mod field;
pub mod flexible;
mod frame;
pub mod inputs;
pub mod integrator;
pub mod joint;
mod kinematic;
mod kinks;
pub mod linear;
pub mod linearised;
pub mod loose;
mod memory;
pub mod model;
mod outputs;
mod periodic;
pub mod rotation;
pub mod shape;
mod simulation;
mod singular;
pub mod start;
pub mod state;
mod surface;
mod thread_pool;
mod topology;
mod transient;

pub use assembled::Assembled;
pub use decay::{CycleReport, Mode};
pub use equilibrium::{run_assemble, run_static};
pub use error::{
    Leaving, LeavingBody, Moment, NamedRow, NotBack, RedundantGroup, RuntimeError, Timed,
    TimedElement, TurningBody, Undefined, Varies,
};
pub use integrator::{Damped, Statistics};
pub use kinematic::{Determined, Shared, kinematic_columns, run_kinematic};
pub use kinks::Overlooked;
pub use linearised::{FrequencyResponse, LinearModes, run_linear, run_response};
pub use periodic::{PeriodicSummary, Remedy, run_periodic};
pub use simulation::{
    Energy, FAILS, Jump, Jumping, Options, Reading, SampleGradient, Simulation, Slow, StepLimit,
    StepReport, Stopped, Warning,
};
pub use start::{StartReport, Turning, Unstable};
pub use topology::TopologyReport;
pub use transient::{Advance, Observer, RunSummary, Sample, Verdict, countable, run_transient};
