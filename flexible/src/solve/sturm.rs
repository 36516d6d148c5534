//! Proof by Sturm count that no mode is missing.

use super::eigen::SturmCount;
use super::factor::{Definiteness, Factorization};
use super::positive::FIRST_SHIFT;
use super::random::Random;
use super::restrained::Restrained;
use super::search::Search;
use crate::error::FlexibleError;
use crate::sparse::product::multiply;
use eng_system::significant::short;

/// Neighbours closer than this share of the eigenvalue are one cluster. A choice: eigenvalues of the
/// iteration are right to more digits, and a count between nearer ones could not tell them apart.
const CLUSTER: f64 = 1e-6;
/// Neighbours closer than this share of the typical ratio of the diagonals are also one cluster: zeros with
/// rounding errors. It is some hundred rounding units, for sums of many terms.
const ROUNDING: f64 = 1e-13;
/// Pairs with θ below this share of the largest are massless motions. A choice: their θ is zero but for
/// rounding.
const MASSLESS: f64 = 1e-12;
/// An eigenvalue within this relative distance of a place of counting may count on either side. It is the
/// tolerance of the eigenpairs.
pub(super) const BORDER: f64 = 1e-9;
/// Largest relative distance by which a place of counting moves away from an eigenvalue or an inexact factor.
/// A choice: from 1e-10 on, each is ten times the one before, and none comes near the next cluster.
const NUDGES: f64 = 1e-8;
/// Largest residual of a solution with an indefinite factor, as a share of the size of its parts. A larger
/// residual shows that the pivots are unreliable. A choice: ten digits are then lost, and the signs of small
/// pivots with them.
const TRUSTED: f64 = 1e-6;

/// The pairs found so far.
pub(super) struct Pairs {
    /// σ + 1/θ, ascending. The values after the first `sure` ones are estimates from above.
    pub(super) eigenvalues: Vec<f64>,
    pub(super) sure: usize,
    /// True when there are no other eigenvalues.
    pub(super) complete: bool,
}

impl Pairs {
    pub(super) fn new(
        theta: &[f64],
        residuals: &[f64],
        tolerance: f64,
        shift: f64,
        complete: bool,
    ) -> Pairs {
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

    /// Number of sure eigenvalues below a value.
    pub(super) fn below(&self, value: f64) -> usize {
        self.eigenvalues
            .iter()
            .take(self.sure)
            .filter(|eigenvalue| **eigenvalue < value)
            .count()
    }
}

/// A count at a place. If it differs from the number of pairs found: the count and its place.
pub(super) type Proof = Result<SturmCount, (usize, f64)>;

/// The place for a count.
pub(super) enum Place {
    /// Above a number of the found eigenvalues, at this value. The next eigenvalue is expected at a distance
    /// above them.
    At {
        expected: usize,
        below: f64,
        gap: f64,
    },
    /// No count before this many eigenvalues are found, because the last ones form a cluster.
    After(usize),
}

impl Search<'_> {
    /// The number of eigenvalues below a place, the exact place, and the factor. The place moves up a little
    /// if it hits an eigenvalue or if the factor is inexact.
    pub(super) fn inertia(
        &mut self,
        mut memory: Option<Factorization>,
        place: f64,
    ) -> Result<(usize, f64, Restrained), FlexibleError> {
        let mut offset = 0.0;
        loop {
            let place = place + offset * place.abs();
            let result = self.factor(memory.take(), place, Definiteness::Indefinite);
            let factor = match result {
                Err(FlexibleError::Singular { .. }) if offset < NUDGES => None,
                result => Some(result?),
            };
            if let Some(factor) = factor {
                if self.trusted(&factor, place)? {
                    return Ok((factor.negative(), place, factor));
                }
                memory = Some(factor.into_factor());
            }
            if offset >= NUDGES {
                return Err(FlexibleError::Numerical {
                    problem: format!(
                        "the eigenvalues below {} rad²/s² can't be counted: the factor there is inexact",
                        short(place, 7)
                    ),
                    advice: "request a few modes more or fewer".into(),
                });
            }
            // from 1e-10 on, each ten times the one before; see [`NUDGES`]
            offset = if offset > 0.0 { 10.0 * offset } else { 1e-10 };
        }
    }

    /// The place of a count that proves the first `count` pairs complete.
    pub(super) fn place(&self, pairs: &Pairs, count: usize) -> Place {
        for expected in count..=pairs.sure {
            let Some(&last) = expected
                .checked_sub(1)
                .and_then(|index| pairs.eigenvalues.get(index))
            else {
                continue;
            };
            // a choice: a per cent above the last eigenvalue, and off zero if that is a rigid motion
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

    /// Counts. If the count is smaller than the number of pairs found, it counts a second time farther away.
    pub(super) fn prove(
        &mut self,
        memory: Option<Factorization>,
        expected: usize,
        below: f64,
        gap: f64,
    ) -> Result<(Proof, Restrained), FlexibleError> {
        let (mut count, mut below, mut factor) = self.inertia(memory, below)?;
        if count < expected {
            (count, below, factor) =
                // a quarter of the gap farther: the first place is at most in its middle
                self.inertia(Some(factor.into_factor()), below + 0.25 * gap)?;
        }
        let proof = if count == expected {
            Ok(SturmCount { count, below })
        } else {
            Err((count, below))
        };
        Ok((proof, factor))
    }

    /// Whether a factor solves its equations.
    fn trusted(&self, factor: &Restrained, shift: f64) -> Result<bool, FlexibleError> {
        let size = self.mass.size();
        let mut random = Random::new(1);
        let right: Vec<f64> = (0..size).map(|_| random.symmetric()).collect();
        let mut solution = right.clone();
        factor.factor().solve_in_place(&mut solution)?;
        let (mut stiff, mut heavy) = (vec![0.0; size], vec![0.0; size]);
        multiply(self.stiffness, &solution, &mut stiff);
        multiply(self.mass, &solution, &mut heavy);
        // squares of the residual of the solution, and of its parts, which set the scale of the rounding
        // error
        let (mut left, mut parts) = (0.0, 0.0);
        for ((stiff, heavy), right) in stiff.iter().zip(&heavy).zip(&right) {
            let rest = stiff - shift * heavy - right;
            left += rest * rest;
            parts += stiff * stiff + shift * shift * heavy * heavy + right * right;
        }
        Ok(left <= TRUSTED * TRUSTED * parts)
    }
}

/// The count at a limit, if it agrees with the pairs found.
pub(super) fn agree(pairs: &Pairs, count: usize, limit: f64) -> Result<SturmCount, FlexibleError> {
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

pub(super) fn miscounted(found: usize, counted: usize, below: f64) -> FlexibleError {
    FlexibleError::Numerical {
        problem: format!(
            "{found} modes are found below the eigenvalue {} rad²/s², but {counted} counted",
            short(below, 7)
        ),
        advice: "request a few modes more or fewer; otherwise check that stiffness and mass are positive semidefinite"
            .into(),
    }
}
