//! `K − σ M` as one sparse matrix.

use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;

/// `stiffness − shift · mass`, with the entries of both patterns even where their difference is zero, so that
/// all shifts share one pattern. Shift in rad²/s² when the matrices are in SI units.
///
/// # Errors
/// [`FlexibleError::Matrix`] when the sizes differ.
pub fn shifted(
    stiffness: &SymmetricMatrix,
    mass: &SymmetricMatrix,
    shift: f64,
) -> Result<SymmetricMatrix, FlexibleError> {
    let size = stiffness.size();
    if mass.size() != size {
        return Err(FlexibleError::Matrix {
            problem: format!(
                "the stiffness matrix has {size} rows, the mass matrix {}",
                mass.size()
            ),
            advice: "give both matrices of the same freedoms".into(),
        });
    }
    let most = stiffness.rows().len().max(mass.rows().len());
    let mut column_start = Vec::with_capacity(size + 1);
    let (mut row, mut value) = (Vec::with_capacity(most), Vec::with_capacity(most));
    column_start.push(0);
    for column in 0..size {
        let (stiffness_rows, stiffness_values) = stiffness.column(column);
        let (mass_rows, mass_values) = mass.column(column);
        let mut stiff = stiffness_rows.iter().zip(stiffness_values).peekable();
        let mut heavy = mass_rows.iter().zip(mass_values).peekable();
        loop {
            let next = match (stiff.peek(), heavy.peek()) {
                (Some((one, _)), Some((two, _))) => **one.min(two),
                (Some((one, _)), None) => **one,
                (None, Some((two, _))) => **two,
                (None, None) => break,
            };
            let mut entry = 0.0;
            if let Some((_, &k)) = stiff.next_if(|(row, _)| **row == next) {
                entry += k;
            }
            if let Some((_, &m)) = heavy.next_if(|(row, _)| **row == next) {
                entry -= shift * m;
            }
            row.push(next);
            value.push(entry);
        }
        column_start.push(row.len());
    }
    SymmetricMatrix::from_parts(size, column_start, row, value)
}
