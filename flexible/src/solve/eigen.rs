//! The lowest eigenvalues of `K x = λ M x`, proven complete by a Sturm count.
//!
//! `K` and `M` are symmetric and positive semidefinite, either may be singular (a free body, massless freedoms), but not over
//! the same motion. With a shift σ < 0, `K − σ M` is positive definite, and the eigenvalues nearest σ are the lowest ones: a
//! block Lanczos iteration finds them. Then `K − s M` is factored with s just above the last one: its number of negative
//! pivots is the number of eigenvalues below s, whatever the iteration found.

use super::dense::inverse_eigen;
use super::factor::{Analysis, Definiteness, Factorization, diagonal, norm};
use super::lanczos::{Lanczos, Ritz, dot};
use super::pencil::shifted;
use super::product::multiply;
use super::random::Random;
use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;
use std::sync::Arc;

/// Which modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Modes {
    /// So many of the lowest, rigid ones counted.
    Count(usize),
    /// All with an eigenvalue (2π f)² below this, rad²/s².
    UpTo(f64),
}

/// How to look for them.
#[derive(Clone, Debug)]
pub struct EigenOptions {
    /// Order and structure of the factor, if the caller has them for the pattern of [`shifted`].
    pub analysis: Option<Arc<Analysis>>,
    /// Shift σ, below all eigenvalues, rad²/s²; else one is found.
    pub shift: Option<f64>,
    /// Vectors iterated together, at least 1.
    pub block: usize,
    /// Vectors held at once; else twice the modes and ten blocks. Fewer than the modes and four blocks are not possible.
    pub basis: Option<usize>,
    /// Residual of a mode in the inverse iteration, relative, at which it counts as found. The eigenvalue's relative error is
    /// about the square of it.
    pub tolerance: f64,
    /// Blocks solved for, at most; else a number that is plenty for the modes.
    pub solves: Option<usize>,
}

impl Default for EigenOptions {
    fn default() -> Self {
        EigenOptions {
            analysis: None,
            shift: None,
            block: 8,
            basis: None,
            tolerance: 1e-9,
            solves: None,
        }
    }
}

/// What a count by inertia showed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SturmCount {
    /// Eigenvalues below [`SturmCount::below`], all found. It may be more than the modes given, when the last one asked for has
    /// others as close to it as rounding.
    pub count: usize,
    /// The eigenvalue up to which nothing is missing, rad²/s².
    pub below: f64,
}

/// Modes.
#[derive(Clone, Debug)]
pub struct EigenSolution {
    /// Eigenvalues (2π f)², rad²/s², ascending. Those of rigid motions are rounding, of either sign.
    pub eigenvalues: Vec<f64>,
    /// Vectors one after the other, each of the matrices' size, `xᵀ M x = 1`, the largest component positive (the first of
    /// those within a millionth of the largest).
    pub vectors: Vec<f64>,
    /// `‖K x − λ M x‖ / (|λ − σ| ‖M x‖)` of each.
    pub residuals: Vec<f64>,
    /// That none is missing.
    pub sturm: SturmCount,
    /// The shift σ used, rad²/s².
    pub shift: f64,
    /// Factorisations made.
    pub factorizations: usize,
    /// Blocks of vectors solved for.
    pub solves: usize,
}

/// First guess of |σ| over the typical ratio of the diagonals, itself about the largest eigenvalue.
const FIRST_SHIFT: f64 = 1e-9;
/// The same where all eigenvalues are found densely: rounding is even over all of them.
const DENSE_SHIFT: f64 = 1e-3;
/// Up to this size the eigenvalues are found densely.
const DENSE: usize = 200;
/// Up to this size they are when more than a third is wanted.
const DENSE_MANY: usize = 2500;
/// Neighbours closer than this share of the eigenvalue are one cluster…
const CLUSTER: f64 = 1e-6;
/// …and so are those closer than this share of the typical ratio of the diagonals: rounding of zeros.
const ROUNDING: f64 = 1e-13;
/// An eigenvalue below this share of |σ| is a rigid motion, as far as the choice of σ goes.
const RIGID: f64 = 1e-4;
/// |σ| over the first elastic eigenvalue: outside of these σ is moved…
const SHIFT_RANGE: [f64; 2] = [1e-6, 20.0];
/// …so often at most.
const MOVES: usize = 3;
/// Pairs with θ below this share of the largest are massless motions.
const MASSLESS: f64 = 1e-12;
/// Times the search is taken up again when the count shows that modes are missing.
const RESUMPTIONS: usize = 8;
/// An eigenvalue this near (relative) a place of counting may count on either side.
const BORDER: f64 = 1e-9;
/// How far a place of counting is moved (relative) when its factor is no good.
const NUDGES: f64 = 1e-8;
/// What a solution with an indefinite factor may leave of the right-hand side: more means that its pivots can't be trusted.
const TRUSTED: f64 = 1e-6;

