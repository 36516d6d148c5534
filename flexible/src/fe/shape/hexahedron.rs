//! Hexahedra and quadrilaterals: tensor products, and the serendipity family.

use super::Shape;

/// Corners of the hexahedron; the first four have the signs of the quadrilateral's.
pub(super) const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Product of a factor an axis, and its slopes, from each factor's value and slope.
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
pub(super) fn linear(shape: &mut Shape, point: [f64; 3], dimension: usize) {
    for (node, corner) in CORNERS.iter().take(1 << dimension).enumerate() {
        let mut factors = [(1.0, 0.0); 3];
        for axis in 0..dimension {
            factors[axis] = (0.5 * (1.0 + point[axis] * corner[axis]), 0.5 * corner[axis]);
        }
        (shape.values[node], shape.slopes[node]) = product(&factors[..dimension]);
    }
}

/// Corners ∏ (1 + ξ ξᵢ)/2 · (Σ ξ ξᵢ − d + 1) in d dimensions; an edge's node has (1 − ξ²) along its edge and (1 + ξ ξᵢ)/2
/// across.
pub(super) fn quadratic(
    shape: &mut Shape,
    point: [f64; 3],
    dimension: usize,
    edges: &[[usize; 2]],
) {
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
