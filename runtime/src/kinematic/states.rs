//! States of elements along a prescribed motion, such as the pressure of a gas.
//!
//! The motion is known, so the states obey `ṡ = f(s, t)`. The classical Runge–Kutta method of fourth order takes a
//! step once as a whole and once in two halves. The difference estimates the error, and the halves with this
//! difference extrapolated are the result. Steps whose error is too large are halved. Positions within a step are
//! those of [`Piece`]. So the motion of a cycle is computed once, however many cycles the states need to repeat.

use super::mechanism::{Mechanism, States};
use super::piece::Piece;
use crate::error::RuntimeError;
use crate::integrator::STATE_SHARE;
use crate::state::State;

/// Error of a step as a share of a state's scale. A choice: the errors of thousands of steps add up to less
/// than 1e-4 of a state.
const ERROR: f64 = 1e-8;
/// A shortest step as a share of a piece of the motion. A piece turns a body by 0.05 rad at most, so such a step turns
/// it by 1.2e-5 rad.
const SHORTEST: f64 = 1.0 / 4096.0;
/// Turn (rad) of the motion within which a state may not decay: that of a shortest step, rounded.
const FASTEST: f64 = 1e-5;
/// Change of a state until the cycles repeat, as a share of its scale, at which it repeats. A choice: a
/// hundred times the error of a step.
const REPEATS: f64 = 1e-6;
/// Largest change of a state over whole cycles of the samples, as a share of its scale. A choice: ten times the error
/// of a step over a jump. A state that reads the time or an unwrapped angle changes by more.
const KEPT: f64 = 1e-4;
/// Change over a cycle, as a share of the scale, that is rounding. A choice: some thousand rounding units,
/// for the steps of a cycle.
const ROUNDING: f64 = 1e-12;
/// Most cycles until states repeat. A choice: a state that keeps 70 % of its deviation over a cycle repeats
/// within them.
const CYCLES: usize = 40;

impl Mechanism {
    /// Whether elements that act have states.
    pub fn has_states(&self) -> bool {
        !self.model.state_scales.is_empty()
    }

    /// The rates of the states at a place of a piece, a share of its time. In SI per second.
    fn rates_at(
        &mut self,
        piece: &Piece,
        place: f64,
        states: &[f64],
        at: &mut State,
    ) -> Result<Vec<f64>, RuntimeError> {
        piece.place(&self.model, place, at);
        at.states.copy_from_slice(states);
        self.dynamics.set_state(&self.model, at, &[]);
        self.dynamics.evaluate(&self.model)?;
        Ok(self.dynamics.rates().to_vec())
    }

