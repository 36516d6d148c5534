//! `eng reduce`.

use super::arguments::ReduceArguments;
use super::{Console, Engine, MODEL_WRONG, Stop, run::explain_error};
use crate::render::{self, Colors};

pub(super) fn reduce(
    arguments: &ReduceArguments,
    engine: &mut dyn Engine,
    console: &mut Console<'_>,
) -> Result<(), Stop> {
    let checked = match engine.check(&arguments.model) {
        Ok(outcome) => outcome,
        Err(error) => return Err(explain_error(&error, &Default::default(), console)),
    };
    if !checked.diagnostics.is_empty() {
        let colors = if console.colored_errors {
            Colors::Ansi
        } else {
            Colors::None
        };
        let text = render::human(&checked.diagnostics, &checked.sources, colors);
        write!(console.errors, "{text}")?;
    }
    if checked.diagnostics.has_errors() {
        return Err(Stop::Code(MODEL_WRONG));
    }
    match engine.reduce() {
        Ok(texts) if texts.is_empty() => {
            writeln!(
                console.output,
                "{} has no flexible body",
                arguments.model.display()
            )?;
        }
        Ok(texts) => {
            for text in texts {
                write!(console.output, "{text}")?;
            }
        }
        Err(error) => return Err(explain_error(&error, &checked.sources, console)),
    }
    Ok(())
}
