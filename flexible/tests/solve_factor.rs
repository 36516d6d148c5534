//! Factors of sparse matrices against dense ones, their inertia, and matrices without factors.

use crate::systems;
use crate::systems::{
    Numbers, chain, chain_eigenvalues, dense, dense_eigenvalues, diagonal, elastic_box, laplacian,
    laplacian_eigenvalues, matrix, random_sparse,
};
use eng_flexible::FlexibleError;
use eng_flexible::solve::{Analysis, Definiteness, Factorization, Method, Ordering, shifted};
use eng_flexible::sparse::{SymmetricMatrix, SymmetricOperator};
use faer::linalg::solvers::Solve;
use std::sync::Arc;

fn factor(matrix: &SymmetricMatrix, kind: Definiteness) -> Result<Factorization, FlexibleError> {
    Factorization::new(&Arc::new(Analysis::fill_reducing(matrix)?), matrix, kind)
}

fn random_columns(size: usize, columns: usize) -> Vec<f64> {
    let mut numbers = Numbers::new(7);
    (0..size * columns).map(|_| numbers.symmetric()).collect()
}

#[test]
fn solutions_agree_with_dense_ones() {
    for (size, a_row) in [(1, 0), (2, 1), (40, 2), (300, 3), (500, 20)] {
        for (lift, kind) in [
            (1.1, Definiteness::Positive),
            (1.1, Definiteness::Indefinite),
            (0.1, Definiteness::Indefinite),
        ] {
            let matrix = if size == 1 {
                diagonal(&[3.0])
            } else {
                random_sparse(size, a_row, lift, size as u64)
            };
            for method in [Method::MinimumDegree, Method::NestedDissection] {
                let ordering = Ordering::with_method(&matrix, method).unwrap();
                let analysis = Arc::new(Analysis::new(&matrix, ordering).unwrap());
                let factor = Factorization::new(&analysis, &matrix, kind).unwrap();
                // more columns than are solved together
                let columns = 37;
                let right = random_columns(size, columns);
                let mut solution = right.clone();
                factor.solve_in_place(&mut solution).unwrap();
                let exact = dense(&matrix)
                    .partial_piv_lu()
                    .solve(faer::MatRef::from_column_major_slice(&right, size, columns));
                let largest = exact.norm_max();
                for column in 0..columns {
                    for row in 0..size {
                        let error = solution[column * size + row] - exact[(row, column)];
                        assert!(error.abs() < 1e-9 * largest, "{size} {kind:?} {error}");
                    }
                }
            }
        }
    }
}

#[test]
fn pivots_count_the_negative_eigenvalues() {
    for seed in 0..6 {
        let matrix = random_sparse(180, 3, 0.2, seed);
        let eigenvalues = dense(&matrix)
            .self_adjoint_eigenvalues(faer::Side::Lower)
            .unwrap();
        let negative = eigenvalues.iter().filter(|value| **value < 0.0).count();
        assert!(negative > 10);
        let factor = factor(&matrix, Definiteness::Indefinite).unwrap();
        assert_eq!(factor.negative_pivots(), negative);
    }
    // zero diagonals: every pivot is a pair of rows
    let pairs: Vec<(u32, u32, f64)> = (0..50).map(|pair| (2 * pair + 1, 2 * pair, 3.0)).collect();
    let factor = factor(&matrix(100, &pairs), Definiteness::Indefinite).unwrap();
    assert_eq!(factor.negative_pivots(), 50);
}

#[test]
fn shifts_slice_the_spectrum() {
    let sides = [14, 11, 9];
    let stiffness = laplacian(sides);
    let mass = diagonal(&vec![1.0; stiffness.size()]);
    let eigenvalues = laplacian_eigenvalues(sides);
    let analysis = Arc::new(Analysis::fill_reducing(&stiffness).unwrap());
    let mut factor: Option<Factorization> = None;
    for below in [1, 3, 40, 700, 1385] {
        let gap = (below..)
            .find(|&above| eigenvalues[above] - eigenvalues[above - 1] > 1e-5)
            .unwrap();
        let shift = 0.5 * (eigenvalues[gap - 1] + eigenvalues[gap]);
        let matrix = shifted(&stiffness, &mass, shift).unwrap();
        let next = match factor.take() {
            None => Factorization::new(&analysis, &matrix, Definiteness::Indefinite),
            Some(factor) => factor.replace(&matrix, Definiteness::Indefinite),
        }
        .unwrap();
        let expected = eigenvalues.iter().filter(|value| **value < shift).count();
        assert_eq!(next.negative_pivots(), expected);
        factor = Some(next);
    }
    let (stiffness, mass) = elastic_box([3, 3, 2]);
    let eigenvalues = dense_eigenvalues(&stiffness, &mass);
    for shift in [1e3, 5e7, 4e8, 3e9] {
        let matrix = shifted(&stiffness, &mass, shift).unwrap();
        let expected = eigenvalues.iter().filter(|value| **value < shift).count();
        assert_eq!(
            self::factor(&matrix, Definiteness::Indefinite)
                .unwrap()
                .negative_pivots(),
            expected
        );
    }
}

