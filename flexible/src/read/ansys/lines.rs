//! Commands of an archive, and the columns of its blocks.

use crate::error::FileProblem;
use crate::read::Files;
use crate::read::number;
use crate::read::source::{At, Source, Syntax};

const SYNTAX: Syntax = Syntax {
    include: "/INPUT",
    text: "an ANSYS archive",
    files: "an archive that CDWRITE has written",
};

/// A command: its name and its fields, without blanks around them.
#[derive(Clone, Debug)]
pub(super) struct Command {
    /// Its name as messages show it.
    pub name: String,
    fields: Vec<String>,
    /// Its place in the file.
    pub at: At,
}

impl Command {
    /// The name by which ANSYS finds it: four letters, or the sign `/` or `*` and three letters.
    pub fn key(&self) -> &str {
        self.name.get(..4).unwrap_or(&self.name)
    }

    /// The command of a text; `None` for a blank one, and for the value of a parameter.
    pub fn of(text: &str, at: &At) -> Option<Command> {
        let mut fields = text.split(',').map(|field| field.trim().to_owned());
        let name = fields.next().unwrap_or_default().to_ascii_uppercase();
        (!name.is_empty() && !name.contains('=')).then(|| Command {
            name: short(&name),
            fields: fields.collect(),
            at: at.clone(),
        })
    }

    /// A field after the name, from 0; empty if the command is shorter.
    pub fn text(&self, i: usize) -> &str {
        self.fields.get(i).map_or("", String::as_str)
    }

    /// The same command without its first `count` fields.
    pub fn without(&self, count: usize) -> Command {
        Command {
            name: self.name.clone(),
            fields: self.fields.get(count..).unwrap_or(&[]).to_vec(),
            at: self.at.clone(),
        }
    }

    /// The number of fields after the name.
    pub fn len(&self) -> usize {
        self.fields.len()
    }

    /// A whole number; zero if the field is empty.
    pub fn integer(&self, i: usize, name: &str) -> Result<i64, FileProblem> {
        let text = self.text(i);
        whole(text).ok_or_else(|| {
            self.problem(
                format!("{name} is \"{text}\", not a whole number"),
                "write the model by CDWRITE: an archive has numbers in place of parameters",
            )
        })
    }

    /// The number of an object, above zero.
    pub fn label(&self, i: usize, name: &str) -> Result<u64, FileProblem> {
        let number = self.integer(i, name)?;
        u64::try_from(number)
            .ok()
            .filter(|number| *number > 0)
            .ok_or_else(|| {
                self.problem(
                    format!("{name} is {number}"),
                    "give a whole number above zero",
                )
            })
    }

    /// A real number; zero if the field is empty.
    pub fn real(&self, i: usize, name: &str) -> Result<f64, FileProblem> {
        real(self.text(i), name, &self.at)
    }

    /// A problem of this command.
    pub fn problem(&self, problem: impl std::fmt::Display, advice: &str) -> FileProblem {
        self.at.problem(format!("{}: {problem}", self.name), advice)
    }
}

/// A whole number; zero for an empty text.
fn whole(text: &str) -> Option<i64> {
    match text {
        "" => Some(0),
        text => number::integer(text),
    }
}

/// A real number; zero for an empty text.
pub(super) fn real(text: &str, name: &str, at: &At) -> Result<f64, FileProblem> {
    if text.is_empty() {
        return Ok(0.0);
    }
    number::real(text).ok_or_else(|| {
        at.problem(
            format!("{name} is \"{text}\", not a number"),
            "write a number such as 1.5 or 2.1E+11",
        )
    })
}

/// The columns of a block's lines, by its Fortran format: `(3i9,6e21.13e3)`.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    widths: Vec<usize>,
    /// The number of columns before the first real number.
    pub integers: usize,
}

impl Columns {
    fn of(format: &str) -> Option<Columns> {
        let inner = format.trim().strip_prefix('(')?.strip_suffix(')')?;
        let mut columns = Columns {
            widths: Vec::new(),
            integers: 0,
        };
        for part in inner.split(',') {
            let part = part.trim().to_ascii_lowercase();
            let letter = part.find(|c: char| c.is_ascii_alphabetic())?;
            let (count, rest) = part.split_at(letter);
            let count: usize = if count.is_empty() {
                1
            } else {
                count.parse().ok()?
            };
            let width = rest.get(1..)?;
            let end = width.find(|c: char| !c.is_ascii_digit());
            let width: usize = width.get(..end.unwrap_or(width.len()))?.parse().ok()?;
            if width == 0 || count > 100 || width > 100 {
                return None;
            }
            match rest.as_bytes().first()? {
                b'i' if columns.integers == columns.widths.len() => columns.integers += count,
                b'i' | b'e' | b'f' | b'g' | b'd' | b'a' => {}
                _ => return None,
            }
            columns.widths.extend(std::iter::repeat_n(width, count));
        }
        Some(columns)
    }

