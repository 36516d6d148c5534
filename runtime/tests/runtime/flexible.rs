//! Flexible bodies against sums over their nodes, against rigid ones, and against conservation laws.

use crate::jacobian;
use crate::support::classes::*;
use crate::support::*;
use eng_runtime::body::{BodyFrame, BodyKind, BodyModel, Weights};
use eng_runtime::chain;
use eng_runtime::dynamics::Dynamics;
use eng_runtime::flexible::{Flexible, Work};
use eng_runtime::integrator::{Goal, Integrator, Trial};
use eng_runtime::model::MarkerModel;
use eng_runtime::shape::MarkerShape;
use eng_runtime::{Moment, Options, Simulation};
use eng_system::code::Compiled;
use eng_system::reduced::{Geometric, Invariants, MarkerStiffness, ReducedBody, ReducedMarker};
use eng_system::system::{Method, Origin, Role, StepControl};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use std::sync::Arc;

/// Numbers in −1…1, always the same.
pub struct Draw(pub u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
    fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.next(), self.next(), self.next())
    }
}

fn skew(v: &Vector3<f64>) -> Matrix3<f64> {
    v.cross_matrix()
}

/// Place (m) and mass (kg) of a point, and its displacement (m) in each shape.
pub type Point = ([f64; 3], f64, Vec<[f64; 3]>);

/// A structure of nodes with three translations and three rotations each (all translations first).
pub struct Nodes {
    pub places: Vec<Vector3<f64>>,
    mass: DMatrix<f64>,
    shapes: DMatrix<f64>,
}

impl Nodes {
    /// A coupled, positive definite nodal mass, alike in x, y and z; rotary inertia where asked for.
    pub fn new(count: usize, modes: usize, rotary: f64, draw: &mut Draw) -> Nodes {
        let places = (0..count)
            .map(|_| {
                draw.vector().component_mul(&Vector3::new(0.4, 0.2, 0.3))
                    + Vector3::new(0.1, 0.05, -0.02)
            })
            .collect();
        let root = DMatrix::from_fn(count, count, |i, j| {
            0.1 * draw.next() + if i == j { 0.6 } else { 0.0 }
        });
        let scalar = &root * root.transpose();
        let size = 6 * count;
        let mut mass = DMatrix::zeros(size, size);
        for i in 0..count {
            for j in 0..count {
                for k in 0..3 {
                    mass[(3 * i + k, 3 * j + k)] = scalar[(i, j)];
                }
            }
            let r = Matrix3::from_fn(|_, _| draw.next());
            let block = r * r.transpose() * rotary;
            for k in 0..3 {
                for l in 0..3 {
                    mass[(3 * (count + i) + k, 3 * (count + i) + l)] = block[(k, l)];
                }
            }
        }
        let shapes = DMatrix::from_fn(size, modes, |i, _| {
            draw.next() * if i < 3 * count { 0.3 } else { 0.8 }
        });
        Nodes {
            places,
            mass,
            shapes,
        }
    }

    /// Masses in points, with the displacement (m) of each point in each shape.
    pub fn lumped(points: &[Point]) -> Nodes {
        let count = points.len();
        let modes = points.first().map_or(0, |p| p.2.len());
        let mut mass = DMatrix::zeros(6 * count, 6 * count);
        let mut shapes = DMatrix::zeros(6 * count, modes);
        for (i, (_, own, moves)) in points.iter().enumerate() {
            for k in 0..3 {
                mass[(3 * i + k, 3 * i + k)] = *own;
                for (mode, by) in moves.iter().enumerate() {
                    shapes[(3 * i + k, mode)] = by[k];
                }
            }
        }
        Nodes {
            places: points.iter().map(|p| Vector3::from(p.0)).collect(),
            mass,
            shapes,
        }
    }

    /// The reduced body with stiffness and damping of the shapes.
    pub fn reduced(&self, stiffness: &DMatrix<f64>, damping: &DMatrix<f64>) -> ReducedBody {
        ReducedBody {
            invariants: self.invariants(stiffness, damping),
            frequencies: vec![0.0; self.shapes.ncols()],
            markers: (0..self.places.len()).map(|i| self.marker(i)).collect(),
            surfaces: Vec::new(),
        }
    }

    fn turn(&self, axis: &Vector3<f64>) -> DMatrix<f64> {
        let nodes = 2 * self.places.len();
        let mut e = DMatrix::zeros(3 * nodes, 3 * nodes);
        for i in 0..nodes {
            e.view_mut((3 * i, 3 * i), (3, 3)).copy_from(&skew(axis));
        }
        e
    }

    fn rigid(&self) -> (DMatrix<f64>, DMatrix<f64>) {
        let n = self.places.len();
        let (mut t, mut r) = (DMatrix::zeros(6 * n, 3), DMatrix::zeros(6 * n, 3));
        for (i, place) in self.places.iter().enumerate() {
            t.view_mut((3 * i, 0), (3, 3))
                .copy_from(&Matrix3::identity());
            r.view_mut((3 * i, 0), (3, 3)).copy_from(&-skew(place));
            r.view_mut((3 * (n + i), 0), (3, 3))
                .copy_from(&Matrix3::identity());
        }
        (t, r)
    }

