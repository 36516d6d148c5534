//! Words, codes, names and files of texts.

use eng::codes::all;
use eng::internals::sources::{asked, opened};
use eng::internals::{LINTS, WORDS, listed, text};
use eng::{HostError, Sources};
use eng_grammar::{Diagnostics, SourceMap, parse};
use eng_system::host::Host;
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn every_code_has_one_meaning_and_an_explanation() {
    let mut seen = BTreeSet::new();
    for code in all() {
        assert!(seen.insert(code.code), "{} stands twice", code.code);
        assert!(
            !code.title.is_empty() && !code.title.ends_with('.'),
            "{}",
            code.code
        );
        assert!(code.meaning.ends_with('.'), "{}", code.code);
        assert_eq!(
            code.wrong.is_empty(),
            code.right.is_empty(),
            "{}",
            code.code
        );
    }
    assert!(seen.len() > 100);
}

/// The examples are texts of the language. Those that the parser refuses are tested beside the grammar.
#[test]
fn examples_can_be_read() {
    for code in all().into_iter().filter(|c| !c.code.starts_with("E01")) {
        for text in [code.wrong, code.right] {
            let mut sources = SourceMap::new();
            let id = sources.add("example.eng", text);
            let mut diagnostics = Diagnostics::new();
            parse(text, id, &mut diagnostics);
            let found: Vec<_> = diagnostics.iter().collect();
            assert!(found.is_empty(), "{}: {text}\n{found:#?}", code.code);
        }
    }
}

#[test]
fn indices_that_count_on_are_one_entry() {
    let names = ["a[1]", "a[2]", "a[3]", "b", "c[2]", "c[4]", "d[1]", "e[2]"];
    assert_eq!(listed(names), "a[1..3], b, c[2], c[4], d[1], e[2]");
    assert_eq!(listed([]), "");
}

#[test]
fn wrong_bytes_are_told_with_their_place() {
    assert_eq!(text("é\n".into()), Ok("é\n".to_owned()));
    let latin = text(b"ab\nc\xc3\xa9d\xe9\n".to_vec()).unwrap_err();
    assert!(latin.contains("0xe9 in line 2, column 4"), "{latin}");
    for sixteen in [&b"\xff\xfea\0"[..], b"\xfe\xff\0a"] {
        let refused = text(sixteen.to_vec()).unwrap_err();
        assert!(refused.contains("UTF-16"), "{refused}");
    }
}

/// The sentence about analyses names every kind.
#[test]
fn the_kinds_of_analyses_are_named() {
    let sentence = WORDS.iter().find(|(word, _)| *word == "analysis");
    let (_, sentence) = sentence.expect("a word of the language");
    for kind in eng_system::analysis::KINDS {
        assert!(sentence.contains(kind.name), "{}", kind.name);
    }
}

/// Every word of the grammar has a sentence, and each lint of the program its own.
#[test]
fn words_of_the_grammar_are_known() {
    let grammar = include_str!("../../grammar/src/eng.pest");
    let rules = grammar
        .lines()
        .take_while(|line| !line.starts_with("file "));
    let rules: Vec<&str> = rules
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect();
    let text = rules.join("\n");
    let quoted = text.split('"').skip(1).step_by(2);
    let letters = |word: &&str| word.len() > 1 && word.chars().all(|c| c.is_ascii_lowercase());
    let mut count = 0;
    for word in quoted.filter(letters) {
        count += 1;
        assert!(WORDS.iter().any(|(known, _)| *known == word), "{word}");
    }
    assert!(count > 50, "{count} words");
    assert!(WORDS.is_sorted_by_key(|(word, _)| *word));
    for (lint, known) in LINTS.iter().zip(eng_system::lint::BUILT_IN) {
        assert_eq!(lint.0, known);
    }
}

#[test]
fn a_folder_reads_nothing_outside() {
    let sources = Sources::folder(env!("CARGO_MANIFEST_DIR")).expect("a folder");
    assert!(sources.read_text("Cargo.toml").is_ok());
    assert_eq!(
        sources.read_text("../Cargo.toml"),
        Err(HostError::Outside("../Cargo.toml".into()))
    );
    assert!(matches!(
        sources.read_text("/etc/passwd"),
        Err(HostError::Outside(_))
    ));
    assert_eq!(
        sources.read_text("no.eng"),
        Err(HostError::NotFound("no.eng".into()))
    );
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .canonicalize()
        .expect("a folder");
    let due = [("Cargo.toml", true), ("no.eng", false)];
    assert_eq!(
        asked(&sources),
        due.map(|(name, there)| (root.join(name), there))
    );
    assert_eq!(opened(&sources), BTreeSet::from([root.join("Cargo.toml")]));
}
