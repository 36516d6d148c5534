//! The contents of a mesh file: words of text or binary numbers, with their places.

use std::io::{BufRead, Read};

use crate::error::{FileProblem, Place};
use crate::read::{Files, number};

/// Longest word of a text file. A choice: numbers and names are far shorter, and a longer one shows a binary
/// file.
const LONGEST_WORD: usize = 512;
/// The largest number of bytes that are read of a line. A choice: a longer one shows a binary file, and
/// memory stays bounded.
const LONGEST_LINE: u64 = 1 << 16;

/// An open file.
pub(super) struct Stream {
    reader: Box<dyn BufRead>,
    file: String,
    line: u64,
    /// Start of the last line read.
    line_before: u64,
    byte: u64,
    section: u64,
    section_name: String,
    /// Whether numbers are binary.
    pub binary: bool,
    /// Whether the bytes of a number are in the opposite order to this machine's.
    pub swapped: bool,
}

impl Stream {
    /// Opens a file.
    pub fn open(files: &dyn Files, name: &str) -> Result<Self, FileProblem> {
        Ok(Stream {
            reader: crate::read::open(files, name)?,
            file: name.into(),
            line: 1,
            line_before: 1,
            byte: 0,
            section: 0,
            section_name: String::new(),
            binary: false,
            swapped: false,
        })
    }

    /// A problem here.
    pub fn problem(&self, problem: impl Into<String>, advice: impl Into<String>) -> FileProblem {
        self.problem_at(self.line, problem.into(), advice.into())
    }

    /// A problem of the last line read.
    pub fn problem_of_line(
        &self,
        problem: impl Into<String>,
        advice: impl Into<String>,
    ) -> FileProblem {
        self.problem_at(self.line_before, problem.into(), advice.into())
    }

    fn problem_at(&self, line: u64, problem: String, advice: String) -> FileProblem {
        let place = if self.binary {
            Place::Record {
                record: self.section,
                byte: self.byte,
            }
        } else {
            Place::Line(line)
        };
        FileProblem {
            file: self.file.clone(),
            place,
            problem: if self.section_name.is_empty() {
                problem
            } else {
                format!("${}: {problem}", self.section_name)
            },
            advice,
        }
    }

    /// The place of the last line read, for the list of unread contents.
    pub fn place(&self) -> (String, u64) {
        (self.file.clone(), self.line_before)
    }

    fn unreadable(&self, error: &std::io::Error) -> FileProblem {
        self.problem(
            format!("reading stopped here: {error}"),
            "copy the file again; it may be cut or damaged",
        )
    }

    fn cut(&self) -> FileProblem {
        self.problem(
            "the file ends too early",
            "write or copy the file again; it may be cut",
        )
    }

