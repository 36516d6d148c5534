//! A simulation: one parameter set of a compiled model, its state, and all data to integrate it.

mod beginning;
mod demanded;
mod driving;
mod gradients;
mod kinked;
mod leaping;
mod reading;
mod resting;
mod runaway;
pub(crate) mod sampling;
mod saving;
mod step_limit;
mod stepping;
mod stopping;

use crate::acceleration::AccelerationSystem;
use crate::assembled::Assembled;
use crate::checkpoint;
use crate::control::{FixedGrid, StepSize};
use crate::dynamics::Dynamics;
pub use crate::error::{Jump, Jumping, Slow, StepLimit};
use crate::error::{Moment, RuntimeError};
use crate::field::Demand;
use crate::integrator::{Damped, Goal, Integrator, Statistics};
use crate::kinks::{Kinks, Overlooked};
use crate::linear::Pattern;
use crate::model::{LEAST_ERROR, Model, STEP_SHARE};
use crate::outputs::{Outputs, Watch};
use crate::rotation::{M3, V3};
use crate::start::{self, StartReport};
use crate::state::State;
use eng_system::analysis::{Integration, Method};
use eng_system::code::Compiled;
use eng_system::system::{Origin, Start, StepControl};
pub(crate) use gradients::Units;
pub use gradients::{Gradients, SampleGradient};
pub use leaping::Section;
pub use reading::Reading;
use runaway::Runaway;
use std::sync::OnceLock;
use step_limit::Limit;
pub use stopping::Stopped;
use stopping::Stopping;

/// Options of the integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Fixed steps, or a factor on the physical tolerances.
    pub step: StepControl,
    /// The method. The spectral radius of generalised-α must be below 1 with constraints: at 1 their multipliers have
    /// no damping and drift away after many turns.
    pub method: Method,
    /// Largest correction that ends Newton's iteration, in scaled unknowns. `None` means 1e-4 of the position
    /// tolerance over the model's length, times the factor on the tolerances if that is below 1, and at most
    /// 1e-10. The correction must also be below `GOAL` of the accelerations' share of a step.
    pub newton_tolerance: Option<f64>,
    /// Largest step under error control (s), so that a step cannot skip a short load that depends on time.
    pub max_step: f64,
    /// Whether the simulation sums up work, which costs one more evaluation in each step.
    pub energy: bool,
    /// The kind of start; see [`mod@crate::start`].
    pub start: Start,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            step: StepControl::Tolerance(1.0),
            method: Method::default(),
            newton_tolerance: None,
            // a choice: a load of tens of milliseconds is seen, and slow motions still take few steps
            max_step: 0.01,
            energy: true,
            start: Start::Assembled,
        }
    }
}

impl From<Integration> for Options {
    fn from(stated: Integration) -> Options {
        let Integration {
            step,
            method,
            start,
        } = stated;
        Options {
            step,
            method,
            start,
            ..Options::default()
        }
    }
}

/// One accepted step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Time reached (s).
    pub time: f64,
    /// Length of the step (s).
    pub step: f64,
}

/// Energy and work since the start (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Potential of gravity.
    pub gravity: f64,
    /// Strain energy of flexible bodies.
    pub strain: f64,
    /// Energy lost in the damping of flexible bodies.
    pub damping: f64,
    /// Work of the elements' loads on the bodies.
    pub loads: f64,
    /// Work of the constraints on the bodies: that of drives.
    pub constraints: f64,
    /// Kinetic and strain energy plus gravity's potential at the start.
    pub start: f64,
}

impl Energy {
    /// Energy without a source: zero up to the integrator's error.
    pub fn imbalance(&self) -> f64 {
        self.kinetic + self.gravity + self.strain - self.start + self.damping
            - self.loads
            - self.constraints
    }
}

/// The label of a failed `advise`.
pub const FAILS: &str = "the condition fails here";

/// A failed `advise`, or a doubt about gradients.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// The name of the lint for `accept`; empty without a name.
    pub name: String,
    /// The element and the place of the condition.
    pub origin: Origin,
    /// The author's message.
    pub message: String,
    /// The label at its place.
    pub label: &'static str,
    /// The first moment of the failure.
    pub moment: Moment,
}

