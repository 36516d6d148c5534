//! Results of one row: the values of a state.

use super::Table;
use crate::results::{Column, Results, TIME};
use eng_system::significant::short;

/// Values that are printed: more are in the file. A choice: a screen.
const MOST_VALUES: usize = 24;

/// The columns that a reader looks for: the model's outputs first, then the channels of its elements; without
/// time and energies.
pub(crate) fn columns(results: &Results) -> Vec<&Column> {
    let shown = |column: &&Column| column.path != TIME && !column.path.starts_with("energy.");
    let (own, others): (Vec<&Column>, Vec<&Column>) = results
        .columns()
        .iter()
        .filter(shown)
        .partition(|column| !column.path.contains('.'));
    [own, others].concat()
}

/// The values with their units as text.
pub(crate) fn text(results: &Results) -> String {
    let columns = columns(results);
    if columns.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&[&["channel", "value", "unit"]]);
    for column in columns.iter().take(MOST_VALUES) {
        let value = column.values.first().copied().unwrap_or(f64::NAN);
        table.row(vec![
            column.path.clone(),
            short(column.display.from_si(value), 6),
            column.display.symbol.clone(),
        ]);
    }
    let rest = match columns.len().saturating_sub(MOST_VALUES) {
        0 => String::new(),
        more => format!("  and {more} more in the file\n"),
    };
    format!("{}{rest}", table.render_left(2))
}
