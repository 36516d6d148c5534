//! `eng run`.

use super::arguments::RunArguments;
use super::summary::{JournalSummary, journal_table};
use super::terminal::Terminal;
use super::{
    CheckOutcome, Engine, EngineError, Event, MODEL_WRONG, Progress, RunOptions, RunOutcome,
    Setting, Stop, USAGE_OR_SYSTEM, figures, modes, post, sweep,
};
use crate::Quantity;
use crate::modes::are_modes;
use crate::plot;
use crate::results::{Last, Recording, Selection, failed_twin, stem_of, writable};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap};
use eng_system::Dimension;
use eng_system::system::StepControl;
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// A model that can be gone on with; what the check says is shown.
pub(super) fn checked(
    model: &Path,
    engine: &mut dyn Engine,
    console: &mut Terminal<'_>,
) -> Result<CheckOutcome, Stop> {
    let checked = match engine.check(model) {
        Ok(checked) => checked,
        Err(error) => return Err(explain_error(&error, &SourceMap::new(), console)),
    };
    show(&checked.diagnostics, &checked.sources, console)?;
    match checked.diagnostics.has_errors() {
        true => Err(Stop::Code(MODEL_WRONG)),
        false => Ok(checked),
    }
}

pub(super) fn run(
    arguments: &RunArguments,
    engine: &mut dyn Engine,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    told_of(set_once(&arguments.set), console)?;
    let checked = checked(&arguments.model, engine, console)?;
    let analyses = chosen(&arguments.model, &arguments.analysis, &checked, console)?;
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| results_folder(&arguments.model));
    let recording = recording(arguments, &folder);
    let recording = told_of(recording, console)?;
    // before anything is computed
    for name in &analyses {
        let stem = stem_of(name, false);
        told_of(writable(&folder.join(format!("{stem}.parquet"))), console)?;
        if arguments.csv {
            told_of(writable(&folder.join(format!("{stem}.csv"))), console)?;
        }
    }
    let written = engine.record(&recording);
    engine.options(told_of(options(arguments), console)?);
    let bars = MultiProgress::with_draw_target(if !arguments.quiet && console.live {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    });
    let mut shown: Vec<Option<ProgressBar>> = vec![None; analyses.len()];
    let mut ended: Vec<Option<Result<RunOutcome, EngineError>>> =
        analyses.iter().map(|_| None).collect();
    let mut told = Told {
        written,
        ..Told::default()
    };
    engine.run_many(
        &analyses,
        &arguments.set,
        threads(arguments),
        &mut |index, event| {
            let (Some(bar), Some(end), Some(name)) = (
                shown.get_mut(index),
                ended.get_mut(index),
                analyses.get(index),
            ) else {
                return;
            };
            match event {
                Event::Progress(progress) => {
                    let bar = bar.get_or_insert_with(|| bars.add(progress_bar(name)));
                    show_progress(bar, progress);
                }
                Event::Slow(message) => {
                    let mut messages = Diagnostics::new();
                    messages.push(*message);
                    // a console that takes nothing more is found out at the end
                    bars.suspend(|| {
                        let _ = console.errors.messages(&messages, &checked.sources);
                    });
                }
                Event::Done(result) => {
                    if let Some(bar) = bar.take() {
                        bar.finish_and_clear();
                        bars.remove(&bar);
                    }
                    *end = Some(*result);
                    bars.suspend(|| {
                        told.go_on(&analyses, &mut ended, arguments, &checked, &folder, console);
                    });
                }
            }
        },
    );
    if let Some(stop) = told.stop {
        return Err(stop);
    }
    let outcomes = told.outcomes;
    for family in sweep::families(&outcomes) {
        let of_modes = family.iter().all(|o| are_modes(&o.results));
        let (mut table, text) = if of_modes {
            let name = sweep::name(&family);
            (
                modes::campbell(name, &family),
                modes::campbell_text(name, &family),
            )
        } else {
            let table = sweep::table(&family);
            let text = sweep::text(&table);
            (table, text)
        };
        let missing: Vec<&str> = told
            .failures
            .iter()
            .filter(|name| name.split('[').next() == Some(table.analysis()))
            .map(String::as_str)
            .collect();
        if !missing.is_empty() {
            table.set_failure(&format!("no row of {}, which failed", missing.join(", ")));
        }
        if !arguments.quiet {
            write!(console.output, "{text}")?;
        }
        let path = told_of(table.write_parquet(&folder), console)?;
        wrote(&path, arguments, console)?;
        if arguments.csv {
            let path = told_of(table.write_csv(&folder), console)?;
            wrote(&path, arguments, console)?;
        }
    }
    if !arguments.no_plots {
        let compared: Vec<&RunOutcome> = outcomes
            .iter()
            .filter(|o| o.point.is_empty() && !are_modes(&o.results))
            .collect();
        // without those that failed they are not what they are with them
        let failed = !told.failures.is_empty();
        let figures = figures::comparisons(&compared);
        draw(figures, failed, &folder, arguments, console)?;
    }
    let holds = post::reports(&outcomes, arguments, &checked, &folder, engine, console)?;
    if !told.failures.is_empty() || !holds {
        return Err(Stop::Code(MODEL_WRONG));
    }
    Ok(())
}

