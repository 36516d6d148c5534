//! LU factors of the matrix of a ring of cells.
//!
//! The ring has `around` columns of `across` cells. Each cell couples with its four neighbours, the last
//! column with the first. One column is taken as the border. The others make a band whose half width is
//! `across`:
//!
//! ```text
//! | B  E |      B band, (around − 1) across rows       E (rows of B) × across
//! | G  C |      G across × (columns of B)              C across × across
//! ```
//!
//! No pivots are exchanged. The matrix is weakly diagonally dominant by columns, with positive diagonal and
//! without positive numbers beside it, but for cells of a cavity that closes within a step, which fill in the
//! next round.

/// Matrix and, after [`RingMatrix::factor`], its LU factors.
#[derive(Clone, Debug)]
pub(crate) struct RingMatrix {
    across: usize,
    columns: usize,
    /// Column of the ring that is the border.
    border: usize,
    /// Whether any number couples the border with the band.
    coupled: bool,
    /// Rows of `2 across + 1` numbers, the diagonal in the middle.
    band: Vec<f64>,
    /// Rows of `across` numbers.
    right: Vec<f64>,
    /// `across` rows of the band's length.
    below: Vec<f64>,
    corner: Vec<f64>,
}

/// Adds `-factor*other` to a row.
fn subtract(row: &mut [f64], factor: f64, other: &[f64]) {
    for (number, subtracted) in row.iter_mut().zip(other) {
        *number -= factor * subtracted;
    }
}

impl RingMatrix {
    /// A matrix of zeros. A ring has at least three columns: else both neighbours of a column would be one.
    pub(crate) fn new(around: usize, across: usize) -> Self {
        let rows = (around - 1) * across;
        RingMatrix {
            across,
            columns: around,
            border: around - 1,
            coupled: false,
            band: vec![0.0; rows * (2 * across + 1)],
            right: vec![0.0; rows * across],
            below: vec![0.0; rows * across],
            corner: vec![0.0; across * across],
        }
    }

    /// Zeros everywhere, and the column that becomes the border.
    pub(crate) fn clear(&mut self, border: usize) {
        self.border = border;
        self.coupled = false;
        self.band.fill(0.0);
        self.right.fill(0.0);
        self.below.fill(0.0);
        self.corner.fill(0.0);
    }

    /// Row of a cell, numbered column by column: band first, then border.
    fn place(&self, cell: usize) -> usize {
        let (column, row) = (cell / self.across, cell % self.across);
        let turned = (column + self.columns - self.border - 1) % self.columns;
        turned * self.across + row
    }

    /// Adds a number at the row and column of two cells that are neighbours or the same.
    pub(crate) fn add(&mut self, row: usize, column: usize, number: f64) {
        let (row, column) = (self.place(row), self.place(column));
        let (m, rows) = (self.across, (self.columns - 1) * self.across);
        match (row < rows, column < rows) {
            (true, true) => self.band[row * (2 * m + 1) + column + m - row] += number,
            (true, false) => {
                self.coupled |= number != 0.0;
                self.right[row * m + column - rows] += number;
            }
            (false, true) => {
                self.coupled |= number != 0.0;
                self.below[(row - rows) * rows + column] += number;
            }
            (false, false) => self.corner[(row - rows) * m + column - rows] += number,
        }
    }

