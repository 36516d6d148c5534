//! The files of a run that goes on: a stream of its samples, checkpoints, and the results at its end.

use super::parquet::{ParquetRows, WriteError};
use super::recording::{Files, Recording};
use super::resume_point::{KeptWarning, ResumePoint};
use super::selection::Last;
use super::stream::{Portions, Stream};
use super::table::first_of;
use super::{Results, ResultsError, remove_if_there, replace_file, schema};
use std::path::Path;
use std::time::{Duration, Instant};

/// The largest number of samples that wait before they are written to disk. A choice: writing in portions is
/// faster, and a failure loses no more.
const BATCH: usize = 512;
/// The longest time that a sample waits. A choice: figures of a run that is watched are as new.
const WAIT: Duration = Duration::from_millis(250);
/// The least time between two checkpoints. A choice: a disk is not kept busy by them.
const REST: Duration = Duration::from_millis(100);
/// The least time between two checkpoints, as a multiple of the time that the last one took. So saving stays
/// a small part of a run. A choice: 5 % at most.
const SHARE: u32 = 20;

/// Key of the metadata that identify a run.
const IDENTITY: &str = "identity";

/// The files of one recording.
#[derive(Debug)]
pub(super) struct Disk {
    files: Files,
    identity: String,
    /// Opened again with the first row, when all metadata are known.
    stream: Option<Stream>,
    flushed: Instant,
    saved: Instant,
    cost: Duration,
}

/// The files at the beginning of a recording.
pub(super) enum Opened {
    /// Without samples.
    Fresh(Disk),
    /// With the samples before a checkpoint.
    Resumed(Disk, ResumePoint),
    /// The results are already complete.
    Complete(Results),
}

impl Disk {
    /// Opens the files of a recording in a folder. `identity` distinguishes this run from others. The header gets the
    /// metadata of a run that is resumed.
    pub fn open(
        folder: &Path,
        recording: &Recording,
        header: &mut Results,
        identity: String,
    ) -> Result<Opened, ResultsError> {
        // the last part is cut at the end, so a checkpoint serves every `--last`; complete results serve only
        // their own
        let whole = format!("{identity} {:?}", recording.last);
        header.set_metadata(IDENTITY, &whole);
        let now = Instant::now();
        let mut disk = Disk {
            identity,
            stream: None,
            flushed: now,
            saved: now,
            cost: Duration::ZERO,
            files: Files::new(folder, header.analysis()),
        };
        if recording.resume {
            if let Some(point) = ResumePoint::read(&disk.files.checkpoint)? {
                disk.resume(&point, header)?;
                return Ok(Opened::Resumed(disk, point));
            }
            if !disk.files.partial.exists()
                && let Some(results) = complete(&disk.files.parquet)?
            {
                let same = results.metadata().get(IDENTITY) == Some(&whole);
                return match same {
                    true => Ok(Opened::Complete(results)),
                    false => Err(ResultsError::Foreign {
                        path: disk.files.parquet.clone(),
                        message: format!(
                            "these are complete results of another run: {}; run without --resume to replace them, or keep them by --out",
                            difference(&results, header)
                        ),
                    }),
                };
            }
        }
        // creating the stream now reports an unwritable folder before hours of computing;
        // a checkpoint of another run must not outlive its samples
        disk.stream = Some(Stream::create(&disk.files.partial, header)?);
        remove_if_there(&disk.files.checkpoint)?;
        disk.files.remove_leftovers();
        Ok(Opened::Fresh(disk))
    }

    /// Continues the stream of an interrupted run after the samples of its checkpoint.
    fn resume(&mut self, point: &ResumePoint, header: &mut Results) -> Result<(), ResultsError> {
        if point.identity != self.identity {
            let interrupted = Portions::open(&self.files.partial)?.header();
            return Err(ResultsError::Foreign {
                path: self.files.checkpoint.clone(),
                message: format!(
                    "the interrupted run was another one: {}; run again without --resume",
                    difference(&interrupted, header)
                ),
            });
        }
        let (stream, found) = Stream::resume(&self.files.partial, point.samples)?;
        if found.columns() != header.columns() {
            return Err(ResultsError::Foreign {
                path: self.files.partial.clone(),
                message: "its columns are not those of the run; run again without --resume"
                    .to_owned(),
            });
        }
        // the stream's header holds the metadata of the start
        for (key, value) in found.metadata() {
            if key != IDENTITY {
                header.set_metadata(key, value);
            }
        }
        self.stream = Some(stream);
        self.files.remove_leftovers();
        Ok(())
    }

    /// Begins the stream again, because the metadata have changed before the first row.
    pub fn begin_again(&mut self, header: &Results) -> Result<(), ResultsError> {
        self.stream = None;
        self.stream = Some(Stream::create(&self.files.partial, header)?);
        Ok(())
    }

    /// Takes rows that wait, if there are many or if they have waited for long.
    pub fn pushed(&mut self, rows: &mut [Vec<f64>]) -> Result<(), ResultsError> {
        let waiting = rows.first().map_or(0, Vec::len);
        match waiting >= BATCH || self.flushed.elapsed() >= WAIT {
            true => self.flush(rows),
            false => Ok(()),
        }
    }

    /// Writes all rows that wait.
    pub fn flush(&mut self, rows: &mut [Vec<f64>]) -> Result<(), ResultsError> {
        if let Some(stream) = &mut self.stream {
            self.flushed = Instant::now();
            if rows.first().is_some_and(|row| !row.is_empty()) {
                stream.write(rows)?;
            }
        }
        Ok(())
    }

