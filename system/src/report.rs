//! What a report makes of results: figures and values as trees over recorded channels.
//!
//! Contains no names to be looked up and no units to be converted: numbers are SI, dimensions fit, lists are written out.

use crate::DisplayUnit;
use crate::expression::{Expression, Member};
use crate::figure::Figure;
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
