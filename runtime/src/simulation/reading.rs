//! Reading chosen channels, no deeper than they need.

use super::Simulation;
use crate::acceleration::Factors;
use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::outputs::Outputs;
use eng_system::system::Depth;

/// The plan for reading some channels of one simulation: their elements, and how deep they reach.
#[derive(Clone, Debug)]
pub struct Reading {
    outputs: Outputs,
    channels: Vec<usize>,
    depth: Depth,
    projected: bool,
    /// The fingerprint of the simulation.
    fingerprint: u64,
}

impl Reading {
    /// Reads positions and velocities as the integrator holds them, without any solution of equations. They
    /// violate the constraints by the errors of the steps.
    ///
    /// # Errors
    /// A channel that needs accelerations or reactions.
    pub fn unprojected(mut self) -> Result<Reading, RuntimeError> {
        if self.depth > Depth::Velocity {
            return Err(RuntimeError::Options {
                message: "accelerations and reactions exist only after a solution of the equations, so such a channel has no unprojected reading: take the reading without `unprojected`".into(),
            });
        }
        self.projected = false;
        Ok(self)
    }

    /// Number of its channels.
    pub fn len(&self) -> usize {
        self.channels.len()
    }

    /// Whether it has no channel.
    pub fn is_empty(&self) -> bool {
        self.channels.is_empty()
    }
}

/// The depth of a channel, with the channels that it reads.
fn depth(model: &Model, channel: usize) -> Depth {
    let system = &model.compiled.system;
    let mut waiting = vec![channel];
    let mut seen = vec![false; system.channels.len()];
    let mut deepest = Depth::Position;
    while let Some(at) = waiting.pop() {
        if std::mem::replace(&mut seen[at], true) {
            continue;
        }
        let channel = &system.channels[at];
        let element = &system.elements[channel.element as usize];
        let output = &system.classes[element.class as usize].outputs[channel.output as usize];
        deepest = deepest.max(output.depth);
        waiting.extend(element.signals.iter().map(|signal| *signal as usize));
    }
    deepest
}

impl Simulation {
    /// A plan for reading channels by their indices.
    pub fn reading(&self, channels: &[usize]) -> Result<Reading, RuntimeError> {
        let system = &self.model.compiled.system;
        let mut elements = Vec::with_capacity(channels.len());
        for index in channels {
            let Some(channel) = system.channels.get(*index) else {
                return Err(RuntimeError::Options {
                    message: format!("there is no channel {index}"),
                });
            };
            elements.push(channel.element as usize);
        }
        let depths = channels.iter().map(|index| depth(&self.model, *index));
        Ok(Reading {
            outputs: Outputs::of_elements(&self.model, elements)?,
            channels: channels.to_vec(),
            depth: depths.max().unwrap_or(Depth::Position),
            projected: true,
            fingerprint: self.fingerprint(),
        })
    }

    /// Values of the channels of a plan at the last accepted state (SI), in their order. Their bits are those of
    /// [`Simulation::value`], unless the plan is unprojected. It allocates nothing.
    pub fn read(&mut self, reading: &mut Reading, out: &mut [f64]) -> Result<(), RuntimeError> {
        if reading.fingerprint != self.fingerprint() {
            return Err(RuntimeError::Options {
                message: "the plan belongs to a simulation of another model or other parameters"
                    .into(),
            });
        }
        if out.len() != reading.channels.len() {
            return Err(RuntimeError::Options {
                message: format!(
                    "room for {} channels, not {}",
                    out.len(),
                    reading.channels.len()
                ),
            });
        }
        let key = self.integrator.current.time.to_bits();
        if reading.projected && self.evaluated == Some(key) {
            for (value, channel) in out.iter_mut().zip(&reading.channels) {
                *value = self.outputs.values[*channel];
            }
            return Ok(());
        }
        self.evaluated = None;
        self.completed.copy_from(&self.integrator.current);
        self.bring(reading)
            .and_then(|()| {
                let outputs = &mut reading.outputs;
                outputs.evaluate(&self.model, &self.dynamics, &self.completed)
            })
            .map_err(|error| self.at_moment(error))?;
        for (value, channel) in out.iter_mut().zip(&reading.channels) {
            *value = reading.outputs.values[*channel];
        }
        Ok(())
    }

    /// Brings the completed state and the dynamics to where a plan reads.
    fn bring(&mut self, reading: &Reading) -> Result<(), RuntimeError> {
        let state = &mut self.completed;
        if !reading.projected {
            self.dynamics
                .place(&self.model, state.time, &state.pose, &state.velocity);
            return Ok(());
        }
        let moment = Moment {
            time: state.time,
            cycle_angle: self.cycle_now.map(|c| c[0]),
        };
        let factors = match reading.depth {
            Depth::Position => Factors::IfNeeded,
            _ => Factors::Made,
        };
        self.system
            .project(&self.model, &mut self.dynamics, state, moment, factors)?;
        if reading.depth > Depth::Position {
            let settles = state.time < self.integrator.current.time;
            self.system.finish(
                &self.model,
                &mut self.dynamics,
                &mut self.integrator,
                state,
                (moment, settles),
            )?;
        }
        Ok(())
    }
}