    /// Whether a checkpoint is expected.
    pub fn wants_checkpoint(&self) -> bool {
        self.saved.elapsed() >= REST.max(self.cost * SHARE)
    }

    /// Saves the runtime's state after the last row.
    pub fn save(
        &mut self,
        rows: &mut [Vec<f64>],
        given: u64,
        state: Vec<u8>,
        warnings: Vec<KeptWarning>,
    ) -> Result<(), ResultsError> {
        let began = Instant::now();
        self.flush(rows)?;
        if let Some(stream) = &self.stream {
            stream.sync()?;
        }
        ResumePoint {
            identity: self.identity.clone(),
            samples: given,
            warnings,
            state,
        }
        .write(&self.files.checkpoint)?;
        self.saved = Instant::now();
        self.cost = self.saved.duration_since(began);
        Ok(())
    }

    /// Removes the files of a run that failed before its first sample.
    pub fn abandon(self) -> Result<(), ResultsError> {
        remove_if_there(&self.files.checkpoint)?;
        remove_if_there(&self.files.partial)?;
        remove_if_there(&self.files.failed)
    }

    /// Makes the results of the stream, and returns them.
    pub fn finish(self, header: &Results, last: Option<Last>) -> Result<Results, ResultsError> {
        let Files {
            partial,
            checkpoint,
            parquet,
            failed,
        } = &self.files;
        let is_failure = header.failure().is_some();
        let parquet = if is_failure { failed } else { parquet };
        let first = first_kept(partial, last)?;
        let written = replace_file(parquet, |file| {
            let mut rows = ParquetRows::new(file, header)?;
            copy(partial, first, &mut rows).map(|()| rows)?.close()
        });
        written.map_err(|error: WriteError| error.at(parquet.clone()))?;
        let results = Results::read_parquet(parquet)?;
        // the checkpoint is removed first: a killed run may leave samples without a checkpoint, which
        // are computed again, but a checkpoint without samples would be refused
        remove_if_there(checkpoint)?;
        remove_if_there(partial)?;
        if !is_failure {
            remove_if_there(failed)?;
        }
        Ok(results)
    }
}

/// Writes the results of a table that is complete in memory.
pub(crate) fn write_whole(results: &Results, folder: &Path) -> Result<(), ResultsError> {
    results.write_parquet(folder).map(|_| ())
}

/// The results of a complete run, if the file has any.
fn complete(parquet: &Path) -> Result<Option<Results>, ResultsError> {
    match Results::read_parquet(parquet) {
        Err(ResultsError::File { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
            Ok(None)
        }
        read => read.map(Some),
    }
}

/// The difference between kept results and a new run, as far as the metadata of both show it.
fn difference(found: &Results, begun: &Results) -> String {
    let (old, new) = (found.metadata(), begun.metadata());
    let parameters: Vec<String> = new
        .iter()
        .filter_map(|(key, value)| {
            let path = key.strip_prefix("parameter.")?;
            let before = old.get(key).filter(|before| *before != value)?;
            Some(format!("{path} was {before} and is {value}"))
        })
        .collect();
    let differs = |key: &str| old.get(key) != new.get(key);
    let paths = |results: &Results| -> Vec<String> {
        let columns = results.columns().iter();
        columns.map(|column| column.path.clone()).collect()
    };
    match parameters.as_slice() {
        [one] => one.clone(),
        [first, second] => format!("{first}, {second}"),
        [first, second, rest @ ..] => format!("{first}, {second}, and {} more", rest.len()),
        [] if differs("version") => "another version of eng made them".to_owned(),
        [] if differs("source_hash") => "the text has changed since".to_owned(),
        [] if paths(found) != paths(begun) => "it records other channels".to_owned(),
        [] => "its analysis, its steps, a mesh or the recorded part differs".to_owned(),
    }
}

/// Index of the first sample that is kept at the end.
fn first_kept(partial: &Path, last: Option<Last>) -> Result<usize, ResultsError> {
    let Some(last) = last else {
        return Ok(0);
    };
    let mut portions = Portions::open(partial)?;
    let header = portions.header();
    let place = |c: &super::Column| c.path == last.path();
    let Some(index) = header.columns().iter().position(place) else {
        return Ok(0);
    };
    let mut axis: Vec<super::Column> = header.columns().get(index).cloned().into_iter().collect();
    while let Some(batch) = portions.next()? {
        if let (Some(column), Some(array)) = (axis.first_mut(), batch.columns().get(index)) {
            schema::extend(column, array).map_err(|message| foreign(partial, message))?;
        }
    }
    Ok(axis
        .first()
        .map_or(0, |column| first_of(last, &column.values)))
}

/// Copies the rows of a stream from an index on.
fn copy(partial: &Path, first: usize, rows: &mut ParquetRows<'_>) -> Result<(), WriteError> {
    let refused = |error: ResultsError| WriteError::Parquet(error.to_string());
    let mut portions = Portions::open(partial).map_err(refused)?;
    let mut skip = first;
    while let Some(batch) = portions.next().map_err(refused)? {
        let from = skip.min(batch.num_rows());
        skip -= from;
        let mut columns = Vec::with_capacity(batch.num_columns());
        for array in batch.columns() {
            let numbers =
                schema::numbers("", array).map_err(|message| refused(foreign(partial, message)))?;
            columns.push(numbers.values().get(from..).unwrap_or_default());
        }
        rows.push(&columns)?;
    }
    Ok(())
}

fn foreign(path: &Path, message: String) -> ResultsError {
    ResultsError::Foreign {
        path: path.to_owned(),
        message,
    }
}
