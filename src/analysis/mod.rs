//! Running the analyses of a program.

mod choose;
mod gradients;
mod identity;
mod motion;
mod run;

use crate::lint::{self, Finding};
use crate::machine::{Machine, at};
use crate::model::{Model, Parameter};
use crate::places::{place, set_by, span};
use crate::program::{Bodies, Program};
use crate::recorded_field::RecordedField;
use crate::results::{Gradient, Recording, Results};
use crate::simulation::{SimulationBuilder, run_error_with};
use crate::timings::{Clock, Timings};
use crate::{Error, Quantity, RuntimeError};
use eng_compiler::elaborate::{AnalysisPlan, Structural};
use eng_runtime::linearised::FrequencyResponse;
use eng_runtime::start::turn::{Turned, turn};
use eng_runtime::{
    Advance, Assembled, LinearModes, PeriodicSummary, RunSummary, Slow, StartReport, StepLimit,
    Verdict, Warning,
};
use eng_system::code::BindError;
use eng_system::significant::short;
use eng_system::system::{AnalysisKind, BodyRef, Extent, PointValue, Rows, Start, StepControl};
use std::num::NonZeroUsize;
use std::sync::OnceLock;
use std::time::Duration;

/// An analysis, ready to run.
#[derive(Clone, Debug)]
pub struct Analysis {
    model: Model,
    plan: eng_system::system::Analysis,
    program: Program,
    overrides: Vec<Option<f64>>,
    /// Parameters set in place of the text's values.
    set_here: Vec<String>,
    /// `step` or `tolerance` set in place of the text's, with its value.
    stepped_here: Option<(&'static str, String)>,
    replaced: Vec<String>,
    /// Words of choices in place of the text's: path, word, value.
    chosen: Vec<(String, String, Structural)>,
    recording: Recording,
    /// Whether a run measures its phases.
    timed: bool,
    /// Threads that solve its fields.
    threads: NonZeroUsize,
    /// Its model in the assembled position, for all its users.
    assembled: OnceLock<Result<Assembled, RuntimeError>>,
}

/// Findings of lints on an analysis.
pub(crate) struct Findings {
    pub list: Vec<Finding>,
    /// The turn without forces of the lints of cylinders, if there are cylinders.
    pub turned: Option<Result<Turned, RuntimeError>>,
    /// Processor time of the turn without forces with its lints.
    pub turning: Duration,
}

/// A cycle is at rest if after this number of steps it has turned by less than this part of the run. Choices: steps grow at the
/// start, so a cycle that turns has advanced by more after as many of them.
const STANDING: (u64, f64) = (50, 1e-3);

/// The progress of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Finished part, 0…1.
    pub fraction: f64,
    /// Simulated time (s).
    pub time: f64,
    /// Steps since the start.
    pub steps: u64,
    /// Unwrapped cycle angle (rad), if the model has a cycle.
    pub cycle_angle: Option<f64>,
    /// For a periodic analysis: number of whole cycles, and the largest change from the last cycle, as a
    /// share of the swing.
    pub cycles: Option<(u32, Option<f64>)>,
}

/// A watch on a run. A function of the progress is one.
pub trait Watch {
    /// Called after every step.
    fn progress(&mut self, now: Progress) -> Verdict;
    /// Takes the cause of short steps, after [`Verdict::Explain`].
    fn short_steps(&mut self, _slow: &Slow) {}
}

impl<F: FnMut(Progress) -> Verdict> Watch for F {
    fn progress(&mut self, now: Progress) -> Verdict {
        self(now)
    }
}

