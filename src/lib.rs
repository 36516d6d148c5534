//! Eng: engines as text.
//!
//! A model is a text. [`check`] reads it, [`Program::model`] compiles it, and [`Model::simulation`] steps it.
//! [`Program::analysis`] runs an analysis of the text.
//!
//! ```
//! let text = "
//!     use std.joints.Revolute
//!     model Pendulum {
//!         gravity = [0, -9.81, 0] m/s^2
//!         marker pivot = [0, 0, 0] mm
//!         body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker top = [0, 1, 0] m }
//!         joint pin = Revolute(bob.top, pivot)
//!         start pin.angle = 10 deg
//!     }";
//! let program = eng::check(&eng::Sources::from_text("pendulum.eng", text), "pendulum.eng").into_program()?;
//! let model = program.model("Pendulum")?;
//! let angle = model.channel("pin.angle")?;
//! let mut simulation = model.simulation().fixed_step(1e-3).start()?;
//! let start = simulation.value(angle)?;
//! assert!((start - 10f64.to_radians()).abs() < 1e-9);
//! while simulation.time() < 0.5 {
//!     simulation.step()?;
//! }
//! assert!(simulation.value(angle)? < start);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
// some functions serve the command line alone
#![cfg_attr(not(feature = "cli"), allow(dead_code, unused_imports))]

/// The snippets of the page on programs that embed Eng are tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/embedding.md")]
pub struct Embedding;

#[cfg(feature = "cli")]
pub mod cli;
pub mod codes;
pub mod plot;
pub mod post;
pub mod render;
pub mod results;

mod analysis;
pub mod assembled;
mod counted;
mod cycle;
mod definitions;
mod error;
mod explained;
mod failure;
mod fields;
mod figures;
pub mod fmu;
mod grid_error;
mod indexed;
mod kinematic;
mod lint;
mod machine;
mod matrices;
mod model;
pub mod modes;
mod moment;
pub mod motion;
mod places;
mod program;
mod quantity;
mod recorded_field;
mod reduction;
mod regular;
mod repetition;
pub mod report;
mod response;
pub mod run;
#[cfg(feature = "cli")]
pub mod server;
mod simulation;
mod sources;
pub mod study;
mod tables;
pub mod timings;
mod utf8;
mod vocabulary;

pub use analysis::{Analysis, Failed, Outcome, Progress, Watch};
pub use eng_runtime::inputs::Point;
pub use eng_runtime::linearised::{
    Coefficients, FrequencyResponse, Harmonics, LinearModes, Mode, Orbit, Repeating, StateSpace,
    Wanted,
};
pub use eng_runtime::{
    Determined, Energy, PeriodicSummary, Reading, RuntimeError, Shared, Slow, StartReport,
    Statistics, StepLimit, TopologyReport, Turning, Verdict, Warning,
};
pub use eng_system::host::HostError;
pub use eng_system::input::Interpolation;
pub use eng_system::system::summary::{Statistic, SummaryColumn, SummaryParameter};
pub use eng_system::system::{Method, Start, StepControl};
pub use eng_system::{Dimension, DisplayUnit};
pub use error::{Error, Report};
pub use figures::figures_of;
pub use machine::{InterfaceSummary, JournalGeometry, Machine, SummarisedElement};
pub use model::{Channel, ChannelInfo, Input, InputInfo, Model, Parameter, ParameterInfo};
pub use program::{Checked, Program, check, open};
pub use quantity::{Quantity, QuantityError};
pub use recorded_field::RecordedField;
pub use reduction::{BodyFile, BodyFormat, HandOverError, Reduction};
pub use results::{Gradient, Results};
pub use simulation::{Simulation, SimulationBuilder};
pub use sources::Sources;
pub use tables::{Summarised, SummaryTable, outcome_text, sweep_texts};
