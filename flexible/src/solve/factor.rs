//! Factors of sparse symmetric matrices: `L Lᵀ` of positive definite ones, `L B Lᵀ` of indefinite ones.
//!
//! The factorisation is supernodal (dense panels of columns with the same rows). One [`Analysis`] serves all
//! matrices of one pattern, such as `K − σ M` for all shifts.
//!
//! We compared two ways. faer's factorisation of a sparse matrix stores a block of columns as one rectangle, with
//! zeros above its diagonal, and its threads share one product at a time. Panels of limited width store fewer zeros,
//! and threads work on whole branches of the tree of elimination.

use super::numeric::{self, Pairs, Stopped};
use super::ordering::{Ordering, out_of_memory};
use super::panels::Panels;
use super::substitution::Substitution;
use crate::error::FlexibleError;
use crate::sparse::{SymmetricMatrix, SymmetricOperator};
use eng_system::significant::short;
use std::sync::Arc;

/// A pivot is a rounding error and not a stiffness if its ratio to the entry before the elimination is below
/// this. Foreign matrices have 13 or 14 digits, so their rigid motions leave pivots of about 1e-13.
const LOST: f64 = 1e-12;
/// The same ratio for an indefinite matrix. Its pivots may come closer to zero, at a shift near an
/// eigenvalue. A choice some units above the rounding unit.
const LOST_INDEFINITE: f64 = 1e-14;
/// Number of right-hand sides solved together. A choice: the factor is read once for all of them, and their
/// columns fit in the cache.
const TOGETHER: usize = 32;

/// The known definiteness of a matrix before its factorisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Definiteness {
    /// All eigenvalues are positive.
    Positive,
    /// Some eigenvalues may be negative. The factorisation counts them.
    Indefinite,
}

/// The order of elimination and the structure of the factor for one pattern.
#[derive(Debug)]
pub struct Analysis {
    panels: Panels,
    ordering: Ordering,
    /// Hash of the pattern, and number of its entries. Every factorisation compares them, because the factor of
    /// another pattern has other places.
    pattern: (u64, usize),
}

impl Analysis {
    /// The analysis of a matrix's pattern, in the given order.
    ///
    /// # Errors
    /// When the order is not of this matrix's rows, or memory or indices run out.
    pub fn new(matrix: &SymmetricMatrix, ordering: Ordering) -> Result<Analysis, FlexibleError> {
        let size = matrix.size();
        if ordering.forward().len() != size {
            return Err(FlexibleError::Matrix {
                problem: format!(
                    "an order of {} rows for a matrix of {size}",
                    ordering.forward().len()
                ),
                advice: String::new(),
            });
        }
        let panels = Panels::new(matrix, ordering.forward(), ordering.inverse())?;
        Ok(Analysis {
            panels,
            ordering,
            pattern: pattern_of(matrix),
        })
    }

    /// The analysis of a matrix's pattern, in the order that [`Ordering::fill_reducing`] finds.
    ///
    /// # Errors
    /// When memory or indices run out.
    pub fn fill_reducing(matrix: &SymmetricMatrix) -> Result<Analysis, FlexibleError> {
        Analysis::new(matrix, Ordering::fill_reducing(matrix)?)
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.ordering.forward().len()
    }

    /// The order of elimination.
    pub fn ordering(&self) -> &Ordering {
        &self.ordering
    }

    /// Number of stored values of a factor: its entries, and the zeros that complete its blocks to
    /// rectangles.
    pub fn stored(&self) -> usize {
        self.panels.stored()
    }

    /// Number of branches of the tree of elimination that threads factor side by side.
    pub fn branches(&self) -> usize {
        self.panels.branches().len()
    }

    /// Visits the pivots block by block, with their index in the factor's values and their index in the
    /// order.
    fn each_pivot(&self, mut visit: impl FnMut(usize, usize)) {
        for panel in 0..self.panels.count() {
            let (height, first) = (self.panels.height(panel), self.panels.place(panel).start);
            for (place, index) in self.panels.columns(panel).enumerate() {
                visit(first + place * (height + 1), index);
            }
        }
    }

    /// The first column of the panel of each column.
    fn starts(&self) -> Vec<u32> {
        let mut starts = vec![0; self.size()];
        for panel in 0..self.panels.count() {
            let columns = self.panels.columns(panel);
            let first = columns.start as u32;
            starts[columns].fill(first);
        }
        starts
    }

    /// The row of a pivot: its panel exchanges rows by `inside`.
    fn row_of_pivot(&self, index: usize, first: usize, inside: &[u32]) -> usize {
        let place = inside
            .get(index)
            .map_or(index, |&place| first + place as usize);
        self.ordering
            .forward()
            .get(place)
            .map_or(0, |&row| row as usize)
    }
}

