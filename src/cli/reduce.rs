//! `eng reduce`.

use super::arguments::{BodyTarget, ReduceArguments};
use super::open::checked;
use super::outputs::folder;
use super::terminal::Terminal;
use super::{MODEL_WRONG, Refusal, Stop, USAGE_OR_SYSTEM};
use crate::regular;
use crate::results::replace_file;
use crate::{BodyFile, BodyFormat, HandOverError, Reduction};
use eng_flexible::read::matrix::{ForeignModes, read_modes, shape_format};
use eng_flexible::{Files, FlexibleError};
use std::io::{self, Read, Write as _};
use std::path::{Path, PathBuf};

/// The reason why bodies were not written or compared.
#[derive(Debug, thiserror::Error)]
enum Refused {
    #[error("--body selects bodies for --to and --compare; neither is given")]
    OnlyBody,
    #[error(
        "{}: it does not begin as a file of mode shapes: OP2, punch file, .frd of CalculiX or universal file",
        .0.display()
    )]
    NoShapes(PathBuf),
    #[error("{0}; {advice}", advice = .0.advice())]
    Shapes(FlexibleError),
    #[error("--first-point is for the formats dmig and abaqus; the others have no points")]
    NoPoints,
    #[error(transparent)]
    HandOver(#[from] HandOverError),
    #[error("there is no flexible body {asked}; the flexible bodies are: {known}")]
    Unknown { asked: String, known: String },
    #[error(
        "two models have different bodies with the name {0}, whose files would have one name: write one model in a file of its own"
    )]
    TwoBodies(String),
    #[error("{}: {source}", path.display())]
    File { path: PathBuf, source: io::Error },
}

/// A file of the command line, by whatever name it is opened.
struct OnDisk<'p>(&'p Path);

impl Files for OnDisk<'_> {
    fn open(&self, _: &str) -> io::Result<Box<dyn Read>> {
        Ok(Box::new(regular::open(self.0)?))
    }
}

/// The mode shapes to compare with.
fn shapes(file: &Path) -> Result<ForeignModes, Refused> {
    let (path, name) = (file.to_owned(), file.to_string_lossy());
    let files = OnDisk(file);
    if let Err(source) = files.open(&name) {
        return Err(Refused::File { path, source });
    }
    let format = shape_format(&files, &name).ok_or(Refused::NoShapes(path))?;
    read_modes(&files, &name, format).map_err(Refused::Shapes)
}

pub(super) fn reduce(arguments: &ReduceArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    if let Err(problem) = folder("--out", arguments.out.as_deref()) {
        return refuse(problem, console);
    }
    let compared = match arguments.compare.as_deref().map(shapes).transpose() {
        Ok(compared) => compared,
        Err(error) => return refuse(error, console),
    };
    if !arguments.body.is_empty() && arguments.to.is_none() && compared.is_none() {
        return refuse(Refused::OnlyBody, console);
    }
    let program = checked(&arguments.model, console)?;
    let (reductions, messages) = program
        .reduce()
        .map_err(|error| Refusal::from(error).show(program.texts(), console))?;
    if reductions.is_empty() && messages.is_empty() {
        writeln!(
            console.output,
            "{} has no flexible body",
            arguments.model.display()
        )?;
        return Ok(());
    }
    console.errors.messages(&messages, program.texts())?;
    if !messages.has_errors()
        && let Err(error) = all_known(arguments, &reductions)
    {
        return refuse(error, console);
    }
    // before anything is printed, because the reader of the output may close it
    let written = match (arguments.to, &arguments.out) {
        (Some(to), Some(out)) if !messages.has_errors() => {
            hand_over(arguments, &reductions, to, out, console)?
        }
        _ => Vec::new(),
    };
    let mut texts = Vec::new();
    for reduction in &reductions {
        let mut text = reduction.text();
        if let Some(shapes) = compared.as_ref().filter(|_| is_asked(arguments, reduction)) {
            match reduction.compared(shapes) {
                Ok(lines) => text += &lines,
                Err(error) => return refuse(Refused::Shapes(error), console),
            }
        }
        // bodies of one component have the same reduction
        if !texts.contains(&text) {
            write!(console.output, "{text}")?;
            texts.push(text);
        }
    }
    for path in written {
        writeln!(console.output, "wrote {}", path.display())?;
    }
    match messages.has_errors() {
        true => Err(Stop::Code(MODEL_WRONG)),
        false => Ok(()),
    }
}

