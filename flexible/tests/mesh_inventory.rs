//! What a mesh holds, and the shape of its elements.

use crate::fe_meshes::*;
use eng_flexible::Mesh;
use eng_flexible::fe::Inventory;
use eng_flexible::fe::quality::{LONG, SHARP};
use eng_flexible::mesh::{Code, ElementKind, Section, ShellSection};

type Place = [f64; 3];

const CUBE: [Place; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];

/// A mesh of one element.
fn one(kind: ElementKind, corners: &[Place]) -> Mesh {
    let mut mesh = empty();
    if !kind.is_solid() {
        mesh.properties[0].section = Section::Shell(ShellSection::plate(0.01));
    }
    let nodes: Vec<u32> = corners.iter().map(|x| add_node(&mut mesh, *x)).collect();
    add_element(&mut mesh, kind, 0, &nodes);
    mesh
}

/// The longest side by the shortest, and the sharpest corner.
fn shape(kind: ElementKind, corners: &[Place]) -> (f64, f64) {
    let found = Inventory::of(&one(kind, corners));
    (found.longest.unwrap().value, found.sharpest.unwrap().value)
}

/// Elements of equal sides have 1; mirrored solids are negative.
#[test]
fn regular_elements_have_one() {
    let (height, third) = (0.75f64.sqrt(), 0.75f64.sqrt() / 3.0);
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, height, 0.0]];
    let up = |x: Place| [x[0], x[1], x[2] + 1.0];
    let with = |base: &[Place], others: &[Place]| [base, others].concat();
    for (kind, corners) in [
        (ElementKind::Hexahedron8, CUBE.to_vec()),
        (ElementKind::Wedge6, with(&triangle, &triangle.map(up))),
        (
            ElementKind::Tetrahedron4,
            with(&triangle, &[[0.5, third, (2.0f64 / 3.0).sqrt()]]),
        ),
        (
            ElementKind::Pyramid5,
            with(&CUBE[..4], &[[0.5, 0.5, 0.5f64.sqrt()]]),
        ),
        (ElementKind::Quadrilateral4, CUBE[..4].to_vec()),
        (ElementKind::Triangle3, triangle.to_vec()),
    ] {
        let (ratio, corner) = shape(kind, &corners);
        assert!(agrees(ratio, 1.0, 1e-12), "{kind:?}: {ratio}");
        assert!(agrees(corner, 1.0, 1e-12), "{kind:?}: {corner}");
        if kind.is_solid() {
            let mirrored: Vec<Place> = corners.iter().map(|x| [x[0], x[1], -x[2]]).collect();
            let corner = shape(kind, &mirrored).1;
            assert!(agrees(corner, -1.0, 1e-12), "{kind:?}: {corner}");
        }
    }
}

/// A rhombus of 30° has its sine; a reflex corner is negative; a long plate has the ratio of its sides.
#[test]
fn poor_shells_are_measured() {
    let c = 0.75f64.sqrt();
    let quad = ElementKind::Quadrilateral4;
    let rhombus = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [1.0 + c, 0.5, 0.0],
        [c, 0.5, 0.0],
    ];
    let (ratio, corner) = shape(quad, &rhombus);
    assert!(agrees(ratio, 1.0, 1e-12) && agrees(corner, 0.5, 1e-12));
    let reflex = [[0.0; 3], [1.0, 0.0, 0.0], [0.2, 0.2, 0.0], [0.0, 1.0, 0.0]];
    assert!(shape(quad, &reflex).1 < 0.0);
    let long = [
        [0.0; 3],
        [30.0, 0.0, 0.0],
        [30.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let (ratio, corner) = shape(quad, &long);
    assert!(agrees(ratio, 30.0, 1e-12) && agrees(corner, 1.0, 1e-12));
}

/// Two cubes and a flat one: the flat one is poor, with its number and place. The names are those of the code.
#[test]
fn the_worst_element_has_its_number_and_place() {
    let mut mesh = one(ElementKind::Hexahedron8, &CUBE);
    for (start, height) in [(2.0, 1.0), (4.0, 1.0 / 25.0)] {
        let places = CUBE.map(|x| [x[0] + start, x[1], height * x[2]]);
        let nodes = places.map(|x| add_node(&mut mesh, x));
        add_element(&mut mesh, ElementKind::Hexahedron8, 0, &nodes);
    }
    let flat = mesh.elements[2].id;
    for (code, name) in [(Code::Abaqus, "C3D8"), (Code::Nastran, "CHEXA (8 nodes)")] {
        mesh.code = code;
        let found = Inventory::of(&mesh);
        assert_eq!(found.elements, [(name.to_string(), 3)]);
        assert_eq!(found.poor, 1);
        let longest = found.longest.unwrap();
        assert_eq!(longest.element, flat);
        assert!(agrees(longest.value, 25.0, 1e-12) && longest.value > LONG);
        assert!((0..3).all(|k| (longest.place[k] - [4.5, 0.5, 0.02][k]).abs() < 1e-12));
        assert!(found.sharpest.unwrap().value > SHARP);
    }
    assert_eq!(Inventory::of(&empty()), Inventory::default());
}
