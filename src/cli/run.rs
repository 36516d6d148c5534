//! `eng run`.

use super::arguments::RunArguments;
use super::summary::{JournalSummary, journal_table};
use super::{
    CheckOutcome, Console, Engine, EngineError, MODEL_WRONG, Progress, RunOutcome, Stop,
    USAGE_OR_SYSTEM, figures,
};
use crate::plot;
use crate::render::{self, Colors};
use crate::results::file_stem;
use eng_grammar::{Diagnostics, SourceMap};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::path::{Path, PathBuf};

pub(super) fn run(
    arguments: &RunArguments,
    engine: &mut dyn Engine,
    console: &mut Console<'_>,
) -> Result<(), Stop> {
    let checked = match engine.check(&arguments.model) {
        Ok(checked) => checked,
        Err(error) => return Err(explain_error(&error, &SourceMap::new(), console)),
    };
    show(&checked.diagnostics, &checked.sources, console)?;
    if checked.diagnostics.has_errors() {
        return Err(Stop::Code(MODEL_WRONG));
    }
    let analyses = chosen(arguments, &checked, console)?;
    let folder = output_folder(arguments);
    let mut outcomes = Vec::new();
    for analysis in analyses {
        let bar = progress_bar(analysis, !arguments.quiet && console.live);
        let ran = engine.run(analysis, &arguments.set, &mut |progress| {
            show_progress(&bar, progress);
        });
        bar.finish_and_clear();
        match ran {
            Ok(outcome) => {
                show(&outcome.diagnostics, &checked.sources, console)?;
                report(&outcome, arguments, &folder, console)?;
                outcomes.push(outcome);
            }
            Err(EngineError::Model {
                diagnostics,
                partial,
            }) => {
                show(&diagnostics, &checked.sources, console)?;
                if let Some(partial) = partial {
                    show(&partial.diagnostics, &checked.sources, console)?;
                    writeln!(
                        console.errors,
                        "{analysis} failed; the results up to the failure are kept"
                    )?;
                    report(&partial, arguments, &folder, console)?;
                }
                return Err(Stop::Code(MODEL_WRONG));
            }
            Err(error) => return Err(explain_error(&error, &checked.sources, console)),
        }
    }
    if !arguments.no_plots {
        draw(figures::comparisons(&outcomes), &folder, arguments, console)?;
    }
    Ok(())
}

/// The analyses to run: those asked for, or all.
fn chosen<'a>(
    arguments: &'a RunArguments,
    checked: &'a CheckOutcome,
    console: &mut Console<'_>,
) -> Result<Vec<&'a str>, Stop> {
    let known = &checked.analyses;
    let mut analyses: Vec<&str> = Vec::new();
    for asked in &arguments.analysis {
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
                arguments.model.display(),
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
    if arguments.analysis.is_empty() {
        analyses.extend(known.iter().map(String::as_str));
    }
    if analyses.is_empty() {
        writeln!(
            console.errors,
            "error: {} has no analysis; write one: analysis run = transient(…)",
            arguments.model.display()
        )?;
        return Err(Stop::Code(MODEL_WRONG));
    }
    Ok(analyses)
}

fn output_folder(arguments: &RunArguments) -> PathBuf {
    arguments.out.clone().unwrap_or_else(|| {
        let stem = arguments.model.file_stem().unwrap_or_default();
        Path::new("results").join(stem)
    })
}

/// Writes the files of one analysis, prints its table.
fn report(
    outcome: &RunOutcome,
    arguments: &RunArguments,
    folder: &Path,
    console: &mut Console<'_>,
) -> Result<(), Stop> {
    let results = &outcome.results;
    if !arguments.quiet {
        writeln!(
            console.output,
            "{} ({})",
            results.analysis(),
            results.model()
        )?;
        for fact in &outcome.facts {
            writeln!(console.output, "  {fact}")?;
        }
        let summaries: Vec<JournalSummary> = outcome
            .journals
            .iter()
            .map(|journal| JournalSummary::new(results, journal, outcome.cycle_period))
            .collect();
        write!(console.output, "{}", journal_table(&summaries))?;
    }
    let written = results.write_parquet(folder);
    let path = told(written, console)?;
    wrote(&path, arguments, console)?;
    if arguments.csv {
        let written = results.write_csv(folder);
        let path = told(written, console)?;
        wrote(&path, arguments, console)?;
    }
    if !arguments.no_plots {
        draw(figures::of_analysis(outcome), folder, arguments, console)?;
    }
    Ok(())
}

fn draw(
    figures: Vec<(String, String)>,
    folder: &Path,
    arguments: &RunArguments,
    console: &mut Console<'_>,
) -> Result<(), Stop> {
    for (name, svg) in figures {
        let written = plot::write_svg_and_png(&svg, folder, &file_stem(&name));
        for path in told(written, console)? {
            wrote(&path, arguments, console)?;
        }
    }
    Ok(())
}

fn wrote(path: &Path, arguments: &RunArguments, console: &mut Console<'_>) -> Result<(), Stop> {
    if !arguments.quiet {
        writeln!(console.output, "  wrote {}", path.display())?;
    }
    Ok(())
}

/// The value, or the error on the console.
fn told<T, E: std::fmt::Display>(
    result: Result<T, E>,
    console: &mut Console<'_>,
) -> Result<T, Stop> {
    match result {
        Ok(value) => Ok(value),
        Err(error) => {
            writeln!(console.errors, "error: {error}")?;
            Err(Stop::Code(USAGE_OR_SYSTEM))
        }
    }
}

fn show(
    diagnostics: &Diagnostics,
    sources: &SourceMap,
    console: &mut Console<'_>,
) -> Result<(), Stop> {
    let colors = if console.colored_errors {
        Colors::Ansi
    } else {
        Colors::None
    };
    write!(
        console.errors,
        "{}",
        render::human(diagnostics, sources, colors)
    )?;
    Ok(())
}

/// Tells an error and gives the way to stop for it.
pub(super) fn explain_error(
    error: &EngineError,
    sources: &SourceMap,
    console: &mut Console<'_>,
) -> Stop {
    let (told, code) = match error {
        EngineError::Model { diagnostics, .. } => {
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

fn progress_bar(analysis: &str, visible: bool) -> ProgressBar {
    let target = if visible {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
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
        let bar = progress_bar("unfired", false);
        show_progress(&bar, progress);
        assert_eq!((bar.position(), bar.length()), (500, Some(1000)));
    }
}
