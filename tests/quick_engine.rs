//! The mobility method in closed forms, and `QuickEngine` against multibody models.

use crate::library_run::{close, column, integral, run};
use eng::Results;
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

const SPEED: f64 = 300.0;
const DIAMETER: f64 = 0.05;
const CLEARANCE: f64 = 25e-6;
const VISCOSITY: f64 = 0.01;

/// A pin that turns at 300 rad/s in the middle of bearings of 50 mm. `items` are functions, constants and journals.
fn turning(items: &str, journals: &str, analysis: &str) -> String {
    format!(
        "use std.joints.Revolute
use std.drives.PrescribedRotation
use std.journals.{{Mobility, SolvedMobility}}
{items}
model Pin {{
    gravity = [0, 0, 0] m/s^2
    marker shell = [0, 0, 0] mm
    body pin {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker middle = origin; start angular_velocity = [0, 0, 300] rad/s }}
    joint seat = Revolute(pin.middle, shell)
    drive turn = PrescribedRotation(pin.middle, shell, speed: 300 rad/s)
    cycle angle = rotation(pin.middle, shell) {{ period = 720 deg }}
    {journals}
}}
analysis run = transient(Pin(), {analysis})
"
    )
}

/// A load that turns at half of the pin's speed meets no resistance of the rotation: the pin moves along the load as in
/// pure squeeze. With `s² = 1 − ε` and `k = 2.12 (D/B)²` the formula gives the time `2 (f(s) − f(1))/(0.15 K)`,
/// `f = 1/s + √k arctan(√k s)`, `K = F (c/R)²/(μ B D)`.
#[test]
fn under_a_load_at_half_of_the_speed_the_pin_is_squeezed() {
    let results = run(
        &turning(
            "fn whirling(angle: CrankAngle, size: Force) -> Vector2<Force> =
    [size*cos((angle - 0 deg)/2), size*sin((angle - 0 deg)/2)]",
            "journal film = Mobility(pin.middle, shell, diameter: 50 mm, width: 20 mm, radial_clearance: 25 um, \
             viscosity: 10 mPa*s, load: whirling(size: 8 kN))",
            "duration: 6 rev, sample: 30 deg, tolerance: 0.1",
        ),
        "run",
    );
    let [time, x, y] = [
        "time",
        "film.eccentricity_ratio.x",
        "film.eccentricity_ratio.y",
    ]
    .map(|path| column(&results, path));
    let width = 0.02;
    let pull = 8e3 * (2.0 * CLEARANCE / DIAMETER).powi(2) / (VISCOSITY * width * DIAMETER);
    let k: f64 = 2.12 * (DIAMETER / width).powi(2);
    let f = |s: f64| 1.0 / s + k.sqrt() * (k.sqrt() * s).atan();
    let (mut gap, mut beside) = (0.0_f64, 0.0_f64);
    for ((time, x), y) in time.iter().zip(x).zip(y) {
        let (sine, cosine) = (SPEED * time / 2.0).sin_cos();
        let left: f64 = 1.0 - x.hypot(*y);
        let due = 2.0 / (0.15 * pull) * (f(left.sqrt()) - f(1.0));
        // the error of time as one of the gap
        let rate = 0.15 * pull * (1.0 + k * left) * left.powf(1.5);
        gap = gap.max((due - time).abs() * rate / left);
        beside = beside.max((y * cosine - x * sine).abs());
    }
    let last = x[x.len() - 1].hypot(y[y.len() - 1]);
    println!("gap {gap:.1e}, beside {beside:.1e}, ratio at the end {last:.4}");
    assert!(last > 0.99);
    assert!(gap < 1e-3, "{gap}");
    assert!(beside < 2e-3, "{beside}");
}

