//! Messages about wrong texts: a folder of small wrong models, their messages as snapshots, and
//! every code at least once. Lists of names in messages.

use crate::check_support::{Run, elaborated_in, render, run_in};
use eng_compiler::codes;
use eng_compiler::internals::listing;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn run_file(path: &Path) -> Run {
    let text = std::fs::read_to_string(path).expect("a fixture");
    run_text(path, &text)
}

fn run_text(path: &Path, text: &str) -> Run {
    let folder = path
        .parent()
        .expect("a folder")
        .to_string_lossy()
        .into_owned();
    let file = path
        .file_name()
        .expect("a file")
        .to_string_lossy()
        .into_owned();
    if folder.ends_with("elaborate") || folder.ends_with("report") {
        elaborated_in(&folder, &file, text)
    } else {
        run_in(&folder, &file, text)
    }
}

fn fixtures() -> Vec<PathBuf> {
    let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics");
    let mut files = Vec::new();
    for stage in ["resolve", "check", "elaborate", "report"] {
        for entry in std::fs::read_dir(base.join(stage)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|extension| extension == "eng") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

#[test]
fn wrong_models_and_their_messages() {
    // line numbers of the library change; the text of the lines is shown
    let mut settings = insta::Settings::clone_current();
    settings.add_filter(r"(std/\w+\.eng):\d+:\d+", "$1");
    let _bound = settings.bind_to_scope();
    insta::glob!(
        "diagnostics/{resolve,check,elaborate,report}/*.eng",
        |path| {
            let run = run_file(path);
            assert!(!run.diagnostics.is_empty(), "no message");
            insta::assert_snapshot!(render(&run));
        }
    );
}

#[test]
fn every_code_is_raised_by_the_fixture_that_names_it() {
    let mut raised: BTreeSet<&str> = BTreeSet::new();
    for path in fixtures() {
        let run = run_file(&path);
        let codes: BTreeSet<&str> = run.diagnostics.iter().map(|d| d.code).collect();
        let text = std::fs::read_to_string(&path).expect("a fixture");
        let named = text.strip_prefix("// ").and_then(|t| t.split(':').next());
        let named = named.unwrap_or_default().split(", ");
        for named in named.filter(|n| n.starts_with(['E', 'W', 'N']) && n.len() == 5) {
            assert!(
                codes.contains(named),
                "{}: {named} is not raised",
                path.display()
            );
        }
        raised.extend(codes);
    }
    for code in codes::all() {
        // no text raises it: `tests/elaborate.rs` does, by leaving out the check
        if code.code == codes::INTERNAL {
            assert!(!raised.contains(code.code), "an internal error");
            continue;
        }
        assert!(
            raised.contains(code.code),
            "no fixture raises {}",
            code.code
        );
    }
    let known: BTreeSet<&str> = codes::all().map(|code| code.code).collect();
    let unknown: Vec<&&str> = raised
        .iter()
        .filter(|code| !known.contains(*code))
        .collect();
    assert!(unknown.is_empty(), "not in the registry: {unknown:?}");
}

#[test]
fn codes_stand_in_the_registry_once_and_in_order_of_their_group() {
    let mut known = BTreeSet::new();
    for group in codes::GROUPS {
        let errors: Vec<&str> = group
            .iter()
            .map(|code| code.code)
            .filter(|code| code.starts_with('E'))
            .collect();
        assert!(errors.is_sorted(), "{errors:?}");
        for code in group {
            assert!(known.insert(code.code), "{} stands twice", code.code);
        }
    }
}

/// An applied fix removes its message and causes no other message of the same kind.
#[test]
fn every_fix_mends_its_mistake() {
    let mut tried = 0;
    for path in fixtures() {
        let text = std::fs::read_to_string(&path).expect("a fixture");
        let run = run_text(&path, &text);
        let root = run.typed.program.modules.last().map(|module| module.source);
        for diagnostic in run.diagnostics.iter() {
            let same = |run: &Run| {
                run.diagnostics
                    .iter()
                    .filter(|d| d.title == diagnostic.title)
                    .count()
            };
            for fix in &diagnostic.fixes {
                if Some(fix.span.source) != root {
                    continue;
                }
                let mut mended = text.clone();
                mended.replace_range(
                    fix.span.start as usize..fix.span.end as usize,
                    &fix.replacement,
                );
                let again = run_text(&path, &mended);
                assert!(
                    same(&again) < same(&run),
                    "{}: {} `{}` does not mend: {}\n{}",
                    path.display(),
                    fix.title,
                    fix.replacement,
                    diagnostic.title,
                    render(&again)
                );
                tried += 1;
            }
        }
    }
    assert!(tried > 40, "only {tried} fixes");
}

#[test]
fn lists_read_like_sentences() {
    assert_eq!(listing([], 3), "none");
    assert_eq!(listing(["a"], 3), "`a`");
    assert_eq!(listing(["a", "b", "c"], 3), "`a`, `b` and `c`");
    assert_eq!(listing(["a", "b", "c"], 2), "`a`, `b`, …");
}
