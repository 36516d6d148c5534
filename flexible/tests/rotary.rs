//! Point masses with rotary inertia and beside their nodes: the constants' energy against that of the turned body.

use eng_flexible::fe::Rules;
use eng_flexible::markers::{MarkerPlace, MarkerRequest};
use eng_flexible::mesh::{BeamAxes, BeamSection, Mesh, PointMass, Section};
use eng_flexible::reduce::{Interface, Reduced, Request, Term, reduce};
use eng_flexible::rotary::split_offsets;
use eng_flexible::solve::Modes;
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

use crate::fe_meshes::*;

const PLACE: [f64; 3] = [0.3, 0.05, -0.02];
const MASS: f64 = 1.7;

fn central() -> Matrix3<f64> {
    Matrix3::new(6.0, 0.4, -0.7, 0.4, 3.5, 0.2, -0.7, 0.2, 4.1) * 1e-3
}

/// A beam almost without mass, with a mass at its end.
fn beam(offset: [f64; 3]) -> Mesh {
    let mut mesh = empty();
    mesh.materials[0].density = 1e-9;
    add_node(&mut mesh, [0.0; 3]);
    let tip = add_node(&mut mesh, PLACE);
    let section = Section::Beam(BeamSection {
        area: 1e-4,
        moment_z: 1e-9,
        moment_y: 2e-9,
        product: 0.0,
        torsion: 1.5e-9,
        shear: [0.0; 2],
        mass_per_length: 0.0,
    });
    let axes = BeamAxes {
        centroid: [0.0; 2],
        orientation: [0.1, 1.0, 0.2],
        offsets: [[0.0; 3]; 2],
        released: [0; 2],
    };
    add_beam(&mut mesh, section, axes, [0, tip]);
    let skew = Vector3::from(offset).cross_matrix() * MASS;
    let inertia = central() + skew.transpose() * skew / MASS;
    mesh.point_masses.push(PointMass {
        id: 1,
        node: tip,
        matrix: std::array::from_fn(|i| {
            std::array::from_fn(|j| match (i < 3, j < 3) {
                (true, true) => {
                    if i == j {
                        MASS
                    } else {
                        0.0
                    }
                }
                (true, false) => -skew[(i, j - 3)],
                (false, true) => skew[(i - 3, j)],
                (false, false) => inertia[(i - 3, j - 3)],
            })
        }),
    });
    mesh
}

fn reduced(offset: [f64; 3]) -> Reduced {
    let mesh = beam(offset);
    let marker = |name: &str, id| MarkerRequest {
        axes: eng_flexible::markers::MESH_AXES,
        name: name.into(),
        place: MarkerPlace::Node(id),
    };
    let request = Request {
        rules: Rules::default(),
        markers: vec![marker("root", 1), marker("tip", 2)],
        support: vec![Interface {
            marker: 0,
            components: 0b11_1111,
        }],
        terms: vec![Term::Normal {
            modes: Modes::Count(6),
            fixed: vec![],
        }],
        damping_ratio: 0.0,
        damping_up_to: f64::INFINITY,
        geometric_stiffness: false,
        ..Request::default()
    };
    reduce(mesh, &request).unwrap()
}

/// ½ ω·J(a) ω + ω·B(a) ȧ + ½ ȧ·m ȧ of the constants.
fn by_constants(
    reduced: &Reduced,
    omega: &Vector3<f64>,
    a: &DVector<f64>,
    rates: &DVector<f64>,
) -> f64 {
    let c = &reduced.body.invariants;
    let n = c.modes;
    let square = |block: &[f64]| DMatrix::from_row_slice(n, n, block);
    let rows = |block: &[f64]| DMatrix::from_row_slice(3, n, block);
    let mut inertia = Matrix3::from_fn(|i, j| c.inertia[i][j]);
    for (k, block) in c.rotation_by_shape.iter().enumerate() {
        let along = rows(block) * a;
        for i in 0..3 {
            inertia[(i, k)] += along[i];
            inertia[(k, i)] += along[i];
        }
    }
    for (p, (i, k)) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
        .into_iter()
        .enumerate()
    {
        let value = a.dot(&(square(&c.centrifugal[p]) * a));
        inertia[(i, k)] += value;
        if i != k {
            inertia[(k, i)] += value;
        }
    }
    let mut energy = 0.5 * omega.dot(&(inertia * omega));
    let turning = rows(&c.rotation) * rates;
    for k in 0..3 {
        energy += omega[k] * (turning[k] + rates.dot(&(square(&c.coriolis[k]) * a)));
    }
    energy + 0.5 * rates.dot(&(square(&c.modal_mass) * rates))
}