/// A steady load: the formula's own ratio and attitude, and for `SolvedMobility` those of Reynolds' equation.
#[test]
fn a_steady_load_has_the_ratio_and_attitude_of_the_film() {
    let file: Value =
        serde_json::from_str(include_str!("reference/bearing_impedance_mobility.json"))
            .expect("JSON");
    let rows: Vec<Vec<f64>> = file["moes_finite"]["steady_rotation_vs_reynolds"]["rows"]
        .as_array()
        .expect("rows")
        .iter()
        .map(|row| {
            let row = row.as_array().expect("a row").iter();
            row.map(|n| n.as_f64().expect("a number")).collect()
        })
        .collect();
    // columns: B/D, ratio, W and attitude of the solved film, of the impedance, of the mobility
    let rows: Vec<_> = rows
        .into_iter()
        .filter(|row| row[0] <= 1.0 && row[1] >= 0.5)
        .collect();
    assert_eq!(rows.len(), 18);
    for (law, w, film, angle) in [
        ("Mobility", 6, 1e-5, 1e-3),
        ("SolvedMobility", 2, 3e-2, 2.5),
    ] {
        let mut journals = String::new();
        for (k, row) in rows.iter().enumerate() {
            let width = row[0] * DIAMETER;
            let speed = row[1] * CLEARANCE * SPEED / 2.0;
            let load =
                2.0 * VISCOSITY * width * (DIAMETER / (2.0 * CLEARANCE)).powi(3) * speed * row[w];
            let _ = writeln!(
                journals,
                "journal film{k} = {law}(pin.middle, shell, diameter: 50 mm, width: {width:?} m, radial_clearance: 25 um, \
                 viscosity: 10 mPa*s, load: steady(size: {load:?} N))"
            );
        }
        let text = turning(
            "fn steady(angle: CrankAngle, size: Force) -> Vector2<Force> = [size, 0 N]",
            &journals,
            "duration: 20 rev, sample: 30 deg",
        );
        let results = run(&text, "run");
        for (k, row) in rows.iter().enumerate() {
            let end = |axis: &str| {
                let values = column(&results, &format!("film{k}.eccentricity_ratio.{axis}"));
                values[values.len() - 1]
            };
            let (x, y) = (end("x"), end("y"));
            let thinner = (x.hypot(y) - row[1]) / (1.0 - row[1]);
            let beside = y.atan2(x).to_degrees() - row[w + 1];
            println!(
                "{law}: B/D {}, ratio {}: film {thinner:.1e} thinner, attitude {beside:.3} deg",
                row[0], row[1]
            );
            assert!(thinner.abs() < film, "{law} {row:?}: {thinner}");
            assert!(beside.abs() < angle, "{law} {row:?}: {beside}");
        }
    }
}

/// Ends and sense of a V-twin, as words and as signs.
struct Sense {
    numbered_from: &'static str,
    seen_from: &'static str,
    sense: &'static str,
    /// 1 if cylinder 1 is at the timing end.
    ahead: f64,
    /// 1 if the observer is at the timing end.
    view: f64,
    /// 1 for clockwise.
    clockwise: f64,
}

const SENSES: [Sense; 3] = [
    Sense {
        numbered_from: "timing_end",
        seen_from: "timing_end",
        sense: "clockwise",
        ahead: 1.0,
        view: 1.0,
        clockwise: 1.0,
    },
    Sense {
        numbered_from: "driving_end",
        seen_from: "driving_end",
        sense: "counterclockwise",
        ahead: -1.0,
        view: -1.0,
        clockwise: -1.0,
    },
    Sense {
        numbered_from: "driving_end",
        seen_from: "timing_end",
        sense: "counterclockwise",
        ahead: -1.0,
        view: 1.0,
        clockwise: -1.0,
    },
];

const TWIN: &str = "use std.cylinder.{Cylinder, Rod, diametral}
use std.drives.PrescribedRotation
use std.engine.{Crank, ThrowCrank}
use std.forces.GasPressure
use std.joints.{PointOnLine, Spherical}
use std.journals.Impedance
use std.layouts.vee
use std.oils.SAE_10W40
use std.quick.QuickEngine
table indicated(theta: CrankAngle) -> AbsolutePressure =
    points([-360, -180, -120, -60, -30, 0, 30, 60, 120, 180, 360] deg, [1, 1, 1.5, 4, 10, 50, 30, 12, 4, 1.2, 1] bar,
           interpolation: monotone, periodic: 720 deg)
