//! The samples of a run on their way to memory or disk.

use super::disk::{Disk, Opened};
use super::recording::Recording;
use super::resume_point::{KeptWarning, ResumePoint};
use super::selection::Last;
use super::{Results, ResultsError};

/// Key of the metadata for the end of a run: [`COMPLETE`], or the reason of a failure.
pub(crate) const STATE: &str = "state";
/// Beginning of the state of a failed run.
pub(super) const FAILED_BECAUSE: &str = "failed: ";
const COMPLETE: &str = "complete";

/// The rows of a run: kept in memory, or sent to disk in batches.
#[derive(Debug)]
pub(crate) struct Table {
    /// The kept columns without values, and the metadata of the run.
    header: Results,
    kept: Vec<bool>,
    /// Rows that are not on disk: SI in memory, in display units before a stream.
    rows: Vec<Vec<f64>>,
    given: u64,
    disk: Option<Disk>,
    last: Option<Last>,
}

/// The beginning of a recording.
#[derive(Debug)]
pub(crate) enum Begun {
    /// At the start.
    Fresh(Table),
    /// At a checkpoint.
    Resumed(Table, ResumePoint),
    /// The results are already complete.
    Complete(Results),
}

impl Table {
    /// Begins a recording of all columns of `header`, whose values are empty. `identity` distinguishes this
    /// run from others.
    pub fn begin(
        mut header: Results,
        recording: &Recording,
        identity: String,
    ) -> Result<Begun, ResultsError> {
        let kept = recording.channels.of(&header)?;
        header = recording.channels.apply(&header)?;
        if let Some(last) = recording.last
            && header.column(last.path()).is_none()
        {
            return Err(ResultsError::Last(
                match header.metadata().get(super::ROWS) {
                    Some(rows) => format!(
                        "{} has no last part: its rows are {rows}, not samples; name the analyses in time by --analysis, or leave --last out",
                        header.analysis()
                    ),
                    None => format!(
                        "the last part can't be an angle: {} has no cycle",
                        header.model()
                    ),
                },
            ));
        }
        let mut table = Table {
            rows: vec![Vec::new(); header.columns().len()],
            kept,
            header,
            given: 0,
            disk: None,
            last: recording.last,
        };
        let Some(folder) = &recording.folder else {
            return Ok(Begun::Fresh(table));
        };
        let (disk, point) = match Disk::open(folder, recording, &mut table.header, identity)? {
            Opened::Fresh(disk) => (disk, None),
            Opened::Resumed(disk, point) => (disk, Some(point)),
            Opened::Complete(results) => return Ok(Begun::Complete(results)),
        };
        table.disk = Some(disk);
        Ok(match point {
            None => Begun::Fresh(table),
            Some(point) => {
                table.given = point.samples;
                Begun::Resumed(table, point)
            }
        })
    }

    /// Sets metadata of the run before its first row.
    pub fn set_metadata(&mut self, key: &str, value: String) -> Result<(), ResultsError> {
        self.header.set_metadata(key, value);
        if self.given == 0
            && let Some(disk) = &mut self.disk
        {
            disk.begin_again(&self.header)?;
        }
        Ok(())
    }

    /// Adds a row: a value (SI) for each column of the header given to [`Table::begin`].
    pub fn push(&mut self, values: impl Iterator<Item = f64>) -> Result<(), ResultsError> {
        let kept = values.zip(&self.kept).filter(|(_, kept)| **kept);
        let places = self.rows.iter_mut().zip(self.header.columns());
        for ((value, _), (row, column)) in kept.zip(places) {
            row.push(match self.disk {
                Some(_) => column.display.from_si(value),
                None => value,
            });
        }
        self.given += 1;
        match &mut self.disk {
            Some(disk) => disk.pushed(&mut self.rows),
            None => Ok(()),
        }
    }

    /// Whether a checkpoint is expected.
    pub fn wants_checkpoint(&self) -> bool {
        self.disk.as_ref().is_some_and(Disk::wants_checkpoint)
    }

    /// Saves the runtime's state after the last row.
    pub fn save(&mut self, state: Vec<u8>, warnings: Vec<KeptWarning>) -> Result<(), ResultsError> {
        match &mut self.disk {
            Some(disk) => disk.save(&mut self.rows, self.given, state, warnings),
            None => Ok(()),
        }
    }

    /// Ends the recording and returns the results. With a folder they are also on disk. `failure` is the
    /// reason if the run ended early. The results then have a file of their own, and files of an earlier run
    /// remain.
    pub fn finish(mut self, failure: Option<&str>) -> Result<Results, ResultsError> {
        if let Some(disk) = &mut self.disk {
            disk.flush(&mut self.rows)?;
        }
        match failure {
            Some(reason) => self.header.set_failure(reason),
            None => self.header.set_metadata(STATE, COMPLETE),
        }
        match self.disk.take() {
            None => self.in_memory(),
            Some(disk) if failure.is_some() && self.given == 0 => {
                disk.abandon()?;
                self.in_memory()
            }
            Some(disk) => disk.finish(&self.header, self.last),
        }
    }

    fn in_memory(self) -> Result<Results, ResultsError> {
        let mut results = self.header.without_columns();
        let axis = self.last.and_then(|last| {
            let place = |c: &super::Column| c.path == last.path();
            let index = self.header.columns().iter().position(place)?;
            Some((last, self.rows.get(index)?.clone()))
        });
        let first = axis.map_or(0, |(last, values)| first_of(last, &values));
        for (column, values) in self.header.columns().iter().zip(self.rows) {
            let mut column = column.clone();
            column.values = match first {
                0 => values,
                _ => values.get(first..).unwrap_or_default().to_vec(),
            };
            results.push(column)?;
        }
        Ok(results)
    }
}

/// Index of the first value in the last part.
pub(super) fn first_of(last: Last, values: &[f64]) -> usize {
    let end = values.last().copied().unwrap_or(0.0);
    values
        .iter()
        .position(|value| last.holds(*value, end))
        .unwrap_or(0)
}
