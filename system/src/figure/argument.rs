//! The arguments of figures: types, and their values on the way into a tree.

use super::Vector;
use crate::analysis::Extent;
use crate::dimension::{Dimension, DisplayUnit};
use crate::expression::{Expression, Limit, Member};
use crate::kinds;

/// An argument that a figure takes.
#[derive(Debug)]
pub struct Argument {
    /// `up_to`.
    pub name: &'static str,
    /// Its meaning, as a clause with its default.
    pub about: &'static str,
    /// Its type.
    pub takes: Takes,
    /// Whether it is given by its place and is required; the others have names and are optional.
    pub by_place: bool,
    /// Whether more arguments of its type may follow by place.
    pub more: bool,
}

/// The type of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takes {
    /// Signals along the ordinate, in the unit that `as` states.
    Ordinates,
    /// The same, of samples or of the frequencies of a response.
    OrdinatesOfRows,
    /// Signals in their own unit, of a dimension if one is given. Without one they may have the frequencies of a
    /// response as rows.
    Signals(Option<Dimension>),
    /// Signals whose amplitudes are drawn along the ordinate.
    Amplitudes,
    /// Signals of several runs, one of each, whose amplitudes are drawn.
    AmplitudesOfRuns,
    /// Signals of several runs whose amplitudes are drawn; of one run if the named argument is given.
    AmplitudesOfRunsOr(&'static str),
    /// Outputs of frequency responses, as recorded.
    Responses,
    /// Journals.
    Journals,
    /// Journals whose films are solved on cells.
    Films,
    /// A number that is an angle of the cycle or a time.
    Moment,
    /// Recorded vectors, or journals, whose loads are meant.
    Vectors,
    /// A value, if the named argument states a share by which parameters change; otherwise changes of values by
    /// parameters.
    Changes(&'static str),
    /// A share above 0, up to 100 %.
    Change,
    /// Linear analyses of the model of the first argument.
    LinearAnalyses,
    /// A plain number above zero or a list of them.
    Orders,
    /// One of these words.
    Word(&'static [&'static str]),
    /// A whole number from 1 on.
    Count,
    /// A share from 0 to below 1.
    Share,
    /// A frequency, or an order as a plain number.
    Limit,
    /// A time or an angle of the cycle.
    Extent,
    /// An angle of the shaft.
    Turn,
    /// A reference for levels of the first argument.
    Reference,
}

/// The value of an argument. A number is within the limits of its type.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Signals, of each argument by place one list.
    Signals(Vec<Signals>),
    /// Journals.
    Journals(Journals),
    /// Journals with films on cells, and whether all their models have a cycle.
    Films(Journals, bool),
    /// A moment, and whether it is a time.
    Moment(Expression, bool),
    /// Vectors.
    Vectors(Vec<Vector>, Recorded),
    /// Names of analyses.
    Analyses(Vec<String>),
    /// Numbers (SI).
    Numbers(Vec<f64>),
    /// The place of a word in the list of its row.
    Word(usize),
    /// A frequency or an order.
    Limit(Limit),
    /// A time or an angle.
    Extent(Extent),
}

/// Journals: analysis and path of each.
pub type Journals = Vec<(String, String)>;

/// The display of signals.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Words for the quantity: `force x`.
    pub quantity: String,
    /// Its unit.
    pub display: DisplayUnit,
    /// Its dimension.
    pub dimension: Dimension,
}

/// Signals of one quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Signals {
    /// The signals.
    pub members: Vec<Member>,
    /// Their display unit.
    pub shown: Recorded,
    /// Whether the models behind all of them have a cycle.
    pub cycle: bool,
    /// Whether they are of analyses whose cycle repeats, and whole.
    pub repeats: bool,
}

impl Signals {
    /// The expressions of the signals.
    pub fn expressions(members: &[Member]) -> Vec<&Expression> {
        members.iter().map(|member| &member.expression).collect()
    }
}

/// The stated arguments of a figure. Each has the type of its row.
pub type Given = kinds::Given<Value>;

/// The reason why arguments give no tree.
#[derive(Clone, Debug, PartialEq)]
pub enum Unplanned {
    /// An argument needs a cycle, and the model has none. The words name its part in the message.
    NoCycle(&'static str, &'static str),
    /// An argument is of another axis than another one: the title and the label of the message.
    OtherAxis(&'static str, String, &'static str),
    /// An argument has neither one item for all items of another one nor one for each: the title.
    Counts(&'static str, String),
    /// A required argument is absent.
    Absent(&'static str),
}

impl Given {
    /// The lists of signals of an argument.
    pub fn panels(&self, name: &'static str) -> Result<&[Signals], Unplanned> {
        match self.find(name) {
            Some(Value::Signals(panels)) if !panels.is_empty() => Ok(panels),
            _ => Err(Unplanned::Absent(name)),
        }
    }

    /// The signals of an argument for each of a number of items, if the text states it. The words are the
    /// plural names of the items and of the signals.
    pub fn for_each(
        &self,
        name: &'static str,
        count: usize,
        (items, signals): (&str, &str),
    ) -> Result<Option<Vec<Expression>>, Unplanned> {
        let Ok(of) = self.signals(name) else {
            return Ok(None);
        };
        let expression = |member: &Member| member.expression.clone();
        match of.members.as_slice() {
            [one] => Ok(Some(vec![expression(one); count])),
            members if members.len() == count => Ok(Some(members.iter().map(expression).collect())),
            members => {
                let given = members.len();
                let title =
                    format!("the numbers of {items} ({count}) and {signals} ({given}) differ");
                Err(Unplanned::Counts(name, title))
            }
        }
    }

    /// The signals of an argument.
    pub fn signals(&self, name: &'static str) -> Result<&Signals, Unplanned> {
        self.panels(name)?.first().ok_or(Unplanned::Absent(name))
    }

    /// The first number (SI) of an argument, if the text states it.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers(name)?.first().copied()
    }

    /// The numbers (SI) of an argument, if the text states it.
    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        match self.find(name)? {
            Value::Numbers(numbers) => Some(numbers),
            _ => None,
        }
    }

    /// A count, if the text states it.
    pub fn count(&self, name: &str) -> Option<u32> {
        // a whole number within its limits
        self.number(name).map(|count| count as u32)
    }

    /// The meaning of a word in a table of words, if the text states one.
    pub fn word<T: Copy>(&self, name: &str, table: &[(&'static str, T)]) -> Option<T> {
        match self.find(name)? {
            Value::Word(at) => table.get(*at).map(|(_, meaning)| *meaning),
            _ => None,
        }
    }

    /// A frequency or an order, if the text states it.
    pub fn limit(&self, name: &str) -> Option<Limit> {
        match self.find(name)? {
            Value::Limit(limit) => Some(*limit),
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
}

/// An argument by place.
pub(super) const fn place(name: &'static str, takes: Takes, about: &'static str) -> Argument {
    Argument {
        name,
        about,
        takes,
        by_place: true,
        more: false,
    }
}

/// An argument by name, which may be left out.
pub(super) const fn option(name: &'static str, takes: Takes, about: &'static str) -> Argument {
    Argument {
        name,
        about,
        takes,
        by_place: false,
        more: false,
    }
}

/// The words of a table.
pub(super) const fn words<T, const N: usize>(table: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut at = 0;
    while at < N {
        words[at] = table[at].0;
        at += 1;
    }
    words
}

pub(super) const CYCLES: Argument = option(
    "cycles",
    Takes::Count,
    "the last cycles that are drawn; without it all samples",
);