/// Refuses a parameter with two values.
fn set_once(settings: &[Setting]) -> Result<(), String> {
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

/// What is kept, and where.
fn recording(arguments: &RunArguments, folder: &Path) -> Result<Recording, String> {
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
        resume: arguments.resume,
        channels: Selection::new(arguments.channels.iter().map(String::as_str)),
        last,
    })
}

/// How the analyses are run.
fn options(arguments: &RunArguments) -> Result<RunOptions, String> {
    let step = match &arguments.step {
        Some(text) => {
            let step: Quantity = text.parse().map_err(|e| format!("--step {text}: {e}"))?;
            if step.dimension() != Dimension::TIME {
                return Err(format!("--step {text}: a step is a time, such as 10us"));
            }
            Some(step.value())
        }
        None => None,
    };
    for (name, value) in [("step", step), ("tolerance", arguments.tolerance)] {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
            return Err(format!(
                "--{name}: it must be positive and finite, not {value}"
            ));
        }
    }
    let step = match (step, arguments.tolerance) {
        (Some(step), Some(tolerance)) => Some(StepControl::FixedTo { step, tolerance }),
        (Some(step), None) => Some(StepControl::Fixed(step)),
        (None, tolerance) => tolerance.map(StepControl::Tolerance),
    };
    Ok(RunOptions {
        step,
        patient: arguments.patient,
    })
}

/// As many as asked for, or as the machine has processors.
fn threads(arguments: &RunArguments) -> NonZeroUsize {
    arguments
        .threads
        .or_else(|| std::thread::available_parallelism().ok())
        .unwrap_or(NonZeroUsize::MIN)
}

/// What was told of the analyses, in the order of the text whichever ends first.
#[derive(Default)]
struct Told {
    /// Whether the engine has written the results.
    written: bool,
    next: usize,
    outcomes: Vec<RunOutcome>,
    /// Each message once, though analyses of one model fail alike.
    messages: Vec<Diagnostic>,
    /// Names of the analyses that failed.
    failures: Vec<String>,
    stop: Option<Stop>,
}

impl Told {
    /// Tells of those that have ended and whose forerunners were told of.
    fn go_on(
        &mut self,
        analyses: &[&str],
        ended: &mut [Option<Result<RunOutcome, EngineError>>],
        arguments: &RunArguments,
        checked: &CheckOutcome,
        folder: &Path,
        console: &mut Terminal<'_>,
    ) {
        while self.stop.is_none()
            && let Some(result) = ended.get_mut(self.next).and_then(Option::take)
        {
            let name = analyses.get(self.next).copied().unwrap_or_default();
            self.next += 1;
            if let Err(stop) = self.tell(name, result, arguments, checked, folder, console) {
                self.stop = Some(stop);
            }
        }
    }