const rod = Rod(mass: 0.5 kg, center: 40 mm, inertia: [0.1, 2.5, 2.6] g*m^2)
";

/// A V-twin of 60 degrees with pins 20 degrees apart, twice: bodies on a crank that hangs in a spherical joint and a slot
/// at its mains, and the quick engine.
fn twin(s: &Sense) -> String {
    let bank = [30.0 * s.view, -30.0 * s.view];
    let pin = [30.0 * s.view, 10.0 * s.view];
    let lean = [0, 1].map(|k: usize| {
        let beside = 40.0 * (pin[k] - bank[k]).to_radians().sin();
        -beside
            .atan2((140.0_f64.powi(2) - beside * beside).sqrt())
            .to_degrees()
    });
    // 10 g m towards each pin, on 8 kg: in mm
    let center = [f64::cos, f64::sin]
        .map(|f| pin.iter().map(|angle| f(angle.to_radians())).sum::<f64>() * 10.0 / 8.0);
    let (place, main) = (10.0 * s.ahead, 45.0 * s.ahead);
    let turning = s.view * s.clockwise;
    let second = if s.clockwise > 0.0 { 320 } else { 40 };
    let Sense {
        numbered_from,
        seen_from,
        sense,
        ..
    } = s;
    format!(
        "{TWIN}
model Bodies {{
    gravity = [0, 0, 0] m/s^2
    marker shell[j in 1..2] = [0, 0, [-1, 1][j]*{main:?}] mm
    marker bore[k in 1..2] = at([0, 0, [-1, 1][k]*{place:?}] mm,
        z: [cos({bank:?}[k]*1 deg), sin({bank:?}[k]*1 deg), 0])
    body crank {{
        mass = 8 kg
        inertia = [20, 20, 10] g*m^2
        center_of_mass = [{:?}, {:?}, 0] mm
        marker main[j in 1..2] = [0, 0, [-1, 1][j]*{main:?}] mm
        marker pin[k in 1..2] = [40*cos({pin:?}[k]*1 deg), 40*sin({pin:?}[k]*1 deg), [-1, 1][k]*{place:?}] mm
        start angular_velocity = [0, 0, {turning:?}]*(4000 rpm)
    }}
    joint first = Spherical(crank.main[1], shell[1])
    joint second = PointOnLine(crank.main[2], shell[2])
    drive turn = PrescribedRotation(crank.main[1], shell[1], speed: {turning:?}*4000 rpm)
    cycle angle = {turning:?}*rotation(crank.main[1], shell[1]) {{ period = 720 deg }}
    part cylinder[k in 1..2] = Cylinder(
        throw: crank.pin[k], bore: bore[k], head: bore[k], diameter: 80 mm, rod_length: 140 mm, rod_shape: rod,
        piston_mass: 0.4 kg, gas_law: GasPressure(pressure: indicated), firing: [0, {second}][k]*1 deg, big_ends: hinge,
        law: Impedance, pin_diameter: 45 mm, pin_width: 0 mm, pin_clearance: diametral(0 um), viscosity: 10 mPa*s,
    ) with {{
        guess rod.rotation = [0, 0, [{:?}, {:?}][k]] deg
        guess piston.rotation = [0, 0, {bank:?}[k]] deg
    }}
}}
model Quick {{
    gravity = [0, 0, 0] m/s^2
    part engine = QuickEngine(
        layout: vee(angle: 60 deg, throws: [0] deg, numbers: in_turn, split: 20 deg), order: [1, 2], idle_turn_after: 2,
        numbered_from: {numbered_from}, seen_from: {seen_from}, sense: {sense},
        bore: 80 mm, stroke: 80 mm, rod_length: 140 mm, spacing: 90 mm,
        main_diameter: 50 mm, main_width: 22 mm, main_clearance: diametral(50 um),
        pin_diameter: 45 mm, pin_width: 18 mm, pin_clearance: diametral(46 um), rod_stagger: 20 mm,
        oil: SAE_10W40, oil_temperature: 100 degC, rod: rod, piston_mass: 0.4 kg, speed: 4000 rpm,
        crankshaft: ThrowCrank(crank: Crank(mass: 8 kg, inertia: [20, 20, 10] g*m^2), moment: 20 g*m), pressure: indicated,
    )
}}
analysis bodies = transient(Bodies(), duration: 2 rev, sample: 5 deg)
analysis quick = transient(Quick(), duration: 2 rev, sample: 5 deg)
",
        center[0],
        center[1],
        bank[0] + lean[0],
        bank[1] + lean[1],
    )
}

