//! Linear analyses against closed forms, published bearing coefficients, and the decay of the same models in time.

use crate::support::{decay, program_with_bar as program, refused};
use eng::{Coefficients, LinearModes, Outcome, Program, Quantity};
use nalgebra::{Complex, DMatrix};
use std::f64::consts::{PI, TAU};

fn run(program: &Program, analysis: &str, settings: &[(&str, &str)]) -> Outcome {
    let mut analysis = program.analysis(analysis).expect("an analysis");
    for (path, value) in settings {
        let parameter = analysis.model().parameter(path).expect("a parameter");
        let value: Quantity = value.parse().expect("a quantity");
        analysis = analysis.set(parameter, value).expect("it fits");
    }
    match analysis.run(&mut |_| {}) {
        Ok(outcome) => outcome,
        Err(failed) => panic!("{}", failed.error),
    }
}

fn modes(program: &Program, analysis: &str, settings: &[(&str, &str)]) -> LinearModes {
    run(program, analysis, settings).modes.expect("modes")
}

/// ω (rad/s) of the oscillations, ascending.
fn circular(modes: &LinearModes) -> Vec<f64> {
    modes.oscillations().map(|m| m.value.im).collect()
}

#[track_caller]
fn near(found: f64, due: f64, tolerance: f64) {
    assert!(
        (found - due).abs() <= tolerance * due.abs(),
        "{found} instead of {due}: {:.1e}",
        found / due - 1.0
    );
}

