//! Samples on disk while an analysis runs: an Arrow stream that is readable up to its last whole batch at any
//! moment.
//!
//! Columns and metadata are those of the Parquet file; see [`super::schema`]. Every batch is written in one
//! call. A killed run may leave an incomplete batch: [`read`] ignores it, and [`Stream::resume`] removes it.

use super::file::{make_folder, refuse_link};
use super::{Column, Results, ResultsError, schema};
use crate::regular::{open, regular};
use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_ipc::reader::StreamReader;
use arrow_ipc::writer::StreamWriter;
use arrow_schema::Schema;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// An open stream. A lock on its file keeps other runs from writing into it.
pub struct Stream {
    path: PathBuf,
    file: File,
    encoder: StreamWriter<Vec<u8>>,
    schema: Arc<Schema>,
    /// Length of all whole batches (bytes).
    length: u64,
}

impl std::fmt::Debug for Stream {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Stream({}, {} bytes)", self.path.display(), self.length)
    }
}

impl Stream {
    /// Begins a stream with the columns and metadata of results. It overwrites an earlier file.
    pub fn create(path: &Path, header: &Results) -> Result<Stream, ResultsError> {
        let mut stream = Stream::on(path, lock(path)?, header)?;
        // a run killed between these two calls leaves an empty file, so nothing comes between them
        stream.file.set_len(0).map_err(at(path))?;
        stream.hand_over()?;
        Ok(stream)
    }

    /// Continues after a number of rows, at which a batch must end, and removes later rows. The header on
    /// disk does not change.
    pub fn resume(path: &Path, rows: u64) -> Result<(Stream, Results), ResultsError> {
        // `false`: a refused `--resume` must not leave a new file
        let mut file = locked(path, false).map_err(|error| match error {
            ResultsError::File { path, source } if source.kind() == io::ErrorKind::NotFound => {
                ResultsError::Foreign {
                    path,
                    message:
                        "the samples before the checkpoint are not here; run again without --resume"
                            .to_owned(),
                }
            }
            other => other,
        })?;
        let (mut found, mut end) = (0, None);
        let portions = Portions::open(path)?;
        let header = portions.header();
        if rows == 0 {
            end = Some(portions.position.get());
        }
        let mut portions = portions;
        while end.is_none()
            && let Some(batch) = portions.next()?
        {
            found += batch.num_rows() as u64;
            if found == rows {
                end = Some(portions.position.get());
            }
        }
        let length = end.ok_or_else(|| ResultsError::Foreign {
            path: path.to_owned(),
            message: format!(
                "the checkpoint is after {rows} samples, but only {found} whole ones are here; run again without --resume"
            ),
        })?;
        file.set_len(length).map_err(at(path))?;
        file.seek(SeekFrom::Start(length)).map_err(at(path))?;
        let mut stream = Stream::on(path, file, &header)?;
        // the header is on disk already
        stream.encoder.get_mut().clear();
        stream.length = length;
        Ok((stream, header))
    }

    fn on(path: &Path, file: File, header: &Results) -> Result<Stream, ResultsError> {
        let schema = schema::schema(header);
        let encoder = StreamWriter::try_new(Vec::new(), &schema).map_err(library(path))?;
        Ok(Stream {
            path: path.to_owned(),
            file,
            encoder,
            schema: Arc::new(schema),
            length: 0,
        })
    }

    /// Writes a batch: one vector for each column, in display units. It leaves the vectors empty.
    pub fn write(&mut self, columns: &mut [Vec<f64>]) -> Result<(), ResultsError> {
        let arrays = columns
            .iter_mut()
            .map(|column| Arc::new(Float64Array::from(std::mem::take(column))) as ArrayRef)
            .collect();
        let batch =
            RecordBatch::try_new(Arc::clone(&self.schema), arrays).map_err(library(&self.path))?;
        self.encoder.write(&batch).map_err(library(&self.path))?;
        self.hand_over()
    }

    /// Writes the encoded batch to the file, whole or not at all.
    fn hand_over(&mut self) -> Result<(), ResultsError> {
        let bytes = std::mem::take(self.encoder.get_mut());
        match self.file.write_all(&bytes) {
            Ok(()) => {
                self.length += bytes.len() as u64;
                Ok(())
            }
            Err(source) => {
                // a missing batch is better than a broken one; if the cut fails too, readers ignore the rest
                let _ = self.file.set_len(self.length);
                let _ = self.file.seek(SeekFrom::Start(self.length));
                Err(at(&self.path)(source))
            }
        }
    }

