//! Tables of results by interface: the text of an interface states the number that a table takes from an output.

use super::Slot;
use crate::dimension::{Dimension, DisplayUnit};

/// The number that a table shows of a column of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Statistic {
    /// The least value and its place.
    Least,
    /// The largest value and its place.
    Largest,
    /// The mean over time.
    Mean,
}

impl Statistic {
    /// All with their words in a text.
    pub const ALL: [(&'static str, Statistic); 3] = [
        ("least", Statistic::Least),
        ("largest", Statistic::Largest),
        ("mean", Statistic::Mean),
    ];

    /// By its word.
    pub fn of(word: &str) -> Option<Statistic> {
        let known = Statistic::ALL.iter().find(|(other, _)| *other == word);
        known.map(|(_, statistic)| *statistic)
    }

    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Statistic::Least => "least",
            Statistic::Largest => "largest",
            Statistic::Mean => "mean",
        }
    }
}

/// The elements whose classes fill one interface, and the numbers of them that a table shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Name of the interface.
    pub interface: String,
    /// Its parameters that are numbers, in their order.
    pub parameters: Vec<SummaryParameter>,
    /// The outputs with a summary, in their order: those of the interface, then those that interfaces
    /// between it and a class add.
    pub columns: Vec<SummaryColumn>,
    /// A row for each element, in the order of the text.
    pub rows: Vec<SummaryRow>,
}

/// A parameter of an interface.
#[derive(Clone, Debug, PartialEq)]
pub struct SummaryParameter {
    /// Its name.
    pub name: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its display unit.
    pub display: DisplayUnit,
}

/// An output of an interface that has a summary.
#[derive(Clone, Debug, PartialEq)]
pub struct SummaryColumn {
    /// Name of the output.
    pub output: String,
    /// Its comment.
    pub about: String,
    /// The number that the table shows.
    pub statistic: Statistic,
}

/// An element of a summary.
#[derive(Clone, Debug, PartialEq)]
pub struct SummaryRow {
    /// Index into [`crate::system::System::elements`].
    pub element: u32,
    /// The values of the parameters; `None` for a value that depends on the motion.
    pub parameters: Vec<Option<Slot>>,
    /// Indices into [`crate::system::System::channels`]; `None` for a column that the element's class lacks.
    pub channels: Vec<Option<u32>>,
}
