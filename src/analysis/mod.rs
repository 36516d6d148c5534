//! Running the analyses of a program.

mod motion;

use crate::lint::{self, Finding};
use crate::machine::{Machine, at};
use crate::model::{Model, Parameter};
use crate::places::{at_first, place, set_by};
use crate::program::{Bodies, Program};
use crate::repetition::Repetition;
use crate::results::{Begun, Column, KeptWarning, Recording, Results, ResultsError, Table};
use crate::significant::short;
use crate::simulation::run_error_with;
use crate::{Error, Quantity, RuntimeError};
use eng_compiler::elaborate::AnalysisPlan;
use eng_runtime::{
    Advance, CycleReport, LinearModes, Moment, Observer, Pace, PeriodicSummary, RunSummary, Sample,
    Slow, StartReport, Verdict, Warning, run_linear, run_periodic, run_transient,
};
use eng_system::code::BindError;
use eng_system::recorded::recorded;
use eng_system::system::{
    AnalysisKind, BodyRef, Extent, Location, Origin, PointValue, Start, StepControl, Transient,
};
use motion::Motion;
use std::ops::ControlFlow;

/// An analysis, ready to run.
#[derive(Clone, Debug)]
pub struct Analysis {
    model: Model,
    plan: eng_system::system::Analysis,
    program: Program,
    overrides: Vec<Option<f64>>,
    /// Parameters that were set over the text's.
    set_here: Vec<String>,
    /// How steps were stated over the text's: `step` or `tolerance`, and its value.
    stepped_here: Option<(&'static str, String)>,
    replaced: Vec<String>,
    recording: Recording,
}

/// Steps after which a cycle that has turned by less than this part of a run stands.
const STANDING: (u64, f64) = (50, 1e-3);

/// How far a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Done part, 0…1.
    pub fraction: f64,
    /// Simulated time (s).
    pub time: f64,
    /// Steps since the start.
    pub steps: u64,
    /// Unwrapped cycle angle (rad), if the model has a cycle.
    pub cycle_angle: Option<f64>,
    /// Of a periodic analysis: whole cycles so far, and the largest change from the last to this one as a share of its swing.
    pub cycles: Option<(u32, Option<f64>)>,
}

/// What watches a run while it goes on; a function of the progress is one.
pub trait Watch {
    /// After every step.
    fn progress(&mut self, now: Progress) -> Verdict;
    /// What makes steps short, after [`Verdict::Explain`].
    fn paced(&mut self, _slow: &Slow) {}
}

impl<F: FnMut(Progress) -> Verdict> Watch for F {
    fn progress(&mut self, now: Progress) -> Verdict {
        self(now)
    }
}

/// What a run made.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// All columns.
    pub results: Results,
    /// Where the bodies were in the last cycle, thinned: see [`crate::motion`].
    pub motion: Results,
    /// `advise`s that did not hold.
    pub warnings: Vec<Warning>,
    /// Steps and energy; absent where only the start was asked for, or the run failed.
    pub summary: Option<RunSummary>,
    /// How the motion began; absent where it did not.
    pub start: Option<StartReport>,
    /// Cycles, decay and whirl of a periodic analysis; absent where it failed.
    pub periodic: Option<PeriodicSummary>,
    /// Modes of a linear analysis, which are the rows of `results` as well; absent where it failed.
    pub modes: Option<LinearModes>,
    /// Whether an earlier run had made all that and nothing was computed.
    pub made_before: bool,
}

/// A run that failed, with what was computed before.
#[derive(Debug)]
pub struct Failed<O = Outcome> {
    /// Why.
    pub error: Box<Error>,
    /// Samples up to the failure, if there are any.
    pub partial: Option<Box<O>>,
}

impl Program {
    /// The plan of an analysis and its compiled model.
    pub fn analysis(&self, name: &str) -> Result<Analysis, Error> {
        let plan = self.plan(name)?;
        let model = self.compile(plan.model, &plan.constants, Bodies::Reduced)?;
        Analysis::new(model, plan.analysis.clone(), self.clone())
    }

    /// Several analyses. Those of one model with the same constants, such as the points of a sweep over a parameter, share one
    /// compiled model.
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
            recording: Recording::default(),
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

    /// Where it stands in its sweep; empty for one without an index.
    pub fn point(&self) -> &[PointValue] {
        &self.plan.point
    }

