//! Files of the cells of films.

use super::{Entry, ReportError};
use crate::results::write_cells;
use std::path::{Path, PathBuf};

/// Writes pressure, gap and content in the cells of an entry's films over its motion, and returns the path of
/// the file; `None` without such films or without their numbers.
///
/// # Errors
/// Films that cannot be solved as in the run; a failure of the operating system.
pub fn write_fields(entry: &Entry, folder: &Path) -> Result<Option<PathBuf>, ReportError> {
    let Some(motion) = &entry.outcome.motion else {
        return Ok(None);
    };
    let machine = &entry.described.machine;
    let mut columns = Vec::new();
    for field in &machine.fields {
        let journal = machine.journals.iter().find(|j| j.path == field.path);
        let force = journal.and_then(|j| entry.outcome.results.column(&j.force[0]));
        let frame = force.map_or("", |column| column.frame.as_str());
        let cells = field.cells(motion, frame);
        let cells = cells.map_err(|source| ReportError::Film {
            path: field.path.clone(),
            source,
        })?;
        columns.extend(cells.into_iter().flatten());
    }
    if columns.is_empty() {
        return Ok(None);
    }
    Ok(Some(write_cells(folder, motion, entry.name(), columns)?))
}
