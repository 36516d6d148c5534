//! The arguments of analyses: types, units, limits, and their values on the way into a plan.

use super::{Extent, Integration, Method, Named, Names, PLAIN_RHO, Start, StepControl};
use crate::kinds;
use std::f64::consts::PI;

/// An argument that a kind of analysis takes, by name.
#[derive(Debug)]
pub struct Argument {
    /// `duration`.
    pub name: &'static str,
    /// Its meaning, as a clause with its default.
    pub about: &'static str,
    /// Its type.
    pub takes: Takes,
    /// The unit that messages use to show its form; empty for a plain number.
    pub unit: &'static str,
    /// Whether it must be stated.
    pub required: bool,
    /// The limits of its number (SI). A message reports the first limit that the number breaks.
    pub limits: &'static [Limit],
}

/// The type of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takes {
    /// A plain number.
    Number,
    /// A whole number.
    Count,
    /// A time.
    Time,
    /// An angle.
    Angle,
    /// One over a time.
    Frequency,
    /// A time or an angle.
    Extent(Counted),
    /// True or false.
    Switch,
    /// A word of [`Start::NAMED`].
    Start,
    /// A word of [`Method::NAMED`].
    Method,
    /// Names of inputs, channels or parameters.
    Names(Names),
    /// A condition on the motion, with the names of the model.
    Condition,
}

/// The motion that counts the angle of an extent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// The cycle: a model without one refuses an angle.
    ByCycle,
    /// The cycle, or the body that turns fastest in a model without a cycle.
    ByFastest,
}

/// A limit of a number.
#[derive(Debug)]
pub struct Limit {
    /// Whether a value (SI) keeps the limit.
    pub fits: fn(f64) -> bool,
    /// "must be …".
    pub due: &'static str,
    /// The label and the help of its message, if its label is not "this is negative".
    pub label_and_help: Option<(&'static str, &'static str)>,
}

/// Two arguments that contradict each other.
#[derive(Debug)]
pub struct Apart {
    /// One argument with its label.
    pub first: (&'static str, &'static str),
    /// The other argument with its label.
    pub second: (&'static str, &'static str),
    /// The title of the message.
    pub title: &'static str,
    /// Its help.
    pub help: &'static str,
}

/// The value of an argument.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number (SI).
    Number(f64),
    /// A time or an angle.
    Extent(Extent),
    /// True or false.
    Switch(bool),
    /// The kind of start.
    Start(Start),
    /// The method of integration.
    Method(Method),
    /// Names of inputs, channels or parameters.
    Names(Vec<Named>),
    /// A condition, as written. It belongs to the model, which elaboration makes.
    Condition(String),
}

/// The stated arguments of an analysis. Each is within its limits and has the type of its row.
pub type Given = kinds::Given<Value>;

/// The reason why arguments give no plan.
#[derive(Clone, Debug, PartialEq)]
pub enum Unplanned {
    /// An argument does not fit the others.
    Refused {
        /// The argument.
        argument: &'static str,
        /// The title of the message.
        title: &'static str,
        /// Its label.
        label: &'static str,
        /// Its help.
        help: &'static str,
    },
    /// A required argument is absent.
    Absent(&'static str),
}

impl Given {
    /// A number (SI), if the text states it.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.find(name)? {
            Value::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// A time or an angle, if the text states it.
    pub fn extent(&self, name: &str) -> Option<Extent> {
        match self.find(name)? {
            Value::Extent(extent) => Some(*extent),
            _ => None,
        }
    }

    /// Whether the text states `true` for an argument.
    pub fn switch(&self, name: &str) -> bool {
        self.find(name) == Some(&Value::Switch(true))
    }

    /// The settings of an integration; its start is `unstated` if the text leaves it open.
    pub fn integration(&self, unstated: Start) -> Integration {
        Integration {
            step: self.steps(),
            method: match self.find(INTEGRATOR.name) {
                Some(Value::Method(Method::Radau)) => Method::Radau,
                _ => Method::GeneralisedAlpha {
                    rho_infinity: self.number(RHO.name).unwrap_or(PLAIN_RHO),
                },
            },
            start: match self.find(START.name) {
                Some(Value::Start(start)) => *start,
                _ => unstated,
            },
        }
    }

