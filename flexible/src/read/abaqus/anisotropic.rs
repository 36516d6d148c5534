//! Constants of anisotropic solids: `*ELASTIC, TYPE=ENGINEERING CONSTANTS`, `ORTHO` and `ANISO`.
//!
//! In the order 11, 22, 33, 12, 23, 31 of Eng, `ANISO` states the upper triangle of the stiffness by columns, with 13 before
//! 23 (manuals of Abaqus and CalculiX, `*ELASTIC`). Shear strains are engineering ones.

use super::lines::Row;
use crate::error::FileProblem;
use crate::mesh::SolidElasticity;

/// Entries of a line that is full.
const WIDTH: usize = 8;

/// Row and column of the constants of `TYPE=ANISO` in their order.
const ENTRIES: [(usize, usize); 21] = [
    (0, 0),
    (0, 1),
    (1, 1),
    (0, 2),
    (1, 2),
    (2, 2),
    (0, 3),
    (1, 3),
    (2, 3),
    (3, 3),
    (0, 5),
    (1, 5),
    (2, 5),
    (3, 5),
    (5, 5),
    (0, 4),
    (1, 4),
    (2, 4),
    (3, 4),
    (5, 4),
    (4, 4),
];

/// The constants of `TYPE=ORTHO` among these: D1111, D1122, D2222, D1133, D2233, D3333, D1212, D1313, D2323.
const ORTHOTROPIC: [usize; 9] = [0, 1, 2, 3, 4, 5, 9, 14, 20];

/// The lines of a temperature for a TYPE (capitals, without blanks); `None` for another type.
pub(super) fn lines(kind: &str) -> Option<usize> {
    match kind {
        "ENGINEERINGCONSTANTS" | "ORTHO" | "ORTHOTROPIC" => Some(2),
        "ANISO" | "ANISOTROPIC" => Some(3),
        _ => None,
    }
}

/// The entry of the temperature in the last of these lines.
pub(super) fn place_of_temperature(lines: usize) -> usize {
    match lines {
        2 => 1,
        _ => 5,
    }
}

/// The constants of `TYPE=ANISO` from the lines of a temperature.
///
/// # Errors
/// A missing line or constant; constants of no elastic solid.
pub(super) fn constants(kind: &str, rows: &[&Row]) -> Result<[f64; 21], FileProblem> {
    let number = |i: usize, name: &str| {
        let Some(row) = rows.get(i / WIDTH) else {
            let problem = |row: &&Row| {
                row.at.problem(
                    format!("{name} is missing: the line after this one is not there"),
                    "write eight constants on each line, and the rest on the last one",
                )
            };
            return match rows.last().map(problem) {
                Some(problem) => Err(problem),
                None => Ok(0.0), // never: a group has a line
            };
        };
        row.real(i % WIDTH, name)
    };
    let mut found = [0.0; 21];
    match kind {
        "ENGINEERINGCONSTANTS" => {
            let names = [
                "E1", "E2", "E3", "nu12", "nu13", "nu23", "G12", "G13", "G23",
            ];
            let mut own = [0.0; 9];
            for ((i, constant), name) in own.iter_mut().enumerate().zip(names) {
                *constant = number(i, name)?;
            }
            let [e1, e2, e3, n12, n13, n23, g12, g13, g23] = own;
            let stiffness =
                SolidElasticity::orthotropic([e1, e2, e3], [n12, n13, n23], [g12, g13, g23]);
            match (stiffness, rows.first()) {
                (Some(stiffness), _) => {
                    for (constant, (i, j)) in found.iter_mut().zip(ENTRIES) {
                        *constant = stiffness[i][j];
                    }
                }
                (None, Some(row)) => {
                    return Err(row.at.problem(
                        "no elastic solid has these constants",
                        "E1, E2, E3 and the shear moduli must be above zero, and nu12 squared below E1/E2, nu13 squared below E1/E3, nu23 squared below E2/E3",
                    ));
                }
                (None, None) => {} // never: a group has a line
            }
        }
        "ANISO" | "ANISOTROPIC" => {
            for ((k, constant), (i, j)) in found.iter_mut().enumerate().zip(ENTRIES) {
                *constant = number(k, &format!("the stiffness of {} and {}", axis(i), axis(j)))?;
            }
        }
        _ => {
            for (k, place) in ORTHOTROPIC.into_iter().enumerate() {
                let (i, j) = ENTRIES[place];
                found[place] = number(k, &format!("the stiffness of {} and {}", axis(i), axis(j)))?;
            }
        }
    }
    Ok(found)
}

/// The name of a component.
fn axis(i: usize) -> &'static str {
    ["11", "22", "33", "12", "23", "13"].get(i).unwrap_or(&"")
}

/// The stiffness of these constants.
pub(super) fn stiffness(constants: &[f64; 21]) -> [[f64; 6]; 6] {
    let mut stiffness = [[0.0; 6]; 6];
    for (x, (i, j)) in constants.iter().zip(ENTRIES) {
        (stiffness[i][j], stiffness[j][i]) = (*x, *x);
    }
    stiffness
}
