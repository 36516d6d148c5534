//! Lists of the language's words against the grammar, and the nearest of several names.

use eng_grammar::internals::{ITEM_WORDS, KINDS};
use eng_grammar::{WORDS, nearest};
use std::collections::BTreeSet;

const GRAMMAR: &str = include_str!("../src/eng.pest");

/// The words between quotes in the rules of the grammar.
fn of_the_grammar() -> BTreeSet<&'static str> {
    let rules = GRAMMAR.lines().filter(|line| !line.starts_with("//"));
    let quoted = rules.flat_map(|line| line.split('"').skip(1).step_by(2));
    let is_word =
        |text: &&str| text.len() > 1 && text.bytes().all(|byte| byte.is_ascii_lowercase());
    quoted.filter(is_word).collect()
}

#[test]
fn the_list_has_the_words_of_the_grammar() {
    let all: BTreeSet<&str> = WORDS.iter().copied().collect();
    assert_eq!(all, of_the_grammar());
    assert_eq!(all.len(), WORDS.len());
}

/// Editors of the family of TextMate colour texts by these rules.
#[test]
fn the_colours_of_editors_know_the_words() {
    let rules = include_str!("../../editors/vscode/syntaxes/eng.tmLanguage.json");
    let rules = rules.replace("\\\\b", " ");
    let coloured: BTreeSet<&str> = rules
        .split(|letter: char| !letter.is_ascii_lowercase())
        .collect();
    for word in WORDS {
        assert!(coloured.contains(word), "`{word}` has no colour");
    }
}

/// The quoted words of a rule, and of the rules that it names.
fn words_of_rule(grammar: &str, rule: &str) -> BTreeSet<String> {
    let begin = grammar.find(&format!("\n{rule} ")).expect("a rule") + 1;
    let text = &grammar[begin..];
    let text = &text[..text.find("\n\n").unwrap_or(text.len())];
    let text = &text[text.find('{').expect("a body")..];
    let text = &text[..=text.find('}').expect("an end")];
    let quoted = text.split('"').skip(1).step_by(2).map(str::to_owned);
    let mut found: BTreeSet<String> = quoted.collect();
    for name in text.split(|c: char| !(c.is_ascii_lowercase() || c == '_')) {
        if name.starts_with("word_") && name != "word_char" || name.ends_with("kind") {
            found.extend(words_of_rule(grammar, name));
        }
    }
    found
}

#[test]
fn every_word_that_begins_an_item_is_known_here() {
    let known = ITEM_WORDS.iter().chain(KINDS.iter().map(|(kind, _)| kind));
    // `der` begins an item only in front of its parenthesis
    let known: BTreeSet<String> = known
        .filter(|word| **word != "der")
        .map(|word| (*word).to_owned())
        .collect();
    assert_eq!(known, words_of_rule(GRAMMAR, "item_word"));
}

#[test]
fn the_nearest_name_is_found() {
    let known = ["Revolute", "Spherical", "Fixed"];
    assert_eq!(nearest("Revolut", known), Some("Revolute"));
    assert_eq!(nearest("fixed", known), Some("Fixed"));
    assert_eq!(nearest("Gear", known), None);
    assert_eq!(nearest("mn", ["mm", "N", "kg"]), Some("mm"));
    assert_eq!(nearest("stat", ["start", "state"]), Some("state"));
    assert_eq!(nearest("start", ["start"]), None);
    assert_eq!(nearest("nope", ["bore"]), None);
    assert_eq!(nearest("bola", ["bore"]), Some("bore"));
}
