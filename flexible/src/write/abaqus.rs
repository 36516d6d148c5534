//! Input of Abaqus: a reduced body as matrices of nodes (`*MATRIX INPUT`), and its markers as nodes that follow them.
//!
//! Each node has six freedoms. The first node after the markers carries the six coordinates of the frame, the
//! next ones six amplitudes each. Linear equations join the freedoms of each marker to them (see
//! [`crate::small_motion`]).

use super::NumberedBody;
use crate::small_motion::Dense;
use std::fmt::{self, Write};

/// Node and freedom 1…6 of a coordinate. The nodes of the markers come first.
fn place(body: &NumberedBody, coordinate: usize) -> (usize, usize) {
    let first = body.first + body.markers.len();
    (first + coordinate / 6, coordinate % 6 + 1)
}

/// Entries `node, freedom, node, freedom, value` on and below the diagonal, with 17 digits.
pub fn abaqus_matrix(body: &NumberedBody, matrix: &Dense) -> String {
    let mut text = String::new();
    for row in 0..matrix.rows() {
        for column in 0..=row {
            let value = matrix.at(row, column);
            // a matrix of zeros still has an entry, because a file without one is damaged
            if value == 0.0 && row + 1 < matrix.rows() {
                continue;
            }
            if value == 0.0 && column < row {
                continue;
            }
            let ((node, freedom), (other, its)) = (place(body, row), place(body, column));
            // writing to a text cannot fail
            let _ = writeln!(text, "{node},{freedom},{other},{its},{value:.16e}");
        }
    }
    text
}

/// The lines that a deck includes: nodes, matrices by the names of their files, equations.
pub fn abaqus_deck(body: &NumberedBody, files: [&str; 3]) -> String {
    let mut text = String::new();
    // writing to a text cannot fail
    let _ = write_deck(&mut text, body, files);
    text
}

fn write_deck(text: &mut String, body: &NumberedBody, files: [&str; 3]) -> fmt::Result {
    let name = body.name;
    let size = body.motion.mass.rows();
    writeln!(
        text,
        "** {name}: reduced body of Eng, in SI units (N, m, kg, s, rad)"
    )?;
    writeln!(text, "** Loads of gravity do not act on its matrices.")?;
    writeln!(text, "*NODE")?;
    for (index, (marker, [x, y, z])) in body.markers.iter().enumerate() {
        writeln!(text, "** {marker}")?;
        writeln!(text, "{}, {x:.16e}, {y:.16e}, {z:.16e}", body.first + index)?;
    }
    let (frame, _) = place(body, 0);
    let (last, _) = place(body, size.saturating_sub(1));
    writeln!(
        text,
        "** node {frame}: translation and rotation of the frame; from node {}: amplitudes of the modes, six a node",
        frame + 1
    )?;
    for node in frame..=last {
        writeln!(text, "{node}, 0., 0., 0.")?;
    }
    if last > frame {
        writeln!(text, "*NSET, NSET={name}_MODAL_FREEDOMS, GENERATE")?;
        writeln!(text, "{}, {last}, 1", frame + 1)?;
    }
    for (kind, file) in ["STIFFNESS", "MASS", "DAMPING"].iter().zip(files) {
        writeln!(text, "*MATRIX INPUT, NAME={name}_{kind}, INPUT={file}")?;
    }
    writeln!(
        text,
        "*MATRIX ASSEMBLE, STIFFNESS={name}_STIFFNESS, MASS={name}_MASS, VISCOUS DAMPING={name}_DAMPING"
    )?;
    // freedoms of the last node that no amplitude uses
    let (_, used) = place(body, size.saturating_sub(1));
    if used < 6 {
        writeln!(text, "*BOUNDARY")?;
        writeln!(text, "{last}, {}, 6", used + 1)?;
    }
    for row in 0..body.motion.motion.rows() {
        equation(text, body, row)?;
    }
    Ok(())
}

/// `−u + Σ L q = 0` of one freedom of a marker, which Abaqus eliminates.
fn equation(text: &mut String, body: &NumberedBody, row: usize) -> fmt::Result {
    let matrix = &body.motion.motion;
    let factors = (0..matrix.columns()).map(|column| (place(body, column), matrix.at(row, column)));
    let own = ((body.first + row / 6, row % 6 + 1), -1.0);
    let terms = std::iter::once(own).chain(factors.filter(|(_, factor)| *factor != 0.0));
    let terms = terms.collect::<Vec<_>>();
    writeln!(text, "*EQUATION\n{}", terms.len())?;
    for line in terms.chunks(4) {
        let words = line
            .iter()
            .map(|((node, freedom), factor)| format!("{node}, {freedom}, {factor:.16e}"));
        writeln!(text, "{}", words.collect::<Vec<_>>().join(", "))?;
    }
    Ok(())
}
