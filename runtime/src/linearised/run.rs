//! From a model to its modes: the start, the transient to the state, the linearisation.

use super::floquet::about_an_orbit;
use super::state_space::state_space;
use super::{LinearModes, StateSpace, Wanted, linearise};
use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::simulation::{Options, Simulation, Slow, Warning};
use crate::transient::{Advance, Observer, PATIENCE, Sample, Verdict, follow};
use eng_system::analysis::{Named, Names};
use eng_system::code::Compiled;
use eng_system::system::{Extent, Linear};
use std::ops::ControlFlow;

/// Share of the transient in the progress, if a period follows. A choice: the integration of a period with
/// its matrices takes longer.
const BEFORE: f64 = 0.25;

/// Linearises about the state of an analysis. `observer` gets start, progress and warnings, and no samples.
pub fn run_linear(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    linear: &Linear,
    observer: &mut dyn Observer,
) -> Result<LinearModes, RuntimeError> {
    let options = Options::from(linear.integration);
    let mut simulation = Simulation::new(compiled, overrides, options)?;
    observer.started(simulation.start());
    let wanted = Wanted {
        number: linear.number,
        up_to: linear.up_to,
        frozen: linear.frozen,
    };
    let mut values = vec![0.0; compiled.system.channels.len()];
    simulation.evaluate_channels(&mut values)?;
    let all = observer;
    // a period after the transient takes longer than the transient
    let part = if linear.over.is_some() { BEFORE } else { 1.0 };
    let observer = &mut Stretch::new(all, 0.0, part);
    match linear.after {
        None => {}
        Some(Extent::Time(end)) => {
            if !(end > 0.0 && end.is_finite()) {
                return Err(RuntimeError::Options {
                    message: format!("`after` is {end} s; it must be positive"),
                });
            }
            while simulation.time() < end {
                simulation.step_within(end)?;
                report(&mut simulation, observer, |s| s.time() / end)?;
            }
            simulation.evaluate_channels(&mut values)?;
        }
        Some(Extent::Angle(angle)) => turn_by(&mut simulation, angle, &mut values, observer)?,
    }
    for warning in simulation.take_warnings() {
        observer.warning(&warning);
    }
    let modes = match linear.over {
        None => LinearModes {
            matrices: matrices(&mut simulation, linear)?,
            ..simulation.sampled_modes(wanted)?
        },
        Some(over) => {
            let mut rest = Stretch::new(all, part, 1.0);
            about_an_orbit(
                &mut simulation,
                over,
                linear.integration.step,
                wanted,
                &mut rest,
            )?
        }
    };
    follow(&simulation, all, &Advance::new(&simulation, 1.0), true)?;
    Ok(modes)
}

/// The matrices about the state of the last outputs, if the analysis names inputs and outputs.
fn matrices(
    simulation: &mut Simulation,
    linear: &Linear,
) -> Result<Option<StateSpace>, RuntimeError> {
    if linear.inputs.is_empty() || linear.outputs.is_empty() {
        return Ok(None);
    }
    let system = &simulation.model().compiled.system;
    let find = |names: Names, named: &[Named]| {
        names
            .indices(named, &system.paths_of(names))
            .map_err(|misnamed| RuntimeError::Options {
                message: match named.get(misnamed.index) {
                    Some(name) => format!("{} names no input or channel of its own", name.path),
                    None => "a name is missing".to_owned(),
                },
            })
    };
    let inputs = find(Names::Inputs, &linear.inputs)?;
    let outputs = find(Names::Channels, &linear.outputs)?;
    simulation
        .sampled_state_space(&inputs, &outputs, linear.frozen)
        .map(Some)
}

/// An observer of one stretch of the run. It maps the progress of the stretch to a part of the whole, 0…1.
pub(super) struct Stretch<'a> {
    inner: &'a mut dyn Observer,
    from: f64,
    to: f64,
}

impl<'a> Stretch<'a> {
    pub fn new(inner: &'a mut dyn Observer, from: f64, to: f64) -> Stretch<'a> {
        Stretch { inner, from, to }
    }
}

impl Observer for Stretch<'_> {
    fn sample(&mut self, sample: &Sample<'_>) -> ControlFlow<()> {
        self.inner.sample(sample)
    }

