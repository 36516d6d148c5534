//! Factorisations by blocks against dense elimination with full pivoting.

use eng_runtime::assembly::closing::Numbers;
use eng_runtime::linear::dissection::Dissection;
use eng_runtime::linear::{BlockLu, LinearError, LinearSolver, Pattern, PatternBuilder, SparseLu};
use nalgebra::{DMatrix, DVector};

/// A mechanism's matrix `[M + K, Φᵀ; Φ, 0]`: bodies with their widths, joints between two of them (or one and
/// the ground), loads.
struct Mechanism {
    widths: Vec<usize>,
    joints: Vec<(usize, Option<usize>, usize)>,
    loads: Vec<(usize, usize)>,
}

impl Mechanism {
    fn at(&self, body: usize) -> std::ops::Range<usize> {
        let first: usize = self.widths[..body].iter().sum();
        first..first + self.widths[body]
    }

    fn rows(&self, joint: usize) -> std::ops::Range<usize> {
        let bodies: usize = self.widths.iter().sum();
        let first: usize = bodies + self.joints[..joint].iter().map(|j| j.2).sum::<usize>();
        first..first + self.joints[joint].2
    }

    fn size(&self) -> usize {
        self.rows(self.joints.len() - 1).end
    }

    fn pattern(&self) -> Pattern {
        let mut builder = PatternBuilder::new(self.size());
        let mut couple = |a: usize, b: usize| {
            for (i, j) in [(a, a), (a, b), (b, a), (b, b)] {
                builder.reserve(self.at(i), self.at(j));
            }
        };
        for body in 0..self.widths.len() {
            couple(body, body);
        }
        for (a, b) in &self.loads {
            couple(*a, *b);
        }
        for (a, b, _) in &self.joints {
            couple(*a, b.unwrap_or(*a));
        }
        for (index, (a, b, _)) in self.joints.iter().enumerate() {
            for body in [Some(*a), *b].into_iter().flatten() {
                builder.reserve(self.rows(index), self.at(body));
                builder.reserve(self.at(body), self.rows(index));
            }
        }
        builder.finish()
    }

    /// Masses of very different size, stiffness between bodies of the given size, no diagonal at the multipliers.
    fn matrix(&self, stiffness: f64, numbers: &mut Numbers) -> DMatrix<f64> {
        let mut a = DMatrix::zeros(self.size(), self.size());
        for body in 0..self.widths.len() {
            let range = self.at(body);
            let n = range.len();
            let root =
                DMatrix::from_fn(n, n, |i, j| numbers.draw() + if i == j { 3.0 } else { 0.0 });
            let mass = libm::pow(10.0, 2.0 * numbers.draw() - 1.0);
            a.view_mut((range.start, range.start), (n, n))
                .copy_from(&(&root * root.transpose() * mass));
        }
        let mut soften = |a: &mut DMatrix<f64>, i: usize, j: usize| {
            for r in self.at(i).chain(self.at(j)) {
                for c in self.at(i).chain(self.at(j)) {
                    a[(r, c)] += stiffness * numbers.draw();
                }
            }
        };
        for (i, j) in &self.loads {
            soften(&mut a, *i, *j);
        }
        for (i, j, _) in &self.joints {
            soften(&mut a, *i, j.unwrap_or(*i));
        }
        for (index, (i, j, _)) in self.joints.iter().enumerate() {
            for body in [Some(*i), *j].into_iter().flatten() {
                for r in self.rows(index) {
                    for c in self.at(body) {
                        let g = numbers.draw();
                        a[(r, c)] = g;
                        a[(c, r)] = g * (1.0 + 0.01 * stiffness * numbers.draw());
                    }
                }
            }
        }
        a
    }

