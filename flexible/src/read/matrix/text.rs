//! Text files line by line, and numbers in their columns.

use std::io::{BufRead, Read};

use super::CUT;
use crate::error::FileProblem;
use crate::read::{self, Files, number};

/// Longer lines than this are no text of any of these formats.
const LONGEST_LINE: u64 = 1 << 16;

/// A text file.
pub(in crate::read) struct Text {
    file: String,
    reader: Box<dyn BufRead>,
    line: u64,
    bytes: Vec<u8>,
    again: bool,
}

impl Text {
    /// Opens a file.
    pub fn open(files: &dyn Files, file: &str) -> Result<Self, FileProblem> {
        Ok(Text {
            file: file.into(),
            reader: read::open(files, file)?,
            line: 0,
            bytes: Vec::new(),
            again: false,
        })
    }

    /// Number of the line last read.
    pub fn line(&self) -> u64 {
        self.line.max(1)
    }

    /// A problem at the line last read.
    pub fn problem(&self, problem: impl Into<String>, advice: impl Into<String>) -> FileProblem {
        FileProblem::at_line(&self.file, self.line.max(1), problem, advice)
    }

    /// A problem with the text of the line last read.
    pub fn wrong(&self, expected: &str, advice: &str) -> FileProblem {
        let text = String::from_utf8_lossy(&self.bytes);
        let text = text.chars().take(60).collect::<String>();
        self.problem(format!("\"{}\" is not {expected}", text.trim()), advice)
    }

    /// The file ends where `expected` should come.
    pub fn cut(&self, expected: &str) -> FileProblem {
        self.problem(format!("the file ends before {expected}"), CUT)
    }

    /// The next line without its end and trailing blanks, ASCII only (other bytes became `?`); `None` at the
    /// end of the file.
    pub fn next_line(&mut self) -> Result<Option<&str>, FileProblem> {
        if std::mem::take(&mut self.again) {
            return Ok(std::str::from_utf8(&self.bytes).ok());
        }
        self.bytes.clear();
        self.line += 1;
        let read = (&mut self.reader)
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut self.bytes);
        if let Err(error) = read {
            return Err(self.problem(
                format!("reading stopped here: {error}"),
                "copy the file again; it may be cut or damaged",
            ));
        }
        if self.bytes.is_empty() {
            self.line -= 1;
            return Ok(None);
        }
        if self.bytes.len() as u64 == LONGEST_LINE || self.bytes.contains(&0) {
            return Err(self.problem(
                "this line is no text of a matrix or of modes",
                "write the matrix or the modes as text; this file is binary",
            ));
        }
        for byte in &mut self.bytes {
            if !byte.is_ascii() {
                *byte = b'?';
            }
        }
        while self.bytes.last().is_some_and(u8::is_ascii_whitespace) {
            self.bytes.pop();
        }
        Ok(std::str::from_utf8(&self.bytes).ok())
    }

    /// Makes the next line this one again.
    pub fn put_back(&mut self) {
        self.again = true;
    }
}

/// The columns `from` up to (not including) `to` of a line of ASCII, without blanks around; fewer at its end.
pub(super) fn columns(line: &str, from: usize, to: usize) -> &str {
    let end = to.min(line.len());
    line.get(from.min(end)..end).unwrap_or("").trim()
}

/// A finite real, with any of the exponents of Fortran.
pub(in crate::read) fn real(text: &str) -> Option<f64> {
    match text.parse::<f64>() {
        Ok(value) => Some(value).filter(|value| value.is_finite()),
        Err(_) => number::real(text),
    }
}

/// An integer not below zero.
pub(in crate::read) fn count(text: &str) -> Option<u64> {
    number::integer(text).and_then(|value| u64::try_from(value).ok())
}

/// The remedy for a text that is no number.
pub(in crate::read) const NUMBERS: &str =
    "write the file again; it was edited or cut, or its run failed and wrote stars or NaN";
