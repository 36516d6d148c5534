//! Engines of `std.engine`: firing angles of known engines, forces of slider-cranks by Newton's and Euler's
//! equations, residual forces of a row of four, and the hand-written engine of the examples.

use crate::library_run::{close, column, largest, refusal, run};
use eng::Sources;
use eng::post::{Run, evaluate};
use eng::results::Results;
use std::f64::consts::TAU;
use std::path::Path;

const HEAD: &str = "use std.cylinder.{Rod, WeighedRod, diametral, radial}
use std.cranks.Web
use std.engine.{Crank, Engine, PlainCrank}
use std.forces.GasPressure
use std.gas.{ClosedCycle, wiebe}
use std.journals.Impedance
use std.layouts.{Layout, boxer, inline, single, vee}
use std.materials.Steel
use std.oils.SAE_10W40
/// A peak at the firing dead centre.
table peaked(theta: CrankAngle) -> AbsolutePressure =
    points([-360, -180, -120, -60, -30, 0, 30, 60, 120, 180, 360] deg, [1, 1, 1.5, 4, 10, 50, 30, 12, 4, 1.2, 1] bar,
           interpolation: monotone, periodic: 720 deg)
";

/// An engine with hinges in its big ends at 3000 rpm. `arguments` replace or add arguments.
fn engine(layout: &str, order: &str, arguments: &str) -> String {
    // names within parentheses are arguments of something else
    let mut depth = 0;
    let outer: String = arguments
        .chars()
        .filter(|letter| {
            depth += i32::from(*letter == '(') - i32::from(*letter == ')');
            depth == 0
        })
        .collect();
    let stated = |name: &str| outer.contains(&format!("{name}:"));
    let usual = [
        ("numbered_from", "timing_end"),
        ("seen_from", "timing_end"),
        ("sense", "clockwise"),
        ("bore", "86 mm"),
        ("stroke", "86 mm"),
        ("rod_length", "143 mm"),
        ("spacing", "92 mm"),
        ("main_diameter", "54 mm"),
        ("main_width", "20 mm"),
        ("main_clearance", "diametral(54 um)"),
        ("big_ends", "hinge"),
        ("pin_diameter", "48 mm"),
        ("law", "Impedance"),
        ("oil", "SAE_10W40"),
        ("oil_temperature", "105 degC"),
        (
            "rod",
            "Rod(mass: 0.62 kg, center: 41 mm, inertia: [0.12, 3.0, 3.1] g*m^2)",
        ),
        ("piston_mass", "0.45 kg"),
        (
            "crankshaft",
            "Crank(mass: 20 kg, inertia: [250, 260, 42] g*m^2)",
        ),
        ("gas", "GasPressure(pressure: peaked)"),
        ("flywheel_mass", "11 kg"),
        ("flywheel_inertia", "0.112 kg*m^2"),
        ("block_mass", "60 kg"),
        ("block_inertia", "[2.2, 2.4, 1.1] kg*m^2"),
        ("speed", "3000 rpm"),
        ("drive_line", "constant_speed"),
    ];
    let usual = usual.iter().filter(|(name, _)| !stated(name));
    let usual: Vec<String> = usual
        .map(|(name, value)| format!("{name}: {value}"))
        .collect();
    format!(
        "{HEAD}
model Test {{
    part engine = Engine(layout: {layout}, order: {order}, {arguments} {})
    gravity = engine.up*(-9.81 m/s^2)
}}
analysis run = transient(Test(), duration: 2 rev, sample: 5 deg)
",
        usual.join(", ")
    )
}

/// The warnings and errors of `eng check`.
fn told(text: &str) -> String {
    let checked = eng::check(&Sources::from_text("m.eng", text), "m.eng");
    let mut all = checked.report().to_string();
    if let Some(program) = checked.program() {
        match program.assemble() {
            Ok(assembled) => {
                all.extend(assembled.diagnostics.iter().map(|d| d.title.clone() + "\n"))
            }
            Err(error) => all += &error.to_string(),
        }
    }
    all
}

/// Refuses all errors and warnings but those of unused names.
fn quiet(text: &str) {
    let said = told(text);
    let unused = said.matches("warning[W0201]").count();
    assert_eq!(said.matches("warning[").count(), unused, "{said}");
    assert!(!said.contains("error["), "{said}");
}

/// The angle (deg) at which each cylinder's pressure has its peak. There the piston must be at its dead centre.
fn firing_angles(results: &Results, cylinders: usize) -> Vec<f64> {
    let angle = column(results, "cycle.angle");
    let at = |k: usize| {
        let pressure = column(results, &format!("engine.cylinder[{k}].gas.gauge_pressure"));
        // the last sample repeats the first
        let last = pressure.len() - 1;
        let peak = (0..last)
            .max_by(|a, b| pressure[*a].total_cmp(&pressure[*b]))
            .unwrap();
        let travel = column(results, &format!("engine.cylinder[{k}].liner.travel"));
        let top = travel[peak];
        assert!(
            (top - 0.186).abs() < 5e-5,
            "cylinder {k}: {top} at its firing"
        );
        angle[peak].to_degrees().round().rem_euclid(720.0)
    };
    (1..=cylinders).map(at).collect()
}

