//! Recovery from amplitudes: uniform strain, the whole finite-element model, time differences, turned frames.

use eng_flexible::fe::stress::{ElementRecovery, von_mises};
use eng_flexible::fe::{Reduction, Rules, assemble};
use eng_flexible::markers::{MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::mesh::{ElementKind, Mesh, Set};
use eng_flexible::recover::{Amplitudes, Envelope, FrameMotion, Recovery, Surface, principal};
use eng_flexible::reduce::{Interface, Reduced, Report, Request, Term, reduce};
use eng_flexible::store::{Key, StoredBody};
use eng_system::reduced::{Invariants, ReducedBody};

use crate::fe_meshes::*;

const STRAIN: [[f64; 3]; 3] = [
    [1.1e-3, 0.4e-3, -0.2e-3],
    [0.4e-3, -0.7e-3, 0.3e-3],
    [-0.2e-3, 0.3e-3, 0.5e-3],
];

fn times_vector(m: &[[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    m.map(|row| row.iter().zip(x).map(|(r, x)| r * x).sum())
}

/// σ = λ tr ε I + 2 μ ε of [`STRAIN`].
fn exact_stress() -> [f64; 6] {
    let lambda = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let mu = YOUNG / (2.0 * (1.0 + POISSON));
    let trace = STRAIN[0][0] + STRAIN[1][1] + STRAIN[2][2];
    let at =
        |i: usize, j: usize| 2.0 * mu * STRAIN[i][j] + if i == j { lambda * trace } else { 0.0 };
    [at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(1, 2), at(2, 0)]
}

type Field = fn([f64; 3]) -> [f64; 3];

/// A mesh with these fields as its modes.
fn with_shapes(mesh: Mesh, fields: &[Field]) -> Reduced {
    let full = assemble(&mesh, &Rules::default()).unwrap();
    let shapes = fields.iter().flat_map(|f| field(&mesh, &full, f)).collect();
    let n = fields.len();
    Reduced {
        body: ReducedBody {
            invariants: Invariants::zero(n),
            frequencies: vec![0.0; n],
            markers: vec![],
            surfaces: vec![],
        },
        shapes,
        freedoms: full.freedoms,
        report: Report::default(),
        mesh,
    }
}

/// A reduced body as the store keeps it.
fn stored(reduced: Reduced) -> StoredBody {
    StoredBody::new(reduced, Rules::default(), Key([0; 32]), Vec::new())
}

#[test]
fn uniform_strain_is_uniform_stress_in_every_solid() {
    let exact = exact_stress();
    let scale = largest(&exact);
    for kind in SOLIDS {
        let reduced = with_shapes(
            distorted(kind, false),
            &[|x| times_vector(&STRAIN, x), |x| [-x[1], x[0], 0.0]],
        );
        // the second mode is a turn: no stress, however large
        let a = [2.0, 0.3];
        let stored = stored(reduced);
        let (mesh, recovery) = (&stored.mesh, Recovery::of_stored(&stored).unwrap());
        let nodes: Vec<u32> = (0..mesh.nodes.len() as u32).collect();
        let modal = recovery.stress_at_nodes(&nodes).unwrap();
        let mut values = Vec::new();
        modal.stress(&a, &mut values).unwrap();
        assert_eq!(values.len(), modal.nodes().len());
        assert!(values.len() >= nodes.len().min(mesh.elements.len()));
        let full = recovery.displacements(&a).unwrap();
        for element in &mesh.elements {
            let rules = Rules::default();
            let element = ElementRecovery::new(mesh, element, &rules)
                .unwrap()
                .unwrap();
            values.extend(element.stresses(&element.displacements(&stored.freedoms, &full)));
        }
        for value in &values {
            for (x, y) in value.iter().zip(exact) {
                assert!((x - 2.0 * y).abs() < 1e-9 * scale, "{kind:?}: {x} {y}");
            }
        }
    }
}

fn named_ends(mut mesh: Mesh, length: f64) -> Mesh {
    for (name, x) in [("root", 0.0), ("tip", length)] {
        let nodes = nodes_where(&mesh, |p| (p[0] - x).abs() < 1e-9);
        let set = Set::new(nodes, vec![]);
        mesh.sets.insert(name.into(), set);
    }
    mesh
}

const ALL: u8 = 0b11_1111;

fn cantilever(kind: ElementKind) -> Reduced {
    let mesh = named_ends(bar(kind, [5, 2, 2], [0.25, 0.04, 0.05]), 0.25);
    let marker = |name: &str, tie| MarkerRequest {
        axes: eng_flexible::markers::MESH_AXES,
        name: name.into(),
        place: MarkerPlace::Gathered {
            nodes: Selection::Set(name.into()),
            tie,
            center: None,
        },
    };
    let request = Request {
        rules: Rules::default(),
        markers: vec![
            marker("root", Spider::Rigid),
            marker("tip", Spider::Averaging),
        ],
        support: vec![Interface {
            marker: 0,
            components: ALL,
        }],
        terms: vec![Term::Static(vec![Interface {
            marker: 1,
            components: ALL,
        }])],
        damping_ratio: 0.0,
        damping_up_to: f64::INFINITY,
        geometric_stiffness: false,
        ..Request::default()
    };
    reduce(mesh, &request).unwrap()
}

/// Amplitudes at rest under a wrench at the tip: k a = Φᵀ f.
fn at_rest(body: &ReducedBody, wrench: [f64; 6]) -> Vec<f64> {
    let n = body.invariants.modes;
    let marker = &body.markers[1];
    (0..n)
        .map(|mode| {
            let force: f64 = (0..3)
                .map(|k| {
                    marker.translation[k * n + mode] * wrench[k]
                        + marker.rotation[k * n + mode] * wrench[3 + k]
                })
                .sum();
            force / body.invariants.stiffness[mode * n + mode]
        })
        .collect()
}

#[test]
fn with_static_modes_stresses_are_those_of_the_whole_model() {
    let wrench = [2e3, -5e3, 3e3, 120.0, -80.0, 200.0];
    for kind in [ElementKind::Hexahedron20, ElementKind::Tetrahedron10] {
        let stored = stored(cantilever(kind));
        let (mesh, rules) = (&stored.mesh, Rules::default());
        let full = assemble(mesh, &rules).unwrap();
        let reduction =
            Reduction::new(mesh, &full, &held(&[mesh.nodes.len() as u32 - 2], ALL)).unwrap();
        let mut forces = vec![0.0; full.freedoms.size()];
        let tip = full.freedoms.of(mesh.nodes.len() as u32 - 1);
        forces[tip].copy_from_slice(&wrench);
        let exact = solve(&full, &reduction, &forces);

        let recovery = Recovery::of_stored(&stored).unwrap();
        let a = at_rest(&stored.body, wrench);
        let found = recovery.displacements(&a).unwrap();
        let miss: Vec<f64> = found.iter().zip(&exact).map(|(x, y)| x - y).collect();
        assert!(largest(&miss) < 1e-9 * largest(&exact));

        let nodes: Vec<u32> = (0..mesh.nodes.len() as u32).collect();
        let modal = recovery.stress_at_nodes(&nodes).unwrap();
        let mut values = Vec::new();
        modal.stress(&a, &mut values).unwrap();
        let stresses = nodal_stress(mesh, &full.freedoms, &rules, &exact);
        let scale = stresses
            .iter()
            .flatten()
            .map(|s| largest(s))
            .fold(0.0, f64::max);
        assert!(scale > 1e7);
        // all nodes but the two centres
        assert_eq!(values.len(), nodes.len() - 2);
        let mut worst = 0.0_f64;
        for (node, value) in modal.nodes().iter().zip(&values) {
            for (x, y) in value.iter().zip(stresses[*node as usize].unwrap()) {
                worst = worst.max((x - y).abs());
            }
        }
        println!("{kind:?}: stress {:.1e}", worst / scale);
        assert!(worst < 1e-9 * scale);

        // the energy is the work of the load, and the elements' sum
        let energy = modal_energy(&stored.body, &a);
        let work = 0.5 * dot(&forces, &exact);
        assert!(agrees(energy, work, 1e-9), "{energy} {work}");
        let sum = energy_of_solids(mesh, &stored.freedoms, &rules, &found);
        assert!(agrees(sum, energy, 1e-9), "{sum} {energy}");
    }
}

/// Rotation by an angle about a unit axis.
fn turn(axis: [f64; 3], angle: f64) -> [[f64; 3]; 3] {
    let (s, c) = angle.sin_cos();
    let [x, y, z] = axis;
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let own = if i == j { c } else { 0.0 };
            own + s * cross[i][j] + (1.0 - c) * axis[i] * axis[j]
        })
    })
}

