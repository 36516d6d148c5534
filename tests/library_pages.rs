//! `docs/library.md` has the comments of the library's texts: every law with its parameters, equation,
//! source, sign and check.

use std::fmt::Write as _;
use std::path::Path;

/// Modules of laws and of functions for them.
const MODULES: [&str; 21] = [
    "joints",
    "drives",
    "forces",
    "contacts",
    "drivelines",
    "gas",
    "mounts",
    "valvetrain",
    "thrust",
    "liners",
    "math",
    "frames",
    "sections",
    "cranks",
    "layouts",
    "cylinder",
    "engine",
    "quick",
    "journals",
    "oils",
    "materials",
];

/// Words that begin an item of a file.
const KINDS: [&str; 10] = [
    "joint",
    "journal",
    "drive",
    "force",
    "interface",
    "component",
    "record",
    "fn",
    "const",
    "choice",
];

/// Words that begin a line of a comment about a law.
const HEADS: [&str; 5] = ["Law", "Source", "Sign", "Check", "Trap"];

/// The head of an item: up to its block or value, on one line.
fn signature(lines: &[&str]) -> String {
    let mut depth = 0;
    let mut out = String::new();
    for line in lines {
        for letter in line.trim().chars() {
            match letter {
                '(' | '[' => depth += 1,
                ')' | ']' => depth -= 1,
                '{' if depth == 0 => return out.trim().to_owned(),
                '=' if depth == 0 => return out.trim().to_owned(),
                _ => {}
            }
            out.push(letter);
        }
        out.push(' ');
    }
    out.trim().to_owned()
}

/// The fields of a record or the parameters of an interface with their comments, each on a line of its own.
fn fields(lines: &[&str], word: &str) -> String {
    let mut out = String::new();
    let mut comment = String::new();
    for line in lines.iter().take_while(|line| **line != "}") {
        match line.strip_prefix("    ") {
            Some(text) if text.starts_with("///") => comment = format!("{comment}\n{line}"),
            Some(text) => {
                if text.starts_with(word) {
                    let _ = write!(out, "{comment}\n{line}");
                }
                comment.clear();
            }
            None => comment.clear(),
        }
    }
    out
}

/// The text of an item on a page: its head, the fields of a record, the parameters of an interface, the words of a choice.
fn shown(kind: &str, lines: &[&str]) -> String {
    match kind {
        "choice" => lines[0].to_owned(),
        "record" => signature(lines) + &fields(lines, "let "),
        "interface" => signature(lines) + &fields(lines, "param "),
        _ => signature(lines),
    }
}

/// A comment with its heads in bold, each on a line of its own. Angle brackets would be tags outside of code.
fn described(comment: &[&str]) -> String {
    let mut out = String::new();
    let mut code = false;
    for line in comment {
        let head = HEADS
            .iter()
            .find(|head| line.starts_with(&format!("{head}: ")));
        match head {
            Some(head) if !code => {
                // a list is a paragraph of its own
                let listed = out.rsplit('\n').next().unwrap_or_default();
                let begins = !out.contains("\n- **") && !listed.is_empty();
                out.push_str(if begins { "\n\n" } else { "\n" });
                let _ = write!(out, "- **{head}.**{}", &line[head.len() + 1..]);
            }
            _ if line.is_empty() => out.push_str("\n\n"),
            _ => {
                // rows of a table and items of a list
                let begins = line.starts_with('|') || line.starts_with("- ");
                if !out.is_empty() && !out.ends_with('\n') {
                    out.push(if begins { '\n' } else { ' ' });
                }
                out.push_str(line);
            }
        }
        code ^= line.matches('`').count() % 2 == 1;
    }
    while out.contains("\n\n\n") {
        out = out.replace("\n\n\n", "\n\n");
    }
    out.trim().to_owned()
}

fn page(module: &str, text: &str) -> String {
    let mut out = format!("\n## std.{module}\n");
    let lines: Vec<&str> = text.lines().collect();
    let head: Vec<&str> = lines
        .iter()
        .take_while(|line| line.starts_with("//!"))
        .map(|line| line.trim_start_matches("//!").trim())
        .collect();
    let _ = write!(out, "\n{}\n", described(&head));
    let mut comment = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        if let Some(text) = line.strip_prefix("///") {
            comment.push(text.trim());
            continue;
        }
        let mut words = line.split([' ', '(', '<']);
        let kind = words.next().unwrap_or_default();
        if KINDS.contains(&kind) && !comment.is_empty() {
            let name = words.next().unwrap_or_default();
            let _ = write!(
                out,
                "\n### {name}\n\n```text\n{}\n```\n\n{}\n",
                shown(kind, &lines[at..]),
                described(&comment)
            );
        }
        comment.clear();
    }
    out
}

/// A failure writes the right page beside the results of the tests.
#[test]
fn the_page_of_the_library_has_its_comments() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut right = String::from(
        "# The library\n\nThe parts and laws of the library, from the comments of its texts in `stdlib/`. The first marker moves, the second is the\n\
         reference, and forces and torques are those on the first. [Bearings](bearings.md) compares the films. `eng explain MODEL PATH` prints the\n\
         text of a class that a model uses. [Validation](validation.md) has the figures of the checks.\n",
    );
    for module in MODULES {
        let text = std::fs::read_to_string(root.join(format!("stdlib/{module}.eng")));
        right += &page(module, &text.expect("a module"));
    }
    let kept = std::fs::read_to_string(root.join("docs/library.md")).unwrap_or_default();
    if kept != right {
        let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("library.md");
        std::fs::write(&place, right).expect("a page");
        panic!("docs/library.md is not as {}", place.display());
    }
}

/// Every law, joint and drive says its equation, its signs and how it is checked.
#[test]
fn every_law_says_its_equation_and_its_check() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut laws = 0;
    for module in MODULES {
        let text = std::fs::read_to_string(root.join(format!("stdlib/{module}.eng")));
        let text = text.expect("a module");
        let mut comment = String::new();
        for line in text.lines() {
            if let Some(more) = line.strip_prefix("///") {
                comment += more;
                comment.push('\n');
                continue;
            }
            let law = ["force ", "joint ", "drive "]
                .iter()
                .find_map(|kind| line.strip_prefix(kind));
            if let Some(name) = law {
                laws += 1;
                for head in ["Law", "Sign", "Check"] {
                    let says = comment.contains(&format!(" {head}: "));
                    assert!(says, "{module}: {name} has no {head}");
                }
            }
            comment.clear();
        }
    }
    assert!(laws >= 60, "{laws}");
}
