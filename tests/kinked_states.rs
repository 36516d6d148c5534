//! Linearised motions about states at kinks: modes by closed forms, or a refusal.

use crate::support::program;
use eng::{Error, RuntimeError};
use eng_runtime::LinearModes;
use std::f64::consts::TAU;

fn modes(text: &str) -> Result<LinearModes, RuntimeError> {
    let program = program(text);
    let analysis = program.analysis("small").expect("an analysis");
    match analysis.run(&mut |_| {}) {
        Ok(outcome) => Ok(outcome.modes.expect("modes")),
        Err(failed) => match *failed.error {
            Error::Run { cause, .. } => Err(*cause),
            other => panic!("{other}"),
        },
    }
}

fn frequencies(text: &str) -> Vec<f64> {
    let found = modes(text).expect("modes");
    found
        .oscillations()
        .map(|mode| mode.undamped_frequency())
        .collect()
}

/// The path and the kink of a refusal.
fn refused(text: &str) -> (String, String) {
    match modes(text) {
        Err(RuntimeError::Kinked { origin, text, .. }) => (origin.path.clone(), text),
        Err(other) => panic!("{other}"),
        Ok(found) => panic!("modes {:?}", found.modes),
    }
}

fn assert_near(found: f64, due: f64, share: f64) {
    println!("{found} for {due}");
    assert!(
        (found / due - 1.0).abs() < share,
        "{found} instead of {due}"
    );
}

/// A disc on the arc springs of a dual-mass flywheel.
fn flywheel(play: &str, bias: &str) -> String {
    format!(
        "use std.joints.Revolute
        use std.drivelines.DualMassFlywheel
        force Moment(a: Marker, b: Marker, load: Torque) {{ apply torque load*b.z on a against b }}
        model Disc {{
            gravity = [0, 0, 0] m/s^2
            marker axis = [0, 0, 0] mm
            body disc {{ mass = 10 kg; inertia = [1, 1, 1]*0.15 kg*m^2; marker hub = origin }}
            joint pin = Revolute(disc.hub, axis)
            force arcs = DualMassFlywheel(disc.hub, axis, stiffness: 500 N*m/rad, second_stiffness: 1500 N*m/rad,
                free_play: {play}, second_stage: 20 deg, friction: 5 N*m, creep: 1 rad/s)
            force t = Moment(disc.hub, axis, load: {bias})
        }}
        analysis small = linear(Disc())"
    )
}

/// Both branches of the dead zone meet at zero with one slope: `sqrt(k/J)`, damping `friction/creep`. Between two
/// stages the slopes are 500 and 1500 N m/rad.
#[test]
fn springs_without_play_have_one_stiffness() {
    let found = modes(&flywheel("0 deg", "0 N*m")).expect("modes");
    let mode = found.oscillations().next().expect("a mode");
    assert_near(
        mode.undamped_frequency(),
        libm::sqrt(500.0 / 0.15) / TAU,
        1e-9,
    );
    assert_near(
        mode.damping_ratio(),
        5.0 / (2.0 * libm::sqrt(500.0 * 0.15)),
        1e-9,
    );
    let (due, share) = (8.798, mode.shares.potential.iter().sum::<f64>());
    assert_near(mode.frequency(), due, 1e-3);
    assert!((share - 1.0).abs() < 1e-9, "the springs hold all energy");
    let beside = frequencies(&flywheel("0 deg", "1e-3 N*m"));
    assert_near(beside[0], mode.undamped_frequency(), 1e-7);
    let (path, kink) = refused(&flywheel("0 deg", "500 N*m/rad*20 deg"));
    assert_eq!(
        (path.as_str(), kink.as_str()),
        ("arcs", "max(x - half, 0*x)")
    );
}

