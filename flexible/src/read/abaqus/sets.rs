//! Named sets: `*NSET`, `*ELSET`, and the sets of the mesh.

use std::collections::BTreeMap;

use super::lines::key;
use super::model::{Model, Placed};
use super::scope::{Member, SetBlock};
use crate::error::FileProblem;
use crate::mesh::{Carries, Set};
use crate::read::unread::UnreadCards;

/// Fills the sets of all places in the order of the file. A set may contain earlier sets.
pub(super) fn fill(model: &mut Model, unread: &mut UnreadCards) -> Result<(), FileProblem> {
    for place in 0..model.places.len() {
        let Some(placed) = model.places.get_mut(place) else {
            continue;
        };
        let blocks = std::mem::take(&mut placed.scope.sets);
        for block in &blocks {
            let mut members = gather(model, place, block, unread)?;
            let Some(placed) = model.places.get_mut(place) else {
                continue;
            };
            let sets = if block.of_nodes {
                &mut placed.node_sets
            } else {
                &mut placed.element_sets
            };
            let entry = sets
                .entry(key(&block.name))
                .or_insert_with(|| (block.name.clone(), Vec::new()));
            entry.1.append(&mut members);
        }
        if let Some(placed) = model.places.get_mut(place) {
            let sets = placed.node_sets.values_mut();
            for (_, members) in sets.chain(placed.element_sets.values_mut()) {
                members.sort_unstable();
                members.dedup();
            }
        }
    }
    Ok(())
}

fn gather(
    model: &Model,
    place: usize,
    block: &SetBlock,
    unread: &mut UnreadCards,
) -> Result<Vec<u32>, FileProblem> {
    let place = match &block.instance {
        Some(name) => model.instance(name, &block.at)?,
        None => place,
    };
    let mut members = Vec::new();
    for member in &block.members {
        match member {
            Member::Numbers(first, last, step) => {
                let Some(placed) = model.places.get(place) else {
                    continue;
                };
                let labels = if block.of_nodes {
                    &placed.nodes
                } else {
                    &placed.elements
                };
                let before = members.len();
                members.extend(labels.range(*first, *last, *step, &[]));
                if members.len() == before
                    || (*step == 1 && lacks(members.len() - before, *first, *last))
                {
                    unread.note("set members that are missing", &block.at, Carries::Nothing);
                }
            }
            Member::Name(name) if block.of_nodes => {
                members.extend(model.nodes_of(place, name, &block.at)?);
            }
            Member::Name(name) => members.extend(model.rows_of(place, name, &block.at)?),
            Member::NodesOf(name) => {
                members.extend(model.nodes_of_rows(&model.rows_of(place, name, &block.at)?));
            }
        }
    }
    // a member listed several times must not make sets of sets grow
    members.sort_unstable();
    members.dedup();
    Ok(members)
}

/// Whether fewer members were found than the range from first to last has.
fn lacks(found: usize, first: u64, last: u64) -> bool {
    (found as u64) <= last - first
}

/// The sets of the mesh. A set of an instance has the name `Instance.SET`, and also `SET` if no other set has
/// that name. In a model with instances, each instance is also a set with its own name. A surface has the
/// name `surface:NAME`, and also `NAME` if no set has that name. A set of elements holds the nodes of its
/// elements, unless a set of nodes has the same name.
pub(super) fn sets(model: &Model) -> BTreeMap<String, Set> {
    let mut sets: BTreeMap<String, Set> = BTreeMap::new();
    // short name in capitals: number of uses, and full name
    let mut short: BTreeMap<String, (usize, String, String)> = BTreeMap::new();
    for placed in &model.places {
        let mut own: BTreeMap<String, (String, Set)> = BTreeMap::new();
        for (name, (written, rows)) in &placed.element_sets {
            let set = Set::new(model.nodes_of_rows(rows), elements(model, rows));
            own.insert(name.clone(), (written.clone(), set));
        }
        for (name, (written, nodes)) in &placed.node_sets {
            let entry = own
                .entry(name.clone())
                .or_insert_with(|| (written.clone(), Set::default()));
            entry.1 = Set::new(nodes.clone(), entry.1.elements().to_vec());
        }
        for (name, (written, surface)) in &placed.surfaces {
            let nodes = surface.nodes.iter().map(|(node, _)| *node).collect();
            let set = Set::new(nodes, Vec::new());
            if !own.contains_key(name) {
                own.insert(name.clone(), (written.clone(), set.clone()));
            }
            own.insert(
                format!("surface:{name}"),
                (format!("surface:{written}"), set),
            );
        }
        for (name, (written, set)) in own {
            let full = if placed.name.is_empty() {
                written.clone()
            } else {
                format!("{}.{written}", placed.name)
            };
            short
                .entry(name)
                .or_insert_with(|| (0, written, full.clone()))
                .0 += 1;
            sets.insert(full, set);
        }
        if !placed.name.is_empty() {
            sets.entry(placed.name.clone())
                .or_insert_with(|| whole(model, placed));
        }
    }
    for (count, written, full) in short.into_values() {
        if count == 1
            && !sets.contains_key(&written)
            && let Some(set) = sets.get(&full).cloned()
        {
            sets.insert(written, set);
        }
    }
    sets
}

fn whole(model: &Model, placed: &Placed) -> Set {
    let rows: Vec<u32> = placed.elements.indices().collect();
    Set::new(placed.nodes.indices().collect(), elements(model, &rows))
}

/// Elements of the mesh made from rows.
fn elements(model: &Model, rows: &[u32]) -> Vec<u32> {
    rows.iter()
        .filter_map(|row| model.rows.get(*row as usize))
        .flat_map(|row| row.elements.0..row.elements.0 + row.elements.1)
        .collect()
}
