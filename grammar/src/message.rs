//! Messages of conditions: texts with `{expression as unit}` places.

use crate::ast::{Expr, Name, UnitExpr};
use crate::codes;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::parse::parse_placeholder;
use crate::span::Span;
use crate::strings::unescape;

/// A part of a `require` message.
#[derive(Clone, Debug, PartialEq)]
pub enum MessagePart {
    /// Plain text, escapes resolved.
    Text(String),
    /// `{expression as unit}`.
    Value {
        /// The shown expression.
        value: Expr,
        /// Its unit.
        unit: Option<UnitExpr>,
        /// With its braces.
        span: Span,
    },
}

/// Splits the message of a [`crate::ast::Statement::Require`] into texts and values.
///
/// `{{` and `}}` are braces. An unreadable place gets an error and is left out. With `is_unit` a word that is no unit
/// ends a unit.
pub fn parse_message(
    message: &Name,
    is_unit: Option<&dyn Fn(&str) -> bool>,
    diagnostics: &mut Diagnostics,
) -> Vec<MessagePart> {
    let text = message.text.as_str();
    let source = message.span.source;
    let base = message.span.start as usize;
    let span = |start: usize, end: usize| Span::new(source, base + start, base + end);
    let mut parts = Vec::new();
    let mut plain = String::new();
    let mut at = 0;
    while let Some(rest) = text.get(at..).filter(|rest| !rest.is_empty()) {
        let Some(next) = rest.find(['{', '}']) else {
            plain.push_str(&unescape(rest).0);
            break;
        };
        plain.push_str(&unescape(&rest[..next]).0);
        let brace = at + next;
        let here = &rest[next..];
        if here.starts_with("{{") || here.starts_with("}}") {
            plain.push_str(&here[..1]);
            at = brace + 2;
            continue;
        }
        let close = here
            .find('}')
            .filter(|close| *close > 0)
            .filter(|close| !here[1..*close].contains('{'));
        let Some(close) = close else {
            diagnostics.push(
                Diagnostic::error(
                    codes::UNPAIRED,
                    "a brace in a message has no matching brace",
                )
                .at(span(brace, brace + 1), "this one")
                .with_help("write `{{` or `}}` for a brace itself"),
            );
            at = brace + 1;
            continue;
        };
        if !plain.is_empty() {
            parts.push(MessagePart::Text(std::mem::take(&mut plain)));
        }
        let inside = &here[1..close];
        if let Some((value, unit)) =
            parse_placeholder(inside, source, base + brace + 1, is_unit, diagnostics)
        {
            parts.push(MessagePart::Value {
                value,
                unit,
                span: span(brace, brace + close + 1),
            });
        }
        at = brace + close + 1;
    }
    if !plain.is_empty() {
        parts.push(MessagePart::Text(plain));
    }
    parts
}
