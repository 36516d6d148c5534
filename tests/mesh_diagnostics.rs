//! What is wrong with meshes, markers on them and reductions: a folder of such models, their messages as snapshots, and every
//! code at least once.

use eng::Sources;
use eng::codes::REDUCING;
use eng::render::{Colors, human};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn fixtures() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics/mesh");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "eng"))
        .collect();
    files.sort();
    files
}

#[test]
fn meshes_that_fail_raise_every_code_of_a_reduction() {
    let mut raised: BTreeSet<&str> = BTreeSet::new();
    for path in fixtures() {
        let sources = Sources::folder(path.parent().expect("a folder")).expect("a folder");
        let file = path.file_name().expect("a name").to_string_lossy();
        let checked = eng::check(&sources, &file);
        let report = checked.report();
        let mut diagnostics = report.diagnostics().clone();
        if let Some(program) = checked.program() {
            let (_, doubts) = program
                .reduce()
                .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            diagnostics.extend(doubts);
        }
        let name = path.file_stem().expect("a name").to_string_lossy();
        insta::assert_snapshot!(
            name.as_ref(),
            human(&diagnostics, report.texts(), Colors::None)
        );
        let codes: BTreeSet<&str> = diagnostics.iter().map(|d| d.code).collect();
        let text = std::fs::read_to_string(&path).expect("a fixture");
        let named = text.strip_prefix("// ").and_then(|t| t.split(':').next());
        for named in named.expect("a first line").split(", ") {
            assert!(
                codes.contains(named),
                "{}: {named} is not raised but {codes:?}",
                path.display()
            );
        }
        raised.extend(codes);
    }
    for code in REDUCING {
        assert!(raised.contains(code.code), "{} is not raised", code.code);
    }
}
