//! A start at a kink: the motion begins on the side to which it goes.
//!
//! Before its start a motion has no values. So where a load or a required acceleration jumps at the first
//! state, such as after `if time > 0 s`, its value is that just after the start. Outputs of the first state
//! are those of a state just after it, and the first step begins there if the kink is a moment.

use super::Simulation;
use crate::assembly::velocity::{BEHIND, JUMP};
use crate::error::RuntimeError;
use crate::state::State;
use eng_system::dense::largest;
use eng_system::system::StepControl;

/// Longest time to a kink, in the same measure. A slow motion reaches a kink that is a rounding away after a
/// time in which its loads change by themselves, and its first state is no state of that time. The limit is a
/// choice.
const NEAR: f64 = 1e-9;

impl Simulation {
    /// At the start, a kink in time at which the motion begins. Loads may jump there.
    pub(super) fn first_moment(&self) -> Option<usize> {
        match self.options.step {
            StepControl::Tolerance(factor) => {
                let time = self.integrator.current.time;
                let here = self.kinks.here(time, factor);
                here.into_iter().find(|kink| self.kinks.is_moment(*kink))
            }
            _ => None,
        }
    }

    /// The state just after the start, if the motion begins at kinks and accelerations or rates of states jump there.
    pub(super) fn behind_start(&mut self) -> Result<Option<State>, RuntimeError> {
        if self.integrator.statistics.steps > 0 {
            return Ok(None);
        }
        let time = self.integrator.current.time;
        let here = self.kinks.here(time, self.options.step.tolerance());
        if here.is_empty() {
            return Ok(None);
        }
        let base = self.integrator.current.clone();
        let motion_rate = base.motion_rate(&self.model);
        let mut e = 0.0_f64;
        for kink in &here {
            if self.kinks.is_moment(*kink) || motion_rate == 0.0 {
                let [_, behind] = self.kinks.around(*kink, time);
                e = e.max(behind - time);
                continue;
            }
            let to_kink = self.kinks.time_to(*kink);
            if to_kink * motion_rate <= NEAR {
                e = e.max(to_kink + BEHIND / motion_rate);
            }
        }
        if e == 0.0 {
            return Ok(None);
        }
        // a table may end here, or the first step reports the error
        let found = self.ahead(&base, e);
        self.stand()?;
        let Ok(behind) = found else { return Ok(None) };
        let jumps = |a: &[f64], b: &[f64]| differ(a, b, JUMP);
        let found = jumps(&base.acceleration, &behind.acceleration)
            || jumps(&base.rates, &behind.rates)
            || jumps(&base.multipliers, &behind.multipliers);
        Ok(found.then_some(behind))
    }
}

/// Whether numbers of two lists differ by more than a share of the largest one.
pub(super) fn differ(a: &[f64], b: &[f64], share: f64) -> bool {
    let size = largest(a).max(largest(b));
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > share * size)
}
