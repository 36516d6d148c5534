//! Matrices as lines `row column value`: CalculiX's `.sti` and `.mas` (`*FREQUENCY, SOLVER=MATRIXSTORAGE`;
//! upper triangle, 13 digits after the first), Abaqus' `.mtx` (`*MATRIX OUTPUT`) in the formats `COORDINATE`
//! (both triangles) and `MATRIX INPUT` (`node, freedom, node, freedom, value`, one triangle). Rows count from
//! 1.

use super::text::{NUMBERS, Text, columns, count, real};
use super::{ForeignFreedoms, ForeignMatrix, substructure, whole};
use crate::error::FileProblem;
use crate::mesh::Pair;
use crate::read::Files;

/// A diagonal entry of at least this size means a support (Abaqus writes 10³⁶).
const PENALTY: f64 = 1e30;

const MATRIX_MARKET: &str =
    "lines that begin with % belong to the format MatrixMarket, not to text of Abaqus or CalculiX";
const STRIP: &str = "remove the lines that begin with % and the line of sizes after them. Eng reads the remaining lines `row column value` of a \
     symmetric matrix, counted from 1. State the freedoms of the rows by `per_node: 3`, `per_node: 6` or `freedoms: \".dof\"`";

/// Reads a matrix of Abaqus, in either of its formats, or that of a substructure: `name` is then its type,
/// `STIFFNESS` or `MASS`.
///
/// # Errors
/// With file and line: a line that isn't an entry, a number that isn't finite, a support (held freedoms are
/// stiff springs in Abaqus' matrices), a node of Abaqus' own; a file without entries.
pub fn read_abaqus_matrix(
    files: &dyn Files,
    file: &str,
    name: &str,
) -> Result<ForeignMatrix, FileProblem> {
    let mut text = Text::open(files, file)?;
    let mut coordinates = Vec::new();
    let mut freedoms = Vec::new();
    while let Some(line) = text.next_line()? {
        let line = line.trim();
        if line.is_empty() || line.starts_with("**") {
            continue;
        }
        if line.starts_with('%') {
            return Err(text.problem(MATRIX_MARKET, STRIP));
        }
        if substructure::begins(line) && coordinates.is_empty() && freedoms.is_empty() {
            text.put_back();
            return substructure::read(text, file, name);
        }
        if line.starts_with('*') {
            return Err(text.wrong(
                "an entry of a matrix",
                "write stiffness and mass with *MATRIX GENERATE and *MATRIX OUTPUT, or those of a substructure with \
                 *SUBSTRUCTURE MATRIX OUTPUT",
            ));
        }
        let fields = line
            .split([',', ' ', '\t'])
            .filter(|field| !field.is_empty())
            .collect::<Vec<_>>();
        let value = match fields.as_slice() {
            [row, column, value] if freedoms.is_empty() => {
                place(row, column).map(|(row, column)| {
                    coordinates.push((row, column, f64::NAN));
                    *value
                })
            }
            [node, freedom, other, other_freedom, value] if coordinates.is_empty() => {
                match (
                    node_freedom(node, freedom),
                    node_freedom(other, other_freedom),
                ) {
                    (Some(first), Some(second)) => {
                        freedoms.push((first, second, f64::NAN));
                        Some(*value)
                    }
                    _ => None,
                }
            }
            _ => None,
        };
        let Some(value) = value else {
            return Err(text.wrong(
                "an entry \"row column value\" or \"node, freedom, node, freedom, value\"",
                "write numbers from 1 and freedoms from 1 to 6; nodes that Abaqus adds, with negative numbers (contact), can't be part of a body",
            ));
        };
        let Some(value) = real(value) else {
            return Err(text.wrong("an entry with a finite number", NUMBERS));
        };
        if value.abs() >= PENALTY {
            return Err(text.wrong(
                "an entry of a free body, but of a support",
                "write the matrices without *BOUNDARY, and state the supports in the model",
            ));
        }
        if let Some(last) = coordinates.last_mut() {
            last.2 = value;
        }
        if let Some(last) = freedoms.last_mut() {
            last.2 = value;
        }
    }
    if freedoms.is_empty() {
        return from_coordinates(file, coordinates);
    }
    of_pairs(file, "", &freedoms)
}

/// The symmetric matrix of entries of one triangle, its rows by ascending node and freedom.
pub(crate) fn of_pairs(
    file: &str,
    name: &str,
    pairs: &[Pair],
) -> Result<ForeignMatrix, FileProblem> {
    let mut rows = pairs
        .iter()
        .flat_map(|(first, second, _)| [*first, *second])
        .collect::<Vec<_>>();
    rows.sort_unstable();
    rows.dedup();
    let row = |freedom| rows.binary_search(&freedom).unwrap_or(0) as u32; // fewer than lines; all are there
    if u32::try_from(rows.len()).is_err() {
        return Err(whole(file, "has too many freedoms", "divide the model"));
    }
    Ok(ForeignMatrix {
        file: file.into(),
        name: name.into(),
        rows: rows.len(),
        columns: rows.len(),
        symmetric: true,
        entries: pairs
            .iter()
            .map(|(first, second, value)| (row(*first), row(*second), *value))
            .collect(),
        freedoms: Some(ForeignFreedoms { rows }),
    })
}

