//! Whether a structure is one piece.

use super::check::{Role, list, role};
use super::freedoms::FreedomMap;
use crate::error::FlexibleError;
use crate::mesh::{ABSENT, Mesh, scalar_index};
use crate::sparse::SymmetricMatrix;

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

/// Nodes as they are joined, and which of them something stiff holds.
struct Pieces {
    sets: Sets,
    held: Vec<bool>,
    nodes: usize,
}

impl Pieces {
    fn new(mesh: &Mesh) -> Self {
        let count = mesh.nodes.len() + mesh.scalar_points.len();
        Pieces {
            nodes: mesh.nodes.len(),
            sets: Sets {
                parent: (0..count as u32).collect(),
            },
            held: vec![false; count],
        }
    }

    /// Joins nodes and scalar points; the latter follow the `nodes` of the mesh.
    fn join(&mut self, nodes: impl Iterator<Item = u32>) {
        let mut first = None;
        for node in nodes.filter(|node| *node != ABSENT) {
            let node = scalar_index(node).map_or(node, |index| (self.nodes + index) as u32);
            self.held[node as usize] = true;
            self.sets.join(*first.get_or_insert(node), node);
        }
    }

    fn join_ties(&mut self, mesh: &Mesh) {
        for tie in &mesh.ties {
            let mut nodes = Vec::new();
            tie.each(|node, _| nodes.push(node));
            self.join(nodes.into_iter());
        }
    }

    /// Refuses nodes that nothing stiff holds, and several parts.
    fn finish(
        mut self,
        mesh: &Mesh,
        freedoms: &FreedomMap,
        advice: &str,
    ) -> Result<(), FlexibleError> {
        let id = |node: usize| mesh.nodes[node].id.to_string();
        let used = |node: &usize| !freedoms.of(*node as u32).is_empty();
        let loose: Vec<usize> = (0..mesh.nodes.len())
            .filter(used)
            .filter(|node| !self.held[*node])
            .collect();
        if !loose.is_empty() {
            return Err(FlexibleError::structure(
                format!(
                    "{} mass but no stiffness: {}",
                    match loose.len() {
                        1 => "a node has".to_owned(),
                        count => format!("{count} nodes have"),
                    },
                    list(loose.iter().map(|node| id(*node)))
                ),
                advice,
            ));
        }
        let mut size = vec![0usize; self.held.len()];
        for node in (0..mesh.nodes.len()).filter(used) {
            size[self.sets.find(node as u32) as usize] += 1;
        }
        let parts: Vec<usize> = (0..size.len()).filter(|node| size[*node] > 0).collect();
        if parts.len() > 1 {
            return Err(FlexibleError::structure(
                format!(
                    "the structure falls into {} parts that nothing connects: {}",
                    parts.len(),
                    list(parts.iter().map(|node| match size[*node] {
                        1 => format!("node {} alone", id(*node)),
                        size => format!("{size} nodes with node {}", id(*node)),
                    }))
                ),
                "merge coincident nodes or tie the parts; a body is one piece",
            ));
        }
        Ok(())
    }
}

/// Checks that every node with freedoms is held by something stiff and that all are one part.
///
/// # Errors
/// Nodes that carry mass but are held by no element with stiffness, spring or tie; parts that nothing
/// connects, with the number of nodes and a node of each.
pub(super) fn check(mesh: &Mesh, freedoms: &FreedomMap) -> Result<(), FlexibleError> {
    let mut pieces = Pieces::new(mesh);
    for element in &mesh.elements {
        if matches!(
            role(mesh, element),
            Some(Role::Solid(_) | Role::Beam(_) | Role::Shell(..))
        ) {
            pieces.join(mesh.nodes_of(element).iter().copied());
        }
    }
    for spring in &mesh.springs {
        pieces.join(spring.terms.iter().map(|(node, ..)| *node));
    }
    pieces.join_ties(mesh);
    pieces.finish(
        mesh,
        freedoms,
        "attach these nodes by ties, or remove them; shells without a material have mass but no stiffness",
    )
}

/// As [`check`], joined by the entries of a stiffness over the freedoms.
///
/// # Errors
/// As [`check`].
pub(super) fn check_matrix(
    mesh: &Mesh,
    freedoms: &FreedomMap,
    stiffness: &SymmetricMatrix,
) -> Result<(), FlexibleError> {
    let mut pieces = Pieces::new(mesh);
    let owner: Vec<u32> = (0..mesh.nodes.len() as u32)
        .flat_map(|node| freedoms.of(node).map(move |_| node))
        .collect();
    for (column, node) in owner.iter().enumerate().take(stiffness.size()) {
        let (rows, values) = stiffness.column(column);
        for (row, _) in rows.iter().zip(values).filter(|(_, x)| **x != 0.0) {
            if let Some(other) = owner.get(*row as usize) {
                pieces.join([*node, *other].into_iter());
            }
        }
    }
    pieces.join_ties(mesh);
    pieces.finish(
        mesh,
        freedoms,
        "tie these nodes, or write the matrices without them; the matrices have mass but no stiffness there",
    )
}