#[test]
fn refinement_lowers_the_residual() {
    let (stiffness, mass) = elastic_box([5, 5, 5]);
    let matrix = shifted(&stiffness, &mass, -1e-3).unwrap();
    let factor = factor(&matrix, Definiteness::Positive).unwrap();
    let right = random_columns(matrix.size(), 3);
    let mut solution = vec![0.0; right.len()];
    let plain = factor
        .solve_refined(&matrix, &right, &mut solution, 0)
        .unwrap();
    let refined = factor
        .solve_refined(&matrix, &right, &mut solution, 2)
        .unwrap();
    assert!(refined <= plain, "{plain} {refined}");
    let mut product = vec![0.0; right.len()];
    let easy = random_sparse(matrix.size(), 4, 2.0, 3);
    let factor = self::factor(&easy, Definiteness::Positive).unwrap();
    let left = factor
        .solve_refined(&easy, &right, &mut solution, 1)
        .unwrap();
    assert!(left < 1e-15, "{left}");
    easy.apply(3, &solution, &mut product);
    for (product, right) in product.iter().zip(&right) {
        assert!((product - right).abs() < 1e-13);
    }
}

#[test]
fn singular_matrices_are_refused_with_their_row() {
    for kind in [Definiteness::Positive, Definiteness::Indefinite] {
        // a row without anything
        let mut values = vec![2.0; 30];
        values[17] = 0.0;
        let error = factor(&diagonal(&values), kind).unwrap_err();
        assert!(
            matches!(error, FlexibleError::Singular { row: 17, .. }),
            "{error}"
        );
        assert!(error.to_string().contains("row 18"), "{error}");
        assert!(!error.advice().is_empty());
        if kind == Definiteness::Indefinite {
            continue;
        }
        // free bodies
        let error = factor(&chain(400, 3.7), kind).unwrap_err();
        assert!(matches!(error, FlexibleError::Singular { .. }), "{error}");
        // a free part beside a supported one: the row is of the free part
        let mut entries = systems::chain_entries(50, 1.3, 0);
        entries.push((0, 0, 1.0));
        entries.extend(systems::chain_entries(60, 0.7, 50));
        match factor(&matrix(110, &entries), kind).unwrap_err() {
            FlexibleError::Singular { row, .. } => assert!((50..110).contains(&row), "{row}"),
            other => panic!("{other}"),
        }
    }
    let (stiffness, _) = elastic_box([6, 5, 4]);
    let error = factor(&stiffness, Definiteness::Positive).unwrap_err();
    assert!(matches!(error, FlexibleError::Singular { .. }), "{error}");
    let error = factor(&random_sparse(60, 3, 0.1, 1), Definiteness::Positive).unwrap_err();
    assert!(matches!(error, FlexibleError::Singular { .. }), "{error}");
}

#[test]
fn poor_but_regular_matrices_are_factored() {
    // a long chain held at one end: condition number about 16 n²/π²
    let masses = 100_000;
    let mut entries = systems::chain_entries(masses, 1.0, 0);
    entries.push((0, 0, 1.0));
    let stiffness = matrix(masses, &entries);
    let factor = factor(&stiffness, Definiteness::Positive).unwrap();
    let mut right = vec![0.0; masses];
    right[masses - 1] = 1.0;
    factor.solve_in_place(&mut right).unwrap();
    // the free end moves by n unit springs
    let relative = right[masses - 1] / masses as f64 - 1.0;
    assert!(relative.abs() < 1e-8, "{relative}");
    // freedoms in units a million times apart
    let mut values = vec![1e-6; 40];
    values[3] = 1e12;
    assert!(self::factor(&diagonal(&values), Definiteness::Indefinite).is_ok());
}

