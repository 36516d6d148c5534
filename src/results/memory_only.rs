//! In the place of files, for programs without the feature `parquet`: a recording with a folder is refused when it
//! begins, and all others stay in memory.

use super::gradient::Gradient;
use super::recording::Recording;
use super::resume_point::{KeptWarning, ResumePoint};
use super::selection::Last;
use super::{Results, ResultsError};
use std::path::Path;

/// The files of one recording. There are none.
#[derive(Debug)]
pub(super) enum Disk {}

/// The files at the beginning of a recording. There are none.
pub(super) enum Opened {
    Fresh(Disk),
    Resumed(Disk, ResumePoint),
    Complete(Results),
}

impl Disk {
    /// Refuses the folder.
    pub fn open(
        folder: &Path,
        _: &Recording,
        _: &mut Results,
        _: String,
    ) -> Result<Opened, ResultsError> {
        Err(refused(folder))
    }

    pub fn begin_again(&mut self, _: &Results) -> Result<(), ResultsError> {
        match *self {}
    }

    pub fn pushed(&mut self, _: &mut [Vec<f64>]) -> Result<(), ResultsError> {
        match *self {}
    }

    pub fn flush(&mut self, _: &mut [Vec<f64>]) -> Result<(), ResultsError> {
        match *self {}
    }

    pub fn wants_checkpoint(&self) -> bool {
        match *self {}
    }

    pub fn save(
        &mut self,
        _: &mut [Vec<f64>],
        _: u64,
        _: Vec<u8>,
        _: Vec<KeptWarning>,
    ) -> Result<(), ResultsError> {
        match *self {}
    }

    pub fn abandon(self) -> Result<(), ResultsError> {
        match self {}
    }

    pub fn finish(self, _: &Results, _: Option<Last>) -> Result<Results, ResultsError> {
        match self {}
    }
}

/// Rows beside the samples of a run. There are none.
#[derive(Debug)]
pub(crate) enum RowLog {}

impl RowLog {
    pub fn create(folder: &Path, _: &Results) -> Result<RowLog, ResultsError> {
        Err(refused(folder))
    }

    pub fn resume(
        folder: &Path,
        _: &Results,
        _: u64,
        _: impl FnMut(&[f64]),
    ) -> Result<RowLog, ResultsError> {
        Err(refused(folder))
    }

    pub fn left(folder: &Path, _: &str, _: impl FnMut(&[f64])) -> Result<bool, ResultsError> {
        Err(refused(folder))
    }

    pub fn push(&mut self, _: impl Iterator<Item = f64>) -> Result<(), ResultsError> {
        match *self {}
    }

    pub fn save(&mut self) -> Result<(), ResultsError> {
        match *self {}
    }

    pub fn remove(folder: &Path, _: &str) -> Result<(), ResultsError> {
        Err(refused(folder))
    }
}

/// Refuses the folder.
pub(crate) fn write_whole(_: &Results, folder: &Path) -> Result<(), ResultsError> {
    Err(refused(folder))
}

/// Refuses the file.
pub(crate) fn write_gradients(
    path: &Path,
    _: &[Gradient],
    _: &Results,
) -> Result<(), ResultsError> {
    Err(refused(path))
}

fn refused(path: &Path) -> ResultsError {
    ResultsError::File {
        path: path.to_owned(),
        source: std::io::Error::new(
            std::io::ErrorKind::Unsupported,
            "this program was built without the feature `parquet`, so results stay in memory",
        ),
    }
}
