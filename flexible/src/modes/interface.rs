//! The rigid motions that an interface holds, and the displacements for its unit displacements.

use super::{Load, Structure, products};
use crate::error::FlexibleError;
use crate::solve::dense::{positive_inverse, subtract, symmetric_eigen};

/// A rigid motion is not held if its share (squared) in the interface's rows, each of unit length, is below
/// this limit. A lever of a hundredth of the body's size holds nothing, because the mean position of a
/// journal's nodes is easily that far off the axis. Such a lever would only make a spin of some hertz.
/// Without its rigid part this spin is already among the constraint modes.
const LEFT: f64 = 1e-4;
/// Share of the largest eigenvalue below which a row depends on others, for the interface's flexibility
/// scaled to a unit diagonal. A choice above rounding: the flexibilities come from solutions with some twelve
/// digits. With a larger limit, rows that are near each other, such as those of two markers in one bore,
/// would count as one.
const DEPENDENT: f64 = 1e-11;

/// Rows to hold, and their displacements in rigid motions.
#[derive(Debug)]
pub struct Interface<'a> {
    structure: &'a Structure<'a>,
    rows: &'a [Load],
    /// Rigid motions that the rows hold, orthonormal combinations of [`super::Rigid::motions`] by columns.
    held: Vec<f64>,
    /// Displacements of the rows in these, by columns.
    seen: Vec<f64>,
    /// Rigid motions of the structure.
    rigid: usize,
}

impl<'a> Interface<'a> {
    /// Analyses rows of a structure.
    ///
    /// # Errors
    /// A row that reaches beyond the structure's freedoms, or is empty.
    pub fn new(structure: &'a Structure<'a>, rows: &'a [Load]) -> Result<Self, FlexibleError> {
        let size = structure.size();
        for (number, row) in rows.iter().enumerate() {
            let outside = row.entries.iter().find(|(f, _)| *f as usize >= size);
            if let Some((freedom, _)) = outside {
                return Err(FlexibleError::Matrix {
                    problem: format!("interface freedom {freedom} of {size}"),
                    advice: String::new(),
                });
            }
            if row.entries.is_empty() {
                return Err(FlexibleError::Row {
                    row: number,
                    problem: format!("{} is held by a support already", row.label),
                    advice: "remove it from the interface".into(),
                });
            }
        }
        let mut interface = Interface {
            structure,
            rows,
            held: Vec::new(),
            seen: Vec::new(),
            rigid: 0,
        };
        let Some(rigid) = &structure.rigid else {
            return Ok(interface);
        };
        let count = rigid.count();
        interface.rigid = count;
        let all: Vec<f64> = rigid
            .motions()
            .chunks_exact(size.max(1))
            .flat_map(|motion| rows.iter().map(|row| row.displacement(motion)))
            .collect();
        let at = |row: usize, motion: usize| all[motion * rows.len() + row];
        let mut gram = vec![0.0; count * count];
        for row in 0..rows.len() {
            let square: f64 = (0..count)
                .map(|motion| at(row, motion) * at(row, motion))
                .sum();
            if square > 0.0 {
                for i in 0..count {
                    for j in 0..count {
                        gram[i * count + j] += at(row, i) * at(row, j) / square;
                    }
                }
            }
        }
        let (values, vectors) = symmetric_eigen(count, gram)?;
        let largest = values.last().copied().unwrap_or(0.0);
        for (_, vector) in values
            .iter()
            .zip(vectors.chunks_exact(count.max(1)))
            .filter(|(value, _)| **value > LEFT * largest)
        {
            interface.held.extend(vector);
            let seen = (0..rows.len()).map(|row| {
                (0..count)
                    .map(|motion| at(row, motion) * vector[motion])
                    .sum::<f64>()
            });
            interface.seen.extend(seen);
        }
        Ok(interface)
    }

    /// Number of rigid motions of the structure that the rows leave free.
    pub fn left(&self) -> usize {
        self.rigid - self.held.len().checked_div(self.rigid).unwrap_or(0)
    }

    /// The freedoms, if every row is a single freedom and together they hold the structure. Such freedoms can
    /// be removed from the matrices.
    pub fn plain(&self) -> Option<Vec<u32>> {
        if self.left() > 0 {
            return None;
        }
        self.rows.iter().map(Load::plain).collect()
    }

