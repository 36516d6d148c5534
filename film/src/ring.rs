//! Block elimination of a ring of cells.
//!
//! The ring has columns of `across` cells. Each cell couples with its four neighbours, the last column with
//! the first. One column is the border; the others are a chain, in the order of the flow:
//!
//! ```text
//! L_t x_(t−1) + D_t x_t + U_t x_(t+1) + [W x_border]_t = r_t        D_t tridiagonal, L_t, U_t diagonal
//! Z x + D_b x_border = r_border
//! ```
//!
//! Elimination along the chain, with the inverses of whole blocks:
//!
//! ```text
//! S_t = D_t − L_t S_(t−1)⁻¹ U_(t−1)          W_t −= L_t V_(t−1)     V_t = S_t⁻¹ W_t
//! S_b = D_b − Σ Z_t V_t                      Z_t −= Z_(t−1) S_(t−1)⁻¹ U_(t−1)
//! ```
//!
//! W and Z hold only those cells of the border that couple with cells of the next columns. If the border has
//! no such cell, as in a cavity or an opening, the ring is open there. Cells that couple with no other cell,
//! such as those of a cavity without content, are rows of the identity. Their elimination is skipped.
//!
//! No pivots are exchanged. The matrix has a positive diagonal and no positive numbers beside it. It is weakly
//! diagonally dominant by columns. Beside edges (`edge.rs`), for equal cells and gaps, it is so after a division of
//! the first cells' rows by 3/2, which changes the sign of no pivot. Cells of a cavity that closes within a step are an exception; they fill in
//! the next round. An explicit inverse of such a block is as exact as its factors.

use crate::block::{add, add_lanes, apply, apply_transposed, invert, with_width};

/// Cells of the border that are eliminated together. A choice: four doubles fill a vector register.
const LANES: usize = 4;

/// Entries of a cell's row: its own, and those of its neighbours in the east, in the west, towards positive
/// and negative z.
pub type Row = [f64; 5];

/// Place of a cell's own entry in its row.
pub const OWN: usize = 0;
/// Place of the entry of the neighbour in the east, towards larger angles.
pub const EAST: usize = 1;
/// Place of the entry of the neighbour in the west.
pub const WEST: usize = 2;
/// Place of the entry of the neighbour towards positive z.
pub const HIGH: usize = 3;
/// Place of the entry of the neighbour towards negative z.
pub const LOW: usize = 4;

type Lanes = [f64; LANES];

/// Order of the columns.
#[derive(Clone, Copy, Debug)]
struct Chain {
    around: usize,
    border: usize,
    eastwards: bool,
}

impl Chain {
    /// The column at a place of the chain; the border is at its end.
    fn column(self, at: usize) -> usize {
        let steps = if self.eastwards {
            at + 1
        } else {
            self.around - 1 - at
        };
        let column = self.border + steps;
        if column < self.around {
            column
        } else {
            column - self.around
        }
    }

    /// Places in a `Row` of the neighbours before and behind in this order.
    fn neighbours(self) -> (usize, usize) {
        if self.eastwards {
            (WEST, EAST)
        } else {
            (EAST, WEST)
        }
    }
}

/// Matrix of a ring and, after [`RingMatrix::factor`], the inverses of its blocks.
#[derive(Clone, Debug)]
pub struct RingMatrix {
    /// Rows of the cells. The elimination does not read further rows.
    pub rows: Vec<Row>,
    chain: Chain,
    across: usize,
    /// Length of a block's row: `across`, rounded up to pairs.
    width: usize,
    symmetric: bool,
    /// Rows of the border that couple with their neighbours around.
    pub coupled: Vec<usize>,
    /// `S⁻ᵀ` of each column, `across × width`.
    inverses: Vec<f64>,
    /// `V` of each column: LANES cells of the border at a time, `across` rows each.
    right: Vec<Lanes>,
    /// `Zᵀ`, in the same form.
    below: Vec<Lanes>,
    /// Whether `V` and `Z` of each column have a number other than 0.
    filled: Vec<[bool; 2]>,
    /// W of a column, and `S⁻ᵀ Zᵀ` of the last one.
    wide: [Vec<Lanes>; 2],
    /// Rows of a block.
    lines: [Vec<f64>; 2],
    /// Numbers of the coupled cells of the border.
    ends: Vec<Lanes>,
}

fn any(lanes: &[Lanes]) -> bool {
    lanes.iter().any(|lanes| *lanes != [0.0; LANES])
}