    /// The constants by their definitions.
    fn invariants(&self, stiffness: &DMatrix<f64>, damping: &DMatrix<f64>) -> Invariants {
        let flat = |m: &DMatrix<f64>| -> Vec<f64> { m.transpose().as_slice().to_vec() };
        let (t, r) = self.rigid();
        let e: Vec<_> = (0..3).map(|k| self.turn(&Vector3::ith(k, 1.0))).collect();
        let turned: Vec<_> = e.iter().map(|e| e * &self.shapes).collect();
        let rigid = t.transpose() * &self.mass * &t;
        let moment = r.transpose() * &self.mass * &t; // Σ m s~
        let inertia = r.transpose() * &self.mass * &r;
        let centrifugal = |j: usize, k: usize| {
            let h = turned[j].transpose() * &self.mass * &turned[k];
            flat(&((&h + h.transpose()) * 0.5))
        };
        Invariants {
            modes: self.shapes.ncols(),
            mass: rigid[(0, 0)],
            first_moment: [moment[(2, 1)], moment[(0, 2)], moment[(1, 0)]],
            inertia: std::array::from_fn(|i| std::array::from_fn(|j| inertia[(i, j)])),
            translation: flat(&(t.transpose() * &self.mass * &self.shapes)),
            rotation: flat(&(r.transpose() * &self.mass * &self.shapes)),
            rotation_by_shape: std::array::from_fn(|k| {
                flat(&(r.transpose() * &self.mass * &turned[k]))
            }),
            coriolis: std::array::from_fn(|k| {
                flat(&(self.shapes.transpose() * &self.mass * &turned[k]))
            }),
            centrifugal: [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
                .map(|(j, k)| centrifugal(j, k)),
            modal_mass: flat(&(self.shapes.transpose() * &self.mass * &self.shapes)),
            stiffness: flat(stiffness),
            damping: flat(damping),
            geometric: None,
        }
    }

    fn marker(&self, node: usize) -> ReducedMarker {
        let n = self.shapes.ncols();
        let rows = |first: usize| -> Vec<f64> {
            (0..3)
                .flat_map(|k| (0..n).map(move |m| (k, m)))
                .map(|(k, m)| self.shapes[(first + k, m)])
                .collect()
        };
        ReducedMarker {
            name: format!("node[{node}]"),
            position: self.places[node].into(),
            translation: rows(3 * node),
            rotation: rows(3 * (self.places.len() + node)),
        }
    }
}

struct Moving {
    rotation: Matrix3<f64>,
    position: Vector3<f64>,
    a: DVector<f64>,
    v: Vec<f64>,
    rate: Vec<f64>,
    gravity: Vector3<f64>,
}

impl Moving {
    fn new(modes: usize, draw: &mut Draw) -> Moving {
        let list =
            |draw: &mut Draw| -> Vec<f64> { (0..6 + modes).map(|_| 3.0 * draw.next()).collect() };
        Moving {
            rotation: nalgebra::Rotation3::new(draw.vector() * 2.0).into_inner(),
            position: draw.vector(),
            a: DVector::from_fn(modes, |_, _| 0.2 * draw.next()),
            v: list(draw),
            rate: list(draw),
            gravity: draw.vector() * 5.0,
        }
    }

    fn frame(&self) -> BodyFrame<'_> {
        BodyFrame {
            position: self.position,
            rotation: self.rotation,
            amplitudes: self.a.as_slice(),
        }
    }
}

/// Inertia, gravity, elastic and damping force by sums over nodes whose mass acts on translations:
/// `Σ_ij (∂ẋ_i/∂v)ᵀ M_ij (ẍ_j − g)`.
fn by_sums(nodes: &Nodes, m: &Moving, k: &DMatrix<f64>, c: &DMatrix<f64>) -> DVector<f64> {
    let n = m.a.len();
    let count = nodes.places.len();
    let (omega, alpha) = (
        Vector3::new(m.v[3], m.v[4], m.v[5]),
        Vector3::new(m.rate[3], m.rate[4], m.rate[5]),
    );
    let (rates, second) = (
        DVector::from_row_slice(&m.v[6..]),
        DVector::from_row_slice(&m.rate[6..]),
    );
    let mut out = DVector::zeros(6 + n);
    let mut columns = Vec::new();
    let mut accelerations = Vec::new();
    for i in 0..count {
        let shape = nodes.shapes.rows(3 * i, 3);
        let p = nodes.places[i] + shape * &m.a;
        let p = Vector3::new(p[0], p[1], p[2]);
        let of = |x: &DVector<f64>| -> Vector3<f64> {
            let y = shape * x;
            Vector3::new(y[0], y[1], y[2])
        };
        let local = alpha.cross(&p)
            + omega.cross(&omega.cross(&p))
            + omega.cross(&of(&rates)) * 2.0
            + of(&second);
        accelerations
            .push(Vector3::new(m.rate[0], m.rate[1], m.rate[2]) + m.rotation * local - m.gravity);
        let mut column = DMatrix::zeros(3, 6 + n);
        column
            .view_mut((0, 0), (3, 3))
            .copy_from(&Matrix3::identity());
        column
            .view_mut((0, 3), (3, 3))
            .copy_from(&-(m.rotation * skew(&p)));
        column
            .view_mut((0, 6), (3, n))
            .copy_from(&(m.rotation * shape));
        columns.push(column);
    }
    for i in 0..count {
        for j in 0..count {
            out += columns[i].transpose() * accelerations[j] * nodes.mass[(3 * i, 3 * j)];
        }
    }
    let elastic = k * &m.a + c * &rates;
    for i in 0..n {
        out[6 + i] += elastic[i];
    }
    out
}

