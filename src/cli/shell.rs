//! `eng completions` and `eng manual`: files for shells and for `man`.

use super::arguments::{Arguments, CompletionsArguments, ManualArguments};
use super::terminal::Terminal;
use super::{Stop, USAGE_OR_SYSTEM};
use clap::CommandFactory;

/// Prints the script that completes the command's words in a shell.
pub(super) fn completions(
    arguments: &CompletionsArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    // the generator cannot report a closed pipe, so it writes into memory
    let mut script = Vec::new();
    clap_complete::generate(
        arguments.shell,
        &mut Arguments::command(),
        "eng",
        &mut script,
    );
    // the shell reads the script: not one of its characters may change
    console.output.write_all(&script)?;
    Ok(())
}

/// Writes the pages of the manual: `eng.1`, and one for each command.
pub(super) fn manual(arguments: &ManualArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let folder = &arguments.out;
    let written = std::fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(Arguments::command(), folder));
    if let Err(error) = written {
        writeln!(console.errors, "error: {}: {error}", folder.display())?;
        return Err(Stop::Code(USAGE_OR_SYSTEM));
    }
    writeln!(
        console.output,
        "wrote the pages of the manual into {}",
        folder.display()
    )?;
    Ok(())
}
