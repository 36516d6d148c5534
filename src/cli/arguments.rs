//! The arguments of the command line.

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Eng: engines as text.
///
/// Reads a model of an engine written in the Eng language, checks its units and its topology, compiles it to
/// machine code and integrates its motion. Exit codes: 0 done, 1 the model is wrong or a run failed because
/// of it, 2 wrong usage or the operating system refused.
#[derive(Debug, Parser)]
#[command(name = "eng", version, about, long_about, max_term_width = 100)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Run the analyses of a model; write results, pictures and one table for each journal
    ///
    /// Writes into the output folder, for each analysis: ANALYSIS.parquet (one column for each channel, named
    /// by its path, in its display unit, which the column's metadata name), ANALYSIS.motion.parquet for
    /// animations, pictures of the journals' forces and orbits and of the model's own outputs as SVG and PNG,
    /// and on request ANALYSIS.csv; for a sweep SWEEP.parquet with one row for each point. An analysis that
    /// fails leaves its results up to the failure in ANALYSIS.failed.parquet; the results of an earlier run
    /// remain.
    ///
    /// Exit codes: 0 all was done; 1 the model is wrong or an analysis failed because of it; 2 wrong usage,
    /// or the operating system refused.
    Run(RunCommand),
    /// Check a model at each save, and run again the analyses that the change touches
    ///
    /// Begins as `eng run`, then waits until the model's file changes, or a file that it uses: another text, a table, a mesh. A
    /// change is checked. Analyses whose numbers it cannot change are kept, and the others are run again. A save during a run stops
    /// the run. Messages do not end the command; Ctrl-C ends it. Each round ends with a line of its own, also with `--quiet`.
    Watch(WatchArguments),
    /// Check a model without running it
    ///
    /// Reports all mistakes and doubts at once: names, units, connections, degrees of freedom.
    Check(CheckArguments),
    /// Make one HTML file of the results of a model, and files for other tools
    ///
    /// Reads the results of `eng run`. The file has tables, figures, an animation, stresses of flexible
    /// bodies and the provenance. It needs no other file and no network.
    Report(ReportArguments),
    /// Build an FMU of a model for other simulation tools, or the library for C
    ///
    /// An FMU (FMI 2.0 or 3.0, co-simulation) has the model with all that it uses, and the library of Eng. The other tool sets
    /// parameters and inputs, takes steps and reads outputs: see `docs/fmi.md`. The library for C is `libeng` with `eng.h`.
    Build(BuildArguments),
    /// Write the script that computes the points of a study on a cluster
    ///
    /// The points are those of an analysis with an index, or of a table (`--design`). The script is printed: it
    /// submits an array of tasks, each with a slice of the points, and collects them at the end. See `docs/sweeps.md`.
    Plan(PlanArguments),
    /// Show how far the points of a study are: complete, failed, running, missing
    ///
    /// Reads the files of the folder alone, so it works while tasks run, on any machine that sees the folder.
    Status(StatusArguments),
    /// Write all points of a study into one table, ANALYSIS.points.parquet
    ///
    /// A row is a point: its parameters, its numbers, how it ended. Points that failed are rows without numbers.
    ///
    /// Exit codes: 0 all points are complete; 1 some have failed; 2 points are missing, or parts do not belong to
    /// each other.
    Collect(CollectArguments),
    /// Reduce the flexible bodies of a model and print their mass, modes and frequencies
    Reduce(ReduceArguments),
    /// List the contents of result files: channels with unit, frame and range, samples, time, origin
    Results(ResultsArguments),
    /// Write a result file in the format of another tool: CSV, universal file (58), MAT
    Export(ExportArguments),
    /// Give texts the one form: spaces, indents, line ends
    ///
    /// Rewrites the files that differ from it and names them. Tokens, comments, numbers and line ends inside of an
    /// item stay as written. A text that cannot be read is left as it is, and its messages are shown.
    ///
    /// Exit codes: 0 all have the form; 1 with `--check` a text differs, or a text has mistakes; 2 wrong usage, or
    /// the operating system refused.
    Fmt(FmtArguments),
    /// Serve an editor: messages while typing, completion, definitions
    ///
    /// Speaks the Language Server Protocol on the standard input and output. An editor starts it; see
    /// `docs/editor.md`.
    Lsp {
        /// Use the standard input and output, as always: many editors add this word
        #[arg(long = "stdio")]
        _stdio: bool,
    },
    /// Write a first model into a new file: it checks, runs and has a report
    New(NewArguments),
    /// Print the script that completes the words of this command in a shell
    Completions(CompletionsArguments),
    /// Write the pages of the manual, for `man`
    Manual(ManualArguments),
    /// Explain a message code, such as E0301, an analysis or a figure, or a part of a model; list all codes without one
    Explain(ExplainArguments),
}

