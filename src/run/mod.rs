//! Runs of analyses with their messages: one or several in parallel, with a watch that stops a run without
//! end.

pub(crate) mod patience;

use crate::analysis::{Failed, Outcome};
use crate::grid_error::{GridError, grid_errors};
use crate::lint::{self, Finding};
use crate::machine::Machine;
use crate::moment::Moment;
use crate::repetition::Repetition;
use crate::timings::{Clock, Timings};
use crate::{Analysis, Error, Gradient, Progress, Results, Slow, Verdict, Watch};
use eng_grammar::{Diagnostic, Diagnostics};
use eng_system::significant::{short, significant};
use eng_system::system::PointValue;
pub(crate) use patience::in_words;
use patience::{Estimate, Patience};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Duration;

/// The results of a run with its machine and its messages.
#[derive(Clone, Debug)]
pub struct RunOutcome {
    /// All columns.
    pub results: Results,
    /// The motion of the bodies in the last cycle, `ANALYSIS.motion`; absent if unknown.
    pub motion: Option<Results>,
    /// Journals, summaries, cycle and firing order. Modes have no journals and no summaries.
    pub machine: Machine,
    /// Warnings of the run (failed `advise`s), with places in the texts of the program.
    pub diagnostics: Diagnostics,
    /// Facts, one line each: steps, Newton iterations, energy.
    pub facts: Vec<String>,
    /// Its point in the sweep; empty for an analysis without an index.
    pub point: Vec<PointValue>,
    /// For a periodic analysis: number of cycles, and whether the last repeats; absent after a failure.
    pub periodic: Option<(u32, bool)>,
    /// The derivatives of the channels by the parameters that the analysis names.
    pub gradients: Vec<Gradient>,
    /// Whether an earlier run had completed it, so that this one computed and wrote nothing.
    pub made_before: bool,
    /// Processor time of the phases, if the analysis is [`Analysis::timed`].
    pub timings: Option<Timings>,
}

/// An event of a run.
#[derive(Debug)]
pub enum Event {
    /// It made progress.
    Progress(Progress),
    /// It is slow, with the reason.
    Slow(Box<Diagnostic>),
    /// It has ended.
    Done(Box<Result<RunOutcome, Failed<RunOutcome>>>),
}

/// Least time between two [`Event::Progress`] of an analysis among several. A choice: a line on a terminal
/// changes fifty times a second at most.
const BETWEEN: Duration = Duration::from_millis(20);

/// Runs several analyses, up to `threads` at a time. If there are fewer analyses than threads, each has an
/// equal share of the threads for its films on cells. `on_event` gets each event with the index of its
/// analysis in `analyses`; events of progress come at most fifty times a second. After a `Break` no further
/// analysis begins, and those that run are stopped. The results equal those of [`run`] to the last bit, for
/// any number of threads. `patient`: see [`run`].
pub fn run_many(
    analyses: &[Analysis],
    patient: bool,
    threads: NonZeroUsize,
    on_event: &mut dyn FnMut(usize, Event) -> ControlFlow<()>,
) {
    let next = AtomicUsize::new(0);
    let broken = AtomicBool::new(false);
    let (sender, receiver) = mpsc::channel();
    let together = threads.get().min(analyses.len().max(1));
    // with fewer analyses than threads, the films on cells of each have an equal share of the threads
    let each = NonZeroUsize::new(threads.get() / together).unwrap_or(NonZeroUsize::MIN);
    std::thread::scope(|scope| {
        for _ in 0..together {
            let (sender, next, broken) = (sender.clone(), &next, &broken);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let ended = broken.load(Ordering::Relaxed);
                    let Some(analysis) = analyses.get(index).filter(|_| !ended) else {
                        return;
                    };
                    // sending fails only after the receiver is closed, and then nobody needs the event
                    let mut last: Option<Moment> = None;
                    let result = run_on(analysis, patient, each, &mut |event| {
                        // an event wakes the thread that reads it, which takes some ten microseconds of a step
                        if broken.load(Ordering::Relaxed) {
                            return ControlFlow::Break(());
                        }
                        if matches!(event, Event::Progress(_)) {
                            if last.is_some_and(|last| last.elapsed() < BETWEEN) {
                                return ControlFlow::Continue(());
                            }
                            last = Some(Moment::now());
                        }
                        let _ = sender.send((index, event));
                        ControlFlow::Continue(())
                    });
                    let _ = sender.send((index, Event::Done(Box::new(result))));
                }
            });
        }
        drop(sender);
        for (index, event) in receiver {
            if !broken.load(Ordering::Relaxed) && on_event(index, event).is_break() {
                broken.store(true, Ordering::Relaxed);
            }
        }
    });
}