const AXIS: [f64; 3] = [0.48, -0.6, 0.64];

/// A smooth motion: the frame flies on a curve and turns about an axis at a changing speed.
fn frame(t: f64) -> FrameMotion {
    let (angle, speed, rate) = (0.3 + 20.0 * t + 900.0 * t * t, 20.0 + 1800.0 * t, 1800.0);
    FrameMotion {
        position: [(30.0 * t).sin(), 2.0 * t, 5.0 * t * t],
        rotation: turn(AXIS, angle),
        velocity: [30.0 * (30.0 * t).cos(), 2.0, 10.0 * t],
        angular_velocity: AXIS.map(|x| x * speed),
        acceleration: [-900.0 * (30.0 * t).sin(), 0.0, 10.0],
        angular_acceleration: AXIS.map(|x| x * rate),
    }
}

fn amplitudes(modes: usize, t: f64) -> [Vec<f64>; 3] {
    let w = |k: usize| 150.0 + 40.0 * k as f64;
    let all = |f: &dyn Fn(usize) -> f64| (0..modes).map(f).collect();
    [
        all(&|k| 1e-3 * (w(k) * t + k as f64).sin()),
        all(&|k| 1e-3 * w(k) * (w(k) * t + k as f64).cos()),
        all(&|k| -1e-3 * w(k) * w(k) * (w(k) * t + k as f64).sin()),
    ]
}

