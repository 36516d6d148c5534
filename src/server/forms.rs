//! The form of `eng fmt`, for a text and for the items in a range of it.

use super::document::{Document, range};
use eng_compiler::resolve::lone_return;
use eng_grammar::ast::Item;
use eng_grammar::{Diagnostics, SourceId, format, parse};
use serde_json::{Value, json};

/// A text in its form, as `eng fmt` gives it; none for a text that cannot be read.
fn form(text: &str) -> Option<String> {
    let readable = lone_return(text).is_none();
    readable.then(|| format(text, SourceId(0)).ok())?
}

/// The change that gives a text its form; none for a text with mistakes.
pub(super) fn formed(document: &Document) -> Value {
    match form(&document.text) {
        Some(formed) if formed != document.text => {
            let range = range(&document.text, 0, document.text.len());
            json!([{ "range": range, "newText": formed }])
        }
        _ => json!([]),
    }
}

/// The changes that give the items in a range their form.
pub fn formed_range(document: &Document, wanted: &Value) -> Value {
    let text = document.text.as_str();
    let Some(formed) = form(text) else {
        return json!([]);
    };
    let tree = |text: &str| parse(text, SourceId(0), &mut Diagnostics::new());
    let (start, end) = (
        document.byte(&wanted["start"]),
        document.byte(&wanted["end"]),
    );
    let mut edits = Vec::new();
    let texts = (text, formed.as_str());
    let (before, after) = (tree(text), tree(&formed));
    let items = (before.items.as_slice(), after.items.as_slice());
    collect(texts, items, (start, end), &mut edits);
    Value::Array(edits)
}

/// The edits of the items that meet a range. Both trees are the same but for places.
fn collect(
    (text, formed): (&str, &str),
    (before, after): (&[Item], &[Item]),
    (start, end): (usize, usize),
    edits: &mut Vec<Value>,
) {
    for (old, new) in before.iter().zip(after) {
        let of = |item: &Item| (item.span.start as usize, item.span.end as usize);
        let (old_span, new_span) = (of(old), of(new));
        if old_span.1 < start || end < old_span.0 {
            continue;
        }
        let blocks = (old.kind.block(), new.kind.block());
        if let (Some(inside), Some(inside_after)) = blocks
            && (inside.span.start as usize) < start
            && end < inside.span.end as usize
        {
            let items = (inside.items.as_slice(), inside_after.items.as_slice());
            collect((text, formed), items, (start, end), edits);
            continue;
        }
        let (mut from, mut new_from) = (old_span.0, new_span.0);
        // with its indent, unless another item is before it in its line
        if let (Some(line), Some(new_line)) = (line(text, from), line(formed, new_from)) {
            (from, new_from) = (line, new_line);
        }
        let piece = formed.get(new_from..new_span.1).unwrap_or("");
        if text.get(from..old_span.1) != Some(piece) {
            edits.push(json!({ "range": range(text, from, old_span.1), "newText": piece }));
        }
    }
}

/// The start of the line of a byte, if only blanks are before it.
fn line(text: &str, byte: usize) -> Option<usize> {
    let before = text.get(..byte)?;
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    let blank = before.get(start..)?.trim().is_empty();
    blank.then_some(start)
}
