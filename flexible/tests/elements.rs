//! Shape functions of all elements, and the consistency of their table.

use eng_flexible::element::{ElementKind, MOST_NODES, Shape};
use eng_flexible::internals::elements::{
    edges, faces, found_by_names, nastran_cards, of_gmsh, of_nastran, orders,
};

/// All with shape functions.
fn kinds() -> impl Iterator<Item = ElementKind> {
    let beam = |kind: &ElementKind| *kind != ElementKind::Beam2;
    ElementKind::ALL.into_iter().filter(beam)
}

/// Places of the corners in the reference domain (a pyramid's in collapsed coordinates, its apex on the
/// axis).
fn corner_places(kind: ElementKind) -> Vec<[f64; 3]> {
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let layer = |corners: &[[f64; 2]], z: f64| -> Vec<[f64; 3]> {
        corners.iter().map(|[x, y]| [*x, *y, z]).collect()
    };
    match kind.linear() {
        ElementKind::Tetrahedron4 => [layer(&triangle, 0.0), vec![[0.0, 0.0, 1.0]]].concat(),
        ElementKind::Triangle3 => layer(&triangle, 0.0),
        ElementKind::Wedge6 => [layer(&triangle, -1.0), layer(&triangle, 1.0)].concat(),
        ElementKind::Hexahedron8 => [layer(&square, -1.0), layer(&square, 1.0)].concat(),
        ElementKind::Pyramid5 => [layer(&square, 0.0), vec![[0.0, 0.0, 1.0]]].concat(),
        _ => layer(&square, 0.0),
    }
}

/// Places of an element's nodes in its reference domain (a pyramid's in collapsed coordinates).
fn node_places(kind: ElementKind) -> Vec<[f64; 3]> {
    let corners = corner_places(kind);
    let mut places = corners.clone();
    for &[a, b] in kind.midside_edges() {
        let mut middle = [0.0; 3];
        for (i, x) in middle.iter_mut().enumerate() {
            *x = 0.5 * (corners[a][i] + corners[b][i]);
        }
        if kind.linear() == ElementKind::Pyramid5 && b == 4 {
            // half-way to the apex the collapsed coordinates still are the corner's
            middle = [corners[a][0], corners[a][1], 0.5];
        }
        places.push(middle);
    }
    places
}

fn is_pyramid(kind: ElementKind) -> bool {
    kind.linear() == ElementKind::Pyramid5
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
    for kind in kinds() {
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
    for kind in kinds() {
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
    if kind.is_solid() { 3 } else { 2 }
}

#[test]
fn every_edge_of_a_solid_is_on_two_faces_in_opposite_directions() {
    for kind in kinds() {
        let mut directed = Vec::new();
        for face in faces(kind) {
            for (a, b) in face.iter().zip(face.iter().cycle().skip(1)) {
                directed.push((*a, *b));
            }
        }
        let sides = if faces(kind).len() == 1 { 1 } else { 2 };
        assert_eq!(directed.len(), sides * edges(kind).len(), "{kind:?}");
        for edge in edges(kind) {
            let there = directed.contains(&(edge[0], edge[1]));
            let back = directed.contains(&(edge[1], edge[0]));
            assert!(if sides == 2 {
                there && back
            } else {
                there != back
            });
        }
        let middle = kind.node_count() - kind.corner_count();
        assert!(middle == 0 || middle == edges(kind).len());
    }
}

/// Edges of gmsh's second-order volumes in the order of their mid-side nodes (gmsh reference manual, Node
/// ordering).
#[test]
fn middle_nodes_belong_to_their_edges() {
    let edges_of_gmsh: [(i32, &[[usize; 2]]); 4] = [
        (11, &[[0, 1], [1, 2], [2, 0], [3, 0], [2, 3], [1, 3]]),
        (
            17,
            &[
                [0, 1],
                [0, 3],
                [0, 4],
                [1, 2],
                [1, 5],
                [2, 3],
                [2, 6],
                [3, 7],
                [4, 5],
                [4, 7],
                [5, 6],
                [6, 7],
            ],
        ),
        (
            18,
            &[
                [0, 1],
                [0, 2],
                [0, 3],
                [1, 2],
                [1, 4],
                [2, 5],
                [3, 4],
                [3, 5],
                [4, 5],
            ],
        ),
        (
            19,
            &[
                [0, 1],
                [0, 3],
                [0, 4],
                [1, 2],
                [1, 4],
                [2, 3],
                [2, 4],
                [3, 4],
            ],
        ),
    ];
    for (number, gmsh) in edges_of_gmsh {
        let kind = of_gmsh(number).unwrap();
        let order = orders(kind)[1].unwrap();
        let corners = kind.corner_count();
        assert_eq!(order.len(), kind.node_count());
        for (place, edge) in kind.midside_edges().iter().enumerate() {
            let [a, b] = gmsh[order[corners + place] - corners];
            assert!(*edge == [a, b] || *edge == [b, a], "{kind:?} {place}");
        }
    }
}

/// Nastran gives the mid-side nodes of the vertical edges before those of the top (Quick Reference Guide,
/// CHEXA and CPENTA).
#[test]
fn names_find_their_kinds_and_orders_are_permutations() {
    for kind in ElementKind::ALL {
        for order in orders(kind).into_iter().flatten() {
            let mut sorted = order.to_vec();
            sorted.sort_unstable();
            assert_eq!(
                sorted,
                (0..kind.node_count()).collect::<Vec<_>>(),
                "{kind:?}"
            );
        }
        for card in nastran_cards(kind) {
            let (linear, largest) = of_nastran(card).unwrap();
            assert!([linear, largest].contains(&kind), "{kind:?} {card}");
            assert_eq!(linear, kind.linear());
        }
        for (name, found) in found_by_names(kind) {
            assert_eq!(found, Some(kind), "{name}");
        }
    }
    let order = orders(ElementKind::Hexahedron20)[0].unwrap();
    assert_eq!(edges(ElementKind::Hexahedron20)[order[12] - 8], [0, 4]);
    assert_eq!(of_nastran("CQUAD4").unwrap().1, ElementKind::Quadrilateral4);
}