    /// Names of inputs, channels or parameters, if the text states them.
    pub fn names(&self, name: &str) -> Option<Vec<Named>> {
        match self.find(name)? {
            Value::Names(names) => Some(names.clone()),
            _ => None,
        }
    }

    /// A condition as written, if the text states it.
    pub fn condition(&self, name: &str) -> Option<String> {
        match self.find(name)? {
            Value::Condition(text) => Some(text.clone()),
            _ => None,
        }
    }

    /// The control of steps, from `step` and `tolerance`.
    fn steps(&self) -> StepControl {
        match (self.number(STEP.name), self.number(TOLERANCE.name)) {
            (Some(step), Some(tolerance)) => StepControl::FixedTo { step, tolerance },
            (Some(step), None) => StepControl::Fixed(step),
            (None, tolerance) => StepControl::Tolerance(tolerance.unwrap_or(1.0)),
        }
    }
}

/// An argument that may be left out.
pub(super) const fn argument(
    name: &'static str,
    takes: Takes,
    unit: &'static str,
    limits: &'static [Limit],
    about: &'static str,
) -> Argument {
    Argument {
        name,
        about,
        takes,
        unit,
        required: false,
        limits,
    }
}

/// A limit whose message describes the number that breaks it.
pub(super) const fn limit(fits: fn(f64) -> bool, due: &'static str) -> Limit {
    Limit {
        fits,
        due,
        label_and_help: None,
    }
}

/// The limit of times, angles and frequencies.
pub(super) const POSITIVE: &[Limit] = &[limit(|x| x > 0.0 && x.is_finite(), "positive")];

/// Distance of samples over the cycle angle (rad) without `sample`: half a degree. A choice: it shows the
/// peaks of gas and films of an engine, and a cycle has 1440 samples.
pub(super) const PLAIN_ANGLE: f64 = PI / 360.0;

/// Number of samples in a time if the text states no `sample`. A choice: as many as a figure has pixels across.
pub(super) const PLAIN_SAMPLES: f64 = 1000.0;

/// Most samples of an analysis: it keeps all of them in memory until it ends. A choice: with a hundred
/// channels they take 8 GB.
const MOST_SAMPLES: f64 = 1e7;

/// Whether a range has more samples than memory holds. A time and an angle cannot be compared.
pub(super) fn too_many_samples(whole: Extent, sample: Extent) -> bool {
    match (whole, sample) {
        (Extent::Time(whole), Extent::Time(part)) | (Extent::Angle(whole), Extent::Angle(part)) => {
            whole / part > MOST_SAMPLES
        }
        _ => false,
    }
}

pub(super) const STEP: Argument = argument(
    "step",
    Takes::Time,
    "us",
    POSITIVE,
    "a fixed step; without it error control chooses the steps",
);

pub(super) const TOLERANCE: Argument = argument(
    "tolerance",
    Takes::Number,
    "",
    &[limit(
        // a choice: with a larger factor the error control has no effect on any model
        |x| x > 0.0 && x <= 1e6,
        "positive and at most 1e6; 1 is the default",
    )],
    "a factor on the physical tolerances, 1 by default",
);

pub(super) const RHO: Argument = argument(
    "rho",
    Takes::Number,
    "",
    &[limit(
        |x| (0.0..1.0).contains(&x),
        "from 0 to below 1; 0.8 is the default",
    )],
    "the spectral radius at infinite frequency, 0.8 by default",
);

/// The derivatives of a motion.
pub(super) const GRADIENTS: Argument = argument(
    "gradients",
    Takes::Names(Names::Parameters),
    "",
    &[],
    "the parameters by which the channels are differentiated",
);

pub(super) const START: Argument = argument(
    "start",
    Takes::Start,
    "",
    &[],
    "how the motion begins: `quasi_static` or `assembled`",
);

pub(super) const INTEGRATOR: Argument = argument(
    "integrator",
    Takes::Method,
    "",
    &[],
    "the method: `generalised_alpha`, the default, or `radau` for tight tolerances of smooth motions",
);

impl Start {
    /// The words that state a start.
    pub const NAMED: [(&'static str, Start); 2] = [
        ("quasi_static", Start::QuasiStatic),
        ("assembled", Start::Assembled),
    ];
}
