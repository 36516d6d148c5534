//! Solids: constant strain, rigid motion, rank, energy, exact mass.

use crate::fe_meshes::*;
use eng_flexible::fe::mass::rigid_motions;
use eng_flexible::fe::stress::{ElementRecovery, stress};
use eng_flexible::fe::{MassRule, Rules, assemble, assemble_on};
use eng_flexible::mesh::{ABSENT, Code, ElementKind, Mesh, VARIANT_LETTERS, Variant};
use eng_flexible::solve::{EigenOptions, Modes, lowest_modes};

/// u = A x + b with no symmetry in A.
fn linear_field(x: [f64; 3]) -> [f64; 3] {
    [
        1e-4 * (1.0 + 2.0 * x[0] - 0.7 * x[1] + 0.4 * x[2]),
        1e-4 * (-0.5 + 0.3 * x[0] + 1.1 * x[1] - 0.9 * x[2]),
        1e-4 * (0.2 - 0.6 * x[0] + 0.8 * x[1] - 1.3 * x[2]),
    ]
}

/// Its strain.
const STRAIN: [f64; 6] = [2e-4, 1.1e-4, -1.3e-4, -0.4e-4, -0.1e-4, -0.2e-4];

fn patch(mesh: &Mesh, rules: &Rules, what: &str) {
    let structure = assemble(mesh, rules).unwrap();
    let full = field(mesh, &structure, linear_field);
    let force = times(&structure.stiffness, &full);
    let scale = largest(&force);
    assert!(scale > 1e3, "{what}: {scale}");
    let mut inner = 0;
    for (index, node) in mesh.nodes.iter().enumerate() {
        if on_cube(node.position) {
            continue;
        }
        inner += 1;
        for freedom in structure.freedoms.of(index as u32) {
            assert!(
                force[freedom].abs() < 1e-12 * scale,
                "{what}: {} of {scale}",
                force[freedom]
            );
        }
    }
    assert!(inner > 0, "{what}");
    let expected = stress(&mesh.materials[0], [0.0; 3], &STRAIN);
    let peak = largest(&expected);
    for element in &mesh.elements {
        let recovery = ElementRecovery::new(mesh, element, rules).unwrap().unwrap();
        let displacements = recovery.displacements(&structure.freedoms, &full);
        for strain in recovery.strains(&displacements) {
            for (x, y) in strain.iter().zip(STRAIN) {
                assert!((x - y).abs() < 1e-12 * 2e-4, "{what}: {strain:?}");
            }
        }
    }
    // the cube's volume is one
    let exact: f64 = 0.5 * dot(&expected, &STRAIN);
    let energy = energy_of_solids(mesh, &structure.freedoms, rules, &full);
    assert!(agrees(energy, exact, 1e-12), "{what}: {energy} {exact}");
    assert!(agrees(0.5 * dot(&full, &force), exact, 1e-12), "{what}");
    let nodal = nodal_stress(mesh, &structure.freedoms, rules, &full);
    for value in nodal.iter().flatten() {
        for (x, y) in value.iter().zip(expected) {
            assert!((x - y).abs() < 1e-11 * peak, "{what}: {value:?}");
        }
    }
}

#[test]
fn constant_strain_is_exact_in_distorted_patches_of_every_solid() {
    for kind in SOLIDS {
        let mesh = distorted(kind, false);
        patch(&mesh, &Rules::default(), &format!("{kind:?}"));
    }
}

#[test]
fn constant_strain_is_exact_in_distorted_patches_of_other_forms() {
    let reduced = Variant::Letters(VARIANT_LETTERS.find('R').map_or(0, |bit| 1 << bit));
    let plain = Variant::Plain;
    for (kind, code, variant) in [
        (ElementKind::Hexahedron20, Code::CalculiX, reduced),
        (ElementKind::Hexahedron20, Code::Abaqus, reduced),
        (ElementKind::Wedge6, Code::CalculiX, plain),
        (ElementKind::Hexahedron8, Code::Abaqus, plain),
        (ElementKind::Hexahedron8, Code::Nastran, plain),
    ] {
        let mut mesh = distorted(kind, false);
        mesh.code = code;
        for element in &mut mesh.elements {
            element.variant = variant;
        }
        let what = format!("{kind:?} of {code:?}");
        patch(&mesh, &Rules::default(), &what);
        let stiffness = |rules| assemble(&mesh, &rules).unwrap().stiffness;
        assert_ne!(
            stiffness(Rules::default()),
            stiffness(Rules::exact()),
            "{what}"
        );
    }
}

#[test]
fn curved_edges_of_hexahedra_and_pyramids_pass_too() {
    for kind in [ElementKind::Hexahedron20, ElementKind::Pyramid13] {
        let mesh = distorted(kind, true);
        patch(&mesh, &Rules::default(), &format!("curved {kind:?}"));
    }
}

