//! Lowest modes against closed forms and dense solutions.

use crate::systems::{
    chain, chain_eigenvalues, chain_entries, dense_eigenvalues, diagonal, elastic_box, laplacian,
    laplacian_eigenvalues, matrix,
};
use eng_flexible::FlexibleError;
use eng_flexible::solve::{Analysis, EigenOptions, EigenSolution, Modes, lowest_modes, shifted};
use eng_flexible::sparse::{SymmetricMatrix, SymmetricOperator};
use std::sync::Arc;

fn find(
    stiffness: &SymmetricMatrix,
    mass: &SymmetricMatrix,
    request: Modes,
) -> Result<EigenSolution, FlexibleError> {
    lowest_modes(stiffness, mass, request, &EigenOptions::default())
}

/// Eigenvalues against those expected: relative, or of the size of `zero` where zero is expected.
fn check_values(solution: &EigenSolution, expected: &[f64], relative: f64, zero: f64) {
    assert_eq!(solution.eigenvalues.len(), expected.len());
    for (index, (value, expected)) in solution.eigenvalues.iter().zip(expected).enumerate() {
        let error = (value - expected).abs();
        assert!(
            error <= relative * expected.abs() + zero,
            "{index}: {value:e} instead of {expected:e}"
        );
    }
    assert!(solution.sturm.count >= expected.len());
    assert!(
        solution
            .eigenvalues
            .iter()
            .all(|value| *value < solution.sturm.below)
    );
}

/// `XᵀMX = 1`, `XᵀKX = Λ`, residuals, signs.
fn check_vectors(
    stiffness: &SymmetricMatrix,
    mass: &SymmetricMatrix,
    solution: &EigenSolution,
    tolerance: f64,
) {
    let size = mass.size();
    let count = solution.eigenvalues.len();
    let (mut heavy, mut stiff) = (
        vec![0.0; solution.vectors.len()],
        vec![0.0; solution.vectors.len()],
    );
    mass.apply(count, &solution.vectors, &mut heavy);
    stiffness.apply(count, &solution.vectors, &mut stiff);
    let dot = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
    // for a rigid motion, K x is only the rounding of the sums of its rows
    let ends = (0..size).filter_map(|row| {
        let own = |matrix: &SymmetricMatrix| matrix.column(row).1.first().copied().unwrap_or(0.0);
        (own(mass) > 0.0).then(|| own(stiffness) / own(mass))
    });
    let rounding = 3e-14 * ends.fold(0.0, f64::max);
    let highest = solution.eigenvalues[count - 1]
        .abs()
        .max(solution.shift.abs());
    for (i, x) in solution.vectors.chunks(size).enumerate() {
        for j in 0..count {
            let range = j * size..(j + 1) * size;
            let unit = if i == j { 1.0 } else { 0.0 };
            let inner = dot(x, &heavy[range.clone()]);
            assert!((inner - unit).abs() < tolerance, "{i} {j}: mass {inner}");
            let inner = dot(x, &stiff[range]) - unit * solution.eigenvalues[i];
            assert!(
                inner.abs() < tolerance * highest,
                "{i} {j}: stiffness {inner}"
            );
        }
        let largest = x.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let first = x
            .iter()
            .find(|x| x.abs() >= largest * (1.0 - 1e-6))
            .unwrap();
        assert!(*first > 0.0);
        let distance = solution.eigenvalues[i] - solution.shift;
        let residual = solution.residuals[i];
        // the remainder of the inverse iteration is a hundred times as large in K x, where the
        // highest motions weigh most
        assert!(
            residual < 100.0 * tolerance + rounding / distance,
            "{i}: {residual:e}, {:e} of it rounding",
            rounding / distance
        );
    }
}

fn unit_mass(size: usize) -> SymmetricMatrix {
    diagonal(&vec![1.0; size])
}

#[test]
fn grids_with_multiple_eigenvalues() {
    for (sides, count) in [
        ([40, 40, 1], 30),
        ([12, 12, 12], 41),
        ([37, 23, 1], 25),
        ([9, 8, 7], 100),
        ([300, 1, 1], 12),
    ] {
        let stiffness = laplacian(sides);
        let mass = unit_mass(stiffness.size());
        let expected = laplacian_eigenvalues(sides);
        let solution = find(&stiffness, &mass, Modes::Count(count)).unwrap();
        check_values(&solution, &expected[..count], 1e-10, 0.0);
        check_vectors(&stiffness, &mass, &solution, 1e-8);
        let below = solution.sturm.below;
        let there = expected.iter().filter(|value| **value < below).count();
        assert_eq!(solution.sturm.count, there);
    }
}

#[test]
fn small_blocks_and_bases_find_the_same() {
    let sides = [10, 9, 9];
    let stiffness = laplacian(sides);
    let mass = unit_mass(stiffness.size());
    let expected = laplacian_eigenvalues(sides);
    for block in [1, 2, 5, 16] {
        for basis in [None, Some(1)] {
            let options = EigenOptions {
                block,
                basis,
                solves: Some(4000),
                ..EigenOptions::default()
            };
            let solution = lowest_modes(&stiffness, &mass, Modes::Count(20), &options).unwrap();
            check_values(&solution, &expected[..20], 1e-10, 0.0);
            check_vectors(&stiffness, &mass, &solution, 1e-8);
        }
    }
}