fn stiffness(n: usize, draw: &mut Draw) -> DMatrix<f64> {
    let root = DMatrix::from_fn(n, n, |i, j| draw.next() + if i == j { 4.0 } else { 0.0 });
    &root * root.transpose()
}

#[test]
fn inertia_is_the_sum_over_the_nodes() {
    let mut draw = Draw(7);
    for modes in [0, 1, 5] {
        let nodes = Nodes::new(6, modes, 0.0, &mut draw);
        let (k, c) = (stiffness(modes, &mut draw), stiffness(modes, &mut draw));
        let body = Flexible::new(Arc::new(nodes.invariants(&k, &c)));
        for _ in 0..5 {
            let m = Moving::new(modes, &mut draw);
            let mut found = vec![0.0; 6 + modes];
            body.add_inertia(
                &m.frame(),
                &m.v,
                &m.rate,
                &m.gravity,
                &mut Work::default(),
                &mut found,
            );
            let expected = by_sums(&nodes, &m, &k, &c);
            let miss = (DVector::from_vec(found) - &expected).amax() / expected.amax();
            assert!(miss < 1e-13, "{modes} modes: {miss:e}");
        }
    }
}

/// With rotary inertia as well: dT/dt = force · velocity for every motion, T and its rate by the nodal vectors.
#[test]
fn power_of_inertia_is_the_rate_of_the_energy() {
    let mut draw = Draw(11);
    let modes = 4;
    let nodes = Nodes::new(5, modes, 0.3, &mut draw);
    let (k, c) = (stiffness(modes, &mut draw), stiffness(modes, &mut draw));
    let body = Flexible::new(Arc::new(nodes.invariants(&k, &c)));
    let (t, r) = nodes.rigid();
    for _ in 0..5 {
        let mut m = Moving::new(modes, &mut draw);
        m.gravity = Vector3::zeros();
        // T along the motion, from w = R_t v + R_r ω + E(ω) Φ a + Φ ȧ
        let kinetic = |time: f64| {
            let v: Vec<f64> = m.v.iter().zip(&m.rate).map(|(v, a)| v + time * a).collect();
            let omega = Vector3::new(v[3], v[4], v[5]);
            // the frame turns: v in body axes has the rate Aᵀ r̈ − ω × Aᵀ ṙ, to first order in time
            let start = m.rotation.transpose() * Vector3::new(v[0], v[1], v[2]);
            let spin = Vector3::new(m.v[3], m.v[4], m.v[5]);
            let seen = start - spin.cross(&start) * time;
            let rates = DVector::from_row_slice(&v[6..]);
            let a = &m.a + DVector::from_row_slice(&m.v[6..]) * time;
            let w = &t * seen
                + &r * omega
                + nodes.turn(&omega) * &nodes.shapes * &a
                + &nodes.shapes * &rates;
            let strain = (&k * &a).dot(&a);
            0.5 * (w.dot(&(&nodes.mass * &w)) + strain)
        };
        let h = 1e-3;
        let central = |h: f64| (kinetic(h) - kinetic(-h)) / (2.0 * h);
        let rate = (4.0 * central(h) - central(2.0 * h)) / 3.0;
        let mut force = vec![0.0; 6 + modes];
        body.add_inertia(
            &m.frame(),
            &m.v,
            &m.rate,
            &m.gravity,
            &mut Work::default(),
            &mut force,
        );
        let rates = DVector::from_row_slice(&m.v[6..]);
        let lost = (&c * &rates).dot(&rates);
        let power: f64 = force.iter().zip(&m.v).map(|(f, v)| f * v).sum::<f64>() - lost;
        assert!(
            (power - rate).abs() < 1e-9 * (1.0 + power.abs()),
            "{power} {rate}"
        );
        let [found, _, strain, damped] =
            body.energy(&m.frame(), &m.v, &m.gravity, &mut Work::default());
        assert!((found + strain - kinetic(0.0)).abs() < 1e-12 * found);
        assert!((damped - lost).abs() < 1e-12 * lost.abs());
    }
}

#[test]
fn matrix_of_inertia_is_its_derivative() {
    let mut draw = Draw(5);
    let modes = 4;
    let nodes = Nodes::new(5, modes, 0.3, &mut draw);
    let (k, c) = (stiffness(modes, &mut draw), stiffness(modes, &mut draw));
    let body = Flexible::new(Arc::new(nodes.invariants(&k, &c)));
    check_matrix(&body, &mut draw);
    let (_, body) = geometric_body(modes, &mut draw);
    check_matrix(&body, &mut draw);
}