    fn tell(
        &mut self,
        analysis: &str,
        result: Result<RunOutcome, EngineError>,
        arguments: &RunArguments,
        checked: &CheckOutcome,
        folder: &Path,
        console: &mut Terminal<'_>,
    ) -> Result<(), Stop> {
        match result {
            Ok(outcome) => {
                self.show(&outcome.diagnostics, checked, console)?;
                report(&outcome, self.written, arguments, folder, console)?;
                self.outcomes.push(outcome);
            }
            Err(EngineError::Model {
                diagnostics,
                partial,
            }) => {
                self.show(&diagnostics, checked, console)?;
                self.failures.push(analysis.to_owned());
                match partial {
                    Some(mut partial) => {
                        if partial.results.failure().is_none() {
                            let reason = diagnostics.iter().next().map(|d| d.title.clone());
                            let reason = reason.unwrap_or_else(|| "the run failed".to_owned());
                            partial.results.set_failure(&reason);
                        }
                        self.show(&partial.diagnostics, checked, console)?;
                        writeln!(
                            console.errors,
                            "{analysis} failed; the results up to the failure are kept as {}, those of an earlier run stay as they are",
                            partial.results.stem()
                        )?;
                        report(&partial, self.written, arguments, folder, console)?;
                    }
                    None => writeln!(
                        console.errors,
                        "{analysis} failed before its first sample; results of an earlier run stay as they are"
                    )?,
                }
            }
            Err(EngineError::Stopped(diagnostics)) => {
                self.show(&diagnostics, checked, console)?;
                self.failures.push(analysis.to_owned());
                writeln!(
                    console.errors,
                    "{analysis} was stopped: `--patient` runs it to its end however long that takes, `--patient --resume` from where it stands"
                )?;
            }
            Err(error) => return Err(explain_error(&error, &checked.sources, console)),
        }
        Ok(())
    }

    fn show(
        &mut self,
        diagnostics: &Diagnostics,
        checked: &CheckOutcome,
        console: &mut Terminal<'_>,
    ) -> Result<(), Stop> {
        let mut new = Diagnostics::new();
        for diagnostic in diagnostics.iter() {
            if !self.messages.contains(diagnostic) {
                self.messages.push(diagnostic.clone());
                new.push(diagnostic.clone());
            }
        }
        show(&new, &checked.sources, console)
    }
}

