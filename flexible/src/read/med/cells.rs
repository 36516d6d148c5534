//! Cells: for each geometry their nodes, families and numbers.

use super::folder::{AGAIN, File, Folder, fits};
use crate::error::FileProblem;
use crate::fe::vector::{Vector, determinant, subtract};
use crate::mesh::{ElementKind, Node};

/// Geometries that are no elements here, with dimension and number of nodes: points, lines, and those with nodes inside.
const OTHERS: &[(&str, u8, usize)] = &[
    ("PO1", 0, 1),
    ("SE2", 1, 2),
    ("SE3", 1, 3),
    ("SE4", 1, 4),
    ("TR7", 2, 7),
    ("QU9", 2, 9),
    ("P18", 3, 18),
    ("H27", 3, 27),
    ("OCT", 3, 12),
];

/// Cells of one geometry.
#[derive(Debug)]
pub(super) struct Cells {
    /// The path of their folder, for messages.
    pub path: String,
    /// Name of the geometry.
    pub geometry: String,
    /// Dimension of the geometry.
    pub dimension: u8,
    /// The kind, if Eng has one.
    pub kind: Option<ElementKind>,
    /// Nodes of a cell.
    pub nodes: usize,
    /// Number of cells.
    pub count: usize,
    /// Their nodes from 1, by place in the cell, then by cell.
    connectivity: Vec<i64>,
    /// Families; empty if all cells are in none.
    families: Vec<i64>,
    /// The file's numbers; empty without numbers.
    pub numbers: Vec<i64>,
}

impl Cells {
    /// Reads the cells of a geometry. `None` if Eng does not know the geometry.
    pub fn read(
        file: &File<'_>,
        folder: &Folder<'_>,
        geometry: &str,
    ) -> Result<Option<Self>, FileProblem> {
        let kind = ElementKind::of_med(geometry);
        let other = OTHERS.iter().find(|(name, ..)| *name == geometry);
        let (dimension, nodes) = match (kind, other) {
            (Some(kind), _) => (kind.dimension(), kind.node_count()),
            (None, Some((_, dimension, nodes))) => (*dimension, *nodes),
            (None, None) => return Ok(None),
        };
        let Some(connectivity) = file.integers(folder, "NOD")? else {
            return Err(file.problem(
                &folder.path,
                "the cells have no list of nodes NOD; faces or edges describe them, or it is missing",
                "write the mesh with nodal connectivity",
            ));
        };
        let count = connectivity.len() / nodes;
        let mut lists = [Vec::new(), Vec::new()];
        for (list, name) in lists.iter_mut().zip(["FAM", "NUM"]) {
            *list = file.integers(folder, name)?.unwrap_or_default();
        }
        let [families, numbers] = lists;
        if connectivity.len() % nodes != 0 || !fits(&families, count) || !fits(&numbers, count) {
            let problem = format!(
                "it has {} nodes, {} families and {} numbers, which do not fit cells of {nodes} nodes",
                connectivity.len(),
                families.len(),
                numbers.len()
            );
            return Err(file.problem(&folder.path, &problem, AGAIN));
        }
        Ok(Some(Cells {
            path: folder.path.clone(),
            geometry: geometry.to_owned(),
            dimension,
            kind,
            nodes,
            count,
            connectivity,
            families,
            numbers,
        }))
    }

    /// The indices of the nodes of a cell, in the order of its kind, in a mesh with these nodes. Some programs write mirrored
    /// solids, and code_aster takes them as they are. The order of MED is the mirror image of ours, so these have our order.
    pub fn nodes_of(
        &self,
        file: &File<'_>,
        cell: usize,
        nodes: &[Node],
    ) -> Result<Vec<u32>, FileProblem> {
        let order = self
            .kind
            .and_then(|kind| kind.description().names.med_order);
        let found = self.in_order(file, cell, (nodes.len(), order))?;
        let mirrored = self
            .kind
            .is_some_and(|kind| volume(kind, &found, nodes) < 0.0);
        match mirrored {
            true => self.in_order(file, cell, (nodes.len(), None)),
            false => Ok(found),
        }
    }

    /// The indices of the nodes of a cell by an order of places, in a mesh of so many nodes.
    fn in_order(
        &self,
        file: &File<'_>,
        cell: usize,
        (nodes, order): (usize, Option<&[usize]>),
    ) -> Result<Vec<u32>, FileProblem> {
        let mut found = Vec::with_capacity(self.nodes);
        for place in 0..self.nodes {
            let place = order.and_then(|order| order.get(place)).unwrap_or(&place);
            let node = self.connectivity.get(place * self.count + cell).copied();
            let node = node.unwrap_or(0);
            let index = u32::try_from(node)
                .ok()
                .and_then(|node| node.checked_sub(1));
            match index.filter(|index| (*index as usize) < nodes) {
                Some(index) => found.push(index),
                None => {
                    let problem = format!(
                        "cell {} uses node {node}, but the mesh has {nodes} nodes",
                        cell + 1
                    );
                    return Err(file.problem(
                        &self.path,
                        &problem,
                        "write the whole mesh with all its nodes",
                    ));
                }
            }
        }
        Ok(found)
    }

    /// The family of a cell.
    pub fn family(&self, cell: usize) -> i64 {
        self.families.get(cell).copied().unwrap_or(0)
    }
}

/// Six times the volume of a solid between its corners, negative if it is mirrored; zero for a surface.
fn volume(kind: ElementKind, own: &[u32], nodes: &[Node]) -> f64 {
    let corner = |local: &usize| {
        let index = own.get(*local).copied()?;
        nodes.get(index as usize).map(|node| node.position)
    };
    let volumes = kind.description().simplices.iter().map(|simplex| {
        let corners: Option<Vec<Vector>> = simplex.iter().map(corner).collect();
        match corners.as_deref() {
            Some([a, b, c, d]) => determinant(&[b, c, d].map(|x| subtract(*x, *a))),
            _ => 0.0,
        }
    });
    volumes.sum()
}
