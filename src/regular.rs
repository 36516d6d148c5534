//! Reading of files, which must be regular: a pipe could block the program, and a device may have no end.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The file that a path leads to, links followed.
///
/// # Errors
/// A folder, a pipe or a device at the path, or no file.
pub(crate) fn regular(path: &Path) -> io::Result<PathBuf> {
    let found = std::fs::metadata(path)?;
    if found.is_file() {
        std::fs::canonicalize(path)
    } else if found.is_dir() {
        Err(io::Error::new(
            io::ErrorKind::IsADirectory,
            "this is a folder, not a file",
        ))
    } else {
        Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "this is no file, but a pipe or a device",
        ))
    }
}

/// Opens a regular file for reading.
pub fn open(path: &Path) -> io::Result<File> {
    File::open(regular(path)?)
}

/// The bytes of a regular file.
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}