    /// Its compiled model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The parameter of its model with a path; of a constant it is told that it is one.
    pub fn parameter(&self, path: &str) -> Result<Parameter, Error> {
        self.model.parameter(path).map_err(|error| {
            let constant = self.program.constant(self.model.name(), path);
            constant.unwrap_or(error)
        })
    }

    /// What is done.
    pub fn kind(&self) -> &AnalysisKind {
        &self.plan.kind
    }

    /// Sets a parameter, over what the analysis states; but not what its sweep varies.
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
            let told = format!(
                "{path} = {}, not {} as the text states",
                text(value),
                text(*stated)
            );
            self.replaced.push(told);
        }
        self.set_here.push(path.clone());
        if let Some(place) = self.overrides.get_mut(parameter.index) {
            *place = Some(value);
        }
        Ok(self)
    }

    /// Takes fixed steps, or steps of another tolerance, in place of those that the text states.
    pub fn stepping(mut self, control: StepControl) -> Self {
        let place = match &mut self.plan.kind {
            AnalysisKind::Transient(transient) => &mut transient.step,
            AnalysisKind::Periodic(periodic) => &mut periodic.step,
            AnalysisKind::Linear(linear) => &mut linear.step,
            // takes no steps
            AnalysisKind::Assemble => return self,
        };
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
                "{name} = {value}, not {stated_name} = {stated} as the text states or takes by itself"
            ));
        }
        *place = control;
        self.stepped_here = Some((name, value));
        self
    }

    /// Parameters that were set over what the text of the analysis states, in words.
    pub fn replaced(&self) -> &[String] {
        &self.replaced
    }

    /// States what is kept of the run, and where.
    pub fn record(mut self, recording: Recording) -> Self {
        self.recording = recording;
        self
    }

    /// The folder that its samples go to while it runs.
    pub(crate) fn recorded_to(&self) -> Option<&std::path::Path> {
        self.recording.folder.as_deref()
    }

    /// The values of all slots for this analysis's parameters: what the summary needs of journals and cycle.
    pub(crate) fn bound(&self) -> Result<eng_system::code::Bound, Error> {
        let compiled = self.model.compiled();
        compiled
            .bind
            .bind(&self.overrides, &compiled.system.tables)
            .map_err(|e| self.error(e.into()))
    }

    /// What tables and figures need to know of the machine with its parameters.
    ///
    /// # Errors
    /// Parameters that the model refuses.
    pub fn machine(&self) -> Result<Machine, Error> {
        let system = &self.model.compiled().system;
        Ok(Machine::new(system, &self.bound()?, &self.plan.kind))
    }

    /// What lints say of its numbers, and of the model as it is assembled, with the `advise`s that the start does not follow. What
    /// does not assemble is told elsewhere.
    pub(crate) fn findings(&self) -> Result<Vec<Finding>, Error> {
        let (compiled, overrides) = (self.model.compiled(), &self.overrides);
        let mut found = lint::of_numbers(compiled, overrides, &self.bound()?);
        let Ok(mut model) = eng_runtime::model::Model::bind(compiled, overrides) else {
            return Ok(found);
        };
        if let Ok(state) = eng_runtime::assembly::assemble(&mut model) {
            let origin = &self.plan.origin;
            found.extend(lint::of_start(&model, &state, &self.plan.kind, origin));
            // the points of a sweep turn alike
            let first = self.plan.point.is_empty() || self.plan.origin.path.ends_with("[1]");
            if first {
                found.extend(lint::of_turn(compiled, overrides, &self.bound()?));
            }
        }
        Ok(found)
    }

    /// Where the markers that the text states and the bodies' origins are, as assembled: body, path and place (m, ground's axes).
    pub fn positions(&self) -> Result<Vec<(String, String, [f64; 3])>, Error> {
        let compiled = self.model.compiled();
        let bind = eng_runtime::model::Model::bind(compiled, &self.overrides);
        let mut model = bind.map_err(|e| self.error(e))?;
        let state = eng_runtime::assembly::assemble(&mut model).map_err(|e| self.error(e))?;
        let markers = compiled.system.markers.iter().enumerate();
        let stated = markers.filter(|(_, marker)| !marker.origin.path.is_empty());
        let placed = stated.map(|(index, marker)| {
            let found =
                eng_runtime::assembly::rows::marker(&model, index, &state.pose, &state.velocity);
            let body = match marker.body {
                BodyRef::Ground => "ground".to_owned(),
                BodyRef::Body(body) => compiled.system.bodies[body as usize].origin.path.clone(),
            };
            (body, marker.origin.path.clone(), found.position.into())
        });
        Ok(placed.collect())
    }

    /// What `advise`s on the motion say of the start.
    pub(crate) fn findings_of_start(&self) -> Vec<Finding> {
        let options = eng_runtime::Options::default();
        let start = eng_runtime::Simulation::new(self.model.compiled(), &self.overrides, options);
        let Ok(mut simulation) = start else {
            return Vec::new();
        };
        let parameters = simulation.model().advice.len();
        let told = simulation.take_warnings();
        told.iter().skip(parameters).map(Finding::of_run).collect()
    }

    /// What is told of a run by angle that came to grief before its cycle turned.
    fn stands(&self, last: &Advance) -> Option<String> {
        let AnalysisKind::Transient(Transient {
            duration: Extent::Angle(whole),
            ..
        }) = self.plan.kind
        else {
            return None;
        };
        (last.steps >= STANDING.0 && last.fraction < STANDING.1).then(|| {
            format!(
                "the duration is {:.0}° of the cycle, and until then it has turned {:.1e}° in {:.3} s: does anything turn it?",
                whole.to_degrees(),
                (last.fraction * whole).to_degrees(),
                last.time
            )
        })
    }

    /// A failure with its places; who set a parameter that does not fit is told.
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
            RuntimeError::Stopped(slow) => matches!(*slow.pace, Pace::Stated | Pace::Longest),
            _ => false,
        };
        let argument = match &cause {
            RuntimeError::TurnsTooFar { .. } => Some("step"),
            RuntimeError::CycleStands { .. } => Some("duration"),
            RuntimeError::Rounding { .. } if self.stepped_here.is_none() => Some("tolerance"),
            _ => None,
        };
        let argument =
            argument.and_then(|wanted| self.plan.arguments.iter().find(|(name, _)| name == wanted));
        run_error_with(&self.model, cause, |message| {
            let message = match note {
                Some(note) => message.with_note(note),
                None => message,
            };
            if of_analysis {
                return place(message, &self.plan.origin, "of this analysis");
            }
            if let Some((name, at)) = argument {
                return at_first(message, *at, &format!("this {name}"));
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

    /// Assembles the model as the analysis begins, and counts its freedoms.
    pub fn topology(&self) -> Result<eng_runtime::TopologyReport, Error> {
        let (compiled, overrides) = (self.model.compiled(), &self.overrides);
        let begins = |start: Start| {
            let options = eng_runtime::Options {
                start,
                ..eng_runtime::Options::default()
            };
            eng_runtime::Simulation::new(compiled, overrides, options)
        };
        // The start has conditions of its own: clearances, velocities that fit each other. They count in the state in which the run
        // begins; that is dearer to find, and asked for where the assembled state does not do.
        let run_starts = match &self.plan.kind {
            AnalysisKind::Transient(t) => t.start,
            AnalysisKind::Periodic(p) => p.start,
            AnalysisKind::Linear(l) => l.start,
            AnalysisKind::Assemble => Start::Assembled,
        };
        if let AnalysisKind::Transient(transient) = &self.plan.kind {
            eng_runtime::countable(transient).map_err(|cause| self.error(cause))?;
        }
        let begun = match begins(Start::Assembled) {
            Err(RuntimeError::Require { .. }) if run_starts != Start::Assembled => {
                begins(run_starts)
            }
            other => other,
        };
        begun
            .and_then(|_| eng_runtime::topology(compiled, overrides))
            .map_err(|cause| self.error(cause))
    }

    /// The numbers that place its markers, as bits: analyses that agree in them have one geometry.
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
        let found = eng_runtime::start::hanging::hanging(self.model.compiled(), &self.overrides)
            .map_err(|cause| self.error(cause))?;
        Ok(found.as_ref().map(crate::failure::hanging))
    }

    /// Where the machine locks when it is turned through its cycle by its geometry alone, as a warning: a run need not come there.
    pub fn dry_turn(&self) -> Result<Option<eng_grammar::Diagnostic>, Error> {
        let turned =
            eng_runtime::start::turn::turn(self.model.compiled(), &self.overrides, &mut |_| Ok(()));
        match turned {
            Ok(_) => Ok(None),
            Err(cause @ RuntimeError::Locked { .. }) => {
                let system = &self.model.compiled().system;
                Ok(Some(crate::failure::does_not_turn(&cause, system)))
            }
            Err(cause) => Err(self.error(cause)),
        }
    }

    /// Runs. `progress` is called after every step.
    pub fn run(&self, progress: &mut dyn FnMut(Progress)) -> Result<Outcome, Failed> {
        self.run_watched(&mut |now: Progress| {
            progress(now);
            Verdict::GoOn
        })
    }

    /// Runs as long as a watch, which is asked after every step, wants it. One that is stopped ends with [`RuntimeError::Stopped`], which
    /// tells what makes its steps as short as they are; what a recording has on disk then stays, to go on from. A run that ends has the
    /// same bits as without being watched.
    pub fn run_watched(&self, watch: &mut dyn Watch) -> Result<Outcome, Failed> {
        let failed = |error: Error| Failed {
            error: Box::new(error),
            partial: None,
        };
        let compiled = self.model.compiled();
        let begun = self
            .header()
            .and_then(|header| Ok(Table::begin(header, &self.recording, self.identity()?)?));
        let (table, point) = match begun {
            Ok(Begun::Fresh(table)) => (table, None),
            Ok(Begun::Resumed(table, point)) => (table, Some(point)),
            Ok(Begun::Complete(results)) => {
                // its motion is on disk beside it, unless the run was killed just then
                let motion = Motion::left(self, results.metadata()).map_err(failed)?;
                return Ok(Outcome {
                    motion: motion.unwrap_or_else(|| Results::new(self.name(), self.model.name())),
                    results,
                    warnings: Vec::new(),
                    summary: None,
                    start: None,
                    periodic: None,
                    modes: None,
                    made_before: true,
                });
            }
            Err(error) => {
                return Err(Failed {
                    error: Box::new(error),
                    partial: None,
                });
            }
        };
        let motion = Motion::begin(self, point.as_ref().map(|p| p.samples)).map_err(failed)?;
        let mut recorder = Recorder {
            table,
            refused: None,
            resumed: point.is_some(),
            warnings: point.iter().flat_map(|p| &p.warnings).map(given).collect(),
            motion,
            start: None,
            cycles: None,
            last: None,
            watch,
        };
        let state = point.as_ref().map(|p| p.state.as_slice());
        let mut modes = None;
        let ran = match &self.plan.kind {
            AnalysisKind::Transient(t) => {
                run_transient(compiled, &self.overrides, t, &mut recorder, state)
                    .map(|summary| (Some(summary), None))
            }
            AnalysisKind::Periodic(p) => run_periodic(compiled, &self.overrides, p, &mut recorder)
                .map(|found| (Some(found.run.clone()), Some(found))),
            AnalysisKind::Linear(l) => {
                run_linear(compiled, &self.overrides, l, &mut recorder).map(|found| {
                    recorder.modes(&found);
                    modes = Some(found);
                    (None, None)
                })
            }
            AnalysisKind::Assemble => self.assembled(&mut recorder).map(|()| (None, None)),
        };
        // what the disk refused ended the run; its samples stay as they are, to go on from
        if let Some(refused) = recorder.refused {
            return Err(Failed {
                error: Box::new(refused.into()),
                partial: None,
            });
        }
        if let Err(cause @ RuntimeError::Stopped(_)) = &ran
            && self.recorded_to().is_some()
        {
            return Err(failed(self.error(cause.clone())));
        }
        let (summary, periodic, cause) = match ran {
            Ok((summary, periodic)) => (summary, periodic, None),
            Err(cause) => (None, None, Some(cause)),
        };
        if let Some(found) = &periodic {
            let found = Repetition::new(found, &compiled.system);
            for (key, value) in found.metadata() {
                let stated = recorder.table.set_metadata(key, value);
                stated.map_err(|error| failed(error.into()))?;
            }
        }
        let failure = cause.as_ref().map(ToString::to_string);
        // a run that is killed between its results and its motion has all of the motion on disk
        let saved = recorder.motion.save();
        if cause.is_none() {
            saved.map_err(|error| failed(error.into()))?;
        }
        let finished = recorder.table.finish(failure.as_deref());
        let stands = recorder.last.and_then(|last| self.stands(&last));
        let cause = cause.map(|cause| self.error_with(cause, stands));
        match (finished, cause) {
            (Err(error), None) => Err(Failed {
                error: Box::new(error.into()),
                partial: None,
            }),
            (Err(_), Some(error)) => Err(Failed {
                error: Box::new(error),
                partial: None,
            }),
            (Ok(results), cause) => {
                let motion =
                    recorder
                        .motion
                        .results(self, results.metadata())
                        .map_err(|error| Failed {
                            error: Box::new(error),
                            partial: None,
                        })?;
                let outcome = Outcome {
                    results,
                    motion,
                    warnings: recorder.warnings,
                    summary,
                    start: recorder.start,
                    periodic,
                    modes,
                    made_before: false,
                };
                match cause {
                    None => Ok(outcome),
                    Some(error) => Err(Failed {
                        error: Box::new(error),
                        partial: (outcome.results.samples() > 0).then(|| Box::new(outcome)),
                    }),
                }
            }
        }
    }

    /// All columns without values, in the order of [`Recorder::sample`], with what is known before the run.
    fn header(&self) -> Result<Results, Error> {
        let system = &self.model.compiled().system;
        let mut results = Results::new(self.name(), self.model.name());
        if let AnalysisKind::Linear(_) = self.plan.kind {
            let bound = eng_runtime::model::Model::bind(self.model.compiled(), &self.overrides)
                .map_err(|cause| self.error(cause))?;
            crate::modes::push_columns(&mut results, &bound)?;
        } else {
            self.push_samples(&mut results)?;
        }
        results.set_metadata("version", env!("CARGO_PKG_VERSION"));
        results.set_metadata("file", self.program.file());
        results.set_metadata("source_hash", self.program.source_hash());
        if let Some((name, value)) = &self.stepped_here {
            results.set_metadata(format!("override.{name}"), value);
        }
        for point in self.point() {
            results.set_metadata(
                format!("point.{}", point.name),
                point.display.exact_text(point.value),
            );
        }
        let bound = self.bound()?;
        for (parameter, value) in system.parameters.iter().zip(&bound.parameters) {
            let d = &parameter.display;
            results.set_metadata(
                format!("parameter.{}", parameter.origin.path),
                d.exact_text(*value),
            );
        }
        Ok(results)
    }

    /// Columns of samples: time, cycle, channels, energy.
    fn push_samples(&self, results: &mut Results) -> Result<(), Error> {
        let system = &self.model.compiled().system;
        for column in recorded(system) {
            results.push(Column {
                path: column.path,
                dimension: column.dimension,
                display: column.display,
                frame: column.frame,
                values: Vec::new(),
            })?;
        }
        Ok(())
    }

    /// What tells this run from others: program's version, texts, plan, bound model, reduced bodies, kept channels.
    fn identity(&self) -> Result<String, Error> {
        use sha2::Digest;
        use std::fmt::Write;
        if self.recording.folder.is_none() {
            return Ok(String::new());
        }
        let mut text = format!(
            "{} {} {:?} {:?} {:?}",
            env!("CARGO_PKG_VERSION"),
            self.program.source_hash(),
            self.plan,
            self.recording.channels,
            self.model.compiled().system,
        );
        let bound = self.bound()?;
        for value in bound.parameters.iter().chain(&bound.slots) {
            // a text takes all that is written to it
            let _ = write!(text, " {:x}", value.to_bits());
        }
        for reduction in self.model.reductions() {
            let _ = write!(text, " {}", reduction.key());
        }
        Ok(sha2::Sha256::digest(text.as_bytes())
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect())
    }

    fn assembled(&self, recorder: &mut Recorder<'_>) -> Result<(), RuntimeError> {
        let mut simulation = eng_runtime::Simulation::new(
            self.model.compiled(),
            &self.overrides,
            eng_runtime::Options::default(),
        )?;
        let mut values = vec![0.0; self.model.compiled().system.channels.len()];
        simulation.evaluate_channels(&mut values)?;
        let _ = recorder.sample(&Sample {
            time: simulation.time(),
            cycle_angle: simulation.cycle_angle(),
            cycle_rate: simulation.cycle_rate(),
            values: &values,
            energy: simulation.energy(),
            eccentricities: &[],
            pose: simulation.sampled_pose(),
            velocity: &simulation.sampled_state().velocity,
            states: &simulation.sampled_state().states,
        });
        Ok(())
    }
}

/// What a run gives on its way to a table.
struct Recorder<'a> {
    table: Table,
    /// Why samples or checkpoints could not be kept.
    refused: Option<ResultsError>,
    /// Whether an earlier run told of the start.
    resumed: bool,
    warnings: Vec<Warning>,
    motion: Motion,
    start: Option<StartReport>,
    cycles: Option<(u32, Option<f64>)>,
    /// How far the run is.
    last: Option<Advance>,
    watch: &'a mut dyn Watch,
}

