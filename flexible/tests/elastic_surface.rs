//! Elastic surfaces of bores against the exact solution of a ring in plane stress, and against each other
//! with different modes.

use crate::foreign_files::OneFile;
use eng_flexible::FlexibleError;
use eng_flexible::fe::Rules;
use eng_flexible::markers::{MESH_AXES, MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::mesh::{Code, Mesh};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::reduce::{Reduced, Request, SurfaceRequest, Term, reduce};
use eng_flexible::solve::Modes;
use eng_system::reduced::ReducedSurface;
use eng_system::surface::{SurfaceShape, SurfaceShapes};
use std::fmt::Write;

const INNER: f64 = 27e-3;
const OUTER: f64 = 40e-3;
const WIDTH: f64 = 4e-3;
const YOUNG: f64 = 210e9;
const POISSON: f64 = 0.3;

/// A ring of 20-node hexahedra in SI: so many around, across the wall and along the axis.
fn ring(around: usize, wall: usize, along: usize) -> Mesh {
    let number = |i: usize, j: usize, k: usize| {
        1 + (i % (2 * around)) + 2 * around * (j + (2 * wall + 1) * k)
    };
    let mut text = "*NODE\n".to_owned();
    for k in 0..=2 * along {
        for j in 0..=2 * wall {
            for i in 0..2 * around {
                if (i % 2) + (j % 2) + (k % 2) > 1 {
                    continue;
                }
                let angle = std::f64::consts::PI * i as f64 / around as f64;
                let radius = INNER + (OUTER - INNER) * j as f64 / (2 * wall) as f64;
                let z = WIDTH * (k as f64 / (2 * along) as f64 - 0.5);
                let (x, y) = (radius * angle.cos(), radius * angle.sin());
                writeln!(text, "{}, {x:.15e}, {y:.15e}, {z:.15e}", number(i, j, k)).unwrap();
            }
        }
    }
    text += "*ELEMENT, TYPE=C3D20, ELSET=ALL\n";
    let mut element = 0;
    for k in (0..2 * along).step_by(2) {
        for j in (0..2 * wall).step_by(2) {
            for i in (0..2 * around).step_by(2) {
                element += 1;
                // corners below, corners above, middles below, above, between; the radius, then the angle,
                // then the axis
                let corners = [(0, 0), (0, 2), (2, 2), (2, 0)];
                let middles = [(0, 1), (1, 2), (2, 1), (1, 0)];
                let level = |places: [(usize, usize); 4], up: usize| {
                    places.map(|(di, dj)| number(i + di, j + dj, k + up))
                };
                let nodes = [
                    level(corners, 0),
                    level(corners, 2),
                    level(middles, 0),
                    level(middles, 2),
                    level(corners, 1),
                ];
                let nodes: Vec<String> = nodes.concat().iter().map(usize::to_string).collect();
                writeln!(
                    text,
                    "{element}, {},\n{}",
                    nodes[..10].join(", "),
                    nodes[10..].join(", ")
                )
                .unwrap();
            }
        }
    }
    writeln!(
        text,
        "*MATERIAL, NAME=STEEL\n*ELASTIC\n{YOUNG}, {POISSON}\n*DENSITY\n7850\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL"
    )
    .unwrap();
    read_inp(&OneFile(text.into_bytes()), "ring.inp", Code::CalculiX).unwrap()
}

fn bore(tie: Spider, width: f64) -> MarkerRequest {
    MarkerRequest {
        name: "bore".into(),
        place: MarkerPlace::Gathered {
            nodes: Selection::Ring {
                center: [0.0; 3],
                axis: [0.0, 0.0, 1.0],
                radius: INNER,
                width,
                tolerance: 1e-3 * INNER,
            },
            tie,
            center: None,
        },
        axes: MESH_AXES,
    }
}

fn request(marker: MarkerRequest, around: u32, across: u32, modes: usize) -> Request {
    Request {
        rules: Rules::exact(),
        markers: vec![marker],
        surfaces: vec![SurfaceRequest {
            marker: 0,
            shapes: SurfaceShapes { around, across },
        }],
        terms: vec![Term::Normal {
            modes: Modes::Count(modes),
            fixed: vec![],
        }],
        ..Request::default()
    }
}

fn reduced(mesh: Mesh, request: &Request) -> Reduced {
    reduce(mesh, request).unwrap_or_else(|error| panic!("{error} ({})", error.advice()))
}

/// `Ψ k⁻¹ Ψᵀ + C`: all static deflection.
fn all(body: &Reduced) -> Vec<f64> {
    let surface: &ReducedSurface = &body.body.surfaces[0];
    let (count, modes) = (surface.shapes.count(), body.body.invariants.modes);
    let stiffness = |mode: usize| body.body.invariants.stiffness[mode * (modes + 1)];
    let mut sum = surface.compliance.clone();
    for i in 0..count {
        for j in 0..count {
            for mode in 0..modes {
                let content = |shape: usize| surface.content[shape * modes + mode];
                sum[i * count + j] += content(i) * content(j) / stiffness(mode);
            }
        }
    }
    sum
}

/// Compliance of a ring in plane stress under a pressure of k waves on its inner wall, for a width of 1 m (m²/N).
///
/// Michell's stress function has four terms of k waves, whose stresses and displacements are those of J. R.
/// Barber, Elasticity, 3rd ed. (2010), tables 8.1 and 9.1; k = 0 is Lamé's solution, and of k = 1 the
/// self-balanced part is left.
fn exact(k: u32) -> f64 {
    let (a, b, nu) = (INNER, OUTER, POISSON);
    if k == 0 {
        let deflection = a / YOUNG * ((b * b + a * a) / (b * b - a * a) + nu);
        return deflection / (2.0 * std::f64::consts::PI * a);
    }
    let kappa = (3.0 - nu) / (1.0 + nu);
    let shear = YOUNG / (2.0 * (1.0 + nu));
    if k == 1 {
        // the marker takes the resultant of `q cos` back as a uniform traction, so half of q is left in each
        // direction: the terms r³ and 1/r; the amplitude is relative to the mean motion of the wall
        let factor = -0.25 / (a - b.powi(4) / a.powi(3));
        let moved = factor * (kappa * a * a + b.powi(4) / (a * a)) / (2.0 * shear);
        return moved / (std::f64::consts::PI * a);
    }
    let n = f64::from(k);
    // lengths are multiples of the inner radius
    let stresses = |r: f64| {
        [
            [
                -n * (n - 1.0) * r.powf(n - 2.0),
                n * (n - 1.0) * r.powf(n - 2.0),
            ],
            [
                -n * (n + 1.0) * r.powf(-n - 2.0),
                -n * (n + 1.0) * r.powf(-n - 2.0),
            ],
            [
                -(n + 1.0) * (n - 2.0) * r.powf(n),
                n * (n + 1.0) * r.powf(n),
            ],
            [
                -(n + 2.0) * (n - 1.0) * r.powf(-n),
                -n * (n - 1.0) * r.powf(-n),
            ],
        ]
    };
    let (inside, outside) = (stresses(1.0), stresses(b / a));
    let matrix = nalgebra::Matrix4::from_fn(|row, term| match row {
        0 | 1 => inside[term][row],
        _ => outside[term][row - 2],
    });
    let factors = matrix
        .lu()
        .solve(&nalgebra::Vector4::new(-1.0, 0.0, 0.0, 0.0))
        .unwrap();
    let moved = nalgebra::Vector4::new(-n, n, kappa - n - 1.0, kappa + n - 1.0).dot(&factors);
    let deflection = a * moved / (2.0 * shear);
    deflection / (std::f64::consts::PI * a)
}

#[test]
fn a_ring_yields_as_the_exact_solution() {
    let body = reduced(
        ring(48, 4, 1),
        &request(bore(Spider::Averaging, WIDTH), 6, 0, 8),
    );
    let found = all(&body);
    let shapes: Vec<SurfaceShape> = body.body.surfaces[0].shapes.each().collect();
    let count = shapes.len();
    for (at, shape) in shapes.iter().enumerate() {
        let ratio = found[at * (count + 1)] * WIDTH / exact(shape.around);
        // the tie of the marker gives all nodes the same force, which on quadratic faces is no uniform traction
        let most = if shape.around == 1 { 0.08 } else { 4e-3 };
        assert!((ratio - 1.0).abs() < most, "{shape:?}: {ratio}");
        for other in (0..count).filter(|other| *other != at) {
            let size = (found[at * (count + 1)] * found[other * (count + 1)]).sqrt();
            assert!(
                found[at * count + other].abs() < 1e-6 * size,
                "{shape:?} {other}"
            );
        }
    }
}

/// The modes take their part of the deflection: the sum does not depend on them.
#[test]
fn modes_and_compliance_share_the_deflection() {
    let few = reduced(
        ring(24, 2, 2),
        &request(bore(Spider::Averaging, WIDTH), 4, 1, 1),
    );
    let many = reduced(
        ring(24, 2, 2),
        &request(bore(Spider::Averaging, WIDTH), 4, 1, 30),
    );
    let (few_all, many_all) = (all(&few), all(&many));
    let largest = few_all.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (x, y) in few_all.iter().zip(&many_all) {
        assert!((x - y).abs() < 1e-8 * largest, "{x} {y}");
    }
    let rest = |body: &Reduced| {
        body.body.surfaces[0]
            .compliance
            .iter()
            .map(|x| x.abs())
            .fold(0.0, f64::max)
    };
    assert!(
        rest(&many) < 0.2 * rest(&few),
        "{} {}",
        rest(&many),
        rest(&few)
    );
}

fn refused(mesh: Mesh, request: &Request) -> String {
    let error: FlexibleError = reduce(mesh, request).unwrap_err();
    format!("{error}; {}", error.advice())
}

#[test]
fn surfaces_that_cannot_be_are_refused() {
    let mesh = || ring(12, 1, 1);
    let told = refused(mesh(), &request(bore(Spider::Rigid, WIDTH), 2, 0, 1));
    assert!(
        told.contains("a rigid tie holds the surface round"),
        "{told}"
    );
    let told = refused(mesh(), &request(bore(Spider::Averaging, WIDTH), 9, 0, 1));
    assert!(
        told.contains("15.0°") && told.contains("`waves_around: 6`"),
        "{told}"
    );
    let told = refused(mesh(), &request(bore(Spider::Averaging, WIDTH), 2, 3, 1));
    assert!(
        told.contains("nodes 2.00 mm apart across") && told.contains("`degree_across: 2`"),
        "{told}"
    );
    // five rows that lie close to one end are no better than three
    let mut uneven = ring(12, 1, 2);
    for node in &mut uneven.nodes {
        let z = &mut node.position[2];
        *z += 0.45 * (0.5 * WIDTH - z.abs());
    }
    let told = refused(uneven, &request(bore(Spider::Averaging, WIDTH), 2, 4, 1));
    assert!(
        told.contains("nodes 1.45 mm apart across") && told.contains("`degree_across: 2`"),
        "{told}"
    );
    let told = refused(
        mesh(),
        &request(bore(Spider::Averaging, 2.0 * WIDTH), 2, 0, 1),
    );
    assert!(told.contains("cover 50 % of the ring's surface"), "{told}");
    let mut turned = bore(Spider::Averaging, WIDTH);
    turned.axes = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let told = refused(mesh(), &request(turned, 2, 0, 1));
    assert!(told.contains("not the axis of its ring"), "{told}");
    let mut point = bore(Spider::Averaging, WIDTH);
    point.place = MarkerPlace::Node(1);
    let told = refused(mesh(), &request(point, 2, 0, 1));
    assert!(
        told.contains("an elastic surface needs a ring of nodes"),
        "{told}"
    );
}