fn check_matrix(body: &Flexible, draw: &mut Draw) {
    let modes = body.modes();
    let m = Moving::new(modes, draw);
    let weights = Weights {
        acceleration: 3.0,
        velocity: 1.7,
    };
    let n = 6 + modes;
    let mut exact = vec![0.0; n * n];
    body.add_inertia_matrix(
        &m.frame(),
        &m.v,
        &m.rate,
        &m.gravity,
        weights,
        &Matrix3::identity(),
        &mut Work::default(),
        &mut exact,
    );
    for column in 0..n {
        let value = |d: f64| {
            let mut moved = Moving {
                rotation: m.rotation,
                position: m.position,
                a: m.a.clone(),
                v: m.v.clone(),
                rate: m.rate.clone(),
                gravity: m.gravity,
            };
            moved.v[column] += weights.velocity * d;
            moved.rate[column] += weights.acceleration * d;
            if (3..6).contains(&column) {
                let turn = Vector3::ith(column - 3, d);
                moved.rotation *= nalgebra::Rotation3::new(turn).into_inner();
            } else if column >= 6 {
                moved.a[column - 6] += d;
            }
            let mut out = vec![0.0; n];
            body.add_inertia(
                &moved.frame(),
                &moved.v,
                &moved.rate,
                &moved.gravity,
                &mut Work::default(),
                &mut out,
            );
            DVector::from_vec(out)
        };
        let h = 1e-2;
        let central = |h: f64| (value(h) - value(-h)) / (2.0 * h);
        let (one, two, four) = (central(h), central(2.0 * h), central(4.0 * h));
        let fine = (&one * 4.0 - &two) / 3.0;
        let coarse = (&two * 4.0 - &four) / 3.0;
        let difference = (fine * 16.0 - coarse) / 15.0;
        for row in 0..n {
            let found = exact[row * n + column];
            assert!(
                (found - difference[row]).abs() < 1e-8 * (1.0 + difference.amax()),
                "row {row} column {column}: {found} {}",
                difference[row]
            );
        }
    }
}

/// A flexible body whose shapes keep mean axes neither in place nor in turn, between springs and joints at its nodes.
pub fn reduced(nodes: &Nodes, scale: f64, draw: &mut Draw) -> ReducedBody {
    let n = nodes.shapes.ncols();
    let k = stiffness(n, draw) * scale;
    let c = &k * 2e-4;
    nodes.reduced(&k, &c)
}

fn flexible_chain() -> Compiled {
    chain_of(|_| {})
}

fn chain_of(change: impl FnOnce(&mut ReducedBody)) -> Compiled {
    let mut draw = Draw(3);
    let nodes = Nodes::new(3, 3, 0.05, &mut draw);
    let mut b = Builder::new([0.3, -0.5, -9.81]);
    let oblique = [0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6];
    let end = nodes.places[0];
    let mut body = reduced(&nodes, 40.0, &mut draw);
    change(&mut body);
    let (_, markers) = b.flexible(
        "bar",
        body,
        ([0.0; 3], IDENTITY),
        &[IDENTITY, oblique, IDENTITY],
    );
    let rod = b.body(
        "rod",
        BodySpec {
            mass: 0.8,
            center: [0.1, 0.0, 0.03],
            inertia: [0.003, 0.008, 0.007],
            place: Some((nodes.places[1].into(), oblique)),
        },
    );
    let eye = b.marker("rod.eye", Some(rod), [0.0; 3], IDENTITY);
    let tip = b.marker("rod.tip", Some(rod), [0.25, 0.05, 0.02], IDENTITY);
    let ground = b.marker("ground", None, end.into(), IDENTITY);
    let post = b.marker("post", None, [0.5, 0.4, -0.1], IDENTITY);
    let spherical = b.class("Spherical", Spherical);
    let revolute = b.class("Revolute", Revolute);
    let spring = b.class("Spring", Spring);
    let bushing = b.class("Bushing", Bushing);
    b.element(
        "hold",
        spherical,
        Role::Dynamic,
        &[markers[0], ground],
        &[],
        &[],
    );
    b.element(
        "hinge",
        revolute,
        Role::Dynamic,
        &[eye, markers[1]],
        &[],
        &[],
    );
    b.element(
        "spring",
        spring,
        Role::Dynamic,
        &[tip, post],
        &[60.0, 0.3, 0.8, 0.001],
        &[],
    );
    b.element(
        "bushing",
        bushing,
        Role::Dynamic,
        &[markers[2], tip],
        &[20.0, 0.3, 0.4, 0.01],
        &[],
    );
    b.finish()
}

#[test]
fn matrix_of_a_step_is_exact_with_a_flexible_body() {
    jacobian::check(&flexible_chain(), 0.05, 0.1);
    jacobian::check(&flexible_chain(), 0.01, 0.02);
}

#[test]
fn positions_and_velocities_keep_the_constraints() {
    keeps_constraints(&flexible_chain());
}

/// A chain whose markers also have displacements of second order.
fn curved_chain() -> Compiled {
    let mut draw = Draw(37);
    chain_of(|body| body.invariants.geometric = Some(geometric(3, 3, 0.3, &mut draw)))
}

#[test]
fn markers_of_second_order_keep_the_constraints() {
    keeps_constraints(&curved_chain());
}

