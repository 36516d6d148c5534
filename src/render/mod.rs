//! Diagnostics as text for people and as JSON for tools.
//!
//! This module contains the form of messages. It makes no messages and prints nothing.

pub(crate) mod excerpt;
mod human;
mod json;
pub(crate) mod visible;

pub use human::{Colors, human};
pub(crate) use json::text;
pub use json::{Document, document, json};
pub(crate) use visible::{visible, visible_name};

use eng_grammar::{Diagnostic, Diagnostics, Severity, SourceMap, Span};

/// Most messages that are shown. The others are counted. A choice: nobody reads more at once.
const MOST: usize = 100;

/// The messages to show, in their order. If there are more than [`MOST`], errors come before warnings.
fn shown(diagnostics: &Diagnostics) -> Vec<&Diagnostic> {
    let mut ranked: Vec<(usize, &Diagnostic)> = diagnostics.iter().enumerate().collect();
    if ranked.len() > MOST {
        ranked.sort_by_key(|(at, d)| (d.severity, *at));
        ranked.truncate(MOST);
        ranked.sort_by_key(|(at, _)| *at);
    }
    ranked.into_iter().map(|(_, d)| d).collect()
}

/// Moves a span onto character boundaries inside its text; `None` if its source is not in the map.
fn inside(sources: &SourceMap, span: Span) -> Option<std::ops::Range<usize>> {
    let text = &sources.get(span.source)?.text;
    let start = text.floor_char_boundary(span.start as usize);
    let end = text.ceil_char_boundary(span.end as usize).max(start);
    Some(start..end)
}

/// Number of messages of one severity.
fn count(diagnostics: &Diagnostics, severity: Severity) -> usize {
    diagnostics
        .iter()
        .filter(|d| d.severity == severity)
        .count()
}
