//! Balances at rest: their stability, and the search for a balance that Newton's method misses.
//!
//! At rest the free moves of a balance obey `ẍ + K x = 0` with the mass-normalised stiffness K of the moves
//! that are neither constrained nor held. A real eigenvalue κ < 0 of K belongs to a move that grows as
//! `exp(√−κ t)`: the balance is upside down. (This test ignores a complex κ, which only forces without
//! potential can cause.)
//!
//! Newton's method may find any balance, and it ends where K has no inverse: a level pendulum has no
//! stiffness, although gravity holds it farther down. From such positions the search follows the motion in
//! steps of pseudo-time, each solved implicitly,
//!
//! ```text
//! (M σ + K) δ = −r        σ = |M⁻¹r|/reach + 2 |κ|
//! ```
//!
//! with the mass M, the residual r and the least κ of K; the second term is left out if κ ≥ 0. The reach is
//! the largest move of a step, in scaled velocities.
//! This is steepest descent of the energy for a large σ, and Newton's method as r vanishes. A balance that
//! the text states upside down is kept, with a warning. (C. T. Kelley, D. E. Keyes, SIAM J. Numer. Anal. 35
//! (1998) 508.)

use super::describing::not_finite;
use super::{Balance, NEUTRAL, Place, REACH, Stop};
use crate::start::picking::split;
use crate::start::{Equilibrium, Unstable};
use crate::state::State;
use nalgebra::{DMatrix, DVector};

/// The largest number of steps of pseudo-time. A choice: with [`REACH`] a body can turn or move by 40 rad or
/// model lengths, farther than a fall to any balance, and each step costs a matrix.
const STEPS: usize = 200;
/// Least σ as a share of the largest stiffness. At an exact balance without stiffness along a move both parts
/// of σ vanish and the matrix would have no inverse. A choice above rounding. At each step it leaves the part
/// σ/κ of a move of the stiffness κ.
const LEAST: f64 = 1e-10;
/// An eigenvalue of the stiffness below this share of the largest is a rounding error. A choice some decades
/// above the rounding of a decomposition, because the stiffness itself is a sum in which larger loads cancel.
const ROUNDING: f64 = 1e-10;

/// Stiffness of the free moves.
pub(super) struct FreeStiffness {
    /// Mass-normalised, freedoms × freedoms (1/s²).
    pub stiffness: DMatrix<f64>,
    /// Moves in scaled velocities, velocities × freedoms.
    pub moves: DMatrix<f64>,
}