/// Finds modes.
///
/// # Errors
/// [`FlexibleError::Matrix`] for matrices that don't fit, are not finite, or have negative masses;
/// [`FlexibleError::Singular`] when a motion has neither stiffness nor mass; [`FlexibleError::Numerical`] when there are fewer
/// modes than asked for, or the iteration or the count does not come out.
pub fn lowest_modes(
    stiffness: &SymmetricMatrix,
    mass: &SymmetricMatrix,
    request: Modes,
    options: &EigenOptions,
) -> Result<EigenSolution, FlexibleError> {
    let mut search = Search::new(stiffness, mass, options)?;
    match request {
        Modes::Count(0) => Ok(search.nothing(0.0)),
        Modes::Count(count) => search.run(count, None, None),
        Modes::UpTo(limit) => {
            if !limit.is_finite() || limit <= 0.0 {
                return Err(FlexibleError::Matrix {
                    problem: format!("modes up to the eigenvalue {limit}"),
                    advice: "give a positive frequency".into(),
                });
            }
            let (count, _, factor) = search.inertia(None, limit)?;
            if count == 0 {
                Ok(search.nothing(limit))
            } else {
                search.run(count, Some(limit), Some(factor))
            }
        }
    }
}

/// What a search needs throughout.
struct Search<'a> {
    stiffness: &'a SymmetricMatrix,
    mass: &'a SymmetricMatrix,
    options: &'a EigenOptions,
    analysis: Arc<Analysis>,
    /// Median of the ratios of stiffness's and mass's diagonals.
    typical: f64,
    factorizations: usize,
    solves: usize,
}

/// The pairs found so far.
struct Pairs {
    /// σ + 1/θ, ascending; those after the first `sure` are estimates from above.
    eigenvalues: Vec<f64>,
    sure: usize,
    /// True when there are no others.
    complete: bool,
}

impl Pairs {
    fn new(theta: &[f64], residuals: &[f64], tolerance: f64, shift: f64, complete: bool) -> Pairs {
        let least = MASSLESS * theta.first().copied().unwrap_or(0.0);
        let eigenvalues: Vec<f64> = theta
            .iter()
            .take_while(|theta| **theta > least)
            .map(|theta| shift + 1.0 / theta)
            .collect();
        let sure = residuals
            .iter()
            .take(eigenvalues.len())
            .take_while(|residual| **residual <= tolerance)
            .count();
        Pairs {
            eigenvalues,
            sure,
            complete,
        }
    }

    /// How many of the sure ones are below a value.
    fn below(&self, value: f64) -> usize {
        self.eigenvalues
            .iter()
            .take(self.sure)
            .filter(|eigenvalue| **eigenvalue < value)
            .count()
    }
}

/// How an iteration went.
enum Progress {
    /// The wanted pairs are there.
    Found(Pairs, Ritz),
    /// This shift is better.
    Move(f64),
}

/// A count at a place, or how many were counted and where if that is not what was found.
type Proof = Result<SturmCount, (usize, f64)>;

/// Where a count is to be made.
enum Place {
    /// Above so many of the found eigenvalues, at this value; the next one is supposed so far above them.
    At {
        expected: usize,
        below: f64,
        gap: f64,
    },
    /// Not before this many are found: the last ones are a cluster.
    After(usize),
}