fn keeps_constraints(compiled: &Compiled) {
    let options = Options {
        step: StepControl::Fixed(1e-3),
        ..Options::default()
    };
    let mut s = Simulation::new(compiled, &[], options).unwrap();
    for _ in 0..200 {
        s.step().unwrap();
        s.output_state().unwrap();
        let (position, velocity) = s.output_drift().unwrap();
        assert!(
            position < 1e-10 && velocity < 1e-10,
            "{position:e} {velocity:e}"
        );
    }
    let e = s.energy();
    assert!(
        e.imbalance().abs() < 1e-3 * e.damping.abs().max(e.kinetic),
        "{e:?}"
    );
}

fn free(nodes: &Nodes, body: ReducedBody) -> Compiled {
    let mut b = Builder::new([0.0; 3]);
    let axes = vec![IDENTITY; nodes.places.len()];
    let (index, _) = b.flexible("body", body, ([0.2, 0.1, 0.0], IDENTITY), &axes);
    let marker = b.marker("body.origin", Some(index), [0.0; 3], IDENTITY);
    let rotation = b.class("StartRotation", StartRotation);
    let velocity = b.class("StartVelocity", StartVelocity);
    let exact = Role::StartVelocity { exact: true };
    b.element("spin", rotation, exact, &[marker], &[1.0, 8.0, 0.5], &[]);
    b.element("speed", velocity, exact, &[marker], &[0.5, 0.2, -0.1], &[]);
    b.finish()
}

#[test]
fn a_free_flexible_body_keeps_momentum_and_energy() {
    let mut draw = Draw(13);
    let modes = 3;
    let nodes = Nodes::new(5, modes, 0.0, &mut draw);
    let mut body = reduced(&nodes, 30.0, &mut draw);
    body.invariants.damping = vec![0.0; modes * modes];
    let compiled = free(&nodes, body);
    let momenta = |s: &Simulation| {
        let (r, rotation) = s.body_pose(0).unwrap();
        let state = s.state();
        let a = DVector::from_row_slice(&state.pose[7..]);
        let rates = DVector::from_row_slice(&state.velocity[6..]);
        let v = &state.velocity;
        let omega = Vector3::new(v[3], v[4], v[5]);
        let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
        let motion: Vec<_> = (0..nodes.places.len())
            .map(|i| {
                let shape = nodes.shapes.rows(3 * i, 3);
                let (u, du) = (shape * &a, shape * &rates);
                let p = nodes.places[i] + Vector3::new(u[0], u[1], u[2]);
                let speed = Vector3::new(v[0], v[1], v[2])
                    + rotation * (omega.cross(&p) + Vector3::new(du[0], du[1], du[2]));
                (r + rotation * p, speed)
            })
            .collect();
        for (i, (place, _)) in motion.iter().enumerate() {
            for (j, (_, speed)) in motion.iter().enumerate() {
                let momentum = speed * nodes.mass[(3 * i, 3 * j)];
                linear += momentum;
                angular += place.cross(&momentum);
            }
        }
        let e = s.energy();
        (linear, angular, e.kinetic + e.strain)
    };
    let drift = |h: f64| {
        let options = Options {
            step: StepControl::Fixed(h),
            method: Method::GeneralisedAlpha { rho_infinity: 1.0 },
            ..Options::default()
        };
        let mut s = Simulation::new(&compiled, &[], options).unwrap();
        let before = momenta(&s);
        while s.time() < 1.0 {
            s.step_within(1.0).unwrap();
        }
        let after = momenta(&s);
        [
            (after.0 - before.0).norm() / before.0.norm(),
            (after.1 - before.1).norm() / before.1.norm(),
            (after.2 - before.2).abs() / before.2,
        ]
    };
    let (coarse, fine) = (drift(4e-4), drift(2e-4));
    println!("{coarse:?} {fine:?}");
    for (coarse, fine) in coarse.iter().zip(fine) {
        assert!(fine < 1e-4, "{fine}");
        assert!(fine < 1e-9 || coarse / fine > 3.5, "{coarse} {fine}");
    }
}

/// The centre of mass of a free body moves straight at constant speed, for any motion about it. This is its distance
/// (m) from there after a second, for a body of about 1 m.
#[test]
fn the_centre_of_a_free_flexible_body_goes_straight_on() {
    let mut draw = Draw(13);
    let modes = 3;
    let nodes = Nodes::new(5, modes, 0.0, &mut draw);
    let mut body = reduced(&nodes, 30.0, &mut draw);
    body.invariants.damping = vec![0.0; modes * modes];
    let compiled = free(&nodes, body);
    let centre = |s: &Simulation| {
        let (r, rotation) = s.body_pose(0).unwrap();
        let state = s.state();
        let (a, rates) = (
            DVector::from_row_slice(&state.pose[7..]),
            DVector::from_row_slice(&state.velocity[6..]),
        );
        let v = &state.velocity;
        let omega = Vector3::new(v[3], v[4], v[5]);
        let (mut place, mut speed, mut mass) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        for i in 0..nodes.places.len() {
            let shape = nodes.shapes.rows(3 * i, 3);
            let (u, du) = (shape * &a, shape * &rates);
            let p = nodes.places[i] + Vector3::new(u[0], u[1], u[2]);
            let of_node: f64 = (0..nodes.places.len())
                .map(|j| nodes.mass[(3 * i, 3 * j)])
                .sum();
            mass += of_node;
            place += of_node * (r + rotation * p);
            speed += of_node
                * (Vector3::new(v[0], v[1], v[2])
                    + rotation * (omega.cross(&p) + Vector3::new(du[0], du[1], du[2])));
        }
        (place / mass, speed / mass)
    };
    let miss = |step: StepControl| {
        let options = Options {
            step,
            method: Method::GeneralisedAlpha { rho_infinity: 1.0 },
            ..Options::default()
        };
        let mut s = Simulation::new(&compiled, &[], options).unwrap();
        let (place, speed) = centre(&s);
        while s.time() < 1.0 {
            s.step_within(1.0).unwrap();
        }
        let miss = (centre(&s).0 - place - speed).norm();
        println!("{step:?}: {miss:e} m, {:?}", s.statistics());
        miss
    };
    let misses = [4e-4, 2e-4, 1e-4, 5e-5, 2.5e-5].map(|step| {
        miss(StepControl::FixedTo {
            step,
            tolerance: 1e-3,
        })
    });
    for pair in misses.windows(2) {
        assert!((3.5..4.5).contains(&(pair[0] / pair[1])), "{misses:?}");
    }
    assert!(misses[4] < 1e-8, "{misses:?}");
    let mut before = f64::INFINITY;
    for tolerance in [1.0, 1e-1, 1e-2, 1e-3, 1e-4] {
        let found = miss(StepControl::Tolerance(tolerance));
        assert!(
            found < 0.5 * before,
            "{tolerance}: {found:e} after {before:e}"
        );
        before = found;
    }
    assert!(before < 1e-8, "{before:e}");
}

