//! Smaller graphs that resemble a graph: matched vertices become one.

use super::graph::{Graph, NONE};
use super::random::Random;

/// A graph of about half the vertices, and the vertex of it that each vertex became. Vertices are matched
/// over their heaviest edge, few-neighboured ones first (Karypis, Kumar: A fast and high quality multilevel
/// scheme for partitioning irregular graphs, SIAM J. Sci. Comput. 20, 1998). No vertex of it weighs more than
/// `heaviest`, unless it did before.
pub(crate) fn coarsen(graph: &Graph, heaviest: u32, random: &mut Random) -> (Graph, Vec<u32>) {
    let count = graph.vertices();
    let mut partner = vec![NONE; count];
    for vertex in visiting_order(graph, random) {
        if partner[vertex as usize] != NONE {
            continue;
        }
        let own = graph.weight[vertex as usize];
        let mut best = (0u32, vertex);
        for (other, weight) in graph.edges(vertex as usize) {
            if weight > best.0
                && partner[other as usize] == NONE
                && own.saturating_add(graph.weight[other as usize]) <= heaviest
            {
                best = (weight, other);
            }
        }
        partner[vertex as usize] = best.1;
        partner[best.1 as usize] = vertex;
    }
    let mut coarse = vec![NONE; count];
    let mut pairs = Vec::with_capacity(count / 2 + 1);
    for vertex in 0..count as u32 {
        if coarse[vertex as usize] == NONE {
            let other = partner[vertex as usize];
            coarse[vertex as usize] = pairs.len() as u32;
            coarse[other as usize] = pairs.len() as u32;
            pairs.push((vertex, other));
        }
    }
    (contract(graph, &pairs, &coarse), coarse)
}

/// By number of neighbours, at random among equals; beyond the mean number all count as equal.
fn visiting_order(graph: &Graph, random: &mut Random) -> Vec<u32> {
    let count = graph.vertices();
    let cap = graph.neighbour.len() / count.max(1) + 1;
    let mut shuffled: Vec<u32> = (0..count as u32).collect();
    random.shuffle(&mut shuffled);
    let degree = |vertex: u32| graph.neighbours(vertex as usize).len().min(cap);
    let mut first = vec![0usize; cap + 2];
    for &vertex in &shuffled {
        first[degree(vertex) + 1] += 1;
    }
    for index in 0..=cap {
        first[index + 1] += first[index];
    }
    let mut order = vec![0u32; count];
    for &vertex in &shuffled {
        let slot = &mut first[degree(vertex)];
        order[*slot] = vertex;
        *slot += 1;
    }
    order
}

/// The graph with each pair made one vertex; parallel edges add up.
fn contract(graph: &Graph, pairs: &[(u32, u32)], coarse: &[u32]) -> Graph {
    let mut small = Graph {
        start: Vec::with_capacity(pairs.len() + 1),
        neighbour: Vec::with_capacity(graph.neighbour.len() / 2),
        edge_weight: Vec::with_capacity(graph.neighbour.len() / 2),
        weight: Vec::with_capacity(pairs.len()),
    };
    small.start.push(0);
    // index of the edge to each vertex, while the edges of one vertex are collected
    let mut slot = vec![usize::MAX; pairs.len()];
    for (index, &(one, two)) in pairs.iter().enumerate() {
        let begin = small.neighbour.len();
        let mut weight = graph.weight[one as usize];
        let second = if one == two {
            None
        } else {
            weight += graph.weight[two as usize];
            Some(two)
        };
        for vertex in [Some(one), second].into_iter().flatten() {
            for (other, edge) in graph.edges(vertex as usize) {
                let other = coarse[other as usize];
                if other as usize == index {
                    continue;
                }
                let at = slot[other as usize];
                if at >= begin && at < small.neighbour.len() {
                    small.edge_weight[at] += edge;
                } else {
                    slot[other as usize] = small.neighbour.len();
                    small.neighbour.push(other);
                    small.edge_weight.push(edge);
                }
            }
        }
        small.start.push(small.neighbour.len());
        small.weight.push(weight);
    }
    small
}
