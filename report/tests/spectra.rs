//! Spectra of signals whose amplitudes are known.

use eng_report::signal::{
    Amplitude, Averaging, Axis, Sampling, Signal, SignalError, SpectrumOptions, Window, rms,
    spectrum,
};
use proptest::prelude::*;
use std::f64::consts::TAU;

const WINDOWS: [Window; 4] = [
    Window::Rectangular,
    Window::Hann,
    Window::FlatTop,
    Window::BlackmanHarris,
];

fn timed(values: &[f64], step: f64) -> Signal<'_> {
    Signal {
        values,
        sampling: Sampling::Time { step },
    }
}

fn options(window: Window) -> SpectrumOptions {
    SpectrumOptions {
        window,
        ..SpectrumOptions::default()
    }
}

/// Sum of amplitude·cos(2π·cycles·n/N + phase).
fn waves(samples: usize, parts: &[(f64, f64, f64)]) -> Vec<f64> {
    (0..samples)
        .map(|n| {
            parts
                .iter()
                .map(|(amplitude, cycles, phase)| {
                    amplitude * libm::cos(TAU * cycles * n as f64 / samples as f64 + phase)
                })
                .sum()
        })
        .collect()
}

#[test]
fn amplitudes_at_bin_centres_are_exact_for_every_window_and_length() {
    // powers of two, engine cycles, odd lengths, primes (by convolution)
    for samples in [256usize, 720, 999, 1009, 7199, 2 * 1009] {
        let values = waves(
            samples,
            &[(12.5, 20.0, 0.3), (0.04, 60.0, -1.0), (3.0, 0.0, 0.0)],
        );
        for window in WINDOWS {
            let found = spectrum(timed(&values, 1e-3), options(window)).unwrap();
            let line = |k: usize| found.amplitudes[k];
            assert!((line(20) - 12.5).abs() < 1e-10, "{samples} {window:?}");
            assert!((line(60) - 0.04).abs() < 1e-10, "{samples} {window:?}");
            assert!((line(0) - 3.0).abs() < 1e-10, "{samples} {window:?}");
            assert!(line(40) < 1e-10, "{samples} {window:?}");
        }
    }
}

#[test]
fn the_lines_at_zero_and_nyquist_have_no_mirror_image() {
    let values: Vec<f64> = (0..128)
        .map(|n| 2.0 + if n % 2 == 0 { 0.75 } else { -0.75 })
        .collect();
    let found = spectrum(timed(&values, 0.01), options(Window::Rectangular)).unwrap();
    assert_eq!(found.amplitudes.len(), 65);
    assert!((found.amplitudes[0] - 2.0).abs() < 1e-12);
    assert!((found.amplitudes[64] - 0.75).abs() < 1e-12);
    assert!((found.positions()[64] - 50.0).abs() < 1e-12);
    // an odd length has no line at the Nyquist frequency
    let odd = waves(127, &[(1.5, 63.0, 0.2)]);
    let found = spectrum(timed(&odd, 0.01), options(Window::Rectangular)).unwrap();
    assert_eq!(found.amplitudes.len(), 64);
    assert!((found.amplitudes[63] - 1.5).abs() < 1e-10);
}

#[test]
fn between_bins_windows_lose_what_is_published() {
    // Harris (1978), table 1; the flat top's loss is its very point
    for (window, least, most) in [
        (Window::Rectangular, 3.90, 3.95),
        (Window::Hann, 1.41, 1.44),
        (Window::BlackmanHarris, 0.81, 0.85),
        (Window::FlatTop, -0.01, 0.01),
    ] {
        let values = waves(2048, &[(1.0, 300.5, 0.7)]);
        let found = spectrum(timed(&values, 1e-3), options(window)).unwrap();
        let loss = -20.0 * libm::log10(found.amplitudes[300].max(found.amplitudes[301]));
        assert!((least..=most).contains(&loss), "{window:?}: {loss} dB");
    }
    // the flat top stays within 0.01 dB wherever the frequency lies
    for part in 0..=20 {
        let values = waves(2048, &[(1.0, 300.0 + 0.05 * f64::from(part), 0.7)]);
        let found = spectrum(timed(&values, 1e-3), options(Window::FlatTop)).unwrap();
        let top = found.amplitudes.iter().copied().fold(0.0, f64::max);
        assert!(20.0 * libm::log10(top).abs() < 0.01, "{part}: {top}");
    }
}

