//! The meaning of a name: its line of the text, its comment, and the numbers of its path.

use super::document::{Document, range};
use super::index::{Found, Index, What};
use super::place::path_at;
use crate::Program;
use eng_grammar::ast::ItemKind;
use serde_json::{Value, json};

pub(super) fn hover(
    index: &Index<'_>,
    document: &Document,
    program: Option<&Program>,
    place: usize,
) -> Option<Value> {
    let path = path_at(&document.text, place)?;
    let found = index.resolve(&path.names, place);
    let mut parts: Vec<String> = found.into_iter().map(|found| about(index, found)).collect();
    // a local name may be that of a part of the model
    let explained = program.and_then(|program| program.explain(&path.written).ok());
    if let Some(text) = explained.or_else(|| program?.explain(&path.names.join(".")).ok()) {
        parts.push(format!("```text\n{}\n```", text.trim_end()));
    }
    if parts.is_empty() {
        parts.extend(built_in(&path.names));
    }
    if parts.is_empty() {
        return None;
    }
    Some(json!({
        "contents": { "kind": "markdown", "value": parts.join("\n\n") },
        "range": range(&document.text, path.start, path.end),
    }))
}

/// The first line of a definition and its comment.
pub(super) fn about(index: &Index<'_>, found: Found<'_>) -> String {
    let mut text = format!("```eng\n{}\n```", head(index, found));
    let docs = match found.what {
        What::Item(item, _) => item.docs.as_slice(),
        What::Parameter(parameter) => parameter.docs.as_slice(),
        What::Name(_) => &[],
    };
    if !docs.is_empty() {
        text.push_str(&format!("\n\n{}", docs.join("\n")));
    }
    text
}

/// A definition without its block and its comment, in one line.
pub(super) fn head(index: &Index<'_>, found: Found<'_>) -> String {
    let Some(module) = index.module(found.module) else {
        return String::new();
    };
    let span = match found.what {
        What::Item(item, _) => item.span,
        What::Parameter(parameter) => parameter.span,
        What::Name(name) => name.span,
    };
    let written =
        |start: u32, end: u32| module.text.get(start as usize..end as usize).unwrap_or("");
    let text = match found.item().map(|item| &item.kind) {
        Some(ItemKind::Declaration(declaration)) => match declaration.block() {
            Some(block) => written(declaration.kind_span.start, block.span.start),
            None => written(declaration.kind_span.start, span.end),
        },
        Some(ItemKind::Report(report)) => written(report.word.start, report.block.span.start),
        _ => written(span.start, span.end),
    };
    let lines = text.lines().map(str::trim);
    let lines = lines.filter(|line| !line.starts_with("//") && !line.is_empty());
    lines.collect::<Vec<_>>().join(" ")
}

/// A function of the language, a kind of analysis or a kind of figure.
fn built_in(names: &[String]) -> Option<String> {
    let [name] = names else { return None };
    if let Some((forms, about)) = eng_compiler::functions::explained(name) {
        return Some(format!("```eng\n{forms}\n```\n\n{about}"));
    }
    if let Some(row) = eng_system::analysis::kind(name) {
        let mut text = format!("analysis `{name}`: {}\n", row.about);
        for argument in row.arguments {
            text.push_str(&format!("\n- `{}`: {}", argument.name, argument.about));
        }
        return Some(text);
    }
    let row = eng_system::figure::kind(name)?;
    let mut text = format!("figure `{name}`: {}\n", row.about);
    for argument in row.arguments {
        text.push_str(&format!("\n- `{}`: {}", argument.name, argument.about));
    }
    Some(text)
}
