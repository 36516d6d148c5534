//! Errors of the library as exceptions of Python. Their classes are in `englang/_errors.py`.

use eng::Error;
use eng::results::ResultsError;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::path::Path;

const CLASSES: &str = "englang._errors";

/// The exception for an error of the library. `partial` is the run up to the error.
pub fn raised(py: Python<'_>, error: &Error, partial: Option<Bound<'_, PyAny>>) -> PyErr {
    let class = match error {
        Error::Results(ResultsError::File { path, source }) => return of_system(path, source),
        Error::Report(_) => "ModelError",
        Error::Run { .. } => "RunError",
        Error::Results(ResultsError::NoChannel { .. }) => "SettingError",
        Error::Code(_) | Error::Results(_) => "Error",
        _ => "SettingError",
    };
    let messages = error
        .report()
        .map(|report| eng::render::json(report.diagnostics(), report.texts()));
    made(py, class, &error.to_string(), messages, partial)
}

/// An error of the system about a file, as the class of `OSError` that Python has for its number.
fn of_system(path: &Path, source: &std::io::Error) -> PyErr {
    match source.raw_os_error() {
        Some(number) => {
            // Python shows the number itself
            let text = source.to_string();
            let reason = text.split(" (os error").next().unwrap_or_default();
            let (reason, file) = (reason.to_owned(), path.display().to_string());
            // a number of Windows is the fourth argument, and Python finds the first one from it
            #[cfg(windows)]
            let arguments = (0, reason, file, number);
            #[cfg(not(windows))]
            let arguments = (number, reason, file);
            PyOSError::new_err(arguments)
        }
        None => PyOSError::new_err(format!("{}: {source}", path.display())),
    }
}

/// [`raised`] without a run.
pub fn plain(py: Python<'_>) -> impl Fn(Error) -> PyErr {
    move |error| raised(py, &error, None)
}

/// The exception for a name or value that a caller gave.
pub fn setting(py: Python<'_>, message: &str) -> PyErr {
    made(py, "SettingError", message, None, None)
}

/// The exception for a run that Ctrl-C has stopped.
pub fn interrupted(py: Python<'_>, partial: Option<Bound<'_, PyAny>>) -> PyErr {
    made(py, "Interrupted", "the run was stopped", None, partial)
}

fn made(
    py: Python<'_>,
    class: &str,
    message: &str,
    messages: Option<String>,
    partial: Option<Bound<'_, PyAny>>,
) -> PyErr {
    let arguments = (class, message.trim_end(), messages, partial);
    let made =
        PyModule::import(py, CLASSES).and_then(|classes| classes.call_method1("made", arguments));
    // a damaged installation has another error
    made.map_or_else(|error| error, PyErr::from_value)
}

/// Messages as objects of `englang.Diagnostic`, from the JSON of the library.
pub fn diagnostics<'py>(py: Python<'py>, messages: &str) -> PyResult<Bound<'py, PyAny>> {
    PyModule::import(py, "englang._diagnostics")?.call_method1("parsed", (messages,))
}
