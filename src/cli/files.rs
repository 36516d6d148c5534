//! The files of a run.

use super::arguments::RunArguments;
use super::terminal::Terminal;
use super::{Stop, USAGE_OR_SYSTEM};
use crate::figures::Wanted;
use crate::plot;
use crate::post::Run;
use crate::results::{failed_twin, replace_file, stem_of};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The default folder of results.
pub(super) fn results_folder(model: &Path) -> PathBuf {
    let name = model.file_name().unwrap_or_default();
    let stem = model.file_stem().unwrap_or_default();
    // a stem of points alone would name another folder: `..` the parent, `.` the folder of all models
    match stem.to_string_lossy().trim_matches('.').is_empty() {
        true => Path::new("results").join(name),
        false => Path::new("results").join(stem),
    }
}

/// The folder of the results of a run.
pub(super) fn folder_of(arguments: &RunArguments) -> PathBuf {
    let stated = arguments.out.clone();
    stated.unwrap_or_else(|| results_folder(&arguments.model))
}

/// The file in a default folder of results that names their text.
const TEXT: &str = ".text";

/// Keeps the results of another text: texts in several folders may have one file name, and so one default folder.
///
/// # Errors
/// Results of another text that is still there; a folder that cannot be written.
pub(super) fn claim(arguments: &RunArguments, folder: &Path) -> Result<(), String> {
    match (&arguments.out, std::env::current_dir()) {
        (None, Ok(here)) => claim_from(&here, &arguments.model, folder),
        // the folder was chosen for these results
        _ => Ok(()),
    }
}

/// `claim` with the current folder, to which the paths are relative.
pub fn claim_from(here: &Path, model: &Path, folder: &Path) -> Result<(), String> {
    let (Ok(here), Ok(text)) = (here.canonicalize(), here.join(model).canonicalize()) else {
        return Ok(());
    };
    // relative, because folders with results and texts are moved and copied
    let own = text.strip_prefix(&here).unwrap_or(&text);
    let own = own.to_string_lossy().into_owned();
    let results = here.join(folder);
    let note = results.join(TEXT);
    let known = crate::regular::read(&note).unwrap_or_default();
    let known = String::from_utf8_lossy(&known).into_owned();
    if known == own {
        return Ok(());
    }
    if !known.is_empty() && here.join(&known).is_file() && has_results(&results) {
        return Err(format!(
            "{} has the results of {known}: choose another folder for those of {own} by --out",
            folder.display()
        ));
    }
    let written: io::Result<()> = replace_file(&note, |file| file.write_all(own.as_bytes()));
    written.map_err(|error| format!("{}: {error}", note.display()))
}

/// Whether a folder has samples, also of a run that was interrupted.
fn has_results(folder: &Path) -> bool {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).any(|path| {
        path.extension()
            .is_some_and(|end| end == "parquet" || end == "arrows")
    })
}

/// Writes figures: names (without extension) and SVG texts.
pub(super) fn draw(
    figures: Vec<(String, String)>,
    failed: bool,
    folder: &Path,
    arguments: &RunArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    for (name, svg) in figures {
        let written = plot::write_svg_and_png(&svg, folder, &stem_of(&name, failed));
        for path in or_stop(written, console)? {
            wrote(&path, arguments, console)?;
        }
    }
    Ok(())
}

/// Draws figures that no `report` block states. A figure that the results do not give is named on the console.
pub(super) fn draw_all(
    wanted: &[Wanted],
    runs: &[Run<'_>],
    failed: bool,
    folder: &Path,
    arguments: &RunArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let mut figures = Vec::new();
    for wanted in wanted {
        match wanted.draw(runs) {
            Ok(figure) => figures.push((wanted.name.clone(), figure.to_svg())),
            Err(error) => writeln!(
                console.errors,
                "warning: {} is not drawn: {error}",
                wanted.title
            )?,
        }
    }
    draw(figures, failed, folder, arguments, console)
}

/// Removes the file of an earlier failed run, which is out of date beside a whole one.
fn remove_failed(path: &Path) {
    if let Some(twin) = failed_twin(path) {
        // if it cannot be removed, its name still marks it as failed
        let _ = std::fs::remove_file(twin);
    }
}

/// Prints the name of a written file.
pub(super) fn wrote(
    path: &Path,
    arguments: &RunArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    remove_failed(path);
    if !arguments.quiet {
        writeln!(console.output, "  wrote {}", path.display())?;
    }
    Ok(())
}

/// Prints the name of a file that an earlier run has completed.
pub(super) fn complete(
    path: &Path,
    arguments: &RunArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    remove_failed(path);
    if !arguments.quiet {
        writeln!(
            console.output,
            "  {} is complete, nothing was written",
            path.display()
        )?;
    }
    Ok(())
}

/// The value, or the error on the console.
pub(super) fn or_stop<T, E: std::fmt::Display>(
    result: Result<T, E>,
    console: &mut Terminal<'_>,
) -> Result<T, Stop> {
    match result {
        Ok(value) => Ok(value),
        Err(error) => {
            writeln!(console.errors, "error: {error}")?;
            Err(Stop::Code(USAGE_OR_SYSTEM))
        }
    }
}
