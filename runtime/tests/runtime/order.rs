//! Observed order of positions, velocities and multipliers, with fixed and varying steps; error control.

use crate::mechanisms::*;
use eng_runtime::{Options, Simulation};
use eng_system::code::Compiled;
use eng_system::system::StepControl;

const END: f64 = 0.12;

/// Runs to [`END`] with `count` steps of a size that varies by up to `variation` around the mean, along a
/// smooth pattern.
fn run(compiled: &Compiled, count: usize, variation: f64) -> Simulation {
    let weights: Vec<f64> = (0..count)
        .map(|i| {
            1.0 + variation
                * if i % 3 == 0 {
                    1.0
                } else if i % 3 == 1 {
                    -0.7
                } else {
                    0.2
                }
        })
        .collect();
    let total: f64 = weights.iter().sum();
    let options = Options {
        step: StepControl::Fixed(1.0),
        newton_tolerance: Some(1e-13),
        ..Options::default()
    };
    let mut s = Simulation::new(compiled, &[], options).unwrap();
    let mut sum = 0.0;
    for w in &weights {
        sum += w;
        let end = if sum >= total * (1.0 - 1e-12) {
            END
        } else {
            END * sum / total
        };
        let report = s.step_within(end).unwrap();
        assert_eq!(report.time, end);
    }
    s
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
    a.iter()
        .zip(b)
        .fold(0.0_f64, |w, (a, b)| w.max((a - b).abs()))
        / size
}

fn check(compiled: &Compiled, counts: [usize; 2], variation: f64) {
    // Multipliers of the reference from the acceleration level: those of an index-3 step carry rounding over βh².
    let mut fine = run(compiled, counts[1] * 12, 0.0);
    let reference = fine.output_state().unwrap();
    let errors: Vec<[f64; 4]> = counts
        .iter()
        .map(|count| {
            let s = run(compiled, *count, variation);
            let s = s.state();
            [
                distance(&s.pose, &reference.pose),
                distance(&s.velocity, &reference.velocity),
                distance(&s.multipliers, &reference.multipliers),
                if s.states.is_empty() {
                    0.0
                } else {
                    distance(&s.states, &reference.states)
                },
            ]
        })
        .collect();
    let ratio = counts[1] as f64 / counts[0] as f64;
    for (k, name) in ["q", "v", "multipliers", "states"].iter().enumerate() {
        let (coarse, fine) = (errors[0][k], errors[1][k]);
        if coarse < 1e-11 {
            continue;
        }
        let order = (coarse / fine).ln() / ratio.ln();
        assert!(
            order > 1.9,
            "{name}: order {order}, errors {coarse:e} {fine:e}"
        );
    }
}

#[test]
fn second_order_on_a_spatial_chain() {
    check(&spatial_chain(), [60, 120], 0.0);
}

#[test]
fn second_order_on_a_spatial_chain_with_varying_steps() {
    check(&spatial_chain(), [60, 120], 0.4);
}

#[test]
fn second_order_on_a_driven_slider_crank() {
    let turn = Turn::Driven {
        start: 0.7,
        speed: 30.0,
    };
    let m = slider_crank(turn, [0.0, -9.81, 0.0], true);
    check(&m.compiled, [150, 300], 0.0);
    check(&m.compiled, [150, 300], 0.4);
}

#[test]
fn global_error_falls_with_the_tolerance() {
    let compiled = spatial_chain();
    let fine = run(&compiled, 3000, 0.0);
    let reference = fine.state();
    let mut before = f64::INFINITY;
    for factor in [100.0, 10.0, 1.0] {
        let options = Options {
            step: StepControl::Tolerance(factor),
            ..Options::default()
        };
        let mut s = Simulation::new(&compiled, &[], options).unwrap();
        while s.time() < END {
            s.step_within(END).unwrap();
        }
        assert_eq!(s.time(), END);
        let error = distance(&s.state().pose, &reference.pose);
        assert!(error < before / 2.5, "{factor}: {error:e} after {before:e}");
        before = error;
    }
    assert!(before < 1e-5, "{before}");
}
