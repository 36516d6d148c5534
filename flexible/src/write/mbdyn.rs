//! The data of MBDyn's `modal` joint: its text of record groups.
//!
//! The nodes of the file are the markers, by their names. The joint needs constants of the floating frame. The manual
//! of MBDyn names them invariants, and its joint sums them over masses m at places u with the shapes φ_j (a~ is the
//! matrix of the cross product with a):
//!
//! ```text
//! I3_j = Σ m φ_j    I4_j = Σ m u × φ_j    I5_jk = Σ m φ_j × φ_k    I8_j = −Σ m u~ φ_j~    I9_jk = Σ m φ_j~ φ_k~
//! ```
//!
//! Eng has the same sums over the mass matrix of the mesh. I3 and I4 are [`Invariants::translation`] and
//! [`Invariants::rotation`]. Column c of I8_j is `rotation_by_shape[c]`, component c of I5_jk is `coriolis[c]` in row k
//! and column j. Entry cd of I9_jk is `−centrifugal[cd]` of its rows j and k, plus the same entry of `½ (I5_jk)~`:
//! `centrifugal` has the part that is symmetric in j and k.

use super::number::fortran;
use crate::small_motion::{Dense, RIGID, SmallMotion};
use eng_system::reduced::{Block, Invariants};
use std::fmt::{Result, Write};

/// The text of a body with the names and places (m) of its markers. Names have no spaces. Units are SI, axes those of
/// the body.
pub fn modal_data(
    name: &str,
    markers: &[(String, [f64; 3])],
    constants: &Invariants,
    motion: &SmallMotion,
) -> String {
    let mut text = String::new();
    // writing to a text cannot fail
    let _ = heads(&mut text, name, markers, constants);
    let _ = shapes(&mut text, markers.len(), constants.modes, &motion.motion);
    let _ = matrices(&mut text, constants);
    let _ = inertia(&mut text, constants);
    let _ = invariants(&mut text, constants);
    text.push_str("** END OF FILE\n");
    text
}

/// A line of numbers.
fn line(text: &mut String, values: impl IntoIterator<Item = f64>) -> Result {
    for value in values {
        write!(text, " {}", fortran(value, 16, 'E'))?;
    }
    writeln!(text)
}

/// The head of a record group, which MBDyn knows by its number.
fn group(text: &mut String, number: usize, subject: &str) -> Result {
    writeln!(text, "** RECORD GROUP {number}, {subject}")
}

/// An entry of a block with n columns; zero outside of it.
fn at(block: &Block, n: usize, row: usize, column: usize) -> f64 {
    block.get(row * n + column).copied().unwrap_or(0.0)
}

fn heads(
    text: &mut String,
    name: &str,
    markers: &[(String, [f64; 3])],
    constants: &Invariants,
) -> Result {
    writeln!(text, "** MBDyn MODAL DATA FILE of {name}")?;
    group(text, 1, "HEADER")?;
    writeln!(
        text,
        "** revision, nodes, modes of the four kinds, rejected modes"
    )?;
    writeln!(text, "REV0 {} {} 0 0 0", markers.len(), constants.modes)?;
    group(text, 2, "NODES: the markers")?;
    for (marker, _) in markers {
        writeln!(text, "{marker}")?;
    }
    for (axis, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
        group(text, 5 + axis, &format!("{letter} OF THE NODES (m)"))?;
        let places = markers.iter();
        line(
            text,
            places.map(|(_, place)| place.get(axis).copied().unwrap_or(0.0)),
        )?;
    }
    Ok(())
}

/// Translations and rotations of the markers, mode by mode. `motion` has the coordinates of the frame first.
fn shapes(text: &mut String, markers: usize, modes: usize, motion: &Dense) -> Result {
    group(text, 8, "SHAPES: translations and rotations of the nodes")?;
    for mode in 0..modes {
        writeln!(text, "** mode {}", mode + 1)?;
        for marker in 0..markers {
            let rows = 6 * marker..6 * marker + 6;
            line(text, rows.map(|row| motion.at(row, RIGID + mode)))?;
        }
    }
    Ok(())
}

fn matrices(text: &mut String, constants: &Invariants) -> Result {
    let n = constants.modes;
    for (number, subject, matrix) in [
        (9, "MODAL MASS", &constants.modal_mass),
        (10, "MODAL STIFFNESS", &constants.stiffness),
        (13, "MODAL DAMPING", &constants.damping),
    ] {
        group(text, number, subject)?;
        for row in 0..n {
            line(text, (0..n).map(|column| at(matrix, n, row, column)))?;
        }
    }
    Ok(())
}

/// Mass, centre of mass, and the inertia about it.
fn inertia(text: &mut String, constants: &Invariants) -> Result {
    group(text, 12, "MASS, CENTRE, INERTIA ABOUT THE CENTRE")?;
    line(text, [constants.mass])?;
    let centre = constants.first_moment.map(|moment| moment / constants.mass);
    line(text, centre)?;
    let squared: f64 = centre.iter().map(|x| x * x).sum();
    for (i, (row, x)) in constants.inertia.iter().zip(centre).enumerate() {
        let moved = row.iter().zip(centre).enumerate().map(|(k, (value, y))| {
            let diagonal = if i == k { squared } else { 0.0 };
            value - constants.mass * (diagonal - x * y)
        });
        line(text, moved)?;
    }
    Ok(())
}

fn invariants(text: &mut String, constants: &Invariants) -> Result {
    let n = constants.modes;
    let of_axis = |blocks: &[Block; 3], axis: usize, row: usize, column: usize| {
        let block = blocks.get(axis);
        block.map_or(0.0, |block| at(block, n, row, column))
    };
    // component c of I5_jk
    let turned = |c: usize, j: usize, k: usize| of_axis(&constants.coriolis, c, k, j);
    for (number, block) in [(14, &constants.translation), (15, &constants.rotation)] {
        group(text, number, &format!("INVARIANT {}", number - 11))?;
        for row in 0..3 {
            line(text, (0..n).map(|mode| at(block, n, row, mode)))?;
        }
    }
    group(text, 16, "INVARIANT 8")?;
    for row in 0..3 {
        let columns = (0..n).flat_map(|mode| [0, 1, 2].map(|c| (mode, c)));
        line(
            text,
            columns.map(|(mode, c)| of_axis(&constants.rotation_by_shape, c, row, mode)),
        )?;
    }
    group(text, 17, "INVARIANT 5")?;
    for c in 0..3 {
        let pairs = (0..n).flat_map(|j| (0..n).map(move |k| (j, k)));
        line(text, pairs.map(|(j, k)| turned(c, j, k)))?;
    }
    group(text, 18, "INVARIANT 9")?;
    for (row, pairs) in PAIRS.iter().enumerate() {
        let entries = (0..n).flat_map(|j| (0..n).flat_map(move |k| [0, 1, 2].map(|c| (j, k, c))));
        line(
            text,
            entries.map(|(j, k, c)| {
                let both = pairs
                    .get(c)
                    .and_then(|pair| constants.centrifugal.get(*pair));
                let symmetric = both.map_or(0.0, |block| at(block, n, j, k));
                // row and column c of v~: −v of the third axis for xy, yz, zx, +v for yx, zy, xz
                let skew = match (3 + c - row) % 3 {
                    0 => 0.0,
                    1 => -turned((row + 2) % 3, j, k),
                    _ => turned((row + 1) % 3, j, k),
                };
                0.5 * skew - symmetric
            }),
        )?;
    }
    Ok(())
}

/// The block of [`Invariants::centrifugal`] for two axes.
const PAIRS: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];
