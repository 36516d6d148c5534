//! Small motions about a motion that repeats.

use eng_runtime::internals::floquet::{Stage, exponential, multipliers, radau, step, transform};
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::{PI, TAU};

/// A motion of one harmonic has only its own place different from zero.
#[test]
fn one_harmonic_is_found() {
    let n = 64_i32;
    for k in [-31_i32, -5, 0, 7, 31] {
        let mut values: Vec<Complex<f64>> = (0..n)
            .map(|j| exponential(Complex::new(0.0, TAU * f64::from(k * j) / f64::from(n))))
            .collect();
        transform(&mut values);
        for (place, c) in values.iter().enumerate() {
            let due = if place as i32 == k.rem_euclid(n) {
                64.0
            } else {
                0.0
            };
            assert!(
                (c - Complex::new(due, 0.0)).norm() < 1e-12,
                "{k} {place} {c}"
            );
        }
    }
}

/// `ÿ + (a − 2q cos 2t) y = 0` over π in n steps.
fn mathieu(a: f64, q: f64, n: usize) -> DMatrix<f64> {
    let tableau = radau();
    let h = PI / n as f64;
    let none = |rows, columns| DMatrix::<f64>::zeros(rows, columns);
    let mut solution = DMatrix::identity(2, 2);
    for k in 0..n {
        let stages = tableau.places.map(|c| {
            let t = (k as f64 + c) * h;
            Stage {
                stiffness: DMatrix::from_element(1, 1, a - 2.0 * q * (2.0 * t).cos()),
                damping: none(1, 1),
                by_states: none(1, 0),
                rates_by_place: none(0, 1),
                rates_by_velocity: none(0, 1),
                rates_by_states: none(0, 0),
            }
        });
        solution = step(&tableau, &stages, &solution, h).unwrap();
    }
    solution
}

/// Exponents of Mathieu's equation (DLMF 28.2.16 and 28.29; values of the design's independent
/// integration to 1e-12).
#[test]
fn mathieu_has_its_exponents() {
    for (a, q, growth, frequency) in [(1.0, 0.5, 0.243_145_76, 1.0), (2.0, 0.5, 0.0, 0.630_491_43)]
    {
        let mut errors = Vec::new();
        for n in [50, 100] {
            let solution = mathieu(a, q, n);
            // the method's own damping, of order 5
            let damped = (solution.determinant() - 1.0).abs();
            assert!(damped < 3e-8 * (50.0 / n as f64).powi(5), "{n} {damped:e}");
            // μ + 1/μ = trace
            let half = 0.5 * solution.trace();
            let found = if growth > 0.0 {
                assert!(half < -1.0);
                (half.abs().acosh() / PI - growth).abs()
            } else {
                let turn = half.acos() / PI;
                (turn - frequency).abs().min((2.0 - turn - frequency).abs())
            };
            errors.push(found);
        }
        assert!(errors[0] < 3e-8 && errors[1] < 1e-8, "{errors:?}");
    }
}

/// A mode of 10⁶ rad/s and a decay of 10⁶ 1/s die in steps of a millisecond.
#[test]
fn what_is_fast_dies() {
    let tableau = radau();
    let stages = [0, 1, 2].map(|_| Stage {
        stiffness: DMatrix::from_element(1, 1, 1e12),
        damping: DMatrix::from_element(1, 1, 1.0),
        by_states: DMatrix::zeros(1, 1),
        rates_by_place: DMatrix::zeros(1, 1),
        rates_by_velocity: DMatrix::zeros(1, 1),
        rates_by_states: DMatrix::from_element(1, 1, -1e6),
    });
    let end = step(&tableau, &stages, &DMatrix::identity(3, 3), 1e-3).unwrap();
    let scaled = DMatrix::from_diagonal(&DVector::from_vec(vec![1e6, 1.0, 1.0]));
    let scaled = &scaled * end * scaled.clone().try_inverse().unwrap();
    assert!(scaled.amax() < 0.02, "{scaled}");
}

/// Known multipliers over 60 decades, behind a mixing that the segments share.
#[test]
fn small_multipliers_are_found_beside_large_ones() {
    let n = 7;
    let mix = DMatrix::from_fn(n, n, |i, j| ((i * 7 + j * 5) % 11) as f64 - 5.0)
        .qr()
        .q();
    let m = 7;
    // per segment: a turn by 0.3, one that makes μ = −0.5, 2, 1e-20, 1e-60
    let turn = 0.3_f64;
    let root = |x: f64| x.powf(1.0 / m as f64);
    let segments: Vec<DMatrix<f64>> = (0..m)
        .map(|k| {
            let mut d = DMatrix::zeros(n, n);
            d[(0, 0)] = turn.cos();
            d[(0, 1)] = -turn.sin();
            d[(1, 0)] = turn.sin();
            d[(1, 1)] = turn.cos();
            d[(2, 2)] = root(0.5) * if k == 3 { -1.0 } else { 1.0 };
            d[(3, 3)] = root(2.0);
            d[(4, 4)] = root(1e-20);
            d[(5, 5)] = 1e-9;
            d[(6, 6)] = root(0.25);
            &mix * d * mix.transpose()
        })
        .collect();
    let all = multipliers(&segments).unwrap();
    assert_eq!(all.lost, 1);
    let mut due = vec![
        (0.0, 7.0 * turn, false),
        (0.5_f64.ln(), PI, true),
        (2.0_f64.ln(), 0.0, true),
        (1e-20_f64.ln(), 0.0, true),
        (0.25_f64.ln(), 0.0, true),
    ];
    assert_eq!(all.found.len(), due.len());
    for found in &all.found {
        let place = due
            .iter()
            .position(|(re, im, real)| {
                *real == found.real && (found.logarithm - Complex::new(*re, *im)).norm() < 1e-7
            })
            .unwrap_or_else(|| panic!("{}", found.logarithm));
        due.remove(place);
        // each segment takes one vector to the next
        let step = (found.logarithm / m as f64).exp();
        for (k, segment) in segments.iter().enumerate() {
            let (v, next) = (&found.vectors[k], &found.vectors[(k + 1) % m]);
            let moved = segment.map(|x| Complex::new(x, 0.0)) * v;
            let due = next * step;
            assert!(
                (moved - due).norm() < 1e-7 * v.norm(),
                "{k} {}",
                found.logarithm
            );
        }
    }
    assert!(due.is_empty(), "{due:?}");
}