/// The analyses that are meant: those asked for, or all.
pub(super) fn chosen<'a>(
    model: &Path,
    wanted: &[String],
    checked: &'a CheckOutcome,
    console: &mut Terminal<'_>,
) -> Result<Vec<&'a str>, Stop> {
    let known = &checked.analyses;
    let mut analyses: Vec<&str> = Vec::new();
    for asked in wanted {
        // `sweep` stands for all of `sweep[1]`, `sweep[2]`, …
        let found: Vec<&str> = known
            .iter()
            .map(String::as_str)
            .filter(|name| *name == asked || name.split('[').next() == Some(asked.as_str()))
            .collect();
        if found.is_empty() {
            writeln!(
                console.errors,
                "error: {} has no analysis {asked}; it has {}",
                model.display(),
                if known.is_empty() {
                    "none".to_owned()
                } else {
                    known.join(", ")
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
        analyses.extend(known.iter().map(String::as_str));
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

/// Where results are kept if nothing else is said.
pub(super) fn results_folder(model: &Path) -> PathBuf {
    Path::new("results").join(model.file_stem().unwrap_or_default())
}

/// Writes the files of one analysis, prints its table.
fn report(
    outcome: &RunOutcome,
    written: bool,
    arguments: &RunArguments,
    folder: &Path,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let results = &outcome.results;
    if !arguments.quiet {
        writeln!(
            console.output,
            "{} ({})",
            results.analysis(),
            results.model()
        )?;
        let point: Vec<String> = outcome
            .point
            .iter()
            .map(|p| format!("{} = {}", p.name, p.display.text(p.value)))
            .collect();
        if !point.is_empty() {
            writeln!(console.output, "  {}", point.join(", "))?;
        }
        for fact in &outcome.facts {
            writeln!(console.output, "  {fact}")?;
        }
        let summaries: Vec<JournalSummary> = outcome
            .journals
            .iter()
            .map(|journal| JournalSummary::new(results, journal, outcome.cycle_period))
            .collect();
        if outcome.point.is_empty() {
            write!(console.output, "{}", journal_table(&summaries))?;
            if are_modes(results) {
                write!(console.output, "{}", modes::table(results))?;
            }
        }
    }
    let path = if written {
        folder.join(format!("{}.parquet", results.stem()))
    } else {
        told_of(results.write_parquet(folder), console)?
    };
    wrote(&path, arguments, console)?;
    if let Some(motion) = &outcome.motion {
        let path = if written {
            folder.join(format!("{}.parquet", motion.stem()))
        } else {
            told_of(motion.write_parquet(folder), console)?
        };
        wrote(&path, arguments, console)?;
    }
    if arguments.csv {
        let written = results.write_csv(folder);
        let path = told_of(written, console)?;
        wrote(&path, arguments, console)?;
    }
    // of a sweep the table over its points tells more
    if !arguments.no_plots && outcome.point.is_empty() && !are_modes(results) {
        let failed = results.failure().is_some();
        draw(
            figures::of_analysis(outcome),
            failed,
            folder,
            arguments,
            console,
        )?;
    }
    Ok(())
}

pub(super) fn draw(
    figures: Vec<(String, String)>,
    failed: bool,
    folder: &Path,
    arguments: &RunArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    for (name, svg) in figures {
        let written = plot::write_svg_and_png(&svg, folder, &stem_of(&name, failed));
        for path in told_of(written, console)? {
            wrote(&path, arguments, console)?;
        }
    }
    Ok(())
}

fn wrote(path: &Path, arguments: &RunArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    // what a failed run left is out of date; where it can't be removed, it still says what it is
    if let Some(twin) = failed_twin(path) {
        let _ = std::fs::remove_file(twin);
    }
    if !arguments.quiet {
        writeln!(console.output, "  wrote {}", path.display())?;
    }
    Ok(())
}

/// The value, or the error on the console.
pub(super) fn told_of<T, E: std::fmt::Display>(
    result: Result<T, E>,
    console: &mut Terminal<'_>,
) -> Result<T, Stop> {
    match result {
        Ok(value) => Ok(value),
        Err(error) => {
            writeln!(console.errors, "error: {error}")?;
            Err(Stop::Code(USAGE_OR_SYSTEM))
        }
    }
}

pub(super) fn show(
    diagnostics: &Diagnostics,
    sources: &SourceMap,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    Ok(console.errors.messages(diagnostics, sources)?)
}

/// Tells an error and gives the way to stop for it.
pub(super) fn explain_error(
    error: &EngineError,
    sources: &SourceMap,
    console: &mut Terminal<'_>,
) -> Stop {
    let (told, code) = match error {
        EngineError::Model { diagnostics, .. } | EngineError::Stopped(diagnostics) => {
            (show(diagnostics, sources, console), MODEL_WRONG)
        }
        EngineError::Usage(message) | EngineError::System(message) => (
            writeln!(console.errors, "error: {message}").map_err(Stop::from),
            USAGE_OR_SYSTEM,
        ),
    };
    match told {
        Ok(()) => Stop::Code(code),
        Err(stop) => stop,
    }
}

const BAR: u64 = 1000;

fn progress_bar(analysis: &str) -> ProgressBar {
    let target = ProgressDrawTarget::hidden();
    let bar = ProgressBar::with_draw_target(Some(BAR), target).with_prefix(analysis.to_owned());
    let template = "{prefix} {wide_bar} {percent:>3} %  {msg}  {eta} left";
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style.progress_chars("━╸─")),
        Err(_) => bar,
    }
}

fn show_progress(bar: &ProgressBar, progress: Progress) {
    bar.set_message(place(progress));
    bar.set_position((progress.fraction.clamp(0.0, 1.0) * BAR as f64) as u64);
}

/// `1260 °CA`, or the time of a model without cycle.
fn place(progress: Progress) -> String {
    if let Some((cycles, change)) = progress.cycles {
        return match change {
            Some(change) => format!("{cycles} cycles, {:.3} % change", 100.0 * change),
            None => format!("{cycles} cycles"),
        };
    }
    match progress.cycle_angle {
        Some(angle) => format!("{:.0} °CA", angle.to_degrees()),
        None => format!("{:.6} s", progress.time),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_names_the_angle_or_the_time() {
        let mut progress = Progress {
            fraction: 0.5,
            time: 0.03,
            cycle_angle: Some(4.0 * std::f64::consts::PI),
            cycles: None,
        };
        assert_eq!(place(progress), "720 °CA");
        progress.cycle_angle = None;
        assert_eq!(place(progress), "0.030000 s");
        progress.cycles = Some((3, Some(0.0125)));
        assert_eq!(place(progress), "3 cycles, 1.250 % change");
        progress.cycles = None;
        let bar = progress_bar("unfired");
        show_progress(&bar, progress);
        assert_eq!((bar.position(), bar.length()), (500, Some(1000)));
    }
}
