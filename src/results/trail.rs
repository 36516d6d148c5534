//! Rows that a run leaves on disk beside its samples, one a sample, so that a resumed run has those of before its checkpoint.
//!
//! An Arrow stream as that of the samples, `ANALYSIS.partial.arrows`. Its columns are shown in SI: the bits come back as they were.

use super::recording::Files;
use super::stream::{Portions, Stream};
use super::{Results, ResultsError, schema};
use std::path::Path;

/// Rows that wait at most, before they go to disk.
const BATCH: usize = 512;

/// The rows on their way to disk.
#[derive(Debug)]
pub(crate) struct Trail {
    stream: Stream,
    /// A vector a column.
    waiting: Vec<Vec<f64>>,
}

impl Trail {
    /// Begins with the columns of `header`, over what was there.
    pub fn create(folder: &Path, header: &Results) -> Result<Trail, ResultsError> {
        let path = Files::new(folder, header.analysis()).partial;
        Ok(Trail {
            stream: Stream::create(&path, header)?,
            waiting: vec![Vec::new(); header.columns().len()],
        })
    }

    /// Goes on after the first `rows`, whose number a checkpoint says; each of them is given to `take`.
    pub fn resume(
        folder: &Path,
        header: &Results,
        rows: u64,
        take: impl FnMut(&[f64]),
    ) -> Result<Trail, ResultsError> {
        let path = Files::new(folder, header.analysis()).partial;
        let (stream, found) = Stream::resume(&path, rows)?;
        if found.columns() != header.columns() {
            return Err(ResultsError::Foreign {
                path,
                message: "its columns are not those of the run; run again without --resume"
                    .to_owned(),
            });
        }
        each(&path, take)?;
        Ok(Trail {
            stream,
            waiting: vec![Vec::new(); header.columns().len()],
        })
    }

    /// Gives the rows of a run that has ended to `take`; false where there is no trail.
    pub fn left(
        folder: &Path,
        analysis: &str,
        take: impl FnMut(&[f64]),
    ) -> Result<bool, ResultsError> {
        let path = Files::new(folder, analysis).partial;
        if !path.exists() {
            return Ok(false);
        }
        each(&path, take)?;
        Ok(true)
    }

    /// Adds a row.
    pub fn push(&mut self, row: impl Iterator<Item = f64>) -> Result<(), ResultsError> {
        for (column, value) in self.waiting.iter_mut().zip(row) {
            column.push(value);
        }
        match self.waiting.first().map_or(0, Vec::len) >= BATCH {
            true => self.flush(),
            false => Ok(()),
        }
    }

    /// To disk, all that waits; a checkpoint that is written after it finds a batch's end here.
    pub fn save(&mut self) -> Result<(), ResultsError> {
        self.flush()?;
        self.stream.sync()
    }

    fn flush(&mut self) -> Result<(), ResultsError> {
        match self.waiting.first().is_some_and(|c| !c.is_empty()) {
            true => self.stream.write(&mut self.waiting),
            false => Ok(()),
        }
    }

    /// Removes the trail of an analysis, which need not be there.
    pub fn remove(folder: &Path, analysis: &str) -> Result<(), ResultsError> {
        let path = Files::new(folder, analysis).partial;
        match std::fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                Err(ResultsError::File { path, source })
            }
            _ => Ok(()),
        }
    }
}

/// Gives all rows of whole batches to `take`.
fn each(path: &Path, mut take: impl FnMut(&[f64])) -> Result<(), ResultsError> {
    let mut portions = Portions::open(path)?;
    let mut row = Vec::new();
    while let Some(batch) = portions.next()? {
        let columns = batch
            .columns()
            .iter()
            .map(|array| schema::numbers("", array))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|message| ResultsError::Foreign {
                path: path.to_owned(),
                message,
            })?;
        for index in 0..batch.num_rows() {
            row.clear();
            let values = columns.iter();
            row.extend(values.filter_map(|column| column.values().get(index).copied()));
            take(&row);
        }
    }
    Ok(())
}
