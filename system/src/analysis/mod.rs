//! Analyses: the table of their kinds, and the plans that the compiler makes.
//!
//! Each kind has a file here. It holds a struct with the numbers of the kind, an implementation of [`Kind`],
//! which every stage uses, and a [`KindRow`] with the name, the arguments and the function that makes a plan
//! of them. The checker and elaboration read the row and name no kind. A function of the runtime
//! solves the kind; `src/analysis/run.rs` calls it.

mod argument;
mod assemble;
mod equilibrium;
mod kinematic;
mod linear;
pub(crate) mod named;
mod periodic;
mod response;
mod transient;

pub use argument::{Apart, Argument, Counted, Given, Limit, Takes, Unplanned, Value};
pub use assemble::Assemble;
pub use equilibrium::Static;
pub use kinematic::Kinematic;
pub use linear::Linear;
pub use named::{Misnamed, Named, Names};
pub use periodic::Periodic;
pub use response::Response;
pub use transient::{STOP, Transient};

use crate::dimension::{Dimension, DisplayUnit};
use crate::kinds::dereferences;
use crate::place::{Location, Origin};

/// The kinds that a text can name, in the order in which messages list them.
pub const KINDS: &[KindRow] = &[
    transient::ROW,
    periodic::ROW,
    linear::ROW,
    response::ROW,
    equilibrium::ROW,
    kinematic::ROW,
    assemble::ROW,
];

/// The kind with a name.
pub fn kind(name: &str) -> Option<&'static KindRow> {
    KINDS.iter().find(|row| row.name == name)
}

/// The name and the arguments of a kind in a text, and the function that makes a plan of them.
#[derive(Debug)]
pub struct KindRow {
    /// `transient`.
    pub name: &'static str,
    /// Its result, as a clause for messages.
    pub about: &'static str,
    /// The names of this kind in other programs. A message uses them to suggest the name here.
    pub also_called: &'static [&'static str],
    /// The reason, as a clause, if only a model with a cycle can have this kind.
    pub needs_cycle: Option<&'static str>,
    /// Its arguments after the model, in the order in which messages list them.
    pub arguments: &'static [Argument],
    /// Arguments that contradict each other.
    pub apart: &'static [Apart],
    /// Makes the plan from the stated arguments.
    pub plan: fn(&Given) -> Result<AnalysisKind, Unplanned>,
}

/// The meaning of the rows of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rows {
    /// Samples of a motion.
    Samples,
    /// Samples of one cycle, which repeats.
    Cycle,
    /// Modes.
    Modes,
    /// Frequencies of a vibration.
    Frequencies,
    /// One state.
    State,
}

/// The properties of an analysis that every stage reads.
pub trait Kind {
    /// The settings of its integration, even if an argument leaves no step to take; `None` for a kind without steps.
    fn integration(&self) -> Option<&Integration> {
        None
    }

    /// The same settings, to be changed.
    fn integration_mut(&mut self) -> Option<&mut Integration> {
        None
    }

    /// The control of its steps; `None` if it takes no steps.
    fn step(&self) -> Option<StepControl> {
        self.integration().map(|settings| settings.step)
    }

    /// The start of its motion.
    fn start(&self) -> Start {
        self.integration()
            .map_or(Start::Assembled, |settings| settings.start)
    }

    /// The distance of its samples, and the sampled span if the text states it; `None` for a kind without
    /// samples.
    fn sampling(&self) -> Option<(Extent, Option<Extent>)> {
        None
    }

    /// The meaning of the rows of its results.
    fn rows(&self) -> Rows;

    /// Lists of inputs, channels or parameters that its text names, with the name of each argument.
    fn named(&self) -> Vec<(&'static str, Names, &[Named])> {
        Vec::new()
    }

    /// The parameters by which its channels are differentiated; `None` for a kind without derivatives.
    fn gradients(&self) -> Option<&[Named]> {
        None
    }

    /// The same parameters, to be changed.
    fn gradients_mut(&mut self) -> Option<&mut Vec<Named>> {
        None
    }

    /// Whether joints and drives alone decide the motion: no force moves anything, so there are no energies, no
    /// films and no summaries of loads.
    fn is_prescribed(&self) -> bool {
        false
    }
}

/// An analysis of one kind, with its numbers. It dereferences to its [`Kind`].
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
    /// Steady vibration over frequency.
    Response(Response),
    /// The equilibrium.
    Static(Static),
    /// The motion by joints and drives alone.
    Kinematic(Kinematic),
}

