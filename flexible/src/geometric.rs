//! Geometric stiffness in modes, load by load: see [`eng_system::reduced::Geometric`].
//!
//! Each reference load acts on the finite-element model at rest. The initial-stress matrix of its stresses is
//! projected on the modes. Inertial loads are those of the rigid body with the mesh's own mass: `−M E_j R_k`
//! for `ω_j ω_k`, `−M R_r` for `ω̇`, `−M R_t` for `Aᵀ(r̈ − g)`. In a supported body they go to the supports.
//! In a free body the inertia of the rigid motion that a load causes balances it. The sum of all loads needs
//! no balance, so this loses nothing. The loads of `ω̇` and of `r̈` balance themselves, so their blocks
//! vanish.

use crate::error::FlexibleError;
use crate::fe::geometric::GeometricStiffness;
use crate::fe::{self, Reduction, Rules};
use crate::invariants::turned;
use crate::mesh::Mesh;
use crate::modes::statics::attachment_modes;
use crate::modes::{Load, Structure, applied, products};
use crate::sparse::SymmetricOperator;
use eng_system::reduced::{Block, Geometric, MarkerStiffness};

/// Pairs of axes of [`Geometric::spin`].
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// Most reference loads whose matrices a thread holds at once. A choice that bounds the memory.
const MOST_CASES: usize = 8;

/// The model that gives the stresses.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a> {
    /// The mesh (SI), with ties.
    pub mesh: &'a Mesh,
    /// Its matrices.
    pub full: &'a fe::Assembled,
    /// Integration rules.
    pub rules: &'a Rules,
    /// Reduction from full freedoms to free ones.
    pub reduction: &'a Reduction,
    /// Stiffness and mass over the free ones.
    pub structure: &'a Structure<'a>,
    /// The six rigid motions over full freedoms.
    pub motions: &'a [f64],
}

/// The blocks for shapes (over full freedoms, one after the other) and for unit loads at freedoms of markers
/// (index of the marker, component, full freedom).
///
/// # Errors
/// Those of static modes; a mesh without elements that have stresses.
pub fn geometric(
    model: &Model,
    shapes: &[f64],
    markers: &[(usize, u8, usize)],
) -> Result<Geometric, FlexibleError> {
    let freedoms = &model.full.freedoms;
    let size = freedoms.size();
    let modes = shapes.len().checked_div(size).unwrap_or(0);
    let motion = |k: usize| model.motions.get(k * size..(k + 1) * size).unwrap_or(&[]);
    let mut out = Geometric::zero(modes);

    let inertial = |field: &[f64]| -> Vec<f64> {
        let mut load = applied(&model.full.mass, field);
        load.iter_mut().for_each(|x| *x = -*x);
        load
    };
    let mut loads = Vec::new();
    for (j, k) in PAIRS {
        let mut field = turned(freedoms, j, motion(3 + k));
        if j != k {
            let other = turned(freedoms, k, motion(3 + j));
            field.iter_mut().zip(other).for_each(|(x, y)| *x += y);
        }
        loads.extend(inertial(&field));
    }
    let supported = model.structure.rigid.is_none();
    if supported {
        for k in [3, 4, 5, 0, 1, 2] {
            loads.extend(inertial(motion(k)));
        }
    }
    for (_, _, freedom) in markers {
        let first = loads.len();
        loads.resize(first + size, 0.0);
        if let Some(x) = loads.get_mut(first + freedom) {
            *x = 1.0;
        }
    }
    let count = loads.len().checked_div(size).unwrap_or(0);
    let free = model.reduction.gather(count, &loads);
    drop(loads);
    let loads: Vec<Load> = free
        .chunks_exact(model.reduction.size().max(1))
        .map(|load| Load {
            label: "reference load".into(),
            entries: (0..).zip(load.iter().copied()).collect(),
        })
        .collect();
    let vectors = attachment_modes(model.structure, &loads)?;
    drop(loads);
    let mut blocks = reduced(model, &vectors, shapes, modes)?.into_iter();
    let mut next = || blocks.next().unwrap_or_else(|| vec![0.0; modes * modes]);
    for block in &mut out.spin {
        *block = next();
    }
    if supported {
        for block in out.turn.iter_mut().chain(&mut out.acceleration) {
            *block = next();
        }
    }
    for (marker, component, _) in markers {
        out.loads.push(MarkerStiffness {
            marker: *marker,
            component: *component,
            stiffness: next(),
        });
    }
    Ok(out)
}

/// The blocks of displacements over free freedoms, one after the other. Threads share the cases, and one
/// thread computes a case alone, so the bits do not depend on their number.
fn reduced(
    model: &Model,
    vectors: &[f64],
    shapes: &[f64],
    modes: usize,
) -> Result<Vec<Block>, FlexibleError> {
    let size = model.reduction.size().max(1);
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let share = (vectors.len() / size)
        .div_ceil(threads)
        .clamp(1, MOST_CASES);
    let run = |vectors: &[f64]| -> Result<Vec<Block>, FlexibleError> {
        let full = model.reduction.expand(vectors.len() / size, vectors);
        let freedoms = &model.full.freedoms;
        let matrices =
            GeometricStiffness::of_displacements(model.mesh, freedoms, model.rules, &full)?;
        Ok(matrices
            .iter()
            .map(|matrix| in_modes(matrix, shapes, modes))
            .collect())
    };
    let run = &run;
    let parts: Vec<&[f64]> = vectors.chunks(share * size).collect();
    let mut blocks = Vec::new();
    // a system without threads has one
    if threads < 2 {
        for part in parts {
            blocks.extend(run(part)?);
        }
        return Ok(blocks);
    }
    for parts in parts.chunks(threads) {
        let found = std::thread::scope(|scope| {
            let mut running = Vec::with_capacity(parts.len());
            for &part in parts {
                running.push(scope.spawn(move || run(part)));
            }
            running
                .into_iter()
                .map(|thread| match thread.join() {
                    Ok(found) => found,
                    Err(panic) => std::panic::resume_unwind(panic),
                })
                .collect::<Result<Vec<_>, _>>()
        })?;
        blocks.extend(found.into_iter().flatten());
    }
    Ok(blocks)
}

/// Φᵀ K_σ Φ, exactly symmetric.
fn in_modes(matrix: &dyn SymmetricOperator, shapes: &[f64], modes: usize) -> Block {
    let product = products(matrix.size(), shapes, &applied(matrix, shapes));
    let at = |i: usize, j: usize| product.get(j * modes + i).copied().unwrap_or(0.0);
    (0..modes)
        .flat_map(|i| (0..modes).map(move |j| (i, j)))
        .map(|(i, j)| 0.5 * (at(i, j) + at(j, i)))
        .collect()
}
