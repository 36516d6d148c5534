//! `eng report`.

use super::arguments::ReportArguments;
use super::files::{or_stop, results_folder};
use super::open::checked;
use super::outputs::{self, Output, apart};
use super::run::chosen;
use super::terminal::Terminal;
use super::{Refusal, Stop, USAGE_OR_SYSTEM};
use crate::Quantity;
use crate::indexed::listed;
use crate::motion::SUFFIX;
use crate::plot::write_svg_and_png;
use crate::report::{At, Drawn, Entry, Made, Request, make, write_fields, write_series};
use crate::results::{
    Gradient, Results, ResultsError, file_stem, interrupted, read_gradients, replace_file,
};
use eng_flexible::store::{content_hash, hexadecimal};
use eng_system::Dimension;
use std::io::Write;
use std::path::{Path, PathBuf};

pub(super) fn report(arguments: &ReportArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let program = checked(&arguments.model, console)?;
    let moments = or_stop(moments(&arguments.stress_at), console)?;
    let names = chosen(&arguments.model, &arguments.analysis, &program, console)?;
    let folder = arguments
        .results
        .clone()
        .unwrap_or_else(|| results_folder(&arguments.model));
    or_stop(
        outputs::folder("--figures", arguments.figures.as_deref()),
        console,
    )?;
    or_stop(outputs::folder("--vtu", arguments.vtu.as_deref()), console)?;
    or_stop(
        outputs::folder("--fields", arguments.fields.as_deref()),
        console,
    )?;
    let mut found = read(&names, &folder, console)?;
    refuse_missing(&found, arguments, &folder, console)?;
    let in_time = found.in_time.len();
    found.in_time.append(&mut found.of_modes);
    let results: Vec<&Results> = found.in_time.iter().map(|read| &read.results).collect();
    let described = program
        .describe(&results)
        .map_err(|error| Refusal::from(error).show(program.texts(), console))?;
    let mut entries: Vec<Entry> = found
        .in_time
        .into_iter()
        .zip(described)
        .map(|(read, described)| {
            let mut entry = Entry::new(read.results, read.motion, described, read.files);
            entry.outcome.gradients = read.gradients;
            entry
        })
        .collect();
    let modes = entries.split_off(in_time);
    let file = arguments
        .model
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    let made = or_stop(
        make(Request {
            file: &file,
            entries: &entries,
            modes: &modes,
            missing: &found.missing,
            reports: program.reports(),
            command: &command(arguments),
            stress_at: &moments,
            drawn: arguments.figures.is_some(),
        }),
        console,
    )?;
    for warning in &made.warnings {
        writeln!(console.errors, "warning: {warning}")?;
    }
    let mut inputs = program.files();
    inputs.append(&mut found.inputs);
    or_stop(
        refuse_loss(
            &inputs,
            &files_of(&page_of(arguments, &folder), arguments, &made.figures),
        ),
        console,
    )?;
    let written = write_all(&made, &entries, arguments, &folder, console)?;
    if !arguments.quiet {
        for path in written {
            writeln!(console.output, "wrote {}", path.display())?;
        }
    }
    Ok(())
}

/// The results of an analysis, read from files.
struct Read {
    results: Results,
    motion: Option<Results>,
    gradients: Vec<Gradient>,
    /// Name and hash of each file.
    files: Vec<(String, String)>,
}

/// The results of some analyses in a folder.
#[derive(Default)]
struct Found {
    in_time: Vec<Read>,
    /// Modes and responses.
    of_modes: Vec<Read>,
    /// Names of the analyses without results.
    missing: Vec<String>,
    /// The files that were read.
    inputs: Vec<PathBuf>,
}

fn read(names: &[&str], folder: &Path, console: &mut Terminal<'_>) -> Result<Found, Stop> {
    let mut found = Found::default();
    for name in names {
        let file = |suffix: &str| folder.join(format!("{}{suffix}.parquet", file_stem(name)));
        let path = file("");
        if !path.is_file() {
            found.missing.push((*name).to_owned());
            continue;
        }
        let results = or_stop(Results::read_parquet(&path), console)?;
        found.inputs.push(path.clone());
        let mut read = Read {
            results,
            motion: None,
            gradients: Vec::new(),
            files: vec![or_stop(hashed(&path), console)?],
        };
        if read.results.are_responses() {
            writeln!(
                console.errors,
                "note: {name} is a frequency response: the page shows it in reports of the text; `eng results {}` lists its outputs",
                path.display()
            )?;
            found.of_modes.push(read);
            continue;
        }
        if read.results.are_modes() {
            writeln!(
                console.errors,
                "note: {name} holds modes: the page shows them in reports of the text, and their frequencies in Campbell diagrams; `eng results {}` lists them",
                path.display()
            )?;
            found.of_modes.push(read);
            continue;
        }
        let path = file(SUFFIX);
        if path.is_file() {
            read.files.push(or_stop(hashed(&path), console)?);
            found.inputs.push(path.clone());
            read.motion = Some(or_stop(Results::read_parquet(&path), console)?);
        }
        read.gradients = or_stop(read_gradients(folder, &read.results), console)?;
        found.in_time.push(read);
    }
    Ok(found)
}

