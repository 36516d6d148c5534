//! Static modes: attachment modes (a unit load each) and constraint modes (a unit displacement each).

use super::interface::Interface;
use super::{Load, Structure, applied};
use crate::error::FlexibleError;
use crate::solve::{Analysis, Definiteness, Factorization};
use crate::sparse::SymmetricMatrix;
use std::sync::Arc;

/// Solves `K u = f` for several loads, one after the other in `vectors`, which become the displacements. Freedoms in `held` stay
/// at zero.
fn solve(
    stiffness: &SymmetricMatrix,
    held: &[bool],
    vectors: &mut [f64],
) -> Result<(), FlexibleError> {
    let size = stiffness.size();
    let matrix = stiffness.without(held)?;
    let kept: Vec<usize> = (0..size).filter(|i| !held[*i]).collect();
    let analysis = Arc::new(Analysis::fill_reducing(&matrix)?);
    let factor =
        Factorization::new(&analysis, &matrix, Definiteness::Positive).map_err(|error| {
            match error {
                // the row's number among all freedoms
                FlexibleError::Singular { row, advice, .. } => FlexibleError::Singular {
                    row: kept.get(row).copied().unwrap_or(row),
                    problem: "a load on the structure meets no resistance: it is a mechanism, or not held".into(),
                    advice,
                },
                other => other,
            }
        })?;
    let inner = kept.len();
    let mut loads = Vec::with_capacity(vectors.len() / size.max(1) * inner);
    for vector in vectors.chunks_exact(size) {
        loads.extend(kept.iter().map(|i| vector[*i]));
    }
    let mut found = vec![0.0; loads.len()];
    factor.solve_refined(&matrix, &loads, &mut found, 2)?;
    for (vector, found) in vectors
        .chunks_exact_mut(size)
        .zip(found.chunks_exact(inner))
    {
        vector.fill(0.0);
        for (i, x) in kept.iter().zip(found) {
            vector[*i] = *x;
        }
    }
    Ok(())
}

/// Attachment modes: the displacement under each unit load. A free structure's loads are balanced by the inertia of the rigid
/// motion they cause (inertia relief), and rigid motion is taken out of the displacements (mean axes).
///
/// # Errors
/// [`FlexibleError::Singular`] when the structure is a mechanism.
pub fn attachment_modes(structure: &Structure, loads: &[Load]) -> Result<Vec<f64>, FlexibleError> {
    let size = structure.size();
    let mut vectors = vec![0.0; size * loads.len()];
    for (vector, load) in vectors.chunks_exact_mut(size.max(1)).zip(loads) {
        load.add_to(vector)?;
    }
    let mut held = vec![false; size];
    if let Some(rigid) = &structure.rigid {
        rigid.balance(&mut vectors);
        for freedom in rigid.holding_freedoms() {
            held[freedom] = true;
        }
    }
    solve(structure.stiffness, &held, &mut vectors)?;
    if let Some(rigid) = &structure.rigid {
        rigid.remove(&mut vectors);
    }
    Ok(vectors)
}

/// Constraint modes: the displacement for a unit displacement of each row of `interface`, the others of them held and all else
/// unloaded (R. R. Craig, M. C. C. Bampton, AIAA Journal 6 (1968) 1313). Their span holds the rigid motions of a free body that the
/// interface holds; from those that it leaves (spin of collinear journals) the modes are free.
///
/// # Errors
/// [`FlexibleError::Singular`] when the structure is a mechanism, a row that follows from others.
pub fn constraint_modes(
    structure: &Structure,
    interface: &[Load],
) -> Result<Vec<f64>, FlexibleError> {
    let seen = Interface::new(structure, interface)?;
    match seen.plain() {
        Some(freedoms) => by_freedoms(structure, &freedoms),
        None => seen.constraint_modes(&attachment_modes(structure, interface)?),
    }
}

/// The same for freedoms that hold the structure.
fn by_freedoms(structure: &Structure, interface: &[u32]) -> Result<Vec<f64>, FlexibleError> {
    let size = structure.size();
    let mut held = vec![false; size];
    let mut units = vec![0.0; size * interface.len()];
    for (unit, freedom) in units.chunks_exact_mut(size.max(1)).zip(interface) {
        let freedom = *freedom as usize;
        if let (Some(held), Some(unit)) = (held.get_mut(freedom), unit.get_mut(freedom)) {
            *held = true;
            *unit = 1.0;
        }
    }
    // K_oo u_o = −K_ob u_b
    let mut vectors = applied(structure.stiffness, &units);
    vectors.iter_mut().for_each(|x| *x = -*x);
    solve(structure.stiffness, &held, &mut vectors)?;
    for (x, unit) in vectors.iter_mut().zip(&units) {
        *x += unit;
    }
    Ok(vectors)
}
