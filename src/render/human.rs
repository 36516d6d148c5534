//! Messages with the lines of the text.

use super::excerpt::{Excerpt, Excerpts};
use super::visible::visible;
use super::{count, inside, shown};
use codespan_reporting::diagnostic as codespan;
use codespan_reporting::term::termcolor::Buffer;
use codespan_reporting::term::{self, Config};
use eng_grammar::{Diagnostic, Diagnostics, Fix, Severity, SourceId, SourceMap};
use std::collections::BTreeMap;
use std::ops::Range;

/// Whether escape sequences for colours are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colors {
    /// ANSI escape sequences.
    Ansi,
    /// Plain text.
    None,
}

/// The messages, then a line with their number; empty without messages. At most a hundred are shown, errors
/// before warnings.
pub fn human(diagnostics: &Diagnostics, sources: &SourceMap, colors: Colors) -> String {
    let config = Config::default();
    let mut text = String::new();
    let shown = shown(diagnostics);
    for diagnostic in &shown {
        let files = excerpts(diagnostic, sources);
        let message = translate(diagnostic, sources, &files);
        let files = Excerpts(files.into_iter().map(|(_, excerpt)| excerpt).collect());
        let mut buffer = match colors {
            Colors::Ansi => Buffer::ansi(),
            Colors::None => Buffer::no_color(),
        };
        match term::emit_to_write_style(&mut buffer, &config, &files, &message) {
            Ok(()) => text.push_str(&String::from_utf8_lossy(buffer.as_slice())),
            Err(_) => text.push_str(&without_source(diagnostic)),
        }
    }
    if !diagnostics.is_empty() {
        match diagnostics.len() - shown.len() {
            0 => {}
            more => text.push_str(&format!("… and {more} more messages\n")),
        }
        text.push_str(&summary(diagnostics));
        text.push('\n');
    }
    // codespan fills lines up to its longest label
    text.lines()
        .flat_map(|line| [line.trim_end(), "\n"])
        .collect()
}

/// `2 errors, 1 warning`; notes are not counted.
fn summary(diagnostics: &Diagnostics) -> String {
    let counted = |severity, singular: &str| match count(diagnostics, severity) {
        1 => format!("1 {singular}"),
        n => format!("{n} {singular}s"),
    };
    format!(
        "{}, {}",
        counted(Severity::Error, "error"),
        counted(Severity::Warning, "warning")
    )
}

/// The texts that a message shows.
fn excerpts<'s>(diagnostic: &Diagnostic, sources: &'s SourceMap) -> Vec<(SourceId, Excerpt<'s>)> {
    let mut places: BTreeMap<SourceId, Vec<Range<usize>>> = BTreeMap::new();
    for label in &diagnostic.labels {
        if let Some(range) = inside(sources, label.span) {
            places.entry(label.span.source).or_default().push(range);
        }
    }
    places
        .into_iter()
        .filter_map(|(id, places)| {
            let source = sources.get(id)?;
            Some((id, Excerpt::new(&source.name, &source.text, &places)))
        })
        .collect()
}

fn translate(
    diagnostic: &Diagnostic,
    sources: &SourceMap,
    files: &[(SourceId, Excerpt<'_>)],
) -> codespan::Diagnostic<usize> {
    let severity = match diagnostic.severity {
        Severity::Error => codespan::Severity::Error,
        Severity::Warning => codespan::Severity::Warning,
        Severity::Note => codespan::Severity::Note,
    };
    let mut labels = Vec::new();
    let mut notes = Vec::new();
    for label in &diagnostic.labels {
        let file = files.iter().position(|(id, _)| *id == label.span.source);
        let excerpt = file.and_then(|file| files.get(file));
        match (file, excerpt, inside(sources, label.span)) {
            (Some(file), Some((_, excerpt)), Some(range)) => {
                let range = excerpt.place(range.start)..excerpt.place(range.end);
                let style = if label.primary {
                    codespan::LabelStyle::Primary
                } else {
                    codespan::LabelStyle::Secondary
                };
                labels.push(
                    codespan::Label::new(style, file, range)
                        .with_message(shortened(&label.message)),
                );
            }
            _ => notes.push(bullet("note", &label.message)),
        }
    }
    notes.extend(diagnostic.notes.iter().map(|note| bullet("note", note)));
    notes.extend(diagnostic.help.iter().map(|help| bullet("help", help)));
    notes.extend(
        diagnostic
            .fixes
            .iter()
            .map(|fix| bullet("help", &fix_text(fix, diagnostic, sources))),
    );
    codespan::Diagnostic::new(severity)
        .with_code(diagnostic.code)
        .with_message(shortened(&diagnostic.title))
        .with_labels(labels)
        .with_notes(notes)
}

/// Lines after the first are aligned with the text.
fn bullet(kind: &str, text: &str) -> String {
    format!("{kind}: {}", shortened(text).replace('\n', "\n      "))
}

/// Largest number of characters of a title or note. A choice: longer ones quote data.
const LONGEST: usize = 1000;

/// A text of a message. Control characters are escaped, and the middle of a very long text is left out.
fn shortened(text: &str) -> String {
    let text = visible(text);
    let count = text.chars().count();
    if count <= LONGEST {
        return text.into_owned();
    }
    let begin: String = text.chars().take(LONGEST / 2).collect();
    let end: String = text.chars().skip(count - LONGEST / 2).collect();
    format!("{begin}…{end}")
}

fn fix_text(fix: &Fix, diagnostic: &Diagnostic, sources: &SourceMap) -> String {
    let old = sources.text(fix.span);
    let change = match (old.is_empty(), fix.replacement.is_empty()) {
        (false, false) => format!("replace {} with {}", code(old), code(&fix.replacement)),
        (false, true) => format!("remove {}", code(old)),
        (true, _) => match sources.line_column(fix.span.source, fix.span.start) {
            Some((line, column)) => {
                format!("insert {} at {line}:{column}", code(&fix.replacement))
            }
            None => format!("insert {}", code(&fix.replacement)),
        },
    };
    if fix.title.is_empty() {
        change
    } else if fix.title.contains(&code(&fix.replacement))
        && diagnostic.labels.iter().any(|label| label.span == fix.span)
    {
        // the place is marked, and the title states the text to write there
        fix.title.clone()
    } else {
        format!("{}: {change}", fix.title)
    }
}

fn code(text: &str) -> String {
    if text.contains('\n') {
        format!("\n{text}\n")
    } else {
        format!("`{text}`")
    }
}

fn without_source(diagnostic: &Diagnostic) -> String {
    let severity = match diagnostic.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    let title = shortened(&diagnostic.title);
    let mut text = format!("{severity}[{}]: {title}\n", diagnostic.code);
    let labels = diagnostic.labels.iter().map(|label| &label.message);
    for line in labels.chain(&diagnostic.notes).chain(&diagnostic.help) {
        text.push_str(&format!("  = {}\n", shortened(line)));
    }
    text
}
