//! Simulations, plans for reading, and checkpoints.

use super::model::Described;
use super::{EngModel, object, or, status};
use crate::edge::{self, Refused};
use eng::{Point, Quantity, Reading, Simulation, SimulationBuilder};
use std::ffi::c_int;
use std::sync::Arc;

/// A simulation before or after its start.
#[derive(Debug)]
pub struct EngSimulation {
    model: Arc<Described>,
    phase: Phase,
}

#[derive(Debug)]
enum Phase {
    Prepared(Box<SimulationBuilder>),
    Running(Box<Simulation>),
}

/// A plan for reading channels.
#[derive(Debug)]
pub struct EngWatch {
    inner: Reading,
    channels: usize,
}

/// The state of a simulation as bytes.
#[derive(Debug)]
pub struct EngCheckpoint {
    bytes: Vec<u8>,
}

impl EngSimulation {
    fn running(&mut self) -> Result<&mut Simulation, Refused> {
        match &mut self.phase {
            Phase::Running(simulation) => Ok(simulation),
            Phase::Prepared(_) => Err(Refused::new(
                "the simulation is not started: call eng_start or eng_resume before",
            )),
        }
    }

    fn prepared(&mut self) -> Result<&mut SimulationBuilder, Refused> {
        match &mut self.phase {
            Phase::Prepared(builder) => Ok(builder),
            Phase::Running(_) => Err(Refused::new(
                "the simulation has started: parameters and steps keep their values; declare a number that changes as `input`",
            )),
        }
    }

    /// Changes the builder. A refused change leaves it as it was.
    fn change(
        &mut self,
        change: impl FnOnce(SimulationBuilder) -> Result<SimulationBuilder, eng::Error>,
    ) -> Result<(), Refused> {
        let builder = self.prepared()?;
        *builder = change(builder.clone())?;
        Ok(())
    }
}

/// Prepares a simulation of a model. Set its parameters, then start it.
///
/// # Safety
/// `model` is a model that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_simulation(model: *const EngModel) -> *mut EngSimulation {
    object(|| {
        // SAFETY: by the promise of the caller
        let model = unsafe { edge::shared(model, "model")? }.0.clone();
        let phase = Phase::Prepared(Box::new(model.prototype.clone()));
        Ok(EngSimulation { model, phase })
    })
}

/// Frees a simulation.
///
/// # Safety
/// `simulation` is null or a simulation that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_free_simulation(simulation: *mut EngSimulation) {
    // SAFETY: by the promise of the caller
    unsafe { edge::taken(simulation) }
}

/// Sets a parameter (SI) before the start.
///
/// # Safety
/// `simulation` is a simulation that is not freed, and no other call uses it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_set(
    simulation: *mut EngSimulation,
    parameter: usize,
    value: f64,
) -> c_int {
    status(|| {
        // SAFETY: by the promise of the caller
        let simulation = unsafe { edge::changed(simulation, "simulation")? };
        let (parameter, dimension) = simulation.model.parameter(parameter)?;
        simulation.change(|builder| builder.set(parameter, Quantity::si(value, dimension)))
    })
}

/// Takes fixed steps (s).
///
/// # Safety
/// `simulation` is a simulation that is not freed, and no other call uses it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_fixed_step(simulation: *mut EngSimulation, step: f64) -> c_int {
    status(|| {
        // SAFETY: by the promise of the caller
        let simulation = unsafe { edge::changed(simulation, "simulation")? };
        simulation.change(|builder| Ok(builder.fixed_step(step)))
    })
}

/// Takes steps of a tolerance; the number scales the physical tolerances.
///
/// # Safety
/// `simulation` is a simulation that is not freed, and no other call uses it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_tolerance(simulation: *mut EngSimulation, factor: f64) -> c_int {
    status(|| {
        // SAFETY: by the promise of the caller
        let simulation = unsafe { edge::changed(simulation, "simulation")? };
        simulation.change(|builder| Ok(builder.tolerance(factor)))
    })
}

/// Assembles the model and starts the simulation.
///
/// # Safety
/// `simulation` is a simulation that is not freed, and no other call uses it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_start(simulation: *mut EngSimulation) -> c_int {
    status(|| {
        // SAFETY: by the promise of the caller
        let simulation = unsafe { edge::changed(simulation, "simulation")? };
        let started = simulation.prepared()?.clone().start()?;
        simulation.phase = Phase::Running(Box::new(started));
        Ok(())
    })
}

/// Continues from a checkpoint of the same model with the same parameters, in place of a start.
///
/// # Safety
/// `simulation` is a simulation that is not freed, and no other call uses it; `bytes` points to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_resume(
    simulation: *mut EngSimulation,
    bytes: *const u8,
    size: usize,
) -> c_int {
    status(|| {
        // SAFETY: by the promise of the caller
        let simulation = unsafe { edge::changed(simulation, "simulation")? };
        // SAFETY: by the promise of the caller
        let bytes = unsafe { edge::numbers(bytes, size, "bytes")? };
        let resumed = simulation.prepared()?.clone().resume(bytes)?;
        simulation.phase = Phase::Running(Box::new(resumed));
        Ok(())
    })
}

