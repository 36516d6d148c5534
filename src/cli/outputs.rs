//! Refuses outputs that would replace a file: one that the command reads, another output, or one that only
//! Eng writes.

use crate::results::may_be_folder;
use std::path::{Path, PathBuf};

/// Endings of models, and of the files that runs write and read again.
const OURS: [&str; 4] = ["eng", "parquet", "arrows", "checkpoint"];

/// A file that an option of the command line names.
pub(super) struct Output {
    /// `--out`
    pub option: &'static str,
    pub path: PathBuf,
}

impl Output {
    pub fn new(option: &'static str, path: impl Into<PathBuf>) -> Output {
        Output {
            option,
            path: path.into(),
        }
    }

    fn text(&self) -> String {
        format!("{} {}", self.option, self.path.display())
    }

    /// Refuses the ending of a model or of a result file, because such a name was probably meant as the
    /// input.
    pub fn is_foreign(&self) -> Result<(), String> {
        let ending = self.path.extension().unwrap_or_default().to_string_lossy();
        match OURS.iter().find(|ours| ending.eq_ignore_ascii_case(ours)) {
            Some(ours) => Err(format!(
                "{}: .{ours} is the ending of {}, which are not overwritten; give another name",
                self.text(),
                match *ours {
                    "eng" => "models",
                    _ => "results",
                }
            )),
            None => Ok(()),
        }
    }
}

/// Refuses an output that is an input, and two outputs that are one file. Links are followed.
pub(super) fn apart(inputs: &[PathBuf], outputs: &[Output]) -> Result<(), String> {
    let inputs: Vec<PathBuf> = inputs.iter().map(|input| place(input)).collect();
    let places: Vec<PathBuf> = outputs.iter().map(|output| place(&output.path)).collect();
    for (index, (output, here)) in outputs.iter().zip(&places).enumerate() {
        if inputs.contains(here) {
            return Err(format!(
                "{}: the command reads this file; give another name",
                output.text()
            ));
        }
        let other = outputs.iter().zip(&places).take(index);
        if let Some((other, _)) = other.into_iter().find(|(_, there)| *there == here) {
            return Err(format!(
                "{} and {} are one file; give each a name of its own",
                other.text(),
                output.text()
            ));
        }
    }
    Ok(())
}

/// Refuses an option whose path cannot be a folder.
pub(super) fn folder(option: &str, path: Option<&Path>) -> Result<(), String> {
    let refused = |error| format!("{option}: {error}");
    path.map_or(Ok(()), |path| may_be_folder(path).map_err(refused))
}

/// The target of a path, which need not exist yet.
fn place(path: &Path) -> PathBuf {
    let in_folder = || {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        Some(folder.canonicalize().ok()?.join(path.file_name()?))
    };
    path.canonicalize()
        .ok()
        .or_else(in_folder)
        .or_else(|| std::path::absolute(path).ok())
        .unwrap_or_else(|| path.to_owned())
}
