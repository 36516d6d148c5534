//! Makes a symmetric matrix of the matrix of a file, with checks.

use super::{ForeignMatrix, MatrixKind};
use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;
use eng_system::significant::short;

/// The largest difference of two mirrored entries, as a share of the norm of the row. A choice: files of ten
/// digits and more pass.
const SYMMETRIC_TO: f64 = 1e-9;
/// A structure has fewer empty rows than this multiple of its entries. More empty rows mean a damaged size. A
/// choice.
const EMPTIEST: usize = 64;

impl ForeignMatrix {
    /// The symmetric matrix, with the mean of mirrored entries. Row i must satisfy |aᵢⱼ − aⱼᵢ| ≤ 10⁻⁹ ‖aᵢ‖₂.
    /// For a file of one triangle the other is the mirror image; an entry given on both sides must agree
    /// within the same limit.
    ///
    /// # Errors
    /// When it isn't square, has an entry that isn't finite, isn't symmetric (with the worst entry), or when
    /// a mass has a negative diagonal.
    pub fn to_symmetric(&self, kind: MatrixKind) -> Result<SymmetricMatrix, FlexibleError> {
        if self.rows != self.columns {
            return Err(self.problem(
                format!("is not square: {} × {}", self.rows, self.columns),
                "name a stiffness or a mass matrix, which is square",
            ));
        }
        if self.rows / EMPTIEST > self.entries.len() + EMPTIEST {
            return Err(self.problem(
                format!(
                    "has {} rows but only {} entries",
                    self.rows,
                    self.entries.len()
                ),
                "write the matrix again; its size is damaged, or the run wrote an empty matrix",
            ));
        }
        let mut pairs = Vec::with_capacity(self.entries.len());
        for &(row, column, value) in &self.entries {
            if !value.is_finite() {
                return Err(self.problem(
                    format!(
                        "contains {value} at {}, column {}",
                        self.row_name(row as usize),
                        column + 1
                    ),
                    "the run that wrote it failed; read the messages of that run",
                ));
            }
            if row as usize >= self.rows || column as usize >= self.rows {
                return Err(self.problem(
                    format!(
                        "has {} rows, but an entry at row {}, column {}",
                        self.rows,
                        row + 1,
                        column + 1
                    ),
                    "write or copy the file again; it is damaged",
                ));
            }
            let (low, high) = (row.min(column), row.max(column));
            pairs.push((low, high, row < column, value));
        }
        pairs.sort_by_key(|&(low, high, above, _)| (low, high, above)); // stable: sums in the order of the file
        let folded = fold(&pairs);
        let norms = self.norms(&folded);
        self.is_symmetric(&folded, &norms)?;
        let mut column_start = vec![0; self.rows + 1];
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for place in &folded {
            if let Some(count) = column_start.get_mut(place.column as usize + 1) {
                *count += 1;
            }
            rows.push(place.row);
            values.push(self.value(place));
            if kind == MatrixKind::Mass && place.row == place.column && self.value(place) < 0.0 {
                return Err(self.problem(
                    format!(
                        "is a mass matrix with {} on its diagonal at {}",
                        short(self.value(place), 5),
                        self.row_name(place.row as usize)
                    ),
                    "check for negative densities or masses, and for an exchange of stiffness and mass",
                ));
            }
        }
        let mut sum = 0;
        for count in &mut column_start {
            sum += *count;
            *count = sum;
        }
        SymmetricMatrix::from_parts(self.rows, column_start, rows, values)
    }

    /// Values below and above the diagonal. For a file of one triangle each represents the other.
    fn sides(&self, place: &Place) -> (f64, f64) {
        match (place.below, place.above) {
            (Some(below), Some(above)) => (below, above),
            (Some(only), None) | (None, Some(only))
                if self.symmetric || place.row == place.column =>
            {
                (only, only)
            }
            (below, above) => (below.unwrap_or(0.0), above.unwrap_or(0.0)),
        }
    }

    fn value(&self, place: &Place) -> f64 {
        let (below, above) = self.sides(place);
        if below == above {
            below
        } else {
            0.5 * below + 0.5 * above
        }
    }

    /// Euclidean norms of the rows.
    fn norms(&self, folded: &[Place]) -> Vec<f64> {
        let largest = folded.iter().fold(0.0_f64, |largest, place| {
            let (below, above) = self.sides(place);
            largest.max(below.abs()).max(above.abs())
        });
        if largest == 0.0 {
            return vec![0.0; self.rows];
        }
        let mut norms = vec![0.0; self.rows];
        let mut add = |row: u32, value: f64| {
            if let Some(sum) = norms.get_mut(row as usize) {
                *sum += (value / largest) * (value / largest);
            }
        };
        for place in folded {
            let (below, above) = self.sides(place);
            add(place.row, below);
            if place.row != place.column {
                add(place.column, above);
            }
        }
        norms
            .into_iter()
            .map(|sum: f64| sum.sqrt() * largest)
            .collect()
    }

    fn is_symmetric(&self, folded: &[Place], norms: &[f64]) -> Result<(), FlexibleError> {
        let mut worst: Option<(f64, &Place)> = None;
        for place in folded {
            let (below, above) = self.sides(place);
            let norm = |row: u32| norms.get(row as usize).copied().unwrap_or(0.0);
            let smaller = norm(place.row).min(norm(place.column));
            let difference = (below - above).abs();
            if difference <= SYMMETRIC_TO * smaller {
                continue;
            }
            let part = difference / smaller; // infinite for an empty row
            if worst.is_none_or(|(most, _)| part > most) {
                worst = Some((part, place));
            }
        }
        let Some((part, place)) = worst else {
            return Ok(());
        };
        let (below, above) = self.sides(place);
        Err(self.problem(
            format!(
                "is not symmetric: the worst entry, at {}, column {}, is {}, and its mirror image is {}; they differ by {} of the row's norm",
                self.row_name(place.row as usize),
                place.column + 1,
                short(below, 9),
                short(above, 9),
                short(part, 2)
            ),
            "write the structural stiffness alone, without gyroscopic, follower or friction terms, and \
             with enough digits",
        ))
    }
}

/// A place on or below the diagonal, with the values of the file there and at its mirror image.
#[derive(Clone, Copy, Debug)]
struct Place {
    row: u32,
    column: u32,
    below: Option<f64>,
    above: Option<f64>,
}

/// Adds entries at the same place. The result is sorted by column and row.
fn fold(pairs: &[(u32, u32, bool, f64)]) -> Vec<Place> {
    let mut folded: Vec<Place> = Vec::with_capacity(pairs.len());
    for &(column, row, above, value) in pairs {
        let same = folded
            .last()
            .is_some_and(|last| last.row == row && last.column == column);
        if !same {
            folded.push(Place {
                row,
                column,
                below: None,
                above: None,
            });
        }
        if let Some(last) = folded.last_mut() {
            let side = if above {
                &mut last.above
            } else {
                &mut last.below
            };
            *side = Some(side.map_or(value, |sum| sum + value));
        }
    }
    folded
}
