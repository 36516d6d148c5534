//! `eng build`: a model as FMU, and the library for C.

use super::arguments::{BuildArguments, BuildTarget, FmiVersion};
use super::open::checked;
use super::outputs::{Output, apart, folder};
use super::terminal::Terminal;
use super::{Refusal, Stop, USAGE_OR_SYSTEM};
use crate::Program;
use crate::fmu::{Export, FmuError, Selected, Subject, Version};
use crate::results::replace_file;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The header of the library for C.
const HEADER: &str = include_str!("../../capi/include/eng.h");

/// The variable of the environment that names the library.
const LIBRARY: &str = "ENG_LIBRARY";

/// The way to the library.
const BUILD_IT: &str = "build it with `cargo build --release --package eng-capi`, and name it with --library or ENG_LIBRARY";

pub(super) fn build(arguments: &BuildArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let library = match library(arguments) {
        Ok(library) => library,
        Err(problem) => return refused(&problem, console),
    };
    match arguments.to {
        BuildTarget::Library => for_c(arguments, &library, console),
        BuildTarget::Fmu => fmu(arguments, &library, console),
    }
}

fn refused(problem: &str, console: &mut Terminal<'_>) -> Result<(), Stop> {
    writeln!(console.errors, "error: {problem}")?;
    Err(Stop::Code(USAGE_OR_SYSTEM))
}

/// The text before `=` and the version in the bytes of the library, as `eng_version` of `capi` has it.
const MARK: &[u8] = b"eng-library-version";

/// The library: the stated one, that of the environment, or one beside the command.
///
/// # Errors
/// No such file; a file that is no library of this version.
fn library(arguments: &BuildArguments) -> Result<PathBuf, String> {
    let library = named(arguments)?;
    let bytes = crate::regular::read(&library)
        .map_err(|error| format!("{}: {error}", library.display()))?;
    let (own, found) = (env!("CARGO_PKG_VERSION"), versions(&bytes));
    if found.contains(&own) {
        return Ok(library);
    }
    let problem = match found.first() {
        Some(other) => format!("is the library of Eng {other}, and this is Eng {own}"),
        None => "is no library of Eng".to_owned(),
    };
    Err(format!("{} {problem}: {BUILD_IT}", library.display()))
}

/// The versions behind the marks in the bytes of a library. The library is not loaded: it may be of another system.
pub fn versions(bytes: &[u8]) -> Vec<&str> {
    let (mut found, mut marked) = (Vec::new(), false);
    for part in bytes.split(|byte| *byte == b'=') {
        if marked {
            let version = part.split(|byte| matches!(byte, 0 | b'\n')).next();
            let version = version.filter(|version| version.len() < part.len());
            found.extend(version.and_then(|version| std::str::from_utf8(version).ok()));
        }
        marked = part.ends_with(MARK);
    }
    found
}

/// The file of the library.
fn named(arguments: &BuildArguments) -> Result<PathBuf, String> {
    let stated = arguments.library.clone();
    let stated = stated.or_else(|| {
        std::env::var_os(LIBRARY)
            .filter(|v| !v.is_empty())
            .map(PathBuf::from)
    });
    if let Some(library) = stated {
        return match library.is_file() {
            true => Ok(library),
            false => Err(format!("the library {} is no file", library.display())),
        };
    }
    let name = format!("{DLL_PREFIX}eng_c{DLL_SUFFIX}");
    let command = std::env::current_exe().unwrap_or_default();
    let here = command.parent().unwrap_or_else(|| Path::new(""));
    let places = [here.join(&name), here.join("../lib").join(&name)];
    places
        .iter()
        .find(|place| place.is_file())
        .cloned()
        .ok_or_else(|| format!("{name} is not beside the command: {BUILD_IT}"))
}

/// Copies the library and its header into a folder.
fn for_c(
    arguments: &BuildArguments,
    library: &Path,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from("."));
    if let Err(problem) = folder("--out", Some(&out)) {
        return refused(&problem, console);
    }
    let bytes = match crate::regular::read(library) {
        Ok(bytes) => bytes,
        Err(error) => return refused(&format!("{}: {error}", library.display()), console),
    };
    let named = format!("{DLL_PREFIX}eng{DLL_SUFFIX}");
    for (name, bytes) in [
        (named.as_str(), bytes.as_slice()),
        ("eng.h", HEADER.as_bytes()),
    ] {
        let path = out.join(name);
        if let Err(error) = replace_file(&path, |file| file.write_all(bytes)) {
            let error: std::io::Error = error;
            return refused(&format!("{}: {error}", path.display()), console);
        }
        writeln!(console.output, "wrote {}", path.display())?;
    }
    Ok(())
}

/// Writes a model as FMU.
fn fmu(arguments: &BuildArguments, library: &Path, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let Some(model) = &arguments.model else {
        return refused(
            "name the model's file: eng build MODEL.eng --to fmu",
            console,
        );
    };
    let program = checked(model, console)?;
    let subject = match subject(arguments, &program) {
        Ok(subject) => subject,
        Err(problem) => return refused(&problem, console),
    };
    let (Subject::Model(name) | Subject::Analysis(name)) = &subject;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{name}.fmu")));
    let output = Output::new("--out", &out);
    if let Err(problem) =
        apart(&program.files(), std::slice::from_ref(&output)).and_then(|()| output.is_foreign())
    {
        return refused(&problem, console);
    }
    let patterns = |texts: &[String]| {
        let parts = texts.iter().flat_map(|text| text.split(','));
        parts.map(|part| part.trim().to_owned()).collect::<Vec<_>>()
    };
    let export = Export {
        program: &program,
        subject,
        selected: Selected {
            parameters: patterns(&arguments.parameters),
            inputs: patterns(&arguments.inputs),
            outputs: patterns(&arguments.outputs),
        },
        version: match arguments.fmi {
            FmiVersion::Two => Version::Two,
            FmiVersion::Three => Version::Three,
        },
        library,
    };
    match export.write(&out) {
        Ok(written) => {
            let [parameters, inputs, outputs] = written.variables;
            writeln!(
                console.output,
                "wrote {}: {}, {}, {}",
                out.display(),
                crate::counted::counted(parameters, "parameter", "parameters"),
                crate::counted::counted(inputs, "input", "inputs"),
                crate::counted::counted(outputs, "output", "outputs")
            )?;
            if written.left_out > 0 {
                writeln!(
                    console.output,
                    "  {} left out, because the text computes {} from others; --parameters takes chosen ones",
                    crate::counted::counted(written.left_out, "parameter is", "parameters are"),
                    if written.left_out == 1 { "it" } else { "them" }
                )?;
            }
            Ok(())
        }
        Err(FmuError::Model(error)) => Err(Refusal::from(error).show(program.texts(), console)),
        Err(error) => refused(&error.to_string(), console),
    }
}

/// The simulated part of the file: the stated one, or the only model.
fn subject(arguments: &BuildArguments, program: &Program) -> Result<Subject, String> {
    if let Some(name) = &arguments.analysis {
        return Ok(Subject::Analysis(name.clone()));
    }
    match (&arguments.name, program.models().as_slice()) {
        (Some(name), _) => Ok(Subject::Model(name.clone())),
        (None, [only]) => Ok(Subject::Model((*only).to_owned())),
        (None, models) => Err(format!(
            "choose one with --model, or an analysis with --analysis; the models are: {}",
            models.join(", ")
        )),
    }
}