#[test]
fn velocities_and_accelerations_are_rates() {
    let stored = stored(cantilever(ElementKind::Hexahedron8));
    let recovery = Recovery::of_stored(&stored).unwrap();
    let last = stored.mesh.nodes.len() as u32 - 1;
    let shapes = recovery.nodes(&[3, 17, last]).unwrap();
    let at = |t: f64| {
        let [value, rate, second] = amplitudes(recovery.modes(), t);
        let given = Amplitudes {
            value: &value,
            rate: &rate,
            second: &second,
        };
        shapes.motion(&frame(t), &given).unwrap()
    };
    let (t, h) = (0.0123, 2e-4);
    let now = at(t);
    assert!(now[0].rotation.is_none() && now[2].rotation.is_some());
    let differ = |of: &dyn Fn(f64) -> f64| {
        let central = |h: f64| (of(t + h) - of(t - h)) / (2.0 * h);
        let (one, two, four) = (central(h), central(2.0 * h), central(4.0 * h));
        let (fine, coarse) = ((4.0 * one - two) / 3.0, (4.0 * two - four) / 3.0);
        (16.0 * fine - coarse) / 15.0
    };
    for (node, now) in now.iter().enumerate() {
        for k in 0..3 {
            let velocity = differ(&|t| at(t)[node].position[k]);
            assert!(
                (velocity - now.velocity.inertial[k]).abs() < 1e-7,
                "{velocity}"
            );
            let acceleration = differ(&|t| at(t)[node].velocity.inertial[k]);
            let miss = (acceleration - now.acceleration.inertial[k]).abs();
            assert!(
                miss < 1e-7 * acceleration.abs().max(1e3),
                "{acceleration} {miss}"
            );
        }
        let back = frame(t).to_inertial(now.velocity.body);
        for (x, y) in back.iter().zip(now.velocity.inertial) {
            assert!((x - y).abs() < 1e-12 * 40.0);
        }
    }
}

#[test]
fn a_turned_frame_turns_everything_and_changes_nothing_in_the_body() {
    let stored = stored(cantilever(ElementKind::Hexahedron8));
    let recovery = Recovery::of_stored(&stored).unwrap();
    let nodes: Vec<u32> = (0..stored.mesh.nodes.len() as u32).collect();
    let shapes = recovery.nodes(&nodes).unwrap();
    let [value, rate, second] = amplitudes(recovery.modes(), 0.02);
    let given = Amplitudes {
        value: &value,
        rate: &rate,
        second: &second,
    };
    let plain = frame(0.02);
    let q = turn([0.0, 0.6, 0.8], 1.9);
    let turned = FrameMotion {
        position: times_vector(&q, plain.position),
        rotation: std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..3).map(|k| q[i][k] * plain.rotation[k][j]).sum())
        }),
        velocity: times_vector(&q, plain.velocity),
        acceleration: times_vector(&q, plain.acceleration),
        ..plain
    };
    let close = |x: [f64; 3], y: [f64; 3], scale: f64| {
        for (x, y) in x.iter().zip(y) {
            assert!((x - y).abs() < 1e-12 * scale, "{x} {y}");
        }
    };
    let before = shapes.motion(&plain, &given).unwrap();
    let after = shapes.motion(&turned, &given).unwrap();
    for (before, after) in before.iter().zip(&after) {
        close(times_vector(&q, before.position), after.position, 1.0);
        for (x, y, scale) in [
            (before.displacement, after.displacement, 1.0),
            (before.velocity, after.velocity, 100.0),
            (before.acceleration, after.acceleration, 1e4),
        ] {
            close(x.body, y.body, scale);
            close(times_vector(&q, x.inertial), y.inertial, scale);
        }
    }
}

