//! Results of an analysis in memory, and their way to files and back.
//!
//! This module contains columns of numbers with unit, dimension and frame. It computes none of them.

mod cells;
mod column;
pub(crate) mod csv;
pub(crate) mod dimension_text;
pub(crate) mod file;
mod gradients;
mod listing;
pub(crate) mod mat;
mod parquet;
mod points;
mod recording;
pub(crate) mod resume_point;
mod row_log;
mod schema;
pub(crate) mod selection;
pub(crate) mod stream;
mod table;
pub(crate) mod universal;

pub(crate) use cells::{CellColumn, write_cells};
pub use column::Column;
pub(crate) use column::display_unit;
pub use csv::CsvForm;
pub use file::{file_stem, replace_file, writable};
pub(crate) use file::{may_be_folder, remove_if_there, remove_leftovers};
pub use gradients::Gradient;
pub(crate) use gradients::{
    derivative_of, derived_from, gradients_file, read_gradients, write_gradients,
};
pub(crate) use listing::finite_range;
pub use listing::{Kind, Listed, listed};
pub(crate) use points::{POINTS, PointRow, PointTable};
pub use recording::Recording;
pub(crate) use recording::{discard, failed_twin, interrupted, stem_of};
pub use resume_point::{KeptWarning, ResumePoint};
pub(crate) use row_log::RowLog;
pub(crate) use selection::matches;
pub use selection::{Last, Selection};
pub(crate) use stream::lock;
pub(crate) use table::{Begun, STATE, Table};

pub use eng_system::recorded::{CYCLE_ANGLE, CYCLE_SPEED, TIME};
use eng_system::recorded::{DAMPING_RATIO, FREQUENCY, LOGARITHMIC_DECREMENT, MODE};

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Results that cannot be built, written or read.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// Two columns with one name.
    #[error("there are two columns {0}")]
    Duplicate(String),
    /// A column of another length than the first.
    #[error("column {path} has {length} values, the first column {expected}")]
    Length {
        /// The column.
        path: String,
        /// Its length.
        length: usize,
        /// The first column's length.
        expected: usize,
    },
    /// A pattern without a matching column.
    #[error(
        "no channel is called {pattern}{}; {known} of them are there, `eng results` lists them",
        hint(nearest)
    )]
    NoChannel {
        /// The pattern.
        pattern: String,
        /// The most similar name.
        nearest: Option<String>,
        /// Number of columns.
        known: usize,
    },
    /// A last part that the results don't have.
    #[error("{0}")]
    Last(String),
    /// Another run writes to the file.
    #[error("{}: another run is writing it", path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// Results that do not fit into a format.
    #[error("{format}: {message}")]
    Format {
        /// The format.
        format: &'static str,
        /// The reason.
        message: String,
    },
    /// A missing column.
    #[error("there is no column {0}")]
    NoColumn(String),
    /// The system refused.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The Parquet library refused.
    #[error("{}: {message}", path.display())]
    Parquet {
        /// The file.
        path: PathBuf,
        /// The error of the library.
        message: String,
    },
    /// An incomplete or damaged Parquet file.
    #[error("{}: {problem}; run the analysis again, or copy the file again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The problem.
        problem: String,
    },
    /// A Parquet file that was not written by [`Results::write_parquet`].
    #[error("{}: {message}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// The missing part.
        message: String,
    },
}

fn hint(nearest: &Option<String>) -> String {
    match nearest {
        Some(n) => format!("; did you mean {n}?"),
        None => String::new(),
    }
}

/// The columns of one analysis, all of one length, with the metadata of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Results {
    analysis: String,
    model: String,
    columns: Vec<Column>,
    metadata: BTreeMap<String, String>,
}

/// Key of the metadata for the kind of rows. Samples of a motion have none.
pub const ROWS: &str = "rows";
/// Key of the condition that ended the run early, with the moment.
pub const STOPPED: &str = "stopped";
/// See [`ROWS`].
pub const MODES: &str = "modes";
/// See [`ROWS`].
pub const FREQUENCIES: &str = "frequencies";
/// See [`ROWS`].
pub const ONE_STATE: &str = "state";
/// Columns of every mode.
pub const COLUMNS_OF_MODES: [&str; 6] = [
    MODE,
    FREQUENCY,
    "undamped_frequency",
    DAMPING_RATIO,
    LOGARITHMIC_DECREMENT,
    "growth",
];

impl Results {
    /// Results without columns. Push [`Column::time`] first, then [`Column::cycle_angle`] and
    /// [`Column::cycle_speed`] if the model has a cycle, then the channels.
    pub fn new(analysis: impl Into<String>, model: impl Into<String>) -> Self {
        Results {
            analysis: analysis.into(),
            model: model.into(),
            columns: Vec::new(),
            metadata: BTreeMap::new(),
        }
    }

    /// Adds a column; its path must be new and its length that of the first.
    pub fn push(&mut self, column: Column) -> Result<(), ResultsError> {
        if self.column(&column.path).is_some() {
            return Err(ResultsError::Duplicate(column.path));
        }
        if let Some(first) = self.columns.first()
            && first.values.len() != column.values.len()
        {
            return Err(ResultsError::Length {
                path: column.path,
                length: column.values.len(),
                expected: first.values.len(),
            });
        }
        self.columns.push(column);
        Ok(())
    }

    /// Sets an entry of the run's metadata: `source_hash`, `version`, `parameter.speed`.
    pub fn set_metadata(&mut self, key: impl Into<String>, value: impl Into<String>) {
        self.metadata.insert(key.into(), value.into());
    }

    /// Reads a result file: Parquet, or the stream of an unfinished or killed run.
    pub fn read(path: impl AsRef<Path>) -> Result<Results, ResultsError> {
        let path = path.as_ref();
        if recording::is_partial(path) {
            stream::read(path)
        } else {
            Results::read_parquet(path)
        }
    }

    /// The same analysis and metadata without columns.
    pub fn without_columns(&self) -> Results {
        Results {
            columns: Vec::new(),
            ..self.clone()
        }
    }

    /// The analysis: `unfired`, `sweep[3]`.
    pub fn analysis(&self) -> &str {
        &self.analysis
    }

    /// The model's name.
    pub fn model(&self) -> &str {
        &self.model
    }

    /// The metadata of the run.
    pub fn metadata(&self) -> &BTreeMap<String, String> {
        &self.metadata
    }

    /// The condition that ended the run early, and the moment: `speed > 6000 rpm at 1.5 s`.
    pub fn stopped(&self) -> Option<&str> {
        self.metadata.get(STOPPED).map(String::as_str)
    }

    /// All columns in order.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The column with this path.
    pub fn column(&self, path: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.path == path)
    }

    /// Whether rows are modes instead of samples of a motion.
    pub fn are_modes(&self) -> bool {
        self.metadata.get(ROWS).map(String::as_str) == Some(MODES)
    }

    /// Whether the only row is a state: the assembled one, or the equilibrium.
    pub fn is_state(&self) -> bool {
        self.metadata.get(ROWS).map(String::as_str) == Some(ONE_STATE)
    }

    /// Whether rows are the frequencies of a response.
    pub fn are_responses(&self) -> bool {
        self.metadata.get(ROWS).map(String::as_str) == Some(FREQUENCIES)
    }

    /// Whether rows are samples of a motion.
    pub fn are_samples(&self) -> bool {
        !self.metadata.contains_key(ROWS)
    }

    /// Number of samples in each column.
    pub fn samples(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }
}
