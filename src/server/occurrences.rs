//! All names of a text with their meanings: for uses, other names, and colours.
//!
//! The tree is walked once. Names that nothing defines, such as components of vectors, keep their place without a
//! meaning.

mod items;
mod values;

use super::index::{Found, Index, What};
use eng_grammar::Span;
use eng_grammar::ast::{BindingKind, Form, Item, ItemKind, Kind, Name};
use std::collections::BTreeMap;

/// The kind of a name, for its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Token {
    Module,
    Dimension,
    Class,
    Interface,
    Record,
    Choice,
    Word,
    Function,
    Parameter,
    Value,
    Member,
    Unit,
}

/// A definition, by its module and the first byte of its name there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Target {
    pub module: usize,
    pub start: u32,
}

/// A name at a place of the document.
#[derive(Clone, Copy, Debug)]
pub(super) struct Occurrence {
    pub span: Span,
    /// Its definition; none for a name of the language, and for one that is not known.
    pub of: Option<Target>,
    pub token: Token,
    /// Whether it is the definition.
    pub defines: bool,
}

/// The names of the document of an index, in the order of their places.
pub(super) fn occurrences(index: &Index<'_>) -> Vec<Occurrence> {
    let number = index.own();
    let Some(module) = index.module(number) else {
        return Vec::new();
    };
    let (mut values, mut units) = (BTreeMap::new(), BTreeMap::new());
    for found in index.visible(number) {
        let names = match is_unit(found) {
            true => &mut units,
            false => &mut values,
        };
        names.entry(found.name().text.as_str()).or_insert(found);
    }
    let mut walk = Walk {
        index,
        number,
        outer: values,
        units,
        inner: Vec::new(),
        model: None,
        in_body: false,
        text: &module.text,
        found: Vec::new(),
    };
    walk.items(&module.file.items);
    let mut found = walk.found;
    found.sort_by_key(|one| (one.span.start, one.of.is_none()));
    found.dedup_by_key(|one| one.span.start);
    found
}

fn is_unit(found: Found<'_>) -> bool {
    matches!(found.item().map(|item| &item.kind), Some(ItemKind::Unit(_)))
}

struct Walk<'i, 'l> {
    index: &'i Index<'l>,
    number: usize,
    /// Names at the top level, without units.
    outer: BTreeMap<&'i str, Found<'i>>,
    units: BTreeMap<&'i str, Found<'i>>,
    /// Variables of lists and of dimensions around a place, the innermost last.
    inner: Vec<(String, Span)>,
    /// The model whose names an argument of an analysis states.
    model: Option<Found<'i>>,
    /// Whether a place is in the block of a body, whose attributes are names of the language.
    in_body: bool,
    text: &'i str,
    found: Vec<Occurrence>,
}

impl<'i> Walk<'i, '_> {
    fn push(&mut self, span: Span, of: Option<Target>, token: Token, defines: bool) {
        self.found.push(Occurrence {
            span,
            of,
            token,
            defines,
        });
    }

    /// A definition of the document itself.
    fn define(&mut self, name: &Name, token: Token) {
        let of = Target {
            module: self.number,
            start: name.span.start,
        };
        self.push(name.span, Some(of), token, true);
    }

    fn refer(&mut self, span: Span, found: Found<'i>) {
        let of = Target {
            module: found.module,
            start: found.name_span().start,
        };
        let token = self.token(found);
        self.push(span, Some(of), token, false);
    }

    fn token(&self, found: Found<'_>) -> Token {
        match found.what {
            What::Parameter(_) => Token::Parameter,
            What::Item(item, _) => of_item(&item.kind),
            What::Name(name) => {
                let is_word = |item: &Item| matches!(&item.kind, ItemKind::Choice(choice) if choice.words.contains(name));
                let module = self.index.module(found.module);
                match module.is_some_and(|module| module.file.items.iter().any(is_word)) {
                    true => Token::Word,
                    false => Token::Value,
                }
            }
        }
    }
}

/// The kind of the name of an item.
fn of_item(kind: &ItemKind) -> Token {
    match kind {
        ItemKind::Dimension(_) => Token::Dimension,
        ItemKind::Unit(_) => Token::Unit,
        ItemKind::Choice(_) => Token::Choice,
        ItemKind::Function(_) | ItemKind::Table(_) => Token::Function,
        ItemKind::Report(_) => Token::Module,
        ItemKind::Entry(_) => Token::Member,
        ItemKind::Binding(binding) => match binding.kind {
            BindingKind::Const | BindingKind::Param | BindingKind::Input => Token::Parameter,
            BindingKind::Output => Token::Member,
            BindingKind::Let | BindingKind::State | BindingKind::Field => Token::Value,
        },
        ItemKind::Declaration(declaration) => match (declaration.kind, &declaration.form) {
            (Kind::Interface, _) => Token::Interface,
            (Kind::Record, _) => Token::Record,
            (Kind::Model | Kind::Component, _) | (_, Form::Class { .. }) => Token::Class,
            _ => Token::Value,
        },
        ItemKind::Use(_) | ItemKind::Statement(_) | ItemKind::Attribute(_) | ItemKind::Error => {
            Token::Value
        }
    }
}
