//! Joints of `std.joints` that couple motions, and functions of `std.math` and `std.frames`, against closed forms.

use crate::library_run::{close, column, last, run};
use std::f64::consts::PI;

/// A nut of 2 kg and 3 g m² falls on a screw of 20 mm a turn: m g x = (m + J (2π/lead)²) v²/2.
#[test]
fn a_nut_falls_and_turns() {
    let text = "use std.joints.Screw
        model Nut {
            gravity = [0, 0, -10] m/s^2
            marker screw = [0, 0, 0] mm
            body nut { mass = 2 kg; inertia = [3, 3, 3] g*m^2; marker thread = origin }
            joint thread = Screw(nut.thread, screw, lead: 20 mm)
        }
        analysis fall = transient(Nut(), duration: 1 s, sample: 0.1 s)";
    let results = run(text, "fall");
    let mass = 2.0 + 3e-3 * (2.0 * PI / 0.02_f64).powi(2);
    close(
        "travel",
        last(&results, "thread.travel"),
        -0.5 * 20.0 / mass,
        1e-7,
    );
    close(
        "angle",
        last(&results, "thread.angle"),
        last(&results, "thread.travel") * 2.0 * PI / 0.02,
        1e-9,
    );
}

/// Gears with the ratio −0.4 to a rack: all accelerations from one reduced inertia.
#[test]
fn gears_and_rack_share_the_inertia() {
    let text = "use std.joints.{GearRatio, RackAndPinion, Revolute, Translational}
        use std.forces.ExternalTorque
        model Train {
            gravity = [0, 0, 0] m/s^2
            marker frame[i in 1..2] = [100*i, 0, 0] mm
            marker guide = at([0, 50, 0] mm, z: [1, 0, 0])
            body shaft[i in 1..2] { mass = 1 kg; inertia = [2, 2, 2*i] g*m^2; marker hub = origin }
            body rack { mass = 3 kg; inertia = [1, 1, 1] g*m^2; marker slide = at(origin, z: [1, 0, 0]) }
            joint bearing[i in 1..2] = Revolute(shaft[i].hub, frame[i])
            joint slide = Translational(rack.slide, guide)
            joint gears = GearRatio(shaft[1].hub, frame[1], shaft[2].hub, frame[2], gear_ratio: -0.4)
            joint pinion = RackAndPinion(shaft[2].hub, frame[2], rack.slide, guide, pinion_radius: 20 mm)
            force drive = ExternalTorque(shaft[1].hub, load: [0, 0, 1] N*m)
        }
        analysis run = transient(Train(), duration: 0.2 s, sample: 0.01 s)";
    let results = run(text, "run");
    // of the second shaft: 0.4 of the torque against J1 0.4² + J2 + m r²
    let reduced = 2e-3 * 0.16 + 4e-3 + 3.0 * 0.02 * 0.02;
    let speed = -0.4 / reduced * 0.2;
    close("second", last(&results, "bearing[2].speed"), speed, 1e-9);
    close(
        "first",
        last(&results, "bearing[1].speed"),
        -0.4 * speed,
        1e-9,
    );
    close("rack", last(&results, "slide.speed"), 0.02 * speed, 1e-9);
}

/// A differential whose cage is driven: both shafts have half of the torque; unlike shafts turn apart.
#[test]
fn a_differential_halves_the_torque() {
    let text = "use std.joints.{Differential, Revolute}
        use std.forces.ExternalTorque
        model Axle {
            gravity = [0, 0, 0] m/s^2
            marker frame = [0, 0, 0] mm
            body part[i in 1..3] { mass = 1 kg; inertia = [3, 3, [2, 4, 1][i]] g*m^2; marker hub = origin }
            joint bearing[i in 1..3] = Revolute(part[i].hub, frame)
            joint gear = Differential(part[1].hub, part[2].hub, part[3].hub)
            force drive = ExternalTorque(part[3].hub, load: [0, 0, 1] N*m)
        }
        analysis run = transient(Axle(), duration: 0.1 s, sample: 0.01 s)";
    let results = run(text, "run");
    // each shaft: J w' = M/2; the cage: Jc (w1' + w2')/2 = 1 N m − M
    let sum = 0.5 / 2e-3 + 0.5 / 4e-3;
    let torque = 1.0 / (1.0 + 1e-3 * sum / 2.0);
    close(
        "left",
        last(&results, "bearing[1].speed"),
        0.1 * torque / 2.0 / 2e-3,
        1e-9,
    );
    close(
        "right",
        last(&results, "bearing[2].speed"),
        0.1 * torque / 2.0 / 4e-3,
        1e-9,
    );
}

