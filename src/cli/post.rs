//! The reports of a text after its runs.

use super::files::{draw, or_stop};
use super::outcomes::Outcomes;
use super::terminal::Terminal;
use super::{Refusal, Stop};
use crate::explained::stated_at;
use crate::motion::SUFFIX;
use crate::places::without_places;
use crate::post::{self, EvaluatedReport, Outcome, Run};
use crate::report::mixed;
use crate::results::{Gradient, Results, file_stem, read_gradients};
use eng_system::report::Report;
use std::path::Path;

/// The reports that are due. A report without an analysis of this call has no new contents; a report that names no
/// analysis is printed every time. After earlier rounds a report is due if it or one of its analyses is new.
fn due<'p>(outcomes: &Outcomes<'p>) -> Vec<&'p Report> {
    let completed = &outcomes.completed;
    let ran = |name: &&str| completed.iter().any(|o| o.results.analysis() == *name);
    let due = |report: &&Report| {
        let named: Vec<&str> = report.entries.iter().flat_map(|e| e.analyses()).collect();
        let new = |name: &&str| ran(name) && outcomes.is_new(name);
        let again = || named.iter().any(new) || !outcomes.made.reports.contains(&identity(report));
        (named.is_empty() || named.iter().any(ran)) && again()
    };
    outcomes.program.reports().iter().filter(due).collect()
}

/// Equal for equal reports at any place of a text.
pub(super) fn identity(report: &Report) -> String {
    without_places(&format!("{report:?}"))
}

/// Prints the reports about the analyses of this call, together with earlier results in the folder, and
/// writes their figures. Returns true if all conditions of the reports hold and the results give all entries.
pub(super) fn reports(ended: &Outcomes<'_>, console: &mut Terminal<'_>) -> Result<bool, Stop> {
    let (arguments, program, folder) = (ended.arguments, ended.program, ended.folder);
    let outcomes = &ended.completed;
    let ran = |name: &str| outcomes.iter().any(|o| o.results.analysis() == name);
    let reports = due(ended);
    if reports.is_empty() {
        return Ok(true);
    }
    let mut earlier: Vec<Results> = Vec::new();
    for name in reports
        .iter()
        .flat_map(|r| &r.entries)
        .flat_map(|e| e.analyses())
    {
        let path = folder.join(format!("{}.parquet", file_stem(name)));
        let read = ran(name) || earlier.iter().any(|r| r.analysis() == name);
        if !read && path.is_file() {
            earlier.push(or_stop(Results::read_parquet(&path), console)?);
        }
    }
    let mut described = Vec::new();
    let mut ran_described = Vec::new();
    if !earlier.is_empty() {
        let ran = outcomes.iter().map(|o| &o.results);
        let all: Vec<&Results> = earlier.iter().chain(ran).collect();
        described = program
            .describe(&all)
            .map_err(|error| Refusal::from(error).show(program.texts(), console))?;
        ran_described = described.split_off(earlier.len().min(described.len()));
    }
    for (results, described) in earlier.iter().zip(&described) {
        if results.metadata().get("source_hash") != Some(&described.source_hash) {
            writeln!(
                console.errors,
                "warning: the results of {} are of another text of the model; run it again",
                results.analysis()
            )?;
        }
    }
    let results = || earlier.iter().chain(outcomes.iter().map(|o| &o.results));
    let mut shown: Vec<String> = Vec::new();
    for report in &reports {
        let named: Vec<&str> = report.entries.iter().flat_map(|e| e.analyses()).collect();
        let runs: Vec<_> = results()
            .zip(described.iter().chain(&ran_described))
            .filter(|(results, _)| named.contains(&results.analysis()))
            .collect();
        for message in mixed(&runs) {
            if !shown.contains(&message) {
                writeln!(console.errors, "warning: {message}")?;
                shown.push(message);
            }
        }
    }
    let (motions, gradients) = beside(&earlier, folder, console)?;
    let ran_now = outcomes.iter().map(|o| {
        let run = Run::new(&o.results, &o.machine).with_motion(o.motion.as_ref());
        run.with_gradients(&o.gradients)
    });
    let read = earlier
        .iter()
        .zip(&described)
        .zip(motions.iter().zip(&gradients));
    let read = read.map(|((results, described), (motion, gradients))| {
        let run = Run::new(results, &described.machine).with_motion(motion.as_ref());
        run.with_gradients(gradients)
    });
    let runs: Vec<Run<'_>> = ran_now.chain(read).collect();
    let mut holds = true;
    for report in &reports {
        let made = post::evaluate(report, &runs);
        holds &= !made.fails();
        if !arguments.quiet {
            write!(console.output, "{}", post::text(&made))?;
        } else if made.fails() {
            write!(console.errors, "{}", post::text(&made))?;
        }
        // `--last` leaves out samples that an entry may need
        if arguments.last.is_none() {
            for (entry, error) in made.faults() {
                holds = false;
                let place = stated_at(program.texts(), Some(entry.place));
                let (name, report) = (&entry.name, &made.name);
                writeln!(
                    console.errors,
                    "error: {place}: `{name}` of the report `{report}` is not made: {error}"
                )?;
            }
        }
        if !arguments.no_plots {
            let failed = outcomes.iter().any(|o| o.results.failure().is_some());
            draw(figures(&made), failed, folder, arguments, console)?;
        }
    }
    Ok(holds)
}

/// The motions and the gradients in the folder of earlier results. A figure or a value that needs a missing
/// file reports this.
#[allow(clippy::type_complexity)]
fn beside(
    earlier: &[Results],
    folder: &Path,
    console: &mut Terminal<'_>,
) -> Result<(Vec<Option<Results>>, Vec<Vec<Gradient>>), Stop> {
    let (mut motions, mut gradients) = (Vec::new(), Vec::new());
    for results in earlier {
        let name = format!("{}{SUFFIX}", results.analysis());
        let path = folder.join(format!("{}.parquet", file_stem(&name)));
        motions.push(match path.is_file() {
            true => Some(or_stop(Results::read_parquet(&path), console)?),
            false => None,
        });
        gradients.push(or_stop(read_gradients(folder, results), console)?);
    }
    Ok((motions, gradients))
}

/// File names (without extension) and SVG texts.
fn figures(report: &EvaluatedReport) -> Vec<(String, String)> {
    report
        .entries
        .iter()
        .filter_map(|entry| match &entry.outcome {
            Ok(Outcome::Figure(figure)) => {
                Some((format!("{}-{}", report.name, entry.name), figure.to_svg()))
            }
            _ => None,
        })
        .collect()
}
