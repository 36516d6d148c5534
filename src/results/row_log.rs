//! Rows that a run writes to disk beside its samples, one for each sample. So a resumed run has the rows
//! before its checkpoint.
//!
//! They form an Arrow stream like that of the samples, `ANALYSIS.partial.arrows`. Its columns are in SI, so
//! that reading gives the same bits.

use super::recording::Files;
use super::stream::{Portions, Stream};
use super::{Results, ResultsError, remove_if_there, schema};
use std::path::Path;

/// The largest number of rows that wait before they are written to disk. A choice, as for tables of results.
const BATCH: usize = 512;

/// The rows on their way to disk.
#[derive(Debug)]
pub(crate) struct RowLog {
    stream: Stream,
    /// One vector for each column.
    waiting: Vec<Vec<f64>>,
}

impl RowLog {
    /// Begins a log with the columns of `header`. It overwrites an earlier one.
    pub fn create(folder: &Path, header: &Results) -> Result<RowLog, ResultsError> {
        let path = Files::new(folder, header.analysis()).partial;
        Ok(RowLog {
            stream: Stream::create(&path, header)?,
            waiting: vec![Vec::new(); header.columns().len()],
        })
    }

    /// Continues after the first `rows`, the number in a checkpoint. Each of these rows is passed to `take`.
    pub fn resume(
        folder: &Path,
        header: &Results,
        rows: u64,
        take: impl FnMut(&[f64]),
    ) -> Result<RowLog, ResultsError> {
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
        Ok(RowLog {
            stream,
            waiting: vec![Vec::new(); header.columns().len()],
        })
    }

    /// Passes the rows of a finished run to `take`; false if there is no log.
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

    /// Writes all waiting rows to disk. A checkpoint written after this finds the end of a batch here.
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

    /// Removes the log of an analysis, if there is one.
    pub fn remove(folder: &Path, analysis: &str) -> Result<(), ResultsError> {
        remove_if_there(&Files::new(folder, analysis).partial)
    }
}

/// Passes all rows of whole batches to `take`.
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