    /// Crank and block of the given widths; rod and piston a cylinder; flywheel and dynamometer.
    fn engine(cylinders: usize, crank: usize, block: usize) -> Mechanism {
        let mut widths = vec![crank, block];
        let mut joints = vec![(1, None, 6), (0, Some(1), 1)];
        let mut loads = vec![(0, 1)];
        for cylinder in 0..cylinders {
            let (rod, piston) = (2 + 2 * cylinder, 3 + 2 * cylinder);
            widths.extend([6, 6]);
            joints.extend([
                (rod, Some(0), 5),
                (rod, Some(piston), 2),
                (piston, Some(1), 5),
            ]);
            loads.push((piston, 1));
        }
        let flywheel = widths.len();
        widths.extend([6, 6]);
        joints.extend([(flywheel, Some(0), 6), (flywheel + 1, None, 6)]);
        loads.push((flywheel, flywheel + 1));
        Mechanism {
            widths,
            joints,
            loads,
        }
    }

    /// Bodies one after the other; every second one wider.
    fn chain(bodies: usize, rows: usize) -> Mechanism {
        Mechanism {
            widths: (0..bodies)
                .map(|b| if b % 2 == 0 { 6 } else { 9 })
                .collect(),
            joints: (0..bodies).map(|b| (b, b.checked_sub(1), rows)).collect(),
            loads: (2..bodies).map(|b| (b, b - 2)).collect(),
        }
    }
}

fn values(pattern: &Pattern, a: &DMatrix<f64>) -> Vec<f64> {
    let places = pattern.places();
    places.map(|(_, row, column)| a[(row, column)]).collect()
}

/// Largest residual of a solution, row by row, over the terms whose difference it is.
fn backward_error(a: &DMatrix<f64>, x: &DVector<f64>, b: &DVector<f64>) -> f64 {
    let residual = a * x - b;
    let size = a.abs() * x.abs() + b.abs();
    residual
        .iter()
        .zip(size.iter())
        .map(|(r, s)| if *r == 0.0 { 0.0 } else { r.abs() / s })
        .fold(0.0, f64::max)
}

fn solve(solver: &mut dyn LinearSolver, b: &DVector<f64>) -> DVector<f64> {
    let mut x = b.clone();
    solver.solve(x.as_mut_slice());
    x
}

/// Factors and compares; returns the number of fallbacks to the general factorisation.
fn check(pattern: &Pattern, a: &DMatrix<f64>, numbers: &mut Numbers) -> u64 {
    let mut blocks = BlockLu::new(pattern);
    let values = values(pattern, a);
    blocks.factor(&values).unwrap();
    let reference = a.clone().full_piv_lu();
    for _ in 0..3 {
        let b = DVector::from_fn(pattern.size(), |_, _| numbers.draw());
        let x = solve(&mut blocks, &b);
        let expected = reference.solve(&b).unwrap();
        let error = backward_error(a, &x, &b);
        assert!(error < 1e-11, "backward error {error:e}");
        let allowed = 1e3 * (backward_error(a, &expected, &b) + 1e-16) * expected.amax();
        // both within the rounding errors that the condition of the matrix allows
        let inverse = reference.solve(&DMatrix::identity(a.nrows(), a.nrows()));
        let condition = inverse.unwrap().abs().row_sum().max() * a.abs().row_sum().max();
        assert!((&x - &expected).amax() < allowed * condition.max(1.0));
    }
    blocks.fallbacks()
}

fn mechanisms() -> Vec<Mechanism> {
    vec![
        Mechanism::engine(4, 6, 6),
        Mechanism::engine(3, 34, 26),
        Mechanism::engine(12, 6, 26),
        Mechanism::chain(1, 3),
        Mechanism::chain(40, 5),
        Mechanism::chain(17, 2),
        // two parts without a coupling
        Mechanism {
            widths: vec![6, 6, 6, 6],
            joints: vec![(0, Some(1), 5), (2, Some(3), 5)],
            loads: vec![],
        },
        // a joint to a body twice: more multipliers in a piece than freedoms
        Mechanism {
            widths: vec![30, 6, 6, 26],
            joints: vec![
                (1, Some(0), 5),
                (1, Some(2), 5),
                (2, Some(3), 5),
                (0, None, 1),
            ],
            loads: vec![],
        },
    ]
}

