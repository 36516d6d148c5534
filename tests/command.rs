//! The `eng` command as a process: exit codes, texts and files that scripts use.

use crate::support::Temporary;
use std::process::{Command, Output};

fn eng(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_eng"))
        .args(arguments)
        .output()
        .expect("the command starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn help_names_the_commands_and_the_exit_codes() {
    let output = eng(&["--help"]);
    assert_eq!(output.status.code(), Some(0));
    let help = text(&output.stdout);
    for part in [
        "Usage: eng",
        "run ",
        "watch ",
        "check ",
        "explain ",
        "Exit codes: 0",
    ] {
        assert!(help.contains(part), "{part} in\n{help}");
    }
    let run = text(&eng(&["run", "--help"]).stdout);
    for flag in [
        "--analysis",
        "--set",
        "--out",
        "--csv",
        "--threads",
        "--no-plots",
        "--quiet",
    ] {
        assert!(run.contains(flag), "{flag} in\n{run}");
    }
}

#[test]
fn version_is_the_package_version() {
    let output = eng(&["--version"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(
        text(&output.stdout).trim(),
        format!("eng {}", env!("CARGO_PKG_VERSION"))
    );
}

#[test]
fn wrong_usage_exits_with_2_and_says_why() {
    let cases: [(&[&str], &str); 5] = [
        (&[], "Usage: eng"),
        (&["rum", "a.eng"], "run"),
        (&["run"], "MODEL"),
        (&["run", "a.eng", "--set", "speed"], "speed=5000 rpm"),
        (&["check", "a.eng", "--format", "xml"], "json"),
    ];
    for (arguments, hint) in cases {
        let output = eng(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        let errors = text(&output.stderr);
        assert!(errors.contains(hint), "{hint} in\n{errors}");
    }
}

#[test]
fn a_file_that_is_not_there_exits_with_2() {
    for command in ["run", "check"] {
        let output = eng(&[command, "no/such/model.eng"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains("no/such/model.eng"));
    }
}

/// A folder of its own, removed afterwards.
struct Texts(Temporary);

impl Texts {
    fn new(name: &str) -> Texts {
        let folder = Temporary::new(&format!("fmt-{name}"));
        std::fs::create_dir_all(folder.join("inner/.hidden")).expect("a folder");
        Texts(folder)
    }

    fn write(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, text).expect("a file");
        path.to_string_lossy().into_owned()
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).expect("a file")
    }
}

const MESSY: &str = "param bore:Length=86mm\n";
const TIDY: &str = "param bore: Length = 86 mm\n";

#[test]
fn fmt_rewrites_the_texts_that_differ() {
    let texts = Texts::new("rewrites");
    texts.write("a.eng", MESSY);
    texts.write("inner/b.eng", TIDY);
    texts.write("inner/c.eng", MESSY);
    texts.write("inner/notes.txt", MESSY);
    texts.write("inner/.hidden/d.eng", MESSY);
    let folder = texts.0.to_string_lossy().into_owned();
    let names = |output: &Output, word: &str| {
        let found = text(&output.stdout).replace(&folder, "");
        let lines = found.lines().map(|line| line.replace(word, ""));
        lines.collect::<Vec<_>>()
    };

    let check = eng(&["fmt", "--check", &folder]);
    assert_eq!(check.status.code(), Some(1));
    assert_eq!(names(&check, "not formatted: "), ["/a.eng", "/inner/c.eng"]);
    assert_eq!(texts.read("a.eng"), MESSY, "--check changes nothing");

    let first = eng(&["fmt", &folder]);
    assert_eq!(first.status.code(), Some(0));
    assert_eq!(names(&first, "formatted "), ["/a.eng", "/inner/c.eng"]);
    assert_eq!(
        (texts.read("a.eng"), texts.read("inner/c.eng")),
        (TIDY.into(), TIDY.into())
    );
    assert_eq!(texts.read("inner/notes.txt"), MESSY);
    assert_eq!(texts.read("inner/.hidden/d.eng"), MESSY);

    let second = eng(&["fmt", "--check", &folder]);
    assert_eq!(
        (second.status.code(), text(&second.stdout)),
        (Some(0), String::new())
    );
}

#[test]
fn fmt_leaves_a_text_with_mistakes() {
    let texts = Texts::new("mistakes");
    let wrong = texts.write("a.eng", "param bore:Length=(86mm\n");
    let messy = texts.write("b.eng", MESSY);
    let output = eng(&["fmt", &wrong, &messy]);
    assert_eq!(output.status.code(), Some(1));
    let errors = text(&output.stderr);
    assert!(errors.contains("a.eng:1:"), "{errors}");
    assert_eq!(texts.read("a.eng"), "param bore:Length=(86mm\n");
    assert_eq!(texts.read("b.eng"), TIDY, "the other file is formatted");

    let absent = eng(&["fmt", &format!("{wrong}.no"), &messy]);
    assert_eq!(absent.status.code(), Some(2));
    let bytes = texts.0.join("bytes.eng");
    std::fs::write(&bytes, [b'a', 0xff]).expect("a file");
    let output = eng(&["fmt", &bytes.to_string_lossy()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("is not UTF-8"));
}

#[cfg(unix)]
#[test]
fn fmt_keeps_links_and_rights() {
    use std::os::unix::fs::PermissionsExt;
    let texts = Texts::new("rights");
    let real = texts.write("real.eng", MESSY);
    let link = texts.0.join("link.eng");
    std::os::unix::fs::symlink(&real, &link).expect("a link");
    std::fs::set_permissions(&real, std::fs::Permissions::from_mode(0o640)).expect("rights");
    assert_eq!(
        eng(&["fmt", &link.to_string_lossy()]).status.code(),
        Some(0)
    );
    assert_eq!(texts.read("real.eng"), TIDY);
    let mode = std::fs::metadata(&real)
        .expect("a file")
        .permissions()
        .mode();
    assert_eq!(mode & 0o777, 0o640);
    assert!(link.is_symlink());
}

#[test]
fn fmt_reads_the_standard_input() {
    use std::io::Write;
    let through = |arguments: &[&str], input: &str| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_eng"))
            .args(arguments)
            .stdin(std::process::Stdio::piped())
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .expect("the command starts");
        let mut pipe = child.stdin.take().expect("a pipe");
        pipe.write_all(input.as_bytes()).expect("it reads");
        drop(pipe);
        let output = child.wait_with_output().expect("it ends");
        (
            output.status.code(),
            text(&output.stdout),
            text(&output.stderr),
        )
    };
    assert_eq!(
        through(&["fmt", "-"], MESSY),
        (Some(0), TIDY.into(), String::new())
    );
    // no character is escaped
    let odd = "// \u{1b}[0m \u{202e}\n";
    assert_eq!(
        through(&["fmt", "-"], odd),
        (Some(0), odd.into(), String::new())
    );
    let (code, output, _) = through(&["fmt", "-", "--check"], MESSY);
    assert_eq!(
        (code, output.as_str()),
        (Some(1), "not formatted: standard input\n")
    );
    let (code, output, errors) = through(&["fmt", "-"], "let a = (\n");
    assert_eq!((code, output.as_str()), (Some(1), ""));
    assert!(errors.contains("standard input:1:"), "{errors}");
}
