//! The command line's engine: this process compiles and runs.

use crate::analysis::{Failed, Outcome};
use crate::cli::{
    AssemblyOutcome, CheckOutcome, Engine, EngineError, Event, JournalGeometry, PlacedMarker,
    Positions, Progress, ReductionOutcome, RunOptions, RunOutcome, Setting,
};
use crate::counted::counted;
use crate::lint::{self, Finding, Heard};
use crate::patience::{Look, Patience, in_words};
use crate::plot::Upright;
use crate::program::Bodies;
use crate::repetition::Repetition;
use crate::report::Described;
use crate::results::Recording;
use crate::significant::significant;
use crate::{
    Analysis, Error, Program, Quantity, Results, RuntimeError, Slow, Sources, TopologyReport,
    Verdict, Watch,
};
use eng_grammar::Diagnostics;
use eng_system::code::Bound;
use eng_system::system::{Slot, System};
use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// Compiles and runs models of this machine's folders.
#[derive(Debug, Default)]
pub struct Local {
    program: Option<Program>,
    recording: Recording,
    options: RunOptions,
}

impl Local {
    /// Nothing checked yet.
    pub fn new() -> Local {
        Local::default()
    }

    /// An analysis as the command line wants it to run.
    fn prepared(&self, analysis: Analysis, settings: &[Setting]) -> Result<Analysis, EngineError> {
        let analysis = with_settings(analysis, settings)?.record(self.recording.clone());
        Ok(match self.options.step {
            Some(step) => analysis.stepping(step),
            None => analysis,
        })
    }
}

impl Engine for Local {
    fn check(&mut self, model: &Path) -> Result<CheckOutcome, EngineError> {
        let system = |message: String| EngineError::System(message);
        let file = model
            .file_name()
            .and_then(|n| n.to_str())
            .ok_or_else(|| system(format!("{} is not a file", model.display())))?;
        let folder = match model.parent() {
            Some(p) if !p.as_os_str().is_empty() => p,
            _ => Path::new("."),
        };
        if !model.is_file() {
            return Err(system(match model.exists() {
                true => format!("{} is no file", model.display()),
                false => format!("there is no file {}", model.display()),
            }));
        }
        let mut sources = Sources::folder(folder).map_err(|e| system(e.to_string()))?;
        if let Some(cache) = cache_folder(|name| std::env::var_os(name)) {
            sources = sources.with_cache(cache);
        }
        let checked = crate::check(&sources, file);
        let report = checked.report();
        self.program = checked.program().cloned();
        Ok(CheckOutcome {
            sources: report.texts().clone(),
            diagnostics: report.diagnostics().clone(),
            analyses: self
                .program
                .as_ref()
                .map(|p| p.analyses().iter().map(ToString::to_string).collect())
                .unwrap_or_default(),
        })
    }

    fn reduce(&mut self) -> Result<ReductionOutcome, EngineError> {
        let Some(program) = &self.program else {
            return Err(EngineError::System("no model was checked".into()));
        };
        let mut found = ReductionOutcome::default();
        for name in program.models() {
            let model = match program.model(name) {
                Ok(model) => model,
                Err(Error::Report(report)) => {
                    found.diagnostics.extend(report.diagnostics().clone());
                    continue;
                }
                Err(other) => return Err(engine_error(other)),
            };
            for reduction in model.reductions() {
                let text = reduction.text();
                if !found.texts.contains(&text) {
                    found.texts.push(text);
                }
                reduction.doubts().for_each(|d| found.diagnostics.push(d));
            }
        }
        Ok(found)
    }

    fn describe(&mut self, results: &[&Results]) -> Result<Vec<Described>, EngineError> {
        let Some(program) = &self.program else {
            return Err(EngineError::System("no model was checked".into()));
        };
        let names: Vec<&str> = results.iter().map(|r| r.analysis()).collect();
        program
            .analyses_of(&names)
            .into_iter()
            .zip(results)
            .map(|(analysis, results)| {
                Described::new(analysis.map_err(engine_error)?, results.metadata())
                    .map_err(engine_error)
            })
            .collect()
    }

