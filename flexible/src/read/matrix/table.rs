//! A dense matrix as text: a line of numbers for each row, parted by commas, semicolons or blanks, as
//! `numpy.savetxt` writes it.

use super::text::{NUMBERS, Text, real};
use super::{ForeignMatrix, whole};
use crate::error::FileProblem;
use crate::read::{Files, csv};

/// Reads a dense matrix. Lines that begin with `#` are comments.
///
/// # Errors
/// With file and line: text in the place of a number, a row of another length; a file without numbers.
pub fn read_dense_matrix(files: &dyn Files, file: &str) -> Result<ForeignMatrix, FileProblem> {
    let mut text = Text::open(files, file)?;
    let mut entries = Vec::new();
    let (mut rows, mut columns) = (0_u32, 0);
    while let Some(line) = text.next_line()? {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let values: Option<Vec<f64>> = csv::fields(line).into_iter().map(real).collect();
        let Some(values) = values else {
            return Err(text.wrong("a row of finite numbers", NUMBERS));
        };
        if rows > 0 && values.len() != columns {
            return Err(text.problem(
                format!(
                    "this row has {} numbers, those before have {columns}",
                    values.len()
                ),
                "write the matrix again, with all numbers of a row on one line",
            ));
        }
        columns = values.len();
        let row = rows;
        let nonzero = (0_u32..).zip(values).filter(|(_, value)| *value != 0.0);
        entries.extend(nonzero.map(|(column, value)| (row, column, value)));
        rows = match rows.checked_add(1) {
            Some(rows) => rows,
            None => return Err(whole(file, "has too many rows", "divide the model")),
        };
    }
    if rows == 0 {
        return Err(whole(
            file,
            "contains no number",
            "write the matrix again; the file is empty",
        ));
    }
    Ok(ForeignMatrix {
        file: file.into(),
        name: String::new(),
        rows: rows as usize,
        columns,
        symmetric: false,
        entries,
        freedoms: None,
    })
}
