//! The search for the lowest modes: choice of the shift, iteration, proof, and resumption if modes are
//! missing.

use super::dense::inverse_eigen;
use super::eigen::{EigenOptions, EigenSolution, SturmCount};
use super::factor::{Analysis, Definiteness, Factorization, diagonal, norm};
use super::lanczos::{Lanczos, Ritz, dot};
use super::pencil::shifted;
use super::positive::{Shifted, first_shift, typical_ratio};
use super::restrained::{self, Combination, Restrained};
use super::sturm::{BORDER, Pairs, Place, agree, miscounted};
use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;
use crate::sparse::product::multiply;
use std::sync::Arc;

/// Ratio of |σ| to the typical ratio of the diagonals, for a dense solution of all eigenvalues. In it the
/// rounding error is even over all eigenvalues. A choice: with a much smaller one the shifted matrix of a
/// free body is close to singular, with a larger one the low eigenvalues lose digits.
const DENSE_SHIFT: f64 = 1e-3;
/// Up to this size a dense solver finds the eigenvalues. A choice: its effort, which grows with the cube of
/// the size, is then negligible.
const DENSE: usize = 200;
/// Up to this size a dense solver finds them if more than a third is wanted. A choice: an iteration would
/// need as many vectors, and its effort would grow with the cube of the size, too.
const DENSE_MANY: usize = 2500;
/// For the choice of σ, an eigenvalue below this share of |σ| counts as a rigid motion. A choice: a rigid
/// motion has rounding, and an elastic one as low would move σ in any case.
const RIGID: f64 = 1e-4;
/// Range of |σ| over the first elastic eigenvalue. Outside of it σ moves. A choice: above it the wanted
/// eigenvalues of the inverse lie close together and the iteration is slow. Below it rigid motions outweigh
/// the elastic ones by more than six digits.
const SHIFT_RANGE: std::ops::Range<f64> = 1e-6..20.0;
/// The same range if combinations of freedoms are held. The held rigid motions are removed from solutions, so
/// in a solution they must not be much larger than the wanted modes.
const HELD_RANGE: std::ops::Range<f64> = 0.02..20.0;
/// The largest number of moves of σ. A choice: each takes a factorisation, and the first elastic eigenvalue
/// is known after one.
const MOVES: usize = 3;
/// The largest number of resumptions of the search after a count that shows missing modes. A choice: modes
/// are missed where eigenvalues are multiple, and each resumption finds at least one.
const RESUMPTIONS: usize = 8;

/// The data of a search.
pub(super) struct Search<'a> {
    pub(super) stiffness: &'a SymmetricMatrix,
    pub(super) mass: &'a SymmetricMatrix,
    options: &'a EigenOptions,
    /// Combinations of freedoms held at zero, with unit length.
    held: Vec<Combination>,
    analysis: Arc<Analysis>,
    /// Median of the ratios of the diagonal entries of stiffness and mass.
    pub(super) typical: f64,
    factorizations: usize,
    solves: usize,
}

/// The factor or memory available at the start of a search.
pub(super) enum Start {
    /// The memory of a factor that is no longer needed.
    Memory(Factorization),
    /// A factor for the iteration.
    Positive(Shifted),
}

impl Start {
    fn memory(self) -> Factorization {
        match self {
            Start::Memory(factor) => factor,
            Start::Positive(shifted) => shifted.factor,
        }
    }
}

/// The result of an iteration.
enum Progress {
    /// The wanted pairs.
    Found(Pairs, Ritz),
    /// A better shift.
    Move(f64),
}

impl<'a> Search<'a> {
    pub(super) fn new(
        stiffness: &'a SymmetricMatrix,
        mass: &'a SymmetricMatrix,
        options: &'a EigenOptions,
    ) -> Result<Self, FlexibleError> {
        if stiffness.size() == 0 && mass.size() == 0 {
            return Err(FlexibleError::Matrix {
                problem: "modes of matrices without rows".into(),
                advice: "check that the mesh has free nodes".into(),
            });
        }
        let masses = diagonal(mass);
        if let Some(row) = masses.iter().position(|mass| mass.is_nan() || *mass < 0.0) {
            return Err(FlexibleError::Matrix {
                problem: format!("the mass of row {} is negative or not a number", row + 1),
                advice: "a mass matrix is positive semidefinite".into(),
            });
        }
        let analysis = match &options.analysis {
            Some(analysis) => analysis.clone(),
            None => Arc::new(Analysis::fill_reducing(&shifted(stiffness, mass, 0.0)?)?),
        };
        let typical = typical_ratio(stiffness, mass)?;
        Ok(Search {
            stiffness,
            mass,
            options,
            held: restrained::unit(&options.held, mass.size())?,
            analysis,
            typical,
            factorizations: 0,
            solves: 0,
        })
    }

