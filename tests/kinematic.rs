//! `kinematic` analyses: motion, reactions and torque against closed forms, own kinematics of a four-bar, transients with
//! an ideal drive and the quick engine; and reactions that it does not determine.

use crate::library_run::{column, integral, outcome, refusal, run};
use eng::results::Results;
use serde_json::Value;
use std::f64::consts::TAU;

fn reference() -> Value {
    serde_json::from_str(include_str!("reference/slider_crank_analytic.json")).expect("JSON")
}

fn number(value: &Value) -> f64 {
    let number = value.as_f64().or_else(|| value.as_str()?.parse().ok());
    number.expect("a number")
}

/// The text of the example, with further lines.
fn slider_crank(lines: &str) -> String {
    let text = include_str!("../examples/slider_crank/slider_crank.eng");
    let (model, _) = text.split_once("analysis inertia").expect("an analysis");
    format!("{model}\n{lines}\n")
}

/// Largest difference of two lists, as a share of the second one's largest number.
fn apart(found: &[f64], due: &[f64]) -> f64 {
    assert_eq!(found.len(), due.len());
    let size = due.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let worst = found.iter().zip(due);
    worst.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / size
}

/// Forces of a slider-crank in closed form, with a drive and with the cycle turned by the analysis.
#[test]
fn forces_of_a_slider_crank_are_those_of_the_closed_form() {
    let table = reference();
    let rows = table["example"]["inertia_only"].as_array().expect("rows");
    let driven = slider_crank("analysis turn = kinematic(SliderCrank(), sample: 5 deg)");
    let free = driven
        .replace(
            "drive turn = PrescribedRotation(crank.main, rail, speed: speed)",
            "",
        )
        .replace("output drive_torque: Torque = turn.torque.z as N*m", "");
    for (text, torque) in [(&driven, "drive_torque"), (&free, "cycle.torque")] {
        let results = run(text, "turn");
        let angle = column(&results, "cycle.angle");
        assert_eq!(angle.len(), 73);
        let paths = [
            "piston_acceleration",
            "pin_force_x",
            "pin_force_y",
            "wrist_force_x",
            "wrist_force_y",
            "wall_force",
            torque,
        ];
        let (mut worst, mut compared) = (0.0_f64, 0);
        for (k, path) in paths.iter().enumerate() {
            let values = column(&results, path);
            let sizes = rows.iter().map(|row| number(&row[k + 1]).abs());
            let largest = sizes.fold(0.0, f64::max);
            for row in rows {
                let wanted = number(&row[0]).to_radians();
                let Some(i) = angle.iter().position(|a| (a - wanted).abs() < 1e-9) else {
                    continue;
                };
                worst = worst.max((values[i] - number(&row[k + 1])).abs() / largest);
                compared += 1;
            }
        }
        println!("{torque}: {worst:.1e} of the largest, {compared} numbers");
        assert!(compared >= 7 * 13, "{compared}");
        assert!(worst < 1e-10, "{worst:e}");
    }
    // both torques are one number
    let results = run(&driven, "turn");
    let [own, drive] = ["cycle.torque", "drive_torque"].map(|path| column(&results, path));
    assert!(apart(own, drive) < 1e-13);
}

/// Place, speed and acceleration of the piston for three geometries, in closed form.
#[test]
fn the_motion_of_a_slider_crank_is_that_of_the_closed_form() {
    let table = reference();
    for case in table["kinematics"].as_array().expect("cases") {
        let (r, l) = (number(&case["r"]), number(&case["l"]));
        let text = slider_crank(&format!(
            "analysis turn = kinematic(SliderCrank(throw: {r:?} m, rod_length: {l:?} m), sample: 5 deg)"
        ));
        let results = run(&text, "turn");
        let speed = column(&results, "cycle.speed")[0];
        let angle = column(&results, "cycle.angle");
        let columns = [
            ("piston_place", 1.0, l),
            ("piston_velocity", speed, r),
            ("piston_acceleration", speed * speed, r),
        ];
        let mut worst = [0.0_f64; 3];
        for row in case["table"].as_array().expect("rows") {
            let wanted = number(&row[0]).to_radians();
            let i = angle.iter().position(|a| (a - wanted).abs() < 1e-9);
            let i = i.expect("a sample at every 5°");
            for (k, (path, unit, size)) in columns.iter().enumerate() {
                let value = column(&results, path)[i] / unit;
                worst[k] = worst[k].max((value - number(&row[k + 1])).abs() / size);
            }
        }
        println!("r/l {:.2}: {worst:?}", r / l);
        assert!(worst.iter().all(|worst| *worst < 1e-11), "{worst:?}");
    }
}

