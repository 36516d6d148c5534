//! Files that are whole or absent.

use std::fs::{File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// Where a path leads: a link to the file that it stands for.
///
/// # Errors
/// What is there is no file: a device, a pipe.
fn regular(path: &Path) -> io::Result<PathBuf> {
    match std::fs::metadata(path) {
        Ok(found) if found.is_file() => std::fs::canonicalize(path),
        Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(_) => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "what is there is no file, but a pipe or a device",
        )),
        // a link that leads nowhere is replaced
        Err(_) => Ok(path.to_owned()),
    }
}

/// Opens a file to be read.
///
/// # Errors
/// What is there is no file: a pipe would be waited for, a device has no end.
pub(super) fn open(path: &Path) -> io::Result<File> {
    File::open(regular(path)?)
}

/// Refuses a link: who may put one into the folder of results would choose the file that is overwritten.
pub(super) fn refuse_link(path: &Path) -> io::Result<()> {
    match std::fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "this is a link, and a run writes no unfinished results through one: remove it",
        )),
        _ => Ok(()),
    }
}

/// Writes a file under a temporary name beside it, then renames it: `path` is never half-written, and keeps its old
/// content when writing fails. Creates the folder; a link is followed.
pub fn replace_file<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), E>,
) -> Result<(), E> {
    let path = &regular(path)?;
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder)?;
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

/// Removes what killed processes left of [`replace_file`] for a path. Nobody else may be writing it. What cannot be removed stays: it is in
/// nobody's way.
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

/// Finds out whether a file can be written, without touching what it holds; creates its folder.
pub fn writable(path: &Path) -> Result<(), super::ResultsError> {
    let refused = |source| super::ResultsError::File {
        path: path.to_owned(),
        source,
    };
    let path = &regular(path).map_err(refused)?;
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder).map_err(refused)?;
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

/// An analysis's name as the beginning of a file name: what some file system refuses becomes `_`.
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("eng-file-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        folder
    }

    #[test]
    fn leftovers_of_one_path_are_removed() {
        let folder = folder("leftovers");
        std::fs::create_dir_all(&folder).unwrap();
        let names = [
            ".a.txt.12-0.part",
            ".a.txt.x.part",
            ".b.txt.12-0.part",
            "a.txt",
        ];
        for name in names {
            std::fs::write(folder.join(name), name).unwrap();
        }
        remove_leftovers(&folder.join("a.txt"));
        let left = names.map(|name| folder.join(name).exists());
        assert_eq!(left, [false, true, true, true]);
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn keeps_the_old_content_when_writing_fails() {
        let folder = folder("keeps");
        let path = folder.join("a.txt");
        replace_file(&path, |f| f.write_all(b"old")).unwrap();
        let failed = replace_file(&path, |f| {
            f.write_all(b"ne")?;
            Err(io::Error::other("disk full"))
        });
        assert_eq!(failed.unwrap_err().to_string(), "disk full");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        replace_file(&path, |f| f.write_all(b"new")).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn stems_are_file_names() {
        assert_eq!(file_stem("sweep[3]"), "sweep[3]");
        assert_eq!(file_stem("a/b:c"), "a_b_c");
        assert_eq!(file_stem(".."), "analysis");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_devices_refused() {
        let folder = std::env::temp_dir().join(format!("eng-links-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (file, link) = (folder.join("file"), folder.join("link"));
        std::fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        let put = |path: &Path| replace_file(path, |out| io::Write::write_all(out, b"new"));
        put(&link).unwrap();
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        assert!(regular(Path::new("/dev/null")).is_err());
        assert!(open(Path::new("/dev/null")).is_err());
        assert!(open(&link).is_ok());
        assert!(refuse_link(&link).is_err());
        assert!(refuse_link(&file).is_ok() && refuse_link(&folder.join("none")).is_ok());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