#[test]
fn solutions_are_those_of_dense_elimination() {
    let mut numbers = Numbers::new(5);
    for (index, mechanism) in mechanisms().iter().enumerate() {
        let pattern = mechanism.pattern();
        for stiffness in [0.0, 1e-3, 1.0] {
            let a = mechanism.matrix(stiffness, &mut numbers);
            assert_eq!(check(&pattern, &a, &mut numbers), 0, "mechanism {index}");
        }
    }
}

#[test]
fn every_unknown_is_eliminated_once_and_borders_lie_above() {
    let mut all_mechanisms = mechanisms();
    all_mechanisms.push(Mechanism::chain(150, 5));
    // every body tied to every other
    all_mechanisms.push(Mechanism {
        widths: vec![6; 20],
        joints: vec![(0, None, 1)],
        loads: (0..20).flat_map(|i| (0..i).map(move |j| (i, j))).collect(),
    });
    for mechanism in all_mechanisms {
        let pattern = mechanism.pattern();
        let plan = Dissection::new(&pattern);
        let fronts = plan.fronts();
        let mut all: Vec<usize> = fronts.iter().flat_map(|f| f.pivots.clone()).collect();
        all.sort_unstable();
        assert!(all.iter().copied().eq(0..pattern.size()));
        for (index, front) in fronts.iter().enumerate() {
            let Some(parent) = front.parent else {
                assert!(front.border.is_empty());
                continue;
            };
            assert!(parent > index);
            for unknown in &front.border {
                let above = &fronts[parent];
                assert!(above.pivots.contains(unknown) || above.border.contains(unknown));
            }
        }
    }
}

/// Rods and pistons are blocks of their own. Crank and block come last, with the other multipliers. So the work grows
/// with the number of cylinders.
#[test]
fn an_engine_falls_into_its_cylinders() {
    let sizes = |cylinders: usize| -> Vec<(usize, usize)> {
        let pattern = Mechanism::engine(cylinders, 34, 26).pattern();
        let plan = Dissection::new(&pattern);
        let fronts = plan.fronts();
        let mut sizes: Vec<_> = fronts
            .iter()
            .map(|f| (f.pivots.len(), f.border.len()))
            .collect();
        sizes.sort_unstable();
        sizes
    };
    for cylinders in [2, 4, 12] {
        let mut expected = vec![(24, 34)];
        expected.extend(vec![(24, 60); cylinders]);
        expected.push((67, 0));
        assert_eq!(sizes(cylinders), expected);
    }
}

/// Where a body's own block is singular, or zero on its whole diagonal, its pivots come later or from other rows.
#[test]
fn pivots_that_vanish_are_found_elsewhere() {
    let mut numbers = Numbers::new(9);
    let mechanism = Mechanism::engine(4, 10, 8);
    let pattern = mechanism.pattern();
    let n = pattern.size();
    let mut a = mechanism.matrix(0.3, &mut numbers);
    for i in 0..n {
        a[(i, i)] = 0.0;
    }
    assert_eq!(check(&pattern, &a, &mut numbers), 0);
    // a rod without any inertia: joints alone hold it, one freedom by a stiffness to the crank
    let mut a = mechanism.matrix(0.0, &mut numbers);
    let (rod, crank) = (mechanism.at(2), mechanism.at(0));
    for i in rod.clone() {
        for j in rod.clone() {
            a[(i, j)] = 0.0;
        }
        for j in crank.clone() {
            a[(i, j)] = numbers.draw();
            a[(j, i)] = numbers.draw();
        }
    }
    assert_eq!(check(&pattern, &a, &mut numbers), 0);
    // the multipliers of one cylinder do not depend on the rod: its piece alone is singular
    let mut a = mechanism.matrix(0.1, &mut numbers);
    for joint in [2, 3] {
        for row in mechanism.rows(joint) {
            for i in rod.clone() {
                a[(row, i)] = 0.0;
                a[(i, row)] = 0.0;
            }
        }
    }
    assert_eq!(check(&pattern, &a, &mut numbers), 0);
}

