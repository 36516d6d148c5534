//! The graph of a symmetric matrix. Rows with the same pattern share a vertex.

use super::random::mix;
use crate::sparse::SymmetricMatrix;

/// No vertex.
pub(crate) const NONE: u32 = u32::MAX;

/// An undirected graph. Each edge is listed at both ends, and no edge joins a vertex to itself.
#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    /// Start of the neighbours of each vertex, and the end of the last ones.
    pub(crate) start: Vec<usize>,
    pub(crate) neighbour: Vec<u32>,
    /// Number of edges of the finest graph that an edge represents.
    pub(crate) edge_weight: Vec<u32>,
    /// Number of rows of the matrix that a vertex represents.
    pub(crate) weight: Vec<u32>,
}

impl Graph {
    pub(crate) fn vertices(&self) -> usize {
        self.weight.len()
    }

    pub(crate) fn total_weight(&self) -> i64 {
        self.weight.iter().map(|&weight| i64::from(weight)).sum()
    }

    pub(crate) fn neighbours(&self, vertex: usize) -> &[u32] {
        &self.neighbour[self.start[vertex]..self.start[vertex + 1]]
    }

    /// Neighbours with the weights of the edges.
    pub(crate) fn edges(&self, vertex: usize) -> impl Iterator<Item = (u32, u32)> + '_ {
        let range = self.start[vertex]..self.start[vertex + 1];
        self.neighbour[range.clone()]
            .iter()
            .copied()
            .zip(self.edge_weight[range].iter().copied())
    }

    /// The graph of the `chosen` vertices. `place` gives each vertex its new number, ascending in the order
    /// of `chosen`, and [`NONE`] to the others.
    pub(crate) fn induced(&self, chosen: &[u32], place: &[u32]) -> Graph {
        let mut part = Graph {
            start: Vec::with_capacity(chosen.len() + 1),
            weight: Vec::with_capacity(chosen.len()),
            ..Graph::default()
        };
        part.start.push(0);
        for &vertex in chosen {
            let vertex = vertex as usize;
            for (other, weight) in self.edges(vertex) {
                if place[other as usize] != NONE {
                    part.neighbour.push(place[other as usize]);
                    part.edge_weight.push(weight);
                }
            }
            part.start.push(part.neighbour.len());
            part.weight.push(self.weight[vertex]);
        }
        part
    }
}

/// Groups of rows of a matrix, one for each vertex. The rows of a group have entries in the same columns. So
/// the three or six freedoms of a node share a vertex, whatever their numbers.
#[derive(Clone, Debug)]
pub(crate) struct Compressed {
    pub(crate) graph: Graph,
    /// Start of each vertex's rows in `member`, and the end of the last ones.
    pub(crate) first: Vec<usize>,
    pub(crate) member: Vec<u32>,
}

impl Compressed {
    /// Compares the columns by a 64-bit hash of their rows. A collision would only add fill; the result stays
    /// correct.
    pub(crate) fn new(matrix: &SymmetricMatrix) -> Compressed {
        let size = matrix.size();
        let code: Vec<u64> = (1..=size as u64).map(mix).collect();
        let mut hash = code.clone();
        for column in 0..size {
            let own = code[column];
            let mut sum = 0u64;
            for &row in matrix.column(column).0 {
                let row = row as usize;
                if row != column {
                    sum = sum.wrapping_add(code[row]);
                    hash[row] = hash[row].wrapping_add(own);
                }
            }
            hash[column] = hash[column].wrapping_add(sum);
        }
        let mut by_hash: Vec<(u64, u32)> = hash.iter().copied().zip(0..).collect();
        by_hash.sort_unstable();
        // the vertex of each group's first row; vertices are numbered in the order of these rows
        let mut leader = vec![0u32; size];
        for group in by_hash.chunk_by(|one, two| one.0 == two.0) {
            for &(_, row) in group {
                leader[row as usize] = group[0].1;
            }
        }
        let mut vertex = vec![NONE; size];
        let mut first = vec![0usize];
        let mut leaders = Vec::new();
        for row in 0..size {
            if leader[row] as usize == row {
                vertex[row] = leaders.len() as u32;
                leaders.push(row as u32);
                first.push(0);
            }
        }
        for &row in &leader {
            first[vertex[row as usize] as usize + 1] += 1;
        }
        for index in 0..leaders.len() {
            first[index + 1] += first[index];
        }
        let mut place = first.clone();
        let mut member = vec![0u32; size];
        for (row, &lead) in leader.iter().enumerate() {
            let slot = &mut place[vertex[lead as usize] as usize];
            member[*slot] = row as u32;
            *slot += 1;
        }
        let graph = quotient(matrix, &leaders, &vertex, &first);
        Compressed {
            graph,
            first,
            member,
        }
    }

    /// The order of the rows for an order of the vertices.
    pub(crate) fn expand(&self, order: &[u32]) -> Vec<u32> {
        let mut rows = Vec::with_capacity(self.member.len());
        for &vertex in order {
            let vertex = vertex as usize;
            rows.extend_from_slice(&self.member[self.first[vertex]..self.first[vertex + 1]]);
        }
        rows
    }
}

/// The graph of the leading rows.
fn quotient(matrix: &SymmetricMatrix, leaders: &[u32], vertex: &[u32], first: &[usize]) -> Graph {
    let mut start = vec![0usize; leaders.len() + 1];
    let lead_pairs = |found: &mut dyn FnMut(usize, usize)| {
        for (one, &column) in leaders.iter().enumerate() {
            for &row in matrix.column(column as usize).0 {
                let two = vertex[row as usize];
                if row != column && two != NONE {
                    found(one, two as usize);
                }
            }
        }
    };
    lead_pairs(&mut |one, two| {
        start[one + 1] += 1;
        start[two + 1] += 1;
    });
    for index in 0..leaders.len() {
        start[index + 1] += start[index];
    }
    let mut place = start.clone();
    let mut neighbour = vec![0u32; start[leaders.len()]];
    lead_pairs(&mut |one, two| {
        neighbour[place[one]] = two as u32;
        place[one] += 1;
        neighbour[place[two]] = one as u32;
        place[two] += 1;
    });
    Graph {
        edge_weight: vec![1; neighbour.len()],
        weight: first
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) as u32)
            .collect(),
        start,
        neighbour,
    }
}
