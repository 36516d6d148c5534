//! The one form of a text: spaces, indents and line ends.
//!
//! Tokens, comments and numbers stay as written, and so does each line end that an author chose inside of an item. The
//! tree decides which gaps are spaces: `2*x` and `2 N * x` differ, because a space ends a unit. The first line end of a
//! text decides whether its lines end with `\n` or with `\r\n`.

mod layout;
mod marks;
mod pieces;

use crate::diagnostic::Diagnostics;
use crate::grammar::{EngGrammar, Rule};
use crate::parse::parse;
use crate::span::SourceId;
use crate::tokens::{Token, TokenKind, tokens};
use marks::Marks;
use pest::Parser;
use pest::iterators::Pairs;
use thiserror::Error;

/// The reason why a text has no form.
#[derive(Debug, Error)]
pub enum FormatError {
    /// The text can't be read as a whole; its messages state the places.
    #[error("the text has mistakes")]
    Unreadable(Diagnostics),
    /// A fault of the formatter: its text would mean something else.
    #[error(
        "the formatter would change the meaning of this text; this is a fault of Eng, please report it"
    )]
    Changed,
    /// A fault of the formatter: it would format its own text differently.
    #[error("the formatter would change its own text; this is a fault of Eng, please report it")]
    Unstable,
}

/// The text in the one form. It reads as the same tree, and its own form is itself; otherwise there is no text.
///
/// ```
/// let text = "model  M{ param bore:Length=86mm // of one\n}";
/// assert_eq!(
///     eng_grammar::format(text, eng_grammar::SourceId(0)).unwrap(),
///     "model M {\n    param bore: Length = 86 mm  // of one\n}\n"
/// );
/// ```
///
/// # Errors
/// A text with mistakes; a fault of this function.
pub fn format(text: &str, source: SourceId) -> Result<String, FormatError> {
    let mut diagnostics = Diagnostics::new();
    parse(text, source, &mut diagnostics);
    if diagnostics.has_errors() {
        return Err(FormatError::Unreadable(diagnostics));
    }
    let (shape, formed) = formed(text).ok_or(FormatError::Changed)?;
    let mut diagnostics = Diagnostics::new();
    parse(&formed, source, &mut diagnostics);
    let (shape_after, again) = self::formed(&formed).ok_or(FormatError::Changed)?;
    if diagnostics.has_errors() || shape != shape_after {
        return Err(FormatError::Changed);
    }
    match again == formed {
        true => Ok(with_line_ends_of(text, formed)),
        false => Err(FormatError::Unstable),
    }
}

/// A formed text with line ends like the first one of a text. So a text that was checked out on Windows keeps its own.
fn with_line_ends_of(text: &str, formed: String) -> String {
    let first = text.split_inclusive('\n').next().unwrap_or_default();
    match first.ends_with("\r\n") {
        true => formed.replace('\n', "\r\n"),
        false => formed,
    }
}

/// The contents of a text without its blanks and line ends: tokens and comments, and the tree over them.
#[derive(Debug, PartialEq, Eq)]
struct Shape {
    pieces: Vec<String>,
    /// Rules with their first token and the one after their last.
    tree: Vec<(Rule, usize, usize)>,
}

/// The shape of a text, and the text in the one form.
fn formed(text: &str) -> Option<(Shape, String)> {
    let pairs = EngGrammar::parse(Rule::file, text).ok()?;
    let tokens = split(tokens(text), &pairs);
    let pieces = pieces::pieces(text, &tokens);
    let shape = Shape {
        pieces: pieces.iter().map(|piece| piece.text.to_owned()).collect(),
        tree: pairs
            .clone()
            .flatten()
            .map(|pair| {
                let span = pair.as_span();
                let (from, to) = range(&tokens, span.start(), span.end());
                (pair.as_rule(), from, to)
            })
            .collect(),
    };
    let marks = Marks::of(text, &tokens, pairs);
    let formed = layout::text(&pieces, &marks);
    Some((shape, formed))
}

/// The tokens that begin inside of `start..end`: the first one, and the one after the last.
fn range(tokens: &[Token], start: usize, end: usize) -> (usize, usize) {
    let index = |place: usize| tokens.partition_point(|token| token.start < place);
    (index(start), index(end))
}

/// In `Vector<Force>=`, the sign `>=` is the end of a type and the sign `=`.
fn split(tokens: Vec<Token>, pairs: &Pairs<'_, Rule>) -> Vec<Token> {
    let closed: Vec<usize> = pairs
        .clone()
        .flatten()
        .filter(|pair| pair.as_rule() == Rule::close_angle)
        .map(|pair| pair.as_span().end())
        .collect();
    let mut parts = Vec::with_capacity(tokens.len());
    for token in tokens {
        let middle = token.start + 1;
        if token.end == middle + 1
            && token.kind == TokenKind::Sign
            && closed.binary_search(&middle).is_ok()
        {
            parts.push(Token {
                end: middle,
                ..token
            });
            parts.push(Token {
                start: middle,
                ..token
            });
        } else {
            parts.push(token);
        }
    }
    parts
}
