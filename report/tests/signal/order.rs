//! Amplitudes of orders over speed.

use eng_report::signal::{
    Run, RunUp, Sampling, Signal, Window, component, order_track, order_track_of_run_up,
};
use std::f64::consts::TAU;

#[test]
fn orders_of_steady_runs_are_exact() {
    let step = 1.0 / 7200.0;
    let make = |speed: f64, amplitude: f64| -> Vec<f64> {
        // whole revolutions
        let samples = (60.0 / speed * 8.0 / step).round() as usize;
        (0..samples)
            .map(|n| {
                let turns = speed / 60.0 * n as f64 * step;
                amplitude * libm::cos(TAU * 2.0 * turns + 0.5) + libm::sin(TAU * 0.5 * turns)
            })
            .collect()
    };
    let (slow, fast) = (make(1200.0, 3.0), make(2400.0, 5.0));
    let runs = [(1200.0, &slow), (2400.0, &fast)].map(|(speed, values)| Run {
        speed,
        signal: Signal {
            values,
            sampling: Sampling::Time { step },
        },
    });
    let track = order_track(&runs, &[0.5, 2.0], Window::Rectangular).unwrap();
    assert!((track.components[1][0].amplitude - 3.0).abs() < 1e-10);
    assert!((track.components[1][1].amplitude - 5.0).abs() < 1e-10);
    assert!((track.components[1][0].phase - 0.5f64.to_degrees()).abs() < 1e-9);
    assert!((track.components[0][1].amplitude - 1.0).abs() < 1e-10);
}

#[test]
fn a_run_up_follows_the_amplitude() {
    let samples = 360 * 40;
    let angle = |n: usize| n as f64;
    let speeds: Vec<f64> = (0..samples).map(|n| 1000.0 + n as f64 * 0.1).collect();
    let values: Vec<f64> = (0..samples)
        .map(|n| speeds[n] * 1e-3 * libm::cos(2.0 * angle(n).to_radians()))
        .collect();
    let run = RunUp {
        values: &values,
        speeds: &speeds,
        step: 1.0,
        revolutions: 4.0,
        overlap: 0.5,
    };
    let track = order_track_of_run_up(run, &[2.0], Window::Hann).unwrap();
    assert_eq!(track.speeds.len(), 19);
    for (speed, component) in track.speeds.iter().zip(&track.components[0]) {
        // the amplitude changes within a block: the window's mean and the block's differ by half a sample
        assert!((component.amplitude - speed * 1e-3).abs() < 1e-3);
    }
}

#[test]
fn beyond_nyquist_is_refused() {
    assert!(component(&[0.0; 8], 0.6, Window::Hann).is_err());
    assert!(component(&[0.0; 8], f64::NAN, Window::Hann).is_err());
}