/// A factored matrix.
#[derive(Debug)]
pub struct Factorization {
    analysis: Arc<Analysis>,
    values: Vec<f64>,
    /// Empty for a positive matrix.
    pairs: Pairs,
    negative: usize,
    threads: usize,
}

impl Factorization {
    /// Factors a matrix of the analysed pattern.
    ///
    /// # Errors
    /// [`FlexibleError::Singular`] when a pivot vanishes (or is negative although the matrix should be
    /// positive definite); [`FlexibleError::Matrix`] when the matrix is not finite or of another pattern.
    pub fn new(
        analysis: &Arc<Analysis>,
        matrix: &SymmetricMatrix,
        kind: Definiteness,
    ) -> Result<Factorization, FlexibleError> {
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Factorization::new_on(analysis, matrix, kind, threads)
    }

    /// Like [`Factorization::new`], on a number of threads, which also solve. The result does not depend on this
    /// number.
    ///
    /// # Errors
    /// See [`Factorization::new`].
    pub fn new_on(
        analysis: &Arc<Analysis>,
        matrix: &SymmetricMatrix,
        kind: Definiteness,
        threads: usize,
    ) -> Result<Factorization, FlexibleError> {
        Factorization::reusing(Vec::new(), analysis, matrix, kind, threads)
    }

    /// Like [`Factorization::new`], but in the memory of an earlier factorisation, because a factor needs by
    /// far the most memory.
    ///
    /// # Errors
    /// See [`Factorization::new`].
    pub fn replace(
        self,
        matrix: &SymmetricMatrix,
        kind: Definiteness,
    ) -> Result<Factorization, FlexibleError> {
        Factorization::reusing(self.values, &self.analysis, matrix, kind, self.threads)
    }

    fn reusing(
        mut values: Vec<f64>,
        analysis: &Arc<Analysis>,
        matrix: &SymmetricMatrix,
        kind: Definiteness,
        threads: usize,
    ) -> Result<Factorization, FlexibleError> {
        check(analysis, matrix)?;
        let stored = analysis.stored();
        // the factorisation overwrites the old values
        if values.len() != stored {
            values.clear();
            values
                .try_reserve_exact(stored)
                .map_err(|_| out_of_memory())?;
            values.resize(stored, 0.0);
        }
        let mut factor = Factorization {
            analysis: analysis.clone(),
            values,
            pairs: Pairs::default(),
            negative: 0,
            // more threads than this only wait for memory
            threads: threads.clamp(1, 16),
        };
        match kind {
            Definiteness::Positive => factor.factor_positive(matrix)?,
            Definiteness::Indefinite => factor.factor_indefinite(matrix)?,
        }
        Ok(factor)
    }

    /// Factors the values of a matrix.
    fn fill(&mut self, matrix: &SymmetricMatrix) -> Result<(), FlexibleError> {
        let panels = &self.analysis.panels;
        panels.scatter(matrix, self.analysis.ordering.inverse(), &mut self.values);
        let done = numeric::factor(panels, &mut self.values, &mut self.pairs, self.threads);
        done.map_err(|stopped| match stopped {
            Stopped::NotPositive(column) => singular(self.row_of(column), None),
            Stopped::Memory => out_of_memory(),
        })
    }

    fn factor_positive(&mut self, matrix: &SymmetricMatrix) -> Result<(), FlexibleError> {
        self.fill(matrix)?;
        let analysis = self.analysis.clone();
        let before = diagonal(matrix);
        let mut weakest = (0, f64::INFINITY);
        analysis.each_pivot(|place, index| {
            let row = self.row_of(index);
            let pivot = self.values[place];
            let ratio = pivot * pivot / before[row];
            weakest = weaker(weakest, (row, ratio));
        });
        self.settle(weakest, LOST)
    }

