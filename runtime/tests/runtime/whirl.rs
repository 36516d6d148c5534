//! Whirl of journals in successive cycles.

use eng_runtime::internals::whirl::{Orbits, find};
use std::f64::consts::PI;

fn cycles(period: f64, sense: f64, count: usize, e: impl Fn(f64) -> [f64; 2]) -> Vec<Orbits> {
    let samples = 180;
    (0..count)
        .map(|k| {
            let angles: Vec<f64> = (1..=samples)
                .map(|i| sense * period * (k as f64 + i as f64 / samples as f64))
                .collect();
            Orbits {
                eccentricities: angles.iter().map(|a| vec![e(*a)]).collect(),
                forward: sense > 0.0,
                angles,
            }
        })
        .collect()
}

#[test]
fn finds_order_and_radius_beside_the_repeating_orbit() {
    for (period, sense) in [(4.0 * PI, 1.0), (4.0 * PI, -1.0), (2.0 * PI, 1.0)] {
        let order = 0.47;
        let found = find(
            &cycles(period, sense, 8, |a| {
                // a repeating orbit far larger than the whirl
                let b = 2.0 * PI * a / period;
                [
                    10.0 * libm::cos(b) + 3.0 + 0.2 * libm::cos(order * a),
                    8.0 * libm::sin(2.0 * b) + 0.2 * libm::sin(order * a),
                ]
            }),
            period,
        );
        assert_eq!(found.len(), 1);
        let whirl = found[0];
        assert!((whirl.order - order).abs() < 0.02, "{whirl:?}");
        assert!((0.12..0.22).contains(&whirl.radius), "{whirl:?}");
        assert!(whirl.is_sustained(), "{whirl:?}");
    }
}

#[test]
fn what_repeats_is_no_whirl() {
    let found = find(
        &cycles(4.0 * PI, 1.0, 6, |a| {
            [libm::cos(0.5 * a), libm::sin(0.5 * a)]
        }),
        4.0 * PI,
    );
    assert!(found.iter().all(|w| w.radius < 1e-12), "{found:?}");
    assert!(find(&cycles(4.0 * PI, 1.0, 3, |_| [1.0, 0.0]), 4.0 * PI).is_empty());
}
