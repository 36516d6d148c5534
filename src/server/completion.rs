//! Words that may come next.

use super::channels::Channels;
use super::document::Document;
use super::due::{begins_argument, dimension_at};
use super::hover::{about, head};
use super::index::{Found, Index, OF_MARKERS, What, is_kind};
use super::place::{call_around, is_quiet, names_before, path_at};
use crate::Program;
use eng_compiler::program::{DefinitionId, ValueType};
use eng_compiler::typed::TypedProgram;
use eng_grammar::ast::{BindingKind, Declaration, Form, ItemKind, Kind};
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

/// What the checks of a text have found.
#[derive(Clone, Copy)]
pub(super) struct Known<'k> {
    /// The last program without errors.
    pub program: Option<&'k Program>,
    /// The recorded channels of this program.
    pub channels: &'k Channels,
    /// The types of the last text that was checked.
    pub typed: Option<&'k TypedProgram>,
}

/// The words that may come next at a place.
pub(super) fn completion(
    index: &Index<'_>,
    document: &Document,
    known: Known<'_>,
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
        members(index, known, &document.text, place - word)
    } else if wants_unit(head, &line[line.len() - word..]) {
        units(index, known.typed, &document.text, place)
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

/// The elements of a model, which have channels.
const ELEMENTS: [Kind; 5] = [
    Kind::Joint,
    Kind::Force,
    Kind::Journal,
    Kind::Drive,
    Kind::Part,
];

fn own(name: &str, about: &str) -> Value {
    json!({ "label": name, "kind": kinds::PROPERTY, "detail": about, "sortText": "1" })
}

fn components(count: usize) -> Vec<Value> {
    let names = ["x", "y", "z"].into_iter().take(count);
    names.map(|name| own(name, "a component")).collect()
}

fn of_marker() -> impl Iterator<Item = Value> {
    OF_MARKERS.iter().map(|(name, about)| own(name, about))
}

/// The names that can be read after the path before a dot.
fn members(index: &Index<'_>, known: Known<'_>, text: &str, place: usize) -> Vec<Value> {
    let names = names_before(text, place);
    let Some((last, base)) = names.split_last() else {
        return Vec::new();
    };
    let analysis = names.first().and_then(|first| {
        let found = index.resolve(std::slice::from_ref(first), place);
        found.filter(|found| is_kind(*found, &[Kind::Analysis]))
    });
    if analysis.is_some() {
        return recorded(index, known, &names, place);
    }
    let Some(found) = index.resolve(&names, place) else {
        let base = index.resolve(base, place);
        return match (base, last.as_str()) {
            (None, "cycle") if names.len() == 1 => vec![
                own("angle", "the angle that counts turns"),
                own("period", "the angle of one cycle"),
            ],
            (None, "ground") if names.len() == 1 => of_marker().collect(),
            (Some(base), "force" | "torque") if index.has_reaction(base) => components(3),
            (Some(base), "origin") if is_kind(base, &[Kind::Body, Kind::Flexible]) => {
                of_marker().collect()
            }
            _ => Vec::new(),
        };
    };
    if is_definition(found) {
        return Vec::new();
    }
    let members = index.members(found).into_iter();
    let mut items: Vec<Value> = members.map(|member| item(index, member, 0)).collect();
    items.extend(built_in(index, found));
    let output = matches!(found.item().map(|item| &item.kind),
        Some(ItemKind::Binding(binding)) if binding.kind == BindingKind::Output);
    match known.typed.and_then(|typed| type_of(index, typed, found)) {
        // an output has the axes that its class states; other vectors have none
        Some(ValueType::Vector(_)) if output => items.extend(components(3)),
        Some(ValueType::Components(count, _)) if *count <= 3 => {
            items.extend(components(*count as usize));
        }
        _ => {}
    }
    items
}

/// Whether a definition is a class or a model itself, which has nothing to read.
fn is_definition(found: Found<'_>) -> bool {
    let class = |declaration: &Declaration| matches!(declaration.form, Form::Class { .. });
    let kinds = [
        Kind::Model,
        Kind::Component,
        Kind::Interface,
        Kind::Record,
        Kind::Default,
    ];
    match found.item().map(|item| &item.kind) {
        Some(ItemKind::Declaration(declaration)) => class(declaration) || is_kind(found, &kinds),
        _ => false,
    }
}

/// The names of the language that can be read after a definition.
fn built_in(index: &Index<'_>, found: Found<'_>) -> Vec<Value> {
    if index.is_marker(found) {
        return of_marker().collect();
    }
    if index.has_reaction(found) {
        return vec![
            own("force", "force on the first marker"),
            own("torque", "torque on the first marker"),
        ];
    }
    let Some(ItemKind::Declaration(body)) = found.item().map(|item| &item.kind) else {
        return Vec::new();
    };
    let states = |name: &str| {
        let mut items = body.block().into_iter().flat_map(|block| &block.items);
        items.any(|item| matches!(&item.kind, ItemKind::Attribute(one) if one.name.text == name))
    };
    let mut items = Vec::new();
    if matches!(body.kind, Kind::Body | Kind::Flexible) {
        items.push(own("origin", "marker at the origin of the body"));
    }
    if body.kind == Kind::Body && states("mass") {
        items.push(own("mass", "mass of the body"));
    }
    if body.kind == Kind::Flexible && states("support") {
        items.push(own(
            "support",
            "the joint that holds the body on the ground",
        ));
    }
    items
}

/// The type of a named value in the checked texts.
fn type_of<'t>(
    index: &Index<'_>,
    typed: &'t TypedProgram,
    found: Found<'_>,
) -> Option<&'t ValueType> {
    let place = found.name_span().start;
    let module = index.module(found.module)?;
    let mut around = module.file.items.iter();
    let around = around.find(|item| item.span.start <= place && place < item.span.end)?;
    let name = around.kind.name()?;
    let modules = &typed.program.modules;
    let number = match found.module == index.own() {
        true => typed.program.root() as usize,
        false => modules.iter().position(|other| other.path == module.path)?,
    };
    let mut items = modules.get(number)?.file.items.iter();
    let same = |other: &eng_grammar::ast::Name| other.text == name.text;
    let item = items.position(|item| item.kind.name().is_some_and(same))?;
    let definition = DefinitionId {
        module: number as u32,
        item: item as u32,
    };
    let member = match name.span == found.name_span() {
        true => "",
        false => found.name().text.as_str(),
    };
    typed.of(definition, member)
}

