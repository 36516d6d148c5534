use super::*;

const KINDS: [ElementKind; 12] = [
    ElementKind::Tetrahedron4,
    ElementKind::Tetrahedron10,
    ElementKind::Hexahedron8,
    ElementKind::Hexahedron20,
    ElementKind::Wedge6,
    ElementKind::Wedge15,
    ElementKind::Pyramid5,
    ElementKind::Pyramid13,
    ElementKind::Triangle3,
    ElementKind::Triangle6,
    ElementKind::Quadrilateral4,
    ElementKind::Quadrilateral8,
];

fn is_pyramid(kind: ElementKind) -> bool {
    linear(kind) == ElementKind::Pyramid5
}

/// From the coordinates a rule uses to ξ, η, ζ.
fn opened(kind: ElementKind, [x, y, z]: [f64; 3]) -> [f64; 3] {
    if is_pyramid(kind) {
        [x * (1.0 - z), y * (1.0 - z), z]
    } else {
        [x, y, z]
    }
}

fn closed(kind: ElementKind, [x, y, z]: [f64; 3]) -> [f64; 3] {
    if is_pyramid(kind) {
        [x / (1.0 - z), y / (1.0 - z), z]
    } else {
        [x, y, z]
    }
}

#[test]
fn each_function_is_one_at_its_node_and_zero_at_the_others() {
    for kind in KINDS {
        let places = node_places(kind);
        assert_eq!(places.len(), kind.node_count());
        for (i, place) in places.iter().enumerate() {
            let shape = Shape::at(kind, *place);
            for j in 0..MOST_NODES {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!(
                    (shape.values[j] - expected).abs() < 1e-15,
                    "{kind:?} {i} {j}"
                );
            }
        }
    }
}

#[test]
fn they_sum_to_one_hold_linear_functions_and_slopes_are_derivatives() {
    let point = [0.31, 0.22, 0.17];
    for kind in KINDS {
        let places: Vec<_> = node_places(kind)
            .into_iter()
            .map(|place| opened(kind, place))
            .collect();
        for removed in [false, true] {
            let mut shape = Shape::at(kind, closed(kind, point));
            if removed {
                for local in [kind.corner_count(), kind.node_count() - 1] {
                    shape.remove_midside(kind, local);
                }
            }
            let flat = if kind.node_count() == 2 {
                0
            } else {
                shape_dimension(kind)
            };
            let sum: f64 = shape.values.iter().sum();
            assert!((sum - 1.0).abs() < 1e-14, "{kind:?}");
            for axis in 0..flat {
                let place: f64 = places
                    .iter()
                    .zip(shape.values)
                    .map(|(p, n)| p[axis] * n)
                    .sum();
                assert!((place - point[axis]).abs() < 1e-14, "{kind:?}");
                for along in 0..flat {
                    let slope: f64 = places
                        .iter()
                        .zip(shape.slopes)
                        .map(|(p, s)| p[axis] * s[along])
                        .sum();
                    let expected = if axis == along { 1.0 } else { 0.0 };
                    assert!((slope - expected).abs() < 1e-14, "{kind:?} {axis} {along}");
                }
            }
        }
        let shape = Shape::at(kind, closed(kind, point));
        let step = 1e-6;
        for axis in 0..shape_dimension(kind) {
            let moved = |sign: f64| {
                let mut moved = point;
                moved[axis] += sign * step;
                Shape::at(kind, closed(kind, moved))
            };
            let (up, down) = (moved(1.0), moved(-1.0));
            for node in 0..kind.node_count() {
                let difference = (up.values[node] - down.values[node]) / (2.0 * step);
                assert!(
                    (difference - shape.slopes[node][axis]).abs() < 1e-8,
                    "{kind:?} node {node} axis {axis}"
                );
            }
        }
    }
}

fn shape_dimension(kind: ElementKind) -> usize {
    if is_solid(kind) { 3 } else { 2 }
}
