//! Whether a structure hangs together.

use super::check::{Role, list, role, wrong};
use super::freedoms::FreedomMap;
use crate::error::FlexibleError;
use crate::mesh::{ABSENT, Mesh, Tie};

/// Sets of nodes that are joined; each is named by its smallest node.
struct Sets {
    parent: Vec<u32>,
}

impl Sets {
    fn find(&mut self, mut node: u32) -> u32 {
        while self.parent[node as usize] != node {
            let up = self.parent[node as usize];
            self.parent[node as usize] = self.parent[up as usize];
            node = up;
        }
        node
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

/// Checks that every node with freedoms is held by something stiff and that all are one part.
///
/// # Errors
/// Nodes that carry mass but are held by no element with stiffness, spring or tie; parts that nothing connects, with the
/// number of nodes and a node of each.
pub(super) fn check(mesh: &Mesh, freedoms: &FreedomMap) -> Result<(), FlexibleError> {
    let mut sets = Sets {
        parent: (0..mesh.nodes.len() as u32).collect(),
    };
    let mut held = vec![false; mesh.nodes.len()];
    let mut together = |nodes: &mut dyn Iterator<Item = u32>| {
        let mut first = None;
        for node in nodes.filter(|node| *node != ABSENT) {
            held[node as usize] = true;
            sets.join(*first.get_or_insert(node), node);
        }
    };
    for element in &mesh.elements {
        if matches!(role(mesh, element), Some(Role::Solid(_) | Role::Beam(_))) {
            together(&mut mesh.nodes_of(element).iter().copied());
        }
    }
    for spring in &mesh.springs {
        let ends = [Some(spring.first), spring.second];
        together(&mut ends.into_iter().flatten().map(|(node, _)| node));
    }
    for tie in &mesh.ties {
        match tie {
            Tie::Rigid {
                independent,
                dependent,
                ..
            } => together(
                &mut std::iter::once(*independent).chain(dependent.iter().map(|(node, _)| *node)),
            ),
            Tie::Averaging {
                reference,
                independent,
                ..
            } => together(
                &mut std::iter::once(*reference).chain(independent.iter().map(|(node, ..)| *node)),
            ),
            Tie::Equation { terms, .. } => together(&mut terms.iter().map(|(node, ..)| *node)),
        }
    }
    let id = |node: usize| mesh.nodes[node].id.to_string();
    let used = |node: &usize| !freedoms.of(*node as u32).is_empty();
    let loose: Vec<usize> = (0..mesh.nodes.len())
        .filter(used)
        .filter(|node| !held[*node])
        .collect();
    if !loose.is_empty() {
        return Err(wrong(
            format!(
                "{} nodes have mass but no stiffness: {}",
                loose.len(),
                list(loose.iter().map(|node| id(*node)))
            ),
            "shells carry no stiffness here, only mass on the nodes of solids; attach such nodes by ties, or leave them out",
        ));
    }
    let mut size = vec![0usize; mesh.nodes.len()];
    for node in (0..mesh.nodes.len()).filter(used) {
        size[sets.find(node as u32) as usize] += 1;
    }
    let parts: Vec<usize> = (0..size.len()).filter(|node| size[*node] > 0).collect();
    if parts.len() > 1 {
        return Err(wrong(
            format!(
                "the structure falls into {} parts that nothing connects: {}",
                parts.len(),
                list(parts.iter().map(|node| format!(
                    "{} nodes with node {}",
                    size[*node],
                    id(*node)
                )))
            ),
            "merge coincident nodes or tie the parts; a body is one piece",
        ));
    }
    Ok(())
}
