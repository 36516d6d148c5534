//! Block Lanczos iteration for `A⁻¹ M x = θ x` in the inner product of `M`, with full reorthogonalisation and
//! thick restarts (Grimes, Lewis, Simon: A shifted block Lanczos algorithm, SIAM J. Matrix Anal. Appl. 15,
//! 1994; Wu, Simon: Thick-restart Lanczos method, ibid. 22, 2000).
//!
//! The basis is a set of processed columns `V`, followed by the next block `W`: `A⁻¹ M V = V T + W C`,
//! `[V W]ᵀ M [V W] = 1`. Only the columns of `C` from `coupled` on are not zero. The code does not assume a
//! banded `T`: it projects every new column on all others, which also makes restarts simple.

use super::dense::symmetric_eigen;
use super::random::Random;
use super::restrained::Restrained;
use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;
use crate::sparse::product::multiply;
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// A column depends on the others if it keeps less than this share of its length when they are projected out.
/// A choice above rounding: a column of less is noise of the solution, and of unit length it would be an
/// arbitrary direction.
const DEPENDENT: f64 = 1e-11;
/// The same limit for columns of unit length, which should not shrink again. A choice: a unit column loses
/// nothing but rounding.
const UNIT_LOST: f64 = 1e-2;
/// If a projection leaves less than this share of a column's square, the Gram matrix is computed again: by
/// differences it has lost four digits and more. A choice.
const SHRUNK: f64 = 1e-4;
/// A second projection is unnecessary under two conditions. First: the projection leaves more than this share
/// of the square of every column, which is half of its length, so that it loses less than a digit.
const KEPT: f64 = 0.25;
/// Second: every column keeps more than this share of its square when the others of its block are projected
/// out. A choice: the columns lose less than two digits among each other.
const INDEPENDENT: f64 = 1e-3;
/// A block counts as orthonormal if its remaining components along the basis are below this. A choice above
/// the rounding of sums over large vectors; with it eigenvectors are orthogonal to as many digits.
const ORTHOGONAL: f64 = 1e-12;

/// The state of an iteration.
pub(crate) struct Lanczos<'a> {
    mass: &'a SymmetricMatrix,
    size: usize,
    block: usize,
    /// The largest number of processed columns.
    limit: usize,
    /// Processed columns, then the next block.
    basis: Vec<f64>,
    processed: usize,
    next: usize,
    /// `M` times the next block.
    mass_next: Vec<f64>,
    /// `T`, upper triangle, by columns of `limit` entries.
    projected: Vec<f64>,
    /// `C`: `next` rows, columns from `coupled` to `processed`.
    coupling: Vec<f64>,
    coupled: usize,
    random: Random,
    /// Number of solved blocks.
    pub(crate) solves: usize,
}

/// Approximate eigenpairs, with θ descending.
pub(crate) struct Ritz {
    pub(crate) values: Vec<f64>,
    /// The vectors by columns, in the basis of the processed columns.
    vectors: Vec<f64>,
    /// `C s`: the part of each pair's residual in the next block; `next` rows.
    leak: Vec<f64>,
    /// Length of that residual, over θ.
    pub(crate) residuals: Vec<f64>,
}

impl<'a> Lanczos<'a> {
    /// Starts from `block` random vectors. Each step that solves gets the factor as an argument, so that its
    /// memory can serve other factorisations in between. It must always be the factor of the same matrix.
    ///
    /// # Errors
    /// When memory runs out.
    pub(crate) fn new(
        mass: &'a SymmetricMatrix,
        factor: &Restrained,
        block: usize,
        limit: usize,
    ) -> Result<Self, FlexibleError> {
        let size = mass.size();
        let mut basis = Vec::new();
        basis
            .try_reserve_exact(size * (limit + block))
            .map_err(|_| super::ordering::out_of_memory())?;
        let mut lanczos = Lanczos {
            mass,
            size,
            block,
            limit,
            basis,
            processed: 0,
            next: 0,
            mass_next: Vec::new(),
            projected: zeros(limit)?,
            coupling: Vec::new(),
            coupled: 0,
            random: Random::new(size as u64),
            solves: 0,
        };
        lanczos.inject(factor)?;
        Ok(lanczos)
    }

    /// Number of processed columns.
    pub(crate) fn processed(&self) -> usize {
        self.processed
    }

    /// The largest number of processed columns.
    pub(crate) fn limit(&self) -> usize {
        self.limit
    }