const SPRING: &str = "
    use std.joints.Translational
    use std.forces.Bushing
    model Mass {
        param damping: Damping = 40 N*s/m
        gravity = [0, 0, -9.81] m/s^2
        marker wall = [0, 0, 0] mm
        body block { mass = 2.5 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
        joint rail = Translational(block.eye, wall)
        force spring = Bushing(block.eye, wall, stiffness: [0, 0, 9000] N/m, damping: [0 N*s/m, 0 N*s/m, damping],
            torsional_stiffness: [0, 0, 0] N*m/rad, torsional_damping: [0, 0, 0] N*m*s/rad)
        output acceleration = dot(block.eye.acceleration, ground.z)
        output place = dot(block.eye.origin - wall.origin, ground.z) as mm
    }
    analysis modes = linear(Mass())
    analysis later = linear(Mass(), after: 20 ms)
    analysis fast = linear(Mass(), up_to: 1 Hz)";

/// λ of a damped oscillator; its outputs at 1 J; above critical damping two decays.
#[test]
fn a_mass_on_a_spring() {
    let program = program(SPRING);
    let (m, c, k) = (2.5_f64, 40.0_f64, 9000.0_f64);
    for analysis in ["modes", "later"] {
        let outcome = run(&program, analysis, &[]);
        let found = outcome.modes.expect("modes");
        assert_eq!((found.freedoms, found.zeros, found.modes.len()), (1, 0, 1));
        let mode = &found.modes[0];
        near(mode.value.re, -c / (2.0 * m), 1e-12);
        near(
            mode.value.im,
            (k / m - (c / (2.0 * m)).powi(2)).sqrt(),
            1e-12,
        );
        near(mode.undamped_frequency(), (k / m).sqrt() / TAU, 1e-12);
        near(mode.damping_ratio(), c / (2.0 * (k * m).sqrt()), 1e-12);
        assert_eq!(found.stores, ["spring"]);
        for share in [
            mode.shares.kinetic[0],
            mode.shares.potential[0],
            mode.shares.lost[0],
        ] {
            near(share, 1.0, 1e-9);
        }
        // ½ m |v|² = 1 J
        let speed = (2.0 / m).sqrt();
        let column = |path: &str| outcome.results.column(path).expect("a column").values[0];
        let size = mode.value.norm();
        near(column("acceleration"), speed * size, 1e-7);
        near(column("place"), speed / size, 1e-7);
        near(
            column("spring.force.z"),
            (mode.value * c + k).norm() * speed / size,
            1e-7,
        );
        near(
            column("spring.force.z.phase").abs(),
            (PI - ((mode.value * c + k).arg())).abs(),
            1e-6,
        );
        near(column("frequency"), mode.frequency(), 1e-15);
        near(column("kinetic.block"), 1.0, 1e-9);
        let ratio = c / (2.0 * (k * m).sqrt());
        let decrement = TAU * ratio / (1.0 - ratio * ratio).sqrt();
        near(column("logarithmic_decrement"), decrement, 1e-12);
    }
    let none = modes(&program, "fast", &[]);
    assert_eq!((none.modes.len(), none.left_out), (0, [1, 0]));
    let outcome = run(&program, "modes", &[("damping", "400 N*s/m")]);
    let decrements = outcome.results.column("logarithmic_decrement");
    assert!(
        decrements
            .expect("a column")
            .values
            .iter()
            .all(|x| x.is_nan())
    );
    let found = outcome.modes.expect("modes");
    assert_eq!(found.modes.len(), 2);
    let root = ((400.0 / (2.0 * m)).powi(2) - k / m).sqrt();
    near(found.modes[0].value.re, -80.0 + root, 1e-12);
    near(found.modes[1].value.re, -80.0 - root, 1e-12);
    assert!(!found.modes[0].oscillates());
}

/// A mass on a spring behind ever heavier dampers: the slow pole, `−2k/(c + √(c² − 4mk))`, is found beside a fast one
/// of up to 10¹⁶ times its rate.
#[test]
fn what_creeps_behind_a_damper_is_no_zero() {
    let program = program(SPRING);
    let (m, k) = (2.5_f64, 9000.0_f64);
    for c in [1e5_f64, 1e7, 1e9, 1e11] {
        let found = modes(&program, "modes", &[("damping", &format!("{c:e} N*s/m"))]);
        assert_eq!((found.zeros, found.modes.len()), (0, 2), "{c:e}");
        let root = (c * c - 4.0 * m * k).sqrt();
        near(found.modes[0].value.re, -2.0 * k / (c + root), 1e-9);
        near(found.modes[1].value.re, -(c + root) / (2.0 * m), 1e-9);
    }
}

/// Two masses, free together, one of them with a very weak damper: a stiff spring between them, a true zero of the
/// place, and the slow pole `−c/(m₁ + m₂)` nine decades below the oscillation.
#[test]
fn a_free_motion_has_a_zero_and_dies_out() {
    let text = "
        use std.joints.Translational
        use std.forces.Bushing
        model Pair {
            gravity = [0, 0, 0] m/s^2
            marker wall = [0, 0, 0] mm
            body one { mass = 2 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
            body two { mass = 3 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
            joint rail_one = Translational(one.eye, wall)
            joint rail_two = Translational(two.eye, wall)
            force spring = Bushing(one.eye, two.eye, stiffness: [0, 0, 4e8] N/m, damping: [0, 0, 0] N*s/m,
                torsional_stiffness: [0, 0, 0] N*m/rad, torsional_damping: [0, 0, 0] N*m*s/rad)
            force air = Bushing(one.eye, wall, stiffness: [0, 0, 0] N/m, damping: [0, 0, 1e-4] N*s/m,
                torsional_stiffness: [0, 0, 0] N*m/rad, torsional_damping: [0, 0, 0] N*m*s/rad)
        }
        analysis modes = linear(Pair(), start: assembled)";
    let found = modes(&program(text), "modes", &[]);
    assert_eq!(
        (found.zeros, found.modes.len()),
        (1, 2),
        "{:?}",
        found.modes
    );
    near(
        circular(&found)[0],
        (4e8_f64 * (0.5 + 1.0 / 3.0)).sqrt(),
        1e-9,
    );
    near(found.modes[1].value.re, -1e-4 / 5.0, 1e-7);
}

/// A pendulum on a hub that turns about the vertical at a constant speed, at its outward balance, and hanging. Its
/// one freedom turns with the hub, so frozen coefficients are exact.
#[test]
fn a_turning_pendulum() {
    let text = "
        use std.joints.Revolute
        use std.drives.ConstantSpeed
        model Governor {
            param speed: AngularVelocity = 12 rad/s
            param out: Angle = 0 deg
            gravity = [0, 0, -9.81] m/s^2
            marker stand = [0, 0, 0] mm
            body hub { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker foot = origin; marker eye = at(origin, z: [0, -1, 0], x: [0, 0, -1]) }
            body bob {
                mass = 0.7 kg
                inertia = [0.9, 4, 4] g*m^2
                marker eye = at([-250, 0, 0] mm, z: [0, 0, 1], x: [1, 0, 0])
                guess rotation = [0, 90, 0] deg
            }
            drive turn = ConstantSpeed(hub.foot, stand, speed: speed)
            joint pin = Revolute(bob.eye, hub.eye)
            start pin.angle = out
            start pin.speed = 0 rpm
        }
        analysis modes = linear(Governor(), start: assembled, frozen: true)";
    let program = program(text);
    let (m, l, g) = (0.7_f64, 0.25_f64, 9.81_f64);
    let (along, about) = (0.9e-3, 4e-3 + m * l * l);
    let hanging = modes(&program, "modes", &[("speed", "1e-9 rad/s")]);
    near(circular(&hanging)[0], (m * g * l / about).sqrt(), 1e-10);
    let speed = 12.0_f64;
    let cosine = m * g * l / (speed * speed * (about - along));
    let angle = cosine.acos();
    assert!((0.3..1.4).contains(&angle), "{angle}");
    let found = modes(&program, "modes", &[("out", &format!("{angle} rad"))]);
    assert_eq!((found.freedoms, found.modes.len()), (1, 1));
    assert_eq!(
        (hanging.coefficients, found.coefficients),
        (Coefficients::Constant, Coefficients::Frozen)
    );
    let due = speed * angle.sin() * ((about - along) / about).sqrt();
    near(circular(&found)[0], due, 1e-9);
    assert!(found.modes[0].damping_ratio().abs() < 1e-9);
}

/// Nothing holds a body that turns freely about a pin beside its centre: two zeros, no oscillation.
#[test]
fn a_body_turning_about_a_pin_is_not_held() {
    let text = "
        use std.joints.Revolute
        model Wheel {
            gravity = [0, 0, 0] m/s^2
            marker stand = [0, 0, 0] mm
            body wheel { mass = 3 kg; inertia = [3, 4, 5] g*m^2; products_of_inertia = [0.2, 0.1, -0.1] g*m^2; center_of_mass = [30, 10, 5] mm; marker eye = origin }
            joint pin = Revolute(wheel.eye, stand)
            start pin.angle = 50 deg
            start pin.speed = 3000 rpm
        }
        analysis modes = linear(Wheel(), start: assembled, frozen: true)";
    let found = modes(&program(text), "modes", &[]);
    assert_eq!(
        (found.zeros, found.modes.len()),
        (2, 0),
        "{:?}",
        found.modes
    );
}

/// A slider driven to and fro by a free crank, in the middle of its motion: `λ² = −K` with the closed form of
/// its one freedom in the coordinate `x = √m δθ`, `K = (ṁ/2m)² + (½ m′ θ̈ + V″)/m`.
#[test]
fn a_crank_of_varying_inertia() {
    let text = "
        use std.joints.{Revolute, Translational, Distance}
        model Crank {
            gravity = [-60, 0, 0] m/s^2
            marker stand = [0, 0, 0] mm
            marker rail = at([0, 0, 0] mm, z: [1, 0, 0], x: [0, 1, 0])
            body crank { mass = 2 kg; inertia = [2, 2, 3] g*m^2; marker hub = origin; marker pin = [50, 0, 0] mm }
            body slider { mass = 0.8 kg; inertia = [1, 1, 1] g*m^2; marker eye = at(origin, z: [1, 0, 0], x: [0, 1, 0]); guess position = [200, 0, 0] mm }
            joint bearing = Revolute(crank.hub, stand)
            joint way = Translational(slider.eye, rail) { branch travel > 0 mm }
            joint rod = Distance(crank.pin, slider.eye, length: 170 mm)
            start bearing.angle = 130 deg
            start bearing.speed = 90 rpm
        }
        analysis modes = linear(Crank(), start: assembled, frozen: true)";
    let found = modes(&program(text), "modes", &[]);
    let (inertia, mass, g, r, l) = (3e-3, 0.8, 60.0, 0.05, 0.17);
    let (theta, speed) = (130f64.to_radians(), 90.0 * PI / 30.0);
    // place of the slider and its derivatives by θ: u = √(l² − r² sin²θ)
    let (sin, cos) = theta.sin_cos();
    let u = (l * l - r * r * sin * sin).sqrt();
    let u1 = -r * r * sin * cos / u;
    let u2 = (-r * r * (cos * cos - sin * sin) - u1 * u1) / u;
    let u3 = (4.0 * r * r * sin * cos - 3.0 * u1 * u2) / u;
    let (x1, x2, x3) = (-r * sin + u1, -r * cos + u2, r * sin + u3);
    let m = inertia + mass * x1 * x1;
    let m1 = 2.0 * mass * x1 * x2;
    let (v1, v2) = (mass * g * x1, mass * g * x2);
    let acceleration = -(0.5 * m1 * speed * speed + v1) / m;
    let stiffness = (m1 * speed / (2.0 * m)).powi(2) + (0.5 * m1 * acceleration + v2) / m;
    // x3 enters m″ alone, which drops out
    assert!(x3.is_finite() && stiffness > 1.0, "{stiffness}");
    assert_eq!(found.modes.len(), 1);
    near(circular(&found)[0], stiffness.sqrt(), 1e-9);
}

/// Whirl of a disc on an elastic support of its axis over its speed: `J_t ω² − J_p Ω ω − k = 0`, forwards and
/// backwards.
#[test]
fn a_gyroscopic_rotor_over_speed() {
    let text = "
        use std.joints.Spherical
        force AxisSpring(a: Marker, b: Marker, k: TorsionalStiffness) {
            apply torque k*1 rad*cross(a.z, b.z) on a against b
        }
        model Rotor {
            param speed: AngularVelocity = 0 rad/s
            gravity = [0, 0, 0] m/s^2
            marker stand = [0, 0, 0] mm
            body disc { mass = 5 kg; inertia = [20, 20, 38] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 1]*speed }
            joint ball = Spherical(disc.hub, stand)
            force support = AxisSpring(disc.hub, stand, k: 500 N*m/rad)
        }
        analysis campbell[s in [0, 50, 200, 800] rad/s] = linear(Rotor(speed: s))";
    let program = program(text);
    let (transverse, polar, k) = (20e-3_f64, 38e-3_f64, 500.0_f64);
    for (index, speed) in [0.0, 50.0, 200.0, 800.0].into_iter().enumerate() {
        let found = modes(&program, &format!("campbell[{}]", index + 1), &[]);
        assert_eq!(found.coefficients, Coefficients::Constant);
        let half = polar * speed / (2.0 * transverse);
        let root = (half * half + k / transverse).sqrt();
        let found = (circular(&found), found.zeros);
        assert_eq!((found.0.len(), found.1), (2, 2));
        near(found.0[0], root - half, 1e-9);
        near(found.0[1], root + half, 1e-9);
    }
}

/// A flywheel on its coupling: two discs and a spring between; the common rotation is free.
const DISCS: &str = "
    use std.joints.Revolute
    use std.forces.TorsionSpring
    model Discs {
        param damping: TorsionalDamping = 8 N*m*s/rad
        gravity = [0, 0, 0] m/s^2
        marker stand = [0, 0, 0] mm
        marker far = [0, 0, 200] mm
        body crank { mass = 20 kg; inertia = [0.1, 0.1, 0.18] kg*m^2; marker hub = origin }
        body wheel { mass = 11 kg; inertia = [0.06, 0.06, 0.112] kg*m^2; marker hub = origin; guess position = [0, 0, 200] mm }
        joint main = Revolute(crank.hub, stand)
        joint pilot = Revolute(wheel.hub, far)
        force coupling = TorsionSpring(wheel.hub, crank.hub, stiffness: 2e4 N*m/rad, damping: damping)
        start main.angle = 0 deg
        start pilot.angle = 2 deg
        start main.speed = 4000 rpm
        start pilot.speed = 4000 rpm
        output twist = coupling.twist
    }
    analysis modes = linear(Discs(), start: assembled)
    analysis decay = transient(Discs(), duration: 60 ms, sample: 0.05 ms, start: assembled, tolerance: 1e-3)";

#[test]
fn a_flywheel_on_its_coupling_and_its_decay_in_time() {
    let program = program(DISCS);
    let found = modes(&program, "modes", &[]);
    let inverse: f64 = 1.0 / 0.18 + 1.0 / 0.112;
    let (k, c) = (2e4, 8.0);
    assert_eq!((found.zeros, found.modes.len()), (2, 1));
    let mode = &found.modes[0];
    near(mode.value.norm(), (k * inverse).sqrt(), 1e-9);
    near(mode.value.re, -0.5 * c * inverse, 1e-9);
    // the lighter disc moves more: kinetic energies as the inverse inertias
    near(mode.shares.kinetic[1], 1.0 / 0.112 / inverse, 1e-9);
    let results = run(&program, "decay", &[]).results;
    let twist = &results.column("twist").expect("a column").values;
    let (re, im) = decay(&twist[10..], 0.05e-3);
    near(re, mode.value.re, 1e-4);
    near(im, mode.value.im, 1e-5);
}

const HELD: &str = "
    model Held {
        gravity = [0, 0, -9.81] m/s^2
        flexible bar {
            mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
            support = foot
            modes = static(at: tip, freedoms: [x, y]) + normal(6)
            damping = modal(2 %, up_to: 4000 Hz)
            marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm, tie: rigid)
            marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
        }
    }
    model Free {
        gravity = [0, 0, 0] m/s^2
        flexible bar {
            mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
            modes = normal(7)
            damping = 1 %
            marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
        }
    }
    analysis held = linear(Held())
    analysis free = linear(Free())";

/// The modes of one flexible body are those of its reduction.
#[test]
fn a_flexible_body_alone_has_the_modes_of_its_reduction() {
    let program = program(HELD);
    for (model, analysis, zeros) in [("Held", "held", 0), ("Free", "free", 12)] {
        let frequencies = program.model(model).expect("a model").reductions()[0]
            .frequencies()
            .to_vec();
        let found = modes(&program, analysis, &[]);
        assert_eq!((found.zeros, found.modes.len()), (zeros, frequencies.len()));
        for (place, (mode, due)) in found.modes.iter().zip(&frequencies).enumerate() {
            near(mode.undamped_frequency(), *due, 1e-9);
            let ratio = if model == "Held" && *due > 4000.0 {
                0.02 + 0.98 * ((due - 4000.0) / 16_000.0).min(1.0)
            } else if model == "Held" {
                0.02
            } else {
                0.01
            };
            near(mode.damping_ratio(), ratio, 1e-7);
            // a pair of equal frequencies may stand in any mixture
            let own: f64 = frequencies
                .iter()
                .zip(&mode.shares.kinetic[1..])
                .filter(|(f, _)| (*f / due - 1.0).abs() < 1e-6)
                .map(|(_, share)| share)
                .sum();
            near(own, 1.0, 1e-6);
            assert!(found.parts[place + 1].to_string() == format!("bar mode {}", place + 1));
        }
    }
}

/// A rigid rotor on one short bearing at ε = 0.4, with the published coefficients, SI; x along the load.
struct JournalRotor {
    program: Program,
    mass: f64,
    stiffness: [[f64; 2]; 2],
    damping: [[f64; 2]; 2],
    /// rad/s.
    speed: f64,
    /// Frequency of the whirl at the threshold over the speed.
    whirl: f64,
}

/// A rotor whose mass is this share of the mass at which whirl begins, under the same load.
fn journal_rotor(threshold: f64) -> JournalRotor {
    let table: serde_json::Value =
        serde_json::from_str(include_str!("reference/bearing_short_coefficients.json"))
            .expect("JSON");
    let rows = table["short_bearing_ocvirk"]["rows"]
        .as_array()
        .expect("rows");
    let row = rows
        .iter()
        .find(|r| r["eps"].as_f64() == Some(0.4))
        .expect("0.4");
    let number = |key: &str| row[key].as_f64().expect("a number");
    // S = μ N L D/W (R/c)², times (L/D)²
    let (d, l, c, mu, speed): (f64, f64, f64, f64, f64) = (0.05, 0.0125, 30e-6, 0.01, 500.0);
    let load = mu * speed / TAU * l * d * (0.5 * d / c).powi(2) * (l / d).powi(2) / number("S_LD2");
    let mass = threshold * number("M_crit") * load / (c * speed * speed);
    let attitude = number("attitude_deg").to_radians();
    let ratio = 0.4 * c;
    let text = format!(
        "
        use std.joints.{{ParallelAxes, PointOnPlane}}
        use std.drives.PrescribedRotation
        use std.journals.Short
        model Jeffcott {{
            param aside: Length = 0 um
            gravity = [{gravity:e}, 0, 0] m/s^2
            marker shell = [0, 0, 0] mm
            body rotor {{
                mass = {mass:e} kg; inertia = [1, 1, 1] g*m^2; marker pin = origin
                guess position = [{x:e} m, {y:e} m + aside, 0 m]
            }}
            joint level = ParallelAxes(rotor.pin, shell)
            joint thrust = PointOnPlane(rotor.pin, shell)
            drive turn = PrescribedRotation(rotor.pin, shell, speed: 500 rad/s)
            journal film = Short(pin: rotor.pin, shell: shell, diameter: 50 mm, width: 12.5 mm,
                radial_clearance: 30 um, viscosity: 10 mPa*s)
            output x = dot(rotor.pin.origin, ground.x) as um
            output y = dot(rotor.pin.origin, ground.y) as um
        }}
        analysis modes = linear(Jeffcott())
        analysis decay = transient(Jeffcott(aside: 0.05 um), duration: 120 ms, sample: 2 ms, start: assembled, step: 20 us)",
        gravity = load / mass,
        x = ratio * attitude.cos(),
        y = ratio * attitude.sin(),
    );
    let matrix = |name: &str, unit: f64| {
        ["x", "y"].map(|i| ["x", "y"].map(|j| unit * number(&format!("{name}{i}{j}"))))
    };
    JournalRotor {
        program: program(&text),
        mass,
        stiffness: matrix("K", load / c),
        damping: matrix("C", load / (c * speed)),
        speed,
        whirl: number("whirl_ratio"),
    }
}

/// A rigid rotor on a short bearing: eigenvalues with the published coefficients (x along the load, y on in
/// the sense of rotation).
#[test]
fn a_rotor_on_a_short_bearing_has_the_published_stiffness_and_damping() {
    for threshold in [0.3, 0.9] {
        let rotor = journal_rotor(threshold);
        let outcome = run(&rotor.program, "modes", &[]);
        let found = outcome.modes.expect("modes");
        assert_eq!((found.freedoms, found.zeros), (2, 0), "{:?}", outcome.start);
        assert!(
            matches!(outcome.start, Some(eng::StartReport::QuasiStatic(_))),
            "{:?}",
            outcome.start
        );
        assert!(!found.modes.is_empty());
        let due = published(&rotor);
        for mode in &found.modes {
            let off = distance(mode.value, &due);
            assert!(off < 1e-5, "{} {due:?} {off:e}", mode.value);
        }
    }
}

/// λ of the rotor with the published coefficients.
fn published(rotor: &JournalRotor) -> Vec<Complex<f64>> {
    let (k, c, mass) = (rotor.stiffness, rotor.damping, rotor.mass);
    let matrix = DMatrix::from_fn(4, 4, |i, j| match (i, j) {
        (0..2, _) => f64::from(u8::from(j == i + 2)),
        (_, 0..2) => -k[i - 2][j] / mass,
        _ => -c[i - 2][j - 2] / mass,
    });
    matrix.complex_eigenvalues().iter().copied().collect()
}

/// The distance of λ from the nearest of others, as a share of its size.
fn distance(value: Complex<f64>, others: &[Complex<f64>]) -> f64 {
    others
        .iter()
        .map(|x| (x - value).norm() / value.norm())
        .fold(f64::INFINITY, f64::min)
}

/// The threshold of whirl of a rigid rotor on short bearings, and the whirl there, against the published chart.
/// Beside the threshold the whirl is that of the published coefficients with the rotor's mass, and not that of the
/// chart (at 2 % the difference is 0.7 %).
#[test]
fn a_rotor_begins_to_whirl_at_the_published_threshold() {
    for (threshold, grows) in [(0.98, false), (1.02, true)] {
        let rotor = journal_rotor(threshold);
        let found = modes(&rotor.program, "modes", &[]);
        let slow = found.oscillations().next().expect("a whirl");
        assert_eq!(slow.grows(), grows, "{}", slow.value);
        assert_eq!(
            found.modes.iter().filter(|m| m.grows()).count(),
            usize::from(grows)
        );
        let off = distance(slow.value, &published(&rotor));
        println!(
            "whirl at {threshold} of the threshold: {} of the speed, {off:.1e} from the published coefficients' ({} at the threshold)",
            slow.value.im / rotor.speed,
            rotor.whirl
        );
        assert!(off < 1e-9, "{} {off:e}", slow.value);
        // the film feeds energy into it
        assert_eq!(slow.shares.lost[0] < 0.0, grows);
    }
    let JournalRotor {
        program,
        speed,
        whirl,
        ..
    } = journal_rotor(1.0);
    let found = modes(&program, "modes", &[]);
    let slow = found.oscillations().next().expect("a whirl");
    near(slow.value.im / speed, whirl, 1e-5);
    assert!(slow.damping_ratio().abs() < 1e-5, "{}", slow.value);
}

/// Displaced by 50 nm, the rotor returns with the decay of its slow mode.
#[test]
fn a_rotor_swings_back_as_its_mode_says() {
    let program = journal_rotor(0.7).program;
    let found = modes(&program, "modes", &[]);
    let slow = found.oscillations().next().expect("a whirl");
    assert!(slow.damping_ratio() > 0.01, "{}", slow.value);
    let results = run(&program, "decay", &[]).results;
    let y = &results.column("y").expect("a column").values;
    // differences of samples know nothing of where it comes to rest; faster modes have gone by 20 ms
    let swing: Vec<f64> = y[10..].windows(2).map(|w| w[1] - w[0]).collect();
    let (re, im) = decay(&swing, 2e-3);
    println!("{re} {im} instead of {}", slow.value);
    near(im, slow.value.im, 1e-4);
    near(re, slow.value.re, 2e-3);
}

/// A spring behind a damper (Maxwell's element), whose force is a state: `λ² + k/c λ + k/m = 0`, and a zero
/// of the place.
#[test]
fn a_state_of_an_element() {
    let text = "
        use std.joints.Translational
        force Maxwell(a: Marker, b: Marker, k: Stiffness, c: Damping) {
            state pull: Force = 0 N scale 1 N
            der(pull) = k*dot(a.velocity - b.velocity, b.z) - pull*k/c
            apply force -pull*b.z on a against b
            output tension = pull as N
        }
        model Strut {
            gravity = [0, 0, 0] m/s^2
            marker wall = [0, 0, 0] mm
            body block { mass = 2 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
            joint rail = Translational(block.eye, wall)
            force strut = Maxwell(block.eye, wall, k: 8000 N/m, c: 300 N*s/m)
        }
        analysis modes = linear(Strut())";
    let outcome = run(&program(text), "modes", &[]);
    let found = outcome.modes.expect("modes");
    assert_eq!((found.freedoms, found.states, found.zeros), (1, 1, 1));
    let (m, k, c) = (2.0_f64, 8000.0_f64, 300.0_f64);
    assert_eq!(found.modes.len(), 1);
    let mode = &found.modes[0];
    near(mode.value.norm(), (k / m).sqrt(), 1e-12);
    near(mode.value.re, -0.5 * k / c, 1e-12);
    // the force that the mass feels is that of its acceleration
    let tension = outcome
        .results
        .column("strut.tension")
        .expect("a column")
        .values[0];
    near(tension, m * (2.0 / m).sqrt() * mode.value.norm(), 1e-7);
}

/// A free bar that spins about its axis: from the ground it nutates with `Ω J_p/J_t`; bending, ω₀ from the ground, is
/// ω₀ ± Ω in the bar's own axes, except for the gyroscopic moment of its sections.
#[test]
fn a_spinning_bar_in_its_own_axes() {
    let text = "
        model Free {
            param spin: AngularVelocity = 0 rad/s
            gravity = [0, 0, 0] m/s^2
            flexible bar {
                mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
                modes = normal(4)
                damping = 0 %
                geometric_stiffness = true
                marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
                start angular_velocity = [0, 0, 1]*spin
            }
        }
        analysis modes = linear(Free(), start: assembled, frozen: true)";
    let program = program(text);
    let still = circular(&modes(&program, "modes", &[]));
    let turning = circular(&modes(&program, "modes", &[("spin", "600 rad/s")]));
    let (side, length) = (0.02_f64, 0.2_f64);
    let inertia = 2.0 * side * side / (side * side + length * length);
    // The second bending answers a tilt rate w with a = −C Ω w/ω₂², C = ∂J_xz/∂a. Its axes turn with the bar;
    // the frozen ones do not, and leave of the moment d/dt(Ω C a) in ground axes the part −i C²Ω³/ω₂² w: J_p
    // Ω appears less by C²Ω³/ω₂². In mean axes C = 2 side²/12 Δφ/L for a shape φ of mean square 1 (slender:
    // Δφ = 4 from end to end), J_p = side²/6, both over the mass.
    let slope = 2.0 * side * side / 12.0 * 4.0 / length;
    let frozen = slope * slope / (side * side / 6.0) * (600.0 / still[2]).powi(2);
    println!(
        "nutation: {:.2e} below the rigid bar's, {frozen:.2e} by frozen axes",
        1.0 - turning[0] / (600.0 * inertia)
    );
    near(turning[0], 600.0 * inertia * (1.0 - frozen), 1e-6);
    // rotary inertia of the sections, r = I/A · ∫φ′²/∫φ² = side²/12 · 49.48/L² (first free bending of a
    // slender beam, R. D. Blevins, 1979): from the ground the whirls are at ω₀ ± Ω r/(1 + r)
    let rotary = side * side / 12.0 * 49.48 / (length * length);
    let due = 600.0 * (1.0 - rotary / (1.0 + rotary));
    for (k, sign) in [-1.0, 1.0].into_iter().enumerate() {
        let shift = sign * (turning[k + 1] - still[0]);
        assert!((shift - due).abs() < 5e-3 * 600.0, "{shift} {due}");
    }
}

/// The same bits in every run, and in any order of threads.
#[test]
fn the_same_bits() {
    let text = HELD;
    let (first, second) = (
        modes(&program(text), "held", &[]),
        std::thread::spawn(move || modes(&program(text), "held", &[]))
            .join()
            .expect("a thread"),
    );
    assert_eq!(first, second);
}

/// A rotor on two tilting pads whose oil brakes it: the zero of its angle is no motion of 3e-29 1/s that grows. The
/// slide along its axis is a double zero.
#[test]
fn a_free_angle_is_a_zero_and_no_growth() {
    let text = "
        use std.journals.JournalLaw
        journal Pads(pin: Marker, shell: Marker, diameter: Length, width: Length, radial_clearance: Length,
                     viscosity: DynamicViscosity, kxx: Stiffness, kyy: Stiffness, kxy: Stiffness, cxx: Damping, cyy: Damping) : JournalLaw {
            let p = local(pin.origin - shell.origin, shell)
            let e = [p.x, p.y]
            let v = der(e)
            let fx = -kxx*e.x - kxy*e.y - cxx*v.x
            let fy = kxy*e.x - kyy*e.y - cyy*v.y
            let w = dot(pin.angular_velocity - shell.angular_velocity, shell.z)
            let t = pi/4*viscosity*diameter^3*width*w/radial_clearance
            let F = vector([fx, fy, 0 N], shell)
            apply force F on pin against shell
            apply torque -t*shell.z on pin against shell
            output force: Vector<Force> = F in shell as N
            output eccentricity: Vector2<Length> = e in shell as um
            output eccentricity_ratio: Vector2<1> = e/radial_clearance in shell
            output film_ratio: 1 = norm(e, floor: 1 nm)/radial_clearance
            output minimum_film: Length = radial_clearance - norm(e, floor: 1 nm) as um
            output friction_torque: Torque = t as N*m
            output power_loss: Power = t*w - fx*v.x - fy*v.y as W
        }
        model Rotor {
            gravity = [0, -9.81, 0] m/s^2
            body rotor {
                mass = 20 kg
                inertia = [0.5, 0.5, 0.3] kg*m^2
                marker a = [0, 0, -150] mm
                marker b = [0, 0, 250] mm
                start angular_velocity = [0, 0, 3000] rpm
            }
            marker sa = at([0, 0, -150] mm, z: [0, 0, 1], x: [1, 1, 0])
            marker sb = at([0, 0, 250] mm, z: [0, 0, 1], x: [1, 1, 0])
            journal ja = Pads(rotor.a, sa, diameter: 50 mm, width: 20 mm, radial_clearance: 30 um, viscosity: 10 mPa*s,
                kxx: 1e7 N/m, kyy: 2e7 N/m, kxy: 1e6 N/m, cxx: 2e3 N*s/m, cyy: 4e3 N*s/m)
            journal jb = Pads(rotor.b, sb, diameter: 50 mm, width: 20 mm, radial_clearance: 30 um, viscosity: 10 mPa*s,
                kxx: 3e7 N/m, kyy: 2e7 N/m, kxy: 2e6 N/m, cxx: 2e3 N*s/m, cyy: 4e3 N*s/m)
        }
        analysis modes = linear(Rotor(), number: 8)";
    let found = modes(&program(text), "modes", &[]);
    assert_eq!(found.oscillations().count(), 4);
    assert!(found.modes.iter().all(|mode| !mode.grows()), "{found:?}");
    assert_eq!((found.zeros, found.modes.len()), (3, 5), "{found:?}");
    // the oil of both brakes it: c/J
    let oil = 2.0 * PI / 4.0 * 0.01 * 0.05_f64.powi(3) * 0.02 / 30e-6;
    near(found.modes[4].value.re, -oil / 0.3, 1e-4);
}

/// Stiffness, pivots and loads that change with time alone. A load or a motion of the ground that only
/// excites leaves the coefficients, and with them the modes, as they are.
const TIMED: &str = "
    use std.joints.{Translational, Revolute}
    force Beaten(a: Marker, b: Marker, mean: Stiffness, swing: Stiffness, jump: Stiffness, across: Stiffness) {
        let away = a.origin - b.origin
        let later = if time > 1 s then jump else 0 N/m
        apply force -(mean - swing*cos(2 rad/s * time) + later)*dot(away, b.z)*b.z
            - across*(dot(away, b.x)*b.x + dot(away, b.y)*b.y) on a against b
    }
    force Push(a: Marker, b: Marker, along: Force, sideways: Force) {
        apply force (along*b.z + sideways*b.x)*sin(7 rad/s * time) on a against b
    }
    drive Shake(a: Marker, b: Marker, swing: Length) {
        constrain dot(a.origin - b.origin, b.z) == swing*cos(5 rad/s * time)
    }
    model Block {
        param swing: Stiffness = 0 N/m
        param jump: Stiffness = 0 N/m
        param along: Force = 0 N
        gravity = [0, 0, 0] m/s^2
        marker wall = [0, 0, 0] mm
        body block { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
        joint rail = Translational(block.eye, wall)
        force spring = Beaten(block.eye, wall, mean: 9 N/m, swing: swing, jump: jump, across: 0 N/m)
        force push = Push(block.eye, wall, along: along, sideways: 20 N)
    }
    model Loose {
        gravity = [0, 0, 0] m/s^2
        marker wall = [0, 0, 0] mm
        body block { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
        force spring = Beaten(block.eye, wall, mean: 1 N/m, swing: 0.1 N/m, jump: 0 N/m, across: 1e9 N/m)
    }
    model Shaken {
        param swing: Length = 30 mm
        gravity = [0, 0, -9.81] m/s^2
        marker wall = [0, 0, 0] mm
        body slide {
            mass = 1 kg
            inertia = [1, 1, 1] g*m^2
            marker eye = origin
            marker pin = at([0, 0, 0] mm, z: [0, 1, 0], x: [1, 0, 0])
        }
        body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = at([0, 0, 500] mm, z: [0, 1, 0], x: [1, 0, 0]) }
        joint rail = Translational(slide.eye, wall)
        drive shake = Shake(slide.eye, wall, swing: swing)
        joint hinge = Revolute(bob.eye, slide.pin)
    }
    model Carried {
        gravity = [0, 0, 0] m/s^2
        marker wall = [0, 0, 0] mm
        body slide { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
        body block { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
        joint rail = Translational(slide.eye, wall)
        joint guide = Translational(block.eye, slide.eye)
        drive shake = Shake(slide.eye, wall, swing: 30 mm)
        force spring = Beaten(block.eye, slide.eye, mean: 9 N/m, swing: 0 N/m, jump: 0 N/m, across: 0 N/m)
    }
    analysis plain = linear(Block())
    analysis pushed = linear(Block(along: 50 N))
    analysis beaten = linear(Block(swing: 0.2 N/m))
    analysis hardly = linear(Block(swing: 2e-3 N/m))
    analysis jumping = linear(Block(jump: 0.2 N/m))
    analysis held = linear(Block(swing: 0.2 N/m), frozen: true)
    analysis soft = linear(Loose())
    analysis shaken = linear(Shaken())
    analysis still = linear(Shaken(swing: 0 mm))
    analysis carried = linear(Carried())";

#[test]
fn coefficients_that_change_with_time_are_refused() {
    let program = program(TIMED);
    for analysis in ["plain", "pushed", "carried"] {
        let found = modes(&program, analysis, &[]);
        assert_eq!(found.coefficients, Coefficients::Constant, "{analysis}");
        assert!(found.variation < 1e-9, "{analysis}: {}", found.variation);
        near(circular(&found)[0], 3.0, 1e-9);
    }
    for (analysis, element) in [
        ("beaten", "spring"),
        ("jumping", "spring"),
        ("soft", "spring"),
        ("shaken", "shake"),
    ] {
        let message = refused(&program, analysis);
        assert!(
            message.contains(&format!("depend on time through {element}")),
            "{analysis}: {message}"
        );
    }
    near(
        circular(&modes(&program, "still", &[]))[0],
        (9.81 * 0.5 / 0.251_f64).sqrt(),
        1e-9,
    );
    let held = modes(&program, "held", &[]);
    assert_eq!(held.coefficients, Coefficients::Frozen);
    near(circular(&held)[0], 8.8_f64.sqrt(), 1e-9);
    // a swing of 2.2e-4 of the stiffness moves eigenvalues by 2.2e-4 of their size at most
    let hardly = modes(&program, "hardly", &[]);
    assert_eq!(hardly.coefficients, Coefficients::Constant);
    assert!(
        hardly.variation > 1e-4 && hardly.variation < 3e-4,
        "{}",
        hardly.variation
    );
    near(circular(&hardly)[0], 3.0, hardly.variation);
}

/// A round rotor that hangs lower in one of its bearings than in the other: a drive about the ground's axis allows it
/// other small rotations at every angle, by its tilt of some 1e-5. This moves no eigenvalue: the eigenvalues are
/// those of a whole turn.
#[test]
fn a_rotor_that_its_bearings_tilt() {
    let text = "
        use std.joints.PointOnPlane
        use std.journals.Short
        use std.drives.PrescribedRotation
        model Rotor {
            gravity = [0, -9.81, 0] m/s^2
            body rotor {
                mass = 60 kg
                inertia = [1.5, 1.5, 0.3] kg*m^2
                marker a = [0, 0, -150] mm
                marker b = [0, 0, 160] mm
                start angular_velocity = [0, 0, 3000] rpm
            }
            marker sa = at([0, 0, -150] mm, z: [0, 0, 1], x: [1, 1, 0])
            marker sb = at([0, 0, 160] mm, z: [0, 0, 1], x: [1, 1, 0])
            journal ja = Short(rotor.a, sa, diameter: 50 mm, width: 12 mm, radial_clearance: 30 um, viscosity: 10 mPa*s)
            journal jb = Short(rotor.b, sb, diameter: 50 mm, width: 12 mm, radial_clearance: 30 um, viscosity: 10 mPa*s)
            joint thrust = PointOnPlane(rotor.a, sa)
            drive turn = PrescribedRotation(rotor.a, sa, speed: 3000 rpm)
        }
        analysis held = linear(Rotor(), number: 6)
        analysis turn = linear(Rotor(), over: 1 rev, number: 6)";
    let program = program(text);
    let (held, turn) = (modes(&program, "held", &[]), modes(&program, "turn", &[]));
    assert_eq!(held.coefficients, Coefficients::Constant);
    assert!(
        held.variation > 0.0 && held.variation < 1e-4,
        "{}",
        held.variation
    );
    let mut compared = 0;
    for mode in held.oscillations() {
        let off = turn
            .modes
            .iter()
            .map(|other| (other.value - mode.value).norm())
            .fold(f64::INFINITY, f64::min);
        assert!(off < 1e-6 * mode.value.norm(), "{} {off:e}", mode.value);
        compared += 1;
    }
    assert!(compared >= 2, "{held:?}");
}

/// Two masses on springs and dampers, a force through a first-order lag, and an input that acts by its square. All
/// matrices are compared by their frequency response `C (iω − A)⁻¹ B + D` with the closed form of the two masses
/// `Z = [k1 + k2 + (d1 + d2) s + m1 s², −k2 − d2 s; −k2 − d2 s, k2 + d2 s + m2 s²]`, s = iω.
#[test]
fn the_frequency_response_is_that_of_two_masses() {
    let text = "use std.joints.Translational
        use std.forces.LinearSpring
        force Actuator(a: Marker, b: Marker, command: Force, lag: Time) {
            state pushed: Force = 0 N scale 1 N
            der(pushed) = (command - pushed)/lag
            apply force pushed*b.z on a against b
            output push = pushed as N
        }
        force Square(a: Marker, b: Marker, current: 1) {
            apply force 5 N*current^2*b.z on a against b
            output pull = 5 N*current^2 as N
        }
        force Bent(a: Marker, b: Marker, current: 1) { apply force max(current, 0)*1 N*b.z on a against b }
        model Two {
            input command: Force = 0 N
            input current: 1 = 0
            input bent: 1 = 0
            gravity = [0, 0, 0] m/s^2
            marker wall = [0, 0, 0] mm
            body near { mass = 2 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
            body far { mass = 3 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
            joint rail_near = Translational(near.eye, wall)
            joint rail_far = Translational(far.eye, wall)
            start rail_near.travel = 100 mm
            start rail_far.travel = 250 mm
            force first = LinearSpring(near.eye, wall, stiffness: 8 N/mm, damping: 20 N*s/m, free_length: 100 mm)
            force second = LinearSpring(far.eye, near.eye, stiffness: 5 N/mm, damping: 10 N*s/m, free_length: 150 mm)
            force actuator = Actuator(near.eye, wall, command: command, lag: 5 ms)
            force square = Square(far.eye, wall, current: current)
            force kink = Bent(far.eye, wall, current: bent)
            output near_at = rail_near.travel as mm
            output far_at = rail_far.travel as mm
            output acceleration = dot(far.origin.acceleration, ground.z)
            output pull = square.pull
        }";
    let program = program(text);
    let model = program.model("Two").expect("a model");
    let input = |path: &str| model.input(path).expect("an input");
    let (command, current) = (input("command"), input("current"));
    let channels = ["near_at", "far_at", "acceleration", "pull"];
    let channels = channels.map(|path| model.channel(path).expect("a channel"));
    let mut simulation = model.simulation().start().expect("a start");
    let value = 1.5;
    simulation.set_input(current, value).expect("a value");
    // the square pulls at once, so the state is no balance: the matrices are those of the moment
    let held = simulation
        .state_space(&[command, current], &channels, true)
        .expect("matrices");
    assert_eq!((held.freedoms, held.states), (2, 1));
    assert_eq!(held.a.shape(), (5, 5));
    assert_eq!(
        (held.b.shape(), held.c.shape(), held.d.shape()),
        ((5, 2), (4, 5), (4, 2))
    );
    let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
    let (m1, m2, k1, k2, d1, d2) = (2.0, 3.0, 8e3, 5e3, 20.0, 10.0);
    for hertz in [0.5, 6.0, 9.0, 13.0, 60.0, 400.0] {
        let s = Complex::new(0.0, TAU * hertz);
        let inverse = (DMatrix::from_diagonal_element(5, 5, s) - complex(&held.a))
            .lu()
            .solve(&complex(&held.b))
            .expect("regular");
        let found = complex(&held.c) * inverse + complex(&held.d);
        let near = s * (d1 + d2) + s * s * m1 + (k1 + k2);
        let (across, far) = (-(s * d2 + k2), s * d2 + s * s * m2 + k2);
        let all = near * far - across * across;
        let lag = Complex::new(1.0, 0.0) / (s * 5e-3 + 1.0);
        let slope = 10.0 * value;
        let due = [
            [far / all * lag, -across / all * slope],
            [-across / all * lag, near / all * slope],
            [-across / all * lag * s * s, near / all * slope * s * s],
            [Complex::new(0.0, 0.0), Complex::new(slope, 0.0)],
        ];
        // below resonance an acceleration is the small difference of the force and that of the springs
        let terms = [[0.0; 2], [0.0; 2], [1.0 / m1, slope / m2], [1e-8, 0.0]];
        for (row, due) in due.iter().enumerate() {
            for (column, due) in due.iter().enumerate() {
                let found = found[(row, column)];
                assert!(
                    (found - due).norm() <= 1e-7 * (due.norm() + terms[row][column]),
                    "{hertz} Hz, output {row}, input {column}: {found} instead of {due}"
                );
            }
        }
    }
    // only the acceleration and the pull answer at once
    assert!(held.d[(0, 0)] == 0.0 && held.d[(1, 1)] == 0.0);
    near(held.d[(2, 1)], 10.0 * value / m2, 1e-9);
    near(held.d[(3, 1)], 10.0 * value, 1e-9);
    let refused = simulation.state_space(&[input("bent")], &channels, true);
    let refused = refused.expect_err("a kink").to_string();
    assert!(refused.contains("has a kink at its value"), "{refused}");
}

#[test]
fn matrices_of_an_analysis_are_those_of_a_simulation_and_a_file() {
    let text = "
        use std.joints.Translational
        use std.forces.LinearSpring
        force Push(a: Marker, b: Marker, load: Force) { apply force load*b.z on a against b }
        model Cart {
            input push[i in 1..2]: Force = 0 N
            gravity = [0, 0, 0] m/s^2
            marker wall = [0, 0, 0] mm
            body block { mass = 2 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
            joint rail = Translational(block.eye, wall)
            force spring = LinearSpring(block.eye, wall, stiffness: 3 N/mm, damping: 40 N*s/m, free_length: 100 mm)
            force drive[i in 1..2] = Push(block.eye, wall, load: i*push[i])
            start rail.travel = 100 mm
            output at = rail.travel as mm
        }
        analysis small = linear(Cart(), inputs: [push[*]], outputs: [at, rail.force, spring.tension])
        analysis plain = linear(Cart())";
    let program = program(text);
    let folder = std::env::temp_dir().join(format!("eng-matrices-{}", std::process::id()));
    let recording = eng::results::Recording {
        folder: Some(folder.clone()),
        ..Default::default()
    };
    let analysis = program.analysis("small").expect("an analysis");
    let outcome = analysis.record(recording).run(&mut |_| {}).expect("modes");
    let found = outcome.modes.expect("modes").matrices.expect("matrices");
    let plain = modes(&program, "plain", &[]);
    assert!(plain.matrices.is_none());

    let model = program.model("Cart").expect("a model");
    let inputs = ["push[1]", "push[2]"].map(|path| model.input(path).expect("an input"));
    let outputs = [
        "at",
        "rail.force.x",
        "rail.force.y",
        "rail.force.z",
        "spring.tension",
    ];
    let channels = outputs.map(|path| model.channel(path).expect("a channel"));
    let mut simulation = model
        .simulation()
        .start_from(eng_system::system::Start::QuasiStatic)
        .start()
        .expect("a start");
    let due = simulation
        .state_space(&inputs, &channels, false)
        .expect("matrices");
    assert_eq!(found, due);

    // at rest a force F moves the block by F/k, and the spring carries it
    let gains = found.gains().expect("a regular A");
    for (column, factor) in [1.0, 2.0].into_iter().enumerate() {
        near(gains[(0, column)], factor / 3000.0, 1e-7);
        near(gains[(4, column)].abs(), factor, 1e-7);
    }

    let file = folder.join("small.matrices.json");
    let written = std::fs::read_to_string(&file).expect("a file");
    let written: serde_json::Value = serde_json::from_str(&written).expect("JSON");
    let names = |list: &str| -> Vec<&str> {
        let list = written[list].as_array().expect("a list");
        list.iter().filter_map(|s| s["path"].as_str()).collect()
    };
    assert_eq!(names("inputs"), ["push[1]", "push[2]"]);
    assert_eq!(names("outputs"), outputs);
    assert_eq!(written["outputs"][0]["unit"], "m");
    for (name, matrix) in [("A", &due.a), ("B", &due.b), ("C", &due.c), ("D", &due.d)] {
        for (i, row) in matrix.row_iter().enumerate() {
            for (j, number) in row.iter().enumerate() {
                let read = written[name][i][j].as_f64().expect("a number");
                assert_eq!(read.to_bits(), number.to_bits(), "{name} {i} {j}");
            }
        }
    }

    // the matrices of an earlier text do not remain
    let other = text.replace(
        "inputs: [push[*]], outputs: [at, rail.force, spring.tension]",
        "number: 3",
    );
    let program = self::program(&other);
    let analysis = program.analysis("small").expect("an analysis");
    let recording = eng::results::Recording {
        folder: Some(folder.clone()),
        ..Default::default()
    };
    analysis.record(recording).run(&mut |_| {}).expect("modes");
    assert!(!file.exists());
    std::fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn a_simulation_has_the_modes_of_its_present_state() {
    let program = program(SPRING);
    let model = program.model("Mass").expect("a model");
    let mut simulation = model.simulation().start().expect("a start");
    let wanted = eng::Wanted {
        frozen: true,
        ..eng::Wanted::default()
    };
    let found = simulation.linear_modes(wanted).expect("modes");
    assert_eq!((found.freedoms, found.modes.len()), (1, 1));
    let (m, c, k) = (2.5_f64, 40.0_f64, 9000.0_f64);
    near(found.modes[0].value.re, -c / (2.0 * m), 1e-12);
    near(
        found.modes[0].undamped_frequency(),
        (k / m).sqrt() / TAU,
        1e-12,
    );
}
