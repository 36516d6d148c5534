//! Entries of a pattern that follow each other by rows: loops over them are loops over slices.

use super::Pattern;

/// A run: entries in consecutive rows.
#[derive(Clone, Copy, Debug)]
struct Run {
    entry: usize,
    row: usize,
    length: usize,
}

/// The runs of every column.
#[derive(Clone, Debug, Default)]
pub struct Runs {
    /// Beginning of each column in `runs`, and the end.
    columns: Vec<usize>,
    runs: Vec<Run>,
}

impl Runs {
    /// The runs of a pattern.
    pub fn new(pattern: &Pattern) -> Runs {
        let mut columns = vec![0];
        let mut runs: Vec<Run> = Vec::new();
        for column in 0..pattern.size() {
            let first = runs.len();
            for entry in pattern.columns[column]..pattern.columns[column + 1] {
                let row = pattern.rows[entry];
                match runs[first..].last_mut() {
                    Some(run) if run.row + run.length == row => run.length += 1,
                    _ => runs.push(Run {
                        entry,
                        row,
                        length: 1,
                    }),
                }
            }
            columns.push(runs.len());
        }
        Runs { columns, runs }
    }

    fn column(&self, column: usize) -> &[Run] {
        &self.runs[self.columns[column]..self.columns[column + 1]]
    }

    /// Multiplies each entry by the factor of its row times that of its column.
    pub fn scale(&self, values: &mut [f64], rows: &[f64], columns: &[f64]) {
        for (column, by_column) in columns.iter().enumerate() {
            for run in self.column(column) {
                let factors = &rows[run.row..run.row + run.length];
                let values = &mut values[run.entry..run.entry + run.length];
                for (value, by_row) in values.iter_mut().zip(factors) {
                    *value *= by_column * by_row;
                }
            }
        }
    }

    /// `sum += A x` and `size += |A| |x|`, both with the sign or the size of `factor` (±1).
    pub(super) fn add_product(
        &self,
        values: &[f64],
        factor: f64,
        x: &[f64],
        sum: &mut [f64],
        size: &mut [f64],
    ) {
        for (column, x) in x.iter().enumerate() {
            let x = factor * x;
            for run in self.column(column) {
                let range = run.row..run.row + run.length;
                let values = &values[run.entry..run.entry + run.length];
                for ((sum, size), value) in sum[range.clone()]
                    .iter_mut()
                    .zip(&mut size[range])
                    .zip(values)
                {
                    let term = value * x;
                    *sum += term;
                    *size += term.abs();
                }
            }
        }
    }
}
