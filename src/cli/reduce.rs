//! `eng reduce`.

use super::arguments::ReduceArguments;
use super::open::checked;
use super::terminal::Terminal;
use super::{MODEL_WRONG, Refusal, Stop};

pub(super) fn reduce(arguments: &ReduceArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let program = checked(&arguments.model, console)?;
    let (reductions, messages) = program
        .reduce()
        .map_err(|error| Refusal::from(error).show(program.texts(), console))?;
    if reductions.is_empty() && messages.is_empty() {
        writeln!(
            console.output,
            "{} has no flexible body",
            arguments.model.display()
        )?;
        return Ok(());
    }
    console.errors.messages(&messages, program.texts())?;
    let mut texts = Vec::new();
    for reduction in &reductions {
        let text = reduction.text();
        // bodies of one component have the same reduction
        if !texts.contains(&text) {
            write!(console.output, "{text}")?;
            texts.push(text);
        }
    }
    match messages.has_errors() {
        true => Err(Stop::Code(MODEL_WRONG)),
        false => Ok(()),
    }
}
