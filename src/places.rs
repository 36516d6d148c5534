//! Labels of messages at the places in a system's origins.

use eng_grammar::{Diagnostic, SourceId, Span};
use eng_system::system::{Location, Origin};

/// Most places of numbers that a message shows.
pub(crate) const MOST_PLACES: usize = 3;

/// Adds the places of the numbers that decide a condition. More than [`MOST_PLACES`] of them would not help.
pub(crate) fn decided(message: Diagnostic, by: &[Origin]) -> Diagnostic {
    if by.len() > MOST_PLACES {
        return message;
    }
    by.iter()
        .fold(message, |message, origin| match origin.used_at {
            Some(at) => message.also(span(at), format!("{} is stated here", origin.path)),
            None => message,
        })
}

/// Adds the origin's place with a label, then the place of its definition.
pub(crate) fn place(message: Diagnostic, origin: &Origin, label: &str) -> Diagnostic {
    let message = match origin.used_at {
        Some(at) => message.at(span(at), format!("{}: {label}", origin.path)),
        None => message,
    };
    related(message, origin, "defined here")
}

/// Adds the place of the origin's definition with a label.
pub(crate) fn related(message: Diagnostic, origin: &Origin, label: &str) -> Diagnostic {
    match origin.defined_at {
        Some(at) => message.also(span(at), label),
        None => message,
    }
}

/// A place as a span of the texts.
pub(crate) fn span(at: Location) -> Span {
    Span {
        source: SourceId(at.source),
        start: at.start,
        end: at.end,
    }
}

/// Adds a place to a message, before its other places.
pub(crate) fn at_first(mut message: Diagnostic, at: Location, label: &str) -> Diagnostic {
    for label in &mut message.labels {
        label.primary = false;
    }
    let mut first = message.clone().at(span(at), label).labels;
    first.rotate_right(1);
    message.labels = first;
    message
}

/// Adds the place of the analysis that set a parameter.
pub(crate) fn set_by(message: Diagnostic, analysis: &Origin) -> Diagnostic {
    match analysis.used_at {
        Some(at) => message.also(span(at), "set by this analysis"),
        None => message,
    }
}