/// A four-bar linkage: angles by its closed loop, rates and accelerations by the loop's derivatives, the torque by virtual
/// work, all of them from formulas of this test.
#[test]
fn a_four_bar_has_the_motion_and_the_torque_of_its_loop() {
    let text = include_str!("good/fourbar.eng");
    let (model, _) = text.split_once("}\nanalysis run").expect("an analysis");
    let text = format!(
        "{model}
    output rocker_rate = dot(rocker.top.angular_velocity, ground.z) as rad/s
    output rocker_swing = dot(rocker.top.angular_acceleration, ground.z) as rad/s^2
}}
analysis turn = kinematic(FourBar(speed: 300 rpm), over: 0.2 s, sample: 1 ms)
"
    );
    let results = run(&text, "turn");
    let time = column(&results, "time");
    assert_eq!(time.len(), 201);
    let [x, y, torque, rate, swing] =
        ["x", "y", "torque", "rocker_rate", "rocker_swing"].map(|path| column(&results, path));
    // lengths (m) of crank, coupler, rocker and ground
    let (a, b, c, d) = (0.1_f64, 0.4_f64, 0.25_f64, 0.4_f64);
    let omega = 300.0 * TAU / 60.0;
    let mut due: [Vec<f64>; 5] = Default::default();
    for t in time {
        let turned = omega * t;
        // the crank's pin, and the triangle between it and the rocker's foot
        let pin = [a * turned.cos(), a * turned.sin()];
        let (ex, ey) = (d - pin[0], -pin[1]);
        let way = ex.hypot(ey);
        let beta = ey.atan2(ex) + ((b * b + way * way - c * c) / (2.0 * b * way)).acos();
        let top = [pin[0] + b * beta.cos(), pin[1] + b * beta.sin()];
        // from the foot to the top
        let gamma = top[1].atan2(top[0] - d);
        // −a ω sin − b β' sin + c γ' sin = 0, a ω cos + b β' cos − c γ' cos = 0, and their derivatives
        let solve = |p: f64, q: f64| {
            // [−b sin β, c sin γ; b cos β, −c cos γ] [u; w] = [p; q]
            let (m11, m12) = (-b * beta.sin(), c * gamma.sin());
            let (m21, m22) = (b * beta.cos(), -c * gamma.cos());
            let det = m11 * m22 - m12 * m21;
            ((p * m22 - m12 * q) / det, (m11 * q - m21 * p) / det)
        };
        let (db, dc) = solve(a * omega * turned.sin(), -a * omega * turned.cos());
        let p =
            a * omega * omega * turned.cos() + b * db * db * beta.cos() - c * dc * dc * gamma.cos();
        let q =
            a * omega * omega * turned.sin() + b * db * db * beta.sin() - c * dc * dc * gamma.sin();
        let (ddb, ddc) = solve(p, q);
        // a point of the coupler: along and beside
        let point = |u: f64, w: f64| {
            [
                pin[0] + u * beta.cos() - w * beta.sin(),
                pin[1] + u * beta.sin() + w * beta.cos(),
            ]
        };
        let tip = point(b / 2.0, 0.12);
        due[0].push(tip[0]);
        due[1].push(tip[1]);
        due[3].push(dc);
        due[4].push(ddc);
        // power of inertia and weight of crank, coupler and rocker over the crank's speed
        let g = 9.81;
        let crank_power = 0.5 * g * a / 2.0 * omega * turned.cos();
        let middle_v = [
            -a * omega * turned.sin() - b / 2.0 * db * beta.sin(),
            a * omega * turned.cos() + b / 2.0 * db * beta.cos(),
        ];
        let middle_a = [
            -a * omega * omega * turned.cos() - b / 2.0 * (ddb * beta.sin() + db * db * beta.cos()),
            -a * omega * omega * turned.sin() + b / 2.0 * (ddb * beta.cos() - db * db * beta.sin()),
        ];
        let coupler_power =
            1.2 * (middle_a[0] * middle_v[0] + (middle_a[1] + g) * middle_v[1]) + 16e-3 * ddb * db;
        let about_foot = 5e-3 + 0.9 * c * c / 4.0;
        let rocker_power = about_foot * ddc * dc + 0.9 * g * c / 2.0 * gamma.cos() * dc;
        due[2].push((crank_power + coupler_power + rocker_power) / omega);
    }
    let found = [x, y, torque, rate, swing];
    let worst: Vec<f64> = (0..5).map(|k| apart(found[k], &due[k])).collect();
    println!("x, y, torque, rate and its rate: {worst:?}");
    assert!(worst.iter().all(|worst| *worst < 1e-10), "{worst:?}");
}