    fn reports(&self) -> Vec<eng_system::report::Report> {
        let program = self.program.as_ref();
        program.map_or_else(Vec::new, |program| program.reports().to_vec())
    }

    fn assemble(&mut self) -> Result<AssemblyOutcome, EngineError> {
        let Some(program) = &self.program else {
            return Err(EngineError::System("no model was checked".into()));
        };
        let mut found = AssemblyOutcome::default();
        for name in program.models() {
            match program.outlined(name) {
                Ok(model) => found.facts.push(model.summary()),
                // a mesh that reads well may still make no structure
                Err(Error::Report(report)) => {
                    found.diagnostics.extend(report.diagnostics().clone());
                }
                Err(other) => return Err(engine_error(other)),
            }
        }
        if found.diagnostics.has_errors() {
            return Ok(found);
        }
        let mut told = Vec::new();
        let mut geometries = Vec::new();
        let mut heard = Heard::default();
        let names = program.analyses();
        let analyses = program.analyses_with(&names, Bodies::Rigid);
        for (name, analysis) in names.iter().zip(analyses) {
            let analysis = match analysis {
                Ok(analysis) => analysis,
                Err(Error::Report(report)) => {
                    found.diagnostics.extend(report.diagnostics().clone());
                    continue;
                }
                Err(other) => return Err(engine_error(other)),
            };
            heard.take(&analysis);
            match topology(program, name, &analysis) {
                Ok((report, bends)) => {
                    // of analyses that differ in loads and speeds alone one is turned; a body that must bend is no geometry
                    let model = std::sync::Arc::as_ptr(&analysis.model().compiled().system);
                    let geometry = (model, analysis.geometry().map_err(engine_error)?);
                    let (mut turned, mut hanging) = (None, None);
                    if !bends && !geometries.contains(&geometry) {
                        geometries.push(geometry);
                        turned = analysis.dry_turn().map_err(engine_error)?;
                        hanging = analysis.hanging().map_err(engine_error)?;
                    }
                    for diagnostic in hanging.into_iter().chain(turned) {
                        if !told.contains(&diagnostic) {
                            told.push(diagnostic.clone());
                            found.diagnostics.push(diagnostic);
                        }
                    }
                    let equations = counted(
                        report.equations,
                        "constraint equation",
                        "constraint equations",
                    );
                    found.facts.push(match bends {
                        false => format!(
                            "{name}: assembles; {}, {equations}, {}{}",
                            counted(report.velocities, "velocity", "velocities"),
                            counted(report.freedom, "freedom", "freedoms"),
                            analysis.model().besides(),
                        ),
                        true => format!(
                            "{name}: assembles if its flexible bodies bend as the joints ask; {equations}"
                        ),
                    });
                }
                Err(Error::Run { report, .. } | Error::Report(report)) => {
                    // analyses of one model fail alike: each mistake once
                    for diagnostic in report.diagnostics().iter() {
                        if !told.contains(diagnostic) {
                            told.push(diagnostic.clone());
                            found.diagnostics.push(diagnostic.clone());
                        }
                    }
                }
                Err(other) => return Err(engine_error(other)),
            }
        }
        heard.tell(&mut found);
        Ok(found)
    }

    fn positions(&mut self) -> Result<Vec<Positions>, EngineError> {
        let Some(program) = &self.program else {
            return Err(EngineError::System("no model was checked".into()));
        };
        let names = program.analyses();
        let mut found: Vec<Positions> = Vec::new();
        for (name, analysis) in names
            .iter()
            .zip(program.analyses_with(&names, Bodies::Rigid))
        {
            let placed = analysis.and_then(|analysis| analysis.positions());
            let markers: Vec<PlacedMarker> = placed
                .map_err(engine_error)?
                .into_iter()
                .map(|(body, marker, position)| PlacedMarker {
                    body,
                    marker,
                    position,
                })
                .collect();
            match found.iter_mut().find(|known| known.markers == markers) {
                Some(known) => known.analyses.push((*name).to_owned()),
                None => found.push(Positions {
                    analyses: vec![(*name).to_owned()],
                    markers,
                }),
            }
        }
        Ok(found)
    }

