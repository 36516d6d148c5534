//! What the command line may say.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Eng: engines as text.
///
/// Reads a model of an engine written in the Eng language, checks its units and its topology, compiles it to machine
/// code and integrates its motion. Exit codes: 0 done, 1 the model is wrong or a run failed because of it,
/// 2 wrong usage or the system refused.
#[derive(Debug, Parser)]
#[command(name = "eng", version, about, long_about, max_term_width = 100)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Run the analyses of a model; write results, pictures and a table a journal
    ///
    /// Writes into the output folder, for each analysis: ANALYSIS.parquet (one column for each channel, named by its path, in its
    /// display unit, which the column's metadata name), ANALYSIS.motion.parquet for animations, pictures of the journals'
    /// forces and orbits and of the model's own outputs as SVG and PNG, and on request ANALYSIS.csv; for a sweep SWEEP.parquet, a
    /// row a point. An analysis that fails leaves its results up to then in ANALYSIS.failed.parquet; those of an earlier run stay.
    ///
    /// Exit codes: 0 all was done; 1 the model is wrong or an analysis failed because of it; 2 wrong usage, or the system refused.
    Run(RunArguments),
    /// Check a model without running it
    ///
    /// Reports everything that is wrong or doubtful in one go: names, units, connections, degrees of freedom.
    Check(CheckArguments),
    /// Make one HTML file of the results of a model, and files for other tools
    ///
    /// Reads what `eng run` wrote: tables, figures, an animation, stresses of flexible bodies, provenance. The file needs no
    /// other and no network.
    Report(ReportArguments),
    /// Reduce the flexible bodies of a model and print what they are: mass, modes, frequencies
    Reduce(ReduceArguments),
    /// List what result files hold: channels with unit, frame and range, samples, time, where they come from
    Results(ResultsArguments),
    /// Write a result file in the format of another tool: CSV, universal file (58), MAT
    Export(ExportArguments),
    /// Explain a message code, such as E0301, an analysis or a figure; list all codes without one
    Explain(ExplainArguments),
}

#[derive(Debug, Args)]
pub(super) struct ReduceArguments {
    /// The model's file
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct ResultsArguments {
    /// A result file, or a folder of them
    #[arg(value_name = "DIR|FILE")]
    pub path: PathBuf,
    /// List these channels only, by patterns: `main[*].force.*`
    #[arg(long, value_name = "PATTERN", value_parser = pattern)]
    pub channels: Vec<String>,
}

#[derive(Debug, Args)]
pub(super) struct ExportArguments {
    /// The result file: .parquet, or .partial.arrows of a run that was interrupted
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The format
    #[arg(long, value_enum)]
    pub to: Target,
    /// Write this file [default: ANALYSIS.csv, .uff or .mat beside the results]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write these channels only, by patterns: `main[*].force.*`
    #[arg(long, value_name = "PATTERN", value_parser = pattern)]
    pub channels: Vec<String>,
    /// Separator of the fields of CSV
    #[arg(long, value_name = "CHARACTER", default_value_t = ',')]
    pub separator: char,
    /// Decimal sign of CSV
    #[arg(long, value_name = "CHARACTER", default_value_t = '.')]
    pub decimal: char,
}

/// A format of another tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Target {
    /// A row of paths, a row of units, the numbers
    Csv,
    /// Universal file, dataset 58, ASCII, SI
    Uff58,
    /// MATLAB level 5
    Mat,
}

