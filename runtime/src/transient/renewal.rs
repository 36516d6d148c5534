//! Steps that repeat with the cycle.

use crate::simulation::Simulation;

/// The points at which the sequence of steps starts again.
///
/// A change of the step excites motions that the steps do not resolve. So the last steps of a cycle are made
/// equal, and a few per cent shorter than the control chooses. A cycle begins with the step that the first
/// cycles reached at their beginning.
pub(super) struct Renewal {
    start: f64,
    /// The period, with the sign of the machine's sense of rotation.
    period: f64,
    cycles: u64,
    /// Number of equal steps left before the end of the cycle.
    left: Option<f64>,
    /// First step of a cycle (s), and whether it stays.
    first_step: f64,
    settled: bool,
}

impl Renewal {
    /// Part of a step within which the end of a cycle counts as met. Steps meet it to second order, and a
    /// very short extra step would amplify rounding. A choice: a larger part would end cycles too early, and
    /// a much smaller one is as small as the error with which steps meet the end.
    const MET: f64 = 0.05;
    /// Number of steps before the end of a cycle that are made equal. A choice: no step is shortened by more
    /// than a thirty-second part.
    const EQUAL: f64 = 32.0;
    /// Number of cycles that determine the first step. A choice: the first cycle contains the start, and
    /// later ones have steps like those of the cycle before.
    const SETTLING: u64 = 3;

    /// A renewal from a cycle angle (rad) on. The period has the sign of the machine's sense of rotation.
    pub fn new(start: f64, period: f64) -> Renewal {
        Renewal {
            start,
            period,
            cycles: 0,
            left: None,
            first_step: 0.0,
            settled: false,
        }
    }

    /// Latest end of the next step (s).
    pub fn end(&mut self, simulation: &Simulation) -> f64 {
        let (Some(angle), Some(rate)) = (simulation.cycle_angle(), simulation.cycle_rate()) else {
            return f64::INFINITY;
        };
        let target = self.begin() + self.period;
        let rest = (target - angle) / rate;
        let steps = libm::ceil(rest / simulation.next_step() - Self::MET);
        if rest > 0.0 && steps <= Self::EQUAL {
            let left = self
                .left
                .map_or(steps, |left| steps.max(left - 1.0))
                .max(1.0);
            self.left = Some(left);
            simulation.time() + rest / left
        } else {
            f64::INFINITY
        }
    }

    /// Cycle angle (rad) at which the present cycle began.
    pub fn begin(&self) -> f64 {
        self.start + self.cycles as f64 * self.period
    }

    /// Called at the beginning of a cycle, from which on other steps lead on. All cycles begin with the first step of the
    /// cycles before, times a factor.
    pub fn again(&mut self, simulation: &mut Simulation, factor: f64) {
        self.settled = true;
        self.first_step *= factor;
        simulation.renew_steps(self.first_step);
    }

    /// Called after a step. At the end of a cycle it starts the sequence of steps again.
    pub fn after(&mut self, simulation: &mut Simulation, step: f64) {
        let (Some(angle), Some(rate)) = (simulation.cycle_angle(), simulation.cycle_rate()) else {
            return;
        };
        let target = self.begin() + self.period;
        if (target - angle) * self.period.signum() > Self::MET * step * rate.abs() {
            return;
        }
        self.cycles += 1;
        self.left = None;
        if self.cycles <= Self::SETTLING && !self.settled {
            self.first_step = step;
        }
        simulation.renew_steps(self.first_step);
    }
}