/// A row of four on hinges with a pressure trace, turned by an ideal drive.
const FOUR: &str = "use std.joints.{Revolute, PointOnLine, Translational}
use std.drives.PrescribedRotation
use std.forces.GasPressure
table indicated(theta: CrankAngle) -> AbsolutePressure =
    points([-360, -180, -120, -60, -30, 0, 30, 60, 120, 180, 360] deg, [1, 1, 1.5, 4, 10, 50, 30, 12, 4, 1.2, 1] bar,
           interpolation: cubic, periodic: 720 deg)
model Four {
    const side = [1, -1, -1, 1]
    const firing = [0, 540, 180, 360] deg
    gravity = [-9.81, 0, 0] m/s^2
    marker main = [0, 0, 0] mm
    marker bore[k in 1..4] = at([0, 0, (k - 2.5)*92] mm, z: [1, 0, 0])
    marker head[k in 1..4] = at([186, 0, (k - 2.5)*92] mm, z: [1, 0, 0])
    body crank { mass = 20 kg; inertia = [250, 260, 42] g*m^2; products_of_inertia = [0, 3, 0] g*m^2
        marker main = origin
        marker pin[k in 1..4] = [43*side[k], 0, (k - 2.5)*92] mm
        start angular_velocity = [0, 0, 4000] rpm }
    body rod[k in 1..4] { mass = 0.62 kg; inertia = [0.12, 3.0, 3.1] g*m^2
        marker big = [-41, 0, 0] mm; marker small = [102, 0, 0] mm }
    body piston[k in 1..4] { mass = 0.45 kg; inertia = [0.4, 0.3, 0.4] g*m^2
        marker pin = origin; marker crown = at(origin, z: [1, 0, 0]) }
    joint bearing = Revolute(crank.main, main)
    drive turn = PrescribedRotation(crank.main, main, speed: 4000 rpm)
    joint big[k in 1..4] = Revolute(rod[k].big, crank.pin[k])
    joint small[k in 1..4] = PointOnLine(rod[k].small, piston[k].pin)
    joint liner[k in 1..4] = Translational(piston[k].crown, bore[k]) { branch travel > 0 mm }
    force gas[k in 1..4] = GasPressure(piston[k].crown, head[k], bore: 86 mm, pressure: indicated, firing: firing[k])
    cycle angle = rotation(crank.main, main) { period = 720 deg }
}
analysis turn = kinematic(Four(), sample: 2 deg)
analysis moving = transient(Four(), duration: 720 deg, sample: 2 deg, tolerance: 0.01)
";

/// Every channel of a fired row of four: inverse dynamics against the motion in time with an ideal drive. The torque does
/// the work of the gas.
#[test]
fn inverse_dynamics_of_a_row_of_four_are_the_forces_of_its_motion_in_time() {
    let turn = run(FOUR, "turn");
    let moving = run(FOUR, "moving");
    let own = |path: &&str| !path.starts_with("energy.") && *path != "cycle.torque";
    let paths: Vec<&str> = turn.columns().iter().map(|c| c.path.as_str()).collect();
    let (mut worst, mut at, mut compared) = (0.0_f64, "", 0);
    for path in paths.iter().copied().filter(|path| own(path)) {
        let due = column(&moving, path);
        let size = due.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        // zero by symmetry
        if size < 1e-6 {
            continue;
        }
        let apart = apart(column(&turn, path), due);
        compared += 1;
        if apart > worst {
            (worst, at) = (apart, path);
        }
    }
    println!("{compared} channels: at most {worst:.1e} of the largest value, in {at}");
    assert!(compared > 60, "{compared}");
    assert!(worst < 1e-6, "{at}: {worst:e}");

    // means over the period: the rule of trapezoids is as exact as the trace is smooth
    let angle = column(&turn, "cycle.angle");
    let work = integral(angle, column(&turn, "cycle.torque"));
    let gas: f64 = (1..=4)
        .map(|k| {
            let thrust = column(&turn, &format!("gas[{k}].thrust"));
            let speed = column(&turn, &format!("liner[{k}].speed"));
            let power: Vec<f64> = thrust.iter().zip(speed).map(|(f, v)| -f * v).collect();
            integral(column(&turn, "time"), &power)
        })
        .sum();
    println!("work of the torque {work:.6} J, of the gas {gas:.6} J");
    assert!(gas > 1e3);
    assert!((work + gas).abs() < 1e-9 * gas, "{work} {gas}");
}