#[test]
fn more_equal_eigenvalues_than_a_block_has_vectors() {
    // twenty equal chains, not connected: every eigenvalue twenty times
    let (chains, masses) = (20, 30);
    let mut entries = Vec::new();
    for index in 0..chains {
        entries.extend(chain_entries(masses, 5.0, (index * masses) as u32));
    }
    let stiffness = matrix(chains * masses, &entries);
    let mass = diagonal(&vec![2.0; chains * masses]);
    let expected: Vec<f64> = chain_eigenvalues(masses, 5.0, 2.0)
        .into_iter()
        .flat_map(|value| std::iter::repeat_n(value, chains))
        .collect();
    for (count, block) in [(60, 4), (60, 8), (55, 8), (20, 3), (7, 8)] {
        let options = EigenOptions {
            block,
            ..EigenOptions::default()
        };
        let solution = lowest_modes(&stiffness, &mass, Modes::Count(count), &options).unwrap();
        check_values(&solution, &expected[..count], 1e-10, 1e-12);
        check_vectors(&stiffness, &mass, &solution, 1e-8);
        // the count takes all of the last ones in
        let below = solution.sturm.below;
        let there = expected.iter().filter(|value| **value < below).count();
        assert_eq!(solution.sturm.count, there);
        assert_eq!(there % chains, 0);
    }
}

#[test]
fn free_chains() {
    for masses in [2, 17, 199, 201, 2000] {
        let stiffness = chain(masses, 3e6);
        let mass = diagonal(&vec![0.25; masses]);
        let count = masses.min(15);
        let solution = find(&stiffness, &mass, Modes::Count(count)).unwrap();
        let expected = chain_eigenvalues(masses, 3e6, 0.25);
        check_values(&solution, &expected[..count], 1e-8, 1e-7);
        check_vectors(&stiffness, &mass, &solution, 1e-8);
    }
}

#[test]
fn massless_freedoms_are_condensed_by_themselves() {
    for masses in [31, 400] {
        // a massless node in the middle of each spring: two of stiffness 2k make one of k
        let stiffness = chain(2 * masses - 1, 2.0 * 700.0);
        let lumped: Vec<f64> = (0..2 * masses - 1)
            .map(|node| if node % 2 == 0 { 3.0 } else { 0.0 })
            .collect();
        let mass = diagonal(&lumped);
        let expected = chain_eigenvalues(masses, 700.0, 3.0);
        let count = 20;
        let solution = find(&stiffness, &mass, Modes::Count(count)).unwrap();
        check_values(&solution, &expected[..count], 1e-8, 1e-10);
        check_vectors(&stiffness, &mass, &solution, 1e-7);
    }
    // few masses on a long chain: there are no more modes than masses
    let stiffness = chain(900, 1.0);
    let mut lumped = vec![0.0; 900];
    for node in [3, 400, 555, 898] {
        lumped[node] = 1.0;
    }
    let mass = diagonal(&lumped);
    let solution = find(&stiffness, &mass, Modes::Count(4)).unwrap();
    check_vectors(&stiffness, &mass, &solution, 1e-7);
    assert_eq!(solution.sturm.count, 4);
    let error = find(&stiffness, &mass, Modes::Count(5)).unwrap_err();
    assert!(error.to_string().contains("only 4 were found"), "{error}");
}

#[test]
fn free_elastic_boxes_against_dense_eigenvalues() {
    for (elements, count) in [
        ([3, 3, 3], 40),
        ([6, 3, 2], 30),
        ([4, 4, 4], 60),
        ([20, 1, 1], 25),
    ] {
        let (stiffness, mass) = elastic_box(elements);
        let expected = dense_eigenvalues(&stiffness, &mass);
        let solution = find(&stiffness, &mass, Modes::Count(count)).unwrap();
        // rigid motions: rounding of the highest eigenvalue
        let zero = 1e-13 * expected[expected.len() - 1];
        check_values(&solution, &expected[..count], 1e-9, zero);
        assert!(
            solution.eigenvalues[..6]
                .iter()
                .all(|value| value.abs() < zero)
        );
        check_vectors(&stiffness, &mass, &solution, 1e-7);
    }
}

#[test]
fn all_modes_of_a_small_structure() {
    let (stiffness, mass) = elastic_box([2, 2, 1]);
    let expected = dense_eigenvalues(&stiffness, &mass);
    let solution = find(&stiffness, &mass, Modes::Count(expected.len())).unwrap();
    check_values(
        &solution,
        &expected,
        1e-9,
        1e-13 * expected[expected.len() - 1],
    );
    let (stiffness, mass) = elastic_box([5, 5, 5]);
    let expected = dense_eigenvalues(&stiffness, &mass);
    let solution = find(&stiffness, &mass, Modes::Count(expected.len())).unwrap();
    check_values(
        &solution,
        &expected,
        1e-9,
        1e-13 * expected[expected.len() - 1],
    );
    assert!(find(&stiffness, &mass, Modes::Count(expected.len() + 1)).is_err());
}

