//! The arguments of analyses: types, units, limits, and their values on the way into a plan.

use super::{Extent, Start, StepControl};
use std::f64::consts::PI;

/// An argument that a kind of analysis takes, by name.
#[derive(Debug)]
pub struct Argument {
    /// `duration`.
    pub name: &'static str,
    /// What it is, a clause with its default.
    pub about: &'static str,
    /// Its type.
    pub takes: Takes,
    /// The unit in which messages show how it is written; empty for a plain number.
    pub unit: &'static str,
    /// Whether it must be stated.
    pub required: bool,
    /// What its number (SI) must keep; the first that it breaks is told.
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
}

/// What counts the angle of an extent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// The cycle: a model without one refuses an angle.
    ByCycle,
    /// The cycle, or without one the body that turns fastest.
    ByFastest,
}

/// What a number must keep.
#[derive(Debug)]
pub struct Limit {
    /// Whether a value (SI) keeps it.
    pub fits: fn(f64) -> bool,
    /// "must be …".
    pub due: &'static str,
    /// The label and the help of its message, where "this is negative" would not tell enough.
    pub told: Option<(&'static str, &'static str)>,
}

/// Two arguments that contradict each other.
#[derive(Debug)]
pub struct Apart {
    /// One with its label.
    pub first: (&'static str, &'static str),
    /// The other with its label.
    pub second: (&'static str, &'static str),
    /// The title of the message.
    pub title: &'static str,
    /// Its help.
    pub help: &'static str,
}

/// The value of an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number (SI).
    Number(f64),
    /// A time or an angle.
    Extent(Extent),
    /// True or false.
    Switch(bool),
    /// How the motion begins.
    Start(Start),
}

/// The stated arguments of an analysis: each within its limits, of the type that its row says.
#[derive(Clone, Debug, Default)]
pub struct Given(Vec<(&'static str, Value)>);

/// Why no plan is made of arguments.
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
    /// One that must be stated is absent.
    Absent(&'static str),
}

impl Given {
    /// States an argument.
    pub fn state(&mut self, name: &'static str, value: Value) {
        self.0.push((name, value));
    }

    fn find(&self, wanted: &str) -> Option<Value> {
        let stated = self.0.iter().find(|(name, _)| *name == wanted);
        stated.map(|(_, value)| *value)
    }

    /// A number (SI), where it is stated.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.find(name)? {
            Value::Number(number) => Some(number),
            _ => None,
        }
    }

    /// A time or an angle, where it is stated.
    pub fn extent(&self, name: &str) -> Option<Extent> {
        match self.find(name)? {
            Value::Extent(extent) => Some(extent),
            _ => None,
        }
    }

    /// Whether something is stated to be true.
    pub fn switch(&self, name: &str) -> bool {
        self.find(name) == Some(Value::Switch(true))
    }

    /// How the motion begins; `unstated` where the text leaves that open.
    pub fn start(&self, unstated: Start) -> Start {
        match self.find(START.name) {
            Some(Value::Start(start)) => start,
            _ => unstated,
        }
    }

    /// How steps are taken: `step` and `tolerance`.
    pub fn steps(&self) -> StepControl {
        match (self.number(STEP.name), self.number(TOLERANCE.name)) {
            (Some(step), Some(tolerance)) => StepControl::FixedTo { step, tolerance },
            (Some(step), None) => StepControl::Fixed(step),
            (None, tolerance) => StepControl::Tolerance(tolerance.unwrap_or(1.0)),
        }
    }

    /// The spectral radius at infinite frequency.
    pub fn rho(&self) -> f64 {
        self.number(RHO.name).unwrap_or(0.8)
    }
}

/// One that need not be stated.
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

/// One whose message says how the number breaks it.
pub(super) const fn limit(fits: fn(f64) -> bool, due: &'static str) -> Limit {
    Limit {
        fits,
        due,
        told: None,
    }
}

/// Of times, angles and frequencies.
pub(super) const POSITIVE: &[Limit] = &[limit(|x| x > 0.0 && x.is_finite(), "positive")];

/// Distance of samples over the cycle angle (rad) without `sample`: half a degree.
pub(super) const PLAIN_ANGLE: f64 = PI / 360.0;

pub(super) const STEP: Argument = argument(
    "step",
    Takes::Time,
    "us",
    POSITIVE,
    "a fixed step; without it the error decides",
);

pub(super) const TOLERANCE: Argument = argument(
    "tolerance",
    Takes::Number,
    "",
    &[limit(
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

pub(super) const START: Argument = argument(
    "start",
    Takes::Start,
    "",
    &[],
    "how the motion begins: `quasi_static` or `assembled`",
);

impl Start {
    /// The words that state a start.
    pub const NAMED: [(&'static str, Start); 2] = [
        ("quasi_static", Start::QuasiStatic),
        ("assembled", Start::Assembled),
    ];
}
