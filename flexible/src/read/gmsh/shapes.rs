//! Types of elements.

use crate::mesh::ElementKind;

/// The shape of an element type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Type {
    /// Dimension of its shape.
    pub dimension: u8,
    /// Number of nodes in the file.
    pub nodes: usize,
    /// The kind, if Eng has one of this shape.
    pub kind: Option<ElementKind>,
}

/// Types that are no elements here, with dimension and number of nodes: points, lines, and those with nodes
/// inside or of higher order.
const OTHERS: &[(i32, u8, usize)] = &[
    (15, 0, 1),
    (1, 1, 2),
    (8, 1, 3),
    (26, 1, 4),
    (27, 1, 5),
    (28, 1, 6),
    (10, 2, 9),
    (20, 2, 9),
    (21, 2, 10),
    (22, 2, 12),
    (23, 2, 15),
    (24, 2, 15),
    (25, 2, 21),
    (12, 3, 27),
    (13, 3, 18),
    (14, 3, 14),
    (29, 3, 20),
    (30, 3, 35),
    (31, 3, 56),
    (92, 3, 64),
    (93, 3, 125),
];

impl Type {
    /// The type with a number; `None` if the number is unknown.
    pub fn of(number: i32) -> Option<Type> {
        if let Some(kind) = ElementKind::of_gmsh(number) {
            return Some(Type {
                dimension: kind.dimension(),
                nodes: kind.node_count(),
                kind: Some(kind),
            });
        }
        let (_, dimension, nodes) = OTHERS.iter().find(|(known, ..)| *known == number)?;
        Some(Type {
            dimension: *dimension,
            nodes: *nodes,
            kind: None,
        })
    }
}