    fn run(
        &mut self,
        analysis: &str,
        settings: &[Setting],
        progress: &mut dyn FnMut(Progress),
    ) -> Result<RunOutcome, EngineError> {
        let Some(program) = &self.program else {
            return Err(EngineError::System("no model was checked".into()));
        };
        let analysis = program.analysis(analysis).map_err(engine_error)?;
        let analysis = self.prepared(analysis, settings)?;
        run(&analysis, self.options.patient, &mut |event| {
            if let Event::Progress(now) = event {
                progress(now);
            }
        })
    }

    fn options(&mut self, options: RunOptions) {
        self.options = options;
    }

    fn record(&mut self, recording: &Recording) -> bool {
        self.recording = recording.clone();
        recording.folder.is_some()
    }

    fn run_many(
        &mut self,
        analyses: &[&str],
        settings: &[Setting],
        threads: NonZeroUsize,
        tell: &mut dyn FnMut(usize, Event),
    ) {
        let Some(program) = &self.program else {
            return;
        };
        let prepared: Vec<Result<Analysis, EngineError>> = program
            .analyses_of(analyses)
            .into_iter()
            .map(|made| self.prepared(made.map_err(engine_error)?, settings))
            .collect();
        let patient = self.options.patient;
        let next = AtomicUsize::new(0);
        let (sender, receiver) = mpsc::channel();
        let (mut ready, mut refused) = (Vec::new(), Vec::new());
        for (index, made) in prepared.into_iter().enumerate() {
            match made {
                Ok(analysis) => ready.push((index, analysis)),
                Err(error) => refused.push((index, error)),
            }
        }
        for (index, error) in refused {
            tell(index, Event::Done(Box::new(Err(error))));
        }
        std::thread::scope(|scope| {
            for _ in 0..threads.get().min(ready.len()) {
                let (sender, ready, next) = (sender.clone(), &ready, &next);
                scope.spawn(move || {
                    while let Some((index, analysis)) =
                        ready.get(next.fetch_add(1, Ordering::Relaxed))
                    {
                        // nobody listens any more only when the caller has gone
                        let result = run(analysis, patient, &mut |event| {
                            let _ = sender.send((*index, event));
                        });
                        let _ = sender.send((*index, Event::Done(Box::new(result))));
                    }
                });
            }
            drop(sender);
            for (index, event) in receiver {
                tell(index, event);
            }
        });
    }
}

/// Whether an analysis of a model with rigid bodies in place of flexible ones assembles; if it does not, whether it does where the markers
/// of these may move: joints may hold a body that bends in more ways than a rigid one.
fn topology(
    program: &Program,
    name: &str,
    analysis: &Analysis,
) -> Result<(TopologyReport, bool), Error> {
    match analysis.topology() {
        Ok(report) => Ok((report, false)),
        Err(Error::Run { .. }) if analysis.model().is_outlined() => {
            let mut loose = program.analyses_with(&[name], Bodies::Loose);
            match loose.pop() {
                Some(loose) => Ok((loose?.topology()?, true)),
                None => Ok((analysis.topology()?, false)),
            }
        }
        Err(other) => Err(other),
    }
}

/// An analysis with the parameters set on the command line.
fn with_settings(mut analysis: Analysis, settings: &[Setting]) -> Result<Analysis, EngineError> {
    for setting in settings {
        let usage = |e: Error| EngineError::Usage(format!("--set {}: {e}", setting.path));
        let parameter = analysis.parameter(&setting.path).map_err(usage)?;
        let value: Quantity = setting
            .value
            .parse()
            .map_err(|e: crate::QuantityError| usage(e.into()))?;
        analysis = analysis.set(parameter, value).map_err(usage)?;
    }
    Ok(analysis)
}

/// Watches a run for the command line: tells of its progress and of what slows it down, and stops it where nobody waits for its end.
struct Watching<'a> {
    analysis: &'a Analysis,
    tell: &'a mut dyn FnMut(Event),
    patient: bool,
    began: Instant,
    patience: Patience,
    /// Whether it was told what slows the run down.
    told: bool,
    /// Where it was stopped: time since it began, progress, seconds that the rest would take.
    lost: Option<(Duration, crate::Progress, f64)>,
}

