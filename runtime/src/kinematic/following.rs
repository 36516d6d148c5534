//! Steps along a prescribed motion, from one position to the next.

use super::mechanism::{Mechanism, States};
use super::piece::Piece;
use crate::assembly::lock;
use crate::error::RuntimeError;
use crate::state::{State, move_pose};
use eng_system::dense::largest_scaled;

/// Largest turn of a body in one step (rad). A choice: 8.6°, so that the nearest position to the predicted
/// one is on the same branch of the mechanism.
const TURN: f64 = 0.15;
/// The same if states follow the motion. Positions within the step are interpolated then, those of a harmonic
/// motion with an error of 3e-13 of its amplitude.
const TURN_WITH_STATES: f64 = 0.05;
/// Largest difference, scaled, between the polynomials of third and of fifth degree in the middle of such a
/// step. It is 2e-8 for a harmonic motion of the model's size. An acceleration that jumps inside of the step
/// makes it larger, and then the step is halved.
const INTERPOLATES: f64 = 1e-7;
/// Most halvings of a step. A choice: the shortest step turns a body by 2e-3°, so a lock or a jump is known
/// as exactly.
const HALVINGS: u32 = 12;
/// Share of the motion's rate by which velocities may differ from those that the accelerations predict. A
/// choice: in a smooth motion the difference is of second order in the turn of a step, some per cent. On
/// another branch velocities differ by about as much as they are.
const SMOOTH: f64 = 0.1;
/// The same as a share of the fastest motion so far: rounding of velocities near rest. A choice: far above
/// the rounding unit, and far below the velocities by which two branches differ.
const ROUNDING: f64 = 1e-9;
/// Share of the change of the accelerations over a shortest step by which velocities may differ. Half of the
/// change is due where accelerations jump inside of the step; a velocity that jumps differs by more. The rest
/// above one half is a choice for rounding and curvature.
const JUMPS: f64 = 0.6;

impl Mechanism {
    /// Follows the motion to a time (s).
    pub fn advance(&mut self, state: &mut State, time: f64) -> Result<(), RuntimeError> {
        let mut halved: u32 = 0;
        let turn = match self.states {
            States::Constant => TURN,
            States::Followed | States::Traced(_) => TURN_WITH_STATES,
        };
        let motion_rate = state.fastest_turn(&self.model).max(f64::MIN_POSITIVE);
        let shortest =
            (time - state.time).abs().min(turn / motion_rate) * libm::exp2(-f64::from(HALVINGS));
        while state.time != time {
            let left = time - state.time;
            let motion_rate = state.fastest_turn(&self.model);
            let longest = turn / motion_rate.max(f64::MIN_POSITIVE);
            let halves = left.clamp(-longest, longest) * libm::exp2(-f64::from(halved));
            let whole = halves.abs().max(shortest).min(left.abs()).copysign(left);
            let mut next = state.clone();
            next.time = match state.time + whole {
                // below the rounding of the time
                at if whole == left || at == state.time => time,
                at => at,
            };
            let last = whole.abs() <= shortest;
            if self.step(state, &mut next, last)? {
                *state = next;
                if let States::Traced(states) = &mut self.states {
                    states.push(state.clone());
                }
                halved = halved.saturating_sub(1);
                continue;
            }
            if last {
                return Err(self.stuck(state)?);
            }
            halved += 1;
        }
        Ok(())
    }

    /// The state at the time of `next`. Returns whether it continues the motion. `last` is a shortest step,
    /// in which accelerations and rates of states may jump.
    fn step(&mut self, from: &State, next: &mut State, last: bool) -> Result<bool, RuntimeError> {
        if !self.move_to(from, next, last)? {
            return Ok(false);
        }
        if !matches!(self.states, States::Followed) {
            return Ok(true);
        }
        let mut states = from.states.clone();
        let follows = self.follow_states(&Piece::between(&self.model, from, next), &mut states)?;
        next.states = states;
        Ok(follows)
    }

    /// [`Mechanism::step`] without states.
    fn move_to(
        &mut self,
        from: &State,
        next: &mut State,
        last: bool,
    ) -> Result<bool, RuntimeError> {
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
        let motion_rate = largest_scaled(&from.velocity, &self.scales)
            .max(largest_scaled(&next.velocity, &self.scales));
        self.quickest = self.quickest.max(motion_rate);
        let jump: Vec<f64> = (0..next.velocity.len())
            .map(|i| {
                let mean = 0.5 * (from.acceleration[i] + next.acceleration[i]);
                next.velocity[i] - from.velocity[i] - mean * h
            })
            .collect();
        let mut allowed = SMOOTH * motion_rate;
        if !matches!(self.states, States::Constant) && !last {
            // the polynomials differ by h/32 of the jump
            allowed = allowed.min(32.0 * INTERPOLATES / h.abs());
        }
        allowed += ROUNDING * self.quickest;
        if last {
            let changes = next.acceleration.iter().zip(&from.acceleration);
            let changes: Vec<f64> = changes.map(|(b, a)| (b - a) * h).collect();
            allowed += JUMPS * largest_scaled(&changes, &self.scales);
        }
        Ok(largest_scaled(&jump, &self.scales) <= allowed)
    }

    /// The error for a motion that does not go on from a state.
    pub(super) fn stuck(&mut self, state: &State) -> Result<RuntimeError, RuntimeError> {
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