/// Every load of the quick engine is that of a multibody model: two rods beside each other on a throw with split pins,
/// the mains of a statically determinate crank, and the torque.
#[test]
fn loads_of_a_v_twin_are_those_of_its_bodies() {
    for sense in &SENSES {
        let text = twin(sense);
        let bodies = run(&text, "bodies");
        let quick = run(&text, "quick");
        let mut worst = 0.0_f64;
        let mut same = |path: &str, found: &[f64], due: &[f64]| {
            assert_eq!(found.len(), due.len());
            let size = magnitude(due);
            assert!(size > 0.0, "{path}");
            for (found, due) in found.iter().zip(due) {
                worst = worst.max((found - due).abs() / size);
            }
        };
        for (joint, main) in [("first", 1), ("second", 2)] {
            for axis in ["x", "y"] {
                let path = format!("engine.main[{main}].force.{axis}");
                let due = column(&bodies, &format!("{joint}.force.{axis}"));
                same(&path, column(&quick, &path), due);
            }
        }
        for k in 1..=2 {
            let hinge =
                |axis: &str| column(&bodies, &format!("cylinder[{k}].hinge.force.{axis}")).to_vec();
            let due: Vec<f64> = hinge("x")
                .iter()
                .zip(hinge("y"))
                .map(|(x, y)| x.hypot(y))
                .collect();
            let path = format!("engine.cylinder[{k}].big_end.radial_load");
            same(&path, column(&quick, &path), &due);
            let path = format!("engine.cylinder[{k}].side_force");
            let due = column(&bodies, &format!("cylinder[{k}].side_force"));
            same(&path, column(&quick, &path), due);
        }
        // the torque on the drive, without the losses of films
        let torque: Vec<f64> = (0..column(&quick, "time").len())
            .map(|i| {
                let of = |k| column(&quick, &format!("engine.cylinder[{k}].torque"))[i];
                of(1) + of(2)
            })
            .collect();
        let turning = sense.view * sense.clockwise;
        let due: Vec<f64> = column(&bodies, "turn.torque.z")
            .iter()
            .map(|torque| -turning * torque)
            .collect();
        same("torque", &torque, &due);
        println!("seen from the {}: {worst:.1e}", sense.seen_from);
        assert!(worst < 1e-9, "{worst}");
    }
}

