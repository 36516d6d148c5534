//! Counterweights, balance shafts and the thrust bearing of `std.engine`: forces against closed forms and against the same masses as
//! bodies of their own.

use crate::library_run::{close, column, integral, largest, run};
use eng::Sources;
use eng::results::Results;
use std::f64::consts::TAU;

/// An engine at 3000 rpm without gas. Narrow films of cold oil hold the crank near its axis. `more` are arguments, `parts` are items.
fn engine(layout: &str, order: &str, more: &str, parts: &str) -> String {
    format!(
        "use std.cylinder.{{WeighedRod, radial}}
        use std.engine.*
        use std.forces.GasPressure
        use std.joints.Fixed
        use std.journals.Impedance
        use std.layouts.*
        use std.oils.SAE_10W40
        table flat(theta: CrankAngle) -> AbsolutePressure = points([0, 180, 360, 720] deg, [9, 1, 1, 9] bar, periodic: 720 deg)
        const rod = WeighedRod(big_end: 0.42 kg, small_end: 0.18 kg, big_radius: 28 mm, small_radius: 14 mm)
        model Machine {{
            part engine = Engine(
                layout: {layout}, order: {order}, bore: 86 mm, stroke: 86 mm, rod_length: 143 mm, spacing: 92 mm,
                main_diameter: 54 mm, main_width: 20 mm, main_clearance: radial(9 um), big_ends: hinge, pin_diameter: 48 mm,
                law: Impedance, oil: SAE_10W40, oil_temperature: 40 degC, rod: rod, piston_mass: 0.45 kg, rod_stagger: 24 mm,
                crankshaft: Crank(mass: 20 kg, inertia: [250, 260, 42] g*m^2), gas: GasPressure(pressure: flat, scale: 0),
                flywheel_mass: 11 kg, flywheel_inertia: 112 g*m^2, block_mass: 70 kg, block_inertia: [2, 2, 1] kg*m^2,
                speed: 3000 rpm, drive_line: constant_speed,
                {more}
            )
            {parts}
            gravity = engine.up*(-9.81 m/s^2)
            output upward = -dot(engine.mounts.force, engine.up) as N
            output along_y = -dot(engine.mounts.force, ground.y) as N
        }}
        analysis run = periodic(Machine(), sample: 2 deg)"
    )
}

const SPEED: f64 = 3000.0 * TAU / 60.0;
const SIDE: &str = "numbered_from: timing_end, seen_from: timing_end, sense: clockwise,";
/// Oscillating mass of a cylinder times half of the stroke, and the rotating one.
const OSCILLATING: f64 = (0.45 + 0.18) * 0.043;
const ROTATING: f64 = 0.42 * 0.043;

/// The parts of an order of the force on the frame that turn about z, and against z.
fn turning(results: &Results, order: f64) -> [nalgebra::Complex<f64>; 2] {
    let angle = column(results, "cycle.angle");
    let (x, y) = (column(results, "upward"), column(results, "along_y"));
    // turn of the crank about z
    let about = column(results, "engine.turn.angle");
    let sense = (about[1] - about[0]).signum();
    [1.0, -1.0].map(|way| {
        let part = |f: &dyn Fn(f64, f64, f64) -> f64| {
            let values: Vec<f64> = (0..angle.len())
                .map(|k| f(x[k], y[k], way * sense * order * angle[k]))
                .collect();
            integral(angle, &values) / (angle[angle.len() - 1] - angle[0])
        };
        nalgebra::Complex::new(
            part(&|x, y, turn| x * turn.cos() + y * turn.sin()),
            part(&|x, y, turn| y * turn.cos() - x * turn.sin()),
        )
    })
}

/// Half of the oscillating mass on the crank leaves half of the first order, which turns backwards. A shaft takes the rest away.
#[test]
fn a_single_is_balanced_by_a_counterweight_and_a_shaft() {
    let weight = "counterweights: [balancing_weight(throw: 1, share: 50 %, radius: 60 mm, rod: rod, rod_length: 143 mm,
        piston_mass: 0.45 kg, stroke: 86 mm)],";
    let shaft = "balance_shafts: [BalanceShaft(ratio: -1, moment: 0.315 kg*43 mm, angle: 180 deg, across: 80 mm, mass: 0.8 kg,
        inertia: 0.3 g*m^2)],";
    let full = OSCILLATING * SPEED * SPEED;
    // without a weight the rotating mass adds to the part that turns with the crank
    let due = [
        (
            String::new(),
            full / 2.0 + ROTATING * SPEED * SPEED,
            full / 2.0,
        ),
        (weight.to_owned(), 0.0, full / 2.0),
        (format!("{weight} {shaft}"), 0.0, 0.0),
    ];
    for (more, forward, backward) in due {
        let results = run(
            &engine("single()", "[1]", &format!("{SIDE} {more}"), ""),
            "run",
        );
        // seen from the timing end, so z leads away from the eye, and clockwise is about z
        let parts = turning(&results, 1.0);
        println!("{parts:?} for {forward} and {backward}");
        assert!(
            (parts[0] - forward).norm() < 4e-3 * full,
            "{parts:?} for {forward}"
        );
        assert!(
            (parts[1] - backward).norm() < 4e-3 * full,
            "{parts:?} for {backward}"
        );
    }
}

