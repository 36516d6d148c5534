//! The lines of an input file: keyword lines with their parameters, and data lines. It skips comments.

use crate::error::FileProblem;
use crate::read::source::{At, Source, Syntax};
use crate::read::{Files, number};

/// Words for messages about these files.
const INPUT: Syntax = Syntax {
    include: "*INCLUDE",
    text: "an Abaqus or CalculiX input file",
    files: "the input file (.inp)",
};
/// The largest number of lines of one keyword. A choice: options of a keyword take a few lines, and a file
/// with more is damaged.
const LONGEST_KEYWORD: usize = 200;

/// A keyword line.
#[derive(Clone, Debug)]
pub(super) struct Keyword {
    /// The name in capitals, with single blanks and without the asterisk: `SOLID SECTION`.
    pub name: String,
    /// The name without blanks, used for comparison.
    pub key: String,
    /// Names (capitals, without blanks) and values.
    parameters: Vec<(String, String)>,
    /// Its place in the file.
    pub at: At,
}

impl Keyword {
    fn parse(text: &str, at: At) -> Self {
        let mut parts = split(text).into_iter();
        let words = parts.next().unwrap_or("").trim_start_matches('*');
        let name = words.split_whitespace().collect::<Vec<_>>().join(" ");
        let name = name.to_ascii_uppercase();
        let parameters = parts
            .filter(|part| !part.is_empty())
            .map(|part| {
                let (name, value) = part.split_once('=').unwrap_or((part, ""));
                (squeezed(name), unquoted(value).to_string())
            })
            .collect();
        Keyword {
            key: squeezed(&name),
            name,
            parameters,
            at,
        }
    }

    /// Value of a parameter; empty if the file gives the parameter without a value.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.parameters
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, value)| value.as_str())
    }

    /// Whether the file gives a parameter.
    pub fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// Value of a parameter, in capitals without blanks; empty if the parameter is absent.
    pub fn choice(&self, name: &str) -> String {
        self.get(name).map(squeezed).unwrap_or_default()
    }

    /// Value of a required parameter.
    pub fn require(&self, name: &str, written: &str) -> Result<&str, FileProblem> {
        self.get(name)
            .filter(|value| !value.is_empty())
            .ok_or_else(|| {
                self.problem(
                    &format!("the parameter {written} is missing"),
                    format!("write *{}, {written}=…", self.name),
                )
            })
    }

    /// A problem of this keyword.
    pub fn problem(&self, problem: &str, advice: impl Into<String>) -> FileProblem {
        self.at
            .problem(format!("*{}: {problem}", self.name), advice)
    }
}

/// A data line.
#[derive(Clone, Debug)]
pub(super) struct Row {
    text: String,
    /// Its place in the file.
    pub at: At,
}

impl Row {
    /// A line of this text.
    pub fn new(text: String, at: At) -> Self {
        Row { text, at }
    }

    /// The fields, without blanks around them and without empty ones at the end.
    pub fn fields(&self) -> Vec<&str> {
        let mut fields = split(&self.text);
        while fields.last().is_some_and(|field| field.is_empty()) {
            fields.pop();
        }
        fields
    }

    /// Whether it is empty.
    pub fn is_blank(&self) -> bool {
        self.fields().is_empty()
    }

    /// A field; empty if the line is shorter.
    pub fn text(&self, i: usize) -> &str {
        split(&self.text).get(i).copied().unwrap_or("")
    }

    /// A number; `None` for an empty field.
    pub fn optional_real(&self, i: usize, name: &str) -> Result<Option<f64>, FileProblem> {
        match self.text(i) {
            "" => Ok(None),
            text => number::real(text).map(Some).ok_or_else(|| {
                self.at.problem(
                    format!("{name} is \"{text}\", not a number"),
                    "write a number such as 1.5 or 2.1E+11",
                )
            }),
        }
    }

    /// A required number.
    pub fn real(&self, i: usize, name: &str) -> Result<f64, FileProblem> {
        self.optional_real(i, name)?.ok_or_else(|| {
            self.at.problem(
                format!("{name} is missing (entry {} of this line)", i + 1),
                "add it; commas separate the entries",
            )
        })
    }

    /// A number; zero if the field is empty.
    pub fn real_or_zero(&self, i: usize, name: &str) -> Result<f64, FileProblem> {
        Ok(self.optional_real(i, name)?.unwrap_or(0.0))
    }

