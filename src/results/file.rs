//! Writing of files that are either whole or absent.

use super::ResultsError;
use crate::regular::regular;
use std::fs::{File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// The target of writing: the file that a path leads to, or the path itself if there is none.
///
/// # Errors
/// A folder, a device or a pipe at the path.
pub fn target(path: &Path) -> io::Result<PathBuf> {
    match regular(path) {
        // a link without a target is replaced; the creation of the folder reports a file in its place
        Err(error)
            if matches!(
                error.kind(),
                io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
            ) =>
        {
            Ok(path.to_owned())
        }
        found => found,
    }
}

/// Refuses a path that cannot be a folder, without making it. The error names the file in place of the folder
/// or of a parent.
pub(crate) fn may_be_folder(folder: &Path) -> io::Result<()> {
    let in_the_way = folder
        .ancestors()
        .find_map(|above| Some((above, std::fs::symlink_metadata(above).ok()?)));
    let what = match in_the_way {
        Some((above, found)) if found.is_symlink() && !above.exists() => {
            Some((above, "a link that leads nowhere"))
        }
        Some((above, _)) if above.is_file() => Some((above, "a file")),
        _ => None,
    };
    what.map_or(Ok(()), |(above, what)| {
        let message = format!("{} is {what}, not a folder", above.display());
        Err(io::Error::new(io::ErrorKind::NotADirectory, message))
    })
}

/// Makes a folder and those above it.
pub(super) fn make_folder(folder: &Path) -> io::Result<()> {
    std::fs::create_dir_all(folder).or_else(|error| may_be_folder(folder).and(Err(error)))
}

/// Refuses a link. Otherwise anyone who can put a link into the folder of results could choose the
/// overwritten file.
pub fn refuse_link(path: &Path) -> io::Result<()> {
    match std::fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "this is a link, and a run writes no unfinished results through one: remove it",
        )),
        _ => Ok(()),
    }
}

/// Writes a file under a temporary name beside it, then renames it. So `path` is never half-written, and
/// keeps its old contents if writing fails. It creates the folder and follows a link.
pub fn replace_file<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), E>,
) -> Result<(), E> {
    let path = &target(path)?;
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    make_folder(folder)?;
    let (mut file, temporary) = create_beside(folder, path)?;
    let written = write(&mut file)
        .and_then(|()| file.sync_all().map_err(E::from))
        .and_then(|()| std::fs::rename(&temporary, path).map_err(E::from));
    if written.is_err() {
        // the first error is the one to report
        let _ = std::fs::remove_file(&temporary);
    }
    written
}

/// Removes a file, if there is one.
pub fn remove_if_there(path: &Path) -> Result<(), ResultsError> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(ResultsError::File {
            path: path.to_owned(),
            source,
        }),
        _ => Ok(()),
    }
}

/// Whether the name of a file has an ending.
pub(super) fn has_ending(path: &Path, ending: &str) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy());
    name.is_some_and(|name| name.ends_with(ending))
}

/// Removes temporary files of [`replace_file`] for a path that killed processes left. No other process may be
/// writing the path. Files that cannot be removed remain and do no harm.
pub fn remove_leftovers(path: &Path) {
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else {
        return;
    };
    let begin = format!(".{}.", name.to_string_lossy());
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let found = entry.file_name();
        let found = found.to_string_lossy();
        let process = found
            .strip_prefix(&begin)
            .and_then(|rest| rest.strip_suffix(".part"));
        if process.is_some_and(|p| p.chars().all(|c| c.is_ascii_digit() || c == '-')) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Tests whether a file can be written, without changing its contents. Creates its folder.
pub fn writable(path: &Path) -> Result<(), super::ResultsError> {
    let refused = |source| super::ResultsError::File {
        path: path.to_owned(),
        source,
    };
    let path = &target(path).map_err(refused)?;
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    make_folder(folder).map_err(refused)?;
    let (file, temporary) = create_beside(folder, path).map_err(refused)?;
    drop(file);
    std::fs::remove_file(temporary).map_err(refused)
}

fn create_beside(folder: &Path, path: &Path) -> io::Result<(File, PathBuf)> {
    let name = path
        .file_name()
        .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "the path has no file name"))?;
    let process = std::process::id();
    let mut attempt = 0;
    loop {
        let temporary = folder.join(format!(
            ".{}.{process}-{attempt}.part",
            name.to_string_lossy()
        ));
        match OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&temporary)
        {
            Ok(file) => return Ok((file, temporary)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempt < 99 => {
                attempt += 1;
            }
            Err(error) => return Err(error),
        }
    }
}

/// An analysis's name as the beginning of a file name. Characters that some file system refuses become `_`.
pub fn file_stem(analysis: &str) -> String {
    let stem: String = analysis
        .chars()
        .map(|c| match c {
            '/' | '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|' => '_',
            c if c.is_control() => '_',
            c => c,
        })
        .collect();
    if stem.trim_matches(['.', ' ']).is_empty() {
        "analysis".to_owned()
    } else {
        stem
    }
}
