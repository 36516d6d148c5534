//! A factored matrix with solutions in which given combinations of rows are zero.
//!
//! With A factored, rows C (one a column) and multipliers μ: `A x + C μ = b`, `Cᵀ x = 0`, so `x = y − Y F⁻¹
//! Cᵀ y` with `A y = b`, `A Y = C` and `F = Cᵀ Y`. By Sylvester's law the pencil restricted to `Cᵀ x = 0` has
//! as many negative eigenvalues as A has, more the positive ones of F, less the number of rows (E. V.
//! Haynsworth, Linear Algebra Appl. 1 (1968) 73).

use super::dense::{subtract, symmetric_eigen};
use super::factor::{Definiteness, Factorization};
use crate::error::FlexibleError;

/// A combination of rows: row and coefficient.
pub type Combination = Vec<(u32, f64)>;

/// Combinations of unit length depend on each other if the ratio of the eigenvalues of F is below this. A
/// choice above the rounding of F.
const DEPENDENT: f64 = 1e-12;

/// A factor, with the correction that keeps combinations at zero.
#[derive(Debug)]
pub(crate) struct Restrained {
    factor: Factorization,
    held: Option<Response>,
}

/// The correction by the multipliers of the combinations.
#[derive(Debug)]
struct Response {
    /// Combinations scaled to unit length.
    rows: Vec<Combination>,
    /// `Y F⁻¹`, by columns.
    correction: Vec<f64>,
    /// Positive eigenvalues of F.
    positive: usize,
}

/// `Cᵀ x` of vectors of a size, by columns.
fn values(rows: &[Combination], size: usize, x: &[f64]) -> Vec<f64> {
    x.chunks_exact(size.max(1))
        .flat_map(|x| {
            rows.iter().map(|row| {
                row.iter()
                    .map(|(freedom, factor)| {
                        factor * x.get(*freedom as usize).copied().unwrap_or(0.0)
                    })
                    .sum::<f64>()
            })
        })
        .collect()
}

/// The combinations, scaled to unit length.
///
/// # Errors
/// A combination is empty, not finite, or has a row outside the matrix.
pub(crate) fn unit(rows: &[Combination], size: usize) -> Result<Vec<Combination>, FlexibleError> {
    rows.iter()
        .enumerate()
        .map(|(index, row)| {
            let length = libm::sqrt(row.iter().map(|(_, x)| x * x).sum());
            let inside = row.iter().all(|(freedom, _)| (*freedom as usize) < size);
            if !inside || !length.is_finite() || length <= 0.0 {
                return Err(FlexibleError::Matrix {
                    problem: format!(
                        "combination {} of rows to be held is empty or out of range",
                        index + 1
                    ),
                    advice: String::new(),
                });
            }
            Ok(row
                .iter()
                .map(|(freedom, x)| (*freedom, x / length))
                .collect())
        })
        .collect()
}

/// Removes from a vector its components along combinations. Residuals need this, because the multipliers may
/// balance these components.
pub(crate) fn without(rows: &[Combination], vector: &mut [f64]) -> Result<(), FlexibleError> {
    let count = rows.len();
    let mut columns = vec![0.0; vector.len() * count];
    for (column, row) in columns.chunks_exact_mut(vector.len().max(1)).zip(rows) {
        for (freedom, x) in row {
            if let Some(entry) = column.get_mut(*freedom as usize) {
                *entry += x;
            }
        }
    }
    let gram = values(rows, vector.len(), &columns);
    let (inverse, _) = inverse(count, gram)?;
    let along = values(rows, vector.len(), vector);
    let share: Vec<f64> = inverse
        .chunks_exact(count.max(1))
        .map(|line| line.iter().zip(&along).map(|(x, y)| x * y).sum())
        .collect();
    for (row, share) in rows.iter().zip(share) {
        for (freedom, x) in row {
            if let Some(entry) = vector.get_mut(*freedom as usize) {
                *entry -= share * x;
            }
        }
    }
    Ok(())
}