#[test]
fn rows_and_columns_of_very_different_size_are_solved() {
    let mut numbers = Numbers::new(21);
    for mechanism in mechanisms() {
        let pattern = mechanism.pattern();
        let mut a = mechanism.matrix(0.2, &mut numbers);
        for i in 0..pattern.size() {
            let (row, column) = (3.0 * numbers.draw(), 3.0 * numbers.draw());
            a.row_mut(i).scale_mut(libm::pow(10.0, row));
            a.column_mut(i).scale_mut(libm::pow(10.0, column));
        }
        let mut blocks = BlockLu::new(&pattern);
        blocks.factor(&values(&pattern, &a)).unwrap();
        let b = DVector::from_fn(pattern.size(), |i, _| numbers.draw() * a.row(i).amax());
        let x = solve(&mut blocks, &b);
        let error = backward_error(&a, &x, &b);
        assert!(error < 1e-9, "backward error {error:e}");
    }
}

/// Both refuse the same matrices, and recover afterwards.
#[test]
fn singular_matrices_are_refused_as_by_the_general_factorisation() {
    let mut numbers = Numbers::new(33);
    let mechanism = Mechanism::engine(4, 12, 6);
    let pattern = mechanism.pattern();
    let sound = mechanism.matrix(0.2, &mut numbers);
    let n = pattern.size();
    let mut cases = Vec::new();
    // a constraint stated twice, in a cylinder and at the block
    for joint in [4, 0] {
        let rows = mechanism.rows(joint);
        let mut a = sound.clone();
        let (first, second) = (rows.start, rows.start + 1);
        let row = a.row(first).clone_owned();
        a.set_row(second, &row);
        let column = a.column(first).clone_owned();
        a.set_column(second, &column);
        cases.push(a);
    }
    // a column of zeros, a matrix of zeros, a body without inertia or joints
    let mut a = sound.clone();
    a.column_mut(14).fill(0.0);
    cases.push(a);
    cases.push(DMatrix::zeros(n, n));
    let mut a = sound.clone();
    a[(3, 3)] = f64::NAN;
    cases.push(a);
    let (mut blocks, mut general) = (BlockLu::new(&pattern), SparseLu::new(&pattern).unwrap());
    for (index, a) in cases.iter().enumerate() {
        let values = values(&pattern, a);
        assert_eq!(
            blocks.factor(&values),
            Err(LinearError::Singular),
            "{index}"
        );
        assert_eq!(
            general.factor(&values),
            Err(LinearError::Singular),
            "{index}"
        );
        let mut x = vec![1.0; n];
        blocks.solve(&mut x);
        assert!(x.iter().all(|x| x.is_nan()));
        blocks.factor(&self::values(&pattern, &sound)).unwrap();
        let b = DVector::from_fn(n, |_, _| numbers.draw());
        assert!(backward_error(&sound, &solve(&mut blocks, &b), &b) < 1e-11);
    }
    assert!(blocks.factor(&[1.0]).is_err());
}

