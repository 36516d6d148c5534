//! Tokens and comments in order, with the line ends between them.

use crate::tokens::{Token, TokenKind};

/// A token or a comment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<'t> {
    /// Its characters, without blanks at the end.
    pub text: &'t str,
    pub kind: PieceKind,
    /// Line ends between the piece before and this one.
    pub breaks: usize,
    /// Characters before it in its line, as written.
    pub column: usize,
}

/// The kinds of pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PieceKind {
    /// The token of this number.
    Token(usize),
    /// A `///` or `//!` comment, the token of this number.
    Doc(usize),
    /// A comment that the tree does not hold.
    Comment,
}

impl Piece<'_> {
    /// Its number among the tokens.
    pub fn token(&self) -> Option<usize> {
        match self.kind {
            PieceKind::Token(token) | PieceKind::Doc(token) => Some(token),
            PieceKind::Comment => None,
        }
    }

    /// Whether it takes the rest of its line.
    pub fn ends_line(&self) -> bool {
        !matches!(self.kind, PieceKind::Token(_))
    }
}

/// The pieces of a text.
pub(super) fn pieces<'t>(text: &'t str, tokens: &[Token]) -> Vec<Piece<'t>> {
    let mut pieces = Vec::with_capacity(tokens.len());
    let mut at = 0;
    for (i, token) in tokens.iter().enumerate() {
        comments(text, at, token.start, &mut pieces);
        let kind = match token.kind {
            TokenKind::Doc => PieceKind::Doc(i),
            _ => PieceKind::Token(i),
        };
        push(text, token.start, token.end, kind, &mut pieces);
        at = token.end;
    }
    comments(text, at, text.len(), &mut pieces);
    pieces
}

/// The comments between two tokens.
fn comments<'t>(text: &'t str, from: usize, to: usize, pieces: &mut Vec<Piece<'t>>) {
    let mut at = from;
    while let Some(found) = text.get(at..to).and_then(|gap| gap.find("//")) {
        let start = at + found;
        let rest = text.get(start..to).unwrap_or("");
        let end = start + rest.find('\n').unwrap_or(rest.len());
        push(text, start, end, PieceKind::Comment, pieces);
        at = end;
    }
}

fn push<'t>(text: &'t str, start: usize, end: usize, kind: PieceKind, pieces: &mut Vec<Piece<'t>>) {
    let before = text.get(..start).unwrap_or("");
    let line = before.rfind('\n').map_or(0, |end| end + 1);
    let last = pieces.last().map_or(0, |piece: &Piece<'_>| {
        // both are parts of one text
        piece.text.as_ptr() as usize - text.as_ptr() as usize + piece.text.len()
    });
    pieces.push(Piece {
        text: text.get(start..end).unwrap_or("").trim_end(),
        kind,
        breaks: text.get(last..start).unwrap_or("").matches('\n').count(),
        column: before[line..]
            .trim_start_matches('\u{FEFF}')
            .chars()
            .count(),
    });
}