/// Runs an analysis. Without `patient`, a run that would take more than a day is stopped
/// ([`Error::is_stopped`]). Its files remain, so it can be resumed.
///
/// # Errors
/// Failures of the model, with the results up to the failure; failures of the disk.
pub fn run(
    analysis: &Analysis,
    patient: bool,
    on_event: &mut dyn FnMut(Event),
) -> Result<RunOutcome, Failed<RunOutcome>> {
    run_while(analysis, patient, &mut |event| {
        on_event(event);
        ControlFlow::Continue(())
    })
}

/// [`run`] as long as `on_event` allows. After a `Break` the run is stopped at its next step ([`Error::is_stopped`]), with its
/// results up to there.
///
/// # Errors
/// Those of [`run`].
pub fn run_while(
    analysis: &Analysis,
    patient: bool,
    on_event: &mut dyn FnMut(Event) -> ControlFlow<()>,
) -> Result<RunOutcome, Failed<RunOutcome>> {
    run_on(analysis, patient, analysis.own_threads(), on_event)
}

/// [`run`] with this number of threads for the fields of the analysis.
fn run_on(
    analysis: &Analysis,
    patient: bool,
    threads: NonZeroUsize,
    on_event: &mut dyn FnMut(Event) -> ControlFlow<()>,
) -> Result<RunOutcome, Failed<RunOutcome>> {
    let mut watch = Watching {
        analysis,
        on_event,
        patient,
        began: Moment::now(),
        patience: Patience::default(),
        explained: false,
        slowing: None,
        lost: None,
        broken: false,
    };
    let ran = analysis.run_on(threads, &mut watch);
    match (ran, watch.lost) {
        (Ok(outcome), _) => Ok(run_outcome(analysis, outcome)?),
        (Err(Failed { error, .. }), Some((passed, now, left))) if error.is_stopped() => {
            let note = format!(
                "{} steps in {} s of computing were {} % of the run; at this pace the rest takes {}",
                now.steps,
                passed.as_secs(),
                short(100.0 * now.fraction, 2),
                in_words(left)
            );
            Err(error.with_note(&note).into())
        }
        (Err(Failed { error, partial }), _) => Err(Failed {
            error,
            partial: partial
                .and_then(|outcome| run_outcome(analysis, *outcome).ok())
                .map(Box::new),
        }),
    }
}

/// Watches a run: reports its progress and the cause of short steps, and stops a run that would take too
/// long.
struct Watching<'a> {
    analysis: &'a Analysis,
    on_event: &'a mut dyn FnMut(Event) -> ControlFlow<()>,
    patient: bool,
    began: Moment,
    patience: Patience,
    /// Whether the cause of short steps was reported.
    explained: bool,
    /// Estimated remaining seconds of a run that slows down.
    slowing: Option<f64>,
    /// Data of a stopped run: time since its beginning, progress, estimated remaining seconds.
    lost: Option<(Duration, Progress, f64)>,
    /// Whether the caller has stopped the run.
    broken: bool,
}

impl Watching<'_> {
    fn tell(&mut self, event: Event) {
        self.broken |= (self.on_event)(event).is_break();
    }
}

impl Watch for Watching<'_> {
    fn progress(&mut self, now: Progress) -> Verdict {
        self.tell(Event::Progress(now));
        if self.broken {
            return Verdict::Stop;
        }
        let passed = self.began.elapsed();
        match self.patience.check(passed, now.fraction, now.steps) {
            Estimate::Lost(left) if !self.patient => {
                self.lost = Some((passed, now, left));
                Verdict::Stop
            }
            Estimate::Slowing(left) if !self.explained => {
                self.slowing = Some(left);
                Verdict::Explain
            }
            Estimate::Now | Estimate::Lost(_) if !self.explained => Verdict::Explain,
            _ => Verdict::GoOn,
        }
    }

    fn short_steps(&mut self, slow: &Slow) {
        let rest = self.slowing.map(in_words);
        if let Some(message) = crate::failure::slow(slow, self.analysis.name(), rest.as_deref()) {
            self.explained = true;
            self.tell(Event::Slow(Box::new(message)));
        }
    }
}