/// The energy of the rigid body at the tip, turned by exp(θ).
fn exact(
    reduced: &Reduced,
    offset: [f64; 3],
    omega: &Vector3<f64>,
    a: &DVector<f64>,
    rates: &DVector<f64>,
) -> f64 {
    let n = reduced.body.invariants.modes;
    let tip = &reduced.body.markers[1];
    let along = |block: &[f64], x: &DVector<f64>| -> Vector3<f64> {
        let y = DMatrix::from_row_slice(3, n, block) * x;
        Vector3::new(y[0], y[1], y[2])
    };
    let (u, du) = (along(&tip.translation, a), along(&tip.translation, rates));
    let (theta, d_theta) = (along(&tip.rotation, a), along(&tip.rotation, rates));
    let turn = Rotation3::new(theta).into_inner();
    // T(θ) to more digits than are needed
    let cross = theta.cross_matrix();
    let (mut tangent, mut power, mut factor) = (Matrix3::identity(), Matrix3::identity(), 1.0);
    for k in 1..12 {
        power *= cross;
        factor /= f64::from(k) + 1.0;
        tangent += power * factor;
    }
    let spin = omega + tangent * d_theta;
    let arm = turn * Vector3::from(offset);
    let velocity = omega.cross(&(Vector3::from(PLACE) + u)) + du + spin.cross(&arm);
    let own = turn.transpose() * spin;
    0.5 * MASS * velocity.norm_squared() + 0.5 * own.dot(&(central() * own))
}

/// The error of the constants, at amplitudes and rates of a size and of half that size.
fn misses(offset: [f64; 3]) -> [f64; 2] {
    let reduced = reduced(offset);
    let n = reduced.body.invariants.modes;
    assert_eq!(n, 6);
    let omega = Vector3::new(30.0, -20.0, 50.0);
    // of the order of one in the tip's displacement and rotation
    let a = DVector::from_fn(n, |i, _| 0.05 * (1.0 + i as f64).sin());
    let rates = DVector::from_fn(n, |i, _| 2.0 * (2.0 + 3.0 * i as f64).cos());
    [0.02, 0.01].map(|size| {
        let (a, rates) = (&a * size, &rates * size);
        let found = by_constants(&reduced, &omega, &a, &rates);
        (found - exact(&reduced, offset, &omega, &a, &rates)).abs()
    })
}

#[test]
fn a_turned_inertia_has_its_energy_to_second_order() {
    let [coarse, fine] = misses([0.0; 3]);
    println!("{coarse:e} {fine:e}");
    assert!(fine > 1e-12 && coarse / fine > 7.0, "{coarse:e} {fine:e}");
}

#[test]
fn a_mass_beside_its_node_has_its_energy_to_first_order() {
    let [coarse, fine] = misses([0.06, -0.03, 0.04]);
    println!("{coarse:e} {fine:e}");
    assert!(fine > 1e-12 && coarse / fine > 3.5, "{coarse:e} {fine:e}");
}

#[test]
fn masses_are_split_only_where_they_are_rigid_bodies() {
    let mut centred = beam([0.0; 3]);
    let before = centred.clone();
    split_offsets(&mut centred);
    assert_eq!(centred, before);
    // an uneven mass, as a foreign code may condense it
    let mut uneven = beam([0.1, 0.0, 0.0]);
    uneven.point_masses[0].matrix[1][1] *= 2.0;
    let before = uneven.clone();
    split_offsets(&mut uneven);
    assert_eq!(uneven, before);
    let mut beside = beam([0.1, 0.02, 0.0]);
    split_offsets(&mut beside);
    assert_eq!(
        (
            beside.nodes.len(),
            beside.point_masses.len(),
            beside.ties.len()
        ),
        (3, 2, 1)
    );
    let place = beside.nodes[2].position;
    for (x, y) in place.iter().zip([0.4, 0.07, -0.02]) {
        assert!((x - y).abs() < 1e-12);
    }
    for i in 0..3 {
        for j in 0..3 {
            let x = beside.point_masses[0].matrix[3 + i][3 + j];
            assert!((x - central()[(i, j)]).abs() < 1e-12);
        }
    }
}
