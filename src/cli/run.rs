//! `eng run`.

use super::arguments::{RunArguments, RunCommand, Setting, Settings};
use super::files::{claim, draw_all, folder_of, or_stop, wrote};
use super::open::checked;
use super::outcomes::{Ended, Outcomes};
use super::outputs::{Output, apart};
use super::progress::Bars;
use super::terminal::Terminal;
use super::{MODEL_WRONG, Refusal, Stop, USAGE_OR_SYSTEM, post, study};
use crate::analysis::Analysis;
use crate::error::Error;
use crate::figures;
use crate::indexed::{base, listed};
use crate::post::Run;
use crate::program::Program;
use crate::quantity::{Quantity, QuantityError};
use crate::render::visible_name;
use crate::results::{Last, Recording, Selection, stem_of, writable};
use crate::run::{Event, RunOutcome, run_many};
use crate::tables::{over_points_of, sweep};
use crate::timings::{self, Clock};
use eng_grammar::Diagnostics;
use eng_system::Dimension;
use eng_system::analysis::AnalysisKind;
use eng_system::system::StepControl;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::Path;

pub(super) fn run(command: &RunCommand, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let arguments = &command.run;
    or_stop(set_once(&arguments.settings.set), console)?;
    let mut clock = Clock::new();
    let program = checked(&arguments.model, console)?;
    let check = clock.since();
    if command.study.are_stated() {
        return study::run(command, &program, console);
    }
    let folder = folder_of(arguments);
    let due = due(arguments, &program, &folder, arguments.resume, console)?;
    let code = clock.since();
    let all = due.len();
    let mut outcomes = Outcomes::new(arguments, &program, &folder);
    run_all(due, &mut outcomes, &mut || false, console)?;
    let holds = conclude(&outcomes, all, console)?;
    if arguments.timings && !arguments.quiet {
        let phases = [
            ("check", check),
            ("reductions and machine code", code),
            ("tables, pictures and reports", clock.since()),
        ];
        writeln!(console.output, "{}", timings::line(&phases))?;
    }
    if !outcomes.failures.is_empty() || !holds {
        return Err(Stop::Code(MODEL_WRONG));
    }
    Ok(())
}

/// The name of an analysis, and the analysis with the settings of the command line.
pub(super) type Due<'p> = (&'p str, Result<Analysis, Refusal>);

/// The requested analyses with the settings of the command line. Refuses outputs that cannot be written.
pub(super) fn due<'p>(
    arguments: &RunArguments,
    program: &'p Program,
    folder: &Path,
    resume: bool,
    console: &mut Terminal<'_>,
) -> Result<Vec<Due<'p>>, Stop> {
    let names = chosen(&arguments.model, &arguments.analysis, program, console)?;
    let recording = or_stop(recording(arguments, folder, resume), console)?;
    // refuse them before any computation
    for name in &names {
        let file = |ending: &str| folder.join(format!("{}.{ending}", stem_of(name, false)));
        or_stop(writable(&file("parquet")), console)?;
        if arguments.csv {
            let csv = Output::new("--csv:", file("csv"));
            or_stop(apart(&program.files(), std::slice::from_ref(&csv)), console)?;
            or_stop(writable(&csv.path), console)?;
        }
    }
    or_stop(claim(arguments, folder), console)?;
    let settings = &arguments.settings;
    let steps = or_stop(steps(settings), console)?;
    let prepared = program.analyses_of(&names).into_iter();
    let prepared = prepared.map(|made| -> Result<Analysis, Refusal> {
        let mut analysis = prepare(made?, settings, steps)?.record(recording.clone());
        if !arguments.gradients.is_empty() {
            let usage = |e: Error| Refusal::Usage(format!("--gradients: {e}"));
            analysis = analysis.gradients(&arguments.gradients).map_err(usage)?;
        }
        Ok(match arguments.timings {
            true => analysis.timed(),
            false => analysis,
        })
    });
    Ok(names.iter().copied().zip(prepared).collect())
}

/// Makes the tables over the points of sweeps, the figures of several analyses and the reports after a round of `all`
/// analyses, except for those that an earlier round has made. Returns true if all conditions of the reports hold and the results
/// give all entries.
pub(super) fn conclude(
    outcomes: &Outcomes<'_>,
    all: usize,
    console: &mut Terminal<'_>,
) -> Result<bool, Stop> {
    let (arguments, folder) = (outcomes.arguments, outcomes.folder);
    for line in outcomes.repeated(all) {
        writeln!(console.errors, "{line}")?;
    }
    for family in sweep::families(&outcomes.completed) {
        if family.iter().any(|o| outcomes.is_new(o.results.analysis())) {
            over_points(&family, &outcomes.failures, arguments, folder, console)?;
        }
    }
    if !arguments.no_plots {
        let compared: Vec<Run<'_>> = outcomes
            .completed
            .iter()
            .filter(|o| o.point.is_empty() && o.results.are_samples())
            .map(|o| Run::new(&o.results, &o.machine))
            .collect();
        let new = |run: &Run<'_>| outcomes.is_new(run.results.analysis());
        if compared.iter().any(new) {
            // without the failed analyses these figures differ from those of all analyses, so their names mark
            // them as failed
            let failed = !outcomes.failures.is_empty();
            let wanted = figures::comparisons(&compared);
            draw_all(&wanted, &compared, failed, folder, arguments, console)?;
        }
    }
    post::reports(outcomes, console)
}

