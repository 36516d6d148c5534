//! Eng's runtime: state on the manifold, kinematic chain, assembly, integration, outputs.
//!
//! It works on a [`eng_system::code::Compiled`] model. It has no syntax, looks up no names, opens no files
//! and prints nothing. It returns numbers, and errors with the path and the place of their subject. It holds
//! no global state, and the same input gives the same bits for any number of threads.
//!
//! | module | subject |
//! | --- | --- |
//! | [`model`], [`state`] | numbers of one parameter set; the state on R³ × SO(3) × Rⁿ |
//! | [`body`], [`chain`], [`shape`] | kinds of bodies: inertia, markers, generalised forces |
//! | [`inputs`] | numbers that a program sets while a model runs |
//! | `surface` | elastic surfaces of flexible bodies under fields |
//! | [`joint`] | the kind of joint that a class of elements makes |
//! | `elements`, [`dynamics`] | calls of element code; residual and exact matrix |
//! | [`linear`] | sparse factorisation behind a trait |
//! | `singular` | singular values of dense matrices |
//! | [`assembly`], `topology`, `assembled`, [`mod@loose`] | positions; freedom and redundancy; both of a model; unheld bodies |
//! | [`mod@start`] | the quasi-static start of a turning engine |
//! | `acceleration` | projection of outputs, accelerations and reactions |
//! | [`integrator`], `control` | generalised-α on the Lie group; step sizes |
//! | `equilibrium` | the state in which all loads balance; the assembled position as a result |
//! | `kinematic` | the motion at a prescribed speed, with reactions by inverse dynamics |
//! | [`linearised`] | eigenvalues and modes about a state |
//! | `simulation`, `transient`, `periodic`, `checkpoint` | the types that a user works with |

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
mod crew;
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
    Energy, FAILS, Jump, Jumping, Options, Pace, Reading, SampleGradient, Simulation, Slow,
    StepReport, Stopped, Warning,
};
pub use start::{StartReport, Turning, Unstable};
pub use topology::TopologyReport;
pub use transient::{Advance, Observer, RunSummary, Sample, Verdict, countable, run_transient};
