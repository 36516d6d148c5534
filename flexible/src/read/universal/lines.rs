//! Datasets of a universal file, and the fields of their records.

use super::deck::Origin;
use crate::error::FileProblem;
use crate::read::Files;
use crate::read::number;
use crate::read::source::{At, Source, Syntax};

const SYNTAX: Syntax = Syntax {
    include: "",
    text: "a universal file",
    files: "a universal file of I-deas (.unv, .uff)",
};

/// The advice for a file with damaged lines.
pub(super) const AGAIN: &str = "write the file again; numbers need spaces between them, or the columns of the dataset's format";

/// The line that begins and ends a dataset.
pub(super) const BRACKET: &str = "-1";

/// A record: a line of a dataset.
#[derive(Clone, Debug)]
pub(super) struct Record {
    /// Number of its dataset.
    dataset: u32,
    pub text: String,
    pub at: At,
}

impl Record {
    /// Its dataset and line.
    pub fn origin(&self) -> Origin {
        Origin {
            dataset: self.dataset,
            line: self.at.line,
        }
    }

    /// A problem of this record.
    pub fn problem(&self, problem: impl std::fmt::Display, advice: &str) -> FileProblem {
        let problem = format!("dataset {}: {problem}", self.dataset);
        self.at.problem(problem, advice)
    }

    /// Its fields, which are as many as `widths`. Blanks part them if that gives this number of them; fields
    /// that fill their columns touch each other, and only the columns part these.
    fn fields(&self, widths: &[usize]) -> Result<Vec<&str>, FileProblem> {
        let words: Vec<&str> = self.text.split_ascii_whitespace().collect();
        if words.len() == widths.len() {
            return Ok(words);
        }
        let mut fields = Vec::with_capacity(widths.len());
        let mut rest = self.text.as_str();
        for width in widths {
            let Some((field, after)) = rest.split_at_checked((*width).min(rest.len())) else {
                break;
            };
            if field.trim().is_empty() {
                break;
            }
            fields.push(field.trim());
            rest = after;
        }
        if fields.len() != widths.len() || !rest.trim().is_empty() {
            return Err(self.problem(
                format!(
                    "the line has {} fields instead of {}: \"{}\"",
                    words.len(),
                    widths.len(),
                    short(&self.text)
                ),
                AGAIN,
            ));
        }
        Ok(fields)
    }

    /// Whole numbers of ten columns each.
    pub fn integers(&self, count: usize) -> Result<Vec<i64>, FileProblem> {
        let fields = self.fields(&vec![10; count])?;
        fields.into_iter().map(|text| self.integer(text)).collect()
    }

    /// A fixed number of whole numbers.
    pub fn head<const N: usize>(&self) -> Result<[i64; N], FileProblem> {
        let found = self.integers(N)?;
        // as many as requested
        <[i64; N]>::try_from(found).map_err(|_| self.problem("a number is missing", AGAIN))
    }

    /// The whole numbers of a line, however many. Blanks part them.
    pub fn whole_numbers(&self) -> Result<Vec<i64>, FileProblem> {
        let words = self.text.split_ascii_whitespace();
        words.map(|text| self.integer(text)).collect()
    }

    /// The real numbers of a line, however many. Blanks part them, or they fill 13 columns each.
    pub fn real_numbers(&self) -> Result<Vec<f64>, FileProblem> {
        let words = self.text.split_ascii_whitespace();
        let apart: Option<Vec<f64>> = words.map(number::real).collect();
        if let Some(values) = apart {
            return Ok(values);
        }
        let mut values = Vec::new();
        let mut rest = self.text.as_str();
        while !rest.trim().is_empty() {
            let Some((field, after)) = rest.split_at_checked(rest.len().min(13)) else {
                return Err(self.problem("a number has other characters than digits", AGAIN));
            };
            values.push(self.real(field.trim())?);
            rest = after;
        }
        Ok(values)
    }

    /// The most digits that a real number of the line has before its exponent, from the first one above zero.
    pub fn digits(&self) -> u32 {
        let words = self.text.split_ascii_whitespace();
        let count = |word: &str| {
            let word = word.trim_start_matches(['+', '-', '0', '.']);
            let digits = word.chars().take_while(|c| c.is_ascii_digit() || *c == '.');
            digits.filter(char::is_ascii_digit).count() as u32 // of one line
        };
        words.map(count).max().unwrap_or(0)
    }

    fn integer(&self, text: &str) -> Result<i64, FileProblem> {
        number::integer(text)
            .ok_or_else(|| self.problem(format!("\"{}\" is no whole number", short(text)), AGAIN))
    }

    fn real(&self, text: &str) -> Result<f64, FileProblem> {
        number::real(text)
            .ok_or_else(|| self.problem(format!("\"{}\" is no number", short(text)), AGAIN))
    }

    /// Three real numbers of 25 columns each.
    pub fn vector(&self) -> Result<[f64; 3], FileProblem> {
        self.three(&self.fields(&[25; 3])?)
    }

    /// Four whole numbers of ten columns each, and three real ones of 13.
    pub fn point(&self) -> Result<([i64; 4], [f64; 3]), FileProblem> {
        let fields = self.fields(&[10, 10, 10, 10, 13, 13, 13])?;
        let (whole, reals) = fields.split_at(4);
        let mut head = [0; 4];
        for (value, text) in head.iter_mut().zip(whole) {
            *value = self.integer(text)?;
        }
        Ok((head, self.three(reals)?))
    }

    fn three(&self, fields: &[&str]) -> Result<[f64; 3], FileProblem> {
        let mut values = [0.0; 3];
        for (value, text) in values.iter_mut().zip(fields) {
            *value = self.real(text)?;
        }
        Ok(values)
    }

