//! Derivatives of the values of reports, against central differences of the whole values.

use crate::gradients::{analysis, differences, exact, run, value};
use crate::periodic_gradients::motor_wheel;
use crate::support::program;
use eng::post::{EvaluatedReport, Outcome, PostError, Run, evaluate};
use eng::{Analysis, Program};
use eng_report::figure::Figure;
use std::path::Path;

/// Largest error of a derivative.
const TOLERANCE: f64 = 1e-6;
/// The same of a motion that repeats: its steps meet the ends of cycles, so other parameters have slightly other steps.
const OF_REPEATED: f64 = 1e-4;
/// Step (s) of a motion whose speed changes.
const STEP: f64 = 2e-5;
/// Change of a parameter for differences.
const SHARE: f64 = 1e-2;

/// Values of a report, each with its text.
type Values<'t> = &'t [(&'t str, &'t str)];

/// A text with a report `values`, and with a report `gradients` of all values by all parameters.
fn with_reports(text: &str, values: Values<'_>, parameters: &[&str]) -> String {
    let all: String = values
        .iter()
        .map(|(name, of)| format!("    value {name} = {of}\n"))
        .collect();
    let mut slopes = String::new();
    for (name, of) in values {
        for (at, parameter) in parameters.iter().enumerate() {
            slopes.push_str(&format!(
                "    value {name}_{at} = gradient({of}, {parameter})\n"
            ));
        }
    }
    format!("{text}\nreport values {{\n{all}}}\nreport gradients {{\n{slopes}}}\n")
}

fn reported(program: &Program, of: &Analysis, report: &str) -> EvaluatedReport {
    let outcome = run(of);
    let machine = of.machine().unwrap();
    let runs = [Run::new(&outcome.results, &machine).with_gradients(&outcome.gradients)];
    let report = program.reports().iter().find(|r| r.name == report).unwrap();
    evaluate(report, &runs)
}

fn number(report: &EvaluatedReport, name: &str) -> f64 {
    match report.values(name) {
        Ok([number]) => number.value,
        other => panic!("{name}: {other:?}"),
    }
}

/// Compares every derivative with the extrapolated central difference of its whole value. Below a tenth of the value over
/// the parameter, a derivative is small beside the tolerance of the steps.
fn compare(text: &str, of: (&str, f64), values: Values<'_>, parameters: &[&str]) {
    compare_within(TOLERANCE, text, of, values, parameters);
}