    /// Replaces the matrix by its factors.
    pub(crate) fn factor(&mut self) {
        let m = self.across;
        let width = 2 * m + 1;
        let rows = (self.columns - 1) * m;
        for pivot in 0..rows {
            let (done, rest) = self.band.split_at_mut((pivot + 1) * width);
            let pivot_row = &done[pivot * width..];
            let inverse = 1.0 / pivot_row[m];
            let pivot_tail = &pivot_row[m + 1..];
            let (right_done, right_rest) = self.right.split_at_mut((pivot + 1) * m);
            let right_pivot = &right_done[pivot * m..];
            let below_pivot = m.min(rows - 1 - pivot);
            for (next, row) in rest.chunks_exact_mut(width).take(below_pivot).enumerate() {
                let at = m - 1 - next;
                if row[at] == 0.0 {
                    continue;
                }
                let factor = row[at] * inverse;
                row[at] = factor;
                subtract(&mut row[at + 1..at + 1 + m], factor, pivot_tail);
                if self.coupled {
                    subtract(
                        &mut right_rest[next * m..(next + 1) * m],
                        factor,
                        right_pivot,
                    );
                }
            }
            if !self.coupled {
                continue;
            }
            for (row, corner) in self
                .below
                .chunks_exact_mut(rows)
                .zip(self.corner.chunks_exact_mut(m))
            {
                if row[pivot] == 0.0 {
                    continue;
                }
                let factor = row[pivot] * inverse;
                row[pivot] = factor;
                subtract(
                    &mut row[pivot + 1..pivot + 1 + below_pivot],
                    factor,
                    pivot_tail,
                );
                subtract(corner, factor, right_pivot);
            }
        }
        for pivot in 0..m {
            let (done, rest) = self.corner.split_at_mut((pivot + 1) * m);
            let pivot_row = &done[pivot * m..];
            for row in rest.chunks_exact_mut(m) {
                let factor = row[pivot] / pivot_row[pivot];
                row[pivot] = factor;
                subtract(&mut row[pivot + 1..], factor, &pivot_row[pivot + 1..]);
            }
        }
    }

    /// Copies numbers of cells into the order of the rows.
    fn order(&self, cells: &[f64], rows: &mut [f64]) {
        let split = (self.border + 1) * self.across;
        let after = cells.len() - split;
        rows[..after].copy_from_slice(&cells[split..]);
        rows[after..].copy_from_slice(&cells[..split]);
    }

    /// Copies numbers in the order of the rows back to cells.
    fn restore(&self, rows: &[f64], cells: &mut [f64]) {
        let split = (self.border + 1) * self.across;
        let after = cells.len() - split;
        cells[split..].copy_from_slice(&rows[..after]);
        cells[..split].copy_from_slice(&rows[after..]);
    }

    /// Solves `A x = b` with the factors: `cells` holds b and then x; `scratch` is as long.
    pub(crate) fn solve(&self, cells: &mut [f64], scratch: &mut [f64]) {
        self.order(cells, scratch);
        let m = self.across;
        let width = 2 * m + 1;
        let rows = (self.columns - 1) * m;
        let (x, end) = scratch.split_at_mut(rows);
        for row in 1..rows {
            let first = row.saturating_sub(m);
            let factors = &self.band[row * width + first + m - row..row * width + m];
            let sum: f64 = factors.iter().zip(&x[first..row]).map(|(a, b)| a * b).sum();
            x[row] -= sum;
        }
        if self.coupled {
            for (number, factors) in end.iter_mut().zip(self.below.chunks_exact(rows)) {
                *number -= factors
                    .iter()
                    .zip(x.iter())
                    .map(|(a, b)| a * b)
                    .sum::<f64>();
            }
        }
        for row in 1..m {
            let sum: f64 = self.corner[row * m..row * m + row]
                .iter()
                .zip(end.iter())
                .map(|(a, b)| a * b)
                .sum();
            end[row] -= sum;
        }
        for row in (0..m).rev() {
            let factors = &self.corner[row * m..(row + 1) * m];
            let sum: f64 = factors[row + 1..]
                .iter()
                .zip(&end[row + 1..])
                .map(|(a, b)| a * b)
                .sum();
            end[row] = (end[row] - sum) / factors[row];
        }
        for row in (0..rows).rev() {
            let last = (row + 1 + m).min(rows);
            let factors = &self.band[row * width + m..row * width + m + last - row];
            let mut sum: f64 = factors[1..]
                .iter()
                .zip(&x[row + 1..last])
                .map(|(a, b)| a * b)
                .sum();
            if self.coupled {
                sum += self.right[row * m..(row + 1) * m]
                    .iter()
                    .zip(end.iter())
                    .map(|(a, b)| a * b)
                    .sum::<f64>();
            }
            x[row] = (x[row] - sum) / factors[0];
        }
        self.restore(scratch, cells);
    }

