//! What a report makes of results: figures and values as trees over recorded channels.
//!
//! Contains no names to be looked up and no units to be converted: numbers are SI, dimensions fit, lists are written out.

use crate::DisplayUnit;
use crate::analysis::Extent;
use crate::place::Location;

/// `report name "title" { … }`.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Its name.
    pub name: String,
    /// What the section is called.
    pub title: String,
    /// `///` lines before it.
    pub text: String,
    /// Its place.
    pub place: Location,
    /// Figures, values and requirements in the order of the text.
    pub entries: Vec<Entry>,
}

/// A figure, a value or a requirement.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its name; of a requirement `require`.
    pub name: String,
    /// What it is called.
    pub title: String,
    /// `///` lines before it.
    pub text: String,
    /// As written, after `=`.
    pub written: String,
    /// Its place.
    pub place: Location,
    /// What it is.
    pub kind: EntryKind,
}

/// What an entry is.
#[derive(Clone, Debug, PartialEq)]
pub enum EntryKind {
    /// A picture.
    Figure(Figure),
    /// Numbers, one a member.
    Value {
        /// The numbers.
        members: Vec<Member>,
        /// How they are shown.
        display: DisplayUnit,
    },
    /// What must hold of all members.
    Require {
        /// Truth values.
        members: Vec<Expression>,
        /// What is told where one does not.
        message: Vec<MessagePart>,
        /// `advise`: told, but no failure.
        advise: bool,
    },
}

/// Part of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum MessagePart {
    /// Plain text.
    Text(String),
    /// A number; one for each member of the condition, or one for all.
    Value(Vec<Expression>, DisplayUnit),
}

/// A named expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// The analysis that it is of, or the first of them; empty for a constant.
    pub analysis: String,
    /// What it is of its analysis: `vertical[5]`.
    pub channel: String,
    /// The signal or number.
    pub expression: Expression,
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
    /// Amplitude (0-peak) of a sinusoid of a signal: its order, or its frequency (Hz).
    Amplitude(Limit, Window, Box<Expression>),
    /// What a column of a linear analysis has for one of its modes.
    Mode(Chosen, Box<Expression>),
    /// 20·lg of a number or of each sample over a reference.
    Decibel(f64, Box<Expression>),
    /// One number of several.
    Fold(Operator, Vec<Expression>),
    /// Not.
    Not(Box<Expression>),
}

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Function {
    Abs,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Exp,
    Log,
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
    /// Whole cycles, angles counted from the first one's begin.
    Cycles(u32),
}

/// A frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Hz.
    Frequency(f64),
    /// Cycles a revolution.
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

/// What passes a filter. Of whole cycles it is that of a signal that repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Lower limit; absent for a low-pass.
    pub from: Option<Limit>,
    /// Upper limit; absent for a high-pass.
    pub to: Option<Limit>,
    /// Order of a Butterworth filter run both ways; absent for a brick wall.
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
    /// The cycle angle of the minimum; its time where `true`.
    MinimumAt(bool),
    /// The cycle angle of the maximum; its time where `true`.
    MaximumAt(bool),
}

/// Weight of a block of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Window {
    Rectangular,
    Hann,
    FlatTop,
    BlackmanHarris,
}

/// From the spectra of blocks to one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Averaging {
    Linear,
    RootMeanSquare,
    Peak,
}

/// Horizontal axis of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Hz.
    Frequency,
    /// Cycles a revolution.
    Order,
}

/// How spectra are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumSettings {
    /// Weight of a block.
    pub window: Window,
    /// What the lines are counted by.
    pub axis: Axis,
    /// Where the axis ends (Hz, or orders).
    pub up_to: Option<f64>,
    /// Length of a block; absent: one block of all.
    pub block: Option<Extent>,
    /// Share of a block that the next one repeats.
    pub overlap: f64,
    /// From blocks to one spectrum.
    pub averaging: Averaging,
    /// Whether the mean of each block is taken away.
    pub remove_mean: bool,
    /// Logarithmic ordinate.
    pub logarithmic: bool,
    /// Amplitudes as decibels over this.
    pub reference: Option<f64>,
}

/// What a figure shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What the ordinate is called.
    pub quantity: String,
    /// The ordinate's unit.
    pub display: DisplayUnit,
    /// Which picture.
    pub picture: Picture,
}

