//! Studies: `eng run --slice`, `eng plan`, `eng status`, `eng collect`.

use super::arguments::{
    CollectArguments, PlanArguments, Points, RunCommand, Scheduler, Settings, StatusArguments,
    StudyArguments,
};
use super::files::{folder_of, or_stop, results_folder};
use super::open::checked;
use super::progress::Bars;
use super::run::{prepare, set_once, steps, threads};
use super::terminal::Terminal;
use super::{MODEL_WRONG, Refusal, Stop};
use crate::analysis::Analysis;
use crate::counted::counted;
use crate::indexed::base;
use crate::program::Program;
use crate::run::{Event, in_words};
use crate::study::{
    self, Dataset, Design, Failure, PartOutcome, Script, SliceOptions, Study, StudyError,
    points_in_words,
};
use eng_grammar::SourceMap;
use std::path::{Path, PathBuf};

/// The design of a command.
fn design(path: Option<&PathBuf>) -> Result<Option<Design>, Refusal> {
    let design = path.map(|path| Design::read(path)).transpose();
    Ok(design.map_err(StudyError::from)?)
}

/// The analysis of a study: the stated one, or the only one of the text.
fn only(program: &Program, stated: &[String]) -> Result<String, Refusal> {
    if let [name] = stated {
        return Ok(name.clone());
    }
    let mut names: Vec<String> = Vec::new();
    for name in program.analyses() {
        let base = base(name).to_owned();
        if !names.contains(&base) {
            names.push(base);
        }
    }
    match (stated.is_empty(), names.as_slice()) {
        (true, [only]) => Ok(only.clone()),
        _ => Err(Refusal::Usage(format!(
            "points belong to one analysis; name one of {} by --analysis",
            names.join(", ")
        ))),
    }
}

/// `eng run` of points.
pub(super) fn run(
    command: &RunCommand,
    program: &Program,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let (arguments, stated) = (&command.run, &command.study);
    let refused =
        |refusal: Refusal, console: &mut Terminal<'_>| refusal.show(program.texts(), console);
    let steps = or_stop(steps(&arguments.settings), console)?;
    let set = |analysis: Analysis| prepare(analysis, &arguments.settings, steps);
    let made = only(program, &arguments.analysis)
        .and_then(|name| Study::new(program, &name, design(stated.design.as_ref())?, &set));
    let study = made.map_err(|refusal| refused(refusal, console))?;
    let folder = folder_of(arguments);
    let parts = range(&study, stated).and_then(|range| {
        let dataset = study.dataset(&folder)?;
        let parts = match range {
            Some(range) => vec![range],
            None => study.failed_parts(&dataset)?,
        };
        Ok((dataset, parts))
    });
    let (dataset, parts) = parts.map_err(|refusal| refused(refusal, console))?;
    let options = SliceOptions {
        again: stated.points == Some(Points::Failed),
        patient: arguments.settings.patient,
        threads: threads(arguments),
    };
    let mut failed = false;
    if parts.is_empty() && !arguments.quiet {
        writeln!(
            console.output,
            "{}: no part has points that failed",
            study.analysis()
        )?;
    }
    for (from, to) in parts {
        let mut bars = Bars::new(
            to + 1 - from,
            arguments.quiet || !console.live,
            Some("Ctrl-C keeps the points that have ended, and the same command continues"),
        );
        let ended = study.run(
            &dataset,
            (from, to),
            options,
            &set,
            &mut |index, name, event| match event {
                Event::Progress(progress) => bars.show(index, name, *progress),
                Event::Slow(_) => {}
                Event::Done(_) => bars.end(index),
            },
        );
        let part = ended.map_err(|refusal| refused(refusal, console))?;
        failed |= !part.failures.is_empty();
        if !arguments.quiet {
            show_part(&study, &part, console)?;
        }
    }
    match failed {
        true => Err(Stop::Code(MODEL_WRONG)),
        false => Ok(()),
    }
}

/// First and last point of the part that a command names; `None` for the parts with failures.
fn range(study: &Study, stated: &StudyArguments) -> Result<Option<(usize, usize)>, Refusal> {
    let all = study.points();
    match (stated.points, stated.slice) {
        (Some(Points::Failed), _) => Ok(None),
        (Some(Points::Range(from, to)), _) => Ok(Some(study.part(from, to)?)),
        (None, Some((_, count))) if count > all => Err(Refusal::Usage(format!(
            "--slice: {} has {}, fewer than {count} slices",
            study.analysis(),
            counted(all, "point", "points")
        ))),
        (None, Some((index, count))) => Ok(Some(study.slice(index, count))),
        (None, None) => Ok(Some((1, all))),
    }
}

fn show_part(study: &Study, part: &PartOutcome, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let (from, to) = part.range;
    let all = (to + 1 - from) as usize;
    let state = match part.computed {
        0 => "were there, and are not run again".to_owned(),
        computed if computed == all => "are run".to_owned(),
        computed => format!("are there, {computed} of them run now"),
    };
    writeln!(
        console.output,
        "{}: points {from}..{to} {state}",
        study.analysis()
    )?;
    show_failures(&part.failures, console)?;
    if let Some(path) = &part.path {
        writeln!(console.output, "  wrote {}", path.display())?;
    }
    Ok(())
}