/// The names that come next on the path of a recorded channel: those of the last program without errors, otherwise
/// those of the text.
fn recorded(index: &Index<'_>, known: Known<'_>, names: &[String], place: usize) -> Vec<Value> {
    let Some((analysis, path)) = names.split_first() else {
        return Vec::new();
    };
    let of_program = |program| known.channels.next_names(program, analysis, path);
    if let Some(next) = known.program.and_then(of_program) {
        let next = next.into_iter();
        return next
            .map(|(name, unit)| match unit {
                Some(unit) => own(&name, &format!("recorded in {unit}")),
                None => own(&name, "has channels"),
            })
            .collect();
    }
    let Some(found) = index.resolve(names, place) else {
        return Vec::new();
    };
    let has_channels = |member: &Found<'_>| match member.item().map(|item| &item.kind) {
        Some(ItemKind::Binding(binding)) => binding.kind == BindingKind::Output,
        _ => is_kind(*member, &ELEMENTS),
    };
    let members = index.members(found).into_iter().filter(has_channels);
    let mut items: Vec<Value> = members.map(|member| item(index, member, 0)).collect();
    if index.has_reaction(found) {
        items.extend(built_in(index, found));
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

/// All units; those of the dimension that the argument or the line needs come first.
fn units(index: &Index<'_>, typed: Option<&TypedProgram>, text: &str, place: usize) -> Vec<Value> {
    let resolved = typed.map(|typed| &typed.program);
    let due = resolved.and_then(|resolved| dimension_at(index, resolved, text, place));
    let mut items = Vec::new();
    for found in index.visible(index.own()) {
        let Some(ItemKind::Unit(unit)) = found.item().map(|item| &item.kind) else {
            continue;
        };
        let known = resolved.and_then(|resolved| resolved.units.get(&unit.name.text));
        let fits = due.is_some() && known.map(|unit| unit.dimension) == due;
        items.push(item(index, found, if fits { 0 } else { 1 }));
    }
    items
}

/// Parameters of the call around a place, names that the place sees, functions, words of the language.
fn words(index: &Index<'_>, text: &str, place: usize) -> Vec<Value> {
    let mut items = Vec::new();
    if let Some(callee) = call_around(text, place).filter(|_| begins_argument(text, place)) {
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