#[test]
fn the_envelope_keeps_the_largest_and_its_time() {
    let mut envelope = Envelope::new(2);
    let uniaxial = |x: f64| [x, 0.0, 0.0, 0.0, 0.0, 0.0];
    for (time, [x, y]) in [(0.1, [3.0, 5.0]), (0.2, [-7.0, 5.0]), (0.3, [6.0, 1.0])] {
        envelope.update(time, &[uniaxial(x), uniaxial(y)]).unwrap();
    }
    assert!(envelope.peaks().eq([(7.0, 0.2), (5.0, 0.1)]));
    assert!(envelope.update(0.4, &[uniaxial(1.0)]).is_err());
}

#[test]
fn principal_stresses_rebuild_the_tensor() {
    let states = [
        [3.0, -1.0, 2.0, 0.5, -0.7, 1.2],
        [2e8, 2e8, 2e8, 1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 5.0, 0.0, 0.0],
        [0.0; 6],
        [1e-3, 7e9, -2.0, 3e4, 8.0, -1e9],
    ];
    for stress in states {
        let found = principal(&stress);
        let scale = largest(&stress).max(1e-300);
        let tensor = |i: usize, j: usize| -> f64 {
            found.iter().map(|(value, d)| value * d[i] * d[j]).sum()
        };
        for (at, (i, j)) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
            .iter()
            .enumerate()
        {
            assert!(
                (tensor(*i, *j) - stress[at]).abs() < 1e-14 * scale,
                "{stress:?}"
            );
        }
        assert!(found[0].0 >= found[1].0 && found[1].0 >= found[2].0);
        for (a, (_, x)) in found.iter().enumerate() {
            for (b, (_, y)) in found.iter().enumerate() {
                let product: f64 = x.iter().zip(y).map(|(x, y)| x * y).sum();
                assert!((product - if a == b { 1.0 } else { 0.0 }).abs() < 1e-14);
            }
        }
        let [a, b, c] = found.map(|(value, _)| value);
        let equivalent = (0.5 * ((a - b) * (a - b) + (b - c) * (b - c) + (c - a) * (c - a))).sqrt();
        assert!((equivalent - von_mises(&stress)).abs() < 1e-13 * scale);
    }
}

/// By the divergence theorem the triangles enclose the volume of the elements; each edge lies on two of them.
#[test]
fn the_surface_is_closed_and_looks_outwards() {
    for kind in SOLIDS {
        let mesh = distorted(kind, false);
        let surface = Surface::new(&mesh);
        let place = |node: u32| mesh.nodes[node as usize].position;
        let mut volume = 0.0;
        let mut edges = std::collections::BTreeMap::new();
        for &[a, b, c] in surface.triangles() {
            let (p, q, r) = (place(a), place(b), place(c));
            let cross = [
                q[1] * r[2] - q[2] * r[1],
                q[2] * r[0] - q[0] * r[2],
                q[0] * r[1] - q[1] * r[0],
            ];
            volume += dot(&p, &cross) / 6.0;
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from, to)).or_insert(0) += 1;
            }
        }
        // the cube of unit side
        assert!((volume - 1.0).abs() < 1e-12, "{kind:?}: {volume}");
        for ((from, to), count) in &edges {
            assert_eq!(*count, 1, "{kind:?}");
            assert!(edges.contains_key(&(*to, *from)), "{kind:?}");
        }
        assert_eq!(surface.elements().len(), surface.triangles().len());
        let nodes = surface.nodes();
        assert_eq!(nodes, nodes_where(&mesh, on_cube));
    }
}
