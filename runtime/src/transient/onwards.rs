//! A run by cycles that goes on behind its last sample.

use super::Points;
use super::renewal::Renewal;
use crate::error::RuntimeError;
use crate::simulation::Simulation;

/// A motion from the end of a cycle on. Its steps repeat with the cycle, as those of the run before.
pub(crate) struct Onwards {
    pub(crate) simulation: Simulation,
    renewal: Renewal,
    points: Points,
    /// Longest distance of a step (rad).
    longest: f64,
    /// Index of the next sample in the cycle, from 1 on.
    next: u64,
}

impl Onwards {
    /// From a simulation behind the end of a cycle on. `distance` (rad) of the samples has the sign of the machine's sense of
    /// rotation.
    pub(super) fn new(
        simulation: Simulation,
        renewal: Renewal,
        distance: f64,
        longest: f64,
    ) -> Onwards {
        let start = renewal.begin();
        Onwards {
            simulation,
            renewal,
            points: Points::Angle { start, distance },
            longest,
            next: 1,
        }
    }

    /// Takes a step. Returns its length (s).
    pub(crate) fn step(&mut self) -> Result<f64, RuntimeError> {
        let end = self.renewal.end(&self.simulation);
        let longest = self.points.longest_step(self.longest, &self.simulation);
        Ok(self.simulation.step_no_longer(end, longest)?.step)
    }

    /// Ends a step, after its derivatives are carried on: at the end of a cycle the sequence of steps starts again.
    pub(crate) fn stepped(&mut self, step: f64) {
        self.renewal.after(&mut self.simulation, step);
    }

    /// The index and the angle (rad) of the next sample, if the last step passed it.
    pub(crate) fn passed(&mut self) -> Option<(u64, f64)> {
        if self.points.passed(self.next, &self.simulation) < 0.0 {
            return None;
        }
        self.next += 1;
        Some((self.next - 1, self.points.at(self.next - 1)))
    }

    /// The next sample is the first one behind another one, at an angle (rad).
    pub(crate) fn begin_cycle(&mut self, angle: f64) {
        let distance = self.points.distance();
        self.points = Points::Angle {
            start: angle,
            distance,
        };
        self.next = 1;
    }
}