    fn factor_indefinite(&mut self, matrix: &SymmetricMatrix) -> Result<(), FlexibleError> {
        let analysis = self.analysis.clone();
        let size = analysis.size();
        self.pairs = Pairs {
            below: vec![0.0; size],
            forward: vec![0; size],
            inverse: vec![0; size],
        };
        self.fill(matrix)?;
        let Pairs { below, forward, .. } = &self.pairs;
        let before = pivot_scale(matrix);
        let starts = analysis.starts();
        let scale = |index: usize| {
            let row = analysis.row_of_pivot(index, starts[index] as usize, forward);
            (row, before[row])
        };
        let (mut weakest, mut negative) = ((0, f64::INFINITY), 0);
        let mut judge = |row: usize, ratio: f64| {
            weakest = weaker(weakest, (row, ratio));
        };
        // the first half of a pair of rows that make one pivot
        let mut half: Option<(f64, f64, usize)> = None;
        analysis.each_pivot(|place, index| {
            let pivot = self.values[place];
            if let Some((first, coupling, index_of_first)) = half.take() {
                let determinant = first * pivot - coupling * coupling;
                negative += if determinant < 0.0 {
                    1
                } else if first < 0.0 {
                    2
                } else {
                    0
                };
                let ((row, one), (_, two)) = (scale(index_of_first), scale(index));
                judge(row, (determinant.abs() / (one * two)).sqrt());
            } else if below[index] != 0.0 {
                half = Some((pivot, below[index], index));
            } else {
                negative += usize::from(pivot < 0.0);
                let (row, scale) = scale(index);
                judge(row, pivot.abs() / scale);
            }
        });
        self.negative = negative;
        self.settle(weakest, LOST_INDEFINITE)
    }

    /// Returns an error if the weakest pivot has lost too many digits.
    fn settle(&self, weakest: (usize, f64), lost: f64) -> Result<(), FlexibleError> {
        if self.analysis.size() == 0 {
            return Ok(());
        }
        if weakest.1 > lost && weakest.1.is_finite() {
            Ok(())
        } else {
            Err(singular(weakest.0, Some(weakest.1)))
        }
    }

    fn row_of(&self, index: usize) -> usize {
        self.analysis
            .ordering
            .forward()
            .get(index)
            .map_or(0, |&row| row as usize)
    }

    /// The analysis of this factor.
    pub fn analysis(&self) -> &Arc<Analysis> {
        &self.analysis
    }

    /// Number of negative eigenvalues of the matrix (Sylvester's law of inertia). For `K − σ M` with a
    /// positive semidefinite `M` it is the number of eigenvalues of the pencil below σ.
    pub fn negative_pivots(&self) -> usize {
        self.negative
    }

    /// Solves `A x = b` for right-hand sides stored one after the other, in their place.
    ///
    /// # Errors
    /// When the length is not a multiple of the matrix's size, or memory runs out.
    pub fn solve_in_place(&self, right_hand_sides: &mut [f64]) -> Result<(), FlexibleError> {
        let size = self.analysis.size();
        if right_hand_sides.is_empty() {
            return Ok(());
        }
        if size == 0 || !right_hand_sides.len().is_multiple_of(size) {
            return Err(FlexibleError::Matrix {
                problem: format!(
                    "right-hand sides of {} numbers for a matrix of {size} rows",
                    right_hand_sides.len()
                ),
                advice: String::new(),
            });
        }
        let together = (right_hand_sides.len() / size).min(TOGETHER);
        let order = self.analysis.ordering.forward();
        let mut rows = vec![0.0; size * together];
        for block in right_hand_sides.chunks_mut(size * together) {
            let count = block.len() / size;
            let rows = &mut rows[..block.len()];
            for (&row, out) in order.iter().zip(rows.chunks_exact_mut(count)) {
                for (column, out) in out.iter_mut().enumerate() {
                    *out = block[column * size + row as usize];
                }
            }
            let substitution = Substitution {
                panels: &self.analysis.panels,
                values: &self.values,
                pairs: &self.pairs,
                count,
            };
            substitution.solve(rows, self.threads);
            for (&row, found) in order.iter().zip(rows.chunks_exact(count)) {
                for (column, found) in found.iter().enumerate() {
                    block[column * size + row as usize] = *found;
                }
            }
        }
        Ok(())
    }

