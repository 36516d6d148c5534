//! The transform against the sum as it is written.

use eng_report::signal::fourier::{Complex, inverse, transform, transform_real};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// The sum as it is written.
fn slow(values: &[Complex]) -> Vec<Complex> {
    let length = values.len() as u64;
    (0..length)
        .map(|k| {
            values
                .iter()
                .enumerate()
                .fold(Complex::default(), |sum, (n, value)| {
                    let turn = (k * n as u64 % length) as f64 / length as f64;
                    let (sine, cosine) = libm::sincos(-TAU * turn);
                    Complex::new(
                        sum.re + value.re * cosine - value.im * sine,
                        sum.im + value.re * sine + value.im * cosine,
                    )
                })
        })
        .collect()
}

fn sample(length: usize) -> Vec<Complex> {
    (0..length)
        .map(|n| {
            let n = n as f64;
            Complex::new(libm::sin(n * 1.7 + 0.3), libm::cos(n * n * 0.01))
        })
        .collect()
}

#[test]
fn every_length_agrees_with_the_sum() {
    for length in (0..70).chain([97, 128, 180, 211, 251, 360, 720, 37 * 41]) {
        let values = sample(length);
        let (fast, slow) = (transform(&values), slow(&values));
        assert_eq!(fast.len(), slow.len());
        for (a, b) in fast.iter().zip(&slow) {
            let off = libm::hypot(a.re - b.re, a.im - b.im);
            assert!(off < 1e-11 * length as f64, "length {length}");
        }
    }
}

proptest! {
    #[test]
    fn the_inverse_gives_the_values_back(values in proptest::collection::vec(-1e3f64..1e3, 0..400)) {
        let back = inverse(&transform_real(&values));
        for (a, b) in values.iter().zip(&back) {
            prop_assert!((a - b.re).abs() < 1e-10 && b.im.abs() < 1e-10);
        }
    }

    #[test]
    fn parseval(values in proptest::collection::vec(-10.0f64..10.0, 1..500)) {
        let square: f64 = values.iter().map(|v| v * v).sum();
        let transformed: f64 = transform_real(&values).iter().map(|v| v.re * v.re + v.im * v.im).sum();
        prop_assert!((square - transformed / values.len() as f64).abs() <= 1e-11 * (1.0 + square));
    }
}