/// An analysis with the settings of the command line.
pub(super) fn prepare(
    mut analysis: Analysis,
    settings: &Settings,
    steps: Option<StepControl>,
) -> Result<Analysis, Refusal> {
    for setting in &settings.set {
        let usage = |e: Error| Refusal::Usage(format!("--set {}: {e}", setting.path));
        if analysis.chooses(&setting.path) {
            analysis = analysis
                .choose(&setting.path, setting.value.trim())
                .map_err(usage)?;
            continue;
        }
        let parameter = analysis.parameter(&setting.path).map_err(usage)?;
        let value: Quantity = setting
            .value
            .parse()
            .map_err(|e: QuantityError| usage(e.into()))?;
        analysis = analysis.set(parameter, value).map_err(usage)?;
    }
    Ok(match steps {
        Some(steps) => analysis.stepping(steps),
        None => analysis,
    })
}

/// Runs the analyses side by side and reports them in the order of the text. An analysis that has ended waits
/// for those before it. `ends` is asked while they run: if it returns true, the runs are stopped. Returns whether it did.
pub(super) fn run_all(
    due: Vec<Due<'_>>,
    outcomes: &mut Outcomes<'_>,
    ends: &mut dyn FnMut() -> bool,
    console: &mut Terminal<'_>,
) -> Result<bool, Stop> {
    let (arguments, texts) = (outcomes.arguments, outcomes.program.texts());
    let names: Vec<&str> = due.iter().map(|(name, _)| *name).collect();
    let advice = due
        .iter()
        .any(|(_, made)| made.as_ref().is_ok_and(can_resume));
    let advice = advice.then_some("Ctrl-C keeps the samples so far, and --resume continues");
    let mut bars = Bars::new(names.len(), arguments.quiet || !console.live, advice);
    let mut queue = Queue {
        names: &names,
        outcomes,
        ended: Vec::new(),
        next: 0,
        stop: None,
    };
    // indices of the prepared analyses among the names
    let (mut ready, mut places) = (Vec::new(), Vec::new());
    for (place, (_, prepared)) in due.into_iter().enumerate() {
        match prepared {
            Ok(analysis) => {
                ready.push(analysis);
                places.push(place);
                queue.ended.push(None);
            }
            Err(refusal) => queue.ended.push(Some(Err(refusal))),
        }
    }
    queue.go_on(console);
    // if the first analysis refuses a setting, the command stops before any run
    if let Some(stop) = queue.stop {
        return Err(stop);
    }
    let threads = threads(arguments);
    let mut stopped = false;
    run_many(
        &ready,
        arguments.settings.patient,
        threads,
        &mut |index, event| {
            let place = places[index];
            match event {
                Event::Progress(progress) => bars.show(place, names[place], progress),
                Event::Slow(message) => {
                    let mut messages = Diagnostics::new();
                    messages.push(*message);
                    // an error of the console is handled at the end
                    bars.suspend(|| {
                        let _ = console.errors.messages(&messages, texts);
                    });
                }
                Event::Done(result) => {
                    bars.end(place);
                    queue.ended[place] = Some(Ok(*result));
                    bars.suspend(|| queue.go_on(console));
                }
            }
            stopped = ends();
            match stopped {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        },
    );
    if stopped {
        (0..names.len()).for_each(|place| bars.end(place));
        queue.go_over_all(console);
    }
    queue.stop.map_or(Ok(stopped), Err)
}

/// Whether a run that is interrupted leaves a checkpoint from which `--resume` continues.
fn can_resume(analysis: &Analysis) -> bool {
    matches!(analysis.kind(), AnalysisKind::Transient(run) if run.gradients.is_empty())
}

/// Analyses that have ended and wait for their turn in the report.
struct Queue<'q, 't> {
    names: &'q [&'q str],
    outcomes: &'q mut Outcomes<'t>,
    ended: Vec<Option<Result<Ended, Refusal>>>,
    next: usize,
    stop: Option<Stop>,
}

impl Queue<'_, '_> {
    /// Reports the analyses whose turn has come.
    fn go_on(&mut self, console: &mut Terminal<'_>) {
        while self.stop.is_none()
            && let Some(result) = self.ended.get_mut(self.next).and_then(Option::take)
        {
            let done = match result {
                Ok(result) => self.outcomes.add(self.names[self.next], result, console),
                Err(refusal) => Err(refusal.show(self.outcomes.program.texts(), console)),
            };
            self.next += 1;
            self.stop = done.err();
        }
    }