#[test]
fn known_engines_fire_at_their_angles() {
    let even = "rod_stagger: 22 mm,";
    let cases: [(&str, &str, &str, &[f64]); 9] = [
        (
            "inline(throws: [0, 180, 180, 0] deg)",
            "[1, 3, 4, 2]",
            "",
            &[0.0, 540.0, 180.0, 360.0],
        ),
        // seen from the other end the same crank turns the other way
        (
            "inline(throws: [0, 180, 180, 0] deg)",
            "[1, 2, 4, 3]",
            "numbered_from: driving_end, seen_from: driving_end, sense: counterclockwise,",
            &[0.0, 180.0, 540.0, 360.0],
        ),
        (
            "inline(throws: [0, 240, 120, 120, 240, 0] deg)",
            "[1, 5, 3, 6, 2, 4]",
            "",
            &[0.0, 480.0, 240.0, 600.0, 120.0, 360.0],
        ),
        (
            "vee(angle: 60 deg, throws: [0, 120, 240] deg, numbers: bank_by_bank)",
            "[1, 5, 2, 6, 3, 4]",
            even,
            &[0.0, 240.0, 480.0, 660.0, 180.0, 420.0],
        ),
        // split pins make the intervals even
        (
            "vee(angle: 60 deg, throws: [0, 120, 240] deg, numbers: in_turn, split: -60 deg)",
            "[1, 4, 3, 6, 5, 2]",
            even,
            &[0.0, 600.0, 240.0, 120.0, 480.0, 360.0],
        ),
        ("boxer(throws: [0, 180] deg)", "[1, 2]", "", &[0.0, 360.0]),
        (
            "vee(angle: 45 deg, throws: [0] deg, numbers: in_turn)",
            "[1, 2]",
            "rod_stagger: 22 mm, idle_turn_after: 2,",
            &[0.0, 315.0],
        ),
        // a crossed crank: one bank fires at 0, 180, 450 and 630, the other at 90, 270, 360 and 540
        (
            "vee(angle: 90 deg, throws: [0, 90, 270, 180] deg, numbers: bank_by_bank)",
            "[1, 8, 4, 5, 7, 3, 6, 2]",
            even,
            &[0.0, 630.0, 450.0, 180.0, 270.0, 540.0, 360.0, 90.0],
        ),
        (
            "vee(angle: 90 deg, throws: [0, 180, 180, 0] deg, numbers: bank_by_bank)",
            "[1, 7, 3, 8, 4, 6, 2, 5]",
            even,
            &[0.0, 540.0, 180.0, 360.0, 630.0, 450.0, 90.0, 270.0],
        ),
    ];
    for (layout, order, arguments, due) in cases {
        let text = engine(layout, order, arguments);
        let warnings = told(&text);
        assert!(!warnings.contains("W0759"), "{layout}: {warnings}");
        let found = firing_angles(&run(&text, "run"), due.len());
        assert_eq!(found, due, "{layout}");
    }
}

#[test]
fn a_single_idles_one_turn_and_no_order_that_does_not_fit_passes() {
    assert_eq!(
        firing_angles(&run(&engine("single()", "[1]", ""), "run"), 1),
        [0.0]
    );
    let four = "inline(throws: [0, 180, 180, 0] deg)";
    let twin = "vee(angle: 45 deg, throws: [0] deg, numbers: in_turn)";
    for (layout, order, arguments, message) in [
        (
            four,
            "[1, 2, 3, 4]",
            "",
            "cylinder 4, number 4 of it, would fire 720 deg after the first",
        ),
        (
            four,
            "[1, 2, 3, 4]",
            "",
            "These orders fit: [[1, 2, 4, 3], [1, 3, 4, 2]]; the longest interval of the first one is 180 deg",
        ),
        (
            "inline(throws: [0, 240, 120] deg)",
            "[1, 2, 3]",
            "",
            "These orders need no such turn: [[1, 3, 2]]; the longest interval of the first one is 240 deg",
        ),
        (
            "inline(throws: [0, 120, 240, 240, 120, 0] deg)",
            "[1, 2, 3, 4, 5, 6]",
            "",
            "[[1, 3, 2, 6, 4, 5], [1, 4, 2, 6, 3, 5], [1, 3, 5, 6, 4, 2], [1, 4, 5, 6, 3, 2]]; the longest interval of the first one is 120 deg",
        ),
        (
            "inline(throws: [0, 0, 0] deg)",
            "[1, 3, 2]",
            "",
            "three cylinders reach their dead centres together",
        ),
        (
            four,
            "[1, 3, 4, 4]",
            "",
            "the firing order names each of the 4 cylinders once",
        ),
        (
            four,
            "[1, 3, 2]",
            "",
            "the firing order names 3 cylinders, the layout has 4",
        ),
        (
            twin,
            "[1, 2]",
            "rod_stagger: 22 mm,",
            "`idle_turn_after:` names the cylinder",
        ),
        (
            four,
            "[1, 3, 4, 2]",
            "idle_turn_after: 2,",
            "without an idle turn this order takes 720 deg, and the cycle has 720 deg: leave `idle_turn_after` out",
        ),
        (
            twin,
            "[1, 2]",
            "idle_turn_after: 2,",
            "cylinder 1 shares throw 1",
        ),
        (
            four,
            "[1, 3, 4, 2]",
            "rod_length: 42 mm,",
            "is shorter than the throw",
        ),
        (
            four,
            "[1, 3, 4, 2]",
            "main_clearance: 54 um,",
            "`main_clearance`",
        ),
        (
            four,
            "[1, 3, 4, 2]",
            "drive_line: dynamometer,",
            "a dynamometer has a coupling",
        ),
        (
            four,
            "[1, 3, 4, 2]",
            "big_ends: film,",
            "engine: films in the big ends need `pin_width` and `pin_clearance`, here 0 mm and 0 um",
        ),
        (
            four,
            "[1, 3, 4, 2]",
            "speed: -3000 rpm,",
            "`sense` gives the direction",
        ),
    ] {
        let said = refusal(&engine(layout, order, arguments), "run");
        assert!(said.contains(message), "{arguments} {said}");
    }
    let split = "vee(angle: 60 deg, throws: [0, 120, 240] deg, numbers: in_turn, split: -60 deg)";
    let plain = format!("rod_stagger: 22 mm, crankshaft: {PLAIN},");
    let said = refusal(&engine(split, "[1, 4, 3, 6, 5, 2]", &plain), "run");
    assert!(
        said.contains("two pins on one throw are 60 deg apart"),
        "{said}"
    );
}

