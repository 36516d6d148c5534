//! Beams, springs and point masses against closed forms.

use crate::fe_meshes::*;
use eng_flexible::fe::mass::rigid_motions;
use eng_flexible::fe::{Assembled, Reduction, Rules, assemble};
use eng_flexible::mesh::{
    BeamAxes, BeamSection, ElementKind, Frame, Mesh, PointMass, Section, ShellSection, Spring,
    Support,
};
use eng_flexible::solve::{EigenOptions, Modes, lowest_modes};

const AREA: f64 = 3e-4;
const MOMENT_Z: f64 = 4e-9;
const MOMENT_Y: f64 = 9e-9;
const PRODUCT: f64 = 2.5e-9;
const TORSION: f64 = 7e-9;
const SHEAR: [f64; 2] = [0.8, 0.6];
const MODULUS: f64 = YOUNG / (2.0 * (1.0 + POISSON));

fn section(product: f64) -> Section {
    Section::Beam(BeamSection {
        area: AREA,
        moment_z: MOMENT_Z,
        moment_y: MOMENT_Y,
        product,
        torsion: TORSION,
        shear: SHEAR,
        mass_per_length: 0.0,
    })
}

fn axes(orientation: [f64; 3]) -> BeamAxes {
    BeamAxes {
        centroid: [0.0; 2],
        orientation,
        offsets: [[0.0; 3]; 2],
        released: [0; 2],
    }
}

/// A beam from the origin along `axis` in this number of pieces.
fn line(axis: [f64; 3], pieces: u32, section: Section, orientation: [f64; 3]) -> Mesh {
    let mut mesh = empty();
    for i in 0..=pieces {
        let share = f64::from(i) / f64::from(pieces);
        add_node(&mut mesh, axis.map(|x| share * x));
    }
    for i in 0..pieces {
        add_beam(&mut mesh, section, axes(orientation), [i, i + 1]);
    }
    mesh
}

fn cantilever(mesh: &Mesh) -> (Assembled, Reduction) {
    let structure = assemble(mesh, &Rules::default()).unwrap();
    let reduction = Reduction::new(mesh, &structure, &held(&[0], 0b111111)).unwrap();
    (structure, reduction)
}

/// Displacement of a node under a force on it.
fn push(structure: &Assembled, reduction: &Reduction, node: u32, force: [f64; 6]) -> [f64; 6] {
    let mut full = vec![0.0; structure.freedoms.size()];
    let range = structure.freedoms.of(node);
    full[range.clone()].copy_from_slice(&force);
    let displacement = solve(structure, reduction, &full);
    std::array::from_fn(|i| displacement[range.start + i])
}

