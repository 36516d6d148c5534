//! Reports on the terminal.

use super::{EvaluatedReport, Outcome};

/// Values, conditions that do not hold, and the entries that could not be made, with the reason.
pub fn text(report: &EvaluatedReport) -> String {
    let mut text = format!("report {}: {}\n", report.name, report.title);
    for (analysis, reason) in &report.partial {
        text.push_str(&format!(
            "  {analysis} ended early ({reason}); the numbers cover the part before\n"
        ));
    }
    let mut rows: Vec<[String; 3]> = Vec::new();
    let mut problems = String::new();
    for entry in &report.entries {
        match &entry.outcome {
            Ok(Outcome::Value(numbers, display)) => {
                for number in numbers {
                    let shown = display.text(number.value);
                    let (value, unit) = shown.split_once(' ').unwrap_or((&shown, ""));
                    rows.push([entry.name_of(number), value.to_owned(), unit.to_owned()]);
                }
            }
            Ok(Outcome::Condition {
                holds: false,
                message,
                advise,
            }) => {
                let word = if *advise { "advised" } else { "required" };
                problems.push_str(&format!(
                    "  {word}: {} does not hold: {message}\n",
                    entry.written
                ));
            }
            Ok(Outcome::Condition { .. } | Outcome::Figure(_)) => {}
            Err(error) => {
                problems.push_str(&format!("  {} is not made: {error}\n", entry.name));
            }
        }
    }
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let (names, values) = (width(0), width(1));
    for [name, value, unit] in &rows {
        let name_pad = " ".repeat(names.saturating_sub(name.chars().count()));
        let value_pad = " ".repeat(values.saturating_sub(value.chars().count()));
        let line = format!("  {name}{name_pad}  {value_pad}{value} {unit}");
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text.push_str(&problems);
    text
}
