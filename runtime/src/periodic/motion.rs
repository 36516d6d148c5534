//! The distance of the motion itself from repetition: its positions, velocities and states of elements.
//!
//! Outputs may be quadratic in the motion, or small differences of large values. So the factor by which
//! deviations shrink is that of the motion. If the motion repeats within the tolerance of its steps,
//! remaining changes of outputs are noise of these steps.

use super::repetition::{Fit, slowest, thinned, within};
use crate::decay::Mode;
use crate::model::Model;
use crate::rotation::turn_between;
use std::borrow::Cow;
use std::collections::VecDeque;

/// Share of a state's size, at the usual tolerance, within which states of two cycles count as equal. It is
/// ten times the error of a step. The factor ten is a choice: that of positions, whose error of a step is a
/// tenth of the tolerance.
const STATE_TOLERANCE: f64 = 1e-4;
/// Cycles over which the distance of the motion is compared. A choice: over eight cycles a slow approach goes
/// eight times as far as over one, and noise of the steps does not.
const LONG: usize = 8;

/// Indices of a body's numbers in a sample's pose and velocities.
#[derive(Clone, Copy, Debug)]
struct Place {
    pose: usize,
    /// First of its velocities.
    velocity: usize,
    modes: usize,
}

/// Comparison of a cycle's motion with the one before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// Factor and turn of deviations from cycle to cycle; from the third cycle on.
    pub mode: Option<Mode>,
    /// The fit with this mode.
    pub fit: Option<Fit>,
    /// The factor that the last difference shows by itself.
    pub within: Option<f64>,
    /// Whether three differences are known. Two show no turn.
    pub turns: bool,
    /// Largest difference of positions, and of states in the mean of the cycle, in units of the error that the
    /// tolerance of the steps leaves.
    pub beyond: f64,
    /// The same difference from the cycle eight cycles before, once it exists. A motion that approaches its
    /// limit slowly is far from that cycle, and noise of the steps is not.
    pub beyond_long: Option<f64>,
}

impl Moved {
    /// Whether the motion repeats within the tolerance of its steps: now, and in its limit. If the last
    /// difference follows from the earlier ones, their factor leads to the limit. Otherwise the factor is
    /// random, and the motion must also equal that of an early cycle.
    pub fn repeats(&self, noise: f64) -> bool {
        let Some(mode) = self.mode.filter(|_| self.beyond <= 1.0) else {
            return false;
        };
        self.beyond * mode.reach() <= 1.0
            || (mode.unpredicted > noise && self.beyond_long.is_some_and(|beyond| beyond <= 1.0))
    }
}

/// Positions and states of a cycle's samples.
#[derive(Clone, Debug, Default)]
struct Cycle {
    poses: Vec<f64>,
    states: Vec<f64>,
}

/// Compares the motion of cycles.
#[derive(Clone, Debug)]
pub struct Motion {
    places: Vec<Place>,
    /// Units of velocities (m/s and rad/s, by the model's speed) and of states.
    units: Vec<f64>,
    velocities: usize,
    /// Error of positions that the tolerance leaves (m), and the model's length (m), which converts it to an
    /// angle.
    tolerance: f64,
    length: f64,
    /// Share of a state's size that is the error which the tolerance leaves, and the least size of each state.
    share: f64,
    states: Vec<f64>,
    /// The last cycles, the newest first.
    cycles: VecDeque<Cycle>,
    /// Velocities and states of the last cycle.
    before: Vec<f64>,
    /// Differences of velocities and states from cycle to cycle, in their units, the newest first.
    differences: VecDeque<Vec<f64>>,
}

impl Motion {
    /// A comparison for a model whose steps have a factor on the tolerances. Errors of the motion are
    /// proportional to the factor to the power 2/3.
    pub fn new(model: &Model, factor: f64) -> Motion {
        let share = libm::cbrt(factor * factor);
        let mut units = model.velocity_scales();
        units.extend(&model.state_scales);
        Motion {
            places: model
                .bodies
                .iter()
                .map(|body| Place {
                    pose: body.pose,
                    velocity: body.velocity,
                    modes: body.modes(),
                })
                .collect(),
            units,
            velocities: model.velocities,
            tolerance: model.tolerance * share,
            length: model.length,
            share: STATE_TOLERANCE * share,
            ..Motion::of_states(&model.state_scales)
        }
    }

