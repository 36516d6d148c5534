//! Radau IIA against closed forms, published digits and generalised-α.

use crate::support::{program, program_with_bar};
use eng::{Method, Model, Simulation};
use serde_json::Value;

/// A slider-crank that coasts, against gravity and a torsional spring and damper on its crank.
const COASTING: &str = include_str!("benchmarks/coasting.eng");
/// A flexible bar that flies freely, and one that turns on a pin.
const MOVING_BARS: &str = include_str!("mesh/moving_bars.eng");

fn model(text: &str, name: &str) -> Model {
    program(text)
        .model(name)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn values(model: &Model, simulation: &mut Simulation, channels: &[&str]) -> Vec<f64> {
    let channel = |path: &&str| model.channel(path).expect("a channel");
    let channels = channels.iter().map(channel);
    channels
        .map(|channel| simulation.value(channel).expect("a value"))
        .collect()
}

/// Channels at the end of a time (s), reached in equal steps or with a tolerance; and the number of steps.
fn at_the_end(
    model: &Model,
    end: f64,
    method: Method,
    control: eng::StepControl,
    channels: &[&str],
) -> (Vec<f64>, u64) {
    let mut simulation = model
        .simulation()
        .method(method)
        .stepping(control)
        .start()
        .unwrap_or_else(|error| panic!("{error}"));
    while simulation.time() < end {
        simulation
            .runtime()
            .step_within(end)
            .unwrap_or_else(|error| panic!("{error}"));
    }
    let steps = simulation.runtime().statistics().steps;
    (values(model, &mut simulation, channels), steps)
}

/// Positions, velocities and reactions of a closed loop have the fifth order.
#[test]
fn positions_velocities_and_reactions_converge_with_fifth_order() {
    use eng::StepControl::Fixed;
    const END: f64 = 5e-3;
    let channels = ["place", "speed", "wall"];
    let model = model(COASTING, "Coasting");
    let (exact, _) = at_the_end(&model, END, Method::Radau, Fixed(END / 640.0), &channels);
    // another method gives the same values
    let alpha = |steps: f64| {
        let control = Fixed(END / steps);
        at_the_end(&model, END, Method::default(), control, &channels).0
    };
    let (coarse, fine) = (alpha(6_000.0), alpha(12_000.0));
    for ((a, b), exact) in coarse.iter().zip(&fine).zip(&exact) {
        let extrapolated = (4.0 * b - a) / 3.0;
        let miss = (extrapolated / exact - 1.0).abs();
        assert!(miss < 2e-8, "{extrapolated} and not {exact}: {miss:.1e}");
    }
    // with forty steps the error of the place is rounding
    let errors: Vec<Vec<f64>> = [5.0, 10.0, 20.0]
        .map(|steps| {
            let control = Fixed(END / steps);
            let (found, _) = at_the_end(&model, END, Method::Radau, control, &channels);
            found
                .iter()
                .zip(&exact)
                .map(|(a, b)| (a - b).abs())
                .collect()
        })
        .into();
    for (i, name) in channels.iter().enumerate() {
        for pair in errors.windows(2) {
            let order = (pair[0][i] / pair[1][i]).log2();
            println!("{name}: error {:.2e}, order {order:.2}", pair[1][i]);
            assert!((4.5..5.8).contains(&order), "{name}: order {order:.2}");
        }
    }
}

fn reference(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// A number of a reference. Its digits are text, because a double holds fewer.
fn figure(value: &Value) -> f64 {
    value.as_str().expect("digits").parse().expect("a number")
}

/// The published digits at a tight tolerance, in far fewer steps than the second order needs.
#[test]
fn the_published_digits_are_met_in_few_steps() {
    let andrews = reference(include_str!("reference/andrews.json"));
    let values = &andrews["rederived"]["values"]["0.03"];
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
    let squeezer = model(include_str!("../examples/squeezer/squeezer.eng"), "Andrews");
    meets(&squeezer, 0.03, &due, 0.1, 1e-8);
    let axis = reference(include_str!("reference/car_axis.json"));
    let values = &axis["rederived"]["3.0"];
    let get = |key: &str| figure(&values[key]);
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
    let car = model(include_str!("benchmarks/car_axis.eng"), "CarAxis");
    meets(&car, 3.0, &due, 1e-2, 1e-8);
}

fn meets(model: &Model, end: f64, due: &[(&str, f64)], tolerance: f64, error: f64) {
    let channels: Vec<&str> = due.iter().map(|(path, _)| *path).collect();
    let control = eng::StepControl::Tolerance(tolerance);
    let (found, steps) = at_the_end(model, end, Method::Radau, control, &channels);
    println!("{steps} steps");
    // a rate near its zero is a small difference, so rates are compared with the largest of them
    let rates = due.iter().filter(|(path, _)| path.ends_with("_rate"));
    let fastest = rates.fold(0.0_f64, |most, (_, rate)| most.max(rate.abs()));
    for ((path, due), found) in due.iter().zip(found) {
        let size = match path.ends_with("_rate") {
            true => fastest,
            false => due.abs(),
        };
        let miss = (found - due).abs() / size;
        println!("{path}: {miss:.1e}");
        assert!(miss < error, "{path}: {found} instead of {due}: {miss:.1e}");
    }
}

/// A flexible bar on a turning pin, with a spring that follows its tip with a delay: a state, a flexible body and large rotations.
/// The method's fifth order is that of its tip, and generalised-α converges to the same motion.
#[test]
fn a_turning_flexible_bar_has_the_fifth_order() {
    use eng::StepControl::{Fixed, Tolerance};
    const END: f64 = 2e-3;
    let model = program_with_bar(MOVING_BARS)
        .model("Turning")
        .unwrap_or_else(|error| panic!("{error}"));
    let channels = ["across", "speed", "lag.load"];
    let (exact, _) = at_the_end(&model, END, Method::Radau, Fixed(END / 640.0), &channels);
    let alpha = |steps: f64| {
        let control = Fixed(END / steps);
        at_the_end(&model, END, Method::default(), control, &channels).0
    };
    let (coarse, fine) = (alpha(8_000.0), alpha(16_000.0));
    for ((a, b), exact) in coarse.iter().zip(&fine).zip(&exact) {
        let extrapolated = (4.0 * b - a) / 3.0;
        let miss = (extrapolated / exact - 1.0).abs();
        println!("generalised-α: {miss:.1e}");
        assert!(miss < 1e-6, "{extrapolated} and not {exact}: {miss:.1e}");
    }
    let (found, steps) = at_the_end(&model, END, Method::Radau, Tolerance(1e-2), &channels);
    for (found, exact) in found.iter().zip(&exact) {
        let miss = (found / exact - 1.0).abs();
        println!("{steps} steps: {miss:.1e}");
        assert!(miss < 1e-7, "{found} and not {exact}: {miss:.1e}");
    }
}

/// The tip of a free flexible bar, which tumbles and rings. The errors are shares of its largest coordinate.
#[test]
fn a_flying_flexible_bar_is_followed_to_1e_8() {
    use eng::StepControl::{Fixed, Tolerance};
    const END: f64 = 5e-3;
    let model = program_with_bar(MOVING_BARS)
        .model("Flying")
        .unwrap_or_else(|error| panic!("{error}"));
    let run = |method, control| {
        let channels = ["tip.x", "tip.y", "tip.z"];
        at_the_end(&model, END, method, control, &channels)
    };
    let (exact, _) = run(Method::Radau, Tolerance(1e-3));
    let size = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let alpha = |steps: f64| run(Method::default(), Fixed(END / steps)).0;
    let (coarse, fine) = (alpha(10_000.0), alpha(20_000.0));
    for ((a, b), exact) in coarse.iter().zip(&fine).zip(&exact) {
        let miss = ((4.0 * b - a) / 3.0 - exact).abs() / size;
        println!("generalised-α: {miss:.1e}");
        assert!(miss < 1e-8, "{miss:.1e}");
    }
    let (found, steps) = run(Method::Radau, Tolerance(1e-2));
    for (found, exact) in found.iter().zip(&exact) {
        let miss = (found - exact).abs() / size;
        println!("{steps} steps: {miss:.1e}");
        assert!(miss < 1e-8, "{found} and not {exact}: {miss:.1e}");
    }
}

/// The bits after a checkpoint are those of the run without it.
#[test]
fn a_checkpoint_changes_nothing() {
    let model = model(COASTING, "Coasting");
    let prepared = || model.simulation().method(Method::Radau).tolerance(1e-3);
    let mut whole = prepared().start().expect("a start");
    for _ in 0..40 {
        whole.step().expect("a step");
    }
    let mut first = prepared().start().expect("a start");
    for _ in 0..25 {
        first.step().expect("a step");
    }
    let mut second = prepared()
        .resume(&first.runtime().checkpoint())
        .expect("the same model");
    for _ in 0..15 {
        second.step().expect("a step");
    }
    assert_eq!(whole.runtime().state(), second.runtime().state());
}

/// The energy of the run is audited with the powers of the stages: work and energy agree far better than the steps of
/// generalised-α at the same tolerance.
#[test]
fn the_audit_of_energy_closes_to_the_order_of_the_method() {
    let model = model(COASTING, "Coasting");
    let mut simulation = model
        .simulation()
        .method(Method::Radau)
        .start()
        .expect("a start");
    let start = simulation.energy().kinetic;
    let mut miss = 0.0_f64;
    while simulation.time() < 0.04 {
        simulation.step().expect("a step");
        miss = miss.max(simulation.energy().imbalance().abs() / start);
    }
    println!("imbalance {miss:.2e} of the energy at the start");
    // generalised-α leaves 9.7e-6 at this tolerance
    assert!(miss < 4e-7, "{miss:.1e}");
}

/// A film would answer to the velocities that the stages leave.
#[test]
fn films_are_refused() {
    let text = "use std.journals.Impedance
    use std.joints.PointOnPlane
    model Rotor {
        gravity = [0, -9.81, 0] m/s^2
        marker shell = [0, 0, 0] mm
        body rotor { mass = 10 kg; inertia = [100, 100, 50] g*m^2; marker pin = origin; start angular_velocity = [0, 0, 300] rad/s }
        joint axial = PointOnPlane(rotor.pin, shell)
        journal film = Impedance(pin: rotor.pin, shell: shell, diameter: 50 mm, width: 20 mm, radial_clearance: 25 um, viscosity: 10 mPa*s)
    }
    analysis run = transient(Rotor(), duration: 1 ms, integrator: radau)";
    let message = crate::support::refused(&program(text), "run");
    assert!(message.contains("film is a film"), "{message}");
}

/// Arguments that belong to generalised-α are refused.
#[test]
fn arguments_of_the_other_method_are_refused() {
    for (arguments, message) in [
        ("step: 1 us", "chooses its steps by their error"),
        ("rho: 0.5", "has no spectral radius"),
        ("gradients: stiffness", "generalised-α alone"),
    ] {
        let text = format!(
            "{}\nanalysis run = transient(Coasting(), duration: 1 ms, integrator: radau, {arguments})",
            COASTING.replace(
                "model Coasting {",
                "model Coasting {\n    param stiffness: TorsionalStiffness = 60 N*m/rad"
            )
        );
        let checked = eng::check(&eng::Sources::from_text("m.eng", text), "m.eng");
        let report = checked
            .into_program()
            .expect_err("it is refused")
            .to_string();
        assert!(report.contains(message), "{report}");
    }
}