/// The outcome of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// All columns.
    pub results: Results,
    /// The thinned motion of the bodies in the last cycle: see [`crate::motion`].
    pub motion: Results,
    /// Failed `advise`s.
    pub warnings: Vec<Warning>,
    /// Steps and energy; absent for a start alone, and after a failure.
    pub summary: Option<RunSummary>,
    /// The report on the start; absent if the run did not start.
    pub start: Option<StartReport>,
    /// Cycles, decay and whirl of a periodic analysis; absent after a failure.
    pub periodic: Option<PeriodicSummary>,
    /// Modes of a linear analysis, which are also the rows of `results`; absent after a failure.
    pub modes: Option<LinearModes>,
    /// The response over frequency, whose amplitudes and phases are the rows of `results`; absent after a failure.
    pub response: Option<FrequencyResponse>,
    /// The results of a kinematic analysis beside its rows; absent after a failure.
    pub determined: Option<eng_runtime::Determined>,
    /// The derivatives of the channels by the parameters that the analysis names; empty after a failure.
    pub gradients: Vec<Gradient>,
    /// Whether all this comes from an earlier run, and nothing was computed.
    pub made_before: bool,
    /// Processor time of the phases, if the analysis is [`Analysis::timed`].
    pub timings: Option<Timings>,
}

/// A failed run, with its results up to the failure.
#[derive(Debug)]
pub struct Failed<O = Outcome> {
    /// The reason.
    pub error: Box<Error>,
    /// Samples up to the failure, if there are any.
    pub partial: Option<Box<O>>,
}

impl<O> From<Error> for Failed<O> {
    fn from(error: Error) -> Failed<O> {
        Failed {
            error: Box::new(error),
            partial: None,
        }
    }
}

impl Program {
    /// The plan of an analysis and its compiled model.
    pub fn analysis(&self, name: &str) -> Result<Analysis, Error> {
        let plan = self.plan(name)?;
        let model = self.compile(plan.model, &plan.constants, Bodies::Reduced)?;
        Analysis::new(model, plan.analysis.clone(), self.clone())
    }

    /// Several analyses. Those of one model with the same constants, such as the points of a sweep over a
    /// parameter, share one compiled model.
    pub fn analyses_of(&self, names: &[&str]) -> Vec<Result<Analysis, Error>> {
        self.analyses_with(names, Bodies::Reduced)
    }

    /// [`Program::analyses_of`], with other bodies in place of the flexible ones.
    pub(crate) fn analyses_with(
        &self,
        names: &[&str],
        bodies: Bodies,
    ) -> Vec<Result<Analysis, Error>> {
        let mut models: Vec<(&AnalysisPlan, Model)> = Vec::new();
        names
            .iter()
            .map(|name| {
                let plan = self.plan(name)?;
                let known = models
                    .iter()
                    .find(|(p, _)| p.model == plan.model && p.constants == plan.constants);
                let model = match known {
                    Some((_, model)) => model.clone(),
                    None => {
                        let model = self.compile(plan.model, &plan.constants, bodies)?;
                        models.push((plan, model.clone()));
                        model
                    }
                };
                Analysis::new(model, plan.analysis.clone(), self.clone())
            })
            .collect()
    }
}