#[test]
fn missing_midside_nodes_keep_the_patch() {
    for kind in SOLIDS {
        if kind.corner_count() == kind.node_count() {
            continue;
        }
        let mut mesh = distorted(kind, false);
        let corners = kind.corner_count();
        for element in mesh.elements.clone() {
            let first = element.first as usize;
            for local in corners..kind.node_count() {
                let node = mesh.connectivity[first + local];
                // the same nodes in all elements, so that neighbours fit
                if node.wrapping_mul(2_654_435_761) >> 30 & 1 == 1 {
                    mesh.connectivity[first + local] = ABSENT;
                }
            }
        }
        assert!(mesh.connectivity.contains(&ABSENT));
        patch(&mesh, &Rules::default(), &format!("partial {kind:?}"));
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        assert!(!structure.unused_nodes.is_empty());
        assert!(agrees(structure.mass.rigid(&mesh).mass, DENSITY, 1e-13));
    }
}

#[test]
fn without_any_midside_node_quadratic_elements_are_linear_ones() {
    for (quadratic, linear) in [
        (ElementKind::Tetrahedron10, ElementKind::Tetrahedron4),
        (ElementKind::Hexahedron20, ElementKind::Hexahedron8),
    ] {
        let make = |kind| bar(kind, [1, 1, 1], [0.3, 0.2, 0.5]);
        let mut mesh = make(quadratic);
        for element in mesh.elements.clone() {
            let first = element.first as usize;
            let range = first + quadratic.corner_count()..first + quadratic.node_count();
            mesh.connectivity[range].fill(ABSENT);
        }
        let one = assemble(&mesh, &Rules::exact()).unwrap();
        let other = make(linear);
        let two = assemble(&other, &Rules::exact()).unwrap();
        assert_eq!(one.freedoms.size(), two.freedoms.size());
        // the same nodes in another order of their numbers: compare the energies of a field
        let wild = |x: [f64; 3]| [x[0] * x[1], 3.0 * x[1] * x[2] - x[0], x[0] * x[2] - x[1]];
        let (u, v) = (field(&mesh, &one, wild), field(&other, &two, wild));
        let stiff = |matrix, x: &[f64]| dot(x, &times(matrix, x));
        assert!(agrees(
            stiff(&one.stiffness, &u),
            stiff(&two.stiffness, &v),
            1e-13
        ));
        let heavy = |mass: &eng_flexible::fe::Mass, x: &[f64]| dot(x, &times(mass, x));
        assert!(agrees(heavy(&one.mass, &u), heavy(&two.mass, &v), 1e-13));
    }
}

#[test]
fn rigid_motions_need_no_force_and_nothing_else_is_free() {
    for kind in SOLIDS {
        let mesh = distorted(kind, false);
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let motions = rigid_motions(&mesh, &structure.freedoms);
        let force = times(&structure.stiffness, &motions);
        let stiffest = largest(structure.stiffness.values());
        assert!(
            largest(&force) < 1e-12 * stiffest,
            "{kind:?}: {}",
            largest(&force)
        );
    }
    // one element: six rigid motions, and the next mode far above
    for kind in SOLIDS {
        let mut mesh = bar(kind, [1, 1, 1], [1.0, 1.0, 1.0]);
        let nodes: Vec<u32> = mesh.nodes_of(&mesh.elements[0]).to_vec();
        mesh.elements.truncate(1);
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        assert_eq!(structure.freedoms.size(), 3 * nodes.len());
        let mass = structure.mass.assembled().unwrap();
        let count = (3 * nodes.len()).min(8);
        let modes = lowest_modes(
            &structure.stiffness,
            &mass,
            Modes::Count(count),
            &EigenOptions::default(),
        )
        .unwrap();
        let values = modes.eigenvalues;
        assert!(values[5].abs() < 1e-9 * values[6], "{kind:?}: {values:?}");
        assert!(values[6] > 1e6, "{kind:?}: {values:?}");
    }
}

/// ∫ xⁿ over 0…l.
fn moment(length: f64, power: i32) -> f64 {
    length.powi(power + 1) / f64::from(power + 1)
}

