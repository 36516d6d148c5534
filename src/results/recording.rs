//! Where the samples of a run go, and which of them stay.

use super::table::{FAILED_BECAUSE, STATE};
use super::{Last, Results, Selection, file_stem};
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
/// What the names of files of a run that failed get, so that they replace no good ones.
const FAILED: &str = ".failed";

/// The files of one analysis.
#[derive(Clone, Debug)]
pub(super) struct Files {
    /// Samples of a run that goes on or was killed.
    pub partial: PathBuf,
    /// Where it goes on.
    pub checkpoint: PathBuf,
    /// The results.
    pub parquet: PathBuf,
    /// What there is of a run that failed.
    pub failed: PathBuf,
}

impl Files {
    pub fn new(folder: &Path, analysis: &str) -> Files {
        let stem = file_stem(analysis);
        let file = |ending: &str| folder.join(format!("{stem}{ending}"));
        Files {
            partial: file(PARTIAL),
            checkpoint: file(CHECKPOINT),
            parquet: file(FINAL),
            failed: file(&format!("{FAILED}{FINAL}")),
        }
    }

    /// Removes half-written files of runs that were killed; the run that owns the stream of samples may do so.
    pub fn remove_leftovers(&self) {
        for path in [&self.checkpoint, &self.parquet, &self.failed] {
            super::file::remove_leftovers(path);
        }
    }
}

/// Whether a run of an analysis was interrupted, or goes on: its samples are in the folder.
pub(crate) fn interrupted(folder: &Path, analysis: &str) -> bool {
    Files::new(folder, analysis).partial.exists()
}

/// Begin of the names of the files of an analysis, or of a picture of it.
pub(crate) fn stem_of(name: &str, failed: bool) -> String {
    let stem = file_stem(name);
    if failed {
        format!("{stem}{FAILED}")
    } else {
        stem
    }
}

impl Results {
    /// Begin of the names of its files: the analysis, and `.failed` where the run failed.
    pub fn stem(&self) -> String {
        stem_of(self.analysis(), self.failure().is_some())
    }

    /// Why the run failed, if it did; what is there then is what was computed before.
    pub fn failure(&self) -> Option<&str> {
        self.metadata().get(STATE)?.strip_prefix(FAILED_BECAUSE)
    }

    /// States that the run failed.
    pub fn set_failure(&mut self, reason: &str) {
        self.set_metadata(STATE, format!("{FAILED_BECAUSE}{reason}"));
    }
}

/// The file of a failed run that a good one stands for: `fired.failed.svg` of `fired.svg`.
pub(crate) fn failed_twin(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let (stem, ending) = name.rsplit_once('.')?;
    Some(path.with_file_name(format!("{stem}{FAILED}.{ending}")))
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
