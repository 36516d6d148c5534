//! `eng new`.

use super::arguments::{NewArguments, Template};
use super::terminal::Terminal;
use super::{Stop, USAGE_OR_SYSTEM};
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

impl Template {
    /// The text of the model.
    fn text(self) -> &'static str {
        match self {
            Template::Engine => include_str!("new/engine.eng"),
            Template::Compressor => include_str!("new/compressor.eng"),
            Template::Pendulum => include_str!("new/pendulum.eng"),
        }
    }
}

/// Writes a first model into a new file.
pub(super) fn new(arguments: &NewArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let file = with_ending(&arguments.name);
    if let Err(error) = create(&file, arguments.from.text()) {
        let reason = match error.kind() {
            ErrorKind::AlreadyExists => "exists and is not replaced; give another name".to_owned(),
            ErrorKind::NotFound => {
                let folder = file.parent().unwrap_or(&file);
                format!("there is no folder {}; make it first", folder.display())
            }
            _ => error.to_string(),
        };
        writeln!(console.errors, "error: {}: {reason}", file.display())?;
        return Err(Stop::Code(USAGE_OR_SYSTEM));
    }
    let path = file.display().to_string();
    // a shell takes a path with blanks as one word only in quotes
    let word = match path.contains(char::is_whitespace) {
        true => format!("\"{path}\""),
        false => path.clone(),
    };
    writeln!(console.output, "wrote {path}; next:")?;
    for (command, purpose) in [
        ("check", "names, units, connections"),
        ("run", "all analyses, into results/"),
        ("report", "one page with figures and the motion"),
    ] {
        writeln!(console.output, "    eng {command:<6} {word}  # {purpose}")?;
    }
    Ok(())
}

/// The name with the ending `.eng`.
fn with_ending(name: &Path) -> PathBuf {
    match name.extension().is_some_and(|ending| ending == "eng") {
        true => name.to_owned(),
        false => {
            // `v1.2` keeps its last part: it is no ending
            let mut whole = name.as_os_str().to_owned();
            whole.push(".eng");
            PathBuf::from(whole)
        }
    }
}

/// Writes a file that does not exist yet. After a failure none is left.
fn create(file: &Path, text: &str) -> std::io::Result<()> {
    let mut opened = OpenOptions::new().write(true).create_new(true).open(file)?;
    opened.write_all(text.as_bytes()).inspect_err(|_| {
        // the first failure is reported
        let _ = std::fs::remove_file(file);
    })
}
