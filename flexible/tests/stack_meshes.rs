//! Meshes of stacked sections: upright elements, volumes, and refusals.

use eng_flexible::Mesh;
use eng_flexible::element::{ElementKind, Shape, quadrature};
use eng_flexible::internals::{outline_area, outline_turn};
use eng_flexible::stack::{StackError, stack_mesh};
use eng_system::stack::{Corner, Section, Stack};
use std::f64::consts::PI;

fn corner(x: f64, y: f64, bend: f64) -> Corner {
    Corner {
        place: [x, y],
        bend,
    }
}

fn disc(center: [f64; 2], radius: f64, length: f64) -> Section {
    Section {
        corners: vec![
            corner(center[0] + radius, center[1], PI),
            corner(center[0] - radius, center[1], PI),
        ],
        length,
    }
}

fn polygon(corners: &[[f64; 2]], length: f64) -> Section {
    Section {
        corners: corners.iter().map(|[x, y]| corner(*x, *y, 0.0)).collect(),
        length,
    }
}

fn stack(size: f64, sections: Vec<Section>) -> Stack {
    Stack {
        axis: 2,
        begin: 0.0,
        size,
        sections,
    }
}

/// Volume of a mesh, and the least determinant of its elements' Jacobians by the size cubed, by the shape functions at
/// the points of a fine rule and at the nodes.
fn volume(mesh: &Mesh) -> (f64, f64) {
    let rule = quadrature::wedge(&quadrature::triangle(3), 2);
    let mut at: Vec<([f64; 3], f64)> = rule.iter().map(|p| (p.at, p.weight)).collect();
    for [r, s] in [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [0.5, 0.0],
        [0.5, 0.5],
        [0.0, 0.5],
    ] {
        at.push(([r, s, 0.0], 0.0));
    }
    let shapes: Vec<(Shape, f64)> = at
        .iter()
        .map(|(point, weight)| (Shape::at(ElementKind::Wedge15, *point), *weight))
        .collect();
    let (mut total, mut least) = (0.0, f64::INFINITY);
    for element in &mesh.elements {
        assert_eq!(element.kind, ElementKind::Wedge15);
        let nodes = mesh.nodes_of(element);
        for (shape, weight) in &shapes {
            let mut j = [[0.0; 3]; 3];
            for (node, slope) in nodes.iter().zip(&shape.slopes) {
                let place = mesh.nodes[*node as usize].position;
                for (row, x) in j.iter_mut().zip(place) {
                    for (entry, s) in row.iter_mut().zip(slope) {
                        *entry += x * s;
                    }
                }
            }
            let determinant = j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1])
                - j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0])
                + j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
            least = least.min(determinant);
            total += weight * determinant;
        }
    }
    (total, least)
}

/// A mesh whose elements are upright, and whose volume is that of the outlines within a relative difference.
fn sound(stack: &Stack, within: f64) -> Mesh {
    let mesh = stack_mesh(stack).unwrap_or_else(|error| panic!("{error}"));
    let (found, least) = volume(&mesh);
    assert!(least > 0.0, "a Jacobian of {least}");
    let exact: f64 = stack
        .sections
        .iter()
        .map(|section| outline_area(section).unwrap() * section.length)
        .sum();
    assert!(
        (found / exact - 1.0).abs() <= within,
        "volume {found} for {exact}: {}",
        found / exact - 1.0
    );
    mesh
}

/// A web that points along the first axis: round the pin, a waist, a sector as counterweight.
fn web(side: f64, length: f64) -> Section {
    let throw = 0.043;
    let deg = PI / 180.0;
    let at = |x: f64, y: f64, bend: f64| corner(side * x, side * y, bend);
    let pin = |angle: f64| {
        [
            throw + 0.034 * (angle * deg).cos(),
            0.034 * (angle * deg).sin(),
        ]
    };
    let weight = |angle: f64| [0.073 * (angle * deg).cos(), 0.073 * (angle * deg).sin()];
    let [p, q, u, v] = [pin(-100.0), pin(100.0), weight(106.0), weight(-106.0)];
    Section {
        corners: vec![
            at(p[0], p[1], 200.0 * deg),
            at(q[0], q[1], 0.0),
            at(0.004, 0.037, 0.0),
            at(u[0], u[1], 148.0 * deg),
            at(v[0], v[1], 0.0),
            at(0.004, -0.037, 0.0),
        ],
        length,
    }
}

