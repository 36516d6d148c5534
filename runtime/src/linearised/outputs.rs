//! Derivatives of outputs along a small motion about a state.
//!
//! Outputs depend on accelerations and multipliers, which follow from positions, velocities and states of
//! elements by the acceleration-level system. Their derivatives along a direction are central differences of
//! fourth order over this whole computation, `(8 (f(h) − f(−h)) − (f(2h) − f(−2h)))/12h`, with time held.

use crate::acceleration::AccelerationSystem;
use crate::dynamics::Dynamics;
use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::outputs::Outputs;
use crate::state::{State, move_pose};
use eng_system::dense::{add_scaled, largest_scaled};

/// The longest move of a difference, as a share of the model's position tolerance (a thousandth of the
/// smallest clearance). Films are linear over it to 1e-9, and rounding of positions of a metre causes 1e-7.
const REACH: f64 = 1.0 / 32.0;

/// Rate of the fastest motion (rad/s) with the full move. A faster motion has a smaller move, so that its
/// velocities remain small against those of a film. A choice: 4 kHz, above the modes that outputs are read
/// for.
const FASTEST: f64 = 25_000.0;

/// Move of a difference along states alone, as a share of their sizes. A choice: differences of fourth order
/// of a smooth law are exact but for rounding, 1e-11.
const STATES: f64 = 1e-5;

/// Steps over which the slopes to both sides are compared, in steps of a difference: up to a quarter of the position
/// tolerance.
const WIDER: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// Ratios of the differences of slopes over neighbouring steps at a kink. A kink that the state misses by
/// half a step gives 1.5, a curved output 2, rounding 0.5. A choice between these.
const ALIKE: std::ops::Range<f64> = 0.8..1.6;
/// Share of the slope up to which both sides agree. A choice: a smaller bend changes a derivative by less
/// than a thousandth.
const BENT: f64 = 1e-3;
/// Number of roundings of an output that count as zero. A choice: outputs are sums of larger numbers.
const ROUNDINGS: f64 = 1e3;

/// A direction of motion, as the runtime's increments.
#[derive(Clone, Debug)]
pub(super) struct Direction {
    /// δq: rotations in body axes.
    pub place: Vec<f64>,
    /// δv.
    pub velocity: Vec<f64>,
    /// δz.
    pub states: Vec<f64>,
}

impl Direction {
    /// Multiplies by a factor.
    pub fn scale(&mut self, factor: f64) {
        let numbers = self.place.iter_mut().chain(&mut self.velocity);
        numbers.chain(&mut self.states).for_each(|x| *x *= factor);
    }

    /// Adds a share of another direction.
    pub fn add(&mut self, other: &Direction, share: f64) {
        add_scaled(&mut self.place, share, &other.place);
        add_scaled(&mut self.velocity, share, &other.velocity);
        add_scaled(&mut self.states, share, &other.states);
    }

    /// A state after a step along the direction, with its time, accelerations and multipliers.
    pub fn moved(&self, model: &Model, state: &State, step: f64) -> State {
        let mut moved = state.clone();
        move_pose(model, &state.pose, &self.place, step, &mut moved.pose);
        for (v, d) in moved.velocity.iter_mut().zip(&self.velocity) {
            *v += step * d;
        }
        for (z, d) in moved.states.iter_mut().zip(&self.states) {
            *z += step * d;
        }
        moved
    }
}

/// Differences of the outputs about a state.
#[derive(Debug)]
pub(super) struct Probe<'a> {
    model: &'a Model,
    state: &'a State,
    moment: Moment,
    dynamics: Dynamics,
    system: AccelerationSystem,
    outputs: Outputs,
    scales: Vec<f64>,
}

