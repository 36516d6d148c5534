//! Slopes of accelerations, eigenvalues and frequency responses.

use eng_runtime::internals::small_motions::{
    Differences, Eigenpair, POWERS, response_at, slopes, spectrum,
};
use eng_runtime::linearised::{Coefficients, StateSpace};
use eng_runtime::{Moment, RuntimeError};
use nalgebra::{Complex, DMatrix, DVector};

/// Differences of a function over all steps.
fn steps(f: impl Fn(f64) -> f64) -> Vec<Differences> {
    let vector = |x: f64| DVector::from_element(1, x);
    let step = |power: i32| {
        let h = libm::pow(10.0, f64::from(power));
        let [plus, minus, far, near] = [h, -h, 2.0 * h, -2.0 * h].map(&f);
        Differences {
            h,
            slopes: vector(((plus - minus) * 8.0 - (far - near)) / (12.0 * h)),
            sides: vector((plus + minus - f(0.0) * 2.0) / h),
            size: vector(plus.abs()),
        }
    };
    POWERS.rev().map(step).collect()
}

/// The least number of a scatter of one millionth, without a pattern.
fn scatter(x: f64) -> f64 {
    let bits = x.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15);
    1e-6 * ((bits >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
}

/// Accelerations as small differences of large loads scatter far above one rounding of their own size. A linear
/// effect stays linear, whatever the scatter is; a kink is found above it and without it.
#[test]
fn scatter_is_no_kink() {
    for seed in 0..400 {
        let noise = |x: f64| scatter(x + f64::from(seed));
        let found = slopes(&steps(|x| 3.0 * x + noise(x)), 1)[0];
        assert!(!found.bent, "{seed}");
        assert!((found.value - 3.0).abs() < 1e-6, "{seed}: {}", found.value);
        let still = slopes(&steps(noise), 1)[0];
        assert!(
            !still.bent && still.value.abs() < 1e-6,
            "{seed}: {}",
            still.value
        );
        let bent = slopes(&steps(|x| x.max(0.0) + noise(x)), 1)[0];
        assert!(bent.bent, "{seed}");
    }
    assert!(slopes(&steps(|x| x.max(0.0)), 1)[0].bent);
    assert!(!slopes(&steps(|x| x * x * 1e-3 + x), 1)[0].bent);
}

/// Random numbers of a fixed sequence, −1…1.
fn numbers(mut seed: u64) -> impl FnMut() -> f64 {
    move || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

#[test]
fn the_hessenberg_form_gives_the_response_of_the_full_matrix() {
    for n in [1, 2, 7, 30] {
        let mut next = numbers(n as u64);
        let mut matrix = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| next());
        let matrices = StateSpace {
            moment: Moment {
                time: 0.0,
                cycle_angle: None,
            },
            coefficients: Coefficients::Constant,
            freedoms: 0,
            states: n,
            // coordinates of very different size
            a: {
                let plain = matrix(n, n);
                DMatrix::from_fn(n, n, |i, j| {
                    plain[(i, j)] * libm::pow(10.0, (i as f64 - j as f64) / 3.0)
                })
            },
            b: matrix(n, 1),
            c: matrix(3, n),
            d: matrix(3, 1),
        };
        for omega in [0.01, 0.7, 40.0] {
            let mut full = matrices.a.map(|x| Complex::new(-x, 0.0));
            for k in 0..n {
                full[(k, k)].im += omega;
            }
            let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
            let moved = full.lu().solve(&complex(&matrices.b)).unwrap();
            let due = complex(&matrices.c) * moved + complex(&matrices.d);
            let found = response_at(&matrices, 0, omega).unwrap();
            let size = due.norm();
            for (found, due) in found.iter().zip(due.iter()) {
                assert!(
                    (found - due).norm() < 1e-11 * size,
                    "{n} {omega}: {found} {due}"
                );
            }
        }
    }
}

fn residual(matrix: &DMatrix<f64>, pair: &Eigenpair) -> f64 {
    let complex = matrix.map(|x| Complex::new(x, 0.0));
    let left = &complex * &pair.vector;
    (left - &pair.vector * pair.value).norm() / pair.vector.norm()
}

/// Oscillators of 1 to 1e6 rad/s, damped and not, mixed by an orthogonal matrix.
#[test]
fn frequencies_over_six_decades() {
    let places = [1.0, 30.0, 470.0, 8e3, 1.1e5, 1e6];
    let n = places.len();
    let mix = DMatrix::from_fn(n, n, |i, j| ((i * 7 + j * 5) % 11) as f64 - 5.0)
        .qr()
        .q();
    let turned = |values: DVector<f64>| &mix * DMatrix::from_diagonal(&values) * mix.transpose();
    let stiffness = turned(DVector::from_fn(n, |i, _| places[i] * places[i]));
    let damping = turned(DVector::from_fn(n, |i, _| 0.02 * places[i]));
    let mut matrix = DMatrix::zeros(2 * n, 2 * n);
    matrix
        .view_mut((0, n), (n, n))
        .copy_from(&DMatrix::identity(n, n));
    matrix.view_mut((n, 0), (n, n)).copy_from(&-stiffness);
    matrix.view_mut((n, n), (n, n)).copy_from(&-damping);
    let found = spectrum(matrix.clone()).unwrap();
    let mut sizes: Vec<f64> = found.pairs.iter().map(|p| p.value.norm()).collect();
    sizes.sort_by(f64::total_cmp);
    assert_eq!(sizes.len(), n);
    for (size, place) in sizes.iter().zip(places) {
        // the mixed stiffness itself is rounded at 1e-16 of its largest entry, 1e12
        let due = 1e-15 * 1e12 / (place * place) + 1e-12;
        assert!((size / place - 1.0).abs() < due, "{size} {place}");
    }
    for pair in &found.pairs {
        assert!((pair.value.re / pair.value.norm() + 0.01).abs() < 1e-2);
        assert!(residual(&matrix, pair) < 1e-14 * 1e12, "{pair:?}");
    }
}

/// 100 rows take the method's other branch (multishift with deflation); companion of a rotation has roots
/// of one.
#[test]
fn a_cyclic_shift_has_the_roots_of_one() {
    let n = 100;
    let matrix = DMatrix::from_fn(n, n, |i, j| if (i + 1) % n == j { 1.0 } else { 0.0 });
    let found = spectrum(matrix.clone()).unwrap();
    assert_eq!(found.pairs.len(), n / 2 + 1);
    for pair in &found.pairs {
        assert!((pair.value.norm() - 1.0).abs() < 1e-12, "{}", pair.value);
        assert!(residual(&matrix, pair) < 1e-12);
    }
}

#[test]
fn nothing_and_what_is_no_number() {
    assert!(spectrum(DMatrix::zeros(0, 0)).unwrap().pairs.is_empty());
    let wrong = spectrum(DMatrix::from_element(2, 2, f64::NAN)).unwrap_err();
    assert!(matches!(wrong, RuntimeError::Eigenvalues { size: 2, .. }));
}
