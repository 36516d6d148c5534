//! Hints beside a text: the types of values that state none, and the command that runs an analysis.

use super::document::{Document, position, range};
use eng_compiler::program::{DefinitionId, Program, ValueType};
use eng_compiler::typed::TypedProgram;
use eng_grammar::ast::{Binding, Expr, ExprKind, File, Item, ItemKind, Kind};
use eng_grammar::{Diagnostics, SourceId, parse};
use eng_system::Dimension;
use serde_json::{Value, json};

fn tree(document: &Document) -> File {
    parse(&document.text, SourceId(0), &mut Diagnostics::new())
}

/// The types of the values in a range whose text states neither a type nor a unit.
pub(super) fn hints(document: &Document, typed: Option<&TypedProgram>, wanted: &Value) -> Value {
    let Some(typed) = typed else {
        return json!([]);
    };
    let (start, end) = (
        document.byte(&wanted["start"]),
        document.byte(&wanted["end"]),
    );
    let mut hints = Vec::new();
    for item in &tree(document).items {
        let Some(definition) = definition(&typed.program, item) else {
            continue;
        };
        let inner = item.kind.block().map_or(&[][..], |block| &block.items);
        let own = bindings(std::slice::from_ref(item)).map(|binding| (binding, ""));
        let inner = bindings(inner).map(|binding| (binding, binding.name.text.as_str()));
        for (binding, name) in own.chain(inner) {
            let place = after_name(&document.text, binding);
            if place < start || end < place || is_plain(binding) {
                continue;
            }
            let ty = typed.of(definition, name);
            if let Some(label) = ty.and_then(|ty| words(&typed.program, ty)) {
                hints.push(json!({
                    "position": position(&document.text, place), "label": format!(": {label}"), "kind": 1,
                }));
            }
        }
    }
    Value::Array(hints)
}

/// The definition with the name of an item in the checked text, which may be an earlier one.
fn definition(program: &Program, item: &Item) -> Option<DefinitionId> {
    let module = program.root();
    let name = &item.kind.name()?.text;
    let file = &program.modules.get(module as usize)?.file;
    let mut names = file.items.iter().map(|item| item.kind.name());
    let item = names.position(|other| other.is_some_and(|other| other.text == *name))?;
    Some(DefinitionId {
        module,
        item: item as u32,
    })
}

fn bindings(items: &[Item]) -> impl Iterator<Item = &Binding> {
    items.iter().filter_map(|item| match &item.kind {
        ItemKind::Binding(binding) => Some(binding),
        _ => None,
    })
}

/// The byte after the name and the index of a value.
fn after_name(text: &str, binding: &Binding) -> usize {
    let Some(last) = binding.index.last() else {
        return binding.name.span.end as usize;
    };
    let end = last.range.span.end as usize;
    let bracket = text.get(end..).and_then(|rest| rest.find(']'));
    bracket.map_or(end, |bracket| end + bracket + 1)
}

/// Whether the text of a value states its type or its unit.
fn is_plain(binding: &Binding) -> bool {
    fn shown(value: &Expr) -> bool {
        match &value.kind {
            ExprKind::Number { .. } | ExprKind::Text(_) | ExprKind::Bool(_) => true,
            ExprKind::List { unit, .. }
            | ExprKind::Comprehension { unit, .. }
            | ExprKind::Paren { unit, .. } => unit.is_some(),
            ExprKind::Unary { operand, .. } => shown(operand),
            _ => false,
        }
    }
    binding.ty.is_some() || binding.display.is_some() || binding.value.as_ref().is_none_or(shown)
}

/// A type in words: `Length`, `Vector<Force>`; a dimension without a name of its own in SI units.
fn words(program: &Program, ty: &ValueType) -> Option<String> {
    Some(match ty {
        ValueType::Scalar(of) => dimension(program, *of),
        ValueType::Vector(of) => format!("Vector<{}>", dimension(program, *of)),
        ValueType::Components(count, of) => format!("{}[{count}]", dimension(program, *of)),
        ValueType::Int => "Int".to_owned(),
        ValueType::Bool => "Bool".to_owned(),
        ValueType::Text => "Text".to_owned(),
        ValueType::Marker => "Marker".to_owned(),
        ValueType::Choice(choice) => program.item(*choice)?.kind.name()?.text.clone(),
        ValueType::Array(element) => format!("{}[]", words(program, element)?),
        ValueType::Other => return None,
    })
}

/// The name of a dimension, if it has exactly one.
fn dimension(program: &Program, of: Dimension) -> String {
    let named = program.dimensions.iter();
    let mut named = named.filter(|(_, named)| named.dimension == of && named.point_of.is_none());
    match (named.next(), named.next()) {
        (Some((name, _)), None) => name.clone(),
        _ => of.to_string(),
    }
}

/// A command above each analysis of a file: the client runs it.
pub(super) fn lenses(document: &Document) -> Value {
    let file = tree(document);
    let analyses = file.items.iter().filter_map(|item| match &item.kind {
        ItemKind::Declaration(declaration) if declaration.kind == Kind::Analysis => {
            Some(&declaration.name)
        }
        _ => None,
    });
    let analyses = analyses.filter(|_| document.path.is_some());
    let lenses = analyses.map(|name| {
        let (start, end) = (name.span.start as usize, name.span.end as usize);
        let command = json!({
            "title": "run", "command": "eng.run", "arguments": [document.uri, name.text],
        });
        json!({ "range": range(&document.text, start, end), "command": command })
    });
    Value::Array(lenses.collect())
}