/// The machine of an analysis, reduced to the parts of which its results have columns: modes and responses have no orbits and
/// no peaks, and a prescribed motion has only the force of a film.
///
/// # Errors
/// Parameters that the model refuses.
pub fn machine_of(analysis: &Analysis, results: &Results) -> Result<Machine, Error> {
    let mut machine = analysis.machine()?;
    let of_motion = !results.are_modes() && !results.are_responses();
    if !of_motion {
        machine.journals.clear();
    }
    if !of_motion || analysis.kind().is_prescribed() {
        machine.summaries.clear();
    }
    Ok(machine)
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
    let mut findings = analysis.findings()?.list;
    for warning in &outcome.warnings {
        // a run reports failed `advise`s on parameters again, and the findings contain them already
        let repeated = |advice: &eng_system::code::Advice| {
            advice.origin == warning.origin && advice.message == warning.message
        };
        if !bound.advice.iter().any(repeated) {
            findings.push(Finding::of_run(warning, system));
        }
    }
    lint::diagnostics(&lint::sift(findings, system).reported)
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
        let of_motion = outcome.results.are_samples() || outcome.results.is_state();
        let moves = !system.bodies.is_empty() && of_motion;
        if moves && analysis.recorded_to().is_some_and(gone) {
            facts.push("its motion is missing: run it without --resume to make it".to_owned());
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
    if let Some(stopped) = outcome.results.stopped() {
        facts.push(format!("ended by its condition {stopped}"));
    }
    if let Some(periodic) = &outcome.periodic {
        let (lines, warnings) = crate::failure::periodic(periodic, system, &bound);
        facts.extend(lines);
        warnings.into_iter().for_each(|d| diagnostics.push(d));
    }
    if let Some(modes) = &outcome.modes {
        facts.extend(crate::modes::facts(modes));
        facts.extend(analysis.facts_of_matrices(modes));
    }
    if let Some(response) = &outcome.response {
        facts.extend(crate::response::facts(response));
    }
    if let Some(determined) = &outcome.determined {
        let places = (&**system, analysis.origin());
        crate::kinematic::tell(determined, places, &mut facts, &mut diagnostics);
    }
    let linearised = outcome
        .modes
        .iter()
        .chain(outcome.response.iter().map(|found| &found.modes));
    for warning in linearised.flat_map(|modes| analysis.unmoved(modes)) {
        diagnostics.push(warning);
    }
    if let Some(summary) = &outcome.summary {
        let s = &summary.statistics;
        facts.push(format!(
            "{} steps, {} rejected, {} Newton iterations, {} factorisations",
            s.steps, s.rejected, s.iterations, s.factorizations
        ));
        let e = &summary.energy;
        facts.push(format!(
            "energy: {} J kinetic, {} J out of balance",
            significant(e.kinetic, 6),
            significant(e.imbalance(), 3)
        ));
        let damped = summary.damped.as_ref();
        if let Some(warning) = damped.map(|d| crate::failure::damped(d, analysis.origin())) {
            diagnostics.push(warning);
        }
        let overlooked = summary.overlooked.as_ref();
        if let Some(warning) = overlooked.map(|o| crate::failure::overlooked(o, analysis.origin()))
        {
            diagnostics.push(warning);
        }
    }
    let machine = machine_of(analysis, &outcome.results)?;
    let mut clock = Clock::new();
    let errors = match outcome.results.is_state() {
        true => Vec::new(),
        false => grid_errors(&machine, &outcome.motion),
    };
    let cells = clock.since();
    facts.extend(errors.iter().map(GridError::text));
    Ok(RunOutcome {
        machine,
        diagnostics,
        facts,
        point: analysis.point().to_vec(),
        periodic: repetition.map(|r| (r.cycles, r.repeats)),
        gradients: outcome.gradients,
        made_before: outcome.made_before,
        timings: outcome.timings.map(|spent| Timings { cells, ..spent }),
        motion: (outcome.motion.samples() > 0).then_some(outcome.motion),
        results: outcome.results,
    })
}