/// A kind of picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Picture {
    /// Curves over crank angle, or time where `true`; one list a panel.
    History(Vec<Vec<Member>>, bool),
    /// Spectra.
    Spectrum(Vec<Member>, SpectrumSettings),
    /// Paths of pins: analysis and path of each journal; the last cycles, or all.
    Orbit(Vec<(String, String)>, Option<u32>),
    /// Vectors, of journals the load on their shells; the last cycles, or all.
    Polar(Vec<Vector>, Option<u32>),
    /// Orders over speed.
    OrderTrack {
        /// The signals, one a run; or one alone over changing speed.
        members: Vec<Member>,
        /// The orders.
        orders: Vec<f64>,
        /// Weight of a block.
        window: Window,
        /// Revolutions of a block of one run over changing speed, and their overlap.
        block: Option<(f64, f64)>,
    },
    /// Spectra one behind the other.
    Waterfall(Vec<Member>, SpectrumSettings),
    /// Colours over speed and frequency with lines of orders and natural frequencies.
    Campbell {
        /// The signals, one a run.
        members: Vec<Member>,
        /// How their spectra are made.
        settings: SpectrumSettings,
        /// Orders with a line each; absent: those of the firing, or the first four.
        orders: Option<Vec<f64>>,
        /// Linear analyses whose natural frequencies are drawn.
        modes: Vec<String>,
    },
}

/// A vector of a polar diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector {
    /// The analysis.
    pub analysis: String,
    /// `main[5].force`; of a journal `main[5]`.
    pub path: String,
    /// Whether it is the load that a journal's pin puts on its shell, −force; else a vector as it was recorded.
    pub load: bool,
    /// Component along x.
    pub x: Expression,
    /// Component along y.
    pub y: Expression,
    /// The angle by which the drawn axes are turned about z.
    pub turned_by: Option<Expression>,
}

impl Expression {
    /// The expressions that it is made of.
    pub fn parts(&self) -> Vec<&Expression> {
        match self {
            Expression::Number(_) | Expression::Channel { .. } => Vec::new(),
            Expression::Map(_, of)
            | Expression::Last(_, of)
            | Expression::Filter(_, of)
            | Expression::Reduce(_, of)
            | Expression::Amplitude(_, _, of)
            | Expression::Mode(_, of)
            | Expression::Decibel(_, of)
            | Expression::Not(of) => vec![of],
            Expression::Binary(_, left, right) | Expression::Resample(left, right) => {
                vec![left, right]
            }
            Expression::Fold(_, members) => members.iter().collect(),
        }
    }

    /// Calls with every channel in it: analysis and path.
    pub fn channels<'e>(&'e self, found: &mut dyn FnMut(&'e str, &'e str)) {
        if let Expression::Channel { analysis, path } = self {
            found(analysis, path);
        }
        for part in self.parts() {
            part.channels(found);
        }
    }
}

impl Entry {
    /// The analyses that it is made of, each once, in order of appearance.
    pub fn analyses(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        let mut add = |name| {
            if !names.contains(&name) {
                names.push(name);
            }
        };
        for expression in self.expressions() {
            expression.channels(&mut |analysis, _| add(analysis));
        }
        if let EntryKind::Figure(figure) = &self.kind {
            match &figure.picture {
                Picture::Orbit(journals, _) => journals.iter().for_each(|(name, _)| add(name)),
                Picture::Campbell { modes, .. } => modes.iter().for_each(|name| add(name)),
                _ => {}
            }
        }
        names
    }

    /// Its signals and numbers.
    fn expressions(&self) -> Vec<&Expression> {
        match &self.kind {
            EntryKind::Value { members, .. } => members.iter().map(|m| &m.expression).collect(),
            EntryKind::Require {
                members, message, ..
            } => members
                .iter()
                .chain(message.iter().flat_map(|part| match part {
                    MessagePart::Value(values, _) => values.as_slice(),
                    MessagePart::Text(_) => &[],
                }))
                .collect(),
            EntryKind::Figure(figure) => match &figure.picture {
                Picture::History(panels, _) => {
                    panels.iter().flatten().map(|m| &m.expression).collect()
                }
                Picture::Spectrum(members, _)
                | Picture::Waterfall(members, _)
                | Picture::Campbell { members, .. }
                | Picture::OrderTrack { members, .. } => {
                    members.iter().map(|m| &m.expression).collect()
                }
                Picture::Orbit(..) => Vec::new(),
                Picture::Polar(vectors, _) => vectors
                    .iter()
                    .flat_map(|v| [&v.x, &v.y].into_iter().chain(&v.turned_by))
                    .collect(),
            },
        }
    }
}
