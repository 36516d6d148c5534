//! A flat view of a text: words, numbers, texts and signs with their places.
//!
//! The tree comes from the grammar. Tokens give information that the grammar cannot give: the last character
//! of an item, the nesting of brackets, an open bracket, and the text at a mistake.

/// The kinds of tokens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TokenKind {
    /// Letters, digits and `_`, not beginning with a digit.
    Word,
    /// A literal number without its unit.
    Number,
    /// A text with both quotes.
    Text,
    /// A text whose line ends before its quote.
    OpenText,
    /// A `///` or `//!` comment.
    Doc,
    /// A sign of one or two characters.
    Sign,
    /// A character the language does not use.
    Strange,
}

/// One token; places are bytes of the text it was made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    pub kind: TokenKind,
    pub start: usize,
    pub end: usize,
}

impl Token {
    /// The characters.
    pub fn text<'t>(&self, text: &'t str) -> &'t str {
        text.get(self.start..self.end).unwrap_or("")
    }
}

const PAIRS: [&str; 7] = ["..", "==", "!=", "<=", ">=", "->", "**"];

/// All tokens of a text in order.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let bytes = text.as_bytes();
    let byte = |i: usize| bytes.get(i).copied().unwrap_or(0);
    let run = |mut i: usize, accept: fn(u8) -> bool| {
        while i < bytes.len() && accept(bytes[i]) {
            i += 1;
        }
        i
    };
    let word = |b: u8| b.is_ascii_alphanumeric() || b == b'_';
    let digit = |b: u8| b.is_ascii_digit();
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let start = at;
        let here = byte(at);
        let kind = match here {
            b' ' | b'\t' | b'\r' | b'\n' => {
                at += 1;
                continue;
            }
            b'/' if byte(at + 1) == b'/' => {
                at = run(at, |b| b != b'\n');
                let (third, fourth) = (byte(start + 2), byte(start + 3));
                if !(third == b'!' || (third == b'/' && fourth != b'/')) {
                    continue;
                }
                TokenKind::Doc
            }
            b'"' => {
                at += 1;
                while at < bytes.len() && !matches!(bytes[at], b'"' | b'\n') {
                    at += if bytes[at] == b'\\' && byte(at + 1) != b'\n' {
                        2
                    } else {
                        1
                    };
                }
                at = at.min(bytes.len());
                if byte(at) == b'"' {
                    at += 1;
                    TokenKind::Text
                } else {
                    TokenKind::OpenText
                }
            }
            b if b.is_ascii_digit() => {
                at = run(at, digit);
                if byte(at) == b'.' && byte(at + 1).is_ascii_digit() {
                    at = run(at + 1, digit);
                }
                if matches!(byte(at), b'e' | b'E') {
                    let sign = usize::from(matches!(byte(at + 1), b'+' | b'-'));
                    if byte(at + 1 + sign).is_ascii_digit() {
                        at = run(at + 1 + sign, digit);
                    }
                }
                TokenKind::Number
            }
            b if word(b) => {
                at = run(at, word);
                TokenKind::Word
            }
            _ => {
                let rest = text.get(at..).unwrap_or("");
                if PAIRS.iter().any(|pair| rest.starts_with(pair)) {
                    at += 2;
                    TokenKind::Sign
                } else {
                    let Some(character) = rest.chars().next() else {
                        at += 1;
                        continue;
                    };
                    at += character.len_utf8();
                    if character == '\u{FEFF}' {
                        continue;
                    }
                    if "()[]{}<>=+-*/^.,:;%|".contains(character) {
                        TokenKind::Sign
                    } else {
                        TokenKind::Strange
                    }
                }
            }
        };
        // after an escape the position may be inside a character
        while at < bytes.len() && !text.is_char_boundary(at) {
            at += 1;
        }
        found.push(Token {
            kind,
            start,
            end: at,
        });
    }
    found
}

/// The end of the last token that begins before `position`; `start` without such a token.
pub(crate) fn last_end(tokens: &[Token], start: usize, position: usize) -> usize {
    let count = tokens.partition_point(|token| token.start < position);
    match count.checked_sub(1).and_then(|i| tokens.get(i)) {
        Some(token) if token.start >= start => token.end.min(position),
        _ => start,
    }
}