/// A V-twin on films, transient and quick: forces, films, losses and torque.
#[test]
fn films_of_a_v_twin_are_near_those_of_the_transient_engine() {
    let arguments = "layout: vee(angle: 60 deg, throws: [0] deg, numbers: in_turn), order: [1, 2], idle_turn_after: 2,
        numbered_from: timing_end, seen_from: timing_end, sense: clockwise,
        bore: 80 mm, stroke: 80 mm, rod_length: 140 mm, spacing: 90 mm,
        main_diameter: 50 mm, main_width: 22 mm, main_clearance: diametral(50 um),
        pin_diameter: 45 mm, pin_width: 18 mm, pin_clearance: diametral(46 um), rod_stagger: 20 mm,
        oil: SAE_10W40, oil_temperature: 100 degC, rod: rod, piston_mass: 0.4 kg, speed: 4000 rpm,";
    let text = |quick: &str, films: &str| {
        format!(
            "{TWIN}
use std.engine.Engine
use std.gas.closed_cycle
use std.journals.{{Impedance, Mobility, Reynolds, SolvedMobility}}
const angles = [2*(i - 180)*1 deg for i in 0..359]
fn gas = closed_cycle(bore: 80 mm, stroke: 80 mm, rod_length: 140 mm, compression_ratio: 10, heat: 1 kJ, begin: -20 deg,
    duration: 50 deg)
table burnt(theta: CrankAngle) -> AbsolutePressure = points(angles, [gas(angles[i]) for i in 1..360], periodic: 720 deg)
model Quick {{
    gravity = [0, 0, 0] m/s^2
    part engine = QuickEngine({arguments} law: {quick}, pressure: burnt,
        crankshaft: ThrowCrank(crank: Crank(mass: 8 kg, inertia: [20, 20, 10] g*m^2), moment: 0 g*m))
}}
model Films {{
    gravity = [0, 0, 0] m/s^2
    part engine = Engine({arguments} law: {films}, big_ends: film, gas: GasPressure(pressure: burnt),
        crankshaft: Crank(mass: 8 kg, inertia: [20, 20, 10] g*m^2), flywheel_mass: 0.1 kg, flywheel_inertia: 0.2 g*m^2,
        flange_distance: -45 mm, block_mass: 60 kg, block_inertia: [2, 2, 1] kg*m^2, drive_line: constant_speed)
}}
analysis quick = periodic(Quick(), change: 1 %, sample: 2 deg)
analysis films = periodic(Films(), change: 1 %, sample: 2 deg)
"
        )
    };
    for (quick, films, near) in [
        ("Mobility", "Impedance", 0.04),
        ("SolvedMobility", "Reynolds", 0.02),
    ] {
        let text = text(quick, films);
        let films = run(&text, "films");
        let quick = run(&text, "quick");
        let least = |results, path: &str| {
            let films = column(results, &format!("{path}.minimum_film"));
            films.iter().copied().fold(f64::INFINITY, f64::min)
        };
        let mean = |results, path: &str| {
            let time = column(results, "time");
            integral(time, column(results, path)) / (time[time.len() - 1] - time[0])
        };
        for path in [
            "engine.main[1]",
            "engine.main[2]",
            "engine.cylinder[1].big_end",
            "engine.cylinder[2].big_end",
        ] {
            close(path, least(&quick, path), least(&films, path), near);
            let loss = format!("{path}.power_loss");
            close(&loss, mean(&quick, &loss), mean(&films, &loss), 1e-2);
        }
        let torque = "engine.brake_torque";
        close(torque, mean(&quick, torque), mean(&films, torque), 5e-3);
    }
}

/// A row of four at 3000 rpm without pressure. Its throws have this moment (g m), and there are counterweights.
fn row_of_four(moment: f64, weights: &str) -> Results {
    let text = format!(
        "use std.cylinder.{{Rod, diametral}}
use std.engine.{{Counterweight, Crank, ThrowCrank}}
use std.layouts.inline
use std.oils.SAE_10W40
use std.quick.QuickEngine
fn still(angle: CrankAngle) -> AbsolutePressure = 1.01325 bar
model Row {{
    gravity = [0, 0, 0] m/s^2
    part engine = QuickEngine(
        layout: inline(throws: [0, 180, 180, 0] deg), order: [1, 3, 4, 2],
        numbered_from: timing_end, seen_from: timing_end, sense: clockwise,
        bore: 86 mm, stroke: 86 mm, rod_length: 143 mm, spacing: 92 mm,
        main_diameter: 54 mm, main_width: 20 mm, main_clearance: diametral(54 um),
        pin_diameter: 48 mm, pin_width: 24 mm, pin_clearance: diametral(50 um), oil: SAE_10W40, oil_temperature: 105 degC,
        rod: Rod(mass: 0.62 kg, center: 41 mm, inertia: [0.12, 3.0, 3.1] g*m^2), piston_mass: 0.45 kg, speed: 3000 rpm,
        crankshaft: ThrowCrank(crank: Crank(mass: 20 kg, inertia: [250, 260, 42] g*m^2), moment: {moment:?} g*m),
        pressure: still, counterweights: [{weights}],
    )
}}
analysis run = transient(Row(), duration: 2 rev, sample: 5 deg)
"
    );
    run(&text, "run")
}

