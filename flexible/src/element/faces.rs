//! The nodes around a face.

use super::ElementKind;

/// The index of an absent mid-side node: its edge is straight and linear.
pub const ABSENT: u32 = u32::MAX;

/// Nodes of the edge or face with these corners: each corner, and after it the mid-side node between it and
/// the next one if there is one.
pub(crate) fn around(
    kind: ElementKind,
    nodes: &[u32],
    corners: &[usize],
) -> Vec<(u32, Option<u32>)> {
    let middle = |a: usize, b: usize| {
        let edges = kind.description().edges;
        let edge = edges
            .iter()
            .position(|edge| *edge == [a, b] || *edge == [b, a])?;
        let node = nodes.get(kind.corner_count() + edge).copied()?;
        (node != ABSENT).then_some(node)
    };
    let next = corners.iter().cycle().skip(1);
    corners
        .iter()
        .zip(next)
        .filter_map(|(a, b)| Some((nodes.get(*a).copied()?, middle(*a, *b))))
        .collect()
}

/// Flat facets of a face: a triangle at each corner between mid-side nodes, and the polygon of all other nodes.
pub(crate) fn facets(ring: &[(u32, Option<u32>)]) -> Vec<Vec<u32>> {
    let mut facets = Vec::new();
    let mut inner = Vec::new();
    let mut before = ring.last().and_then(|(_, middle)| *middle);
    for (corner, middle) in ring {
        match (before, *middle) {
            (Some(before), Some(after)) => facets.push(vec![before, *corner, after]),
            _ => inner.push(*corner),
        }
        inner.extend(*middle);
        before = *middle;
    }
    facets.push(inner);
    facets
}