#[derive(Debug, Args)]
pub(super) struct ReportArguments {
    /// The model's file
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// Read the results in this folder [default: results/MODEL]
    #[arg(long, value_name = "DIR")]
    pub results: Option<PathBuf>,
    /// Write this file [default: report.html beside the results]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Report this analysis only; may be given several times [default: all that were run]
    #[arg(long, value_name = "NAME")]
    pub analysis: Vec<String>,
    /// Write the first animation as a binary glTF file, too
    #[arg(long, value_name = "FILE")]
    pub gltf: Option<PathBuf>,
    /// Write the motion and stresses of its flexible bodies as a series for ParaView into this folder, too
    #[arg(long, value_name = "DIR")]
    pub vtu: Option<PathBuf>,
    /// Write each figure as SVG and PNG into this folder, too
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,
    /// Show stresses at this crank angle or time, such as "372 deg" or "12 ms"; may be given several times [default: where each body's
    /// is largest]
    #[arg(long, value_name = "MOMENT")]
    pub stress_at: Vec<String>,
    /// Say nothing but warnings and errors
    #[arg(long, short)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct ExplainArguments {
    /// The code in the brackets of a message, or the name of an analysis or a figure
    #[arg(value_name = "CODE")]
    pub code: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct RunArguments {
    /// The model's file
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// Run this analysis only; may be given several times [default: all]
    #[arg(long, value_name = "NAME")]
    pub analysis: Vec<String>,
    /// Set a parameter: `--set "speed=5000 rpm"`; may be given several times. Holds in all analyses, over what they state
    /// themselves; not what a sweep varies
    #[arg(long, value_name = "PATH=VALUE", value_parser = setting)]
    pub set: Vec<Setting>,
    /// Scale the tolerance of the steps by this factor, over what the text states: `--tolerance 0.1`. With `--step` it says how far the equations
    /// of a step are solved
    #[arg(long, value_name = "FACTOR")]
    pub tolerance: Option<f64>,
    /// Take fixed steps of this length, over what the text states: `--step 10us`
    #[arg(long, value_name = "TIME")]
    pub step: Option<String>,
    /// Go on however long a run takes; without it a run whose rest would take more than a day is stopped after some seconds
    #[arg(long)]
    pub patient: bool,
    /// Write into this folder [default: results/MODEL, without .eng, where the command is called]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write CSV files, too: a row of paths, a row of units, then the numbers
    #[arg(long)]
    pub csv: bool,
    /// Run so many analyses at a time [default: as many as the machine has processors]
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Keep these channels only, by patterns: `main[*].force.*`; may be given several times [default: all]
    #[arg(long, value_name = "PATTERN", value_parser = pattern)]
    pub channels: Vec<String>,
    /// Keep the last part of each analysis only: `"2 rev"`, `720deg`, `50ms` [default: all of it]
    #[arg(long, value_name = "PART")]
    pub last: Option<String>,
    /// Go on where an interrupted run stopped; analyses that are complete are not run again
    #[arg(long)]
    pub resume: bool,
    /// Draw no pictures
    #[arg(long)]
    pub no_plots: bool,
    /// Say nothing but warnings and errors
    #[arg(long, short)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    /// The model's file
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// List where all markers are at the start of each analysis, as assembled
    #[arg(long)]
    pub positions: bool,
    /// Form of the messages
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
}

/// Form of messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// With the lines they speak of
    Human,
    /// One JSON document for tools
    Json,
}

/// A parameter set on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Setting {
    /// The parameter's path.
    pub path: String,
    /// Its value with unit, as written.
    pub value: String,
}

fn setting(text: &str) -> Result<Setting, String> {
    match text.split_once('=') {
        Some((path, value)) if !path.trim().is_empty() && !value.trim().is_empty() => Ok(Setting {
            path: path.trim().to_owned(),
            value: value.trim().to_owned(),
        }),
        _ => Err("give a parameter's path and its value: \"speed=5000 rpm\"".to_owned()),
    }
}

/// Patterns of channels, commas between them.
fn pattern(text: &str) -> Result<String, String> {
    match text.split(',').any(|part| part.trim().is_empty()) {
        true => Err("give a channel's path, or a pattern of several: `main[*].force.*`".to_owned()),
        false => Ok(text.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn definition_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn settings_have_path_and_value() {
        let read = setting("cylinder[2].bore = 86 mm").unwrap();
        assert_eq!(
            (read.path.as_str(), read.value.as_str()),
            ("cylinder[2].bore", "86 mm")
        );
        for text in ["speed", "=3", "speed=", ""] {
            assert!(setting(text).is_err(), "{text}");
        }
    }
}