/// A simulation. It owns its state, so simulations in several threads give the same bits.
#[derive(Debug)]
pub struct Simulation {
    model: Model,
    options: Options,
    integrator: Integrator,
    dynamics: Dynamics,
    system: AccelerationSystem,
    outputs: Outputs,
    cycle: Option<Outputs>,
    watch: Watch,
    /// The condition that ends the run.
    stopping: Option<Stopping>,
    kinks: Kinks,
    /// The kink at which the last step ended.
    at_kink: Option<usize>,
    /// The change of accelerations (in model lengths, 1/s²) after this kink, if they jump there; otherwise 0.
    jump_at_kink: f64,
    /// The step (s) before a kink, until steps are as long again; otherwise zero.
    before_kink: f64,
    /// The kink that a fixed step overlooked most.
    overlooked: Option<Overlooked>,
    /// How often the motion began again at a jump of accelerations.
    renewals: u64,
    /// The state of the last outputs, projected and completed.
    completed: State,
    /// Time of the state in `completed` whose outputs are evaluated.
    evaluated: Option<u64>,
    work: Vec<f64>,
    rest: Vec<f64>,
    pose: Vec<f64>,
    rows: Vec<f64>,
    size: StepSize,
    grid: FixedGrid,
    /// The reason for the length of the last step.
    limit: Limit,
    /// The last failure at a table's end, until a step succeeds at once.
    undefined: Option<Box<RuntimeError>>,
    energy: Energy,
    /// Works of loads and of constraints, and the loss in flexible bodies (J), at the beginning of the last
    /// step.
    energy_before: [f64; 3],
    /// Energy at the state of the last outputs.
    sampled_energy: Energy,
    /// Powers of loads and of constraints, and the power lost in flexible bodies, at the last accepted state
    /// and at the one before.
    powers: [f64; 3],
    earlier_powers: [f64; 3],
    /// Length of the last step (s), zero before the first.
    earlier_step: f64,
    cycle_now: Option<[f64; 2]>,
    /// Cycle angle and rate of the dense output at both ends of the last step, if a sample asked for them.
    cycle_at_ends: Option<[[f64; 2]; 2]>,
    cycle_start: f64,
    runaway: Runaway,
    advised: Vec<bool>,
    /// Names and places of failed `advise`s on parameters that follow inputs, since the start or the resumption.
    advised_inputs: Vec<(String, Origin)>,
    warnings: Vec<Warning>,
    /// The fingerprint of the model and its parameters. It is made at the first use, because its text is long
    /// and most runs write no checkpoint.
    fingerprint: OnceLock<u64>,
    start: StartReport,
}

impl Simulation {
    /// Binds parameters and assembles the model. `overrides` has one entry for each parameter, `None` for its
    /// default; an empty slice means all defaults.
    pub fn new(
        compiled: &Compiled,
        overrides: &[Option<f64>],
        options: Options,
    ) -> Result<Simulation, RuntimeError> {
        let (model, state) = assembled(compiled, overrides, &options)?;
        Simulation::started(model, state, options)
    }

    /// A simulation of an assembled model.
    ///
    /// # Errors
    /// As [`Simulation::new`], without those of the assembly.
    pub fn of(assembled: &Assembled, options: Options) -> Result<Simulation, RuntimeError> {
        check(&options, assembled.model())?;
        let (model, state) = assembled.independent()?;
        Simulation::started(model, state, options)
    }

    fn started(
        model: Model,
        mut state: State,
        options: Options,
    ) -> Result<Simulation, RuntimeError> {
        let start = start::begin(&model, &mut state, options.start)?;
        Simulation::begun(model, state, options, start)
    }

    /// A simulation that begins in a state of an assembled model.
    pub(crate) fn begun(
        model: Model,
        state: State,
        options: Options,
        start: StartReport,
    ) -> Result<Simulation, RuntimeError> {
        let mut simulation = Simulation::with_state(model, state, options)?;
        simulation.start = start;
        simulation.begin()?;
        Ok(simulation)
    }

