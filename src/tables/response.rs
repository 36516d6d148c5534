//! The largest amplitude of each output of a frequency response.

use super::Table;
use crate::results::{Column, Results};
use crate::run::RunOutcome;
use eng_system::recorded::{FREQUENCY, PHASE};
use eng_system::significant::significant;

/// The largest number of printed outputs. The file has all. A choice: a screen.
const MOST_OUTPUTS: usize = 40;

/// The outputs of a response.
pub(crate) fn outputs(results: &Results) -> impl Iterator<Item = &Column> {
    let outputs = results.columns().iter();
    outputs.filter(|c| c.path != FREQUENCY && !c.path.ends_with(PHASE))
}

/// The amplitude of each output at the lowest frequency, its largest amplitude, and the frequency of that, with the
/// point of a sweep before them.
fn lines(results: &Results, point: &[String], table: &mut Table) {
    let frequencies = results.column(FREQUENCY).map(|c| c.values.as_slice());
    let frequencies = frequencies.unwrap_or_default();
    for output in outputs(results).take(MOST_OUTPUTS) {
        let number = |value: Option<&f64>| match value {
            Some(value) => significant(output.display.from_si(*value), 5),
            None => "–".to_owned(),
        };
        let all = output.values.iter().zip(frequencies);
        let largest = all.max_by(|(a, _), (b, _)| a.total_cmp(b));
        let mut cells = point.to_vec();
        cells.extend([
            output.path.clone(),
            output.display.symbol.clone(),
            number(output.values.first()),
            number(largest.map(|(value, _)| value)),
            largest.map_or_else(|| "–".to_owned(), |(_, at)| significant(*at, 5)),
        ]);
        table.row(cells);
    }
}

/// The table of one response.
pub(crate) fn text(results: &Results) -> String {
    let frequencies = results.column(FREQUENCY);
    let Some(lowest) = frequencies.and_then(|c| c.values.first()) else {
        return String::new();
    };
    let lowest = format!("at {} Hz", significant(*lowest, 4));
    let mut table = Table::new(&[&["output", "unit", &lowest, "largest", "at Hz"]]);
    lines(results, &[], &mut table);
    let rest = match outputs(results).count().saturating_sub(MOST_OUTPUTS) {
        0 => String::new(),
        more => format!("  and {more} more in the file\n"),
    };
    format!("{}{rest}", table.render())
}

/// The table of the responses of a sweep's points.
pub(crate) fn text_of_sweep(name: &str, family: &[&RunOutcome]) -> String {
    let Some(first) = family.first() else {
        return String::new();
    };
    let mut head: Vec<&str> = first.point.iter().map(|p| p.name.as_str()).collect();
    head.extend(["output", "unit", "at the lowest", "largest", "at Hz"]);
    let mut table = Table::new(&[&head]);
    for outcome in family {
        let point = outcome.point.iter().map(|p| p.display.text(p.value));
        let point: Vec<String> = point.collect();
        lines(&outcome.results, &point, &mut table);
    }
    format!("{name}\n{}", table.render())
}
