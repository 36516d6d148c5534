//! `*PRE-TENSION SECTION`, closed: its surfaces stay together.
//!
//! CalculiX and Abaqus cut the body there, and move the sides apart by the first displacement of a node. Where this is held,
//! as after a bolt has been tightened, the cut has no effect on vibrations.

use std::collections::BTreeSet;

use super::model::Model;
use crate::error::FileProblem;
use crate::mesh::{Carries, Mesh};
use crate::read::unread::UnreadCards;

/// Closes the sections of a mesh with its ties and supports. A note says so where no support holds the node. A section whose
/// node a tie or an element uses is listed as not read.
///
/// # Errors
/// No node, or one that is missing.
pub(super) fn close(
    model: &Model,
    mesh: &mut Mesh,
    unread: &mut UnreadCards,
) -> Result<(), FileProblem> {
    let mut used: BTreeSet<u32> = BTreeSet::new();
    for (place, block) in model.blocks() {
        let keyword = &block.keyword;
        if keyword.key != "PRE-TENSIONSECTION" {
            continue;
        }
        if used.is_empty() {
            used.extend(model.rows.iter().flat_map(|row| model.row_nodes(row)));
            let ties = mesh.ties.iter();
            ties.for_each(|tie| {
                tie.each(|node, _| {
                    used.insert(node);
                });
            });
        }
        let node = keyword.require("NODE", "NODE")?;
        let node = model.node_of(place, node, &keyword.at)?;
        let id = model.nodes.get(node as usize).map_or(0, |node| node.id);
        if used.contains(&node) {
            let name = "*PRE-TENSION SECTION with a node of a tie or element";
            unread.note(name, &keyword.at, Carries::Structure);
            continue;
        }
        let held = |support: &&crate::mesh::Support| support.node == node;
        let support = mesh.supports.iter().find(held);
        if support.is_none_or(|support| support.components & 1 == 0) {
            mesh.doubts.push(format!(
                "{}:{}: *PRE-TENSION SECTION is closed, as if the displacement of its node {id} were held after tightening",
                keyword.at.file, keyword.at.line
            ));
        }
    }
    Ok(())
}
