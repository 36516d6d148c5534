//! Tables of results: summaries by interface, points of a sweep, modes; as text with aligned columns.

pub(crate) mod modes;
mod outcome;
pub(crate) mod response;
pub(crate) mod state;
pub(crate) mod summary;
pub(crate) mod sweep;

pub(crate) use outcome::over_points_of;
pub use outcome::{outcome_text, sweep_texts};
pub use summary::{Summarised, SummaryTable};
pub(crate) use summary::{in_words, mean, readable};

use eng_system::significant::without_sign_of_zero;

/// A table. Its first column is aligned left; the others are aligned right unless [`Table::render_left`] states
/// otherwise.
pub(crate) struct Table {
    rows: Vec<Vec<String>>,
    heads: usize,
}

impl Table {
    /// A table with rows of headings.
    pub fn new(heads: &[&[&str]]) -> Self {
        Table {
            rows: heads
                .iter()
                .map(|row| row.iter().map(|cell| (*cell).to_owned()).collect())
                .collect(),
            heads: heads.len(),
        }
    }

    /// Adds a row; a zero has no sign.
    pub fn row(&mut self, cells: Vec<String>) {
        let cells = cells.into_iter().map(without_sign_of_zero);
        self.rows.push(cells.collect());
    }

    /// The text, each line indented by two spaces, a rule under the headings.
    pub fn render(&self) -> String {
        self.render_left(usize::MAX)
    }

    /// [`Table::render`] with columns from `left` on aligned left.
    pub fn render_left(&self, left: usize) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let mut text = String::new();
        for (index, row) in self.rows.iter().enumerate() {
            let mut line = String::from(" ");
            for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
                let pad = " ".repeat(width.saturating_sub(cell.chars().count()));
                if column == 0 {
                    line.push_str(&format!(" {cell}{pad}"));
                } else if column >= left {
                    line.push_str(&format!("  {cell}{pad}"));
                } else {
                    line.push_str(&format!("  {pad}{cell}"));
                }
            }
            text.push_str(line.trim_end());
            text.push('\n');
            if index + 1 == self.heads {
                let total = widths.iter().sum::<usize>() + 2 * columns.saturating_sub(1);
                text.push_str(&format!("  {}\n", "─".repeat(total)));
            }
        }
        text
    }
}
