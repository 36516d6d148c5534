//! Steps that repeat with the cycle.

use crate::simulation::Simulation;

/// Where steps begin anew.
///
/// A change of the step excites what the steps do not resolve. So the last steps of a cycle are made equal, a few per cent shorter than
/// the control would have them, and a cycle begins with the step that the first cycles came to there.
pub(super) struct Renewal {
    start: f64,
    /// With the sense in which the machine turns.
    period: f64,
    cycles: u64,
    /// Equal steps that are left up to the end of the cycle.
    left: Option<f64>,
    /// First step of a cycle (s).
    first_step: f64,
}

impl Renewal {
    /// Part of a step within which the end of a cycle is met: steps meet it to second order, and a sliver of a step would blow
    /// rounding up.
    const MET: f64 = 0.05;
    /// So many steps before the end they are made equal.
    const EQUAL: f64 = 32.0;
    /// Cycles that settle the first step.
    const SETTLING: u64 = 3;

    /// From a cycle angle (rad) on, with a period in the sense in which the machine turns.
    pub fn new(start: f64, period: f64) -> Renewal {
        Renewal {
            start,
            period,
            cycles: 0,
            left: None,
            first_step: 0.0,
        }
    }

    /// When the next step ends at the latest (s).
    pub fn end(&mut self, simulation: &Simulation) -> f64 {
        let (Some(angle), Some(rate)) = (simulation.cycle_angle(), simulation.cycle_rate()) else {
            return f64::INFINITY;
        };
        let target = self.start + (self.cycles + 1) as f64 * self.period;
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

    /// After a step: begins anew at the end of a cycle.
    pub fn after(&mut self, simulation: &mut Simulation, step: f64) {
        let (Some(angle), Some(rate)) = (simulation.cycle_angle(), simulation.cycle_rate()) else {
            return;
        };
        let target = self.start + (self.cycles + 1) as f64 * self.period;
        if (target - angle) * self.period.signum() > Self::MET * step * rate.abs() {
            return;
        }
        self.cycles += 1;
        self.left = None;
        if self.cycles <= Self::SETTLING {
            self.first_step = step;
        }
        simulation.renew_steps(self.first_step);
    }
}
