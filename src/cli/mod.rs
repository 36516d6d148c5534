//! The `eng` command: arguments, progress, exit codes.
//!
//! This module contains the interface at a terminal. The library compiles, solves, and makes tables and
//! figures; it does not use this module. Only this module and `main.rs` print.

pub(crate) mod arguments;
pub(crate) mod build;
mod check;
mod explain;
mod export;
pub(crate) mod files;
mod fmt;
mod lsp;
mod new;
mod open;
mod outcomes;
mod outputs;
mod post;
pub(crate) mod progress;
mod reduce;
mod report;
pub(crate) mod results;
mod run;
mod shell;
mod study;
mod terminal;
pub(crate) mod watch;

use crate::codes;
use crate::error::Error;
use crate::study::StudyError;
use arguments::{Arguments, Command};
use clap::Parser;
use eng_grammar::{Diagnostic, Diagnostics, SourceMap};
use std::ffi::OsString;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;
use terminal::Terminal;
use watch::changes::{Changes, Looks};

/// Done.
pub const DONE: u8 = 0;
/// The model is wrong, or a run failed because of it.
pub const MODEL_WRONG: u8 = 1;
/// Wrong usage, or the operating system refused.
pub const USAGE_OR_SYSTEM: u8 = 2;

/// Runs the command on the process's own output, error and terminal.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    ExitCode::from(status(arguments))
}

/// [`run`], with the exit code as a number, for programs that carry the command inside.
pub fn status(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let color = std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty());
    let mut console = Console {
        colored_output: color && std::io::stdout().is_terminal(),
        colored_errors: color && std::io::stderr().is_terminal(),
        live: std::io::stderr().is_terminal(),
        // not locked: the language server writes from a thread of its own
        output: &mut std::io::stdout(),
        errors: &mut std::io::stderr(),
    };
    run_on(arguments, &mut console)
}

/// The output streams of the command.
pub struct Console<'a> {
    /// The requested output: tables, messages of `check`.
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

/// The reason for an early end of a command.
#[derive(Debug)]
enum Stop {
    /// An exit code; the reason has been printed.
    Code(u8),
    /// The output cannot be written, for example because its disk is full.
    Output(std::io::Error),
}

impl From<std::io::Error> for Stop {
    fn from(error: std::io::Error) -> Self {
        Stop::Output(error)
    }
}

/// Runs the command on any output and returns the exit code.
pub fn run_on(arguments: impl IntoIterator<Item = OsString>, console: &mut Console<'_>) -> u8 {
    run_with(arguments, &mut Looks::default(), console)
}

/// [`run_on`], where `eng watch` waits for these changes.
pub(crate) fn run_with(
    arguments: impl IntoIterator<Item = OsString>,
    changes: &mut dyn Changes,
    console: &mut Console<'_>,
) -> u8 {
    let console = &mut Terminal::new(console);
    let words: Vec<OsString> = arguments.into_iter().collect();
    let arguments = match Arguments::try_parse_from(&words) {
        Ok(arguments) => arguments,
        Err(refusal) => return show_refusal(&refusal, wants_json(&words), console),
    };
    let done = match &arguments.command {
        Command::Run(run) => run::run(run, console),
        Command::Watch(watch) => watch::watch(watch, changes, console),
        Command::Check(check) => check::check(check, console),
        Command::Build(build) => build::build(build, console),
        Command::Plan(plan) => study::plan(plan, console),
        Command::Status(status) => study::status(status, console),
        Command::Collect(collect) => study::collect(collect, console),
        Command::Reduce(reduce) => reduce::reduce(reduce, console),
        Command::Results(listing) => results::results(listing, console),
        Command::Export(export) => export::export(export, console),
        Command::Report(report) => report::report(report, console),
        Command::Fmt(texts) => fmt::fmt(texts, console),
        Command::Lsp { .. } => lsp::lsp(console),
        Command::New(first) => new::new(first, console),
        Command::Completions(shell) => shell::completions(shell, console),
        Command::Manual(pages) => shell::manual(pages, console),
        Command::Explain(code) => explain::explain(code, console),
    };
    match done.and_then(|()| Ok(console.output.flush()?)) {
        Ok(()) => DONE,
        Err(Stop::Code(code)) => code,
        Err(Stop::Output(error)) => {
            let _ = writeln!(console.errors, "error: {error}");
            USAGE_OR_SYSTEM
        }
    }
}

/// Whether the words request messages as JSON. clap has refused them as a whole, so this looks at the words
/// themselves.
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
        let messages = Refusal::Usage(text.to_owned()).messages();
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

/// The reason why a command cannot do its work.
#[derive(Debug)]
enum Refusal {
    /// The library's error.
    Library(Error),
    /// A wrong parameter path or value on the command line.
    Usage(String),
    /// The operating system refused.
    System(String),
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Refusal {
        Refusal::Library(error)
    }
}

impl From<StudyError> for Refusal {
    fn from(error: StudyError) -> Refusal {
        match error {
            StudyError::Model(error) => Refusal::Library(error),
            other => Refusal::Usage(other.to_string()),
        }
    }
}

impl Refusal {
    /// Messages with their places; for an error without any, the code and text of its message.
    fn located(&self) -> Result<&Diagnostics, (&'static str, String)> {
        match self {
            Refusal::Library(error) => match (error.report(), error) {
                (Some(report), _) => Ok(report.diagnostics()),
                (None, Error::Results(_) | Error::Code(_)) => {
                    Err((codes::SYSTEM, error.to_string()))
                }
                (None, _) => Err((codes::USAGE, error.to_string())),
            },
            Refusal::Usage(text) => Err((codes::USAGE, text.clone())),
            Refusal::System(text) => Err((codes::SYSTEM, text.clone())),
        }
    }

    /// Its messages.
    fn messages(&self) -> Diagnostics {
        self.located().map_or_else(
            |(code, text)| {
                let mut messages = Diagnostics::new();
                messages.push(Diagnostic::error(code, text));
                messages
            },
            Diagnostics::clone,
        )
    }

    /// The exit code.
    fn code(&self) -> u8 {
        match self.located() {
            Ok(_) => MODEL_WRONG,
            Err(_) => USAGE_OR_SYSTEM,
        }
    }

    /// Prints it among the errors and returns the exit code as a reason to stop.
    fn show(&self, sources: &SourceMap, console: &mut Terminal<'_>) -> Stop {
        let shown = match self.located() {
            Ok(messages) => console.errors.messages(messages, sources),
            Err((_, text)) => writeln!(console.errors, "error: {text}"),
        };
        match shown {
            Ok(()) => Stop::Code(self.code()),
            Err(error) => Stop::Output(error),
        }
    }
}
