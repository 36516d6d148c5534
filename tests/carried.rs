//! Quasi-static starts of machines on mounts: shafts turn about the axes of their tilted blocks.

use crate::library_run::{close, column, outcome as run};
use eng::{Outcome, StartReport};
use eng_runtime::start::Equilibrium;

/// The quasi-static start of a run.
fn begun(outcome: &Outcome) -> &Equilibrium {
    match &outcome.start {
        Some(StartReport::QuasiStatic(found)) => found,
        Some(other) => panic!("{other}"),
        None => panic!("no start"),
    }
}

/// The largest effort that would hold a direction at the start (N or N m).
fn held(found: &Equilibrium) -> f64 {
    let efforts = found.held.iter().map(|held| held.effort.abs());
    efforts.fold(0.0, f64::max)
}

/// The first value of a column, in SI units.
fn first(outcome: &Outcome, path: &str) -> f64 {
    column(&outcome.results, path)[0]
}

/// A wheel in two films of a housing, which hangs from a mount beside its middle and so tilts by some degrees.
fn housing(speed: f64) -> String {
    format!(
        "use std.forces.Bushing
         use std.joints.PointOnPlane
         use std.journals.Impedance
         model Housing {{
             gravity = [0, -9.81, 0] m/s^2
             marker foot = [0, 0, 0] mm
             body housing {{
                 mass = 10 kg
                 inertia = [0.2, 0.2, 0.1] kg*m^2
                 marker support = [0, 0, -30] mm
                 marker shell[k in 1..2] = [0 mm, 0 mm, [-40, 40][k]*1 mm]
             }}
             body wheel {{
                 mass = 15 kg
                 inertia = [0.1, 0.1, 0.18] kg*m^2
                 marker pin[k in 1..2] = [0 mm, 0 mm, [-40, 40][k]*1 mm]
                 start angular_velocity = [0, 0, {speed}] rad/s
             }}
             cycle angle = rotation(wheel.pin[1], housing.shell[1]) {{ period = 360 deg }}
             force mount = Bushing(housing.support, foot, stiffness: [200, 200, 200] N/mm, damping: [1, 1, 1] kN*s/m,
                 torsional_stiffness: [200, 200, 4000] N*m/rad, torsional_damping: [20, 20, 20] N*m*s/rad)
             joint thrust = PointOnPlane(wheel.pin[1], housing.shell[1])
             journal film[k in 1..2] = Impedance(wheel.pin[k], housing.shell[k], diameter: 40 mm, width: 20 mm, radial_clearance: 20 um,
                 viscosity: 20 mPa*s)
             output tilt: Angle = atan2(dot(housing.support.z, ground.y), dot(housing.support.z, ground.z))
             output yaw: Angle = atan2(dot(housing.support.z, ground.x), dot(housing.support.z, ground.z))
             output sag: Length = dot(housing.support.origin, ground.y)
             output turning: AngularVelocity = norm(housing.support.angular_velocity, floor: 1e-12 rad/s)
             output spin: AngularVelocity = dot(wheel.pin[1].angular_velocity, housing.support.z)
         }}
         analysis run = transient(Housing(), duration: 20 ms, sample: 1 ms)"
    )
}

/// The axis of a wheel that turns in a tilted housing rests, so the housing hangs as with a wheel at rest: by its weights, the tilt t
/// of the mount's spring solves `k t = (arm of the weights) cos t`. It stays there.
#[test]
fn a_housing_with_a_turning_wheel_tilts_as_at_rest() {
    let weight = 25.0 * 9.81;
    let mut tilt = 0.0_f64;
    for _ in 0..50 {
        tilt = -weight * 0.03 * tilt.cos() / 200.0;
    }
    for speed in [30.0, 600.0, -1500.0] {
        let outcome = run(&housing(speed), "run");
        let effort = held(begun(&outcome));
        assert!(effort < 10.0, "{speed}: {effort}");
        close("tilt", first(&outcome, "tilt"), tilt, 2e-3);
        close("sag", first(&outcome, "sag"), -weight / 200e3, 2e-3);
        close("spin", first(&outcome, "spin"), speed, 1e-2);
        let rest = first(&outcome, "turning");
        assert!(rest < 1e-6 * speed.abs(), "{speed}: {rest}");
        for path in ["tilt", "yaw"] {
            let values = column(&outcome.results, path);
            let moved = values
                .iter()
                .fold(0.0_f64, |most, x| most.max((x - values[0]).abs()));
            println!("{speed} rad/s: {path} moves by {moved:.1e}");
            assert!(
                moved < 2e-2 * tilt.abs(),
                "{speed}: {path} moves by {moved}"
            );
        }
    }
}

