//! Factors of sparse symmetric matrices: `L Lᵀ` of positive definite ones, `L B Lᵀ` of indefinite ones.
//!
//! The factorisation is supernodal (dense blocks of columns with the same rows), by faer. One [`Analysis`]
//! serves all matrices of one pattern, such as `K − σ M` for all shifts.

use super::ordering::{Ordering, out_of_memory, too_large};
use crate::error::FlexibleError;
use crate::sparse::{SymmetricMatrix, SymmetricOperator};
use eng_system::significant::short;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, LltRef, SymbolicCholesky, SymbolicCholeskyRaw,
    SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
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
    symbolic: SymbolicCholesky<u32>,
    column_start: Vec<u32>,
    ordering: Ordering,
    /// Hash of the pattern, and number of its entries. Every factorisation compares them, because faer's
    /// behaviour for another pattern is undefined.
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
        let column_start: Vec<u32> = matrix
            .column_start()
            .iter()
            .map(|&start| u32::try_from(start))
            .collect::<Result<_, _>>()
            .map_err(|_| too_large())?;
        let symbolic = factorize_symbolic_cholesky(
            SymbolicSparseColMatRef::<'_, u32>::new_checked(
                size,
                size,
                &column_start,
                None,
                matrix.rows(),
            ),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(
                ordering.forward(),
                ordering.inverse(),
                size,
            )),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..CholeskySymbolicParams::default()
            },
        )
        .map_err(|_| too_large())?;
        Ok(Analysis {
            symbolic,
            column_start,
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
        self.symbolic.len_val()
    }

    /// Visits the pivots block by block, with their index in the factor's values and their index in the
    /// order.
    fn each_pivot(&self, mut visit: impl FnMut(usize, usize)) {
        if let SymbolicCholeskyRaw::Supernodal(factor) = self.symbolic.raw() {
            let blocks = factor
                .supernode_begin()
                .iter()
                .zip(factor.supernode_end())
                .zip(factor.col_ptr_for_val())
                .zip(factor.nnz_per_super());
            for (((&begin, &end), &values), &below) in blocks {
                let (begin, end) = (begin as usize, end as usize);
                let rows = end - begin + below as usize;
                for index in begin..end {
                    visit(values as usize + (index - begin) * (rows + 1), index);
                }
            }
        }
    }
}

/// A factored matrix.
#[derive(Debug)]
pub struct Factorization {
    analysis: Arc<Analysis>,
    values: Vec<f64>,
    /// For an indefinite matrix: the entries below the diagonal of B, and the row exchanges inside blocks, in
    /// both directions.
    indefinite: Option<(Vec<f64>, Vec<u32>, Vec<u32>)>,
    negative: usize,
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
        Factorization::reusing(Vec::new(), analysis, matrix, kind)
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
        Factorization::reusing(self.values, &self.analysis, matrix, kind)
    }

    fn reusing(
        mut values: Vec<f64>,
        analysis: &Arc<Analysis>,
        matrix: &SymmetricMatrix,
        kind: Definiteness,
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
            indefinite: None,
            negative: 0,
        };
        match kind {
            Definiteness::Positive => factor.factor_positive(matrix)?,
            Definiteness::Indefinite => factor.factor_indefinite(matrix)?,
        }
        Ok(factor)
    }

    fn factor_positive(&mut self, matrix: &SymmetricMatrix) -> Result<(), FlexibleError> {
        let analysis = self.analysis.clone();
        let scratch = analysis
            .symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| out_of_memory())?;
        let result = analysis.symbolic.factorize_numeric_llt(
            &mut self.values,
            view(&analysis, matrix),
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        match result {
            Ok(_) => {}
            Err(LltError::NonPositivePivot { index }) => {
                return Err(singular(self.row_of(index), None));
            }
        }
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
        let scratch = analysis
            .symbolic
            .factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| out_of_memory())?;
        let mut below = vec![0.0; size];
        let (mut forward, mut inverse) = (vec![0u32; size], vec![0u32; size]);
        analysis.symbolic.factorize_numeric_intranode_lblt(
            &mut self.values,
            &mut below,
            &mut forward,
            &mut inverse,
            view(&analysis, matrix),
            Side::Lower,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        let before = pivot_scale(matrix);
        let scale = |index: usize| {
            let row = forward
                .get(index)
                .map_or(0, |&inside| self.row_of(inside as usize));
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
        self.indefinite = Some((below, forward, inverse));
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
        let symbolic = &self.analysis.symbolic;
        let mut memory =
            MemBuffer::try_new(symbolic.solve_in_place_scratch::<f64>(together, Par::Seq))
                .map_err(|_| out_of_memory())?;
        for block in right_hand_sides.chunks_mut(size * together) {
            let columns = block.len() / size;
            let block = MatMut::from_column_major_slice_mut(block, size, columns);
            let stack = MemStack::new(&mut memory);
            match &self.indefinite {
                None => LltRef::<'_, u32, f64>::new(symbolic, &self.values)
                    .solve_in_place_with_conj(Conj::No, block, Par::Seq, stack),
                Some((below, forward, inverse)) => IntranodeLbltRef::<'_, u32, f64>::new(
                    symbolic,
                    &self.values,
                    below,
                    PermRef::new_checked(forward, inverse, size),
                )
                .solve_in_place_with_conj(Conj::No, block, Par::Seq, stack),
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

fn view<'a>(analysis: &'a Analysis, matrix: &'a SymmetricMatrix) -> SparseColMatRef<'a, u32, f64> {
    SparseColMatRef::new(
        SymbolicSparseColMatRef::new_checked(
            matrix.size(),
            matrix.size(),
            &analysis.column_start,
            None,
            matrix.rows(),
        ),
        matrix.values(),
    )
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
