//! What is wrong with meshes, markers on them and reductions: a folder of such models, their messages as snapshots, and every
//! code at least once.

use eng::Local;
use eng::cli::{Engine, EngineError};
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
        let mut engine = Local::new();
        let checked = engine.check(&path).expect("a readable fixture");
        let mut diagnostics = checked.diagnostics.clone();
        if !diagnostics.has_errors() {
            match engine.reduce() {
                Ok(reduced) => diagnostics.extend(reduced.diagnostics),
                Err(EngineError::Model {
                    diagnostics: why, ..
                }) => diagnostics.extend(why),
                Err(other) => panic!("{}: {other}", path.display()),
            }
        }
        let name = path.file_stem().expect("a name").to_string_lossy();
        insta::assert_snapshot!(
            name.as_ref(),
            human(&diagnostics, &checked.sources, Colors::None)
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