/// A carried engine of three cylinders on one mount of rubber.
fn three(speed: f64, big_ends: &str, drive_line: &str) -> String {
    format!(
        "use std.cylinder.{{WeighedRod, diametral}}
        use std.engine.{{Crank, Engine}}
        use std.gas.{{ClosedCycle, wiebe}}
        use std.journals.Impedance
        use std.layouts.inline
        use std.mounts.ElastomerMount
        use std.oils.SAE_5W30
        model Three {{
            part engine = Engine(
                layout: inline(throws: [0, 240, 120] deg), order: [1, 3, 2],
                numbered_from: timing_end, seen_from: timing_end, sense: clockwise,
                bore: 74 mm, stroke: 82 mm, rod_length: 137 mm, spacing: 82 mm,
                main_diameter: 48 mm, main_width: 18 mm, main_clearance: diametral(44 um),
                {big_ends}, pin_diameter: 42 mm,
                law: Impedance, oil: SAE_5W30, oil_temperature: 110 degC,
                rod: WeighedRod(big_end: 0.32 kg, small_end: 0.13 kg, big_radius: 27 mm, small_radius: 13 mm), piston_mass: 0.33 kg,
                crankshaft: Crank(mass: 12 kg, inertia: [110, 110, 24] g*m^2),
                gas: ClosedCycle(stroke: 82 mm, compression_ratio: 10.5, heat: 0.9 kJ, burnt: wiebe(begin: -18 deg, duration: 50 deg)),
                flywheel_mass: 8 kg, flywheel_inertia: 80 g*m^2, block_mass: 45 kg, block_inertia: [1.2, 1.3, 0.7] kg*m^2,
                block_is: carried, speed: {speed} rpm, {drive_line},
            )
            marker foot = [0, 0, 0] mm
            force mount = ElastomerMount(engine.block.support, foot, stiffness: [300, 300, 300] N/mm, fast_stiffness: [400, 400, 400] N/mm,
                relaxation: 8 ms, torsional_stiffness: [30, 30, 30] kN*m/rad, torsional_damping: [200, 200, 200] N*m*s/rad)
            gravity = engine.up*(-9.81 m/s^2)
        }}
        analysis begin = transient(Three(), duration: 5 deg, sample: 1 deg)
        analysis fired = periodic(Three(), sample: 2 deg, change: 1 %)"
    )
}

const FILMS: &str = "big_ends: film, pin_width: 18 mm, pin_clearance: diametral(40 um)";

/// Carried engines begin in balance at every speed, with films and with hinges in the big ends.
#[test]
fn a_carried_engine_begins_in_balance() {
    for (speed, big_ends, drive_line) in [
        (300.0, FILMS, "drive_line: constant_speed"),
        (3000.0, FILMS, "drive_line: constant_speed"),
        (6000.0, FILMS, "drive_line: constant_speed"),
        (3000.0, "big_ends: hinge", "drive_line: constant_speed"),
        (6000.0, "big_ends: hinge", "drive_line: constant_speed"),
        (
            3000.0,
            FILMS,
            "drive_line: dynamometer, coupling_stiffness: 500 N*m/rad, coupling_damping: 2 N*m*s/rad",
        ),
    ] {
        let outcome = run(&three(speed, big_ends, drive_line), "begin");
        let effort = held(begun(&outcome));
        println!("{speed} {big_ends}: {effort}");
        // the gas of one cylinder at its highest pressure has some 700 N m
        assert!(effort < 1000.0, "{speed} {big_ends}: {effort}");
    }
}

/// The cycle of a carried engine repeats, with films and with hinges, and in the mean the mount yields by the weight of all parts.
#[test]
fn a_carried_engine_repeats() {
    let weight = (45.0 + 12.0 + 8.0 + 3.0 * (0.33 + 0.45)) * 9.81;
    for big_ends in [FILMS, "big_ends: hinge"] {
        let text = three(3000.0, big_ends, "drive_line: constant_speed");
        let outcome = run(&text, "fired");
        let periodic = outcome.periodic.as_ref().expect("a periodic analysis");
        println!("{big_ends}: {} cycles", periodic.cycles);
        assert!(
            periodic.repeats && periodic.cycles <= 15,
            "{big_ends}: {periodic:?}"
        );
        let cycle = &column(&outcome.results, "mount.deflection.x")[..360];
        let sag = cycle.iter().sum::<f64>() / 360.0;
        close("sag", sag, -weight / 300e3, 1e-2);
    }
}

