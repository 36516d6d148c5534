//! Hexahedra and quadrilaterals: tensor products, and the serendipity family.

use super::{Description, ElementKind, Names, Shape, no_points, quadrature};

/// The hexahedron of eight nodes.
pub(super) const HEXAHEDRON8: Description = Description {
    nodes: 8,
    corners: 8,
    dimension: 3,
    linear: ElementKind::Hexahedron8,
    edges: &[
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
    faces: &[
        &[0, 1, 2, 3],
        &[4, 7, 6, 5],
        &[0, 4, 5, 1],
        &[1, 5, 6, 2],
        &[2, 6, 7, 3],
        &[3, 7, 4, 0],
    ],
    simplices: &[
        &[0, 1, 2, 6],
        &[0, 2, 3, 6],
        &[0, 3, 7, 6],
        &[0, 7, 4, 6],
        &[0, 4, 5, 6],
        &[0, 5, 1, 6],
    ],
    corner_edges: (
        &[
            [1, 3, 4],
            [2, 0, 5],
            [3, 1, 6],
            [0, 2, 7],
            [7, 5, 0],
            [4, 6, 1],
            [5, 7, 2],
            [6, 4, 3],
        ],
        1.0,
    ),
    centre: [0.0; 3],
    shape: |shape, at| linear(shape, at, 3),
    stiffness: || quadrature::hexahedron(2),
    reduced: || quadrature::hexahedron(2),
    // degree 4 a coordinate
    mass: || quadrature::hexahedron(3),
    mass_of_abaqus: || quadrature::hexahedron(3),
    names: Names {
        nastran: &["CHEXA"],
        abaqus: &["C3D8"],
        gmsh: Some(5),
        universal: Some(115),
        med: Some("HE8"),
        med_order: Some(&[0, 3, 2, 1, 4, 7, 6, 5]),
        ..Names::NONE
    },
};

/// The hexahedron of twenty nodes.
pub(super) const HEXAHEDRON20: Description = Description {
    nodes: 20,
    shape: |shape, at| quadratic(shape, at, 3, HEXAHEDRON8.edges),
    stiffness: || quadrature::hexahedron(3),
    reduced: || quadrature::hexahedron(2),
    // degree 9 a coordinate
    mass: || quadrature::hexahedron(5),
    mass_of_abaqus: || quadrature::hexahedron(3),
    names: Names {
        nastran: &["CHEXA"],
        // the vertical edges before those of the top
        nastran_order: Some(&[
            0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15,
        ]),
        abaqus: &["C3D20"],
        gmsh: Some(17),
        gmsh_order: Some(&[
            0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15,
        ]),
        universal: Some(116),
        // the nodes around the bottom with those of its edges, the vertical edges, the nodes around the top
        universal_order: Some(&[
            0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11,
        ]),
        med: Some("H20"),
        med_order: Some(&[
            0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17,
        ]),
        ..Names::NONE
    },
    ..HEXAHEDRON8
};

/// The quadrilateral of four nodes.
pub(super) const QUADRILATERAL4: Description = Description {
    nodes: 4,
    corners: 4,
    dimension: 2,
    linear: ElementKind::Quadrilateral4,
    edges: &[[0, 1], [1, 2], [2, 3], [3, 0]],
    faces: &[&[0, 1, 2, 3]],
    simplices: &[&[0, 1, 2], &[0, 2, 3]],
    corner_edges: (&[], 1.0),
    centre: [0.0; 3],
    shape: |shape, at| linear(shape, at, 2),
    stiffness: no_points,
    reduced: no_points,
    mass: || quadrature::quadrilateral(3),
    mass_of_abaqus: || quadrature::quadrilateral(3),
    names: Names {
        nastran: &["CQUAD4", "CQUADR"],
        abaqus: &["S4", "S4R", "S4RS", "S4RSW", "S4R5"],
        abaqus_facets: &["4", "4R", "4I"],
        gmsh: Some(3),
        med: Some("QU4"),
        ..Names::NONE
    },
};

/// The quadrilateral of eight nodes.
pub(super) const QUADRILATERAL8: Description = Description {
    nodes: 8,
    shape: |shape, at| quadratic(shape, at, 2, QUADRILATERAL4.edges),
    mass: || quadrature::quadrilateral(5),
    mass_of_abaqus: || quadrature::quadrilateral(5),
    names: Names {
        nastran: &["CQUAD8"],
        abaqus: &["S8", "S8R", "S8R5"],
        abaqus_facets: &["8", "8R"],
        gmsh: Some(16),
        med: Some("QU8"),
        ..Names::NONE
    },
    ..QUADRILATERAL4
};

/// Corners of the hexahedron; the first four have the signs of the quadrilateral's.
const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// The product of one factor for each axis, and its slopes, from the value and slope of each
/// factor.
fn product(factors: &[(f64, f64)]) -> (f64, [f64; 3]) {
    let mut value = 1.0;
    let mut slope = [0.0; 3];
    for (axis, &(factor, factor_slope)) in factors.iter().enumerate() {
        for s in slope.iter_mut().take(axis) {
            *s *= factor;
        }
        slope[axis] = value * factor_slope;
        value *= factor;
    }
    (value, slope)
}

/// ∏ (1 + ξ ξᵢ)/2 over the axes.
fn linear(shape: &mut Shape, point: [f64; 3], dimension: usize) {
    for (node, corner) in CORNERS.iter().take(1 << dimension).enumerate() {
        let mut factors = [(1.0, 0.0); 3];
        for axis in 0..dimension {
            factors[axis] = (0.5 * (1.0 + point[axis] * corner[axis]), 0.5 * corner[axis]);
        }
        (shape.values[node], shape.slopes[node]) = product(&factors[..dimension]);
    }
}

/// Corners ∏ (1 + ξ ξᵢ)/2 · (Σ ξ ξᵢ − d + 1) in d dimensions; an edge's node has (1 − ξ²) along its edge and
/// (1 + ξ ξᵢ)/2 across.
fn quadratic(shape: &mut Shape, point: [f64; 3], dimension: usize, edges: &[[usize; 2]]) {
    linear(shape, point, dimension);
    let corner_count = 1 << dimension;
    for (node, corner) in CORNERS.iter().take(corner_count).enumerate() {
        let mut sum = 1.0 - dimension as f64;
        for (x, sign) in point.iter().zip(corner).take(dimension) {
            sum += x * sign;
        }
        let value = shape.values[node];
        for (slope, sign) in shape.slopes[node].iter_mut().zip(corner).take(dimension) {
            *slope = *slope * sum + value * sign;
        }
        shape.values[node] = value * sum;
    }
    for (k, &[a, b]) in edges.iter().enumerate() {
        let mut factors = [(1.0, 0.0); 3];
        for axis in 0..dimension {
            let (x, first, second) = (point[axis], CORNERS[a][axis], CORNERS[b][axis]);
            factors[axis] = if first == second {
                (0.5 * (1.0 + x * first), 0.5 * first)
            } else {
                (1.0 - x * x, -2.0 * x)
            };
        }
        (
            shape.values[corner_count + k],
            shape.slopes[corner_count + k],
        ) = product(&factors[..dimension]);
    }
}
