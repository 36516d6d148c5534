//! Opens the model that a command names.

use super::Refusal;
use super::terminal::Terminal;
use super::{MODEL_WRONG, Stop};
use crate::program::{self, Checked, Program};
use eng_grammar::SourceMap;
use std::path::Path;

/// Reads a model and everything it uses, and checks it. Reduced bodies are kept in the user's cache.
///
/// # Errors
/// A file or folder that can't be read.
pub(super) fn open(model: &Path) -> Result<Checked, Refusal> {
    program::open(model).map_err(|error| Refusal::System(error.to_string()))
}

/// A model without errors; the messages of its check are shown.
pub(super) fn checked(model: &Path, console: &mut Terminal<'_>) -> Result<Program, Stop> {
    match open(model) {
        Ok(checked) => without_errors(&checked, console).cloned(),
        Err(refusal) => Err(refusal.show(&SourceMap::new(), console)),
    }
}

/// The program of a check without errors; the messages are shown.
pub(super) fn without_errors<'c>(
    checked: &'c Checked,
    console: &mut Terminal<'_>,
) -> Result<&'c Program, Stop> {
    let report = checked.report();
    console
        .errors
        .messages(report.diagnostics(), report.texts())?;
    checked.program().ok_or(Stop::Code(MODEL_WRONG))
}
