//! `eng reduce`.

use super::arguments::ReduceArguments;
use super::run::{checked, explain_error};
use super::terminal::Terminal;
use super::{Engine, MODEL_WRONG, Stop};

pub(super) fn reduce(
    arguments: &ReduceArguments,
    engine: &mut dyn Engine,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let checked = checked(&arguments.model, engine, console)?;
    match engine.reduce() {
        Ok(reduced) if reduced.texts.is_empty() && reduced.diagnostics.is_empty() => {
            writeln!(
                console.output,
                "{} has no flexible body",
                arguments.model.display()
            )?;
        }
        Ok(reduced) => {
            console
                .errors
                .messages(&reduced.diagnostics, &checked.sources)?;
            for text in reduced.texts {
                write!(console.output, "{text}")?;
            }
            if reduced.diagnostics.has_errors() {
                return Err(Stop::Code(MODEL_WRONG));
            }
        }
        Err(error) => return Err(explain_error(&error, &checked.sources, console)),
    }
    Ok(())
}
