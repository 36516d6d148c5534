//! Triangles and tetrahedra, in the barycentric coordinates 1 − r − s (− t), r, s (, t).

use super::Shape;

/// Corners of the tetrahedron; the first three are the triangle's.
pub(super) const CORNERS: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
];

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
pub(super) fn linear(shape: &mut Shape, point: [f64; 3], dimension: usize) {
    let (value, slope) = barycentric(point, dimension);
    shape.values[..=dimension].copy_from_slice(&value[..=dimension]);
    shape.slopes[..=dimension].copy_from_slice(&slope[..=dimension]);
}

/// Corners L (2L − 1), edges 4 L_a L_b.
pub(super) fn quadratic(
    shape: &mut Shape,
    point: [f64; 3],
    dimension: usize,
    edges: &[[usize; 2]],
) {
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
