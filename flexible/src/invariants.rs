//! From shapes over all nodes to the constants of a floating frame: see [`eng_system::reduced::Invariants`].
//!
//! The shapes cover all freedoms of the mesh, with ties expanded. So the mass is the mesh's own, and the
//! constants are exact for a consistent mass.

use crate::fe::vector::{cross, dot, subtract};
use crate::fe::{FreedomMap, Mass};
use crate::modes::{applied, products};
use crate::sparse::SymmetricMatrix;
use eng_system::reduced::Invariants;
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// Pairs of axes of the centrifugal blocks.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// Triples of freedoms whose products are summed together. Their panels fit in the cache. A choice: larger
/// panels leave it, and smaller ones use the product of matrices badly. The number decides the order of the
/// sums, so it changes their last digits.
const TOGETHER: usize = 256;

/// A structure over the full freedoms of its mesh (SI, basic axes).
#[derive(Clone, Copy, Debug)]
pub struct Full<'a> {
    /// Numbering of the freedoms.
    pub freedoms: &'a FreedomMap,
    /// M.
    pub mass: &'a Mass,
    /// Whether a condensation made the mass, so that it does not act alike on x, y and z, and has scalar
    /// points: see [`invariants`].
    pub condensed: bool,
    /// The six rigid motions about the frame's origin, one after the other: translations, then rotations.
    pub rigid: &'a [f64],
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
        for node in 0..freedoms.all_nodes() {
            for first in turning(freedoms, node) {
                out[first + next] = -x[first + last];
                out[first + last] = x[first + next];
            }
        }
    }
    out
}

/// First freedoms of the translations and of the rotations of a node; none of a scalar point, which does not
/// turn.
fn turning(freedoms: &FreedomMap, node: usize) -> impl Iterator<Item = usize> + use<> {
    let range = freedoms.of(node as u32);
    let whole = if range.len() < 3 {
        range.start..range.start
    } else {
        range
    };
    whole.step_by(3)
}

/// `R_rᵀ M E_k φ = δ_rk tr N − N_kr` of a condensed mass, with `N = ∫ x φᵀ dm = ∫ (x − c) φᵀ dm + c ∫ φᵀ dm`.
/// The momentum `∫ φ dm` and the angular momentum, which is the antimetric part of the first term, are known.
/// Its symmetric part is not, and is zero here.
fn turn_condensed(n: usize, out: &mut Invariants) {
    let centre = out.first_moment.map(|moment| moment / out.mass);
    for mode in 0..n {
        let row = |block: &[f64]| [0, 1, 2].map(|axis: usize| block[axis * n + mode]);
        let momentum = row(&out.translation);
        let moment = subtract(row(&out.rotation), cross(centre, momentum));
        let trace = dot(centre, momentum);
        for (k, block) in out.rotation_by_shape.iter_mut().enumerate() {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            for r in 0..3 {
                block[r * n + mode] = -centre[k] * momentum[r];
            }
            block[k * n + mode] += trace;
            // ½ ε_krl of the angular momentum
            block[next * n + mode] -= 0.5 * moment[last];
            block[last * n + mode] += 0.5 * moment[next];
        }
    }
}

