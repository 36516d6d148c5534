//! Rows that depend on others, and the directions that rows leave free.

use eng_runtime::assembly::closing::Numbers;
use eng_runtime::assembly::gradients::Gradients;
use eng_runtime::assembly::independent::{FEW, Independent, solution};
use eng_runtime::assembly::placement::cube_rotations;
use eng_runtime::internals::{decompose, dependencies, dependent_rows, free_of, split, unit_rows};
use eng_runtime::rotation::M3;
use nalgebra::{DMatrix, DVector};

#[test]
fn a_cube_has_24_rotations() {
    let cubes = cube_rotations();
    assert_eq!(cubes.len(), 24);
    assert_eq!(cubes[0], M3::identity());
    for (i, a) in cubes.iter().enumerate() {
        assert!((a.determinant() - 1.0).abs() < 1e-15);
        assert!(cubes[..i].iter().all(|b| b != a));
    }
}

/// Rows that touch two neighbours, as those of a chain whose bodies have any order.
fn chain(rows: usize, numbers: &mut Numbers) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(5 * rows, 6 * rows);
    let place = |body: usize| 6 * ((3 * body) % rows);
    for i in 0..5 * rows {
        for body in (i / 5).saturating_sub(1)..=i / 5 {
            for j in place(body)..place(body) + 6 {
                matrix[(i, j)] = numbers.draw();
            }
        }
    }
    matrix
}

#[test]
fn the_solution_is_that_of_singular_values() {
    let mut numbers = Numbers::new(3);
    for rows in [1, 2, 7, 20] {
        let matrix = chain(rows, &mut numbers);
        let rhs = DVector::from_fn(5 * rows, |_, _| numbers.draw());
        let found = solution(&Gradients::of(&matrix), &rhs).expect("independent rows");
        let svd = decompose(matrix.clone()).expect("numbers");
        let expected = svd.solve(&rhs, 0.0).expect("numbers");
        assert!((&found - &expected).amax() < 1e-10 * expected.amax());
        assert!((&matrix * &found - &rhs).amax() < 1e-14 * found.amax().max(1.0));
    }
}

#[test]
fn repeated_rows_have_the_least_squares_of_singular_values() {
    let mut numbers = Numbers::new(7);
    let bodies = 40;
    let mut matrix = chain(bodies, &mut numbers);
    // more rows than an analysis by singular values would take, every third of them a sum of others
    for i in (0..5 * bodies - 6).step_by(3) {
        let sum = 0.5 * matrix.row(i + 1) - 2.0 * matrix.row(i + 5);
        matrix.set_row(i, &sum);
    }
    let x = DVector::from_fn(6 * bodies, |_, _| numbers.draw());
    let svd = decompose(matrix.clone()).expect("numbers");
    let threshold = 1e-9 * svd.singular_values.amax();
    let consistent = &matrix * x;
    let other = DVector::from_fn(5 * bodies, |_, _| numbers.draw());
    for rhs in [consistent, other] {
        let found = solution(&Gradients::of(&matrix), &rhs).expect("dependent rows");
        let expected = svd.solve(&rhs, threshold).expect("numbers");
        let error = (&found - &expected).amax();
        assert!(error < 1e-10 * expected.amax(), "{error}");
    }
}

#[test]
fn nearly_dependent_rows_are_left_to_another_method() {
    let mut numbers = Numbers::new(5);
    let mut matrix = chain(4, &mut numbers);
    let sum = matrix.row(0) + matrix.row(19);
    matrix.set_row(11, &sum);
    let rhs = DVector::from_element(20, 1.0);
    let of = |matrix: &DMatrix<f64>| Independent::of(&Gradients::of(matrix)).unwrap();
    assert_eq!(of(&matrix).dependent_part(), [0, 11, 19]);
    assert!(of(&matrix).is_decided());
    // nearly dependent
    matrix[(11, 0)] += 2e-6;
    assert!(solution(&Gradients::of(&matrix), &rhs).is_none());
    assert!(!of(&matrix).is_decided());
    let zeros = Gradients::new(2, 3);
    let found = solution(&zeros, &DVector::from_element(2, 1.0));
    assert_eq!(found, Some(DVector::zeros(3)));
    assert_eq!(Independent::of(&zeros).unwrap().dependent_part(), [0, 1]);
}

#[test]
fn free_motions_are_those_of_the_projector() {
    let mut numbers = Numbers::new(9);
    let matrix = chain(5, &mut numbers);
    let factor = Independent::of(&Gradients::of(&matrix)).unwrap();
    let mut x = DVector::from_fn(30, |_, _| numbers.draw());
    let before = x.clone();
    factor.free(&mut x);
    assert!((&matrix * &x).amax() < 1e-13);
    // the removed part is normal to every free motion
    let mut other = DVector::from_fn(30, |_, _| numbers.draw());
    factor.free(&mut other);
    assert!((before - &x).dot(&other).abs() < 1e-13);
    assert!(x.norm() > 0.1);
    let basis = factor.basis();
    assert_eq!(basis.ncols(), 5);
    assert!((&matrix * &basis).amax() < 1e-13);
    assert!((basis.tr_mul(&basis) - DMatrix::identity(5, 5)).amax() < 1e-13);
}

