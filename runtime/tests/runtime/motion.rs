//! Motions with known answers.

use crate::mechanisms::*;
use crate::support::classes::*;
use crate::support::*;
use eng_runtime::{Options, Simulation};
use eng_system::code::Compiled;
use eng_system::system::{Role, StepControl};
use nalgebra::Vector3;

fn fixed(h: f64) -> Options {
    Options {
        step: StepControl::Fixed(h),
        ..Options::default()
    }
}

/// Point mass 1 kg on a massless rod of 1 m about y (swinging in x–z), from horizontal, g = 9.81 m/s².
fn pendulum() -> Compiled {
    let mut b = Builder::new([0.0, 0.0, -9.81]);
    let bob = b.body(
        "bob",
        BodySpec {
            mass: 1.0,
            center: [-1.0, 0.0, 0.0],
            inertia: [0.0; 3],
            place: Some(([0.0; 3], IDENTITY)),
        },
    );
    let z_along_y = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0];
    let pivot = b.marker("pivot", None, [0.0; 3], z_along_y);
    let eye = b.marker("bob.eye", Some(bob), [0.0; 3], z_along_y);
    let revolute = b.class("Revolute", Revolute);
    b.element("hinge", revolute, Role::Dynamic, &[eye, pivot], &[], &[]);
    b.finish()
}

fn bob(simulation: &Simulation) -> [f64; 2] {
    let (r, a) = simulation.body_pose(0).unwrap();
    let x = r + a * Vector3::new(-1.0, 0.0, 0.0);
    [x.x, x.z]
}