/// The constants for shapes (one after the other over the full freedoms) and their `ΦᵀKΦ` by rows. Damping is
/// zero here, because it is an attribute of the body and not of the mesh.
///
/// A mass that is equal in all directions commutes with `E_k`. So all blocks n × n follow from the nine
/// products `S_ij = (M Φ)_iᵀ Φ_j` of the shapes' components i, j. `ΦᵀME_kΦ = S_ji − S_ij` for i, j, k cyclic.
/// The centrifugal blocks follow from `(e_j × u)·(e_k × v) = (e_j·e_k)(u·v) − (e_k·u)(e_j·v)`. The remaining
/// mass, of beams and offset masses, is turned explicitly on its nodes.
///
/// A condensed mass does not commute with `E_k`, and scalar points have no direction to turn. Mass, first
/// moment, inertia, `R_tᵀ M Φ`, `R_rᵀ M Φ`, `Φᵀ M Φ` are exact all the same. Of `R_rᵀ M E_k Φ` only a part is
/// known (`turn_condensed`). The remaining blocks are those of the turning nodes, with scalar points that
/// do not turn (`docs/theory.md`).
pub fn invariants(full: &Full, shapes: &[f64], stiffness: &[f64]) -> Invariants {
    let size = full.freedoms.size();
    let n = shapes.len().checked_div(size).unwrap_or(0);
    let mut out = Invariants::zero(n);
    // converts column-major products with `rows` rows to row-major blocks
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
    match full.condensed {
        true => turn_condensed(n, &mut out),
        false => {
            for (k, out) in out.rotation_by_shape.iter_mut().enumerate() {
                // R_rᵀ M E_k Φ = −(E_k M R_r)ᵀ Φ
                let levers = turned(full.freedoms, k, &inertial[3 * size..]);
                let by_shape = products(size, &levers, shapes);
                *out = block(&by_shape, 3, 0, 3).into_iter().map(|x| -x).collect();
            }
        }
    }
    add_alike(full, shapes, n, &mut out);
    if let Some(general) = &full.mass.general {
        Directed::new(full.freedoms, general).add(shapes, n, &mut out);
    }
    out.modal_mass = symmetric(&out.modal_mass, n);
    for block in &mut out.centrifugal {
        *block = symmetric(block, n);
    }
    if stiffness.len() == n * n {
        out.stiffness = symmetric(stiffness, n);
    }
    out
}

/// `out += factor · x`.
fn add(out: &mut [f64], block: &[f64], factor: f64) {
    for (out, x) in out.iter_mut().zip(block) {
        *out += factor * x;
    }
}

/// Adds the contributions of the mass that is equal in all directions.
fn add_alike(full: &Full, shapes: &[f64], n: usize, out: &mut Invariants) {
    let size = full.freedoms.size();
    let mut inertial = vec![0.0; shapes.len()];
    full.mass.add_alike(n, shapes, &mut inertial);
    let products = component_products(full.freedoms, size, n, &inertial, shapes);
    let of = |i: usize, j: usize| products[3 * i + j].as_slice();
    for (k, coriolis) in out.coriolis.iter_mut().enumerate() {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        add(coriolis, of(last, next), 1.0);
        add(coriolis, of(next, last), -1.0);
    }
    for ((j, k), centrifugal) in PAIRS.into_iter().zip(&mut out.centrifugal) {
        if j == k {
            add(centrifugal, of((k + 1) % 3, (k + 1) % 3), 1.0);
            add(centrifugal, of((k + 2) % 3, (k + 2) % 3), 1.0);
        } else {
            add(centrifugal, of(k, j), -1.0);
        }
    }
    for i in 0..3 {
        add(&mut out.modal_mass, of(i, i), 1.0);
    }
}

/// `X_iᵀ Y_j` (n × n by rows) of the components i, j = x, y, z of translations, at 3 i + j.
fn component_products(
    freedoms: &FreedomMap,
    size: usize,
    n: usize,
    x: &[f64],
    y: &[f64],
) -> [Vec<f64>; 9] {
    let mut out: [Vec<f64>; 9] = std::array::from_fn(|_| vec![0.0; n * n]);
    let firsts: Vec<usize> = (0..freedoms.all_nodes())
        .map(|node| freedoms.of(node as u32))
        .filter(|range| range.len() >= 3)
        .map(|range| range.start)
        .collect();
    let mut panels: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; TOGETHER * n]);
    for firsts in firsts.chunks(TOGETHER) {
        let rows = firsts.len();
        let (left, right) = panels.split_at_mut(3);
        for (panels, vectors) in [(left, x), (right, y)] {
            for (column, vector) in vectors.chunks_exact(size.max(1)).enumerate() {
                let [a, b, c] = panels else { continue };
                let range = column * rows..(column + 1) * rows;
                let places = a[range.clone()]
                    .iter_mut()
                    .zip(&mut b[range.clone()])
                    .zip(&mut c[range]);
                for (((a, b), c), first) in places.zip(firsts) {
                    if let Some([x, y, z]) = vector.get(*first..first + 3) {
                        (*a, *b, *c) = (*x, *y, *z);
                    }
                }
            }
        }
        let view =
            |panel: usize| MatRef::from_column_major_slice(&panels[panel][..rows * n], rows, n);
        for (place, out) in out.iter_mut().enumerate() {
            matmul(
                MatMut::from_row_major_slice_mut(out, n, n),
                Accum::Add,
                view(place / 3).transpose(),
                view(3 + place % 3),
                1.0,
                Par::Seq,
            );
        }
    }
    out
}

