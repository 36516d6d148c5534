//! Singular values, with a check of the decomposition.

use eng_runtime::internals::{WRONG, decompose, is_of, jacobi};
use nalgebra::{DMatrix, Dyn, SVD};

/// Numbers in −1…1 without a pattern.
struct Numbers(u64);

impl Numbers {
    fn draw(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

fn error(matrix: &DMatrix<f64>, found: &SVD<f64, Dyn, Dyn>) -> f64 {
    let (u, v) = (found.u.as_ref().unwrap(), found.v_t.as_ref().unwrap());
    let count = found.singular_values.len();
    let one = DMatrix::identity(count, count);
    let product = u * DMatrix::from_diagonal(&found.singular_values) * v;
    let ordered = found
        .singular_values
        .as_slice()
        .windows(2)
        .all(|w| w[0] >= w[1]);
    assert!(ordered);
    (product - matrix)
        .amax()
        .max((u.tr_mul(u) - &one).amax())
        .max((v * v.transpose() - &one).amax())
}

/// Rows of a rotor on springs with a drive and a stated speed about the same axis, rounding around them.
fn repeated(numbers: &mut Numbers) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(5, 6);
    for (row, column) in [(0, 2), (1, 5), (2, 3), (3, 4), (4, 5)] {
        rows[(row, column)] = 1.0;
    }
    for row in 0..5 {
        for column in 3..6 {
            if rows[(row, column)] == 0.0 && numbers.draw() > 0.5 {
                rows[(row, column)] = 1e-16 * numbers.draw();
            }
        }
    }
    rows
}

#[test]
fn repeated_rows_have_the_right_values() {
    let mut numbers = Numbers(12345);
    let mut wrong = 0;
    for _ in 0..2000 {
        let rows = repeated(&mut numbers);
        for rows in [rows.transpose(), rows] {
            let alone = rows.clone().try_svd(true, true, f64::EPSILON, 10_000);
            wrong += usize::from(alone.is_none_or(|found| !is_of(&rows, &found)));
            let found = decompose(rows.clone()).unwrap();
            assert!(error(&rows, &found) < WRONG);
            assert!((found.singular_values[0] - 2.0_f64.sqrt()).abs() < 1e-11);
            assert!(found.singular_values[4].abs() < 1e-11);
        }
    }
    // without one that the other method gets wrong this test shows nothing
    assert!(wrong > 0);
}

#[test]
fn jacobi_decomposes_what_lacks_rank() {
    let mut numbers = Numbers(7);
    for (rows, columns, rank) in [
        (1, 1, 1),
        (4, 4, 2),
        (7, 3, 3),
        (3, 7, 2),
        (12, 12, 11),
        (30, 40, 9),
    ] {
        let mut factor = |m, n| DMatrix::from_fn(m, n, |_, _| numbers.draw());
        let matrix = factor(rows, rank) * factor(rank, columns);
        let found = jacobi(&matrix).unwrap();
        assert!(error(&matrix, &found) < 1e-12);
        assert_eq!(found.rank(1e-10 * found.singular_values[0]), rank);
    }
    assert!(
        error(
            &DMatrix::zeros(3, 2),
            &jacobi(&DMatrix::zeros(3, 2)).unwrap()
        ) < 1e-15
    );
    assert!(decompose(DMatrix::from_element(2, 2, f64::NAN)).is_none());
}
