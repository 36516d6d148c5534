//! The pairs of nodes that share an entry of the matrices, and the places of their blocks. The layout of a
//! matrix is known before its numbers are computed.

use super::freedoms::FreedomMap;
use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;

/// Neighbours of each node with a greater index, ascending.
pub(super) struct Pattern {
    start: Vec<usize>,
    neighbour: Vec<u32>,
    /// Number of freedoms of a node's neighbours before this neighbour.
    before: Vec<u32>,
}

impl Pattern {
    /// Makes the pattern from groups of coupled nodes. `nodes` has the nodes of all groups, `group_start` the
    /// start of each group and the end.
    pub(super) fn new(freedoms: &FreedomMap, group_start: &[usize], nodes: &[u32]) -> Self {
        let count = freedoms.all_nodes();
        // groups of each node
        let mut first = vec![0usize; count + 1];
        for &node in nodes {
            first[node as usize + 1] += 1;
        }
        for node in 0..count {
            first[node + 1] += first[node];
        }
        let mut place = first.clone();
        let mut group = vec![0u32; nodes.len()];
        for (index, range) in group_start.windows(2).enumerate() {
            for &node in &nodes[range[0]..range[1]] {
                group[place[node as usize]] = index as u32;
                place[node as usize] += 1;
            }
        }
        drop(place);
        let (mut start, mut neighbour, mut before) = (vec![0], Vec::new(), Vec::new());
        let mut seen = vec![u32::MAX; count];
        for node in 0..count {
            let from = neighbour.len();
            for &index in &group[first[node]..first[node + 1]] {
                let range = group_start[index as usize]..group_start[index as usize + 1];
                for &other in &nodes[range] {
                    if other as usize > node && seen[other as usize] != node as u32 {
                        seen[other as usize] = node as u32;
                        neighbour.push(other);
                    }
                }
            }
            neighbour[from..].sort_unstable();
            let mut sum = 0;
            for &other in &neighbour[from..] {
                before.push(sum);
                sum += freedoms.of(other).len() as u32;
            }
            start.push(neighbour.len());
        }
        Pattern {
            start,
            neighbour,
            before,
        }
    }

    /// The place of a pair of nodes, `node` < `other`; `None` for nodes that are not coupled.
    pub(super) fn pair(&self, node: u32, other: u32) -> Option<Pair> {
        let range = self.start[node as usize]..self.start[node as usize + 1];
        let found = self.neighbour[range.clone()].binary_search(&other).ok()?;
        let place = range.start + found;
        Some(Pair {
            before: self.before[place] as usize,
            // each column begins with its diagonal entry
            entry: place + node as usize + 1,
        })
    }

    /// Index of the diagonal entry of a node in the node matrix; for the number of nodes, the number of
    /// entries.
    pub(super) fn diagonal(&self, node: u32) -> usize {
        self.start[node as usize] + node as usize
    }

    /// Columns and rows of the matrix over freedoms. The block of a pair of nodes is full and includes zeros.
    pub(super) fn freedom_layout(&self, freedoms: &FreedomMap) -> Layout {
        let mut column_start = Vec::with_capacity(freedoms.size() + 1);
        column_start.push(0usize);
        let mut total = 0;
        for node in 0..freedoms.all_nodes() {
            let own = freedoms.of(node as u32).len();
            let range = self.start[node]..self.start[node + 1];
            let others: usize = self.neighbour[range]
                .iter()
                .map(|&other| freedoms.of(other).len())
                .sum();
            for component in 0..own {
                total += own - component + others;
                column_start.push(total);
            }
        }
        let mut row = Vec::with_capacity(total);
        for node in 0..freedoms.all_nodes() {
            let own = freedoms.of(node as u32);
            let range = self.start[node]..self.start[node + 1];
            for component in own.clone() {
                row.extend((component..own.end).map(|freedom| freedom as u32));
                for &other in &self.neighbour[range.clone()] {
                    row.extend(freedoms.of(other).map(|freedom| freedom as u32));
                }
            }
        }
        Layout { column_start, row }
    }

    /// Columns and rows of the matrix over nodes.
    pub(super) fn node_layout(&self) -> Layout {
        let count = self.start.len() - 1;
        let column_start = (0..=count).map(|node| self.start[node] + node).collect();
        let mut row = Vec::with_capacity(self.neighbour.len() + count);
        for node in 0..count {
            row.push(node as u32);
            row.extend_from_slice(&self.neighbour[self.start[node]..self.start[node + 1]]);
        }
        Layout { column_start, row }
    }
}

/// The place of the block of two nodes.
#[derive(Clone, Copy)]
pub(super) struct Pair {
    /// Number of freedoms of the first node's neighbours before the second node. The rows of the second node
    /// start at this distance after those of the first.
    pub(super) before: usize,
    /// Index of the pair's entry in the node matrix.
    pub(super) entry: usize,
}

/// Columns and rows of a sparse matrix without values.
pub(super) struct Layout {
    pub(super) column_start: Vec<usize>,
    pub(super) row: Vec<u32>,
}

impl Layout {
    /// Index of the entry of two freedoms of either order.
    pub(super) fn entry(&self, a: usize, b: usize) -> Option<usize> {
        let (column, row) = (a.min(b), a.max(b) as u32);
        let range = self.column_start[column]..self.column_start[column + 1];
        let found = self.row[range.clone()].binary_search(&row).ok()?;
        Some(range.start + found)
    }

    pub(super) fn with(self, value: Vec<f64>) -> Result<SymmetricMatrix, FlexibleError> {
        let size = self.column_start.len() - 1;
        SymmetricMatrix::from_parts(size, self.column_start, self.row, value)
    }
}