#[derive(Debug, Args)]
pub(super) struct FmtArguments {
    /// Files, folders with `.eng` files, or `-` for the standard input, whose form goes to the output
    #[arg(value_name = "PATH", required = true)]
    pub paths: Vec<PathBuf>,
    /// Change nothing; name the texts that differ from their form
    #[arg(long)]
    pub check: bool,
}

#[derive(Debug, Args)]
pub(super) struct NewArguments {
    /// Name of the file, with or without `.eng`; a file that exists is not replaced
    #[arg(value_name = "NAME")]
    pub name: PathBuf,
    /// The kind of model
    #[arg(long, value_enum, default_value_t = Template::Engine)]
    pub from: Template,
}

/// A model to begin with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Template {
    /// One cylinder: crank on two oil films, rod, piston, gas
    Engine,
    /// One cylinder with valves and the state of its gas
    Compressor,
    /// One body on one joint
    Pendulum,
}

#[derive(Debug, Args)]
pub(super) struct CompletionsArguments {
    /// The shell
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: Shell,
}

#[derive(Debug, Args)]
pub(super) struct ManualArguments {
    /// Write into this folder
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct BuildArguments {
    /// The model's file; the library for C needs none
    #[arg(value_name = "MODEL")]
    pub model: Option<PathBuf>,
    /// The thing to build
    #[arg(long, value_enum)]
    pub to: BuildTarget,
    /// Version of the standard
    #[arg(long, value_enum, default_value_t = FmiVersion::Three)]
    pub fmi: FmiVersion,
    /// Name of the model in the file [default: the only one]
    #[arg(long = "model", value_name = "NAME")]
    pub name: Option<String>,
    /// Take the model of this analysis, with its parameters, steps and start
    #[arg(long, value_name = "NAME", conflicts_with = "name")]
    pub analysis: Option<String>,
    /// Inputs that the other tool sets, by patterns [default: all that no function of time drives]
    #[arg(long, value_name = "PATTERN", value_parser = pattern)]
    pub inputs: Vec<String>,
    /// Channels that the other tool reads, by patterns: `speed,main[*].force.*` [default: the model's outputs]
    #[arg(long, value_name = "PATTERN", value_parser = pattern)]
    pub outputs: Vec<String>,
    /// Parameters that the other tool sets before the start, by patterns [default: all that the text does not compute
    /// from others]
    #[arg(long, value_name = "PATTERN", value_parser = pattern)]
    pub parameters: Vec<String>,
    /// Write this file [default: NAME.fmu]; the library and its header go into this folder [default: the current one]
    #[arg(long, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// The library of Eng [default: beside the command, or as ENG_LIBRARY names it]
    #[arg(long, value_name = "FILE")]
    pub library: Option<PathBuf>,
}

/// A thing that `eng build` makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum BuildTarget {
    /// A functional mock-up unit for co-simulation
    Fmu,
    /// The library and the header for C
    Library,
}

/// A version of the standard for FMUs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FmiVersion {
    /// FMI 2.0
    #[value(name = "2")]
    Two,
    /// FMI 3.0
    #[value(name = "3")]
    Three,
}