dereferences!(AnalysisKind to Kind: Assemble Transient Periodic Linear Response Static Kinematic);

/// A time or an angle of the cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Seconds.
    Time(f64),
    /// Radians of the cycle angle.
    Angle(f64),
}

/// The control of steps.
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
    /// The control by a fixed step (s), a factor on the tolerances, or both; `None` if neither is stated.
    pub fn stated(step: Option<f64>, tolerance: Option<f64>) -> Option<StepControl> {
        match (step, tolerance) {
            (Some(step), Some(tolerance)) => Some(StepControl::FixedTo { step, tolerance }),
            (Some(step), None) => Some(StepControl::Fixed(step)),
            (None, tolerance) => tolerance.map(StepControl::Tolerance),
        }
    }

    /// The step (s) if it is fixed.
    pub fn fixed(self) -> Option<f64> {
        match self {
            StepControl::Fixed(step) | StepControl::FixedTo { step, .. } => Some(step),
            StepControl::Tolerance(_) => None,
        }
    }

    /// Factor on the tolerances to which the equations of a step are solved. It is 1 if a fixed step states
    /// none.
    pub fn tolerance(self) -> f64 {
        match self {
            StepControl::Fixed(_) => 1.0,
            StepControl::FixedTo { tolerance, .. } | StepControl::Tolerance(tolerance) => tolerance,
        }
    }
}

/// The kind of start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Start {
    /// Quasi-static if the cycle turns at the start and the model has journals or flexible bodies; otherwise
    /// as assembled.
    Automatic,
    /// In balance with the loads of the steady motion.
    QuasiStatic,
    /// As assembled: the text and the joints decide all positions.
    #[default]
    Assembled,
}

/// The method of an integration in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Generalised-α, of second order.
    GeneralisedAlpha {
        /// Spectral radius at infinite frequency, 0…1.
        rho_infinity: f64,
    },
    /// Radau IIA with three stages, of fifth order.
    Radau,
}

impl Method {
    /// The words that state a method.
    pub const NAMED: [(&'static str, Method); 2] = [
        (
            "generalised_alpha",
            Method::GeneralisedAlpha {
                rho_infinity: PLAIN_RHO,
            },
        ),
        ("radau", Method::Radau),
    ];

    /// The spectral radius of generalised-α.
    pub fn rho_infinity(self) -> f64 {
        match self {
            Method::GeneralisedAlpha { rho_infinity } => rho_infinity,
            Method::Radau => PLAIN_RHO,
        }
    }

    /// The most samples in a step. Then at most one sample is between two evaluations of the equations: Radau IIA has stages at
    /// 0.155, 0.645 and 1 of a step.
    pub fn samples_in_step(self) -> u32 {
        match self {
            Method::GeneralisedAlpha { .. } => 1,
            Method::Radau => 2,
        }
    }
}

impl Default for Method {
    fn default() -> Method {
        Method::GeneralisedAlpha {
            rho_infinity: PLAIN_RHO,
        }
    }
}

/// Spectral radius without a statement. A choice: the multipliers' errors decay to a thousandth in thirty steps, and
/// vibrations of 25 and more steps per period lose little.
pub const PLAIN_RHO: f64 = 0.8;

/// The settings of an integration in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integration {
    /// Fixed steps or error control.
    pub step: StepControl,
    /// The method.
    pub method: Method,
    /// The kind of start.
    pub start: Start,
}

/// The value of a sweep's variable at one of its points: `s` of `analysis runup[s in …]`.
#[derive(Clone, Debug, PartialEq)]
pub struct PointValue {
    /// The variable.
    pub name: String,
    /// Its value (SI); for a value that is no number, its index in the list.
    pub value: f64,
    /// Its dimension.
    pub dimension: Dimension,
    /// The unit in which it is shown.
    pub display: DisplayUnit,
}

/// An analysis of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// Its path (`unfired`, `runup[3]`) and its places in the text.
    pub origin: Origin,
    /// The model's name.
    pub model: String,
    /// The values of the sweep's variables, for an analysis with an index.
    pub point: Vec<PointValue>,
    /// Parameters set by the analysis (path, SI value).
    pub set: Vec<(String, f64)>,
    /// Named arguments of the analysis, each with the place of its value in the text.
    pub arguments: Vec<(String, Location)>,
    /// The kind, with its numbers.
    pub kind: AnalysisKind,
}