impl RingMatrix {
    /// A matrix of zeros, with rows for `fixed` places after those of the cells. A ring has at least three
    /// columns: with two, both neighbours of a column would be the same one.
    pub fn new(around: usize, across: usize, fixed: usize) -> Self {
        let width = across.next_multiple_of(2);
        let chunks = across.div_ceil(LANES);
        let lanes = |count: usize| vec![[0.0; LANES]; count];
        RingMatrix {
            rows: vec![[0.0; 5]; around * across + fixed],
            chain: Chain {
                around,
                border: around - 1,
                eastwards: true,
            },
            across,
            width,
            symmetric: false,
            coupled: Vec::with_capacity(across),
            inverses: vec![0.0; around * across * width],
            right: lanes(around * chunks * across),
            below: lanes(around * chunks * across),
            filled: vec![[false; 2]; around],
            wide: [lanes(chunks * across), lanes(chunks * across)],
            lines: [vec![0.0; width], vec![0.0; width]],
            ends: lanes(chunks),
        }
    }

    /// Inverts the blocks. The border may be any column, and the chain may run in either direction. The
    /// fewest numbers fill if it runs with the flow, and if few cells of the border couple with the next
    /// columns.
    pub fn factor(&mut self, border: usize, eastwards: bool, symmetric: bool) {
        (self.chain.border, self.chain.eastwards) = (border, eastwards);
        self.symmetric = symmetric;
        let chain = self.chain;
        let (m, rows) = (self.across, &self.rows);
        let (first, last) = (chain.column(0), chain.column(chain.around - 2));
        let (before, behind) = chain.neighbours();
        self.coupled.clear();
        for row in 0..m {
            let own = &rows[border * m + row];
            let theirs = [rows[first * m + row][before], rows[last * m + row][behind]];
            if own[before] != 0.0 || own[behind] != 0.0 || theirs != [0.0; 2] {
                self.coupled.push(row);
            }
        }
        with_width!(self.width, |width| self.factor_chain(width));
    }

    #[inline(always)]
    fn factor_chain(&mut self, width: usize) {
        let chain = self.chain;
        let (m, end) = (self.across, chain.around - 1);
        self.open_block(end, width);
        for at in 0..end {
            self.open_block(at, width);
            if at > 0 {
                self.subtract_before(at, width);
            }
            let size = m * width;
            invert(
                &mut self.inverses[at * size..(at + 1) * size],
                width,
                &mut self.lines,
            );
            if !self.coupled.is_empty() {
                self.eliminate_border(at, width);
            }
        }
        let block = &mut self.inverses[end * m * width..];
        invert(block, width, &mut self.lines);
    }

    /// Writes `Dᵀ` of a column.
    #[inline(always)]
    fn open_block(&mut self, at: usize, width: usize) {
        let chain = self.chain;
        let (m, column) = (self.across, chain.column(at));
        let block = &mut self.inverses[at * m * width..(at + 1) * m * width];
        block.fill(0.0);
        for (row, numbers) in self.rows[column * m..(column + 1) * m].iter().enumerate() {
            block[row * width + row] = numbers[OWN];
            if row > 0 {
                block[(row - 1) * width + row] = numbers[LOW];
            }
            if row + 1 < m {
                block[(row + 1) * width + row] = numbers[HIGH];
            }
        }
    }

    /// Subtracts `(L S⁻¹ U)ᵀ` of the column before.
    #[inline(always)]
    fn subtract_before(&mut self, at: usize, width: usize) {
        let chain = self.chain;
        let (m, size) = (self.across, self.across * width);
        let (own, earlier) = (chain.column(at) * m, chain.column(at - 1) * m);
        let (before, behind) = chain.neighbours();
        for (number, row) in self.lines[0].iter_mut().zip(&self.rows[own..own + m]) {
            *number = row[before];
        }
        let (done, rest) = self.inverses.split_at_mut(at * size);
        let inverse = done[(at - 1) * size..].chunks_exact(width);
        let line = &self.lines[0][..width];
        for ((row, inverse), numbers) in rest[..size]
            .chunks_exact_mut(width)
            .zip(inverse)
            .zip(&self.rows[earlier..earlier + m])
        {
            let factor = numbers[behind];
            if factor == 0.0 {
                continue;
            }
            for ((number, inverse), before) in row.iter_mut().zip(inverse).zip(line) {
                *number -= factor * inverse * before;
            }
        }
    }