    /// Makes room for more processed columns.
    ///
    /// # Errors
    /// When memory runs out.
    pub(crate) fn widen(&mut self, limit: usize) -> Result<(), FlexibleError> {
        if limit <= self.limit {
            return Ok(());
        }
        let mut projected = zeros(limit)?;
        for (wide, narrow) in projected
            .chunks_exact_mut(limit)
            .zip(self.projected.chunks_exact(self.limit))
        {
            wide[..self.limit].copy_from_slice(narrow);
        }
        self.projected = projected;
        self.limit = limit;
        Ok(())
    }

    /// True when the next block is empty: the basis holds an invariant subspace.
    pub(crate) fn exhausted(&self) -> bool {
        self.next == 0
    }

    /// True when the next block does not fit.
    pub(crate) fn full(&self) -> bool {
        self.processed + self.next > self.limit
    }

    /// Replaces the next block by a random one. It finds vectors that the iteration cannot reach from its
    /// present basis: further vectors of a multiple eigenvalue. The block stays empty when the basis spans
    /// all motions with mass.
    ///
    /// # Errors
    /// When memory runs out.
    pub(crate) fn inject(&mut self, factor: &Restrained) -> Result<(), FlexibleError> {
        self.basis.truncate(self.processed * self.size);
        self.next = 0;
        self.coupled = self.processed;
        self.coupling.clear();
        let start: Vec<f64> = (0..self.size * self.block)
            .map(|_| self.random.symmetric())
            .collect();
        let mut image = vec![0.0; start.len()];
        multiply(self.mass, &start, &mut image);
        // one application removes motions without mass
        factor.solve_in_place(&mut image)?;
        self.solves += 1;
        self.append(image, Vec::new());
        Ok(())
    }

    /// Processes the next block.
    ///
    /// # Errors
    /// When memory runs out.
    pub(crate) fn step(&mut self, factor: &Restrained) -> Result<(), FlexibleError> {
        let mass_block = std::mem::take(&mut self.mass_next);
        let mut image = mass_block.clone();
        factor.solve_in_place(&mut image)?;
        self.solves += 1;
        let (first, columns) = (self.processed, self.next);
        let known = self.known_components(&mass_block, &mut image);
        drop(mass_block);
        self.processed += columns;
        self.next = 0;
        self.coupled = first;
        let (along, coupling) = self.append(image, known);
        let rows = self.processed;
        for column in first..rows {
            let own = &along[(column - first) * rows..][..rows];
            for row in 0..=column {
                // T is symmetric, so the product of the block with itself is replaced by the mean with its
                // transpose
                let mirror = if row < first {
                    own[row]
                } else {
                    along[(row - first) * rows + column]
                };
                self.projected[column * self.limit + row] = 0.5 * (own[row] + mirror);
            }
        }
        self.coupling = coupling;
        Ok(())
    }

    /// Removes the components of the image `Z = A⁻¹ M W` of the next block that are known without a product
    /// with the mass. Along W the component is `(M W)ᵀ Z`, and along the columns before it
    /// `Vᵀ M A⁻¹ M W = (A⁻¹ M V)ᵀ M W = Cᵀ`. The remaining components are small or rounding errors, so that
    /// one projection on the whole basis is mostly enough. Returns the removed components, over the basis
    /// with the block, by columns.
    fn known_components(&self, mass_block: &[f64], image: &mut [f64]) -> Vec<f64> {
        let (size, next) = (self.size, self.next);
        let rows = self.processed + next;
        let mut known = vec![0.0; rows * next];
        for (index, c) in self.coupling.iter().enumerate() {
            let (column, row) = (self.coupled + index / next.max(1), index % next.max(1));
            known[row * rows + column] = *c;
        }
        let own = self.gram(mass_block, image);
        for column in 0..next {
            for row in 0..next {
                // the mean, because the matrix is symmetric
                known[column * rows + self.processed + row] =
                    0.5 * (own[column * next + row] + own[row * next + column]);
            }
        }
        let tail = self.coupled;
        matmul(
            MatMut::from_column_major_slice_mut(image, size, next),
            Accum::Add,
            MatRef::from_column_major_slice(&self.basis[tail * size..], size, rows - tail),
            MatRef::from_column_major_slice(&known, rows, next).subrows(tail, rows - tail),
            -1.0,
            Par::Seq,
        );
        known
    }

