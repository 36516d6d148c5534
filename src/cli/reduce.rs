//! `eng reduce`.

use super::arguments::ReduceArguments;
use super::run::{checked, explain_error};
use super::{Console, Engine, Stop};

pub(super) fn reduce(
    arguments: &ReduceArguments,
    engine: &mut dyn Engine,
    console: &mut Console<'_>,
) -> Result<(), Stop> {
    let checked = checked(&arguments.model, engine, console)?;
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
