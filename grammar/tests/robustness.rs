//! Every text becomes a tree, in bounded time and stack.

use crate::common::{messages, parsed};
use eng_grammar::{Diagnostics, SourceId, parse_expression};
use proptest::prelude::*;
use std::time::{Duration, Instant};

const GOOD: [&str; 4] = [
    include_str!("good/joints.eng"),
    include_str!("good/slider_crank.eng"),
    include_str!("good/inline4.eng"),
    include_str!("good/v6_split_pins.eng"),
];

fn check(text: &str) {
    let (_, diagnostics) = parsed(text);
    for diagnostic in diagnostics.iter() {
        for span in diagnostic
            .labels
            .iter()
            .map(|label| label.span)
            .chain(diagnostic.fixes.iter().map(|fix| fix.span))
        {
            let range = span.start as usize..span.end as usize;
            assert!(text.get(range).is_some(), "{text:?}: {diagnostic:?}");
        }
    }
}

#[test]
fn deep_nesting_ends_in_a_message() {
    let deep = 4000;
    for text in [
        format!("let a = {}1{}", "(".repeat(deep), ")".repeat(deep)),
        format!("let a = {}1{}", "[".repeat(deep), "]".repeat(deep)),
        format!("let a = {}1{}", "f(".repeat(deep), ")".repeat(deep)),
        format!("let a = {}1{}", "a[".repeat(deep), "]".repeat(deep)),
        format!("{}{}", "body a { ".repeat(deep), "}".repeat(deep)),
        format!(
            "let a = {}1 {}",
            "if a then ".repeat(deep),
            "else 2 ".repeat(deep)
        ),
        format!("let a = {}3", "if a then 1 else ".repeat(deep)),
        format!("let a: {}1{} = 3", "V<".repeat(deep), ">".repeat(deep)),
        format!("let a: {}1 = 3", "fn() -> ".repeat(deep)),
        format!("let a: {}1{} = 3", "(".repeat(deep), ")".repeat(deep)),
        format!("let a = {}1", "-".repeat(deep)),
        format!("let a = {}b", "not ".repeat(deep)),
        format!("let a = 1{}", " + 1".repeat(deep)),
        format!("let a = 1{}", "^1".repeat(deep)),
        format!("let a = b{}", ".c".repeat(deep)),
        format!("let a = 1 {}m{}", "(".repeat(deep), ")".repeat(deep)),
        format!("dimension A = B{}", "*B".repeat(deep)),
    ] {
        let (_, diagnostics) = parsed(&text);
        let codes: Vec<_> = diagnostics.iter().map(|found| found.code).collect();
        assert_eq!(
            codes,
            ["E0106"],
            "{}\n{:?}",
            &text[..60],
            diagnostics.iter().next()
        );
    }
    for text in [
        "(".repeat(deep),
        "[".repeat(deep),
        "{".repeat(deep),
        "body a {".repeat(deep),
    ] {
        check(&text);
    }
}

#[test]
fn usual_depths_are_read() {
    for text in [
        format!("let a = {}1{}", "(".repeat(100), ")".repeat(100)),
        format!("let a = {}1{}", "[".repeat(100), "]".repeat(100)),
        format!("let a = {}1{}", "f(".repeat(100), ")".repeat(100)),
        format!("let a = {}1{}", "f(2 - ".repeat(80), ")".repeat(80)),
        format!("let a = 1{}", " + 1".repeat(249)),
        format!("let a = {}3", "if a then 1 else ".repeat(100)),
        format!("let a = [{}1]", "1, ".repeat(10_000)),
    ] {
        let (_, diagnostics) = parsed(&text);
        assert!(diagnostics.is_empty(), "{}", messages(&text));
    }
}

#[test]
fn a_large_file_is_read_in_reasonable_time() {
    let mut text = String::new();
    while text.len() < 200_000 {
        text.push_str(GOOD[2]);
        text.push('\n');
    }
    let text = text.replace("//!", "//");
    let begin = Instant::now();
    let (file, diagnostics) = parsed(&text);
    assert!(diagnostics.is_empty());
    assert!(file.items.len() > 400);
    assert!(
        begin.elapsed() < Duration::from_secs(60),
        "{:?}",
        begin.elapsed()
    );
}

#[test]
fn a_large_wrong_file_is_read_in_reasonable_time() {
    for line in [
        "let a = (b\n",
        "mass = = 3\n",
        "body a { mass = (\n",
        "( [ ",
        "\"",
        "}",
        "{",
        "f(",
        "a b c\n",
    ] {
        let text = line.repeat(50_000 / line.len());
        let begin = Instant::now();
        check(&text);
        assert!(
            begin.elapsed() < Duration::from_secs(60),
            "{line:?} {:?}",
            begin.elapsed()
        );
    }
}

const PIECES: [&str; 64] = [
    "let ",
    "param ",
    "output ",
    "body ",
    "joint ",
    "model ",
    "fn ",
    "use ",
    "unit ",
    "dimension ",
    "table ",
    "constrain ",
    "require ",
    "apply force ",
    " on ",
    " against ",
    "start ",
    "der(p) = ",
    "if ",
    " then ",
    " else ",
    " for ",
    " in ",
    " by ",
    " as ",
    "not ",
    " and ",
    " or ",
    "a",
    "b",
    "Length",
    "5",
    "1.5e3",
    " mm",
    " %",
    "\"t\"",
    "\"",
    "\\",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "<",
    ">",
    "=",
    "==",
    ":",
    ";",
    ",",
    ".",
    "..",
    "+",
    "-",
    "*",
    "/",
    "^",
    "->",
    "\n",
    "// c\n",
    "/// d\n",
    "µ",
    " ",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_characters(text in "\\PC{0,200}") {
        check(&text);
        let mut diagnostics = Diagnostics::new();
        let value = parse_expression(&text, SourceId(0), 7, &mut diagnostics);
        prop_assert!(value.is_some() || !diagnostics.is_empty());
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        check(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn any_tokens(pieces in prop::collection::vec(prop::sample::select(&PIECES[..]), 0..120)) {
        let text: String = pieces.concat();
        check(&text);
        let mut diagnostics = Diagnostics::new();
        let value = parse_expression(&text, SourceId(0), 7, &mut diagnostics);
        prop_assert!(value.is_some() || !diagnostics.is_empty());
    }

    #[test]
    fn mutations_of_good_files(
        which in 0..GOOD.len(),
        place in 0.0..1.0f64,
        length in 0usize..12,
        insert in prop::sample::select(&PIECES[..]),
    ) {
        let mut characters: Vec<char> = GOOD[which].chars().collect();
        let at = (place*characters.len() as f64) as usize;
        let end = (at + length).min(characters.len());
        characters.splice(at..end, insert.chars());
        check(&characters.into_iter().collect::<String>());
    }

    /// A text with an error node has a message, and a text without a message has no error node.
    #[test]
    fn errors_in_the_tree_have_messages(
        which in 0..GOOD.len(),
        place in 0.0..1.0f64,
        length in 1usize..6,
    ) {
        let mut characters: Vec<char> = GOOD[which].chars().collect();
        let at = (place*characters.len() as f64) as usize;
        let end = (at + length).min(characters.len());
        characters.drain(at..end);
        let text: String = characters.into_iter().collect();
        let (file, diagnostics) = parsed(&text);
        let shown = crate::common::tree(&file.items);
        prop_assert!(!shown.contains("(error)") || diagnostics.has_errors(), "{}", shown);
        prop_assert!(diagnostics.len() <= 12, "{}", messages(&text));
    }
}