    /// Waits until the written data would survive a loss of power.
    pub fn sync(&self) -> Result<(), ResultsError> {
        self.file.sync_data().map_err(at(&self.path))
    }
}

/// Opens or creates a file for this process alone, and makes its folder.
pub(crate) fn lock(path: &Path) -> Result<File, ResultsError> {
    if let Some(folder) = path.parent() {
        make_folder(folder).map_err(at(folder))?;
    }
    locked(path, true)
}

/// Opens a stream for a single writer. `make` creates a missing file.
fn locked(path: &Path, make: bool) -> Result<File, ResultsError> {
    refuse_link(path).map_err(at(path))?;
    match regular(path) {
        Err(error) if make && error.kind() == io::ErrorKind::NotFound => {}
        found => drop(found.map_err(at(path))?),
    }
    let file = OpenOptions::new()
        .read(true)
        .write(true)
        .create(make)
        .truncate(false)
        .open(path)
        .map_err(at(path))?;
    // on other systems a lock would also keep readers out
    if !cfg!(unix) {
        return Ok(file);
    }
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(ResultsError::Busy {
            path: path.to_owned(),
        }),
        // a file system without locks
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(error)) => Err(at(path)(error)),
    }
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> ResultsError + '_ {
    move |source| ResultsError::File {
        path: path.to_owned(),
        source,
    }
}

fn library<E: std::fmt::Display>(path: &Path) -> impl FnOnce(E) -> ResultsError + '_ {
    move |error| ResultsError::Foreign {
        path: path.to_owned(),
        message: error.to_string(),
    }
}

/// Counts the bytes that were read.
struct Counting<R> {
    inner: R,
    position: Rc<Cell<u64>>,
}

impl<R: Read> Read for Counting<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let taken = self.inner.read(buffer)?;
        self.position.set(self.position.get() + taken as u64);
        Ok(taken)
    }
}

/// The whole batches of a stream, one after the other.
pub(super) struct Portions {
    reader: StreamReader<Counting<BufReader<File>>>,
    header: Results,
    /// Bytes up to the end of the last whole batch.
    position: Rc<Cell<u64>>,
}

impl Portions {
    /// Reads the header.
    pub fn open(path: &Path) -> Result<Portions, ResultsError> {
        let file = open(path).map_err(at(path))?;
        let position = Rc::new(Cell::new(0));
        let counting = Counting {
            inner: BufReader::new(file),
            position: Rc::clone(&position),
        };
        // the library panics on some damaged streams
        let opened = catch_unwind(AssertUnwindSafe(|| {
            StreamReader::try_new(counting, None).ok()
        }));
        let reader =
            opened.ok().flatten().ok_or_else(|| ResultsError::Foreign {
                path: path.to_owned(),
                message: "the file is empty or damaged: its run was killed before its first samples, or it was cut; run the analysis again".to_owned(),
            })?;
        let schema = reader.schema();
        let entries: BTreeMap<String, String> = schema
            .metadata()
            .iter()
            .map(|(key, value)| (key.to_string(), value.to_string()))
            .collect();
        let foreign = |message| ResultsError::Foreign {
            path: path.to_owned(),
            message,
        };
        let (mut header, columns) = schema::header(&entries, &schema).map_err(foreign)?;
        for column in columns {
            let pushed = header.push(column);
            pushed.map_err(|error| foreign(error.to_string()))?;
        }
        Ok(Portions {
            reader,
            header,
            position,
        })
    }

    /// Columns without values, metadata.
    pub fn header(&self) -> Results {
        self.header.clone()
    }

    /// The next whole batch. An unfinished batch after the last whole one counts as the end of the stream.
    pub fn next(&mut self) -> Result<Option<RecordBatch>, ResultsError> {
        let next = catch_unwind(AssertUnwindSafe(|| self.reader.next()));
        match next.ok().flatten() {
            Some(Ok(batch)) if batch.num_columns() == self.header.columns().len() => {
                Ok(Some(batch))
            }
            _ => Ok(None),
        }
    }
}

/// All whole batches of a stream, with values in SI.
pub fn read(path: &Path) -> Result<Results, ResultsError> {
    let mut portions = Portions::open(path)?;
    let header = portions.header();
    let mut columns: Vec<Column> = header.columns().to_vec();
    while let Some(batch) = portions.next()? {
        for (column, array) in columns.iter_mut().zip(batch.columns()) {
            schema::extend(column, array).map_err(|message| ResultsError::Foreign {
                path: path.to_owned(),
                message,
            })?;
        }
    }
    let mut results = header.without_columns();
    for column in columns {
        results.push(column)?;
    }
    Ok(results)
}