    pub(super) fn nothing(&self, below: f64) -> EigenSolution {
        EigenSolution {
            eigenvalues: Vec::new(),
            vectors: Vec::new(),
            residuals: Vec::new(),
            sturm: SturmCount { count: 0, below },
            shift: 0.0,
            factorizations: self.factorizations,
            solves: 0,
        }
    }

    /// Finds `count` modes and proves that none is missing. With a `limit` the proof uses the count at this
    /// limit.
    pub(super) fn run(
        &mut self,
        count: usize,
        limit: Option<f64>,
        start: Option<Start>,
    ) -> Result<EigenSolution, FlexibleError> {
        let size = self.mass.size();
        let most = size.saturating_sub(self.held.len());
        if count > most {
            return Err(too_few(most, count));
        }
        let dense = size <= DENSE || (size <= DENSE_MANY && count >= size / 3);
        if dense && self.held.is_empty() {
            self.run_dense(count, limit, start)
        } else {
            self.run_lanczos(count, limit, start)
        }
    }

    fn run_dense(
        &mut self,
        count: usize,
        limit: Option<f64>,
        start: Option<Start>,
    ) -> Result<EigenSolution, FlexibleError> {
        let size = self.mass.size();
        let shift = self.options.shift.unwrap_or(-DENSE_SHIFT * self.typical);
        let matrix = shifted(self.stiffness, self.mass, shift)?;
        let (theta, mut vectors) = inverse_eigen(size, dense(&matrix), dense(self.mass))?;
        let pairs = Pairs::new(&theta, &vec![0.0; size], 0.0, shift, true);
        let sturm = match limit {
            Some(limit) => agree(&pairs, count, limit)?,
            None => match self.place(&pairs, count) {
                Place::At {
                    expected,
                    below,
                    gap,
                } => self
                    .prove(start.map(Start::memory), expected, below, gap)?
                    .0
                    .map_err(|(counted, at)| miscounted(expected, counted, at))?,
                Place::After(more) => return Err(too_few(pairs.eigenvalues.len(), more)),
            },
        };
        vectors.truncate(size * count);
        self.solution(&pairs, vectors, sturm, shift)
    }

    fn run_lanczos(
        &mut self,
        count: usize,
        limit: Option<f64>,
        start: Option<Start>,
    ) -> Result<EigenSolution, FlexibleError> {
        let (mut shift, mut factor) = match start {
            Some(Start::Positive(Shifted { shift, factor }))
                if self.options.shift.is_none() && self.held.is_empty() =>
            {
                (shift, Restrained::new(factor, &[], Definiteness::Positive)?)
            }
            other => self.positive(other.map(Start::memory))?,
        };
        let mut lanczos = self.start(&factor, count)?;
        let mut moves = if self.options.shift.is_some() {
            0
        } else {
            MOVES
        };
        let mut wanted = count;
        let mut limit = limit;
        for _ in 0..=RESUMPTIONS {
            let (pairs, ritz) = loop {
                match self.converge(&mut lanczos, &factor, shift, wanted, moves > 0)? {
                    Progress::Found(pairs, ritz) => break (pairs, ritz),
                    Progress::Move(better) => {
                        moves -= 1;
                        self.solves += lanczos.solves;
                        shift = better;
                        factor = self.factor_positive(Some(factor.into_factor()), shift)?;
                        lanczos = self.start(&factor, wanted)?;
                    }
                }
            };
            // the pairs found below a place with a known count
            if let Some(below) = limit {
                let found = pairs.below(below * (1.0 + BORDER));
                if found >= wanted {
                    let sturm = agree(&pairs, wanted, below)?;
                    return self.finish(&lanczos, &ritz, &pairs, count, sturm, shift);
                }
                lanczos.restart(&ritz, found);
                lanczos.inject(&factor)?;
                continue;
            }
            match self.place(&pairs, wanted) {
                Place::After(more) => wanted = more,
                Place::At {
                    expected,
                    below,
                    gap,
                } => {
                    // the count needs memory, and from here on only these columns are needed
                    let ritz = lanczos.settle(&ritz, expected);
                    let (proof, used) =
                        self.prove(Some(factor.into_factor()), expected, below, gap)?;
                    match proof {
                        Ok(sturm) => {
                            return self.finish(&lanczos, &ritz, &pairs, count, sturm, shift);
                        }
                        Err((counted, at)) if counted > expected => {
                            wanted = counted;
                            limit = Some(at);
                            factor = self.factor_positive(Some(used.into_factor()), shift)?;
                            lanczos.restart(&ritz, expected);
                            lanczos.inject(&factor)?;
                        }
                        Err((counted, at)) => return Err(miscounted(expected, counted, at)),
                    }
                }
            }
        }
        Err(FlexibleError::Numerical {
            problem: format!("some of the {wanted} counted modes can't be found"),
            advice:
                "request a few modes more or fewer, so that the last one does not lie among many close modes"
                    .into(),
        })
    }

