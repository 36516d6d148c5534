//! Types of elements, and their order of nodes.

use crate::mesh::ElementKind;

/// What an element of a type is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Type {
    /// Dimension of its shape.
    pub dimension: u8,
    /// Number of nodes in the file.
    pub nodes: usize,
    /// For a volume that can be read: its kind, and which of the file's nodes come where the mesh's order differs.
    pub volume: Option<(ElementKind, Option<&'static [usize]>)>,
}

const TETRAHEDRON10: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8];
const WEDGE15: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11];
const PYRAMID13: &[usize] = &[0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12];
const HEXAHEDRON20: &[usize] = &[
    0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15,
];

impl Type {
    /// The type of a number; `None` where it isn't known.
    pub fn of(number: i32) -> Option<Type> {
        use ElementKind::*;
        let (dimension, nodes, volume) = match number {
            15 => (0, 1, None),
            1 => (1, 2, None),
            8 => (1, 3, None),
            26 => (1, 4, None),
            27 => (1, 5, None),
            28 => (1, 6, None),
            2 => (2, 3, None),
            3 => (2, 4, None),
            9 => (2, 6, None),
            10 => (2, 9, None),
            16 => (2, 8, None),
            20 => (2, 9, None),
            21 => (2, 10, None),
            22 => (2, 12, None),
            23 => (2, 15, None),
            24 => (2, 15, None),
            25 => (2, 21, None),
            4 => (3, 4, Some((Tetrahedron4, None))),
            5 => (3, 8, Some((Hexahedron8, None))),
            6 => (3, 6, Some((Wedge6, None))),
            7 => (3, 5, Some((Pyramid5, None))),
            11 => (3, 10, Some((Tetrahedron10, Some(TETRAHEDRON10)))),
            17 => (3, 20, Some((Hexahedron20, Some(HEXAHEDRON20)))),
            18 => (3, 15, Some((Wedge15, Some(WEDGE15)))),
            19 => (3, 13, Some((Pyramid13, Some(PYRAMID13)))),
            12 => (3, 27, None),
            13 => (3, 18, None),
            14 => (3, 14, None),
            29 => (3, 20, None),
            30 => (3, 35, None),
            31 => (3, 56, None),
            92 => (3, 64, None),
            93 => (3, 125, None),
            _ => return None,
        };
        Some(Type {
            dimension,
            nodes,
            volume,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::faces::edges;

    /// Edges of gmsh's second-order volumes in the order of their mid-side nodes (gmsh reference manual, Node ordering).
    #[test]
    fn middle_nodes_belong_to_their_edges() {
        let orders: [(i32, &[[usize; 2]]); 4] = [
            (11, &[[0, 1], [1, 2], [2, 0], [3, 0], [2, 3], [1, 3]]),
            (
                17,
                &[
                    [0, 1],
                    [0, 3],
                    [0, 4],
                    [1, 2],
                    [1, 5],
                    [2, 3],
                    [2, 6],
                    [3, 7],
                    [4, 5],
                    [4, 7],
                    [5, 6],
                    [6, 7],
                ],
            ),
            (
                18,
                &[
                    [0, 1],
                    [0, 2],
                    [0, 3],
                    [1, 2],
                    [1, 4],
                    [2, 5],
                    [3, 4],
                    [3, 5],
                    [4, 5],
                ],
            ),
            (
                19,
                &[
                    [0, 1],
                    [0, 3],
                    [0, 4],
                    [1, 2],
                    [1, 4],
                    [2, 3],
                    [2, 4],
                    [3, 4],
                ],
            ),
        ];
        for (number, gmsh) in orders {
            let (kind, order) = Type::of(number).and_then(|t| t.volume).unwrap();
            let order = order.unwrap();
            let corners = kind.corner_count();
            assert_eq!(order.len(), kind.node_count());
            for (place, edge) in edges(kind).iter().enumerate() {
                let [a, b] = gmsh[order[corners + place] - corners];
                assert!(*edge == [a, b] || *edge == [b, a], "{kind:?} {place}");
            }
        }
    }

    #[test]
    fn kinds_have_the_nodes_of_their_types() {
        for number in -1..200 {
            if let Some(Type {
                nodes,
                volume: Some((kind, _)),
                dimension,
            }) = Type::of(number)
            {
                assert_eq!((kind.node_count(), dimension), (nodes, 3));
            }
        }
    }
}