fn show_failures(failures: &[Failure], console: &mut Terminal<'_>) -> Result<(), Stop> {
    for failure in failures {
        let Failure {
            code,
            message,
            place,
            points,
        } = failure;
        let at = if place.is_empty() {
            String::new()
        } else {
            format!(" ({place})")
        };
        writeln!(
            console.output,
            "  {} failed with {code}: {}; the first: {message}{at}",
            counted(points.len(), "point", "points"),
            points_in_words(points)
        )?;
    }
    Ok(())
}

/// `eng plan`.
pub(super) fn plan(arguments: &PlanArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let settings = &arguments.settings;
    or_stop(set_once(&settings.set), console)?;
    let program = checked(&arguments.model, console)?;
    let steps = or_stop(steps(settings), console)?;
    let set = |analysis: Analysis| prepare(analysis, settings, steps);
    let points = design(arguments.design.as_ref())
        .and_then(|design| Study::count(&program, &arguments.analysis, design, &set));
    let points = points.map_err(|refusal| refusal.show(program.texts(), console))?;
    let text = |path: &Path| path.to_string_lossy().into_owned();
    let out = arguments.out.clone();
    let script = Script {
        model: text(&arguments.model),
        analysis: arguments.analysis.clone(),
        out: text(&out.unwrap_or_else(|| results_folder(&arguments.model))),
        options: options(settings, arguments.design.as_deref()),
        points,
        per_task: arguments.per_task.map(usize::from),
        threads: arguments.threads.into(),
        flexible: program.is_flexible(),
    };
    let scheduler = match arguments.to {
        Scheduler::Slurm => study::Scheduler::Slurm,
        Scheduler::Hq => study::Scheduler::HyperQueue,
        Scheduler::Parallel => study::Scheduler::Parallel,
    };
    console
        .output
        .write_all(script.text(scheduler).as_bytes())?;
    Ok(())
}

/// The words of settings and design.
fn options(settings: &Settings, design: Option<&Path>) -> Vec<String> {
    let mut words = Vec::new();
    let mut add = |name: &str, value: String| words.extend([name.to_owned(), value]);
    if let Some(design) = design {
        add("--design", design.to_string_lossy().into_owned());
    }
    for set in &settings.set {
        add("--set", format!("{}={}", set.path, set.value));
    }
    if let Some(factor) = settings.tolerance {
        add("--tolerance", factor.to_string());
    }
    if let Some(step) = &settings.step {
        add("--step", step.clone());
    }
    if settings.patient {
        words.push("--patient".to_owned());
    }
    words
}

/// The studies of a folder, or the stated one.
fn studies(
    folder: &Path,
    analysis: Option<&String>,
    console: &mut Terminal<'_>,
) -> Result<Vec<Dataset>, Stop> {
    let names = match analysis {
        Some(name) => vec![name.clone()],
        None => shown(Dataset::all(folder), console)?,
    };
    if names.is_empty() {
        let message = format!(
            "{}: no study was begun in this folder; `eng run MODEL --analysis NAME --slice 1/N` begins one",
            folder.display()
        );
        return or_stop(Err(message), console);
    }
    let opened = names.iter().map(|name| Dataset::open(folder, name));
    shown(opened.collect::<Result<Vec<_>, _>>(), console)
}

fn shown<T>(made: Result<T, StudyError>, console: &mut Terminal<'_>) -> Result<T, Stop> {
    made.map_err(|error| Refusal::from(error).show(&SourceMap::new(), console))
}

/// `eng status`.
pub(super) fn status(arguments: &StatusArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    for dataset in studies(&arguments.folder, arguments.analysis.as_ref(), console)? {
        let standing = shown(dataset.standing(), console)?;
        let failed: usize = standing.failures.iter().map(|f| f.points.len()).sum();
        writeln!(
            console.output,
            "{} of {}: {}, {} complete, {failed} failed, {} missing",
            standing.analysis,
            standing.file,
            counted(standing.points, "point", "points"),
            standing.complete,
            standing.points - standing.complete - failed
        )?;
        show_failures(&standing.failures, console)?;
        for worker in &standing.workers {
            let place = worker.place.as_ref();
            let place = place.map_or(String::new(), |(host, process)| {
                format!(" ({host}, process {process})")
            });
            let (from, to) = worker.range;
            let state = if worker.runs { "runs" } else { "was killed" };
            writeln!(
                console.output,
                "  the part {from}..{to} {state} at {} of {}{place}",
                worker.ended,
                to + 1 - from
            )?;
        }
        if !standing.missing.is_empty() {
            writeln!(
                console.output,
                "  missing: {}",
                study::in_words(&standing.missing)
            )?;
        }
        if let Some(left) = standing.left {
            let left = in_words(left.as_secs_f64());
            writeln!(console.output, "  at this pace the rest takes {left}")?;
        }
    }
    Ok(())
}

/// `eng collect`.
pub(super) fn collect(
    arguments: &CollectArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let mut failed = false;
    for dataset in studies(&arguments.folder, arguments.analysis.as_ref(), console)? {
        let collected = shown(dataset.collect(arguments.partial), console)?;
        failed |= !collected.failures.is_empty();
        show_failures(&collected.failures, console)?;
        writeln!(
            console.output,
            "  wrote {} ({})",
            collected.path.display(),
            counted(collected.points, "point", "points")
        )?;
    }
    match failed {
        true => Err(Stop::Code(MODEL_WRONG)),
        false => Ok(()),
    }
}
