//! The points of a sweep side by side.

use super::{SummaryTable, Table};
use crate::cycle::last_cycle;
use crate::indexed;
use crate::results::{CYCLE_ANGLE, Column, Results, STOPPED, TIME, finite_range};
use crate::run::RunOutcome;
use eng_system::analysis::STOP;
use eng_system::significant::short;
use eng_system::{Dimension, DisplayUnit};

/// Two or more analyses with one name and an index: `runup[1]`, `runup[2]`, …
pub(crate) fn families(outcomes: &[RunOutcome]) -> Vec<Vec<&RunOutcome>> {
    let mut families: Vec<Vec<&RunOutcome>> = Vec::new();
    for outcome in outcomes.iter().filter(|o| !o.point.is_empty()) {
        let name = base(outcome);
        match families
            .iter_mut()
            .find(|f| f.first().is_some_and(|o| base(o) == name))
        {
            Some(family) => family.push(outcome),
            None => families.push(vec![outcome]),
        }
    }
    families.retain(|family| family.len() > 1);
    families
}

/// `runup` of `runup[3]`.
fn base(outcome: &RunOutcome) -> &str {
    indexed::base(outcome.results.analysis())
}

/// The name of a family.
pub(crate) fn name<'o>(family: &[&'o RunOutcome]) -> &'o str {
    family.first().map_or("", |o| base(o))
}

/// One row for each point. It has:
///
/// - the variables of the sweep,
/// - of a periodic analysis the number of cycles, and 1 if the last cycle repeats. There are no numbers if the
///   point was complete and was not run again,
/// - of a transient analysis with a `stop` the time at which it ended the point; no number if it did not,
/// - the summaries of the elements, such as `main[1].radial_load.largest`,
/// - the smallest and the largest value of each output of the model.
///
/// The values cover the last whole cycle if there is one, otherwise the whole run.
pub(crate) fn table(family: &[&RunOutcome]) -> Results {
    let Some(first) = family.first() else {
        return Results::new("", "");
    };
    let mut table = Results::new(base(first), first.results.model());
    // names differ and lengths are equal, so no column is refused
    let mut push = |path: String, dimension, display: DisplayUnit, values: Vec<f64>| {
        let _ = table.push(Column {
            path,
            dimension,
            display,
            frame: String::new(),
            values,
        });
    };
    for (k, point) in first.point.iter().enumerate() {
        let value = |o: &&RunOutcome| o.point.get(k).map_or(f64::NAN, |p| p.value);
        push(
            point.name.clone(),
            point.dimension,
            point.display.clone(),
            family.iter().map(value).collect(),
        );
    }
    let plain = DisplayUnit::si(Dimension::ONE);
    if family.iter().any(|o| o.periodic.is_some()) {
        let cycles = |o: &&RunOutcome| o.periodic.map_or(f64::NAN, |p| f64::from(p.0));
        let repeats = |o: &&RunOutcome| o.periodic.map_or(f64::NAN, |p| f64::from(u8::from(p.1)));
        push(
            "cycles".to_owned(),
            Dimension::ONE,
            plain.clone(),
            family.iter().map(cycles).collect(),
        );
        push(
            "repeats".to_owned(),
            Dimension::ONE,
            plain,
            family.iter().map(repeats).collect(),
        );
    }
    let metadata = |o: &RunOutcome, key: &str| o.results.metadata().contains_key(key);
    if family.iter().any(|o| metadata(o, STOP)) {
        let time = first.results.column(TIME).map(|time| time.display.clone());
        let moment = |o: &&RunOutcome| {
            let time = o.results.column(TIME).filter(|_| metadata(o, STOPPED));
            let last = time.and_then(|time| time.values.last());
            last.copied().unwrap_or(f64::NAN)
        };
        push(
            "stopped_at".to_owned(),
            Dimension::TIME,
            time.unwrap_or_else(|| DisplayUnit::si(Dimension::TIME)),
            family.iter().map(moment).collect(),
        );
    }
    let outputs = || {
        let columns = first.results.columns().iter();
        columns.filter(|column| !column.path.contains('.') && column.path != TIME)
    };
    // of a state each output has one value, and the first columns are printed
    if first.results.is_state() {
        for column in outputs() {
            let value = |o: &&RunOutcome| extremes(o, &column.path).map_or(f64::NAN, |e| e.0);
            push(
                column.path.clone(),
                column.dimension,
                column.display.clone(),
                family.iter().map(value).collect(),
            );
        }
    }
    let of_interfaces: Vec<Vec<SummaryTable<'_>>> = family.iter().map(|o| summaries(o)).collect();
    for (k, summary) in first.machine.summaries.iter().enumerate() {
        for (row, element) in summary.elements.iter().enumerate() {
            for (at, (column, channel)) in summary.columns.iter().zip(&element.channels).enumerate()
            {
                let Some(own) = channel.as_ref().and_then(|path| first.results.column(path)) else {
                    continue;
                };
                let value = |tables: &Vec<SummaryTable<'_>>| {
                    let row = tables.get(k)?.rows.get(row)?;
                    Some(row.get(at).copied().flatten()?.value)
                };
                let values = of_interfaces
                    .iter()
                    .map(|tables| value(tables).unwrap_or(f64::NAN));
                push(
                    format!(
                        "{}.{}.{}",
                        element.path,
                        column.output,
                        column.statistic.word()
                    ),
                    own.dimension,
                    own.display.clone(),
                    values.collect(),
                );
            }
        }
    }
    for column in outputs().filter(|_| !first.results.is_state()) {
        let extremes: Vec<(f64, f64)> = family
            .iter()
            .map(|o| extremes(o, &column.path).unwrap_or((f64::NAN, f64::NAN)))
            .collect();
        for (name, pick) in [("smallest", 0), ("largest", 1)] {
            push(
                format!("{}.{name}", column.path),
                column.dimension,
                column.display.clone(),
                extremes
                    .iter()
                    .map(|e| if pick == 0 { e.0 } else { e.1 })
                    .collect(),
            );
        }
    }
    table
}

