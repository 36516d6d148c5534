//! One instance of an FMU, in safe code: its variables by value reference, its phases, steps and states.

use super::Saved;
use crate::edge::Refused;
use eng::fmu::{Kind, Opened};
use eng::{
    Channel, Dimension, Input, Interpolation, Parameter, Quantity, Reading, Simulation,
    SimulationBuilder,
};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Difference between a communication point and the time of the simulation that is rounding: a share of the
/// step, and of the time. Choices: importers sum steps in their own way, and a millionth of a step is no
/// step.
const ROUNDING: (f64, f64) = (1e-6, 16.0 * f64::EPSILON);

/// The phases of an FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Parameters and start values are set.
    Instantiated,
    /// As before; outputs have values.
    Initialization,
    /// The motion has begun, and steps follow.
    Stepping,
    /// A step has failed.
    Failed,
    /// The importer has ended the simulation.
    Terminated,
}

/// A variable. Its place among all is its value reference.
#[derive(Clone, Debug)]
struct Variable {
    path: String,
    role: Role,
}

#[derive(Clone, Copy, Debug)]
enum Role {
    Time,
    Parameter(Start),
    Input(Start, Input, Interpolation),
    /// Its place among the channels that are read.
    Output(usize),
}

/// The parameter that holds a start value.
#[derive(Clone, Copy, Debug)]
struct Start {
    parameter: Parameter,
    dimension: Dimension,
    /// Its place among the parameters of the model.
    place: usize,
}

/// A simulation that has begun.
#[derive(Debug)]
struct Running {
    simulation: Simulation,
    /// The channels that are read.
    reading: Reading,
    /// Values of the outputs at the last reading.
    outputs: Vec<f64>,
    /// Whether they belong to the present state and inputs.
    fresh: bool,
}

/// An instance of an FMU.
#[derive(Debug)]
pub struct Slave {
    /// A simulation as the FMU states it.
    builder: SimulationBuilder,
    token: String,
    variables: Vec<Variable>,
    channels: Vec<Channel>,
    phase: Phase,
    /// Values that the importer has set, by value reference.
    stated: Vec<Option<f64>>,
    /// The set values with which the simulation began, by value reference.
    begun: Vec<Option<f64>>,
    /// Rates of inputs in the next step, by value reference.
    rates: Vec<Option<f64>>,
    /// Values of all parameters of the model at the start.
    values: Option<Vec<f64>>,
    running: Option<Running>,
}

impl Slave {
    /// Reads and compiles the model in the resources of an FMU. Also gives the warnings of its check.
    pub fn new(resources: &Path, token: &str) -> Result<(Slave, String), Refused> {
        let refused = |error: eng::fmu::FmuError| Refused(error.to_string());
        let Opened {
            manifest,
            builder,
            warnings,
        } = eng::fmu::open(resources).map_err(refused)?;
        if manifest.token != token {
            return Err(Refused::new(
                "the description and the resources are of different FMUs: their tokens differ",
            ));
        }
        let model = builder.model();
        let infos = model.parameters();
        let start = |path: &str| -> Result<Start, Refused> {
            let parameter = model.parameter(path)?;
            let info = model.describe(parameter)?;
            let place = infos.iter().position(|known| known.path == path);
            Ok(Start {
                parameter,
                dimension: info.dimension,
                place: place.unwrap_or(usize::MAX),
            })
        };
        let inputs = model.inputs();
        let (mut variables, mut channels) = (Vec::new(), Vec::new());
        variables.push(Variable {
            path: "time".to_owned(),
            role: Role::Time,
        });
        for known in manifest.variables {
            let path = known.path;
            let role = match known.kind {
                Kind::Parameter => Role::Parameter(start(&path)?),
                Kind::Input => {
                    let info = inputs.iter().find(|info| info.path == path);
                    let interpolation = info.map_or(Interpolation::Hold, |info| info.interpolation);
                    Role::Input(start(&path)?, model.input(&path)?, interpolation)
                }
                Kind::Output => {
                    channels.push(model.channel(&path)?);
                    Role::Output(channels.len() - 1)
                }
            };
            variables.push(Variable { path, role });
        }
        let none = vec![None; variables.len()];
        let slave = Slave {
            builder,
            token: manifest.token,
            channels,
            phase: Phase::Instantiated,
            stated: none.clone(),
            begun: none.clone(),
            rates: none,
            values: None,
            running: None,
            variables,
        };
        Ok((slave, warnings))
    }

    /// Forgets all that was set and computed.
    pub fn reset(&mut self) {
        let none = vec![None; self.variables.len()];
        self.phase = Phase::Instantiated;
        (self.stated, self.begun, self.rates) = (none.clone(), none.clone(), none);
        (self.values, self.running) = (None, None);
    }

    fn variable(&self, reference: u32) -> Result<&Variable, Refused> {
        let count = self.variables.len();
        self.variables.get(reference as usize).ok_or_else(|| {
            Refused(format!(
                "there is no variable with the value reference {reference}: they are below {count}"
            ))
        })
    }