/// The V-twin of the test of `QuickEngine`: two mains, so every bearing load is determinate.
#[test]
fn bearing_loads_of_an_engine_on_films_are_those_of_the_quick_engine() {
    let arguments = "layout: vee(angle: 60 deg, throws: [0] deg, numbers: in_turn), order: [1, 2], idle_turn_after: 2,
        numbered_from: timing_end, seen_from: timing_end, sense: clockwise,
        bore: 80 mm, stroke: 80 mm, rod_length: 140 mm, spacing: 90 mm,
        main_diameter: 50 mm, main_width: 22 mm, main_clearance: diametral(50 um),
        pin_diameter: 45 mm, pin_width: 18 mm, pin_clearance: diametral(46 um), rod_stagger: 20 mm,
        oil: SAE_10W40, oil_temperature: 100 degC, rod: Rod(mass: 0.5 kg, center: 40 mm, inertia: [0.1, 2.5, 2.6] g*m^2),
        piston_mass: 0.4 kg, speed: 4000 rpm,";
    let text = format!(
        "use std.cylinder.{{Rod, diametral}}
use std.engine.{{Crank, Engine, ThrowCrank}}
use std.forces.GasPressure
use std.journals.Impedance
use std.layouts.vee
use std.oils.SAE_10W40
use std.quick.QuickEngine
table indicated(theta: CrankAngle) -> AbsolutePressure =
    points([-360, -180, -120, -60, -30, 0, 30, 60, 120, 180, 360] deg, [1, 1, 1.5, 4, 10, 50, 30, 12, 4, 1.2, 1] bar,
           interpolation: monotone, periodic: 720 deg)
model Quick {{
    gravity = [0, 0, 0] m/s^2
    part engine = QuickEngine({arguments} pressure: indicated,
        crankshaft: ThrowCrank(crank: Crank(mass: 8 kg, inertia: [20, 20, 10] g*m^2), moment: 0 g*m))
}}
model Films {{
    gravity = [0, 0, 0] m/s^2
    part engine = Engine({arguments} law: Impedance, big_ends: film, gas: GasPressure(pressure: indicated),
        crankshaft: Crank(mass: 8 kg, inertia: [20, 20, 10] g*m^2), flywheel_mass: 1e-6 kg, flywheel_inertia: 1e-6 g*m^2,
        flange_distance: -45 mm, block_mass: 60 kg, block_inertia: [2, 2, 1] kg*m^2, drive_line: constant_speed)
}}
analysis quick = transient(Quick(), duration: 2 rev, sample: 5 deg)
analysis turn = kinematic(Films(), sample: 5 deg)
"
    );
    let quick = run(&text, "quick");
    let turn = run(&text, "turn");
    for main in 1..=2 {
        for axis in ["x", "y"] {
            let path = format!("engine.main[{main}].force.{axis}");
            let off = apart(column(&turn, &path), column(&quick, &path));
            println!("{path}: {off:.1e}");
            assert!(off < 1e-6, "{path}: {off:e}");
        }
    }
    for k in 1..=2 {
        let force =
            |axis: &str| column(&turn, &format!("engine.cylinder[{k}].big_end.force.{axis}"));
        let pairs = force("x").iter().zip(force("y"));
        let load: Vec<f64> = pairs.map(|(x, y)| x.hypot(*y)).collect();
        let path = format!("engine.cylinder[{k}].big_end.radial_load");
        let off = apart(&load, column(&quick, &path));
        println!("{path}: {off:.1e}");
        assert!(off < 1e-6, "{path}: {off:e}");
    }
}

fn has(results: &Results, path: &str) -> bool {
    results.column(path).is_some()
}

/// A shaft with an unbalance of 4 kg mm at 100 rad/s.
fn shaft(items: &str) -> String {
    format!(
        "use std.joints.{{Revolute, PointOnPlane}}
use std.journals.Impedance
model Shaft {{
    gravity = [0, 0, 0] m/s^2
    marker shell[j in 1..3] = [0, 0, 100*(j - 2)] mm
    body rotor {{ mass = 4 kg; inertia = [10, 10, 20] g*m^2; center_of_mass = [1, 0, 50] mm
        marker pin[j in 1..3] = [0, 0, 100*(j - 2)] mm
        start angular_velocity = [0, 0, 100] rad/s }}
    cycle angle = rotation(rotor.pin[1], shell[1]) {{ period = 360 deg }}
    {items}
}}
analysis turn = kinematic(Shaft(), sample: 10 deg)
"
    )
}