impl Analysis {
    pub(crate) fn new(
        model: Model,
        plan: eng_system::system::Analysis,
        program: Program,
    ) -> Result<Analysis, Error> {
        let mut overrides = vec![None; model.compiled().system.parameters.len()];
        for (path, value) in &plan.set {
            overrides[model.parameter(path)?.index] = Some(*value);
        }
        Ok(Analysis {
            model,
            plan,
            program,
            overrides,
            set_here: Vec::new(),
            stepped_here: None,
            replaced: Vec::new(),
            chosen: Vec::new(),
            recording: Recording::default(),
            timed: false,
            threads: NonZeroUsize::MIN,
            assembled: OnceLock::new(),
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.plan.origin.path
    }

    /// Hash of the texts of its program.
    pub(crate) fn source_hash(&self) -> String {
        self.program.source_hash()
    }

    /// Its place in the text.
    pub(crate) fn origin(&self) -> &eng_system::system::Origin {
        &self.plan.origin
    }

    /// Its point in the sweep; empty for an analysis without an index.
    pub fn point(&self) -> &[PointValue] {
        &self.plan.point
    }

    /// Its compiled model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The parameter of its model with a path. The error names a constant as such.
    pub fn parameter(&self, path: &str) -> Result<Parameter, Error> {
        self.model.parameter(path).map_err(|error| {
            let constant = self.program.constant(self.model.name(), path);
            constant.unwrap_or(error)
        })
    }

    /// The values (SI) of the parameters of its model, in the order of [`Model::parameters`].
    ///
    /// # Errors
    /// Parameters that the model refuses.
    pub fn parameter_values(&self) -> Result<Vec<f64>, Error> {
        Ok(self.bound()?.parameters)
    }

    /// A simulation of its model with its parameters, steps and start, which a program steps.
    ///
    /// # Errors
    /// A kind of analysis that takes no steps.
    pub fn simulation(&self) -> Result<SimulationBuilder, Error> {
        match self.plan.kind.integration() {
            Some(integration) => {
                let options = eng_runtime::Options::from(*integration);
                let (model, overrides) = (self.model.clone(), self.overrides.clone());
                Ok(SimulationBuilder::with(model, overrides, options))
            }
            None => Err(Error::NoSteps {
                analysis: self.name().to_owned(),
            }),
        }
    }

    /// Its kind.
    pub fn kind(&self) -> &AnalysisKind {
        &self.plan.kind
    }

    /// Sets a parameter in place of the analysis's value. Refuses a parameter that its sweep varies.
    pub fn set(mut self, parameter: Parameter, value: Quantity) -> Result<Self, Error> {
        let value = self.model.checked(parameter, value)?;
        let system = &self.model.compiled().system;
        let Some(info) = system.parameters.get(parameter.index) else {
            return Err(Error::OtherModel);
        };
        let path = &info.origin.path;
        if self.program.sweeps(self.name(), path) {
            return Err(Error::Swept {
                path: path.clone(),
                analysis: self.name().to_owned(),
            });
        }
        let stated = self.plan.set.iter().find(|(p, _)| p == path);
        if let Some((_, stated)) = stated
            && *stated != value
        {
            let text = |x: f64| info.display.text(x);
            let line = format!(
                "{path} = {}, not {} as the text states",
                text(value),
                text(*stated)
            );
            self.replaced.push(line);
        }
        self.set_here.push(path.clone());
        if let Some(place) = self.overrides.get_mut(parameter.index) {
            *place = Some(value);
        }
        self.assembled = OnceLock::new();
        Ok(self)
    }

    /// Whether the parameter of a path was set in place of the analysis's value.
    pub(crate) fn sets(&self, path: &str) -> bool {
        self.set_here.iter().any(|set| set == path)
    }

    /// The analysis at a point of a table: with these values of parameters of its model.
    pub(crate) fn at_point(&self, values: Vec<(Parameter, PointValue)>) -> Analysis {
        let mut point = self.clone();
        for (parameter, value) in values {
            if let Some(place) = point.overrides.get_mut(parameter.index) {
                *place = Some(value.value);
            }
            point.plan.point.push(value);
        }
        point.assembled = OnceLock::new();
        point
    }

    /// The analysis with its own parameters and the names of a point's values.
    pub(crate) fn named_as(&self, point: &Analysis) -> Analysis {
        let mut named = self.clone();
        named.plan.point.clone_from(&point.plan.point);
        named
    }

    /// Takes fixed steps, or steps of another tolerance, in place of the text's.
    pub fn stepping(mut self, control: StepControl) -> Self {
        let Some(integration) = self.plan.kind.integration_mut() else {
            return self;
        };
        let place = &mut integration.step;
        let text = |control: StepControl| match control {
            StepControl::Fixed(step) => ("step", format!("{} s", short(step, 12))),
            StepControl::FixedTo { step, tolerance } => (
                "step",
                format!(
                    "{} s, solved to a tolerance of {tolerance}",
                    short(step, 12)
                ),
            ),
            StepControl::Tolerance(factor) => ("tolerance", factor.to_string()),
        };
        let ((name, value), (stated_name, stated)) = (text(control), text(*place));
        if *place != control {
            self.replaced.push(format!(
                "{name} = {value} in place of {stated_name} = {stated}, which the text states or which is the default"
            ));
        }
        *place = control;
        self.stepped_here = Some((name, value));
        self
    }

    /// Parameters set in place of the text's values, in words.
    pub fn replaced(&self) -> &[String] {
        &self.replaced
    }

    /// Sets the kept channels and their folder.
    pub fn record(mut self, recording: Recording) -> Self {
        self.recording = recording;
        self
    }

    /// Measures the phases of a run: see [`Outcome::timings`]. This changes no result.
    #[must_use]
    pub fn timed(mut self) -> Self {
        self.timed = true;
        self
    }

    /// Lets so many threads solve the films on cells of a run side by side: see [`Model::threads`].
    #[must_use]
    pub fn threads(mut self, threads: NonZeroUsize) -> Self {
        self.threads = threads;
        self
    }

    pub(crate) fn own_threads(&self) -> NonZeroUsize {
        self.threads
    }

    /// The folder of its samples during the run.
    pub(crate) fn recorded_to(&self) -> Option<&std::path::Path> {
        self.recording.folder.as_deref()
    }

    /// The values of all slots for this analysis's parameters. The summary uses those of journals and cycle.
    pub(crate) fn bound(&self) -> Result<eng_system::code::Bound, Error> {
        let compiled = self.model.compiled();
        compiled
            .bind
            .bind(&self.overrides, &compiled.system.tables)
            .map_err(|e| self.error(e.into()))
    }

    /// The data of the machine with its parameters, for tables and figures.
    ///
    /// # Errors
    /// Parameters that the model refuses.
    pub fn machine(&self) -> Result<Machine, Error> {
        let system = &self.model.compiled().system;
        Ok(Machine {
            fields: self.fields()?,
            ..Machine::new(system, &self.bound()?, &self.plan.kind)
        })
    }

    /// The fields of its elements, with their kernels.
    pub(crate) fn fields(&self) -> Result<Vec<RecordedField>, Error> {
        let compiled = self.model.compiled();
        let without = |element: &eng_system::system::Element| element.fields.is_empty();
        // a film without forces has no pressure
        if self.plan.kind.is_prescribed() || compiled.system.elements.iter().all(without) {
            return Ok(Vec::new());
        }
        let bound = eng_runtime::model::Model::bind(compiled, &self.overrides);
        let bound = bound.map_err(|cause| self.error(cause))?;
        Ok(RecordedField::all(&bound))
    }

    /// Its model in the assembled position.
    pub(crate) fn assembled(&self) -> Result<&Assembled, RuntimeError> {
        let assembled = self
            .assembled
            .get_or_init(|| Assembled::new(self.model.compiled(), &self.overrides));
        assembled.as_ref().map_err(RuntimeError::clone)
    }

    /// Findings of lints on its numbers and on the assembled model, with the failed `advise`s of the start.
    /// Another stage reports a model that does not assemble.
    pub(crate) fn findings(&self) -> Result<Findings, Error> {
        let (compiled, overrides) = (self.model.compiled(), &self.overrides);
        let bound = self.bound()?;
        let mut list = lint::of_numbers(compiled, overrides, &bound);
        let (mut turned, mut turning) = (None, Duration::ZERO);
        if let Ok(assembled) = self.assembled() {
            let (model, state) = (assembled.model(), assembled.state());
            let origin = &self.plan.origin;
            list.extend(lint::of_start(model, state, &self.plan.kind, origin));
            // the turn without forces is the same for all points of a sweep
            let first = self.plan.point.is_empty() || self.plan.origin.path.ends_with("[1]");
            if first {
                let mut clock = Clock::new();
                let (found, turn) = lint::of_turn(assembled, &bound);
                turning = clock.since();
                list.extend(found);
                turned = turn;
            }
        }
        Ok(Findings {
            list,
            turned,
            turning,
        })
    }

    /// Assembled positions of the stated markers and of the bodies' origins: body, path and position (m,
    /// ground's axes).
    pub fn positions(&self) -> Result<Vec<(String, String, [f64; 3])>, Error> {
        let compiled = self.model.compiled();
        let assembled = self.assembled().map_err(|e| self.error(e))?;
        let (model, state) = (assembled.model(), assembled.state());
        let markers = compiled.system.markers.iter().enumerate();
        let stated = markers.filter(|(_, marker)| !marker.origin.path.is_empty());
        let placed = stated.map(|(index, marker)| {
            let found =
                eng_runtime::assembly::rows::marker(model, index, &state.pose, &state.velocity);
            let body = match marker.body {
                BodyRef::Ground => "ground".to_owned(),
                BodyRef::Body(body) => compiled.system.bodies[body as usize].origin.path.clone(),
            };
            (body, marker.origin.path.clone(), found.position.into())
        });
        Ok(placed.collect())
    }

    /// Failed `advise`s on the motion at the start.
    pub(crate) fn findings_of_start(&self) -> Vec<Finding> {
        let options = eng_runtime::Options::default();
        let start = self
            .assembled()
            .and_then(|assembled| eng_runtime::Simulation::of(assembled, options));
        let Ok(mut simulation) = start else {
            return Vec::new();
        };
        let parameters = simulation.model().advice.len();
        let warnings = simulation.take_warnings();
        let system = &self.model.compiled().system;
        let of_motion = warnings.iter().skip(parameters);
        of_motion
            .map(|warning| Finding::of_run(warning, system))
            .collect()
    }

    /// The note for a run by angle that failed before its cycle turned.
    fn stands(&self, last: &Advance) -> Option<String> {
        let Some((_, Some(Extent::Angle(whole)))) = self.plan.kind.sampling() else {
            return None;
        };
        (last.steps >= STANDING.0 && last.fraction < STANDING.1).then(|| {
            format!(
                "the duration is {:.0}° of the cycle, and until then it has turned {}° in {:.3} s: does anything turn it?",
                whole.to_degrees(),
                short((last.fraction * whole).to_degrees(), 2),
                last.time
            )
        })
    }

    /// The note on a condition that fails at the start because the assembly could not bring parts of its
    /// element together, such as a pin and its shell in a loop that does not close.
    fn apart(&self, cause: &RuntimeError) -> Option<String> {
        let RuntimeError::Require { origin, moment, .. } = cause else {
            return None;
        };
        let assembled = self.assembled().ok().filter(|_| moment.time == 0.0)?;
        let (model, state) = (assembled.model(), assembled.state());
        let system = &model.compiled.system;
        let own = |element: &&eng_system::system::Element| element.origin.path == origin.path;
        let element = system.elements.iter().find(own)?;
        let lengths = element.resolves.iter().map(|slot| model.slot(*slot));
        // the largest tolerance of positions in a model that resolves no length
        let allowed = lengths.fold(1e-6 * model.length, f64::max);
        let place = |index: u32| -> Option<(&str, _)> {
            let marker = *element.markers.get(index as usize)? as usize;
            let path = &system.markers.get(marker)?.origin.path;
            let found =
                eng_runtime::assembly::rows::marker(model, marker, &state.pose, &state.velocity);
            Some((path, found))
        };
        element.places.iter().find_map(|placing| {
            let ((moving, a), (on, b)) = (place(placing.moving)?, place(placing.on)?);
            let offset = b.rotation.transpose() * (a.position - b.position);
            let apart = match placing.height {
                Some(height) => (offset[2] - model.slot(height)).abs(),
                None => libm::hypot(offset[0], offset[1]),
            };
            (apart > allowed).then(|| {
                format!(
                    "the assembly brings {moving} and {on} no nearer than {} mm: a loop of these lengths does not close, or a stated place or a branch keeps them apart",
                    short(1e3 * apart, 4)
                )
            })
        })
    }

    /// A failure with its places. It names the analysis that set an unsuitable parameter.
    fn error(&self, cause: RuntimeError) -> Error {
        self.error_with(cause, None)
    }

    fn error_with(&self, cause: RuntimeError, note: Option<String>) -> Error {
        let path = match &cause {
            RuntimeError::Bind(BindError::Limits { path, .. }) => Some(path.clone()),
            _ => None,
        };
        let of_analysis = match &cause {
            RuntimeError::Options { .. } => true,
            RuntimeError::Stopped(slow) => {
                matches!(*slow.limit, StepLimit::Stated | StepLimit::Samples)
            }
            _ => false,
        };
        let argument = match &cause {
            RuntimeError::TurnsTooFar { .. } => Some("step"),
            RuntimeError::CycleStands { .. } => Some("duration"),
            RuntimeError::Rounding { .. } if self.stepped_here.is_none() => Some("tolerance"),
            _ => None,
        };
        let note = note.or_else(|| self.apart(&cause));
        let of_response = self.plan.kind.rows() == Rows::Frequencies;
        let help = of_response
            .then(|| crate::failure::help_of_response(&cause))
            .flatten();
        let argument =
            argument.and_then(|wanted| self.plan.arguments.iter().find(|(name, _)| name == wanted));
        run_error_with(&self.model, cause, |message| {
            let mut message = message.note_if(note);
            if let Some(help) = help {
                message.help = vec![help.to_owned()];
            }
            if of_analysis {
                return place(message, &self.plan.origin, "of this analysis");
            }
            if let Some((name, at)) = argument {
                return message.moved_to(span(*at), format!("this {name}"));
            }
            let Some(path) = path else {
                return message;
            };
            if self.set_here.contains(&path) {
                message.with_note("it was set for this run: by --set, or by the program around")
            } else if self.plan.set.iter().any(|(p, _)| *p == path) {
                set_by(message, &self.plan.origin)
            } else {
                message
            }
        })
    }

    /// Assembles the model at the start of the analysis, and counts its freedoms.
    pub fn topology(&self) -> Result<eng_runtime::TopologyReport, Error> {
        let assembled = self.assembled().map_err(|cause| self.error(cause))?;
        if let Some(determined) = self.determined() {
            determined?;
            let topology = assembled.topology().cloned();
            return topology.map_err(|cause| self.error(cause));
        }
        let begins = |start: Start| {
            let options = eng_runtime::Options {
                start,
                ..eng_runtime::Options::default()
            };
            eng_runtime::Simulation::of(assembled, options)
        };
        // The start has conditions of its own, on clearances and velocities. They count in the state in which
        // the run begins. This state is costly, so it is computed only if the assembled state fails the
        // conditions.
        let run_starts = self.plan.kind.start();
        eng_runtime::countable(&*self.plan.kind).map_err(|cause| self.error(cause))?;
        let begun = match begins(Start::Assembled) {
            Err(RuntimeError::Require { .. }) if run_starts != Start::Assembled => {
                begins(run_starts)
            }
            other => other,
        };
        begun
            .and_then(|_| assembled.topology().cloned())
            .map_err(|cause| self.error(cause))
    }

    /// The numbers that place its markers, as bits. Analyses with equal numbers have one geometry.
    pub(crate) fn geometry(&self) -> Result<Vec<u64>, Error> {
        let bound = self.bound()?;
        let markers = &self.model.compiled().system.markers;
        let slots = markers
            .iter()
            .flat_map(|m| m.position.iter().chain(&m.orientation));
        Ok(slots.map(|slot| at(&bound, *slot).to_bits()).collect())
    }

    /// Bodies that nothing holds, as a warning.
    pub fn hanging(&self) -> Result<Option<eng_grammar::Diagnostic>, Error> {
        let found = self
            .assembled()
            .and_then(eng_runtime::start::hanging::hanging)
            .map_err(|cause| self.error(cause))?;
        Ok(found.as_ref().map(crate::failure::hanging))
    }

    /// The lock of the machine in a turn through its cycle by geometry alone. It is a warning, because a run
    /// need not reach it. Call it for machines that [`Analysis::hanging`] finds held, because geometry does
    /// not determine the motion of a falling machine.
    pub fn dry_turn(&self) -> Result<Option<eng_grammar::Diagnostic>, Error> {
        let assembled = self.assembled();
        self.lock(assembled.and_then(|assembled| turn(assembled, &mut |_| Ok(()))))
    }

    /// The warning about a lock in the turn without forces.
    pub(crate) fn lock(
        &self,
        turned: Result<Turned, RuntimeError>,
    ) -> Result<Option<eng_grammar::Diagnostic>, Error> {
        match turned {
            Ok(_) => Ok(None),
            Err(cause @ RuntimeError::Locked { .. }) => {
                let system = &self.model.compiled().system;
                Ok(Some(crate::failure::does_not_turn(&cause, system)))
            }
            Err(cause) => Err(self.error(cause)),
        }
    }
}
