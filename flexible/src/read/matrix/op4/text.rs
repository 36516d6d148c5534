//! OP4 as text. The format in the head gives the number of values in a line and their width. No blank
//! separates them.

use super::super::text::{NUMBERS, Text, columns, real};
use super::{Found, Head, Wrong, keep};
use crate::error::FileProblem;
use crate::read::matrix::ForeignMatrix;
use crate::read::{Files, number};

pub(super) fn read(files: &dyn Files, file: &str, found: &mut Found) -> Result<(), FileProblem> {
    let mut text = Text::open(files, file)?;
    while let Some(line) = text.next_line()? {
        if line.is_empty() {
            continue;
        }
        let number = |i: usize| number::integer(columns(line, 8 * i, 8 * i + 8));
        let numbers = [number(0), number(1), number(2), number(3)];
        let name = columns(line, 32, 40).to_string();
        let format = Format::new(columns(line, 40, line.len()));
        let [Some(column_count), Some(row_count), Some(_), Some(kind)] = numbers else {
            return Err(text.wrong(
                "the head of a matrix: columns, rows, form, type (8 columns each), name, format",
                "write or copy the file again; it is damaged, or it is no OP4",
            ));
        };
        let Some(format) = format else {
            return Err(text.wrong(
                "the head of a matrix, because its format, such as 1P,3E23.16, is missing",
                "write or copy the file again; it is damaged, or it is no OP4",
            ));
        };
        let head = Head::new(name, column_count, row_count, kind);
        let head = head.map_err(|(problem, advice)| text.problem(problem, advice))?;
        let mut matrix = if found.wants(&head) {
            let empty = head.empty_matrix(file);
            Some(empty.map_err(|(problem, advice)| text.problem(problem, advice))?)
        } else {
            None
        };
        read_columns(&mut text, &head, format, matrix.as_mut())?;
        if matrix.is_some() {
            found.found = matrix;
        }
    }
    Ok(())
}

/// Values on a line.
#[derive(Clone, Copy)]
struct Format {
    values: usize,
    width: usize,
}

impl Format {
    /// From Fortran's: `1P,3E23.16`, `1P5E16.9`, `3D23.16`.
    fn new(text: &str) -> Option<Self> {
        let text = text.trim_start_matches(['(', ' ']);
        let text = text.strip_prefix("1P").unwrap_or(text);
        let (values, rest) = text.trim_start_matches([',', ' ']).split_once(['E', 'D'])?;
        let (width, _) = rest.split_once('.')?;
        let values = values.parse().ok().filter(|count| *count > 0)?;
        let width = width.parse().ok().filter(|width| *width > 0)?;
        Some(Format { values, width })
    }
}

/// Integers of eight columns, which may touch.
fn integers(line: &str, count: usize) -> Option<Vec<i64>> {
    let words = line.split_whitespace().collect::<Vec<_>>();
    let parts = if words.len() == count {
        words
    } else {
        (0..count)
            .map(|i| {
                columns(
                    line,
                    8 * i,
                    if i + 1 == count {
                        line.len()
                    } else {
                        8 * i + 8
                    },
                )
            })
            .collect()
    };
    parts.into_iter().map(number::integer).collect()
}

