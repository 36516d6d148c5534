//! The lines of a deck, without comments and with the lines of included files in their place.

use super::weight::WeightTable;
use crate::error::FileProblem;
use crate::read::Files;
pub(super) use crate::read::source::{At, whole};
use crate::read::source::{Source, Syntax};

/// Words for messages about these files.
const BULK: Syntax = Syntax {
    include: "INCLUDE",
    text: "bulk data",
    files: "the deck (.bdf, .dat, .nas)",
};
/// The largest number of lines of one file name. A choice: a name is at most some thousand characters long.
const LONGEST_NAME: usize = 40;

/// A line without its comment, ASCII only (other bytes became `?`), not blank.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// Its text.
    pub text: String,
    /// Its place.
    pub at: At,
    /// Its number in the deck as a whole.
    pub order: u64,
}

/// Reads a deck line by line.
pub(super) struct Lines<'f> {
    source: Source<'f>,
    order: u64,
    /// The weight check in the comments read so far.
    pub weight: WeightTable,
}

impl<'f> Lines<'f> {
    /// Opens a deck.
    pub fn open(files: &'f dyn Files, name: &str) -> Result<Self, FileProblem> {
        Ok(Lines {
            source: Source::open(files, name, &BULK)?,
            order: 0,
            weight: WeightTable::default(),
        })
    }

    /// The next line that isn't blank.
    pub fn next_line(&mut self) -> Result<Option<Line>, FileProblem> {
        while self.source.is_open() {
            let Some((text, at)) = self.raw()? else {
                self.source.end_file();
                continue;
            };
            if let Some(rest) = include_operand(&text) {
                let name = self.include_name(rest, &at)?;
                self.source.include(&name, &at)?;
                continue;
            }
            if let Some(comment) = text.trim_start().strip_prefix('$') {
                self.weight.comment(comment, &at);
                continue;
            }
            let text = before_comment(&text);
            if text.trim().is_empty() {
                continue;
            }
            self.order += 1;
            return Ok(Some(Line {
                text: text.to_string(),
                at,
                order: self.order,
            }));
        }
        Ok(None)
    }

    /// Closes the innermost file at an `ENDDATA`; `false` if it is the deck itself. (Nastran ends the whole
    /// deck at an included `ENDDATA`. Later lines would be lost without a message.)
    pub fn end_file(&mut self) -> bool {
        self.source.end_file()
    }

    /// An unchanged line of the innermost file; `None` at its end.
    fn raw(&mut self) -> Result<Option<(String, At)>, FileProblem> {
        let Some((bytes, at)) = self.source.line()? else {
            return Ok(None);
        };
        let text = bytes
            .iter()
            .map(|&b| if b.is_ascii() { char::from(b) } else { '?' })
            .collect::<String>();
        Ok(Some((text.trim_end().to_string(), at)))
    }

    /// The file name of an `INCLUDE`. It may continue over several lines inside one pair of quotes.
    fn include_name(&mut self, operand: String, at: &At) -> Result<String, FileProblem> {
        let quote = operand.chars().next().filter(|c| matches!(c, '\'' | '"'));
        let Some(quote) = quote else {
            let name = before_comment(&operand).trim().to_string();
            if name.is_empty() {
                return Err(at.problem("INCLUDE names no file", "write INCLUDE 'file'"));
            }
            return Ok(name);
        };
        let mut name = String::new();
        let mut part = operand.get(1..).unwrap_or("").to_string();
        for _ in 0..LONGEST_NAME {
            if let Some((last, _)) = part.split_once(quote) {
                name.push_str(last.trim());
                return Ok(name);
            }
            if !part.starts_with('$') {
                name.push_str(part.trim());
            }
            match self.raw()? {
                Some((text, _)) => part = text.trim_start().to_string(),
                None => break,
            }
        }
        Err(at.problem(
            format!("INCLUDE {quote}{name}: the closing quote is missing"),
            "close the file name with the quote that opens it",
        ))
    }
}

fn before_comment(text: &str) -> &str {
    text.split('$').next().unwrap_or("")
}

/// The text after the word `INCLUDE`; `None` on any other line.
pub fn include_operand(text: &str) -> Option<String> {
    let text = text.trim_start();
    let word = text.get(..7)?;
    if !word.eq_ignore_ascii_case("INCLUDE") {
        return None;
    }
    let rest = text.get(7..).unwrap_or("");
    if rest.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_') {
        return None;
    }
    Some(
        rest.trim_start_matches([' ', '\t', '=', ','])
            .trim_end()
            .to_string(),
    )
}