#[test]
fn what_does_not_fit_is_an_error() {
    let one = laplacian([5, 5, 1]);
    let other = chain(25, 1.0);
    let analysis = Arc::new(Analysis::fill_reducing(&one).unwrap());
    let wrong = Factorization::new(&analysis, &other, Definiteness::Positive).unwrap_err();
    assert!(wrong.to_string().contains("another pattern"), "{wrong}");
    let small = Ordering::fill_reducing(&chain(24, 1.0)).unwrap();
    assert!(Analysis::new(&one, small).is_err());
    let mut broken = one.clone();
    broken.values_mut()[7] = f64::NAN;
    let wrong = Factorization::new(&analysis, &broken, Definiteness::Positive).unwrap_err();
    assert!(wrong.to_string().contains("NaN"), "{wrong}");
    let factor = Factorization::new(&analysis, &one, Definiteness::Positive).unwrap();
    assert!(factor.solve_in_place(&mut [0.0; 26]).is_err());
    assert!(factor.solve_in_place(&mut []).is_ok());
    assert!(
        factor
            .solve_refined(&one, &[0.0; 25], &mut [0.0; 50], 1)
            .is_err()
    );
    assert!(factor.solve_refined(&other, &[], &mut [], 1).is_ok());
    assert!(shifted(&one, &chain(24, 1.0), 1.0).is_err());
    let empty = self::factor(&matrix(0, &[]), Definiteness::Positive).unwrap();
    assert!(empty.solve_in_place(&mut []).is_ok());
    assert_eq!(chain_eigenvalues(1, 1.0, 1.0), [0.0]);
}

#[test]
fn the_shifted_matrix_has_both_patterns() {
    let stiffness = matrix(3, &[(0, 0, 2.0), (1, 0, -1.0), (2, 2, 5.0)]);
    let mass = matrix(3, &[(0, 0, 1.0), (1, 1, 4.0), (2, 0, 0.5)]);
    let both = shifted(&stiffness, &mass, 2.0).unwrap();
    assert_eq!(both.column(0), (&[0, 1, 2][..], &[0.0, -1.0, -1.0][..]));
    assert_eq!(both.column(1), (&[1][..], &[-8.0][..]));
    assert_eq!(both.column(2), (&[2][..], &[5.0][..]));
}

#[test]
fn the_same_bits_come_out_every_time() {
    let (stiffness, mass) = elastic_box([8, 7, 6]);
    let matrix = shifted(&stiffness, &mass, -1e6).unwrap();
    let right = random_columns(matrix.size(), 5);
    let run = || {
        let mut solution = right.clone();
        factor(&matrix, Definiteness::Positive)
            .unwrap()
            .solve_in_place(&mut solution)
            .unwrap();
        solution
    };
    let first = run();
    let second = std::thread::spawn({
        let (matrix, right) = (matrix.clone(), right.clone());
        move || {
            let mut solution = right;
            factor(&matrix, Definiteness::Positive)
                .unwrap()
                .solve_in_place(&mut solution)
                .unwrap();
            solution
        }
    });
    let third = run();
    assert!(
        first
            .iter()
            .zip(&third)
            .all(|(a, b)| a.to_bits() == b.to_bits())
    );
    let second = second.join().unwrap();
    assert!(
        first
            .iter()
            .zip(&second)
            .all(|(a, b)| a.to_bits() == b.to_bits())
    );
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    // large enough for several branches, and for panels above them that threads share
    let (stiffness, mass) = elastic_box([26, 13, 12]);
    let matrix = shifted(&stiffness, &mass, 1e-3).unwrap();
    let analysis = Arc::new(Analysis::fill_reducing(&matrix).unwrap());
    assert!(analysis.branches() > 2);
    for kind in [Definiteness::Positive, Definiteness::Indefinite] {
        let shift = if kind == Definiteness::Positive {
            -1e6
        } else {
            1e6
        };
        let matrix = shifted(&stiffness, &mass, shift).unwrap();
        let right = random_columns(matrix.size(), 3);
        let mut first: Option<(usize, Vec<f64>)> = None;
        for threads in [1, 2, 3, 7] {
            let factor = Factorization::new_on(&analysis, &matrix, kind, threads).unwrap();
            let mut solution = right.clone();
            factor.solve_in_place(&mut solution).unwrap();
            let found = (factor.negative_pivots(), solution);
            let first = first.get_or_insert_with(|| found.clone());
            assert_eq!(first.0, found.0, "{kind:?}, {threads} threads");
            let same = first
                .1
                .iter()
                .zip(&found.1)
                .all(|(x, y)| x.to_bits() == y.to_bits());
            assert!(same, "{kind:?}, {threads} threads");
        }
        let (negative, solution) = first.unwrap();
        assert_eq!(negative > 0, kind == Definiteness::Indefinite);
        let mut rest = vec![0.0; right.len()];
        matrix.apply(3, &solution, &mut rest);
        let apart = rest
            .iter()
            .zip(&right)
            .map(|(x, y)| (x - y).abs())
            .fold(0.0, f64::max);
        assert!(apart < 1e-7, "{kind:?}: {apart}");
    }
}
