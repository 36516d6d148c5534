//! Geometric stiffness in modes, load by load: see [`eng_system::reduced::Geometric`].
//!
//! Each reference load is put on the finite-element model at rest, and the initial-stress matrix of its stresses is taken into
//! the modes. Inertial loads are those of the rigid body, by the mesh's own mass: `−M E_j R_k` for `ω_j ω_k`, `−M R_r` for `ω̇`,
//! `−M R_t` for `Aᵀ(r̈ − g)`. A body on supports passes them to its supports. In a free body each load is balanced by the inertia
//! of the rigid motion that it causes; the sum of all loads needs no balance, so nothing is lost, and the loads of `ω̇` and of
//! `r̈` balance themselves: their blocks vanish.

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

/// The model whose stresses count.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a> {
    /// The mesh (SI), with ties.
    pub mesh: &'a Mesh,
    /// Its matrices.
    pub full: &'a fe::Structure,
    /// Integration rules.
    pub rules: &'a Rules,
    /// From full freedoms to free ones.
    pub reduction: &'a Reduction,
    /// Stiffness and mass over the free ones.
    pub structure: &'a Structure<'a>,
    /// The six rigid motions over full freedoms.
    pub motions: &'a [f64],
}

/// The blocks for shapes (over full freedoms, one after the other) and for unit loads at freedoms of markers: index of the
/// marker, component, full freedom.
///
/// # Errors
/// As static modes; a mesh without elements that have stresses.
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
    let mut blocks = vectors.chunks_exact(model.reduction.size().max(1)).map(
        |vector| -> Result<Block, FlexibleError> {
            let full = model.reduction.expand(1, vector);
            let matrix =
                GeometricStiffness::of_displacements(model.mesh, freedoms, model.rules, &full)?;
            Ok(in_modes(&matrix, shapes, modes))
        },
    );
    let mut next = || {
        blocks
            .next()
            .unwrap_or_else(|| Ok(vec![0.0; modes * modes]))
    };
    for block in &mut out.spin {
        *block = next()?;
    }
    if supported {
        for block in out.turn.iter_mut().chain(&mut out.acceleration) {
            *block = next()?;
        }
    }
    for (marker, component, _) in markers {
        out.loads.push(MarkerStiffness {
            marker: *marker,
            component: *component,
            stiffness: next()?,
        });
    }
    Ok(out)
}

/// Φᵀ K_σ Φ, symmetric to the bit.
fn in_modes(matrix: &dyn SymmetricOperator, shapes: &[f64], modes: usize) -> Block {
    let product = products(matrix.size(), shapes, &applied(matrix, shapes));
    let at = |i: usize, j: usize| product.get(j * modes + i).copied().unwrap_or(0.0);
    (0..modes)
        .flat_map(|i| (0..modes).map(move |j| (i, j)))
        .map(|(i, j)| 0.5 * (at(i, j) + at(j, i)))
        .collect()
}
