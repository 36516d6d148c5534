//! Normal modes of a free or supported structure, also with further freedoms held.

use super::interface::{Interface, independent};
use super::{Load, Structure, applied};
use crate::error::FlexibleError;
use crate::solve::factor::diagonal;
use crate::solve::{EigenOptions, Modes, Shifted, SturmCount, lowest_modes, lowest_modes_from};

/// Part of the typical ratio of the diagonals of stiffness and mass, below which an elastic mode's eigenvalue
/// is rounding. A choice: about the digits that a stiffness has after the rounding of its sums
/// ([`crate::solve::factor`]).
const LOOSE: f64 = 1e-12;

/// The directions held in addition to the structure's own supports.
#[derive(Clone, Debug, PartialEq, Default)]
pub enum Boundary {
    /// None: free modes of a free body, supported modes of a supported body.
    #[default]
    AsIs,
    /// The displacements of these loads: fixed-interface modes. A single freedom is removed from the
    /// matrices. A multiplier holds a combination of freedoms.
    Fixed(Vec<Load>),
}

/// Elastic normal modes.
#[derive(Clone, Debug)]
pub struct NormalModes {
    /// Eigenvalues (2π f)² (rad²/s²), ascending.
    pub eigenvalues: Vec<f64>,
    /// Vectors one after the other, `xᵀMx = 1`.
    pub vectors: Vec<f64>,
    /// The proof that none is missing. It counts rigid modes too.
    pub sturm: SturmCount,
}

/// Computes the lowest normal modes. `request` counts elastic modes only. `start` is an existing factor of the
/// structure, which saves a factorisation.
///
/// # Errors
/// Those of [`lowest_modes`].
pub fn normal_modes(
    start: Option<Shifted>,
    structure: &Structure,
    request: Modes,
    boundary: &Boundary,
) -> Result<NormalModes, FlexibleError> {
    let size = structure.size();
    match boundary {
        Boundary::AsIs => {
            let rigid = structure.rigid.as_ref().map_or(0, |rigid| rigid.count());
            let request = match request {
                Modes::Count(count) => Modes::Count(count + rigid),
                other => other,
            };
            let options = EigenOptions {
                analysis: Some(structure.analysis()?),
                ..EigenOptions::default()
            };
            let (stiffness, mass) = (structure.stiffness, structure.mass);
            let found = lowest_modes_from(start, stiffness, mass, request, &options)?;
            let first = rigid.min(found.eigenvalues.len());
            loose(
                structure,
                &found.eigenvalues[first..],
                &found.vectors[first * size..],
            )?;
            let mut vectors = found.vectors;
            vectors.drain(..first * size);
            if let Some(rigid) = &structure.rigid {
                rigid.remove(&mut vectors);
                normalise(structure, &mut vectors);
            }
            Ok(NormalModes {
                eigenvalues: found.eigenvalues[first..].to_vec(),
                vectors,
                sturm: found.sturm,
            })
        }
        Boundary::Fixed(rows) => {
            drop(start);
            fixed(structure, request, rows)
        }
    }
}