    /// States after a step over the share `part` of a piece from `begin`, with the rates at its beginning. In
    /// SI.
    fn runge_kutta(
        &mut self,
        piece: &Piece,
        [begin, part]: [f64; 2],
        (states, first): (&[f64], &[f64]),
        at: &mut State,
    ) -> Result<Vec<f64>, RuntimeError> {
        let h = part * piece.duration();
        let along = |rates: &[f64], h: f64| -> Vec<f64> {
            states.iter().zip(rates).map(|(s, r)| s + h * r).collect()
        };
        let middle = begin + 0.5 * part;
        let k2 = self.rates_at(piece, middle, &along(first, 0.5 * h), at)?;
        let k3 = self.rates_at(piece, middle, &along(&k2, 0.5 * h), at)?;
        let k4 = self.rates_at(piece, begin + part, &along(&k3, h), at)?;
        let mean: Vec<f64> = (0..states.len())
            .map(|i| (first[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0)
            .collect();
        Ok(along(&mean, h))
    }

    /// States after a step in two halves, and a fifteenth of their difference from those of the whole step.
    fn twice(
        &mut self,
        piece: &Piece,
        [begin, part]: [f64; 2],
        (states, first): (&[f64], &[f64]),
        at: &mut State,
    ) -> Result<(Vec<f64>, Vec<f64>), RuntimeError> {
        let half = 0.5 * part;
        let whole = self.runge_kutta(piece, [begin, part], (states, first), at)?;
        let middle = self.runge_kutta(piece, [begin, half], (states, first), at)?;
        let second = self.rates_at(piece, begin + half, &middle, at)?;
        let fine = self.runge_kutta(piece, [begin + half, half], (&middle, &second), at)?;
        let off = fine
            .iter()
            .zip(&whole)
            .map(|(f, w)| (f - w) / 15.0)
            .collect();
        Ok((fine, off))
    }

    /// Takes the states over a piece of the motion. Returns whether the error of every step is small enough.
    pub(super) fn follow_states(
        &mut self,
        piece: &Piece,
        states: &mut [f64],
    ) -> Result<bool, RuntimeError> {
        let mut at = piece.from.clone();
        let (mut begin, mut part) = (0.0, 1.0_f64);
        let mut first = self.rates_at(piece, begin, states, &mut at)?;
        while begin < 1.0 {
            // all places are whole multiples of the shortest step, so the sums have no rounding
            part = part.min(1.0 - begin);
            let half = 0.5 * part;
            let tried = self.twice(piece, [begin, part], (states, &first), &mut at);
            let (fine, off) = match tried {
                Ok(tried) => tried,
                // a trial may leave the range of the law, such as a pressure below zero
                Err(RuntimeError::NotFinite { .. }) if part > SHORTEST => {
                    part = half;
                    continue;
                }
                Err(error) => return Err(error),
            };
            let scaled = off.iter().zip(&self.model.state_scales);
            let error = scaled.fold(0.0, |most: f64, (off, scale)| {
                // a step with no number is no good step
                let error = (off / scale).abs();
                if error.is_nan() {
                    f64::INFINITY
                } else {
                    most.max(error)
                }
            });
            // in a shortest step the rate of a state may jump, as at the opening of a valve
            let shortest = part <= SHORTEST;
            if error > if shortest { STATE_SHARE } else { ERROR } {
                if shortest {
                    return Ok(false);
                }
                part = half;
                continue;
            }
            for (state, (fine, off)) in states.iter_mut().zip(fine.iter().zip(&off)) {
                *state = fine + off;
            }
            begin += part;
            part *= 2.0;
            if begin < 1.0 {
                first = self.rates_at(piece, begin, states, &mut at)?;
            }
        }
        Ok(true)
    }

    /// Refuses states that differ from those of the first sample after whole cycles.
    pub(super) fn require_kept(&self, first: &[f64], states: &[f64]) -> Result<(), RuntimeError> {
        if self.changed(first, states) <= KEPT {
            return Ok(());
        }
        Err(self.refused_state(
            [first, states],
            "differs from that of the first sample after whole cycles: its rate reads the time or an unwrapped angle, or has a pulse that is shorter than 0.7° of the motion",
        ))
    }

    /// The error for the state that changes most between two lists of states, for a reason.
    fn refused_state(&self, [from, to]: [&[f64]; 2], reason: &str) -> RuntimeError {
        let changes = self.changes(from, to);
        let most = (0..changes.len()).max_by(|i, k| changes[*i].total_cmp(&changes[*k]));
        let named = most.and_then(|state| self.model.state_named(state));
        let origin = named.map(|(element, _)| super::origin_of(&self.model, element));
        let (path, name) = match (&origin, named) {
            (Some(origin), Some((_, name))) => (origin.path.as_str(), name),
            _ => ("an element", ""),
        };
        self.refused(
            origin.clone(),
            format!("{path}: its state `{name}` {reason}"),
            "state the range as a time: then states begin with the values of the text; or run a `transient`",
        )
    }

    /// The largest change between two lists of states, as a share of their scales.
    fn changed(&self, from: &[f64], to: &[f64]) -> f64 {
        let changes = self.changes(from, to);
        changes.into_iter().fold(0.0, f64::max)
    }

    /// The change of each state, as a share of its scale.
    fn changes(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        let scales = self.model.state_scales.iter();
        let both = from.iter().zip(to).zip(scales);
        both.map(|((a, b), scale)| ((b - a) / scale).abs())
            .collect()
    }
}

impl super::Prepared {
    /// The period over whose whole multiples the states of elements repeat: that of the cycle, for samples by angle.
    pub(super) fn repeating(&self) -> Option<f64> {
        match self.grid {
            super::Grid::Angle(_) if self.mechanism.has_states() => self.mechanism.period(),
            _ => None,
        }
    }

    /// Gives the start the states with which the cycle repeats, and lets states follow the motion from then on.
    pub(super) fn begin_with_states(&mut self) -> Result<(), RuntimeError> {
        if let Some(period) = self.repeating() {
            let mut state = self.begin()?;
            self.mechanism.states = States::Traced(vec![state.clone()]);
            self.follow_to(&mut state, period)?;
            let traced = std::mem::replace(&mut self.mechanism.states, States::Followed);
            if let States::Traced(nodes) = traced {
                self.repeat_states(&nodes)?;
            }
            // the first cycle has been repeated; a rate that reads the time differs in the second one
            state.states.clone_from(&self.start.states);
            self.follow_to(&mut state, 2.0 * period)?;
            self.mechanism
                .require_kept(&self.start.states, &state.states)?;
        }
        self.mechanism.states = States::Followed;
        Ok(())
    }

    /// Gives the start the states with which the cycle between these states of the motion repeats.
    fn repeat_states(&mut self, nodes: &[State]) -> Result<(), RuntimeError> {
        let pieces: Vec<Piece> = (nodes.windows(2))
            .map(|ends| Piece::between(&self.mechanism.model, &ends[0], &ends[1]))
            .collect();
        let mut before: Option<f64> = None;
        let mut previous = self.start.states.clone();
        for _ in 0..CYCLES {
            let mut states = self.start.states.clone();
            for piece in &pieces {
                if !self.mechanism.follow_states(piece, &mut states)? {
                    return Err(self.mechanism.stuck(piece.from)?);
                }
            }
            let changed = self.mechanism.changed(&self.start.states, &states);
            previous = std::mem::replace(&mut self.start.states, states);
            // changes that fall by a factor a cycle still sum to changed/(1 - factor), which is large for a
            // slow state
            let factor = before.map(|before| changed / before);
            let rest = factor.map(|factor| changed / (1.0 - factor));
            if changed <= ROUNDING || rest.is_some_and(|rest| (0.0..=REPEATS).contains(&rest)) {
                return Ok(());
            }
            before = Some(changed);
        }
        Err(self.mechanism.refused_state(
            [&previous, &self.start.states],
            &format!("does not repeat in {CYCLES} cycles of this motion: it decays too slowly, or within {FASTEST} rad of the motion"),
        ))
    }
}
