//! The distance of the motion itself from repetition: its positions, velocities and states of elements.
//!
//! Outputs may be quadratic in the motion, or small differences of large values. So the factor by which
//! deviations shrink is that of the motion. If the motion repeats within the tolerance of its steps,
//! remaining changes of outputs are noise of these steps.

use super::repetition::slowest;
use crate::decay::Mode;
use crate::model::Model;
use std::collections::VecDeque;

/// Share of a state's size, at the usual tolerance, within which states of two cycles count as equal. It is
/// ten times the error of a step.
const STATE_TOLERANCE: f64 = 1e-4;

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
    /// Largest difference of positions and states, in units of the error that the tolerance of the steps
    /// leaves.
    pub beyond: f64,
}

/// Compares the motion of cycles.
#[derive(Clone, Debug)]
pub struct Motion {
    places: Vec<Place>,
    /// Units of velocities (m/s and rad/s, by the model's pace) and of states.
    units: Vec<f64>,
    velocities: usize,
    /// Error of positions that the tolerance leaves (m), and the model's length (m), which converts it to an
    /// angle.
    tolerance: f64,
    length: f64,
    /// Error of states that the tolerance leaves.
    states: Vec<f64>,
    poses: Vec<f64>,
    before: Vec<f64>,
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
            states: model
                .state_scales
                .iter()
                .map(|scale| STATE_TOLERANCE * share * scale)
                .collect(),
            poses: Vec::new(),
            before: Vec::new(),
            differences: VecDeque::new(),
        }
    }

    /// Compares the next cycle: poses of its samples one after the other, and for each sample velocities
    /// followed by states.
    pub fn next(&mut self, poses: &[f64], motion: &[f64]) -> Moved {
        let width = self.units.len().max(1);
        let old_poses = std::mem::replace(&mut self.poses, poses.to_vec());
        let old = std::mem::replace(&mut self.before, motion.to_vec());
        if old.len() != motion.len() || old_poses.len() != poses.len() {
            return Moved::default();
        }
        let beyond = self.beyond(poses, &old_poses, motion, &old);
        let difference = motion
            .iter()
            .zip(&old)
            .enumerate()
            .map(|(i, (now, before))| (now - before) / self.units[i % width])
            .collect();
        self.differences.push_front(difference);
        self.differences.truncate(3);
        let of_age = |age: usize| self.differences.get(age).map_or(&[][..], |d| d);
        Moved {
            mode: slowest(of_age(0), of_age(1), of_age(2)),
            beyond,
        }
    }

    /// Largest difference of positions and states, in units of the error that the tolerance leaves.
    fn beyond(&self, poses: &[f64], old_poses: &[f64], motion: &[f64], old: &[f64]) -> f64 {
        let pose_width = self.places.last().map_or(1, |p| p.pose + 7 + p.modes);
        let mut worst = 0.0_f64;
        for (now, before) in poses.chunks(pose_width).zip(old_poses.chunks(pose_width)) {
            for place in &self.places {
                let p = place.pose;
                for i in p..p + 3 {
                    worst = worst.max((now[i] - before[i]).abs());
                }
                let turn = turned(&before[p + 3..p + 7], &now[p + 3..p + 7]);
                worst = worst.max(self.length * turn);
                for i in 0..place.modes {
                    let unit = self.units[place.velocity + 6 + i] / self.length;
                    worst = worst.max((now[p + 7 + i] - before[p + 7 + i]).abs() / unit);
                }
            }
        }
        let mut beyond = worst / self.tolerance;
        let width = self.units.len().max(1);
        for (now, before) in motion.chunks(width).zip(old.chunks(width)) {
            let states = now[self.velocities..]
                .iter()
                .zip(&before[self.velocities..]);
            for ((now, before), left) in states.zip(&self.states) {
                beyond = beyond.max((now - before).abs() / left);
            }
        }
        beyond
    }
}

/// Angle (rad) between two orientations, as unit quaternions of either sign. It is twice the length of the
/// vector part of `conj(a) b`, which is accurate for small angles too.
fn turned(a: &[f64], b: &[f64]) -> f64 {
    let cross = [
        a[2] * b[3] - a[3] * b[2],
        a[3] * b[1] - a[1] * b[3],
        a[1] * b[2] - a[2] * b[1],
    ];
    let square: f64 = (0..3)
        .map(|i| {
            let x = a[0] * b[i + 1] - b[0] * a[i + 1] - cross[i];
            x * x
        })
        .sum();
    2.0 * libm::asin(libm::sqrt(square).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_turns_keep_their_digits_and_signs_of_quaternions_do_not_count() {
        let of = |angle: f64| [libm::cos(0.5 * angle), 0.0, 0.0, libm::sin(0.5 * angle)];
        for turn in [1e-12, 1e-5, 0.7, 3.0] {
            let (a, b) = (of(0.4), of(0.4 + turn));
            assert!((turned(&a, &b) / turn - 1.0).abs() < 1e-3, "{turn}");
            assert!((turned(&a, &b.map(|x| -x)) / turn - 1.0).abs() < 1e-3);
        }
    }
}