/// The same values give the same bits after any earlier factorisation, also after a block had to pass on pivots.
#[test]
fn factors_do_not_remember() {
    let mut numbers = Numbers::new(41);
    let mechanism = Mechanism::engine(3, 12, 6);
    let pattern = mechanism.pattern();
    let sound = mechanism.matrix(0.2, &mut numbers);
    let mut odd = sound.clone();
    let rod = mechanism.at(2);
    for row in mechanism.rows(2).chain(mechanism.rows(3)) {
        for i in rod.clone() {
            odd[(row, i)] = 0.0;
            odd[(i, row)] = 0.0;
        }
    }
    let b = DVector::from_fn(pattern.size(), |_, _| numbers.draw());
    let (mut first, mut second) = (BlockLu::new(&pattern), BlockLu::new(&pattern));
    first.factor(&values(&pattern, &sound)).unwrap();
    let before = solve(&mut first, &b);
    first.factor(&values(&pattern, &odd)).unwrap();
    let between = solve(&mut first, &b);
    first.factor(&values(&pattern, &sound)).unwrap();
    assert_eq!(before, solve(&mut first, &b));
    second.factor(&values(&pattern, &odd)).unwrap();
    assert_eq!(between, solve(&mut second, &b));
    assert_eq!(first.fallbacks() + second.fallbacks(), 0);
}

/// A chain of bodies is halved again and again: no block grows with its length.
#[test]
fn blocks_of_a_chain_stay_small() {
    for bodies in [40, 160] {
        let mechanism = Mechanism {
            loads: vec![],
            ..Mechanism::chain(bodies, 5)
        };
        let plan = Dissection::new(&mechanism.pattern());
        let fronts = plan.fronts();
        let largest = fronts.iter().map(|f| f.pivots.len() + f.border.len());
        assert!(largest.max().unwrap_or(0) <= 60);
    }
}

/// Pivots too small for a reciprocal: the general factorisation is used and reported, and the next matrix uses blocks
/// again.
#[test]
fn the_general_factorisation_stands_behind() {
    let mut numbers = Numbers::new(57);
    let mechanism = Mechanism::engine(2, 8, 6);
    let pattern = mechanism.pattern();
    let a = mechanism.matrix(0.2, &mut numbers);
    let values = values(&pattern, &a);
    let tiny: Vec<f64> = values.iter().map(|v| v * 1e-260).collect();
    let b = DVector::from_fn(pattern.size(), |_, _| numbers.draw());
    let mut blocks = BlockLu::new(&pattern);
    blocks.factor(&values).unwrap();
    let x = solve(&mut blocks, &b);
    blocks.factor(&tiny).unwrap();
    assert_eq!(blocks.fallbacks(), 1);
    let y = solve(&mut blocks, &(&b * 1e-260));
    assert!((&x - &y).amax() < 1e-8 * x.amax());
    blocks.factor(&values).unwrap();
    assert_eq!(blocks.fallbacks(), 1);
    assert_eq!(x, solve(&mut blocks, &b));
}

#[test]
fn a_system_without_unknowns_is_solved() {
    let pattern = PatternBuilder::new(0).finish();
    let mut blocks = BlockLu::new(&pattern);
    blocks.factor(&[]).unwrap();
    blocks.solve(&mut []);
}

#[test]
fn solves_and_refuses_singular() {
    let mut builder = PatternBuilder::new(3);
    builder.reserve(0..2, 1..3);
    builder.reserve(1..3, 0..1);
    let pattern = builder.finish();
    let mut lu = SparseLu::new(&pattern).unwrap();
    let mut values = vec![0.0; pattern.count()];
    pattern
        .block(0, 1..3)
        .add(&mut values, &[1.0, 2.0, 0.0, 3.0], 1.0);
    pattern.block(1, 0..1).add(&mut values, &[4.0, 5.0], 1.0);
    lu.factor(&values).unwrap();
    let x = [1.0, -2.0, 3.0];
    let mut b = [0.0; 3];
    pattern.multiply(&values, &x, &mut b);
    lu.solve(&mut b);
    for (a, b) in x.iter().zip(b) {
        assert!((a - b).abs() < 1e-14);
    }
    values.fill(0.0);
    pattern
        .block(0, 1..3)
        .add(&mut values, &[1.0, 2.0, 1.0, 2.0], 1.0);
    assert_eq!(lu.factor(&values), Err(LinearError::Singular));
}