impl<'a> Search<'a> {
    fn new(
        stiffness: &'a SymmetricMatrix,
        mass: &'a SymmetricMatrix,
        options: &'a EigenOptions,
    ) -> Result<Self, FlexibleError> {
        let both = shifted(stiffness, mass, 0.0)?;
        if both.size() == 0 {
            return Err(FlexibleError::Matrix {
                problem: "modes of matrices without rows".into(),
                advice: "does the mesh have free nodes?".into(),
            });
        }
        let masses = diagonal(mass);
        if let Some(row) = masses.iter().position(|mass| !(*mass >= 0.0)) {
            return Err(FlexibleError::Matrix {
                problem: format!("the mass of row {} is negative or not a number", row + 1),
                advice: "a mass matrix is positive semidefinite".into(),
            });
        }
        let mut ratios: Vec<f64> = diagonal(stiffness)
            .iter()
            .zip(&masses)
            .map(|(stiffness, mass)| stiffness / mass)
            .filter(|ratio| ratio.is_finite() && *ratio > 0.0)
            .collect();
        ratios.sort_unstable_by(f64::total_cmp);
        let Some(&typical) = ratios.get(ratios.len() / 2) else {
            return Err(FlexibleError::Matrix {
                problem: "no row has both mass and stiffness: there are no modes".into(),
                advice: "do the materials have densities?".into(),
            });
        };
        let analysis = match &options.analysis {
            Some(analysis) => analysis.clone(),
            None => Arc::new(Analysis::fill_reducing(&both)?),
        };
        Ok(Search {
            stiffness,
            mass,
            options,
            analysis,
            typical,
            factorizations: 0,
            solves: 0,
        })
    }

