//! Pyramids: rational in ξ, η, ζ, but polynomials in the collapsed coordinates x = ξ/d, y = η/d, d = 1 − ζ,
//! in which they are written here; so nothing divides by zero at the apex. The functions are G. Bedrosian's
//! (Int. J. Numer. Meth. Eng. 35, 1992, pp. 95–108).
//!
//! Every function but the apex's has a factor d: N = d g(x, y, d), and by the chain rule
//! ∂N/∂ξ = g_x, ∂N/∂η = g_y, ∂N/∂ζ = −g − d g_d + x g_x + y g_y.

use super::{Description, ElementKind, Names, Shape, quadrature};

/// The pyramid of five nodes.
pub(super) const PYRAMID5: Description = Description {
    nodes: 5,
    corners: 5,
    dimension: 3,
    linear: ElementKind::Pyramid5,
    edges: &[
        [0, 1],
        [1, 2],
        [2, 3],
        [3, 0],
        [0, 4],
        [1, 4],
        [2, 4],
        [3, 4],
    ],
    faces: &[
        &[0, 1, 2, 3],
        &[0, 4, 1],
        &[1, 4, 2],
        &[2, 4, 3],
        &[3, 4, 0],
    ],
    simplices: &[&[0, 1, 2, 4], &[0, 2, 3, 4]],
    // four edges meet at the apex
    corner_edges: (
        &[[1, 3, 4], [2, 0, 4], [3, 1, 4], [0, 2, 4]],
        std::f64::consts::SQRT_2,
    ),
    centre: [0.0, 0.0, 0.25],
    shape: linear,
    stiffness: || quadrature::pyramid(2),
    reduced: || quadrature::pyramid(2),
    // degree 4 in the collapsed coordinates
    mass: || quadrature::pyramid(3),
    mass_of_abaqus: || quadrature::pyramid(3),
    names: Names {
        nastran: &["CPYRAM", "CPYRA"],
        abaqus: &["C3D5"],
        gmsh: Some(7),
        med: Some("PY5"),
        med_order: Some(&[0, 3, 2, 1, 4]),
        ..Names::NONE
    },
};

/// The pyramid of thirteen nodes.
pub(super) const PYRAMID13: Description = Description {
    nodes: 13,
    shape: quadratic,
    stiffness: || quadrature::pyramid(3),
    reduced: || quadrature::pyramid(3),
    // degree 9 in the collapsed coordinates
    mass: || quadrature::pyramid(5),
    mass_of_abaqus: || quadrature::pyramid(3),
    names: Names {
        nastran: &["CPYRAM", "CPYRA"],
        abaqus: &["C3D13"],
        gmsh: Some(19),
        gmsh_order: Some(&[0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12]),
        med: Some("P13"),
        med_order: Some(&[0, 3, 2, 1, 4, 8, 7, 6, 5, 9, 12, 11, 10]),
        ..Names::NONE
    },
    ..PYRAMID5
};

/// Corners in collapsed coordinates x, y, ζ; the apex on the axis.
const CORNERS: [[f64; 3]; 5] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
];

/// g and its derivatives in x, y, d.
struct Factor {
    g: f64,
    x: f64,
    y: f64,
    d: f64,
}

fn put(shape: &mut Shape, node: usize, [x, y, z]: [f64; 3], factor: &Factor) {
    let d = 1.0 - z;
    shape.values[node] = d * factor.g;
    shape.slopes[node] = [
        factor.x,
        factor.y,
        -factor.g - d * factor.d + x * factor.x + y * factor.y,
    ];
}

/// Base corners d (1 ± x)(1 ± y)/4, apex ζ.
fn linear(shape: &mut Shape, point: [f64; 3]) {
    let [x, y, z] = point;
    for (node, corner) in CORNERS.iter().take(4).enumerate() {
        let (a, b) = (1.0 + corner[0] * x, 1.0 + corner[1] * y);
        let factor = Factor {
            g: 0.25 * a * b,
            x: 0.25 * corner[0] * b,
            y: 0.25 * a * corner[1],
            d: 0.0,
        };
        put(shape, node, point, &factor);
    }
    shape.values[4] = z;
    shape.slopes[4] = [0.0, 0.0, 1.0];
}

/// Base corners d (1 ± x)(1 ± y)(±ξ ± η − 1)/4, base edges d² (1 − x²)(1 ± y)/2, edges to the apex ζ d (1 ±
/// x)(1 ± y), apex ζ (2ζ − 1).
fn quadratic(shape: &mut Shape, point: [f64; 3]) {
    let [x, y, z] = point;
    let d = 1.0 - z;
    for (node, corner) in CORNERS.iter().take(4).enumerate() {
        let [sx, sy, _] = *corner;
        let (a, b) = (1.0 + sx * x, 1.0 + sy * y);
        let slant = sx * x + sy * y;
        let rest = d * slant - 1.0;
        put(
            shape,
            node,
            point,
            &Factor {
                g: 0.25 * a * b * rest,
                x: 0.25 * sx * b * (rest + a * d),
                y: 0.25 * sy * a * (rest + b * d),
                d: 0.25 * a * b * slant,
            },
        );
        put(
            shape,
            9 + node,
            point,
            &Factor {
                g: z * a * b,
                x: z * sx * b,
                y: z * a * sy,
                d: -a * b,
            },
        );
    }
    for (edge, along_x, sign) in [
        (5, true, -1.0),
        (6, false, 1.0),
        (7, true, 1.0),
        (8, false, -1.0),
    ] {
        let (along, across) = if along_x { (x, y) } else { (y, x) };
        let (bubble, side) = (1.0 - along * along, 1.0 + sign * across);
        let slope_along = -d * along * side;
        let slope_across = 0.5 * d * bubble * sign;
        let (gx, gy) = if along_x {
            (slope_along, slope_across)
        } else {
            (slope_across, slope_along)
        };
        put(
            shape,
            edge,
            point,
            &Factor {
                g: 0.5 * d * bubble * side,
                x: gx,
                y: gy,
                d: 0.5 * bubble * side,
            },
        );
    }
    shape.values[4] = z * (2.0 * z - 1.0);
    shape.slopes[4] = [0.0, 0.0, 4.0 * z - 1.0];
}
