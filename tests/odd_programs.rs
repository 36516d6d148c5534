//! Good models with random damage. Each is a program that assembles, or has a message with a place in its
//! text. None ends in a panic. `fuzz/` looks for such texts without end.

use eng::{Error, Report, Sources, check};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// The good models and, by name, the files they read.
fn good_models() -> (Vec<String>, BTreeMap<String, String>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/good");
    let (mut models, mut data) = (Vec::new(), BTreeMap::new());
    let files = std::fs::read_dir(folder).expect("the folder of good models");
    let mut paths: Vec<_> = files.map(|file| file.expect("an entry").path()).collect();
    paths.sort();
    for path in paths {
        let Ok(text) = std::fs::read_to_string(&path) else {
            continue;
        };
        if path.extension().is_some_and(|extension| extension == "eng") {
            models.push(text);
        } else {
            let name = path.file_name().expect("a file").to_string_lossy();
            data.insert(name.into_owned(), text);
        }
    }
    (models, data)
}

/// Every place of every message lies in its text.
fn places_exist(report: &Report) {
    for diagnostic in report.diagnostics().iter() {
        for label in &diagnostic.labels {
            let range = label.span.start as usize..label.span.end as usize;
            let source = report.texts().get(label.span.source);
            let place = source.and_then(|source| source.text.get(range));
            assert!(place.is_some(), "{diagnostic:?}");
        }
    }
    assert!(report.diagnostics().is_empty() || !report.to_string().is_empty());
}

fn tried(text: String, data: &BTreeMap<String, String>) {
    let mut files = data.clone();
    files.insert("model.eng".into(), text);
    let sources = Sources::from_texts(files);
    let checked = check(&sources, "model.eng");
    places_exist(&checked.report());
    match checked.into_program() {
        Err(report) => assert!(report.diagnostics().has_errors()),
        Ok(program) => match program.assemble() {
            Ok(_) => {}
            Err(Error::Report(report) | Error::Run { report, .. }) => places_exist(&report),
            Err(other) => panic!("{other}"),
        },
    }
}

/// Words, numbers and signs that change the meaning of a text.
const PIECES: [&str; 28] = [
    "0",
    "-",
    "1e308",
    "1e-308",
    "1/0",
    "0 mm",
    "-1 kg",
    "7",
    "[",
    "]",
    "{",
    "}",
    "(",
    ")",
    " deg",
    " mm",
    "[1..0]",
    "[k]",
    "ground",
    "origin",
    "der(",
    "speed",
    "if ",
    " else ",
    ": Length",
    "param x: 1 = 2\n",
    "\n",
    "",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Words of a model are replaced, doubled, exchanged or left out.
    #[test]
    fn damaged_models_have_messages(
        which in any::<prop::sample::Index>(),
        damages in prop::collection::vec((any::<prop::sample::Index>(), 0..4u8, any::<prop::sample::Index>()), 1..4),
    ) {
        let (models, data) = good_models();
        let text = which.get(&models);
        // words and the signs between them, so that most damage passes the grammar
        let mut words: Vec<&str> = text.split_inclusive([' ', '\n', '(', ')', '[', ']', ',', '.', '*', '/']).collect();
        for (place, kind, other) in &damages {
            let (at, from) = (place.index(words.len()), other.index(words.len()));
            match kind {
                0 => words[at] = PIECES[other.index(PIECES.len())],
                1 => words[at] = words[from],
                2 => words.swap(at, from),
                _ => drop(words.remove(at)),
            }
            prop_assume!(!words.is_empty());
        }
        tried(words.concat(), &data);
    }
}
