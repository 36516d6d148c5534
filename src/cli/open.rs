//! Opens the model that a command names.

use super::Refusal;
use super::terminal::Terminal;
use super::{MODEL_WRONG, Stop};
use crate::program::{Checked, Program};
use crate::sources::Sources;
use eng_grammar::SourceMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Reads a model and everything it uses, and checks it. Reduced bodies are kept in the user's cache.
///
/// # Errors
/// A file or folder that can't be read.
pub(super) fn open(model: &Path) -> Result<Checked, Refusal> {
    let file = model
        .file_name()
        .and_then(|n| n.to_str())
        .ok_or_else(|| Refusal::System(format!("{} is not a file", model.display())))?;
    let folder = match model.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    if !model.is_file() {
        return Err(Refusal::System(match model.exists() {
            true => format!("{} is no file", model.display()),
            false => format!("there is no file {}", model.display()),
        }));
    }
    let mut sources = Sources::folder(folder).map_err(|e| Refusal::System(e.to_string()))?;
    if let Some(cache) = cache_folder(|name| std::env::var_os(name)) {
        sources = sources.with_cache(cache);
    }
    Ok(crate::check(&sources, file))
}

/// A model without errors; the messages of its check are shown.
pub(super) fn checked(model: &Path, console: &mut Terminal<'_>) -> Result<Program, Stop> {
    let checked = match open(model) {
        Ok(checked) => checked,
        Err(refusal) => return Err(refusal.show(&SourceMap::new(), console)),
    };
    let report = checked.report();
    console
        .errors
        .messages(report.diagnostics(), report.texts())?;
    checked.program().cloned().ok_or(Stop::Code(MODEL_WRONG))
}

/// The folder of reduced bodies: `ENG_CACHE` (empty for none), otherwise a folder of the user's caches.
pub(super) fn cache_folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    if let Some(folder) = variable("ENG_CACHE") {
        return (!folder.is_empty()).then(|| PathBuf::from(folder));
    }
    let set = |name: &str| variable(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    set("XDG_CACHE_HOME")
        .or_else(|| set("LOCALAPPDATA"))
        .or_else(|| {
            let home = set("HOME")?;
            Some(if cfg!(target_os = "macos") {
                home.join("Library").join("Caches")
            } else {
                home.join(".cache")
            })
        })
        .map(|folder| folder.join("eng"))
}