/// A V-twin of 60 degrees, with each word of its sides: a shaft with the moment and the angle that the lint states balances the part of the first
/// order that turns as it does. With the crank this part has the rotating masses, too.
#[test]
fn the_lint_of_a_shaft_says_what_balances() {
    for (numbered, seen, sense, ratio) in [
        ("timing_end", "timing_end", "clockwise", -1),
        ("timing_end", "driving_end", "counterclockwise", -1),
        ("driving_end", "timing_end", "clockwise", 1),
        ("driving_end", "driving_end", "counterclockwise", 1),
    ] {
        let side = format!("numbered_from: {numbered}, seen_from: {seen}, sense: {sense},");
        let twin = |moment: &str, angle: &str| {
            let shaft = format!(
                "balance_shafts: [BalanceShaft(ratio: {ratio}, moment: {moment}, angle: {angle}, mass: 0.8 kg, inertia: 0.3 g*m^2)],"
            );
            let layout = "vee(angle: 60 deg, throws: [0 deg], numbers: bank_by_bank)";
            engine(
                layout,
                "[1, 2]",
                &format!("{side} {shaft} idle_turn_after: 1,"),
                "",
            )
        };
        let wrong = twin("5 kg*mm", "10 deg");
        let sources = Sources::from_text("m.eng", &wrong);
        let program = eng::check(&sources, "m.eng").into_program();
        let program = program.unwrap_or_else(|report| panic!("{report}"));
        let assembled = program.assemble().unwrap_or_else(|error| panic!("{error}"));
        let said: Vec<&str> = assembled
            .diagnostics
            .iter()
            .map(|d| d.title.as_str())
            .collect();
        let rest = said
            .iter()
            .find_map(|title| title.split_once("balance the order by "));
        let (_, rest) = rest.unwrap_or_else(|| panic!("{said:?}"));
        let (moment, rest) = rest.split_once(" at ").expect("an angle");
        let angle = rest.trim_end_matches(" deg");
        let right = run(&twin(moment, &format!("({angle} deg)")), "run");
        let parts = turning(&right, 1.0);
        println!("{numbered}, {seen}, {sense}, {ratio}: {moment} at {angle} deg leaves {parts:?}");
        let full = OSCILLATING * SPEED * SPEED;
        let part = parts[usize::from(ratio < 0)];
        assert!(part.norm() < 6e-3 * full, "{parts:?} of {full}");
    }
}

/// Counterweights of a V6 with split pins and the same masses as bodies on its pins: forces and moments on the frame.
#[test]
fn counterweights_are_masses_on_the_crank() {
    let layout =
        "vee(angle: 60 deg, throws: [0, 240, 120] deg, numbers: bank_by_bank, split: -60 deg)";
    let order = "[1, 4, 2, 5, 3, 6]";
    let with = |more: &str, parts: &str| {
        let side = "numbered_from: driving_end, seen_from: driving_end, sense: counterclockwise,";
        run(
            &engine(layout, order, &format!("{side} {more}"), parts),
            "run",
        )
    };
    let weights = with(
        "counterweights: [Counterweight(throw: 1, mass: 0.9 kg, radius: 60 mm), Counterweight(throw: 3, mass: 0.7 kg, radius: 50 mm,
            angle: 150 deg, offset: 12 mm)],",
        "",
    );
    // pin 1 points along bank 1, 30 deg clockwise for an eye at the driving end, which is about -z; the throw is 30 deg
    // clockwise of pin 1, that of cylinder 3 is 120 deg clockwise of it
    let bodies = with(
        "",
        "body first { mass = 0.9 kg; inertia = [1, 1, 1] mg*m^2
            marker seat = [43*cos(-30 deg) - 60*cos(120 deg), 43*sin(-30 deg) - 60*sin(120 deg), 12] mm }
        joint first_bolts = Fixed(first.seat, engine.crank.pin[1])
        body third { mass = 0.7 kg; inertia = [1, 1, 1] mg*m^2
            marker seat = [43*cos(-150 deg) - 50*cos(30 deg), 43*sin(-150 deg) - 50*sin(30 deg), 0] mm }
        joint third_bolts = Fixed(third.seat, engine.crank.pin[3])",
    );
    for part in ["force.x", "force.y", "torque.x", "torque.y", "torque.z"] {
        let path = format!("engine.mounts.{part}");
        let (found, due) = (column(&weights, &path), column(&bodies, &path));
        let miss: Vec<f64> = found.iter().zip(due).map(|(a, b)| (a - b).abs()).collect();
        let (miss, size) = (largest(&miss), largest(due));
        println!("{path}: {miss:.1e} of {size:.0}");
        assert!(miss < 1e-4 * size, "{path}: {miss} of {size}");
    }
}

/// A shaft under a slope: the crank slides onto its thrust bearing, whose pads carry the weight of crank and flywheel along the axis.
#[test]
fn a_floating_crank_comes_to_rest_on_its_thrust_bearing() {
    let more = "axial: floating, thrust_law: TaperLandThrust(pads: 4, pad_angle: 80 deg, depth: 25 um), thrust_inner: 60 mm, thrust_outer: 80 mm,
        end_float: 200 um,";
    let text = engine("single()", "[1]", &format!("{SIDE} {more}"), "")
        .replace("use std.joints.Fixed", "use std.thrust.TaperLandThrust")
        .replace("engine.up*(-9.81 m/s^2)", "[-9, 0, 4] m/s^2");
    let results = run(&text, "run");
    let force = column(&results, "engine.thrust_bearing.force");
    let angle = column(&results, "cycle.angle");
    let mean = integral(angle, force) / (angle[angle.len() - 1] - angle[0]);
    // crank, flywheel and rod move along the axis
    close("thrust", mean, -4.0 * (20.0 + 11.0 + 0.6), 1e-3);
}