#[test]
fn blocks_overlap_and_are_averaged_as_stated() {
    // amplitude 1 in the first half, 3 in the second
    let values: Vec<f64> = (0..2000)
        .map(|n| {
            let amplitude = if n < 1000 { 1.0 } else { 3.0 };
            amplitude * libm::cos(TAU * 0.05 * f64::from(n))
        })
        .collect();
    let with = |averaging, overlap| {
        spectrum(
            timed(&values, 1e-3),
            SpectrumOptions {
                window: Window::Rectangular,
                block_length: Some(1000),
                overlap,
                averaging,
                ..SpectrumOptions::default()
            },
        )
        .unwrap()
    };
    let linear = with(Averaging::Linear, 0.0);
    assert_eq!((linear.blocks, linear.block_length), (2, 1000));
    assert!((linear.step - 1.0).abs() < 1e-15);
    assert!((linear.amplitudes[50] - 2.0).abs() < 1e-10);
    assert!((with(Averaging::RootMeanSquare, 0.0).amplitudes[50] - 5f64.sqrt()).abs() < 1e-10);
    assert!((with(Averaging::Peak, 0.0).amplitudes[50] - 3.0).abs() < 1e-10);
    let overlapped = with(Averaging::Linear, 0.5);
    assert_eq!(overlapped.blocks, 3);
    assert!((overlapped.amplitudes[50] - 2.0).abs() < 1e-10);
    assert_eq!(
        overlapped.description(),
        "linear spectrum, 0-peak; rectangular window, resolution 1.0000 Hz, noise bandwidth 1.0000 Hz; mean of 3 blocks of 1000 samples, overlap 50 %"
    );
}

#[test]
fn orders_by_speed_and_by_angle_are_the_same() {
    // order 2 at 4000/min: 133.33 Hz, sampled over 6 revolutions in 2160 samples
    let values = waves(2160, &[(8.0, 12.0, 0.1)]);
    let step = 6.0 * 60.0 / 4000.0 / 2160.0;
    let by_speed = spectrum(timed(&values, step), options(Window::Hann))
        .unwrap()
        .in_orders(4000.0)
        .unwrap();
    let by_angle = spectrum(
        Signal {
            values: &values,
            sampling: Sampling::Angle { step: 1.0 },
        },
        options(Window::Hann),
    )
    .unwrap();
    for found in [by_speed, by_angle] {
        assert_eq!(found.axis, Axis::Order);
        assert!((found.step - 1.0 / 6.0).abs() < 1e-14);
        let top = found.peaks(1)[0];
        assert!((top.position - 2.0).abs() < 1e-12 && (top.amplitude - 8.0).abs() < 1e-10);
        assert!(found.nearest(2.04).is_some_and(|line| line == top));
        assert_eq!(found.nearest(-1.0), None);
    }
}

#[test]
fn rms_amplitudes_and_removed_means() {
    let values = waves(400, &[(2.0, 20.0, 0.0), (5.0, 0.0, 0.0)]);
    let found = spectrum(
        timed(&values, 1e-3),
        SpectrumOptions {
            amplitude: Amplitude::RootMeanSquare,
            remove_mean: true,
            ..SpectrumOptions::default()
        },
    )
    .unwrap();
    assert!((found.amplitudes[20] - 2f64.sqrt()).abs() < 1e-10);
    assert!(found.amplitudes[0] < 1e-12);
    // Hann spreads a wave over three lines; the noise bandwidth puts them together again
    let squares: f64 = found.amplitudes[12..=28].iter().map(|a| a * a).sum();
    let wave = (squares * found.step / found.noise_bandwidth()).sqrt();
    assert!((wave - 2f64.sqrt()).abs() < 1e-10);
}

#[test]
fn faults_are_named() {
    assert!(matches!(
        spectrum(timed(&[1.0], 1.0), SpectrumOptions::default()),
        Err(SignalError::TooShort { .. })
    ));
    assert!(matches!(
        spectrum(
            timed(&[1.0, f64::INFINITY], 1.0),
            SpectrumOptions::default()
        ),
        Err(SignalError::NotFinite { index: 1, .. })
    ));
    assert!(matches!(
        spectrum(timed(&[1.0, 2.0], 0.0), SpectrumOptions::default()),
        Err(SignalError::Setting { .. })
    ));
    let wrong = SpectrumOptions {
        overlap: 1.0,
        ..SpectrumOptions::default()
    };
    assert!(spectrum(timed(&[1.0, 2.0], 1.0), wrong).is_err());
}

proptest! {
    #[test]
    fn parseval(values in proptest::collection::vec(-100.0f64..100.0, 2..600)) {
        let found = spectrum(timed(&values, 1e-3), options(Window::Rectangular)).unwrap();
        let expected = rms(&values).unwrap();
        // the lines at 0 and, of an even number of samples, at the Nyquist frequency stand for one wave, all
        // others for two
        let last = values.len() / 2;
        let alone = |k: usize| k == 0 || 2 * k == values.len();
        let square = |(k, a): (usize, &f64)| if alone(k) { a * a } else { a * a / 2.0 };
        prop_assert_eq!(found.amplitudes.len(), last + 1);
        let all = found.amplitudes.iter().enumerate().map(square).sum::<f64>().sqrt();
        prop_assert!((all - expected).abs() <= 1e-11 * (1.0 + expected));
    }
}
