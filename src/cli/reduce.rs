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
    #[error(transparent)]
    HandOver(#[from] HandOverError),
    #[error("there is no flexible body {asked}: {known}")]
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
    let mut texts = Vec::new();
    for reduction in &reductions {
        let text = reduction.text();
        // bodies of one component have the same reduction
        if !texts.contains(&text) {
            write!(console.output, "{text}")?;
            texts.push(text);
        }
    }
    if messages.has_errors() {
        return Err(Stop::Code(MODEL_WRONG));
    }
    match (arguments.to, &arguments.out) {
        (Some(to), Some(out)) => hand_over(arguments, &reductions, to, out, console),
        _ => Ok(()),
    }
}

/// Writes the bodies for another code.
fn hand_over(
    arguments: &ReduceArguments,
    reductions: &[Reduction],
    to: BodyTarget,
    out: &Path,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
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
            for path in paths {
                writeln!(console.output, "wrote {}", path.display())?;
            }
            Ok(())
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
    };
    // nothing is written unless all files can be made
    let mut files: Vec<BodyFile> = Vec::new();
    for reduction in reductions.iter().filter(|r| is_asked(arguments, r)) {
        for file in reduction.files(format, arguments.first_point)? {
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