/// Layouts whose banks stand upright, lean and lie, with films in all bearings: the assembly finds each
/// without a guess, and the engine stands where its text says.
#[test]
fn engines_with_films_in_the_big_ends_assemble_by_themselves() {
    let films = "big_ends: film, pin_width: 20 mm, pin_clearance: diametral(50 um),";
    let pair = "rod_stagger: 22 mm,";
    let flat = "vee(angle: 180 deg, throws: [0, 120, 240] deg, numbers: in_turn, split: 60 deg)";
    let wide = "vee(angle: 120 deg, throws: [0, 120, 240] deg, numbers: in_turn)";
    let turned = "numbered_from: driving_end, seen_from: driving_end, sense: counterclockwise,";
    let flipped = format!("{pair} {turned}");
    for (layout, order, arguments) in [
        ("single()", "[1]", ""),
        ("inline(throws: [0, 240, 120] deg)", "[1, 3, 2]", ""),
        (
            "inline(throws: [0, 180, 180, 0] deg)",
            "[1, 2, 4, 3]",
            turned,
        ),
        ("boxer(throws: [0, 180] deg)", "[1, 2]", ""),
        ("boxer(throws: [0, 180, 180, 0] deg)", "[1, 3, 2, 4]", ""),
        (
            "boxer(throws: [0, 180, 120, 300, 240, 60] deg)",
            "[1, 6, 3, 2, 5, 4]",
            "",
        ),
        (flat, "[1, 4, 3, 6, 5, 2]", pair),
        (wide, "[1, 4, 3, 6, 5, 2]", pair),
        (
            "vee(angle: 60 deg, throws: [0, 120, 240] deg, numbers: bank_by_bank)",
            "[1, 5, 2, 6, 3, 4]",
            pair,
        ),
        (
            "vee(angle: 60 deg, throws: [0, 120, 240] deg, numbers: in_turn, split: -60 deg)",
            "[1, 4, 3, 6, 5, 2]",
            pair,
        ),
        (
            "vee(angle: 45 deg, throws: [0] deg, numbers: in_turn)",
            "[1, 2]",
            "rod_stagger: 22 mm, idle_turn_after: 2,",
        ),
        (
            "vee(angle: 90 deg, throws: [0, 90, 270, 180] deg, numbers: bank_by_bank)",
            "[1, 8, 4, 5, 7, 3, 6, 2]",
            pair,
        ),
        (
            "vee(angle: 90 deg, throws: [0, 180, 180, 0] deg, numbers: bank_by_bank)",
            "[1, 7, 3, 8, 4, 6, 2, 5]",
            pair,
        ),
        (
            "vee(angle: 90 deg, throws: [0, 180, 180, 0] deg, numbers: bank_by_bank)",
            "[1, 5, 2, 6, 4, 8, 3, 7]",
            flipped.as_str(),
        ),
    ] {
        let text = engine(layout, order, &format!("{films} {arguments}"));
        quiet(&text);
        let placed = text.replace("analysis run = transient(Test(), duration: 2 rev, sample: 5 deg)", "analysis run = assemble(Test())").replace(
            "    gravity =",
            "    output middle[i in 1..3] = dot(engine.block.support.origin, [ground.x, ground.y, ground.z][i]) as mm
    output level = dot(engine.crank.main[1].z, ground.z)
    gravity =",
        );
        let results = run(&placed, "run");
        for axis in 1..=3 {
            let away = column(&results, &format!("middle[{axis}]"))[0];
            assert!(away.abs() < 1e-9, "{layout}: {away} m along axis {axis}");
        }
        let level = column(&results, "level")[0];
        assert!((level - 1.0).abs() < 1e-12, "{layout}: {level}");
    }
}

/// An engine on a body at another place, whose axes are turned by right angles: its films are those of the engine at the origin, and
/// the text has no guess.
#[test]
fn an_engine_stands_in_the_frame_of_a_body() {
    let films = "big_ends: film, pin_width: 20 mm, pin_clearance: diametral(50 um),";
    let coupled =
        "drive_line: dynamometer, coupling_stiffness: 20 kN*m/rad, coupling_damping: 10 N*m*s/rad,";
    let layout = "inline(throws: [0, 240, 120] deg)";
    for drive_line in ["", coupled] {
        let arguments = format!("{films} {drive_line}");
        let upright = engine(layout, "[1, 3, 2]", &arguments);
        let carried = engine(
            layout,
            "[1, 3, 2]",
            &format!("{arguments} engine_frame: [car.bed],"),
        )
        .replace(
            "    part engine",
            "    marker post = at([1, 2, 3] m, x: [0, 0, 1], z: [1, 0, 0])
    body car {
        mass = 900 kg
        inertia = [100, 100, 100] kg*m^2
        marker bed = [0, 0, 0] mm
        marker floor = [0, 0, 0] mm
    }
    joint hold = Fixed(car.floor, post)
    part engine",
        )
        .replace("engine.up*(-9.81 m/s^2)", "[0, 0, -9.81] m/s^2")
        .replace("use std.journals", "use std.joints.Fixed\nuse std.journals");
        quiet(&carried);
        let [upright, carried] = [upright, carried].map(|text| run(&text, "run"));
        let paths = (1..=4).flat_map(|j| {
            ["x", "y"].map(|axis| format!("engine.main[{j}].eccentricity_ratio.{axis}"))
        });
        for path in paths.chain(["engine.brake_torque".to_owned()]) {
            let (due, found) = (column(&upright, &path), column(&carried, &path));
            let swing = due.iter().fold(f64::MIN, |most, x| most.max(*x))
                - due.iter().fold(f64::MAX, |least, x| least.min(*x));
            let off = due.iter().zip(found);
            let off = off.fold(0.0_f64, |worst, (x, y)| worst.max((x - y).abs()));
            println!("{path}: {off:.1e} of {swing:.3}");
            assert!(off < 1e-4 * swing, "{path}: {off} of {swing}");
        }
    }
}

/// Mistakes in the structure of an engine: one error, which names the arguments, and none from inside of the library.
#[test]
fn a_wrong_structure_is_told_once() {
    let three = "inline(throws: [0, 240, 120] deg)";
    let elastic = "crank_main: rail[1..3], crank_pin: rail[1..3], crank_flange: [rail[4]],";
    for (layout, order, arguments, message) in [
        (
            three,
            "[1, 3]",
            "",
            "the firing order names 2 cylinders, the layout has 3",
        ),
        (
            "inline(throws: [0, 240] deg)",
            "[1, 3, 2]",
            "",
            "the firing order names 3 cylinders, the layout has 2",
        ),
        (
            three,
            "[1, 3, 2]",
            elastic,
            "4 markers in `crank_main`, 3 in `crank_pin` and 1 in `crank_flange`, here 3, 3 and 1",
        ),
        (
            three,
            "[1, 3, 2]",
            "crank_main: rail[1..4],",
            "here 4, 0 and 0",
        ),
        (
            three,
            "[1, 3, 2]",
            "block_main: rail[1..4],",
            "here 4, 0 and 0",
        ),
        (
            three,
            "[1, 3, 2]",
            "idle_turn_after: 9,",
            "names no cylinder: they have the numbers 1 to 3",
        ),
        (
            three,
            "[1, 3, 2]",
            "idle_turn_after: 2,",
            "without an idle turn this order takes 720 deg",
        ),
        (
            three,
            "[1, 3, 2]",
            "crankshaft: Crank(mass: 0 kg, inertia: [1, 1, 1] g*m^2),",
            "a rigid crank has a mass",
        ),
        (
            three,
            "[1, 3, 2]",
            "block_mass: 0 kg,",
            "a rigid block has a mass",
        ),
        (
            three,
            "[1, 3, 2]",
            "big_ends: film, pin_width: 20 mm,",
            "films in the big ends need `pin_width` and `pin_clearance`",
        ),
        (
            three,
            "[1, 3, 2]",
            "oil_temperature: 105 K,",
            "engine: Vogel's equation",
        ),
    ] {
        let text = engine(layout, order, arguments).replace(
            "    gravity =",
            "    marker rail[i in 1..4] = [0, 0, 92*(i - 2.5)] mm\n    gravity =",
        );
        let said = told(&text);
        assert!(said.contains(message), "{arguments}: {said}");
        assert!(said.matches("error").count() <= 2, "{arguments}: {said}");
        assert!(
            !said.contains("E0501") && !said.contains("E0510"),
            "{arguments}: {said}"
        );
    }
}