/// Time (s); not a number before the start.
///
/// # Safety
/// `simulation` is a simulation that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_time(simulation: *const EngSimulation) -> f64 {
    or(f64::NAN, || {
        // SAFETY: by the promise of the caller
        match &unsafe { edge::shared(simulation, "simulation")? }.phase {
            Phase::Running(simulation) => Ok(simulation.time()),
            Phase::Prepared(_) => Err(Refused::new("the simulation is not started")),
        }
    })
}

/// Sets an input (SI) from the present time on.
///
/// # Safety
/// `simulation` is a simulation that is not freed, and no other call uses it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_set_input(
    simulation: *mut EngSimulation,
    input: usize,
    value: f64,
) -> c_int {
    status(|| {
        // SAFETY: by the promise of the caller
        let simulation = unsafe { edge::changed(simulation, "simulation")? };
        let input = simulation.model.input(input)?;
        Ok(simulation.running()?.set_input(input, value)?)
    })
}

/// Gives value (SI) and rate that a `linear` or `cubic` input has at the end of the next advance. A `linear` input takes
/// the rate 0.
///
/// # Safety
/// `simulation` is a simulation that is not freed, and no other call uses it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_aim_input(
    simulation: *mut EngSimulation,
    input: usize,
    value: f64,
    rate: f64,
) -> c_int {
    status(|| {
        // SAFETY: by the promise of the caller
        let simulation = unsafe { edge::changed(simulation, "simulation")? };
        let input = simulation.model.input(input)?;
        Ok(simulation
            .running()?
            .aim_input(input, Point { value, rate })?)
    })
}

/// Steps up to a time (s), which no step crosses.
///
/// # Safety
/// `simulation` is a simulation that is not freed, and no other call uses it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_advance(simulation: *mut EngSimulation, to: f64) -> c_int {
    status(|| {
        // SAFETY: by the promise of the caller
        let simulation = unsafe { edge::changed(simulation, "simulation")? };
        simulation.running()?.advance(to)?;
        Ok(())
    })
}

/// Plans the reading of channels.
///
/// # Safety
/// `simulation` is a simulation that is not freed, and no other call uses it; `channels` points to `count` indices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_watch(
    simulation: *mut EngSimulation,
    channels: *const usize,
    count: usize,
) -> *mut EngWatch {
    object(|| {
        // SAFETY: by the promise of the caller
        let simulation = unsafe { edge::changed(simulation, "simulation")? };
        // SAFETY: by the promise of the caller
        let indices = unsafe { edge::numbers(channels, count, "channels")? };
        let channels = indices.iter().map(|index| simulation.model.channel(*index));
        let channels = channels.collect::<Result<Vec<_>, _>>()?;
        let inner = simulation.running()?.watch(&channels)?;
        Ok(EngWatch {
            inner,
            channels: count,
        })
    })
}

/// Frees a plan.
///
/// # Safety
/// `watch` is null or a plan that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_free_watch(watch: *mut EngWatch) {
    // SAFETY: by the promise of the caller
    unsafe { edge::taken(watch) }
}

/// Writes the values (SI) of the channels of a plan at the present state. `count` is their number.
///
/// # Safety
/// `simulation` and `watch` are not freed, and no other call uses them; `values` points to room for `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_values(
    simulation: *mut EngSimulation,
    watch: *mut EngWatch,
    values: *mut f64,
    count: usize,
) -> c_int {
    status(|| {
        // SAFETY: by the promise of the caller
        let (simulation, watch) = unsafe {
            (
                edge::changed(simulation, "simulation")?,
                edge::changed(watch, "watch")?,
            )
        };
        if count != watch.channels {
            return Err(Refused(format!(
                "the plan has {} channels, and there is room for {count}",
                watch.channels
            )));
        }
        // SAFETY: by the promise of the caller
        let values = unsafe { edge::room(values, count, "values")? };
        Ok(simulation.running()?.read(&mut watch.inner, values)?)
    })
}

/// The state as bytes. A simulation that continues from them gives the same bits as this one.
///
/// # Safety
/// `simulation` is a simulation that is not freed, and no other call uses it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_checkpoint(simulation: *mut EngSimulation) -> *mut EngCheckpoint {
    object(|| {
        // SAFETY: by the promise of the caller
        let simulation = unsafe { edge::changed(simulation, "simulation")? };
        let bytes = simulation.running()?.checkpoint();
        Ok(EngCheckpoint { bytes })
    })
}

/// The bytes of a checkpoint, valid until it is freed.
///
/// # Safety
/// `checkpoint` is a checkpoint that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_checkpoint_bytes(checkpoint: *const EngCheckpoint) -> *const u8 {
    or(std::ptr::null(), || {
        // SAFETY: by the promise of the caller
        Ok(unsafe { edge::shared(checkpoint, "checkpoint")? }
            .bytes
            .as_ptr())
    })
}

/// The number of its bytes.
///
/// # Safety
/// `checkpoint` is a checkpoint that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_checkpoint_size(checkpoint: *const EngCheckpoint) -> usize {
    or(0, || {
        // SAFETY: by the promise of the caller
        Ok(unsafe { edge::shared(checkpoint, "checkpoint")? }
            .bytes
            .len())
    })
}

/// Frees a checkpoint.
///
/// # Safety
/// `checkpoint` is null or a checkpoint that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_free_checkpoint(checkpoint: *mut EngCheckpoint) {
    // SAFETY: by the promise of the caller
    unsafe { edge::taken(checkpoint) }
}