    /// Three numbers; zero for each empty field.
    pub fn vector(&self, i: usize, name: &str) -> Result<[f64; 3], FileProblem> {
        Ok([
            self.real_or_zero(i, name)?,
            self.real_or_zero(i + 1, name)?,
            self.real_or_zero(i + 2, name)?,
        ])
    }

    /// A freedom, written 1…6, as 0…5.
    pub fn freedom(&self, i: usize) -> Result<u8, FileProblem> {
        match self.text(i).parse::<u8>() {
            Ok(freedom @ 1..=6) => Ok(freedom - 1),
            _ => Err(self.at.problem(
                format!("\"{}\" is no freedom of a structure", self.text(i)),
                "write a freedom from 1 to 6",
            )),
        }
    }

    /// Freedoms from the one in field `i` to the one in field `i + 1`, as bits. Without the second field only
    /// the first freedom.
    pub fn freedom_range(&self, i: usize) -> Result<u8, FileProblem> {
        let first = self.freedom(i)?;
        let last = if self.text(i + 1).is_empty() {
            first
        } else {
            self.freedom(i + 1)?
        };
        if last < first {
            return Err(self.at.problem(
                format!("freedom {} comes after freedom {}", first + 1, last + 1),
                "write the smaller number first",
            ));
        }
        Ok((first..=last).fold(0, |bits, freedom| bits | 1 << freedom))
    }
}

/// A line of either kind.
pub(super) enum Line {
    /// Begins a block.
    Keyword(Keyword),
    /// Belongs to the block before it.
    Row(Row),
}

/// Reads an input file line by line.
pub(super) struct Lines<'f> {
    source: Source<'f>,
    ahead: Option<(String, At)>,
}

impl<'f> Lines<'f> {
    /// Opens an input file.
    pub fn open(files: &'f dyn Files, name: &str) -> Result<Self, FileProblem> {
        Ok(Lines {
            source: Source::open(files, name, &INPUT)?,
            ahead: None,
        })
    }

    /// The next line that is no comment.
    pub fn next_line(&mut self) -> Result<Option<Line>, FileProblem> {
        let Some((text, at)) = self.raw()? else {
            return Ok(None);
        };
        if !text.trim_start().starts_with('*') {
            return Ok(Some(Line::Row(Row::new(text, at))));
        }
        let mut whole = text.trim().to_string();
        for _ in 0..LONGEST_KEYWORD {
            if !whole.ends_with(',') {
                break;
            }
            match self.raw()? {
                Some((more, _)) if !more.trim_start().starts_with('*') => {
                    whole.push_str(more.trim());
                }
                Some(line) => {
                    self.ahead = Some(line);
                    break;
                }
                None => break,
            }
        }
        Ok(Some(Line::Keyword(Keyword::parse(&whole, at))))
    }

    /// Continues with a file that a keyword names.
    pub fn include(&mut self, name: &str, at: &At) -> Result<(), FileProblem> {
        self.source.include(name, at)
    }

    fn raw(&mut self) -> Result<Option<(String, At)>, FileProblem> {
        if let Some(line) = self.ahead.take() {
            return Ok(Some(line));
        }
        while self.source.is_open() {
            let Some((bytes, at)) = self.source.line()? else {
                self.source.end_file();
                continue;
            };
            let text = String::from_utf8_lossy(&bytes).trim_end().to_string();
            if !text.trim_start().starts_with("**") {
                return Ok(Some((text, at)));
            }
        }
        Ok(None)
    }
}

/// The fields of a line, trimmed. Commas separate them, except inside quotes.
fn split(text: &str) -> Vec<&str> {
    let mut quoted = false;
    text.split(|c: char| {
        quoted ^= c == '"';
        c == ',' && !quoted
    })
    .map(str::trim)
    .collect()
}

/// The text without quotes around it.
pub(super) fn unquoted(text: &str) -> &str {
    text.trim().trim_matches(|c| c == '"' || c == '\'').trim()
}

/// The text in capitals without blanks.
pub(super) fn squeezed(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_whitespace())
        .collect::<String>()
        .to_ascii_uppercase()
}

/// The form of a name for comparison: capitals without quotes.
pub(super) fn key(name: &str) -> String {
    unquoted(name).to_uppercase()
}
