//! The contents of a file that a mesh does not hold.

use std::collections::BTreeMap;

use super::source::At;
use crate::mesh::{Carries, Unread};

/// Counts the cards or keywords that were not read.
#[derive(Debug, Default)]
pub(super) struct UnreadCards {
    cards: BTreeMap<String, Unread>,
}

impl UnreadCards {
    /// Counts a card or keyword of which Eng does not read a part.
    pub fn note(&mut self, name: &str, at: &At, carries: Carries) {
        self.cards
            .entry(name.to_string())
            .or_insert_with(|| Unread {
                name: name.to_string(),
                count: 0,
                first: (at.file.to_string(), at.line),
                carries,
            })
            .count += 1;
    }

    /// All of them, sorted by name.
    pub fn into_list(self) -> Vec<Unread> {
        self.cards.into_values().collect()
    }
}

/// The kind of content of a card or keyword, by lists of those that carry structure and of those that carry
/// nothing. A name of the second list with a `.` at its end means all names with this beginning.
pub(super) fn carries(name: &str, structure: &[&str], nothing: &[&str]) -> Carries {
    if structure.contains(&name) {
        return Carries::Structure;
    }
    let harmless = nothing.iter().any(|known| match known.strip_suffix('.') {
        Some(start) => name.starts_with(start),
        None => name == *known,
    });
    match harmless {
        true => Carries::Nothing,
        false => Carries::Unknown,
    }
}