#[test]
fn pendulum_agrees_with_the_elliptic_integral() {
    // Place at 10 s: IFToMM benchmark A01, closed form.
    let exact = [-0.27508746257611686, -0.961419205099125064];
    let error = |h: f64| {
        let mut simulation = Simulation::new(&pendulum(), &[], fixed(h)).unwrap();
        while simulation.time() < 10.0 {
            simulation.step_within(10.0).unwrap();
        }
        let x = bob(&simulation);
        (x[0] - exact[0]).hypot(x[1] - exact[1])
    };
    let (coarse, fine) = (error(2e-3), error(1e-3));
    assert!(fine < 3e-5, "{fine}");
    assert!((3.8..4.2).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn pendulum_has_its_period() {
    let period = 2.367_841_947_576_237_4;
    let mut simulation = Simulation::new(&pendulum(), &[], fixed(5e-4)).unwrap();
    // Two periods later the velocity changes its sign again.
    let mut last = (0.0_f64, 0.0_f64);
    let crossing = loop {
        simulation.step().unwrap();
        let now = (simulation.time(), simulation.state().velocity[4]);
        if last.0 > 1.5 * period && last.1.signum() != now.1.signum() {
            break last.0 + (now.0 - last.0) * last.1 / (last.1 - now.1);
        }
        last = now;
    };
    assert!((crossing / 2.0 - period).abs() < 2e-6, "{crossing}");
}

#[test]
fn free_body_keeps_momentum_and_energy() {
    let mut b = Builder::new([0.0; 3]);
    let inertia = [0.02, 0.05, 0.06];
    let center = [0.1, -0.05, 0.02];
    let body = b.body(
        "body",
        BodySpec {
            mass: 3.0,
            center,
            inertia,
            place: Some(([0.2, 0.1, 0.0], IDENTITY)),
        },
    );
    let marker = b.marker("body.origin", Some(body), [0.0; 3], IDENTITY);
    let rotation = b.class("StartRotation", StartRotation);
    let velocity = b.class("StartVelocity", StartVelocity);
    let exact = Role::StartVelocity { exact: true };
    b.element("spin", rotation, exact, &[marker], &[1.0, 8.0, 0.5], &[]);
    b.element("speed", velocity, exact, &[marker], &[0.5, 0.2, -0.1], &[]);
    let compiled = b.finish();
    let momenta = |s: &Simulation| {
        let (r, a) = s.body_pose(0).unwrap();
        let v = &s.state().velocity;
        let omega = Vector3::new(v[3], v[4], v[5]);
        let c = Vector3::from(center);
        let speed = Vector3::new(v[0], v[1], v[2]) + a * omega.cross(&c);
        let linear = speed * 3.0;
        let spin = Vector3::from(inertia).component_mul(&omega);
        (
            linear,
            a * spin + (r + a * c).cross(&linear),
            s.energy().kinetic,
        )
    };
    let drift = |h: f64| {
        let mut s = Simulation::new(&compiled, &[], fixed(h)).unwrap();
        let before = momenta(&s);
        while s.time() < 2.0 {
            s.step_within(2.0).unwrap();
        }
        let after = momenta(&s);
        [
            (after.0 - before.0).norm() / before.0.norm(),
            (after.1 - before.1).norm() / before.1.norm(),
            (after.2 - before.2).abs() / before.2,
        ]
    };
    let (coarse, fine) = (drift(2e-3), drift(1e-3));
    for (coarse, fine) in coarse.iter().zip(fine) {
        assert!(fine < 1e-4, "{fine}");
        assert!(fine < 1e-9 || coarse / fine > 3.5, "{coarse} {fine}");
    }
}

#[test]
fn driven_slider_crank_has_closed_form_kinematics() {
    let (start, speed) = (0.7, 30.0);
    let m = slider_crank(Turn::Driven { start, speed }, [0.0, -9.81, 0.0], false);
    let mut s = Simulation::new(&m.compiled, &[], fixed(1e-4)).unwrap();
    let mut values = vec![0.0; m.compiled.system.channels.len()];
    for _ in 0..300 {
        s.step().unwrap();
    }
    for fraction in [0.0, 0.37, 1.0] {
        let t = s.time() - 1e-4 * (1.0 - fraction);
        s.sample_at(t.min(s.time()), &mut values).unwrap();
        let angle = start + speed * t;
        let (sin, cos) = angle.sin_cos();
        let root = (ROD * ROD - CRANK * CRANK * sin * sin).sqrt();
        let travel = CRANK * cos + root;
        // Second rate at constant speed.
        let u = CRANK * CRANK * sin * cos;
        let acceleration = speed
            * speed
            * (-CRANK * cos
                - (CRANK * CRANK * (cos * cos - sin * sin)) / root
                - u * u / (root * root * root));
        assert!((values[m.angle] - angle).abs() < 1e-9);
        assert!((values[m.angle + 1] - speed).abs() < 1e-7);
        assert!(
            (values[m.travel] - travel).abs() < 1e-10,
            "{} {travel}",
            values[m.travel]
        );
        assert!((values[m.travel + 1] / acceleration - 1.0).abs() < 1e-8);
    }
    let (position, velocity) = s.output_drift().unwrap();
    assert!(position < 1e-9 && velocity < 1e-9, "{position} {velocity}");
}

#[test]
fn undamped_mechanism_keeps_its_energy() {
    let speed = 100.0;
    let m = slider_crank(Turn::Free { start: 0.3, speed }, [0.0; 3], false);
    let drift = |steps: f64| {
        let h = 2.0 * std::f64::consts::PI / speed / steps;
        let mut s = Simulation::new(&m.compiled, &[], fixed(h)).unwrap();
        let start = s.energy().start;
        let mut worst = 0.0_f64;
        while s.cycle_angle().unwrap() < 0.3 + 4.0 * std::f64::consts::PI {
            s.step().unwrap();
            worst = worst.max(s.energy().imbalance().abs() / start);
        }
        worst
    };
    let (coarse, fine) = (drift(200.0), drift(400.0));
    assert!(fine < 1e-4, "{fine}");
    assert!(coarse / fine > 3.5, "{coarse} {fine}");
}

#[test]
fn work_of_loads_and_drive_balances_energy() {
    let turn = Turn::Driven {
        start: 0.7,
        speed: 60.0,
    };
    let m = slider_crank(turn, [0.0, -9.81, 0.0], true);
    let imbalance = |h: f64| {
        let mut s = Simulation::new(&m.compiled, &[], fixed(h)).unwrap();
        while s.time() < 0.05 {
            s.step_within(0.05).unwrap();
        }
        let e = s.energy();
        assert!(e.constraints.abs() > 1e-2);
        (e.imbalance() / e.kinetic).abs()
    };
    let (coarse, fine) = (imbalance(4e-4), imbalance(2e-4));
    assert!(fine < 1e-4, "{fine}");
    assert!(coarse / fine > 3.0, "{coarse} {fine}");
}
