//! Messages in the form of the protocol, and the changes that they propose.

use super::document::range;
use eng_grammar::{Diagnostic, Diagnostics, Severity, SourceMap, Span};
use serde_json::{Value, json};

/// A change of the text that a message proposes.
pub(super) struct Change {
    range: Value,
    title: String,
    text: String,
    /// The message, as it was sent.
    diagnostic: Value,
}

/// Messages of one text.
pub(super) struct Messages {
    pub diagnostics: Vec<Value>,
    pub changes: Vec<Change>,
}

impl Messages {
    /// The messages about a check of the file `name`. A message about another file is at the start of the text.
    pub fn of(found: &Diagnostics, texts: &SourceMap, name: &str, uri: &str) -> Messages {
        let mut messages = Messages {
            diagnostics: Vec::new(),
            changes: Vec::new(),
        };
        for message in found.iter() {
            let diagnostic = converted(message, texts, name, uri);
            for fix in &message.fixes {
                let source = texts.get(fix.span.source);
                if let Some(source) = source.filter(|source| source.name == name) {
                    messages.changes.push(Change {
                        range: of_span(&source.text, fix.span),
                        title: fix.title.clone(),
                        text: fix.replacement.clone(),
                        diagnostic: diagnostic.clone(),
                    });
                }
            }
            messages.diagnostics.push(diagnostic);
        }
        messages
    }

    /// The message of a fault of the program.
    pub fn internal(words: &str) -> Messages {
        let text = format!(
            "the check of this text failed: {words}; this is a fault of Eng, please report it"
        );
        Messages {
            diagnostics: vec![json!({
                "range": range("", 0, 0), "severity": 1, "source": "eng", "message": text,
            })],
            changes: Vec::new(),
        }
    }
}

fn of_span(text: &str, span: Span) -> Value {
    range(text, span.start as usize, span.end as usize)
}

fn converted(message: &Diagnostic, texts: &SourceMap, name: &str, uri: &str) -> Value {
    let mut text = message.title.clone();
    let own = |span: Span| texts.get(span.source).filter(|source| source.name == name);
    let primary = message.labels.iter().find(|label| label.primary);
    let primary = primary.or(message.labels.first());
    let mut at = range("", 0, 0);
    let mut related = Vec::new();
    for label in &message.labels {
        match own(label.span) {
            Some(source) if primary.is_some_and(|primary| primary == label) => {
                at = of_span(&source.text, label.span);
                if !label.message.is_empty() {
                    text.push_str(&format!("\n{}", label.message));
                }
            }
            Some(source) => related.push(json!({
                "location": { "uri": uri, "range": of_span(&source.text, label.span) },
                "message": label.message,
            })),
            None => {
                let place = texts.line_column(label.span.source, label.span.start);
                if let (Some(source), Some((line, _))) = (texts.get(label.span.source), place) {
                    text.push_str(&format!("\n{}:{line}: {}", source.name, label.message));
                }
            }
        }
    }
    for note in &message.notes {
        text.push_str(&format!("\nnote: {note}"));
    }
    for help in &message.help {
        text.push_str(&format!("\nhelp: {help}"));
    }
    let severity = match message.severity {
        Severity::Error => 1,
        Severity::Warning => 2,
        Severity::Note => 3,
    };
    json!({
        "range": at, "severity": severity, "code": message.code, "source": "eng",
        "message": text, "relatedInformation": related,
    })
}

/// The changes for the messages in a range.
pub(super) fn actions(changes: &[Change], wanted: &Value, uri: &str) -> Value {
    let key = |position: &Value| (position["line"].as_u64(), position["character"].as_u64());
    let meets = |range: &Value| {
        key(&range["start"]) <= key(&wanted["end"]) && key(&wanted["start"]) <= key(&range["end"])
    };
    let found = changes
        .iter()
        .filter(|change| meets(&change.range) || meets(&change.diagnostic["range"]));
    let actions: Vec<Value> = found
        .map(|change| {
            let edit = json!({ "range": change.range, "newText": change.text });
            json!({
                "title": change.title, "kind": "quickfix", "diagnostics": [change.diagnostic],
                "edit": { "changes": { uri: [edit] } },
            })
        })
        .collect();
    Value::Array(actions)
}
