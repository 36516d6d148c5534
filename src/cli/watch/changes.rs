//! Changes of files.
//!
//! We compared two ways. *Events of the operating system* come at once and cost nothing while nothing happens. But they need a
//! dependency with code for each system, they name folders and not the files that links lead to, and network disks send none.
//! *Looking at the files again and again* is the present way. A model has some ten files, so a look takes some microseconds.

use crate::sources::Stamp;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Time between two looks. A choice: shorter than the way of the eyes from an editor to a terminal.
const INTERVAL: Duration = Duration::from_millis(200);
/// A file that has not changed for this time has been written to its end. A choice: editors write a text in one piece.
const AT_REST: Duration = Duration::from_millis(50);
/// Most waits for files that go on changing. A choice: two seconds.
pub const MOST_WAITS: usize = 40;

/// The files that a check has asked for, with their stamps before they were read.
pub type Files = BTreeMap<PathBuf, Option<Stamp>>;

/// A source of changes.
pub trait Changes {
    /// Replaces the files.
    fn watch(&mut self, files: Files);
    /// Whether one of the files has changed. It is asked often.
    fn came(&mut self) -> bool;
    /// Waits until one of the files has changed; false if none will.
    fn wait(&mut self) -> bool;
}

/// Looks at the files again and again, for ever.
#[derive(Debug, Default)]
pub struct Looks {
    files: Files,
    last: Option<Instant>,
}

impl Looks {
    /// Whether one of the files has another stamp than before.
    pub fn differ(&self) -> bool {
        self.files
            .iter()
            .any(|(path, stamp)| Stamp::of(path) != *stamp)
    }

    fn stamps(&self) -> Vec<Option<Stamp>> {
        self.files.keys().map(|path| Stamp::of(path)).collect()
    }
}

impl Changes for Looks {
    fn watch(&mut self, files: Files) {
        self.files = files;
    }

    fn came(&mut self) -> bool {
        if self.last.is_some_and(|last| last.elapsed() < INTERVAL) {
            return false;
        }
        self.last = Some(Instant::now());
        self.differ()
    }

    fn wait(&mut self) -> bool {
        while !self.differ() {
            sleep(INTERVAL);
        }
        at_rest(|| {
            sleep(AT_REST);
            self.stamps()
        });
        true
    }
}

/// Looks until two looks see the same, because a file may be half-written.
pub fn at_rest<S: PartialEq>(mut look: impl FnMut() -> S) {
    let mut before = look();
    for _ in 0..MOST_WAITS {
        let now = look();
        if now == before {
            break;
        }
        before = now;
    }
}
