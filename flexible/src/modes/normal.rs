//! Normal modes: free or supported as the structure is, or with freedoms held.

use super::{Structure, applied};
use crate::error::FlexibleError;
use crate::solve::{EigenOptions, Modes, SturmCount, lowest_modes};

/// What is held besides the structure's own supports.
#[derive(Clone, Debug, PartialEq, Default)]
pub enum Boundary {
    /// Nothing: free modes of a free body, supported ones of a supported body.
    #[default]
    AsIs,
    /// These freedoms: fixed-interface modes.
    Fixed(Vec<u32>),
}

/// Normal modes without rigid ones.
#[derive(Clone, Debug)]
pub struct NormalModes {
    /// Eigenvalues (2π f)² (rad²/s²), ascending.
    pub eigenvalues: Vec<f64>,
    /// Vectors one after the other, `xᵀMx = 1`.
    pub vectors: Vec<f64>,
    /// The proof that none is missing, rigid ones counted.
    pub sturm: SturmCount,
}

/// Finds the lowest normal modes. `request` counts elastic modes only.
///
/// # Errors
/// As [`lowest_modes`].
pub fn normal_modes(
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
            let found = lowest_modes(
                structure.stiffness,
                structure.mass,
                request,
                &EigenOptions::default(),
            )?;
            let first = rigid.min(found.eigenvalues.len());
            let mut vectors = found.vectors[first * size..].to_vec();
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
        Boundary::Fixed(freedoms) => {
            let mut held = vec![false; size];
            for freedom in freedoms {
                match held.get_mut(*freedom as usize) {
                    Some(held) => *held = true,
                    None => {
                        return Err(FlexibleError::Matrix {
                            problem: format!("interface freedom {freedom} of {size}"),
                            advice: String::new(),
                        });
                    }
                }
            }
            let stiffness = structure.stiffness.without(&held)?;
            let mass = structure.mass.without(&held)?;
            let found = lowest_modes(&stiffness, &mass, request, &EigenOptions::default())?;
            let inner = stiffness.size();
            let mut vectors = Vec::with_capacity(found.eigenvalues.len() * size);
            for vector in found.vectors.chunks_exact(inner.max(1)) {
                let mut own = vector.iter();
                vectors.extend(held.iter().map(|held| {
                    if *held {
                        0.0
                    } else {
                        own.next().copied().unwrap_or(0.0)
                    }
                }));
            }
            Ok(NormalModes {
                eigenvalues: found.eigenvalues,
                vectors,
                sturm: found.sturm,
            })
        }
    }
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