/// The crank of examples/paper.
fn crank(size: f64) -> Stack {
    let (main, neck, flange) = (
        disc([0.0; 2], 0.027, 0.024),
        disc([0.0; 2], 0.023, 0.024),
        disc([0.0; 2], 0.04, 0.01),
    );
    let mut sections = vec![flange.clone(), neck.clone(), main.clone()];
    for side in [1.0, -1.0, -1.0, 1.0] {
        sections.push(web(side, 0.02));
        sections.push(disc([0.043 * side, 0.0], 0.024, 0.028));
        sections.push(web(side, 0.02));
        sections.push(main.clone());
    }
    sections.extend([neck, flange]);
    Stack {
        begin: -0.23,
        ..stack(size, sections)
    }
}

#[test]
fn a_cylinder_has_its_volume() {
    for (size, within) in [(0.02, 5e-5), (0.01, 5e-5), (0.005, 1e-5)] {
        let mesh = sound(&stack(size, vec![disc([0.01, 0.02], 0.02, 0.1)]), within);
        let [low, high] = [f64::min, f64::max].map(|choose| {
            let along = mesh.nodes.iter().map(|node| node.position[2]);
            along.reduce(choose).unwrap()
        });
        assert_eq!([low, high], [0.0, 0.1]);
    }
}

#[test]
fn nodes_are_in_the_order_of_the_wedge() {
    let mesh = stack_mesh(&stack(
        0.01,
        vec![polygon(
            &[[0.0, 0.0], [0.04, 0.0], [0.04, 0.03], [0.0, 0.03]],
            0.02,
        )],
    ))
    .unwrap();
    for element in &mesh.elements {
        let nodes = mesh.nodes_of(element);
        let place = |local: usize| mesh.nodes[nodes[local] as usize].position;
        for (local, [a, b]) in (6..).zip(element.kind.midside_edges()) {
            for axis in 0..3 {
                let chord = 0.5 * (place(*a)[axis] + place(*b)[axis]);
                assert!((place(local)[axis] - chord).abs() < 1e-15);
            }
        }
    }
}

#[test]
fn the_axes_are_cyclic() {
    let plain = |axis: u8| {
        let section = polygon(&[[0.0, 0.0], [0.04, 0.0], [0.04, 0.03], [0.0, 0.03]], 0.02);
        let stack = Stack {
            axis,
            ..stack(0.01, vec![section])
        };
        sound(&stack, 1e-12)
    };
    for axis in 0..3_u8 {
        let extent = |k: usize| {
            plain(axis)
                .nodes
                .iter()
                .map(|node| node.position[k])
                .fold(0.0, f64::max)
        };
        let along = usize::from(axis);
        assert_eq!(extent(along), 0.02);
        assert_eq!(extent((along + 1) % 3), 0.04);
        assert_eq!(extent((along + 2) % 3), 0.03);
    }
}

#[test]
fn a_crank_is_upright_at_every_size() {
    for size in [0.02, 0.015, 0.012, 0.01, 0.008, 0.006, 0.005] {
        let mesh = sound(&crank(size), 1e-4);
        println!("{} mm: {} nodes", 1e3 * size, mesh.nodes.len());
    }
}

#[test]
fn one_stack_gives_the_same_bits_each_time() {
    assert_eq!(stack_mesh(&crank(0.01)), stack_mesh(&crank(0.01)));
}

