//! Validation of the examples and the solver. docs/validation.md has the numbers and sources.

use crate::support::column;
use eng::{Analysis, Model, Quantity, Results, RuntimeError, Sources};
use serde_json::Value;
use std::path::Path;

fn folder(name: &str) -> Sources {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name);
    Sources::folder(path).expect("the example's folder")
}

fn analysis(example: &str, name: &str) -> Analysis {
    eng::check(&folder(example), &format!("{example}.eng"))
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
        .analysis(name)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn run(analysis: &Analysis) -> Results {
    analysis
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error))
        .results
}

fn model(text: &str, name: &str) -> Model {
    eng::check(&Sources::from_text("m.eng", text), "m.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
        .model(name)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn reference(file: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/reference")
        .join(file);
    serde_json::from_str(&std::fs::read_to_string(path).expect("a reference file"))
        .expect("valid JSON")
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .or_else(|| value.as_str().and_then(|s| s.parse().ok()))
        .expect("a number")
}

/// Newton–Euler forces of a slider-crank (closed form): columns of `example.inertia_only`.
#[test]
fn slider_crank_forces_are_exact() {
    let results = run(&analysis("slider_crank", "inertia"));
    let table = reference("slider_crank_analytic.json");
    let rows = table["example"]["inertia_only"].as_array().expect("rows");
    let angle = column(&results, "cycle.angle");
    let paths = [
        "piston_acceleration",
        "pin_force_x",
        "pin_force_y",
        "wrist_force_x",
        "wrist_force_y",
        "wall_force",
        "drive_torque",
    ];
    let mut compared = 0;
    for (k, path) in paths.iter().enumerate() {
        let values = column(&results, path);
        let largest = rows
            .iter()
            .map(|r| number(&r[k + 1]).abs())
            .fold(0.0, f64::max);
        for row in rows {
            for turn in [0.0, 360.0] {
                let wanted = (number(&row[0]) + turn).to_radians();
                let Some(i) = angle.iter().position(|a| (a - wanted).abs() < 1e-9) else {
                    continue;
                };
                let error = (values[i] - number(&row[k + 1])).abs() / largest;
                assert!(error < 1e-9, "{path} at {}°: {error:.1e}", row[0]);
                compared += 1;
            }
        }
    }
    assert!(compared >= 7 * 20, "only {compared} values were compared");
}

/// x, v/ω, a/ω² of the piston (closed form) for three geometries: columns of `kinematics[…].table`.
#[test]
fn slider_crank_kinematics_are_exact() {
    let table = reference("slider_crank_analytic.json");
    for case in table["kinematics"].as_array().expect("cases") {
        let (r, l) = (number(&case["r"]), number(&case["l"]));
        let plan = analysis("slider_crank", "inertia");
        let throw = plan.model().parameter("throw").expect("a parameter");
        let rod = plan.model().parameter("rod_length").expect("a parameter");
        let length = eng::Dimension::LENGTH;
        let plan = plan
            .set(throw, Quantity::si(r, length))
            .and_then(|p| p.set(rod, Quantity::si(l, length)))
            .expect("lengths fit");
        let results = run(&plan);
        let speed = column(&results, "cycle.speed")[0];
        let angle = column(&results, "cycle.angle");
        let columns = [
            (column(&results, "piston_place"), 1.0, l),
            (column(&results, "piston_velocity"), speed, r),
            (column(&results, "piston_acceleration"), speed * speed, r),
        ];
        for row in case["table"].as_array().expect("rows") {
            let wanted = number(&row[0]).to_radians();
            let i = angle
                .iter()
                .position(|a| (a - wanted).abs() < 1e-9)
                .expect("a sample at every 5°");
            for (k, (values, unit, size)) in columns.iter().enumerate() {
                let error = (values[i] / unit - number(&row[k + 1])).abs() / size;
                assert!(
                    error < 1e-8,
                    "r {r}, column {k} at {}°: {error:.1e}",
                    row[0]
                );
            }
        }
    }
}

#[test]
fn a_prescribed_rotation_holds_its_angle_for_a_second() {
    let text = "
        use std.joints.Revolute
        use std.drives.PrescribedRotation
        model Wheel {
            marker hub = [0, 0, 0] mm
            body wheel {
                mass = 3 kg; inertia = [20, 20, 30] g*m^2; center_of_mass = [10, 0, 0] mm
                marker axle = origin
                start angular_velocity = [0, 0, 1]*(4000 rpm)
            }
            joint bearing = Revolute(wheel.axle, hub)
            drive turn = PrescribedRotation(wheel.axle, hub, speed: 4000 rpm)
        }";
    let model = model(text, "Wheel");
    let angle = model.channel("bearing.angle").expect("a channel");
    let mut simulation = model
        .simulation()
        .fixed_step(1e-4)
        .start()
        .expect("it assembles");
    while simulation.time() < 1.0 - 1e-9 {
        simulation.step().expect("a step");
    }
    let exact = 4000.0 * 2.0 * std::f64::consts::PI / 60.0 * simulation.time();
    let error = (simulation.value(angle).expect("a value") - exact).abs();
    assert!(
        error < 1e-9,
        "{error:.1e} rad after {} turns",
        exact / std::f64::consts::TAU
    );
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Largest change of the journals' forces between two cycles that begin at `first` and `second` (rad), over the peak.
fn change(results: &Results, first: f64, second: f64, length: f64) -> f64 {
    let angle = column(results, "cycle.angle");
    let at = |wanted: f64| {
        angle
            .iter()
            .position(|a| (a - wanted).abs() < 1e-6)
            .expect("a sample")
    };
    let (i, j, n) = (at(first), at(second), at(first + length) - at(first));
    let mut worst = 0.0_f64;
    for k in 1..=5 {
        for axis in ["x", "y"] {
            let force = column(results, &format!("engine.main[{k}].force.{axis}"));
            let size = peak(column(results, &format!("engine.main[{k}].force.x")));
            for s in 0..=n {
                worst = worst.max((force[i + s] - force[j + s]).abs() / size);
            }
        }
    }
    worst
}

#[test]
fn the_engine_on_five_films() {
    let turn = 2.0 * std::f64::consts::PI;
    let program = eng::check(&folder("inline4"), "inline4.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    let get = |name: &str| {
        run(&program
            .analysis(name)
            .unwrap_or_else(|error| panic!("{error}")))
    };

    let unfired = get("unfired");
    for (from, to) in [(turn, 2.0 * turn), (2.0 * turn, 3.0 * turn)] {
        let c = change(&unfired, from, to, turn);
        assert!(
            c < 0.01,
            "unfired forces change by {c:.4} from revolution to revolution"
        );
    }
    let first = column(&unfired, "engine.main[1].force.x");
    let last = column(&unfired, "engine.main[5].force.x");
    let from = first.len() / 2;
    let apart = |a: &[f64], b: &[f64]| {
        let d: f64 = a[from..]
            .iter()
            .zip(&b[from..])
            .map(|(x, y)| (x - y) * (x - y))
            .sum();
        let s: f64 = a[from..].iter().map(|x| x * x).sum();
        (d / s).sqrt()
    };
    assert!(apart(first, last) > 0.05, "the flywheel tells 5 from 1");

    let alone = get("no_flywheel");
    let same = apart(
        column(&alone, "engine.main[1].force.x"),
        column(&alone, "engine.main[5].force.x"),
    );
    assert!(same < 0.01, "without it they differ by {same:.4}");

    for results in [&unfired, &alone, &get("fired")] {
        for k in 1..=5 {
            let ratio = column(results, &format!("engine.main[{k}].film_ratio"));
            assert!(ratio.iter().all(|r| *r < 1.0), "main[{k}] touches");
            let force = results
                .column(&format!("engine.main[{k}].force.x"))
                .expect("a column");
            assert_eq!(force.frame, format!("engine.block.main[{k}]"));
            assert_eq!(force.display.symbol, "kN");
        }
    }
}

/// Fired forces repeat every second revolution once the drive line has settled.
#[test]
fn a_fired_cycle_repeats() {
    let turn = 2.0 * std::f64::consts::PI;
    let text = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4/inline4.eng"),
    )
    .expect("the example");
    let csv = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4/pressure.csv"),
    )
    .expect("its pressure");
    let longer = text.replace(
        "analysis fired = transient(Inline4(combustion: 1), duration: 4 rev, sample: 0.5 deg)",
        "analysis fired = transient(Inline4(combustion: 1), duration: 8 rev, sample: 2 deg)",
    );
    assert_ne!(text, longer);
    let sources = Sources::from_texts([
        ("inline4.eng".to_owned(), longer),
        ("pressure.csv".to_owned(), csv),
    ]);
    let results = run(&eng::check(&sources, "inline4.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
        .analysis("fired")
        .unwrap_or_else(|error| panic!("{error}")));
    let early = change(&results, 2.0 * turn, 4.0 * turn, 2.0 * turn);
    let late = change(&results, 4.0 * turn, 6.0 * turn, 2.0 * turn);
    assert!(
        late < 0.01,
        "fired forces change by {late:.4} (a cycle earlier {early:.4})"
    );
}

const FIVE_MAINS: &str = "
use std.joints.Revolute
model Shaft {
    gravity = [-9.81, 0, 0] m/s^2
    marker wall[j in 1..5] = [0 mm, 0 mm, 100 mm * j]
    body crank {
        mass = 20 kg; inertia = [300, 300, 40] g*m^2
        marker main[j in 1..5] = [0 mm, 0 mm, 100 mm * j]
    }
    joint main[j in 1..5] = Revolute(crank.main[j], wall[j])
}";

#[test]
fn five_revolutes_are_named() {
    let error = model(FIVE_MAINS, "Shaft")
        .simulation()
        .start()
        .expect_err("20 of 25 equations repeat others");
    let eng::Error::Run { cause, report } = &error else {
        panic!("{error}");
    };
    let RuntimeError::Redundant { groups } = cause.as_ref() else {
        panic!("{cause}");
    };
    assert_eq!(groups.len(), 20);
    let text = report.to_string();
    for path in ["main[2]", "main[3]", "main[4]", "main[5]"] {
        assert!(text.contains(path), "{path} is not named in:\n{text}");
    }
    insta::assert_snapshot!(
        "five_revolutes",
        text.lines().take(30).collect::<Vec<_>>().join("\n")
    );
}

#[test]
fn the_same_crank_runs_on_journals() {
    let text = FIVE_MAINS
        .replace("use std.joints.Revolute", "use std.joints.PointOnPlane\nuse std.journals.Short")
        .replace(
            "joint main[j in 1..5] = Revolute(crank.main[j], wall[j])",
            "joint thrust = PointOnPlane(crank.main[3], wall[3])
    journal main[j in 1..5] = Short(pin: crank.main[j], shell: wall[j], diameter: 54 mm, width: 15 mm,
        radial_clearance: 27 um, viscosity: 10 mPa*s)",
        )
        .replace(
            "marker main",
            "start angular_velocity = [0, 0, 1]*(1000 rpm)\n        marker main",
        );
    let mut simulation = model(&text, "Shaft")
        .simulation()
        .start()
        .unwrap_or_else(|error| panic!("{error}"));
    while simulation.time() < 0.02 {
        simulation.step().unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn models_are_shared_and_threads_agree() {
    fn shared<T: Clone + Send + Sync + 'static>(_: &T) {}
    let model = analysis("inline4", "unfired").model().clone();
    shared(&model);
    let force = model.channel("engine.main[5].force.x").expect("a channel");
    let work = move |model: Model| {
        let mut simulation = model
            .simulation()
            .start()
            .unwrap_or_else(|error| panic!("{error}"));
        let mut bits = Vec::new();
        for _ in 0..60 {
            simulation.step().unwrap_or_else(|error| panic!("{error}"));
            let value = simulation
                .value(force)
                .unwrap_or_else(|error| panic!("{error}"));
            bits.push((simulation.time().to_bits(), value.to_bits()));
        }
        bits
    };
    let threads: Vec<_> = (0..2)
        .map(|_| {
            let model = model.clone();
            std::thread::spawn(move || work(model))
        })
        .collect();
    let runs: Vec<_> = threads
        .into_iter()
        .map(|t| t.join().expect("no panic"))
        .collect();
    assert_eq!(runs[0], runs[1]);
    assert_eq!(runs[0], work(model));
}

#[test]
fn a_resumed_engine_has_the_same_bits() {
    let model = analysis("inline4", "fired").model().clone();
    let force = model.channel("engine.main[1].force.x").expect("a channel");
    let mut going = model
        .simulation()
        .start()
        .unwrap_or_else(|error| panic!("{error}"));
    for _ in 0..40 {
        going.step().unwrap_or_else(|error| panic!("{error}"));
    }
    let saved = going.checkpoint();
    let mut resumed = model
        .simulation()
        .resume(&saved)
        .unwrap_or_else(|error| panic!("{error}"));
    for _ in 0..40 {
        going.step().unwrap_or_else(|error| panic!("{error}"));
        resumed.step().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(going.time().to_bits(), resumed.time().to_bits());
        let (a, b) = (going.value(force), resumed.value(force));
        assert_eq!(a.expect("a value").to_bits(), b.expect("a value").to_bits());
    }
    assert!(
        model
            .simulation()
            .resume(&saved[..saved.len() / 2])
            .is_err()
    );
}

/// A slider-crank that turns freely after its start: no drive, no friction.
const FREE: &str = "
use std.joints.{Revolute, PointOnLine, Translational}
model Free {
    marker rail = [0, 0, 0] mm
    marker bore = at([0, 0, 0] mm, z: [1, 0, 0])
    body crank {
        mass = 10 kg; inertia = [250, 250, 400] g*m^2
        marker main = origin
        marker pin = [40, 0, 0] mm
        start angular_velocity = [0, 0, 1]*(3000 rpm)
    }
    body rod {
        mass = 0.6 kg; inertia = [0.1, 3, 3] g*m^2; center_of_mass = [45, 0, 0] mm
        marker big = origin
        marker small = [140, 0, 0] mm
    }
    body piston { mass = 0.5 kg; inertia = [0.5, 0.4, 0.4] g*m^2; marker pin = origin; marker crown = at(origin, z: [1, 0, 0]) }
    joint main = Revolute(crank.main, rail)
    joint big_end = Revolute(rod.big, crank.pin)
    joint wrist = PointOnLine(rod.small, piston.pin)
    joint liner = Translational(piston.crown, bore) { branch travel > 0 mm }
}";

/// Largest |ΔE/E| over some revolutions, and largest drift of position and velocity, with a number of steps for
/// each revolution.
fn drift(revolutions: u32, steps: u32) -> (f64, f64, f64) {
    let mut simulation = model(FREE, "Free")
        .simulation()
        .fixed_step(0.02 / f64::from(steps))
        .start()
        .unwrap_or_else(|error| panic!("{error}"));
    let start = simulation.energy().kinetic;
    let (mut energy, mut position, mut velocity) = (0.0_f64, 0.0_f64, 0.0_f64);
    for k in 0..revolutions * steps {
        simulation.step().unwrap_or_else(|error| panic!("{error}"));
        energy = energy.max((simulation.energy().kinetic / start - 1.0).abs());
        if k % 97 == 0 {
            let runtime = simulation.runtime();
            runtime
                .output_state()
                .unwrap_or_else(|error| panic!("{error}"));
            let (p, v) = runtime
                .output_drift()
                .unwrap_or_else(|error| panic!("{error}"));
            position = position.max(p);
            velocity = velocity.max(v);
        }
    }
    (energy, position, velocity)
}

#[test]
fn energy_stays_over_a_hundred_revolutions() {
    let (energy, position, velocity) = drift(100, 1500);
    println!("|dE/E| {energy:.2e}, drift {position:.1e} m, {velocity:.1e} m/s");
    assert!(energy < 2e-6, "|dE/E| = {energy:.2e}");
    assert!(position < 1e-9 && velocity < 1e-9 * 12.6);
    let (coarse, _, _) = drift(3, 375);
    let (fine, _, _) = drift(3, 750);
    let order = (coarse / fine).log2();
    assert!(order > 1.9, "energy error falls with order {order:.2}");
}
