//! Mode shapes of CalculiX's `.frd` as text (`*NODE FILE` with `U` in a step `*FREQUENCY`). A result begins
//! with `100C` (its value is the frequency in cycles) and names its quantity on a line `-4`. It has a line
//! `-1` for each node, with values of 6 digits in 12 columns. `1PMODE`, `1PGM` and `1PGK` before it give the
//! mode's number, generalised mass and stiffness. Source: CalculiX GraphiX manual, result format.

use super::text::{NUMBERS, Text, columns, count, real};
use super::{ForeignModes, ShapeFrame};
use crate::error::FileProblem;
use crate::read::Files;

/// The data before a result.
#[derive(Default)]
struct Before {
    mode: Option<u64>,
    mass: Option<f64>,
    stiffness: Option<f64>,
}

/// Reads the displacements of all modes and skips other results. It does not read the coordinates, because
/// this format rounds them.
///
/// # Errors
/// With file and line: a binary file, a wrong line, a text that is no number; modes on different nodes, or no
/// modes.
pub fn read_frd_modes(files: &dyn Files, file: &str) -> Result<ForeignModes, FileProblem> {
    let mut text = Text::open(files, file)?;
    let mut modes = ForeignModes::new(file, ShapeFrame::Basic, 6);
    let mut before = Before::default();
    // for a result with a still unknown quantity: number, frequency, and columns of a node's number
    let mut result: Option<(u64, Option<f64>, usize)> = None;
    let mut ended = false;
    while let Some(line) = text.next_line()? {
        let key = columns(line, 0, 5);
        if let Some(name) = line.trim_start().strip_prefix("1P").filter(|_| key == "1") {
            let mut words = name.split_whitespace();
            match (words.next(), words.next()) {
                (Some("MODE"), Some(number)) => before.mode = count(number),
                (Some("GM"), Some(mass)) => before.mass = real(mass),
                (Some("GK"), Some(stiffness)) => before.stiffness = real(stiffness),
                _ => {}
            }
        } else if key == "9999" {
            ended = true;
        } else if key == "100" {
            let id_width = match columns(line, 73, 75) {
                "1" => 10,
                "0" => 5,
                _ => {
                    return Err(text.wrong(
                        "the head of a result as text",
                        "request *NODE FILE instead of *NODE OUTPUT; Eng reads no binary .frd",
                    ));
                }
            };
            let is_mode = columns(line, 63, 73).starts_with("MOD") || before.mode.is_some();
            let taken = std::mem::take(&mut before);
            let number = taken.mode.or_else(|| count(columns(line, 58, 63)));
            let eigenvalue = match (taken.stiffness, taken.mass) {
                (Some(stiffness), Some(mass)) if mass > 0.0 => Some(stiffness / mass),
                _ => real(columns(line, 12, 24)).map(|frequency| {
                    let angular = 2.0 * std::f64::consts::PI * frequency;
                    angular * angular
                }),
            };
            result = number
                .filter(|_| is_mode)
                .map(|number| (number, eigenvalue, id_width));
        } else if columns(line, 0, 3) == "-4" {
            let is_shape = columns(line, 3, 13).starts_with("DISP")
                && !columns(line, 3, 13).starts_with("DISPI");
            if let Some((number, eigenvalue, id_width)) = result.take().filter(|_| is_shape) {
                let rows = shape(&mut text, id_width)?;
                modes.push(number, eigenvalue, rows)?;
            }
        }
    }
    if !ended {
        return Err(text.cut("its line 9999"));
    }
    modes.finish("write shapes with *NODE FILE and U in a step with *FREQUENCY")
}

/// The lines of a result up to `-3`.
fn shape(text: &mut Text, id_width: usize) -> Result<Vec<(u64, [f64; 6])>, FileProblem> {
    let mut rows = Vec::new();
    loop {
        let Some(line) = text.next_line()? else {
            return Err(text.cut("the end of a mode shape"));
        };
        match columns(line, 0, 3) {
            "-5" => {}
            "-3" => return Ok(rows),
            "-1" => {
                let first = 3 + id_width;
                let value = |i: usize| real(columns(line, first + 12 * i, first + 12 * i + 12));
                let id = count(columns(line, 3, first));
                match (id, value(0), value(1), value(2)) {
                    (Some(id), Some(x), Some(y), Some(z)) => {
                        rows.push((id, [x, y, z, 0.0, 0.0, 0.0]));
                    }
                    _ => return Err(text.wrong("a node's number and three finite values", NUMBERS)),
                }
            }
            _ => {
                return Err(text.wrong(
                    "a line of a mode shape (-5, -1 or -3)",
                    "write the file again; it was edited or cut",
                ));
            }
        }
    }
}
