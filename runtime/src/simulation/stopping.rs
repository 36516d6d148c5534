//! The end of a run where a condition begins to hold.
//!
//! Steps under error control end at the kinks of the condition ([`crate::kinks`]), so no step passes a place at which it
//! changes. After a step at whose end it holds, bisection of the dense output finds the moment at which it begins to hold.

use super::{Simulation, StepReport};
use crate::dynamics::Dynamics;
use crate::elements::Inputs;
use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::outputs::Watch;
use crate::state::State;
use eng_system::system::{ConditionKind, Origin};

/// Roundings of the time to which a moment is found: bisection cannot distinguish nearer ones.
const ROUNDINGS: f64 = 2.0;

/// The condition that ended a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Stopped {
    /// The condition as written.
    pub condition: String,
    /// Where it begins to hold.
    pub moment: Moment,
}

impl std::fmt::Display for Stopped {
    /// `speed > 6000 rpm at 1.5 s`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} at {}", self.condition, self.moment)
    }
}

/// The condition of a model that ends its runs.
#[derive(Debug)]
pub(super) struct Stopping {
    element: usize,
    condition: usize,
    watch: Watch,
    /// Whether it holds at the last accepted state.
    holds: bool,
    /// Where it began to hold, if the simulation stands there.
    stopped: Option<Moment>,
}

impl Stopping {
    /// The condition of a model, if it has one.
    pub fn new(model: &Model) -> Option<Stopping> {
        (0..model.elements.len()).find_map(|element| {
            let mut conditions = model.class(element).conditions.iter();
            let condition = conditions.position(|c| c.kind == ConditionKind::Stop)?;
            Some(Stopping {
                element,
                condition,
                watch: Watch::new(model, |e| e == element),
                holds: false,
                stopped: None,
            })
        })
    }

    /// Whether it holds at a state at which the dynamics are placed, with the turns of another one before.
    fn holds_at(
        &mut self,
        model: &Model,
        dynamics: &Dynamics,
        state: &State,
        rotations: &[f64],
    ) -> Result<bool, RuntimeError> {
        let from = Inputs {
            multipliers: &[],
            rotations,
            ..dynamics.inputs_at(state)
        };
        let (mut holds, mut known) = (true, true);
        self.watch.violations(
            model,
            &from,
            dynamics.batches(),
            |kind| *kind == ConditionKind::Stop,
            |violation, _| {
                holds = false;
                known &= !violation.value.is_nan();
            },
        )?;
        match known {
            true => Ok(holds),
            false => Err(RuntimeError::NotFinite {
                origin: Box::new(self.origin(model)),
                because: None,
                moment: Moment {
                    time: state.time,
                    cycle_angle: None,
                },
            }),
        }
    }

    fn origin(&self, model: &Model) -> Origin {
        model.compiled.system.elements[self.element].origin.clone()
    }

    fn stopped_at(&self, model: &Model, moment: Moment) -> Stopped {
        let condition = &model.class(self.element).conditions[self.condition];
        Stopped {
            condition: condition.text.clone(),
            moment,
        }
    }
}

impl Simulation {
    /// Notes whether the condition holds at the last accepted state, at which the dynamics are placed.
    pub(super) fn observe_stop(&mut self) -> Result<(), RuntimeError> {
        let Some(stopping) = &mut self.stopping else {
            return Ok(());
        };
        let state = &self.integrator.current;
        let holds = stopping.holds_at(&self.model, &self.dynamics, state, &state.rotations)?;
        stopping.holds = holds;
        Ok(())
    }

    /// Refuses a start at which the condition holds.
    pub(super) fn refuse_stop_at_start(&self) -> Result<(), RuntimeError> {
        let holding = self.stopping.as_ref().filter(|stopping| stopping.holds);
        let Some(stopping) = holding else {
            return Ok(());
        };
        let Stopped { condition, moment } = stopping.stopped_at(&self.model, self.moment());
        Err(RuntimeError::StopsAtStart {
            origin: Box::new(stopping.origin(&self.model)),
            condition,
            moment,
        })
    }