fn read_columns(
    text: &mut Text,
    head: &Head,
    format: Format,
    mut matrix: Option<&mut ForeignMatrix>,
) -> Result<(), FileProblem> {
    let mut last = 0;
    loop {
        let Some(line) = text.next_line()? else {
            return Err(text.cut(&format!(
                "the end of matrix {}, after column {last}",
                head.name
            )));
        };
        let Some(&[column, first, words]) = integers(line, 3).as_deref() else {
            return Err(text.wrong(
                &format!(
                    "the head of a column after column {last} of matrix {}: column, row, words",
                    head.name
                ),
                "write the file again; it is damaged, or its values have another width than the format in its head",
            ));
        };
        let located = |text: &Text, (problem, advice): Wrong| text.problem(problem, advice);
        let column = head
            .column(column, last)
            .map_err(|wrong| located(text, wrong))?;
        let words = usize::try_from(words).unwrap_or(0);
        if column > head.columns {
            return pass_trailer(text);
        }
        last = column;
        if first != 0 {
            run(
                text,
                head,
                format,
                (column, first, words),
                matrix.as_deref_mut(),
            )?;
            continue;
        }
        let mut left = words;
        while left > 0 {
            let heading = if head.big { 2 } else { 1 };
            let Some(line) = text.next_line()? else {
                return Err(text.cut(&format!("the end of column {column}")));
            };
            let (length, row) = match integers(line, heading).as_deref() {
                Some([length, row]) => (*length, *row),
                Some([both]) => (both >> 16, both & 0xffff),
                _ => {
                    return Err(text.wrong(
                        "the head of a string of entries",
                        "write the file again; it is damaged, or its values have another width than the format in its head",
                    ));
                }
            };
            // words of an entry: two in double precision
            let size = head.parts() * if head.kind % 2 == 0 { 2 } else { 1 };
            let used = usize::try_from(length.saturating_sub(1)).unwrap_or(0);
            if used == 0 || !used.is_multiple_of(size) || used.saturating_add(heading) > left {
                return Err(text.problem(
                    format!(
                        "a string of {length} words does not fit into column {column} of matrix {}, which has {left} words left",
                        head.name
                    ),
                    "write or copy the file again; it is damaged",
                ));
            }
            left -= used + heading;
            let count = used / size * head.parts();
            run(
                text,
                head,
                format,
                (column, row, count),
                matrix.as_deref_mut(),
            )?;
        }
    }
}

/// Passes over the dummy values of the column that ends a matrix.
fn pass_trailer(text: &mut Text) -> Result<(), FileProblem> {
    while let Some(line) = text.next_line()? {
        if line.is_empty() || number::integer(columns(line, 0, 8)).is_some() {
            text.put_back();
            break;
        }
    }
    Ok(())
}

/// Entries one below the other: column from 1, first row from 1, number of reals.
fn run(
    text: &mut Text,
    head: &Head,
    format: Format,
    (column, first, count): (usize, i64, usize),
    mut matrix: Option<&mut ForeignMatrix>,
) -> Result<(), FileProblem> {
    let start = head.run(first, count / head.parts(), column);
    let start = start.map_err(|(problem, advice)| text.problem(problem, advice))?;
    let mut row = start;
    values(text, format, count, |field, value| {
        let Some(matrix) = matrix.as_deref_mut() else {
            return Ok(());
        };
        let Some(value) = value else {
            return Err((
                format!(
                    "\"{field}\" at row {}, column {column} of matrix {} is not a finite number",
                    u64::from(row) + 1,
                    head.name
                ),
                NUMBERS.to_string(),
            ));
        };
        keep(matrix, row, column, value)?;
        row += 1;
        Ok(())
    })
}

/// Reads `count` values over as many lines as they need.
fn values(
    text: &mut Text,
    format: Format,
    count: usize,
    mut give: impl FnMut(&str, Option<f64>) -> Result<(), Wrong>,
) -> Result<(), FileProblem> {
    let mut left = count;
    while left > 0 {
        let here = left.min(format.values);
        let Some(line) = text.next_line()? else {
            return Err(text.cut(&format!("{left} values of a column")));
        };
        let length = line.len();
        let mut wrong = None;
        if here.checked_mul(format.width) == Some(length) {
            for i in 0..here {
                let field = columns(line, i * format.width, (i + 1) * format.width);
                if let Err(found) = give(field, real(field)) {
                    wrong = Some(found);
                    break;
                }
            }
        } else {
            wrong = Some((
                format!(
                    "the line has {length} characters instead of {here} values of {} characters",
                    format.width
                ),
                "write the file again; the line was cut or edited, or its values have another width than the format in the head".into(),
            ));
        }
        if let Some((problem, advice)) = wrong {
            return Err(text.problem(problem, advice));
        }
        left -= here;
    }
    Ok(())
}
