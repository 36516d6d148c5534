//! The contents of one part, instance or assembly, in the numbers of the file.

use std::collections::BTreeMap;

use super::lines::{Keyword, Row, unquoted};
use super::shapes::Shape;
use crate::error::FileProblem;
use crate::read::source::At;

/// A keyword with its data lines.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The keyword.
    pub keyword: Keyword,
    /// Its data lines.
    pub rows: Vec<Row>,
    /// The number of its `*STEP`, from 1. 0 is the model, before all steps.
    pub step: u32,
}

/// A node.
#[derive(Clone, Debug)]
pub(super) struct NodeRow {
    /// Its number.
    pub label: u64,
    /// Its place, in the frame of its part.
    pub position: [f64; 3],
    /// Its place in the file.
    pub at: At,
}

/// An element.
#[derive(Clone, Debug)]
pub(super) struct ElementRow {
    /// Its number.
    pub label: u64,
    /// Its shape.
    pub shape: Shape,
    /// Start of its nodes in [`Scope::labels`].
    pub first: usize,
    /// Number of its nodes.
    pub count: usize,
    /// Its place in the file.
    pub at: At,
}

/// Members of a set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Member {
    /// Numbers: first, last, step.
    Numbers(u64, u64, u64),
    /// The name of a set, or the name of an instance with a set or number of it.
    Name(String),
    /// The nodes of a set of elements.
    NodesOf(String),
}

/// A part of a set.
#[derive(Clone, Debug)]
pub(super) struct SetBlock {
    /// Whether it is a set of nodes; otherwise of elements.
    pub of_nodes: bool,
    /// Its name.
    pub name: String,
    /// The instance whose numbers these are.
    pub instance: Option<String>,
    /// Its members.
    pub members: Vec<Member>,
    /// Its place in the file.
    pub at: At,
}

impl SetBlock {
    /// Adds a number. A run of consecutive numbers is kept as one member.
    pub fn add(&mut self, label: u64) {
        if let Some(Member::Numbers(_, last, 1)) = self.members.last_mut()
            && last.checked_add(1) == Some(label)
        {
            *last = label;
            return;
        }
        self.members.push(Member::Numbers(label, label, 1));
    }

    /// Adds the members of a data line.
    pub fn row(&mut self, row: &Row, generate: bool) -> Result<(), FileProblem> {
        let fields = row.fields();
        if !generate {
            for field in fields.into_iter().filter(|field| !field.is_empty()) {
                match label(field) {
                    Some(number) => self.add(number),
                    None => self.members.push(Member::Name(unquoted(field).to_string())),
                }
            }
            return Ok(());
        }
        let numbers = fields.iter().map(|field| label(field)).collect::<Vec<_>>();
        let (first, last, step) = match *numbers.as_slice() {
            [] => return Ok(()),
            [Some(first)] => (first, first, 1),
            [Some(first), Some(last)] => (first, last, 1),
            [Some(first), Some(last), Some(step)] => (first, last, step.max(1)),
            _ => {
                return Err(row.at.problem(
                    format!(
                        "set {}: with GENERATE, a line is: first number, last number, step",
                        self.name
                    ),
                    "write three whole numbers; for a list of numbers, remove GENERATE",
                ));
            }
        };
        if last < first {
            return Err(row.at.problem(
                format!(
                    "set {}: the first number {first} is above the last number {last}",
                    self.name
                ),
                "write the smaller number first",
            ));
        }
        self.members.push(Member::Numbers(first, last, step));
        Ok(())
    }
}

/// A part, the additions of an instance to its part, or the input outside all parts.
#[derive(Clone, Debug, Default)]
pub(super) struct Scope {
    /// Nodes.
    pub nodes: Vec<NodeRow>,
    /// Elements.
    pub elements: Vec<ElementRow>,
    /// Nodes of the elements.
    pub labels: Vec<u64>,
    /// Instance names of nodes that an element names with their instance, by index in `labels`.
    pub qualified: BTreeMap<usize, String>,
    /// Sets in parts.
    pub sets: Vec<SetBlock>,
    /// All other keywords that Eng reads.
    pub blocks: Vec<Block>,
}

impl Scope {
    /// Adds the contents of another scope.
    pub fn append(&mut self, other: Scope) {
        let shift = self.labels.len();
        self.nodes.extend(other.nodes);
        self.elements
            .extend(other.elements.into_iter().map(|element| ElementRow {
                first: element.first + shift,
                ..element
            }));
        self.labels.extend(other.labels);
        self.qualified.extend(
            other
                .qualified
                .into_iter()
                .map(|(i, name)| (i + shift, name)),
        );
        self.sets.extend(other.sets);
        self.blocks.extend(other.blocks);
    }
}

/// A number of a node or element.
pub(super) fn label(text: &str) -> Option<u64> {
    if text.is_empty() || !text.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    text.parse().ok().filter(|label| *label > 0)
}

/// A number of a node or element, or an error if the text is no such number.
pub(super) fn required_label(text: &str, what: &str, at: &At) -> Result<u64, FileProblem> {
    label(text).ok_or_else(|| {
        at.problem(
            format!("the number of {what} is \"{text}\""),
            "write a whole number above zero",
        )
    })
}
