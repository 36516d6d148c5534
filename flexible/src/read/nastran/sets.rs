//! Named sets: `SET1` and `SET3` as `set:3`, and the nodes and elements of each property as `pid:3`.

use std::collections::{BTreeMap, BTreeSet};

use super::card::{Card, Ids};
use super::grids::{Lookup, existing};
use super::lines::At;
use super::unread::UnreadCards;
use crate::error::FileProblem;
use crate::mesh::{Carries, Mesh, Set};
use crate::read::labels::Labels;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// `SET1`: grid points, or elements where none of its numbers is a grid point.
    Either,
    Grids,
    Elements,
    Properties,
}

/// Cards of sets.
#[derive(Debug, Default)]
pub(super) struct Sets {
    cards: Vec<(u64, Kind, Ids, At)>,
}

impl Sets {
    /// Reads a card; `false` if it is none of these.
    pub fn read(&mut self, card: &Card) -> Result<bool, FileProblem> {
        let (kind, from) = match (card.name.as_str(), card.text(1)) {
            ("SET1", "SKIN") => (Kind::Either, 2),
            ("SET1", _) => (Kind::Either, 1),
            ("SET3", "GRID" | "POINT") => (Kind::Grids, 2),
            ("SET3", "ELEM" | "ELEMENT") => (Kind::Elements, 2),
            ("SET3", "PROP") => (Kind::Properties, 2),
            _ => return Ok(false),
        };
        let ids = card.ids(from, card.len(), "ID")?;
        self.cards
            .push((card.id(0, "SID")?, kind, ids, card.at.clone()));
        Ok(true)
    }

    /// The sets of a mesh, with the number of each element's property card.
    pub fn sets(
        &self,
        lookup: &Lookup,
        mesh: &Mesh,
        properties: &[u64],
        unread: &mut UnreadCards,
    ) -> BTreeMap<String, Set> {
        let mut sets: BTreeMap<String, Set> = BTreeMap::new();
        let mut of_property: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
        let mut numbers = Vec::with_capacity(mesh.elements.len());
        for (index, (property, element)) in properties.iter().zip(&mesh.elements).enumerate() {
            let index = index as u32; // counted when the elements were made
            numbers.push((element.id, index));
            if *property > 0 {
                of_property.entry(*property).or_default().push(index);
            }
        }
        let numbers = Labels::new(numbers);
        for (property, members) in &of_property {
            let set = Set::new(mesh.nodes_of_all(members), members.clone());
            sets.insert(format!("pid:{property}"), set);
        }
        for (id, kind, ids, at) in &self.cards {
            let (mut nodes, mut elements) = (Vec::new(), Vec::new());
            let (grids, no_grids) = lookup.existing(ids);
            let (members, no_elements) = existing(&numbers, ids);
            let lacking = match kind {
                Kind::Either if grids.is_empty() => {
                    elements = members;
                    no_elements
                }
                Kind::Either | Kind::Grids => {
                    nodes = grids;
                    no_grids
                }
                Kind::Elements => {
                    elements = members;
                    no_elements
                }
                Kind::Properties => {
                    let table = of_property
                        .keys()
                        .enumerate()
                        .map(|(i, property)| (*property, i as u32)) // fewer than elements
                        .collect::<Vec<_>>();
                    let (found, lacking) = existing(&Labels::new(table), ids);
                    let found = found.into_iter().collect::<BTreeSet<u32>>();
                    for (i, members) in of_property.values().enumerate() {
                        if found.contains(&(i as u32)) {
                            elements.extend(members);
                        }
                    }
                    lacking
                }
            };
            if lacking > 0 {
                unread.note("SET members that are missing", at, Carries::Nothing);
            }
            if !elements.is_empty() {
                nodes = mesh.nodes_of_all(&elements);
            }
            let into = sets.entry(format!("set:{id}")).or_default();
            *into = std::mem::take(into).joined(&Set::new(nodes, elements));
        }
        sets
    }
}
