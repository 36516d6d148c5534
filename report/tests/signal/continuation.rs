//! Signals continued beyond their ends.

use eng_report::internals::continuation::{Continued, GROWTH, continued, weight};
use std::f64::consts::TAU;

/// The prediction without its weight.
fn unfaded(found: &Continued, count: usize) -> Vec<f64> {
    let after = &found.values[found.before + count..];
    let width = (after.len() + 1) as f64;
    (0..count.min(after.len()) / 2)
        .map(|k| after[k] / weight((k + 1) as f64 / width))
        .collect()
}

#[test]
fn sinusoids_and_decays_go_on_as_they_are() {
    let law = |n: usize| {
        let t = n as f64;
        libm::sin(0.03374 * t + 0.3)
            + 0.3 * libm::cos(0.7757 * t + 1.0)
            + 2.0 * libm::exp(-0.004 * t) * libm::cos(0.2 * t)
    };
    for count in [300, 2000, 3001] {
        let values: Vec<f64> = (0..count).map(law).collect();
        let found = continued(&values, None);
        let after = unfaded(&found, count);
        assert!(after.len() == count / 2, "{}", after.len());
        for (k, value) in after.iter().enumerate() {
            assert!((value - law(count + k)).abs() < 1e-5, "{count}: {k}");
        }
        assert_eq!(&found.values[found.before..found.before + count], values);
    }
}

#[test]
fn a_periodic_pulse_comes_again() {
    let law = |n: usize| libm::exp(20.0 * (libm::cos(TAU * n as f64 / 300.0) - 1.0));
    let values: Vec<f64> = (0..2000).map(|n| law(n) - 0.1).collect();
    let after = unfaded(&continued(&values, None), 2000);
    for (k, value) in after.iter().enumerate() {
        assert!((value - law(2000 + k) + 0.1).abs() < 1e-5, "{k}");
    }
}

/// A cycle of any shape, that grows and has something else over it, which dies away.
#[test]
fn a_cycle_comes_again_with_its_change() {
    let law = |n: usize| {
        let t = n as f64;
        let pulse = f64::from(n % 500 > 250) + libm::fmod(t, 500.0) / 1000.0;
        pulse + 1e-5 * t + 0.2 * libm::exp(-0.002 * t) * libm::cos(0.05 * t)
    };
    let values: Vec<f64> = (0..1501).map(law).collect();
    let after = unfaded(&continued(&values, Some(500)), 1501);
    for (k, value) in after.iter().take(250).enumerate() {
        assert!((value - law(1501 + k)).abs() < 1e-4, "{k}: {value}");
    }
}

#[test]
fn what_dies_away_is_not_grown_backwards() {
    let law = |n: usize| {
        let t = n as f64;
        libm::sin(0.0337 * t + 0.3) + libm::exp(-0.02 * t) * libm::cos(0.2 * t)
    };
    let values: Vec<f64> = (0..2000).map(law).collect();
    let found = continued(&values, None);
    let size = values.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    assert_eq!(found.before, 8000);
    let before = &found.values[..found.before];
    let most = before.iter().fold(0.0f64, |m, x| m.max(x.abs())) / size;
    println!("before the signal: at most {most:.2} of its size");
    assert!(most < 2.0, "{most}");
    // no edge at the beginning
    let edge = (found.values[8000] - 2.0 * found.values[7999] + found.values[7998]).abs();
    assert!(edge < 0.1, "{edge}");
}

#[test]
fn anything_else_stays_of_its_size() {
    for count in [0, 1, 2, 3, 5, 6, 7, 50, 1000] {
        let zeros = vec![0.0; count];
        assert_eq!(continued(&zeros, None).values, zeros);
        // a chirp, and numbers without any law
        let chirp: Vec<f64> = (0..count)
            .map(|n| libm::sin(1e-4 * (n * n) as f64))
            .collect();
        let noise: Vec<f64> = (0..count)
            .map(|n| 1e200 * (libm::sin(1e4 * libm::sin(n as f64 + 0.5))))
            .collect();
        for values in [chirp, noise] {
            let size = values.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            for period in [None, Some(1), Some(count / 2), Some(count)] {
                let found = continued(&values, period);
                assert!(found.values.len() <= 9 * count && found.before <= 4 * count);
                let most = 1.000_001 * GROWTH * size;
                assert!(found.values.iter().all(|x| x.abs() <= most));
            }
        }
    }
}
