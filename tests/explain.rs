//! `eng explain` as a process.

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
fn a_code_is_explained_with_an_example() {
    for written in ["E0301", "e0301"] {
        let output = eng(&["explain", written]);
        assert_eq!(output.status.code(), Some(0));
        assert_eq!(
            text(&output.stdout),
            "E0301: a number has no unit where a quantity is expected\n\
             \n\
             Every quantity has a unit. A zero needs one, too.\n\
             \n\
             wrong:\n    param bore: Length = 86\n\
             right:\n    param bore: Length = 86 mm\n"
        );
    }
}

#[test]
fn every_code_is_listed_and_explained() {
    let list = text(&eng(&["explain"]).stdout);
    let listed: Vec<&str> = list.lines().filter_map(|l| l.split(' ').next()).collect();
    let known: Vec<&str> = eng::codes::all().iter().map(|code| code.code).collect();
    assert_eq!(listed, known);
    for code in eng::codes::all() {
        let mut written = Vec::new();
        let exit = explain(code.code, &mut written);
        let written = text(&written);
        assert_eq!(exit, 0, "{}", code.code);
        assert!(written.starts_with(&format!("{}: {}\n\n", code.code, code.title)));
        assert!((3..=24).contains(&written.lines().count()), "{written}");
        let width = written.lines().map(|line| line.chars().count()).max();
        assert!(width <= Some(160), "{written}");
    }
}

/// In this process: a process for each code would take its time.
fn explain(code: &str, output: &mut Vec<u8>) -> u8 {
    let mut console = eng::cli::Console {
        output,
        errors: &mut Vec::new(),
        colored_output: false,
        colored_errors: false,
        live: false,
    };
    eng::cli::run_on(["eng", "explain", code].map(Into::into), &mut console)
}

#[test]
fn an_unknown_code_is_answered_by_the_nearest() {
    for (asked, near) in [("E301", "E0301"), ("E0O1", "E01"), ("w501", "W0501")] {
        let output = eng(&["explain", asked]);
        assert_eq!(output.status.code(), Some(2), "{asked}");
        assert!(output.stdout.is_empty());
        let errors = text(&output.stderr);
        assert!(errors.contains(&format!("did you mean {near}")), "{errors}");
    }
    // another number is another code
    for asked in ["nothing", "E9999"] {
        let output = eng(&["explain", asked]);
        assert_eq!(output.status.code(), Some(2));
        assert_eq!(
            text(&output.stderr),
            format!("error: there is no code {asked}\n`eng explain` lists all codes\n")
        );
    }
}

/// The tables of analyses and figures give the name and the meaning of each argument.
#[test]
fn analyses_and_figures_are_explained() {
    let output = eng(&["explain", "periodic"]);
    assert_eq!(output.status.code(), Some(0));
    let told = text(&output.stdout);
    assert!(
        told.starts_with("`periodic` is an analysis: the last of as many cycles"),
        "{told}"
    );
    assert!(
        told.contains("\n    sample (deg)  the distance of samples, 0.5° by default\n"),
        "{told}"
    );
    for row in eng_system::figure::KINDS {
        let output = eng(&["explain", row.name]);
        assert_eq!(output.status.code(), Some(0));
        let told = text(&output.stdout);
        assert!(
            told.starts_with(&format!("`{}` is a figure: ", row.name)),
            "{told}"
        );
        for argument in row.arguments {
            assert!(told.contains(argument.about), "{told}");
        }
    }
}
