//! Shape functions and their derivatives in the reference domains of [`super::quadrature`].
//!
//! Nodes are in the order of [`ElementKind`]. Shape functions sum to one, each is one at its node and zero at the others, and
//! they hold all linear functions exactly.

mod hexahedron;
mod pyramid;
mod simplex;
mod wedge;

use crate::mesh::ElementKind;
use crate::read::faces;

/// The most nodes an element has.
pub const MOST_NODES: usize = 20;

/// Shape functions at a point: one entry a node of the element, zero behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Values (–).
    pub values: [f64; MOST_NODES],
    /// Derivatives in the reference coordinates (–); for a pyramid in ξ, η, ζ, not in the collapsed ones.
    pub slopes: [[f64; 3]; MOST_NODES],
}

impl Shape {
    fn zero() -> Self {
        Shape {
            values: [0.0; MOST_NODES],
            slopes: [[0.0; 3]; MOST_NODES],
        }
    }

    /// The functions of an element of this kind at a point of its reference domain (a pyramid's in collapsed coordinates). A
    /// beam has none here: the result is zero.
    pub fn at(kind: ElementKind, point: [f64; 3]) -> Self {
        let mut shape = Shape::zero();
        match kind {
            ElementKind::Tetrahedron4 => simplex::linear(&mut shape, point, 3),
            ElementKind::Tetrahedron10 => simplex::quadratic(&mut shape, point, 3, edges(kind)),
            ElementKind::Triangle3 => simplex::linear(&mut shape, point, 2),
            ElementKind::Triangle6 => simplex::quadratic(&mut shape, point, 2, edges(kind)),
            ElementKind::Hexahedron8 => hexahedron::linear(&mut shape, point, 3),
            ElementKind::Hexahedron20 => hexahedron::quadratic(&mut shape, point, 3, edges(kind)),
            ElementKind::Quadrilateral4 => hexahedron::linear(&mut shape, point, 2),
            ElementKind::Quadrilateral8 => hexahedron::quadratic(&mut shape, point, 2, edges(kind)),
            ElementKind::Wedge6 => wedge::linear(&mut shape, point),
            ElementKind::Wedge15 => wedge::quadratic(&mut shape, point),
            ElementKind::Pyramid5 => pyramid::linear(&mut shape, point),
            ElementKind::Pyramid13 => pyramid::quadratic(&mut shape, point),
            ElementKind::Beam2 => {}
        }
        shape
    }

    /// Removes a mid-side node: the edge becomes straight and linear, as half of the removed function goes to each of the
    /// edge's corners. What remains still sums to one and holds linear functions, for the removed node's place is then the mean
    /// of its corners'.
    pub fn remove_midside(&mut self, kind: ElementKind, local: usize) {
        let Some(edge) = local
            .checked_sub(kind.corner_count())
            .and_then(|k| edges(kind).get(k))
        else {
            return;
        };
        let (value, slope) = (self.values[local], self.slopes[local]);
        for &corner in edge {
            self.values[corner] += 0.5 * value;
            for (sum, s) in self.slopes[corner].iter_mut().zip(slope) {
                *sum += 0.5 * s;
            }
        }
        self.values[local] = 0.0;
        self.slopes[local] = [0.0; 3];
    }
}

/// The corners of each mid-side node of a quadratic element, in the order of its mid-side nodes; none for a linear one.
pub fn edges(kind: ElementKind) -> &'static [[usize; 2]] {
    if linear(kind) == kind {
        &[]
    } else {
        faces::edges(kind)
    }
}

/// The element with the same corners and no mid-side nodes.
pub fn linear(kind: ElementKind) -> ElementKind {
    match kind {
        ElementKind::Tetrahedron10 => ElementKind::Tetrahedron4,
        ElementKind::Hexahedron20 => ElementKind::Hexahedron8,
        ElementKind::Wedge15 => ElementKind::Wedge6,
        ElementKind::Pyramid13 => ElementKind::Pyramid5,
        ElementKind::Triangle6 => ElementKind::Triangle3,
        ElementKind::Quadrilateral8 => ElementKind::Quadrilateral4,
        other => other,
    }
}

/// Whether the element has a volume.
pub fn is_solid(kind: ElementKind) -> bool {
    matches!(
        kind,
        ElementKind::Tetrahedron4
            | ElementKind::Tetrahedron10
            | ElementKind::Hexahedron8
            | ElementKind::Hexahedron20
            | ElementKind::Wedge6
            | ElementKind::Wedge15
            | ElementKind::Pyramid5
            | ElementKind::Pyramid13
    )
}

/// Places of the corners in the reference domain (a pyramid's in collapsed coordinates, its apex on the axis).
fn corners(kind: ElementKind) -> &'static [[f64; 3]] {
    match linear(kind) {
        ElementKind::Tetrahedron4 => &simplex::CORNERS,
        ElementKind::Triangle3 => &simplex::CORNERS[..3],
        ElementKind::Hexahedron8 => &hexahedron::CORNERS,
        ElementKind::Quadrilateral4 => &QUADRILATERAL_CORNERS,
        ElementKind::Wedge6 => &wedge::CORNERS,
        ElementKind::Pyramid5 => &pyramid::CORNERS,
        _ => &[],
    }
}

const QUADRILATERAL_CORNERS: [[f64; 3]; 4] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

/// Places of an element's nodes in its reference domain (a pyramid's in collapsed coordinates).
pub fn node_places(kind: ElementKind) -> Vec<[f64; 3]> {
    let corners = corners(kind);
    let mut places = corners.to_vec();
    for &[a, b] in edges(kind) {
        let mut middle = [0.0; 3];
        for (i, x) in middle.iter_mut().enumerate() {
            *x = 0.5 * (corners[a][i] + corners[b][i]);
        }
        if linear(kind) == ElementKind::Pyramid5 && b == 4 {
            // half-way to the apex the collapsed coordinates still are the corner's
            middle = [corners[a][0], corners[a][1], 0.5];
        }
        places.push(middle);
    }
    places
}

#[cfg(test)]
mod tests;
