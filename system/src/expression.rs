//! Expressions over recorded channels, as trees of numbers in SI.

use crate::analysis::Extent;
use crate::elementary::Elementary;

/// A named expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// The analysis of its results, or the first of them; empty for a constant.
    pub analysis: String,
    /// Its channel in the analysis: `vertical[5]`.
    pub channel: String,
    /// The signal or number.
    pub expression: Expression,
}

impl Member {
    /// Its derivative by a parameter with a path, under the name of its channel.
    #[must_use]
    pub fn derivative(&self, parameter: &str) -> Member {
        Member {
            analysis: self.analysis.clone(),
            channel: self.channel.clone(),
            expression: Expression::Gradient {
                of: Box::new(self.expression.clone()),
                parameter: parameter.to_owned(),
            },
        }
    }
}

/// A signal (a number at each sample of an analysis), a number or a truth value.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    /// A number.
    Number(f64),
    /// A recorded channel.
    Channel {
        /// The analysis.
        analysis: String,
        /// The column.
        path: String,
    },
    /// A function of each sample.
    Map(Function, Box<Expression>),
    /// An operator, sample by sample; sides of two runs must have the same samples.
    Binary(Operator, Box<Expression>, Box<Expression>),
    /// The last part of a signal.
    Last(Part, Box<Expression>),
    /// A band of a signal, without phase.
    Filter(Filter, Box<Expression>),
    /// The first signal at the samples of the second.
    Resample(Box<Expression>, Box<Expression>),
    /// A number of a signal.
    Reduce(Reduction, Box<Expression>),
    /// Amplitude (zero to peak) of a sinusoid in a signal, with its order or its frequency (Hz).
    Amplitude(Limit, Window, Box<Expression>),
    /// The value in a column of a linear analysis for one of its modes.
    Mode(Chosen, Box<Expression>),
    /// The value of a column of a response at a frequency (Hz).
    AtFrequency(f64, Box<Expression>),
    /// 20·log₁₀ of a number or of each sample over a reference.
    Decibel(f64, Box<Expression>),
    /// One number from several: the sum, the smallest or the largest.
    Fold(Operator, Vec<Expression>),
    /// The negation of a truth value.
    Not(Box<Expression>),
    /// The derivative of a number or of each sample by a parameter of the models.
    Gradient {
        /// The number or signal.
        of: Box<Expression>,
        /// Path of the parameter.
        parameter: String,
    },
    /// The value (SI) of a parameter of an analysis; its run is differentiated by this parameter.
    Parameter {
        /// The analysis.
        analysis: String,
        /// Path of the parameter.
        path: String,
    },
}

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Function {
    Abs,
    Sqrt,
    Elementary(Elementary),
    Negate,
}

/// An operator between two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Minimum,
    Maximum,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    And,
    Or,
}

/// The last part of a signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// A time or an angle before the end.
    Extent(Extent),
    /// Whole cycles; angles count from the beginning of the first one.
    Cycles(u32),
}

/// A frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Hz.
    Frequency(f64),
    /// Cycles per revolution.
    Order(f64),
}

/// A mode of a linear analysis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Chosen {
    /// By its number, counted from 1.
    Number(u32),
    /// The oscillation whose frequency (Hz) is nearest.
    Near(f64),
}

/// The band of a filter. A signal of whole cycles is filtered as one that repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Lower limit; absent for a low-pass.
    pub from: Option<Limit>,
    /// Upper limit; absent for a high-pass.
    pub to: Option<Limit>,
    /// Order of a Butterworth filter that runs forward and backward; absent for a brick wall.
    pub butterworth: Option<u32>,
}

/// A number of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Reduction {
    Minimum,
    Maximum,
    Mean,
    RootMeanSquare,
    PeakToPeak,
    /// The cycle angle of the minimum; its time if `true`.
    MinimumAt(bool),
    /// The cycle angle of the maximum; its time if `true`.
    MaximumAt(bool),
}

impl Reduction {
    /// The name of its function.
    pub const fn name(self) -> &'static str {
        match self {
            Reduction::Minimum => "minimum",
            Reduction::Maximum => "maximum",
            Reduction::Mean => "mean",
            Reduction::RootMeanSquare => "rms",
            Reduction::PeakToPeak => "peak_to_peak",
            Reduction::MinimumAt(_) => "minimum_at",
            Reduction::MaximumAt(_) => "maximum_at",
        }
    }
}

/// The weight of a block of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Window {
    Rectangular,
    Hann,
    FlatTop,
    BlackmanHarris,
}

/// The words of [`Window`].
pub const WINDOWS: [(&str, Window); 4] = [
    ("rectangular", Window::Rectangular),
    ("hann", Window::Hann),
    ("flat_top", Window::FlatTop),
    ("blackman_harris", Window::BlackmanHarris),
];
impl Expression {
    /// The expressions inside this one.
    pub fn parts(&self) -> Vec<&Expression> {
        match self {
            Expression::Number(_) | Expression::Channel { .. } | Expression::Parameter { .. } => {
                Vec::new()
            }
            Expression::Map(_, of)
            | Expression::Last(_, of)
            | Expression::Filter(_, of)
            | Expression::Reduce(_, of)
            | Expression::Amplitude(_, _, of)
            | Expression::Mode(_, of)
            | Expression::AtFrequency(_, of)
            | Expression::Decibel(_, of)
            | Expression::Not(of)
            | Expression::Gradient { of, .. } => vec![of],
            Expression::Binary(_, left, right) | Expression::Resample(left, right) => {
                vec![left, right]
            }
            Expression::Fold(_, members) => members.iter().collect(),
        }
    }

    /// Calls `found` with analysis and path of every channel in the expression.
    pub fn channels<'e>(&'e self, found: &mut dyn FnMut(&'e str, &'e str)) {
        if let Expression::Channel { analysis, path } = self {
            found(analysis, path);
        }
        for part in self.parts() {
            part.channels(found);
        }
    }
}