impl Balance<'_> {
    /// Whether the balance is one at rest.
    pub(super) fn rests(&self) -> bool {
        self.velocity.iter().all(|v| *v == 0.0)
    }

    /// The stiffness along the columns of `free` (scaled velocities), from the matrix at the position of the
    /// last residual.
    pub(super) fn free_stiffness(
        &self,
        state: &State,
        matrix: &DMatrix<f64>,
        free: &DMatrix<f64>,
    ) -> Result<FreeStiffness, Stop> {
        let model = self.model;
        let n = model.velocities;
        let stiffness = free.transpose() * matrix.view((0, 0), (n, n)) * free * self.unit;
        let mass = free.transpose() * self.motion.mass(model, state) * free;
        // a part without mass or inertia would have no root
        let floor = 1e-12 * mass.diagonal().amax();
        let count = mass.nrows();
        let root = (mass + DMatrix::identity(count, count) * floor)
            .cholesky()
            .and_then(|c| c.l().try_inverse())
            .ok_or_else(|| not_finite(model))?;
        Ok(FreeStiffness {
            stiffness: &root * stiffness * root.transpose(),
            moves: free * root.transpose(),
        })
    }

    /// The stiffness along the moves that neither constraints nor held quantities prevent; `None` without
    /// such moves.
    fn own_stiffness(
        &self,
        state: &State,
        matrix: &DMatrix<f64>,
    ) -> Result<Option<FreeStiffness>, Stop> {
        let n = self.model.velocities;
        let rows = matrix
            .rows(n, matrix.nrows() - n)
            .columns(0, n)
            .into_owned();
        let free = split(&rows).ok_or_else(|| not_finite(self.model))?.free;
        if free.ncols() == 0 {
            return Ok(None);
        }
        self.free_stiffness(state, matrix, &free).map(Some)
    }

    /// The move that leaves a balance at rest, if it is upside down. No held quantity may have an effort.
    pub(super) fn unstable(&mut self, place: &Place) -> Result<Option<Unstable>, Stop> {
        let model = self.model;
        self.residual(place)?;
        let matrix = self.matrix(&place.state)?;
        // held quantities have no effort here, so they become free
        let unheld = model.velocities + model.rows;
        let matrix = matrix.view((0, 0), (unheld, unheld)).into_owned();
        let Some(free) = self.own_stiffness(&place.state, &matrix)? else {
            return Ok(None);
        };
        let values = free.stiffness.complex_eigenvalues();
        let largest = values.iter().fold(0.0_f64, |w, k| w.max(k.norm()));
        let least = values
            .iter()
            .filter(|k| k.im.abs() <= ROUNDING * largest)
            .fold(0.0_f64, |w, k| w.min(k.re));
        let rounding = (ROUNDING * largest).max(NEUTRAL[0] * self.motion_rate * self.motion_rate);
        if least >= -rounding || !least.is_finite() {
            return Ok(None);
        }
        let count = free.stiffness.nrows();
        let shifted = &free.stiffness - DMatrix::identity(count, count) * least;
        let svd = crate::singular::decompose(shifted).ok_or_else(|| not_finite(model))?;
        let right = svd.v_t.ok_or_else(|| not_finite(model))?;
        let weakest = (0..count).fold(0, |best, i| {
            if svd.singular_values[i] < svd.singular_values[best] {
                i
            } else {
                best
            }
        });
        let away = &free.moves * right.row(weakest).transpose();
        let share = |first: usize, width: usize| away.rows(first, width).norm();
        let body = model
            .bodies
            .iter()
            .max_by(|a, b| share(a.velocity, a.width()).total_cmp(&share(b.velocity, b.width())));
        Ok(body.map(|body| Unstable {
            origin: body.origin.clone(),
            time: 1.0 / libm::sqrt(-least),
        }))
    }

    /// Follows the motion at rest from a position to a balance; `false` if it finds none. Moves that
    /// nothing holds at the position (`neutral`) become free.
    pub(super) fn settle(
        &mut self,
        place: &mut Place,
        goal: f64,
        found: &mut Equilibrium,
    ) -> Result<bool, Stop> {
        let model = self.model;
        let n = model.velocities;
        self.freedoms += self.neutral.nrows();
        self.neutral = DMatrix::zeros(0, n);
        place.efforts = DVector::zeros(self.holding.len());
        place.state.multipliers.fill(0.0);
        for _ in 0..STEPS {
            let residual = match self.residual(place) {
                Ok(residual) => residual,
                Err(Stop::Obstacle(_)) => return Ok(false),
                Err(error) => return Err(error),
            };
            let mut matrix = self.matrix(&place.state)?;
            let mass = self.motion.mass(model, &place.state) / self.unit;
            let Some(free) = self.own_stiffness(&place.state, &matrix)? else {
                return Ok(false);
            };
            let load = free.moves.transpose() * residual.rows(0, n) * self.unit;
            let speeding = (&free.moves * load).amax();
            let symmetric = (&free.stiffness + free.stiffness.transpose()) * 0.5;
            let values = symmetric.symmetric_eigenvalues();
            let sigma = speeding / REACH
                + (-2.0 * values.min()).max(0.0)
                + LEAST * values.amax().max(self.motion_rate * self.motion_rate);
            for i in 0..n {
                for j in 0..n {
                    matrix[(i, j)] += sigma * mass[(i, j)];
                }
            }
            let Some(step) = matrix.lu().solve(&(-residual)) else {
                return Ok(false);
            };
            let size = step.rows(0, n).amax();
            if !size.is_finite() {
                return Ok(false);
            }
            found.iterations += 1;
            let factor = self.advance(place, &step, size);
            self.follow_turns(place)?;
            if factor == 1.0 && size <= goal {
                return Ok(true);
            }
        }
        Ok(false)
    }
}
