//! Triangles and tetrahedra, in the barycentric coordinates 1 − r − s (− t), r, s (, t).

use super::{Description, ElementKind, Names, Shape, no_points, quadrature};

/// The tetrahedron of four nodes.
pub(super) const TETRAHEDRON4: Description = Description {
    nodes: 4,
    corners: 4,
    dimension: 3,
    linear: ElementKind::Tetrahedron4,
    edges: &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
    faces: &[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]],
    simplices: &[&[0, 1, 2, 3]],
    corner_edges: (
        &[[1, 2, 3], [2, 0, 3], [0, 1, 3], [1, 0, 2]],
        std::f64::consts::SQRT_2,
    ),
    centre: [0.25; 3],
    shape: |shape, at| linear(shape, at, 3),
    stiffness: quadrature::tetrahedron_1,
    reduced: quadrature::tetrahedron_1,
    // degree 2
    mass: || quadrature::tetrahedron(2),
    mass_of_abaqus: || quadrature::tetrahedron(2),
    names: Names {
        nastran: &["CTETRA"],
        abaqus: &["C3D4"],
        gmsh: Some(4),
        universal: Some(111),
        med: Some("TE4"),
        med_order: Some(&[0, 2, 1, 3]),
        ..Names::NONE
    },
};

/// The tetrahedron of ten nodes.
pub(super) const TETRAHEDRON10: Description = Description {
    nodes: 10,
    shape: |shape, at| quadratic(shape, at, 3, TETRAHEDRON4.edges),
    stiffness: quadrature::tetrahedron_4,
    reduced: quadrature::tetrahedron_4,
    // degree 7
    mass: || quadrature::tetrahedron(4),
    mass_of_abaqus: || quadrature::tetrahedron(4),
    names: Names {
        nastran: &["CTETRA"],
        abaqus: &["C3D10"],
        gmsh: Some(11),
        gmsh_order: Some(&[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        universal: Some(118),
        // the nodes around the bottom with those of its edges, the edges to the apex, the apex
        universal_order: Some(&[0, 2, 4, 9, 1, 3, 5, 6, 7, 8]),
        med: Some("T10"),
        med_order: Some(&[0, 2, 1, 3, 6, 5, 4, 7, 9, 8]),
        ..Names::NONE
    },
    ..TETRAHEDRON4
};

/// The triangle of three nodes.
pub(super) const TRIANGLE3: Description = Description {
    nodes: 3,
    corners: 3,
    dimension: 2,
    linear: ElementKind::Triangle3,
    edges: &[[0, 1], [1, 2], [2, 0]],
    faces: &[&[0, 1, 2]],
    simplices: &[&[0, 1, 2]],
    corner_edges: (&[], 1.0),
    centre: [1.0 / 3.0, 1.0 / 3.0, 0.0],
    shape: |shape, at| linear(shape, at, 2),
    stiffness: no_points,
    reduced: no_points,
    mass: || quadrature::triangle(2),
    mass_of_abaqus: || quadrature::triangle(2),
    names: Names {
        nastran: &["CTRIA3", "CTRIAR"],
        abaqus: &["S3", "S3R", "S3RS", "STRI3"],
        abaqus_facets: &["3", "3T"],
        gmsh: Some(2),
        med: Some("TR3"),
        ..Names::NONE
    },
};

/// The triangle of six nodes.
pub(super) const TRIANGLE6: Description = Description {
    nodes: 6,
    shape: |shape, at| quadratic(shape, at, 2, TRIANGLE3.edges),
    mass: || quadrature::triangle(4),
    mass_of_abaqus: || quadrature::triangle(4),
    names: Names {
        nastran: &["CTRIA6"],
        abaqus: &["S6", "STRI65"],
        abaqus_facets: &["6", "6M"],
        gmsh: Some(9),
        med: Some("TR6"),
        ..Names::NONE
    },
    ..TRIANGLE3
};

/// Barycentric coordinates and their slopes.
fn barycentric(point: [f64; 3], dimension: usize) -> ([f64; 4], [[f64; 3]; 4]) {
    let mut value = [1.0, 0.0, 0.0, 0.0];
    let mut slope = [[0.0; 3]; 4];
    for i in 0..dimension {
        value[0] -= point[i];
        value[i + 1] = point[i];
        slope[0][i] = -1.0;
        slope[i + 1][i] = 1.0;
    }
    (value, slope)
}

/// N = L.
fn linear(shape: &mut Shape, point: [f64; 3], dimension: usize) {
    let (value, slope) = barycentric(point, dimension);
    shape.values[..=dimension].copy_from_slice(&value[..=dimension]);
    shape.slopes[..=dimension].copy_from_slice(&slope[..=dimension]);
}

/// Corners L (2L − 1), edges 4 L_a L_b.
fn quadratic(shape: &mut Shape, point: [f64; 3], dimension: usize, edges: &[[usize; 2]]) {
    let (value, slope) = barycentric(point, dimension);
    for node in 0..=dimension {
        shape.values[node] = value[node] * (2.0 * value[node] - 1.0);
        shape.slopes[node] = slope[node].map(|s| s * (4.0 * value[node] - 1.0));
    }
    for (k, &[a, b]) in edges.iter().enumerate() {
        let node = dimension + 1 + k;
        shape.values[node] = 4.0 * value[a] * value[b];
        shape.slopes[node] =
            [0, 1, 2].map(|i: usize| 4.0 * (slope[a][i] * value[b] + value[a] * slope[b][i]));
    }
}
