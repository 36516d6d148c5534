//! The reasons for short steps of a run.

use super::Moment;
use eng_system::Dimension;
use eng_system::significant::short;
use eng_system::system::Origin;

/// The reason why steps are not longer.
#[derive(Clone, Debug, PartialEq)]
pub enum StepLimit {
    /// The text states the step.
    Stated,
    /// The sampling interval.
    Samples,
    /// The angle by which a body turns in a step.
    Turn,
    /// The phase by which a sine in a condition changes in a step.
    Sines,
    /// A load or a rate that jumps.
    Jump(Jump),
    /// The error of a body's motion, or of an element's state.
    Error {
        /// The body, or the element.
        origin: Box<Origin>,
        /// The state's name.
        state: Option<String>,
    },
    /// Newton's iteration: it finds no solution for longer steps.
    Unsolved {
        /// Element or body of the worst row.
        origin: Box<Origin>,
        /// The equation of the worst row.
        equation: String,
    },
}

/// The length of the steps of a run, with its reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Slow {
    /// When.
    pub moment: Moment,
    /// The last step (s).
    pub step: f64,
    /// The reason why it is not longer.
    pub limit: Box<StepLimit>,
}

impl std::fmt::Display for Slow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "steps are {} s long: {}",
            short(self.step, 3),
            self.limit
        )
    }
}

/// The quantity that jumps.
#[derive(Clone, Debug, PartialEq)]
pub enum Jumping {
    /// A force of an element (N).
    Force,
    /// A torque of an element (N m).
    Torque,
    /// The rate of a state of an element.
    Rate {
        /// The state's name.
        state: String,
        /// The dimension of the rate, whose SI unit that of the jump is.
        dimension: Dimension,
    },
}

/// A jump of a load or of the rate of a state.
#[derive(Clone, Debug, PartialEq)]
pub struct Jump {
    /// The element.
    pub origin: Box<Origin>,
    /// Size of the jump.
    pub by: f64,
    /// Its quantity.
    pub of: Jumping,
}

impl std::fmt::Display for Jump {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (what, unit) = match &self.of {
            Jumping::Force => ("force".to_owned(), "N".to_owned()),
            Jumping::Torque => ("torque".to_owned(), "N m".to_owned()),
            Jumping::Rate { state, dimension } => (
                format!("rate of the state `{state}`"),
                dimension.to_string(),
            ),
        };
        write!(
            f,
            "the {what} of {} jumps by {} {unit}",
            self.origin.path,
            short(self.by, 4),
        )
    }
}

impl std::fmt::Display for StepLimit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            StepLimit::Stated => f.write_str("the text states this step"),
            StepLimit::Samples => f.write_str("steps are not longer than the sampling interval"),
            StepLimit::Turn => f.write_str("in a longer step a body turns too far"),
            StepLimit::Sines => f.write_str("a condition has a sine that changes fast, and a longer step may miss its change of sign"),
            StepLimit::Jump(jump) => write!(f, "{jump}"),
            StepLimit::Error { origin, state } => {
                let of = state
                    .as_deref()
                    .map_or(String::new(), |state| format!("{state} of "));
                write!(f, "the error control of {of}{} needs steps this short", origin.path)
            }
            StepLimit::Unsolved { origin, equation } => {
                write!(
                    f,
                    "longer steps have no solution: {} ({equation})",
                    origin.path
                )
            }
        }
    }
}
