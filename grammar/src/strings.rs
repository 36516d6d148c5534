//! Texts in quotes: their escapes.

use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::span::Span;

/// Resolves `\"`, `\\`, `\n` and `\t`. Other escapes remain, and their places are returned.
pub(crate) fn unescape(raw: &str) -> (String, Vec<usize>) {
    let mut text = String::with_capacity(raw.len());
    let mut unknown = Vec::new();
    let mut characters = raw.char_indices();
    while let Some((at, character)) = characters.next() {
        if character != '\\' {
            text.push(character);
            continue;
        }
        match characters.next() {
            Some((_, '"')) => text.push('"'),
            Some((_, '\\')) => text.push('\\'),
            Some((_, 'n')) => text.push('\n'),
            Some((_, 't')) => text.push('\t'),
            other => {
                unknown.push(at);
                text.push('\\');
                text.extend(other.map(|(_, character)| character));
            }
        }
    }
    (text, unknown)
}

/// The message for `\q`.
pub(crate) fn unknown_escape(span: Span) -> Diagnostic {
    Diagnostic::error(codes::TEXT, "a text has an escape that does not exist")
        .at(span, "unknown")
        .with_help("the escapes are `\\\"`, `\\\\`, `\\n` and `\\t`")
}