/// The same with another largest error.
fn compare_within(
    tolerance: f64,
    text: &str,
    (name, step): (&str, f64),
    values: Values<'_>,
    parameters: &[&str],
) {
    let program = program(&with_reports(text, values, parameters));
    let with = analysis(&program, name).stepping(exact(step));
    let plain = with.clone().gradients::<&str>(&[]).unwrap();
    let made = reported(&program, &with, "gradients");
    let base = reported(&program, &plain, "values");
    let mut wrong = Vec::new();
    for (at, parameter) in parameters.iter().enumerate() {
        let expected = differences(&plain, parameter, SHARE, |changed| {
            let report = reported(&program, changed, "values");
            values
                .iter()
                .map(|(name, _)| number(&report, name))
                .collect()
        });
        for ((name, of), expected) in values.iter().zip(expected) {
            let got = number(&made, &format!("{name}_{at}"));
            let least = 0.1 * number(&base, name).abs() / value(&plain, parameter).abs();
            let error = (got - expected).abs() / expected.abs().max(least);
            println!("{of} by {parameter}: {got:.6e}, {expected:.6e}, {error:.1e}");
            if error > tolerance || error.is_nan() {
                wrong.push(format!("{of} by {parameter}: {got} for {expected}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn slider_crank() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/slider_crank/slider_crank.eng");
    std::fs::read_to_string(path).unwrap()
}

/// In its repeated motion a wheel has another speed and another time of a cycle for each torque.
#[test]
fn values_of_a_repeated_motion_have_the_derivatives_of_differences() {
    let text = motor_wheel(
        "analysis turns = periodic(Wheel(), sample: 15 deg, change: 1e-7, cycles: 400, gradients: [stall, offset])",
    );
    let values = [
        ("least", "minimum(turns.speed)"),
        ("average", "mean(turns.speed)"),
        ("swing", "peak_to_peak(turns.hinge.force.y)"),
        ("first", "amplitude(turns.speed, 1)"),
        ("slow", "maximum(low_pass(turns.hinge.force.x, 2))"),
    ];
    let of = ("turns", 1e-4);
    compare_within(OF_REPEATED, &text, of, &values, &["stall", "offset"]);
}

/// Samples at angles: by the speed their times change, by lengths and masses they do not.
#[test]
fn values_of_a_slider_crank_have_the_derivatives_of_differences() {
    let text = slider_crank()
        + "analysis s = transient(SliderCrank(), duration: 2 rev, sample: 5 deg, gradients: [speed, throw, rod_mass])";
    let values = [
        ("highest", "maximum(s.wall_force)"),
        ("lowest", "minimum(s.drive_torque)"),
        ("swing", "peak_to_peak(s.wall_force)"),
        ("average", "mean(max(s.pin_force_x, 0 N))"),
        ("effective", "rms(s.wall_force)"),
        ("magnitude", "mean(abs(last_cycle(s.wall_force)))"),
        ("where", "maximum_at(last_cycle(s.wall_force))"),
        ("when", "maximum_at(last_cycle(s.wall_force), over: time)"),
        ("second", "amplitude(last_cycle(s.wall_force), 2)"),
        ("slow", "maximum(low_pass(last_cycle(s.wall_force), 4.5))"),
        ("fast", "rms(band(last_cycle(s.drive_torque), 1.5, 6.5))"),
        ("level", "decibel(rms(s.wall_force), reference: 1 N)"),
        ("pin", "maximum(norm(s.main.force))"),
        (
            "power",
            "maximum(s.wall_force*s.piston_velocity)/maximum(s.drive_torque)",
        ),
        (
            "either",
            "min(maximum(s.wall_force), maximum(s.wrist_force_x))",
        ),
        ("root", "(maximum(s.wall_force)/1 N)^1.5"),
        (
            "again",
            "rms(resample(last_cycle(s.wall_force), like: last_cycle(s.drive_torque)))",
        ),
        ("above", "mean(min(abs(s.pin_force_x), 30 kN))"),
        ("part", "mean(last(s.wall_force, 200 deg))"),
        (
            "both",
            "sum([maximum(s.wall_force), -minimum(s.wall_force)])",
        ),
    ];
    compare(&text, ("s", 5e-5), &values, &["speed", "throw", "rod_mass"]);
}

/// The report of the example. Forces of inertia follow the square of the speed, so `ω ∂F/∂ω = 2 F`.
#[test]
fn the_report_of_the_example_has_its_closed_forms_and_bars() {
    let program = program(&slider_crank());
    let analysis = analysis(&program, "sensitive").stepping(exact(5e-5));
    let report = reported(&program, &analysis, "influences");
    let force = number(&report, "wall");
    let by_speed = number(&report, "by_speed") * value(&analysis, "speed");
    assert!((by_speed / (2.0 * force) - 1.0).abs() < 1e-8, "{by_speed}");
    let figure = report
        .entries
        .iter()
        .find_map(|entry| match &entry.outcome {
            Ok(Outcome::Figure(figure)) => Some(figure),
            _ => None,
        });
    let Some(Figure::Tornado(tornado)) = figure.map(|figure| &**figure) else {
        panic!("{report:?}");
    };
    let bar = |name: &str| {
        tornado
            .bars
            .iter()
            .find(|bar| bar.name == name)
            .unwrap()
            .value
    };
    assert!((bar("speed") / (0.02 * force) - 1.0).abs() < 1e-8);
    let by_piston = number(&report, "by_piston") * 0.01 * value(&analysis, "piston_mass");
    assert!((bar("piston_mass") - by_piston).abs() < 1e-9 * force);
    assert_eq!(tornado.bars.len(), 6);
    let sizes: Vec<f64> = tornado.bars.iter().map(|bar| bar.value.abs()).collect();
    assert!(sizes.is_sorted_by(|a, b| a >= b), "{sizes:?}");
    assert_eq!(
        (
            tornado.abscissa.quantity.as_str(),
            tornado.abscissa.unit.as_str()
        ),
        ("Change of wall force", "N")
    );
    assert!(
        tornado
            .subtitle
            .ends_with("analysis sensitive, 1 % more of each parameter")
    );
}

/// A pendulum that turns over, so the speed of its cycle changes.
fn wheel(analyses: &str) -> String {
    format!(
        "
use std.joints.Revolute
model Wheel {{
    param pull: Acceleration = 9.81 m/s^2
    param length: Length = 0.2 m
    param spin: AngularVelocity = 30 rad/s
    gravity = [0, -1, 0]*pull
    marker pivot = [0, 0, 0] mm
    body bob {{
        mass = 1 kg
        inertia = [1, 1, 1] g*m^2
        marker top = [0, 1, 0]*length
        start angular_velocity = [0, 0, 1]*spin
    }}
    joint pin = Revolute(bob.top, pivot)
    cycle angle = rotation(bob.top, pivot) {{ period = 360 deg }}
    output height: Length = dot(bob.origin.origin, ground.y) as mm
    output slanted: Velocity = dot(bob.origin.velocity, ground.x + ground.y)
}}
{analyses}
"
    )
}

#[test]
fn values_over_a_changing_speed_have_the_derivatives_of_differences() {
    let text = wheel(
        "analysis w = transient(Wheel(), duration: 2 rev, sample: 5 deg, gradients: [pull, length])",
    );
    let values = [
        ("slowest", "minimum(w.cycle.speed)"),
        ("average", "mean(w.cycle.speed)"),
        ("height", "rms(w.height)"),
        ("cycle", "mean(last_cycle(w.cycle.speed))"),
        ("duration", "maximum(w.time)"),
        ("first", "amplitude(last_cycle(w.height), 1)"),
        ("late", "mean(last(w.height, 400 deg))"),
    ];
    let parameters = ["pull", "length"];
    compare(&text, ("w", STEP), &values, &parameters);
    let text = wheel(
        "analysis t = transient(Wheel(), duration: 0.45 s, sample: 5 ms, gradients: [pull, length])",
    );
    let values = [
        ("average", "mean(t.height)"),
        ("highest", "minimum_at(last(t.slanted, 0.15 s), over: time)"),
        ("place", "minimum_at(last(t.slanted, 0.15 s))"),
        ("turned", "maximum(t.cycle.angle)"),
        ("part", "rms(last(t.height, 0.15 s))"),
        ("tone", "amplitude(t.height, 5 Hz)"),
    ];
    compare(&text, ("t", STEP), &values, &parameters);
}

#[test]
fn a_function_without_a_known_derivative_is_refused_with_its_name() {
    let text = wheel(
        "analysis t = transient(Wheel(), duration: 0.6 s, sample: 5 ms, gradients: pull)
report refused {
    value a = gradient(mean(last_cycle(t.height)), pull)
    value b = gradient(maximum(low_pass(t.height, 20 Hz)), pull)
    value c = gradient(amplitude(t.height, 1), pull)
    value d = gradient(gradient(maximum(t.height), pull), pull)
    value e = gradient(minimum(max(t.height, 1 m)), pull)
    value f = gradient(minimum(abs(t.height - t.height)), pull)
}",
    );
    let program = program(&text);
    let report = reported(&program, &analysis(&program, "t"), "refused");
    let said: Vec<String> = report
        .entries
        .iter()
        .map(|entry| match &entry.outcome {
            Ok(Outcome::Value(numbers, _)) => format!("{}: {}", entry.name, numbers[0].value),
            Err(error) => format!("{}: {error}", entry.name),
            Ok(_) => String::new(),
        })
        .collect();
    insta::assert_snapshot!(said.join("\n"));
    // of a run without gradients, for instance after `--gradients` with another parameter
    let plain = analysis(&program, "t").gradients::<&str>(&[]).unwrap();
    let report = reported(&program, &plain, "refused");
    let missing = PostError::NoGradient {
        analysis: "t".to_owned(),
        parameter: "pull".to_owned(),
    };
    assert_eq!(report.entries[4].outcome, Err(missing));
}
