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
#![deny(clippy::disallowed_methods)]
// no input may end the library in a panic
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable,
    clippy::todo
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

/// Parts for the tests in `tests/` alone. No other crate may use them.
#[doc(hidden)]
pub mod internals {
    pub use crate::cycle::{cycle_angle, last_cycle, shifted};
    pub use crate::fields::Fields;
    pub use crate::indexed::listed;
    pub use crate::repetition::{Repetition, Slowest};
    pub use crate::utf8::text;
    pub use crate::vocabulary::{LINTS, WORDS};

    /// The command line.
    #[cfg(feature = "cli")]
    pub mod cli {
        pub use crate::cli::arguments::setting;
        pub use crate::cli::build::versions;
        pub use crate::cli::files::claim_from;
        pub use crate::cli::progress::{Bars, place, progress_bar, show_progress};
        pub use crate::cli::results::rounded;
        pub use crate::cli::watch::changes::{Changes, Files, Looks, MOST_WAITS, at_rest};
        pub use crate::cli::watch::time_of_day;
        pub use crate::sources::Stamp;

        /// Runs the command, where `eng watch` waits for these changes. Returns the exit code.
        pub fn run_with(
            arguments: &[&str],
            changes: &mut dyn Changes,
            console: &mut crate::cli::Console<'_>,
        ) -> u8 {
            let arguments = arguments.iter().map(std::ffi::OsString::from);
            crate::cli::run_with(arguments, changes, console)
        }
    }

    /// Figures.
    pub mod figures {
        pub use crate::figures::{histories, spectrum};
        pub use crate::post::natural::Natural;
        pub use crate::post::picture::labels::common_frame;
        pub use crate::post::sampling_limits::{
            extent_text, limit_text, speed_text, two_digits_below,
        };
        pub use crate::post::track::{Samples, distinct_names};
    }

    /// The description of an FMU.
    pub mod fmu {
        pub use crate::fmu::description::{is_structured, number};
    }

    /// Excerpts of texts, and control characters.
    pub mod render {
        pub use crate::render::excerpt::{Excerpt, Excerpts};
        pub use crate::render::visible::{visible, visible_json};
    }

    /// Contents of the page of results.
    pub mod report {
        pub use crate::report::films::{at_nodes, cylinder, films};
        pub use crate::report::loads::turn;
        pub use crate::report::scene::{round, scene};
        pub use crate::report::shapes::{outlined, solid};
        pub use crate::report::stress::{at, by_place, peaks, table};
        pub use crate::report::surface::thin;
    }

    /// Files of results.
    pub mod results {
        pub use crate::regular::open;
        pub use crate::results::csv::number;
        pub use crate::results::dimension_text::parse as dimension_of;
        pub use crate::results::file::{refuse_link, remove_leftovers, target};
        pub use crate::results::mat::{INT8, RESERVED, element, header, legal_names, vector};
        pub use crate::results::resume_point::parse as resume_point_of;
        pub use crate::results::selection::matches;
        pub use crate::results::stream::{Stream, read as read_stream};
        pub use crate::results::universal::{even_spacing, exponent};

        /// Whether a sample belongs to the last part of a run.
        pub fn holds(last: crate::results::Last, value: f64, end: f64) -> bool {
            last.holds(value, end)
        }
    }

    /// Runs of analyses.
    pub mod run {
        pub use crate::run::patience::{Estimate, Patience, in_words};

        /// The fingerprint of an analysis, and that without the texts.
        pub fn fingerprints(analysis: &crate::Analysis) -> (String, String) {
            (analysis.fingerprint(), analysis.fingerprint_without_texts())
        }

        /// The sample of a motion that is nearest to a moment.
        pub fn nearest(
            at: crate::motion::At,
            times: &[f64],
            angles: &[f64],
            period: Option<f64>,
        ) -> Option<usize> {
            at.nearest(times, angles, period)
        }

        /// A clock of the present thread. A call gives the processor time since the last one.
        pub fn clock() -> impl FnMut() -> std::time::Duration {
            let mut clock = crate::timings::Clock::new();
            move || clock.since()
        }
    }

    /// The language server.
    #[cfg(feature = "cli")]
    pub mod server {
        pub use crate::server::channels::without_indices;
        pub use crate::server::document::{Document, path, position, uri};
        pub use crate::server::due::{argument, begins_argument};
        pub use crate::server::forms::formed_range;
        pub use crate::server::place::{call_around, is_quiet, names_before, path_at};
        pub use crate::server::transport::{body, refuse};

        /// The result of a piece of work, or the words of its panic.
        pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
            crate::server::guarded(work)
        }
    }

    /// Files of a model.
    pub mod sources {
        /// The canonical paths of the files opened so far.
        pub fn opened(sources: &crate::Sources) -> std::collections::BTreeSet<std::path::PathBuf> {
            sources.opened()
        }

        /// The files asked for so far, each with whether it was there.
        pub fn asked(sources: &crate::Sources) -> Vec<(std::path::PathBuf, bool)> {
            let asked = sources.asked().into_iter();
            asked.map(|(path, stamp)| (path, stamp.is_some())).collect()
        }
    }

    /// Studies.
    pub mod study {
        pub use crate::study::design::{from_text, named, whole};
        pub use crate::study::plan::quoted;
    }

    /// Tables.
    pub mod tables {
        pub use crate::reduction::table::{LENGTHS, MASSES, Unit, properties, weight_check};
        pub use crate::tables::summary::{alike, in_words};

        /// The moving parts of a row of modes.
        pub fn composition(results: &crate::Results, row: usize) -> String {
            crate::modes::composition(results, row)
        }

        /// A summary as text.
        pub fn summary_text(table: &crate::SummaryTable<'_>) -> String {
            table.text()
        }
    }

    /// The reduced body of a reduction.
    pub fn reduced(reduction: &crate::Reduction) -> &eng_system::reduced::ReducedBody {
        &reduction.body
    }

    /// The stored body of a reduction.
    pub fn stored(reduction: &crate::Reduction) -> &eng_flexible::store::StoredBody {
        &reduction.stored
    }
}
