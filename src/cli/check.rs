//! `eng check`.

use super::arguments::{CheckArguments, Format};
use super::run::explain_error;
use super::table::Table;
use super::terminal::Terminal;
use super::{
    CheckOutcome, Engine, EngineError, MODEL_WRONG, Positions, Stop, USAGE_OR_SYSTEM, refused,
};
use crate::render;
use eng_grammar::SourceMap;

pub(super) fn check(
    arguments: &CheckArguments,
    engine: &mut dyn Engine,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let mut outcome = match engine.check(&arguments.model) {
        Ok(outcome) => outcome,
        Err(error) => return Err(refuse(&error, &SourceMap::new(), arguments.format, console)),
    };
    let mut facts = Vec::new();
    let mut positions = Vec::new();
    if !outcome.diagnostics.has_errors() {
        match engine.assemble() {
            Ok(assembled) => {
                facts = assembled.facts;
                outcome.diagnostics.extend(assembled.diagnostics);
                // what does not assemble is told, and has none
                if arguments.positions && !outcome.diagnostics.has_errors() {
                    positions = match engine.positions() {
                        Ok(positions) => positions,
                        Err(error) => {
                            let format = arguments.format;
                            return Err(refuse(&error, &outcome.sources, format, console));
                        }
                    };
                }
            }
            Err(error) => {
                return Err(refuse(&error, &outcome.sources, arguments.format, console));
            }
        }
    }
    match arguments.format {
        Format::Json => {
            let (messages, sources) = (&outcome.diagnostics, &outcome.sources);
            let text = match arguments.positions {
                true => render::json_with_positions(messages, sources, &positions),
                false => render::json(messages, sources),
            };
            write!(console.output, "{text}")?;
        }
        Format::Human => {
            human(&outcome, &facts, console)?;
            for positions in &positions {
                write!(console.output, "{}", listing(positions))?;
            }
        }
    }
    if outcome.diagnostics.has_errors() {
        Err(Stop::Code(MODEL_WRONG))
    } else {
        Ok(())
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

/// Tells why nothing could be checked, in the form that is asked for, and gives the way to stop for it.
fn refuse(
    error: &EngineError,
    sources: &SourceMap,
    format: Format,
    console: &mut Terminal<'_>,
) -> Stop {
    if format == Format::Human {
        return explain_error(error, sources, console);
    }
    let code = match error {
        EngineError::Model { .. } | EngineError::Stopped(_) => MODEL_WRONG,
        EngineError::Usage(_) | EngineError::System(_) => USAGE_OR_SYSTEM,
    };
    match write!(console.output, "{}", render::json(&refused(error), sources)) {
        Ok(()) => Stop::Code(code),
        Err(error) => Stop::Output(error),
    }
}

fn human(outcome: &CheckOutcome, facts: &[String], console: &mut Terminal<'_>) -> Result<(), Stop> {
    console
        .output
        .messages(&outcome.diagnostics, &outcome.sources)?;
    for fact in facts {
        writeln!(console.output, "{fact}")?;
    }
    if outcome.diagnostics.is_empty() {
        writeln!(console.output, "no errors, no warnings")?;
    }
    Ok(())
}
