//! A model in its assembled position, with its freedoms.

use crate::assembly::assemble;
use crate::error::RuntimeError;
use crate::model::Model;
use crate::state::State;
use crate::topology::{TopologyReport, analyze};
use eng_system::code::Compiled;

/// A model with its parameters in its assembled position. Make it once for several uses: a mechanism that
/// closes only at the tenth trial takes a second.
#[derive(Clone, Debug)]
pub struct Assembled {
    model: Model,
    state: State,
    topology: Result<TopologyReport, RuntimeError>,
}

impl Assembled {
    /// Binds parameters and assembles. `overrides` has one entry for each parameter, `None` for its default; an
    /// empty slice means all defaults.
    ///
    /// # Errors
    /// Parameters that the model refuses, loops that do not close, branches that are not reached.
    pub fn new(compiled: &Compiled, overrides: &[Option<f64>]) -> Result<Assembled, RuntimeError> {
        Assembled::of(Model::bind(compiled, overrides)?)
    }

    /// A bound model, assembled.
    pub(crate) fn of(mut model: Model) -> Result<Assembled, RuntimeError> {
        let state = assemble(&mut model)?;
        let topology = analyze(&model, &state);
        Ok(Assembled {
            model,
            state,
            topology,
        })
    }

    /// The model. Its ground markers are fixed.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Positions and velocities.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Its freedoms, and the equations that repeat each other.
    ///
    /// # Errors
    /// Those of evaluating the constraints.
    pub fn topology(&self) -> Result<&TopologyReport, RuntimeError> {
        self.topology.as_ref().map_err(RuntimeError::clone)
    }

    /// Model and state to run with, if no equation repeats another one.
    pub(crate) fn independent(&self) -> Result<(Model, State), RuntimeError> {
        let report = self.topology()?;
        if !report.redundant.is_empty() {
            return Err(RuntimeError::Redundant {
                groups: report.redundant.clone(),
            });
        }
        Ok((self.model.clone(), self.state.clone()))
    }
}