    /// A comparison of states alone, whose least sizes are given.
    pub fn of_states(scales: &[f64]) -> Motion {
        Motion {
            places: Vec::new(),
            units: scales.to_vec(),
            velocities: 0,
            tolerance: 1.0,
            length: 1.0,
            share: STATE_TOLERANCE,
            states: scales.to_vec(),
            cycles: VecDeque::new(),
            before: Vec::new(),
            differences: VecDeque::new(),
        }
    }

    /// Forgets all cycles: the next one does not continue them.
    pub fn forget(&mut self) {
        self.cycles.clear();
        self.before.clear();
        self.differences.clear();
    }

    /// Compares the next cycle: poses of its samples one after the other, and for each sample velocities
    /// followed by states.
    pub fn next(&mut self, poses: &[f64], motion: &[f64]) -> Moved {
        let width = self.units.len().max(1);
        let samples = motion.chunks(width);
        let cycle = Cycle {
            poses: poses.to_vec(),
            states: samples
                .flat_map(|sample| &sample[self.velocities..])
                .copied()
                .collect(),
        };
        let old = std::mem::replace(&mut self.before, motion.to_vec());
        let count = self.states.len();
        let from = |age: usize| {
            let before = self.cycles.get(age - 1)?;
            let alike = Cycle {
                poses: thinned(&cycle.poses, self.pose_width(), before.poses.len())?.into_owned(),
                states: thinned(&cycle.states, count, before.states.len())
                    .map_or_else(Vec::new, Cow::into_owned),
            };
            Some(self.beyond(&alike, before))
        };
        let (beyond, beyond_long) = (from(1), from(LONG));
        self.cycles.push_front(cycle);
        self.cycles.truncate(LONG);
        let known = beyond.zip(thinned(motion, width, old.len()));
        let Some((beyond, motion)) = known else {
            return Moved::default();
        };
        let difference = motion
            .iter()
            .zip(&old)
            .enumerate()
            .map(|(i, (now, before))| (now - before) / self.units[i % width])
            .collect();
        self.differences.push_front(difference);
        self.differences.truncate(3);
        let of_age = |age: usize| self.differences.get(age).map_or(&[][..], |d| d);
        let fit = slowest([of_age(0), of_age(1), of_age(2)], width);
        Moved {
            mode: fit.map(|fit| fit.mode),
            fit,
            within: within(of_age(0), width),
            turns: self.differences.len() > 2,
            beyond,
            beyond_long,
        }
    }

    /// The error of positions that the tolerance leaves, as a share of the smallest clearance. The position tolerance is a
    /// thousandth of this clearance.
    pub fn share_of_clearance(&self) -> f64 {
        1e-3 * self.share / STATE_TOLERANCE
    }

    /// Pose numbers of a sample.
    fn pose_width(&self) -> usize {
        self.places.last().map_or(1, |p| p.pose + 7 + p.modes)
    }

    /// Largest difference of positions and states of two cycles, in units of the error that the tolerance
    /// leaves. The size of a state is its largest value in both cycles, as in the control of steps. Its difference is
    /// the root of the mean square over the cycle: an error of a step moves an impact in time, and then the speed of a
    /// valve's plate differs much at the few samples beside it.
    fn beyond(&self, now: &Cycle, before: &Cycle) -> f64 {
        let pose_width = self.pose_width();
        let mut worst = 0.0_f64;
        let poses = now.poses.chunks(pose_width);
        for (now, before) in poses.zip(before.poses.chunks(pose_width)) {
            for place in &self.places {
                let p = place.pose;
                for i in p..p + 3 {
                    worst = worst.max((now[i] - before[i]).abs());
                }
                let turn = turn_between(&before[p + 3..p + 7], &now[p + 3..p + 7]).norm();
                worst = worst.max(self.length * turn);
                for i in 0..place.modes {
                    let unit = self.units[place.velocity + 6 + i] / self.length;
                    worst = worst.max((now[p + 7 + i] - before[p + 7 + i]).abs() / unit);
                }
            }
        }
        let mut beyond = worst / self.tolerance;
        let count = self.states.len().max(1);
        for (state, scale) in self.states.iter().enumerate() {
            let [mut size, mut squares, mut samples] = [*scale, 0.0_f64, 0.0_f64];
            let pairs = now.states.chunks(count).zip(before.states.chunks(count));
            for (now, before) in pairs {
                size = size.max(now[state].abs()).max(before[state].abs());
                let far = now[state] - before[state];
                squares += far * far;
                samples += 1.0;
            }
            let far = libm::sqrt(squares / samples.max(1.0));
            beyond = beyond.max(far / (self.share * size));
        }
        beyond
    }
}
