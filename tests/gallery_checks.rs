//! Examples of the gallery against closed forms, linear equations and an independent integrator.

use crate::library_run::{close, column, integral, run};
use std::f64::consts::PI;

/// The start of the fan: time and heat against quadratures of inertia over torque, with Kloss' torque and a rigid belt. At the breakdown
/// torque the two spans differ by the torque that fan and wheel take.
#[test]
fn a_fan_starts_in_the_time_of_its_quadrature() {
    let text = include_str!("../examples/start_up/start_up.eng");
    let (field, inertia) = (50.0 * PI, 0.08 + 4.0 / 2.25);
    let load = |speed: f64| 76.0 * (speed / field).powi(2);
    for (analysis, connection) in [("direct", 1.0), ("star", 1.0 / 3.0)] {
        let motor = |speed: f64| {
            let slip = (1.0 - speed / field) / 0.15;
            500.0 * connection / (slip + 1.0 / slip)
        };
        let results = run(text, analysis);
        let time = column(&results, "time");
        let speed = column(&results, "motor_bearing.speed");
        let behind = speed.iter().position(|speed| *speed > 44.0 * PI);
        let end = behind.expect("a start") - 1;
        let speeds: Vec<f64> = (0..=4000)
            .map(|i| speed[end] * f64::from(i) / 4000.0)
            .collect();
        let times = speeds.iter().map(|s| inertia / (motor(*s) - load(*s)));
        let times: Vec<f64> = times.collect();
        close("time", time[end], integral(&speeds, &times), 5e-5);
        let heats = speeds.iter().zip(&times);
        let heats: Vec<f64> = heats.map(|(s, t)| t * motor(*s) * (field - s)).collect();
        let heat = integral(&time[..=end], &column(&results, "slip_heat")[..=end]);
        close("heat", heat, integral(&speeds, &heats), 5e-4);
        let torque = column(&results, "motor.torque");
        let at = (0..torque.len()).max_by(|a, b| torque[*a].total_cmp(&torque[*b]));
        let at = at.expect("samples");
        let due = torque[at] - 0.08 * (torque[at] - load(speed[at])) / inertia;
        let spans = [
            column(&results, "tight.load")[at],
            column(&results, "slack.load")[at],
        ];
        close("belt", (spans[0] - spans[1]) * 0.1, due, 1e-3);
    }
}
