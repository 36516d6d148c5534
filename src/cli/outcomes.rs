//! The output of a run for each analysis that ends: messages, tables, files.

use super::arguments::RunArguments;
use super::files::{complete, draw_all, or_stop, wrote};
use super::terminal::Terminal;
use super::{Refusal, Stop};
use crate::analysis::Failed;
use crate::figures;
use crate::post::Run;
use crate::program::Program;
use crate::results::gradients_file;
use crate::run::RunOutcome;
use crate::tables::outcome_text;
use eng_grammar::{Diagnostic, Diagnostics};
use std::collections::BTreeSet;
use std::path::Path;

/// The most analyses that a line about a repeated message names. A choice: they fit in a few lines.
const MOST_NAMES: usize = 20;

/// The end of an analysis.
pub(super) type Ended = Result<RunOutcome, Failed<RunOutcome>>;

/// The output that earlier rounds of `eng watch` have made from results that still hold. It is not made again.
#[derive(Debug, Default)]
pub(super) struct Made {
    /// Names of the analyses.
    pub analyses: BTreeSet<String>,
    /// The reports, without places in the text.
    pub reports: Vec<String>,
}

/// The ends of the analyses, in the order of the text and not in the order of their ends.
pub(super) struct Outcomes<'a> {
    pub arguments: &'a RunArguments,
    pub program: &'a Program,
    /// The folder of the results.
    pub folder: &'a Path,
    pub completed: Vec<RunOutcome>,
    /// Names of the analyses that failed.
    pub failures: Vec<String>,
    /// The output of earlier rounds.
    pub made: Made,
    /// Messages so far, with the analyses that they concern. Each is printed once, although analyses of one model
    /// often fail in the same way.
    messages: Vec<(Diagnostic, Vec<String>)>,
}

impl<'a> Outcomes<'a> {
    pub fn new(
        arguments: &'a RunArguments,
        program: &'a Program,
        folder: &'a Path,
    ) -> Outcomes<'a> {
        Outcomes {
            arguments,
            program,
            folder,
            completed: Vec::new(),
            failures: Vec::new(),
            made: Made::default(),
            messages: Vec::new(),
        }
    }

    /// Whether an analysis has ended in this round.
    pub fn is_new(&self, analysis: &str) -> bool {
        !self.made.analyses.contains(analysis)
    }

    /// Adds an analysis that has ended, and prints its report.
    pub fn add(
        &mut self,
        analysis: &str,
        ended: Ended,
        console: &mut Terminal<'_>,
    ) -> Result<(), Stop> {
        let Failed { error, partial } = match ended {
            Ok(outcome) => {
                self.show(analysis, &outcome.diagnostics, console)?;
                self.written(&outcome, console)?;
                self.completed.push(outcome);
                return Ok(());
            }
            Err(failed) => failed,
        };
        let Some(report) = error.report() else {
            return Err(Refusal::from(*error).show(self.program.texts(), console));
        };
        self.show(analysis, report.diagnostics(), console)?;
        self.failures.push(analysis.to_owned());
        if error.is_stopped() {
            writeln!(
                console.errors,
                "{analysis} was stopped: `--patient` runs it to its end however long that takes, `--patient --resume` from its last checkpoint"
            )?;
            return Ok(());
        }
        let Some(mut partial) = partial else {
            writeln!(
                console.errors,
                "{analysis} failed before its first sample; results of an earlier run stay as they are"
            )?;
            return Ok(());
        };
        if partial.results.failure().is_none() {
            let reason = report.diagnostics().iter().next().map(|d| d.title.clone());
            let reason = reason.unwrap_or_else(|| "the run failed".to_owned());
            partial.results.set_failure(&reason);
        }
        self.show(analysis, &partial.diagnostics, console)?;
        writeln!(
            console.errors,
            "{analysis} failed; the results up to the failure are kept as {}, those of an earlier run stay as they are",
            partial.results.stem()
        )?;
        self.written(&partial, console)
    }

    fn show(
        &mut self,
        analysis: &str,
        diagnostics: &Diagnostics,
        console: &mut Terminal<'_>,
    ) -> Result<(), Stop> {
        let mut new = Diagnostics::new();
        for diagnostic in diagnostics.iter() {
            let mut known = self.messages.iter_mut();
            match known.find(|(known, _)| known == diagnostic) {
                Some((_, names)) if names.iter().all(|name| name != analysis) => {
                    names.push(analysis.to_owned());
                }
                Some(_) => {}
                None => {
                    let names = vec![analysis.to_owned()];
                    self.messages.push((diagnostic.clone(), names));
                    new.push(diagnostic.clone());
                }
            }
        }
        Ok(console.errors.messages(&new, self.program.texts())?)
    }

    /// A line for each message that concerns several analyses, which is printed at the first of them only.
    pub fn repeated(&self, all: usize) -> Vec<String> {
        let several = self.messages.iter().filter(|(_, names)| names.len() > 1);
        let line = |(message, names): &(Diagnostic, Vec<String>)| {
            let shown: Vec<&str> = names.iter().take(MOST_NAMES).map(String::as_str).collect();
            let more = match names.len().saturating_sub(MOST_NAMES) {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            format!(
                "{} concerns {} of {all} analyses, {}{more}: {}",
                message.code,
                names.len(),
                shown.join(", "),
                message.title
            )
        };
        several.map(line).collect()
    }

    /// Prints the table of an analysis and the names of its files, which the run itself or an earlier one has written. Writes
    /// the other requested files.
    fn written(&self, outcome: &RunOutcome, console: &mut Terminal<'_>) -> Result<(), Stop> {
        let Outcomes {
            arguments, folder, ..
        } = *self;
        let results = &outcome.results;
        if !arguments.quiet {
            write!(console.output, "{}", outcome_text(outcome))?;
        }
        let tell = |path: &Path, console: &mut Terminal<'_>| match outcome.made_before {
            true => complete(path, arguments, console),
            false => wrote(path, arguments, console),
        };
        for written in std::iter::once(results).chain(&outcome.motion) {
            let path = folder.join(format!("{}.parquet", written.stem()));
            tell(&path, console)?;
        }
        let matrices = crate::matrices::file_of(folder, results.analysis());
        if results.are_modes() && results.failure().is_none() && matrices.is_file() {
            tell(&matrices, console)?;
        }
        let gradients = gradients_file(folder, results.analysis());
        if results.are_samples() && results.failure().is_none() && gradients.is_file() {
            tell(&gradients, console)?;
        }
        if arguments.csv {
            let path = or_stop(results.write_csv(folder), console)?;
            wrote(&path, arguments, console)?;
        }
        if !arguments.no_plots {
            let failed = results.failure().is_some();
            let run = Run::new(results, &outcome.machine);
            let wanted = figures::of_outcome(outcome);
            draw_all(&wanted, &[run], failed, folder, arguments, console)?;
        }
        Ok(())
    }
}