impl Recorder<'_> {
    fn modes(&mut self, modes: &LinearModes) {
        for (key, value) in crate::modes::metadata(modes) {
            let stated = self.table.set_metadata(key, value);
            if self.keep(stated).is_break() {
                return;
            }
        }
        for (index, mode) in modes.modes.iter().enumerate() {
            let kept = self
                .table
                .push(crate::modes::row(modes, index, mode).into_iter());
            if self.keep(kept).is_break() {
                return;
            }
        }
    }

    fn keep(&mut self, kept: Result<(), ResultsError>) -> ControlFlow<()> {
        match kept {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                self.refused.get_or_insert(error);
                ControlFlow::Break(())
            }
        }
    }
}

/// A warning for a checkpoint.
fn kept(warning: &Warning) -> KeptWarning {
    let place = |at: Location| (at.source, at.start, at.end);
    KeptWarning {
        path: warning.origin.path.clone(),
        used_at: warning.origin.used_at.map(place),
        defined_at: warning.origin.defined_at.map(place),
        name: warning.name.clone(),
        message: warning.message.clone(),
        time: warning.moment.time.to_bits(),
        cycle_angle: warning.moment.cycle_angle.map(f64::to_bits),
    }
}

/// A warning from a checkpoint.
fn given(kept: &KeptWarning) -> Warning {
    let place = |(source, start, end)| Location { source, start, end };
    Warning {
        origin: Origin {
            path: kept.path.clone(),
            used_at: kept.used_at.map(place),
            defined_at: kept.defined_at.map(place),
        },
        name: kept.name.clone(),
        message: kept.message.clone(),
        moment: Moment {
            time: f64::from_bits(kept.time),
            cycle_angle: kept.cycle_angle.map(f64::from_bits),
        },
    }
}

