//! Sparse symmetric matrices, stored by columns of the lower triangle.

pub(crate) mod product;

use crate::error::FlexibleError;
use product::multiply;

/// A sparse symmetric matrix. It stores the lower triangle with the diagonal by columns; rows ascend, and no
/// entry occurs twice.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct SymmetricMatrix {
    size: usize,
    column_start: Vec<usize>,
    row: Vec<u32>,
    value: Vec<f64>,
}

impl SymmetricMatrix {
    /// Makes a matrix from the parts of the storage.
    ///
    /// # Errors
    /// When the parts don't describe a lower triangle with ascending rows.
    pub fn from_parts(
        size: usize,
        column_start: Vec<usize>,
        row: Vec<u32>,
        value: Vec<f64>,
    ) -> Result<Self, FlexibleError> {
        let ordered = column_start.len() == size + 1
            && column_start.first() == Some(&0)
            && column_start.last() == Some(&row.len())
            && row.len() == value.len()
            && column_start.windows(2).enumerate().all(|(column, pair)| {
                pair[0] <= pair[1]
                    && row.get(pair[0]..pair[1]).is_some_and(|rows| {
                        rows.first().is_none_or(|first| *first as usize >= column)
                            && rows.last().is_none_or(|last| (*last as usize) < size)
                            && rows.windows(2).all(|next| next[0] < next[1])
                    })
            });
        if !ordered {
            return Err(FlexibleError::Matrix {
                problem: "a sparse matrix's rows and columns are not in order".into(),
                advice: String::new(),
            });
        }
        Ok(SymmetricMatrix {
            size,
            column_start,
            row,
            value,
        })
    }

    /// Makes a matrix from entries `(row, column, value)` of either triangle. Entries at the same place are
    /// summed in the given order. An entry above the diagonal counts as its mirror image, so give one
    /// triangle only.
    ///
    /// # Errors
    /// When an index is out of range.
    pub fn from_triplets(size: usize, entries: &[(u32, u32, f64)]) -> Result<Self, FlexibleError> {
        let mut count = vec![0usize; size + 1];
        for &(i, j, _) in entries {
            let (low, high) = (i.min(j) as usize, i.max(j) as usize);
            if high >= size {
                return Err(FlexibleError::Matrix {
                    problem: format!(
                        "entry ({}, {}) lies outside a matrix of {size} rows",
                        i + 1,
                        j + 1
                    ),
                    advice: String::new(),
                });
            }
            count[low + 1] += 1;
        }
        for column in 0..size {
            count[column + 1] += count[column];
        }
        let mut place = count.clone();
        let mut unsorted = vec![(0u32, 0.0); entries.len()];
        for &(i, j, value) in entries {
            let (low, high) = (i.min(j) as usize, i.max(j));
            unsorted[place[low]] = (high, value);
            place[low] += 1;
        }
        let (mut column_start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
        for column in 0..size {
            let slice = &mut unsorted[count[column]..count[column + 1]];
            slice.sort_by_key(|entry| entry.0);
            let first = row.len();
            for &(i, x) in slice.iter() {
                if row.len() > first && row.last() == Some(&i) {
                    if let Some(last) = value.last_mut() {
                        *last += x;
                    }
                } else {
                    row.push(i);
                    value.push(x);
                }
            }
            column_start.push(row.len());
        }
        Ok(SymmetricMatrix {
            size,
            column_start,
            row,
            value,
        })
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Start of each column in the storage, and the end of the last.
    pub fn column_start(&self) -> &[usize] {
        &self.column_start
    }

    /// Rows of the entries.
    pub fn rows(&self) -> &[u32] {
        &self.row
    }

    /// Values of the entries.
    pub fn values(&self) -> &[f64] {
        &self.value
    }

    /// Values of the entries, to change them in place.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.value
    }

    /// Rows and values of a column (on and below the diagonal).
    pub fn column(&self, column: usize) -> (&[u32], &[f64]) {
        let range = self.column_start[column]..self.column_start[column + 1];
        (&self.row[range.clone()], &self.value[range])
    }

    /// The matrix without the rows and columns marked in `held`. The other rows keep their order.
    ///
    /// # Errors
    /// When `held` has another length than the matrix has rows.
    pub fn without(&self, held: &[bool]) -> Result<Self, FlexibleError> {
        if held.len() != self.size {
            return Err(FlexibleError::Matrix {
                problem: format!("{} freedoms are held or not, of {}", held.len(), self.size),
                advice: String::new(),
            });
        }
        let mut place = vec![0u32; self.size];
        let mut size = 0u32;
        for (place, held) in place.iter_mut().zip(held) {
            *place = size;
            size += u32::from(!held);
        }
        let (mut column_start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
        for column in (0..self.size).filter(|column| !held[*column]) {
            let (rows, values) = self.column(column);
            for (&i, &x) in rows.iter().zip(values) {
                if !held[i as usize] {
                    row.push(place[i as usize]);
                    value.push(x);
                }
            }
            column_start.push(row.len());
        }
        SymmetricMatrix::from_parts(size as usize, column_start, row, value)
    }
}

/// A symmetric linear operator on vectors of a fixed length.
pub trait SymmetricOperator {
    /// Length of the vectors.
    fn size(&self) -> usize;
    /// `y = A x` for each of `columns` vectors, stored one after the other.
    fn apply(&self, columns: usize, x: &[f64], y: &mut [f64]);
}

impl SymmetricOperator for SymmetricMatrix {
    fn size(&self) -> usize {
        self.size
    }

    fn apply(&self, columns: usize, x: &[f64], y: &mut [f64]) {
        // several vectors share one pass over the matrix; each vector's sums keep their order, so the bits
        // are equal
        if columns > 1 && x.len() == y.len() && x.len() == columns * self.size {
            multiply(self, x, y);
            return;
        }
        y.fill(0.0);
        for (x, y) in x
            .chunks_exact(self.size)
            .zip(y.chunks_exact_mut(self.size))
            .take(columns)
        {
            for column in 0..self.size {
                let (rows, values) = self.column(column);
                let mut sum = 0.0;
                for (&row, &value) in rows.iter().zip(values) {
                    let row = row as usize;
                    sum += value * x[row];
                    if row != column {
                        y[row] += value * x[column];
                    }
                }
                y[column] += sum;
            }
        }
    }
}