/// Teeth without backlash and without load: the gears vibrate on them with
/// `sqrt(k (ra^2/Ja + rb^2/Jb))`, and turn freely together. The separating force bends at zero, and the bearings hold it.
#[test]
fn teeth_without_backlash_have_both_flanks() {
    let text = "
        use std.joints.Revolute
        use std.drivelines.GearMesh
        model Gears {
            gravity = [0, 0, 0] m/s^2
            marker axis = [0, 0, 0] mm
            marker beside = [120, 0, 0] mm
            body a { mass = 2 kg; inertia = [1, 1, 1]*2 g*m^2; marker hub = origin }
            body b { mass = 4 kg; inertia = [1, 1, 1]*10 g*m^2; marker hub = origin }
            joint ja = Revolute(a.hub, axis)
            joint jb = Revolute(b.hub, beside)
            force mesh = GearMesh(a.hub, b.hub, axis, base_radius_a: 40 mm, base_radius_b: 70 mm,
                center_distance: 120 mm, stiffness: 200 N/um, damping: 800 N*s/m)
        }
        analysis small = linear(Gears())";
    let found = modes(text).expect("modes");
    let due = libm::sqrt(2e8 * (0.04 * 0.04 / 2e-3 + 0.07 * 0.07 / 1e-2)) / TAU;
    let mode = found.oscillations().next().expect("a mode");
    assert_near(mode.undamped_frequency(), due, 1e-7);
    assert_eq!(found.zeros, 2);
    let backlash = text.replace("damping: 800 N*s/m", "damping: 800 N*s/m, backlash: 50 um");
    assert_eq!(frequencies(&backlash), Vec::<f64>::new());
    // an axis that may move away feels the bend of the separating force
    let loose = text
        .replace("joint jb = Revolute(b.hub, beside)", "joint jb = Planar(b.hub, beside)\n            force held = Bush(b.hub, beside)")
        .replace("body b {", "body b { guess position = [120, 0, 0] mm;")
        .replace("std.joints.Revolute", "std.joints.{Planar, Revolute}")
        .replace(
            "model Gears",
            "force Bush(a: Marker, b: Marker) { apply force -1 kN/mm*(a.origin - b.origin) on a against b }
        model Gears",
        );
    assert_eq!(refused(&loose).0, "mesh");
}

/// A block on a spring, with another load.
fn block(load: &str, start: &str) -> String {
    format!(
        "use std.joints.Translational
        use std.contacts.{{EndStop, HuntCrossley}}
        use std.forces.LinearSpring
        force Bent(a: Marker, b: Marker, up: Stiffness, down: Stiffness) {{
            let d = dot(a.origin - b.origin, b.z)
            apply force (-(if d > 0 mm then up*d else down*d))*b.z on a against b
        }}
        force Jump(a: Marker, b: Marker) {{
            let d = dot(a.origin - b.origin, b.z)
            apply force (if d > 0 mm then -5 N else 0 N)*b.z on a against b
        }}
        force Rough(a: Marker, b: Marker, drag: Damping) {{
            let v = der(dot(a.origin - b.origin, b.z))
            apply force -drag*abs(v)*b.z on a against b
        }}
        force Ball(a: Marker, b: Marker, load: Force) {{
            let d = -dot(a.origin - b.origin, b.z)
            apply force (if d > 0 mm then load*(d/(1 mm))^1.5 else 0 N)*b.z on a against b
        }}
        force Even(a: Marker, b: Marker, drag: Damping/Velocity) {{
            let v = der(dot(a.origin - b.origin, b.z))
            apply force -drag*abs(v)*v*b.z on a against b
        }}
        model Block {{
            gravity = [0, 0, 0] m/s^2
            marker floor = [0, 0, 0] mm
            marker top = [0, 0, 100] mm
            body block {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }}
            joint rail = Translational(block.eye, floor)
            force spring = LinearSpring(block.eye, top, stiffness: 1 N/mm, damping: 2 N*s/m, free_length: 100 mm)
            force load = {load}
            start rail.travel = {start}
        }}
        analysis small = linear(Block())"
    )
}

/// One-sided laws at the place where they begin are refused with their kink; beside it they have the slope of their
/// side: `sqrt(k/m)`.
#[test]
fn one_sided_laws_are_refused_where_they_begin() {
    let stop = "EndStop(block.eye, floor, stiffness: 100 N/mm)";
    assert_eq!(
        refused(&block(stop, "0 mm")),
        ("load".to_owned(), "depth > 0 mm".to_owned())
    );
    // below a thousandth of its depth this law is a linear spring
    let ball = "HuntCrossley(block.eye, floor, reference_load: 100 N, reference_depth: 1 mm)";
    assert_eq!(refused(&block(ball, "0 mm")).1, "depth > 0 mm");
    // the rounding of a position does not choose a side
    assert_eq!(refused(&block(stop, "1e-12 mm")).0, "load");
    let bent = "Bent(block.eye, floor, up: 5 N/mm, down: 1 N/mm)";
    assert_eq!(refused(&block(bent, "0 mm")).1, "d > 0 mm");
    assert_eq!(
        refused(&block("Jump(block.eye, floor)", "0 mm")).1,
        "d > 0 mm"
    );
    assert_eq!(
        refused(&block("Rough(block.eye, floor, drag: 1 N*s/m)", "0 mm")).1,
        "abs(v)"
    );
    let clear = |place: &str| {
        let text = block(stop, place).replace(
            "free_length: 100 mm",
            &format!("free_length: 100 mm - {place}"),
        );
        frequencies(&text)[0]
    };
    assert_near(clear("0.1 mm"), libm::sqrt(1e3) / TAU, 1e-9);
    let pressed = block(stop, "0 mm")
        .replace("free_length: 100 mm", "free_length: 101 mm")
        .replace("start rail", "guess rail");
    assert_near(frequencies(&pressed)[0], libm::sqrt(101e3) / TAU, 1e-9);
}

