//! `eng results`.

use super::arguments::ResultsArguments;
use super::terminal::Terminal;
use super::{Stop, USAGE_OR_SYSTEM};
use crate::repetition::Repetition;
use crate::results::{Kind, Listed, Selection, listed};
use crate::tables::Table;
use eng_system::significant::short;

/// Lists the contents of result files. It reports unreadable files and still lists the others.
pub(super) fn results(
    arguments: &ResultsArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let files = match listed(&arguments.path) {
        Ok(files) => files,
        Err(error) => {
            writeln!(console.errors, "error: {error}")?;
            return Err(Stop::Code(USAGE_OR_SYSTEM));
        }
    };
    if files.is_empty() {
        writeln!(
            console.errors,
            "error: there are no results in {}",
            arguments.path.display()
        )?;
        return Err(Stop::Code(USAGE_OR_SYSTEM));
    }
    let selection = Selection::new(arguments.channels.iter().map(String::as_str));
    let mut unread = false;
    for (index, file) in files.iter().enumerate() {
        let read = Listed::read(file).and_then(|mut found| {
            found.results = selection.apply(&found.results)?;
            Ok(found)
        });
        match read {
            Ok(found) => {
                if index > 0 {
                    writeln!(console.output)?;
                }
                show(&found, console)?;
            }
            Err(error) => {
                unread = true;
                writeln!(console.errors, "error: {error}")?;
            }
        }
    }
    if unread {
        Err(Stop::Code(USAGE_OR_SYSTEM))
    } else {
        Ok(())
    }
}

fn show(found: &Listed, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let results = &found.results;
    let output = &mut console.output;
    writeln!(output, "{} ({})", results.analysis(), results.model())?;
    let state = match &found.kind {
        Kind::Complete => String::new(),
        Kind::Failed(reason) => format!("; the run failed: {reason}"),
        Kind::Unfinished => {
            "; the run is active or was interrupted: continue with `eng run … --resume`".to_owned()
        }
    };
    writeln!(output, "  {}{state}", found.path.display())?;
    let mut span = format!("{} samples", results.samples());
    let [time, angle] = found.spans();
    if let Some((from, to)) = time {
        span.push_str(&format!(", {} to {} s", short(from, 6), short(to, 6)));
    }
    if let Some((from, to)) = angle {
        let (from, to) = (from.to_degrees(), to.to_degrees());
        span.push_str(&format!(", {} to {} °CA", short(from, 6), short(to, 6)));
    }
    writeln!(output, "  {span}")?;
    if let Some(found) = Repetition::of(results.metadata()) {
        writeln!(output, "  {}", found.text())?;
    }
    for (key, value) in results.metadata() {
        if key == "identity" || key == "state" || Repetition::is_key(key) {
            continue;
        }
        let value = match key.split('.').next() {
            Some("parameter" | "point") => rounded(value),
            _ => value.clone(),
        };
        writeln!(output, "  {key}: {value}")?;
    }
    let mut table = Table::new(&[&["channel", "unit", "smallest", "largest", "frame"]]);
    for column in results.columns() {
        let shown = |si: f64| short(column.display.from_si(si), 6);
        let (low, high) = match column.range() {
            Some((low, high)) => (shown(low), shown(high)),
            None => ("–".to_owned(), "–".to_owned()),
        };
        table.row(vec![
            column.path.clone(),
            column.display.symbol.clone(),
            low,
            high,
            column.frame.clone(),
        ]);
    }
    write!(output, "{}", table.render())?;
    Ok(())
}

/// A number with its unit, to twelve digits. Later digits are rounding errors of the unit's factor.
pub fn rounded(text: &str) -> String {
    let (number, unit) = text.split_at(text.find(' ').unwrap_or(text.len()));
    match number.parse::<f64>() {
        Ok(value) if value.is_finite() => {
            let digits: f64 = format!("{value:.11e}").parse().unwrap_or(value);
            match digits.abs() {
                0.0 => format!("0{unit}"),
                // a choice: numbers of this size are easy to read without an exponent
                magnitude if (1e-4..1e9).contains(&magnitude) => format!("{digits}{unit}"),
                _ => format!("{digits:e}{unit}"),
            }
        }
        _ => text.to_owned(),
    }
}
