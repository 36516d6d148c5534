//! Corrections of a kept matrix along slow directions.

use eng_system::dense::{add_scaled, dot};
use eng_system::secants::Secants;

const SIZE: usize = 7;

/// A matrix that differs from 1 by two directions, times a vector.
fn exact(x: &[f64]) -> Vec<f64> {
    let slow: [[f64; SIZE]; 2] = [
        [0.6, 0.0, 0.3, 0.0, -0.2, 0.5, 0.1],
        [0.0, 0.7, -0.1, 0.2, 0.4, 0.0, 0.3],
    ];
    let mut out = x.to_vec();
    for (size, row) in [0.4, -0.3].iter().zip(&slow) {
        add_scaled(&mut out, size * dot(row, x), row);
    }
    out
}

/// Corrections with a kept matrix 1 until the largest is below 1e-12: their number, and the solution.
fn solve(rhs: &[f64], mut secants: Option<&mut Secants>) -> (usize, Vec<f64>) {
    let mut x = vec![0.0; SIZE];
    let mut last: Option<(Vec<f64>, Vec<f64>)> = None;
    for count in 1..100 {
        let product = exact(&x);
        let plain: Vec<f64> = rhs.iter().zip(&product).map(|(b, p)| b - p).collect();
        let mut move_by = plain.clone();
        if let Some(secants) = secants.as_deref_mut() {
            if let Some((moved, before)) = &last {
                secants.add(moved, before, &plain);
            }
            secants.improve(&mut move_by);
        }
        add_scaled(&mut x, 1.0, &move_by);
        if move_by.iter().all(|d| d.abs() < 1e-12) {
            return (count, x);
        }
        last = Some((move_by, plain));
    }
    (100, x)
}

#[test]
fn slow_directions_are_found_and_kept() {
    let mut secants = Secants::new(SIZE);
    for (rhs, most) in [
        ([1.0, -2.0, 0.5, 3.0, 1.0, -1.0, 0.2], 5),
        ([0.3, 1.0, -1.0, 0.0, 2.0, 1.0, 1.0], 4),
    ] {
        let (plain, expected) = solve(&rhs, None);
        let (count, found) = solve(&rhs, Some(&mut secants));
        assert!(plain > 15 && count <= most, "{plain} and {count}");
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-11);
        }
    }
    // the kept matrix misses at most the larger of the two directions, 0.4 · 0.75 in length
    assert!(
        (0.05..0.5).contains(&secants.missed()),
        "{}",
        secants.missed()
    );
    secants.clear();
    let mut same = vec![1.0; SIZE];
    secants.improve(&mut same);
    assert_eq!(same, vec![1.0; SIZE]);
}

#[test]
fn repeated_pairs_count_once() {
    let mut secants = Secants::new(2);
    for size in [1.0, 0.5, 0.25] {
        // A⁻¹J = 1.25 along the first direction
        secants.add(&[size, 0.0], &[1.25 * size, 0.0], &[0.0, 0.0]);
    }
    let mut correction = vec![2.5, 1.0];
    secants.improve(&mut correction);
    assert!((correction[0] - 2.0).abs() < 1e-14 && correction[1] == 1.0);
}

#[test]
fn a_checkpoint_keeps_all() {
    let mut secants = Secants::new(SIZE);
    solve(&[1.0; SIZE], Some(&mut secants));
    let mut other = Secants::new(SIZE);
    other.set_numbers(&secants.numbers());
    assert_eq!(other, secants);
}