/// Numbers that are possible and strange, and arguments without effect.
#[test]
fn strange_numbers_of_an_engine_are_told() {
    let gas = |heat: &str, begin: &str| {
        format!(
            "gas: ClosedCycle(stroke: 86 mm, compression_ratio: 10, heat: {heat}, burnt: wiebe(begin: {begin}, duration: 50 deg)),"
        )
    };
    let films = "big_ends: film, pin_clearance: diametral(50 um), pin_width:";
    for (arguments, message) in [
        (
            "bore: 95 mm,".to_owned(),
            "bores of 95 mm overlap: cylinders of one bank are 92 mm apart",
        ),
        (
            format!("{films} 75 mm,"),
            "mains of 20 mm and big ends of 75 mm on a throw do not fit",
        ),
        (
            "piston_mass: 450 kg,".to_owned(),
            "in a bore of 86 mm: 89.05 g to 2226 g are usual",
        ),
        (
            "coupling_stiffness: 2e4 N*m/rad,".to_owned(),
            "only a `dynamometer` has a coupling",
        ),
        (
            "pin_clearance: diametral(50 um),".to_owned(),
            "hinges in the big ends have no film",
        ),
        (
            format!("{films} 30 mm, crankshaft: {PLAIN},"),
            "pins of 28 mm are too short for big ends of 30 mm",
        ),
        (
            gas("-1 kJ", "-18 deg"),
            "a heat of -1 kJ: heat into the gas is positive",
        ),
        (gas("1 kJ", "160 deg"), "0 % 90 deg after it"),
    ] {
        let text = engine(
            "inline(throws: [0, 180, 180, 0] deg)",
            "[1, 3, 4, 2]",
            &arguments,
        );
        let said = told(&text);
        assert!(said.contains(message), "{arguments}: {said}");
    }
    let single = told(&engine("single()", "[1]", "idle_turn_after: 1,"));
    assert!(single.contains("a single idles one turn"), "{single}");
}

const FIRED: &str = "big_ends: film, pin_width: 20 mm, pin_clearance: diametral(50 um),
    gas: ClosedCycle(stroke: 86 mm, compression_ratio: 10, heat: 1.2 kJ, burnt: wiebe(begin: -18 deg, duration: 50 deg)),";

/// The nominal end of the burning is a sample. The rate there is Wiebe's in each cylinder, on whichever side
/// rounding puts it, so that the motion repeats.
#[test]
fn a_burning_that_ends_on_a_sample_repeats() {
    let text = engine("inline(throws: [0, 240, 120] deg)", "[1, 3, 2]", FIRED).replace(
        "transient(Test(), duration: 2 rev, sample: 5 deg)",
        "periodic(Test(), sample: 1 deg)",
    );
    let results = run(&text, "run");
    let angle = column(&results, "cycle.angle");
    let rate = 1200.0 * 3.0 * 6.908 * (-6.908_f64).exp() / 50.0 * 18000.0;
    for (cylinder, end) in [(1, 32.0), (3, 272.0), (2, 512.0)] {
        let heat = column(
            &results,
            &format!("engine.cylinder[{cylinder}].gas.heat_release"),
        );
        let off = |k: usize| (angle[k].to_degrees().rem_euclid(720.0) - end).abs();
        let at = (0..angle.len())
            .min_by(|a, b| off(*a).total_cmp(&off(*b)))
            .unwrap();
        assert!(off(at) < 1e-3, "{}", off(at));
        close("rate", heat[at], rate, 1e-9);
    }
}

/// A use changes a number that the class of a cylinder's gas brings along.
#[test]
fn a_use_changes_the_heat_of_one_cylinder() {
    let text = engine("inline(throws: [0, 240, 120] deg)", "[1, 3, 2]", FIRED);
    let text = text.replace(
        ")\n    gravity",
        ") with { cylinder[2].gas.heat = 0.6 kJ; cylinder[3].gas.burnt.begin = -12 deg }\n    gravity",
    );
    quiet(&text);
    let results = run(&text, "run");
    let time = column(&results, "time");
    let burnt = |k: usize| {
        let heat = column(&results, &format!("engine.cylinder[{k}].gas.heat_release"));
        crate::library_run::integral(time, heat)
    };
    // one firing in two turns; the samples are coarse
    for (cylinder, due) in [(2, 600.0), (3, 1200.0)] {
        close("heat", burnt(cylinder), due, 1e-2);
    }
    let wrong = told(&text.replace("gas.heat =", "gas.heet ="));
    assert!(
        wrong.contains("did you mean `engine.cylinder[2].gas.heat`?"),
        "{wrong}"
    );
    let wrong = told(&text.replace("0.6 kJ", "0.6 bar"));
    assert!(
        wrong.contains("E0434") && wrong.contains("`engine.cylinder[2].gas.heat` is in"),
        "{wrong}"
    );
}

const PLAIN: &str = "PlainCrank(material: Steel, pin_length: 28 mm, nose_radius: 23 mm, nose_length: 24 mm, flange_radius: 40 mm,
    flange_length: 10 mm,
    web: Web(thickness: 20 mm, pin_radius: 34 mm, waist: [4, 37] mm, counterweight_radius: 73 mm, counterweight_angle: 106 deg))";