#[derive(Debug, Args)]
pub(super) struct ReduceArguments {
    /// The model's file
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// Write the reduced bodies for another code
    #[arg(long, value_enum, value_name = "FORMAT", requires = "out")]
    pub to: Option<BodyTarget>,
    /// Write into this folder
    #[arg(long, value_name = "DIR", requires = "to")]
    pub out: Option<PathBuf>,
    /// Compare the modes with mode shapes of another code on the same mesh: OP2, punch file, .frd, universal file
    #[arg(long, value_name = "FILE")]
    pub compare: Option<PathBuf>,
    /// Write and compare only this body; may be given several times [default: all]
    #[arg(long, value_name = "PATH")]
    pub body: Vec<String>,
    /// Number of the first point in Nastran and Abaqus; the points of further bodies follow [default: 1]
    #[arg(
        long,
        value_name = "NUMBER",
        requires = "to",
        allow_negative_numbers = true
    )]
    pub first_point: Option<usize>,
}

/// A form of reduced bodies for another code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum BodyTarget {
    /// Arrays of NumPy: matrices, constants of the floating frame, shapes at all nodes
    Numpy,
    /// Nastran's OP4 as text: matrices of small motions
    Op4,
    /// Nastran's bulk data: scalar points with DMIG, markers by MPC
    Dmig,
    /// Abaqus: *MATRIX INPUT with a deck, markers by *EQUATION
    Abaqus,
    /// MBDyn: the data of its modal joint, with all constants of the floating frame
    Mbdyn,
}

#[derive(Debug, Args)]
pub(super) struct ResultsArguments {
    /// A result file, or a folder of them
    #[arg(value_name = "DIR|FILE")]
    pub path: PathBuf,
    /// List only these channels, by patterns: `main[*].force.*`
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
    /// Write only these channels, by patterns: `main[*].force.*`
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
    /// Report only this analysis; may be given several times [default: all with results]
    #[arg(long, value_name = "NAME")]
    pub analysis: Vec<String>,
    /// Write the first animation as a binary glTF file, too
    #[arg(long, value_name = "FILE")]
    pub gltf: Option<PathBuf>,
    /// Write the motion and stresses of the first analysis' flexible bodies into this folder, too, as a
    /// series for ParaView
    #[arg(long, value_name = "DIR")]
    pub vtu: Option<PathBuf>,
    /// Write pressure, gap and content in the cells of each analysis' oil films into this folder, too
    #[arg(long, value_name = "DIR")]
    pub fields: Option<PathBuf>,
    /// Write each figure as SVG and PNG into this folder, too
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,
    /// Show stresses at this crank angle or time, such as "372 deg" or "12 ms"; may be given several times
    /// [default: the moment of each body's largest stress]
    #[arg(long, value_name = "MOMENT", allow_hyphen_values = true)]
    pub stress_at: Vec<String>,
    /// Print only warnings and errors
    #[arg(long, short)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct ExplainArguments {
    /// The code in the brackets of a message, the name of an analysis or a figure, or the file of a model
    #[arg(value_name = "CODE|MODEL")]
    pub code: Option<String>,
    /// With a model: the path of an element, body, marker, parameter or output; without it all elements are listed
    #[arg(value_name = "PATH")]
    pub path: Option<String>,
}

/// The options of `eng run` that points of a dataset do not have.
const WHOLE_RUNS: [&str; 6] = ["csv", "channels", "gradients", "last", "resume", "timings"];

/// The options of `eng watch` that a check does not have.
const RUNS: [&str; 15] = [
    "analysis",
    "set",
    "tolerance",
    "step",
    "patient",
    "out",
    "csv",
    "threads",
    "channels",
    "gradients",
    "last",
    "resume",
    "no_plots",
    "timings",
    "quiet",
];

/// Settings of the command line in place of those of the text.
#[derive(Clone, Debug, Args)]
pub(super) struct Settings {
    /// Set a parameter: `--set "speed=5000 rpm"`; may be given several times. The value counts in all
    /// analyses and replaces values that they state; a parameter that a sweep varies cannot be set
    #[arg(long, value_name = "PATH=VALUE", value_parser = setting)]
    pub set: Vec<Setting>,
    /// Factor on the tolerance of the steps, instead of the stated one: `--tolerance 0.1`. With `--step` it
    /// is the tolerance of the equations of a step
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
    /// Take fixed steps of this length instead of the stated ones: `--step 10us`
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub step: Option<String>,
    /// Continue for any time; without this a run with more than a day left is stopped after some seconds
    #[arg(long)]
    pub patient: bool,
}