#[test]
fn circles_that_nearly_touch_have_straight_edges() {
    let outer = disc([0.0; 2], 0.027, 0.02);
    let mut straight = 0;
    for gap in [0.0, 1e-6, 3e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3] {
        // concentric, shifted, and crossing at a small angle
        for center in [
            [0.0, 0.0],
            [0.5 * gap, 0.0],
            [0.0, -0.5 * gap],
            [1.5 * gap, 2.0 * gap],
        ] {
            for size in [0.01, 0.006] {
                let inner = disc(center, 0.027 - gap, 0.02);
                let both = stack(size, vec![outer.clone(), inner.clone()]);
                match stack_mesh(&both) {
                    Ok(mesh) => {
                        sound(&both, 1e-3);
                        straight += straight_arcs(&mesh);
                    }
                    // less than a 500th of the size
                    Err(StackError::Close { .. } | StackError::Plane { .. }) if gap < 2e-5 => {}
                    Err(error) => panic!("{gap} at {center:?}: {error}"),
                }
            }
        }
    }
    assert!(straight > 0);
    // circles that touch, from inside and outside
    let square = polygon(&[[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]], 0.02);
    for (center, radius) in [
        ([0.007, 0.0], 0.02),
        ([0.047, 0.0], 0.02),
        ([0.0, 0.017], 0.01),
    ] {
        let small = disc(center, radius, 0.02);
        sound(
            &stack(0.01, vec![outer.clone(), square.clone(), small]),
            1e-3,
        );
    }
}

/// Edges between two points on the circle of radius 27 mm whose middle is inside of it.
fn straight_arcs(mesh: &Mesh) -> usize {
    let place = |node: u32| mesh.nodes[node as usize].position;
    let radius = |node: u32| place(node)[0].hypot(place(node)[1]) - 0.027;
    let mut count = 0;
    for element in &mesh.elements {
        let nodes = mesh.nodes_of(element);
        for (node, [a, b]) in nodes[6..].iter().zip(element.kind.midside_edges()).take(6) {
            let (a, b) = (nodes[*a], nodes[*b]);
            let chord = (place(a)[0] - place(b)[0]).hypot(place(a)[1] - place(b)[1]);
            let rise = chord * chord / (8.0 * 0.027);
            let on = radius(a).abs() < 1e-9 && radius(b).abs() < 1e-9;
            count += usize::from(on && (radius(*node) + rise).abs() < 0.1 * rise);
        }
    }
    count
}

fn refused(stack: &Stack) -> StackError {
    stack_mesh(stack).unwrap_err()
}

#[test]
fn wrong_stacks_are_refused() {
    let square = |x: f64| {
        polygon(
            &[[x, 0.0], [x + 0.02, 0.0], [x + 0.02, 0.02], [x, 0.02]],
            0.02,
        )
    };
    let eight = polygon(&[[0.0, 0.0], [0.02, 0.02], [0.02, 0.0], [0.0, 0.02]], 0.02);
    assert!(matches!(refused(&stack(0.01, vec![])), StackError::Empty));
    assert!(matches!(
        refused(&stack(0.01, vec![square(0.0), eight])),
        StackError::Crossing {
            section: 2,
            first: 1,
            second: 3,
            ..
        }
    ));
    assert!(matches!(
        refused(&stack(0.01, vec![square(0.0), square(0.02)])),
        StackError::Apart { first: 1 }
    ));
    assert!(matches!(
        refused(&stack(0.01, vec![square(0.0), square(0.5)])),
        StackError::Apart { first: 1 }
    ));
    assert!(matches!(
        refused(&stack(0.03, vec![square(0.0)])),
        StackError::Coarse { section: 1, .. }
    ));
    assert!(matches!(
        refused(&stack(1e-6, vec![square(0.0)])),
        StackError::Large { .. }
    ));
    let line = polygon(&[[0.0, 0.0], [0.01, 0.0], [0.02, 0.0]], 0.01);
    assert!(matches!(
        refused(&stack(0.01, vec![line])),
        StackError::Crossing { .. } | StackError::NoArea { .. }
    ));
    let twice = polygon(&[[0.0, 0.0], [0.0, 0.0], [0.02, 0.0], [0.0, 0.02]], 0.01);
    assert!(matches!(
        refused(&stack(0.005, vec![twice])),
        StackError::SamePlace {
            first: 1,
            second: 2,
            ..
        }
    ));
    let lens = Section {
        corners: vec![corner(0.0, 0.0, 1.0), corner(0.02, 0.0, -1.0)],
        length: 0.01,
    };
    assert!(matches!(
        refused(&stack(0.005, vec![lens])),
        StackError::NoArea { section: 1 }
    ));
    for bad in [f64::NAN, f64::INFINITY, 0.0, -0.01] {
        assert!(matches!(
            refused(&stack(bad, vec![square(0.0)])),
            StackError::Number { section: None, .. }
        ));
        let section = Section {
            length: bad,
            ..square(0.0)
        };
        assert!(matches!(
            refused(&stack(0.01, vec![square(0.0), section])),
            StackError::Number {
                section: Some(2),
                ..
            }
        ));
    }
    for bad in [f64::NAN, f64::INFINITY, 1e9] {
        assert!(matches!(
            refused(&stack(0.01, vec![square(bad)])),
            StackError::Number {
                section: Some(1),
                ..
            }
        ));
    }
    let corners = vec![corner(0.0, 0.0, 7.0), corner(0.02, 0.0, 0.0)];
    assert!(matches!(
        refused(&stack(
            0.01,
            vec![Section {
                corners,
                length: 0.01
            }]
        )),
        StackError::Number {
            section: Some(1),
            ..
        }
    ));
}