/// A slider-crank of the engines above at constant speed: throw, rod, masses (SI).
struct Slider {
    throw: f64,
    rod: f64,
    rod_mass: f64,
    center: f64,
    inertia: f64,
    piston_mass: f64,
}

const SLIDER: Slider = Slider {
    throw: 0.043,
    rod: 0.143,
    rod_mass: 0.62,
    center: 0.041,
    inertia: 3.1e-3,
    piston_mass: 0.45,
};

impl Slider {
    /// Force (N) along and across the cylinder on the rod's big end, and along on all parts from outside but
    /// the gas, at a crank angle and a speed (rad, rad/s), for a gas force (N) towards the crank. Gravity
    /// acts towards the crank.
    ///
    /// Newton's and Euler's equations of rod and piston, with the wrist's side force from the moment about the big end.
    fn big_end(&self, angle: f64, speed: f64, gas: f64) -> [f64; 2] {
        let g = 9.81;
        let (r, l, w) = (self.throw, self.rod, speed);
        // sin b = -r/l sin a: the rod's angle from the cylinder
        let s = -r / l * angle.sin();
        let c = (1.0 - s * s).sqrt();
        let rate = -r / l * angle.cos() * w / c;
        let second = (r / l * angle.sin() * w * w + s * rate * rate) / c;
        let along = |d: f64| -r * angle.cos() * w * w - d * (c * rate * rate + s * second);
        let across = |d: f64| -r * angle.sin() * w * w + d * (-s * rate * rate + c * second);
        let wrist_along = -self.piston_mass * (along(l) + g) - gas;
        // moment about the big end: of the wrist's force on the rod, of gravity, of inertia
        let d = self.center;
        let inertial =
            self.inertia * second + self.rod_mass * d * (c * across(d) - s * (along(d) + g));
        let wrist_across = (inertial + l * s * wrist_along) / (l * c);
        [
            self.rod_mass * (along(d) + g) - wrist_along,
            self.rod_mass * across(d) - wrist_across,
        ]
    }
}

#[test]
fn forces_of_a_single_agree_with_newtons_and_eulers_equations() {
    // a stiff film, so that the crank stays on its axis
    let arguments = "main_clearance: radial(9 um), oil_temperature: 40 degC,";
    let results = run(&engine("single()", "[1]", arguments), "run");
    let angle = column(&results, "cycle.angle");
    let thrust = column(&results, "engine.cylinder[1].gas.thrust");
    let speed = 3000.0 * TAU / 60.0;
    let (mut miss, mut peak) = (0.0_f64, 0.0_f64);
    let mut carried = 0.0_f64;
    for (k, (&turned, &push)) in angle.iter().zip(thrust).enumerate() {
        let due = SLIDER.big_end(turned, speed, push);
        let found = ["x", "y"]
            .map(|axis| column(&results, &format!("engine.cylinder[1].hinge.force.{axis}"))[k]);
        // the hinge's force is along the axes of the pin's marker, which turn with the crank
        let (s, c) = turned.sin_cos();
        let found = [c * found[0] - s * found[1], s * found[0] + c * found[1]];
        for (found, due) in found.iter().zip(due) {
            miss = miss.max((found - due).abs());
            peak = peak.max(due.abs());
        }
        // the throw is in the middle: both mains together carry its load, and the weight of crank and flywheel
        let mains: f64 = (1..=2)
            .map(|j| column(&results, &format!("engine.main[{j}].force.x"))[k])
            .sum();
        carried = carried.max((mains - due[0] - 31.0 * 9.81).abs());
    }
    println!("big end: {miss:.2} of {peak:.0} N; mains {carried:.2} N");
    assert!(miss < 1e-3 * peak, "{miss} of {peak}");
    assert!(carried < 4e-3 * peak, "{carried} of {peak}");
}

#[test]
fn the_second_order_of_a_row_of_four_is_the_exact_series() {
    let arguments = "main_clearance: radial(9 um), oil_temperature: 40 degC, gas: GasPressure(pressure: peaked, scale: 0),";
    let text = engine(
        "inline(throws: [0, 180, 180, 0] deg)",
        "[1, 3, 4, 2]",
        arguments,
    );
    let results = run(&text, "run");
    let angle = column(&results, "cycle.angle");
    let force = column(&results, "engine.mounts.force.x");
    let half = angle.len() / 2;
    // over the second turn
    let order = |k: f64| {
        let sum = |f: fn(f64) -> f64| -> f64 {
            let part = half..angle.len() - 1;
            part.clone()
                .map(|i| force[i] * f(k * angle[i]))
                .sum::<f64>()
                * 2.0
                / part.len() as f64
        };
        [sum(f64::cos), sum(f64::sin)]
    };
    let speed = 3000.0 * TAU / 60.0;
    let ratio = SLIDER.throw / SLIDER.rod;
    let moving = SLIDER.piston_mass + SLIDER.rod_mass * SLIDER.center / SLIDER.rod;
    // A2 of the acceleration of a piston over r w^2: l + l^3/4 + 15 l^5/128 + …
    let series = ratio + ratio.powi(3) / 4.0 + 15.0 * ratio.powi(5) / 128.0;
    // the supports push the engine upwards when the pistons accelerate upwards, against cos 2a
    let due = -4.0 * moving * SLIDER.throw * speed * speed * series;
    close("second order", order(2.0)[0], due, 1e-3);
    for other in [order(1.0)[0], order(1.0)[1], order(2.0)[1], order(3.0)[0]] {
        assert!(other.abs() < 2e-3 * due.abs(), "{other} of {due}");
    }
}

