//! Words that may come next.

use super::document::Document;
use super::hover::{about, head};
use super::index::{Found, Index, OF_MARKERS, What};
use super::place::{call_around, is_quiet, names_before, path_at};
use crate::Program;
use eng_grammar::ast::{ItemKind, Kind};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// The protocol's numbers of kinds.
mod kinds {
    pub const FUNCTION: u32 = 3;
    pub const FIELD: u32 = 5;
    pub const VARIABLE: u32 = 6;
    pub const CLASS: u32 = 7;
    pub const MODULE: u32 = 9;
    pub const PROPERTY: u32 = 10;
    pub const UNIT: u32 = 11;
    pub const KEYWORD: u32 = 14;
}

pub(super) fn completion(
    index: &Index<'_>,
    document: &Document,
    program: Option<&Program>,
    place: usize,
) -> Value {
    let before = document.text.get(..place).unwrap_or("");
    let line = before.rsplit('\n').next().unwrap_or("");
    let word = line.len()
        - line
            .trim_end_matches(|c: char| c.is_ascii_alphanumeric() || c == '_')
            .len();
    let head = &line[..line.len() - word];
    let mut items = if is_quiet(line) {
        Vec::new()
    } else if let Some(path) = head.trim_start().strip_prefix("use ") {
        modules(index, path)
    } else if head.ends_with('.') && !head.ends_with("..") {
        members(index, &document.text, place - word)
    } else if wants_unit(head, &line[line.len() - word..]) {
        units(index, program, line)
    } else {
        words(index, &document.text, place)
    };
    let mut seen = BTreeSet::new();
    items.retain(|item| seen.insert(item["label"].as_str().unwrap_or("").to_owned()));
    json!({ "isIncomplete": false, "items": items })
}

fn item(index: &Index<'_>, found: Found<'_>, order: u8) -> Value {
    let kind = match found.what {
        What::Parameter(_) | What::Name(_) => kinds::VARIABLE,
        What::Item(item, _) => match &item.kind {
            ItemKind::Function(_) | ItemKind::Table(_) => kinds::FUNCTION,
            ItemKind::Unit(_) => kinds::UNIT,
            ItemKind::Binding(_) => kinds::FIELD,
            _ => kinds::CLASS,
        },
    };
    json!({
        "label": found.name().text, "kind": kind, "detail": head(index, found), "sortText": order.to_string(),
        "documentation": { "kind": "markdown", "value": about(index, found) },
    })
}

/// Modules, and the names of a module.
fn modules(index: &Index<'_>, written: &str) -> Vec<Value> {
    let path = written
        .split('{')
        .next()
        .unwrap_or("")
        .trim_end_matches('.')
        .trim();
    if let Some(number) = index.numbered(path) {
        return index
            .top(number)
            .into_iter()
            .map(|found| item(index, found, 0))
            .collect();
    }
    let begin = match path {
        "" => String::new(),
        path => format!("{path}."),
    };
    let next = index
        .paths()
        .filter_map(|module| module.strip_prefix(&begin));
    let next: BTreeSet<&str> = next.filter_map(|rest| rest.split('.').next()).collect();
    next.into_iter()
        .map(|name| json!({ "label": name, "kind": kinds::MODULE }))
        .collect()
}

/// The members of the path before a dot.
fn members(index: &Index<'_>, text: &str, place: usize) -> Vec<Value> {
    let names = names_before(text, place);
    let Some(found) = index.resolve(&names, place) else {
        return Vec::new();
    };
    let mut items: Vec<Value> = index
        .members(found)
        .into_iter()
        .map(|member| item(index, member, 0))
        .collect();
    let own = |name: &str, about: &str| json!({ "label": name, "kind": kinds::PROPERTY, "detail": about, "sortText": "1" });
    if index.is_marker(found) {
        items.extend(OF_MARKERS.iter().map(|(name, about)| own(name, about)));
    } else if let Some(ItemKind::Declaration(declaration)) = found.item().map(|item| &item.kind)
        && matches!(declaration.kind, Kind::Body | Kind::Flexible)
    {
        items.push(own("origin", "marker at the origin of the body"));
    }
    items
}

