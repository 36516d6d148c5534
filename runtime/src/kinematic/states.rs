//! States of elements along a prescribed motion, such as the pressure of a gas.
//!
//! The motion is known, so the states obey `ṡ = f(s, t)`. A step has positions at its quarters. The classical
//! Runge–Kutta method of fourth order takes it once as a whole and once in two halves. The difference
//! estimates the error, and the halves with this difference extrapolated are the result. Steps whose error is
//! too large are halved.

use super::mechanism::Mechanism;
use crate::error::RuntimeError;
use crate::state::State;
use eng_system::dense::largest_difference;

/// Error of a step as a share of a state's scale. A choice: the errors of thousands of steps add up to less
/// than 1e-4 of a state.
const ERROR: f64 = 1e-8;
/// The same for a shortest step, in which the rate of a state may jump: the opening of a valve. A choice:
/// that of [`crate::integrator::STATE_SHARE`].
const JUMP_ERROR: f64 = 1e-5;
/// Change of a state until the cycles repeat, as a share of its scale, at which it repeats. A choice: a
/// hundred times the error of a step.
const REPEATS: f64 = 1e-6;
/// Change over a cycle, as a share of the scale, that is rounding. A choice: some thousand rounding units,
/// for the steps of a cycle.
const ROUNDING: f64 = 1e-12;
/// Most cycles until states repeat. A choice: changes are extrapolated, so slow states need no more cycles
/// than quick ones.
const CYCLES: usize = 40;

impl Mechanism {
    /// Whether elements that act have states.
    pub fn has_states(&self) -> bool {
        self.element_with_state().is_some()
    }

    fn element_with_state(&self) -> Option<usize> {
        let model = &self.model;
        (0..model.elements.len())
            .find(|e| model.elements[*e].dynamic && model.class(*e).layout.states > 0)
    }

    /// The rates of the states at a position. In SI per second.
    fn rates_at(&mut self, place: &State, states: &[f64]) -> Result<Vec<f64>, RuntimeError> {
        let mut at = place.clone();
        at.states.copy_from_slice(states);
        self.dynamics.set_state(&self.model, &at, &[]);
        self.dynamics.evaluate(&self.model)?;
        Ok(self.dynamics.rates().to_vec())
    }

    /// States after a step between two positions, with one in the middle. In SI; the classical method of
    /// fourth order.
    fn runge_kutta(
        &mut self,
        [first, middle, last]: [&State; 3],
        states: &[f64],
    ) -> Result<Vec<f64>, RuntimeError> {
        let h = last.time - first.time;
        let along = |rates: &[f64], h: f64| -> Vec<f64> {
            states.iter().zip(rates).map(|(s, r)| s + h * r).collect()
        };
        let k1 = self.rates_at(first, states)?;
        let k2 = self.rates_at(middle, &along(&k1, 0.5 * h))?;
        let k3 = self.rates_at(middle, &along(&k2, 0.5 * h))?;
        let k4 = self.rates_at(last, &along(&k3, h))?;
        let mean: Vec<f64> = (0..states.len())
            .map(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0)
            .collect();
        Ok(along(&mean, h))
    }

    /// Takes the states over a step through five positions a quarter apart, and writes them to the last.
    /// Returns whether the error is small enough; `last` is a shortest step.
    pub(super) fn follow_states(
        &mut self,
        quarters: &[State; 3],
        from: &State,
        to: &mut State,
        last: bool,
    ) -> Result<bool, RuntimeError> {
        let [a, b, c] = quarters;
        let whole = self.runge_kutta([from, b, to], &from.states)?;
        let half = self.runge_kutta([from, a, b], &from.states)?;
        let fine = self.runge_kutta([b, c, to], &half)?;
        let mut error = 0.0_f64;
        for i in 0..fine.len() {
            let off = (fine[i] - whole[i]) / 15.0;
            to.states[i] = fine[i] + off;
            error = error.max((off / self.model.state_scales[i]).abs());
        }
        // a step with no number is no good step
        Ok(error <= if last { JUMP_ERROR } else { ERROR })
    }

    /// Refuses states that do not repeat.
    pub(super) fn not_repeating(&self) -> RuntimeError {
        let element = self.element_with_state();
        let origin = element.map(|element| super::origin_of(&self.model, element));
        let path = origin.as_ref().map_or("an element", |origin| &origin.path);
        self.refused(
            origin.clone(),
            format!("{path}: its state does not repeat in {CYCLES} cycles of this motion"),
            "state the range as a time: then states begin with the values of the text; or run a `transient`",
        )
    }

    /// The largest change between two lists of states, as a share of their scales.
    fn changed(&self, a: &[f64], b: &[f64]) -> f64 {
        let scaled = |states: &[f64]| -> Vec<f64> {
            let scales = self.model.state_scales.iter();
            states
                .iter()
                .zip(scales)
                .map(|(s, scale)| s / scale)
                .collect()
        };
        largest_difference(&scaled(a), &scaled(b))
    }
}

impl super::Prepared {
    /// Gives the start the states with which the cycle repeats.
    pub(super) fn repeat_states(&mut self) -> Result<(), RuntimeError> {
        let period = match (self.grid, self.mechanism.period()) {
            (super::Grid::Angle(_), Some(period)) => period,
            _ => return Ok(()),
        };
        let mut before: Option<f64> = None;
        for _ in 0..CYCLES {
            let mut state = self.begin()?;
            self.follow_to(&mut state, period)?;
            let changed = self.mechanism.changed(&state.states, &self.start.states);
            self.start.states = state.states;
            // changes that fall by a factor a cycle still sum to changed/(1 - factor), which is large for a
            // slow state
            let factor = before.map(|before| changed / before);
            let rest = factor.map(|factor| changed / (1.0 - factor));
            if changed <= ROUNDING || rest.is_some_and(|rest| (0.0..=REPEATS).contains(&rest)) {
                return Ok(());
            }
            before = Some(changed);
        }
        Err(self.mechanism.not_repeating())
    }
}