/// Smallest and largest value of a column over the last whole cycle, or the whole run.
fn extremes(outcome: &RunOutcome, path: &str) -> Option<(f64, f64)> {
    let results = &outcome.results;
    let angle = results.column(CYCLE_ANGLE).map(|c| c.values.as_slice());
    let first = last_cycle(angle, outcome.machine.cycle_period).unwrap_or(0);
    finite_range(results.column(path)?.values.get(first..)?)
}

/// The summaries of a point. A state has no samples, and its values are columns of their own.
fn summaries(outcome: &RunOutcome) -> Vec<SummaryTable<'_>> {
    let machine = &outcome.machine;
    let summaries = machine.summaries.iter();
    summaries
        .map(|summary| SummaryTable::new(&outcome.results, summary, machine.cycle_period))
        .collect()
}

/// The largest number of columns of the printed table. The file has all columns. A choice: the width of a
/// terminal.
const MOST_COLUMNS: usize = 9;

/// The table as text.
pub(crate) fn text(table: &Results) -> String {
    let columns = table.columns();
    let shown = &columns[..columns.len().min(MOST_COLUMNS)];
    let names: Vec<&str> = shown.iter().map(|c| c.path.as_str()).collect();
    let units: Vec<&str> = shown.iter().map(|c| c.display.symbol.as_str()).collect();
    let mut text = Table::new(&[&names, &units]);
    for row in 0..table.samples() {
        text.row(
            shown
                .iter()
                .map(|c| match c.values.get(row) {
                    Some(value) if value.is_finite() => short(c.display.from_si(*value), 5),
                    _ => "–".to_owned(),
                })
                .collect(),
        );
    }
    let more = columns.len() - shown.len();
    let rest = match more {
        0 => String::new(),
        1 => "  and one more column in the file\n".to_owned(),
        _ => format!("  and {more} more columns in the file\n"),
    };
    format!("{}\n{}{rest}", table.analysis(), text.render())
}
/// The rows of all points of a sweep, one below the other: the point's variables, then the columns of each.
pub(crate) fn stacked(name: &str, family: &[&RunOutcome]) -> Results {
    let Some(first) = family.first() else {
        return Results::new("", "");
    };
    let mut table = first.results.without_columns();
    let mut all = Results::new(name, table.model());
    for (key, value) in table.metadata() {
        // metadata of a single point are left out
        if !key.starts_with("point.") && !key.starts_with("start") && key != "identity" {
            all.set_metadata(key, value);
        }
    }
    table = all;
    // names differ and lengths are equal, so no column is refused
    let mut push = |column: Column| {
        let _ = table.push(column);
    };
    for (k, point) in first.point.iter().enumerate() {
        let own = |o: &&RunOutcome| {
            let value = o.point.get(k).map_or(f64::NAN, |p| p.value);
            vec![value; o.results.samples()]
        };
        push(Column {
            path: point.name.clone(),
            dimension: point.dimension,
            display: point.display.clone(),
            frame: String::new(),
            values: family.iter().flat_map(own).collect(),
        });
    }
    for column in first.results.columns() {
        let own = |o: &&RunOutcome| match o.results.column(&column.path) {
            Some(column) => column.values.clone(),
            None => vec![f64::NAN; o.results.samples()],
        };
        push(Column {
            values: family.iter().flat_map(own).collect(),
            ..column.clone()
        });
    }
    table
}
