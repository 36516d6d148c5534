//! The entries of a report: figures and values as trees over recorded channels.
//!
//! The trees contain no unresolved names. Numbers are SI, dimensions fit, lists are expanded. An entry keeps the
//! unit in which it is shown.

use crate::DisplayUnit;
use crate::expression::{Expression, Member};
use crate::figure::Figure;
use crate::place::Location;

/// `report name "title" { … }`.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Its name.
    pub name: String,
    /// Title of its section.
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
    /// Its name; `require` for a requirement.
    pub name: String,
    /// Its title.
    pub title: String,
    /// `///` lines before it.
    pub text: String,
    /// The text after `=`.
    pub written: String,
    /// Its place.
    pub place: Location,
    /// Its kind.
    pub kind: EntryKind,
}

/// The kind of an entry.
#[derive(Clone, Debug, PartialEq)]
pub enum EntryKind {
    /// A picture.
    Figure(Figure),
    /// Numbers, one for each member of a list.
    Value {
        /// The numbers.
        members: Vec<Member>,
        /// Their display unit.
        display: DisplayUnit,
    },
    /// A condition that all members must satisfy.
    Require {
        /// Truth values.
        members: Vec<Expression>,
        /// The message if a member does not satisfy it.
        message: Vec<MessagePart>,
        /// Whether it is an `advise`, which gives a warning and no failure.
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

impl Entry {
    /// The analyses whose results it uses, each once, in the order of the text.
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
            figure.picture.analyses().into_iter().for_each(add);
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
            EntryKind::Figure(figure) => figure.picture.expressions(),
        }
    }
}
