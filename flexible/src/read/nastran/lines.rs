//! The lines of a deck: comments cut, included files in their place.

use std::io::{BufRead, Read};
use std::rc::Rc;

use crate::error::{FileProblem, Place};
use crate::read::{self, Files};

/// Longer lines than this are no bulk data.
const LONGEST_LINE: u64 = 1 << 16;
/// Lines a file name may be spread over.
const LONGEST_NAME: usize = 40;
/// Files open in each other.
const DEEPEST: usize = 60;
/// Includes in all.
const MOST_INCLUDES: usize = 10_000;

/// Where something stands.
#[derive(Clone, Debug)]
pub(super) struct At {
    /// The file, as it was asked for.
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

struct OpenFile {
    name: Rc<str>,
    normal: String,
    reader: Box<dyn BufRead>,
    line: u64,
}

/// Reads a deck line by line.
pub(super) struct Lines<'f> {
    files: &'f dyn Files,
    stack: Vec<OpenFile>,
    includes: usize,
    order: u64,
}

impl<'f> Lines<'f> {
    /// Opens a deck.
    pub fn open(files: &'f dyn Files, name: &str) -> Result<Self, FileProblem> {
        let reader = read::open(files, name)?;
        Ok(Lines {
            files,
            stack: vec![OpenFile {
                name: name.into(),
                normal: normal(name),
                reader,
                line: 0,
            }],
            includes: 0,
            order: 0,
        })
    }

    /// The next line that isn't blank.
    pub fn next_line(&mut self) -> Result<Option<Line>, FileProblem> {
        while !self.stack.is_empty() {
            let Some((text, at)) = self.raw()? else {
                self.stack.pop();
                continue;
            };
            if let Some(rest) = include_operand(&text) {
                let name = self.include_name(rest, &at)?;
                self.include(&name, &at)?;
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

    /// Ends the innermost file at an `ENDDATA`; `false` where that is the deck itself. (Nastran ends everything at an included
    /// `ENDDATA`; what follows would be lost without a word.)
    pub fn end_file(&mut self) -> bool {
        self.stack.pop();
        !self.stack.is_empty()
    }

    /// A line of the innermost file as it stands; `None` at its end.
    fn raw(&mut self) -> Result<Option<(String, At)>, FileProblem> {
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
            .map_err(|error| {
                at.problem(
                    format!("the file can't be read on: {error}"),
                    "it may have been cut or damaged on its way here",
                )
            })?;
        if bytes.is_empty() {
            return Ok(None);
        }
        if bytes.len() as u64 == LONGEST_LINE || bytes.contains(&0) {
            return Err(at.problem(
                "this is no text of bulk data",
                "give the deck (.bdf, .dat, .nas), not a database or result file",
            ));
        }
        let text = bytes
            .iter()
            .map(|&b| if b.is_ascii() { char::from(b) } else { '?' })
            .collect::<String>();
        Ok(Some((text.trim_end().to_string(), at)))
    }

    /// The file name of an `INCLUDE`, which may go on over several lines inside one pair of quotes.
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

    /// Opens an included file: beside the including file, beside the deck, or beside the model.
    fn include(&mut self, name: &str, at: &At) -> Result<(), FileProblem> {
        self.includes += 1;
        if self.stack.len() >= DEEPEST || self.includes > MOST_INCLUDES {
            return Err(at.problem(
                format!("INCLUDE '{name}': too many files include each other"),
                "look for files that include themselves",
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
                    format!("INCLUDE '{name}' goes round in a circle: {circle}"),
                    "remove one of these INCLUDE lines",
                ));
            }
            match read::open(self.files, candidate) {
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
            format!("INCLUDE '{name}': {why} (tried {})", candidates.join(", ")),
            "paths count from the including file, the deck or the folder of the model",
        ))
    }
}

/// A place without line, for a problem of the deck as a whole.
pub(super) fn whole(name: &str, problem: &str, advice: &str) -> FileProblem {
    FileProblem {
        file: name.into(),
        place: Place::File,
        problem: problem.into(),
        advice: advice.into(),
    }
}

fn before_comment(text: &str) -> &str {
    text.split('$').next().unwrap_or("")
}

/// What follows the word `INCLUDE`; `None` on any other line.
fn include_operand(text: &str) -> Option<String> {
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

/// Names under which an included file may be found, best first. A logical prefix (`VAR:file`) can't be known here and is left out.
fn candidates(beside: &[&str], name: &str) -> Vec<String> {
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
fn normal(path: &str) -> String {
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
    } else {
        joined
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_included_files() {
        assert_eq!(normal("./a/../b//c.bdf"), "b/c.bdf");
        assert_eq!(normal("../a"), "../a");
        assert_eq!(
            candidates(&["sub/main.bdf", "m"], "x.bdf"),
            ["sub/x.bdf", "x.bdf"]
        );
        assert_eq!(candidates(&["main.bdf"], "..\\x.bdf"), ["../x.bdf"]);
        assert_eq!(candidates(&["m"], "DIR:x.bdf"), ["DIR:x.bdf", "x.bdf"]);
        assert_eq!(candidates(&["a/m", "b/c/m"], "/x/./y"), ["/x/y"]);
    }

    #[test]
    fn only_include_lines_include() {
        assert_eq!(include_operand("include 'a'").as_deref(), Some("'a'"));
        assert_eq!(include_operand("INCLUDE='a b'").as_deref(), Some("'a b'"));
        assert_eq!(include_operand("INCLUDED 1"), None);
        assert_eq!(include_operand("INC"), None);
    }
}