/// A crank with throws that balance nothing, about its first main: mass, centre and moments of the sections
/// against those of their mesh.
#[test]
fn a_plain_crank_has_the_mass_of_its_mesh() {
    let text = format!(
        "{HEAD}
use std.cranks.crank_sections
use std.sections.disc
use std.engine.CrankPlan
model Both {{
    gravity = [0, 0, 0] m/s^2
    let plain = {PLAIN}
    let plan = CrankPlan(throws: 3, angle: [10, 190, 100] deg, split: 0 deg, throw: 43 mm, spacing: 92 mm, main_diameter: 54 mm,
        pin_diameter: 48 mm, bearing_length: 20 mm, room: 100 mm)
    let shape = plain.shape(plan)
    flexible crank {{
        mesh = stack(axis: z, size: 16 mm, begin: -174 mm, sections: crank_sections(
            angles: [10, 190, 100] deg, throw: 43 mm, main: disc(27 mm, length: 24 mm), pin: disc(24 mm, length: 28 mm),
            web: Web(thickness: 20 mm, pin_radius: 34 mm, waist: [4, 37] mm, counterweight_radius: 73 mm, counterweight_angle: 106 deg),
            front: [disc(23 mm, length: 24 mm)], back: [disc(40 mm, length: 10 mm)],
        ))
        material = Steel
        modes = normal(1)
        damping = 1 %
    }}
    output mass = shape.mass
    output center = shape.center_of_mass in ground
    output inertia = shape.inertia in ground
    output products = shape.products_of_inertia in ground
}}
analysis run = assemble(Both())
"
    );
    let sources = Sources::from_text("m.eng", &text);
    let program = eng::check(&sources, "m.eng").into_program();
    let program = program.unwrap_or_else(|report| panic!("{report}"));
    let (bodies, _) = program.reduce().unwrap_or_else(|error| panic!("{error}"));
    let line = bodies[0].text();
    let line = line
        .lines()
        .find(|line| line.contains("inertia about it"))
        .expect("the mass");
    // "mass 20.1 kg, centre (0, 0, 1) mm, inertia about it xx 1, yy 2, zz 3, xy 4, yz 5, zx 6 g m²"
    let numbers: Vec<f64> = line
        .split(|c: char| !(c.is_ascii_digit() || ".-e".contains(c)))
        .filter_map(|word| word.parse().ok())
        .collect();
    for unit in ["kg", "mm", "g m²"] {
        assert!(line.contains(unit), "{line}");
    }
    let results = run(&text, "run");
    let value = |path: &str| column(&results, path)[0];
    let paths = [
        "mass",
        "center.x",
        "center.y",
        "center.z",
        "inertia.x",
        "inertia.y",
        "inertia.z",
        "products.x",
        "products.y",
        "products.z",
    ];
    let scale = |k: usize| match k {
        4.. if line.contains("kg m²") => 1.0,
        0 => 1.0,
        _ => 1e-3,
    };
    assert_eq!(numbers.len(), paths.len(), "{line}");
    for (k, path) in paths.into_iter().enumerate() {
        let (found, due) = (value(path), numbers[k] * scale(k));
        // of the mass, of the length, of the moment across the crank
        let size = [value("mass"), 0.3, value("inertia.x")][(k > 0) as usize + (k > 3) as usize];
        println!("{path}: {found:.6e} for {due:.6e}");
        assert!((found - due).abs() < 2e-4 * size, "{path}: {found} {due}");
    }
}

/// The row of four with hinges, written by hand and as an `Engine` of the same numbers: equations, masses and
/// geometry are the same; only the pistons have other moments, and they never turn. The motion agrees to
/// rounding. Forces of films follow from velocities, and differ by the ends of the solver's iterations:
/// another inertia of the pistons changes those of the text written by hand as much (1.5e-4 of the swing).
#[test]
fn the_library_makes_the_engine_written_by_hand() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect("a file");
    let solve = |name: &str| -> Results {
        let fixed = "analysis fixed = transient(Inline4(combustion: 1), duration: 60 ms, sample: 20 us, step: 10 us, tolerance: 0.01)";
        let sources = Sources::from_texts([
            (name.to_owned(), format!("{}\n{fixed}\n", read(name))),
            ("pressure.csv".to_owned(), read("pressure.csv")),
        ]);
        let program = eng::check(&sources, name).into_program();
        let program = program.unwrap_or_else(|report| panic!("{report}"));
        let solved = program.analysis("fixed").unwrap().run(&mut |_| {});
        solved
            .unwrap_or_else(|failed| panic!("{}", failed.error))
            .results
    };
    let (hand, library) = (solve("by_hand.eng"), solve("inline4.eng"));
    let mut pairs = vec![(
        "coupling.torque".to_owned(),
        "engine.coupling.torque".to_owned(),
    )];
    for j in 1..=5 {
        for member in [
            "force.x",
            "force.y",
            "eccentricity.x",
            "eccentricity.y",
            "minimum_film",
            "power_loss",
        ] {
            pairs.push((
                format!("main[{j}].{member}"),
                format!("engine.main[{j}].{member}"),
            ));
        }
    }
    for k in 1..=4 {
        let of = |name: &str| format!("engine.cylinder[{k}].{name}");
        for (a, b) in [("big_end", "hinge"), ("liner", "liner"), ("wrist", "wrist")] {
            for axis in ["x", "y"] {
                pairs.push((
                    format!("{a}[{k}].force.{axis}"),
                    of(&format!("{b}.force.{axis}")),
                ));
            }
        }
        pairs.push((format!("gas[{k}].thrust"), of("gas.thrust")));
        pairs.push((format!("liner[{k}].travel"), of("liner.travel")));
    }
    // the motion, and the forces at the beginning and in all
    let (mut motion, mut first, mut all) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (a, b) in pairs {
        let (x, y) = (column(&hand, &a), column(&library, &b));
        assert_eq!(x.len(), y.len());
        let swing = largest(x) + largest(&x.iter().map(|v| -v).collect::<Vec<_>>());
        // liners carry nothing along y
        if swing < 1e-9 {
            continue;
        }
        let moves = ["eccentricity", "film", "travel", "thrust", "coupling"];
        let moves = moves.iter().any(|word| a.contains(word));
        for (i, (x, y)) in x.iter().zip(y).enumerate() {
            let miss = (x - y).abs() / swing;
            if moves {
                motion = motion.max(miss);
            } else {
                all = all.max(miss);
            }
            // 20 us are 0.48 degrees
            if i <= 20 {
                first = first.max(miss);
            }
        }
    }
    println!(
        "motion {motion:.1e}, forces in 10 degrees {first:.1e}, in two cycles {all:.1e} of the swing"
    );
    assert!(motion < 1e-6, "{motion}");
    assert!(first < 1e-6, "{first}");
    assert!(all < 1e-3, "{all}");
}

