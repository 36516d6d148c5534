//! Programs of others that a test needs and that may be missing.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The first of these programs that exists.
pub fn find(names: &[&str]) -> Option<PathBuf> {
    let folders: Vec<PathBuf> = std::env::var_os("PATH")
        .map(|path| std::env::split_paths(&path).collect())
        .unwrap_or_default();
    names
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)))
        .find(|path| path.is_file())
}

/// A program by an environment variable, or by its usual names.
pub fn find_or(variable: &str, names: &[&str]) -> Option<PathBuf> {
    std::env::var_os(variable)
        .map(PathBuf::from)
        .or_else(|| find(names))
}

/// Prints the reason for which a test is skipped. If `ENG_TEST_TOOLS=required` is set, a missing
/// tool is a failure.
pub fn skip(what: &str) {
    let required = std::env::var("ENG_TEST_TOOLS").is_ok_and(|v| v == "required");
    assert!(!required, "{what} is required but missing");
    eprintln!("SKIPPED: {what} is not installed; report/tests/install-tools.sh installs it");
}

/// Runs a program and gives its output; its errors go to the test's.
pub fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    eprintln!("{}", String::from_utf8_lossy(&output.stderr));
    output
}

/// A folder for the files of tests.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A file beside the tests.
pub fn beside(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join("report")
        .join(name)
}