    /// The number of an object, above zero.
    pub fn label(&self, number: i64, of: &str) -> Result<u64, FileProblem> {
        u64::try_from(number)
            .ok()
            .filter(|number| *number > 0)
            .ok_or_else(|| {
                self.problem(
                    format!("{of} has the number {number}"),
                    "give it a whole number above zero",
                )
            })
    }
}

/// The beginning of a dataset.
#[derive(Clone, Debug)]
pub(super) struct Head {
    /// Its number.
    pub number: u32,
    pub at: At,
    /// Lines and bytes of a binary one (`58b`).
    pub binary: Option<(u64, u64)>,
}

/// The datasets of a file.
pub(super) struct Lines<'f> {
    source: Source<'f>,
    /// The dataset that is being read, or the last one.
    head: Head,
}

impl<'f> Lines<'f> {
    pub fn open(files: &'f dyn Files, name: &str) -> Result<Self, FileProblem> {
        Ok(Lines {
            source: Source::open(files, name, &SYNTAX)?,
            head: Head {
                number: 0,
                at: At {
                    file: name.into(),
                    line: 0,
                },
                binary: None,
            },
        })
    }

    fn line(&mut self) -> Result<Option<(String, At)>, FileProblem> {
        let read = self.source.line()?;
        Ok(read.map(|(bytes, at)| {
            let text = String::from_utf8_lossy(&bytes);
            (text.trim_end().to_owned(), at)
        }))
    }

    fn line_with_text(&mut self) -> Result<Option<(String, At)>, FileProblem> {
        loop {
            match self.line()? {
                Some((text, _)) if text.is_empty() => {}
                other => return Ok(other),
            }
        }
    }

    /// The beginning of the next dataset; `None` at the end of the file. Remarks between datasets, which some programs write,
    /// are left out. A remark begins with a letter, data do not. A dataset must follow it: otherwise it may be text of a
    /// dataset that a stray -1 ends early.
    pub fn next(&mut self) -> Result<Option<Head>, FileProblem> {
        let mut remark: Option<(String, At)> = None;
        let (text, at) = loop {
            let Some((text, at)) = self.line_with_text()? else {
                return match remark {
                    Some((text, at)) => Err(outside(&text, &at)),
                    None => Ok(None),
                };
            };
            let words = text.trim_start().starts_with(|c: char| c.is_alphabetic());
            if !(words && self.head.number > 0) {
                break (text, at);
            }
            remark.get_or_insert((text, at));
        };
        if text.trim() != BRACKET {
            let (text, at) = remark.unwrap_or((text, at));
            return Err(outside(&text, &at));
        }
        let found = self.line_with_text()?;
        let (text, at) = found.unwrap_or((String::new(), at));
        let Some(head) = head(text.trim(), &at) else {
            return Err(match remark {
                Some((text, at)) => outside(&text, &at),
                None => at.problem(
                    format!("\"{}\" is no number of a dataset", short(&text)),
                    "write the file again; the number of the dataset follows the line -1 that begins it",
                ),
            });
        };
        self.head = head.clone();
        Ok(Some(head))
    }

    fn cut(&self) -> FileProblem {
        let problem = format!("dataset {}: the file ends inside it", self.head.number);
        let advice = "copy or write the file again; a line -1 ends each dataset";
        self.head.at.problem(problem, advice)
    }

    /// The next record of the dataset; `None` at its end. Blank lines are left out.
    pub fn record(&mut self) -> Result<Option<Record>, FileProblem> {
        let Some((text, at)) = self.line_with_text()? else {
            return Err(self.cut());
        };
        if text.trim() == BRACKET {
            return Ok(None);
        }
        let dataset = self.head.number;
        Ok(Some(Record { dataset, text, at }))
    }

    /// A further record of an object that `first` begins.
    pub fn more(&mut self, first: &Record, of: &str) -> Result<Record, FileProblem> {
        self.record()?.ok_or_else(|| {
            first.problem(
                format!("the dataset ends inside {of}"),
                "write the file again; it may be cut",
            )
        })
    }

    /// A line with a name, which may be blank.
    pub fn name(&mut self) -> Result<String, FileProblem> {
        match self.line()? {
            Some((text, _)) => Ok(text.trim().to_owned()),
            None => Err(self.cut()),
        }
    }

    /// Skips the rest of the dataset.
    pub fn skip(&mut self, head: &Head) -> Result<(), FileProblem> {
        if let Some((lines, bytes)) = head.binary {
            for _ in 0..lines {
                self.line()?.ok_or_else(|| self.cut())?;
            }
            if !self.source.skip(bytes, &head.at)? {
                return Err(self.cut());
            }
        }
        while self.record()?.is_some() {}
        Ok(())
    }
}

/// The problem of a line between datasets.
fn outside(text: &str, at: &At) -> FileProblem {
    at.problem(
        format!("\"{}\" is outside a dataset", short(text)),
        "write the file again; a line -1 begins and ends each dataset",
    )
}

/// The number of a dataset, and for a binary one the order of bytes, the format of numbers, and the lines and
/// bytes that follow.
fn head(text: &str, at: &At) -> Option<Head> {
    let digits = text.find(|c: char| !c.is_ascii_digit());
    let (number, rest) = text.split_at(digits.unwrap_or(text.len()));
    let number = number.parse().ok()?;
    let at = at.clone();
    let binary = match rest.strip_prefix(['b', 'B']) {
        Some(rest) => {
            let mut counts = rest.split_ascii_whitespace().skip(2);
            let mut count = || counts.next()?.parse::<u64>().ok();
            Some((count()?, count()?))
        }
        None if rest.is_empty() => None,
        None => return None,
    };
    Some(Head { number, at, binary })
}

/// The beginning of a text, for messages.
pub(super) fn short(text: &str) -> String {
    text.trim().chars().take(40).collect()
}
