//! Inputs: numbers that a program sets while a model runs.
//!
//! A program sets inputs at *points* of time, and no step crosses a point. The interpolation gives the values
//! between two points.

/// The values of an input between two points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// The value of the left point.
    #[default]
    Hold,
    /// On the straight line between the values of both points; constant without a value of the right point.
    Linear,
    /// On Hermite's cubic through values and rates of both points; constant without a right point.
    Cubic,
}

impl Interpolation {
    /// Each interpolation with its word in the text.
    pub const NAMED: [(&'static str, Interpolation); 3] = [
        ("hold", Interpolation::Hold),
        ("linear", Interpolation::Linear),
        ("cubic", Interpolation::Cubic),
    ];

    /// The interpolation of a word.
    pub fn named(word: &str) -> Option<Interpolation> {
        let mut named = Interpolation::NAMED.iter();
        named.find(|(name, _)| *name == word).map(|named| named.1)
    }

    /// Its word in the text.
    pub fn word(self) -> &'static str {
        let mut named = Interpolation::NAMED.iter();
        named
            .find(|named| named.1 == self)
            .map_or("", |named| named.0)
    }
}

/// An input of a system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// Index of the parameter with its path, dimension, limits and start value.
    pub parameter: u32,
    /// Its values between two points.
    pub interpolation: Interpolation,
    /// Whether a value is its rate (`der`): then loads jump where the rate does.
    pub differentiated: bool,
    /// Name of the function of time in the text that gives its values. A stated value of the parameter replaces
    /// the function.
    pub signal: Option<String>,
}