    /// Solves `Aᵀ x = b` with the factors: `cells` holds b and then x; `scratch` is as long.
    pub(crate) fn solve_transposed(&self, cells: &mut [f64], scratch: &mut [f64]) {
        self.order(cells, scratch);
        let m = self.across;
        let width = 2 * m + 1;
        let rows = (self.columns - 1) * m;
        let (x, end) = scratch.split_at_mut(rows);
        for row in 0..rows {
            let last = (row + 1 + m).min(rows);
            let factors = &self.band[row * width + m..row * width + m + last - row];
            let number = x[row] / factors[0];
            x[row] = number;
            subtract(&mut x[row + 1..last], number, &factors[1..]);
            if self.coupled {
                subtract(end, number, &self.right[row * m..(row + 1) * m]);
            }
        }
        for row in 0..m {
            let number = end[row] / self.corner[row * m + row];
            end[row] = number;
            subtract(
                &mut end[row + 1..],
                number,
                &self.corner[row * m + row + 1..(row + 1) * m],
            );
        }
        for row in (1..m).rev() {
            let (before, rest) = end.split_at_mut(row);
            subtract(before, rest[0], &self.corner[row * m..row * m + row]);
        }
        if self.coupled {
            for (number, factors) in end.iter().zip(self.below.chunks_exact(rows)) {
                subtract(x, *number, factors);
            }
        }
        for row in (1..rows).rev() {
            let first = row.saturating_sub(m);
            let (before, rest) = x.split_at_mut(row);
            subtract(
                &mut before[first..],
                rest[0],
                &self.band[row * width + first + m - row..row * width + m],
            );
        }
        self.restore(scratch, cells);
    }
}

#[cfg(test)]
mod tests {
    use super::RingMatrix;

    /// A ring whose couplings are numbers without pattern, once with its border cut.
    fn check(around: usize, across: usize, border: usize, cut: bool) {
        let cells = around * across;
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 40) as f64 / (1_u64 << 24) as f64
        };
        let mut dense = vec![0.0; cells * cells];
        let mut matrix = RingMatrix::new(around, across);
        matrix.clear(border);
        for cell in 0..cells {
            let (column, row) = (cell / across, cell % across);
            let east = (column + 1) % around * across + row;
            let west = (column + around - 1) % around * across + row;
            let mut near = vec![(cell, 5.0 + random()), (east, -random()), (west, -random())];
            if row > 0 {
                near.push((cell - 1, -random()));
            }
            if row + 1 < across {
                near.push((cell + 1, -random()));
            }
            for (other, number) in near {
                if cut && (cell / across == border) != (other / across == border) {
                    continue;
                }
                dense[cell * cells + other] += number;
                matrix.add(cell, other, number);
            }
        }
        assert_eq!(matrix.coupled, !cut);
        matrix.factor();
        let given: Vec<f64> = (0..cells).map(|_| random() - 0.5).collect();
        let mut scratch = vec![0.0; cells];
        let (mut x, mut y) = (given.clone(), given.clone());
        matrix.solve(&mut x, &mut scratch);
        matrix.solve_transposed(&mut y, &mut scratch);
        for cell in 0..cells {
            let row: f64 = (0..cells)
                .map(|other| dense[cell * cells + other] * x[other])
                .sum();
            let column: f64 = (0..cells)
                .map(|other| dense[other * cells + cell] * y[other])
                .sum();
            assert!((row - given[cell]).abs() < 1e-13 && (column - given[cell]).abs() < 1e-13);
        }
    }

    #[test]
    fn factors_solve_the_ring_and_its_transposed() {
        for (around, across) in [(3, 1), (3, 4), (7, 1), (9, 3), (12, 5)] {
            for border in [0, 1, around - 1] {
                check(around, across, border, false);
                check(around, across, border, true);
            }
        }
    }
}
