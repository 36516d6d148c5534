//! Linear systems with a fixed pattern.
//!
//! [`BlockLu`] eliminates small groups of bodies with their multipliers first, each in a dense block of its
//! own, along a tree that is found once from the pattern ([`dissection`]). [`SparseLu`] is a general
//! factorisation and the fallback.

mod blocks;
pub mod dissection;
mod front;
mod probe;
mod runs;
mod sparse;

pub use blocks::BlockLu;
pub use runs::Runs;
pub use sparse::SparseLu;

use std::collections::{BTreeMap, BTreeSet};

/// Columns of a sparse square matrix with sorted rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    /// Beginning of each column, and the end.
    columns: Vec<usize>,
    /// Row of each entry.
    rows: Vec<usize>,
}

/// A block of a pattern: the entry where each of its columns begins; its rows follow each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Entry of the first row, one a column.
    starts: Vec<usize>,
}

impl Block {
    /// Adds `factor` times a row-major block.
    pub fn add(&self, values: &mut [f64], block: &[f64], factor: f64) {
        let width = self.starts.len();
        if width == 0 {
            return;
        }
        for (i, row) in block.chunks_exact(width).enumerate() {
            for (start, x) in self.starts.iter().zip(row) {
                values[start + i] += factor * x;
            }
        }
    }

    /// Adds `factor` times the transpose of a row-major block, whose rows are as long as this block is high.
    pub fn add_transposed(&self, values: &mut [f64], block: &[f64], factor: f64) {
        let Some(height) = block.len().checked_div(self.starts.len()) else {
            return;
        };
        for (start, row) in self.starts.iter().zip(block.chunks_exact(height.max(1))) {
            for (value, x) in values[*start..*start + height].iter_mut().zip(row) {
                *value += factor * x;
            }
        }
    }
}

/// Collects blocks.
#[derive(Clone, Debug, Default)]
pub struct PatternBuilder {
    columns: Vec<BTreeSet<usize>>,
}

impl PatternBuilder {
    /// An empty square pattern with its diagonal.
    pub fn new(size: usize) -> PatternBuilder {
        PatternBuilder {
            columns: (0..size).map(|i| BTreeSet::from([i])).collect(),
        }
    }
    /// Reserves a block.
    pub fn reserve(&mut self, rows: std::ops::Range<usize>, columns: std::ops::Range<usize>) {
        for column in columns {
            self.columns[column].extend(rows.clone());
        }
    }
    /// The pattern.
    pub fn finish(self) -> Pattern {
        let mut columns = vec![0];
        let mut rows = Vec::new();
        for column in &self.columns {
            rows.extend(column.iter().copied());
            columns.push(rows.len());
        }
        Pattern { columns, rows }
    }
}

impl Pattern {
    /// Number of rows, and of columns.
    pub fn size(&self) -> usize {
        self.columns.len() - 1
    }

    /// Number of entries.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// Rows of the entries of a column, rising.
    pub fn rows_of(&self, column: usize) -> &[usize] {
        &self.rows[self.columns[column]..self.columns[column + 1]]
    }

    /// The place of an entry that the pattern has.
    pub fn place(&self, row: usize, column: usize) -> usize {
        self.columns[column] + self.rows_of(column).partition_point(|r| *r < row)
    }

    /// The places of a reserved block whose first row is `row`.
    pub fn block(&self, row: usize, columns: std::ops::Range<usize>) -> Block {
        let starts = columns.map(|column| self.place(row, column)).collect();
        Block { starts }
    }

    /// Place, row and column of each entry.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let columns = self.columns.windows(2).enumerate();
        columns.flat_map(move |(column, ends)| {
            (ends[0]..ends[1]).map(move |place| (place, self.rows[place], column))
        })
    }

    /// Row, column and value of each place.
    pub fn entries<'a>(
        &'a self,
        values: &'a [f64],
    ) -> impl Iterator<Item = (usize, usize, f64)> + 'a {
        self.places()
            .filter_map(|(place, row, column)| Some((row, column, *values.get(place)?)))
    }

    /// `out = A x`.
    pub fn multiply(&self, values: &[f64], x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (place, row, column) in self.places() {
            out[row] += values[place] * x[column];
        }
    }
}

/// Places that several elements share, found once.
#[derive(Clone, Debug, Default)]
pub struct BlockTable {
    blocks: Vec<Block>,
    index: BTreeMap<(usize, usize, usize), usize>,
}

impl BlockTable {
    /// Index of the block at a row and a column range.
    pub fn find(
        &mut self,
        pattern: &Pattern,
        row: usize,
        columns: std::ops::Range<usize>,
    ) -> usize {
        let key = (row, columns.start, columns.end);
        if let Some(index) = self.index.get(&key) {
            return *index;
        }
        self.blocks.push(pattern.block(row, columns));
        self.index.insert(key, self.blocks.len() - 1);
        self.blocks.len() - 1
    }
    /// A block by its index.
    pub fn get(&self, index: usize) -> &Block {
        &self.blocks[index]
    }
}

/// A matrix cannot be factored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LinearError {
    /// A pivot vanishes, or the factors grow until rounding dominates.
    #[error("the matrix is singular")]
    Singular,
    /// The pattern is too large for memory.
    #[error("the matrix is too large")]
    TooLarge,
}

/// Solves with matrices of one pattern.
pub trait LinearSolver: Send + std::fmt::Debug {
    /// Factors the values of the pattern.
    fn factor(&mut self, values: &[f64]) -> Result<(), LinearError>;
    /// Overwrites the right-hand side by the solution, with the last factors; by numbers that are not finite
    /// where there are none.
    fn solve(&mut self, rhs: &mut [f64]);
    /// Factorisations so far that another method had to take over.
    fn fallbacks(&self) -> u64 {
        0
    }
}
