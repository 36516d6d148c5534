//! Any text becomes a tree and messages. Every place of a message lies in the text.
#![no_main]

use eng_grammar::{Diagnostics, SourceId, parse, parse_expression};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let mut diagnostics = Diagnostics::new();
    parse(text, SourceId(0), &mut diagnostics);
    for diagnostic in diagnostics.iter() {
        let labels = diagnostic.labels.iter().map(|label| label.span);
        for span in labels.chain(diagnostic.fixes.iter().map(|fix| fix.span)) {
            let range = span.start as usize..span.end as usize;
            assert!(text.get(range).is_some(), "{diagnostic:?}");
        }
    }
    let mut diagnostics = Diagnostics::new();
    let value = parse_expression(text, SourceId(0), 7, &mut diagnostics);
    assert!(value.is_some() || !diagnostics.is_empty());
});
