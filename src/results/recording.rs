//! The destination of a run's samples, and the selection of samples to keep.

use super::file::has_ending;
use super::table::{FAILED_BECAUSE, STATE};
use super::{Last, Results, ResultsError, Selection, file_stem, remove_if_there};
use std::path::{Path, PathBuf};

/// The kept part of an analysis, and the folder for it. Without a folder the samples stay in memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Samples go to this folder while the analysis runs; at its end it holds `ANALYSIS.parquet`.
    pub folder: Option<PathBuf>,
    /// Continue an interrupted run of the same analysis. A complete analysis is not run again.
    pub resume: bool,
    /// The kept channels.
    pub channels: Selection,
    /// The part of the run that is kept at its end. An interrupted run keeps all samples.
    pub last: Option<Last>,
}

const PARTIAL: &str = ".partial.arrows";
const CHECKPOINT: &str = ".checkpoint";
const FINAL: &str = ".parquet";
/// Ending of the files of a failed run, so that they replace no good results.
const FAILED: &str = ".failed";

/// The files of one analysis.
#[derive(Clone, Debug)]
pub(super) struct Files {
    /// Samples of a run that continues or was killed.
    pub partial: PathBuf,
    /// The state from which `--resume` continues.
    pub checkpoint: PathBuf,
    /// The results.
    pub parquet: PathBuf,
    /// Samples of a failed run.
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

    /// Removes half-written files of killed runs. Only the run that owns the stream of samples may do so.
    pub fn remove_leftovers(&self) {
        for path in [&self.checkpoint, &self.parquet, &self.failed] {
            super::file::remove_leftovers(path);
        }
    }
}

/// Whether a run of an analysis was interrupted or still continues. Its samples are then in the folder.
pub(crate) fn interrupted(folder: &Path, analysis: &str) -> bool {
    Files::new(folder, analysis).partial.exists()
}

/// Removes the samples and the state of a run that was stopped and will not be continued.
pub(crate) fn discard(folder: &Path, analysis: &str) -> Result<(), ResultsError> {
    let files = Files::new(folder, analysis);
    // in this order, as at the end of a run: a checkpoint without samples would be refused
    remove_if_there(&files.checkpoint)?;
    remove_if_there(&files.partial)
}

/// Beginning of the file names of an analysis or of a picture of it.
pub(crate) fn stem_of(name: &str, failed: bool) -> String {
    let stem = file_stem(name);
    if failed {
        format!("{stem}{FAILED}")
    } else {
        stem
    }
}

impl Results {
    /// Beginning of its file names: the analysis, with `.failed` if the run failed.
    pub fn stem(&self) -> String {
        stem_of(self.analysis(), self.failure().is_some())
    }

    /// The reason of a failure, if the run failed. The results then hold the samples before the failure.
    pub fn failure(&self) -> Option<&str> {
        self.metadata().get(STATE)?.strip_prefix(FAILED_BECAUSE)
    }

    /// Marks the run as failed.
    pub fn set_failure(&mut self, reason: &str) {
        self.set_metadata(STATE, format!("{FAILED_BECAUSE}{reason}"));
    }
}

/// The file of a failed run that corresponds to a file of a good run: `fired.failed.svg` for `fired.svg`.
pub(crate) fn failed_twin(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let (stem, ending) = name.rsplit_once('.')?;
    Some(path.with_file_name(format!("{stem}{FAILED}.{ending}")))
}

/// Whether a file is the stream of a run that has not ended, by its name.
pub(super) fn is_partial(path: &Path) -> bool {
    has_ending(path, PARTIAL)
}

/// Whether a file holds results, by its name.
pub(super) fn is_result(path: &Path) -> bool {
    has_ending(path, PARTIAL) || has_ending(path, FINAL)
}
