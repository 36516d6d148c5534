//! Assembly, topology and their messages.

use crate::mechanisms::*;
use crate::support::classes::*;
use crate::support::*;
use eng_runtime::{Assembled, Options, RuntimeError, Simulation, TopologyReport};
use eng_system::code::Compiled;
use eng_system::system::Role;
use std::f64::consts::PI;

fn topology(compiled: &Compiled) -> Result<TopologyReport, RuntimeError> {
    Assembled::new(compiled, &[])?.topology().cloned()
}

#[test]
fn slider_crank_assembles_on_its_branch() {
    for start in [0.3, 1.9, -2.0, 3.1] {
        let m = slider_crank(Turn::Driven { start, speed: 10.0 }, [0.0; 3], false);
        let mut s = Simulation::new(&m.compiled, &[], Options::default()).unwrap();
        let travel = s.value(m.travel).unwrap();
        let exact = CRANK * start.cos() + (ROD * ROD - (CRANK * start.sin()).powi(2)).sqrt();
        assert!((travel - exact).abs() < 1e-10, "{start}: {travel} {exact}");
        assert!((s.cycle_rate().unwrap() - 10.0).abs() < 1e-9);
        let (position, velocity) = s.output_drift().unwrap();
        assert!(position < 1e-9 && velocity < 1e-9);
    }
}

#[test]
fn a_start_angle_keeps_its_turn() {
    let start = 400.0 / 180.0 * PI;
    let m = slider_crank(Turn::Free { start, speed: -5.0 }, [0.0; 3], false);
    let s = Simulation::new(&m.compiled, &[], Options::default()).unwrap();
    assert!(
        (s.cycle_angle().unwrap() - start).abs() < 1e-9,
        "{:?}",
        s.cycle_angle()
    );
    assert!((s.cycle_rate().unwrap() + 5.0).abs() < 1e-9);
}

#[test]
fn counts_freedom() {
    let m = slider_crank(
        Turn::Free {
            start: 0.3,
            speed: 5.0,
        },
        [0.0; 3],
        false,
    );
    let report = topology(&m.compiled).unwrap();
    assert_eq!(
        (report.velocities, report.equations, report.freedom),
        (18, 17, 1)
    );
    assert!(report.redundant.is_empty());
}

/// A shaft in two revolutes.
fn shaft(offset: f64) -> eng_system::code::Compiled {
    let mut b = Builder::new([0.0; 3]);
    let shaft = b.body(
        "shaft",
        BodySpec {
            mass: 1.0,
            center: [0.0; 3],
            inertia: [0.1; 3],
            place: None,
        },
    );
    let revolute = b.class("Revolute", Revolute);
    for (k, z) in [-0.2, 0.3].into_iter().enumerate() {
        let seat = b.marker("seat", None, [0.0, 0.0, z + offset * k as f64], IDENTITY);
        let journal = b.marker("journal", Some(shaft), [0.0, 0.0, z], IDENTITY);
        b.element(
            &format!("main[{}]", k + 1),
            revolute,
            Role::Dynamic,
            &[journal, seat],
            &[],
            &[],
        );
    }
    b.finish()
}

#[test]
fn redundant_joints_are_named() {
    let report = topology(&shaft(0.0)).unwrap();
    assert_eq!((report.equations, report.rank, report.freedom), (10, 5, 1));
    assert_eq!(report.redundant.len(), 5);
    for group in &report.redundant {
        let text = group.to_string();
        assert!(
            text.contains("main[1]") && text.contains("main[2]"),
            "{text}"
        );
    }
    let axial = report
        .redundant
        .iter()
        .find(|g| g.redundant.equation.ends_with("(z)"))
        .unwrap();
    assert_eq!(axial.repeats.len(), 1);
    assert!(axial.repeats[0].equation.ends_with("(z)"));
    let error = Simulation::new(&shaft(0.0), &[], Options::default()).unwrap_err();
    assert!(matches!(error, RuntimeError::Redundant { ref groups } if groups.len() == 5));
}

