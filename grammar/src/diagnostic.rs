//! The one message type of every stage.

use crate::span::Span;
use serde::Serialize;
use std::collections::BTreeMap;

/// The severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The model is wrong and cannot run.
    Error,
    /// The model runs, but probably contains a mistake.
    Warning,
    /// A remark about a default or a choice.
    Note,
}

/// A place with a label.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// The label, in a few words.
    pub message: String,
    /// The place of the mistake, or a related one.
    pub primary: bool,
}

/// A change of the text that corrects the mistake.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fix {
    /// The effect of the change.
    pub title: String,
    /// The text to replace.
    pub span: Span,
    /// The new text.
    pub replacement: String,
}

/// One message: code, title, places, notes, help, fixes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// Its severity.
    pub severity: Severity,
    /// `E0307`, `W0012`: stable.
    pub code: &'static str,
    /// One sentence without a full stop.
    pub title: String,
    /// Places, the user's first.
    pub labels: Vec<Label>,
    /// Further facts.
    pub notes: Vec<String>,
    /// Remedies.
    pub help: Vec<String>,
    /// Changes a tool may apply.
    pub fixes: Vec<Fix>,
}

impl Diagnostic {
    fn new(severity: Severity, code: &'static str, title: impl Into<String>) -> Self {
        Diagnostic {
            severity,
            code,
            title: title.into(),
            labels: Vec::new(),
            notes: Vec::new(),
            help: Vec::new(),
            fixes: Vec::new(),
        }
    }

    /// An error.
    pub fn error(code: &'static str, title: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, title)
    }

    /// A warning.
    pub fn warning(code: &'static str, title: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, title)
    }

    /// A remark.
    pub fn note(code: &'static str, title: impl Into<String>) -> Self {
        Self::new(Severity::Note, code, title)
    }

    /// Adds the place of the mistake.
    pub fn at(mut self, span: Span, message: impl Into<String>) -> Self {
        self.labels.push(Label {
            span,
            message: message.into(),
            primary: true,
        });
        self
    }

    /// Adds the place of the mistake. The places so far become related ones.
    pub fn moved_to(mut self, span: Span, message: impl Into<String>) -> Self {
        for label in &mut self.labels {
            label.primary = false;
        }
        let mut moved = self.at(span, message);
        moved.labels.rotate_right(1);
        moved
    }

    /// Adds a related place.
    pub fn also(mut self, span: Span, message: impl Into<String>) -> Self {
        self.labels.push(Label {
            span,
            message: message.into(),
            primary: false,
        });
        self
    }

    /// Adds the place of the mistake, if it is known.
    pub fn at_if(self, span: Option<Span>, message: impl Into<String>) -> Self {
        match span {
            Some(span) => self.at(span, message),
            None => self,
        }
    }

    /// Adds a related place, if it is known.
    pub fn also_if(self, span: Option<Span>, message: impl Into<String>) -> Self {
        match span {
            Some(span) => self.also(span, message),
            None => self,
        }
    }

    /// Adds something for each value, such as for a value that may be missing.
    pub fn with_each<T>(
        self,
        values: impl IntoIterator<Item = T>,
        add: impl FnMut(Self, T) -> Self,
    ) -> Self {
        values.into_iter().fold(self, add)
    }

    /// Adds a remark.
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// Adds the note on `accept` for a lint with a name.
    pub fn acceptable(self, name: &str) -> Self {
        match name {
            "" => self,
            name => self.with_note(format!(
                "if you intend it: `accept {name}` in its block, or in the model for all"
            )),
        }
    }

    /// Adds the note on `accept` for a lint about the whole model, its cycle or an analysis: these have no block that
    /// accepts.
    pub fn acceptable_in_model(self, name: &str) -> Self {
        self.with_note(format!("if you intend it: `accept {name}` in the model"))
    }

    /// Adds advice.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help.push(help.into());
        self
    }

    /// Adds a remark, if there is one.
    pub fn note_if(mut self, note: Option<impl Into<String>>) -> Self {
        self.notes.extend(note.map(Into::into));
        self
    }

    /// Adds advice, if there is any.
    pub fn help_if(mut self, help: Option<impl Into<String>>) -> Self {
        self.help.extend(help.map(Into::into));
        self
    }

    /// Adds a machine-applicable fix.
    pub fn with_fix(
        mut self,
        title: impl Into<String>,
        span: Span,
        replacement: impl Into<String>,
    ) -> Self {
        self.fixes.push(Fix {
            title: title.into(),
            span,
            replacement: replacement.into(),
        });
        self
    }

    /// Suggests a known name, as a fix for the text at `span`.
    pub fn meant(self, span: Span, known: impl Into<String>) -> Self {
        let known = known.into();
        self.with_fix(format!("did you mean `{known}`?"), span, known)
    }

    /// Suggests a known name, if one is near.
    pub fn meant_if(self, span: Span, known: Option<impl Into<String>>) -> Self {
        self.with_each(known, |message, known| message.meant(span, known))
    }

    /// Whether this is an error.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

/// Collects messages of all stages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostics {
    items: Vec<Diagnostic>,
    /// Indices in `items` by code and place, to find an equal message quickly among very many.
    places: BTreeMap<(&'static str, Option<u32>), Vec<usize>>,
}

impl Diagnostics {
    /// An empty collection.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a message unless there is an equal one.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        let start = diagnostic.labels.first().map(|label| label.span.start);
        let alike = self.places.entry((diagnostic.code, start)).or_default();
        let known = |index: &usize| self.items.get(*index) == Some(&diagnostic);
        if !alike.iter().any(known) {
            alike.push(self.items.len());
            self.items.push(diagnostic);
        }
    }

    /// Adds all messages of another collection.
    pub fn extend(&mut self, other: Diagnostics) {
        for diagnostic in other.items {
            self.push(diagnostic);
        }
    }

    /// Whether any message is an error.
    pub fn has_errors(&self) -> bool {
        self.items.iter().any(Diagnostic::is_error)
    }

    /// The messages in the order they were found.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.items.iter()
    }

    /// Number of messages.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether there is no message.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }
}