/// Two stops that hold a block from both sides and just touch it: together they are the spring of one, or bend if one is stiffer.
#[test]
fn stops_from_both_sides_are_compared_together() {
    let both = |stiffness: &str| {
        let down = "EndStop(block.eye, floor, stiffness: 100 N/mm)";
        let up = format!(
            "force up = EndStop(block.eye, roof, stiffness: {stiffness})\n            start rail.travel"
        );
        block(down, "0 mm")
            .replace("start rail.travel", &up)
            .replace(
                "marker top",
                "marker roof = at([0, 0, 0] mm, z: [0, 0, -1])\n            marker top",
            )
    };
    assert_near(
        frequencies(&both("100 N/mm"))[0],
        libm::sqrt(101e3) / TAU,
        1e-9,
    );
    assert_eq!(refused(&both("101 N/mm")).1, "depth > 0 mm");
}

/// Equal slopes on both sides, a bend that vanishes at the state, and a stop across the only motion.
#[test]
fn kinks_without_a_bend_count_as_smooth() {
    let even = "Bent(block.eye, floor, up: 3 N/mm, down: 3 N/mm)";
    assert_near(
        frequencies(&block(even, "0 mm"))[0],
        libm::sqrt(4e3) / TAU,
        1e-9,
    );
    let drag = frequencies(&block("Even(block.eye, floor, drag: 7 N*s^2/m^2)", "0 mm"));
    assert_near(drag[0], libm::sqrt(1e3) / TAU, 1e-9);
    // load^(3/2): at the first touch it has no stiffness
    let ball = "Ball(block.eye, floor, load: 100 N)";
    assert_near(
        frequencies(&block(ball, "0 mm"))[0],
        libm::sqrt(1e3) / TAU,
        1e-9,
    );
    let across = block("EndStop(block.eye, side, stiffness: 100 N/mm)", "0 mm").replace(
        "marker top",
        "marker side = at([0, 0, 0] mm, x: [0, 0, 1], z: [1, 0, 0])\n            marker top",
    );
    assert_near(frequencies(&across)[0], libm::sqrt(1e3) / TAU, 1e-9);
}

/// A block on a plane with a load of several kinks, or of a table that ends at the state.
fn plane(load: &str) -> String {
    format!(
        "use std.joints.Planar
        use std.math.dead_zone
        force Pads(a: Marker, b: Marker) {{
            let d = local(a.origin - b.origin, b)
            apply force vector([-4 N/mm*dead_zone(d.x, 0 mm), -9 N/mm*dead_zone(d.y, 0 mm), 0 N], b) on a against b
        }}
        force Corner(a: Marker, b: Marker) {{
            let d = local(a.origin - b.origin, b)
            apply force vector([-4 N/mm*dead_zone(d.x, 0 mm), -9 N/mm*max(d.y, 0 mm), 0 N], b) on a against b
        }}
        force Ending(a: Marker, b: Marker) {{
            table push(x: Length) -> Force = points([0, 1, 2] mm, [0, 3, 6] N, extrapolation: hold)
            apply force -push(dot(a.origin - b.origin, b.x))*b.x on a against b
        }}
        force Continued(a: Marker, b: Marker) {{
            table push(x: Length) -> Force = points([0, 1, 2] mm, [0, 3, 6] N, extrapolation: linear)
            apply force -push(dot(a.origin - b.origin, b.x))*b.x on a against b
        }}
        model Block {{
            gravity = [0, 0, 0] m/s^2
            marker floor = [0, 0, 0] mm
            body block {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }}
            joint rail = Planar(block.eye, floor)
            force load = {load}(block.eye, floor)
        }}
        analysis small = linear(Block())"
    )
}

/// Four cones between two crossed dead zones without play: `sqrt(k/m)` along each. Where one of them pushes in one sense
/// only, and at the end of a table that is held, the sides differ.
#[test]
fn crossed_kinks_and_ends_of_tables_are_compared() {
    let found = frequencies(&plane("Pads"));
    assert_eq!(found.len(), 2);
    for (found, stiffness) in found.iter().zip([4e3, 9e3]) {
        assert_near(*found, libm::sqrt(stiffness) / TAU, 1e-9);
    }
    assert_eq!(refused(&plane("Corner")).1, "max(d.y, 0 mm)");
    assert_eq!(refused(&plane("Ending")).0, "load");
    assert_near(
        frequencies(&plane("Continued"))[0],
        libm::sqrt(3e3) / TAU,
        1e-9,
    );
}