    /// Displacements with a unit displacement of each row, the others zero, and loads at the interface alone.
    /// They follow from the attachment modes A of its rows C: `u = A p + R α` with `Cᵀ u = eⱼ` and
    /// `Rᵀ C p = 0`. R contains the rigid motions that the interface holds, and no others. With the
    /// flexibility `F = Cᵀ A` and `S = Cᵀ R`, `α = (Sᵀ F⁻¹ S)⁻¹ Sᵀ F⁻¹ eⱼ`, `p = F⁻¹ (eⱼ − S α)`.
    ///
    /// # Errors
    /// When a row follows from others.
    pub fn constraint_modes(&self, attachments: &[f64]) -> Result<Vec<f64>, FlexibleError> {
        let (size, count) = (self.structure.size(), self.rows.len());
        let column = |j: usize| attachments.get(j * size..(j + 1) * size).unwrap_or(&[]);
        let work: Vec<f64> = (0..count)
            .flat_map(|j| self.rows.iter().map(move |row| row.displacement(column(j))))
            .collect();
        let mut flexibility = work.clone();
        for i in 0..count {
            for j in 0..count {
                flexibility[i * count + j] = 0.5 * (work[i * count + j] + work[j * count + i]);
            }
        }
        let stiffness = positive_inverse(count, &flexibility, DEPENDENT)?
            .map_err(|row| repeated(self.rows, row))?;
        let held = self.seen.len().checked_div(count).unwrap_or(0);
        // F⁻¹ S and Sᵀ F⁻¹ S
        let forces = products(count, &stiffness, &self.seen);
        let resistance = products(count, &self.seen, &forces);
        let inverse =
            // rounding: a matrix of at most six rows, whose rigid motions are held by more than [`LEFT`]
            positive_inverse(held, &resistance, 1e-14)?.map_err(|_| FlexibleError::Numerical {
                problem: "the rigid motions that the interface holds cannot be determined".into(),
                advice: "spread the interface over the body".into(),
            })?;
        // α = inverse · forcesᵀ (held × count), by columns
        let alpha = products(held, &inverse, &transposed(count, &forces));
        // p = F⁻¹ − forces · α
        let mut loads = stiffness;
        subtract(count, &forces, &alpha, &mut loads);
        let negative: Vec<f64> = loads.iter().map(|x| -x).collect();
        let mut modes = vec![0.0; size * count];
        subtract(size, attachments, &negative, &mut modes);
        if let Some(rigid) = &self.structure.rigid {
            // R α = motions · held · α
            let mut along = vec![0.0; self.rigid * count];
            subtract(self.rigid, &self.held, &alpha, &mut along);
            subtract(size, rigid.motions(), &along, &mut modes);
        }
        Ok(modes)
    }
}

fn repeated(rows: &[Load], row: usize) -> FlexibleError {
    let label = rows.get(row).map_or("", |row| row.label.as_str());
    FlexibleError::Row {
        row,
        problem: format!("{label} moves only with the other freedoms of the interface"),
        advice: "remove it, or use nodes that move independently".into(),
    }
}

/// Refuses rows that follow from each other.
///
/// # Errors
/// The number and label of such a row.
pub(super) fn independent(size: usize, rows: &[Load]) -> Result<(), FlexibleError> {
    let count = rows.len();
    let mut gram = Vec::with_capacity(count * count);
    for row in rows {
        let mut dense = vec![0.0; size];
        for (freedom, x) in &row.entries {
            if let Some(entry) = dense.get_mut(*freedom as usize) {
                *entry += x;
            }
        }
        gram.extend(rows.iter().map(|other| other.displacement(&dense)));
    }
    positive_inverse(count, &gram, DEPENDENT)?
        .map(|_| ())
        .map_err(|row| repeated(rows, row))
}

/// The transpose of a matrix with `rows` rows, by columns.
fn transposed(rows: usize, matrix: &[f64]) -> Vec<f64> {
    let columns = matrix.len().checked_div(rows).unwrap_or(0);
    (0..rows)
        .flat_map(|row| (0..columns).map(move |column| matrix[column * rows + row]))
        .collect()
}
