//! States of elements that are zero at first and change later: their scale, and the messages about a missing one.

use crate::support::program;

/// A pendulum with a state beside it. `state` is the state's line, `rate` its rate.
fn text(parameter: &str, state: &str, rate: &str) -> String {
    format!(
        "
use std.joints.Revolute
force Lag(a: Marker, b: Marker{parameter}) {{
    {state}
    der(z) = {rate}
    apply torque 0 N*m*b.z on a against b
    output level = z as mm
}}
model Swing {{
    gravity = [0, -9.81, 0] m/s^2
    body bob {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker top = [0, 0.4, 0] m }}
    marker pivot = [0, 0.4, 0] m
    joint pin = Revolute(bob.top, pivot)
    force lag = Lag(bob.top, pivot)
    start pin.angle = 20 deg
}}
analysis swing = transient(Swing(), duration: 0.2 s, sample: 1 ms)
"
    )
}

/// The message of a run that fails.
fn failure(text: &str) -> String {
    let program = program(text);
    let analysis = program.analysis("swing").expect("an analysis");
    match analysis.run(&mut |_| {}) {
        Ok(_) => panic!("it runs"),
        Err(failed) => format!("{}", failed.error),
    }
}

/// `ż = max(t − 50 ms, 0) 1 m/s²`: z is zero, then it is the parabola `½ (t − 50 ms)² 1 m/s²`, up to 11.25 mm.
#[test]
fn a_state_that_sleeps_wakes() {
    let wakes = "max(time - 0.05 s, 0 s)*1 m/s^2";
    for state in [
        "state z: Length = 0 mm scale 0.1 mm",
        "state z: Length = 0 mm scale size/10",
        "state z: Length = 0 mm scale 1 m",
    ] {
        let outcome = program(&text(", size: Length = 1 mm", state, wakes))
            .analysis("swing")
            .expect("an analysis")
            .run(&mut |_| {})
            .unwrap_or_else(|failed| panic!("{state}: {}", failed.error));
        let levels = outcome
            .results
            .column("lag.level")
            .expect("a column")
            .shown();
        let times = outcome.results.column("time").expect("times").shown();
        let worst = times
            .iter()
            .zip(&levels)
            .map(|(t, found)| {
                let awake = (t - 0.05).max(0.0);
                (found - 500.0 * awake * awake).abs()
            })
            .fold(0.0, f64::max);
        println!(
            "{state}: {worst:.2e} mm, {} steps",
            outcome.summary.expect("a summary").statistics.steps
        );
        // the scheme is of second order: only the step over the kink misses the parabola
        assert!(worst < 1e-3, "{state}: {worst} mm of 11.25");
    }
}

#[test]
fn a_zero_that_parameters_make_is_told_when_they_are_set() {
    let steady = "1 mm/s";
    for (parameter, state, says) in [
        (
            ", begin: Length = 0 mm",
            "state z: Length = begin",
            "the state `z` starts at zero and has no scale",
        ),
        (
            ", size: Length = 0 mm",
            "state z: Length = 1 mm scale size",
            "the scale of the state `z` must be positive",
        ),
    ] {
        let text = text(parameter, state, steady);
        let told = failure(&text);
        assert!(told.contains(says) && told.contains("lag"), "{told}");
        // another value of the parameter, and it runs
        let name = if parameter.contains("begin") {
            "lag.begin"
        } else {
            "lag.size"
        };
        let program = program(&text);
        let analysis = program.analysis("swing").expect("an analysis");
        let parameter = analysis.parameter(name).expect("a parameter");
        analysis
            .set(parameter, "2 mm".parse().expect("a length"))
            .expect("it fits")
            .run(&mut |_| {})
            .unwrap_or_else(|failed| panic!("{}", failed.error));
    }
}

/// `ż = z²/(1 mm · 0.1 s)` from 1 mm is `1 mm/(1 − t/0.1 s)`: it is infinite at 0.1 s.
#[test]
fn a_state_that_asks_for_too_small_steps_is_named() {
    let told = failure(&text("", "state z: Length = 1 mm", "z*z/(1 mm)/(0.1 s)"));
    assert!(
        told.contains("the state `z` is not smooth there: lag") && told.contains("t = 0.0999"),
        "{told}"
    );
}

/// A piston falls and draws gas through a valve, whose flow `√Δp` has an infinite slope where it begins. The gas does
/// not push, so that the piston falls as `v = g t`; the flow through the valve is the rate of the stroke's volume less
/// the expansion of the gas, `A v + V ṗ/(n p)`.
#[test]
fn a_flow_that_begins_with_an_infinite_slope_is_solved() {
    let text = "
use std.joints.Translational
force Cylinder(piston: Marker, head: Marker) {
    let travel = dot(piston.origin - head.origin, head.x)
    let volume = 50 cm^2*(2 mm + travel)
    state p: AbsolutePressure = 1 bar
    let fall = 1 bar - p
    let into = if fall > 0 Pa then 600 mm^2*sqrt(2*fall/(1.2 kg/m^3)) else 0 m^3/s
    der(p) = 1.3*(p - 0 Pa)/volume*(into - der(volume))
    apply force 0 N*head.x on piston against head
    output flow = into as cm^3/s
}
model Suction {
    gravity = [9.81, 0, 0] m/s^2
    body piston { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker crown = at(origin, z: [1, 0, 0]) }
    marker line = at(origin, z: [1, 0, 0])
    marker seat = origin
    joint liner = Translational(piston.crown, line)
    force gas = Cylinder(piston.crown, seat)
}
analysis fill = transient(Suction(), duration: 0.1 s, sample: 1 ms)
";
    let outcome = program(text)
        .analysis("fill")
        .expect("an analysis")
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error));
    let flows = outcome
        .results
        .column("gas.flow")
        .expect("a column")
        .shown();
    let times = outcome.results.column("time").expect("times").shown();
    // before, the fall of pressure is within the error that the state may have
    for (t, flow) in times.iter().zip(&flows).filter(|(t, _)| **t > 0.04) {
        let stroke = 50e-4 * 9.81 * t;
        let volume = 50e-4 * (2e-3 + 0.5 * 9.81 * t * t);
        // Δp = ½ρ (stroke/area)² grows with t², so that ṗ = -2 Δp/t
        let fall = 0.6 * (stroke / 600e-6_f64).powi(2);
        let thinned = volume * 2.0 * fall / t / (1.3 * (1e5 - fall));
        let expected = 1e6 * (stroke - thinned);
        assert!(
            (flow - expected).abs() < 1e-5 * 4905.0,
            "{t} s: {flow}, expected {expected} cm³/s"
        );
    }
    let steps = outcome.summary.expect("a summary").statistics.steps;
    assert!(steps < 500, "{steps} steps for 100 samples");
}
