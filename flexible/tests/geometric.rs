//! Geometric stiffness against turns, buckling loads, a rotating beam of the literature, and whirling discs.

use eng_flexible::fe::geometric::GeometricStiffness;
use eng_flexible::fe::mass::rigid_motions;
use eng_flexible::fe::{Reduction, Rules, assemble};
use eng_flexible::markers::{MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::mesh::{BeamAxes, BeamSection, ElementKind, Mesh, Section, Set, Tie};
use eng_flexible::reduce::{Interface, Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_system::reduced::{Geometric, Invariants};
use nalgebra::DMatrix;
use serde_json::Value;
use std::f64::consts::PI;

use crate::fe_meshes::*;

const ALL: u8 = 0b11_1111;

fn cross(a: [f64; 3], b: &[f64]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// In a loaded body that turns the inner forces of its nodes turn, too. In one that is moved they do not change.
#[test]
fn turned_stress_turns_its_forces() {
    for kind in SOLIDS {
        let mesh = distorted(kind, true);
        let full = assemble(&mesh, &Rules::default()).unwrap();
        let u = field(&mesh, &full, |x| {
            [
                1e-3 * (x[0] * x[1] - 0.3 * x[2]),
                2e-3 * (x[2] * x[2] + x[0]),
                1e-3 * (0.4 * x[1] - x[0] * x[2]),
            ]
        });
        let forces = times(&full.stiffness, &u);
        let matrix =
            GeometricStiffness::of_displacements(&mesh, &full.freedoms, &Rules::default(), &u)
                .unwrap()
                .remove(0);
        let motions = rigid_motions(&mesh, &full.freedoms);
        let found = times(&matrix, &motions);
        let size = full.freedoms.size();
        let scale = largest(&forces);
        assert!(scale > 1e3);
        for (k, found) in found.chunks_exact(size).enumerate() {
            for (force, found) in forces.chunks_exact(3).zip(found.chunks_exact(3)) {
                let mut axis = [0.0; 3];
                axis[k % 3] = 1.0;
                let expected = if k < 3 { [0.0; 3] } else { cross(axis, force) };
                for (x, y) in found.iter().zip(expected) {
                    assert!((x - y).abs() < 1e-11 * scale, "{kind:?} {k}: {x} {y}");
                }
            }
        }
    }
}

const RECTANGLE: [f64; 2] = [0.009, 0.012];

/// A solid rectangle of sides along y and z.
fn rectangle([y, z]: [f64; 2], torsion: f64) -> Section {
    Section::Beam(BeamSection {
        area: y * z,
        moment_z: z * y * y * y / 12.0,
        moment_y: y * z * z * z / 12.0,
        product: 0.0,
        torsion,
        shear: [5.0 / 6.0; 2],
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

fn add_line(mesh: &mut Mesh, from: u32, to: [f64; 3], pieces: u32, section: Section) -> u32 {
    let start = mesh.nodes[from as usize].position;
    let mut before = from;
    for i in 1..=pieces {
        let share = f64::from(i) / f64::from(pieces);
        let place = [0, 1, 2].map(|k: usize| start[k] + share * (to[k] - start[k]));
        let next = add_node(mesh, place);
        add_beam(mesh, section, axes([0.3, 0.4, 1.0]), [before, next]);
        before = next;
    }
    before
}

/// Free beams: a tension turns with them, and inclined fibres resist a twist.
#[test]
fn a_pulled_beam_turns_its_forces_and_resists_a_twist() {
    let mut mesh = empty();
    add_node(&mut mesh, [0.1, -0.2, 0.3]);
    let end = add_line(&mut mesh, 0, [0.5, 0.3, 0.7], 3, rectangle(RECTANGLE, 1e-9));
    let full = assemble(&mesh, &Rules::default()).unwrap();
    let along = [0.4, 0.5, 0.4].map(|x: f64| x / 0.57_f64.sqrt());
    let length = 0.57_f64.sqrt();
    let strain = 1e-4;
    let u = field(&mesh, &full, |x| {
        let s: f64 = (0..3)
            .map(|k| along[k] * (x[k] - [0.1, -0.2, 0.3][k]))
            .sum();
        along.map(|d| strain * s * d)
    });
    let forces = times(&full.stiffness, &u);
    let tension = YOUNG * RECTANGLE[0] * RECTANGLE[1] * strain;
    assert!(agrees(largest(&forces), tension * along[1], 1e-9));
    let matrix = GeometricStiffness::of_displacements(&mesh, &full.freedoms, &Rules::default(), &u)
        .unwrap()
        .remove(0);
    let motions = rigid_motions(&mesh, &full.freedoms);
    let size = full.freedoms.size();
    // a turn about the beam's own axis through the origin moves it, but strains no fibre otherwise
    for k in 0..3 {
        let mut axis = [0.0; 3];
        axis[k] = 1.0;
        let turn = &motions[(3 + k) * size..(4 + k) * size];
        let found = times(&matrix, turn);
        for node in 0..=end {
            let own = full.freedoms.of(node);
            let expected = cross(axis, &forces[own.start..own.start + 3]);
            for (x, y) in found[own.start..own.start + 3].iter().zip(expected) {
                assert!((x - y).abs() < 1e-9 * tension, "{k} {node}: {x} {y}");
            }
        }
    }
    // twist: N (I_y + I_z)/A θ'² L
    let mut twist = vec![0.0; size];
    for (node, place) in mesh.nodes.iter().enumerate() {
        let share = (place.position[0] - 0.1) / 0.4;
        for k in 0..3 {
            twist[full.freedoms.of(node as u32).start + 3 + k] = share * along[k];
        }
    }
    let energy = dot(&twist, &times(&matrix, &twist));
    let gyration = (RECTANGLE[0] * RECTANGLE[0] + RECTANGLE[1] * RECTANGLE[1]) / 12.0;
    assert!(
        agrees(energy, tension * gyration / length, 1e-9),
        "{energy}"
    );
}

fn request(markers: Vec<MarkerRequest>, support: Vec<Interface>, terms: Vec<Term>) -> Request {
    Request {
        rules: Rules::default(),
        markers,
        support,
        terms,
        damping_ratio: 0.0,
        damping_up_to: f64::INFINITY,
        geometric_stiffness: true,
        ..Request::default()
    }
}

fn at_node(name: &str, mesh: &Mesh, node: u32) -> MarkerRequest {
    MarkerRequest {
        axes: eng_flexible::markers::MESH_AXES,
        name: name.into(),
        place: MarkerPlace::Node(mesh.nodes[node as usize].id),
    }
}

fn all(marker: usize) -> Interface {
    Interface {
        marker,
        components: ALL,
    }
}

fn square(n: usize, block: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(n, n, block)
}

fn geometric(constants: &Invariants) -> &Geometric {
    constants.geometric.as_ref().unwrap()
}

/// The smallest pressure under which k − P Kσ is not positive definite any more.
fn buckling(reduced: &Reduced, component: u8) -> f64 {
    let c = &reduced.body.invariants;
    let n = c.modes;
    let load = geometric(c).loads.iter().find(|l| l.component == component);
    let matrix = square(n, &load.unwrap().stiffness);
    let scale = square(n, &c.stiffness).map_diagonal(|x| 1.0 / x.sqrt());
    let scaled = DMatrix::from_fn(n, n, |i, j| scale[i] * matrix[(i, j)] * scale[j]);
    1.0 / scaled.symmetric_eigenvalues().max()
}

#[test]
fn a_pressed_column_buckles_under_eulers_load() {
    let (length, [y, z]) = (0.6, RECTANGLE);
    let euler = PI * PI * YOUNG * z * y * y * y / 12.0 / (4.0 * length * length);
    let normal = Term::Normal {
        modes: Modes::Count(6),
        fixed: vec![],
    };
    let terms = vec![Term::Static(vec![all(1)]), normal];

    let mut mesh = empty();
    add_node(&mut mesh, [0.0; 3]);
    let section = Section::Beam(BeamSection {
        area: y * z,
        moment_z: z * y * y * y / 12.0,
        moment_y: y * z * z * z / 12.0,
        product: 0.0,
        torsion: 1e-9,
        shear: [0.0; 2],
        mass_per_length: 0.0,
    });
    let tip = add_line(&mut mesh, 0, [length, 0.0, 0.0], 8, section);
    let markers = vec![at_node("root", &mesh, 0), at_node("tip", &mesh, tip)];
    let beam = reduce(mesh, &request(markers, vec![all(0)], terms.clone())).unwrap();
    let found = buckling(&beam, 0);
    println!("beam {:.2e}", found / euler - 1.0);
    assert!(agrees(found, euler, 1e-4), "{found} {euler}");

    let mut mesh = bar(ElementKind::Hexahedron20, [16, 1, 1], [length, y, z]);
    // so that its root does not hinder it from growing thicker
    mesh.materials[0].poisson = 0.0;
    for (name, x) in [("root", 0.0), ("tip", length)] {
        let nodes = nodes_where(&mesh, |p| (p[0] - x).abs() < 1e-9);
        let set = Set::new(nodes, vec![]);
        mesh.sets.insert(name.into(), set);
    }
    let marker = |name: &str, tie| MarkerRequest {
        axes: eng_flexible::markers::MESH_AXES,
        name: name.into(),
        place: MarkerPlace::Gathered {
            nodes: Selection::Set(name.into()),
            tie,
            center: None,
        },
    };
    let markers = vec![
        marker("root", Spider::Rigid),
        marker("tip", Spider::Averaging),
    ];
    let solid = reduce(mesh, &request(markers, vec![all(0)], terms)).unwrap();
    let found = buckling(&solid, 0);
    println!("solid {:.2e}", found / euler - 1.0);
    assert!(agrees(found, euler, 1e-3), "{found} {euler}");
}

/// A column under its own weight buckles at q L³/EI = 7.8373 (A. G. Greenhill, Proc. Camb. Phil. Soc. 4,
/// 1881); loads of angular acceleration and of two spins along an offset beam are those of an acceleration
/// along it.
#[test]
fn a_column_buckles_under_its_own_weight() {
    let (length, away, [y, z]) = (0.6, 0.25, RECTANGLE);
    let mut mesh = empty();
    add_node(&mut mesh, [0.0, away, 0.0]);
    let section = rectangle(RECTANGLE, 1e-9);
    let tip = add_line(&mut mesh, 0, [length, away, 0.0], 32, section);
    let markers = vec![at_node("root", &mesh, 0), at_node("tip", &mesh, tip)];
    let normal = Term::Normal {
        modes: Modes::Count(8),
        fixed: vec![],
    };
    let reduced = reduce(mesh, &request(markers, vec![all(0)], vec![normal])).unwrap();
    let c = &reduced.body.invariants;
    let (n, blocks) = (c.modes, geometric(c));
    // the root is held
    assert!(blocks.loads.len() == 6 && blocks.loads.iter().all(|load| load.marker == 1));
    let scale = square(n, &c.stiffness).map_diagonal(|x| 1.0 / x.sqrt());
    let weight = square(n, &blocks.acceleration[0]);
    let scaled = DMatrix::from_fn(n, n, |i, j| -scale[i] * weight[(i, j)] * scale[j]);
    let critical = 1.0 / scaled.symmetric_eigenvalues().max();
    let bending = YOUNG * z * y * y * y / 12.0;
    let exact = 7.8373 * bending / (DENSITY * y * z * length.powi(3));
    assert!(agrees(critical, exact, 2e-3), "{critical} {exact}");
    let largest = weight.amax();
    for (block, factor) in [(&blocks.turn[2], -away), (&blocks.spin[3], away)] {
        let miss = (square(n, block) - &weight * factor).amax();
        assert!(miss < 1e-9 * largest, "{miss:e}");
    }
}

/// Frequencies (Hz, ascending) of small motion in a frame that turns at a constant rate.
fn turning(c: &Invariants, omega: [f64; 3], stiffened: bool) -> Vec<f64> {
    let n = c.modes;
    let mass = square(n, &c.modal_mass);
    let (mut k, mut g) = (square(n, &c.stiffness), DMatrix::zeros(n, n));
    for (p, (i, j)) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
        .into_iter()
        .enumerate()
    {
        let factor = omega[i] * omega[j];
        let both = if i == j { 1.0 } else { 2.0 };
        k -= square(n, &c.centrifugal[p]) * (both * factor);
        if stiffened {
            k += square(n, &geometric(c).spin[p]) * factor;
        }
    }
    for (axis, block) in c.coriolis.iter().enumerate() {
        let block = square(n, block);
        g += (&block - block.transpose()) * omega[axis];
    }
    let inverse = mass.try_inverse().unwrap();
    let mut first = DMatrix::zeros(2 * n, 2 * n);
    first.view_mut((0, n), (n, n)).fill_with_identity();
    first.view_mut((n, 0), (n, n)).copy_from(&-(&inverse * k));
    first.view_mut((n, n), (n, n)).copy_from(&-(&inverse * g));
    let mut found: Vec<f64> = first
        .complex_eigenvalues()
        .iter()
        .filter(|x| x.im > 0.0)
        .map(|x| x.im / (2.0 * PI))
        .collect();
    found.sort_by(f64::total_cmp);
    found
}

/// Two beams at a right angle, the first clamped to a turning frame: numbers of the literature, and the result without
/// geometric stiffness.
#[test]
fn a_rotating_angled_beam_stiffens_as_published() {
    let reference: Value =
        serde_json::from_str(include_str!("data/rotating_angled_beam.json")).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let problem = &reference["problem"];
    let tolerance = number(&reference["tolerance"]);

    let mut mesh = empty();
    mesh.materials.clear();
    let mut at = 0;
    add_node(&mut mesh, [0.0; 3]);
    let mut end = [0.0; 3];
    for (index, (name, axis, pieces)) in [("beam1", 0, 10), ("beam2", 1, 4)].into_iter().enumerate()
    {
        let own = &problem[name];
        let (h, w) = (number(&own["h"]), number(&own["w"]));
        end[axis] += number(&own["l"]);
        let elements = mesh.elements.len();
        at = add_line(
            &mut mesh,
            at,
            end,
            pieces,
            rectangle([h, w], 0.1406 * h * h * w * w),
        );
        mesh.materials.push(eng_flexible::mesh::Material {
            name: name.into(),
            young: number(&own["E"]),
            poisson: number(&own["nu"]),
            density: number(&own["rho"]),
            sheet: None,
            solid: None,
        });
        for element in elements..mesh.elements.len() {
            let property = mesh.elements[element].property as usize;
            mesh.properties[property].material = Some(index as u32);
        }
    }
    let terms = vec![Term::Normal {
        modes: Modes::Count(12),
        fixed: vec![],
    }];
    let markers = vec![at_node("root", &mesh, 0)];
    let reduced = reduce(mesh, &request(markers, vec![all(0)], terms)).unwrap();
    let c = &reduced.body.invariants;
    let list =
        |value: &Value| -> Vec<f64> { value.as_array().unwrap().iter().map(number).collect() };
    let frequencies = &reference["frequencies_hz"];
    let modes = list(&frequencies["modes"]);
    let found = |omega: f64, stiffened| -> Vec<f64> {
        let all = turning(c, [0.0, 0.0, omega], stiffened);
        println!("{omega} {stiffened}: {all:.3?}");
        modes.iter().map(|m| all[*m as usize - 1]).collect()
    };
    for (omega, published) in [(0.0, "at_0"), (6.0, "at_6_rad_s")] {
        for (x, y) in found(omega, true).iter().zip(list(&frequencies[published])) {
            assert!(agrees(*x, y, tolerance), "{omega}: {x} {y}");
        }
    }
    // centrifugal softening alone: the beam loses almost all of its stiffness
    let soft = turning(c, [0.0, 0.0, 6.0], false);
    assert!(soft[0] < 0.2, "{soft:?}");
}

/// A disc of solids, held by the mean motion of its inner nodes at the end of a shaft without mass along x, in a
/// frame that turns with it.
fn overhung(radius: f64, thickness: f64, length: f64, section: Section) -> Mesh {
    // a grid bent into a ring
    let around = 16;
    let inner = 0.3 * radius;
    let mut mesh = grid(ElementKind::Hexahedron20, [around, 2, 1], true, |x| {
        let angle = -2.0 * PI * x[0] / f64::from(around);
        let r = inner + (radius - inner) * x[1] / 2.0;
        [
            length + thickness * (x[2] - 0.5),
            r * angle.cos(),
            r * angle.sin(),
        ]
    });
    // the seam: nodes at the full turn are those at zero
    let places: Vec<[f64; 3]> = mesh.nodes.iter().map(|n| n.position).collect();
    for node in &mut mesh.connectivity {
        let p = places[*node as usize];
        let same = |q: &[f64; 3]| (0..3).all(|k| (p[k] - q[k]).abs() < 1e-9);
        *node = places.iter().position(same).unwrap() as u32;
    }
    let ring = nodes_where(&mesh, |p| (p[1].hypot(p[2]) - inner).abs() < 1e-9);
    let root = add_node(&mut mesh, [0.0; 3]);
    let hub = add_line(&mut mesh, root, [length, 0.0, 0.0], 4, section);
    let used: std::collections::BTreeSet<u32> = mesh.connectivity.iter().copied().collect();
    mesh.ties.push(Tie::Averaging {
        id: 1,
        reference: hub,
        reference_components: ALL,
        independent: ring
            .into_iter()
            .filter(|node| used.contains(node))
            .map(|node| (node, 1.0, 0b111))
            .collect(),
    });
    mesh.materials.push(eng_flexible::mesh::Material {
        name: "shaft".into(),
        young: YOUNG,
        poisson: POISSON,
        density: 1e-3,
        sheet: None,
        solid: None,
    });
    for property in mesh.properties.iter_mut().skip(1) {
        property.material = Some(1);
    }
    mesh
}

/// Whirl of a rigid disc at the end of a massless shaft, from ground: `m ü + k11 u + k12 φ = 0`,
/// `I_d φ̈ − i I_p Ω φ̇ + k12 u + k22 φ = 0` with u = y + i z, φ = the slope of the same plane; seen in the
/// turning frame: less Ω.
fn jeffcott(
    mass: f64,
    [polar, diametral]: [f64; 2],
    [k11, k12, k22]: [f64; 3],
    spin: f64,
) -> Vec<f64> {
    // u = U exp(iωt): (K − ω² M + ω Ω G) = 0, as a first-order problem in ω
    let mut first = DMatrix::<f64>::zeros(4, 4);
    first[(0, 2)] = 1.0;
    first[(1, 3)] = 1.0;
    first[(2, 0)] = k11 / mass;
    first[(2, 1)] = k12 / mass;
    first[(3, 0)] = k12 / diametral;
    first[(3, 1)] = k22 / diametral;
    first[(3, 3)] = polar * spin / diametral;
    let values = first.complex_eigenvalues();
    assert!(values.iter().all(|x| x.im.abs() < 1e-9 * x.re.abs()));
    let mut seen: Vec<f64> = values
        .iter()
        .map(|x| (x.re - spin).abs() / (2.0 * PI))
        .collect();
    seen.sort_by(f64::total_cmp);
    seen
}

#[test]
fn a_spinning_disc_of_solids_keeps_its_gyroscopic_moment() {
    let (radius, thickness, length, side) = (0.08, 0.012, 0.2, 0.008);
    let section = Section::Beam(BeamSection {
        area: side * side,
        moment_z: side.powi(4) / 12.0,
        moment_y: side.powi(4) / 12.0,
        product: 0.0,
        torsion: 0.1406 * side.powi(4),
        shear: [0.0; 2],
        mass_per_length: 0.0,
    });
    let mesh = overhung(radius, thickness, length, section);
    let root = mesh
        .nodes
        .iter()
        .position(|n| n.position == [0.0; 3])
        .unwrap() as u32;
    let markers = vec![at_node("root", &mesh, root)];
    let terms = vec![Term::Normal {
        modes: Modes::Count(8),
        fixed: vec![],
    }];
    let reduced = reduce(mesh, &request(markers, vec![all(0)], terms)).unwrap();
    let c = &reduced.body.invariants;
    let mass = c.mass;
    let polar = c.inertia[0][0];
    let diametral = c.inertia[1][1] - mass * length * length;
    assert!(polar > 1.9 * diametral && polar < 2.0 * diametral);
    let bending = YOUNG * side.powi(4) / 12.0;
    let stiffness = [
        12.0 * bending / length.powi(3),
        -6.0 * bending / length.powi(2),
        4.0 * bending / length,
    ];
    let mut worst = [0.0_f64; 2];
    for spin in [0.0, 70.0, 200.0] {
        let exact = jeffcott(mass, [polar, diametral], stiffness, spin);
        for (place, stiffened) in [(0, false), (1, true)] {
            let found = turning(c, [spin, 0.0, 0.0], stiffened);
            println!("{spin} {stiffened}: {found:.2?}; {exact:.2?}");
            // the four whirls; the others are the disc's own, torsion and length
            for exact in &exact {
                let miss = found
                    .iter()
                    .map(|x| (x - exact).abs() / exact)
                    .fold(f64::INFINITY, f64::min);
                worst[place] = worst[place].max(miss);
            }
        }
    }
    println!("without {:.3}, with {:.4}", worst[0], worst[1]);
    assert!(worst[1] < 0.01, "{worst:?}");
    assert!(worst[0] > 0.1, "{worst:?}");
}

/// The same disc as a point mass: its rotary inertia turns with its node, which needs no stress.
#[test]
fn a_spinning_point_mass_keeps_its_gyroscopic_moment() {
    let (length, side) = (0.2_f64, 0.008_f64);
    let mut mesh = empty();
    mesh.materials[0].density = 1e-6;
    add_node(&mut mesh, [0.0; 3]);
    let section = Section::Beam(BeamSection {
        area: side * side,
        moment_z: side.powi(4) / 12.0,
        moment_y: side.powi(4) / 12.0,
        product: 0.0,
        torsion: 0.1406 * side.powi(4),
        shear: [0.0; 2],
        mass_per_length: 0.0,
    });
    let hub = add_line(&mut mesh, 0, [length, 0.0, 0.0], 1, section);
    let (mass, polar, diametral) = (1.8, 6.0e-3, 3.1e-3);
    let diagonal = [mass, mass, mass, polar, diametral, diametral];
    mesh.point_masses.push(eng_flexible::mesh::PointMass {
        id: 1,
        node: hub,
        matrix: std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { diagonal[i] } else { 0.0 })
        }),
    });
    let markers = vec![at_node("root", &mesh, 0)];
    let normal = Term::Normal {
        modes: Modes::Count(6),
        fixed: vec![],
    };
    let reduced = reduce(mesh, &request(markers, vec![all(0)], vec![normal])).unwrap();
    let bending = YOUNG * side.powi(4) / 12.0;
    let stiffness = [
        12.0 * bending / length.powi(3),
        -6.0 * bending / length.powi(2),
        4.0 * bending / length,
    ];
    for spin in [0.0, 70.0, 200.0, 900.0] {
        let exact = jeffcott(mass, [polar, diametral], stiffness, spin);
        let found = turning(&reduced.body.invariants, [spin, 0.0, 0.0], true);
        println!("{spin}: {found:.4?}; {exact:.4?}");
        for exact in &exact {
            let misses = found.iter().map(|x| (x - exact).abs() / exact);
            let miss = misses.fold(f64::INFINITY, f64::min);
            assert!(miss < 1e-6, "{spin}: {exact} {miss:e}");
        }
    }
}

/// A slender free shaft that spins about its axis shows ω₀ ± Ω in its own frame.
#[test]
fn a_spinning_shaft_shows_its_frequency_shifted_by_the_spin() {
    let mesh = grid(ElementKind::Hexahedron20, [16, 2, 2], false, |x| {
        [
            1.0 * (x[0] / 16.0 - 0.5),
            0.03 * (x[1] / 2.0 - 0.5),
            0.03 * (x[2] / 2.0 - 0.5),
        ]
    });
    let terms = vec![Term::Normal {
        modes: Modes::Count(4),
        fixed: vec![],
    }];
    let reduced = reduce(mesh, &request(vec![], vec![], terms)).unwrap();
    let c = &reduced.body.invariants;
    let rest = reduced.body.frequencies[0];
    assert!(agrees(reduced.body.frequencies[1], rest, 1e-6));
    for block in geometric(c).turn.iter().chain(&geometric(c).acceleration) {
        assert!(block.iter().all(|x| *x == 0.0));
    }
    // from ground the gyroscopic moment of the sections splits the whirls by Ω I/A ∫v'²/∫v²; 49.48/L² for a free bar
    let gyroscopic = 49.48 * 0.03 * 0.03 / 12.0;
    for spin in [200.0, 600.0] {
        let shift = spin / (2.0 * PI) * (1.0 - gyroscopic);
        let worst = [true, false].map(|stiffened| {
            let found = turning(c, [spin, 0.0, 0.0], stiffened);
            let miss = |expected: f64| {
                let misses = found.iter().map(|x| (x - expected).abs() / shift);
                misses.fold(f64::INFINITY, f64::min)
            };
            miss(rest - shift).max(miss(rest + shift))
        });
        println!("{spin}: with {:.1e}, without {:.1e}", worst[0], worst[1]);
        assert!(worst[0] < 1e-4 && worst[1] > 5.0 * worst[0], "{worst:?}");
    }
}

#[test]
fn a_mesh_without_stresses_is_refused() {
    let mut mesh = empty();
    let first = add_node(&mut mesh, [0.0; 3]);
    mesh.point_masses.push(eng_flexible::mesh::PointMass {
        id: 1,
        node: first,
        matrix: std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j && i < 3 { 2.0 } else { 0.0 })
        }),
    });
    for component in 0..3 {
        mesh.springs.push(eng_flexible::mesh::Spring::between(
            u64::from(component) + 1,
            1e5,
            (first, component),
            None,
        ));
    }
    let full = assemble(&mesh, &Rules::default()).unwrap();
    let reduction = Reduction::new(&mesh, &full, &[]).unwrap();
    assert_eq!(reduction.size(), 3);
    let found = GeometricStiffness::of_displacements(
        &mesh,
        &full.freedoms,
        &Rules::default(),
        &[1.0, 0.0, 0.0],
    );
    assert!(problem(found).contains("needs the stresses of solids or beams"));
}
