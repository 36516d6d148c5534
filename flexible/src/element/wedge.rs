//! Wedges: a triangle in r, s times a line in t.

use super::{Description, ElementKind, Names, Shape, TRIANGLE, quadrature};

/// The wedge of six nodes.
pub(super) const WEDGE6: Description = Description {
    nodes: 6,
    corners: 6,
    dimension: 3,
    linear: ElementKind::Wedge6,
    edges: &[
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
    faces: &[
        &[0, 1, 2],
        &[3, 5, 4],
        &[0, 3, 4, 1],
        &[1, 4, 5, 2],
        &[2, 5, 3, 0],
    ],
    simplices: &[&[0, 1, 2, 3], &[1, 2, 3, 4], &[2, 3, 4, 5]],
    corner_edges: (
        &[
            [1, 2, 3],
            [2, 0, 4],
            [0, 1, 5],
            [5, 4, 0],
            [3, 5, 1],
            [4, 3, 2],
        ],
        TRIANGLE,
    ),
    centre: [1.0 / 3.0, 1.0 / 3.0, 0.0],
    shape: linear,
    stiffness: || quadrature::wedge(&quadrature::triangle_3(), 2),
    reduced: || quadrature::wedge(&quadrature::triangle_1(), 2),
    // degree 4 at most
    mass: || quadrature::wedge(&quadrature::triangle(3), 3),
    mass_of_abaqus: || quadrature::wedge(&quadrature::triangle(3), 3),
    names: Names {
        nastran: &["CPENTA"],
        abaqus: &["C3D6"],
        gmsh: Some(6),
        universal: Some(112),
        med: Some("PE6"),
        med_order: Some(&[0, 2, 1, 3, 5, 4]),
        ..Names::NONE
    },
};

/// The wedge of fifteen nodes.
pub(super) const WEDGE15: Description = Description {
    nodes: 15,
    shape: quadratic,
    stiffness: || quadrature::wedge(&quadrature::triangle_3(), 3),
    reduced: || quadrature::wedge(&quadrature::triangle_3(), 3),
    // degree 9 at most
    mass: || quadrature::wedge(&quadrature::triangle(5), 5),
    mass_of_abaqus: || quadrature::wedge(&quadrature::triangle_3(), 3),
    names: Names {
        nastran: &["CPENTA"],
        // the vertical edges before those of the top
        nastran_order: Some(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11]),
        abaqus: &["C3D15"],
        gmsh: Some(18),
        gmsh_order: Some(&[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11]),
        universal: Some(113),
        // the nodes around the bottom with those of its edges, the vertical edges, the nodes around the top
        universal_order: Some(&[0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8]),
        med: Some("P15"),
        med_order: Some(&[0, 2, 1, 3, 5, 4, 8, 7, 6, 11, 10, 9, 12, 14, 13]),
        ..Names::NONE
    },
    ..WEDGE6
};

const SLOPES: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];

fn barycentric(point: [f64; 3]) -> [f64; 3] {
    [1.0 - point[0] - point[1], point[0], point[1]]
}

/// L (1 ± t)/2.
fn linear(shape: &mut Shape, point: [f64; 3]) {
    let area = barycentric(point);
    let t = point[2];
    for i in 0..3 {
        for (layer, sign) in [-1.0, 1.0].into_iter().enumerate() {
            let node = 3 * layer + i;
            let along = 0.5 * (1.0 + sign * t);
            shape.values[node] = area[i] * along;
            shape.slopes[node] = [
                SLOPES[i][0] * along,
                SLOPES[i][1] * along,
                area[i] * 0.5 * sign,
            ];
        }
    }
}

/// Corners L (2L − 1)(1 ± t)/2 − L (1 − t²)/2; edges of the triangles 2 L_a L_b (1 ± t); vertical edges L (1
/// − t²) (Zienkiewicz and Taylor, The Finite Element Method, vol. 1).
fn quadratic(shape: &mut Shape, point: [f64; 3]) {
    let area = barycentric(point);
    let t = point[2];
    let (bubble, bubble_slope) = (1.0 - t * t, -2.0 * t);
    for i in 0..3 {
        let next = (i + 1) % 3;
        for (layer, sign) in [-1.0, 1.0].into_iter().enumerate() {
            let along = 0.5 * (1.0 + sign * t);
            let corner = 3 * layer + i;
            let plane = area[i] * (2.0 * area[i] - 1.0);
            let plane_slope = 4.0 * area[i] - 1.0;
            shape.values[corner] = plane * along - 0.5 * area[i] * bubble;
            let across = plane_slope * along - 0.5 * bubble;
            shape.slopes[corner] = [
                SLOPES[i][0] * across,
                SLOPES[i][1] * across,
                plane * 0.5 * sign - 0.5 * area[i] * bubble_slope,
            ];
            let edge = 6 + 3 * layer + i;
            let pair = 4.0 * area[i] * area[next];
            shape.values[edge] = pair * along;
            let across = |axis: usize| {
                4.0 * (SLOPES[i][axis] * area[next] + area[i] * SLOPES[next][axis]) * along
            };
            shape.slopes[edge] = [across(0), across(1), pair * 0.5 * sign];
        }
        let vertical = 12 + i;
        shape.values[vertical] = area[i] * bubble;
        shape.slopes[vertical] = [
            SLOPES[i][0] * bubble,
            SLOPES[i][1] * bubble,
            area[i] * bubble_slope,
        ];
    }
}
