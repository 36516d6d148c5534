//! Syntax trees of the library's texts, kept from one reading of a program to the next.

use eng_grammar::ast::File;
use eng_grammar::{Diagnostics, SourceId, UnitWords, parse_with_units};
use std::collections::BTreeMap;

/// The trees of the library's texts that were read without a message. An editor's text is read at every key, and the
/// library's texts stay as they are.
///
/// There is one tree for each module and number of its text among the texts of a program, so the memory does not
/// grow with the number of readings.
#[derive(Debug, Default)]
pub struct Trees {
    kept: BTreeMap<(String, SourceId), Kept>,
}

#[derive(Debug)]
struct Kept {
    text: String,
    /// The units before and after this text, because they decide how a text is read.
    before: UnitWords,
    after: UnitWords,
    tree: File,
}

impl Trees {
    /// The tree of a text of the library.
    pub(super) fn read(
        &mut self,
        path: &str,
        text: &str,
        source: SourceId,
        units: &mut UnitWords,
        diagnostics: &mut Diagnostics,
    ) -> File {
        let key = (path.to_owned(), source);
        if let Some(kept) = self.kept.get(&key)
            && kept.text == text
            && kept.before == *units
        {
            *units = kept.after.clone();
            return kept.tree.clone();
        }
        let before = units.clone();
        let mut messages = Diagnostics::new();
        let tree = parse_with_units(text, source, units, &mut messages);
        if messages.is_empty() {
            let kept = Kept {
                text: text.to_owned(),
                before,
                after: units.clone(),
                tree: tree.clone(),
            };
            self.kept.insert(key, kept);
        }
        diagnostics.extend(messages);
        tree
    }
}