    /// Orthonormalises a block against the basis and in itself, and appends it as the next block. Returns the
    /// components of the block along the basis (by columns, added to the components removed before) and along
    /// the new columns: `block = V H + W R`.
    fn append(&mut self, mut block: Vec<f64>, mut along: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
        let (size, known) = (self.size, self.processed);
        let columns = block.len() / size.max(1);
        along.resize(known * columns, 0.0);
        // squared lengths of the components removed before, and of the columns of the block
        let taken: Vec<f64> = (0..columns)
            .map(|column| {
                let own = along.get(column * known..(column + 1) * known);
                own.map_or(0.0, |own| dot(own, own))
            })
            .collect();
        let mut lengths = Vec::new();
        // rows: the present columns of the block; columns: the original ones
        let mut upper = identity(columns);
        let mut mass_block = vec![0.0; block.len()];
        let mut done = false;
        for pass in 0..5 {
            let width = block.len() / size.max(1);
            mass_block.truncate(block.len());
            multiply(self.mass, &block, &mut mass_block);
            // columns have unit length after the first pass; one that still shrinks was a rounding error
            let floors = if pass == 0 {
                let columns = block.chunks_exact(size).zip(mass_block.chunks_exact(size));
                lengths = columns.map(|(x, y)| dot(x, y).max(0.0)).collect();
                let whole = lengths.iter().zip(&taken);
                whole
                    .map(|(length, taken)| DEPENDENT * (length + taken).sqrt())
                    .collect()
            } else {
                vec![UNIT_LOST; width]
            };
            let basis = MatRef::from_column_major_slice(&self.basis, size, known);
            let mut part = vec![0.0; known * width];
            matmul(
                MatMut::from_column_major_slice_mut(&mut part, known, width),
                Accum::Replace,
                basis.transpose(),
                MatRef::from_column_major_slice(&mass_block, size, width),
                1.0,
                Par::Seq,
            );
            matmul(
                MatMut::from_column_major_slice_mut(&mut block, size, width),
                Accum::Add,
                basis,
                MatRef::from_column_major_slice(&part, known, width),
                -1.0,
                Par::Seq,
            );
            matmul(
                MatMut::from_column_major_slice_mut(&mut along, known, columns),
                Accum::Add,
                MatRef::from_column_major_slice(&part, known, width),
                MatRef::from_column_major_slice(&upper, width, columns),
                1.0,
                Par::Seq,
            );
            // (W − V h)ᵀ M W is the Gram matrix of the remaining block, except for rounding errors of the
            // size of the removed part
            let mut gram = self.gram(&block, &mass_block);
            let kept = |gram: &[f64]| {
                let shares = lengths.iter().enumerate();
                shares.fold(1.0f64, |least, (index, length)| {
                    least.min(gram[index * (width + 1)] / length)
                })
            };
            if pass == 0 && kept(&gram) < SHRUNK {
                multiply(self.mass, &block, &mut mass_block);
                gram = self.gram(&block, &mass_block);
            }
            let unit = gram
                .iter()
                .enumerate()
                .fold(0.0f64, |worst, (index, &entry)| {
                    let one = if index % (width + 1) == 0 { 1.0 } else { 0.0 };
                    worst.max((entry - one).abs())
                });
            let moved = part
                .iter()
                .fold(0.0f64, |worst, part| worst.max(part.abs()));
            let (factor, inverse, rank, least) = pivoted_cholesky(&gram, width, &floors);
            // columns that keep their length and are not nearly dependent are orthonormal after one pass
            let clean = pass == 0 && rank == width && kept(&gram) > KEPT && least > INDEPENDENT;
            let apply = |old: &[f64]| product(old, [size, width, rank], &inverse);
            block = apply(&block);
            upper = product(&factor, [rank, width, columns], &upper);
            if pass > 0 && moved <= ORTHOGONAL && unit <= ORTHOGONAL && rank == width {
                mass_block = apply(&mass_block);
                done = true;
            }
            if done || clean || rank == 0 {
                break;
            }
        }
        if !done {
            mass_block.truncate(block.len());
            multiply(self.mass, &block, &mut mass_block);
        }
        self.next = block.len() / size.max(1);
        self.basis.truncate(known * size);
        self.basis.extend_from_slice(&block);
        self.mass_next = mass_block;
        (along, upper)
    }