/// Refuses a page without results over time, and a page without an analysis that the user named.
fn refuse_missing(
    found: &Found,
    arguments: &ReportArguments,
    folder: &Path,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let missing = &found.missing;
    if found.in_time.is_empty() && missing.is_empty() {
        writeln!(
            console.errors,
            "error: {} has no results for a page: run an analysis of a motion",
            folder.display()
        )?;
        return Err(Stop::Code(USAGE_OR_SYSTEM));
    }
    if !found.in_time.is_empty() && (missing.is_empty() || arguments.analysis.is_empty()) {
        return Ok(());
    }
    let begun: Vec<&str> = missing
        .iter()
        .map(String::as_str)
        .filter(|name| interrupted(folder, name))
        .collect();
    if !begun.is_empty() {
        writeln!(
            console.errors,
            "note: {} was interrupted: `--resume` continues where it stopped",
            begun.join(", ")
        )?;
    }
    writeln!(
        console.errors,
        "error: {} has no results of {}; run first: eng run {}{}{}",
        folder.display(),
        listed(missing.iter().map(String::as_str)),
        arguments.model.display(),
        if begun.is_empty() { "" } else { " --resume" },
        match &arguments.results {
            Some(folder) => format!(" --out {}", folder.display()),
            None => String::new(),
        }
    )?;
    Err(Stop::Code(USAGE_OR_SYSTEM))
}

/// Writes the page and the other requested files. Returns their paths.
fn write_all(
    made: &Made,
    entries: &[Entry],
    arguments: &ReportArguments,
    folder: &Path,
    console: &mut Terminal<'_>,
) -> Result<Vec<PathBuf>, Stop> {
    let out = page_of(arguments, folder);
    let mut written = vec![or_stop(write(&out, made.html.as_bytes()), console)?];
    if let Some(path) = &arguments.gltf {
        match &made.gltf {
            Some(bytes) => written.push(or_stop(write(path, bytes), console)?),
            None => {
                writeln!(
                    console.errors,
                    "error: the results have no motion; run the model again"
                )?;
                return Err(Stop::Code(USAGE_OR_SYSTEM));
            }
        }
    }
    if let Some(folder) = &arguments.figures {
        for drawn in &made.figures {
            let paths = write_svg_and_png(&drawn.svg, folder, &drawn.name);
            written.extend(or_stop(paths, console)?);
        }
    }
    if let Some(folder) = &arguments.fields {
        let count = written.len();
        for entry in entries {
            written.extend(or_stop(write_fields(entry, folder), console)?);
        }
        if written.len() == count {
            writeln!(
                console.errors,
                "warning: no analysis has films on cells with a motion: no cells are written"
            )?;
        }
    }
    if let Some(folder) = &arguments.vtu {
        let moved = entries.iter().find(|e| e.outcome.motion.is_some());
        let series = match moved.or(entries.first()) {
            Some(entry) => or_stop(write_series(entry, folder), console)?,
            None => None,
        };
        match series {
            Some(path) => written.push(path),
            None => writeln!(
                console.errors,
                "warning: no body is flexible: no series is written"
            )?,
        }
    }
    Ok(written)
}

/// The path of the page.
fn page_of(arguments: &ReportArguments, folder: &Path) -> PathBuf {
    let stated = arguments.out.clone();
    stated.unwrap_or_else(|| folder.join("report.html"))
}

/// The files that the command will write, except those of the VTU series, which have names of their own.
fn files_of(out: &Path, arguments: &ReportArguments, figures: &[Drawn]) -> Vec<Output> {
    let page = Output::new("--out", out);
    let scene = arguments.gltf.as_ref();
    let scene = scene.map(|path| Output::new("--gltf", path));
    let drawn = arguments.figures.iter().flat_map(|folder| {
        figures.iter().flat_map(move |drawn| {
            ["svg", "png"].map(|ending| {
                let name = format!("{}.{ending}", drawn.name);
                Output::new("--figures", folder.join(name))
            })
        })
    });
    std::iter::once(page).chain(scene).chain(drawn).collect()
}

/// Refuses outputs that would replace an input or another output.
fn refuse_loss(inputs: &[PathBuf], files: &[Output]) -> Result<(), String> {
    apart(inputs, files)?;
    files.iter().try_for_each(Output::is_foreign)
}

/// Angles and times from typed texts.
fn moments(typed: &[String]) -> Result<Vec<At>, String> {
    typed
        .iter()
        .map(|text| {
            let refusal = |reason: String| format!("--stress-at {text}: {reason}");
            let quantity: Quantity = text
                .parse()
                .map_err(|e: crate::QuantityError| refusal(e.to_string()))?;
            match quantity.dimension() {
                Dimension::ANGLE => Ok(At::Angle(quantity.value())),
                Dimension::TIME => Ok(At::Time(quantity.value())),
                _ => Err(refusal("neither an angle nor a time".to_owned())),
            }
        })
        .collect()
}

/// A file's name with the hash of its contents.
fn hashed(path: &Path) -> Result<(String, String), ResultsError> {
    let bytes = crate::regular::read(path).map_err(|source| ResultsError::File {
        path: path.to_owned(),
        source,
    })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok((name.into_owned(), hexadecimal(&content_hash(&bytes))))
}

fn write(path: &Path, bytes: &[u8]) -> Result<PathBuf, ResultsError> {
    replace_file(path, |file: &mut std::fs::File| file.write_all(bytes)).map_err(|source| {
        ResultsError::File {
            path: path.to_owned(),
            source,
        }
    })?;
    Ok(path.to_owned())
}

/// The command, in the form that a user would type.
fn command(arguments: &ReportArguments) -> String {
    let mut words = vec![format!("eng report {}", arguments.model.display())];
    for name in &arguments.analysis {
        words.push(format!("--analysis \"{name}\""));
    }
    let paths = [
        ("--results", &arguments.results),
        ("--out", &arguments.out),
        ("--gltf", &arguments.gltf),
        ("--vtu", &arguments.vtu),
        ("--figures", &arguments.figures),
    ];
    for (flag, path) in paths {
        if let Some(path) = path {
            words.push(format!("{flag} {}", path.display()));
        }
    }
    for moment in &arguments.stress_at {
        words.push(format!("--stress-at \"{moment}\""));
    }
    words.join(" ")
}