    /// The time (s) within the last step at which the condition begins to hold, if it holds at its end.
    pub(crate) fn stop_time(&mut self) -> Result<Option<f64>, RuntimeError> {
        if !self
            .stopping
            .as_ref()
            .is_some_and(|stopping| stopping.holds)
        {
            return Ok(None);
        }
        let (mut before, mut behind) =
            (self.integrator.previous.time, self.integrator.current.time);
        while behind - before > ROUNDINGS * f64::EPSILON * behind.abs() {
            let middle = 0.5 * (before + behind);
            if self.holds_within(middle)? {
                behind = middle;
            } else {
                before = middle;
            }
        }
        Ok(Some(behind))
    }

    /// Whether the condition holds at a time (s) within the last step.
    fn holds_within(&mut self, time: f64) -> Result<bool, RuntimeError> {
        self.interpolate_at(time)?;
        let state = &self.completed;
        self.dynamics
            .place(&self.model, state.time, &state.pose, &state.velocity);
        let rotations = &self.integrator.current.rotations;
        match &mut self.stopping {
            Some(stopping) => stopping.holds_at(&self.model, &self.dynamics, state, rotations),
            None => Ok(false),
        }
    }

    /// The condition that ended the last step, at a moment that [`Simulation::stop_time`] found, where the outputs are.
    pub(crate) fn stopped_within(&mut self, time: f64) -> Result<Option<Stopped>, RuntimeError> {
        let cycle_angle = self.cycle_of_completed()?.map(|[angle, _]| angle);
        let stopping = self.stopping.as_ref();
        Ok(stopping.map(|stopping| stopping.stopped_at(&self.model, Moment { time, cycle_angle })))
    }

    /// The condition that has ended the simulation, if it stands where the condition began to hold.
    pub fn stopped(&self) -> Option<Stopped> {
        let stopping = self.stopping.as_ref()?;
        Some(stopping.stopped_at(&self.model, stopping.stopped?))
    }

    /// Moves the simulation back to the moment within the last step at which the condition begins to hold. It takes no step
    /// from there.
    pub(super) fn stand_at_stop(&mut self) -> Result<bool, RuntimeError> {
        let Some(time) = self.stop_time()? else {
            return Ok(false);
        };
        self.interpolate_at(time)?;
        self.complete()?;
        self.cycle_now = self.cycle_of_completed()?;
        self.integrator.current.copy_from(&self.completed);
        self.energy = self.sampled_energy;
        self.evaluated = Some(time.to_bits());
        let moment = self.moment();
        if let Some(stopping) = &mut self.stopping {
            stopping.stopped = Some(moment);
        }
        Ok(true)
    }

    /// The report of a step that ends earlier, at the condition.
    pub(super) fn report_of_stop(&self, whole: StepReport) -> StepReport {
        let time = self.time();
        StepReport {
            time,
            step: whole.step - (whole.time - time),
        }
    }

    /// Refuses a step after the condition has ended the simulation.
    pub(super) fn refuse_after_stop(&self) -> Result<(), RuntimeError> {
        match self.stopped() {
            None => Ok(()),
            Some(stopped) => Err(RuntimeError::Options {
                message: format!(
                    "the condition of `stop` has ended the simulation: {stopped}; start another one"
                ),
            }),
        }
    }

    /// The time (s) and cycle angle (rad) at which the condition has ended the simulation, for a checkpoint: without it NaN, and
    /// nothing for a model without a condition.
    pub(super) fn stop_numbers(&self) -> Option<[f64; 2]> {
        let stopped = self.stopping.as_ref()?.stopped;
        Some(stopped.map_or([f64::NAN; 2], |moment| {
            [moment.time, moment.cycle_angle.unwrap_or(f64::NAN)]
        }))
    }

    /// Sets them from a checkpoint.
    pub(super) fn set_stop_numbers(&mut self, [time, cycle_angle]: [f64; 2]) {
        if let Some(stopping) = &mut self.stopping
            && !time.is_nan()
        {
            stopping.stopped = Some(Moment {
                time,
                cycle_angle: (!cycle_angle.is_nan()).then_some(cycle_angle),
            });
        }
    }
}
