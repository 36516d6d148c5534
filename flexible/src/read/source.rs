//! Text files that include others: their lines, each with its place.

use std::io::{BufRead, Read};
use std::rc::Rc;

use super::Files;
use crate::error::{FileProblem, Place};

/// A file with a longer line than this is no text. A choice: cards have some hundred characters at most.
const LONGEST_LINE: u64 = 1 << 16;
/// The largest number of files open inside each other. A choice below the limit of open files of a process.
const DEEPEST: usize = 60;
/// The largest number of includes. A choice: without it two files that include each other twice would be read
/// 2⁶⁰ times.
const MOST_INCLUDES: usize = 10_000;

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct At {
    /// The file, under the name of the request.
    pub file: Rc<str>,
    /// The line, from 1.
    pub line: u64,
}

impl At {
    /// A problem here.
    pub fn problem(&self, problem: impl Into<String>, advice: impl Into<String>) -> FileProblem {
        FileProblem::at_line(&self.file, self.line, problem, advice)
    }
}

/// Words for messages about a kind of files.
pub(super) struct Syntax {
    /// The word that includes a file.
    pub include: &'static str,
    /// The kind of text: "no text of …".
    pub text: &'static str,
    /// The expected files: "give …".
    pub files: &'static str,
}

struct OpenFile {
    name: Rc<str>,
    normal: String,
    reader: Box<dyn BufRead>,
    line: u64,
}

/// A file and those it includes, line by line.
pub(super) struct Source<'f> {
    files: &'f dyn Files,
    syntax: &'static Syntax,
    stack: Vec<OpenFile>,
    includes: usize,
}

impl<'f> Source<'f> {
    /// Opens a file.
    pub fn open(
        files: &'f dyn Files,
        name: &str,
        syntax: &'static Syntax,
    ) -> Result<Self, FileProblem> {
        let reader = super::open(files, name)?;
        Ok(Source {
            files,
            syntax,
            stack: vec![OpenFile {
                name: name.into(),
                normal: normal(name),
                reader,
                line: 0,
            }],
            includes: 0,
        })
    }

    /// Whether a file is open.
    pub fn is_open(&self) -> bool {
        !self.stack.is_empty()
    }

    /// Closes the innermost file; `false` if it is the outermost one.
    pub fn end_file(&mut self) -> bool {
        self.stack.pop();
        !self.stack.is_empty()
    }