    /// Reports all analyses that have ended, also after one that has not.
    fn go_over_all(&mut self, console: &mut Terminal<'_>) {
        while self.next < self.ended.len() {
            self.go_on(console);
            self.next += 1;
        }
    }
}

/// Prints and writes the table over the points of a sweep.
fn over_points(
    family: &[&RunOutcome],
    failures: &[String],
    arguments: &RunArguments,
    folder: &Path,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let (mut table, text) = over_points_of(family);
    let missing: Vec<&str> = failures
        .iter()
        .filter(|name| base(name) == table.analysis())
        .map(String::as_str)
        .collect();
    if !missing.is_empty() {
        table.set_failure(&format!("no row of {}, which failed", missing.join(", ")));
    }
    if !arguments.quiet {
        write!(console.output, "{text}")?;
    }
    let path = or_stop(table.write_parquet(folder), console)?;
    wrote(&path, arguments, console)?;
    if arguments.csv {
        let path = or_stop(table.write_csv(folder), console)?;
        wrote(&path, arguments, console)?;
    }
    Ok(())
}

/// Refuses a parameter with two values.
pub(super) fn set_once(settings: &[Setting]) -> Result<(), String> {
    for (index, setting) in settings.iter().enumerate() {
        let before = settings.iter().take(index);
        if let Some(other) = before.clone().find(|other| other.path == setting.path) {
            return Err(format!(
                "--set {} is given twice: {} and {}; give it once",
                setting.path, other.value, setting.value
            ));
        }
    }
    Ok(())
}

/// The kept part of the results, and its folder.
pub(super) fn recording(
    arguments: &RunArguments,
    folder: &Path,
    resume: bool,
) -> Result<Recording, String> {
    let last = match &arguments.last {
        None => None,
        Some(text) => {
            let part: Quantity = text.parse().map_err(|e| format!("--last {text}: {e}"))?;
            let part = Last::new(part.value(), part.dimension());
            Some(part.map_err(|e| format!("--last {text}: {e}"))?)
        }
    };
    Ok(Recording {
        folder: Some(folder.to_owned()),
        resume,
        channels: Selection::new(arguments.channels.iter().map(String::as_str)),
        last,
    })
}

/// The steps that the command line requests instead of those of the text.
pub(super) fn steps(settings: &Settings) -> Result<Option<StepControl>, String> {
    let step = match &settings.step {
        Some(text) => {
            let step: Quantity = text.parse().map_err(|e| format!("--step {text}: {e}"))?;
            if step.dimension() != Dimension::TIME {
                return Err(format!("--step {text}: a step is a time, such as 10us"));
            }
            Some(step.value())
        }
        None => None,
    };
    for (name, value) in [("step", step), ("tolerance", settings.tolerance)] {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
            return Err(format!(
                "--{name}: it must be positive and finite, not {value}"
            ));
        }
    }
    Ok(StepControl::stated(step, settings.tolerance))
}

/// The requested number of threads, or the number of the machine's processors.
pub(super) fn threads(arguments: &RunArguments) -> NonZeroUsize {
    arguments
        .threads
        .or_else(|| std::thread::available_parallelism().ok())
        .unwrap_or(NonZeroUsize::MIN)
}

/// The requested analyses, or all.
pub(super) fn chosen<'a>(
    model: &Path,
    wanted: &[String],
    program: &'a Program,
    console: &mut Terminal<'_>,
) -> Result<Vec<&'a str>, Stop> {
    let known = program.analyses();
    let mut analyses: Vec<&str> = Vec::new();
    for asked in wanted {
        // `sweep` selects all of `sweep[1]`, `sweep[2]`, …
        let found: Vec<&str> = known
            .iter()
            .copied()
            .filter(|name| *name == asked || base(name) == asked)
            .collect();
        if found.is_empty() {
            writeln!(
                console.errors,
                "error: {} has no analysis {}; it has {}",
                visible_name(&model.display().to_string()),
                visible_name(asked),
                if known.is_empty() {
                    "none".to_owned()
                } else {
                    listed(known.iter().copied())
                }
            )?;
            return Err(Stop::Code(USAGE_OR_SYSTEM));
        }
        for name in found {
            if !analyses.contains(&name) {
                analyses.push(name);
            }
        }
    }
    if wanted.is_empty() {
        analyses.extend(&known);
    }
    if analyses.is_empty() {
        writeln!(
            console.errors,
            "error: {} has no analysis; write one: analysis run = transient(…)",
            model.display()
        )?;
        return Err(Stop::Code(MODEL_WRONG));
    }
    Ok(analyses)
}