#[test]
fn modes_up_to_a_frequency() {
    let sides = [14, 13, 9];
    let stiffness = laplacian(sides);
    let mass = unit_mass(stiffness.size());
    let expected = laplacian_eigenvalues(sides);
    for limit in [0.1, 0.25, 0.5, 1.0] {
        let count = expected.iter().filter(|value| **value < limit).count();
        let solution = find(&stiffness, &mass, Modes::UpTo(limit)).unwrap();
        check_values(&solution, &expected[..count], 1e-10, 0.0);
        assert_eq!((solution.sturm.count, solution.sturm.below), (count, limit));
    }
    let nothing = find(&stiffness, &mass, Modes::UpTo(1e-3)).unwrap();
    assert!(nothing.eigenvalues.is_empty() && nothing.sturm.count == 0);
    for limit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(find(&stiffness, &mass, Modes::UpTo(limit)).is_err());
    }
    let (stiffness, mass) = elastic_box([5, 5, 5]);
    let rigid = find(&stiffness, &mass, Modes::UpTo(1e3)).unwrap();
    assert_eq!(rigid.eigenvalues.len(), 6);
}

#[test]
fn stiffness_over_many_orders_of_magnitude() {
    // a soft mount under a stiff body: modes at 1e-3 and from 1e5 rad²/s² on, the largest near 1e12
    let masses = 3000;
    let mut entries = chain_entries(masses, 2.5e11, 0);
    entries.push((0, 0, 3.0));
    let stiffness = matrix(masses, &entries);
    let mass = unit_mass(masses);
    let solution = find(&stiffness, &mass, Modes::Count(10)).unwrap();
    assert!((solution.eigenvalues[0] * masses as f64 / 3.0 - 1.0).abs() < 1e-2);
    let free = chain_eigenvalues(masses, 2.5e11, 1.0);
    check_values(&solution, &[&[1e-3][..], &free[1..10]].concat(), 1e-3, 0.0);
    // a given shift, and a given analysis
    let analysis =
        Arc::new(Analysis::fill_reducing(&shifted(&stiffness, &mass, 0.0).unwrap()).unwrap());
    for shift in [-1e-2, -1e4, -1e9] {
        let options = EigenOptions {
            shift: Some(shift),
            analysis: Some(analysis.clone()),
            ..EigenOptions::default()
        };
        let again = lowest_modes(&stiffness, &mass, Modes::Count(10), &options).unwrap();
        assert_eq!(again.shift, shift);
        for (one, two) in again.eigenvalues.iter().zip(&solution.eigenvalues).skip(1) {
            assert!((one / two - 1.0).abs() < 1e-4, "{shift}: {one} {two}");
        }
    }
}

#[test]
fn what_has_no_modes_is_refused() {
    let stiffness = chain(300, 1.0);
    let none = find(&stiffness, &diagonal(&[0.0; 300]), Modes::Count(3)).unwrap_err();
    assert!(none.to_string().contains("no modes"), "{none}");
    let mut lumped = vec![1.0; 300];
    lumped[8] = -1.0;
    let negative = find(&stiffness, &diagonal(&lumped), Modes::Count(3)).unwrap_err();
    assert!(negative.to_string().contains("row 9"), "{negative}");
    assert!(find(&stiffness, &diagonal(&[1.0; 299]), Modes::Count(3)).is_err());
    assert!(find(&matrix(0, &[]), &matrix(0, &[]), Modes::Count(1)).is_err());
    for many in [301, usize::MAX] {
        let error = find(&stiffness, &unit_mass(300), Modes::Count(many)).unwrap_err();
        assert!(error.to_string().contains("only 300 were found"), "{error}");
    }
    // a freedom with neither stiffness nor mass
    for masses in [30, 300] {
        let mut lumped = vec![1.0; masses + 1];
        lumped[masses] = 0.0;
        let loose = matrix(masses + 1, &chain_entries(masses, 1.0, 0));
        match find(&loose, &diagonal(&lumped), Modes::Count(3)).unwrap_err() {
            FlexibleError::Singular { row, .. } => assert_eq!(row, masses),
            other => panic!("{other}"),
        }
    }
    assert!(
        find(&stiffness, &unit_mass(300), Modes::Count(0))
            .unwrap()
            .vectors
            .is_empty()
    );
}

#[test]
fn the_same_bits_come_out_every_time() {
    let (stiffness, mass) = elastic_box([7, 6, 5]);
    let one = find(&stiffness, &mass, Modes::Count(25)).unwrap();
    let two = find(&stiffness, &mass, Modes::Count(25)).unwrap();
    let bits =
        |values: &[f64]| -> Vec<u64> { values.iter().map(|value| value.to_bits()).collect() };
    assert_eq!(bits(&one.eigenvalues), bits(&two.eigenvalues));
    assert_eq!(bits(&one.vectors), bits(&two.vectors));
    assert_eq!(bits(&one.residuals), bits(&two.residuals));
}
