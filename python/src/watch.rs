//! The watch of Python on a run: Ctrl-C, and a function that gets the progress.

use eng::Progress;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Least time between two looks. A look waits for the interpreter. A choice: Ctrl-C then acts at once for a
/// person.
const BETWEEN: Duration = Duration::from_millis(50);

/// A watch on a run outside of the interpreter's lock.
pub struct Watch {
    last: Instant,
    told: Option<Py<PyAny>>,
    /// The exception that ends the run.
    pub raised: Option<PyErr>,
}

impl Watch {
    /// A watch that tells a function about the progress.
    pub fn new(told: Option<Py<PyAny>>) -> Watch {
        Watch {
            last: Instant::now(),
            told,
            raised: None,
        }
    }

    /// Looks for signals and tells the progress. An exception ends the run.
    pub fn look(&mut self, now: &Progress) -> ControlFlow<()> {
        if self.last.elapsed() < BETWEEN {
            return ControlFlow::Continue(());
        }
        let looked = Python::attach(|py| {
            py.check_signals()?;
            match &self.told {
                Some(told) => told.call1(py, (now.fraction, now.time)).map(drop),
                None => Ok(()),
            }
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
