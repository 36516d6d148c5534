//! Nested dissection: separators last, parts first, each part the same way.

use super::graph::{Graph, NONE};
use super::ordering::minimum_degree_of;
use super::random::Random;
use super::separator::{SEPARATOR, Side, separate, separator_weight};
use crate::error::FlexibleError;

/// Parts of at most this many vertices are ordered by minimum degree. A choice: a cut of a smaller part saves
/// less than its search takes.
const LEAF: usize = 220;
/// Parts of at least this many vertices count as large. A choice: their separators are the largest fronts of the
/// elimination.
const LARGE: usize = 2000;
/// Cuts tried of a large part, and of a small one. The best of four and two instead of two and one takes 0.6 times longer
/// for a bulky part of 104,000 nodes, and saves 9 % of the multiplications and 4 % of the factor's entries.
const CUTS: [usize; 2] = [4, 2];

/// An order of the vertices.
///
/// # Errors
/// When memory runs out.
pub(crate) fn dissect(graph: &Graph) -> Result<Vec<u32>, FlexibleError> {
    let count = graph.vertices();
    let mut random = Random::new(count as u64);
    // a vertex with nearly all others as neighbours would hide every separator: it comes last
    // a choice: a node of a mesh has fewer neighbours than this, and a reference of a tie to a surface has
    // more
    let dense = (10.0 * (count as f64).sqrt()).max(64.0) as usize;
    let (sparse, last): (Vec<u32>, Vec<u32>) =
        (0..count as u32).partition(|&vertex| graph.neighbours(vertex as usize).len() <= dense);
    let mut order = Vec::with_capacity(count);
    if last.is_empty() {
        part(graph, &sparse, &mut random, &mut order)?;
    } else {
        let mut place = vec![NONE; count];
        for (index, &vertex) in sparse.iter().enumerate() {
            place[vertex as usize] = index as u32;
        }
        part(
            &graph.induced(&sparse, &place),
            &sparse,
            &mut random,
            &mut order,
        )?;
    }
    order.extend(last);
    Ok(order)
}

/// Appends the order of a part; `names` are its vertices' numbers in the whole graph.
fn part(
    graph: &Graph,
    names: &[u32],
    random: &mut Random,
    order: &mut Vec<u32>,
) -> Result<(), FlexibleError> {
    if let Some(side) = cut(graph, random) {
        let mut place = vec![NONE; names.len()];
        for half in [0, 1] {
            let mut chosen = Vec::new();
            place.fill(NONE);
            for (vertex, &side) in side.iter().enumerate() {
                if side == half {
                    place[vertex] = chosen.len() as u32;
                    chosen.push(vertex as u32);
                }
            }
            let inner: Vec<u32> = chosen
                .iter()
                .map(|&vertex| names[vertex as usize])
                .collect();
            part(&graph.induced(&chosen, &place), &inner, random, order)?;
        }
        order.extend(
            names
                .iter()
                .zip(&side)
                .filter(|(_, side)| **side == SEPARATOR)
                .map(|(&name, _)| name),
        );
    } else {
        let local = minimum_degree_of(graph)?;
        order.extend(local.into_iter().map(|vertex| names[vertex as usize]));
    }
    Ok(())
}

/// The sides, if cutting is worth while: both parts are there, and neither is nearly everything (so the
/// recursion ends soon).
fn cut(graph: &Graph, random: &mut Random) -> Option<Vec<Side>> {
    let count = graph.vertices();
    if count <= LEAF {
        return None;
    }
    let mut side = separate(graph, random);
    for _ in 1..CUTS[usize::from(count < LARGE)] {
        let other = separate(graph, random);
        if separator_weight(graph, &other) < separator_weight(graph, &side) {
            side = other;
        }
    }
    let size = |part: Side| side.iter().filter(|side| **side == part).count();
    let (zero, one) = (size(0), size(1));
    (zero > 0 && one > 0 && zero.max(one) * 10 <= count * 9).then_some(side)
}
