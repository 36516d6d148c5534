//! The files of a run.

use super::arguments::RunArguments;
use super::terminal::Terminal;
use super::{Stop, USAGE_OR_SYSTEM};
use crate::figures::Wanted;
use crate::plot;
use crate::post::Run;
use crate::results::{failed_twin, stem_of};
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

/// Prints the names of written files.
pub(super) fn wrote(
    path: &Path,
    arguments: &RunArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    // files of an earlier failed run are out of date; if one cannot be removed, its name still marks it as
    // failed
    if let Some(twin) = failed_twin(path) {
        let _ = std::fs::remove_file(twin);
    }
    if !arguments.quiet {
        writeln!(console.output, "  wrote {}", path.display())?;
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