const FILMS: &str = "joint thrust = PointOnPlane(rotor.pin[1], shell[1])
    journal film[j in 1..2] = Impedance(pin: rotor.pin[[1, 3][j]], shell: shell[[1, 3][j]], diameter: 50 mm, width: 20 mm,
        radial_clearance: 25 um, viscosity: 10 mPa*s)";

/// Two films carry the unbalance by the lever rule, `m e ω²` 40 N at three quarters of the span. No other output of a film
/// is in the results.
#[test]
fn two_films_carry_by_the_lever_rule() {
    let results = run(&shaft(FILMS), "turn");
    let angle = column(&results, "cycle.angle");
    for (film, load) in [("film[1]", 10.0), ("film[2]", 30.0)] {
        let [x, y] = ["x", "y"].map(|axis| column(&results, &format!("{film}.force.{axis}")));
        for (i, angle) in angle.iter().enumerate() {
            assert!((x[i] + load * angle.cos()).abs() < 1e-9, "{} {angle}", x[i]);
            assert!((y[i] + load * angle.sin()).abs() < 1e-9, "{} {angle}", y[i]);
        }
    }
    assert!(!has(&results, "film[1].minimum_film"));
    assert!(
        !results
            .columns()
            .iter()
            .any(|c| c.path.starts_with("energy."))
    );
}

/// Three films on a rigid shaft, and two hinges: their single reactions are no result, their sum is.
#[test]
fn shared_reactions_are_left_out_and_named() {
    let three = FILMS
        .replace("film[j in 1..2]", "film[j in 1..3]")
        .replace("[[1, 3][j]]", "[j]");
    let found = outcome(&shaft(&three), "turn");
    assert!(!has(&found.results, "film[1].force.x"));
    let determined = found.determined.expect("a kinematic analysis");
    let shared: Vec<Vec<&str>> = (determined.shared.iter())
        .map(|shared| shared.elements.iter().map(|e| e.path.as_str()).collect())
        .collect();
    assert_eq!(shared, [["film[1]", "film[2]", "film[3]"]]);
    assert!(determined.turned);

    let hinges = "joint left = Revolute(rotor.pin[1], shell[1])
    joint right = Revolute(rotor.pin[3], shell[3])
    output sum = left.force.x + right.force.x as N
    output one = left.force.x as N";
    let found = outcome(&shaft(hinges), "turn");
    let results = &found.results;
    assert!(!has(results, "one") && !has(results, "left.force.x"));
    // each of two hinges also holds the tilt, so no lever rule divides the load
    let sum = column(results, "sum");
    for (sum, angle) in sum.iter().zip(column(results, "cycle.angle")) {
        assert!((sum + 40.0 * angle.cos()).abs() < 1e-9);
    }
    let determined = found.determined.expect("a kinematic analysis");
    assert_eq!(determined.shared.len(), 1);
    assert_eq!(determined.shared[0].elements.len(), 2);
}

/// A swing by a drive that is a function of time: rates and accelerations by its derivatives, samples by time.
#[test]
fn a_stated_angle_gives_rates_and_the_torque_of_its_inertia() {
    let text = "use std.joints.Revolute
use std.drives.PrescribedAngle
fn swing(t: Time) -> Angle = 0.5 rad*sin(3 rad/s*t)
model Arm {
    gravity = [0, 0, 0] m/s^2
    marker stand = origin
    body arm { mass = 2 kg; inertia = [20, 20, 30] g*m^2; marker hub = origin }
    joint hinge = Revolute(arm.hub, stand)
    drive turn = PrescribedAngle(arm.hub, stand, angle_at: swing)
    output torque = turn.torque.z as N*m
}
analysis turn = kinematic(Arm(), over: 4 s, sample: 50 ms)
";
    let results = run(text, "turn");
    let time = column(&results, "time");
    assert_eq!(time.len(), 81);
    let due = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { time.iter().map(|t| f(*t)).collect() };
    let angle = due(&|t| 0.5 * (3.0 * t).sin());
    let torque = due(&|t| -0.03 * 0.5 * 9.0 * (3.0 * t).sin());
    assert!(apart(column(&results, "hinge.angle"), &angle) < 1e-12);
    assert!(apart(column(&results, "torque"), &torque) < 1e-12);
}

