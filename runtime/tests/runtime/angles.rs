//! Motions over the angles of a turn.

use eng_runtime::internals::{PeriodicDerivative, Repeats, gmres, largest, refined};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

#[test]
fn extremes_of_a_cosine_lie_between_the_positions() {
    let angles: Vec<f64> = (0..=36)
        .map(|k| f64::from(k) * 10f64.to_radians())
        .collect();
    for shift in [0.0, 0.03, 0.08, 1.0, 3.1, 6.2] {
        let values: Vec<f64> = angles.iter().map(|x| libm::cos(x - shift)).collect();
        let (at, most) = largest(&angles, &values);
        let off = libm::remainder(at - shift, std::f64::consts::TAU);
        // the parabola through -h, 0, h misses s²(h² − s²)/6 at s, up to h⁴/32 for s = h/2; and h³/16 in the angle
        let step = 10f64.to_radians();
        let missed = step.powi(4) / 32.0;
        assert!(
            off.abs() < 4e-4 && (most - 1.0).abs() < missed,
            "{at} {most}"
        );
    }
    // of two equal ones the first counts; a quantity that grows has its end
    let twice: Vec<f64> = angles.iter().map(|x| libm::cos(2.0 * x)).collect();
    assert!(largest(&angles, &twice).0.abs() < 1e-3);
    assert_eq!(largest(&angles, &angles), (angles[36], angles[36]));
    assert_eq!(largest(&angles, &[1.0; 37]), (0.0, 1.0));
}

/// A matrix that no eigenvalue order makes easy, with a poor and with an exact preconditioner, against
/// LU.
#[test]
fn finds_the_solution_of_a_dense_system() {
    let n = 12;
    let matrix = DMatrix::from_fn(n, n, |i, j| {
        libm::sin((i * 7 + j * 3) as f64) + if i == j { 3.0 + i as f64 } else { 0.0 }
    });
    let b = DVector::from_fn(n, |i, _| libm::cos(i as f64));
    let due = matrix.clone().lu().solve(&b).unwrap();
    let multiply = |x: &[f64]| -> Result<Vec<f64>, ()> {
        Ok((&matrix * DVector::from_column_slice(x))
            .as_slice()
            .to_vec())
    };
    let by_diagonal = |x: &[f64]| -> Result<Vec<f64>, ()> {
        Ok(x.iter()
            .enumerate()
            .map(|(i, x)| x / matrix[(i, i)])
            .collect())
    };
    let found = gmres(multiply, by_diagonal, b.as_slice(), 1e-13, n).unwrap();
    for (x, y) in found.x.iter().zip(due.iter()) {
        assert!((x - y).abs() < 1e-12, "{x} {y}");
    }
    assert!(found.residual < 1e-13);
    let exact = matrix.clone().lu();
    let solved = |x: &[f64]| -> Result<Vec<f64>, ()> {
        Ok(exact
            .solve(&DVector::from_column_slice(x))
            .ok_or(())?
            .as_slice()
            .to_vec())
    };
    let once = gmres(multiply, solved, b.as_slice(), 1e-12, 1).unwrap();
    assert!(once.residual < 1e-12);
    // a singular system whose right side is outside of its range has no solution, and the result
    // reports this
    let flat = |x: &[f64]| -> Result<Vec<f64>, ()> { Ok(vec![x[0], 0.0]) };
    let same = |x: &[f64]| -> Result<Vec<f64>, ()> { Ok(x.to_vec()) };
    let stuck = gmres(flat, same, &[1.0, 1.0], 1e-12, 10).unwrap();
    assert!(
        (stuck.residual - libm::sqrt(0.5)).abs() < 1e-12,
        "{stuck:?}"
    );
}

fn at(points: usize, period: f64, f: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
    (0..points)
        .map(|j| vec![f(2.0 * PI * j as f64 / points as f64), period])
        .collect()
}

/// Exact for all orders below N/2: sums of sines and cosines, whole and half-odd, against their rates.
#[test]
fn rates_of_sines_are_exact() {
    let period = 0.3;
    let frequency = 2.0 * PI / period;
    for points in [4, 8, 16, 96] {
        let derivative = PeriodicDerivative::new(points, period);
        let orders = (0..points / 2).map(|m| m as f64);
        for (half, repeats) in [(0.0, Repeats::Same), (0.5, Repeats::Opposite)] {
            for order in orders.clone().map(|m| m + half) {
                if order > points as f64 / 2.0 - 1.0 + half {
                    continue;
                }
                let values = at(points, period, |x| {
                    libm::sin(order * x) + 0.3 * libm::cos(order * x)
                });
                let mut rates = vec![vec![0.0; 2]; points];
                derivative.rates(&values, repeats, &mut rates);
                for (j, rate) in rates.iter().enumerate() {
                    let x = 2.0 * PI * j as f64 / points as f64;
                    let due =
                        order * frequency * (libm::cos(order * x) - 0.3 * libm::sin(order * x));
                    assert!(
                        (rate[0] - due).abs() < 1e-11 * frequency * points as f64,
                        "{points} {order}: {} {due}",
                        rate[0]
                    );
                    if repeats == Repeats::Same {
                        assert!(rate[1].abs() < 1e-10, "{}", rate[1]);
                    }
                }
            }
        }
    }
}

#[test]
fn values_between_are_those_of_the_polynomial() {
    let f = |x: f64| 0.7 + libm::sin(x) - 2.0 * libm::cos(3.0 * x);
    let fine = refined(&at(8, 1.0, f));
    assert_eq!(fine.len(), 16);
    for (value, due) in fine.iter().zip(at(16, 1.0, f)) {
        assert!((value[0] - due[0]).abs() < 1e-13, "{value:?} {due:?}");
    }
}
