//! Filters of waves whose parts are known.

use eng_report::signal::{Band, Ends, Filter, Sampling, Signal, SignalError, Slope};
use std::f64::consts::TAU;

/// Both ends among the samples.
fn wave(n: usize, cycles: f64) -> Vec<f64> {
    (0..=n)
        .map(|i| libm::cos(TAU * cycles * i as f64 / n as f64 + 0.4))
        .collect()
}

#[test]
fn a_brick_wall_parts_two_waves_exactly() {
    let (low, high) = (wave(720, 4.0), wave(720, 30.0));
    let values: Vec<f64> = low.iter().zip(&high).map(|(a, b)| 2.0 + a + b).collect();
    // 720 samples over two revolutions: 4 cycles are order 2, 30 are order 15
    let signal = Signal {
        values: &values,
        sampling: Sampling::Angle { step: 1.0 },
    };
    let run = |band| {
        Filter {
            band,
            slope: Slope::BrickWall,
            ends: Ends::Periodic,
        }
        .apply(signal)
        .unwrap()
    };
    for (found, expected) in run(Band::Low { to: 2.2 }).iter().zip(&low) {
        assert!((found - 2.0 - expected).abs() < 1e-12);
    }
    for (found, expected) in run(Band::High { from: 14.9 }).iter().zip(&high) {
        assert!((found - expected).abs() < 1e-12);
    }
    // at a limit a line is half below and half above
    for (found, expected) in run(Band::Low { to: 2.0 }).iter().zip(&low) {
        assert!((found - 2.0 - expected / 2.0).abs() < 1e-12);
    }
    for (found, expected) in run(Band::High { from: 15.0 }).iter().zip(&high) {
        assert!((found - expected / 2.0).abs() < 1e-12);
    }
    let parts = [
        run(Band::Low { to: 2.0 }),
        run(Band::Between {
            from: 2.0,
            to: 15.0,
        }),
        run(Band::High { from: 15.0 }),
    ];
    for (n, value) in values.iter().enumerate() {
        let sum: f64 = parts.iter().filter_map(|part| part.get(n)).sum();
        assert!((sum - value).abs() < 1e-12);
    }
    for (found, expected) in run(Band::Between { from: 1.0, to: 3.0 }).iter().zip(&low) {
        assert!((found - expected).abs() < 1e-12);
    }
}

#[test]
fn butterworth_halves_at_the_limit_without_phase() {
    let values = wave(500, 20.0);
    let filter = Filter {
        band: Band::Low { to: 20.0 },
        slope: Slope::Butterworth { order: 4 },
        ends: Ends::Periodic,
    };
    let signal = Signal {
        values: &values,
        sampling: Sampling::Time { step: 0.002 },
    };
    for (found, value) in filter.apply(signal).unwrap().iter().zip(&values) {
        assert!((found - value / 2.0).abs() < 1e-12);
    }
}

/// The largest error of a filter, of the signal's size: anywhere, and in the middle half.
fn errors(filter: Filter, signal: &[f64], due: &[f64], step: f64) -> (f64, f64) {
    let found = filter
        .apply(Signal {
            values: signal,
            sampling: Sampling::Time { step },
        })
        .unwrap();
    assert_eq!(found.len(), due.len());
    let size = signal.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let off: Vec<f64> = found
        .iter()
        .zip(due)
        .map(|(a, b)| (a - b).abs() / size)
        .collect();
    let most = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
    let quarter = off.len() / 4;
    (most(&off), most(&off[quarter..3 * quarter]))
}

/// A drift from cycle to cycle does not ring at the ends.
#[test]
fn a_drift_of_a_cycle_is_a_line() {
    let low = wave(720, 4.0);
    let values: Vec<f64> = low
        .iter()
        .zip(wave(720, 50.0))
        .enumerate()
        .map(|(n, (a, b))| a + b + n as f64 / 720.0)
        .collect();
    let filter = |band| Filter {
        band,
        slope: Slope::BrickWall,
        ends: Ends::Periodic,
    };
    let due: Vec<f64> = low
        .iter()
        .enumerate()
        .map(|(n, a)| a + n as f64 / 720.0)
        .collect();
    assert!(errors(filter(Band::Low { to: 10.0 }), &values, &due, 1.0 / 720.0).0 < 1e-12);
    let due = wave(720, 50.0);
    assert!(
        errors(
            filter(Band::High { from: 10.0 }),
            &values,
            &due,
            1.0 / 720.0
        )
        .0 < 1e-12
    );
}

