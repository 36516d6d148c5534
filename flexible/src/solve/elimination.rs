//! The elimination tree of an order, and the cost of a factor in that order.

use super::graph::{Graph, NONE};

/// An order with its tree worked out.
#[derive(Clone, Debug)]
pub(crate) struct Elimination {
    /// The order, children of the tree right before their parents (an equivalent order that keeps supernodes
    /// together).
    pub(crate) order: Vec<u32>,
    /// Entries of the triangular factor, with the diagonal.
    pub(crate) entries: f64,
    /// Multiplications of the factorisation.
    pub(crate) operations: f64,
}

/// Works out the elimination tree (Liu, The role of elimination trees in sparse factorization, SIAM J. Matrix
/// Anal. Appl. 11, 1990), the number of entries of each column of the factor by walking the rows' subtrees,
/// and a postorder. `order` lists the vertices as they are eliminated.
pub(crate) fn eliminate(graph: &Graph, order: &[u32]) -> Elimination {
    let count = graph.vertices();
    let mut place = vec![0u32; count];
    for (index, &vertex) in order.iter().enumerate() {
        place[vertex as usize] = index as u32;
    }
    let mut parent = vec![NONE; count];
    let mut ancestor = vec![NONE; count];
    for (index, &vertex) in order.iter().enumerate() {
        for &other in graph.neighbours(vertex as usize) {
            let mut walk = place[other as usize];
            while (walk as usize) < index {
                let next = ancestor[walk as usize];
                ancestor[walk as usize] = index as u32;
                if next == NONE {
                    parent[walk as usize] = index as u32;
                    break;
                }
                walk = next;
            }
        }
    }
    // rows below the vertex's own in its columns
    let mut below = vec![0u64; count];
    let mut seen = vec![NONE; count];
    for (index, &vertex) in order.iter().enumerate() {
        seen[index] = index as u32;
        for &other in graph.neighbours(vertex as usize) {
            let mut walk = place[other as usize] as usize;
            while walk < index && seen[walk] != index as u32 {
                seen[walk] = index as u32;
                below[walk] += u64::from(graph.weight[vertex as usize]);
                walk = parent[walk] as usize;
            }
        }
    }
    let (mut entries, mut operations) = (0.0, 0.0);
    for (index, &vertex) in order.iter().enumerate() {
        for own in 1..=u64::from(graph.weight[vertex as usize]) {
            let length = (below[index] + own) as f64;
            entries += length;
            operations += length * length;
        }
    }
    Elimination {
        order: postorder(&parent)
            .into_iter()
            .map(|index| order[index as usize])
            .collect(),
        entries,
        operations,
    }
}

/// Vertices of a forest, each after its children; children in their order.
fn postorder(parent: &[u32]) -> Vec<u32> {
    let mut first_child = vec![NONE; parent.len()];
    let mut sibling = vec![NONE; parent.len()];
    for index in (0..parent.len()).rev() {
        let above = parent[index];
        if above != NONE {
            sibling[index] = first_child[above as usize];
            first_child[above as usize] = index as u32;
        }
    }
    let mut order = Vec::with_capacity(parent.len());
    let mut stack = Vec::new();
    for (root, _) in parent
        .iter()
        .enumerate()
        .filter(|(_, above)| **above == NONE)
    {
        stack.push(root as u32);
        while let Some(&top) = stack.last() {
            let child = first_child[top as usize];
            if child == NONE {
                order.push(top);
                stack.pop();
            } else {
                first_child[top as usize] = sibling[child as usize];
                stack.push(child);
            }
        }
    }
    order
}