    /// Solves `A x = b` and improves the solutions `steps` times by solving for the residual of the
    /// right-hand sides. Returns the largest `‖b − A x‖ / ‖b‖` after the last step.
    ///
    /// # Errors
    /// When lengths don't fit, or memory runs out.
    pub fn solve_refined(
        &self,
        operator: &dyn SymmetricOperator,
        right_hand_sides: &[f64],
        solutions: &mut [f64],
        steps: usize,
    ) -> Result<f64, FlexibleError> {
        let size = self.analysis.size();
        if operator.size() != size || right_hand_sides.len() != solutions.len() {
            return Err(FlexibleError::Matrix {
                problem: format!(
                    "{} right-hand sides' and {} solutions' numbers, operator of {} rows, factor of {size}",
                    right_hand_sides.len(),
                    solutions.len(),
                    operator.size()
                ),
                advice: String::new(),
            });
        }
        solutions.copy_from_slice(right_hand_sides);
        self.solve_in_place(solutions)?;
        let width = (size * TOGETHER).max(1);
        let mut rest = vec![0.0; width.min(solutions.len())];
        let mut worst = 0.0f64;
        for (right, solution) in right_hand_sides
            .chunks(width)
            .zip(solutions.chunks_mut(width))
        {
            let rest = &mut rest[..right.len()];
            for step in 0..=steps {
                operator.apply(right.len() / size, solution, rest);
                for (rest, right) in rest.iter_mut().zip(right) {
                    *rest = right - *rest;
                }
                if step < steps {
                    self.solve_in_place(rest)?;
                    for (solution, rest) in solution.iter_mut().zip(rest.iter()) {
                        *solution += rest;
                    }
                }
            }
            for (rest, right) in rest.chunks(size).zip(right.chunks(size)) {
                let (rest, right) = (norm(rest), norm(right));
                worst = worst.max(if right > 0.0 { rest / right } else { rest });
            }
        }
        Ok(worst)
    }
}

/// The pivot with the smaller ratio. A ratio that is not a number counts as zero.
fn weaker(one: (usize, f64), two: (usize, f64)) -> (usize, f64) {
    let ratio = if two.1.is_nan() { 0.0 } else { two.1 };
    if ratio < one.1 { (two.0, ratio) } else { one }
}

/// Euclidean length.
pub(crate) fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn pattern_of(matrix: &SymmetricMatrix) -> (u64, usize) {
    // FNV-1a over words; the lengths of the columns represent the column starts
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    let mut add = |word: u64| hash = (hash ^ word).wrapping_mul(0x0100_0000_01b3);
    for column in 0..matrix.size() {
        let rows = matrix.column(column).0;
        add(rows.len() as u64);
        rows.iter().for_each(|&row| add(u64::from(row)));
    }
    (hash, matrix.rows().len())
}

fn check(analysis: &Analysis, matrix: &SymmetricMatrix) -> Result<(), FlexibleError> {
    if matrix.size() != analysis.size() || pattern_of(matrix) != analysis.pattern {
        return Err(FlexibleError::Matrix {
            problem: "a matrix is factored with the analysis of another pattern".into(),
            advice: String::new(),
        });
    }
    for column in 0..matrix.size() {
        let (rows, values) = matrix.column(column);
        if let Some((row, value)) = rows
            .iter()
            .zip(values)
            .find(|(_, value)| !value.is_finite())
        {
            return Err(FlexibleError::Matrix {
                problem: format!("entry ({}, {}) of a matrix is {value}", row + 1, column + 1),
                advice: String::new(),
            });
        }
    }
    Ok(())
}

/// Diagonal entries; zero for a row without one.
pub(crate) fn diagonal(matrix: &SymmetricMatrix) -> Vec<f64> {
    (0..matrix.size())
        .map(|column| {
            let (rows, values) = matrix.column(column);
            match (rows.first(), values.first()) {
                (Some(&row), Some(&value)) if row as usize == column => value,
                _ => 0.0,
            }
        })
        .collect()
}

/// The expected size of each row's pivot. It is the larger of two values: the diagonal entry, and the amount
/// `a_ij² / |a_jj|` that the elimination of a neighbour adds. The result does not depend on the units of the
/// freedoms.
fn pivot_scale(matrix: &SymmetricMatrix) -> Vec<f64> {
    let diagonal = diagonal(matrix);
    let mut scale: Vec<f64> = diagonal.iter().map(|entry| entry.abs()).collect();
    let mut raise = |row: usize, value: f64, other: usize| {
        let added = value * value / diagonal[other].abs();
        // for a zero diagonal the entry itself is the pivot of a pair
        let added = if added.is_finite() {
            added
        } else {
            value.abs()
        };
        scale[row] = scale[row].max(added);
    };
    for column in 0..matrix.size() {
        let (rows, values) = matrix.column(column);
        for (&row, &value) in rows.iter().zip(values) {
            let row = row as usize;
            if row != column && value != 0.0 {
                raise(row, value, column);
                raise(column, value, row);
            }
        }
    }
    scale
}

pub(crate) fn singular(row: usize, ratio: Option<f64>) -> FlexibleError {
    let found = match ratio {
        Some(ratio) => format!("is {} of its diagonal entry", short(ratio, 2)),
        None => "is not positive".into(),
    };
    FlexibleError::Singular {
        row,
        problem: format!(
            "a matrix is singular or not positive definite: the pivot of row {} {found}",
            row + 1
        ),
        advice: "support the structure, or connect its parts; it can move there without resistance"
            .into(),
    }
}
