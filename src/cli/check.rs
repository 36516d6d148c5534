//! `eng check`.

use super::arguments::{CheckArguments, Format};
use super::files::or_stop;
use super::open::open;
use super::terminal::Terminal;
use super::{MODEL_WRONG, Refusal, Stop};
use crate::assembled::{Positions, json_with_positions};
use crate::program::Checked;
use crate::render;
use crate::tables::Table;
use crate::timings;
use eng_grammar::{Diagnostics, SourceMap};

pub(super) fn check(arguments: &CheckArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let format = arguments.format;
    if arguments.timings && format == Format::Json {
        let refused = "--timings prints no JSON: leave out `--format json`";
        return or_stop(Err(refused), console);
    }
    let checked = open(&arguments.model)
        .map_err(|error| refuse(&error, &SourceMap::new(), format, console))?;
    tell(&checked, arguments, console)
}

/// Prints the findings about a model that was opened.
pub(super) fn tell(
    checked: &Checked,
    arguments: &CheckArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let format = arguments.format;
    let report = checked.report();
    let sources = report.texts();
    let mut messages = report.diagnostics().clone();
    let mut facts = Vec::new();
    let mut positions = Vec::new();
    let mut spent = checked.timings();
    if let Some(program) = checked.program() {
        let assembled = program
            .assemble()
            .map_err(|error| refuse(&error.into(), sources, format, console))?;
        facts = assembled.facts;
        spent = assembled.timings;
        messages.extend(assembled.diagnostics);
        // a model that does not assemble has no positions, and its messages give the reason
        if arguments.positions && !messages.has_errors() {
            positions = program
                .positions()
                .map_err(|error| refuse(&error.into(), sources, format, console))?;
        }
    }
    match format {
        Format::Json => {
            let text = match arguments.positions {
                true => json_with_positions(&messages, sources, &positions),
                false => render::json(&messages, sources),
            };
            write!(console.output, "{text}")?;
        }
        Format::Human => {
            human(&messages, sources, &facts, console)?;
            for positions in &positions {
                write!(console.output, "{}", listing(positions))?;
            }
            if arguments.timings {
                writeln!(console.output, "{}", timings::line(&spent.phases()))?;
            }
        }
    }
    match messages.has_errors() {
        true => Err(Stop::Code(MODEL_WRONG)),
        false => Ok(()),
    }
}

/// The positions of a model as a table, in mm.
fn listing(positions: &Positions) -> String {
    let mut table = Table::new(&[
        &["marker", "body", "x", "y", "z"],
        &["", "", "mm", "mm", "mm"],
    ]);
    for marker in &positions.markers {
        let [x, y, z] = marker.position.map(|x| format!("{:.4}", 1e3 * x));
        table.row(vec![marker.marker.clone(), marker.body.clone(), x, y, z]);
    }
    format!(
        "\nmarkers at the start of {}, as assembled, in the ground's axes:\n{}",
        positions.analyses.join(", "),
        table.render()
    )
}

/// Prints the reason why nothing could be checked, in the wanted format. Returns the way to stop.
fn refuse(
    refusal: &Refusal,
    sources: &SourceMap,
    format: Format,
    console: &mut Terminal<'_>,
) -> Stop {
    if format == Format::Human {
        return refusal.show(sources, console);
    }
    let text = render::json(&refusal.messages(), sources);
    match write!(console.output, "{text}") {
        Ok(()) => Stop::Code(refusal.code()),
        Err(error) => Stop::Output(error),
    }
}

fn human(
    messages: &Diagnostics,
    sources: &SourceMap,
    facts: &[String],
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    console.output.messages(messages, sources)?;
    for fact in facts {
        writeln!(console.output, "{fact}")?;
    }
    if messages.is_empty() {
        writeln!(console.output, "no errors, no warnings")?;
    }
    Ok(())
}