/// Discs, polygons and stadiums at random: a mesh with upright elements and the right volume, or an error.
#[test]
fn any_sections_give_an_upright_mesh_or_an_error() {
    let mut state = 7_u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut good, mut total) = (0, 0);
    for _ in 0..150 {
        let count = 2 + (4.0 * random()) as usize;
        let mut sections = Vec::new();
        for _ in 0..count {
            let (x, y, r) = (0.02 * random(), 0.02 * random(), 0.012 + 0.02 * random());
            let kind = (3.0 * random()) as usize;
            sections.push(match kind {
                0 => disc([x, y], r, 0.01),
                1 => {
                    let turn = 6.0 * random();
                    let sides = 3 + (5.0 * random()) as usize;
                    let places: Vec<[f64; 2]> = (0..sides)
                        .map(|k| {
                            let angle = turn + 2.0 * PI * k as f64 / sides as f64;
                            [x + r * angle.cos(), y + r * angle.sin()]
                        })
                        .collect();
                    polygon(&places, 0.02)
                }
                _ => Section {
                    corners: vec![
                        corner(x, y - r, 0.0),
                        corner(x + 0.03, y - r, PI),
                        corner(x + 0.03, y + r, 0.0),
                        corner(x, y + r, PI),
                    ],
                    length: 0.015,
                },
            });
        }
        let stack = stack(0.006, sections);
        total += 1;
        match stack_mesh(&stack) {
            Ok(_) => {
                good += 1;
                sound(&stack, 2e-3);
            }
            Err(StackError::Apart { .. } | StackError::Close { .. } | StackError::Plane { .. }) => {
            }
            Err(error) => panic!("{error}: {stack:?}"),
        }
    }
    assert!(good * 20 >= total * 19, "{good} of {total}");
}

#[test]
fn an_outline_winds_around_the_points_inside() {
    let shapes = [
        disc([0.01, 0.0], 0.02, 0.01),
        web(1.0, 0.01),
        web(-1.0, 0.01),
    ];
    for (section, inside, outside) in [
        (
            &shapes[0],
            [[0.0, 0.0], [0.029, 0.0], [0.01, 0.0], [0.01, 0.0199]],
            [[-0.011, 0.0], [0.031, 0.0], [0.03, 0.02], [0.01, -0.021]],
        ),
        (
            &shapes[1],
            [[0.0, 0.0], [0.076, 0.0], [-0.07, 0.0], [-0.05, 0.05]],
            [[0.078, 0.0], [-0.074, 0.0], [0.02, 0.05], [0.0, 0.072]],
        ),
        (
            &shapes[2],
            [[0.0, 0.0], [-0.076, 0.0], [0.07, 0.0], [0.05, 0.05]],
            [[-0.078, 0.0], [0.074, 0.0], [-0.02, 0.05], [0.0, 0.072]],
        ),
    ] {
        let turns = |point: [f64; 2]| outline_turn(section, point).unwrap();
        for point in inside {
            assert!(
                (turns(point).abs() - 2.0 * PI).abs() < 1e-9,
                "{point:?}: {}",
                turns(point)
            );
        }
        for point in outside {
            assert!(turns(point).abs() < 1e-9, "{point:?}: {}", turns(point));
        }
    }
}
