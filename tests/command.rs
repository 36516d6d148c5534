//! The `eng` command as a process: exit codes, texts and files that scripts use.

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
    for part in ["Usage: eng", "run ", "check ", "explain ", "Exit codes: 0"] {
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
