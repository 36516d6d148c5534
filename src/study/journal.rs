//! The points so far of a part that is computed: a line of JSON for each, readable up to its last whole line.
//!
//! A lock on the file keeps other processes from computing the same part. A killed process may leave an incomplete
//! line, which is cut off.

use super::StudyError;
use crate::regular;
use crate::results::{PointRow, ResultsError, lock};
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The longest time that a point waits until it would survive a loss of power.
const SYNC: Duration = Duration::from_secs(1);

/// A line.
#[derive(Debug, Serialize, Deserialize)]
enum Line {
    /// A process has begun.
    Begun(Begun),
    /// A point has ended.
    Point(Point),
}

/// The process that computes a part.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Begun {
    /// Identity of the study.
    pub study: String,
    pub host: String,
    pub process: u32,
}

/// A point that has ended.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Point {
    /// Seconds since 1970 at its end.
    pub at: u64,
    pub rows: Vec<PointRow>,
}

/// Contents of a journal.
#[derive(Debug, Default)]
pub(super) struct Contents {
    /// The last process.
    pub begun: Option<Begun>,
    pub points: Vec<Point>,
    /// Length of the whole lines (bytes).
    length: u64,
}

/// An open journal.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    length: u64,
    synced: Instant,
}

impl Journal {
    /// Opens or creates a journal for this process alone. Its points remain.
    pub fn open(path: &Path, study: &str) -> Result<Journal, StudyError> {
        let file = loop {
            let file = lock(path)?;
            // a process that ended in between has removed the file that was locked
            if same(&file, path) {
                break file;
            }
        };
        let contents = read(path)?;
        let mut journal = Journal {
            path: path.to_owned(),
            file,
            length: contents.length,
            synced: Instant::now(),
        };
        let cut = |journal: &mut Journal| {
            journal.file.set_len(journal.length)?;
            journal.file.seek(SeekFrom::Start(journal.length))
        };
        cut(&mut journal).map_err(|error| journal.at(error))?;
        journal.add(&Line::Begun(Begun {
            study: study.to_owned(),
            host: host(),
            process: std::process::id(),
        }))?;
        Ok(journal)
    }

    /// Adds a point. It is on disk whole or not at all.
    pub fn push(&mut self, rows: Vec<PointRow>) -> Result<(), StudyError> {
        let at = SystemTime::now().duration_since(UNIX_EPOCH);
        let at = at.map_or(0, |at| at.as_secs());
        self.add(&Line::Point(Point { at, rows }))?;
        if self.synced.elapsed() >= SYNC {
            self.file.sync_data().map_err(|error| self.at(error))?;
            self.synced = Instant::now();
        }
        Ok(())
    }

    fn add(&mut self, line: &Line) -> Result<(), StudyError> {
        let mut text = serde_json::to_vec(line).map_err(|error| self.at(error.into()))?;
        text.push(b'\n');
        if let Err(error) = self.file.write_all(&text) {
            // a missing line is better than a broken one; if the cut fails too, readers ignore the rest
            let _ = self.file.set_len(self.length);
            let _ = self.file.seek(SeekFrom::Start(self.length));
            return Err(self.at(error));
        }
        self.length += text.len() as u64;
        Ok(())
    }

    fn at(&self, source: io::Error) -> StudyError {
        let path = self.path.clone();
        ResultsError::File { path, source }.into()
    }

    /// Removes it after its part was written.
    pub fn remove(self) -> Result<(), StudyError> {
        std::fs::remove_file(&self.path).map_err(|error| self.at(error))
    }
}

/// Reads the whole lines of a journal.
pub(super) fn read(path: &Path) -> Result<Contents, StudyError> {
    let bytes = regular::read(path).map_err(|source| ResultsError::File {
        path: path.to_owned(),
        source,
    })?;
    let mut contents = Contents::default();
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        if line.last() != Some(&b'\n') {
            break;
        }
        match serde_json::from_slice(line) {
            Ok(Line::Begun(begun)) => contents.begun = Some(begun),
            Ok(Line::Point(point)) => contents.points.push(point),
            Err(_) => break,
        }
        contents.length += line.len() as u64;
    }
    Ok(contents)
}

/// Whether a process computes into a journal now, as far as its lock shows.
pub(super) fn is_running(path: &Path) -> bool {
    let file = OpenOptions::new().read(true).open(path);
    file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// Whether a path still leads to an open file.
#[cfg(unix)]
fn same(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let of = |found: std::fs::Metadata| (found.dev(), found.ino());
    let open = file.metadata().map(of).ok();
    open.is_some() && open == std::fs::metadata(path).map(of).ok()
}

#[cfg(not(unix))]
fn same(_: &File, _: &Path) -> bool {
    true
}

/// The name of this machine.
fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname");
    name.map_or_else(|_| "this machine".to_owned(), |name| name.trim().to_owned())
}
