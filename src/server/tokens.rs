//! Colours of names by their meaning, which patterns of words do not show.

use super::document::Document;
use super::index::Index;
use super::occurrences::{Token, occurrences};
use serde_json::{Value, json};

/// The protocol's kinds of names, in the order of their numbers. A member is a property, and a unit belongs to its
/// number.
const KINDS: [&str; 12] = [
    "namespace",
    "type",
    "class",
    "interface",
    "struct",
    "enum",
    "enumMember",
    "function",
    "parameter",
    "variable",
    "property",
    "number",
];
/// The bits of a definition, and of a name of the library.
const MARKS: [&str; 2] = ["declaration", "defaultLibrary"];

pub(super) fn legend() -> Value {
    json!({ "tokenTypes": KINDS, "tokenModifiers": MARKS })
}

/// The place of a token's kind in the legend.
fn number(token: Token) -> u32 {
    match token {
        Token::Module => 0,
        Token::Dimension => 1,
        Token::Class => 2,
        Token::Interface => 3,
        Token::Record => 4,
        Token::Choice => 5,
        Token::Word => 6,
        Token::Function => 7,
        Token::Parameter => 8,
        Token::Value => 9,
        Token::Member => 10,
        Token::Unit => 11,
    }
}

/// Five numbers for each name: lines after the one before, UTF-16 units after its start or that of the line, length,
/// kind, marks.
pub(super) fn tokens(index: &Index<'_>, document: &Document) -> Value {
    let text = document.text.as_str();
    let units = |part: &str| part.chars().map(char::len_utf16).sum::<usize>();
    let mut data: Vec<usize> = Vec::new();
    // the byte up to which lines and units are counted
    let (mut at, mut lines, mut column) = (0, 0, 0);
    for one in occurrences(index) {
        let (start, end) = (one.span.start as usize, one.span.end as usize);
        let (Some(between), Some(name)) = (text.get(at..start), text.get(start..end)) else {
            continue;
        };
        let ended = between.matches('\n').count();
        match between.rfind('\n') {
            Some(end) => {
                lines += ended;
                column = units(between.get(end + 1..).unwrap_or(""));
            }
            None => column += units(between),
        }
        let of_library = one.of.is_some_and(|of| index.is_library(of.module));
        let marks = usize::from(one.defines) + 2 * usize::from(of_library);
        data.extend([
            lines,
            column,
            units(name),
            number(one.token) as usize,
            marks,
        ]);
        (at, lines, column) = (start, 0, 0);
    }
    json!({ "data": data })
}
