//! Texts as messages show them. Very long lines are cut around the places of the message, and control
//! characters are escaped.

use super::visible::{acts, shown, visible};
use codespan_reporting::files::{Error, Files};
use std::borrow::Cow;
use std::ops::Range;

/// A line of at most this many characters is shown whole. A choice: longer ones are data.
const WHOLE: usize = 240;
/// Characters that are kept before and after the ends of a label. A choice.
const AROUND: usize = 60;
/// The mark in place of a cut part.
const CUT: &str = "…";

/// A text with its long lines cut. Messages name places of the whole text.
#[derive(Debug)]
pub struct Excerpt<'a> {
    /// Its name, with control characters escaped.
    pub name: Cow<'a, str>,
    whole: &'a str,
    /// The shown text.
    pub shown: String,
    /// The kept parts, in order: first byte in the whole text, number of bytes, first byte in the shown text.
    kept: Vec<(usize, usize, usize)>,
    /// First bytes of the lines of the shown text.
    lines: Vec<usize>,
}

impl<'a> Excerpt<'a> {
    /// The text, cut around the places (bytes) of a message.
    pub fn new(name: &'a str, whole: &'a str, places: &[Range<usize>]) -> Excerpt<'a> {
        let mut excerpt = Excerpt {
            name: visible(name),
            whole,
            shown: String::with_capacity(whole.len()),
            kept: Vec::new(),
            lines: vec![0],
        };
        let mut start = 0;
        for line in whole.split_inclusive('\n') {
            let end = start + line.len();
            if line.chars().nth(WHOLE).is_none() {
                excerpt.keep(start..end);
            } else {
                excerpt.cut(start..end, places);
            }
            if line.ends_with('\n') {
                excerpt.lines.push(excerpt.shown.len());
            }
            start = end;
        }
        excerpt
    }

    /// Keeps the beginning of a line and the characters around both ends of each place in it.
    fn cut(&mut self, line: Range<usize>, places: &[Range<usize>]) {
        let begin = line.start..self.far(line.start, true, line.end);
        let mut parts = vec![begin];
        for end in places.iter().flat_map(|place| [place.start, place.end]) {
            let last = end == line.end && end == self.whole.len();
            if line.contains(&end) || last {
                parts.push(self.far(end, false, line.start)..self.far(end, true, line.end));
            }
        }
        parts.sort_by_key(|part| part.start);
        let mut done = line.start;
        for part in parts {
            if part.start > done {
                self.shown.push_str(CUT);
            }
            self.keep(part.start.max(done)..part.end.max(done));
            done = done.max(part.end);
        }
        if done < line.end {
            self.shown.push_str(CUT);
            if self.whole.as_bytes().get(line.end - 1) == Some(&b'\n') {
                self.keep(line.end - 1..line.end);
            }
        }
    }

    /// The place [`AROUND`] characters after a place (`on`) or before it, not beyond a limit.
    fn far(&self, from: usize, on: bool, limit: usize) -> usize {
        if on {
            let rest = self.whole.get(from..limit).unwrap_or_default();
            rest.char_indices()
                .nth(AROUND)
                .map_or(limit, |(at, _)| from + at)
        } else {
            let before = self.whole.get(limit..from).unwrap_or_default();
            before
                .char_indices()
                .rev()
                .nth(AROUND - 1)
                .map_or(limit, |(at, _)| limit + at)
        }
    }

    /// Shows a part of the text.
    fn keep(&mut self, part: Range<usize>) {
        let whole = self.whole;
        let text = whole.get(part.clone()).unwrap_or_default();
        let mut from = part.start;
        for (at, c) in text.match_indices(acts) {
            let (start, end) = (part.start + at, part.start + at + c.len());
            // the line ends of other systems are also line ends
            if c == "\r" && whole[end..].starts_with('\n') {
                continue;
            }
            self.keep_plain(from..start);
            self.kept.push((start, c.len(), self.shown.len()));
            self.shown.extend(c.chars().map(shown));
            from = end;
        }
        self.keep_plain(from..part.end);
    }

    /// Shows a part of the text as it is.
    fn keep_plain(&mut self, part: Range<usize>) {
        let Some(text) = self.whole.get(part.clone()).filter(|text| !text.is_empty()) else {
            return;
        };
        let at = self.shown.len();
        self.shown.push_str(text);
        // neighbouring parts become one
        match self.kept.last_mut() {
            Some((first, length, begin))
                if *first + *length == part.start && *begin + *length == at =>
            {
                *length += text.len();
            }
            _ => self.kept.push((part.start, text.len(), at)),
        }
    }

    /// The place in the shown text for a place of the whole text. For a cut part it is the place of the mark.
    pub fn place(&self, whole: usize) -> usize {
        let after = self.kept.partition_point(|(first, ..)| *first <= whole);
        match after.checked_sub(1).and_then(|i| self.kept.get(i)) {
            Some((first, length, at)) => at + (whole - first).min(*length),
            None => 0,
        }
    }

    /// The place in the whole text for a place of the shown text.
    pub fn original(&self, shown: usize) -> usize {
        let after = self.kept.partition_point(|(_, _, at)| *at <= shown);
        match after.checked_sub(1).and_then(|i| self.kept.get(i)) {
            Some((first, length, at)) => first + (shown - at).min(*length),
            None => 0,
        }
    }
}

/// The texts of one message.
#[derive(Debug, Default)]
pub struct Excerpts<'a>(pub Vec<Excerpt<'a>>);

impl<'a> Files<'a> for Excerpts<'_> {
    type FileId = usize;
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, id: usize) -> Result<&'a str, Error> {
        self.0
            .get(id)
            .map(|e| e.name.as_ref())
            .ok_or(Error::FileMissing)
    }

    fn source(&'a self, id: usize) -> Result<&'a str, Error> {
        self.0
            .get(id)
            .map(|e| e.shown.as_str())
            .ok_or(Error::FileMissing)
    }

    fn line_index(&'a self, id: usize, byte: usize) -> Result<usize, Error> {
        let excerpt = self.0.get(id).ok_or(Error::FileMissing)?;
        Ok(excerpt
            .lines
            .partition_point(|start| *start <= byte)
            .saturating_sub(1))
    }

    fn line_range(&'a self, id: usize, line: usize) -> Result<Range<usize>, Error> {
        let excerpt = self.0.get(id).ok_or(Error::FileMissing)?;
        let missing = Error::LineTooLarge {
            given: line,
            max: excerpt.lines.len().saturating_sub(1),
        };
        let start = *excerpt.lines.get(line).ok_or(missing)?;
        let end = excerpt.lines.get(line + 1);
        Ok(start..end.copied().unwrap_or(excerpt.shown.len()))
    }

    fn column_number(&'a self, id: usize, _line: usize, byte: usize) -> Result<usize, Error> {
        let excerpt = self.0.get(id).ok_or(Error::FileMissing)?;
        let before = excerpt
            .whole
            .get(..excerpt.original(byte))
            .unwrap_or_default();
        let line = before.rsplit('\n').next().unwrap_or_default();
        Ok(line.chars().count() + 1)
    }
}
