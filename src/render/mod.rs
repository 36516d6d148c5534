//! Diagnostics as text for people and as JSON for tools.
//!
//! May contain: the form of messages. Must not contain: their making, nor printing.

mod excerpt;
mod human;
mod json;
mod visible;

pub use human::{Colors, human};
pub(crate) use json::text;
pub use json::{Document, document, json};
pub(crate) use visible::visible;

use eng_grammar::{Severity, SourceMap, Span};

/// Moves a span onto character boundaries inside its text; `None` where its source is not of the map.
fn inside(sources: &SourceMap, span: Span) -> Option<std::ops::Range<usize>> {
    let text = &sources.get(span.source)?.text;
    let start = text.floor_char_boundary(span.start as usize);
    let end = text.ceil_char_boundary(span.end as usize).max(start);
    Some(start..end)
}

/// How many messages of one severity.
fn count(diagnostics: &eng_grammar::Diagnostics, severity: Severity) -> usize {
    diagnostics
        .iter()
        .filter(|d| d.severity == severity)
        .count()
}