impl Watch for Watching<'_> {
    fn progress(&mut self, now: crate::Progress) -> Verdict {
        (self.tell)(Event::Progress(Progress {
            fraction: now.fraction,
            time: now.time,
            cycle_angle: now.cycle_angle,
            cycles: now.cycles,
        }));
        let passed = self.began.elapsed();
        match self.patience.look(passed, now.fraction) {
            Look::Lost(left) if !self.patient => {
                self.lost = Some((passed, now, left));
                Verdict::Stop
            }
            Look::Now | Look::Lost(_) if !self.told => Verdict::Explain,
            _ => Verdict::GoOn,
        }
    }

    fn paced(&mut self, slow: &Slow) {
        if let Some(message) = crate::failure::slow(slow, self.analysis.name()) {
            self.told = true;
            (self.tell)(Event::Slow(Box::new(message)));
        }
    }
}

fn run(
    analysis: &Analysis,
    patient: bool,
    tell: &mut dyn FnMut(Event),
) -> Result<RunOutcome, EngineError> {
    let mut watch = Watching {
        analysis,
        tell,
        patient,
        began: Instant::now(),
        patience: Patience::default(),
        told: false,
        lost: None,
    };
    let ran = analysis.run_watched(&mut watch);
    match (ran, watch.lost) {
        (Ok(outcome), _) => run_outcome(analysis, outcome).map_err(engine_error),
        (Err(Failed { error, .. }), Some((passed, now, left))) if was_stopped(&error) => {
            let told = format!(
                "{} steps in {} s of computing were {:.1e} % of the run; at this pace the rest takes {}",
                now.steps,
                passed.as_secs(),
                100.0 * now.fraction,
                in_words(left)
            );
            let mut noted = Diagnostics::new();
            if let EngineError::Model { diagnostics, .. } = engine_error(*error) {
                let messages = diagnostics.iter().cloned();
                messages.for_each(|d| noted.push(d.with_note(told.clone())));
            }
            Err(EngineError::Stopped(noted))
        }
        (Err(Failed { error, partial }), _) => {
            let partial = partial.and_then(|o| run_outcome(analysis, *o).ok());
            Err(match engine_error(*error) {
                EngineError::Model { diagnostics, .. } => EngineError::Model {
                    diagnostics,
                    partial: partial.map(Box::new),
                },
                other => other,
            })
        }
    }
}

fn was_stopped(error: &Error) -> bool {
    matches!(error, Error::Run { cause, .. } if matches!(**cause, RuntimeError::Stopped(_)))
}

/// Where reduced bodies are kept: `ENG_CACHE` (empty: nowhere), else a folder of the user's caches.
fn cache_folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    if let Some(folder) = variable("ENG_CACHE") {
        return (!folder.is_empty()).then(|| PathBuf::from(folder));
    }
    let set = |name: &str| variable(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    set("XDG_CACHE_HOME")
        .or_else(|| set("LOCALAPPDATA"))
        .or_else(|| {
            let home = set("HOME")?;
            Some(if cfg!(target_os = "macos") {
                home.join("Library").join("Caches")
            } else {
                home.join(".cache")
            })
        })
        .map(|folder| folder.join("eng"))
}

fn engine_error(error: Error) -> EngineError {
    match error {
        Error::Report(report) | Error::Run { report, .. } => EngineError::Model {
            diagnostics: report.diagnostics().clone(),
            partial: None,
        },
        Error::Results(e) => EngineError::System(e.to_string()),
        Error::Code(e) => EngineError::System(e.to_string()),
        other => EngineError::Usage(other.to_string()),
    }
}

