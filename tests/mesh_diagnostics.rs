//! Mistakes in meshes, markers on them and reductions: a folder of such models, their messages as snapshots,
//! and every code at least once.

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

/// The messages of a check with its assembly.
fn messages(sources: &Sources, file: &str) -> String {
    let checked = eng::check(sources, file);
    let mut diagnostics = checked.report().diagnostics().clone();
    if let Some(program) = checked.program() {
        let assembled = program.assemble().unwrap_or_else(|e| panic!("{file}: {e}"));
        diagnostics.extend(assembled.diagnostics);
    }
    human(&diagnostics, checked.report().texts(), Colors::None)
}

/// The names of the kept files with this end.
fn kept(cache: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(cache).into_iter().flatten();
    let files = entries.map(|entry| entry.expect("an entry").path());
    let mut found: Vec<PathBuf> = files
        .filter(|path| path.extension().is_some_and(|e| e == ending))
        .collect();
    found.sort();
    found
}

#[test]
fn a_kept_look_at_a_mesh_changes_no_message() {
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR")).join("looks_at_fixtures");
    let _ = std::fs::remove_dir_all(&cache);
    for path in fixtures() {
        let folder = || Sources::folder(path.parent().expect("a folder")).expect("a folder");
        let file = path.file_name().expect("a name").to_string_lossy();
        let fresh = messages(&folder(), &file);
        for time in ["first", "second"] {
            let again = messages(&folder().with_cache(&cache), &file);
            assert_eq!(
                again,
                fresh,
                "{}, {time} check with a cache",
                path.display()
            );
        }
    }
    assert!(!kept(&cache, "look").is_empty());
    assert_eq!(kept(&cache, "reduced"), [] as [PathBuf; 0]);
}

#[test]
fn a_kept_look_at_a_mesh_follows_text_and_files() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("looks_at_a_bar");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let (cache, mesh) = (folder.join("cache"), folder.join("bar.bdf"));
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mesh");
    let text = std::fs::read_to_string(meshes.join("bar.eng")).expect("a model");
    let ignoring = text.replace(
        "units: mm_tonne_s",
        "units: mm_tonne_s, ignore: [\"CELAS9\"]",
    );
    let deck = std::fs::read_to_string(meshes.join("bar.bdf")).expect("a mesh");
    let check = |text: &str, deck: &str| {
        std::fs::write(folder.join("bar.eng"), text).expect("a model");
        std::fs::write(&mesh, deck).expect("a mesh");
        let sources = Sources::folder(&folder)
            .expect("a folder")
            .with_cache(&cache);
        messages(&sources, "bar.eng")
    };
    assert_eq!(check(&text, &deck), "");
    let looks = kept(&cache, "look");
    assert_eq!(looks.len(), 1);
    assert_eq!(check(&text, &deck), "");
    // other modes need no other look, another material does
    assert_eq!(check(&text.replace("normal(3)", "normal(4)"), &deck), "");
    assert_eq!(kept(&cache, "look"), looks);
    assert_eq!(check(&text, &deck.replace("210000.", "200000.")), "");
    assert_eq!(kept(&cache, "look").len(), 2);
    // the text ignores a card, and later no more: the look is the same, the refusal is not
    let unread = deck.replace("PSOLID  1 ", "CELAS9  1       1\nPSOLID  1 ");
    assert_eq!(check(&ignoring, &unread), "");
    let looks = kept(&cache, "look");
    let refused = check(&text, &unread);
    assert!(
        refused.contains("E0733") && refused.contains("CELAS9"),
        "{refused}"
    );
    assert_eq!(kept(&cache, "look"), looks);
    // a marker without nodes leaves no look; a damaged look is made again
    let elsewhere = check(&text.replace("[0, 0, 200]", "[0, 0, 300]"), &deck);
    assert!(elsewhere.contains("E0731"), "{elsewhere}");
    assert_eq!(kept(&cache, "look"), looks);
    for look in &looks {
        std::fs::write(look, "damaged").expect("a file");
    }
    assert_eq!(check(&text, &deck), "");
    let whole = looks
        .iter()
        .filter(|look| std::fs::read(look).is_ok_and(|b| b != b"damaged"));
    assert_eq!(whole.count(), 1);
}

/// Springs of a deck to the ground do not count as missing digits of its stiffness. A body without support
/// is refused.
#[test]
fn springs_to_the_ground_need_a_support() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("springs_to_the_ground");
    std::fs::create_dir_all(&folder).expect("a folder");
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mesh");
    let deck = std::fs::read_to_string(meshes.join("bar.bdf")).expect("a mesh");
    let deck = deck.replace("PSOLID  1 ", "CELAS2,900,100.,1,1\nPSOLID  1 ");
    std::fs::write(folder.join("bar.bdf"), deck).expect("a mesh");
    let held = std::fs::read_to_string(meshes.join("bar.eng")).expect("a model");
    let held = held.replace(
        "modes = static",
        "element_rules = exact\n        modes = static",
    );
    let free = held.replace("        support = foot\n", "");
    let doubts = |model: &str| {
        std::fs::write(folder.join("bar.eng"), model).expect("a model");
        let sources = Sources::folder(&folder).expect("a folder");
        let program = eng::check(&sources, "bar.eng").into_program();
        let program = program.unwrap_or_else(|report| panic!("{report}"));
        let (_, doubts) = program.reduce().unwrap_or_else(|error| panic!("{error}"));
        let titles = doubts.iter().map(|doubt| doubt.title.clone());
        titles.collect::<Vec<String>>()
    };
    assert_eq!(doubts(&held), [] as [&str; 0]);
    assert_eq!(
        doubts(&free),
        [
            "spring 900 of the mesh holds a node to the ground, and the body has no `support`: the ground of the mesh would move with the body"
        ]
    );
}