    /// W, Z and V of a column, and their part of the border's block.
    #[inline(always)]
    fn eliminate_border(&mut self, at: usize, width: usize) {
        let chain = self.chain;
        let (m, end) = (self.across, chain.around - 1);
        let (before, behind) = chain.neighbours();
        let (own, ring) = (chain.column(at) * m, chain.border * m);
        let chunks = self.coupled.len().div_ceil(LANES);
        let (here, size) = (at * chunks * m, chunks * m);
        let [wide, left] = &mut self.wide;
        let (wide, left) = (&mut wide[..size], &mut left[..size]);
        let (right_done, right_rest) = self.right.split_at_mut(here);
        let (right, below) = (&mut right_rest[..size], &mut self.below[here..here + size]);
        if at == 0 {
            wide.fill([0.0; LANES]);
            below.fill([0.0; LANES]);
        } else {
            let earlier = chain.column(at - 1) * m;
            let [any_right, any_below] = self.filled[at - 1];
            let last = &right_done[here - size..];
            for chunk in 0..chunks {
                for row in 0..m {
                    let place = chunk * m + row;
                    let factors = [
                        self.rows[own + row][before],
                        self.rows[earlier + row][behind],
                    ];
                    wide[place] = match any_right {
                        true => last[place].map(|number| -factors[0] * number),
                        false => [0.0; LANES],
                    };
                    below[place] = match any_below {
                        true => left[place].map(|number| -factors[1] * number),
                        false => [0.0; LANES],
                    };
                }
            }
        }
        for (number, row) in self.coupled.iter().enumerate() {
            let (place, lane) = (number / LANES * m + row, number % LANES);
            if at == 0 {
                wide[place][lane] += self.rows[own + row][before];
                below[place][lane] += self.rows[ring + row][behind];
            }
            if at + 1 == end {
                wide[place][lane] += self.rows[own + row][behind];
                below[place][lane] += self.rows[ring + row][before];
            }
        }
        let filled = [any(wide), any(below)];
        self.filled[at] = filled;
        let block = m * width;
        let (done, corner) = self.inverses.split_at_mut(end * block);
        let inverse = &done[at * block..(at + 1) * block];
        for chunk in 0..chunks {
            let part = chunk * m..(chunk + 1) * m;
            if filled[0] {
                apply(
                    inverse,
                    width,
                    &wide[part.clone()],
                    &mut right[part.clone()],
                );
            } else {
                right[part.clone()].fill([0.0; LANES]);
            }
            if filled[1] && self.symmetric {
                left[part.clone()].copy_from_slice(&right[part]);
            } else if filled[1] {
                apply_transposed(inverse, width, &below[part.clone()], &mut left[part]);
            }
        }
        if filled != [true; 2] {
            return;
        }
        for (one, columns) in self.coupled.chunks(LANES).enumerate() {
            for (other, rows) in self.coupled.chunks(LANES).enumerate() {
                let mut sums = [[0.0; LANES]; LANES];
                let pairs = right[one * m..(one + 1) * m]
                    .iter()
                    .zip(&below[other * m..]);
                for (right, below) in pairs {
                    for (sums, number) in sums.iter_mut().zip(right) {
                        add_lanes(sums, *number, below);
                    }
                }
                for (column, sums) in columns.iter().zip(&sums) {
                    for (row, sum) in rows.iter().zip(sums) {
                        corner[column * width + row] -= sum;
                    }
                }
            }
        }
    }

    /// Solves `A x = b`: `cells` holds b and then x.
    pub fn solve(&mut self, cells: &mut [f64]) {
        with_width!(self.width, |width| self.solve_one(width, cells));
    }

    /// Product of the inverse of a column with numbers, to the first line.
    #[inline(always)]
    fn apply_line(inverse: &[f64], width: usize, numbers: &[f64], line: &mut [f64]) {
        let line = &mut line[..width];
        line.fill(0.0);
        for (row, number) in inverse.chunks_exact(width).zip(numbers) {
            add(line, *number, row);
        }
    }

