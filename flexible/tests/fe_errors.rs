//! Meshes without meaning, and their errors.

use crate::fe_meshes::*;
use eng_flexible::FlexibleError;
use eng_flexible::fe::{Rules, assemble};
use eng_flexible::mesh::{
    BeamAxes, BeamSection, ElementKind, Material, Mesh, PointMass, Section, ShellSection, Spring,
    Tie,
};
use proptest::prelude::*;

fn box_mesh() -> Mesh {
    bar(ElementKind::Tetrahedron10, [2, 1, 1], [0.2, 0.1, 0.1])
}

fn refused(change: impl FnOnce(&mut Mesh)) -> String {
    let mut mesh = box_mesh();
    change(&mut mesh);
    problem(assemble(&mesh, &Rules::default()))
}

#[test]
fn inverted_elements_are_named_with_their_jacobian() {
    let message = refused(|mesh| {
        for element in [3, 7] {
            let first = mesh.elements[element].first as usize;
            mesh.connectivity.swap(first, first + 1);
        }
    });
    assert!(
        message.starts_with("2 elements are inverted or degenerate"),
        "{message}"
    );
    assert!(message.contains("element 4 (Jacobian -"), "{message}");
    assert!(message.contains("element 8 (Jacobian -"), "{message}");
    // the mid-side nodes in the order of another program
    let shuffled = refused(|mesh| {
        let first = mesh.elements[2].first as usize;
        mesh.connectivity.swap(first + 8, first + 9);
    });
    assert!(shuffled.contains("element 3"), "{shuffled}");
    let flat = refused(|mesh| {
        for node in &mut mesh.nodes {
            node.position[2] = 0.0;
        }
    });
    assert!(
        flat.contains("degenerate") && flat.contains("2 more"),
        "{flat}"
    );
}

#[test]
fn places_that_are_no_numbers_are_named() {
    let message = refused(|mesh| mesh.nodes[4].position[1] = f64::NAN);
    assert!(message.contains("1 nodes: 5"), "{message}");
}

#[test]
fn materials_must_make_sense() {
    let with = |change: fn(&mut Material)| refused(|mesh| change(&mut mesh.materials[0]));
    assert!(with(|m| m.young = 0.0).contains("Young's modulus 0 Pa"));
    assert!(with(|m| m.young = f64::NAN).contains("Young's modulus NaN"));
    assert!(with(|m| m.poisson = 0.5).contains("Poisson's ratio 0.5"));
    assert!(with(|m| m.density = -1.0).contains("density -1"));
    assert!(with(|m| m.density = 0.0).contains("no mass"));
    assert!(refused(|mesh| mesh.properties[0].material = None).contains("element 1"));
    assert!(refused(|mesh| mesh.elements[2].property = 9).contains("element 3"));
}

#[test]
fn sections_must_make_sense() {
    let shell = |thickness: f64| {
        refused(|mesh| {
            let mut property = mesh.properties[0].clone();
            property.name = "skin".into();
            property.section = Section::Shell(ShellSection::plate(thickness));
            mesh.properties.push(property);
            add_element(mesh, ElementKind::Triangle3, 1, &[0, 1, 2]);
        })
    };
    let message = shell(0.0);
    assert!(
        message.contains("“skin”") && message.contains("thickness of 0"),
        "{message}"
    );
    let beam = |area: f64, product: f64, orientation: [f64; 3]| {
        refused(|mesh| {
            let section = Section::Beam(BeamSection {
                area,
                moment_z: 1e-8,
                moment_y: 1e-8,
                product,
                torsion: 1e-8,
                shear: [0.0; 2],
                mass_per_length: 0.0,
            });
            let axes = BeamAxes {
                centroid: [0.0; 2],
                orientation,
                offsets: [[0.0; 3]; 2],
                released: [0; 2],
            };
            let end = add_node(mesh, [0.0, 0.0, -1.0]);
            let root = nodes_where(mesh, |x| x == [0.0, 0.0, 0.0])[0];
            add_beam(mesh, section, axes, [root, end]);
        })
    };
    assert!(beam(0.0, 0.0, [1.0, 0.0, 0.0]).contains("area of 0"));
    assert!(beam(1e-4, 2e-8, [1.0, 0.0, 0.0]).contains("product"));
    let along = beam(1e-4, 0.0, [0.0, 0.0, 1.0]);
    assert!(
        along.contains("orientation") && along.contains("beam 13"),
        "{along}"
    );
}

