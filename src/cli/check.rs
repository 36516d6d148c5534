//! `eng check`.

use super::arguments::{CheckArguments, Format};
use super::{CheckOutcome, Console, Engine, MODEL_WRONG, Stop, run::explain_error};
use crate::render::{self, Colors};

pub(super) fn check(
    arguments: &CheckArguments,
    engine: &mut dyn Engine,
    console: &mut Console<'_>,
) -> Result<(), Stop> {
    let refused =
        |error, console: &mut Console<'_>| Err(explain_error(&error, &Default::default(), console));
    let mut outcome = match engine.check(&arguments.model) {
        Ok(outcome) => outcome,
        Err(error) => return refused(error, console),
    };
    if !outcome.diagnostics.has_errors() {
        match engine.assemble() {
            Ok(assembled) => {
                outcome.facts.extend(assembled.facts);
                for diagnostic in assembled.diagnostics.iter() {
                    outcome.diagnostics.push(diagnostic.clone());
                }
            }
            Err(error) => return refused(error, console),
        }
    }
    match arguments.format {
        Format::Json => write!(
            console.output,
            "{}",
            render::json(&outcome.diagnostics, &outcome.sources)
        )?,
        Format::Human => human(&outcome, console)?,
    }
    if outcome.diagnostics.has_errors() {
        Err(Stop::Code(MODEL_WRONG))
    } else {
        Ok(())
    }
}

fn human(outcome: &CheckOutcome, console: &mut Console<'_>) -> Result<(), Stop> {
    let colors = if console.colored_output {
        Colors::Ansi
    } else {
        Colors::None
    };
    let text = render::human(&outcome.diagnostics, &outcome.sources, colors);
    write!(console.output, "{text}")?;
    for fact in &outcome.facts {
        writeln!(console.output, "{fact}")?;
    }
    if outcome.diagnostics.is_empty() {
        writeln!(console.output, "no errors, no warnings")?;
    }
    Ok(())
}
