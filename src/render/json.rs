//! Messages as JSON for tools.

use super::visible::visible_json;
use super::{count, inside, shown};
use eng_grammar::{Diagnostic, Diagnostics, Severity, SourceMap, Span};
use serde::Serialize;

/// The document that [`json`] prints, version 1.
///
/// ```text
/// { "version": 1,
///   "errors": 1, "warnings": 0, "notes": 0, "more": 0,
///   "diagnostics": [
///     { "severity": "error" | "warning" | "note", "code": "E0312", "title": "…",
///       PLACE of the first primary label (else of the first label),
///       "labels": [ { PLACE, "message": "…", "primary": true } ],
///       "notes": ["…"], "help": ["…"],
///       "fixes": [ { PLACE, "title": "…", "replacement": "…" } ] } ] }
/// ```
///
/// `"diagnostics"` holds at most a hundred messages, errors before warnings, and `"more"` is the number of
/// the others. The three counts include all messages. `eng check --positions` adds
/// [`"positions"`](crate::assembled::json_with_positions).
///
/// PLACE is `"file"`, `"line"`, `"column"`, `"end_line"`, `"end_column"`, `"start"`, `"end"`: lines and
/// columns count from 1, columns in characters; start and end are bytes from 0 in UTF-8, the end is
/// exclusive. All are `null` without a place. Fields may be added within a version; none changes its
/// meaning.
#[derive(Debug, Serialize)]
pub struct Document<'a> {
    version: u32,
    errors: usize,
    warnings: usize,
    notes: usize,
    more: usize,
    diagnostics: Vec<Message<'a>>,
}

#[derive(Debug, Serialize)]
struct Message<'a> {
    severity: Severity,
    code: &'a str,
    title: &'a str,
    #[serde(flatten)]
    place: Place<'a>,
    labels: Vec<LabelEntry<'a>>,
    notes: &'a [String],
    help: &'a [String],
    fixes: Vec<FixEntry<'a>>,
}

#[derive(Debug, Default, Serialize)]
struct Place<'a> {
    file: Option<&'a str>,
    line: Option<usize>,
    column: Option<usize>,
    end_line: Option<usize>,
    end_column: Option<usize>,
    start: Option<usize>,
    end: Option<usize>,
}

#[derive(Debug, Serialize)]
struct LabelEntry<'a> {
    #[serde(flatten)]
    place: Place<'a>,
    message: &'a str,
    primary: bool,
}

#[derive(Debug, Serialize)]
struct FixEntry<'a> {
    #[serde(flatten)]
    place: Place<'a>,
    title: &'a str,
    replacement: &'a str,
}

/// The messages as a value to serialise.
pub fn document<'a>(diagnostics: &'a Diagnostics, sources: &'a SourceMap) -> Document<'a> {
    let shown = shown(diagnostics);
    Document {
        version: 1,
        errors: count(diagnostics, Severity::Error),
        warnings: count(diagnostics, Severity::Warning),
        notes: count(diagnostics, Severity::Note),
        more: diagnostics.len() - shown.len(),
        diagnostics: shown.into_iter().map(|d| message(d, sources)).collect(),
    }
}

/// The messages as JSON text, described at [`Document`], with a line end.
pub fn json(diagnostics: &Diagnostics, sources: &SourceMap) -> String {
    text(&document(diagnostics, sources))
}

/// A document as JSON text with a line end. Characters that would act on a terminal are escaped.
pub(crate) fn text(document: &impl Serialize) -> String {
    // strings and numbers alone: serialising cannot fail
    let text = serde_json::to_string_pretty(document).unwrap_or_default();
    let mut text = visible_json(&text).into_owned();
    text.push('\n');
    text
}

fn message<'a>(diagnostic: &'a Diagnostic, sources: &'a SourceMap) -> Message<'a> {
    let labels = &diagnostic.labels;
    let main = labels.iter().find(|l| l.primary).or(labels.first());
    Message {
        severity: diagnostic.severity,
        code: diagnostic.code,
        title: &diagnostic.title,
        place: main.map_or_else(Place::default, |l| place(l.span, sources)),
        labels: labels
            .iter()
            .map(|label| LabelEntry {
                place: place(label.span, sources),
                message: &label.message,
                primary: label.primary,
            })
            .collect(),
        notes: &diagnostic.notes,
        help: &diagnostic.help,
        fixes: diagnostic
            .fixes
            .iter()
            .map(|fix| FixEntry {
                place: place(fix.span, sources),
                title: &fix.title,
                replacement: &fix.replacement,
            })
            .collect(),
    }
}

fn place(span: Span, sources: &SourceMap) -> Place<'_> {
    let (Some(source), Some(range)) = (sources.get(span.source), inside(sources, span)) else {
        return Place::default();
    };
    let (line, column) = sources.line_column(span.source, range.start as u32).unzip();
    let (end_line, end_column) = sources.line_column(span.source, range.end as u32).unzip();
    Place {
        file: Some(&source.name),
        line,
        column,
        end_line,
        end_column,
        start: Some(range.start),
        end: Some(range.end),
    }
}
