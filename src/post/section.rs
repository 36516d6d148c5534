//! Sections of the page for `report` blocks.

use super::{EvaluatedReport, Outcome};
use eng_report::page::{Cell, Column, Section, Table};
use eng_report::readable_unit;

/// The section of a report: figures with their texts, a table of the values, conditions that do not hold.
pub(crate) fn section(report: &EvaluatedReport) -> Section {
    let mut section = Section::new(report.title.as_str());
    if !report.text.is_empty() {
        section = section.paragraph(report.text.as_str());
    }
    for (analysis, reason) in &report.partial {
        section = section.warning(format!(
            "{analysis} ended early ({reason}); this report uses the samples up to there."
        ));
    }
    let mut rows = Vec::new();
    for entry in &report.entries {
        match &entry.outcome {
            Ok(Outcome::Figure(figure)) => {
                let caption = match entry.text.is_empty() {
                    true => format!("{}.", entry.title),
                    false => entry.text.clone(),
                };
                section = section.figure_named(
                    (**figure).clone(),
                    caption,
                    format!("{}-{}", report.name, entry.name),
                    entry.written.as_str(),
                );
            }
            Ok(Outcome::Value(numbers, display)) => {
                for number in numbers {
                    let unit = if display.symbol == "1" {
                        String::new()
                    } else {
                        readable_unit(&display.symbol)
                    };
                    rows.push(vec![
                        Cell::Text(entry.name_of(number)),
                        Cell::number(display.from_si(number.value)),
                        Cell::Text(unit),
                        Cell::Code(entry.written.clone()),
                    ]);
                }
            }
            Ok(Outcome::Condition {
                holds: false,
                message,
                ..
            }) => {
                section = section.warning(format!("{} does not hold: {message}", entry.written));
            }
            Ok(Outcome::Condition { .. }) => {}
            Err(error) => {
                section = section.warning(format!("{} is not made: {error}.", entry.title));
            }
        }
    }
    if !rows.is_empty() {
        section = section.table(Table {
            caption: format!("Values: {}", report.title),
            columns: ["Value", "Number", "Unit", "As written"]
                .into_iter()
                .map(Column::new)
                .collect(),
            rows,
        });
    }
    section
}
