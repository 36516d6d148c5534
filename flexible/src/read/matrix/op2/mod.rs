//! Nastran's OP2 (`PARAM,POST,-1`, `OUTPUT2`), of 32-bit and 64-bit codes: matrices and mode shapes.
//!
//! Tables read: `EQEXIN` (numbers of points and their rows), `LAMA` (eigenvalues), `OUGV1` and similar tables
//! (mode shapes, single precision in 32-bit files: 7 digits). Any matrix can be read by its name. The reader
//! skips other tables. Sources: MSC Nastran DMAP guide (data blocks), NX Nastran DMAP guide, files of
//! MYSTRAN.

mod blocks;
mod points;
mod shapes;

use super::{COMPLEX, ForeignFreedoms, ForeignMatrix, ForeignModes, Held, chosen};
use crate::error::FileProblem;
use crate::read::Files;
use blocks::{Block, Blocks, Step};
use points::Points;

/// Trailer, after its first word, of a table that holds matrices as cards.
const POOLED: [i64; 6] = [32768, 0, 0, 0, 0, 0];

/// Reads the matrix with a name, or the only one if `name` is empty. Its freedoms are known if it has a row
/// for each freedom of all points (`KGG`, `MGG`) and the file holds `EQEXIN`. For a reduced matrix (`KAA`)
/// the model must state the freedoms of the rows.
///
/// # Errors
/// With file and record: a file of another format, a cut or damaged file, a complex matrix, an entry
/// that is no finite number; a name that is not in the file, with the names that are.
pub fn read_op2_matrix(
    files: &dyn Files,
    file: &str,
    name: &str,
) -> Result<ForeignMatrix, FileProblem> {
    let mut blocks = Blocks::open(files, file)?;
    let mut held = Vec::new();
    let mut found = None;
    let mut pooled = Vec::new();
    let mut points = Points::default();
    while let Some(block) = blocks.next_block()? {
        if points.wants(&block) {
            points.read(&mut blocks)?;
            continue;
        }
        if block.trailer.get(1..) == Some(&POOLED) {
            pooled.push(block.name.clone());
        }
        let mut matrix = None;
        let mut is_matrix = false;
        let mut column = 0;
        while let Some(step) = blocks.next_step()? {
            match step {
                Step::Table => {}
                Step::Column => {
                    if !is_matrix {
                        is_matrix = true;
                        matrix = head(&blocks, &block, file, name, &mut held, found.is_none())?;
                    }
                    column += 1;
                }
                Step::Data(data) => {
                    if let Some(matrix) = &mut matrix {
                        entries(&blocks, &block, matrix, column, &data)?;
                    }
                }
            }
        }
        if let Some(matrix) = matrix {
            if column != matrix.columns {
                return Err(blocks.problem(
                    format!(
                        "matrix {} has {column} columns, but its head states {} columns",
                        matrix.name, matrix.columns
                    ),
                    "write or copy the file again; it is damaged",
                ));
            }
            found = Some(matrix);
        }
    }
    let chosen = chosen(file, name, &held, found);
    let mut matrix = chosen.map_err(|mut problem| {
        if !pooled.is_empty() {
            problem.advice += &format!(
                "; {} are tables of DMIG cards, which Eng does not read: write them with OUTPUT4 or as matrices",
                pooled.join(", ")
            );
        }
        problem
    })?;
    if matrix.rows == matrix.columns {
        matrix.freedoms = points
            .rows()
            .filter(|rows| rows.len() == matrix.rows)
            .map(|rows| ForeignFreedoms { rows });
    }
    Ok(matrix)
}

/// Notes a matrix, and begins to read it if it is the wanted one.
fn head(
    blocks: &Blocks,
    block: &Block,
    file: &str,
    name: &str,
    held: &mut Vec<Held>,
    first: bool,
) -> Result<Option<ForeignMatrix>, FileProblem> {
    let size = |i: usize| {
        block
            .trailer
            .get(i)
            .and_then(|count| u32::try_from(*count).ok())
    };
    let (columns, rows) = (size(1), size(2));
    let kind = block.trailer.get(4).copied().unwrap_or(0);
    held.push(Held {
        name: block.name.clone(),
        size: (rows.unwrap_or(0) as usize, columns.unwrap_or(0) as usize),
    });
    if !first || !(name.is_empty() || block.name.eq_ignore_ascii_case(name)) {
        return Ok(None);
    }
    match (rows, columns, kind) {
        (Some(rows), Some(columns), 1 | 2) => Ok(Some(ForeignMatrix {
            file: file.into(),
            name: block.name.clone(),
            rows: rows as usize,
            columns: columns as usize,
            symmetric: false,
            entries: Vec::new(),
            freedoms: None,
        })),
        (Some(_), Some(_), 3 | 4) => Err(blocks.problem(
            format!("matrix {} is complex (type {kind})", block.name),
            COMPLEX,
        )),
        _ => Err(blocks.problem(
            format!(
                "the trailer {1:?} of matrix {0} states no size and type",
                block.name, block.trailer
            ),
            "write it with OUTPUT4, or with OUTPUT2 as a matrix",
        )),
    }
}

/// The entries of a string: its first row, and values one below the other.
fn entries(
    blocks: &Blocks,
    block: &Block,
    matrix: &mut ForeignMatrix,
    column: usize,
    data: &[u8],
) -> Result<(), FileProblem> {
    let key = blocks.key_bytes();
    let damaged = |problem: String| {
        blocks.problem(
            format!("in column {column} of matrix {}: {problem}", matrix.name),
            "write or copy the file again; it is damaged",
        )
    };
    let single = block.trailer.get(4) == Some(&1);
    let real = if single { key } else { 8 };
    let (first, values) = data.split_at_checked(key).unwrap_or((&[], &[]));
    let first = blocks.integer(first);
    if values.is_empty() || !values.len().is_multiple_of(real) {
        return Err(damaged(format!(
            "a string has {} bytes, which is no whole number of values",
            data.len()
        )));
    }
    let count = values.len() / real;
    let start = match u32::try_from(first.saturating_sub(1)) {
        Ok(start) if start as usize + count <= matrix.rows => start,
        _ => {
            return Err(damaged(format!(
                "{count} entries from row {first} exceed its {} rows",
                matrix.rows
            )));
        }
    };
    let place = match column.checked_sub(1) {
        Some(place) if place < matrix.columns => place as u32, // as many as the head states, which fit
        _ => {
            return Err(damaged(format!(
                "the matrix has only {} columns",
                matrix.columns
            )));
        }
    };
    for (row, bytes) in (start..).zip(values.chunks_exact(real)) {
        let value = blocks.real(bytes);
        if !value.is_finite() {
            return Err(blocks.problem(
                format!(
                    "matrix {} contains {value} at row {}, column {column}",
                    matrix.name,
                    u64::from(row) + 1
                ),
                "the run that wrote it failed; read the messages of that run",
            ));
        }
        if value != 0.0 {
            matrix.entries.push((row, place, value));
        }
    }
    Ok(())
}

/// Reads the real mode shapes of a run of SOL 103, with the eigenvalues of the table `LAMA`.
///
/// # Errors
/// With file and record: a file of another format, a cut or damaged file, complex shapes or shapes sorted
/// by point; modes on different nodes, or none.
pub fn read_op2_modes(files: &dyn Files, file: &str) -> Result<ForeignModes, FileProblem> {
    let mut blocks = Blocks::open(files, file)?;
    let mut shapes = shapes::Shapes::default();
    while let Some(block) = blocks.next_block()? {
        shapes.read(&mut blocks, &block)?;
    }
    shapes.finish(file, blocks.key_bytes())
}
