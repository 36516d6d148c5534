//! Published mechanisms and a torsional chain, written as users write them, against the digits of their sources.

use crate::support::program;
use eng::Model;
use serde_json::Value;

fn model(text: &str, name: &str) -> Model {
    program(text)
        .model(name)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn reference(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// A number of a reference. Its digits are text, because a double holds fewer.
fn figure(value: &Value) -> f64 {
    value.as_str().expect("digits").parse().expect("a number")
}

/// Channels (SI) at `end` (s), reached in `steps` equal steps.
fn at_the_end(model: &Model, end: f64, steps: u32, channels: &[&str]) -> Vec<f64> {
    let channels: Vec<_> = channels
        .iter()
        .map(|path| model.channel(path).expect("a channel"))
        .collect();
    let step = end / f64::from(steps);
    let mut simulation = model
        .simulation()
        .fixed_step(step)
        .start()
        .unwrap_or_else(|error| panic!("{error}"));
    for k in 1..=steps {
        let until = if k == steps { end } else { f64::from(k) * step };
        simulation
            .runtime()
            .step_within(until)
            .unwrap_or_else(|error| panic!("{error}"));
    }
    channels
        .iter()
        .map(|channel| simulation.value(*channel).expect("a value"))
        .collect()
}

/// Values found with `steps` and twice as many steps have errors in the ratio of second order. Richardson's
/// extrapolation `(4 b - a)/3` of both is `due` within `tolerance` (relative).
#[track_caller]
fn converges(model: &Model, end: f64, steps: u32, due: &[(&str, f64)], tolerance: f64) {
    let channels: Vec<&str> = due.iter().map(|(path, _)| *path).collect();
    let coarse = at_the_end(model, end, steps, &channels);
    let fine = at_the_end(model, end, 2 * steps, &channels);
    for (((path, due), a), b) in due.iter().zip(&coarse).zip(&fine) {
        let ratio = (a - due) / (b - due);
        assert!(
            (3.8..4.2).contains(&ratio),
            "{path}: {a}, {b} instead of {due}: the errors fall by {ratio}"
        );
        let found = (4.0 * b - a) / 3.0;
        assert!(
            (found - due).abs() <= tolerance * due.abs(),
            "{path}: {found} instead of {due}: {:.1e}",
            found / due - 1.0
        );
    }
}

/// All seven angles and two rates after 30 ms, in which the crank turns two and a half times.
#[test]
fn the_squeezing_mechanism_moves_as_published() {
    let reference = reference(include_str!("reference/andrews.json"));
    let values = &reference["rederived"]["values"]["0.03"];
    let model = model(include_str!("../examples/squeezer/squeezer.eng"), "Andrews");
    let due = [
        ("beta", "q1"),
        ("theta", "q2"),
        ("gamma", "q3"),
        ("phi", "q4"),
        ("delta", "q5"),
        ("omega", "q6"),
        ("epsilon", "q7"),
        ("beta_rate", "v1"),
        ("phi_rate", "v4"),
    ]
    .map(|(path, key)| (path, figure(&values[key])));
    converges(&model, 0.03, 7_500, &due, 5e-6);
}

/// Places, a velocity and an acceleration after 3 s, in which the right wheel bounces two dozen times; the
/// loads of axle and guide are the multipliers times the gradients of the published constraints.
#[test]
fn the_car_axis_moves_as_published() {
    let reference = reference(include_str!("reference/car_axis.json"));
    let values = &reference["rederived"]["3.0"];
    let get = |key: &str| figure(&values[key]);
    let model = model(include_str!("benchmarks/car_axis.eng"), "CarAxis");
    let due = [
        ("xl", get("q1")),
        ("yl", get("q2")),
        ("xr", get("q3")),
        ("yr", get("q4")),
        ("vyr", get("v4")),
        ("ayr", get("a4")),
        ("axle_load", 2.0 * get("lam2").abs()),
        ("guide_load", get("lam1").abs()),
    ];
    converges(&model, 3.0, 15_000, &due, 5e-7);
}

#[test]
fn torsional_frequencies_of_a_six_cylinder_engine() {
    let reference = reference(include_str!("reference/torsion_six_cylinder.json"));
    let due = reference["natural_frequencies_Hz"]
        .as_array()
        .expect("a list");
    let program = program(include_str!("benchmarks/torsion.eng"));
    let outcome = program
        .analysis("modes")
        .expect("an analysis")
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error));
    let modes = outcome.modes.expect("modes");
    let found: Vec<f64> = modes
        .oscillations()
        .map(|mode| mode.value.im / std::f64::consts::TAU)
        .collect();
    // the first is the turning of the whole shaft
    assert_eq!(found.len() + 1, due.len());
    for (found, due) in found.iter().zip(&due[1..]) {
        let due = figure(due);
        assert!(
            (found / due - 1.0).abs() < 1e-9,
            "{found} Hz instead of {due} Hz"
        );
    }
}
