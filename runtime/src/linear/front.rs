//! A dense block of the elimination. Its unknowns are eliminated by pivots among its own rows. The others are
//! left to the parent.
//!
//! The numbers are stored by columns. Each column begins at a multiple of four, and the rows that fill
//! it up are zero.

use eng_system::dense::largest;

/// Number of columns in a panel: those of a rigid body. The remaining columns follow panel by panel.
const PANEL: usize = 6;
/// Rows and columns of the kernel's tile. A choice: sixteen sums fit in the vector registers.
const TILE: usize = 4;
/// A pivot is accepted if it is at least this part of the entries below it in rows of later fronts. This
/// limits their growth. The usual threshold of sparse solvers, 0.01 to 0.1: a smaller one loses digits, a
/// larger one moves pivots to later fronts and fills them.
const ACCEPTED: f64 = 0.01;
/// Size below which a pivot has no useful reciprocal. A choice: products with the reciprocal stay below the
/// largest double.
const SMALLEST: f64 = 1e-250;

/// A front with its factors.
#[derive(Clone, Debug, Default)]
pub(super) struct Front {
    /// The unknown of each row and of each column.
    pub(super) rows: Vec<usize>,
    /// See `rows`.
    pub(super) columns: Vec<usize>,
    /// Rows that may become pivots: own rows and those that children left over.
    candidates: usize,
    /// Pivots found.
    pub(super) eliminated: usize,
    stride: usize,
    values: Vec<f64>,
    reciprocals: Vec<f64>,
}

/// Room that fronts share.
#[derive(Clone, Debug, Default)]
pub(super) struct Work {
    /// Rows exchanged in a panel.
    swaps: Vec<(usize, usize)>,
    /// The panel's part below its pivots in groups of four rows, without zero groups.
    packed: Vec<[f64; TILE]>,
    /// Indices of these groups.
    tiles: Vec<usize>,
}

/// `y −= factor · x`.
fn subtract(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y -= factor * x;
    }
}

impl Front {
    /// Rows and columns.
    pub(super) fn size(&self) -> usize {
        self.rows.len()
    }

    /// Rows and columns that could not be eliminated here.
    pub(super) fn delayed(&self) -> usize {
        self.candidates - self.eliminated
    }

    /// Zeros with the unknowns set in `rows` and `columns`, the first `candidates` of which are to be
    /// eliminated.
    pub(super) fn clear(&mut self, candidates: usize) {
        let size = self.rows.len();
        self.candidates = candidates;
        self.eliminated = 0;
        self.stride = size.next_multiple_of(TILE);
        self.values.clear();
        self.values.resize(self.stride * size, 0.0);
        self.reciprocals.clear();
        self.reciprocals.resize(candidates, 0.0);
    }