/// Whether a unit comes next: after a number and a blank, after `]` or `)` and a blank, or after `as`.
fn wants_unit(head: &str, word: &str) -> bool {
    if word.starts_with(|first: char| first.is_ascii_digit()) {
        return false;
    }
    let stripped = head.trim_end_matches([' ', '\t']);
    let blank = stripped.len() < head.len();
    let last = stripped.rsplit(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '.'));
    let last = last.into_iter().next().unwrap_or("");
    let number = last.starts_with(|first: char| first.is_ascii_digit()) && !last.contains("..");
    blank && (number || last == "as" || stripped.ends_with(']'))
}

/// All units; those of the dimension that the line states come first.
fn units(index: &Index<'_>, program: Option<&Program>, line: &str) -> Vec<Value> {
    let due = line.split_once(':').and_then(|(_, rest)| {
        let name = rest.split('=').next()?.trim();
        let resolved = &program?.typed().program;
        resolved.dimensions.get(name).map(|named| named.dimension)
    });
    let mut items = Vec::new();
    for found in index.visible(index.own()) {
        let Some(ItemKind::Unit(unit)) = found.item().map(|item| &item.kind) else {
            continue;
        };
        let known = program.and_then(|program| program.typed().program.units.get(&unit.name.text));
        let fits = due.is_some() && known.map(|unit| unit.dimension) == due;
        items.push(item(index, found, if fits { 0 } else { 1 }));
    }
    items
}

/// Parameters of the call around a place, names that the place sees, functions, words of the language.
fn words(index: &Index<'_>, text: &str, place: usize) -> Vec<Value> {
    let mut items = Vec::new();
    if let Some(callee) = call_around(text, place) {
        let class = index.resolve(&callee.names, callee.start);
        for parameter in class.into_iter().flat_map(|class| index.parameters(class)) {
            let mut argument = item(index, parameter, 0);
            let name = &parameter.name().text;
            argument["label"] = json!(format!("{name}:"));
            argument["insertText"] = json!(format!("{name}: "));
            argument["filterText"] = json!(name);
            argument["kind"] = json!(kinds::PROPERTY);
            items.push(argument);
        }
        if let [name] = callee.names.as_slice() {
            items.extend(arguments(name));
        }
    }
    let start = path_at(text, place).map_or(place, |path| path.start);
    let units =
        |found: &Found<'_>| matches!(found.item().map(|item| &item.kind), Some(ItemKind::Unit(_)));
    let scope = index
        .in_scope(start)
        .into_iter()
        .filter(|found| !units(found));
    items.extend(scope.map(|found| item(index, found, 1)));
    for (name, forms, about) in eng_compiler::functions::all_explained() {
        items.push(json!({
            "label": name, "kind": kinds::FUNCTION, "detail": forms, "documentation": about, "sortText": "2",
        }));
    }
    let word = |word: &&str| json!({ "label": word, "kind": kinds::KEYWORD, "sortText": "3" });
    items.extend(eng_grammar::WORDS.iter().map(word));
    items
}

/// The arguments of a kind of analysis or of figure.
fn arguments(name: &str) -> Vec<Value> {
    let argument = |name: &str, about: &str| {
        json!({
            "label": format!("{name}:"), "insertText": format!("{name}: "), "filterText": name,
            "kind": kinds::PROPERTY, "detail": about, "sortText": "0",
        })
    };
    if let Some(row) = eng_system::analysis::kind(name) {
        return row
            .arguments
            .iter()
            .map(|row| argument(row.name, row.about))
            .collect();
    }
    let row = eng_system::figure::kind(name);
    let rows = row.into_iter().flat_map(|row| row.arguments);
    rows.map(|row| argument(row.name, row.about)).collect()
}