/// A rotor that a drive starts from rest, with an acceleration that jumps exactly at a sample; and one that `step` brings to
/// rest at a sample. The torque is the inertia's, also where the cycle is at rest. A fan with a motor of its own has no part.
#[test]
fn drives_start_and_stop_at_samples() {
    let text = |law: &str| {
        format!(
            "use std.joints.Revolute
use std.drives.PrescribedAngle
use std.math.step
fn law(t: Time) -> Angle = {law}
fn blow(t: Time) -> Angle = 400 rad/s^2*t*t
model Rotor {{
    gravity = [0, 0, 0] m/s^2
    marker seat = origin
    marker stand = [0, 500, 0] mm
    body rotor {{ mass = 1 kg; inertia = [6, 6, 11] g*m^2; marker hub = origin }}
    body fan {{ mass = 1 kg; inertia = [3, 3, 5] g*m^2; marker hub = origin }}
    joint hinge = Revolute(rotor.hub, seat)
    joint axle = Revolute(fan.hub, stand)
    drive turn = PrescribedAngle(rotor.hub, seat, angle_at: law)
    drive motor = PrescribedAngle(fan.hub, stand, angle_at: blow)
    cycle angle = rotation(rotor.hub, seat) {{ period = 360 deg }}
}}
analysis run = kinematic(Rotor(), over: 40 ms, sample: 1 ms)
"
        )
    };
    let results = run(&text("1000 rad/s^2*max(t - 20 ms, 0 s)^2"), "run");
    let time = column(&results, "time");
    assert_eq!(time.len(), 41);
    for (time, torque) in time.iter().zip(column(&results, "cycle.torque")) {
        // either side counts at the jump
        let due = if *time > 0.0205 { 22.0 } else { 0.0 };
        if (time - 0.020).abs() > 1e-9 {
            assert!((torque - due).abs() < 1e-9, "{torque} at {time}");
        }
    }
    // s = x³ (10 − 15 x + 6 x²), x = t/(20 ms)
    let results = run(&text("0.8 rad*step(t/(20 ms))"), "run");
    for (time, torque) in time.iter().zip(column(&results, "cycle.torque")) {
        let x = (time / 0.02).min(1.0);
        let due = 0.011 * 0.8 * (60.0 * x - 180.0 * x * x + 120.0 * x * x * x) / 4e-4;
        assert!(
            (torque - due).abs() < 1e-9 * 127.0,
            "{torque} for {due} at {time}"
        );
    }
}

/// Refused: an output that reads a shared reaction behind a condition that no examined moment fulfils, and a state whose slow
/// changes have not ended.
#[test]
fn a_hidden_share_and_a_slow_state_are_refused() {
    let hinges = "joint left = Revolute(rotor.pin[1], shell[1])
    joint right = Revolute(rotor.pin[3], shell[3])
    output late = if sin(left.angle) > 0.9995 then left.force.x else 0 N";
    let message = refusal(&shaft(hinges), "turn");
    assert!(
        message.contains("late contains a shared reaction at t ="),
        "{message}"
    );
    let slow = FILMS.to_owned() + "\n    force warm = Slow(rotor.pin[3], shell[1])";
    let text = shaft(&slow).replace(
        "model Shaft",
        "force Slow(a: Marker, b: Marker) {
    state shift: Length = 1 mm
    der(shift) = (dot(a.x, b.x)*(3 mm) + 5 mm - shift)/(1000 s)
    apply force (0 N/m)*shift*b.z on a against b
}
model Shaft",
    );
    let message = refusal(&text, "turn");
    assert!(
        message.contains("does not repeat in 40 cycles"),
        "{message}"
    );
}