/// The second order of a row of four, by the exact motion of its pistons. The moments of its throws shake nothing. They
/// load the outer mains by half of a throw, the middle one by two halves of equal throws, and the others not at all.
#[test]
fn a_row_of_four_shakes_by_its_pistons_alone() {
    let results = row_of_four(30.0, "");
    let bare = row_of_four(0.0, "");
    let angle = column(&results, "cycle.angle");
    let [x, y] = ["x", "y"].map(|axis| column(&results, &format!("engine.shaking.{axis}")));
    let (r, l, speed) = (0.043_f64, 0.143_f64, 3000.0 * TAU / 60.0);
    let mass = 0.45 + 0.62 * 41.0 / 143.0;
    let place = |t: f64| r * t.cos() + (l * l - (r * t.sin()).powi(2)).sqrt();
    // the second derivative by differences of fourth order
    let h = 1e-2;
    let bend = |t: f64| {
        let far = place(t + 2.0 * h) + place(t - 2.0 * h);
        let near = place(t + h) + place(t - h);
        (16.0 * near - far - 30.0 * place(t)) / (12.0 * h * h)
    };
    let due: Vec<f64> = angle
        .iter()
        .map(|t| -2.0 * mass * speed * speed * (bend(*t) + bend(*t + PI)))
        .collect();
    let size = magnitude(&due);
    let miss: Vec<f64> = x.iter().zip(&due).map(|(found, due)| found - due).collect();
    let (miss, across) = (magnitude(&miss), magnitude(y));
    println!("shaking {size:.0} N: {miss:.1e} N off, {across:.1e} N across");
    assert!(miss < 1e-6 * size && across < 1e-9 * size);
    let throw = 30e-3 * speed * speed;
    loads_differ(
        &results,
        &bare,
        [0.5, 0.0, -1.0, 0.0, 0.5].map(|part| part * throw),
    );
    // a counterweight of this moment at each throw, one of them a tenth of the distance of mains nearer to main 2
    let weights: Vec<String> = [9.2, 0.0, 0.0, 0.0]
        .iter()
        .zip(1..)
        .map(|(offset, throw)| {
            format!(
                "Counterweight(throw: {throw}, mass: 0.5 kg, radius: 60 mm, offset: {offset:?} mm)"
            )
        })
        .collect();
    let balanced = row_of_four(30.0, &weights.join(", "));
    loads_differ(
        &balanced,
        &bare,
        [0.1, -0.1, 0.0, 0.0, 0.0].map(|part| part * throw),
    );
}

/// The loads of five mains differ by these forces (N), which turn with throw 1.
fn loads_differ(of: &Results, from: &Results, by: [f64; 5]) {
    let angle = column(of, "cycle.angle");
    for (main, force) in (1..).zip(by) {
        for (axis, along) in [("x", f64::cos as fn(f64) -> f64), ("y", f64::sin)] {
            let path = format!("engine.main[{main}].force.{axis}");
            let pairs = column(of, &path).iter().zip(column(from, &path));
            for (angle, (one, other)) in angle.iter().zip(pairs) {
                // the film's force on the pin is against the load
                let due = -force * along(*angle);
                let found = one - other;
                assert!((found - due).abs() < 1e-6, "{path}: {found} for {due}");
            }
        }
    }
}

fn magnitude(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| most.max(x.abs()))
}
