//! Bulk data of Nastran: a reduced body as scalar points with direct matrices, and its markers as grid points
//! that follow them.
//!
//! The six coordinates of the frame and the amplitudes of the modes are scalar points. `DMIG` cards give
//! stiffness, mass and damping of them in double precision, with 10 to 13 digits. Multipoint constraints join
//! the six freedoms of the grid point of each marker to the scalar points (see [`crate::small_motion`]).

use super::NumberedBody;
use super::number::field;
use crate::small_motion::Dense;
use std::fmt::{self, Write};

/// Number of the set of constraints.
const CONSTRAINTS: usize = 1;

/// The cards. The case control of the run must select the matrices and the constraints; a comment states the lines.
pub fn bulk_data(body: &NumberedBody) -> String {
    let mut text = String::new();
    // writing to a text cannot fail
    let _ = write_cards(&mut text, body);
    text
}

fn write_cards(text: &mut String, body: &NumberedBody) -> fmt::Result {
    let size = body.motion.mass.rows();
    let scalar = body.first + body.markers.len();
    writeln!(
        text,
        "$ {}: reduced body of Eng, in SI units (N, m, kg, s, rad)",
        body.name
    )?;
    writeln!(
        text,
        "$ Case control: K2GG = KENG, M2GG = MENG, B2GG = BENG, MPC = {CONSTRAINTS}"
    )?;
    writeln!(text, "$ Loads of gravity do not act on M2GG.")?;
    writeln!(
        text,
        "$ Scalar points {scalar} to {}: translation and rotation of the frame (x, y, z each)",
        scalar + 5
    )?;
    writeln!(
        text,
        "$ Scalar points from {}: amplitudes of the modes",
        scalar + 6
    )?;
    for (index, (name, place)) in body.markers.iter().enumerate() {
        writeln!(text, "$ {name}")?;
        let [x, y, z] = place.map(field);
        let id = body.first + index;
        writeln!(text, "{:<8}{id:>16}{:>16}{x:>16}{y:>16}", "GRID*", "")?;
        writeln!(text, "{:<8}{z:>16}", "*")?;
    }
    writeln!(
        text,
        "{:<8}{scalar:>8}{:>8}{:>8}",
        "SPOINT",
        "THRU",
        scalar + size - 1
    )?;
    for (name, matrix) in [
        ("KENG", &body.motion.stiffness),
        ("MENG", &body.motion.mass),
        ("BENG", &body.motion.damping),
    ] {
        direct(text, name, matrix, scalar)?;
    }
    for row in 0..body.motion.motion.rows() {
        constraint(text, body, row, scalar)?;
    }
    Ok(())
}

/// `DMIG` of a symmetric matrix: the entries on and below the diagonal.
fn direct(text: &mut String, name: &str, matrix: &Dense, scalar: usize) -> fmt::Result {
    writeln!(text, "{:<8}{name:<8}{:>8}{:>8}{:>8}", "DMIG", 0, 6, 2)?;
    for column in 0..matrix.columns() {
        let rows = column..matrix.rows();
        let entries = rows.filter(|row| matrix.at(*row, column) != 0.0);
        let entries = entries.collect::<Vec<_>>();
        if entries.is_empty() {
            continue;
        }
        let point = scalar + column;
        writeln!(text, "{:<8}{name:<16}{point:>16}{:>16}", "DMIG*", 0)?;
        for row in entries {
            let value = field(matrix.at(row, column));
            writeln!(text, "{:<8}{:>16}{:>16}{value:>16}", "*", scalar + row, 0)?;
        }
    }
    Ok(())
}

/// `MPC` of one freedom of a marker: `−u + Σ L q = 0`.
fn constraint(text: &mut String, body: &NumberedBody, row: usize, scalar: usize) -> fmt::Result {
    let matrix = &body.motion.motion;
    let own = (body.first + row / 6, row % 6 + 1, -1.0);
    let coordinates =
        (0..matrix.columns()).map(|column| (scalar + column, 0, matrix.at(row, column)));
    let terms = std::iter::once(own).chain(coordinates.filter(|(.., factor)| *factor != 0.0));
    // a card has two terms a line of eight fields, and a line of large fields has four of them
    for (index, (point, freedom, factor)) in terms.enumerate() {
        let factor = field(factor);
        match index {
            0 => write!(text, "{:<8}{CONSTRAINTS:>16}", "MPC*")?,
            _ if index % 2 == 0 => write!(text, "{:<8}{:>16}", "*", "")?,
            _ => write!(text, "{:<8}", "*")?,
        }
        writeln!(text, "{point:>16}{freedom:>16}{factor:>16}")?;
    }
    Ok(())
}