    #[inline(always)]
    fn solve_one(&mut self, width: usize, cells: &mut [f64]) {
        let chain = self.chain;
        let (m, end) = (self.across, chain.around - 1);
        let size = m * width;
        let (before, behind) = chain.neighbours();
        let chunks = self.coupled.len().div_ceil(LANES);
        let [line, sources] = &mut self.lines;
        self.ends.fill([0.0; LANES]);
        for at in 0..end {
            let own = chain.column(at) * m;
            if at > 0 {
                let earlier = chain.column(at - 1) * m;
                for row in 0..m {
                    cells[own + row] -= self.rows[own + row][before] * cells[earlier + row];
                }
            }
            let inverse = &self.inverses[at * size..(at + 1) * size];
            Self::apply_line(inverse, width, &cells[own..own + m], line);
            cells[own..own + m].copy_from_slice(&line[..m]);
            if self.filled[at][1] {
                for (chunk, sums) in self.ends[..chunks].iter_mut().enumerate() {
                    let first = (at * chunks + chunk) * m;
                    for (below, number) in self.below[first..first + m].iter().zip(&cells[own..]) {
                        add_lanes(sums, *number, below);
                    }
                }
            }
        }
        let ring = chain.border * m;
        for (number, row) in self.coupled.iter().enumerate() {
            cells[ring + row] -= self.ends[number / LANES][number % LANES];
        }
        let inverse = &self.inverses[end * size..];
        Self::apply_line(inverse, width, &cells[ring..ring + m], line);
        cells[ring..ring + m].copy_from_slice(&line[..m]);
        for (number, row) in self.coupled.iter().enumerate() {
            self.ends[number / LANES][number % LANES] = cells[ring + row];
        }
        for at in (0..end).rev() {
            let own = chain.column(at) * m;
            if at + 1 < end {
                let next = chain.column(at + 1) * m;
                for row in 0..m {
                    sources[row] = -self.rows[own + row][behind] * cells[next + row];
                }
                let inverse = &self.inverses[at * size..(at + 1) * size];
                Self::apply_line(inverse, width, &sources[..m], line);
                add(&mut cells[own..own + m], 1.0, &line[..m]);
            }
            if self.filled[at][0] {
                for (chunk, x) in self.ends[..chunks].iter().enumerate() {
                    let first = (at * chunks + chunk) * m;
                    let right = &self.right[first..first + m];
                    for (cell, right) in cells[own..own + m].iter_mut().zip(right) {
                        let parts: f64 = right.iter().zip(x).map(|(a, b)| a * b).sum();
                        *cell -= parts;
                    }
                }
            }
        }
    }

    /// Solves `Aᵀ x = b` of several right-hand sides: `cells` holds b and then x; `lanes` is memory for two columns.
    pub fn solve_transposed<const N: usize>(&self, cells: &mut [[f64; N]], lanes: &mut [[f64; N]]) {
        with_width!(self.width, |width| self.solve_lanes(width, cells, lanes));
    }

    #[inline(always)]
    fn solve_lanes<const N: usize>(
        &self,
        width: usize,
        cells: &mut [[f64; N]],
        lanes: &mut [[f64; N]],
    ) {
        let chain = self.chain;
        let (m, end) = (self.across, chain.around - 1);
        let size = m * width;
        let (before, behind) = chain.neighbours();
        let chunks = self.coupled.len().div_ceil(LANES);
        let ring = chain.border * m;
        let (lanes, sources) = lanes.split_at_mut(m);
        for at in 0..end {
            let own = chain.column(at) * m;
            if at > 0 {
                let earlier = chain.column(at - 1) * m;
                for row in 0..m {
                    let last = cells[earlier + row];
                    add_lanes(
                        &mut cells[own + row],
                        -self.rows[earlier + row][behind],
                        &last,
                    );
                }
            }
            if self.filled[at][0] {
                for (number, row) in self.coupled.iter().enumerate() {
                    let first = (at * chunks + number / LANES) * m;
                    let mut sums = [0.0; N];
                    for (right, cell) in self.right[first..first + m].iter().zip(&cells[own..]) {
                        add_lanes(&mut sums, right[number % LANES], cell);
                    }
                    add_lanes(&mut cells[ring + row], -1.0, &sums);
                }
            }
            let inverse = &self.inverses[at * size..(at + 1) * size];
            apply_transposed(inverse, width, &cells[own..own + m], lanes);
            cells[own..own + m].copy_from_slice(lanes);
        }
        let inverse = &self.inverses[end * size..];
        apply_transposed(inverse, width, &cells[ring..ring + m], lanes);
        cells[ring..ring + m].copy_from_slice(lanes);
        for at in (0..end).rev() {
            let own = chain.column(at) * m;
            sources.fill([0.0; N]);
            if at + 1 < end {
                let next = chain.column(at + 1) * m;
                for row in 0..m {
                    sources[row] =
                        cells[next + row].map(|number| -self.rows[next + row][before] * number);
                }
            }
            if self.filled[at][1] {
                for (number, row) in self.coupled.iter().enumerate() {
                    let first = (at * chunks + number / LANES) * m;
                    let x = cells[ring + row];
                    for (source, below) in sources.iter_mut().zip(&self.below[first..first + m]) {
                        add_lanes(source, -below[number % LANES], &x);
                    }
                }
            }
            let inverse = &self.inverses[at * size..(at + 1) * size];
            apply_transposed(inverse, width, sources, lanes);
            for (cell, lanes) in cells[own..own + m].iter_mut().zip(lanes.iter()) {
                add_lanes(cell, 1.0, lanes);
            }
        }
    }
}