#[test]
fn a_cantilever_bends_shears_twists_and_stretches_as_timoshenko_says() {
    let length = 0.7;
    for pieces in [1, 3] {
        let mesh = line([length, 0.0, 0.0], pieces, section(0.0), [0.0, 1.0, 0.0]);
        let (structure, reduction) = cantilever(&mesh);
        let bend = |force, component: usize| push(&structure, &reduction, pieces, force)[component];
        let cube = length * length * length / 3.0;
        let square = length * length / 2.0;
        let cases = [
            ([1.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0, length / (YOUNG * AREA)),
            (
                [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
                1,
                cube / (YOUNG * MOMENT_Z) + length / (SHEAR[0] * MODULUS * AREA),
            ),
            (
                [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
                5,
                square / (YOUNG * MOMENT_Z),
            ),
            (
                [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
                2,
                cube / (YOUNG * MOMENT_Y) + length / (SHEAR[1] * MODULUS * AREA),
            ),
            (
                [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
                4,
                -square / (YOUNG * MOMENT_Y),
            ),
            (
                [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
                3,
                length / (MODULUS * TORSION),
            ),
            (
                [0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
                4,
                length / (YOUNG * MOMENT_Y),
            ),
            (
                [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
                5,
                length / (YOUNG * MOMENT_Z),
            ),
        ];
        for (force, component, exact) in cases {
            let found = bend(force, component);
            assert!(agrees(found, exact, 1e-9), "{force:?}: {found} {exact}");
        }
    }
}

#[test]
fn a_section_with_a_product_of_moments_bends_as_in_its_principal_axes() {
    // the same section described in axes turned by an angle
    let (length, angle) = (0.5, 0.4_f64);
    let (major, minor) = (9e-9, 4e-9);
    let (sine, cosine) = angle.sin_cos();
    // in axes y', z' that are turned by the angle about x, y' = c y + s z: I_z' = ∫ y'² and so on
    let turned = Section::Beam(BeamSection {
        area: AREA,
        moment_z: major * cosine * cosine + minor * sine * sine,
        moment_y: major * sine * sine + minor * cosine * cosine,
        product: (minor - major) * sine * cosine,
        torsion: TORSION,
        shear: [0.7, 0.7],
        mass_per_length: 0.3,
    });
    let principal = Section::Beam(BeamSection {
        area: AREA,
        moment_z: major,
        moment_y: minor,
        product: 0.0,
        torsion: TORSION,
        shear: [0.7, 0.7],
        mass_per_length: 0.3,
    });
    let one = line([length, 0.0, 0.0], 2, principal, [0.0, 1.0, 0.0]);
    let two = line([length, 0.0, 0.0], 2, turned, [0.0, cosine, sine]);
    let first = assemble(&one, &Rules::default()).unwrap();
    let second = assemble(&two, &Rules::default()).unwrap();
    let most = largest(first.stiffness.values());
    for (x, y) in first
        .stiffness
        .values()
        .iter()
        .zip(second.stiffness.values())
    {
        assert!((x - y).abs() < 1e-12 * most, "{x} {y}");
    }
    let x = first.mass.assembled().unwrap();
    let y = second.mass.assembled().unwrap();
    let size = first.freedoms.size();
    for column in 0..size {
        let unit: Vec<f64> = (0..size)
            .map(|i| f64::from(u8::from(i == column)))
            .collect();
        let (a, b) = (times(&x, &unit), times(&y, &unit));
        for (p, q) in a.iter().zip(&b) {
            assert!((p - q).abs() < 1e-13 * largest(&a), "{p} {q}");
        }
    }
}

#[test]
fn rigid_motions_of_beams_with_offsets_cost_nothing_and_have_their_mass() {
    let mut mesh = empty();
    add_node(&mut mesh, [0.3, -0.2, 0.1]);
    add_node(&mut mesh, [0.9, 0.4, -0.3]);
    let offsets = [[0.05, 0.02, -0.04], [-0.03, 0.06, 0.01]];
    let beam = BeamAxes {
        centroid: [0.0; 2],
        offsets,
        ..axes([0.1, 0.2, 1.0])
    };
    add_beam(&mut mesh, section(PRODUCT), beam, [0, 1]);
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let motions = rigid_motions(&mesh, &structure.freedoms);
    let force = times(&structure.stiffness, &motions);
    assert!(largest(&force) < 1e-12 * largest(structure.stiffness.values()));
    // a rod between the ends, with the inertia of its sections
    let ends: Vec<[f64; 3]> = (0..2)
        .map(|i: usize| {
            let p = mesh.nodes[i].position;
            [0, 1, 2].map(|k: usize| p[k] + offsets[i][k])
        })
        .collect();
    let along = [0, 1, 2].map(|k: usize| ends[1][k] - ends[0][k]);
    let length = dot(&along, &along).sqrt();
    let mass = DENSITY * AREA * length;
    let rigid = structure.mass.rigid(&mesh);
    assert!(agrees(rigid.mass, mass, 1e-12));
    for (axis, centre) in rigid.centre().iter().enumerate() {
        assert!(agrees(
            *centre,
            0.5 * (ends[0][axis] + ends[1][axis]),
            1e-12
        ));
    }
    // trace of the inertia: 2 ∫ r² dm + ρ (I_y + I_z) · 2
    let square = |k: usize| {
        (ends[0][k] * ends[0][k] + ends[0][k] * ends[1][k] + ends[1][k] * ends[1][k]) / 3.0
    };
    let spread = mass * (square(0) + square(1) + square(2));
    let trace = 2.0 * spread + 2.0 * DENSITY * length * (MOMENT_Y + MOMENT_Z);
    let found: f64 = (0..3).map(|k| rigid.inertia[k][k]).sum();
    assert!(agrees(found, trace, 1e-12), "{found} {trace}");
}

/// A free square steel bar, 20 mm × 20 mm × 0.5 m: exact roots of Timoshenko's frequency equation with
/// Cowper's shear factor 10 (1 + ν)/(12 + 11 ν), and of the free rod.
#[test]
fn a_free_beam_has_timoshenko_frequencies() {
    let side: f64 = 0.02;
    let square = Section::Beam(BeamSection {
        area: side * side,
        moment_z: side.powi(4) / 12.0,
        moment_y: side.powi(4) / 12.0,
        product: 0.0,
        torsion: 0.1406 * side.powi(4),
        shear: [0.8496732026143791; 2],
        mass_per_length: 0.0,
    });
    let lowest = |pieces: u32| {
        let mesh = line([0.3, 0.0, 0.4], pieces, square, [0.0, 1.0, 0.0]);
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let mass = structure.mass.assembled().unwrap();
        let request = Modes::Count(16);
        let options = EigenOptions::default();
        let modes = lowest_modes(&structure.stiffness, &mass, request, &options).unwrap();
        frequencies(&modes.eigenvalues)
    };
    // the static shapes converge with the square of the elements' length, so that two meshes tell the limit
    let (coarse, fine) = (lowest(96), lowest(192));
    let limit: Vec<f64> = coarse
        .iter()
        .zip(&fine)
        .map(|(x, y)| y + (y - x) / 3.0)
        .collect();
    let exact = [
        422.8854829143632,
        422.8854829143632,
        1153.489916921878,
        1153.489916921878,
        2227.691710262104,
        2227.691710262104,
    ];
    for (found, exact) in limit[6..].iter().zip(exact) {
        assert!(agrees(*found, exact, 1e-7), "{found} {exact}");
    }
    assert!(fine.iter().zip(&coarse).skip(6).all(|(x, y)| x < y));
    let rod = 5172.194153034851;
    assert!(limit.iter().any(|f| agrees(*f, rod, 1e-6)), "{limit:?}");
}

#[test]
fn releases_make_hinges() {
    // clamped at the left, simply resting on a hinged beam at the right: the hinge carries force and no moment
    let mut mesh = line([1.0, 0.0, 0.0], 2, section(0.0), [0.0, 1.0, 0.0]);
    mesh.beam_axes[1].released = [0b110000, 0];
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let supports = held(&[0, 2], 0b111111);
    let reduction = Reduction::new(&mesh, &structure, &supports).unwrap();
    // two cantilevers of half a metre meet at the hinge, but only the left one's end turns with the node
    let flexible = 0.125 / (3.0 * YOUNG * MOMENT_Z) + 0.5 / (SHEAR[0] * MODULUS * AREA);
    let found = push(&structure, &reduction, 1, [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(agrees(found[1], 0.5 * flexible, 1e-9), "{found:?}");
    let slope = 0.25 * 0.5 / (2.0 * YOUNG * MOMENT_Z);
    assert!(agrees(found[5], slope, 1e-9), "{found:?}");
    // the mass is complete
    let rigid = structure.mass.rigid(&mesh);
    assert!(agrees(rigid.mass, DENSITY * AREA, 1e-12));
    // hinges at both ends about the axis: it spins
    mesh.beam_axes[1].released = [0b001000, 0b001000];
    let message = problem(assemble(&mesh, &Rules::default()));
    assert!(
        message.contains("beam 2") && message.contains("mechanism"),
        "{message}"
    );
}

#[test]
fn a_rod_carries_only_its_axis() {
    let rod = Section::Beam(BeamSection {
        area: AREA,
        moment_z: 0.0,
        moment_y: 0.0,
        product: 0.0,
        torsion: 0.0,
        shear: [0.0; 2],
        mass_per_length: 1.5,
    });
    let mesh = line([0.0, 0.5, 0.0], 1, rod, [0.0, 0.0, 1.0]);
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let mass = (DENSITY * AREA + 1.5) * 0.5;
    let rigid = structure.mass.rigid(&mesh);
    assert!(agrees(rigid.mass, mass, 1e-13));
    assert!(agrees(rigid.inertia[0][0], mass * 0.25 / 3.0, 1e-13));
    let message = problem(
        Reduction::new(&mesh, &structure, &[])
            .unwrap()
            .reduce_stiffness(&structure.stiffness),
    );
    assert!(message.contains("component 1 of node 1"), "{message}");
    let axial: Vec<Support> = vec![
        Support {
            node: 0,
            components: 0b111111,
        },
        Support {
            node: 1,
            components: 0b111101,
        },
    ];
    let reduction = Reduction::new(&mesh, &structure, &axial).unwrap();
    let found = push(&structure, &reduction, 1, [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(agrees(found[1], 0.5 / (YOUNG * AREA), 1e-12));
}

#[test]
fn springs_act_along_their_frames() {
    let mut mesh = line([0.5, 0.0, 0.0], 1, section(0.0), [0.0, 1.0, 0.0]);
    // frame → basic: a quarter turn about z, so that local x is basic y
    mesh.frames.push(Frame {
        rotation: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    });
    mesh.nodes[1].frame = Some(0);
    let soft = 1e3;
    mesh.springs.push(Spring::between(7, soft, (1, 0), None));
    mesh.springs
        .push(Spring::between(8, 250.0, (1, 5), Some((0, 5))));
    let (structure, reduction) = cantilever(&mesh);
    let free = line([0.5, 0.0, 0.0], 1, section(0.0), [0.0, 1.0, 0.0]);
    let (plain, _) = cantilever(&free);
    let (a, b) = (structure.freedoms.of(1).start, plain.freedoms.of(1).start);
    let entry = |structure: &Assembled, i: usize| structure.stiffness.column(i).1[0];
    assert!(agrees(
        entry(&structure, a + 1),
        entry(&plain, b + 1) + soft,
        1e-14
    ));
    assert_eq!(entry(&structure, a), entry(&plain, b));
    assert!(agrees(
        entry(&structure, a + 5),
        entry(&plain, b + 5) + 250.0,
        1e-14
    ));
    // a spring from the ground in parallel with the beam's tip
    let bending = 0.125 / (3.0 * YOUNG * MOMENT_Z) + 0.5 / (SHEAR[0] * MODULUS * AREA);
    mesh.springs.truncate(1);
    let (structure, _) = cantilever(&mesh);
    let reduction_of = Reduction::new(&mesh, &structure, &held(&[0], 63)).unwrap();
    let found = push(&structure, &reduction_of, 1, [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(agrees(found[1], 1.0 / (1.0 / bending + soft), 1e-9));
    assert_eq!(reduction.size(), 6);
}

#[test]
fn an_offset_point_mass_has_its_place_and_inertia() {
    let mut mesh = bar(ElementKind::Hexahedron8, [1, 1, 1], [1.0, 1.0, 1.0]);
    let steel = assemble(&mesh, &Rules::default())
        .unwrap()
        .mass
        .rigid(&mesh);
    let node = nodes_where(&mesh, |x| x == [1.0, 1.0, 1.0])[0];
    // mass m at c from the node, inertia j about its own centre: [m I, −m c~; m c~, j − m c~ c~]
    let (m, c, j) = (12.0, [0.1, -0.2, 0.3], [0.4, 0.5, 0.6]);
    let skew = [[0.0, -c[2], c[1]], [c[2], 0.0, -c[0]], [-c[1], c[0], 0.0]];
    let mut matrix = [[0.0; 6]; 6];
    for i in 0..3 {
        matrix[i][i] = m;
        matrix[3 + i][3 + i] = j[i];
        for k in 0..3 {
            matrix[i][3 + k] = -m * skew[i][k];
            matrix[3 + k][i] = -m * skew[i][k];
            let product: f64 = skew[i].iter().zip(skew).map(|(x, row)| x * row[k]).sum();
            matrix[3 + i][3 + k] -= m * product;
        }
    }
    mesh.point_masses.push(PointMass {
        id: 3,
        node,
        matrix,
    });
    mesh.point_masses.push(PointMass {
        id: 4,
        node: 0,
        matrix: std::array::from_fn(|i| {
            std::array::from_fn(|k| if i == k && i < 3 { 5.0 } else { 0.0 })
        }),
    });
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    assert!(structure.freedoms.has_rotation(node));
    assert!(!structure.freedoms.has_rotation(0));
    let rigid = structure.mass.rigid(&mesh);
    assert!(agrees(rigid.mass, steel.mass + m + 5.0, 1e-14));
    let at = [1.1, 0.8, 1.3];
    for axis in 0..3 {
        let first = steel.first_moment[axis] + m * at[axis];
        assert!(agrees(rigid.first_moment[axis], first, 1e-13));
        let (y, z) = (at[(axis + 1) % 3], at[(axis + 2) % 3]);
        let inertia = steel.inertia[axis][axis] + j[axis] + m * (y * y + z * z);
        assert!(agrees(rigid.inertia[axis][axis], inertia, 1e-13));
    }
    let product = steel.inertia[0][1] - m * at[0] * at[1];
    assert!(agrees(rigid.inertia[0][1], product, 1e-13));
}

#[test]
fn shells_without_a_material_weigh_and_carry_nothing() {
    for (solid, kind, take) in [
        (
            ElementKind::Hexahedron8,
            ElementKind::Quadrilateral4,
            [0usize, 3, 2, 1, 0, 0, 0, 0],
        ),
        (
            ElementKind::Hexahedron20,
            ElementKind::Quadrilateral8,
            [0, 3, 2, 1, 11, 10, 9, 8],
        ),
        (
            ElementKind::Hexahedron8,
            ElementKind::Triangle3,
            [0, 2, 1, 0, 0, 0, 0, 0],
        ),
    ] {
        let mut mesh = bar(solid, [1, 1, 1], [0.4, 0.3, 0.2]);
        let bare = assemble(&mesh, &Rules::default()).unwrap();
        let before = bare.mass.rigid(&mesh);
        let mut property = mesh.properties[0].clone();
        property.material = None;
        property.section = Section::Shell(ShellSection {
            mass_per_area: 1.1,
            ..ShellSection::plate(0.002)
        });
        mesh.properties.push(property);
        let own = mesh.nodes_of(&mesh.elements[0]).to_vec();
        let nodes: Vec<u32> = take[..kind.node_count()].iter().map(|i| own[*i]).collect();
        add_element(&mut mesh, kind, 1, &nodes);
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        assert_eq!(structure.without_stiffness, [1]);
        assert_eq!(structure.stiffness.values(), bare.stiffness.values());
        let after = structure.mass.rigid(&mesh);
        let area = if kind == ElementKind::Triangle3 {
            0.06
        } else {
            0.12
        };
        let mass = area * 1.1;
        assert!(agrees(after.mass - before.mass, mass, 1e-12), "{kind:?}");
        if kind != ElementKind::Triangle3 {
            let about_z = mass * (0.4 * 0.4 + 0.3 * 0.3) / 3.0;
            let found = after.inertia[2][2] - before.inertia[2][2];
            assert!(agrees(found, about_z, 1e-11), "{kind:?}: {found} {about_z}");
        }
    }
}