/// The pressure of a closed cycle follows the motion until it repeats: against a periodic motion with an ideal drive.
#[test]
fn the_pressure_of_a_closed_cycle_is_that_of_the_motion_that_repeats() {
    let text = "use std.joints.{Revolute, PointOnLine, Translational}
use std.drives.PrescribedRotation
use std.gas.{ClosedCycle, wiebe}
model Single {
    gravity = [0, 0, 0] m/s^2
    marker main = [0, 0, 0] mm
    marker bore = at([0, 0, 0] mm, z: [1, 0, 0])
    marker head = at([186, 0, 0] mm, z: [1, 0, 0])
    body crank { mass = 4 kg; inertia = [10, 10, 20] g*m^2; marker hub = origin; marker pin = [43, 0, 0] mm }
    body rod { mass = 0.62 kg; inertia = [0.12, 3.0, 3.1] g*m^2; marker big = [-41, 0, 0] mm; marker small = [102, 0, 0] mm }
    body piston { mass = 0.45 kg; inertia = [0.4, 0.3, 0.4] g*m^2; marker pin = origin; marker crown = at(origin, z: [1, 0, 0]) }
    joint bearing = Revolute(crank.hub, main)
    drive turn = PrescribedRotation(crank.hub, main, speed: 4000 rpm)
    joint big = Revolute(rod.big, crank.pin)
    joint small = PointOnLine(rod.small, piston.pin)
    joint liner = Translational(piston.crown, bore) { branch travel > 0 mm }
    force gas = ClosedCycle(piston: piston.crown, head: head, bore: 86 mm, stroke: 86 mm, compression_ratio: 10.3,
        heat: 1.24 kJ, burnt: wiebe(begin: -22 deg, duration: 52 deg), intake: 0.95 bar, firing: 0 deg)
    cycle angle = rotation(crank.hub, main) { period = 720 deg }
    start crank.angular_velocity = [0, 0, 4000] rpm
}
analysis turn = kinematic(Single(), sample: 4 deg)
analysis steady = periodic(Single(), sample: 4 deg, change: 0.001 %, tolerance: 0.001)
";
    let turn = run(text, "turn");
    let steady = run(text, "steady");
    // the cycle of a periodic analysis begins after whole cycles, and both have its first and last angle
    for path in [
        "gas.gauge_pressure",
        "liner.force.x",
        "big.force.x",
        "turn.torque.z",
    ] {
        let off = apart(column(&turn, path), column(&steady, path));
        println!("{path}: {off:.1e}");
        assert!(off < 1e-5, "{path}: {off:e}");
    }
    let pressure = column(&turn, "gas.gauge_pressure");
    let peak = pressure.iter().copied().fold(0.0, f64::max);
    assert!(peak > 5e6, "{peak}");
    // it repeats
    let ends = (pressure[0] - pressure[pressure.len() - 1]).abs();
    assert!(ends < 1e-5 * peak, "{ends}");
}

/// A body on two hinges that turn about crossed axes at unequal speeds. States whose rates are the velocity of one of its
/// points and the rate of one of its axes follow this place and this axis: in a spatial motion, also through a moment at
/// which the acceleration of a drive jumps.
#[test]
fn states_whose_rates_are_velocities_follow_a_spatial_motion() {
    let text = "use std.joints.Revolute
use std.drives.{PrescribedAngle, PrescribedRotation}
fn law(t: Time) -> Angle = 30 rad/s*t + 400 rad/s^2*max(t - 12.3 ms, 0 s)^2
force Followed(a: Marker, b: Marker) {
    state along: Length = 30 mm
    state tilt: 1 = 0.5
    der(along) = dot(a.velocity - b.velocity, b.x)
    der(tilt) = dot(cross(a.angular_velocity, a.x), b.x)
    apply force (0 N/m)*along*b.x on a against b
    output place: Length = along - dot(a.origin - b.origin, b.x)
    output axis: 1 = tilt - dot(a.x, b.x)
    output size: Length = dot(a.origin - b.origin, b.x)
}
model Gimbal {
    gravity = [0, 0, 0] m/s^2
    marker seat = origin
    body ring { accept inertia; mass = 1 kg; inertia = [6, 6, 11] g*m^2; marker hub = origin; marker cross = at([0, 0, 40] mm, z: [1, 0, 0]) }
    body top { mass = 1 kg; inertia = [3, 4, 5] g*m^2; marker hub = at(origin, z: [1, 0, 0]); marker tip = at([20, 70, 30] mm, z: [1, 1, 1]) }
    joint outer = Revolute(ring.hub, seat)
    joint inner = Revolute(top.hub, ring.cross)
    drive first = PrescribedAngle(ring.hub, seat, angle_at: law)
    drive second = PrescribedRotation(top.hub, ring.cross, speed: 700 rpm)
    force followed = Followed(top.tip, seat)
}
analysis turn = kinematic(Gimbal(), over: 100 ms, sample: 1 ms)
";
    let results = run(text, "turn");
    // the range of a difference that should be constant
    let range = |path: &str| {
        let values = column(&results, path).iter();
        let ends = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], x| {
            [least.min(*x), most.max(*x)]
        });
        ends[1] - ends[0]
    };
    let [place, axis, size] = ["followed.place", "followed.axis", "followed.size"].map(range);
    println!("place {place:.1e} m of {size:.3} m, axis {axis:.1e}");
    assert!(size > 0.05, "{size}");
    assert!(place < 1e-8 * size && axis < 1e-8, "{place:e} {axis:e}");
}

