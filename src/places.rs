//! Labels of messages at the places in a system's origins.

use eng_grammar::{Diagnostic, SourceId, Span};
use eng_system::system::{Location, Origin, Part};

/// Most places of numbers that a message shows. A choice.
pub(crate) const MOST_PLACES: usize = 3;

/// Adds the places of the numbers that decide a condition. More than [`MOST_PLACES`] of them would not help.
pub(crate) fn decided(message: Diagnostic, by: &[Origin]) -> Diagnostic {
    if by.len() > MOST_PLACES {
        return message;
    }
    message.with_each(by, |message, origin| {
        let label = format!("{} is stated here", origin.path);
        message.also_if(origin.used_at.map(span), label)
    })
}

/// Adds the origin's place with a label, then the place of its definition.
pub(crate) fn place(message: Diagnostic, origin: &Origin, label: &str) -> Diagnostic {
    let label = format!("{}: {label}", origin.path);
    let message = message.at_if(origin.used_at.map(span), label);
    related(message, origin, "defined here")
}

/// Adds the place of the origin's definition with a label.
pub(crate) fn related(message: Diagnostic, origin: &Origin, label: &str) -> Diagnostic {
    message.also_if(origin.defined_at.map(span), label)
}

/// Puts the user's line that makes a part first, if the places of a message are in the text of the library around it.
pub(crate) fn with_part(message: Diagnostic, part: Option<&Part>) -> Diagnostic {
    match part {
        Some(Part { path, made_at }) => {
            message.moved_to(span(*made_at), format!("{path}: in this part"))
        }
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

/// The text that `{:?}` makes of a value, without the numbers of the places in it.
pub(crate) fn without_places(text: &str) -> String {
    let mut parts = text.split("Location {");
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        kept.push_str("Location");
        kept.push_str(part.split_once('}').map_or(part, |(_, rest)| rest));
    }
    kept
}

/// Adds the place of the analysis that set a parameter.
pub(crate) fn set_by(message: Diagnostic, analysis: &Origin) -> Diagnostic {
    message.also_if(analysis.used_at.map(span), "set by this analysis")
}