/// Stops with a message about the use of the command.
fn refuse(problem: impl std::fmt::Display, console: &mut Terminal<'_>) -> Result<(), Stop> {
    writeln!(console.errors, "error: {problem}")?;
    Err(Stop::Code(USAGE_OR_SYSTEM))
}

/// Refuses names of bodies that the program does not have.
fn all_known(arguments: &ReduceArguments, reductions: &[Reduction]) -> Result<(), Refused> {
    let known = reductions.iter().map(Reduction::path).collect::<Vec<_>>();
    let unknown = arguments
        .body
        .iter()
        .find(|body| !known.contains(&body.as_str()));
    match unknown {
        None => Ok(()),
        Some(asked) => Err(Refused::Unknown {
            asked: asked.clone(),
            known: known.join(", "),
        }),
    }
}

/// Writes the bodies for another code.
fn hand_over(
    arguments: &ReduceArguments,
    reductions: &[Reduction],
    to: BodyTarget,
    out: &Path,
    console: &mut Terminal<'_>,
) -> Result<Vec<PathBuf>, Stop> {
    match written(arguments, reductions, to, out) {
        Ok(paths) => {
            for reduction in reductions {
                let left_out = reduction.left_out();
                if !left_out.is_empty() && is_asked(arguments, reduction) {
                    writeln!(
                        console.errors,
                        "note: the matrices of {} leave out: {}",
                        reduction.path(),
                        left_out.join(", ")
                    )?;
                }
            }
            Ok(paths)
        }
        Err(error) => {
            writeln!(console.errors, "error: {error}")?;
            Err(Stop::Code(USAGE_OR_SYSTEM))
        }
    }
}

fn is_asked(arguments: &ReduceArguments, reduction: &Reduction) -> bool {
    arguments.body.is_empty() || arguments.body.iter().any(|body| body == reduction.path())
}

fn written(
    arguments: &ReduceArguments,
    reductions: &[Reduction],
    to: BodyTarget,
    out: &Path,
) -> Result<Vec<PathBuf>, Refused> {
    let format = match to {
        BodyTarget::Numpy => BodyFormat::Numpy,
        BodyTarget::Op4 => BodyFormat::Op4,
        BodyTarget::Dmig => BodyFormat::Dmig,
        BodyTarget::Abaqus => BodyFormat::Abaqus,
        BodyTarget::Mbdyn => BodyFormat::Mbdyn,
    };
    if arguments.first_point.is_some() && !format.has_points() {
        return Err(Refused::NoPoints);
    }
    // nothing is written unless all files can be made
    let mut files: Vec<BodyFile> = Vec::new();
    let mut first = arguments.first_point.unwrap_or(1);
    let mut numbered = Vec::new();
    for reduction in reductions.iter().filter(|r| is_asked(arguments, r)) {
        // several models may hold one body
        if numbered.contains(&(reduction.path(), reduction.text())) {
            continue;
        }
        numbered.push((reduction.path(), reduction.text()));
        let own = reduction.files(format, first)?;
        first += reduction.points(format);
        for file in own {
            match files.iter().find(|known| known.name == file.name) {
                None => files.push(file),
                Some(known) if *known == file => {}
                Some(_) => return Err(Refused::TwoBodies(reduction.path().to_owned())),
            }
        }
    }
    let mut paths = Vec::with_capacity(files.len());
    for file in files {
        let path = out.join(&file.name);
        replace_file(&path, |target| target.write_all(&file.contents)).map_err(|source| {
            Refused::File {
                path: path.clone(),
                source,
            }
        })?;
        paths.push(path);
    }
    Ok(paths)
}