    /// A factor of `K − σ M` with a sufficiently low σ.
    fn positive(
        &mut self,
        mut memory: Option<Factorization>,
    ) -> Result<(f64, Restrained), FlexibleError> {
        if let Some(shift) = self.options.shift {
            return Ok((shift, self.factor_positive(memory, shift)?));
        }
        first_shift(self.typical, |shift| {
            Ok((shift, self.factor_positive(memory.take(), shift)?))
        })
    }

    fn factor_positive(
        &mut self,
        memory: Option<Factorization>,
        shift: f64,
    ) -> Result<Restrained, FlexibleError> {
        self.factor(memory, shift, Definiteness::Positive)
    }

    pub(super) fn factor(
        &mut self,
        memory: Option<Factorization>,
        shift: f64,
        kind: Definiteness,
    ) -> Result<Restrained, FlexibleError> {
        let matrix = shifted(self.stiffness, self.mass, shift)?;
        self.factorizations += 1;
        let factor = match memory {
            Some(memory) => memory.replace(&matrix, kind),
            None => Factorization::new(&self.analysis, &matrix, kind),
        }?;
        Restrained::new(factor, &self.held, kind)
    }

    fn start(&self, factor: &Restrained, count: usize) -> Result<Lanczos<'a>, FlexibleError> {
        let block = self.options.block.clamp(1, self.mass.size());
        let basis = self.options.basis.unwrap_or(2 * count + 10 * block);
        let most = basis.min(self.mass.size()).max(count + 4 * block);
        Lanczos::new(self.mass, factor, block, most)
    }

    /// Iterates until it has the wanted pairs.
    fn converge(
        &mut self,
        lanczos: &mut Lanczos<'_>,
        factor: &Restrained,
        shift: f64,
        wanted: usize,
        may_move: bool,
    ) -> Result<Progress, FlexibleError> {
        let block = self.options.block.clamp(1, self.mass.size());
        lanczos.widen(wanted + 4 * block)?;
        // a choice: an iteration usually needs few solves for each wanted mode, so one that takes this many
        // does not converge
        let most = self.options.solves.unwrap_or(200 + 20 * wanted / block);
        let mut check = if may_move {
            wanted.min(3 * block)
        } else {
            wanted
        };
        loop {
            let mut complete = false;
            if lanczos.exhausted() {
                lanczos.inject(factor)?;
                complete = lanczos.exhausted();
            }
            if lanczos.processed() >= check.max(1) || lanczos.full() || complete {
                let ritz = lanczos.ritz()?;
                let pairs = Pairs::new(
                    &ritz.values,
                    &ritz.residuals,
                    self.options.tolerance,
                    shift,
                    complete,
                );
                let range = if self.held.is_empty() {
                    SHIFT_RANGE
                } else {
                    HELD_RANGE
                };
                if may_move && let Some(better) = better_shift(&pairs, &ritz, shift, range) {
                    return Ok(Progress::Move(better));
                }
                if pairs.sure >= wanted {
                    return Ok(Progress::Found(pairs, ritz));
                }
                if complete {
                    return Err(too_few(pairs.eigenvalues.len(), wanted));
                }
                if lanczos.full() {
                    lanczos.restart(&ritz, (wanted + 2 * block).min(lanczos.limit() - 2 * block));
                }
                check = lanczos.processed() + block.max(lanczos.processed() / 12);
            }
            if lanczos.solves >= most {
                return Err(FlexibleError::Numerical {
                    problem: format!(
                        "{wanted} modes don't converge within {most} blocks of vectors"
                    ),
                    advice: "request fewer modes, or allow a larger basis".into(),
                });
            }
            lanczos.step(factor)?;
        }
    }

    fn finish(
        &mut self,
        lanczos: &Lanczos<'_>,
        ritz: &Ritz,
        pairs: &Pairs,
        count: usize,
        sturm: SturmCount,
        shift: f64,
    ) -> Result<EigenSolution, FlexibleError> {
        self.solves += lanczos.solves;
        self.solution(pairs, lanczos.vectors(ritz, count), sturm, shift)
    }

    /// Normalises the vectors and computes their residuals.
    fn solution(
        &self,
        pairs: &Pairs,
        mut vectors: Vec<f64>,
        sturm: SturmCount,
        shift: f64,
    ) -> Result<EigenSolution, FlexibleError> {
        let size = self.mass.size();
        let count = vectors.len() / size.max(1);
        if pairs.eigenvalues.len() < count {
            return Err(too_few(pairs.eigenvalues.len(), count));
        }
        let mut residuals = Vec::with_capacity(count);
        let width = size * self.options.block.max(1);
        let (mut heavy, mut stiff) = (vec![0.0; width], vec![0.0; width]);
        for (first, vectors) in vectors.chunks_mut(width).enumerate() {
            let (heavy, stiff) = (&mut heavy[..vectors.len()], &mut stiff[..vectors.len()]);
            multiply(self.mass, vectors, heavy);
            multiply(self.stiffness, vectors, stiff);
            let values = pairs.eigenvalues.iter().skip(first * (width / size));
            for (((vector, heavy), stiff), value) in vectors
                .chunks_exact_mut(size)
                .zip(heavy.chunks_exact(size))
                .zip(stiff.chunks_exact(size))
                .zip(values)
            {
                // the residual does not depend on scale or sign
                let mut rest: Vec<f64> = stiff
                    .iter()
                    .zip(heavy)
                    .map(|(stiff, heavy)| stiff - value * heavy)
                    .collect();
                if !self.held.is_empty() {
                    restrained::without(&self.held, &mut rest)?;
                }
                residuals.push(norm(&rest) / ((value - shift).abs() * norm(heavy)));
                let largest = vector.iter().fold(0.0f64, |most, x| most.max(x.abs()));
                let leading = vector
                    .iter()
                    // of components that differ by rounding alone the first decides the sign on every machine
                    .find(|x| x.abs() >= largest * (1.0 - 1e-6))
                    .copied()
                    .unwrap_or(1.0);
                let scale = 1.0f64.copysign(leading) / dot(vector, heavy).sqrt();
                vector.iter_mut().for_each(|x| *x *= scale);
            }
        }
        Ok(EigenSolution {
            eigenvalues: pairs.eigenvalues[..count].to_vec(),
            vectors,
            residuals,
            sturm,
            shift,
            factorizations: self.factorizations,
            solves: self.solves,
        })
    }
}