/// The inverse of a symmetric matrix, and the number of its positive eigenvalues.
fn inverse(size: usize, matrix: Vec<f64>) -> Result<(Vec<f64>, usize), FlexibleError> {
    let (eigenvalues, vectors) = symmetric_eigen(size, matrix)?;
    let largest = eigenvalues.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let weakest = eigenvalues
        .iter()
        .position(|x| x.abs() <= DEPENDENT * largest);
    if let Some(place) = weakest {
        let row = vectors[place * size..(place + 1) * size]
            .iter()
            .enumerate()
            .fold((0, 0.0f64), |best, (row, x)| {
                if x.abs() > best.1 {
                    (row, x.abs())
                } else {
                    best
                }
            })
            .0;
        return Err(FlexibleError::Singular {
            row,
            problem: format!(
                "combination {} of rows to be held follows from the others",
                row + 1
            ),
            advice: "remove the rows that others hold already".into(),
        });
    }
    let mut inverse = vec![0.0; size * size];
    for (value, vector) in eigenvalues.iter().zip(vectors.chunks_exact(size.max(1))) {
        for (line, x) in inverse.chunks_exact_mut(size.max(1)).zip(vector) {
            for (entry, y) in line.iter_mut().zip(vector) {
                *entry += x * y / value;
            }
        }
    }
    Ok((inverse, eigenvalues.iter().filter(|x| **x > 0.0).count()))
}

impl Restrained {
    /// A factor whose solutions keep `rows`, of unit length, at zero.
    ///
    /// # Errors
    /// [`FlexibleError::Singular`] when a combination follows from others (its row is the combination's
    /// number), or, at an indefinite matrix, when the restricted one is singular there.
    pub(crate) fn new(
        factor: Factorization,
        rows: &[Combination],
        kind: Definiteness,
    ) -> Result<Self, FlexibleError> {
        if rows.is_empty() {
            return Ok(Restrained { factor, held: None });
        }
        let size = factor.analysis().size();
        let count = rows.len();
        let mut responses = vec![0.0; size * count];
        for (column, row) in responses.chunks_exact_mut(size.max(1)).zip(rows) {
            for (freedom, x) in row {
                if let Some(entry) = column.get_mut(*freedom as usize) {
                    *entry += x;
                }
            }
        }
        factor.solve_in_place(&mut responses)?;
        let products = values(rows, size, &responses);
        let mut symmetric = products.clone();
        for i in 0..count {
            for j in 0..count {
                symmetric[i * count + j] =
                    0.5 * (products[i * count + j] + products[j * count + i]);
            }
        }
        let (inverse, positive) = inverse(count, symmetric)?;
        if kind == Definiteness::Positive && positive < count {
            return Err(FlexibleError::Singular {
                row: 0,
                problem: "the combinations of rows to be held meet a matrix that is not positive definite".into(),
                advice: "stiffness and mass must not be negative".into(),
            });
        }
        let mut correction = vec![0.0; size * count];
        let negative: Vec<f64> = inverse.iter().map(|x| -x).collect();
        subtract(size, &responses, &negative, &mut correction);
        Ok(Restrained {
            factor,
            held: Some(Response {
                rows: rows.to_vec(),
                correction,
                positive,
            }),
        })
    }

    /// The factor alone.
    pub(crate) fn factor(&self) -> &Factorization {
        &self.factor
    }

    /// Returns the factor, so that its memory can be used again.
    pub(crate) fn into_factor(self) -> Factorization {
        self.factor
    }

    /// Number of negative eigenvalues of the restricted matrix.
    pub(crate) fn negative(&self) -> usize {
        let own = self.factor.negative_pivots();
        match &self.held {
            Some(held) => (own + held.positive).saturating_sub(held.rows.len()),
            None => own,
        }
    }

    /// Solves for right-hand sides one after the other, in their place.
    ///
    /// # Errors
    /// Those of [`Factorization::solve_in_place`].
    pub(crate) fn solve_in_place(&self, vectors: &mut [f64]) -> Result<(), FlexibleError> {
        self.factor.solve_in_place(vectors)?;
        if let Some(held) = &self.held {
            let size = self.factor.analysis().size();
            // twice: the second pass removes the rounding error of the first
            for _ in 0..2 {
                let along = values(&held.rows, size, vectors);
                subtract(size, &held.correction, &along, vectors);
            }
        }
        Ok(())
    }
}