/// Two mounts under the feet of a rigid block carry the weight of the engine together.
#[test]
fn feet_carry_the_engine() {
    let feet = "block_is: carried, block_feet: [[-100, -100, 0] mm, [-100, 300, 0] mm],";
    let mount = "force mount[k in 1..2] = ElastomerMount(engine.block.foot[k], place[k]";
    let text = three(3000.0, "big_ends: hinge", "drive_line: constant_speed")
        .replace("block_is: carried,", feet)
        .replace(
            "marker foot = [0, 0, 0] mm",
            "marker place[k in 1..2] = [-100, [-100, 300][k], 0]*(1 mm)",
        )
        .replace(
            "force mount = ElastomerMount(engine.block.support, foot",
            mount,
        );
    let outcome = run(&text, "fired");
    let weight = (45.0 + 12.0 + 8.0 + 3.0 * (0.33 + 0.45)) * 9.81;
    let mean = |path: &str| column(&outcome.results, path)[..360].iter().sum::<f64>() / 360.0;
    let sags = [1, 2].map(|k| mean(&format!("mount[{k}].deflection.x")));
    println!("{sags:?}");
    close("both", (sags[0] + sags[1]) * 300e3, -weight, 1e-2);
    assert_ne!(sags[0], sags[1], "the feet are apart");
}

/// A brake between flywheel and ground, whose torque keeps its direction while the engine leans on its mount, leaves the balance.
#[test]
fn a_braked_carried_engine_begins_in_balance() {
    let three_throws = "inline(throws: [0, 240, 120] deg), order: [1, 3, 2]";
    let one_throw = "inline(throws: [0 deg]), order: [1]";
    for (axis, layout, stiffness) in [
        ("b.z", three_throws, "[30, 30, 30]"),
        ("a.z", three_throws, "[30, 30, 30]"),
        ("b.z", one_throw, "[30, 30, 30]"),
        ("b.z", one_throw, "[3, 3, 3]"),
    ] {
        let law = format!(
            "force Drag(a: Marker, b: Marker) {{
                apply torque -(0.1 N*m*s/rad)*dot(a.angular_velocity - b.angular_velocity, {axis})*{axis} on a against b
            }}
            model Three {{
            marker shaft = [0, 0, 300] mm
            force brake = Drag(engine.flywheel.hub, shaft)"
        );
        let text = three(3000.0, FILMS, "drive_line: open")
            .replace(three_throws, layout)
            .replace(
                "torsional_stiffness: [30, 30, 30]",
                &format!("torsional_stiffness: {stiffness}"),
            )
            .replace("model Three {", &law);
        let outcome = run(&text, "begin");
        let found = begun(&outcome);
        let effort = held(found);
        println!(
            "{axis} {layout} {stiffness}: {effort} N m, {} iterations",
            found.iterations
        );
        // 0.1 N m s at 3000 rpm are 31.4 N m, and films brake a little
        assert!(
            (31.0..32.0).contains(&effort),
            "{axis} {layout} {stiffness}: {effort}"
        );
        assert!(
            found.iterations < 100,
            "{axis} {layout} {stiffness}: {found:?}"
        );
    }
}

/// A carried engine is assembled at its place, whatever drives its flywheel: a drive between flywheel and ground states an angle alone.
#[test]
fn a_carried_engine_is_assembled_at_its_place() {
    for drive_line in [
        "drive_line: constant_speed",
        "drive_line: dynamometer, coupling_stiffness: 500 N*m/rad, coupling_damping: 2 N*m*s/rad",
        "drive_line: open",
    ] {
        let text = three(3000.0, FILMS, drive_line);
        let positions = crate::support::program(&text)
            .analysis("begin")
            .expect("an analysis")
            .positions()
            .expect("positions");
        let at = |path: &str| {
            let found = positions.iter().find(|(_, name, _)| name == path);
            found.unwrap_or_else(|| panic!("{path}")).2
        };
        let support = at("engine.block.support");
        println!("{drive_line}: {support:?}");
        assert!(
            support.iter().all(|x| x.abs() < 1e-6),
            "{drive_line}: {support:?}"
        );
    }
}