/// A shift in proportion to the first elastic eigenvalue, if that is known and the shift is out of
/// proportion.
fn better_shift(
    pairs: &Pairs,
    ritz: &Ritz,
    shift: f64,
    range: std::ops::Range<f64>,
) -> Option<f64> {
    let elastic = pairs
        .eigenvalues
        .iter()
        .zip(&ritz.residuals)
        // three digits of the eigenvalue are enough to place a shift
        .find(|(value, residual)| **value > RIGID * shift.abs() && **residual < 1e-3)
        .map(|(value, _)| *value)?;
    let share = shift.abs() / elastic;
    // a quarter of it: the inverse then prefers the lowest modes, and rigid motions outweigh the first by
    // five times only. A choice
    (!range.contains(&share)).then_some(-0.25 * elastic)
}

fn too_few(there: usize, wanted: usize) -> FlexibleError {
    FlexibleError::Numerical {
        problem: format!("{wanted} modes are requested, but only {there} were found"),
        advice: "request fewer modes: only freedoms with mass have modes, and beside a mass that is many million times larger rounding hides the fast ones".into(),
    }
}

/// Both triangles, by columns.
fn dense(matrix: &SymmetricMatrix) -> Vec<f64> {
    let size = matrix.size();
    let mut entries = vec![0.0; size * size];
    for column in 0..size {
        let (rows, values) = matrix.column(column);
        for (&row, &value) in rows.iter().zip(values) {
            entries[column * size + row as usize] = value;
            entries[row as usize * size + column] = value;
        }
    }
    entries
}
