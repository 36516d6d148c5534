//! Static modes: attachment modes (each for a unit load) and constraint modes (each for a unit displacement).

use super::interface::Interface;
use super::{Load, Structure, applied};
use crate::error::FlexibleError;
use crate::solve::lanczos::dot;
use crate::solve::{Analysis, Definiteness, Factorization, Shifted};
use crate::sparse::SymmetricMatrix;
use std::sync::Arc;

/// Most steps of [`corrected`]. A choice: a step wins several digits, or the matrix is too bad for any number
/// of steps.
const MOST_STEPS: usize = 7;
/// Energy of the remaining error, as a share of that of the first step, below which one more step is the
/// last. Its root is nine digits of the displacement, and one step wins the rest.
const ENOUGH: f64 = 1e-18;

/// Solves `K u = f` for several loads, one after the other in `vectors`, which become the displacements.
/// Freedoms in `held` stay at zero.
pub(crate) fn solve(
    stiffness: &SymmetricMatrix,
    held: &[bool],
    vectors: &mut [f64],
) -> Result<(), FlexibleError> {
    let size = stiffness.size();
    let kept: Vec<usize> = (0..size).filter(|i| !held[*i]).collect();
    if kept.is_empty() {
        // nothing can move, and there is no matrix to factor
        vectors.fill(0.0);
        return Ok(());
    }
    let matrix = stiffness.without(held)?;
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
    let mut loads = Vec::with_capacity(vectors.len() / size * inner);
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

/// Attachment modes: the displacement under each unit load. In a free structure the inertia of the rigid
/// motion that the load causes balances it (inertia relief). Rigid motion is removed from the displacements
/// (mean axes).
///
/// # Errors
/// [`FlexibleError::Singular`] when the structure is a mechanism.
pub fn attachment_modes(structure: &Structure, loads: &[Load]) -> Result<Vec<f64>, FlexibleError> {
    attachment_modes_by(&mut None, structure, loads)
}

/// Like [`attachment_modes`], with a factor of `K − σ M` if it is near enough to K. If not, it drops this
/// factor and its memory.
///
/// # Errors
/// Those of [`attachment_modes`].
pub fn attachment_modes_by(
    near: &mut Option<Shifted>,
    structure: &Structure,
    loads: &[Load],
) -> Result<Vec<f64>, FlexibleError> {
    let size = structure.size();
    let mut vectors = vec![0.0; size * loads.len()];
    for (vector, load) in vectors.chunks_exact_mut(size.max(1)).zip(loads) {
        load.add_to(vector)?;
    }
    if let Some(rigid) = &structure.rigid {
        rigid.balance(&mut vectors);
    }
    let solved = match near {
        Some(near) => corrected(structure, near, &vectors)?,
        None => None,
    };
    match solved {
        Some(solved) => vectors = solved,
        None => {
            *near = None;
            let mut held = vec![false; size];
            if let Some(rigid) = &structure.rigid {
                for freedom in rigid.holding_freedoms() {
                    held[freedom] = true;
                }
            }
            solve(structure.stiffness, &held, &mut vectors)?;
        }
    }
    if let Some(rigid) = &structure.rigid {
        rigid.remove(&mut vectors);
    }
    Ok(vectors)
}

/// Solves `K u = f` for several loads with a factor of `A = K − σ M`. It uses conjugate gradients
/// preconditioned by A, separately for each load. The eigenvalues of `A⁻¹K` over elastic motions are λ/(λ +
/// |σ|), so a step reduces the error by about the factor 4 λ₁/|σ|. With the remainder r of a load, `rᵀA⁻¹r`
/// is about the energy of the error. Once it is below 1e-18 of the first one, a last step by A alone removes
/// all of it except the part |σ|/λ₁. `None` if the steps do not suffice: σ is not small enough, or a load
/// meets no resistance.
fn corrected(
    structure: &Structure,
    near: &Shifted,
    loads: &[f64],
) -> Result<Option<Vec<f64>>, FlexibleError> {
    let size = structure.size().max(1);
    let columns = |x: &[f64], y: &[f64]| -> Vec<f64> {
        x.chunks_exact(size)
            .zip(y.chunks_exact(size))
            .map(|(x, y)| dot(x, y))
            .collect()
    };
    let mut rest = loads.to_vec();
    let mut found = vec![0.0; loads.len()];
    let mut step = rest.clone();
    near.factor.solve_in_place(&mut step)?;
    let first = columns(&rest, &step);
    let mut missing = first.clone();
    for _ in 0..MOST_STEPS {
        let forces = applied(structure.stiffness, &step);
        let resisted = columns(&step, &forces);
        for (index, (missing, resisted)) in missing.iter().zip(&resisted).enumerate() {
            // the solution of an empty load is exactly zero
            let length = if *missing > 0.0 {
                missing / resisted
            } else {
                0.0
            };
            let own = index * size..(index + 1) * size;
            add(&mut found[own.clone()], length, &step[own.clone()]);
            add(&mut rest[own.clone()], -length, &forces[own]);
        }
        drop(forces);
        if let Some(rigid) = &structure.rigid {
            rigid.balance(&mut rest);
        }
        let mut next = rest.clone();
        near.factor.solve_in_place(&mut next)?;
        let left = columns(&rest, &next);
        if left
            .iter()
            .zip(&first)
            .all(|(left, first)| *left <= ENOUGH * first)
        {
            add(&mut found, 1.0, &next);
            return Ok(Some(found));
        }
        for (index, (left, missing)) in left.iter().zip(&missing).enumerate() {
            let share = if *missing > 0.0 { left / missing } else { 0.0 };
            let own = index * size..(index + 1) * size;
            add(&mut next[own.clone()], share, &step[own]);
        }
        (step, missing) = (next, left);
    }
    Ok(None)
}

/// `y += factor · x`.
fn add(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

/// Constraint modes: the displacement for a unit displacement of each row of `interface`, with the other rows
/// held and all other freedoms unloaded (R. R. Craig, M. C. C. Bampton, AIAA Journal 6 (1968) 1313). Their
/// span contains the rigid motions of a free body that the interface holds. They contain no part of the rigid
/// motions that it leaves free, such as the spin of collinear journals.
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

/// Constraint modes for an interface of freedoms that hold the structure.
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
