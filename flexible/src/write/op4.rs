//! Nastran's OP4 as text, dense, double precision, with 17 digits. `read/matrix/op4` describes the format.

use super::number::fortran;
use crate::small_motion::Dense;
use std::fmt::Write;

/// Rectangular, square, symmetric: the words of OP4.
fn form(matrix: &Dense, symmetric: bool) -> u8 {
    match (symmetric, matrix.rows() == matrix.columns()) {
        (true, _) => 6,
        (false, true) => 1,
        (false, false) => 2,
    }
}

/// A file with these matrices. A name has at most eight characters. `symmetric` is the kind of the matrix, and all its
/// columns are written all the same.
pub fn op4(matrices: &[(&str, &Dense, bool)]) -> String {
    let mut text = String::new();
    for (name, matrix, symmetric) in matrices {
        // writing to a text cannot fail
        let _ = one(&mut text, name, matrix, *symmetric);
    }
    text
}

fn one(text: &mut String, name: &str, matrix: &Dense, symmetric: bool) -> std::fmt::Result {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    let form = form(matrix, symmetric);
    writeln!(
        text,
        "{columns:8}{rows:8}{form:8}{:8}{name:<8}1P,3E23.16",
        2
    )?;
    for column in 0..columns {
        let values = (0..rows).map(|row| matrix.at(row, column));
        let values = values.collect::<Vec<_>>();
        let Some(first) = values.iter().position(|value| *value != 0.0) else {
            continue;
        };
        let last = values.iter().rposition(|value| *value != 0.0);
        let run = values.get(first..=last.unwrap_or(first)).unwrap_or(&[]);
        writeln!(text, "{:8}{:8}{:8}", column + 1, first + 1, run.len())?;
        numbers(text, run)?;
    }
    // a column beyond the last one, with one number, ends the matrix
    writeln!(text, "{:8}{:8}{:8}", columns + 1, 1, 1)?;
    numbers(text, &[1.0])
}

fn numbers(text: &mut String, values: &[f64]) -> std::fmt::Result {
    for line in values.chunks(3) {
        for value in line {
            write!(text, "{:>23}", fortran(*value, 16, 'E'))?;
        }
        writeln!(text)?;
    }
    Ok(())
}
