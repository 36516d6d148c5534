//! Differences of successive cycles and their decay.

use eng_runtime::internals::repetition::{Comparison, Growth, Verdict, thinned, within};
use eng_system::dimension::Dimension;
use std::f64::consts::PI;

const SAMPLES: usize = 48;

/// Cycles of one channel and a counter, made of the periodic part and decaying modes.
fn verdicts(cycles: usize, sample: impl Fn(usize, f64) -> f64) -> Vec<Verdict> {
    let mut comparison = Comparison::of(vec![Dimension::ONE, Dimension::TIME], 1e-3);
    (0..cycles)
        .map(|k| {
            let mut values = Vec::new();
            for i in 0..SAMPLES {
                let t = (i as f64 + 1.0) / SAMPLES as f64;
                values.push(sample(k, t));
                values.push(k as f64 + t);
            }
            comparison.next(&values)
        })
        .collect()
}

#[test]
fn finds_the_factor_of_one_mode() {
    let periodic = |t: f64| libm::sin(2.0 * PI * t);
    let found = verdicts(6, |k, t| periodic(t) + libm::pow(0.6, k as f64 + t) * 0.1);
    assert_eq!(found[0], Verdict::default());
    let last = found[5].slowest.clone().unwrap();
    assert_eq!(last.channel, 0);
    assert!((last.mode.unwrap().factor - 0.6).abs() < 1e-9, "{last:?}");
    assert_eq!(last.mode.unwrap().turn, 0.0);
    // the remaining distance is the sum of all later differences
    let left = 0.1 * libm::pow(0.6, 5.0);
    assert!(
        (last.distance() * 2.0 - left).abs() < 0.05 * left,
        "{last:?} {left}"
    );
    assert_eq!(
        found[5].growing,
        vec![Growth {
            channel: 1,
            by: 1.0
        }]
    );
}

#[test]
fn finds_a_turning_mode_beside_a_faster_one() {
    // the slow pair: 0.7 a cycle, turning by 2 rad a cycle
    let found = verdicts(12, |k, t| {
        let x = k as f64 + t;
        libm::cos(2.0 * PI * t)
            + 0.3 * libm::pow(0.7, x) * libm::cos(2.0 * x)
            + 0.2 * libm::pow(0.1, x)
    });
    let last = found[11].slowest.clone().unwrap();
    assert!((last.mode.unwrap().factor - 0.7).abs() < 1e-6, "{last:?}");
    assert!((last.mode.unwrap().turn - 2.0).abs() < 1e-6, "{last:?}");
}

#[test]
fn a_sustained_beat_does_not_repeat() {
    let found = verdicts(12, |k, t| {
        libm::cos(2.0 * PI * t) + 0.05 * libm::cos(2.0 * PI * 0.93 * (k as f64 + t))
    });
    let last = found[11].slowest.clone().unwrap();
    // 0.05 of a swing of 2.1
    assert!((last.mode.unwrap().factor - 1.0).abs() < 1e-9, "{last:?}");
    assert!((0.02..0.03).contains(&last.distance()), "{last:?}");
    assert!(
        (last.mode.unwrap().turn - 2.0 * PI * 0.07).abs() < 1e-6,
        "{last:?}"
    );
}

#[test]
fn a_decay_shows_within_a_difference() {
    let decays = |factor: f64| {
        let difference: Vec<f64> = (0..2 * SAMPLES)
            .map(|i| libm::pow(factor, (i / 2) as f64 / SAMPLES as f64))
            .collect();
        within(&difference, 2)
    };
    // fifteen sixteenths of a cycle lie between both parts
    for factor in [1e-3, 0.5, 0.9, 1.2] {
        let due = libm::pow(factor, 15.0 / 16.0);
        let found = decays(factor).unwrap();
        assert!((found / due - 1.0).abs() < 1e-12, "{found} {due}");
    }
    assert_eq!(within(&[0.0; SAMPLES], 1), None);
    assert_eq!(within(&[], 1), None);
}

#[test]
fn a_cycle_with_more_samples_is_compared_at_those_of_the_one_before() {
    let cycle = |samples: usize, more: f64| -> Vec<f64> {
        let at = |i: usize| (i as f64 + 1.0) / samples as f64;
        (0..samples)
            .map(|i| libm::sin(2.0 * PI * at(i)) + more * at(i))
            .collect()
    };
    let mut comparison = Comparison::of(vec![Dimension::ONE], 1e-3);
    assert_eq!(comparison.next(&cycle(12, 0.0)), Verdict::default());
    let found = comparison.next(&cycle(SAMPLES, 0.1)).slowest.unwrap();
    // of swings of 1.95 and 1.925
    assert!((found.change * 1.95 - 0.1).abs() < 2e-3, "{found:?}");
    assert_eq!(found.mode, None);
    // half of the difference, at all samples now
    let found = comparison.next(&cycle(SAMPLES, 0.15)).slowest.unwrap();
    assert!((found.change * 1.925 - 0.05).abs() < 2e-3, "{found:?}");
    let mode = found.mode.unwrap();
    assert!((mode.factor - 0.5).abs() < 1e-9, "{mode:?}");
    // twelve samples are no part of twenty
    assert_eq!(thinned(&[0.0; 20], 1, 12), None);
}

#[test]
fn a_difference_at_one_sample_predicts_nothing() {
    // a peak whose height differs at random from cycle to cycle
    let height = [0.1, 0.3, 0.15, 0.28, 0.12, 0.31, 0.22, 0.17];
    let found = verdicts(8, |k, t| {
        libm::cos(2.0 * PI * t)
            + if (t - 0.5).abs() < 1e-9 {
                height[k]
            } else {
                0.0
            }
    });
    for verdict in &found[3..] {
        assert_eq!(
            verdict.slowest.clone().unwrap().mode.unwrap().unpredicted,
            1.0
        );
    }
}