/// The mass that differs with the direction, on its nodes, and that of scalar points.
struct Directed<'a> {
    matrix: &'a SymmetricMatrix,
    /// First freedoms of the triples (translations or rotations of a node) that it touches.
    triples: Vec<usize>,
    /// The freedoms of scalar points, whose rows follow those of the triples.
    scalars: std::ops::Range<usize>,
    /// Row of each freedom among these rows.
    place: Vec<u32>,
}

impl<'a> Directed<'a> {
    fn new(freedoms: &FreedomMap, matrix: &'a SymmetricMatrix) -> Self {
        let mut touched = vec![false; freedoms.size()];
        for column in 0..matrix.size() {
            for row in matrix.column(column).0 {
                touched[*row as usize] = true;
                touched[column] = true;
            }
        }
        let mut place = vec![u32::MAX; freedoms.size()];
        let mut triples = Vec::new();
        for node in 0..freedoms.all_nodes() {
            for first in turning(freedoms, node) {
                if touched[first..first + 3].contains(&true) {
                    for (component, place) in place[first..first + 3].iter_mut().enumerate() {
                        *place = (3 * triples.len() + component) as u32;
                    }
                    triples.push(first);
                }
            }
        }
        let scalars = freedoms.scalar_freedoms();
        for (index, freedom) in scalars.clone().enumerate() {
            place[freedom] = (3 * triples.len() + index) as u32;
        }
        Directed {
            matrix,
            triples,
            scalars,
            place,
        }
    }

    /// `M x` of vectors on the touched rows, a row's entries of all vectors one after the other.
    fn apply(&self, n: usize, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        let at = |freedom: usize| {
            let first = self.place[freedom] as usize * n;
            first..first + n
        };
        for column in 0..self.matrix.size() {
            let (rows, values) = self.matrix.column(column);
            for (row, value) in rows.iter().zip(values) {
                let row = *row as usize;
                add(&mut out[at(row)], &x[at(column)], *value);
                if row != column {
                    add(&mut out[at(column)], &x[at(row)], *value);
                }
            }
        }
        out
    }

    fn add(&self, shapes: &[f64], n: usize, out: &mut Invariants) {
        let size = self.place.len();
        let turning = 3 * self.triples.len();
        let rows = turning + self.scalars.len();
        let mut own = vec![0.0; rows * n];
        let of_triples = self.triples.iter().flat_map(|first| *first..first + 3);
        for (row, freedom) in of_triples.chain(self.scalars.clone()).enumerate() {
            let row = &mut own[row * n..][..n];
            for (x, shape) in row.iter_mut().zip(shapes.chunks_exact(size.max(1))) {
                *x = shape[freedom];
            }
        }
        let turned: [Vec<f64>; 3] = std::array::from_fn(|k| {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            let mut turned = vec![0.0; own.len()];
            for (x, y) in own[..turning * n]
                .chunks_exact(3 * n.max(1))
                .zip(turned.chunks_exact_mut(3 * n.max(1)))
            {
                add(&mut y[next * n..][..n], &x[last * n..][..n], -1.0);
                add(&mut y[last * n..][..n], &x[next * n..][..n], 1.0);
            }
            turned
        });
        let inertial: [Vec<f64>; 3] = std::array::from_fn(|k| self.apply(n, &turned[k]));
        let product = |out: &mut [f64], x: &[f64], y: &[f64]| {
            matmul(
                MatMut::from_row_major_slice_mut(out, n, n),
                Accum::Add,
                MatRef::from_row_major_slice(x, rows, n).transpose(),
                MatRef::from_row_major_slice(y, rows, n),
                1.0,
                Par::Seq,
            );
        };
        for (coriolis, inertial) in out.coriolis.iter_mut().zip(&inertial) {
            product(coriolis, &own, inertial);
        }
        for ((j, k), centrifugal) in PAIRS.into_iter().zip(&mut out.centrifugal) {
            product(centrifugal, &turned[j], &inertial[k]);
        }
        product(&mut out.modal_mass, &own, &self.apply(n, &own));
    }
}

fn symmetric(block: &[f64], n: usize) -> Vec<f64> {
    (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .map(|(i, j)| 0.5 * (block[i * n + j] + block[j * n + i]))
        .collect()
}