    fn progress(&mut self, advance: &Advance) -> Verdict {
        let fraction = self.from + (self.to - self.from) * advance.fraction;
        self.inner.progress(&Advance {
            fraction,
            ..*advance
        })
    }

    fn short_steps(&mut self, slow: &Slow) {
        self.inner.short_steps(slow);
    }

    fn warning(&mut self, warning: &Warning) {
        self.inner.warning(warning);
    }
}

fn report(
    simulation: &mut Simulation,
    observer: &mut dyn Observer,
    part: impl Fn(&Simulation) -> f64,
) -> Result<(), RuntimeError> {
    for warning in simulation.take_warnings() {
        observer.warning(&warning);
    }
    let advance = Advance::new(simulation, part(simulation));
    follow(simulation, observer, &advance, false)
}

/// Steps until the cycle has turned by an angle (rad), and evaluates the outputs there.
pub(super) fn turn_by(
    simulation: &mut Simulation,
    angle: f64,
    values: &mut [f64],
    observer: &mut dyn Observer,
) -> Result<(), RuntimeError> {
    if simulation.cycle_angle().is_none() {
        return Err(RuntimeError::NoCycle);
    }
    if !(angle > 0.0 && angle.is_finite()) {
        return Err(RuntimeError::Options {
            message: format!("`after` is {:.6}°; it must be positive", angle.to_degrees()),
        });
    }
    let start = simulation.cycle_start();
    let sense = match simulation.cycle_rate() {
        Some(rate) if rate < 0.0 => -1.0,
        _ => 1.0,
    };
    let done = |s: &Simulation| (s.cycle_angle().unwrap_or(start) - start) * sense;
    let (mut farthest, mut standing) = (f64::NEG_INFINITY, 0);
    loop {
        simulation.step()?;
        report(simulation, observer, |s| done(s) / angle)?;
        let now = done(simulation);
        if now >= angle {
            simulation.sample_at_angle(start + sense * angle, values)?;
            return Ok(());
        }
        // progress of less than a billionth of a radian is rounding
        if now > farthest + 1e-9 {
            (farthest, standing) = (now, 0);
            continue;
        }
        standing += 1;
        if standing > PATIENCE {
            return Err(RuntimeError::CycleStands {
                moment: Moment {
                    time: simulation.time(),
                    cycle_angle: simulation.cycle_angle(),
                },
                angle: start + sense * farthest,
            });
        }
    }
}

impl Simulation {
    /// Linearises about the state of the last outputs, which [`Simulation::evaluate_channels`],
    /// [`Simulation::sample_at`] and others set.
    pub fn sampled_modes(&mut self, wanted: Wanted) -> Result<LinearModes, RuntimeError> {
        let state = self.sampled_state().clone();
        let cycle = self.sampled_cycle()?;
        let moment = Moment {
            time: state.time,
            cycle_angle: cycle.map(|[angle, _]| angle),
        };
        let modes = linearise(&self.present()?, &state, moment, wanted)?;
        Ok(LinearModes {
            cycle_speed: cycle.map(|[_, speed]| speed),
            ..modes
        })
    }

    /// The matrices of small motions about the state of the last outputs, under `inputs` and with `channels`
    /// as outputs. Coefficients that change along the motion are an error unless they are held at the moment
    /// (`frozen`).
    pub fn sampled_state_space(
        &mut self,
        inputs: &[usize],
        channels: &[usize],
        frozen: bool,
    ) -> Result<StateSpace, RuntimeError> {
        let state = self.sampled_state().clone();
        let cycle = self.sampled_cycle()?;
        let moment = Moment {
            time: state.time,
            cycle_angle: cycle.map(|[angle, _]| angle),
        };
        for input in inputs {
            self.refuse_driven(*input)?;
        }
        state_space(&self.present()?, &state, moment, (inputs, channels), frozen)
    }

    /// The model with the present values of the inputs that a program sets.
    fn present(&self) -> Result<Model, RuntimeError> {
        let model = self.model();
        let Some(overrides) = self.present_inputs() else {
            return Ok(model.clone());
        };
        let mut present = Model::bind(&model.compiled, &overrides)?;
        // inputs decide no geometry, and the ground markers have their places
        present.markers.clone_from(&model.markers);
        Ok(present)
    }
}