    fn during(&self, allowed: &[Phase], call: &str) -> Result<(), Refused> {
        if allowed.contains(&self.phase) {
            return Ok(());
        }
        let now = match self.phase {
            Phase::Instantiated => "before the initialization",
            Phase::Initialization => "during the initialization",
            Phase::Stepping => "between the steps",
            Phase::Failed => "after a failed step: reset the FMU or restore a saved state",
            Phase::Terminated => "after the end: reset the FMU or restore a saved state",
        };
        Err(Refused(format!("{call} is not possible {now}")))
    }

    /// Sets a variable. A parameter keeps its value from the end of the initialization on.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<(), Refused> {
        let variable = self.variable(reference)?;
        let path = &variable.path;
        if !value.is_finite() {
            return Err(Refused(format!(
                "{path} cannot be {value}: it is no number"
            )));
        }
        let before = matches!(self.phase, Phase::Instantiated | Phase::Initialization);
        match variable.role {
            Role::Time => return Err(Refused::new("time is not set: a step moves it on")),
            Role::Output(_) => {
                return Err(Refused(format!("{path} is an output, which is not set")));
            }
            Role::Parameter(_) if !before => {
                return Err(Refused(format!(
                    "{path} is a parameter, which keeps its value from the start on: declare it as `input` in the text, or reset the FMU"
                )));
            }
            Role::Parameter(_) | Role::Input(..) if before => {
                (self.values, self.running) = (None, None);
            }
            Role::Parameter(_) => {}
            Role::Input(_, input, _) => {
                self.during(&[Phase::Stepping], "setting an input")?;
                let running = self.running()?;
                running.simulation.set_input(input, value)?;
                running.fresh = false;
            }
        }
        if let Some(place) = self.stated.get_mut(reference as usize) {
            *place = Some(value);
        }
        Ok(())
    }

    /// Sets the rate (1/s) that an input has in the next step.
    pub fn set_rate(&mut self, reference: u32, order: i32, rate: f64) -> Result<(), Refused> {
        let Variable { path, role } = self.variable(reference)?;
        if !matches!(role, Role::Input(_, _, Interpolation::Linear)) {
            return Err(Refused(format!(
                "{path} has no rate: only inputs with `interpolation: linear` have one"
            )));
        }
        if order != 1 || !rate.is_finite() {
            return Err(Refused(format!(
                "the derivative of order {order} of {path} cannot be {rate}: only the first one is taken, and it is a number"
            )));
        }
        if let Some(place) = self.rates.get_mut(reference as usize) {
            *place = Some(rate);
        }
        Ok(())
    }

    /// The value of a variable.
    pub fn get(&mut self, reference: u32) -> Result<f64, Refused> {
        let role = self.variable(reference)?.role;
        match role {
            Role::Time => Ok(self.running.as_ref().map_or(0.0, |r| r.simulation.time())),
            Role::Parameter(start) | Role::Input(start, ..) => {
                let stated = self.stated.get(reference as usize).copied().flatten();
                match stated {
                    Some(value) => Ok(value),
                    None => Ok(self.values()?.get(start.place).copied().unwrap_or(f64::NAN)),
                }
            }
            Role::Output(place) => {
                self.during(
                    &[
                        Phase::Initialization,
                        Phase::Stepping,
                        Phase::Failed,
                        Phase::Terminated,
                    ],
                    "reading an output",
                )?;
                let Running {
                    simulation,
                    reading,
                    outputs,
                    fresh,
                } = self.running()?;
                if !*fresh {
                    simulation.read(reading, outputs)?;
                    *fresh = true;
                }
                Ok(outputs.get(place).copied().unwrap_or(f64::NAN))
            }
        }
    }

    /// The simulation with values in place of those of the text.
    fn builder(&self, stated: &[Option<f64>]) -> Result<SimulationBuilder, Refused> {
        let mut builder = self.builder.clone();
        for (variable, value) in self.variables.iter().zip(stated) {
            if let (Role::Parameter(start) | Role::Input(start, ..), Some(value)) =
                (variable.role, value)
            {
                builder = builder.set(start.parameter, Quantity::si(*value, start.dimension))?;
            }
        }
        Ok(builder)
    }

    /// Values of all parameters of the model at the start.
    fn values(&mut self) -> Result<&[f64], Refused> {
        let values = match self.values.take() {
            Some(values) => values,
            None => self.builder(&self.stated)?.parameter_values()?,
        };
        Ok(self.values.insert(values))
    }

    /// The simulation, which begins here at the first need.
    fn running(&mut self) -> Result<&mut Running, Refused> {
        let running = match self.running.take() {
            Some(running) => running,
            None => {
                let simulation = self.builder(&self.stated)?.start()?;
                self.begun.clone_from(&self.stated);
                self.with_outputs(simulation)?
            }
        };
        Ok(self.running.insert(running))
    }

    fn with_outputs(&self, simulation: Simulation) -> Result<Running, Refused> {
        Ok(Running {
            reading: simulation.watch(&self.channels)?,
            outputs: vec![0.0; self.channels.len()],
            fresh: false,
            simulation,
        })
    }

    /// Checks the time of the start. The motion of a model begins at zero.
    pub fn begins_at(&mut self, start: f64) -> Result<(), Refused> {
        self.during(&[Phase::Instantiated], "the initialization")?;
        if start != 0.0 {
            return Err(Refused(format!(
                "a simulation begins at 0 s, because functions of time in the text count from there; it cannot begin at {start} s"
            )));
        }
        Ok(())
    }

    /// Begins the initialization.
    pub fn initialize(&mut self, start: f64) -> Result<(), Refused> {
        self.begins_at(start)?;
        self.phase = Phase::Initialization;
        Ok(())
    }

    /// Ends the initialization: the model is assembled and the motion begins.
    pub fn begin(&mut self) -> Result<(), Refused> {
        self.during(&[Phase::Initialization], "the end of the initialization")?;
        self.running()?;
        self.phase = Phase::Stepping;
        Ok(())
    }

    /// One communication step.
    pub fn step(&mut self, from: f64, length: f64) -> Result<(), Refused> {
        self.during(&[Phase::Stepping], "a step")?;
        if !from.is_finite() || !length.is_finite() || length <= 0.0 {
            return Err(Refused(format!(
                "a step goes forward: it cannot begin at {from} s with a length of {length} s"
            )));
        }
        let now = self.time();
        let near = (ROUNDING.0 * length).max(ROUNDING.1 * now.abs());
        if (from - now).abs() > near {
            return Err(Refused(format!(
                "a step begins at the present time, {now} s, and not at {from} s; to go back, restore a saved state"
            )));
        }
        self.running()?.simulation.may_advance(from + length)?;
        let mut aims = Vec::new();
        for reference in 0..self.variables.len() {
            let rate = self.rates.get_mut(reference).and_then(Option::take);
            let role = self.variables.get(reference).map(|variable| variable.role);
            if let (Some(rate), Some(Role::Input(_, input, _))) = (rate, role) {
                aims.push((input, self.get(reference as u32)? + rate * length));
            }
        }
        let running = self.running()?;
        running.fresh = false;
        let advance = || {
            for (input, value) in aims {
                running.simulation.aim_input(input, value)?;
            }
            running.simulation.advance(from + length)
        };
        let done = advance();
        if let Err(error) = done {
            self.phase = Phase::Failed;
            return Err(error.into());
        }
        Ok(())
    }

    /// The condition of the analysis that has ended the simulation, with its moment. It stands there.
    pub fn stopped(&self) -> Option<String> {
        let stopped = self.running.as_ref()?.simulation.stopped()?;
        Some(format!("ended by its condition {stopped}"))
    }

    /// Time (s).
    pub fn time(&self) -> f64 {
        self.running
            .as_ref()
            .map_or(0.0, |running| running.simulation.time())
    }

    /// The end of the simulation.
    pub fn terminate(&mut self) -> Result<(), Refused> {
        self.during(&[Phase::Stepping, Phase::Failed], "the end")?;
        self.phase = Phase::Terminated;
        Ok(())
    }

    /// The present state.
    pub fn save(&mut self) -> Saved {
        let running = self.running.as_mut();
        Saved {
            token: self.token.clone(),
            phase: self.phase,
            stated: self.stated.clone(),
            begun: self.begun.clone(),
            checkpoint: running.map(|running| running.simulation.checkpoint()),
        }
    }

    /// Continues from a saved state.
    pub fn restore(&mut self, saved: &Saved) -> Result<(), Refused> {
        let count = self.variables.len();
        if saved.token != self.token || saved.stated.len() != count || saved.begun.len() != count {
            return Err(Refused::new(
                "the state was saved by another FMU: only the FMU that saved a state can restore it",
            ));
        }
        let running = match &saved.checkpoint {
            Some(bytes) => {
                let resumed = self.builder(&saved.begun)?.resume(bytes)?;
                Some(self.with_outputs(resumed)?)
            }
            None => None,
        };
        self.running = running;
        self.phase = saved.phase;
        self.stated.clone_from(&saved.stated);
        self.begun.clone_from(&saved.begun);
        self.rates.fill(None);
        self.values = None;
        Ok(())
    }

    /// Failed `advise`s since the last call.
    pub fn warnings(&mut self) -> Vec<String> {
        let taken = self
            .running
            .as_mut()
            .map(|running| running.simulation.runtime().take_warnings());
        let warnings = taken.unwrap_or_default().into_iter();
        warnings
            .map(|warning| format!("{}: {}", warning.origin.path, warning.message))
            .collect()
    }
}
