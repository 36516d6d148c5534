//! Simulations of a model, step by step, for programs that embed Eng.

use crate::model::{Channel, Input, Model, Parameter};
use crate::{Error, Quantity, Report, failure};
use eng_grammar::{Diagnostic, Diagnostics};
use eng_runtime::inputs::Point;
use eng_runtime::linearised::{LinearModes, StateSpace, Wanted};
use eng_runtime::{Energy, Options, Reading, RuntimeError, Statistics};
use eng_system::code::Bound;
use eng_system::system::{Method, Start, StepControl};
use std::ops::ControlFlow;

/// Parameters and options of a simulation before its start.
#[derive(Clone, Debug)]
pub struct SimulationBuilder {
    model: Model,
    overrides: Vec<Option<f64>>,
    options: Options,
}

impl Model {
    /// Prepares a simulation. Set its parameters, then start it.
    pub fn simulation(&self) -> SimulationBuilder {
        SimulationBuilder::new(self.clone())
    }
}

impl SimulationBuilder {
    pub(crate) fn new(model: Model) -> SimulationBuilder {
        let overrides = vec![None; model.compiled().system.parameters.len()];
        let options = Options {
            start: Start::Automatic,
            ..Options::default()
        };
        SimulationBuilder::with(model, overrides, options)
    }

    pub(crate) fn with(
        model: Model,
        overrides: Vec<Option<f64>>,
        options: Options,
    ) -> SimulationBuilder {
        SimulationBuilder {
            model,
            overrides,
            options,
        }
    }

    /// Its model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Sets a parameter; the dimension must fit.
    pub fn set(mut self, parameter: Parameter, value: Quantity) -> Result<Self, Error> {
        self.overrides[parameter.index] = Some(self.model.checked(parameter, value)?);
        Ok(self)
    }

    /// Error control; the number scales the physical tolerances, 1 is the default.
    pub fn tolerance(mut self, factor: f64) -> Self {
        self.options.step = StepControl::Tolerance(factor);
        self
    }

    /// Fixed steps (s).
    pub fn fixed_step(mut self, step: f64) -> Self {
        self.options.step = StepControl::Fixed(step);
        self
    }

    /// Fixed steps (s) whose equations are solved to a factor on the tolerances, which is 1 in
    /// [`Self::fixed_step`].
    pub fn fixed_step_to(mut self, step: f64, tolerance: f64) -> Self {
        self.options.step = StepControl::FixedTo { step, tolerance };
        self
    }

    /// Fixed steps, or steps of a tolerance.
    pub fn stepping(mut self, control: StepControl) -> Self {
        self.options.step = control;
        self
    }

    /// The values (SI) of all parameters, in the order of [`Model::parameters`].
    ///
    /// # Errors
    /// Parameters that the model refuses.
    pub fn parameter_values(&self) -> Result<Vec<f64>, Error> {
        Ok(self.bound()?.parameters)
    }

    /// The values of all slots and parameters.
    pub(crate) fn bound(&self) -> Result<Bound, Error> {
        let compiled = self.model.compiled();
        let bound = compiled.bind.bind(&self.overrides, &compiled.system.tables);
        bound.map_err(|cause| run_error(&self.model, cause.into()))
    }

    /// Spectral radius at infinite frequency, 0…1 (default 0.8). 1 gives no damping and is refused with
    /// constraints.
    pub fn rho_infinity(self, rho: f64) -> Self {
        self.method(Method::GeneralisedAlpha { rho_infinity: rho })
    }

    /// The method of integration (default generalised-α).
    pub fn method(mut self, method: Method) -> Self {
        self.options.method = method;
        self
    }

    /// The kind of start. The default is quasi-static if a cycle turns and the model has journals or flexible
    /// bodies.
    pub fn start_from(mut self, start: Start) -> Self {
        self.options.start = start;
        self
    }

    /// Binds the parameters and assembles positions and velocities.
    pub fn start(self) -> Result<Simulation, Error> {
        match eng_runtime::Simulation::new(self.model.compiled(), &self.overrides, self.options) {
            Ok(inner) => Ok(Simulation {
                inner,
                model: self.model,
            }),
            Err(cause) => Err(run_error(&self.model, cause)),
        }
    }