#[test]
fn ends_of_transients_are_as_good_as_the_middle() {
    let step = 1e-4;
    let of = |law: &dyn Fn(f64) -> f64| -> Vec<f64> {
        (0..2001).map(|n| law(f64::from(n) * step)).collect()
    };
    let slow =
        of(&|t| libm::sin(TAU * 53.7 * t + 0.3) + 0.4 * libm::cos(TAU * 121.3 * t) + 0.7 + 3.0 * t);
    let fast = of(&|t| 0.3 * libm::cos(TAU * 1234.5 * t + 1.0) + 0.2 * libm::sin(TAU * 777.7 * t));
    let both: Vec<f64> = slow.iter().zip(&fast).map(|(a, b)| a + b).collect();
    for slope in [Slope::BrickWall, Slope::Butterworth { order: 16 }] {
        let filter = |band| Filter {
            band,
            slope,
            ends: Ends::Continued { period: None },
        };
        for (band, due) in [
            (Band::Low { to: 350.0 }, &slow),
            (Band::High { from: 350.0 }, &fast),
            (
                Band::Between {
                    from: 350.0,
                    to: 2600.0,
                },
                &fast,
            ),
        ] {
            let (ends, middle) = errors(filter(band), &both, due, step);
            println!("{slope:?} {band:?}: {ends:.1e} {middle:.1e}");
            assert!(ends < 1e-4, "{slope:?} {band:?}: {ends:e}");
        }
    }
    // a start that dies away, and noise: away from the ends as good as anywhere
    let decay = of(&|t| 2.0 * libm::exp(-40.0 * t) * libm::cos(TAU * 330.0 * t));
    let both: Vec<f64> = decay
        .iter()
        .zip(of(&|t| libm::sin(TAU * 2000.3 * t)))
        .map(|(a, b)| a + b)
        .collect();
    let filter = Filter {
        band: Band::Low { to: 1000.0 },
        slope: Slope::BrickWall,
        ends: Ends::Continued { period: None },
    };
    let (ends, middle) = errors(filter, &both, &decay, step);
    println!("decay: {ends:.1e} {middle:.1e}");
    assert!(ends < 1e-2 && middle < 1e-4, "{ends:e} {middle:e}");
    let pulses = of(&|t| libm::exp(20.0 * (libm::cos(TAU * 33.37 * t) - 1.0)));
    let both: Vec<f64> = pulses
        .iter()
        .zip(of(&|t| 0.2 * libm::sin(TAU * 2000.3 * t)))
        .map(|(a, b)| a + b)
        .collect();
    let (ends, middle) = errors(filter, &both, &pulses, step);
    println!("pulses: {ends:.1e} {middle:.1e}");
    assert!(ends < 1e-4, "{ends:e} {middle:e}");
}

/// Many samples, whose law is that of a few.
#[test]
fn long_signals_are_continued_by_strides() {
    for noise in [0.0, 1e-9, 1e-6] {
        let values: Vec<f64> = (0..14_401)
            .map(|n| {
                let angle = f64::from(n).to_radians();
                libm::cos(4.0 * angle) + noise * libm::sin(1e5 * libm::sin(f64::from(n)))
            })
            .collect();
        let filter = Filter {
            band: Band::Between { from: 3.0, to: 5.0 },
            slope: Slope::BrickWall,
            ends: Ends::Continued { period: None },
        };
        let step = 1.0 / 360.0;
        let (ends, middle) = errors(filter, &values, &values, step);
        println!("noise {noise:e}: {ends:.1e} {middle:.1e}");
        assert!(ends < 1e-5 + 3.0 * noise, "{noise:e}: {ends:e} {middle:e}");
    }
}

#[test]
fn a_line_passes_or_is_stopped_whole() {
    let line: Vec<f64> = (0..200).map(|n| 3.0 - 0.1 * f64::from(n)).collect();
    for slope in [Slope::BrickWall, Slope::Butterworth { order: 2 }] {
        let filter = |band| Filter {
            band,
            slope,
            ends: Ends::Continued { period: None },
        };
        let low = errors(filter(Band::Low { to: 5.0 }), &line, &line, 0.01);
        let none = vec![0.0; 200];
        let high = errors(filter(Band::High { from: 5.0 }), &line, &none, 0.01);
        assert!(low.0 < 1e-13 && high.0 < 1e-13, "{low:?} {high:?}");
    }
}

/// A line at the limit of a transient: half of it passes in the middle, and the parts below and above add
/// up everywhere.
#[test]
fn a_line_at_the_limit_of_a_transient_is_halved() {
    let step = 1e-3;
    for frequency in [20.0, 23.7] {
        let values: Vec<f64> = (0..1001)
            .map(|n| libm::cos(TAU * frequency * f64::from(n) * step + 0.4))
            .collect();
        let run = |band| {
            let filter = Filter {
                band,
                slope: Slope::BrickWall,
                ends: Ends::Continued { period: None },
            };
            let signal = Signal {
                values: &values,
                sampling: Sampling::Time { step },
            };
            filter.apply(signal).unwrap()
        };
        let low = run(Band::Low { to: frequency });
        let high = run(Band::High { from: frequency });
        let root = |values: &[f64]| {
            (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
        };
        for (n, value) in values.iter().enumerate() {
            assert!((low[n] + high[n] - value).abs() < 1e-9, "{n}");
        }
        let whole = root(&values);
        println!(
            "{frequency} Hz: gains {:.4} and {:.4}",
            root(&low) / whole,
            root(&high) / whole
        );
        for part in [low, high] {
            let middle = root(&part[400..600]) / root(&values[400..600]);
            println!("  in the middle {middle:.4}");
            assert!((root(&part) / whole - 0.5).abs() < 0.02);
            assert!((middle - 0.5).abs() < 0.02);
        }
    }
}

#[test]
fn faults_are_named() {
    let signal = Signal {
        values: &[0.0, 1.0, 0.0],
        sampling: Sampling::Time { step: 1.0 },
    };
    let filter = Filter {
        band: Band::Between { from: 3.0, to: 2.0 },
        slope: Slope::BrickWall,
        ends: Ends::Periodic,
    };
    assert!(matches!(
        filter.apply(signal),
        Err(SignalError::Setting { .. })
    ));
}