/// Points of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Points {
    /// From the first to the last, counted from 1.
    Range(usize, usize),
    /// Those that failed or were stopped.
    Failed,
}

#[derive(Debug, Args)]
pub(super) struct PlanArguments {
    /// The model's file
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// The analysis; it needs an index, or a design
    #[arg(long, value_name = "NAME")]
    pub analysis: String,
    /// The scheduler that runs the script's tasks
    #[arg(long, visible_alias = "for", value_enum)]
    pub to: Scheduler,
    /// Points from this table: see `eng run`
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Points of a task [default: as many as make at most 150 tasks]
    #[arg(long, value_name = "N", value_parser = count, allow_negative_numbers = true)]
    pub per_task: Option<NonZeroUsize>,
    /// Points that a task runs at the same time; the scheduler gives it so many processors
    #[arg(long, value_name = "N", default_value_t = NonZeroUsize::MIN, value_parser = count, allow_negative_numbers = true)]
    pub threads: NonZeroUsize,
    #[command(flatten)]
    pub settings: Settings,
    /// Folder of the results [default: results/MODEL, without .eng, in the current folder]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// A scheduler of tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Scheduler {
    /// Job arrays of Slurm
    Slurm,
    /// HyperQueue
    Hq,
    /// GNU parallel
    Parallel,
}

#[derive(Debug, Args)]
pub(super) struct StatusArguments {
    /// Folder of the results
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Only this analysis [default: all with points in the folder]
    #[arg(long, value_name = "NAME")]
    pub analysis: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct CollectArguments {
    /// Folder of the results
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Only this analysis [default: all with points in the folder]
    #[arg(long, value_name = "NAME")]
    pub analysis: Option<String>,
    /// Write the points that are there, also if others are missing
    #[arg(long)]
    pub partial: bool,
}

#[derive(Debug, Args)]
pub(super) struct RunCommand {
    #[command(flatten)]
    pub run: RunArguments,
    #[command(flatten)]
    pub study: StudyArguments,
}

// The points of a study that a run computes, in place of whole analyses. (A doc comment would be the help of the command.)
#[derive(Debug, Args)]
pub(super) struct StudyArguments {
    /// Points from this table, a row each: a column for each parameter, whose name is its path and unit, such as
    /// `main[5].radial_clearance [um]`. The file is CSV or Parquet
    #[arg(long, value_name = "FILE", conflicts_with_all = WHOLE_RUNS)]
    pub design: Option<PathBuf>,
    /// Run only these points, and write them as one part of a dataset: `1..64`, or `failed` for the points that
    /// failed or were stopped. Points that are there are not run again
    #[arg(long, value_name = "A..B|failed", value_parser = points, conflicts_with_all = WHOLE_RUNS)]
    pub points: Option<Points>,
    /// Run one of several equal slices of the points: `3/157`
    #[arg(long, value_name = "I/N", value_parser = slice, conflicts_with_all = WHOLE_RUNS, conflicts_with = "points")]
    pub slice: Option<(usize, usize)>,
}

impl StudyArguments {
    /// Whether any of them is stated.
    pub fn are_stated(&self) -> bool {
        self.design.is_some() || self.points.is_some() || self.slice.is_some()
    }
}

#[derive(Debug, Args)]
pub(super) struct WatchArguments {
    /// Check only, and run nothing
    #[arg(long, conflicts_with_all = RUNS)]
    pub check: bool,
    #[command(flatten)]
    pub run: RunArguments,
}

// Whole analyses and their output.
#[derive(Debug, Args)]
pub(super) struct RunArguments {
    /// The model's file
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// Run only this analysis; may be given several times [default: all]
    #[arg(long, value_name = "NAME")]
    pub analysis: Vec<String>,
    #[command(flatten)]
    pub settings: Settings,
    /// Write into this folder [default: results/MODEL, without .eng, in the current folder]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write CSV files, too: a row of paths, a row of units, then the numbers
    #[arg(long)]
    pub csv: bool,
    /// Number of threads: so many analyses run at the same time, and fewer analyses solve their films
    /// on cells side by side [default: the machine's processors]
    #[arg(long, value_name = "N", value_parser = count, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,
    /// Keep only these channels, by patterns: `main[*].force.*`; may be given several times [default: all]
    #[arg(long, value_name = "PATTERN", value_parser = pattern)]
    pub channels: Vec<String>,
    /// Differentiate the channels by these parameters: `main[*].radial_clearance`; may be given several times
    /// [default: those of the text]
    #[arg(long, value_name = "PATH")]
    pub gradients: Vec<String>,
    /// Keep only the last part of each analysis: `"2 rev"`, `720deg`, `50ms` [default: the whole]
    #[arg(long, value_name = "PART", allow_hyphen_values = true)]
    pub last: Option<String>,
    /// Continue interrupted runs; complete analyses are not run again
    #[arg(long)]
    pub resume: bool,
    /// Draw no pictures
    #[arg(long)]
    pub no_plots: bool,
    /// Print the processor time of each phase: check, reductions and machine code, start, steps, samples, files,
    /// pictures. Films that other threads solve do not count; `--threads 1` counts all
    #[arg(long)]
    pub timings: bool,
    /// Print only warnings and errors
    #[arg(long, short)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    /// The model's file
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// List the positions of all markers at the start of each analysis, as assembled
    #[arg(long)]
    pub positions: bool,
    /// Print the processor time of each phase: reading, types, elaboration, machine code, assembly, turn
    /// without forces, lints
    #[arg(long)]
    pub timings: bool,
    /// Form of the messages
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
}

/// Form of messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// With the lines of the text
    Human,
    /// One JSON document for tools
    Json,
}

