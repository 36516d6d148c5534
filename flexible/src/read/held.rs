//! Cards and keywords that hold freedoms, counted by name.

use std::collections::BTreeMap;

use super::source::At;
use crate::mesh::SupportCards;

/// Counts cards that hold freedoms.
#[derive(Debug, Default)]
pub(super) struct HoldingCards {
    cards: BTreeMap<String, SupportCards>,
}

impl HoldingCards {
    /// Counts a card; `moved` if it moves its freedoms instead of holding them.
    pub fn note(&mut self, name: &str, at: &At, moved: bool) {
        let place = (at.file.to_string(), at.line);
        let cards = self
            .cards
            .entry(name.to_string())
            .or_insert_with(|| SupportCards {
                name: name.to_string(),
                count: 0,
                first: place.clone(),
                moved: None,
            });
        cards.count += 1;
        if moved && cards.moved.is_none() {
            cards.moved = Some(place);
        }
    }

    /// All, by name.
    pub fn into_list(self) -> Vec<SupportCards> {
        self.cards.into_values().collect()
    }
}
