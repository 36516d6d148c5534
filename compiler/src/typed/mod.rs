//! The typed tree: the syntax trees of a program with the findings of the checker beside them.
//!
//! The checker writes it, and elaboration reads it.
//!
//! It contains types, dimensions, instantiations and messages, each under the place of its expression. It
//! must not contain values of expressions or instances of classes.
//!
//! The place of an expression is its identity. No two expressions of a text have the same place, and a
//! declared type has a place of its own. A generic function is checked once, and the types in its body keep
//! its dimension variables. Each use of the function has a `types::Solution` with the dimensions of these
//! variables.

mod class_text;
pub(crate) mod kind_words;
pub(crate) mod lineage;
pub(crate) mod types;

pub use class_text::{ClassText, LevelText};

use crate::functions::BuiltIn;
use crate::program::{DefinitionId, Program, ValueType};
use crate::words::Word;
use eng_grammar::ast::{Binding, BindingKind, Declaration, Form, ItemKind, Kind};
use eng_grammar::{MessagePart, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use types::{Solution, Type};

/// The findings of the checker, by place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    /// Types of expressions, and declared types.
    pub types: BTreeMap<Span, Type>,
    /// Dimensions of the variables of a generic function, by the place of its call, or of the expression that
    /// passes the function as a value.
    pub solutions: BTreeMap<Span, Solution>,
    /// Calls of names of the language itself, by the place of the call. A name of the text cannot hide such a
    /// call: the checker decides once, and elaboration does not look the name up again.
    pub callees: BTreeMap<Span, Callee>,
    /// The parameter of each argument, by the place of the call: its index in the signature of a function,
    /// the list of a class, or the [`settable`] values of a record or model.
    pub calls: BTreeMap<Span, Arc<[u32]>>,
    /// Calls that give a function some of its arguments and make a function of the others.
    pub bound: BTreeSet<Span>,
    /// Messages of `require` and `advise` and texts with values in them, by the place inside their quotes.
    pub messages: BTreeMap<Span, Vec<MessagePart>>,
    /// The words of choices, each with its choice and its place among the words.
    pub words: BTreeMap<Span, (DefinitionId, u32)>,
    /// The names in `accept` items that accepted a lint of the checker.
    pub accepted: BTreeSet<Span>,
    /// Lengths of arrays that the arguments decide, by the place of the length: `n` of `values: Length[n]`.
    pub lengths: BTreeSet<Span>,
    /// Types of the named values of each definition; a top-level `const` or `let` has the empty name.
    pub named: BTreeMap<(DefinitionId, String), ValueType>,
}

/// A name of the language itself that a text can call.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Callee {
    /// A function.
    BuiltIn(&'static BuiltIn),
    /// A term of a mode set.
    Modes(&'static Word),
}

impl Findings {
    /// Adds the findings of another check. For an equal place the added finding replaces the present one.
    pub fn extend(&mut self, other: Findings) {
        self.types.extend(other.types);
        self.solutions.extend(other.solutions);
        self.callees.extend(other.callees);
        self.calls.extend(other.calls);
        self.bound.extend(other.bound);
        self.messages.extend(other.messages);
        self.lengths.extend(other.lengths);
        self.named.extend(other.named);
    }
}

/// The values that a use can set, in their order: those in the block of a model, of a component without
/// parameters, or of a record. The block of a class with parameters has none.
pub(crate) fn settable(declaration: &Declaration) -> impl Iterator<Item = &Binding> {
    let items = match &declaration.form {
        Form::Plain { block, .. } => block.items.as_slice(),
        Form::Class { .. } | Form::Instance { .. } => &[],
    };
    let record = declaration.kind == Kind::Record;
    items.iter().filter_map(move |item| match &item.kind {
        ItemKind::Binding(binding) => match binding.kind {
            BindingKind::Param | BindingKind::Input | BindingKind::Const => Some(binding),
            BindingKind::Let => record.then_some(binding),
            BindingKind::State | BindingKind::Field | BindingKind::Output => None,
        },
        _ => None,
    })
}

/// A checked program. Its findings are complete if the checker reported no error.
#[derive(Clone, Debug)]
pub struct TypedProgram {
    /// The syntax trees, names and units.
    pub program: Program,
    pub(crate) findings: Findings,
}

impl TypedProgram {
    /// The type of a named value of a definition: of a class or model, by the name of its parameter, `param`,
    /// `const`, `let`, `state` or `output`; of a top-level `const` or `let`, by the empty name.
    pub fn of(&self, definition: DefinitionId, name: &str) -> Option<&ValueType> {
        self.findings.named.get(&(definition, name.to_owned()))
    }

    /// The type of the expression, or of the declared type, at a place.
    pub(crate) fn type_at(&self, place: Span) -> Option<&Type> {
        self.findings.types.get(&place)
    }
}