    fn nothing(&self, below: f64) -> EigenSolution {
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

    /// Finds `count` modes and proves them complete: below `limit` where the count was made there.
    fn run(
        &mut self,
        count: usize,
        limit: Option<f64>,
        spare: Option<Factorization>,
    ) -> Result<EigenSolution, FlexibleError> {
        let size = self.mass.size();
        if size <= DENSE || (size <= DENSE_MANY && count >= size / 3) {
            self.run_dense(count, limit, spare)
        } else {
            self.run_lanczos(count, limit, spare)
        }
    }

    fn run_dense(
        &mut self,
        count: usize,
        limit: Option<f64>,
        spare: Option<Factorization>,
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
                    .prove(spare, expected, below, gap)?
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
        spare: Option<Factorization>,
    ) -> Result<EigenSolution, FlexibleError> {
        let (mut shift, mut factor) = self.positive(spare)?;
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
                        factor = self.factor_positive(Some(factor), shift)?;
                        lanczos = self.start(&factor, wanted)?;
                    }
                }
            };
            // what is found below a place where the number is known
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
                    let (proof, used) = self.prove(Some(factor), expected, below, gap)?;
                    match proof {
                        Ok(sturm) => {
                            return self.finish(&lanczos, &ritz, &pairs, count, sturm, shift);
                        }
                        Err((counted, at)) if counted > expected => {
                            wanted = counted;
                            limit = Some(at);
                            factor = self.factor_positive(Some(used), shift)?;
                            lanczos.restart(&ritz, expected);
                            lanczos.inject(&factor)?;
                        }
                        Err((counted, at)) => return Err(miscounted(expected, counted, at)),
                    }
                }
            }
        }
        Err(FlexibleError::Numerical {
            problem: format!("of {wanted} modes that a count shows, some can't be found"),
            advice:
                "ask for a few modes more or fewer, so that the last is not one of many close ones"
                    .into(),
        })
    }

    /// A factor of `K − σ M`, with a σ low enough.
    fn positive(
        &mut self,
        mut spare: Option<Factorization>,
    ) -> Result<(f64, Factorization), FlexibleError> {
        if let Some(shift) = self.options.shift {
            return Ok((shift, self.factor_positive(spare, shift)?));
        }
        let mut shift = -FIRST_SHIFT * self.typical;
        loop {
            match self.factor_positive(spare.take(), shift) {
                Err(FlexibleError::Singular { .. }) if shift > -1e-3 * self.typical => {
                    shift *= 1e3;
                }
                result => return Ok((shift, result?)),
            }
        }
    }

    fn factor_positive(
        &mut self,
        spare: Option<Factorization>,
        shift: f64,
    ) -> Result<Factorization, FlexibleError> {
        self.factor(spare, shift, Definiteness::Positive)
    }

    fn factor(
        &mut self,
        spare: Option<Factorization>,
        shift: f64,
        kind: Definiteness,
    ) -> Result<Factorization, FlexibleError> {
        let matrix = shifted(self.stiffness, self.mass, shift)?;
        self.factorizations += 1;
        match spare {
            Some(spare) => spare.replace(&matrix, kind),
            None => Factorization::new(&self.analysis, &matrix, kind),
        }
    }

    /// The number of eigenvalues below a place or right above it, where exactly, and the factor. The place is moved a little
    /// when it hits an eigenvalue, or the factor turns out inexact.
    fn inertia(
        &mut self,
        mut spare: Option<Factorization>,
        place: f64,
    ) -> Result<(usize, f64, Factorization), FlexibleError> {
        let mut offset = 0.0;
        loop {
            let place = place + offset * place.abs();
            let result = self.factor(spare.take(), place, Definiteness::Indefinite);
            let factor = match result {
                Err(FlexibleError::Singular { .. }) if offset < NUDGES => None,
                result => Some(result?),
            };
            if let Some(factor) = factor {
                if self.trusted(&factor, place)? {
                    return Ok((factor.negative_pivots(), place, factor));
                }
                spare = Some(factor);
            }
            if offset >= NUDGES {
                return Err(FlexibleError::Numerical {
                    problem: format!(
                        "the eigenvalues below {place:.6e} rad²/s² can't be counted: the factor there is inexact"
                    ),
                    advice: "ask for a few modes more or fewer".into(),
                });
            }
            offset = if offset > 0.0 { 10.0 * offset } else { 1e-10 };
        }
    }

    /// Whether a factor solves its equations.
    fn trusted(&self, factor: &Factorization, shift: f64) -> Result<bool, FlexibleError> {
        let size = self.mass.size();
        let mut random = Random::new(1);
        let right: Vec<f64> = (0..size).map(|_| random.symmetric()).collect();
        let mut solution = right.clone();
        factor.solve_in_place(&mut solution)?;
        let (mut stiff, mut heavy) = (vec![0.0; size], vec![0.0; size]);
        multiply(self.stiffness, &solution, &mut stiff);
        multiply(self.mass, &solution, &mut heavy);
        // what the solution leaves, over the rounding that its parts alone make
        let (mut left, mut parts) = (0.0, 0.0);
        for ((stiff, heavy), right) in stiff.iter().zip(&heavy).zip(&right) {
            let rest = stiff - shift * heavy - right;
            left += rest * rest;
            parts += stiff * stiff + shift * shift * heavy * heavy + right * right;
        }
        Ok(left <= TRUSTED * TRUSTED * parts)
    }

    fn start(&self, factor: &Factorization, count: usize) -> Result<Lanczos<'a>, FlexibleError> {
        let block = self.options.block.clamp(1, self.mass.size());
        let basis = self.options.basis.unwrap_or(2 * count + 10 * block);
        Lanczos::new(self.mass, factor, block, basis.max(count + 4 * block))
    }

    /// Iterates until the wanted pairs are found.
    fn converge(
        &mut self,
        lanczos: &mut Lanczos<'_>,
        factor: &Factorization,
        shift: f64,
        wanted: usize,
        may_move: bool,
    ) -> Result<Progress, FlexibleError> {
        let block = self.options.block.clamp(1, self.mass.size());
        lanczos.widen(wanted + 4 * block);
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
                if may_move && let Some(better) = better_shift(&pairs, &ritz, shift) {
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
                    advice: "ask for fewer modes, or allow a larger basis".into(),
                });
            }
            lanczos.step(factor)?;
        }
    }

    /// Where to count so as to prove the first `count` pairs complete.
    fn place(&self, pairs: &Pairs, count: usize) -> Place {
        for expected in count..=pairs.sure {
            let Some(&last) = expected
                .checked_sub(1)
                .and_then(|index| pairs.eigenvalues.get(index))
            else {
                continue;
            };
            let room = 0.01 * last.abs() + FIRST_SHIFT * self.typical;
            let gap = match pairs.eigenvalues.get(expected) {
                Some(next) => next - last,
                None if pairs.complete => 2.0 * room,
                None => continue,
            };
            if gap > CLUSTER * last.abs() + ROUNDING * self.typical {
                return Place::At {
                    expected,
                    below: last + room.min(0.5 * gap),
                    gap,
                };
            }
        }
        Place::After(pairs.sure.max(count) + 1)
    }

    /// Counts, a second time further away when fewer are counted than were found.
    fn prove(
        &mut self,
        spare: Option<Factorization>,
        expected: usize,
        below: f64,
        gap: f64,
    ) -> Result<(Proof, Factorization), FlexibleError> {
        let (mut count, mut below, mut factor) = self.inertia(spare, below)?;
        if count < expected {
            (count, below, factor) = self.inertia(Some(factor), below + 0.25 * gap)?;
        }
        let proof = if count == expected {
            Ok(SturmCount { count, below })
        } else {
            Err((count, below))
        };
        Ok((proof, factor))
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

    /// Normalises the vectors and works out what they leave.
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
        let mut heavy = vec![0.0; vectors.len()];
        multiply(self.mass, &vectors, &mut heavy);
        for (vector, heavy) in vectors
            .chunks_exact_mut(size)
            .zip(heavy.chunks_exact_mut(size))
        {
            let largest = vector.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let leading = vector
                .iter()
                .find(|x| x.abs() >= largest * (1.0 - 1e-6))
                .copied()
                .unwrap_or(1.0);
            let scale = 1.0f64.copysign(leading) / dot(vector, heavy).sqrt();
            vector.iter_mut().for_each(|x| *x *= scale);
            heavy.iter_mut().for_each(|x| *x *= scale);
        }
        let mut stiff = vec![0.0; vectors.len()];
        multiply(self.stiffness, &vectors, &mut stiff);
        let residuals = stiff
            .chunks_exact(size)
            .zip(heavy.chunks_exact(size))
            .zip(&pairs.eigenvalues)
            .map(|((stiff, heavy), value)| {
                let rest: Vec<f64> = stiff
                    .iter()
                    .zip(heavy)
                    .map(|(stiff, heavy)| stiff - value * heavy)
                    .collect();
                norm(&rest) / ((value - shift).abs() * norm(heavy))
            })
            .collect();
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

/// A shift in proportion to the first elastic eigenvalue, if that is known and the shift is out of proportion.
fn better_shift(pairs: &Pairs, ritz: &Ritz, shift: f64) -> Option<f64> {
    let elastic = pairs
        .eigenvalues
        .iter()
        .zip(&ritz.residuals)
        .find(|(value, residual)| **value > RIGID * shift.abs() && **residual < 1e-3)
        .map(|(value, _)| *value)?;
    let share = shift.abs() / elastic;
    (share < SHIFT_RANGE[0] || share > SHIFT_RANGE[1]).then_some(-0.25 * elastic)
}

/// The count made at a limit, when it agrees with what was found.
fn agree(pairs: &Pairs, count: usize, limit: f64) -> Result<SturmCount, FlexibleError> {
    let (least, most) = (
        pairs.below(limit * (1.0 - BORDER)),
        pairs.below(limit * (1.0 + BORDER)),
    );
    if (least..=most).contains(&count) {
        Ok(SturmCount {
            count,
            below: limit,
        })
    } else {
        Err(miscounted(most, count, limit))
    }
}

fn miscounted(found: usize, counted: usize, below: f64) -> FlexibleError {
    FlexibleError::Numerical {
        problem: format!(
            "{found} modes are found below the eigenvalue {below:.6e} rad²/s², but {counted} counted"
        ),
        advice: "stiffness or mass may not be positive semidefinite; or ask for a few modes more or fewer"
            .into(),
    }
}

fn too_few(there: usize, wanted: usize) -> FlexibleError {
    FlexibleError::Numerical {
        problem: format!("{wanted} modes asked for, there are {there}"),
        advice: "only freedoms with mass have modes; ask for fewer".into(),
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