#[test]
fn parts_that_nothing_connects_are_counted() {
    let message = refused(|mesh| {
        let other = bar(ElementKind::Tetrahedron4, [1, 1, 1], [0.1, 0.1, 0.1]);
        let base = mesh.nodes.len() as u32;
        for node in &other.nodes {
            add_node(mesh, node.position.map(|x| x + 1.0));
        }
        for element in &other.elements {
            let nodes: Vec<u32> = other.nodes_of(element).iter().map(|n| n + base).collect();
            add_element(mesh, element.kind, 0, &nodes);
        }
    });
    assert!(message.contains("2 parts"), "{message}");
    assert!(
        message.contains("45 nodes with node 1, 8 nodes with node 46"),
        "{message}"
    );
}

#[test]
fn masses_need_something_that_holds_them() {
    let message = refused(|mesh| {
        let node = add_node(mesh, [1.0, 1.0, 1.0]);
        let mut matrix = [[0.0; 6]; 6];
        for (i, row) in matrix.iter_mut().enumerate().take(3) {
            row[i] = 2.0;
        }
        mesh.point_masses.push(PointMass {
            id: 1,
            node,
            matrix,
        });
    });
    assert!(
        message.contains("a node has mass but no stiffness: 46"),
        "{message}"
    );
}

#[test]
fn indices_out_of_range_are_refused() {
    assert!(refused(|mesh| mesh.connectivity[0] = 4_000_000).contains("node 1 of element 1"));
    assert!(refused(|mesh| mesh.connectivity[3] = u32::MAX).contains("node 4 of element 1"));
    assert!(
        refused(|mesh| mesh.connectivity.truncate(15))
            .contains("element 2 lacks some of its 10 nodes")
    );
    assert!(
        refused(|mesh| mesh.springs.push(Spring::between(5, 1.0, (0, 6), None)))
            .contains("spring 5")
    );
    assert!(
        refused(|mesh| mesh.ties.push(Tie::Equation {
            id: 6,
            terms: vec![(900, 0, 1.0)],
        }))
        .contains("tie 6")
    );
    assert!(refused(|mesh| mesh.nodes[3].frame = Some(0)).contains("node 4"));
}

#[test]
fn points_that_nothing_uses_have_no_freedoms() {
    let mut mesh = box_mesh();
    let far = add_node(&mut mesh, [9.0, 9.0, 9.0]);
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    assert_eq!(structure.unused_nodes, [far]);
    assert!(structure.freedoms.of(far).is_empty());
    assert_eq!(structure.freedoms.size(), 3 * (mesh.nodes.len() - 1));
    let last = structure.freedoms.size() - 1;
    assert_eq!(structure.freedoms.owner(last), Some((far - 1, 2)));
    assert_eq!(structure.freedoms.owner(last + 1), None);
    let empty = assemble(&Mesh::default(), &Rules::default());
    assert!(matches!(empty, Err(FlexibleError::Structure { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Any damage of a mesh gives an error or a structure, never a panic.
    #[test]
    fn broken_meshes_never_panic(
        changes in proptest::collection::vec((0u8..9, any::<u32>(), any::<f64>()), 1..4)
    ) {
        let mut mesh = box_mesh();
        for (what, place, value) in changes {
            let place = place as usize;
            let node = place as u32 % 60;
            match what {
                0 => {
                    let at = place % mesh.connectivity.len();
                    mesh.connectivity[at] = (value.to_bits() % 60) as u32;
                }
                1 => {
                    let at = place % mesh.connectivity.len();
                    mesh.connectivity[at] = u32::MAX;
                }
                2 => {
                    let at = place % mesh.nodes.len();
                    mesh.nodes[at].position[place % 3] = value;
                }
                3 => {
                    let at = place % mesh.elements.len();
                    mesh.elements[at].kind = ElementKind::Wedge6;
                }
                4 => {
                    let at = place % mesh.elements.len();
                    mesh.elements[at].first = place as u32;
                }
                5 => mesh.materials[0].young = value,
                6 => mesh.springs.push(Spring {
                    id: 1,
                    stiffness: value,
                    terms: vec![(node, (place % 8) as u8, 1.0), (place as u32 % 7, 2, value)],
                    grounded: place.is_multiple_of(2),
                }),
                7 => mesh.ties.push(Tie::Rigid {
                    id: 2,
                    independent: node,
                    dependent: vec![(place as u32 % 41, (value.to_bits() % 64) as u8)],
                }),
                _ => mesh.ties.push(Tie::Averaging {
                    id: 3,
                    reference: node,
                    reference_components: (value.to_bits() % 64) as u8,
                    independent: vec![(place as u32 % 41, value, 7), (3, 1.0, 63)],
                }),
            }
        }
        if let Ok(structure) = assemble(&mesh, &Rules::default())
            && let Ok(reduction) = eng_flexible::fe::Reduction::new(&mesh, &structure, &held(&[0, 7], 63))
        {
            prop_assert!(reduction.size() <= structure.freedoms.size());
            let _ = reduction.reduce_stiffness(&structure.stiffness);
        }
    }
}