    /// A column.
    pub(super) fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.values[column * self.stride..(column + 1) * self.stride]
    }

    fn column(&self, column: usize) -> &[f64] {
        &self.values[column * self.stride..(column + 1) * self.stride]
    }

    /// Adds the remainder of a child: its row and column `child.eliminated + i` to this front's `places[i]`.
    pub(super) fn add(&mut self, child: &Front, places: &[usize]) {
        for (j, place) in places.iter().enumerate() {
            let left = &child.column(child.eliminated + j)[child.eliminated..];
            let column = self.column_mut(*place);
            for (row, x) in places.iter().zip(left) {
                column[*row] += x;
            }
        }
    }

    /// Eliminates by LU with row exchanges among the candidates. Columns without an acceptable pivot are
    /// moved to the end and remain.
    pub(super) fn eliminate(&mut self, work: &mut Work) {
        let mut limit = self.candidates;
        let mut next = 0;
        while next < limit {
            let begin = next;
            let end = (begin + PANEL).min(limit);
            let mut refused = false;
            work.swaps.clear();
            while next < end && !refused {
                match self.pivot(begin, next) {
                    Some(row) => {
                        self.apply_pivot(begin, end, next, row, work);
                        next += 1;
                    }
                    None => refused = true,
                }
            }
            for column in (0..begin).chain(end..self.size()) {
                let column = &mut self.values[column * self.stride..(column + 1) * self.stride];
                for (a, b) in &work.swaps {
                    column.swap(*a, *b);
                }
            }
            self.follow(begin, next, next + usize::from(refused), work);
            if refused {
                limit -= 1;
                self.exchange_columns(next, limit);
            }
        }
        self.eliminated = next;
    }

    /// Brings a column of the panel up to date and looks for its pivot's row.
    fn pivot(&mut self, begin: usize, column: usize) -> Option<usize> {
        let (done, rest) = self.values.split_at_mut(column * self.stride);
        let current = &mut rest[..self.stride];
        for k in begin..column {
            let factor = current[k];
            if factor != 0.0 {
                let pivots = &done[k * self.stride..(k + 1) * self.stride];
                subtract(&mut current[k + 1..], factor, &pivots[k + 1..]);
            }
        }
        let (mut row, mut size) = (column, 0.0_f64);
        for (i, x) in current[column..self.candidates].iter().enumerate() {
            if x.abs() > size {
                size = x.abs();
                row = column + i;
            }
        }
        let below = largest(&current[self.candidates..]);
        (size > SMALLEST && size >= ACCEPTED * below).then_some(row)
    }

    /// Applies a pivot: exchanges rows in the panel, and divides.
    fn apply_pivot(
        &mut self,
        begin: usize,
        end: usize,
        column: usize,
        row: usize,
        work: &mut Work,
    ) {
        if row != column {
            for c in begin..end {
                self.column_mut(c).swap(column, row);
            }
            self.rows.swap(column, row);
            work.swaps.push((column, row));
        }
        let current = self.column_mut(column);
        let reciprocal = 1.0 / current[column];
        for x in &mut current[column + 1..] {
            *x *= reciprocal;
        }
        self.reciprocals[column] = reciprocal;
    }

    fn exchange_columns(&mut self, a: usize, b: usize) {
        if a != b {
            let (left, right) = self.values.split_at_mut(b * self.stride);
            left[a * self.stride..(a + 1) * self.stride].swap_with_slice(&mut right[..self.stride]);
            self.columns.swap(a, b);
        }
    }

    /// Updates the columns from `from` on with the pivots `begin..end`.
    fn follow(&mut self, begin: usize, end: usize, from: usize, work: &mut Work) {
        let (size, stride, count) = (self.size(), self.stride, end - begin);
        if count == 0 || from >= size {
            return;
        }
        let (done, rest) = self.values.split_at_mut(from * stride);
        let mut triangle = [[0.0; PANEL]; PANEL];
        let mut panel: [&[[f64; TILE]]; PANEL] = [&[]; PANEL];
        for k in 0..count {
            let column = &done[(begin + k) * stride..(begin + k + 1) * stride];
            for (i, line) in triangle[..count].iter_mut().enumerate().skip(k + 1) {
                line[k] = column[begin + i];
            }
            panel[k] = column.as_chunks::<TILE>().0;
        }
        work.packed.clear();
        work.tiles.clear();
        for tile in end / TILE..stride / TILE {
            let mut rows = [[0.0; TILE]; PANEL];
            let mut any = false;
            for (row, column) in rows.iter_mut().zip(&panel[..count]) {
                *row = column[tile];
                // pivots themselves, in the first tile
                for x in row.iter_mut().take(end.saturating_sub(tile * TILE)) {
                    *x = 0.0;
                }
                any |= row.iter().any(|x| *x != 0.0);
            }
            if any {
                work.packed.extend_from_slice(&rows[..count]);
                work.tiles.push(tile);
            }
        }
        let columns = size - from;
        let whole = columns / TILE * TILE;
        let (fours, ones) = rest[..columns * stride].split_at_mut(whole * stride);
        for group in fours.chunks_exact_mut(TILE * stride) {
            follow_columns::<TILE>(group, stride, begin..end, &triangle, work);
        }
        for single in ones.chunks_exact_mut(stride) {
            follow_columns::<1>(single, stride, begin..end, &triangle, work);
        }
    }

    /// Right-hand sides by rows: `L` of this front.
    pub(super) fn forward(&self, rhs: &mut [f64], local: &mut [f64]) {
        let local = &mut local[..self.size()];
        for (x, row) in local.iter_mut().zip(&self.rows) {
            *x = rhs[*row];
        }
        for k in 0..self.eliminated {
            let factor = local[k];
            subtract(&mut local[k + 1..], factor, &self.column(k)[k + 1..]);
        }
        for (x, row) in local.iter().zip(&self.rows) {
            rhs[*row] = *x;
        }
    }

    /// Solutions by columns: `U` of this front.
    pub(super) fn backward(&self, rhs: &[f64], solution: &mut [f64], local: &mut [f64]) {
        let local = &mut local[..self.eliminated];
        for (x, row) in local.iter_mut().zip(&self.rows) {
            *x = rhs[*row];
        }
        for k in self.eliminated..self.size() {
            subtract(local, solution[self.columns[k]], self.column(k));
        }
        for k in (0..self.eliminated).rev() {
            let x = local[k] * self.reciprocals[k];
            subtract(&mut local[..k], x, self.column(k));
            solution[self.columns[k]] = x;
        }
    }
}

/// Updates columns with the pivots of a panel: first the pivots' own rows with the panel's unit triangle,
/// then the rows below.
fn follow_columns<const C: usize>(
    columns: &mut [f64],
    stride: usize,
    pivots: std::ops::Range<usize>,
    triangle: &[[f64; PANEL]; PANEL],
    work: &Work,
) {
    let count = pivots.len();
    let mut upper = [[0.0; C]; PANEL];
    let mut any = false;
    for (c, column) in columns.chunks_exact_mut(stride).take(C).enumerate() {
        for (i, x) in column[pivots.clone()].iter_mut().enumerate() {
            let mut value = *x;
            for k in 0..i {
                value -= triangle[i][k] * upper[k][c];
            }
            upper[i][c] = value;
            any |= value != 0.0;
            *x = value;
        }
    }
    if !any {
        return;
    }
    let mut parts = columns.chunks_exact_mut(stride);
    let parts: [&mut [[f64; TILE]]; C] = std::array::from_fn(|_| {
        let column = parts.next().unwrap_or_default();
        column.as_chunks_mut::<TILE>().0
    });
    for (left, t) in work.packed.chunks_exact(count).zip(&work.tiles) {
        let t = *t;
        let mut sums: [[f64; TILE]; C] = std::array::from_fn(|c| parts[c][t]);
        for (l, u) in left.iter().zip(&upper) {
            for c in 0..C {
                for r in 0..TILE {
                    sums[c][r] -= l[r] * u[c];
                }
            }
        }
        for c in 0..C {
            parts[c][t] = sums[c];
        }
    }
}
