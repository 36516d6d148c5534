//! The contents of the HTML page of a model's results, and of files for other tools: tables, sections, and simple parts
//! in the place of rigid bodies.
//!
//! May contain: the choice and order of contents. Must not contain: the drawing of figures, pages and
//! animations (`eng_report`), the recovery of stresses (`eng_flexible::recover`), arguments of the command.

mod analyses;
mod describe;
mod drawn;
mod fields;
pub(crate) mod films;
mod last_cycle;
pub(crate) mod loads;
mod page;
mod provenance;
pub(crate) mod scene;
mod series;
mod settings;
pub(crate) mod shapes;
pub(crate) mod stress;
pub(crate) mod surface;
mod sweeps;
mod tables;

pub use crate::motion::At;
pub use describe::{BodyPicture, Described, InputValue, JournalAxes, MarkerAxes, Matter, Spot};
pub use fields::write_fields;
pub use page::{Drawn, Made, Request, make};
pub use series::write_series;
pub(crate) use settings::mixed;

use crate::repetition::Repetition;
use crate::results::ResultsError;
use crate::run::RunOutcome;
use eng_flexible::FlexibleError;
use eng_report::animation::AnimationError;
use std::path::PathBuf;

/// A report that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// Results without the necessary data.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A flexible body without shapes or stresses.
    #[error(transparent)]
    Flexible(#[from] FlexibleError),
    /// Bodies that do not fit their motion.
    #[error(transparent)]
    Animation(#[from] AnimationError),
    /// Amplitudes of another mode set.
    #[error(
        "{body}: the results have {found} amplitudes, but the model's body has {expected} modes; run the model again"
    )]
    Modes {
        /// The body.
        body: String,
        /// Modes of the reduction.
        expected: usize,
        /// Amplitudes in the results.
        found: usize,
    },
    /// A film that cannot be solved as in the run.
    #[error("the film of {path}: {source}")]
    Film {
        /// The element.
        path: String,
        /// The reason.
        source: eng_system::field::FieldError,
    },
    /// No motion.
    #[error("{0}: the results have no motion; run the model again")]
    NoMotion(String),
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
}

/// The results of an analysis with the model behind them.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Results and motion as they were read.
    pub outcome: RunOutcome,
    /// The model.
    pub described: Described,
    /// Values of a sweep's variables: name and value with unit.
    pub point: Vec<(String, String)>,
    /// Name and SHA-256 of each file that was read.
    pub files: Vec<(String, String)>,
}

impl Entry {
    /// An entry from results that were read. A file has a name and a hash.
    pub fn new(
        results: crate::Results,
        motion: Option<crate::Results>,
        described: Described,
        files: Vec<(String, String)>,
    ) -> Entry {
        let point = results
            .metadata()
            .iter()
            .filter_map(|(key, value)| {
                let name = key.strip_prefix("point.")?;
                // a number without unit
                let value = value.strip_suffix(" 1").unwrap_or(value);
                Some((name.to_owned(), value.to_owned()))
            })
            .collect();
        Entry {
            outcome: RunOutcome {
                machine: described.machine.clone(),
                diagnostics: Default::default(),
                facts: Vec::new(),
                point: described.point.clone(),
                periodic: Repetition::of(results.metadata()).map(|r| (r.cycles, r.repeats)),
                gradients: Vec::new(),
                made_before: false,
                timings: None,
                results,
                motion,
            },
            described,
            point,
            files,
        }
    }

    /// Its analysis.
    pub fn name(&self) -> &str {
        self.outcome.results.analysis()
    }

    /// Whether the texts have changed since the results were computed.
    pub fn outdated(&self) -> bool {
        let hash = self.outcome.results.metadata().get("source_hash");
        hash != Some(&self.described.source_hash)
    }
}