#[test]
fn splits_a_space() {
    // the third row repeats the first two
    let rows = DMatrix::from_row_slice(
        3,
        4,
        &[1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0],
    );
    let picked = split(&rows).unwrap();
    assert_eq!((picked.pick.nrows(), picked.free.ncols()), (2, 2));
    assert!((&rows * &picked.free).amax() < 1e-14);
    // the combinations still determine the same directions as the rows
    let square = DMatrix::from_fn(4, 4, |i, j| {
        if i < 2 {
            (&picked.pick * &rows)[(i, j)]
        } else {
            picked.free[(j, i - 2)]
        }
    });
    assert!(square.determinant().abs() > 0.1);
    assert!(split(&DMatrix::from_element(1, 1, f64::NAN)).is_none());
    assert_eq!(split(&DMatrix::zeros(0, 3)).unwrap().free.ncols(), 3);
}

#[test]
fn many_rows_leave_the_directions_of_singular_values() {
    // each row touches the next three columns; one repeats its neighbour
    let (rows, space) = (FEW + 10, 170);
    let mut matrix = DMatrix::from_fn(rows, space, |i, j| match j.checked_sub(i) {
        Some(0) => 1.0,
        Some(k) if k < 4 => libm::sin((3 * i + 7 * k) as f64),
        _ => 0.0,
    });
    let twice = matrix.row(6) * 2.0;
    matrix.set_row(7, &twice);
    unit_rows(&mut matrix, 0.0);
    let expected = split(&matrix).unwrap().free;
    let found = free_of(&matrix).unwrap();
    assert_eq!(found.shape(), (space, space - rows + 1));
    // the same projector on the same directions
    let projector = |basis: &DMatrix<f64>| basis * basis.transpose();
    assert!((projector(&found) - projector(&expected)).amax() < 1e-10);
    assert!(Independent::alone(&Gradients::of(&matrix)).is_some());
    // without a clear decision the singular values decide
    matrix[(7, 9)] += 9e-7;
    assert!(Independent::alone(&Gradients::of(&matrix)).is_none());
    assert_eq!(free_of(&matrix).unwrap().ncols(), space - rows + 1);
    matrix[(0, 0)] = f64::NAN;
    assert!(free_of(&matrix).is_none());
}

#[test]
fn names_the_rows_that_repeat() {
    let m = DMatrix::from_row_slice(
        4,
        5,
        &[
            1.0, 0.0, 0.0, 0.0, 1.0, //
            0.0, 2.0, 0.0, 1.0, 0.0, //
            0.0, 0.0, 3.0, 0.0, 0.0, //
            1.0, 2.0, 0.0, 1.0, 1.0,
        ],
    );
    let found = dependencies(&m);
    assert_eq!(found.len(), 1);
    let mut names: Vec<usize> = found[0].1.iter().map(|(r, _)| *r).collect();
    names.push(found[0].0);
    names.sort_unstable();
    assert_eq!(names, [0, 1, 3]);
    assert!(dependencies(&DMatrix::identity(3, 4)).is_empty());
}

/// A chain of bodies, each held at its neighbour by five rows. One is a sum of others, another holds
/// nothing: the rows named are those of the whole matrix.
#[test]
fn of_many_rows_the_same_ones_repeat() {
    let mut numbers = Numbers::new(11);
    let bodies = 41;
    let mut m = DMatrix::zeros(5 * bodies, 6 * bodies);
    for i in 0..5 * bodies {
        let own = 6 * (i / 5);
        for j in own.saturating_sub(6)..own + 6 {
            m[(i, j)] = numbers.draw();
        }
    }
    assert!(m.nrows() > FEW);
    assert!(dependent_rows(&Gradients::of(&m)).is_empty());
    let sum = m.row(63) - m.row(66) * 0.5;
    m.set_row(64, &sum);
    m.row_mut(201).fill(0.0);
    let found = dependent_rows(&Gradients::of(&m));
    let whole = dependencies(&m);
    assert_eq!(found.len(), 2);
    assert_eq!(whole.len(), 2);
    for rows in [found, whole] {
        let mut concerned = Vec::new();
        for (row, shares) in &rows {
            concerned.push(*row);
            concerned.extend(shares.iter().map(|(r, _)| *r));
            let mut rest = m.row(*row) / m.row(*row).norm().max(f64::MIN_POSITIVE);
            for (r, share) in shares {
                rest -= m.row(*r) * (*share / m.row(*r).norm());
            }
            assert!(rest.norm() < 1e-12);
        }
        concerned.sort_unstable();
        assert_eq!(concerned, [63, 64, 66, 201]);
    }
}

#[test]
fn rows_that_hold_nothing_repeat_nothing() {
    let found = dependencies(&DMatrix::zeros(2, 6));
    assert_eq!(found, [(0, Vec::new()), (1, Vec::new())]);
    assert!(dependencies(&DMatrix::zeros(0, 6)).is_empty());
}
