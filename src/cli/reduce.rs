//! `eng reduce`.

use super::arguments::{BodyTarget, ReduceArguments};
use super::open::checked;
use super::outputs::folder;
use super::terminal::Terminal;
use super::{MODEL_WRONG, Refusal, Stop, USAGE_OR_SYSTEM};
use crate::results::replace_file;
use crate::{BodyFile, BodyFormat, HandOverError, Reduction};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The reason why bodies were not written.
#[derive(Debug, thiserror::Error)]
enum Refused {
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
    File {
        path: PathBuf,
        source: std::io::Error,
    },
}

pub(super) fn reduce(arguments: &ReduceArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    if let Err(problem) = folder("--out", arguments.out.as_deref()) {
        writeln!(console.errors, "error: {problem}")?;
        return Err(Stop::Code(USAGE_OR_SYSTEM));
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
    // before anything is printed, because the reader of the output may close it
    let written = match (arguments.to, &arguments.out) {
        (Some(to), Some(out)) if !messages.has_errors() => {
            hand_over(arguments, &reductions, to, out, console)?
        }
        _ => Vec::new(),
    };
    let mut texts = Vec::new();
    for reduction in &reductions {
        let text = reduction.text();
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
    let known = reductions.iter().map(Reduction::path).collect::<Vec<_>>();
    if let Some(asked) = arguments
        .body
        .iter()
        .find(|body| !known.contains(&body.as_str()))
    {
        return Err(Refused::Unknown {
            asked: asked.clone(),
            known: known.join(", "),
        });
    }
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