    /// A simulation of the same model and options with another first state.
    pub(crate) fn restarted(&self, state: State) -> Result<Simulation, RuntimeError> {
        let mut simulation = Simulation::with_state(self.model.clone(), state, self.options)?;
        simulation.warnings.clear();
        simulation.start = self.start.clone();
        simulation.begin()?;
        Ok(simulation)
    }

    fn with_state(
        model: Model,
        state: State,
        options: Options,
    ) -> Result<Simulation, RuntimeError> {
        let goal = goal(&model, &options);
        let cycle = match &model.compiled.system.cycle {
            Some(c) => Some(Outputs::watching(&model, c.element as usize)?),
            None => None,
        };
        let conditions: usize = (0..model.elements.len())
            .map(|e| model.class(e).conditions.len())
            .sum();
        let mut warnings = Vec::new();
        for advice in &model.advice {
            warnings.push(Warning {
                name: advice.name.clone(),
                origin: advice.origin.clone(),
                message: advice.message.clone(),
                label: FAILS,
                moment: Moment {
                    time: state.time,
                    cycle_angle: None,
                },
            });
        }
        use eng_system::system::Role;
        let roles: Vec<Role> = model
            .compiled
            .system
            .elements
            .iter()
            .map(|e| e.role)
            .collect();
        let dynamics = Dynamics::new(&model);
        Ok(Simulation {
            integrator: Integrator::new(&model, &state, options.method, goal)?,
            kinks: Kinks::new(&model, dynamics.batches()),
            overlooked: None,
            renewals: 0,
            at_kink: None,
            jump_at_kink: 0.0,
            before_kink: 0.0,
            dynamics,
            system: AccelerationSystem::new(&model)?,
            outputs: Outputs::all(&model)?,
            cycle,
            stopping: Stopping::new(&model),
            watch: Watch::new(&model, |e| matches!(roles[e], Role::Dynamic | Role::Output)),
            work: vec![0.0; model.velocities],
            rest: vec![0.0; model.velocities],
            pose: vec![0.0; model.poses],
            rows: vec![0.0; model.rows],
            size: StepSize::default(),
            grid: FixedGrid::default(),
            limit: Limit::default(),
            undefined: None,
            energy: Energy::default(),
            energy_before: [0.0; 3],
            sampled_energy: Energy::default(),
            powers: [0.0; 3],
            earlier_powers: [0.0; 3],
            earlier_step: 0.0,
            cycle_now: None,
            cycle_at_ends: None,
            cycle_start: 0.0,
            runaway: Runaway::begin(&model, &state),
            advised: vec![false; conditions],
            advised_inputs: (model.advice.iter())
                .map(|advice| (advice.name.clone(), advice.origin.clone()))
                .collect(),
            warnings,
            evaluated: None,
            fingerprint: OnceLock::new(),
            start: StartReport::Assembled,
            completed: state,
            options,
            model,
        })
    }

    /// The `checkpoint::fingerprint` of its model.
    fn fingerprint(&self) -> u64 {
        *(self.fingerprint).get_or_init(|| checkpoint::fingerprint(&self.model))
    }

    fn moment(&self) -> Moment {
        Moment {
            time: self.integrator.current.time,
            cycle_angle: self.cycle_now.map(|c| c[0]),
        }
    }

    /// Adds the cycle angle to errors that have only the time.
    fn at_moment(&self, mut error: RuntimeError) -> RuntimeError {
        let angle = self.cycle_now.map(|c| c[0]);
        if let RuntimeError::NotFinite { moment, .. } = &mut error {
            moment.cycle_angle = angle;
        }
        error
    }

    /// Time of the last accepted state (s).
    pub fn time(&self) -> f64 {
        self.integrator.current.time
    }

    /// Unwrapped cycle angle (rad), if the model has a cycle.
    pub fn cycle_angle(&self) -> Option<f64> {
        self.cycle_now.map(|c| c[0])
    }

    /// Rate of the cycle angle (rad/s).
    pub fn cycle_rate(&self) -> Option<f64> {
        self.cycle_now.map(|c| c[1])
    }

    /// Cycle angle at the start (rad).
    pub fn cycle_start(&self) -> f64 {
        self.cycle_start
    }

