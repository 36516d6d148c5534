//! Analyses: their kinds as a table, and as the compiler plans them.
//!
//! A kind has a file here: a struct with its numbers, the answers of [`Kind`] that every stage asks for, and a [`KindRow`] with its
//! name, its arguments and how a plan is made of them. The checker and elaboration read the row and know no kind by name. What
//! solves a kind is a function of the runtime, which `src/analysis/run.rs` calls.

mod argument;
mod assemble;
mod linear;
mod periodic;
mod transient;

pub use argument::{Apart, Argument, Counted, Given, Limit, Takes, Unplanned, Value};
pub use assemble::Assemble;
pub use linear::Linear;
pub use periodic::Periodic;
pub use transient::Transient;

use crate::dimension::{Dimension, DisplayUnit};
use crate::place::{Location, Origin};

/// The kinds that a text can name, in the order in which messages list them.
pub const KINDS: &[KindRow] = &[transient::ROW, periodic::ROW, linear::ROW, assemble::ROW];

/// The kind with a name.
pub fn kind(name: &str) -> Option<&'static KindRow> {
    KINDS.iter().find(|row| row.name == name)
}

/// What a text can say of a kind, and how a plan is made of it.
#[derive(Debug)]
pub struct KindRow {
    /// `transient`.
    pub name: &'static str,
    /// What it gives, a clause.
    pub about: &'static str,
    /// Words of other programs for the same.
    pub also_called: &'static [&'static str],
    /// Of a kind that only a model with a cycle can have: the clause that says why.
    pub needs_cycle: Option<&'static str>,
    /// Its arguments after the model, in the order in which messages list them.
    pub arguments: &'static [Argument],
    /// Arguments that contradict each other.
    pub apart: &'static [Apart],
    /// Makes the plan.
    pub plan: fn(&Given) -> Result<AnalysisKind, Unplanned>,
}

/// What the rows of results are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rows {
    /// Samples of a motion.
    Samples,
    /// Samples of one cycle, which repeats.
    Cycle,
    /// Modes.
    Modes,
    /// One state.
    State,
}

/// What every stage asks of an analysis.
pub trait Kind {
    /// How the steps of its motion are taken; `None` where it takes none.
    fn step(&self) -> Option<StepControl> {
        None
    }

    /// How steps are taken, also where an argument leaves none to take; `None` of a kind without steps.
    fn step_mut(&mut self) -> Option<&mut StepControl> {
        None
    }

    /// How its motion begins.
    fn start(&self) -> Start {
        Start::Assembled
    }

    /// Distance of its samples, and how long it samples where the text states that; `None` of a kind without samples.
    fn sampling(&self) -> Option<(Extent, Option<Extent>)> {
        None
    }

    /// What the rows of its results are.
    fn rows(&self) -> Rows;
}

/// What an analysis does. It answers as the [`Kind`] that it is.
#[derive(Clone, Debug, PartialEq)]
pub enum AnalysisKind {
    /// Positions and velocities that satisfy every constraint.
    Assemble(Assemble),
    /// The DAE in time.
    Transient(Transient),
    /// The DAE in time until the cycle repeats.
    Periodic(Periodic),
    /// Eigenvalues about a state.
    Linear(Linear),
}

impl std::ops::Deref for AnalysisKind {
    type Target = dyn Kind;

    fn deref(&self) -> &Self::Target {
        match self {
            AnalysisKind::Assemble(kind) => kind,
            AnalysisKind::Transient(kind) => kind,
            AnalysisKind::Periodic(kind) => kind,
            AnalysisKind::Linear(kind) => kind,
        }
    }
}

impl std::ops::DerefMut for AnalysisKind {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            AnalysisKind::Assemble(kind) => kind,
            AnalysisKind::Transient(kind) => kind,
            AnalysisKind::Periodic(kind) => kind,
            AnalysisKind::Linear(kind) => kind,
        }
    }
}

/// A time or an angle of the cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Seconds.
    Time(f64),
    /// Radians of the cycle angle.
    Angle(f64),
}

/// How a transient is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepControl {
    /// Fixed step (s).
    Fixed(f64),
    /// Fixed step (s) whose equations are solved to the stated factor on the tolerances.
    FixedTo {
        /// The step (s).
        step: f64,
        /// The factor.
        tolerance: f64,
    },
    /// Error control; the number scales the physical tolerances, 1 is the default.
    Tolerance(f64),
}

impl StepControl {
    /// The step (s), where it is fixed.
    pub fn fixed(self) -> Option<f64> {
        match self {
            StepControl::Fixed(step) | StepControl::FixedTo { step, .. } => Some(step),
            StepControl::Tolerance(_) => None,
        }
    }

    /// Factor on the tolerances to which the equations of a step are solved. 1 where a fixed step states none.
    pub fn tolerance(self) -> f64 {
        match self {
            StepControl::Fixed(_) => 1.0,
            StepControl::FixedTo { tolerance, .. } | StepControl::Tolerance(tolerance) => tolerance,
        }
    }
}

/// How a motion begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Start {
    /// Quasi-static where the cycle turns at the start and there are journals or flexible bodies; else as assembled.
    Automatic,
    /// In balance with the loads of the steady motion.
    QuasiStatic,
    /// As assembled: where the text and the joints put everything.
    #[default]
    Assembled,
}

/// The value of a sweep's variable at one of its points: `s` of `analysis runup[s in …]`.
#[derive(Clone, Debug, PartialEq)]
pub struct PointValue {
    /// The variable.
    pub name: String,
    /// Its value (SI); for what is no number its place in the list.
    pub value: f64,
    /// Its dimension.
    pub dimension: Dimension,
    /// How it is shown.
    pub display: DisplayUnit,
}

/// An analysis of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// `unfired`, `runup[3]`, and places.
    pub origin: Origin,
    /// The model's name.
    pub model: String,
    /// Of an analysis with an index: where in the sweep it stands.
    pub point: Vec<PointValue>,
    /// Parameters set by the analysis (path, SI value).
    pub set: Vec<(String, f64)>,
    /// Named arguments of the analysis and where their values stand in the text.
    pub arguments: Vec<(String, Location)>,
    /// What is done.
    pub kind: AnalysisKind,
}