#[test]
fn mass_properties_of_a_box_are_exact_however_it_is_cut() {
    let size = [0.4, 0.04, 0.06];
    for kind in SOLIDS {
        let mesh = bar(kind, [3, 2, 1], size);
        for rule in [
            MassRule::Exact,
            MassRule::CalculiX,
            MassRule::Abaqus,
            MassRule::Lumped,
        ] {
            let rules = Rules {
                mass: rule,
                ..Rules::default()
            };
            let structure = assemble(&mesh, &rules).unwrap();
            let rigid = structure.mass.rigid(&mesh);
            let mass = DENSITY * size.iter().product::<f64>();
            assert!(agrees(rigid.mass, mass, 1e-13), "{kind:?} {rule:?}");
            if rule != MassRule::Exact {
                continue;
            }
            for (axis, centre) in rigid.centre().iter().enumerate() {
                assert!(agrees(*centre, 0.5 * size[axis], 1e-13), "{kind:?}");
            }
            for i in 0..3 {
                for j in 0..3 {
                    let exact = if i == j {
                        let (a, b) = (size[(i + 1) % 3], size[(i + 2) % 3]);
                        mass * (a * a + b * b) / 3.0
                    } else {
                        -mass * size[i] * size[j] / 4.0
                    };
                    assert!(
                        agrees(rigid.inertia[i][j], exact, 1e-12),
                        "{kind:?} {i} {j}"
                    );
                }
            }
        }
    }
}

#[test]
fn curved_elements_have_their_exact_mass() {
    // x = X + a Z², y = Y + b X²: volume is kept, and quadratic elements have these shapes exactly
    let (a, b) = (0.9, 0.6);
    let [lx, ly, lz] = [0.4, 0.3, 0.5];
    for kind in SOLIDS {
        if kind.corner_count() == kind.node_count() {
            continue;
        }
        let mesh = grid(kind, [2, 1, 2], true, |t| {
            let [x, y, z] = [t[0] * lx / 2.0, t[1] * ly, t[2] * lz / 2.0];
            [x + a * z * z, y + b * x * x, z]
        });
        let rigid = assemble(&mesh, &Rules::default())
            .unwrap()
            .mass
            .rigid(&mesh);
        let x = |n| moment(lx, n);
        let y = |n| moment(ly, n);
        let z = |n| moment(lz, n);
        let mass = DENSITY * x(0) * y(0) * z(0);
        let xx = DENSITY * y(0) * (x(2) * z(0) + 2.0 * a * x(1) * z(2) + a * a * x(0) * z(4));
        let yy = DENSITY * z(0) * (x(0) * y(2) + 2.0 * b * x(2) * y(1) + b * b * x(4) * y(0));
        let zz = DENSITY * x(0) * y(0) * z(2);
        let xy = DENSITY
            * (x(1) * y(1) * z(0)
                + b * x(3) * y(0) * z(0)
                + a * x(0) * y(1) * z(2)
                + a * b * x(2) * y(0) * z(2));
        assert!(agrees(rigid.mass, mass, 1e-13), "{kind:?}");
        let first = DENSITY * y(0) * (x(1) * z(0) + a * x(0) * z(2));
        assert!(agrees(rigid.first_moment[0], first, 1e-13), "{kind:?}");
        assert!(agrees(rigid.inertia[0][0], yy + zz, 1e-12), "{kind:?}");
        assert!(agrees(rigid.inertia[1][1], xx + zz, 1e-12), "{kind:?}");
        assert!(agrees(rigid.inertia[2][2], xx + yy, 1e-12), "{kind:?}");
        assert!(agrees(-rigid.inertia[0][1], xy, 1e-12), "{kind:?}");
    }
}

#[test]
fn lumped_masses_are_diagonal_and_positive() {
    for kind in SOLIDS {
        let mesh = distorted(kind, false);
        let rules = Rules {
            mass: MassRule::Lumped,
            ..Rules::default()
        };
        let structure = assemble(&mesh, &rules).unwrap();
        let solid = &structure.mass.solid;
        for node in 0..solid.size() {
            let (rows, values) = solid.column(node);
            for (row, value) in rows.iter().zip(values) {
                if *row as usize == node {
                    assert!(*value > 0.0, "{kind:?}");
                } else {
                    assert_eq!(*value, 0.0, "{kind:?}");
                }
            }
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for kind in [ElementKind::Tetrahedron10, ElementKind::Wedge15] {
        let mesh = grid(kind, [7, 6, 6], false, |x| {
            [0.1 * x[0], 0.11 * x[1], 0.12 * x[2]]
        });
        let one = assemble_on(&mesh, &Rules::default(), 1).unwrap();
        for threads in [2, 3, 7, 40] {
            let many = assemble_on(&mesh, &Rules::default(), threads).unwrap();
            assert!(one == many, "{threads} threads");
        }
    }
}

#[test]
fn the_operator_and_the_assembled_mass_are_the_same() {
    let mesh = distorted(ElementKind::Wedge15, false);
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let assembled = structure.mass.assembled().unwrap();
    let mut wave = field(&mesh, &structure, |x| {
        [x[0] - x[2], x[1] * x[1], 1.0 + x[0] * x[2]]
    });
    let second = wave.iter().map(|x| 1.0 - x).collect::<Vec<_>>();
    wave.extend(second);
    let (x, y) = (times(&structure.mass, &wave), times(&assembled, &wave));
    for (a, b) in x.iter().zip(&y) {
        assert!((a - b).abs() < 1e-13 * largest(&x));
    }
}