/// A frequency response has no number for an output with other slopes on both sides of the state. Beside the kink, and for
/// smooth outputs, it goes on: curved ones, and those that do not change at all.
#[test]
fn outputs_with_a_kink_at_the_state_are_refused() {
    let shaken = |output: &str| {
        let text = format!(
            "use std.joints.Translational
            use std.forces.LinearSpring
            force Push(a: Marker, b: Marker, load: Force) {{ apply force load*b.z on a against b }}
            model Block {{
                gravity = [0, 0, 0] m/s^2
                input load: Force = 0 N
                marker floor = [0, 0, 0] mm
                marker top = [0, 0, 100] mm
                body block {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }}
                joint rail = Translational(block.eye, floor)
                force spring = LinearSpring(block.eye, top, stiffness: 1 N/mm, damping: 2 N*s/m, free_length: 100 mm)
                force push = Push(block.eye, floor, load: load)
                start rail.travel = 0 mm
                output asked = {output} as mm
            }}
            analysis small = response(Block(), to: load, of: [asked], from: 1 Hz, up_to: 20 Hz, start: assembled)"
        );
        let program = program(&text);
        let analysis = program.analysis("small").expect("an analysis");
        match analysis.run(&mut |_| {}) {
            Ok(_) => None,
            Err(failed) => match *failed.error {
                Error::Run { cause, .. } => match *cause {
                    RuntimeError::KinkedOutput { path, .. } => Some(path),
                    other => panic!("{other}"),
                },
                other => panic!("{other}"),
            },
        }
    };
    for bent in [
        "abs(rail.travel)",
        "max(rail.travel, 0 mm)",
        "(if rail.travel > 0 mm then 2*rail.travel else rail.travel)",
    ] {
        assert_eq!(shaken(bent), Some("asked".to_owned()), "{bent}");
    }
    for smooth in [
        "rail.travel",
        "max(rail.travel, -1 um)",
        "rail.travel + rail.travel^2/(1 um)",
        "max(rail.travel, 0 mm) - max(-rail.travel, 0 mm)",
        "abs(rail.travel)*rail.travel/(1 mm)",
        "(dot(block.eye.origin, ground.x) + 1 mm + rail.travel)",
    ] {
        assert_eq!(shaken(smooth), None, "{smooth}");
    }
}

/// A driven block on a spring with a second law, about its motion of one period.
fn driven(law: &str) -> String {
    block(law, "0.1 mm")
        .replace(
            "force spring",
            "force shake = Shake(block.eye, floor)\n            force spring",
        )
        .replace(
            "model Block",
            "force Shake(a: Marker, b: Marker) {
            apply force 5 N*sin(100 rad/s*time)*b.z on a against b
        }
        model Block",
        )
        .replace(
            "linear(Block())",
            "linear(Block(), after: 3 s, over: 0.06283185307179587 s)",
        )
}

/// A motion passes a kink at which a load bends. One at which a load jumps is refused, because a perturbed motion meets it at
/// another moment.
#[test]
fn a_motion_that_passes_a_jump_is_refused() {
    let bent = modes(&driven("Bent(block.eye, floor, up: 2 N/mm, down: 1 N/mm)"));
    let slowest = bent.expect("modes").oscillations().count();
    assert!(slowest > 0);
    match modes(&driven("Jump(block.eye, floor)")) {
        Err(RuntimeError::JumpsInPeriod { jump, .. }) => {
            assert_eq!(jump.origin.path, "load");
            assert!((jump.by - 5.0).abs() < 1e-6, "{jump:?}");
        }
        other => panic!("{other:?}"),
    }
}

/// A block that rests at the kink of its stop while another one moves is refused, as it is at rest alone.
#[test]
fn a_motion_with_a_block_that_rests_at_a_kink_is_refused() {
    let text = driven("EndStop(block.eye, floor, stiffness: 100 N/mm)")
        .replace("start rail.travel = 0.1 mm", "start rail.travel = 0 mm")
        .replace(
            "force shake = Shake(block.eye, floor)",
            "body other {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }}
            joint rail_of_other = Translational(other.eye, floor)
            force spring_of_other = LinearSpring(other.eye, top, stiffness: 1 N/mm, damping: 2 N*s/m, free_length: 100 mm)
            force shake = Shake(other.eye, floor)",
        )
        .replace("{{", "{")
        .replace("}}", "}");
    assert_eq!(
        refused(&text),
        ("load".to_owned(), "depth > 0 mm".to_owned())
    );
}
