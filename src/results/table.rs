//! The samples of a run on their way to memory or disk.

use super::parquet::ParquetRows;
use super::recording::{Files, Recording};
use super::resume_point::{KeptWarning, ResumePoint};
use super::selection::Last;
use super::stream::{Portions, Stream};
use super::{Results, ResultsError, remove_if_there, replace_file, schema};
use std::path::Path;
use std::time::{Duration, Instant};

/// The largest number of samples that wait before they are written to disk. A choice: writing in portions is
/// faster, and a failure loses no more.
const BATCH: usize = 512;
/// The longest time that a sample waits. A choice: figures of a run that someone watches are at most so old.
const WAIT: Duration = Duration::from_millis(250);
/// The least time between two checkpoints. A choice: a disk is not kept busy by them.
const REST: Duration = Duration::from_millis(100);
/// The least time between two checkpoints, as a multiple of the time that the last one took. So saving stays
/// a small part of a run. A choice: 5 % at most.
const SHARE: u32 = 20;

/// Key of the metadata that identify a run.
const IDENTITY: &str = "identity";
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

#[derive(Debug)]
struct Disk {
    files: Files,
    identity: String,
    /// Opened with the first row, when all metadata are known.
    stream: Option<Stream>,
    flushed: Instant,
    saved: Instant,
    cost: Duration,
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
        // the last part is cut at the end, so a checkpoint serves every `--last`; complete results serve only
        // their own
        let whole = format!("{identity} {:?}", recording.last);
        table.header.set_metadata(IDENTITY, &whole);
        let files = Files::new(folder, table.header.analysis());
        let now = Instant::now();
        let mut disk = Disk {
            identity,
            stream: None,
            flushed: now,
            saved: now,
            cost: Duration::ZERO,
            files,
        };
        if recording.resume {
            if let Some(point) = ResumePoint::read(&disk.files.checkpoint)? {
                if point.identity != disk.identity {
                    let interrupted = Portions::open(&disk.files.partial)?.header();
                    return Err(ResultsError::Foreign {
                        path: disk.files.checkpoint.clone(),
                        message: format!(
                            "the interrupted run was another one: {}; run again without --resume",
                            difference(&interrupted, &table.header)
                        ),
                    });
                }
                let (stream, header) = Stream::resume(&disk.files.partial, point.samples)?;
                let same = header.columns() == table.header.columns();
                if !same {
                    return Err(ResultsError::Foreign {
                        path: disk.files.partial.clone(),
                        message: "its columns are not those of the run; run again without --resume"
                            .to_owned(),
                    });
                }
                // the stream's header holds the metadata of the start
                for (key, value) in header.metadata() {
                    if key != IDENTITY {
                        table.header.set_metadata(key, value);
                    }
                }
                table.given = point.samples;
                disk.stream = Some(stream);
                disk.files.remove_leftovers();
                table.disk = Some(disk);
                return Ok(Begun::Resumed(table, point));
            }
            if !disk.files.partial.exists()
                && let Some(results) = complete(&disk.files.parquet)?
            {
                let same = results.metadata().get(IDENTITY) == Some(&whole);
                return match same {
                    true => Ok(Begun::Complete(results)),
                    false => Err(ResultsError::Foreign {
                        path: disk.files.parquet.clone(),
                        message: format!(
                            "these are complete results of another run: {}; run without --resume to replace them, or keep them by --out",
                            difference(&results, &table.header)
                        ),
                    }),
                };
            }
        }
        // creating the stream now reports an unwritable folder before hours of computing;
        // a checkpoint of another run must not outlive its samples
        disk.stream = Some(Stream::create(&disk.files.partial, &table.header)?);
        remove_if_there(&disk.files.checkpoint)?;
        disk.files.remove_leftovers();
        table.disk = Some(disk);
        Ok(Begun::Fresh(table))
    }

    /// Sets metadata of the run before its first row.
    pub fn set_metadata(&mut self, key: &str, value: String) -> Result<(), ResultsError> {
        self.header.set_metadata(key, value);
        if self.given == 0
            && let Some(disk) = &mut self.disk
        {
            disk.stream = None;
            disk.stream = Some(Stream::create(&disk.files.partial, &self.header)?);
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
        let waiting = self.rows.first().map_or(0, Vec::len);
        match &self.disk {
            Some(disk) if waiting >= BATCH || disk.flushed.elapsed() >= WAIT => self.flush(),
            _ => Ok(()),
        }
    }

    /// Whether a checkpoint is expected.
    pub fn wants_checkpoint(&self) -> bool {
        self.disk
            .as_ref()
            .is_some_and(|disk| disk.saved.elapsed() >= REST.max(disk.cost * SHARE))
    }

    /// Saves the runtime's state after the last row.
    pub fn save(&mut self, state: Vec<u8>, warnings: Vec<KeptWarning>) -> Result<(), ResultsError> {
        let began = Instant::now();
        self.flush()?;
        let Some(disk) = &mut self.disk else {
            return Ok(());
        };
        if let Some(stream) = &disk.stream {
            stream.sync()?;
        }
        ResumePoint {
            identity: disk.identity.clone(),
            samples: self.given,
            warnings,
            state,
        }
        .write(&disk.files.checkpoint)?;
        disk.saved = Instant::now();
        disk.cost = disk.saved.duration_since(began);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), ResultsError> {
        if let Some(disk) = &mut self.disk
            && let Some(stream) = &mut disk.stream
        {
            disk.flushed = Instant::now();
            if self.rows.first().is_some_and(|row| !row.is_empty()) {
                stream.write(&mut self.rows)?;
            }
        }
        Ok(())
    }

    /// Ends the recording and returns the results. With a folder they are also on disk. `failure` is the
    /// reason if the run ended early. The results then have a file of their own, and files of an earlier run
    /// remain.
    pub fn finish(mut self, failure: Option<&str>) -> Result<Results, ResultsError> {
        self.flush()?;
        match failure {
            Some(reason) => self.header.set_failure(reason),
            None => self.header.set_metadata(STATE, COMPLETE),
        }
        match self.disk.take() {
            None => self.in_memory(),
            Some(disk) => {
                let Files {
                    partial,
                    checkpoint,
                    parquet,
                    failed,
                } = &disk.files;
                if failure.is_some() && self.given == 0 {
                    remove_if_there(checkpoint)?;
                    remove_if_there(partial)?;
                    remove_if_there(failed)?;
                    return self.in_memory();
                }
                let parquet = if failure.is_some() { failed } else { parquet };
                let first = first_kept(partial, self.last)?;
                let written = replace_file(parquet, |file| {
                    let mut rows = ParquetRows::new(file, &self.header)?;
                    copy(partial, first, &mut rows).map(|()| rows)?.close()
                });
                written.map_err(|error: super::parquet::WriteError| error.at(parquet.clone()))?;
                let results = Results::read_parquet(parquet)?;
                // the checkpoint is removed first: a killed run may leave samples without a checkpoint, which
                // are computed again, but a checkpoint without samples would be refused
                remove_if_there(checkpoint)?;
                remove_if_there(partial)?;
                if failure.is_none() {
                    remove_if_there(failed)?;
                }
                Ok(results)
            }
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

fn first_of(last: Last, values: &[f64]) -> usize {
    let end = values.last().copied().unwrap_or(0.0);
    values
        .iter()
        .position(|value| last.holds(*value, end))
        .unwrap_or(0)
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
fn copy(
    partial: &Path,
    first: usize,
    rows: &mut ParquetRows<'_>,
) -> Result<(), super::parquet::WriteError> {
    let refused = |error: ResultsError| super::parquet::WriteError::Parquet(error.to_string());
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
