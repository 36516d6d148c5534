//! Amplitude and phase over frequency.

use eng_report::figure::{Bode, BodeCurve, Ordinate};
use eng_report::internals::continued_phases;

/// The response of a mass on a spring with damping: 50 Hz, 5 %.
fn oscillator() -> Bode {
    let frequency: Vec<f64> = (0..=200)
        .map(|k| 10.0 * libm::pow(50.0, f64::from(k) / 200.0))
        .collect();
    let (mut amplitude, mut phase) = (Vec::new(), Vec::new());
    for f in &frequency {
        let r = f / 50.0;
        let (re, im) = (1.0 - r * r, 2.0 * 0.05 * r);
        amplitude.push(1.0 / libm::hypot(re, im));
        phase.push(-libm::atan2(im, re).to_degrees());
    }
    Bode {
        title: "Receptance".to_owned(),
        subtitle: "Test".to_owned(),
        ordinate: Ordinate {
            quantity: "Height".to_owned(),
            unit: "mm/N".to_owned(),
            frame: String::new(),
        },
        curves: vec![BodeCurve {
            name: "height".to_owned(),
            frequency,
            amplitude,
            phase,
        }],
    }
}

#[test]
fn amplitude_and_phase_share_the_frequencies() {
    insta::assert_snapshot!(oscillator().to_svg());
}

#[test]
fn phases_continue_over_half_turns() {
    assert_eq!(
        continued_phases(&[170.0, -170.0, -100.0, 100.0]),
        [170.0, 190.0, 260.0, 100.0]
    );
    assert_eq!(continued_phases(&[0.0, f64::NAN, -350.0])[2], 10.0);
}

#[test]
fn nothing_and_zero_are_drawn() {
    let mut figure = oscillator();
    figure.curves[0].amplitude[100] = 0.0;
    let svg = figure.to_svg();
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    figure.curves.clear();
    let svg = figure.to_svg();
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}
