//! Steps along a prescribed motion, from one position to the next.

use super::mechanism::Mechanism;
use crate::assembly::lock;
use crate::error::RuntimeError;
use crate::state::{State, move_pose};
use eng_system::dense::largest_scaled;

/// Largest turn of a body in one step (rad).
const TURN: f64 = 0.15;
/// Most halvings of a step.
const HALVINGS: u32 = 12;
/// Share of the motion's pace by which velocities may differ from those that the accelerations predict.
const SMOOTH: f64 = 0.1;

impl Mechanism {
    /// Follows the motion to a time (s).
    pub fn advance(&mut self, state: &mut State, time: f64) -> Result<(), RuntimeError> {
        let mut halved: u32 = 0;
        while state.time != time {
            let left = time - state.time;
            let pace = self.fastest(state);
            let longest = TURN / pace.max(f64::MIN_POSITIVE);
            let whole = left.clamp(-longest, longest) * libm::exp2(-f64::from(halved));
            let mut next = state.clone();
            next.time = match whole == left {
                true => time,
                false => state.time + whole,
            };
            if self.step(state, &mut next)? {
                *state = next;
                halved = halved.saturating_sub(1);
                continue;
            }
            halved += 1;
            if halved > HALVINGS || state.time + whole == state.time {
                return Err(self.stuck(state)?);
            }
        }
        Ok(())
    }

    /// The state at the time of `next`. Returns whether it continues the motion.
    fn step(&mut self, from: &State, next: &mut State) -> Result<bool, RuntimeError> {
        if !self.follows_states {
            return self.move_to(from, next);
        }
        let h = next.time - from.time;
        let mut quarters = [from.clone(), from.clone(), from.clone()];
        let mut last = from.clone();
        for (quarter, part) in quarters.iter_mut().zip([0.25, 0.5, 0.75]) {
            quarter.time = from.time + part * h;
            if !self.move_to(&last, quarter)? {
                return Ok(false);
            }
            last.clone_from(quarter);
        }
        Ok(self.move_to(&last, next)? && self.follow_states(&quarters, from, next)?)
    }

    /// [`Mechanism::step`] without states.
    fn move_to(&mut self, from: &State, next: &mut State) -> Result<bool, RuntimeError> {
        let h = next.time - from.time;
        let increment: Vec<f64> = (from.velocity.iter().zip(&from.acceleration))
            .map(|(v, a)| v * h + 0.5 * a * h * h)
            .collect();
        next.rotations.copy_from_slice(&from.rotations);
        move_pose(&self.model, &from.pose, &increment, 1.0, &mut next.pose);
        if !self.close(next)? {
            return Ok(false);
        }
        self.unwrap(next)?;
        self.complete(next)?;
        let pace = largest_scaled(&from.velocity, &self.scales)
            .max(largest_scaled(&next.velocity, &self.scales));
        let jump: Vec<f64> = (0..next.velocity.len())
            .map(|i| {
                let mean = 0.5 * (from.acceleration[i] + next.acceleration[i]);
                next.velocity[i] - from.velocity[i] - mean * h
            })
            .collect();
        Ok(largest_scaled(&jump, &self.scales) <= SMOOTH * pace)
    }

    /// The error for a motion that does not go on from a state.
    fn stuck(&mut self, state: &State) -> Result<RuntimeError, RuntimeError> {
        let moment = self.moment(state)?;
        if let Some(locked) = lock::near(&self.model, state, moment)? {
            return Ok(locked);
        }
        Ok(self.refused(
            None,
            format!("the motion does not go on smoothly from {moment}: the mechanism locks, a stated position or speed jumps there, or a state changes too fast"),
            "end the range before it, or let drives start and stop gradually, such as by `step` of `std.math`",
        ))
    }
}
