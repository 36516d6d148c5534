//! The watch of Python on a run: Ctrl-C, and a function that gets the progress.

use eng::Progress;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Least time between two looks. A look waits for the interpreter. A choice: Ctrl-C then acts at once for a
/// person.
const BETWEEN: Duration = Duration::from_millis(50);

/// A watch for the signals of Python, outside of the interpreter's lock.
pub struct Signals {
    last: Instant,
    /// The exception that ends the work.
    pub raised: Option<PyErr>,
}

impl Signals {
    /// A watch from now on.
    pub fn new() -> Signals {
        Signals {
            last: Instant::now(),
            raised: None,
        }
    }

    /// Looks for signals if the last look was long ago, and calls a function then. An exception ends the work.
    pub fn look(&mut self, then: impl FnOnce(Python<'_>) -> PyResult<()>) -> ControlFlow<()> {
        if self.last.elapsed() < BETWEEN {
            return ControlFlow::Continue(());
        }
        let looked = Python::attach(|py| {
            py.check_signals()?;
            then(py)
        });
        self.last = Instant::now();
        match looked {
            Ok(()) => ControlFlow::Continue(()),
            Err(raised) => {
                self.raised = Some(raised);
                ControlFlow::Break(())
            }
        }
    }
}

/// A watch on a run, which calls a function with its progress.
pub struct Watch {
    signals: Signals,
    progress: Option<Py<PyAny>>,
}

impl Watch {
    /// A watch that calls a function of the share and the time (s).
    pub fn new(progress: Option<Py<PyAny>>) -> Watch {
        Watch {
            signals: Signals::new(),
            progress,
        }
    }

    /// Looks for signals and calls the function. An exception of either ends the run.
    pub fn look(&mut self, now: &Progress) -> ControlFlow<()> {
        let progress = &self.progress;
        self.signals.look(|py| match progress {
            Some(progress) => progress.call1(py, (now.fraction, now.time)).map(drop),
            None => Ok(()),
        })
    }

    /// The exception that has ended the run.
    pub fn raised(self) -> Option<PyErr> {
        self.signals.raised
    }
}
