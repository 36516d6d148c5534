//! Binary OP4: one record for each head and each column. Integers and words have 4 bytes in 32-bit files. In
//! 64-bit files, whose heads have 48 bytes, they have 8 bytes, also in single precision.

use super::super::CUT;
use super::super::bytes::{Order, Records};
use super::{Found, Head, Wrong, keep};
use crate::error::FileProblem;
use crate::read::Files;
use crate::read::matrix::ForeignMatrix;

pub(super) fn read(files: &dyn Files, file: &str, found: &mut Found) -> Result<(), FileProblem> {
    let (mut records, length) = Records::open(files, file, &[24, 48], "OP4 file")?;
    let key = if length == 24 { 4 } else { 8 };
    while let Some(record) = records.next_record()? {
        let located = |(problem, advice): Wrong| records.problem(problem, advice);
        let integer = |i: usize| {
            let from = i * key;
            records
                .order()
                .integer(record.get(from..from + key).unwrap_or(&[]))
        };
        if record.len() != 6 * key {
            return Err(records.problem(
                format!(
                    "the head of a matrix has {} bytes, not {}",
                    record.len(),
                    6 * key
                ),
                "write or copy the file again; it is damaged",
            ));
        }
        let name = name(record.get(4 * key..).unwrap_or(&[]));
        let head = Head::new(name, integer(0), integer(1), integer(3)).map_err(located)?;
        let mut matrix = if found.wants(&head) {
            Some(head.empty_matrix(file).map_err(located)?)
        } else {
            None
        };
        columns(&mut records, &head, key, matrix.as_mut())?;
        if matrix.is_some() {
            found.found = matrix;
        }
    }
    Ok(())
}

/// The name in a head; 64-bit files may blank-fill every 4 characters to 8.
fn name(bytes: &[u8]) -> String {
    let spread = bytes.len() == 16 && bytes.get(4..8) == Some(b"    ");
    let parts = if spread {
        [bytes.get(..4), bytes.get(8..12)]
    } else {
        [bytes.get(..8), None]
    };
    let text = parts.into_iter().flatten().flatten();
    let text = text
        .map(|&byte| {
            if byte.is_ascii_graphic() {
                char::from(byte)
            } else {
                ' '
            }
        })
        .collect::<String>();
    text.trim().to_string()
}

/// Reads the columns of a matrix up to the one that ends it, and keeps them.
fn columns(
    records: &mut Records,
    head: &Head,
    key: usize,
    mut matrix: Option<&mut ForeignMatrix>,
) -> Result<(), FileProblem> {
    let mut last = 0;
    loop {
        let Some(record) = records.next_record()? else {
            return Err(records.problem(
                format!(
                    "the file ends inside matrix {}, after column {last} of {}",
                    head.name, head.columns
                ),
                CUT,
            ));
        };
        let order = records.order();
        let integer = |i: usize| order.integer(record.get(i * key..(i + 1) * key).unwrap_or(&[]));
        let column = head
            .column(integer(0), last)
            .map_err(|(problem, advice)| records.problem(problem, advice))?;
        let data = record.get(3 * key..).unwrap_or(&[]);
        let words = usize::try_from(integer(2)).unwrap_or(0);
        let word = data.len().checked_div(words).unwrap_or(4);
        if record.len() < 3 * key || ![4, 8].contains(&word) || word * words != data.len() {
            return Err(records.problem(
                format!(
                    "the head of column {column} of matrix {} states {} words, but the column has {} bytes",
                    head.name,
                    integer(2),
                    data.len()
                ),
                "write or copy the file again; it is damaged",
            ));
        }
        if column > head.columns {
            return Ok(());
        }
        last = column;
        let Some(matrix) = matrix.as_deref_mut() else {
            continue;
        };
        let column = Column {
            head,
            column,
            key,
            word,
            real: if head.kind % 2 == 1 { word } else { 8 },
        };
        let kept = match integer(1) {
            0 => column.strings(data, order, matrix),
            first => column.run(first, data, order, matrix),
        };
        kept.map_err(|(problem, advice)| records.problem(problem, advice))?;
    }
}

/// A column and its sizes in bytes.
struct Column<'h> {
    head: &'h Head,
    /// Its number, from 1.
    column: usize,
    key: usize,
    word: usize,
    real: usize,
}

impl Column<'_> {
    /// Entries one below the other.
    fn run(
        &self,
        first: i64,
        data: &[u8],
        order: Order,
        matrix: &mut ForeignMatrix,
    ) -> Result<(), Wrong> {
        if !data.len().is_multiple_of(self.real) {
            return Err(self.wrong("an entry has too few words"));
        }
        let start = self.head.run(first, data.len() / self.real, self.column)?;
        for (row, bytes) in (start..).zip(data.chunks_exact(self.real)) {
            keep(matrix, row, self.column, order.real(bytes))?;
        }
        Ok(())
    }

    /// Entries in strings with their rows.
    fn strings(
        &self,
        mut data: &[u8],
        order: Order,
        matrix: &mut ForeignMatrix,
    ) -> Result<(), Wrong> {
        while !data.is_empty() {
            let heading = if self.head.big { 2 } else { 1 } * self.key;
            let Some((keys, rest)) = data.split_at_checked(heading) else {
                return Err(self.wrong("the head of a string is cut"));
            };
            let (length, row) = match keys.split_at_checked(self.key) {
                Some((length, row)) if self.head.big => (order.integer(length), order.integer(row)),
                _ => {
                    let both = order.integer(keys);
                    // lengths from 32768 make it negative
                    let both = if self.key == 4 {
                        both & 0xffff_ffff
                    } else {
                        both
                    };
                    (both >> 16, both & 0xffff)
                }
            };
            let bytes = usize::try_from(length.saturating_sub(1))
                .unwrap_or(usize::MAX)
                .saturating_mul(self.word);
            let Some((values, rest)) = rest.split_at_checked(bytes).filter(|_| bytes > 0) else {
                return Err(self.wrong(&format!(
                    "a string of {length} words from row {row} has only {} bytes",
                    rest.len()
                )));
            };
            self.run(row, values, order, matrix)?;
            data = rest;
        }
        Ok(())
    }

    fn wrong(&self, problem: &str) -> Wrong {
        (
            format!(
                "in column {} of matrix {}: {problem}",
                self.column, self.head.name
            ),
            "write the file again; it is damaged, or its integers have another size than its head"
                .into(),
        )
    }
}