    /// The next line of the innermost file, unchanged and with its line end; `None` at the end of the file,
    /// which remains open.
    pub fn line(&mut self) -> Result<Option<(Vec<u8>, At)>, FileProblem> {
        let Some(file) = self.stack.last_mut() else {
            return Ok(None);
        };
        file.line += 1;
        let at = At {
            file: Rc::clone(&file.name),
            line: file.line,
        };
        let mut bytes = Vec::with_capacity(96);
        (&mut file.reader)
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut bytes)
            .map_err(|error| cut(&at, &error))?;
        if bytes.is_empty() {
            return Ok(None);
        }
        if bytes.len() as u64 == LONGEST_LINE || bytes.contains(&0) {
            return Err(at.problem(
                format!("this line is no text of {}", self.syntax.text),
                format!("give {}, not a database or result file", self.syntax.files),
            ));
        }
        Ok(Some((bytes, at)))
    }

    /// Skips bytes of the innermost file, which may be no text; `false` if it ends before. Line ends among
    /// them count as in an editor.
    pub fn skip(&mut self, bytes: u64, at: &At) -> Result<bool, FileProblem> {
        let Some(file) = self.stack.last_mut() else {
            return Ok(bytes == 0);
        };
        let mut left = bytes;
        while left > 0 {
            let ready = file.reader.fill_buf().map_err(|error| cut(at, &error))?;
            let taken = usize::try_from(left).unwrap_or(usize::MAX).min(ready.len());
            if taken == 0 {
                return Ok(false);
            }
            let ends = ready.iter().take(taken).filter(|byte| **byte == b'\n');
            file.line += ends.count() as u64;
            file.reader.consume(taken);
            left -= taken as u64;
        }
        Ok(true)
    }

    /// Opens an included file: beside the including file, beside the deck, or beside the model.
    pub fn include(&mut self, name: &str, at: &At) -> Result<(), FileProblem> {
        let include = self.syntax.include;
        self.includes += 1;
        if self.stack.len() >= DEEPEST || self.includes > MOST_INCLUDES {
            return Err(at.problem(
                format!("{include} '{name}': the files include more than {MOST_INCLUDES} files, or more than {DEEPEST} inside each other"),
                "remove includes; a file may include itself",
            ));
        }
        let including = self.stack.last().map_or("", |file| &*file.name).to_string();
        let deck = self.stack.first().map_or("", |file| &*file.name);
        let candidates = candidates(&[&including, deck], name);
        let mut last = None;
        for candidate in &candidates {
            if self.stack.iter().any(|file| file.normal == *candidate) {
                let circle = self
                    .stack
                    .iter()
                    .skip_while(|file| file.normal != *candidate)
                    .map(|file| &*file.name)
                    .chain([candidate.as_str()])
                    .collect::<Vec<_>>()
                    .join(" → ");
                return Err(at.problem(
                    format!("{include} '{name}' includes itself in a circle: {circle}"),
                    format!("remove one of these {include} lines"),
                ));
            }
            match super::open(self.files, candidate) {
                Ok(reader) => {
                    self.stack.push(OpenFile {
                        name: candidate.as_str().into(),
                        normal: candidate.clone(),
                        reader,
                        line: 0,
                    });
                    return Ok(());
                }
                Err(problem) => last = Some(problem),
            }
        }
        let why = last.map_or_else(String::new, |problem| problem.problem);
        Err(at.problem(
            format!(
                "the file '{name}' {why} (tried {})",
                candidates.join(", ")
            ),
            "check the name; paths are relative to the including file, the deck or the folder of the model",
        ))
    }
}

/// A file that can't be read to its end.
fn cut(at: &At, error: &std::io::Error) -> FileProblem {
    at.problem(
        format!("reading stopped here: {error}"),
        "copy the file again; it may be cut or damaged",
    )
}

/// A problem of a file as a whole, at no line.
pub(super) fn whole(
    name: &str,
    problem: impl Into<String>,
    advice: impl Into<String>,
) -> FileProblem {
    FileProblem {
        file: name.into(),
        place: Place::File,
        problem: problem.into(),
        advice: advice.into(),
    }
}

/// Names under which an included file may be found, best first. Eng does not know the meaning of a logical
/// prefix (`VAR:file`) and leaves it out.
pub fn candidates(beside: &[&str], name: &str) -> Vec<String> {
    let plain = name.replace('\\', "/");
    let mut forms = vec![plain.clone()];
    if let Some((prefix, rest)) = plain.split_once(':')
        && prefix.len() > 1
    {
        forms.push(rest.trim_start_matches('/').to_string());
    }
    let folders = beside
        .iter()
        .map(|file| match normal(file).rsplit_once('/') {
            Some((folder, _)) => format!("{folder}/"),
            None => String::new(),
        });
    let folders = folders.chain([String::new()]).collect::<Vec<_>>();
    let mut names: Vec<String> = Vec::new();
    for form in forms {
        let ways = if form.starts_with('/') {
            vec![normal(&form)]
        } else {
            let within = |folder: &String| normal(&format!("{folder}{form}"));
            folders.iter().map(within).collect()
        };
        for way in ways {
            if !names.contains(&way) {
                names.push(way);
            }
        }
    }
    names
}

/// A path with `/` only, without `.` and without `folder/..`.
pub fn normal(path: &str) -> String {
    let path = path.replace('\\', "/");
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    let joined = parts.join("/");
    if path.starts_with('/') {
        format!("/{joined}")
    } else if joined.is_empty() {
        ".".to_owned()
    } else {
        joined
    }
}