    /// `Xᵀ Y` of two blocks of the same width.
    fn gram(&self, x: &[f64], y: &[f64]) -> Vec<f64> {
        let width = x.len() / self.size.max(1);
        let mut gram = vec![0.0; width * width];
        matmul(
            MatMut::from_column_major_slice_mut(&mut gram, width, width),
            Accum::Replace,
            MatRef::from_column_major_slice(x, self.size, width).transpose(),
            MatRef::from_column_major_slice(y, self.size, width),
            1.0,
            Par::Seq,
        );
        gram
    }

    /// The eigenpairs of `T`.
    ///
    /// # Errors
    /// When `T` is not finite.
    pub(crate) fn ritz(&self) -> Result<Ritz, FlexibleError> {
        let count = self.processed;
        let mut dense = vec![0.0; count * count];
        for column in 0..count {
            for row in 0..=column {
                // the eigenvalue routine reads the lower triangle
                dense[row * count + column] = self.projected[column * self.limit + row];
            }
        }
        let (mut values, ascending) = symmetric_eigen(count, dense)?;
        values.reverse();
        let vectors: Vec<f64> = ascending.rchunks(count.max(1)).flatten().copied().collect();
        let mut leak = vec![0.0; self.next * count];
        let tail = MatRef::from_column_major_slice(&vectors, count, count)
            .subrows(self.coupled, count - self.coupled);
        matmul(
            MatMut::from_column_major_slice_mut(&mut leak, self.next, count),
            Accum::Replace,
            MatRef::from_column_major_slice(&self.coupling, self.next, count - self.coupled),
            tail,
            1.0,
            Par::Seq,
        );
        let residuals = if self.next == 0 {
            vec![0.0; count]
        } else {
            leak.chunks_exact(self.next)
                .zip(&values)
                .map(|(leak, value)| super::factor::norm(leak) / value.abs())
                .collect()
        };
        Ok(Ritz {
            values,
            vectors,
            leak,
            residuals,
        })
    }

    /// Keeps the first `keep` approximate eigenvectors as the processed columns.
    pub(crate) fn restart(&mut self, ritz: &Ritz, keep: usize) {
        let keep = keep.min(self.processed);
        self.combine(&ritz.vectors, keep);
        let next = self.basis.split_off(self.processed * self.size);
        self.basis.truncate(keep * self.size);
        self.basis.extend_from_slice(&next);
        self.projected.fill(0.0);
        for (index, &value) in ritz.values.iter().take(keep).enumerate() {
            self.projected[index * (self.limit + 1)] = value;
        }
        self.processed = keep;
        self.coupled = 0;
        self.coupling = ritz.leak[..self.next * keep].to_vec();
    }

    /// Like [`Lanczos::restart`], but frees the memory of the other columns. The kept pairs do not change.
    pub(crate) fn settle(&mut self, ritz: &Ritz, keep: usize) -> Ritz {
        self.restart(ritz, keep);
        self.basis.shrink_to_fit();
        let keep = self.processed;
        Ritz {
            values: ritz.values.iter().take(keep).copied().collect(),
            vectors: identity(keep),
            leak: ritz.leak[..self.next * keep].to_vec(),
            residuals: ritz.residuals.iter().take(keep).copied().collect(),
        }
    }

    /// Replaces the first columns of the basis by combinations of the processed ones, some rows at a time.
    fn combine(&mut self, vectors: &[f64], keep: usize) {
        // a choice: a panel of these rows fits in the cache
        const ROWS: usize = 512;
        let (size, count) = (self.size, self.processed);
        let mut panel = vec![0.0; ROWS * keep];
        for first in (0..size).step_by(ROWS) {
            let rows = ROWS.min(size - first);
            matmul(
                MatMut::from_column_major_slice_mut(&mut panel[..rows * keep], rows, keep),
                Accum::Replace,
                MatRef::from_column_major_slice(&self.basis[..size * count], size, count)
                    .subrows(first, rows),
                MatRef::from_column_major_slice(&vectors[..count * keep], count, keep),
                1.0,
                Par::Seq,
            );
            for (column, values) in panel[..rows * keep].chunks_exact(rows).enumerate() {
                self.basis[column * size + first..][..rows].copy_from_slice(values);
            }
        }
    }

