//! Wedges: a triangle in r, s times a line in t.

use super::Shape;

pub(super) const CORNERS: [[f64; 3]; 6] = [
    [0.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
];

const SLOPES: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];

fn barycentric(point: [f64; 3]) -> [f64; 3] {
    [1.0 - point[0] - point[1], point[0], point[1]]
}

/// L (1 ± t)/2.
pub(super) fn linear(shape: &mut Shape, point: [f64; 3]) {
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

/// Corners L (2L − 1)(1 ± t)/2 − L (1 − t²)/2; edges of the triangles 2 L_a L_b (1 ± t); vertical edges L (1 − t²)
/// (Zienkiewicz and Taylor, The Finite Element Method, vol. 1).
pub(super) fn quadratic(shape: &mut Shape, point: [f64; 3]) {
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