#[test]
fn an_open_loop_is_named_with_its_gap() {
    let error = topology(&shaft(0.002)).unwrap_err();
    let RuntimeError::OpenLoop { rows, .. } = &error else {
        panic!("{error}");
    };
    // The gap of 2 mm is shared between the two ends.
    assert!((rows[0].value.abs() - 1e-3).abs() < 1e-5, "{error}");
    assert!(rows[0].origin.path.starts_with("main["));
    assert!(
        error.to_string().contains("gaps of 1 mm at main["),
        "{error}"
    );
}

#[test]
fn an_impossible_branch_is_named() {
    let mut b = Builder::new([0.0; 3]);
    let body = b.body(
        "door",
        BodySpec {
            mass: 1.0,
            center: [0.0; 3],
            inertia: [0.1; 3],
            place: None,
        },
    );
    let a = b.marker("door.hinge", Some(body), [0.0; 3], IDENTITY);
    let seat = b.marker("seat", None, [0.0; 3], Z_ALONG_X);
    let class = b.class("Translational", Translational);
    let slide = b.element("slide", class, Role::Dynamic, &[a, seat], &[0.5], &[]);
    let hold = b.class("Spherical", Spherical);
    b.element("hold", hold, Role::Dynamic, &[a, seat], &[], &[]);
    assert_eq!(slide, 0);
    let error = topology(&b.finish()).unwrap_err();
    assert!(
        matches!(error, RuntimeError::Branch { ref condition, .. } if condition == "travel > limit"),
        "{error}"
    );
}

#[test]
fn contradicting_starts_are_named() {
    let m = slider_crank(
        Turn::Driven {
            start: 0.3,
            speed: 10.0,
        },
        [0.0; 3],
        false,
    );
    let mut b = Builder::new([0.0; 3]);
    drop(m);
    let body = b.body(
        "wheel",
        BodySpec {
            mass: 1.0,
            center: [0.0; 3],
            inertia: [0.1; 3],
            place: None,
        },
    );
    let a = b.marker("wheel.hub", Some(body), [0.0; 3], IDENTITY);
    let seat = b.marker("seat", None, [0.0; 3], IDENTITY);
    let revolute = b.class("Revolute", Revolute);
    let spin = b.class("StartSpin", StartSpin);
    b.element("hinge", revolute, Role::Dynamic, &[a, seat], &[], &[]);
    let exact = Role::StartVelocity { exact: true };
    b.element("start[1]", spin, exact, &[a, seat], &[10.0], &[]);
    b.element("start[2]", spin, exact, &[a, seat], &[11.0], &[]);
    let error = Simulation::new(&b.finish(), &[], Options::default()).unwrap_err();
    let RuntimeError::StartVelocity { rows, .. } = &error else {
        panic!("{error}");
    };
    assert!(rows.iter().any(|r| r.origin.path == "start[1]"), "{error}");
    assert!(rows.iter().any(|r| r.origin.path == "start[2]"), "{error}");
}

#[test]
fn ground_that_follows_lies_at_its_partner() {
    let mut b = Builder::new([0.0, 0.0, -9.81]);
    let turned = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let body = b.body(
        "arm",
        BodySpec {
            mass: 1.0,
            center: [0.2, 0.0, 0.0],
            inertia: [0.1; 3],
            place: Some(([0.3, 0.2, 0.1], turned)),
        },
    );
    let hub = b.marker("arm.hub", Some(body), [0.1, 0.0, 0.0], Z_ALONG_X);
    let ground = b.marker("ground", None, [0.0; 3], IDENTITY);
    b.system.markers[ground as usize].placed_at = Some(hub);
    let revolute = b.class("Revolute", Revolute);
    b.element("hinge", revolute, Role::Dynamic, &[hub, ground], &[], &[]);
    let mut s = Simulation::new(&b.finish(), &[], Options::default()).unwrap();
    let place = s.model().markers[ground as usize].position;
    assert!((place - nalgebra::Vector3::new(0.3, 0.3, 0.1)).norm() < 1e-15);
    s.step().unwrap();
}

#[test]
fn a_body_without_mass_is_refused() {
    let mut b = Builder::new([0.0; 3]);
    b.body(
        "ghost",
        BodySpec {
            mass: 0.0,
            center: [0.0; 3],
            inertia: [0.1; 3],
            place: None,
        },
    );
    let error = topology(&b.finish()).unwrap_err();
    assert!(matches!(error, RuntimeError::Body { ref origin, .. } if origin.path == "ghost"));
}