/// A flexible body that can hardly bend moves as the rigid one.
#[test]
fn a_stiff_body_moves_as_a_rigid_one() {
    let mut draw = Draw(17);
    let nodes = Nodes::new(5, 3, 0.0, &mut draw);
    let path = |scale: f64| {
        let mut draw = Draw(23);
        let compiled = free(&nodes, reduced(&nodes, scale, &mut draw));
        let options = Options {
            step: StepControl::Fixed(1e-4),
            ..Options::default()
        };
        let mut s = Simulation::new(&compiled, &[], options).unwrap();
        while s.time() < 0.5 {
            s.step_within(0.5).unwrap();
        }
        s.body_pose(0).unwrap()
    };
    let rigid_nodes = Nodes {
        places: nodes.places.clone(),
        mass: nodes.mass.clone(),
        shapes: DMatrix::zeros(nodes.shapes.nrows(), 0),
    };
    let compiled = free(&rigid_nodes, reduced(&rigid_nodes, 1.0, &mut draw));
    let options = Options {
        step: StepControl::Fixed(1e-4),
        ..Options::default()
    };
    let mut s = Simulation::new(&compiled, &[], options).unwrap();
    while s.time() < 0.5 {
        s.step_within(0.5).unwrap();
    }
    let (rigid, _) = s.body_pose(0).unwrap();
    let miss = |scale: f64| (path(scale).0 - rigid).norm();
    let (soft, stiff) = (miss(1e3), miss(1e5));
    println!("{soft:e} {stiff:e}");
    assert!(stiff < 5e-6 && stiff < 0.05 * soft, "{soft:e} {stiff:e}");
}

/// Symmetric blocks of geometric stiffness, of all loads at some markers.
fn geometric(modes: usize, markers: usize, scale: f64, draw: &mut Draw) -> Geometric {
    let mut block = || {
        let half = DMatrix::from_fn(modes, modes, |_, _| scale * draw.next());
        (&half + half.transpose()).as_slice().to_vec()
    };
    Geometric {
        spin: std::array::from_fn(|_| block()),
        turn: std::array::from_fn(|_| block()),
        acceleration: std::array::from_fn(|_| block()),
        loads: (0..6 * markers)
            .map(|i| MarkerStiffness {
                marker: i / 6,
                component: (i % 6) as u8,
                stiffness: block(),
            })
            .collect(),
    }
}

fn geometric_body(modes: usize, draw: &mut Draw) -> (Invariants, Flexible) {
    let nodes = Nodes::new(5, modes, 0.3, draw);
    let (k, c) = (stiffness(modes, draw), stiffness(modes, draw));
    let mut constants = nodes.invariants(&k, &c);
    constants.geometric = Some(geometric(modes, 0, 0.4, draw));
    let body = Flexible::new(Arc::new(constants.clone()));
    (constants, body)
}

fn force(body: &Flexible, m: &Moving) -> DVector<f64> {
    let mut out = vec![0.0; m.v.len()];
    let work = &mut Work::default();
    body.add_inertia(&m.frame(), &m.v, &m.rate, &m.gravity, work, &mut out);
    DVector::from_vec(out)
}

