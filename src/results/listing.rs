//! Summaries of result files.

use super::cells::is_cells;
use super::gradient::is_gradients;
use super::points::is_points;
use super::recording::{is_partial, is_result};
use super::{CYCLE_ANGLE, Results, ResultsError, TIME};
use std::path::{Path, PathBuf};

/// The end of a file's run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Complete, or not stated.
    Complete,
    /// Failed, for this reason, with the samples up to the failure.
    Failed(String),
    /// Still running, or killed.
    Unfinished,
}

/// A result file.
#[derive(Debug)]
pub struct Listed {
    /// The file.
    pub path: PathBuf,
    /// The end of its run.
    pub kind: Kind,
    /// Its contents.
    pub results: Results,
}

impl Listed {
    /// Reads a file.
    pub fn read(path: &Path) -> Result<Listed, ResultsError> {
        let results = Results::read(path)?;
        let kind = if is_partial(path) {
            Kind::Unfinished
        } else {
            match results.failure() {
                Some(reason) => Kind::Failed(reason.to_owned()),
                None => Kind::Complete,
            }
        };
        Ok(Listed {
            path: path.to_owned(),
            kind,
            results,
        })
    }

    /// First and last value (SI) of the time and of the cycle angle.
    pub fn spans(&self) -> [Option<(f64, f64)>; 2] {
        [TIME, CYCLE_ANGLE].map(|path| {
            let values = &self.results.column(path)?.values;
            Some((*values.first()?, *values.last()?))
        })
    }
}

/// The result files at a path: the file, or those of the folder in the order of their names. Files of cells,
/// of points and of gradients have no channels of a run, so they are left out.
pub fn listed(path: &Path) -> Result<Vec<PathBuf>, ResultsError> {
    let refused = |source| ResultsError::File {
        path: path.to_owned(),
        source,
    };
    if !std::fs::metadata(path).map_err(refused)?.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).map_err(refused)? {
        let file = entry.map_err(refused)?.path();
        let other = is_cells(&file) || is_points(&file) || is_gradients(&file);
        if is_result(&file) && !other && !hidden(&file) {
            files.push(file);
        }
    }
    files.sort();
    Ok(files)
}

/// A file that is being written has a point before its name.
fn hidden(path: &Path) -> bool {
    path.file_name()
        .is_some_and(|name| name.to_string_lossy().starts_with('.'))
}
