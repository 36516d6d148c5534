//! Mode shapes of Nastran's punch file (`VECTOR(PUNCH) = ALL`): a block `$EIGENVECTOR` for each mode, with two
//! lines for each grid point (number, `G`, translations; `-CONT-`, rotations). Values have 18 columns and 7
//! digits. The last 8 columns of a line contain its number.

use super::text::{NUMBERS, Text, columns, count, real};
use super::{COMPLEX, ForeignModes, ShapeFrame};
use crate::error::FileProblem;
use crate::read::Files;

/// A mode being read.
struct Open {
    number: u64,
    eigenvalue: Option<f64>,
    rows: Vec<(u64, [f64; 6])>,
}

/// Reads the mode shapes of a punch file; other results in it are passed over, scalar points too.
///
/// # Errors
/// With file and line: complex shapes, results sorted by point, a lost line, text in the place of a
/// number; modes on different nodes, or none.
pub fn read_punch_modes(files: &dyn Files, file: &str) -> Result<ForeignModes, FileProblem> {
    let mut text = Text::open(files, file)?;
    let mut modes = ForeignModes::new(file, ShapeFrame::Analysis, 7);
    let mut is_shape = false;
    let mut open: Option<Open> = None;
    let mut scalar = 0_u64;
    while let Some(line) = text.next_line()? {
        let line = columns(line, 0, 72).to_string();
        let begins_node = line.len() >= 8 && !line.starts_with('$');
        if let Some(words) = line.strip_prefix('$') {
            let words = words.trim();
            if let Some(mode) = words.strip_prefix("EIGENVALUE").filter(|_| is_shape) {
                close(&mut modes, open.take())?;
                open = Some(begin(&text, mode)?);
            } else if words.starts_with("EIGENVECTOR") {
                is_shape = true;
            } else if is_shape && words.starts_with("POINT ID") {
                return Err(text.problem(
                    "the shapes are sorted by point, not by mode",
                    "write them with VECTOR(SORT1, PUNCH, REAL) = ALL",
                ));
            } else if is_shape && words.contains("IMAGINARY") {
                return Err(text.problem("the shapes are complex", COMPLEX));
            } else if words.starts_with("TITLE") {
                is_shape = false;
                close(&mut modes, open.take())?;
            }
            continue;
        }
        let Some(mode) = open.as_mut().filter(|_| begins_node) else {
            continue;
        };
        // columns were trimmed at the left: the number is the first word
        let mut words = line.split_whitespace();
        let (id, kind) = (words.next().and_then(count), words.next().unwrap_or(""));
        let (Some(id), "G" | "S" | "L" | "M" | "H") = (id, kind) else {
            return Err(text.wrong(
                "the line of a point: number, G, three values",
                "write the file again; it was edited or cut",
            ));
        };
        if kind != "G" {
            scalar += 1;
            continue;
        }
        let first = three(&text, words)?;
        let next = text
            .next_line()?
            .map(|line| columns(line, 0, 72).to_string());
        let Some(rest) = next.as_deref().and_then(|line| line.strip_prefix("-CONT-")) else {
            return Err(match next {
                None => text.cut(&format!("the rotations of grid point {id}")),
                Some(_) => text.wrong(
                    &format!("the rotations of grid point {id}"),
                    "write the file again; it was edited or cut",
                ),
            });
        };
        let second = three(&text, rest.split_whitespace())?;
        let [a, b, c] = first;
        let [d, e, f] = second;
        mode.rows.push((id, [a, b, c, d, e, f]));
    }
    close(&mut modes, open)?;
    if scalar > 0 {
        modes.warnings.push(format!(
            "{file}: {scalar} values of scalar points were not read"
        ));
    }
    modes.finish("write shapes with VECTOR(SORT1, PUNCH, REAL) = ALL in a run of SOL 103")
}

fn close(modes: &mut ForeignModes, open: Option<Open>) -> Result<(), FileProblem> {
    match open {
        Some(open) => modes.push(open.number, open.eigenvalue, open.rows),
        None => Ok(()),
    }
}

/// `= 1.23E+05  MODE = 7`.
fn begin(text: &Text, line: &str) -> Result<Open, FileProblem> {
    if line.contains('(') {
        return Err(text.problem("the shapes are complex", COMPLEX));
    }
    let parts = line.split_once("MODE").map(|(value, mode)| {
        let value = value.trim_matches(['=', ' ']);
        let mode = mode.trim_matches(['=', ' ']);
        (real(value), count(mode))
    });
    match parts {
        Some((Some(eigenvalue), Some(number))) => Ok(Open {
            number,
            eigenvalue: Some(eigenvalue),
            rows: Vec::new(),
        }),
        _ => Err(text.wrong("$EIGENVALUE = value MODE = number", NUMBERS)),
    }
}

/// Three values; each is 13 wide in 18 columns, so that blanks part them.
fn three<'l>(
    text: &Text,
    mut words: impl Iterator<Item = &'l str>,
) -> Result<[f64; 3], FileProblem> {
    let mut value = || words.next().and_then(real);
    match (value(), value(), value()) {
        (Some(a), Some(b), Some(c)) => Ok([a, b, c]),
        _ => Err(text.wrong("a line with three finite numbers", NUMBERS)),
    }
}