/// Modes with an interface held. Rigid motions that it leaves free (axial motion and spin of collinear
/// journals) do not count.
fn fixed(
    structure: &Structure,
    request: Modes,
    rows: &[Load],
) -> Result<NormalModes, FlexibleError> {
    let size = structure.size();
    let left = Interface::new(structure, rows)?.left();
    let mut held = vec![false; size];
    for freedom in rows.iter().filter_map(Load::plain) {
        // in range: the interface was checked above
        if let Some(held) = held.get_mut(freedom as usize) {
            *held = true;
        }
    }
    let stiffness = structure.stiffness.without(&held)?;
    let mass = structure.mass.without(&held)?;
    let mut place = vec![None; size];
    let kept = (0..size).filter(|freedom| !held[*freedom]);
    for (index, freedom) in kept.enumerate() {
        place[freedom] = Some(index as u32);
    }
    let (numbers, combinations): (Vec<usize>, Vec<Load>) = rows
        .iter()
        .enumerate()
        .filter(|(_, row)| row.plain().is_none())
        .map(|(number, row)| {
            let entries = row.entries.iter();
            let entries = entries.filter_map(|(freedom, factor)| {
                let place = place.get(*freedom as usize).copied().flatten();
                place.map(|place| (place, *factor))
            });
            let label = row.label.clone();
            let entries = entries.collect();
            (number, Load { label, entries })
        })
        .filter(|(_, row)| !row.entries.is_empty())
        .unzip();
    independent(stiffness.size(), &combinations).map_err(|mut error| {
        if let FlexibleError::Row { row, .. } = &mut error {
            *row = numbers.get(*row).copied().unwrap_or(*row);
        }
        error
    })?;
    let options = EigenOptions {
        held: combinations.into_iter().map(|row| row.entries).collect(),
        ..EigenOptions::default()
    };
    let request = match request {
        Modes::Count(count) => Modes::Count(count + left),
        other => other,
    };
    let found =
        lowest_modes(&stiffness, &mass, request, &options).map_err(|error| match error {
            // converts the row's number to one among all freedoms
            FlexibleError::Singular {
                row,
                problem,
                advice,
            } => FlexibleError::Singular {
                row: place
                    .iter()
                    .position(|own| *own == Some(row as u32))
                    .unwrap_or(row),
                problem,
                advice,
            },
            other => other,
        })?;
    let inner = stiffness.size();
    let first = left.min(found.eigenvalues.len());
    let mut vectors = Vec::with_capacity((found.eigenvalues.len() - first) * size);
    for vector in found.vectors.chunks_exact(inner.max(1)).skip(first) {
        let own = place.iter().map(|place| match place {
            Some(index) => vector.get(*index as usize).copied().unwrap_or(0.0),
            None => 0.0,
        });
        vectors.extend(own);
    }
    Ok(NormalModes {
        eigenvalues: found.eigenvalues.get(first..).unwrap_or(&[]).to_vec(),
        vectors,
        sturm: found.sturm,
    })
}

/// Refuses elastic modes without stiffness: a mechanism.
fn loose(structure: &Structure, eigenvalues: &[f64], vectors: &[f64]) -> Result<(), FlexibleError> {
    let mut ratios: Vec<f64> = diagonal(structure.stiffness)
        .iter()
        .zip(diagonal(structure.mass))
        .map(|(stiffness, mass)| stiffness / mass)
        .filter(|ratio| ratio.is_finite() && *ratio > 0.0)
        .collect();
    ratios.sort_unstable_by(f64::total_cmp);
    let typical = ratios.get(ratios.len() / 2).copied().unwrap_or(0.0);
    let count = eigenvalues.iter().filter(|x| **x < LOOSE * typical).count();
    if count == 0 {
        return Ok(());
    }
    let row = vectors
        .iter()
        .take(structure.size())
        .enumerate()
        .fold((0, 0.0f64), |most, (row, x)| {
            if x.abs() > most.1 {
                (row, x.abs())
            } else {
                most
            }
        })
        .0;
    Err(FlexibleError::Singular {
        row,
        problem: format!(
            "{} has {count} motion{} without stiffness: {}",
            match structure.rigid {
                Some(_) => "besides its rigid motions, the structure",
                None => "the held structure",
            },
            if count == 1 { "" } else { "s" },
            match structure.rigid {
                Some(_) => "it is a mechanism",
                None => "its supports leave rigid motions, or it is a mechanism",
            }
        ),
        advice: match structure.rigid {
            Some(_) => "join its parts by whole faces or by ties; they may touch only in a node or an edge",
            None => "hold all six motions of the body, or none and let joints of the model hold it; else join its parts by whole faces or by ties, because they may touch only in a node or an edge",
        }
        .into(),
    })
}

fn normalise(structure: &Structure, vectors: &mut [f64]) {
    let size = structure.size();
    let inertial = applied(structure.mass, vectors);
    for (vector, inertial) in vectors
        .chunks_exact_mut(size.max(1))
        .zip(inertial.chunks_exact(size.max(1)))
    {
        let square: f64 = vector.iter().zip(inertial).map(|(x, y)| x * y).sum();
        let scale = 1.0 / libm::sqrt(square);
        vector.iter_mut().for_each(|x| *x *= scale);
    }
}