    /// Energy and work at the last accepted state.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    /// Energy and work at the state of the last outputs.
    pub fn sampled_energy(&self) -> Energy {
        self.sampled_energy
    }

    /// The report on the start.
    pub fn start(&self) -> &StartReport {
        &self.start
    }

    /// e of every journal (m): the pin's origin from the shell's, along the shell's x and y, at the state of
    /// the last outputs.
    pub fn eccentricities(&self) -> Vec<[f64; 2]> {
        start::eccentricity::eccentricities(&self.model, &self.completed.pose)
    }

    /// For each body r (m), unit quaternion, modal amplitudes, at the state of the last outputs.
    pub fn sampled_pose(&self) -> &[f64] {
        &self.completed.pose
    }

    /// The numbers with which the fields were solved at the state of the last outputs: see [`Sample::fields`].
    ///
    /// [`Sample::fields`]: crate::Sample::fields
    pub fn sampled_fields(&self) -> Vec<f64> {
        self.outputs.fields()
    }

    /// Counts of work.
    pub fn statistics(&self) -> Statistics {
        self.integrator.statistics
    }

    /// The body that lost the largest share of its energy to the numerical damping of the steps, if this
    /// share needs a warning.
    pub fn damped(&self) -> Option<Damped> {
        self.integrator.damped(&self.model)
    }

    /// The kink that a fixed step overlooked most, in multiples of its limit, since the start or the resumption.
    pub fn overlooked(&self) -> Option<&Overlooked> {
        self.overlooked.as_ref()
    }

    /// Warnings since the last call.
    pub fn take_warnings(&mut self) -> Vec<Warning> {
        std::mem::take(&mut self.warnings)
    }

    /// The bound model: values of parameters, counts, scales.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The last accepted state of the integrator, without projection.
    pub fn state(&self) -> &State {
        &self.integrator.current
    }

    /// Position (m) and orientation (body → inertial) of a body at the last accepted state.
    pub fn body_pose(&self, body: usize) -> Option<(V3, M3)> {
        let frame = self
            .model
            .bodies
            .get(body)?
            .frame(&self.integrator.current.pose);
        Some((frame.position, frame.rotation))
    }

    /// Unknowns of a step: scaled increments, states, multipliers.
    pub fn unknowns(&self) -> usize {
        self.integrator.unknowns()
    }

    /// The scaled unknowns at which Newton's iteration of a step h (s) from here begins.
    pub fn predicted(&mut self, step: f64, out: &mut [f64]) -> Result<(), RuntimeError> {
        self.room(out.len())?;
        self.integrator.predict(&self.model, step, true);
        out.copy_from_slice(self.integrator.trial());
        Ok(())
    }

    /// Scaled residual of a step h (s) from the last accepted state at scaled unknowns.
    pub fn residual(
        &mut self,
        step: f64,
        unknowns: &[f64],
        out: &mut [f64],
    ) -> Result<(), RuntimeError> {
        self.room(out.len())?;
        self.try_unknowns(step, unknowns, false)?;
        out.copy_from_slice(self.integrator.last_residual());
        Ok(())
    }

    /// Derivative of [`Simulation::residual`] with respect to the scaled unknowns: its pattern and values.
    pub fn jacobian(
        &mut self,
        step: f64,
        unknowns: &[f64],
    ) -> Result<(&Pattern, &[f64]), RuntimeError> {
        self.try_unknowns(step, unknowns, true)?;
        Ok((self.integrator.pattern(), self.integrator.values()))
    }

    /// Evaluates the residual of a step h (s) at scaled unknowns, and the matrix if it is `filled`.
    fn try_unknowns(
        &mut self,
        step: f64,
        unknowns: &[f64],
        filled: bool,
    ) -> Result<(), RuntimeError> {
        self.room(unknowns.len())?;
        // samples of the last step still need the memory at its beginning
        let kept = self.dynamics.memory().clone();
        self.dynamics.memory_mut().begin_step();
        self.integrator.predict(&self.model, step, true);
        self.integrator.set_trial(unknowns);
        let (model, dynamics) = (&self.model, &mut self.dynamics);
        let mut tried = (self.integrator).evaluate(model, dynamics, step, Demand::Answers);
        if filled && tried.is_ok() {
            tried = self.integrator.fill(model, dynamics, step);
        }
        *self.dynamics.memory_mut() = kept;
        tried
    }

