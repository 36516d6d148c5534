//! The first cycles of a periodic analysis, with steps of a wider tolerance than the stated one. Nothing of them is in the result.
//!
//! A machine whose cycle accelerates has some such cycles, until its slow motion is near the limit. A machine that a drive turns
//! has one at most, in the first part of which films settle.

use super::Cycles;
use crate::error::RuntimeError;
use crate::simulation::Simulation;
use crate::start::StartReport;
use crate::transient::Renewed;
use eng_system::system::{Periodic, StepControl};

/// Factor on the tolerance of the first cycles, and the largest factor that they have with it. With the first their
/// steps are three times as long and their errors ten times as large, a hundredth of the swing of a film's force. With
/// more the slow motion would not be that of the engine.
const WIDE: f64 = 30.0;
const WIDEST: f64 = 30.0;
/// Least factor that is worth such cycles. A choice: steps one and a half times as long.
const WORTH: f64 = 3.0;
/// Multiple of the requested change at which cycles of such steps end, and their largest number; and the least
/// largest number of all cycles for which there are any. Choices: nearer to the limit the errors of wide steps hide the
/// motion, and three differences need four cycles.
const WIDELY: f64 = 5.0;
const WIDE_CYCLES: u32 = 5;
const LEAST_CYCLES: u32 = 12;
/// Their samples lie as many times farther apart, but are as many at least where the stated ones are. Choices: 72
/// samples of a cycle, every 10°, show the motion of a drive line.
const SPARSE: f64 = 4.0;
const LEAST_SAMPLES: f64 = 72.0;
/// Part of the first cycle that has wider steps where only films settle. A choice: pins find their orbits within half a
/// revolution, so the errors of the wider steps are gone at the end of the cycle.
const SETTLING: f64 = 0.5;
/// Least requested change for such a cycle. A choice: pins lose the errors of the wider steps in half a cycle, a hundredth of a
/// swing, down to some thousandths. With a smaller change one more cycle would follow, and nothing would be won.
const COARSE: f64 = 5e-3;
/// Least factor of a decay that two cycles show by themselves. A choice: with it the distance to the limit is at least the
/// change, because a film that settles within degrees says nothing about a slower motion beside it.
const LEAST_FACTOR: f64 = 0.5;
/// Factor of a decay that is assumed where two cycles show none. A choice: a slower decay would be that of a drive line or of a
/// mount. It would move bodies by far more than the clearances by which the difference counts.
const ASSUMED_FACTOR: f64 = 0.9;

/// Cycles with a wider tolerance than the stated one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wide {
    /// Factor on the tolerances.
    tolerance: f64,
    /// Samples of a cycle.
    samples: usize,
    /// Whether these are the steps of the first cycle alone, in which films settle; and whether the cycle has come to its
    /// steps of the stated tolerance.
    pub(super) settles: bool,
    settled: bool,
}

impl Wide {
    /// Such cycles of an analysis, if they are worth it.
    pub(super) fn of(periodic: &Periodic, samples: f64) -> Option<Wide> {
        let StepControl::Tolerance(stated) = periodic.integration.step else {
            return None;
        };
        let tolerance = (WIDE * stated).min(WIDEST);
        let sparse = libm::ceil((samples / SPARSE).max(LEAST_SAMPLES.min(samples)));
        (tolerance >= WORTH * stated && periodic.cycles >= LEAST_CYCLES).then_some(Wide {
            tolerance,
            samples: sparse as usize,
            settles: false,
            settled: false,
        })
    }
}

/// Whether films settle in the first cycle. The motion of turning flexible bodies in films already repeats at the start.
fn films_settle(simulation: &Simulation) -> bool {
    let repeats = match simulation.start() {
        StartReport::QuasiStatic(found) | StartReport::Equilibrium(found) => {
            found.turning.is_some()
        }
        _ => false,
    };
    !repeats && !simulation.model().compiled.system.journals.is_empty()
}

/// Estimated distance to the limit after the first two cycles behind the one in which films settled: the smaller of two. Either
/// the change decays within the cycle, by a factor that it shows. Or it is noise of the steps, and a decay may hide below it. Then
/// all later differences of the motion sum up to a share of the clearance. `moved` is the last one as such a share.
pub fn distance_of_two(change: f64, factor: f64, moved: f64) -> f64 {
    let reach = |factor: f64| factor / (1.0 - factor);
    let decays = if factor < 1.0 {
        change * reach(factor.max(LEAST_FACTOR))
    } else {
        f64::INFINITY
    };
    decays.min(change.max(moved * reach(ASSUMED_FACTOR)))
}

/// Whether cycles with a wider tolerance end after `done` of them, at a change of `far` times the requested one.
pub(super) fn ends(far: f64, done: u32) -> bool {
    far <= WIDELY || done >= WIDE_CYCLES
}

impl Cycles<'_> {
    /// A cycle that a drive turns at its own speed has no motion of a drive line that could be slow: then wider steps serve in
    /// the first cycle at most.
    pub(super) fn begin_wide(
        &mut self,
        simulation: &mut Simulation,
    ) -> Result<Option<[f64; 2]>, RuntimeError> {
        if let Some(wide) = &mut self.wide
            && !simulation.cycle_accelerates()?
        {
            wide.settles = true;
            if self.limit.change < COARSE || !films_settle(simulation) {
                self.wide = None;
            }
        }
        Ok(self.wide.map(|wide| {
            simulation.set_tolerance(wide.tolerance);
            self.grid = if wide.settles {
                // nothing is compared with this cycle
                wide.samples.min(LEAST_SAMPLES as usize)
            } else {
                wide.samples
            };
            [self.grid, wide.samples].map(|count| self.period / count as f64)
        }))
    }

    /// The first cycle of a model whose films settle: near its end the steps have the stated tolerance, and the next cycle has
    /// the stated samples.
    pub(super) fn settle(&mut self, simulation: &mut Simulation, ended: bool) -> Option<Renewed> {
        let (StepControl::Tolerance(stated), Some(wide)) =
            (self.limit.integration.step, &mut self.wide)
        else {
            return None;
        };
        let turned = simulation.cycle_angle().unwrap_or(0.0) - simulation.cycle_start();
        if !wide.settled && turned.abs() >= SETTLING * self.period {
            wide.settled = true;
            simulation.set_tolerance(stated);
            let factor = libm::cbrt(stated / wide.tolerance);
            simulation.renew_steps(simulation.next_step() * factor);
        }
        if !ended {
            return None;
        }
        let wide = *wide;
        self.forget();
        self.wide = None;
        self.settled = true;
        // the last cycle alone needs all samples, and it is not the next one
        let few = self.samples.is_multiple_of(wide.samples);
        Some(self.with_samples(if few { wide.samples } else { self.samples }))
    }

    /// The beginning of a cycle with the stated tolerance and some samples.
    pub(super) fn with_samples(&mut self, samples: usize) -> Renewed {
        self.grid = samples;
        Renewed {
            first_step: 1.0,
            sample: self.period / samples as f64,
            longest: self.period / self.samples as f64,
            leapt: false,
        }
    }

    /// The beginning of a cycle with the stated tolerance and samples. The error of a step is of third order.
    pub(super) fn renewed(&mut self, simulation: &mut Simulation, leapt: bool) -> Renewed {
        let mut first_step = 1.0;
        if let (StepControl::Tolerance(stated), Some(wide)) =
            (self.limit.integration.step, self.wide.take())
        {
            simulation.set_tolerance(stated);
            first_step = libm::cbrt(stated / wide.tolerance);
        }
        Renewed {
            first_step,
            leapt,
            ..self.with_samples(self.samples)
        }
    }
}
