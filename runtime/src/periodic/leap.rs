//! Leaps towards the motion that repeats.
//!
//! Often one slow motion remains after some cycles, such as that of the drive line on its coupling. Let c_i be the
//! outputs over cycle i, and x_i the state at its end. The combination of the last cycles with the least
//! `|Σ γ_i (c_i − c_(i−1))|`, `Σ γ_i = 1`, leads to the limit `x = Σ γ_i x_i` (reduced rank extrapolation; D. A. Smith,
//! W. F. Ford, A. Sidi, SIAM Rev 29 (1987) 199). The analysis continues there. A leap decides nothing about
//! repetition: cycles are compared as before, and the cycles before a leap do not count.

use super::repetition::Combination;
use crate::decay::Mode;
use crate::model::Model;
use crate::state::{move_pose, offset};
use std::collections::VecDeque;

/// States that are kept.
const KEPT: usize = 4;
/// Largest factor of a motion that a leap leaves out. A motion that hardly decays may be a limit cycle, whose middle
/// repeats but is not stable.
const SUSTAINED: f64 = 0.95;
/// Largest share of the last cycle's difference that the combination leaves.
const REST: f64 = 0.3;
/// Number of cycles above which a leap saves some. After it two cycles are compared.
const SAVED: f64 = 2.5;

/// A state at the end of a cycle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Poses of all bodies.
    pub pose: Vec<f64>,
    /// Their velocities.
    pub velocity: Vec<f64>,
    /// States of elements (SI).
    pub states: Vec<f64>,
}

/// Largest share of a difference, squared, that does not follow from the earlier ones, if its mode says anything.
const UNPREDICTED: f64 = 0.3;

/// Whether a mode is that of a motion that decays, and not noise.
pub fn is_known(mode: Mode) -> bool {
    mode.factor < SUSTAINED && mode.unpredicted <= UNPREDICTED
}

/// Whether motions may be left out, of which the last cycle differs by `far` times the permitted difference.
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

    /// The state to which a combination of the last cycles leads. `None` if their differences do not cancel.
    pub fn next(&self, model: &Model, combination: &Combination) -> Option<Section> {
        let last = self.sections.front()?;
        if combination.rest > REST || self.sections.len() < combination.weights.len() {
            return None;
        }
        let mut next = last.clone();
        let mut moves = vec![0.0; model.velocities];
        for (section, weight) in self.sections.iter().zip(&combination.weights) {
            let offsets = offset(model, &last.pose, &section.pose);
            for (x, off) in moves.iter_mut().zip(&offsets) {
                *x += weight * off;
            }
            let rates = next
                .velocity
                .iter_mut()
                .zip(section.velocity.iter().zip(&last.velocity));
            let states = next
                .states
                .iter_mut()
                .zip(section.states.iter().zip(&last.states));
            for (x, (there, here)) in rates.chain(states) {
                *x += weight * (there - here);
            }
        }
        move_pose(model, &last.pose, &moves, 1.0, &mut next.pose);
        Some(next)
    }
}