    /// The rest of a line, at most [`LONGEST_LINE`] bytes; `None` at the end of the file.
    fn bytes_of_line(&mut self) -> Result<Option<Vec<u8>>, FileProblem> {
        let mut bytes = Vec::new();
        let read = (&mut self.reader)
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut bytes);
        let count = read.map_err(|error| self.unreadable(&error))?;
        self.byte += count as u64;
        self.line_before = self.line;
        self.line += u64::from(bytes.ends_with(b"\n"));
        Ok((count > 0).then_some(bytes))
    }

    /// The rest of a line as text, without blanks around it; `None` at the end of the file.
    pub fn text_line(&mut self) -> Result<Option<String>, FileProblem> {
        let bytes = self.bytes_of_line()?;
        Ok(bytes.map(|bytes| String::from_utf8_lossy(&bytes).trim().to_string()))
    }

    /// The name of the next section; `None` at the end of the file.
    pub fn next_section(&mut self) -> Result<Option<String>, FileProblem> {
        self.section_name.clear();
        loop {
            let Some(line) = self.text_line()? else {
                return Ok(None);
            };
            if line.is_empty() {
                continue;
            }
            match line.strip_prefix('$') {
                Some(name) if !name.starts_with("End") => {
                    self.section += 1;
                    self.section_name = name.chars().take(40).collect();
                    return Ok(Some(name.to_string()));
                }
                _ => {
                    let found = line.chars().take(40).collect::<String>();
                    return Err(self.problem_of_line(
                        format!("\"{found}\" stands in the place of the beginning of a section"),
                        "give a mesh file of gmsh (.msh); its sections begin with $ and a name",
                    ));
                }
            }
        }
    }

    /// Skips a section.
    pub fn skip(&mut self, name: &str) -> Result<(), FileProblem> {
        let end = format!("$End{name}");
        while let Some(line) = self.bytes_of_line()? {
            if line.trim_ascii_end().ends_with(end.as_bytes()) {
                return Ok(());
            }
        }
        Err(self.cut())
    }

    /// The end of a section.
    pub fn end(&mut self, name: &str) -> Result<(), FileProblem> {
        let end = format!("$End{name}");
        let found = self.word()?;
        if found == end {
            return Ok(());
        }
        let found = found.chars().take(40).collect::<String>();
        Err(self.problem(
            format!("\"{found}\" stands in the place of {end}"),
            "write the file again; the counts at the head of the section do not fit its lines",
        ))
    }

    /// The next word of text.
    pub fn word(&mut self) -> Result<String, FileProblem> {
        let mut word = Vec::new();
        loop {
            let available = match self.reader.fill_buf() {
                Ok(available) => available,
                Err(error) => {
                    let error = std::io::Error::new(error.kind(), error.to_string());
                    return Err(self.unreadable(&error));
                }
            };
            if available.is_empty() {
                if word.is_empty() {
                    return Err(self.cut());
                }
                break;
            }
            let (mut used, mut done) = (0, false);
            for &byte in available {
                if byte.is_ascii_whitespace() {
                    if !word.is_empty() {
                        done = true;
                        break;
                    }
                    self.line += u64::from(byte == b'\n');
                } else {
                    word.push(byte);
                }
                used += 1;
                if word.len() > LONGEST_WORD {
                    break;
                }
            }
            self.reader.consume(used);
            self.byte += used as u64;
            if word.len() > LONGEST_WORD {
                return Err(self.problem(
                    "this line is no text of a mesh file",
                    "give a mesh file of gmsh (.msh)",
                ));
            }
            if done {
                break;
            }
        }
        Ok(String::from_utf8_lossy(&word).into_owned())
    }

    fn exactly<const N: usize>(&mut self) -> Result<[u8; N], FileProblem> {
        let mut bytes = [0; N];
        match self.reader.read_exact(&mut bytes) {
            Ok(()) => {}
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
                return Err(self.cut());
            }
            Err(error) => return Err(self.unreadable(&error)),
        }
        self.byte += N as u64;
        if self.swapped {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn parsed<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, FileProblem> {
        let word = self.word()?;
        word.parse().map_err(|_| self.no_number(what, &word))
    }

    fn no_number(&self, what: &str, word: &str) -> FileProblem {
        let word = word.chars().take(40).collect::<String>();
        self.problem(
            format!("{what} is \"{word}\", not a valid number"),
            "write the file again; it is damaged, or the counts at the head of the section are wrong",
        )
    }

    /// A whole number of 4 bytes.
    pub fn integer(&mut self, what: &str) -> Result<i32, FileProblem> {
        if self.binary {
            return Ok(i32::from_le_bytes(self.exactly()?));
        }
        self.parsed(what)
    }

    /// A whole number of 8 bytes, not negative.
    pub fn size(&mut self, what: &str) -> Result<u64, FileProblem> {
        if self.binary {
            return Ok(u64::from_le_bytes(self.exactly()?));
        }
        self.parsed(what)
    }

    /// A finite number.
    pub fn real(&mut self, what: &str) -> Result<f64, FileProblem> {
        if !self.binary {
            let word = self.word()?;
            return number::real(&word).ok_or_else(|| self.no_number(what, &word));
        }
        let value = f64::from_le_bytes(self.exactly()?);
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.no_number(what, &value.to_string()))
    }

    /// Three finite numbers.
    pub fn vector(&mut self, what: &str) -> Result<[f64; 3], FileProblem> {
        Ok([self.real(what)?, self.real(what)?, self.real(what)?])
    }
}