fn run_outcome(analysis: &Analysis, outcome: Outcome) -> Result<RunOutcome, Error> {
    let system = &analysis.model().compiled().system;
    let bound = analysis.bound()?;
    let mut diagnostics = Diagnostics::new();
    for reduction in analysis.model().reductions() {
        reduction.doubts().for_each(|d| diagnostics.push(d));
    }
    analysis
        .hanging()?
        .into_iter()
        .for_each(|d| diagnostics.push(d));
    let mut findings = analysis.findings()?;
    for warning in &outcome.warnings {
        // a run repeats what its parameters are advised at its start
        let repeated = |advice: &eng_system::code::Advice| {
            advice.origin == warning.origin && advice.message == warning.message
        };
        if !bound.advice.iter().any(repeated) {
            findings.push(Finding::of_run(warning));
        }
    }
    lint::diagnostics(&lint::sift(findings, system).told)
        .into_iter()
        .for_each(|d| diagnostics.push(d));
    let mut facts = analysis.replaced().to_vec();
    if outcome.made_before {
        facts.push("was complete, and is not run again".to_owned());
        let gone = |folder: &Path| {
            let name = format!("{}{}", analysis.name(), crate::motion::SUFFIX);
            let file = crate::results::file_stem(&name) + ".parquet";
            !folder.join(file).is_file()
        };
        let moves = !system.bodies.is_empty() && !crate::modes::are_modes(&outcome.results);
        if moves && analysis.recorded_to().is_some_and(gone) {
            facts.push(
                "its motion is not there: without --resume it is run again and makes it".to_owned(),
            );
        }
    }
    if let Some(start) = &outcome.start {
        facts.push(start.to_string());
        crate::failure::start_advice(start)
            .into_iter()
            .for_each(|d| diagnostics.push(d));
    }
    let repetition = Repetition::of(outcome.results.metadata());
    if let Some(found) = &repetition {
        facts.push(found.text());
        if let Some(warning) = found.warning(analysis.origin()) {
            diagnostics.push(warning);
        }
    }
    if let Some(periodic) = &outcome.periodic {
        let (told, warnings) = crate::failure::periodic(periodic, analysis, &bound);
        facts.extend(told);
        warnings.into_iter().for_each(|d| diagnostics.push(d));
    }
    if let Some(modes) = &outcome.modes {
        facts.extend(crate::modes::facts(modes));
    }
    if let Some(summary) = &outcome.summary {
        let s = &summary.statistics;
        facts.push(format!(
            "{} steps, {} rejected, {} Newton iterations, {} factorisations",
            s.steps, s.rejected, s.iterations, s.factorizations
        ));
        let e = &summary.energy;
        facts.push(format!(
            "energy: {} J kinetic, {:.3e} J out of balance",
            significant(e.kinetic, 6),
            e.imbalance()
        ));
    }
    Ok(RunOutcome {
        // rows that are modes have no orbits and no peaks
        journals: if crate::modes::are_modes(&outcome.results) {
            Vec::new()
        } else {
            journals(system, &bound)
        },
        cycle_period: crate::analysis::cycle_period(analysis.model().compiled(), &bound),
        upright: upright(system, &bound),
        firing: crate::report::firing(system, &bound),
        diagnostics,
        facts,
        point: analysis.point().to_vec(),
        periodic: repetition.map(|r| (r.cycles, r.repeats)),
        motion: (outcome.motion.samples() > 0).then_some(outcome.motion),
        results: outcome.results,
    })
}

/// The journals of a model with its numbers.
pub(crate) fn journals(system: &System, bound: &Bound) -> Vec<JournalGeometry> {
    system
        .journals
        .iter()
        .map(|j| JournalGeometry {
            path: system
                .elements
                .get(j.element as usize)
                .map(|e| e.origin.path.clone())
                .unwrap_or_default(),
            diameter: at(bound, j.diameter),
            width: at(bound, j.width),
            radial_clearance: at(bound, j.radial_clearance),
        })
        .collect()
}

/// The value of a slot.
pub(crate) fn at(bound: &Bound, slot: Slot) -> f64 {
    bound.slots.get(slot.0 as usize).copied().unwrap_or(0.0)
}

/// Orbits are drawn with gravity downwards.
pub(crate) fn upright(system: &System, bound: &Bound) -> Upright {
    let gravity = system.gravity.map(|slot| at(bound, slot));
    if gravity[0].abs() > gravity[1].abs() {
        Upright::X
    } else {
        Upright::Y
    }
}