    /// The first `count` approximate eigenvectors in the given freedoms, with one step of the iteration
    /// applied, `x = V s + W C s / θ`, which removes accumulated motions without mass (Nour-Omid,
    /// Parlett, Ericsson, Jensen: How to implement the spectral transformation, Math. Comp. 48, 1987). Not
    /// normalised.
    pub(crate) fn vectors(&self, ritz: &Ritz, count: usize) -> Vec<f64> {
        let size = self.size;
        let mut vectors = vec![0.0; size * count];
        matmul(
            MatMut::from_column_major_slice_mut(&mut vectors, size, count),
            Accum::Replace,
            MatRef::from_column_major_slice(
                &self.basis[..size * self.processed],
                size,
                self.processed,
            ),
            MatRef::from_column_major_slice(
                &ritz.vectors[..self.processed * count],
                self.processed,
                count,
            ),
            1.0,
            Par::Seq,
        );
        if self.next > 0 {
            let mut leak = ritz.leak[..self.next * count].to_vec();
            for (leak, value) in leak.chunks_exact_mut(self.next).zip(&ritz.values) {
                leak.iter_mut().for_each(|entry| *entry /= value);
            }
            matmul(
                MatMut::from_column_major_slice_mut(&mut vectors, size, count),
                Accum::Add,
                MatRef::from_column_major_slice(
                    &self.basis[size * self.processed..],
                    size,
                    self.next,
                ),
                MatRef::from_column_major_slice(&leak, self.next, count),
                1.0,
                Par::Seq,
            );
        }
        vectors
    }
}

pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// `A B` of matrices stored by columns; A has `rows` rows and `inner` columns, B `columns` columns.
fn product(a: &[f64], [rows, inner, columns]: [usize; 3], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; rows * columns];
    matmul(
        MatMut::from_column_major_slice_mut(&mut out, rows, columns),
        Accum::Replace,
        MatRef::from_column_major_slice(a, rows, inner),
        MatRef::from_column_major_slice(b, inner, columns),
        1.0,
        Par::Seq,
    );
    out
}

/// A square matrix of zeros.
fn zeros(size: usize) -> Result<Vec<f64>, FlexibleError> {
    let mut matrix = Vec::new();
    matrix
        .try_reserve_exact(size.saturating_mul(size))
        .map_err(|_| super::ordering::out_of_memory())?;
    matrix.resize(size * size, 0.0);
    Ok(matrix)
}

fn identity(size: usize) -> Vec<f64> {
    let mut matrix = vec![0.0; size * size];
    for index in 0..size {
        matrix[index * (size + 1)] = 1.0;
    }
    matrix
}

/// `G ≈ Rᵀ R` with one row of `R` for each independent column. A column is independent if the projection of
/// the columns before it leaves more than its floor. Returns `R` (rank × width), `B` (width × rank) with
/// `R B = 1`, the rank, and the least remaining share of a column's square.
fn pivoted_cholesky(
    gram: &[f64],
    width: usize,
    floors: &[f64],
) -> (Vec<f64>, Vec<f64>, usize, f64) {
    let mut least = 1.0f64;
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut pivots: Vec<usize> = Vec::new();
    let mut left: Vec<f64> = (0..width).map(|index| gram[index * (width + 1)]).collect();
    loop {
        let mut best: Option<(f64, usize)> = None;
        for (index, (&left, &floor)) in left.iter().zip(floors).enumerate() {
            if !pivots.contains(&index)
                && left > floor * floor
                && best.is_none_or(|(most, _)| left > most)
            {
                best = Some((left, index));
            }
        }
        let Some((most, pivot)) = best else {
            break;
        };
        least = least.min(most / gram[pivot * (width + 1)]);
        let root = most.sqrt();
        let row: Vec<f64> = (0..width)
            .map(|column| {
                if pivots.contains(&column) {
                    return 0.0;
                }
                let inner: f64 = rows.iter().map(|row| row[pivot] * row[column]).sum();
                (gram[column * width + pivot] - inner) / root
            })
            .collect();
        for (left, entry) in left.iter_mut().zip(&row) {
            *left -= entry * entry;
        }
        rows.push(row);
        pivots.push(pivot);
    }
    let rank = rows.len();
    let mut factor = vec![0.0; rank * width];
    for (index, row) in rows.iter().enumerate() {
        for (column, &entry) in row.iter().enumerate() {
            factor[column * rank + index] = entry;
        }
    }
    // R restricted to the pivots is upper triangular
    let mut inverse = vec![0.0; width * rank];
    for column in 0..rank {
        for index in (0..=column).rev() {
            let mut sum = if index == column { 1.0 } else { 0.0 };
            for later in index + 1..=column {
                sum -= rows[index][pivots[later]] * inverse[column * width + pivots[later]];
            }
            inverse[column * width + pivots[index]] = sum / rows[index][pivots[index]];
        }
    }
    (factor, inverse, rank, least)
}
