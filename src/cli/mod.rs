//! The `eng` command: arguments, progress, tables, exit codes.
//!
//! May contain: what a person at a terminal sees. Must not contain: compiling and solving; these come through [`Engine`].
//! Only this module and `main.rs` print.

mod arguments;
mod check;
mod engine;
mod explain;
mod export;
pub(crate) mod figures;
mod modes;
mod post;
mod reduce;
mod report;
mod results;
mod run;
pub(crate) mod summary;
pub(crate) mod sweep;
mod table;
mod terminal;

pub use engine::{
    AssemblyOutcome, CheckOutcome, Engine, EngineError, Event, JournalGeometry, PlacedMarker,
    Positions, Progress, ReductionOutcome, RunOptions, RunOutcome, Setting,
};
pub use summary::{JournalSummary, journal_table};

use crate::codes;
use arguments::{Arguments, Command};
use clap::Parser;
use eng_grammar::{Diagnostic, Diagnostics, SourceMap};
use std::ffi::OsString;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;
use terminal::Terminal;

/// Done.
pub const DONE: u8 = 0;
/// The model is wrong, or a run failed because of it.
pub const MODEL_WRONG: u8 = 1;
/// Wrong usage, or the system refused.
pub const USAGE_OR_SYSTEM: u8 = 2;

/// Runs the command on the process's own output, error and terminal.
pub fn run(arguments: impl IntoIterator<Item = OsString>, engine: &mut dyn Engine) -> ExitCode {
    let color = std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty());
    let mut console = Console {
        colored_output: color && std::io::stdout().is_terminal(),
        colored_errors: color && std::io::stderr().is_terminal(),
        live: std::io::stderr().is_terminal(),
        output: &mut std::io::stdout().lock(),
        errors: &mut std::io::stderr(),
    };
    ExitCode::from(run_on(arguments, engine, &mut console))
}

/// Where the command writes.
pub struct Console<'a> {
    /// What was asked for: tables, messages of `check`.
    pub output: &'a mut dyn Write,
    /// Messages about the run.
    pub errors: &'a mut dyn Write,
    /// Whether `output` understands escape sequences.
    pub colored_output: bool,
    /// Whether `errors` understands escape sequences.
    pub colored_errors: bool,
    /// Whether a progress bar may be drawn on the process's standard error.
    pub live: bool,
}

/// Why a command ends early.
#[derive(Debug)]
enum Stop {
    /// With this exit code; the reason was told.
    Code(u8),
    /// The reader of the output has gone.
    Output(std::io::Error),
}

impl From<std::io::Error> for Stop {
    fn from(error: std::io::Error) -> Self {
        Stop::Output(error)
    }
}

/// Runs the command on any output and returns the exit code.
pub fn run_on(
    arguments: impl IntoIterator<Item = OsString>,
    engine: &mut dyn Engine,
    console: &mut Console<'_>,
) -> u8 {
    let console = &mut Terminal::new(console);
    let words: Vec<OsString> = arguments.into_iter().collect();
    let arguments = match Arguments::try_parse_from(&words) {
        Ok(arguments) => arguments,
        Err(refusal) => return show_refusal(&refusal, wants_json(&words), console),
    };
    let done = match &arguments.command {
        Command::Run(run) => run::run(run, engine, console),
        Command::Check(check) => check::check(check, engine, console),
        Command::Reduce(reduce) => reduce::reduce(reduce, engine, console),
        Command::Results(listing) => results::results(listing, console),
        Command::Export(export) => export::export(export, console),
        Command::Report(report) => report::report(report, engine, console),
        Command::Explain(code) => explain::explain(code, console),
    };
    match done {
        Ok(()) => DONE,
        Err(Stop::Code(code)) => code,
        // `eng … | head`: nobody is left to be told
        Err(Stop::Output(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => {
            USAGE_OR_SYSTEM
        }
        Err(Stop::Output(error)) => {
            let _ = writeln!(console.errors, "error: {error}");
            USAGE_OR_SYSTEM
        }
    }
}

/// Whether messages are asked for as JSON, by words that clap refuses as a whole.
fn wants_json(words: &[OsString]) -> bool {
    let pairs = words.windows(2).any(|pair| pair == ["--format", "json"]);
    pairs || words.iter().any(|word| word == "--format=json")
}

/// Prints clap's text: help and version to the output, refusals to the errors, or as JSON to the output.
fn show_refusal(refusal: &clap::Error, as_json: bool, console: &mut Terminal<'_>) -> u8 {
    let text = refusal.render().to_string();
    let (written, code) = if !refusal.use_stderr() {
        (write!(console.output, "{text}"), DONE)
    } else if as_json {
        let text = text.trim().trim_start_matches("error: ");
        let messages = refused(&EngineError::Usage(text.to_owned()));
        let json = crate::render::json(&messages, &SourceMap::new());
        (write!(console.output, "{json}"), USAGE_OR_SYSTEM)
    } else {
        (write!(console.errors, "{text}"), USAGE_OR_SYSTEM)
    };
    match written {
        Ok(()) => code,
        Err(_) => USAGE_OR_SYSTEM,
    }
}

/// The messages of an error.
fn refused(error: &EngineError) -> Diagnostics {
    let (code, text) = match error {
        EngineError::Model { diagnostics, .. } | EngineError::Stopped(diagnostics) => {
            return diagnostics.clone();
        }
        EngineError::Usage(text) => (codes::USAGE, text),
        EngineError::System(text) => (codes::SYSTEM, text),
    };
    let mut messages = Diagnostics::new();
    messages.push(Diagnostic::error(code, text));
    messages
}
