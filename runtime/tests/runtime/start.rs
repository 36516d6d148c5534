//! The quasi-static start.

use crate::flexible::{Draw, Nodes, reduced};
use crate::support::classes::*;
use crate::support::*;
use eng_runtime::{Options, Simulation, StartReport};
use eng_system::code::Compiled;
use eng_system::system::{Role, Start, StepControl};

fn begin(compiled: &Compiled, start: Start) -> Simulation {
    begin_with(compiled, start, 2e-4)
}

fn begin_with(compiled: &Compiled, start: Start, step: f64) -> Simulation {
    let options = Options {
        step: StepControl::Fixed(step),
        start,
        ..Options::default()
    };
    Simulation::new(compiled, &[], options).unwrap()
}

/// Largest deviation of the modal amplitudes from their values at the start, over 0.5 s, and their size.
fn ringing(mut s: Simulation) -> (f64, f64) {
    let start = s.state().pose[7..].to_vec();
    let mut largest = 0.0_f64;
    while s.time() < 0.5 {
        s.step_within(0.5).unwrap();
        for (now, then) in s.state().pose[7..].iter().zip(&start) {
            largest = largest.max((now - then).abs());
        }
    }
    (largest, start.iter().fold(0.0, |w, x| w.max(x.abs())))
}

/// A flexible body that turns at constant speed about a node is bent by its spin alone: a steady motion.
#[test]
fn a_turning_flexible_body_starts_bent() {
    let mut draw = Draw(29);
    let nodes = Nodes::new(4, 3, 0.02, &mut draw);
    let mut b = Builder::new([0.0; 3]);
    let body = reduced(&nodes, 4e3, &mut draw);
    let (_, markers) = b.flexible("bar", body, ([0.0; 3], IDENTITY), &[IDENTITY; 4]);
    let ground = b.marker("ground", None, nodes.places[0].into(), IDENTITY);
    let revolute = b.class("Revolute", Revolute);
    let drive = b.class("Drive", Drive);
    b.element(
        "hinge",
        revolute,
        Role::Dynamic,
        &[markers[0], ground],
        &[],
        &[],
    );
    b.element(
        "turn",
        drive,
        Role::Dynamic,
        &[markers[0], ground],
        &[0.0, 20.0, 0.0],
        &[],
    );
    let compiled = b.finish();

    let bent = begin(&compiled, Start::QuasiStatic);
    let StartReport::QuasiStatic(found) = bent.start() else {
        panic!("{}", bent.start());
    };
    assert_eq!(found.freedoms, 3);
    let size = bent
        .state()
        .acceleration
        .iter()
        .fold(0.0_f64, |w, a| w.max(a.abs()));
    for (rate, acceleration) in bent.state().velocity[6..]
        .iter()
        .zip(&bent.state().acceleration[6..])
    {
        assert!(
            rate.abs() < 1e-12 && acceleration.abs() < 1e-6 * size.max(1.0),
            "{rate:e} {acceleration:e}"
        );
    }
    // the rest is the integrator's error in the centrifugal force, of second order
    let (rings, amplitude) = ringing(bent);
    assert!(
        amplitude > 1e-4 && rings < 1e-4 * amplitude,
        "{rings:e} {amplitude:e}"
    );
    let (finer, _) = ringing(begin_with(&compiled, Start::QuasiStatic, 1e-4));
    assert!(finer < 0.3 * rings, "{finer:e} {rings:e}");
    // straight at the start, it swings about the bent shape
    let (rings, _) = ringing(begin(&compiled, Start::Assembled));
    assert!(rings > amplitude, "{rings:e} {amplitude:e}");
}

fn hung(gravity: [f64; 3], held: bool) -> Compiled {
    let mut b = Builder::new(gravity);
    let body = b.body(
        "block",
        BodySpec {
            mass: 12.0,
            center: [0.02, 0.01, -0.03],
            inertia: [0.3, 0.4, 0.5],
            place: Some(([0.0; 3], IDENTITY)),
        },
    );
    let eye = b.marker("eye", Some(body), [0.1, 0.0, 0.0], IDENTITY);
    let ground = b.marker("ground", None, [0.1, 0.0, 0.0], IDENTITY);
    if held {
        let bushing = b.class("Bushing", Bushing);
        b.element(
            "mount",
            bushing,
            Role::Dynamic,
            &[eye, ground],
            &[8e4, 20.0, 900.0, 3.0],
            &[],
        );
    }
    b.finish()
}

/// A body on an elastic mount sags at once, and rests.
#[test]
fn a_mounted_body_starts_where_it_rests() {
    let compiled = hung([0.4, -0.2, -9.81], true);
    let mut s = begin(&compiled, Start::QuasiStatic);
    let StartReport::QuasiStatic(found) = s.start() else {
        panic!("{}", s.start());
    };
    assert_eq!((found.freedoms, found.held.len()), (6, 0));
    let start = s.state().pose.clone();
    // the mount's stiffness along z is 0.6 of the stated: m g/k, and the tilt about the eye
    assert!((0.002..0.005).contains(&-start[2]), "{start:?}");
    while s.time() < 0.3 {
        s.step_within(0.3).unwrap();
    }
    for (now, then) in s.state().pose.iter().zip(&start) {
        assert!((now - then).abs() < 1e-10, "{now} {then}");
    }
}

/// A body that nothing holds against its load has no steady motion. The message names it, and it stays
/// where it is.
#[test]
fn a_falling_body_has_no_balance() {
    let s = begin(&hung([0.0, 0.0, -9.81], false), Start::QuasiStatic);
    let StartReport::NoBalance(obstacle) = s.start() else {
        panic!("{}", s.start());
    };
    assert_eq!(obstacle.origin.path, "block");
    assert_eq!(s.state().pose, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    // without gravity it rests
    let s = begin(&hung([0.0; 3], false), Start::QuasiStatic);
    assert!(matches!(s.start(), StartReport::QuasiStatic(e) if e.freedoms == 0));
}

/// A model without a cycle starts as assembled unless asked.
#[test]
fn without_a_cycle_nothing_is_moved() {
    let s = begin(&hung([0.0, 0.0, -9.81], true), Start::Automatic);
    assert_eq!(*s.start(), StartReport::Assembled);
    assert_eq!(s.state().pose[2], 0.0);
}
