//! The outline of a text.

use super::document::{Document, range};
use eng_grammar::ast::{BindingKind, Item, ItemKind, Kind};
use eng_grammar::{Diagnostics, SourceId, parse};
use serde_json::{Value, json};

pub(super) fn symbols(document: &Document) -> Value {
    let file = parse(&document.text, SourceId(0), &mut Diagnostics::new());
    Value::Array(listed(&document.text, &file.items, 0))
}

/// Blocks nested deeper than the grammar allows do not parse, so the depth is bounded; so is this walk.
fn listed(text: &str, items: &[Item], depth: usize) -> Vec<Value> {
    // a choice
    if depth > 50 {
        return Vec::new();
    }
    let named = items
        .iter()
        .filter_map(|item| Some((item, item.kind.name()?)));
    named
        .map(|(item, name)| {
            let inner = item.kind.block().map_or(&[][..], |block| &block.items);
            json!({
                "name": name.text,
                "kind": kind(&item.kind),
                "range": range(text, item.span.start as usize, item.span.end as usize),
                "selectionRange": range(text, name.span.start as usize, name.span.end as usize),
                "children": listed(text, inner, depth + 1),
            })
        })
        .collect()
}

/// The protocol's number for a kind of item.
pub(super) fn kind(item: &ItemKind) -> u32 {
    const MODULE: u32 = 2;
    const CLASS: u32 = 5;
    const FIELD: u32 = 8;
    const ENUM: u32 = 10;
    const INTERFACE: u32 = 11;
    const FUNCTION: u32 = 12;
    const VARIABLE: u32 = 13;
    const CONSTANT: u32 = 14;
    const OBJECT: u32 = 19;
    const STRUCT: u32 = 23;
    const EVENT: u32 = 24;
    match item {
        ItemKind::Function(_) | ItemKind::Table(_) => FUNCTION,
        ItemKind::Choice(_) => ENUM,
        ItemKind::Dimension(_) | ItemKind::Unit(_) => CONSTANT,
        ItemKind::Report(_) => MODULE,
        ItemKind::Entry(_) => FIELD,
        ItemKind::Binding(binding) => match binding.kind {
            BindingKind::Const => CONSTANT,
            BindingKind::Output => FIELD,
            _ => VARIABLE,
        },
        ItemKind::Declaration(declaration) => match (declaration.kind, &declaration.form) {
            (Kind::Model | Kind::Component, _) => CLASS,
            (Kind::Interface, _) => INTERFACE,
            (Kind::Record, _) => STRUCT,
            (Kind::Analysis, _) => EVENT,
            (_, eng_grammar::ast::Form::Class { .. }) => CLASS,
            _ => OBJECT,
        },
        _ => VARIABLE,
    }
}
