//! The last cycle of results, which the sections of analyses and sweeps show.

use super::{Entry, loads};
use crate::cycle::{last_cycle, shifted};
use crate::results::{CYCLE_ANGLE, Column, Results, ResultsError};
use crate::run::RunOutcome;

/// The last whole cycle with its angles from 0 on; of results without a whole cycle all. With a motion the
/// journals have the angles of their pins, too.
pub(super) fn of_last_cycle(entry: &Entry) -> Result<RunOutcome, ResultsError> {
    let results = &entry.outcome.results;
    // a state has no cycle to cut
    if results.is_state() {
        return Ok(entry.outcome.clone());
    }
    let period = entry.described.machine.cycle_period;
    let angle = results.column(CYCLE_ANGLE).map(|c| c.values.as_slice());
    let first = last_cycle(angle, period).unwrap_or(0);
    let mut cut = Results::new(results.analysis(), results.model());
    for column in results.columns() {
        let mut values = column.values.get(first..).unwrap_or_default().to_vec();
        if column.path == CYCLE_ANGLE {
            values = shifted(values, period);
        }
        cut.push(Column {
            values,
            ..column.clone()
        })?;
    }
    loads::add_turns(entry, &mut cut)?;
    Ok(RunOutcome {
        results: cut,
        ..entry.outcome.clone()
    })
}
