//! From shapes over all nodes to the constants of a floating frame: see [`eng_system::reduced::Invariants`].
//!
//! The shapes are those of all freedoms of the mesh, ties expanded, so that the mass is the mesh's own, exact for a consistent one.

use crate::fe::FreedomMap;
use crate::modes::{applied, products};
use crate::sparse::{SymmetricMatrix, SymmetricOperator};
use eng_system::reduced::Invariants;

/// Pairs of axes of the centrifugal blocks.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// A structure over the full freedoms of its mesh (SI, basic axes).
#[derive(Clone, Copy)]
pub struct Full<'a> {
    /// Numbering of the freedoms.
    pub freedoms: &'a FreedomMap,
    /// M.
    pub mass: &'a dyn SymmetricOperator,
    /// K.
    pub stiffness: &'a SymmetricMatrix,
    /// The six rigid motions about the frame's origin, one after the other: translations, then rotations.
    pub rigid: &'a [f64],
}

impl std::fmt::Debug for Full<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Full")
            .field("freedoms", &self.freedoms.size())
            .finish_non_exhaustive()
    }
}

/// `E_k x`: every node's displacement and rotation turned by a unit rotation about axis k, `e_k ×`.
pub fn turned(freedoms: &FreedomMap, axis: usize, x: &[f64]) -> Vec<f64> {
    let size = freedoms.size();
    let mut out = vec![0.0; x.len()];
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    for (x, out) in x
        .chunks_exact(size.max(1))
        .zip(out.chunks_exact_mut(size.max(1)))
    {
        for node in 0..freedoms.node_count() {
            for first in freedoms.of(node as u32).step_by(3) {
                out[first + next] = -x[first + last];
                out[first + last] = x[first + next];
            }
        }
    }
    out
}

/// The constants for shapes (one after the other over the full freedoms). Damping is zero: it is the body's, not the mesh's.
pub fn invariants(full: &Full, shapes: &[f64]) -> Invariants {
    let size = full.freedoms.size();
    let n = shapes.len().checked_div(size).unwrap_or(0);
    let mut out = Invariants::zero(n);
    // column-major products with `rows` rows to row-major blocks
    let block = |columns: &[f64], rows: usize, first: usize, count: usize| -> Vec<f64> {
        (first..first + count)
            .flat_map(|row| (0..n).map(move |column| (row, column)))
            .map(|(row, column)| columns[column * rows + row])
            .collect()
    };
    let inertial = applied(full.mass, full.rigid);
    let rigid = products(size, full.rigid, &inertial);
    let at = |row: usize, column: usize| rigid[column * 6 + row];
    out.mass = (at(0, 0) + at(1, 1) + at(2, 2)) / 3.0;
    out.first_moment = [
        0.5 * (at(1, 5) - at(2, 4)),
        0.5 * (at(2, 3) - at(0, 5)),
        0.5 * (at(0, 4) - at(1, 3)),
    ];
    for i in 0..3 {
        for j in 0..3 {
            out.inertia[i][j] = 0.5 * (at(3 + i, 3 + j) + at(3 + j, 3 + i));
        }
    }
    let momentum = products(size, &inertial, shapes);
    out.translation = block(&momentum, 6, 0, 3);
    out.rotation = block(&momentum, 6, 3, 3);
    let turned: [Vec<f64>; 3] = std::array::from_fn(|k| turned(full.freedoms, k, shapes));
    let turned_inertial: [Vec<f64>; 3] = std::array::from_fn(|k| applied(full.mass, &turned[k]));
    for (k, inertial) in turned_inertial.iter().enumerate() {
        let by_shape = products(size, full.rigid, inertial);
        out.rotation_by_shape[k] = block(&by_shape, 6, 3, 3);
        let coriolis = products(size, shapes, inertial);
        out.coriolis[k] = block(&coriolis, n, 0, n);
    }
    for (p, (j, k)) in PAIRS.into_iter().enumerate() {
        let both = products(size, &turned[j], &turned_inertial[k]);
        out.centrifugal[p] = symmetric(&block(&both, n, 0, n), n);
    }
    let mass = products(size, shapes, &applied(full.mass, shapes));
    out.modal_mass = symmetric(&block(&mass, n, 0, n), n);
    let stiffness = products(size, shapes, &applied(full.stiffness, shapes));
    out.stiffness = symmetric(&block(&stiffness, n, 0, n), n);
    out
}

fn symmetric(block: &[f64], n: usize) -> Vec<f64> {
    (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .map(|(i, j)| 0.5 * (block[i * n + j] + block[j * n + i]))
        .collect()
}
