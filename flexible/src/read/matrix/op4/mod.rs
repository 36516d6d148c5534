//! Nastran's OP4 (`OUTPUT4`): matrices in binary or as text, dense or sparse, column by column.
//!
//! A matrix begins with its number of columns and of rows (negative: `BIGMAT`), form (1 square, 2
//! rectangular, 6 symmetric; always whole columns), type (1 single, 2 double precision, 3 and 4 complex) and
//! name. A column gives the number of its first row, or 0 if it is made of strings. Each string gives its
//! length and row in one word (length · 65536 + row), or in two words for `BIGMAT`. A last column, one beyond
//! the others, ends the matrix. Source: MSC Nastran DMAP guide, module OUTPUT4.

mod binary;
mod text;

use super::{COMPLEX, ForeignMatrix, Held, chosen};
use crate::error::FileProblem;
use crate::read::{self, Files};

/// Reads the matrix with a name, or the only one if `name` is empty. Single precision has 7 digits; a text
/// has the digits of its format.
///
/// # Errors
/// With file and record or line: a file of another format, a cut or damaged file, a complex matrix,
/// an entry that is not a finite number; a name that is not in the file, with the names that are.
pub fn read_op4(files: &dyn Files, file: &str, name: &str) -> Result<ForeignMatrix, FileProblem> {
    let mut reader = read::open(files, file)?;
    let start = reader.fill_buf().unwrap_or(&[]);
    // the header of a text has digits and blanks; a binary file begins with a length
    let is_text = start
        .iter()
        .take(8)
        .all(|byte| byte.is_ascii_digit() || byte.is_ascii_whitespace() || *byte == b'-')
        && !start.is_empty();
    drop(reader);
    let mut found = Found {
        name,
        held: Vec::new(),
        found: None,
    };
    if is_text {
        text::read(files, file, &mut found)?;
    } else {
        binary::read(files, file, &mut found)?;
    }
    chosen(file, name, &found.held, found.found)
}

/// The matrices of the file so far, and the wanted one.
struct Found<'n> {
    name: &'n str,
    held: Vec<Held>,
    found: Option<ForeignMatrix>,
}

impl Found<'_> {
    /// Whether the matrix with this head is the wanted one. It also notes the head.
    fn wants(&mut self, head: &Head) -> bool {
        self.held.push(Held {
            name: head.name.clone(),
            size: (head.rows, head.columns),
        });
        self.found.is_none() && (self.name.is_empty() || head.name.eq_ignore_ascii_case(self.name))
    }
}

/// The head of a matrix.
#[derive(Clone, Debug)]
struct Head {
    name: String,
    rows: usize,
    columns: usize,
    big: bool,
    kind: i64,
}

/// A mistake in a head or a column, with advice. The reader adds its place.
type Wrong = (String, String);

impl Head {
    /// Makes a head from its numbers.
    fn new(name: String, columns: i64, rows: i64, kind: i64) -> Result<Self, Wrong> {
        let size = |count: i64| {
            u32::try_from(count)
                .ok()
                .filter(|count| *count < u32::MAX)
                .map(|count| count as usize)
        };
        match (size(columns), size(rows.saturating_abs())) {
            (Some(columns), Some(row_count)) if (1..=4).contains(&kind) => Ok(Head {
                name,
                rows: row_count,
                columns,
                big: rows < 0,
                kind,
            }),
            _ => Err((
                format!(
                    "a matrix can't have {} rows, {columns} columns and type {kind}",
                    rows.saturating_abs()
                ),
                "write or copy the file again; it is damaged, or it is no OP4".into(),
            )),
        }
    }

    /// Number of reals in an entry.
    fn parts(&self) -> usize {
        if self.kind > 2 { 2 } else { 1 }
    }

    fn empty_matrix(&self, file: &str) -> Result<ForeignMatrix, Wrong> {
        if self.kind > 2 {
            return Err((
                format!("matrix {} is complex (type {})", self.name, self.kind),
                COMPLEX.into(),
            ));
        }
        Ok(ForeignMatrix {
            file: file.into(),
            name: self.name.clone(),
            rows: self.rows,
            columns: self.columns,
            symmetric: false,
            entries: Vec::new(),
            freedoms: None,
        })
    }

    /// Checks the number of a column, from 1. It must be after the last column and at most the one that ends
    /// the matrix.
    fn column(&self, column: i64, last: usize) -> Result<usize, Wrong> {
        match usize::try_from(column) {
            Ok(column) if column > last && column <= self.columns + 1 => Ok(column),
            _ => Err((
                format!(
                    "matrix {}, of {} columns, has column {column} after column {last}",
                    self.name, self.columns
                ),
                "write or copy the file again; it is damaged".into(),
            )),
        }
    }

    /// Checks that `count` entries from row `first`, from 1, are inside the matrix; gives the first from 0.
    fn run(&self, first: i64, count: usize, column: usize) -> Result<u32, Wrong> {
        match u32::try_from(first.saturating_sub(1)) {
            Ok(start) if (start as usize).saturating_add(count) <= self.rows => Ok(start),
            _ => Err((
                format!(
                    "matrix {}, of {} rows, has {count} entries from row {first} in column {column}",
                    self.name, self.rows
                ),
                "write or copy the file again; it is damaged".into(),
            )),
        }
    }
}

/// Keeps an entry that isn't zero. Row from 0, column from 1.
fn keep(matrix: &mut ForeignMatrix, row: u32, column: usize, value: f64) -> Result<(), Wrong> {
    if !value.is_finite() {
        return Err((
            format!(
                "matrix {} contains {value} at row {}, column {column}",
                matrix.name,
                u64::from(row) + 1
            ),
            "the run that wrote it failed; read the messages of that run".into(),
        ));
    }
    if value != 0.0 {
        matrix.entries.push((row, column as u32 - 1, value)); // columns are from 1 and fit, as heads do
    }
    Ok(())
}