/// A disc that slides in a plane keeps its velocity and its spin; it does not leave the plane.
#[test]
fn a_disc_in_a_plane_keeps_its_motion() {
    let text = "use std.joints.Planar
        model Puck {
            gravity = [0, 0, -9.81] m/s^2
            marker table = [0, 0, 5] mm
            body disc { mass = 1 kg; inertia = [1, 1, 2] g*m^2; marker base = origin; start velocity = [1, 2, 0] m/s; start angular_velocity = [0, 0, 30] rad/s }
            joint ice = Planar(disc.base, table)
        }
        analysis run = transient(Puck(), duration: 1 s, sample: 0.1 s)";
    let results = run(text, "run");
    let travel = |axis: &str| {
        let values = column(&results, &format!("ice.travel.{axis}"));
        values[values.len() - 1] - values[0]
    };
    close("x", travel("x"), 1.0, 1e-9);
    close("y", travel("y"), 2.0, 1e-9);
    assert!(travel("z").abs() < 1e-12);
    close(
        "turn",
        last(&results, "ice.angle") - column(&results, "ice.angle")[0],
        30.0,
        1e-9,
    );
    close("table", last(&results, "ice.force.z"), 9.81, 1e-9);
}

/// A body on two equal links swings as a point on a thread, whatever its inertia.
#[test]
fn a_body_on_two_links_swings_as_a_point() {
    let text = "use std.joints.Bifilar
        model Swing {
            gravity = [0, -9.81, 0] m/s^2
            marker hook = [0, 0, 0] mm
            body board { mass = 2 kg; inertia = [1, 1, 1] kg*m^2; marker eye = origin; accept inertia }
            joint links = Bifilar(board.eye, hook, length: 200 mm)
            start links.swing = -90 deg
        }
        analysis modes = linear(Swing())";
    let results = run(text, "modes");
    let frequency = column(&results, "frequency");
    close(
        "frequency",
        frequency[0],
        (9.81_f64 / 0.2).sqrt() / (2.0 * PI),
        1e-9,
    );
}

/// `positive`, `beyond`, `dead_zone`, `step`, `polar` at places where their values are known.
#[test]
fn functions_have_their_values() {
    let text = "use std.math.*
        use std.frames.polar
        use std.joints.Revolute
        fn smooth(x: 1) -> 1 = step(x)
        fn rounded(x: 1) -> 1 = positive(x, 0.4)
        model Values {
            gravity = [0, 0, 0] m/s^2
            body wheel { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin; marker rim = polar(30 mm, 90 deg, 4 mm) }
            joint bearing = Revolute(wheel.hub, ground)
            output part[i in 1..3] = [positive(0 mm, 2 mm), positive(1.5 mm, 2 mm), positive(5 mm, 2 mm) - positive(-5 mm, 2 mm)][i]
            output zone[i in 1..3] = [beyond(0, 1, 0.1), beyond(1e3, 1, 0.1), dead_zone(-3, 1)][i]
            output inside: 1 = dead_zone(0.5, 1)
            output steps[i in 1..3] = [step(-1), step(0.5), step(2)][i]
            output slopes[i in 1..3] = [slope(smooth, 0), slope(smooth, 0.5), slope(rounded, 0)][i]
            output rim = wheel.rim.origin in ground as mm
        }
        analysis run = assemble(Values())";
    let results = run(text, "run");
    let value = |path: &str| last(&results, path);
    for (path, due) in [
        ("part[1]", 1e-3),
        ("part[2]", 2e-3),
        ("part[3]", 5e-3),
        ("zone[2]", 999.0),
        ("zone[3]", -2.0),
        ("steps[2]", 0.5),
        ("steps[3]", 1.0),
        ("slopes[2]", 1.875),
        ("slopes[3]", 0.5),
        ("rim.y", 0.03),
        ("rim.z", 0.004),
    ] {
        close(path, value(path), due, 1e-6);
    }
    for path in ["zone[1]", "inside", "steps[1]", "slopes[1]", "rim.x"] {
        assert!(value(path).abs() < 1e-15, "{path}: {}", value(path));
    }
}