/// Reads a matrix of CalculiX (`.sti`, `.mas`); its freedoms are in the `.dof` beside it:
/// [`read_calculix_freedoms`].
///
/// # Errors
/// With file and line: a line that isn't an entry, a number that isn't finite; a file without entries.
pub fn read_calculix_matrix(files: &dyn Files, file: &str) -> Result<ForeignMatrix, FileProblem> {
    let mut text = Text::open(files, file)?;
    let mut entries = Vec::new();
    while let Some(line) = text.next_line()? {
        if line.is_empty() {
            continue;
        }
        if line.starts_with('%') {
            return Err(text.problem(MATRIX_MARKET, STRIP));
        }
        let fields = line.split_whitespace().collect::<Vec<_>>();
        let entry = match fields.as_slice() {
            [row, column, value] => place(row, column).map(|place| (place, real(value))),
            _ => None,
        };
        match entry {
            Some(((row, column), Some(value))) => entries.push((row, column, value)),
            Some((_, None)) => return Err(text.wrong("an entry with a finite number", NUMBERS)),
            None => {
                return Err(text.wrong(
                    "an entry \"row column value\" with numbers from 1",
                    "give the .sti or .mas that CalculiX writes with *FREQUENCY, SOLVER=MATRIXSTORAGE",
                ));
            }
        }
    }
    from_coordinates(file, entries)
}

/// Reads the freedom of each row of CalculiX's matrices, from a line `node.freedom` for each row; `point.0`
/// for a scalar point.
///
/// # Errors
/// With file and line: a line that is no freedom, a repeated freedom.
pub fn read_calculix_freedoms(
    files: &dyn Files,
    file: &str,
) -> Result<ForeignFreedoms, FileProblem> {
    let mut text = Text::open(files, file)?;
    let mut rows = Vec::new();
    while let Some(line) = text.next_line()? {
        let line = columns(line, 0, line.len());
        if line.is_empty() {
            continue;
        }
        let freedom = line
            .split_once('.')
            .and_then(|(node, freedom)| match freedom {
                "0" => Some((count(node)?, 0)),
                _ => node_freedom(node, freedom),
            });
        match freedom {
            Some(freedom) => rows.push(freedom),
            None => {
                return Err(text.wrong(
                    "a freedom \"node.direction\" with a direction from 1 to 6, or 0 for a scalar point",
                    "give the .dof that CalculiX writes beside the .sti, or a list of your own",
                ));
            }
        }
    }
    let mut sorted = rows.clone();
    sorted.sort_unstable();
    let twice = sorted.windows(2).find(|pair| pair.first() == pair.last());
    if let Some([(node, freedom), ..]) = twice {
        return Err(whole(
            file,
            format!("lists freedom {freedom} of node {node} twice"),
            "write or copy the file again; it is damaged",
        ));
    }
    Ok(ForeignFreedoms { rows })
}

/// Row and column from 0 of numbers from 1.
fn place(row: &str, column: &str) -> Option<(u32, u32)> {
    let from_one = |text| {
        count(text)?
            .checked_sub(1)
            .and_then(|index| u32::try_from(index).ok())
            .filter(|index| *index < u32::MAX)
    };
    Some((from_one(row)?, from_one(column)?))
}

fn node_freedom(node: &str, freedom: &str) -> Option<(u64, u8)> {
    let node = count(node).filter(|node| *node > 0)?;
    match freedom {
        "1" => Some((node, 1)),
        "2" => Some((node, 2)),
        "3" => Some((node, 3)),
        "4" => Some((node, 4)),
        "5" => Some((node, 5)),
        "6" => Some((node, 6)),
        _ => None,
    }
}

/// The matrix of coordinates. Its size is the largest number. It is one triangle if the other side of the
/// diagonal has no entry.
fn from_coordinates(
    file: &str,
    entries: Vec<(u32, u32, f64)>,
) -> Result<ForeignMatrix, FileProblem> {
    let Some(size) = entries.iter().map(|entry| entry.0.max(entry.1)).max() else {
        return Err(whole(
            file,
            "contains no entry of a matrix",
            "read the messages of the run that writes it; the run may have failed",
        ));
    };
    let below = entries.iter().any(|entry| entry.0 > entry.1);
    let above = entries.iter().any(|entry| entry.0 < entry.1);
    let size = size as usize + 1;
    Ok(ForeignMatrix {
        file: file.into(),
        name: String::new(),
        rows: size,
        columns: size,
        symmetric: !(below && above),
        entries,
        freedoms: None,
    })
}
