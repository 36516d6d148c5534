//! `eng fmt`.

use super::arguments::FmtArguments;
use super::terminal::Terminal;
use super::{MODEL_WRONG, Stop, USAGE_OR_SYSTEM};
use crate::regular::regular;
use crate::results::replace_file;
use eng_compiler::resolve::{RETURN_ALONE, lone_return};
use eng_grammar::{Diagnostics, FormatError, SourceId, SourceMap};
use std::fs::OpenOptions;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Formats texts in their files, or the standard input.
pub(super) fn fmt(arguments: &FmtArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let mut code = 0;
    for path in &arguments.paths {
        let worst = match path.as_os_str() == "-" {
            true => standard_input(arguments.check, console)?,
            false => named(path, arguments.check, console)?,
        };
        code = code.max(worst);
    }
    match code {
        0 => Ok(()),
        code => Err(Stop::Code(code)),
    }
}

/// Formats the standard input to the output. Returns the exit code.
fn standard_input(check: bool, console: &mut Terminal<'_>) -> Result<u8, Stop> {
    let mut bytes = Vec::new();
    if let Err(error) = std::io::stdin().lock().read_to_end(&mut bytes) {
        writeln!(console.errors, "error: the standard input: {error}")?;
        return Ok(USAGE_OR_SYSTEM);
    }
    let Some(text) = readable("standard input", bytes, console)? else {
        return Ok(USAGE_OR_SYSTEM);
    };
    let Some(formed) = formed("standard input", &text, console)? else {
        return Ok(MODEL_WRONG);
    };
    if check {
        return listed("standard input", formed == text, console);
    }
    // a file or an editor gets the text, so none of its characters may change
    console.output.write_all(formed.as_bytes())?;
    Ok(0)
}

/// Formats a file, or all `.eng` files of a folder. Returns the exit code.
fn named(path: &Path, check: bool, console: &mut Terminal<'_>) -> Result<u8, Stop> {
    let files = match files(path) {
        Ok(files) => files,
        Err(error) => {
            writeln!(console.errors, "error: {}: {error}", path.display())?;
            return Ok(USAGE_OR_SYSTEM);
        }
    };
    let mut code = 0;
    for file in files {
        code = code.max(one(&file, check, console)?);
    }
    Ok(code)
}

/// The files that a path names, in order.
fn files(path: &Path) -> std::io::Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut files = Vec::new();
    let mut folders = vec![path.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder)? {
            let entry = entry?;
            let path = entry.path();
            let hidden = entry.file_name().to_string_lossy().starts_with('.');
            // a link could lead around in a circle
            let kind = entry.file_type()?;
            if kind.is_dir() && !hidden {
                folders.push(path);
            } else if kind.is_file() && path.extension().is_some_and(|end| end == "eng") {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

/// Formats one file. Returns the exit code.
fn one(path: &Path, check: bool, console: &mut Terminal<'_>) -> Result<u8, Stop> {
    let name = path.display().to_string();
    let bytes = match regular(path).and_then(std::fs::read) {
        Ok(bytes) => bytes,
        Err(error) => {
            writeln!(console.errors, "error: {name}: {error}")?;
            return Ok(USAGE_OR_SYSTEM);
        }
    };
    let Some(text) = readable(&name, bytes, console)? else {
        return Ok(USAGE_OR_SYSTEM);
    };
    let Some(formed) = formed(&name, &text, console)? else {
        return Ok(MODEL_WRONG);
    };
    if check {
        return listed(&name, formed == text, console);
    }
    if formed == text {
        return Ok(0);
    }
    let written = may_change(path).and_then(|()| {
        replace_file(path, |file| {
            file.set_permissions(std::fs::metadata(path)?.permissions())?;
            file.write_all(formed.as_bytes())
        })
    });
    match written {
        Ok(()) => {
            writeln!(console.output, "formatted {name}")?;
            Ok(0)
        }
        Err(error) => {
            writeln!(console.errors, "error: {name}: {error}")?;
            Ok(USAGE_OR_SYSTEM)
        }
    }
}

/// Refuses a file that may not be written. A new file in its place would only need rights on the folder.
fn may_change(path: &Path) -> io::Result<()> {
    if std::fs::metadata(path)?.permissions().readonly() {
        return Err(io::Error::new(
            io::ErrorKind::PermissionDenied,
            "this file is read-only and stays as it is: make it writable, or format a copy",
        ));
    }
    OpenOptions::new().write(true).open(path).map(drop)
}

/// Names a text that differs from its form. Returns the exit code.
fn listed(name: &str, is_formed: bool, console: &mut Terminal<'_>) -> Result<u8, Stop> {
    if is_formed {
        return Ok(0);
    }
    writeln!(console.output, "not formatted: {name}")?;
    Ok(MODEL_WRONG)
}

fn readable(
    name: &str,
    bytes: Vec<u8>,
    console: &mut Terminal<'_>,
) -> Result<Option<String>, Stop> {
    let refused = match crate::utf8::text(bytes) {
        Ok(text) if lone_return(&text).is_none() => return Ok(Some(text)),
        Ok(_) => RETURN_ALONE.to_owned(),
        Err(refused) => refused,
    };
    writeln!(console.errors, "error: {name}: {refused}")?;
    Ok(None)
}

/// The form of a text, or the reason why it has none.
fn formed(name: &str, text: &str, console: &mut Terminal<'_>) -> Result<Option<String>, Stop> {
    match eng_grammar::format(text, SourceId(0)) {
        Ok(formed) => Ok(Some(formed)),
        Err(FormatError::Unreadable(messages)) => {
            show(name, text, &messages, console)?;
            Ok(None)
        }
        Err(fault) => {
            writeln!(console.errors, "error: {name} is left as it is: {fault}")?;
            Ok(None)
        }
    }
}

fn show(
    name: &str,
    text: &str,
    messages: &Diagnostics,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let mut sources = SourceMap::new();
    sources.add(name, text);
    console.errors.messages(messages, &sources)?;
    Ok(())
}