/// Two compressors of one bore and stroke, pistons in turn or opposed, as engines whose cycle is a turn and
/// which have no firing order. Each cylinder's gas belongs to its own dead centre and takes the work of the
/// ideal cycle, `κ/(κ − 1) p₁ V (1 + c − c π^(1/κ)) (π^((κ − 1)/κ) − 1)`; the drive gives it and the heat of
/// the films.
#[test]
fn a_compressor_is_an_engine_without_an_order() {
    let swept = std::f64::consts::PI / 4.0 * 0.06 * 0.06 * 0.08;
    let efficiency = 1.05 - 0.05 * 5.0_f64.powf(1.0 / 1.4);
    let work = 3.5 * 1e5 * swept * efficiency * (5.0_f64.powf(0.4 / 1.4) - 1.0);
    for (layout, firing) in [("inline", 180.0), ("boxer", 0.0)] {
        let text = format!(
            "use std.cylinder.{{Rod, diametral}}
use std.engine.{{Crank, Engine}}
use std.gas.IdealCompressor
use std.journals.Impedance
use std.layouts.{layout}
use std.oils.SAE_10W40
model Test {{
    accept firing
    part unit = Engine(
        layout: {layout}(throws: [0, 180] deg), cycle_length: 360 deg, numbered_from: timing_end, seen_from: timing_end, sense: clockwise,
        bore: 60 mm, stroke: 80 mm, rod_length: 140 mm, spacing: 92 mm,
        main_diameter: 54 mm, main_width: 20 mm, main_clearance: diametral(54 um), pin_diameter: 48 mm, big_ends: hinge,
        law: Impedance, oil: SAE_10W40, oil_temperature: 60 degC,
        rod: Rod(mass: 0.3 kg, center: 50 mm, inertia: [0.12, 1.5, 1.5] g*m^2), piston_mass: 0.35 kg,
        crankshaft: Crank(mass: 8 kg, inertia: [60, 60, 15] g*m^2),
        gas: IdealCompressor(clearance: {} cc, suction: 1 bar, delivery: 5 bar, suction_port: 20 cm^2, delivery_port: 20 cm^2),
        flywheel_mass: 11 kg, flywheel_inertia: 0.112 kg*m^2, block_mass: 60 kg, block_inertia: [2.2, 2.4, 1.1] kg*m^2,
        speed: 300 rpm, drive_line: constant_speed,
    )
    gravity = unit.up*(-9.81 m/s^2)
}}
analysis run = transient(Test(), duration: 4 rev, sample: 0.25 deg)
",
            0.05e6 * swept
        );
        let results = run(&text, "run");
        let time = column(&results, "time");
        let last = time.len() - 1 - 1440..time.len();
        let of_turn = |path: &str| {
            crate::library_run::integral(&time[last.clone()], &column(&results, path)[last.clone()])
        };
        let mut given = 0.0;
        for k in 1..=2 {
            let found = -of_turn(&format!("unit.cylinder[{k}].gas.indicated_power"));
            close(layout, found, work, 2e-3);
            given += found;
        }
        for j in 1..=3 {
            given += of_turn(&format!("unit.main[{j}].power_loss"));
        }
        let taken = -of_turn("unit.brake_torque") * 300.0 * TAU / 60.0;
        close("drive", taken, given, 2e-3);
        // the highest pressure of the second cylinder follows that of the first by the angle of their dead centres
        let angle = column(&results, "cycle.angle");
        let opened = |k: usize| {
            let pressure = column(
                &results,
                &format!("unit.cylinder[{k}].gas.cylinder_pressure"),
            );
            let at = last
                .clone()
                .take(1440)
                .find(|i| pressure[*i] < 4.9e5 && pressure[*i + 1] >= 4.9e5);
            angle[at.expect("a delivery")].to_degrees()
        };
        let behind = (opened(2) - opened(1)).rem_euclid(360.0);
        assert!(
            (behind - firing).abs().min(360.0 - (behind - firing).abs()) < 0.6,
            "{layout}: {behind}"
        );
    }
}

/// A slow cylinder whose gas pushes with `A (1 + 2 cos(angle)) bar`: for 120° of the turn it pulls the wrist pin, with a third of the
/// largest load. The report of the guide measures both.
#[test]
fn a_report_measures_the_reversal_of_a_pin() {
    let text = "use std.cylinder.{Rod, diametral}
use std.engine.{Crank, Engine}
use std.forces.GasPressure
use std.journals.Impedance
use std.layouts.single
use std.oils.SAE_10W40
fn wave(theta: CrankAngle) -> AbsolutePressure = 5 bar + 2 bar*cos(theta - 0 deg)
model Test {
    accept peak
    part unit = Engine(
        layout: single(), cycle_length: 360 deg, numbered_from: timing_end, seen_from: timing_end, sense: clockwise,
        bore: 60 mm, stroke: 80 mm, rod_length: 140 mm, spacing: 92 mm,
        main_diameter: 54 mm, main_width: 20 mm, main_clearance: diametral(54 um), pin_diameter: 48 mm, big_ends: hinge,
        law: Impedance, oil: SAE_10W40, oil_temperature: 60 degC,
        rod: Rod(mass: 0.3 kg, center: 50 mm, inertia: [0.12, 1.5, 1.5] g*m^2), piston_mass: 0.35 kg,
        crankshaft: Crank(mass: 8 kg, inertia: [60, 60, 15] g*m^2), gas: GasPressure(pressure: wave, ambient: 4 bar),
        flywheel_mass: 11 kg, flywheel_inertia: 0.112 kg*m^2, block_mass: 60 kg, block_inertia: [2.2, 2.4, 1.1] kg*m^2,
        speed: 6 rpm, drive_line: constant_speed,
    )
    gravity = [0, 0, 0] m/s^2
}
analysis run = transient(Test(), duration: 2 rev, sample: 0.5 deg, start: assembled)
report pins {
    let pin = last_cycle(run.unit.cylinder[1].pin_load)
    value reversal = 180 deg*(1 - abs(mean(min(max(pin/(10 N), -1), 1)))) as deg
    value reversed = min(maximum(pin), -minimum(pin))/max(maximum(pin), -minimum(pin)) as %
    value most = maximum(pin) as N
}";
    let program = eng::check(&Sources::from_text("m.eng", text), "m.eng").into_program();
    let program = program.unwrap_or_else(|report| panic!("{report}"));
    let analysis = program.analysis("run").unwrap();
    let solved = analysis.run(&mut |_| {});
    let results = solved
        .unwrap_or_else(|failed| panic!("{}", failed.error))
        .results;
    let machine = analysis.machine().expect("its numbers");
    let report = evaluate(&program.reports()[0], &[Run::new(&results, &machine)]);
    let value = |name: &str| report.values(name).expect("a value")[0].value;
    close("reversal", value("reversal"), TAU / 3.0, 1e-3);
    close("share", value("reversed"), 1.0 / 3.0, 1e-3);
    let area = std::f64::consts::PI / 4.0 * 0.06 * 0.06;
    close("largest", value("most"), 3e5 * area, 1e-4);
}