/// The modal rows have the sum of factors times blocks times amplitudes, no more.
#[test]
fn geometric_stiffness_is_in_the_modal_rows() {
    let mut draw = Draw(29);
    let modes = 4;
    let (constants, body) = geometric_body(modes, &mut draw);
    let blocks = constants.geometric.clone().unwrap();
    let plain = Flexible::new(Arc::new(Invariants {
        geometric: None,
        ..constants
    }));
    for _ in 0..5 {
        let m = Moving::new(modes, &mut draw);
        let difference = force(&body, &m) - force(&plain, &m);
        let omega = [m.v[3], m.v[4], m.v[5]];
        let beta =
            m.rotation.transpose() * (Vector3::new(m.rate[0], m.rate[1], m.rate[2]) - m.gravity);
        let mut sum = DVector::zeros(modes);
        let mut add = |factor: f64, block: &[f64]| {
            sum += DMatrix::from_row_slice(modes, modes, block) * &m.a * factor;
        };
        for (p, (j, k)) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
            .into_iter()
            .enumerate()
        {
            add(omega[j] * omega[k], &blocks.spin[p]);
        }
        for k in 0..3 {
            add(m.rate[3 + k], &blocks.turn[k]);
            add(beta[k], &blocks.acceleration[k]);
        }
        let miss = (difference.rows(6, modes) - &sum).amax();
        assert!(miss < 1e-12 * sum.amax(), "{miss:e}");
    }
}

/// With geometric stiffness and gravity: the rate of all energy is force · velocity less damping, along any motion.
#[test]
fn power_balances_with_geometric_stiffness() {
    let mut draw = Draw(31);
    let modes = 4;
    let (_, body) = geometric_body(modes, &mut draw);
    for _ in 0..5 {
        let m = Moving::new(modes, &mut draw);
        let energy = |time: f64| {
            let omega = Vector3::new(m.v[3], m.v[4], m.v[5]);
            let moved = Moving {
                rotation: m.rotation * nalgebra::Rotation3::new(omega * time).into_inner(),
                position: m.position + Vector3::new(m.v[0], m.v[1], m.v[2]) * time,
                a: &m.a + DVector::from_row_slice(&m.v[6..]) * time,
                v: m.v.iter().zip(&m.rate).map(|(v, a)| v + time * a).collect(),
                rate: m.rate.clone(),
                gravity: m.gravity,
            };
            let work = &mut Work::default();
            let [kinetic, gravity, strain, _] =
                body.energy(&moved.frame(), &moved.v, &moved.gravity, work);
            kinetic + gravity + strain
        };
        let central = |h: f64| (energy(h) - energy(-h)) / (2.0 * h);
        let h = 1e-3;
        let (one, two, four) = (central(h), central(2.0 * h), central(4.0 * h));
        let (fine, coarse) = ((4.0 * one - two) / 3.0, (4.0 * two - four) / 3.0);
        let rate = (16.0 * fine - coarse) / 15.0;
        let [.., lost] = body.energy(&m.frame(), &m.v, &m.gravity, &mut Work::default());
        let power = force(&body, &m).dot(&DVector::from_row_slice(&m.v)) - lost;
        assert!(
            (power - rate).abs() < 1e-9 * (1.0 + power.abs()),
            "{power} {rate}"
        );
    }
}

#[test]
fn matrix_of_a_step_is_exact_with_geometric_stiffness() {
    jacobian::check(&curved_chain(), 0.05, 0.1);
    jacobian::check(&curved_chain(), 0.01, 0.02);
}

/// For a marker of second order, J v is the rate of its pose and J̇ v that of its twist.
#[test]
fn a_marker_of_second_order_moves_as_its_jacobian_says() {
    let mut draw = Draw(43);
    let modes = 4;
    let (_, body) = geometric_body(modes, &mut draw);
    let body = BodyModel {
        origin: Origin::default(),
        kind: BodyKind::Flexible(body),
        pose: 0,
        velocity: 0,
    };
    let nodes = Nodes::new(2, modes, 0.0, &mut draw);
    let blocks = geometric(modes, 1, 0.5, &mut draw);
    let marker = MarkerModel {
        body: Some(0),
        position: nodes.places[1],
        orientation: nalgebra::Rotation3::new(draw.vector()).into_inner(),
        shape: Some(MarkerShape::new(&nodes.marker(1), blocks.loads.iter())),
        placed_at: None,
    };
    for _ in 0..5 {
        let m = Moving::new(modes, &mut draw);
        // v̇ = 0 in the body's own numbers: ṙ, ω, ȧ constant
        let at = |time: f64| {
            let omega = Vector3::new(m.v[3], m.v[4], m.v[5]);
            let moved = Moving {
                rotation: m.rotation * nalgebra::Rotation3::new(omega * time).into_inner(),
                position: m.position + Vector3::new(m.v[0], m.v[1], m.v[2]) * time,
                a: &m.a + DVector::from_row_slice(&m.v[6..]) * time,
                v: m.v.clone(),
                rate: m.rate.clone(),
                gravity: m.gravity,
            };
            chain::kinematics(&moved.frame(), &marker, &m.v)
        };
        let now = at(0.0);
        let h = 1e-3;
        let rate = |value: &dyn Fn(f64) -> Vector3<f64>| {
            let central = |h: f64| (value(h) - value(-h)) / (2.0 * h);
            let (one, two, four) = (central(h), central(2.0 * h), central(4.0 * h));
            (((one * 4.0 - two) / 3.0) * 16.0 - (two * 4.0 - four) / 3.0) / 15.0
        };
        let turn = |t: f64| {
            let turned = now.rotation.transpose() * at(t).rotation;
            nalgebra::Rotation3::from_matrix_unchecked(turned).scaled_axis()
        };
        let mut jacobian = vec![0.0; 6 * (6 + modes)];
        chain::jacobian(&body, &m.frame(), &marker, &mut jacobian);
        let twist =
            DMatrix::from_row_slice(6, 6 + modes, &jacobian) * DVector::from_row_slice(&m.v);
        let bias = chain::bias(
            &m.frame(),
            &chain::Placed::new(&m.frame(), &marker),
            &marker,
            &m.v,
        );
        let three = |x: &[f64]| Vector3::new(x[0], x[1], x[2]);
        for (found, expected) in [
            (now.velocity, rate(&|t| at(t).position)),
            (now.angular_velocity, rate(&turn)),
            (three(twist.as_slice()), now.velocity),
            (three(&twist.as_slice()[3..]), now.angular_velocity),
            (three(&bias), rate(&|t| at(t).velocity)),
            (three(&bias[3..]), rate(&|t| at(t).angular_velocity)),
        ] {
            let miss = (found - expected).amax() / (1.0 + expected.amax());
            assert!(miss < 1e-9, "{found} {expected} {miss:e}");
        }
    }
}