    /// The fields of a line, without blanks around them. A short line has less fields.
    pub fn split<'l>(&self, line: &'l str) -> Vec<&'l str> {
        let mut start = 0;
        let mut fields = Vec::with_capacity(self.widths.len());
        for width in &self.widths {
            let end = (start + width).min(line.len());
            match line.get(start..end) {
                Some(field) if start < line.len() => fields.push(field.trim()),
                _ => break,
            }
            start = end;
        }
        while fields.last().is_some_and(|field| field.is_empty()) {
            fields.pop();
        }
        fields
    }

    /// The whole numbers of a line.
    pub fn integers(&self, line: &str, at: &At) -> Result<Vec<i64>, FileProblem> {
        let fields = self.split(line);
        fields
            .into_iter()
            .map(|field| {
                whole(field).ok_or_else(|| {
                    at.problem(
                        format!("\"{field}\" is no whole number in the columns of this block"),
                        "write the archive again by CDWRITE; columns must keep their width",
                    )
                })
            })
            .collect()
    }
}

/// The lines of an archive.
pub(super) struct Lines<'f> {
    source: Source<'f>,
    again: Option<(String, At)>,
    ready: Vec<Command>,
}

impl<'f> Lines<'f> {
    pub fn open(files: &'f dyn Files, name: &str) -> Result<Self, FileProblem> {
        Ok(Lines {
            source: Source::open(files, name, &SYNTAX)?,
            again: None,
            ready: Vec::new(),
        })
    }

    /// The next line without its end.
    pub fn line(&mut self) -> Result<Option<(String, At)>, FileProblem> {
        if let Some(line) = self.again.take() {
            return Ok(Some(line));
        }
        let read = self.source.line()?;
        Ok(read.map(|(bytes, at)| {
            let text = String::from_utf8_lossy(&bytes);
            (text.trim_end().to_owned(), at)
        }))
    }

    /// Gives a line back. The next call returns it again.
    pub fn give_back(&mut self, line: String, at: At) {
        self.again = Some((line, at));
    }

    /// The format of a block, which is its first line.
    pub fn columns(&mut self, of: &Command) -> Result<Columns, FileProblem> {
        let line = self.line()?;
        let (text, at) = line.unwrap_or_else(|| (String::new(), of.at.clone()));
        Columns::of(&text).ok_or_else(|| {
            at.problem(
                format!("{}: \"{}\" is no format of columns", of.name, short(&text)),
                "write the archive again by CDWRITE; the line after this command is a format such as (3i9,6e21.13e3)",
            )
        })
    }

    /// The next line of numbers of a block; `None` at its end, a line `-1` or another command. `true` says
    /// that the block has its closing line.
    pub fn data(&mut self) -> Result<Result<(String, At), bool>, FileProblem> {
        let Some((text, at)) = self.line()? else {
            return Ok(Err(false));
        };
        let begin = text.trim_start();
        if begin == "-1" {
            return Ok(Err(true));
        }
        if begin.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.')) {
            return Ok(Ok((text, at)));
        }
        self.give_back(text, at);
        Ok(Err(false))
    }

    /// The next command. Comments, titles and values of parameters are left out.
    pub fn command(&mut self) -> Result<Option<Command>, FileProblem> {
        loop {
            if let Some(command) = self.ready.pop() {
                return Ok(Some(command));
            }
            let Some((text, at)) = self.line()? else {
                return Ok(None);
            };
            let upper = text.trim_start().to_ascii_uppercase();
            let free = ["/COM", "/TITLE", "/STITLE", "C***", "*SET", "*DIM", "*MSG"];
            if free.iter().any(|word| upper.starts_with(word)) {
                continue;
            }
            if upper.starts_with("*PREAD") {
                self.skip_parameters()?;
                continue;
            }
            let plain = text.split('!').next().unwrap_or("");
            for part in plain.split('$').rev() {
                let Some(command) = Command::of(part, &at) else {
                    continue;
                };
                let begin = |c: char| c.is_ascii_alphabetic() || matches!(c, '/' | '*');
                if !command.name.starts_with(begin) {
                    return Err(at.problem(
                        format!("\"{}\" is no command of ANSYS", short(part.trim())),
                        "write the archive again by CDWRITE; a line of numbers must follow the command of its block",
                    ));
                }
                self.ready.push(command);
            }
        }
    }

    /// Skips the values of a parameter.
    fn skip_parameters(&mut self) -> Result<(), FileProblem> {
        while let Some((text, _)) = self.line()? {
            if text.trim_start().starts_with("END PREAD") {
                break;
            }
        }
        Ok(())
    }
}

/// The beginning of a text, for messages.
fn short(text: &str) -> String {
    text.chars().take(40).collect()
}