impl Observer for Recorder<'_> {
    fn started(&mut self, report: &StartReport) {
        if !self.resumed {
            let stated = self.table.set_metadata("start", report.to_string());
            // the first sample ends the run
            let _ = self.keep(stated);
            self.start = Some(report.clone());
        }
    }

    fn cycle(&mut self, cycle: &CycleReport) {
        self.cycles = Some((cycle.cycles, cycle.slowest.as_ref().map(|s| s.change)));
    }

    fn sample(&mut self, sample: &Sample<'_>) -> ControlFlow<()> {
        if self.refused.is_some() {
            return ControlFlow::Break(());
        }
        if let Err(error) = self.motion.push(sample) {
            return self.keep(Err(error));
        }
        let e = &sample.energy;
        let audit = [
            e.kinetic,
            e.gravity,
            e.strain,
            e.damping,
            e.loads,
            e.constraints,
            e.imbalance(),
        ];
        let row = std::iter::once(sample.time)
            .chain(sample.cycle_angle)
            .chain(sample.cycle_rate)
            .chain(sample.values.iter().copied())
            .chain(audit);
        let kept = self.table.push(row);
        self.keep(kept)
    }

    fn wants_checkpoint(&mut self) -> bool {
        self.refused.is_none() && self.table.wants_checkpoint()
    }

    fn checkpoint(&mut self, bytes: Vec<u8>) {
        let warnings = self.warnings.iter().map(kept).collect();
        let saved = self
            .motion
            .save()
            .and_then(|()| self.table.save(bytes, warnings));
        // the next sample ends the run
        let _ = self.keep(saved);
    }

    fn progress(&mut self, advance: &Advance) -> Verdict {
        self.last = Some(*advance);
        self.watch.progress(Progress {
            fraction: advance.fraction,
            time: advance.time,
            steps: advance.steps,
            cycle_angle: advance.cycle_angle,
            cycles: self.cycles,
        })
    }

    fn paced(&mut self, slow: &Slow) {
        self.watch.paced(slow);
    }

    fn warning(&mut self, warning: &Warning) {
        self.warnings.push(warning.clone());
    }
}
