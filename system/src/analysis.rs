//! Analyses as the compiler plans them: what is done, and what every stage asks of its kind.

use crate::dimension::{Dimension, DisplayUnit};
use crate::place::{Location, Origin};

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

/// A transient analysis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transient {
    /// How long.
    pub duration: Extent,
    /// Distance of the samples.
    pub sample: Extent,
    /// Steps.
    pub step: StepControl,
    /// Spectral radius at infinite frequency, 0…1.
    pub rho_infinity: f64,
    /// How it begins.
    pub start: Start,
}

/// A transient that runs until the cycle repeats; its result is the last cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periodic {
    /// Distance of the samples (rad of the cycle angle), shortened so that whole ones fill a cycle.
    pub sample: f64,
    /// Steps.
    pub step: StepControl,
    /// Spectral radius at infinite frequency, 0…1.
    pub rho_infinity: f64,
    /// How it begins.
    pub start: Start,
    /// Largest change from cycle to cycle, and largest estimated distance to the limit, as a share of each channel's swing.
    pub change: f64,
    /// Most cycles.
    pub cycles: u32,
}

/// Eigenvalues and modes of the motion linearised about a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// How far a transient runs to the state; `None`: the start itself is the state.
    pub after: Option<Extent>,
    /// Steps of that transient.
    pub step: StepControl,
    /// Its spectral radius at infinite frequency, 0…1.
    pub rho_infinity: f64,
    /// How the motion begins.
    pub start: Start,
    /// Most oscillations, and most motions without oscillation, that are reported: the slowest of each.
    pub number: Option<u32>,
    /// Largest |λ| (rad/s) that is reported.
    pub up_to: Option<f64>,
    /// The period of the motion about which the modes are, where coefficients repeat; `None`: about a state.
    pub over: Option<Extent>,
    /// Whether coefficients that change while bodies turn are held at their values of the moment.
    pub frozen: bool,
}

/// What an analysis does.
#[derive(Clone, Debug, PartialEq)]
pub enum AnalysisKind {
    /// Positions and velocities that satisfy every constraint.
    Assemble,
    /// The DAE in time.
    Transient(Transient),
    /// The DAE in time until the cycle repeats.
    Periodic(Periodic),
    /// Eigenvalues about a state.
    Linear(Linear),
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

impl AnalysisKind {
    /// How steps are taken, also where `after` leaves a linear analysis none to take; `None` of a kind without steps.
    pub fn step_mut(&mut self) -> Option<&mut StepControl> {
        match self {
            AnalysisKind::Assemble => None,
            AnalysisKind::Transient(transient) => Some(&mut transient.step),
            AnalysisKind::Periodic(periodic) => Some(&mut periodic.step),
            AnalysisKind::Linear(linear) => Some(&mut linear.step),
        }
    }

    /// How the steps of its motion are taken; `None` where it takes none.
    pub fn step(&self) -> Option<StepControl> {
        match self {
            AnalysisKind::Assemble => None,
            AnalysisKind::Transient(transient) => Some(transient.step),
            AnalysisKind::Periodic(periodic) => Some(periodic.step),
            AnalysisKind::Linear(linear) => linear.after.map(|_| linear.step),
        }
    }

    /// How its motion begins.
    pub fn start(&self) -> Start {
        match self {
            AnalysisKind::Assemble => Start::Assembled,
            AnalysisKind::Transient(transient) => transient.start,
            AnalysisKind::Periodic(periodic) => periodic.start,
            AnalysisKind::Linear(linear) => linear.start,
        }
    }

    /// Distance of its samples, and how long it samples where the text states that; `None` of a kind without samples.
    pub fn sampling(&self) -> Option<(Extent, Option<Extent>)> {
        match self {
            AnalysisKind::Transient(transient) => {
                Some((transient.sample, Some(transient.duration)))
            }
            AnalysisKind::Periodic(periodic) => Some((Extent::Angle(periodic.sample), None)),
            AnalysisKind::Assemble | AnalysisKind::Linear(_) => None,
        }
    }

    /// Whether its samples are one cycle that repeats.
    pub fn repeats(&self) -> bool {
        matches!(self, AnalysisKind::Periodic(_))
    }

    /// Whether the rows of its results are modes, and not samples.
    pub fn gives_modes(&self) -> bool {
        matches!(self, AnalysisKind::Linear(_))
    }
}
