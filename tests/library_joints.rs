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

/// A ball joint with square trunnions moves as a cardan joint whose trunnions have these directions.
#[test]
fn square_axes_and_a_ball_are_a_cardan_joint() {
    let moved = |joints: &str| {
        let text = format!(
            "use std.joints.{{Perpendicular, Spherical, Universal}}
            model Shaft {{
                gravity = [3, -9.81, 2] m/s^2
                marker frame = at([0, 0, 0] mm, x: [1, 0, 0], z: [0, 0, 1])
                marker turned = at([0, 0, 0] mm, x: [0, 1, 0], z: [0, 0, 1])
                body shaft {{
                    mass = 2 kg
                    inertia = [3, 4, 2] g*m^2
                    center_of_mass = [10, 20, 60] mm
                    marker cross = at(origin, x: [1, 0, 0], z: [0, 0, 1])
                    marker trunnion = at(origin, x: [0, 1, 0], z: [1, 0, 0])
                }}
                {joints}
                output tip = shaft.origin.angular_velocity in ground as rad/s
            }}
            analysis run = transient(Shaft(), duration: 60 ms, sample: 10 ms)"
        );
        let results = run(&text, "run");
        ["tip.x", "tip.y", "tip.z"].map(|path| last(&results, path))
    };
    // a.x stays square to b.y in both
    let cardan = moved("joint cross = Universal(shaft.cross, frame)");
    let square = moved(
        "joint ball = Spherical(shaft.cross, frame)
        joint cross = Perpendicular(shaft.trunnion, turned)",
    );
    for (found, due) in square.into_iter().zip(cardan) {
        close("spin", found, due, 1e-6);
    }
}

/// Two shafts that meet at 30 degrees: equal speeds and torques, while a cardan joint would change the speed by 15 %.
#[test]
fn a_homokinetic_joint_keeps_the_speed() {
    let text = "use std.joints.{Homokinetic, PointOnLine, Revolute}
        use std.drives.PrescribedRotation
        use std.drivelines.RotationalDamper
        model Shafts {
            gravity = [0, 0, 0] m/s^2
            marker first = [0, 0, -100] mm
            marker second = at([50, 0, 86.60254037844386] mm, x: [0.8660254037844386, 0, -0.5], z: [0.5, 0, 0.8660254037844386])
            body input { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker seat = [0, 0, -100] mm; marker end = origin }
            body output_shaft {
                mass = 1 kg
                inertia = [1, 1, 1] g*m^2
                marker end = origin
                marker seat = [0, 0, 100] mm
                guess rotation = [0, 30, 0] deg
            }
            joint bearing = Revolute(input.seat, first)
            joint other = PointOnLine(output_shaft.seat, second)
            joint cross = Homokinetic(output_shaft.end, input.end)
            drive turn = PrescribedRotation(input.seat, first, speed: 600 rpm)
            force load = RotationalDamper(output_shaft.seat, second, damping: 0.1 N*m*s/rad)
            output turned = dot(output_shaft.seat.angular_velocity, second.z) as rad/s
        }
        analysis run = transient(Shafts(), duration: 100 ms, sample: 3 ms)";
    let results = run(text, "run");
    let speed = 20.0 * PI;
    for (k, turned) in column(&results, "turned").iter().enumerate() {
        assert!((turned / speed - 1.0).abs() < 1e-9, "{turned}");
        let torque = column(&results, "turn.torque.z")[k];
        assert!((torque / (0.1 * speed) - 1.0).abs() < 1e-7, "{torque}");
    }
    close("tilt", last(&results, "cross.tilt"), PI / 6.0, 1e-9);
}

/// A follower of 0.2 kg in a groove, and a block of 3 kg that a drive moves: forces and torque by Newton's equation.
#[test]
fn cams_and_drives_impose_a_travel() {
    let text = "use std.joints.{GrooveCam, Revolute, Translational}
        use std.drives.{ConstantSpeed, PrescribedTravel}
        fn lift(turn: Angle) -> Length = 5 mm*(1 + cos(turn))
        fn way(t: Time) -> Length = 20 mm*sin(50 rad/s*t)
        model Cam {
            gravity = [0, 0, -9.81] m/s^2
            marker guide = [0, 0, 0] mm
            marker rail = [200, 0, 0] mm
            marker axle = at([0, 0, -40] mm, z: [0, 1, 0])
            body cam { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker main = at(origin, z: [0, 1, 0]) }
            body follower { mass = 0.2 kg; inertia = [1, 1, 1] g*m^2; marker stem = origin }
            body block { mass = 3 kg; inertia = [1, 1, 1] g*m^2; marker seat = origin }
            drive turn = ConstantSpeed(cam.main, axle, speed: 100 rad/s, initial: 20 deg)
            joint slide = Translational(follower.stem, guide)
            joint groove = GrooveCam(follower.stem, guide, cam.main, axle, profile: lift, base: 2 mm)
            joint rails = Translational(block.seat, rail)
            drive push = PrescribedTravel(block.seat, rail, travel_at: way)
        }
        analysis run = transient(Cam(), duration: 80 ms, sample: 1 ms)";
    let results = run(text, "run");
    let time = column(&results, "time");
    for (k, t) in time.iter().enumerate() {
        let angle = 20.0_f64.to_radians() + 100.0 * t;
        let force = 0.2 * (9.81 - 5e-3 * 1e4 * angle.cos());
        let value = |path: &str| column(&results, path)[k];
        let travel = 2e-3 + 5e-3 * (1.0 + angle.cos());
        assert!((value("groove.travel") - travel).abs() < 1e-9);
        assert!((value("groove.force.z") - force).abs() < 1e-4, "{t}");
        let torque = force * -5e-3 * angle.sin();
        assert!((value("turn.torque.z") - torque).abs() < 1e-5, "{t}");
        let pushed = 3.0 * (9.81 - 0.02 * 2500.0 * (50.0 * t).sin());
        assert!((value("push.force.z") - pushed).abs() < 1e-3, "{t}");
    }
}
