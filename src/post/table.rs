//! Reports on the terminal.

use super::{EvaluatedReport, Outcome};
use crate::cli::Table;

/// Values, conditions, and what could not be made; figures are named.
pub fn text(report: &EvaluatedReport) -> String {
    let mut text = format!("report {}: {}\n", report.name, report.title);
    for (analysis, reason) in &report.partial {
        text.push_str(&format!(
            "  {analysis} ended early ({reason}); this is of what it had reached\n"
        ));
    }
    let mut table = Table::new(&[]);
    let mut told = String::new();
    let mut rows = 0;
    for entry in &report.entries {
        match &entry.outcome {
            Ok(Outcome::Value(numbers, display)) => {
                for number in numbers {
                    let name = if number.name.is_empty() {
                        entry.title.clone()
                    } else {
                        format!("{}, {}", entry.title, number.name)
                    };
                    table.row(vec![name, display.text(number.value)]);
                    rows += 1;
                }
            }
            Ok(Outcome::Condition {
                holds: false,
                message,
                advise,
            }) => {
                let word = if *advise { "advised" } else { "required" };
                told.push_str(&format!(
                    "  {word}: {} does not hold: {message}\n",
                    entry.written
                ));
            }
            Ok(Outcome::Condition { .. } | Outcome::Figure(_)) => {}
            Err(error) => {
                told.push_str(&format!("  {} is not made: {error}\n", entry.name));
            }
        }
    }
    if rows > 0 {
        text.push_str(&table.render());
    }
    text.push_str(&told);
    text
}