/// A parameter set on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The parameter's path.
    pub path: String,
    /// The text of its value with unit.
    pub value: String,
}

/// A parameter and its value: `speed=5000 rpm`.
pub fn setting(text: &str) -> Result<Setting, String> {
    match text.split_once('=') {
        Some((path, value)) if !path.trim().is_empty() && !value.trim().is_empty() => Ok(Setting {
            path: path.trim().to_owned(),
            value: value.trim().to_owned(),
        }),
        _ => Err("give a parameter's path and its value: \"speed=5000 rpm\"".to_owned()),
    }
}

/// `1..64`, `7` or `failed`.
fn points(text: &str) -> Result<Points, String> {
    let text = text.trim();
    if text == "failed" {
        return Ok(Points::Failed);
    }
    let (from, to) = text.split_once("..").unwrap_or((text, text));
    match (from.trim().parse(), to.trim().parse()) {
        (Ok(from), Ok(to)) if from >= 1 && to >= from => Ok(Points::Range(from, to)),
        _ => Err(
            "give the first and the last point, counted from 1: `1..64`; or `failed`".to_owned(),
        ),
    }
}

/// A number of things.
fn count(text: &str) -> Result<NonZeroUsize, String> {
    let read = text.trim().parse::<NonZeroUsize>();
    read.map_err(|_| "give a whole number from 1".to_owned())
}

/// `3/157`.
fn slice(text: &str) -> Result<(usize, usize), String> {
    let found = text.split_once('/').and_then(|(index, count)| {
        let (index, count) = (index.trim().parse().ok()?, count.trim().parse().ok()?);
        (index >= 1 && index <= count).then_some((index, count))
    });
    found.ok_or_else(|| "give the number of the slice and of all slices: `3/157`".to_owned())
}

/// Patterns of channels, separated by commas.
fn pattern(text: &str) -> Result<String, String> {
    match text.split(',').any(|part| part.trim().is_empty()) {
        true => Err("give a channel's path, or a pattern of several: `main[*].force.*`".to_owned()),
        false => Ok(text.to_owned()),
    }
}
