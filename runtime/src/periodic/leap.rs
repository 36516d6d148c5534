//! Leaps towards the motion that repeats.
//!
//! Often one slow motion remains after some cycles, such as that of the drive line on its coupling. Its differences
//! from cycle to cycle follow `d(k) = a d(k−1) + b d(k−2)`, and so do the states x at the ends of the cycles, less
//! their limit: `x∞ = (x(k) − a x(k−1) − b x(k−2))/(1 − a − b)` (minimal polynomial extrapolation; D. A. Smith,
//! W. F. Ford, A. Sidi, SIAM Rev 29 (1987) 199). The analysis continues there. A leap decides nothing about repetition:
//! the cycles before a leap do not count.

use super::repetition::Fit;
use crate::decay::Mode;
use crate::model::Model;
use crate::simulation::Section;
use crate::state::{move_pose, offset};
use std::collections::VecDeque;

/// States that are kept.
const KEPT: usize = 4;
/// Largest factor of a motion that a leap leaves out. A motion that hardly decays may be a limit cycle, whose middle
/// repeats but is not stable.
const SUSTAINED: f64 = 0.95;
/// Largest share of a difference, squared, that does not follow from the earlier ones, if its mode says anything.
const UNPREDICTED: f64 = 0.3;
/// Largest part of the way to the limit that a leap may miss by what its fit leaves.
const MISSED: f64 = 0.1;
/// Number of cycles above which a leap saves some: three cycles must follow it, and one would follow anyway.
const SAVED: f64 = 2.5;
/// Largest part of a cycle by which a leap changes the time.
const MOMENT: f64 = 0.25;

/// Whether a mode is that of a motion that decays, and not noise.
pub fn is_known(mode: Mode) -> bool {
    mode.factor < SUSTAINED && mode.unpredicted <= UNPREDICTED
}

/// Whether a mode may be left out, of which the last cycle differs by `far` times the permitted difference.
pub fn saves(mode: Mode, far: f64) -> bool {
    is_known(mode) && mode.cycles(far) > SAVED
}

/// The states at the ends of the last cycles, the newest first.
#[derive(Clone, Debug, Default)]
pub struct Leaps {
    sections: VecDeque<Section>,
}

impl Leaps {
    /// Adds the state at the end of a cycle.
    pub fn push(&mut self, section: Section) {
        self.sections.push_front(section);
        self.sections.truncate(KEPT);
    }

    /// Forgets all states: the next one does not continue them.
    pub fn forget(&mut self) {
        self.sections.clear();
    }

    /// The limit to which a fit leads, at the end of the last cycle. `None` if the fit would miss it.
    ///
    /// The cycle's angle is equal in all states, and their times are those at which the machine reached it. So the time
    /// of the limit differs from that of the last state, and drives that turn with the time have their place at it.
    pub fn next(&self, model: &Model, fit: &Fit) -> Option<Section> {
        let [a, b] = fit.recurrence;
        let whole = 1.0 - a - b;
        let left = libm::sqrt(fit.mode.unpredicted) / whole.abs();
        let close = left <= MISSED * fit.mode.reach();
        let weights = [1.0 / whole, -a / whole, -b / whole];
        let count = if b == 0.0 { 2 } else { 3 };
        if !close || self.sections.len() <= count || weights.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let last = self.sections.front()?;
        let time_of = |age: usize| self.sections.get(age).map_or(last.time, |s| s.time);
        let weighted = weights[..count].iter().enumerate();
        let cycle: f64 = weighted
            .clone()
            .map(|(age, weight)| weight * (time_of(age) - time_of(age + 1)))
            .sum();
        let mut next = last.clone();
        next.time += weighted
            .map(|(age, weight)| weight * (time_of(age) + age as f64 * cycle - last.time))
            .sum::<f64>();
        if (next.time - last.time).abs() > MOMENT * cycle {
            return None;
        }
        let mut moves = vec![0.0; model.velocities];
        for (section, weight) in self.sections.iter().zip(&weights[..count]) {
            let offsets = offset(model, &last.pose, &section.pose);
            for (x, off) in moves.iter_mut().zip(&offsets) {
                *x += weight * off;
            }
            let there = section.velocity.iter().chain(&section.states);
            let here = last.velocity.iter().chain(&last.states);
            let of_next = next.velocity.iter_mut().chain(&mut next.states);
            for (x, (there, here)) in of_next.zip(there.zip(here)) {
                *x += weight * (there - here);
            }
        }
        move_pose(model, &last.pose, &moves, 1.0, &mut next.pose);
        Some(next)
    }
}
