//! A simulation at rest, for the outputs of an equilibrium.

use super::{Options, Simulation};
use crate::error::RuntimeError;
use crate::model::Model;
use crate::start::StartReport;
use crate::state::State;

impl Simulation {
    /// At a state of rest with the multipliers that balance its loads. Its outputs belong to this very state:
    /// velocities and accelerations are zero, even if a drive states a speed. It cannot step.
    ///
    /// # Errors
    /// A `require` that does not hold; an element that gives no number.
    pub(crate) fn resting(
        model: Model,
        state: State,
        start: StartReport,
    ) -> Result<Simulation, RuntimeError> {
        let mut simulation = Simulation::with_state(model, state, Options::default())?;
        simulation.start = start;
        simulation.stand()?;
        let rates = simulation.dynamics.rates().to_vec();
        simulation.integrator.current.rates.copy_from_slice(&rates);
        simulation.observe_state()?;
        simulation.compute_energy();
        let energy = &mut simulation.energy;
        energy.start = energy.kinetic + energy.gravity + energy.strain;
        simulation.cycle_start = simulation.cycle_angle().unwrap_or(0.0);
        simulation
            .completed
            .copy_from(&simulation.integrator.current);
        simulation.outputs.evaluate(
            &simulation.model,
            &simulation.dynamics,
            &simulation.completed,
        )?;
        simulation.compute_sampled_energy();
        simulation.evaluated = Some(simulation.completed.time.to_bits());
        Ok(simulation)
    }
}
