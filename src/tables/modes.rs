//! The table of modes, and the common table of the modes of a sweep's points.

use super::Table;
use crate::modes::{are_frozen, are_of_a_period, composition, values};
use crate::results::Results;
use crate::run::RunOutcome;
use eng_system::significant::significant;

/// The largest number of printed rows. The file has all rows. A choice: a screen.
const MOST_ROWS: usize = 40;
/// The largest number of printed modes for each point of a sweep. A choice.
const MOST_MODES: usize = 8;

fn frequency(value: f64) -> String {
    match value {
        0.0 => "–".to_owned(),
        // limits at which the shorter form rounds to one more digit
        value if value >= 999.95 => format!("{value:.1}"),
        value if value >= 0.995 => format!("{value:.2}"),
        value => significant(value, 3),
    }
}

fn decrement(value: f64) -> String {
    if value.is_nan() {
        "–".to_owned()
    } else {
        format!("{value:.4}")
    }
}

fn at(results: &Results, path: &str, row: usize) -> f64 {
    values(results, path)
        .and_then(|v| v.get(row))
        .copied()
        .unwrap_or(f64::NAN)
}

/// Frequency, damping and moving parts, with a line for each mode. Modes of a period also have the
/// logarithmic decrement and the growth, which is definite even if the frequency is not.
pub(crate) fn table(results: &Results) -> String {
    let growth = are_of_a_period(results);
    let mut head = [vec!["mode", "frequency", "damping"], vec!["", "Hz", "%"]];
    if growth {
        head[0].extend(["decrement", "growth"]);
        head[1].extend(["log.", "1/s"]);
    }
    head.iter_mut().for_each(|line| line.push(""));
    let mut text = Table::new(&[&head[0], &head[1]]);
    let rows = results.samples();
    for row in 0..rows.min(MOST_ROWS) {
        let mut cells = vec![
            format!("{:.0}", at(results, "mode", row)),
            frequency(at(results, "frequency", row)),
            format!("{:.2}", 100.0 * at(results, "damping_ratio", row)),
        ];
        if growth {
            cells.push(decrement(at(results, "logarithmic_decrement", row)));
            cells.push(significant(at(results, "growth", row), 5));
        }
        cells.push(composition(results, row));
        text.row(cells);
    }
    let rest = match rows.saturating_sub(MOST_ROWS) {
        0 => String::new(),
        more => format!("  and {more} more in the file\n"),
    };
    format!(
        "{}{}{rest}",
        mark(results),
        text.render_left(3 + 2 * usize::from(growth))
    )
}

/// A line above a table of frozen modes.
fn mark(results: &Results) -> &'static str {
    if are_frozen(results) {
        "frozen picture of one moment\n"
    } else {
        ""
    }
}

/// Frequencies and damping of the slowest oscillations, with a line for each point.
pub(crate) fn campbell_text(name: &str, family: &[&RunOutcome]) -> String {
    let Some(first) = family.first() else {
        return String::new();
    };
    let variables: Vec<&str> = first.point.iter().map(|p| p.name.as_str()).collect();
    let slow = |o: &RunOutcome| -> Vec<String> {
        (0..o.results.samples())
            .filter(|row| at(&o.results, "frequency", *row) > 0.0)
            .take(MOST_MODES)
            .map(|row| {
                format!(
                    "{} ({:.1} %)",
                    frequency(at(&o.results, "frequency", row)),
                    100.0 * at(&o.results, "damping_ratio", row)
                )
            })
            .collect()
    };
    let mut head = variables.clone();
    head.push("Hz (damping)");
    let mut text = Table::new(&[&head]);
    for outcome in family {
        let mut cells: Vec<String> = outcome
            .point
            .iter()
            .map(|p| p.display.text(p.value))
            .collect();
        cells.extend(slow(outcome));
        text.row(cells);
    }
    let mark = if family.iter().any(|o| are_frozen(&o.results)) {
        ", frozen pictures"
    } else {
        ""
    };
    format!("{name}{mark}\n{}", text.render())
}