/// A compressor whose valves need short steps: trials of the states leave the range of the law, so they are halved. Against
/// a periodic motion with the same ideal drive.
#[test]
fn an_ideal_compressor_has_the_forces_of_the_motion_that_repeats() {
    let text = "
use std.joints.{Revolute, PointOnLine, Translational}
use std.drives.PrescribedRotation
use std.gas.IdealCompressor
model Single {
    gravity = [0, 0, 0] m/s^2
    marker main = [0, 0, 0] mm
    marker bore = at([0, 0, 0] mm, z: [1, 0, 0])
    marker head = at([186, 0, 0] mm, z: [1, 0, 0])
    body crank { mass = 4 kg; inertia = [10, 10, 20] g*m^2; marker hub = origin; marker pin = [43, 0, 0] mm }
    body rod { mass = 0.62 kg; inertia = [0.12, 3.0, 3.1] g*m^2; marker big = [-41, 0, 0] mm; marker small = [102, 0, 0] mm }
    body piston { mass = 0.45 kg; inertia = [0.4, 0.3, 0.4] g*m^2; marker pin = origin; marker crown = at(origin, z: [1, 0, 0]) }
    joint bearing = Revolute(crank.hub, main)
    drive turn = PrescribedRotation(crank.hub, main, speed: 600 rpm)
    joint big = Revolute(rod.big, crank.pin)
    joint small = PointOnLine(rod.small, piston.pin)
    joint liner = Translational(piston.crown, bore) { branch travel > 0 mm }
    force gas = IdealCompressor(piston.crown, head, bore: 60 mm, clearance: 12 cc, suction: 1 bar, delivery: 5 bar, suction_port: 20 cm^2, delivery_port: 20 cm^2)
    cycle angle = rotation(crank.hub, main) { period = 360 deg }
    start crank.angular_velocity = [0, 0, 1]*(600 rpm)
}
analysis turn = kinematic(Single(), sample: 4 deg)
analysis steady = periodic(Single(), sample: 4 deg, change: 0.001 %, tolerance: 0.01)
";
    let turn = run(text, "turn");
    let steady = run(text, "steady");
    for path in ["turn.torque.z", "liner.force.x", "big.force.x"] {
        let off = apart(column(&turn, path), column(&steady, path));
        println!("{path}: {off:.1e}");
        assert!(off < 1e-4, "{path}: {off:e}");
    }
}

/// A state that reads an unwrapped angle has no cycle that repeats, also where it decays at once. It is named beside a state
/// that repeats, and also if no sample is at a whole cycle, or if the samples end within the first one.
#[test]
fn a_state_of_the_unwrapped_angle_is_refused() {
    let text = "
use std.joints.Revolute
use std.drives.PrescribedAngle
force S(a: Marker, b: Marker, wrapped: 1) {
    let th = rotation(a, b)/(1 rad)
    let followed = if wrapped > 0.5 then sin(th) else th
    state x: 1 = 0 scale 1
    der(x) = (followed - x)/(0.005 s)
    output y: 1 = x
    apply torque 0 N*m*b.z on a against b
}

model M {
    gravity = [0, 0, 0] m/s^2
    marker stand = origin
    body shaft { mass = 4 kg; inertia = [10, 10, 20] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 1]*(100 rad/s) }
    joint hinge = Revolute(shaft.hub, stand)
    force even = S(shaft.hub, stand, wrapped: 1)
    force odd = S(shaft.hub, stand, wrapped: 0)
    cycle angle = rotation(shaft.hub, stand) { period = 360 deg }
}
analysis turn = kinematic(M(), sample: 10 deg, over: 720 deg)
";
    for range in [
        "sample: 10 deg, over: 720 deg",
        "sample: 7 deg, over: 800 deg",
        "sample: 1 deg",
        "sample: 1 deg, over: 90 deg",
    ] {
        let text = text.replace("sample: 10 deg, over: 720 deg", range);
        let message = refusal(&text, "turn");
        assert!(
            message.contains(
                "odd: its state `x` differs from that of the first sample after whole cycles"
            ),
            "{range}: {message}"
        );
    }
}
