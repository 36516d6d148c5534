//! What the command needs from the compiler and the runtime.

use crate::plot::Upright;
use crate::report::Described;
use crate::results::{Recording, Results};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap};
use eng_system::system::{PointValue, StepControl};
use serde::Serialize;
use std::num::NonZeroUsize;
use std::path::Path;

/// Checks and runs models for the command line.
pub trait Engine {
    /// Reads a model and everything it uses, and checks it. An `Err` means that its file could not be read.
    fn check(&mut self, model: &Path) -> Result<CheckOutcome, EngineError>;

    /// Reduces the flexible bodies of the models that were checked last and had no errors.
    fn reduce(&mut self) -> Result<ReductionOutcome, EngineError>;

    /// What a report needs to know of the model behind each of these results of the model that was checked last; parameters are
    /// those that the results were computed with.
    fn describe(&mut self, _results: &[&Results]) -> Result<Vec<Described>, EngineError> {
        Err(EngineError::System(
            "this engine describes no models".into(),
        ))
    }

    /// Assembles the models that were checked last and had no errors, and counts their freedoms: what no text shows.
    fn assemble(&mut self) -> Result<AssemblyOutcome, EngineError>;

    /// Where the markers of the models that were checked last and had no errors are at the start of their analyses, as assembled.
    fn positions(&mut self) -> Result<Vec<Positions>, EngineError> {
        Err(EngineError::System("this engine tells no positions".into()))
    }

    /// Runs an analysis of the model that was checked last and had no errors. `progress` is called at accepted steps.
    fn run(
        &mut self,
        analysis: &str,
        settings: &[Setting],
        progress: &mut dyn FnMut(Progress),
    ) -> Result<RunOutcome, EngineError>;

    /// States what is kept of the runs that follow. `true`: the engine itself writes `ANALYSIS.parquet`.
    fn record(&mut self, _recording: &Recording) -> bool {
        false
    }

    /// States how the runs that follow are integrated, and whether one that takes days is stopped.
    fn options(&mut self, options: RunOptions);

    /// The reports of the checked text, in its order.
    fn reports(&self) -> Vec<eng_system::report::Report> {
        Vec::new()
    }

    /// Runs several analyses, up to `threads` at a time; `tell` hears of the one with an index among `analyses`. The results are those
    /// of [`Engine::run`] to the last bit, whatever the number of threads.
    fn run_many(
        &mut self,
        analyses: &[&str],
        settings: &[Setting],
        _threads: NonZeroUsize,
        tell: &mut dyn FnMut(usize, Event),
    ) {
        for (index, analysis) in analyses.iter().enumerate() {
            let result = self.run(analysis, settings, &mut |p| tell(index, Event::Progress(p)));
            tell(index, Event::Done(Box::new(result)));
        }
    }
}

/// How analyses are run, over what the text states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunOptions {
    /// Fixed steps, or another tolerance.
    pub step: Option<StepControl>,
    /// Whether a run goes on however long it takes.
    pub patient: bool,
}

/// What is heard of an analysis among several.
#[derive(Debug)]
pub enum Event {
    /// It goes on.
    Progress(Progress),
    /// It goes on slowly, and why.
    Slow(Box<Diagnostic>),
    /// It has ended.
    Done(Box<Result<RunOutcome, EngineError>>),
}

/// What a check found.
#[derive(Clone, Debug, Default)]
pub struct CheckOutcome {
    /// The texts that were read.
    pub sources: SourceMap,
    /// What was found.
    pub diagnostics: Diagnostics,
    /// Names of the analyses, in the order of the text: `unfired`, `sweep[3]`.
    pub analyses: Vec<String>,
}

/// What reducing the flexible bodies gave.
#[derive(Clone, Debug, Default)]
pub struct ReductionOutcome {
    /// What is doubtful about them; places are of the checked model's sources.
    pub diagnostics: Diagnostics,
    /// A text a body: mass, modes, frequencies.
    pub texts: Vec<String>,
}

/// What assembling the models found.
#[derive(Clone, Debug, Default)]
pub struct AssemblyOutcome {
    /// Loops that stay open, equations that repeat each other; their places are of the checked model's sources.
    pub diagnostics: Diagnostics,
    /// A line a model (`Inline4: 11 bodies …, 5 journals …`) and a line an analysis: its freedoms.
    pub facts: Vec<String>,
}

/// Where the markers of a model are, as assembled.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Positions {
    /// The analyses that begin so.
    pub analyses: Vec<String>,
    /// All markers that the text states, and the origins of the bodies.
    pub markers: Vec<PlacedMarker>,
}

/// Where a marker is.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PlacedMarker {
    /// Path of its body; `ground`.
    pub body: String,
    /// Its path: `crank.pin[2]`.
    pub marker: String,
    /// Its place in the ground's axes (m).
    pub position: [f64; 3],
}

/// A parameter set on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The parameter's path.
    pub path: String,
    /// Its value with unit, as written.
    pub value: String,
}

/// How far a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Done part, 0…1.
    pub fraction: f64,
    /// Simulated time (s).
    pub time: f64,
    /// Unwrapped cycle angle (rad), if the model has a cycle.
    pub cycle_angle: Option<f64>,
    /// Of a periodic analysis: whole cycles so far, and the largest change from the last to this one as a share of its swing.
    pub cycles: Option<(u32, Option<f64>)>,
}

/// A journal for the summary and the pictures. The columns are named by the journal's path:
/// `main[1].force.x` and `.y` (N), `main[1].eccentricity.x` and `.y` (m, pin's centre from the shell's along the shell's axes),
/// `main[1].minimum_film` (m), `main[1].power_loss` (W). What is absent is left out of table and pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct JournalGeometry {
    /// `main[1]`.
    pub path: String,
    /// Diameter (m).
    pub diameter: f64,
    /// Width (m).
    pub width: f64,
    /// Radial clearance (m).
    pub radial_clearance: f64,
}

/// What a run made.
#[derive(Clone, Debug)]
pub struct RunOutcome {
    /// All columns.
    pub results: Results,
    /// Where the bodies were in the last cycle: `ANALYSIS.motion`; absent where it is not known.
    pub motion: Option<Results>,
    /// Journals in the order of the text.
    pub journals: Vec<JournalGeometry>,
    /// The cycle's period (rad), if the model has a cycle.
    pub cycle_period: Option<f64>,
    /// Which shell axis is drawn upwards.
    pub upright: Upright,
    /// Firing dead centres: number of the cylinder, if it has one, and angle of the cycle (rad).
    pub firing: Vec<(Option<usize>, f64)>,
    /// Warnings of the run (an `advise` that did not hold) with the texts of the check.
    pub diagnostics: Diagnostics,
    /// Facts worth a line each: steps, Newton iterations, computing time.
    pub facts: Vec<String>,
    /// Where it stands in its sweep; empty for an analysis without an index.
    pub point: Vec<PointValue>,
    /// Of a periodic analysis: cycles, and whether the last repeats; absent where it failed.
    pub periodic: Option<(u32, bool)>,
}

/// Why a model was not checked or run.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The model's fault, told with its places; what was computed until then is kept.
    #[error("the run failed")]
    Model {
        /// Messages; their places are of the checked model's sources.
        diagnostics: Diagnostics,
        /// Results up to the failure.
        partial: Option<Box<RunOutcome>>,
    },
    /// At its pace a run would take days: it was stopped, and what is on disk stays, to go on from.
    #[error("the run was stopped")]
    Stopped(Diagnostics),
    /// A wrong parameter path or value on the command line.
    #[error("{0}")]
    Usage(String),
    /// The system's refusal.
    #[error("{0}")]
    System(String),
}
