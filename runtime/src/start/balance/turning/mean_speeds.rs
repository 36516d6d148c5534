//! Parts with a kept mean speed along a motion: stated motions, the cycle's angle, and directions that
//! nothing holds.
//!
//! If a part were held at one of its points, its speed could not swing with the loads of the cycle, and the
//! twist with which a crank carries these loads to its flywheel would be wrong. So each row has an effort
//! `−J (ω_g² φ + 2 ω_g φ̇)`, with the lead φ, the inertia J, and `ω_g` a tenth of the rate of the period. The
//! effort is soft against the orders of the period and critically damped.

use super::super::{Balance, Stop};
use super::NoOrbit;
use crate::start::motion::modal;
use crate::start::picking::{split, unit_rows};
use crate::state::State;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Rate of the efforts, as a share of the rate of the period. A choice: a higher rate would hold the speed
/// against the orders of the period that swing it. A lower one needs more periods until a wrong mean is gone.
const SOFT: f64 = 0.1;
/// Share of a moving row that the constraints leave free, below which they hold it. A choice between the
/// small tilts that a drive leaves, some 1e-4 of a row, and a row that moves freely.
const HELD: f64 = 1e-2;
/// Share of a moving row outside the others, below which it follows from them. The remainder is a small tilt.
/// A choice between such tilts and rows of separate parts, of which most remains.
const DEPENDS: f64 = 0.1;

/// The rows with a kept mean speed, each of length one in scaled velocities, and their present leads.
pub(super) struct MeanSpeeds {
    /// Indices of the moving rows.
    moving: Vec<usize>,
    /// Speeds of the moving rows.
    values: DVector<f64>,
    /// Inertia of each.
    inertia: Vec<f64>,
    /// Lead of each.
    pub ahead: DVector<f64>,
    /// Rate of the lead of each.
    pub faster: DVector<f64>,
    /// Rate of the efforts (1/s).
    soft_frequency: f64,
    /// The rows at the state that was followed last, until it is replaced.
    present: Option<DMatrix<f64>>,
}

/// Scaled velocities (1/s) from velocities (SI).
fn scaled(balance: &Balance, velocity: &[f64]) -> DVector<f64> {
    let scales = balance.motion.scales();
    DVector::from_fn(scales.len(), |i, _| velocity[i] / scales[i])
}

fn no_numbers() -> NoOrbit {
    NoOrbit::Reason("its rows are no numbers".to_owned())
}

impl MeanSpeeds {
    /// The kept rows at a state of the motion, which repeats after a period (s).
    pub fn new(balance: &mut Balance, state: &State, period: f64) -> Result<MeanSpeeds, NoOrbit> {
        let (mut rows, _) = balance.what_moves(state)?;
        // rows have a length of about one in scaled velocities: a shorter one is rounding
        unit_rows(&mut rows, 1e-12);
        // bodies count as rigid here, so that a crank with stated speeds at both ends can twist and tilt
        let shapes = modal(balance.model);
        let bent = balance.motion.free.select_rows(&shapes);
        let rigid = split(&bent).ok_or_else(no_numbers)?;
        let free = &balance.motion.free * rigid.free;
        let mut moving = Vec::new();
        let mut basis: Vec<DVector<f64>> = Vec::new();
        for i in 0..rows.nrows() {
            let own = (rows.row(i) * &free).transpose();
            let mut alone = rows.row(i).into_owned();
            shapes.iter().for_each(|i| alone[*i] = 0.0);
            // a drive holds the row, and only tilts are free
            if own.norm() <= HELD * alone.norm() {
                continue;
            }
            let mut rest = own.clone();
            for known in &basis {
                rest -= known * known.dot(&rest);
            }
            if rest.norm() > DEPENDS * own.norm() {
                basis.push(rest.normalize());
                moving.push(i);
            }
        }
        let count = moving.len() + balance.neutral.nrows();
        let mut mean_speeds = MeanSpeeds {
            moving,
            values: DVector::zeros(0),
            inertia: Vec::new(),
            ahead: DVector::zeros(count),
            faster: DVector::zeros(count),
            soft_frequency: SOFT * TAU / period,
            present: None,
        };
        let rows = mean_speeds.rows(balance, state)?;
        let free = &balance.motion.free;
        let along = &rows * free;
        let mass = free.transpose() * balance.motion.mass(balance.model, state) * free;
        let mass = mass.cholesky().ok_or_else(no_numbers)?;
        mean_speeds.inertia = along
            .row_iter()
            .map(|own| 1.0 / own.transpose().dot(&mass.solve(&own.transpose())))
            .collect();
        // shapes swing and have no mean speed
        let mut velocity = scaled(balance, &state.velocity);
        for i in shapes {
            velocity[i] = 0.0;
        }
        mean_speeds.values = rows * velocity;
        Ok(mean_speeds)
    }

    /// Measures the lead of the cycle's angle from the positions themselves. A sum over the steps would
    /// drift, and a twisting crank has a different angle at each marker.
    pub fn measure_cycle(
        &mut self,
        balance: &mut Balance,
        from: &State,
        here: &State,
    ) -> Result<(), Stop> {
        // the cycle's row is the first moving row
        let cycle = balance.model.compiled.system.cycle.as_ref();
        let (Some(element), Some(0)) = (cycle.map(|c| c.element as usize), self.moving.first())
        else {
            return Ok(());
        };
        let turned = balance.cycle_angle(element, here)? - balance.cycle_angle(element, from)?;
        let row = DVector::from_vec(balance.cycle_rate(element, here)?);
        self.ahead[0] = (turned - TAU * libm::round(turned / TAU)) / row.norm();
        Ok(())
    }

    /// The rows at a position.
    pub fn rows(&self, balance: &mut Balance, state: &State) -> Result<DMatrix<f64>, Stop> {
        let (mut moving, _) = balance.what_moves(state)?;
        // as in [`MeanSpeeds::new`]: a shorter row is rounding
        unit_rows(&mut moving, 1e-12);
        let (count, free) = (self.moving.len(), balance.neutral.nrows());
        let mut rows = DMatrix::zeros(count + free, moving.ncols());
        rows.rows_mut(0, count)
            .copy_from(&moving.select_rows(&self.moving));
        rows.rows_mut(count, free).copy_from(&balance.neutral);
        Ok(rows)
    }

    /// Forgets the rows of the state that was followed last, because another state replaces it.
    pub fn replaced(&mut self) {
        self.present = None;
    }

    /// The loads of the efforts over a step (s) from the state that was followed last, along the scaled
    /// velocities.
    pub fn pull(
        &self,
        balance: &mut Balance,
        state: &State,
        step: f64,
    ) -> Result<DVector<f64>, Stop> {
        let efforts = DVector::from_fn(self.inertia.len(), |k, _| {
            let ahead = self.ahead[k] + step * self.faster[k];
            -self.inertia[k]
                * self.soft_frequency
                * (self.soft_frequency * ahead + 2.0 * self.faster[k])
        });
        match &self.present {
            Some(rows) => Ok(rows.tr_mul(&efforts)),
            None => Ok(self.rows(balance, state)?.tr_mul(&efforts)),
        }
    }

    /// Updates the leads after a step (s) to a state.
    pub fn follow(&mut self, balance: &mut Balance, state: &State, step: f64) -> Result<(), Stop> {
        let rows = self.rows(balance, state)?;
        let faster = &rows * scaled(balance, &state.velocity) - &self.values;
        self.ahead += (&self.faster + &faster) * (0.5 * step);
        self.faster = faster;
        self.present = Some(rows);
        Ok(())
    }
}