    /// Continues from a checkpoint of the same model with the same parameters. The bits are those of the
    /// uninterrupted run.
    pub fn resume(self, checkpoint: &[u8]) -> Result<Simulation, Error> {
        let resumed = eng_runtime::Simulation::resume(
            self.model.compiled(),
            &self.overrides,
            self.options,
            checkpoint,
        );
        match resumed {
            Ok(inner) => Ok(Simulation {
                inner,
                model: self.model,
            }),
            Err(cause) => Err(run_error(&self.model, cause)),
        }
    }

    /// Freedoms and equations that repeat each other, at the assembled position.
    pub fn topology(self) -> Result<eng_runtime::TopologyReport, Error> {
        eng_runtime::Assembled::new(self.model.compiled(), &self.overrides)
            .and_then(|assembled| assembled.topology().cloned())
            .map_err(|cause| run_error(&self.model, cause))
    }
}

/// A failure of the runtime with its places in the model's texts.
pub(crate) fn run_error(model: &Model, cause: RuntimeError) -> Error {
    run_error_with(model, cause, |message| message)
}

/// [`run_error`] with an addition to the message.
pub(crate) fn run_error_with(
    model: &Model,
    cause: RuntimeError,
    added: impl FnOnce(Diagnostic) -> Diagnostic,
) -> Error {
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(added(failure::diagnostic(&cause, &model.compiled().system)));
    Error::Run {
        report: Report::new(model.texts().clone(), diagnostics),
        cause: Box::new(cause),
    }
}

/// A running simulation. It owns its state, so simulations in several threads give the same bits.
#[derive(Debug)]
pub struct Simulation {
    inner: eng_runtime::Simulation,
    model: Model,
}

impl Simulation {
    /// One accepted step; returns the time reached (s).
    pub fn step(&mut self) -> Result<f64, Error> {
        match self.inner.step() {
            Ok(report) => Ok(report.time),
            Err(cause) => Err(run_error(&self.model, cause)),
        }
    }

    /// Steps up to a time (s), which no step crosses; returns the time reached. Fixed steps keep their grid, so
    /// the time reached can differ from `to` by rounding. The condition of an analysis with `stop` ends the steps earlier
    /// ([`Simulation::stopped`]).
    ///
    /// # Errors
    /// A time that is not later than the present one; those of a step.
    pub fn advance(&mut self, to: f64) -> Result<f64, Error> {
        match self.inner.advance(to) {
            Ok(report) => Ok(report.time),
            Err(cause) => Err(run_error(&self.model, cause)),
        }
    }

    /// Refuses a time (s) to which [`Simulation::advance`] cannot go, and changes nothing.
    ///
    /// # Errors
    /// A time that is not later than the present one, or that is so near that numbers resolve no motion until then.
    pub fn may_advance(&self, to: f64) -> Result<(), Error> {
        let may = self.inner.may_advance(to);
        may.map_err(|cause| run_error(&self.model, cause))
    }

