//! Good files give no message and no error node.

use eng_grammar::{Diagnostics, SourceId, ast::File, parse};

/// Whether the tree has an error node anywhere: the debug form has the whole names of variants.
fn has_error(file: &File) -> bool {
    let shown = format!("{file:?}");
    shown
        .split(|character: char| !character.is_alphanumeric() && character != '"')
        .any(|word| word == "Error")
}

fn check(name: &str, text: &str) -> File {
    let mut diagnostics = Diagnostics::new();
    let file = parse(text, SourceId(0), &mut diagnostics);
    let messages: Vec<_> = diagnostics.iter().collect();
    assert!(messages.is_empty(), "{name}: {messages:#?}");
    assert!(!has_error(&file), "{name} has an error node");
    file
}

#[test]
fn fixtures_have_no_mistake() {
    for (name, text, items) in [
        ("joints", include_str!("good/joints.eng"), 30),
        ("slider_crank", include_str!("good/slider_crank.eng"), 4),
        ("inline4", include_str!("good/inline4.eng"), 9),
        ("v6_split_pins", include_str!("good/v6_split_pins.eng"), 10),
        ("report", include_str!("good/report.eng"), 4),
    ] {
        let file = check(name, text);
        assert_eq!(file.items.len(), items, "items of {name}");
        assert!(!file.docs.is_empty());
    }
}
