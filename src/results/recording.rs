//! Where the samples of a run go, and which of them stay.

use super::{Last, Selection, file_stem};
use std::path::{Path, PathBuf};

/// What is kept of an analysis, and where. Without a folder: in memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Samples go to this folder while the analysis runs; at its end it holds `ANALYSIS.parquet`.
    pub folder: Option<PathBuf>,
    /// Go on where an interrupted run of the same analysis stopped; what is complete is not run again.
    pub resume: bool,
    /// Channels that are kept.
    pub channels: Selection,
    /// The part of the run that is kept in the end; an interrupted run leaves all of it.
    pub last: Option<Last>,
}

const PARTIAL: &str = ".partial.arrows";
const CHECKPOINT: &str = ".checkpoint";
const FINAL: &str = ".parquet";

/// The files of one analysis.
#[derive(Clone, Debug)]
pub(super) struct Files {
    /// Samples of a run that goes on or was killed.
    pub partial: PathBuf,
    /// Where it goes on.
    pub checkpoint: PathBuf,
    /// The results.
    pub parquet: PathBuf,
}

impl Files {
    pub fn new(folder: &Path, analysis: &str) -> Files {
        let stem = file_stem(analysis);
        let file = |ending: &str| folder.join(format!("{stem}{ending}"));
        Files {
            partial: file(PARTIAL),
            checkpoint: file(CHECKPOINT),
            parquet: file(FINAL),
        }
    }
}

/// Whether a file is the stream of a run that has not ended, by its name.
pub(super) fn is_partial(path: &Path) -> bool {
    path.file_name()
        .is_some_and(|name| name.to_string_lossy().ends_with(PARTIAL))
}

/// Whether a file holds results, by its name.
pub(super) fn is_result(path: &Path) -> bool {
    path.file_name().is_some_and(|name| {
        let name = name.to_string_lossy();
        name.ends_with(PARTIAL) || name.ends_with(FINAL)
    })
}