/// The chain with joints, spring and bushing on markers of second order keeps its energy to the integrator's order.
#[test]
fn a_chain_on_markers_of_second_order_keeps_energy() {
    let compiled = curved_chain();
    let drift = |h: f64| {
        let options = Options {
            step: StepControl::Fixed(h),
            method: Method::GeneralisedAlpha { rho_infinity: 0.95 },
            ..Options::default()
        };
        let mut s = Simulation::new(&compiled, &[], options).unwrap();
        while s.time() < 0.3 {
            s.step_within(0.3).unwrap();
        }
        let e = s.energy();
        e.imbalance().abs() / e.damping.abs().max(e.kinetic)
    };
    let (coarse, fine) = (drift(4e-4), drift(2e-4));
    println!("{coarse:e} {fine:e}");
    assert!(fine < 1e-4 && coarse / fine > 3.5, "{coarse} {fine}");
}

/// A free body with geometric stiffness keeps its energy to the integrator's order.
#[test]
fn a_free_body_with_geometric_stiffness_keeps_energy() {
    let mut draw = Draw(41);
    let modes = 3;
    let nodes = Nodes::new(5, modes, 0.0, &mut draw);
    let mut body = reduced(&nodes, 30.0, &mut draw);
    body.invariants.damping = vec![0.0; modes * modes];
    body.invariants.geometric = Some(geometric(modes, 0, 0.1, &mut draw));
    let compiled = free(&nodes, body);
    let drift = |h: f64| {
        let options = Options {
            step: StepControl::Fixed(h),
            method: Method::GeneralisedAlpha { rho_infinity: 1.0 },
            ..Options::default()
        };
        let mut s = Simulation::new(&compiled, &[], options).unwrap();
        let energy = |s: &mut Simulation| {
            let e = s.energy();
            e.kinetic + e.strain
        };
        let before = energy(&mut s);
        while s.time() < 1.0 {
            s.step_within(1.0).unwrap();
        }
        (energy(&mut s) - before).abs() / before
    };
    let (coarse, fine) = (drift(4e-4), drift(2e-4));
    println!("{coarse:e} {fine:e}");
    assert!(
        fine < 1e-4 && (fine < 1e-9 || coarse / fine > 3.5),
        "{coarse} {fine}"
    );
}

/// The error norm contains the modes that a step resolves, and no others.
#[test]
fn modes_above_the_step_do_not_control_it() {
    let mut draw = Draw(29);
    let nodes = Nodes::new(5, 2, 0.0, &mut draw);
    let mut body = reduced(&nodes, 1.0, &mut draw);
    let omega = 2e4;
    let n = body.invariants.modes;
    // decoupled, both of the same frequency, without damping
    body.invariants.stiffness = body
        .invariants
        .modal_mass
        .iter()
        .map(|m| m * omega * omega)
        .collect();
    body.invariants.damping = vec![0.0; n * n];
    // as in mean axes: the frame does not shake with the modes
    body.invariants.translation.fill(0.0);
    body.invariants.rotation.fill(0.0);
    let error = |known: bool, h: f64| {
        let mut body = body.clone();
        if known {
            body.frequencies = vec![omega / std::f64::consts::TAU; n];
        }
        let compiled = free(&nodes, body);
        let s = Simulation::new(&compiled, &[], Options::default()).unwrap();
        let (model, state) = (s.model().clone(), s.state().clone());
        let goal = Goal {
            absolute: 1e-12,
            relative: 1e-9,
        };
        let mut integrator = Integrator::new(&model, &state, Method::default(), goal).unwrap();
        let still = vec![0.0; model.velocities];
        integrator.start(&still, &still, &[], &[]);
        let mut dynamics = Dynamics::new(&model);
        let moment = Moment {
            time: h,
            cycle_angle: None,
        };
        match integrator.try_step(&model, &mut dynamics, h, Some(1.0), moment) {
            Ok(Trial::Solved { error }) => error,
            other => panic!("{other:?}"),
        }
    };
    for h in [0.2 / omega, 0.9 / omega] {
        let (known, unknown) = (error(true, h), error(false, h));
        assert!(known > 0.0 && known == unknown, "{known} {unknown}");
    }
    let h = 2.0 / omega;
    let (known, unknown) = (error(true, h), error(false, h));
    assert!(known < 0.1 * unknown, "{known} {unknown}");
}