    /// [`Simulation::advance`] as long as `watch` allows, which gets the time (s) after each step but the last. After a `Break`
    /// the simulation stays at the end of that step. To advance to the same time later gives the bits of one call.
    ///
    /// # Errors
    /// Those of [`Simulation::advance`].
    pub fn advance_while(
        &mut self,
        to: f64,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<f64, Error> {
        match self.inner.advance_while(to, watch) {
            Ok(report) => Ok(report.time),
            Err(cause) => Err(run_error(&self.model, cause)),
        }
    }

    /// Sets an input (SI) from the present time on.
    ///
    /// # Errors
    /// An input of another model; a value outside the limits of the input, or not finite; a jump of a cubic input
    /// after the start; an input that the analysis drives.
    pub fn set_input(&mut self, input: Input, value: impl Into<Point>) -> Result<(), Error> {
        let index = self.model.index_of_input(input)?;
        let set = self.inner.set_input(index, value.into());
        set.map_err(|cause| run_error(&self.model, cause))
    }

    /// Sets an input from the present time on; the dimension must fit.
    pub fn set_quantity(&mut self, input: Input, value: Quantity) -> Result<(), Error> {
        let value = self.model.checked(input.parameter(), value)?;
        self.set_input(input, value)
    }

    /// Gives the value (SI) that a `linear` or `cubic` input has at the end of the next [`Simulation::advance`].
    pub fn aim_input(&mut self, input: Input, value: impl Into<Point>) -> Result<(), Error> {
        let index = self.model.index_of_input(input)?;
        let aimed = self.inner.aim_input(index, value.into());
        aimed.map_err(|cause| run_error(&self.model, cause))
    }

    /// Time (s).
    pub fn time(&self) -> f64 {
        self.inner.time()
    }

    /// The condition of the analysis that has ended the simulation, with the moment at which it begins to hold. The simulation
    /// stands there, and refuses further steps.
    pub fn stopped(&self) -> Option<eng_runtime::Stopped> {
        self.inner.stopped()
    }

    /// Unwrapped cycle angle, if the model has a cycle.
    pub fn cycle_angle(&self) -> Option<Quantity> {
        self.inner
            .cycle_angle()
            .map(|a| Quantity::si(a, eng_system::Dimension::ANGLE))
    }

    /// A channel at the current state (SI).
    pub fn value(&mut self, channel: Channel) -> Result<f64, Error> {
        let index = self.model.index_of(channel)?;
        self.inner
            .value(index)
            .map_err(|cause| run_error(&self.model, cause))
    }

    /// All channels at the current state (SI), in the order of [`Model::channels`]; `out` has one place for
    /// each.
    pub fn values(&mut self, out: &mut [f64]) -> Result<(), Error> {
        self.inner
            .evaluate_channels(out)
            .map_err(|cause| run_error(&self.model, cause))
    }

    /// A plan for reading channels: only their elements are evaluated, and only as deep as they need.
    pub fn watch(&self, channels: &[Channel]) -> Result<Reading, Error> {
        let indices = channels.iter().map(|channel| self.model.index_of(*channel));
        let indices = indices.collect::<Result<Vec<_>, _>>()?;
        self.inner
            .reading(&indices)
            .map_err(|cause| run_error(&self.model, cause))
    }

    /// Values of the channels of a plan at the current state (SI), in their order. The bits are those of
    /// [`Simulation::value`]. It allocates nothing.
    pub fn read(&mut self, watch: &mut Reading, out: &mut [f64]) -> Result<(), Error> {
        self.inner
            .read(watch, out)
            .map_err(|cause| run_error(&self.model, cause))
    }

    /// The report on the start.
    pub fn started(&self) -> &eng_runtime::StartReport {
        self.inner.start()
    }

    /// Energy and work since the start.
    pub fn energy(&self) -> Energy {
        self.inner.energy()
    }

    /// Steps, iterations, factorisations.
    pub fn statistics(&self) -> Statistics {
        self.inner.statistics()
    }

    /// Eigenvalues and modes of the motion linearised about the current state.
    pub fn linear_modes(&mut self, wanted: Wanted) -> Result<LinearModes, Error> {
        let mut values = vec![0.0; self.model.compiled().system.channels.len()];
        self.inner
            .evaluate_channels(&mut values)
            .and_then(|()| self.inner.sampled_modes(wanted))
            .map_err(|cause| run_error(&self.model, cause))
    }

    /// The matrices of small motions about the current state under `inputs`: `ξ̇ = A ξ + B u`,
    /// `y = C ξ + D u`, in SI. Coefficients that change along the motion are an error, unless they are held
    /// at the moment (`frozen`).
    ///
    /// # Errors
    /// Handles of another model; states that `linear` refuses; an input that the analysis drives, or whose effect has a
    /// kink at its present value.
    pub fn state_space(
        &mut self,
        inputs: &[Input],
        outputs: &[Channel],
        frozen: bool,
    ) -> Result<StateSpace, Error> {
        let inputs = inputs.iter().map(|input| self.model.index_of_input(*input));
        let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
        let outputs = outputs.iter().map(|channel| self.model.index_of(*channel));
        let outputs = outputs.collect::<Result<Vec<_>, _>>()?;
        let mut values = vec![0.0; self.model.compiled().system.channels.len()];
        self.inner
            .evaluate_channels(&mut values)
            .and_then(|()| self.inner.sampled_state_space(&inputs, &outputs, frozen))
            .map_err(|cause| run_error(&self.model, cause))
    }

    /// The state as bytes. A simulation resumed from them gives the same bits as this one.
    pub fn checkpoint(&mut self) -> Vec<u8> {
        self.inner.checkpoint()
    }

    /// The runtime's own simulation: residual, Jacobian, poses.
    pub fn runtime(&mut self) -> &mut eng_runtime::Simulation {
        &mut self.inner
    }
}