/// The example: its gas repeats, the drive gives what gas and films take, and a gram of air takes a few
/// percent more than that of the ideal cycle, `κ/(κ − 1) R T (π^((κ − 1)/κ) − 1)`, by the losses of the
/// reeds.
#[test]
fn the_compressor_of_the_examples_takes_a_little_more_than_the_ideal_work() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/compressor");
    let sources = Sources::folder(&folder).expect("a folder");
    let program = eng::check(&sources, "compressor.eng").into_program();
    let program = program.unwrap_or_else(|report| panic!("{report}"));
    let solved = program.analysis("running").unwrap().run(&mut |_| {});
    let results = solved
        .unwrap_or_else(|failed| panic!("{}", failed.error))
        .results;
    let time = column(&results, "time");
    let of_turn = |path: &str, back: usize| {
        let last = time.len() - 1 - 720 * (back + 1)..time.len() - 720 * back;
        crate::library_run::integral(&time[last.clone()], &column(&results, path)[last])
    };
    let work = |back: usize| -of_turn("unit.cylinder[1].gas.indicated_power", back);
    let air = of_turn("unit.cylinder[1].gas.delivery_flow", 0);
    close("repeats", work(1), work(0), 1e-3);
    close(
        "in and out",
        of_turn("unit.cylinder[1].gas.suction_flow", 0),
        air,
        1e-3,
    );
    let ideal = 3.5 * 287.053 * 293.0 * (5.0_f64.powf(0.4 / 1.4) - 1.0);
    let over = work(0) / air / ideal;
    println!("over the ideal work: {over}");
    assert!((1.02..1.08).contains(&over), "{over}");
    let mut given = 2.0 * work(0);
    for path in [
        "main[1]",
        "main[2]",
        "main[3]",
        "cylinder[1].big_end",
        "cylinder[2].big_end",
    ] {
        given += of_turn(&format!("unit.{path}.power_loss"), 0);
    }
    let taken = -of_turn("unit.brake_torque", 0) * 1450.0 * TAU / 60.0;
    close("drive", taken, given, 2e-3);
}

/// The examples: what the gas gives, less the heat of all films, is the brake's power. The films of the V6
/// agree with the firing order.
#[test]
fn the_engines_of_the_examples_balance_their_power() {
    for (name, cylinders, mains, speed) in [("concept", 4, 5, 4000.0), ("v6", 6, 4, 5500.0)] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("examples")
            .join(name);
        let sources = Sources::folder(&folder).expect("a folder");
        let program = eng::check(&sources, &format!("{name}.eng")).into_program();
        let program = program.unwrap_or_else(|report| panic!("{report}"));
        let solved = program.analysis("fired").unwrap().run(&mut |_| {});
        let results = solved
            .unwrap_or_else(|failed| panic!("{}", failed.error))
            .results;
        let time = column(&results, "time");
        let mean = |path: &str| {
            let values = column(&results, path);
            crate::library_run::integral(time, values) / (time[time.len() - 1] - time[0])
        };
        let mut gas = 0.0;
        let mut heat = 0.0;
        for k in 1..=cylinders {
            gas += mean(&format!("engine.cylinder[{k}].gas.indicated_power"));
            heat += mean(&format!("engine.cylinder[{k}].big_end.power_loss"));
        }
        for j in 1..=mains {
            heat += mean(&format!("engine.main[{j}].power_loss"));
        }
        let brake = mean("engine.brake_torque") * speed * TAU / 60.0;
        println!("{name}: gas {gas:.0} W, films {heat:.0} W, brake {brake:.0} W");
        assert!(heat > 0.02 * gas);
        close(name, brake, gas - heat, 2e-3);
        // each big end carries most just after its own firing dead centre
        let angle = column(&results, "cycle.angle");
        let peak = |path: &str| {
            let values = column(&results, path);
            let at = (0..values.len())
                .max_by(|a, b| values[*a].total_cmp(&values[*b]))
                .unwrap();
            angle[at].to_degrees().rem_euclid(720.0)
        };
        let due: &[f64] = match cylinders {
            4 => &[0.0, 540.0, 180.0, 360.0],
            _ => &[0.0, 240.0, 480.0, 660.0, 180.0, 420.0],
        };
        for (k, due) in due.iter().enumerate() {
            let found = peak(&format!("engine.cylinder[{}].big_end.radial_load", k + 1));
            let behind = (found - due).rem_euclid(720.0);
            assert!(
                behind > 5.0 && behind < 25.0,
                "cylinder {}: {found} for {due}",
                k + 1
            );
        }
    }
}

/// The moments of a rod that was weighed: sums over the points of both rings.
#[test]
fn a_weighed_rod_has_the_moments_of_two_rings() {
    let text = format!(
        "{HEAD}
model Rings {{
    gravity = [0, 0, 0] m/s^2
    let rod = WeighedRod(big_end: 0.4 kg, small_end: 0.2 kg, big_radius: 30 mm, small_radius: 15 mm)
    output center = rod.rod_center(150 mm)
    output inertia = rod.rod_inertia(150 mm) in ground
}}
analysis run = assemble(Rings())
"
    );
    let results = run(&text, "run");
    let points: Vec<[f64; 3]> = [(0.4, 0.03, 0.0), (0.2, 0.015, 0.15)]
        .into_iter()
        .flat_map(|(mass, radius, place)| {
            (0..360).map(move |i| {
                let (s, c) = (TAU * f64::from(i) / 360.0).sin_cos();
                [mass / 360.0, place + radius * c, radius * s]
            })
        })
        .collect();
    let mass: f64 = points.iter().map(|p| p[0]).sum();
    let center = points.iter().map(|p| p[0] * p[1]).sum::<f64>() / mass;
    close("centre", column(&results, "center")[0], center, 1e-12);
    let along: f64 = points.iter().map(|p| p[0] * p[2] * p[2]).sum();
    let across: f64 = points.iter().map(|p| p[0] * (p[1] - center).powi(2)).sum();
    for (axis, due) in [("x", along), ("y", across), ("z", along + across)] {
        close(
            axis,
            column(&results, &format!("inertia.{axis}"))[0],
            due,
            1e-12,
        );
    }
}