    fn room(&self, length: usize) -> Result<(), RuntimeError> {
        if length == self.integrator.unknowns() {
            Ok(())
        } else {
            Err(RuntimeError::Options {
                message: format!(
                    "{length} unknowns are given; a step has {}",
                    self.integrator.unknowns()
                ),
            })
        }
    }
}

/// Binds and assembles a model whose constraints are independent of each other.
pub(crate) fn assembled(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    options: &Options,
) -> Result<(Model, State), RuntimeError> {
    let model = Model::bind(compiled, overrides)?;
    check(options, &model)?;
    Assembled::of(model)?.independent()
}

/// Share of the accelerations' contribution to a step that Newton's iteration may leave at the usual
/// tolerance. Ten times this value is visible in small reactions (in inline4 1.6e-3 of their swing).
pub const GOAL: f64 = 1e-9;
/// Least such share above rounding: about ten rounding units.
const LEAST_GOAL: f64 = 1e-15;

/// The limits of Newton's iteration; see [`Options::newton_tolerance`]. A factor above 1 on the tolerances
/// does not widen them, because it should save steps and not iterations. The absolute limit is a choice: a
/// thousandth of the error that a step may have ([`STEP_SHARE`]), and in models with coarse positions 1e-10
/// of the length.
fn goal(model: &Model, options: &Options) -> Goal {
    let factor = options.step.tolerance().min(1.0);
    Goal {
        absolute: options
            .newton_tolerance
            .unwrap_or((1e-4 * model.tolerance / model.length * factor).min(1e-10)),
        relative: GOAL * factor,
    }
}

/// The least factor on the tolerances above rounding.
fn least_tolerance(model: &Model, step: StepControl) -> f64 {
    match step {
        StepControl::Fixed(_) => 0.0,
        StepControl::FixedTo { .. } => LEAST_GOAL / GOAL,
        StepControl::Tolerance(_) => LEAST_ERROR * model.length / (STEP_SHARE * model.tolerance),
    }
}

fn check(options: &Options, model: &Model) -> Result<(), RuntimeError> {
    let refuse = |message: String| Err(RuntimeError::Options { message });
    let rho_infinity = options.method.rho_infinity();
    if !(0.0..=1.0).contains(&rho_infinity) {
        return refuse(format!(
            "the spectral radius at infinite frequency is {rho_infinity}; it must be from 0 to 1"
        ));
    }
    if rho_infinity == 1.0 && model.rows > 0 {
        return refuse(
            "a spectral radius of 1 at infinite frequency damps no error of the constraints' multipliers, which then \
             grows over many turns; take one below 1, such as 0.95"
                .into(),
        );
    }
    let system = &model.compiled.system;
    let journal = system.journals.first().map(|j| j.element as usize);
    let film = journal.or_else(|| model.kernels.iter().position(|kernels| !kernels.is_empty()));
    if let (Method::Radau, Some(element)) = (options.method, film) {
        return refuse(format!(
            "{} is a film, which answers at once to the small errors of velocities that `integrator: radau` leaves, so small reactions \
             would be wrong: leave `integrator` out",
            system.elements[element].origin.path
        ));
    }
    if options.max_step.is_nan() || options.max_step <= 0.0 {
        return refuse(format!(
            "the largest step is {}; it must be positive",
            options.max_step
        ));
    }
    let tolerance = options.step.tolerance();
    for (name, value) in [
        ("step", options.step.fixed().unwrap_or(1.0)),
        ("tolerance", tolerance),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return refuse(format!("the {name} is {value}; it must be positive"));
        }
    }
    let least = least_tolerance(model, options.step);
    if tolerance < least {
        return Err(RuntimeError::Rounding {
            moment: None,
            tolerance,
            // half more than the limit, so that a tolerance rounded down from the message still passes
            least: 1.5 * least,
        });
    }
    Ok(())
}