impl<'a> Probe<'a> {
    /// Room for a model.
    pub fn new(
        model: &'a Model,
        state: &'a State,
        moment: Moment,
    ) -> Result<Probe<'a>, RuntimeError> {
        Ok(Probe {
            dynamics: Dynamics::new(model),
            system: AccelerationSystem::new(model)?,
            outputs: Outputs::all(model)?,
            scales: model.velocity_scales(),
            model,
            state,
            moment,
        })
    }

    fn at(&mut self, direction: &Direction, step: f64) -> Result<Vec<f64>, RuntimeError> {
        let mut moved = direction.moved(self.model, self.state, step);
        self.system
            .accelerations(self.model, &mut self.dynamics, &mut moved, self.moment)?;
        self.outputs.evaluate(self.model, &self.dynamics, &moved)?;
        Ok(self.outputs.values.clone())
    }

    /// Accelerations, rates of states, and all channels (SI) at the state.
    pub fn here(&mut self) -> Result<[Vec<f64>; 3], RuntimeError> {
        let mut state = self.state.clone();
        self.system
            .accelerations(self.model, &mut self.dynamics, &mut state, self.moment)?;
        self.outputs.evaluate(self.model, &self.dynamics, &state)?;
        Ok([state.acceleration, state.rates, self.outputs.values.clone()])
    }

    /// The step of a difference along a direction; `None` if the direction moves nothing.
    fn step(&self, direction: &Direction) -> Option<f64> {
        let sizes: Vec<f64> = self
            .model
            .state_scales
            .iter()
            .zip(&self.state.states)
            .map(|(scale, z)| scale.max(z.abs()))
            .collect();
        let longest = largest_scaled(&direction.place, &self.scales)
            .max(largest_scaled(&direction.velocity, &self.scales) / FASTEST);
        let fallback = largest_scaled(&direction.states, &sizes);
        if longest > 0.0 {
            Some(REACH * self.model.tolerance / (self.model.length * longest))
        } else {
            (fallback > 0.0).then(|| STATES / fallback)
        }
    }

    /// The first of some channels with a kink at the state, along a direction. `here` are the channels at the state.
    ///
    /// The difference of the slopes to both sides, `b(h) = (f(h) + f(−h) − 2 f(0))/h`, is the same over every step h
    /// at a kink, doubles with h for a curved output, and falls with h if it is rounding. So it is compared over steps
    /// of h, 2h, 4h and 8h.
    pub fn bent(
        &mut self,
        direction: &Direction,
        channels: &[usize],
        here: &[f64],
    ) -> Result<Option<usize>, RuntimeError> {
        let Some(step) = self.step(direction) else {
            return Ok(None);
        };
        let mut bends = vec![[0.0; WIDER.len()]; channels.len()];
        let mut slopes = vec![0.0_f64; channels.len()];
        for (i, wider) in WIDER.iter().enumerate() {
            let h = step * wider;
            let sides = [self.at(direction, h)?, self.at(direction, -h)?];
            for (k, channel) in channels.iter().enumerate() {
                let value = |of: &[f64]| of.get(*channel).copied().unwrap_or(0.0);
                let [up, down] = [&sides[0], &sides[1]].map(|side| value(side) - value(here));
                bends[k][i] = (up + down) / h;
                slopes[k] = slopes[k].max(up.abs().max(down.abs()) / h);
                let rounding = ROUNDINGS * f64::EPSILON * value(here).abs() / h;
                if bends[k][i].abs() <= rounding {
                    bends[k][i] = 0.0;
                }
            }
        }
        let stays = |pair: &[f64]| ALIKE.contains(&(pair[1] / pair[0]));
        let bent = bends.iter().zip(&slopes).position(|(bends, slope)| {
            bends.windows(2).all(stays) && bends[0].abs() > BENT * slope
        });
        Ok(bent.and_then(|at| channels.get(at).copied()))
    }

    /// Derivatives of all channels (SI) per unit of the direction.
    pub fn along(&mut self, direction: &Direction) -> Result<Vec<f64>, RuntimeError> {
        let Some(step) = self.step(direction) else {
            return Ok(vec![0.0; self.outputs.values.len()]);
        };
        let near = [self.at(direction, step)?, self.at(direction, -step)?];
        let far = [
            self.at(direction, 2.0 * step)?,
            self.at(direction, -2.0 * step)?,
        ];
        let slope =
            |i: usize| (8.0 * (near[0][i] - near[1][i]) - (far[0][i] - far[1][i])) / (12.0 * step);
        Ok((0..near[0].len()).map(slope).collect())
    }
}
