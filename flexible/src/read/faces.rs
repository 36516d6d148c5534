//! Edges and faces of elements, in the order of nodes of [`ElementKind`] and the order of faces of Abaqus.

use super::vector::{cross, minus, norm};
use crate::mesh::{ABSENT, ElementKind};

/// The corners of each edge, in the order of the mid-side nodes.
pub(crate) fn edges(kind: ElementKind) -> &'static [[usize; 2]] {
    use ElementKind::*;
    match kind {
        Beam2 => &[[0, 1]],
        Triangle3 | Triangle6 => &[[0, 1], [1, 2], [2, 0]],
        Quadrilateral4 | Quadrilateral8 => &[[0, 1], [1, 2], [2, 3], [3, 0]],
        Tetrahedron4 | Tetrahedron10 => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
        Pyramid5 | Pyramid13 => &[
            [0, 1],
            [1, 2],
            [2, 3],
            [3, 0],
            [0, 4],
            [1, 4],
            [2, 4],
            [3, 4],
        ],
        Wedge6 | Wedge15 => &[
            [0, 1],
            [1, 2],
            [2, 0],
            [3, 4],
            [4, 5],
            [5, 3],
            [0, 3],
            [1, 4],
            [2, 5],
        ],
        Hexahedron8 | Hexahedron20 => &[
            [0, 1],
            [1, 2],
            [2, 3],
            [3, 0],
            [4, 5],
            [5, 6],
            [6, 7],
            [7, 4],
            [0, 4],
            [1, 5],
            [2, 6],
            [3, 7],
        ],
    }
}

/// The corners of each face of a solid, in the order S1, S2, … of Abaqus; a shell is one face.
pub(crate) fn faces(kind: ElementKind) -> &'static [&'static [usize]] {
    use ElementKind::*;
    match kind {
        Beam2 => &[],
        Triangle3 | Triangle6 => &[&[0, 1, 2]],
        Quadrilateral4 | Quadrilateral8 => &[&[0, 1, 2, 3]],
        Tetrahedron4 | Tetrahedron10 => &[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]],
        Pyramid5 | Pyramid13 => &[
            &[0, 1, 2, 3],
            &[0, 4, 1],
            &[1, 4, 2],
            &[2, 4, 3],
            &[3, 4, 0],
        ],
        Wedge6 | Wedge15 => &[
            &[0, 1, 2],
            &[3, 5, 4],
            &[0, 3, 4, 1],
            &[1, 4, 5, 2],
            &[2, 5, 3, 0],
        ],
        Hexahedron8 | Hexahedron20 => &[
            &[0, 1, 2, 3],
            &[4, 7, 6, 5],
            &[0, 4, 5, 1],
            &[1, 5, 6, 2],
            &[2, 6, 7, 3],
            &[3, 7, 4, 0],
        ],
    }
}

/// Nodes of the edge or face with these corners: each corner, and after it the mid-side node between it and the next one where
/// there is one.
pub(crate) fn around(
    kind: ElementKind,
    nodes: &[u32],
    corners: &[usize],
) -> Vec<(u32, Option<u32>)> {
    let middle = |a: usize, b: usize| {
        let edge = edges(kind)
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

/// The area [length²] that each node of a face stands for. The face is cut into facets between neighbouring nodes (a triangle at
/// each corner between mid-side nodes, and what they leave), and a facet's area shared equally among its nodes: positive for every
/// node, and exact in sum for a flat face with straight edges.
pub(super) fn shares(
    ring: &[(u32, Option<u32>)],
    place: impl Fn(u32) -> [f64; 3],
) -> Vec<(u32, f64)> {
    let mut shares = Vec::new();
    let mut inner = Vec::new();
    let mut before = ring.last().and_then(|(_, middle)| *middle);
    for (corner, middle) in ring {
        match (before, *middle) {
            (Some(before), Some(after)) => share(&[before, *corner, after], &place, &mut shares),
            _ => inner.push(*corner),
        }
        inner.extend(*middle);
        before = *middle;
    }
    share(&inner, &place, &mut shares);
    shares
}

/// Shares the area of a polygon equally among its corners.
fn share(polygon: &[u32], place: impl Fn(u32) -> [f64; 3], shares: &mut Vec<(u32, f64)>) {
    let Some((first, rest)) = polygon.split_first() else {
        return;
    };
    let origin = place(*first);
    let mut twice = [0.0; 3];
    for pair in rest.windows(2) {
        if let [a, b] = *pair {
            let normal = cross(minus(place(a), origin), minus(place(b), origin));
            for (sum, value) in twice.iter_mut().zip(normal) {
                *sum += value;
            }
        }
    }
    let each = 0.5 * norm(twice) / polygon.len() as f64;
    shares.extend(polygon.iter().map(|node| (*node, each)));
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [ElementKind; 12] = [
        ElementKind::Triangle3,
        ElementKind::Triangle6,
        ElementKind::Quadrilateral4,
        ElementKind::Quadrilateral8,
        ElementKind::Tetrahedron4,
        ElementKind::Tetrahedron10,
        ElementKind::Pyramid5,
        ElementKind::Pyramid13,
        ElementKind::Wedge6,
        ElementKind::Wedge15,
        ElementKind::Hexahedron8,
        ElementKind::Hexahedron20,
    ];

    #[test]
    fn every_edge_of_a_solid_is_on_two_faces_in_opposite_directions() {
        for kind in ALL {
            let mut directed = Vec::new();
            for face in faces(kind) {
                for (a, b) in face.iter().zip(face.iter().cycle().skip(1)) {
                    directed.push((*a, *b));
                }
            }
            let sides = if faces(kind).len() == 1 { 1 } else { 2 };
            assert_eq!(directed.len(), sides * edges(kind).len(), "{kind:?}");
            for edge in edges(kind) {
                let there = directed.contains(&(edge[0], edge[1]));
                let back = directed.contains(&(edge[1], edge[0]));
                assert!(if sides == 2 {
                    there && back
                } else {
                    there != back
                });
            }
            let middle = kind.node_count() - kind.corner_count();
            assert!(middle == 0 || middle == edges(kind).len());
        }
    }

    #[test]
    fn shares_of_a_square_of_eight_nodes() {
        let places = [
            [0.0, 0.0, 1.0],
            [2.0, 0.0, 1.0],
            [2.0, 2.0, 1.0],
            [0.0, 2.0, 1.0],
            [1.0, 0.0, 1.0],
            [2.0, 1.0, 1.0],
            [1.0, 2.0, 1.0],
            [0.0, 1.0, 1.0],
        ];
        let nodes = [0, 1, 2, 3, 4, 5, 6, 7];
        let ring = around(ElementKind::Quadrilateral8, &nodes, &[0, 1, 2, 3]);
        let mut sums = [0.0; 8];
        for (node, share) in shares(&ring, |node| places[node as usize]) {
            sums[node as usize] += share;
        }
        // corner triangles of 1/2, inner square of 2
        for (node, sum) in sums.iter().enumerate() {
            let expected: f64 = if node < 4 { 1.0 / 6.0 } else { 0.5 + 2.0 / 6.0 };
            assert!((sum - expected).abs() < 1e-15, "{node}: {sum}");
        }
    }
}
