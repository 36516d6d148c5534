//! `MEANROT` of `*MPC` in CalculiX: the mean rotation of nodes about an axis.
//!
//! Its last node is no point of the body. Its coordinates are the axis a, and its first displacement is the angle (rad), here
//! a scalar point
//!
//! ```text
//! φ = 1/n Σ_i (a × p_i)·(u_i − ū)/|p_i|²
//! ```
//!
//! with the part p_i, across the axis, of the vector to each node from the mean place of the n nodes, and their mean
//! displacement ū (CalculiX 2.20, `usermpc.f`). A node on the axis through the mean place does not turn.

use std::collections::BTreeSet;

use super::lines::key;
use super::model::Model;
use super::scope::Block;
use crate::error::FileProblem;
use crate::fe::vector::{add, cross, dot, scale, subtract};
use crate::mesh::{Code, Frame, SCALAR, Tie, along_axes};
use crate::read::source::At;
use crate::read::vector::unit;

/// Square of the distance from the axis by the scatter of the nodes, below which a node is on it (`usermpc.f`).
const ON_AXIS: f64 = 1e-10;

/// A mean rotation.
pub(super) struct MeanRotation {
    nodes: Vec<u32>,
    /// The node of axis and angle.
    pub pilot: u32,
    /// The angle, as an index with the bit [`SCALAR`]. The mesh has the angles of all mean rotations in their order.
    pub angle: u32,
    /// Its place in the file.
    pub at: At,
}

impl MeanRotation {
    /// Those of a model of CalculiX. Other codes have none.
    ///
    /// # Errors
    /// A node that is missing, or a list that does not name each node three times and the last one once.
    pub fn all(model: &Model, code: Code) -> Result<Vec<Self>, FileProblem> {
        let mut found = Vec::new();
        if code == Code::CalculiX {
            for (place, block) in model.blocks() {
                if block.keyword.key == "MPC" {
                    found.extend(Self::of_block(model, place, block)?);
                }
            }
        }
        for (index, mean) in (0..).zip(&mut found) {
            mean.angle = SCALAR | index;
        }
        Ok(found)
    }

    /// `MEANROT, n1, n1, n1, n2, … / 0, n6, …`: further lines begin with 0.
    fn of_block(model: &Model, place: usize, block: &Block) -> Result<Vec<Self>, FileProblem> {
        let mut lists: Vec<(Vec<u32>, At)> = Vec::new();
        let mut open = false;
        for row in block.rows.iter().filter(|row| !row.is_blank()) {
            match key(row.text(0)).as_str() {
                "MEANROT" => {
                    lists.push((Vec::new(), row.at.clone()));
                    open = true;
                }
                "0" if open => {}
                _ => open = false,
            }
            if let (true, Some((list, _))) = (open, lists.last_mut()) {
                for field in row.fields().into_iter().skip(1).filter(|f| !f.is_empty()) {
                    list.push(model.node_of(place, field, &row.at)?);
                }
            }
        }
        lists
            .into_iter()
            .map(|(list, at)| Self::of_list(&list, at))
            .collect()
    }

    fn of_list(list: &[u32], at: At) -> Result<Self, FileProblem> {
        let wrong = |at: &At| {
            at.problem(
                "MEANROT does not name each node three times and the node of its axis once",
                "write each node three times in a row, and last the node whose coordinates are the axis",
            )
        };
        let Some((pilot, others)) = list.split_last() else {
            return Err(wrong(&at));
        };
        let (triples, rest) = others.as_chunks::<3>();
        let alike = triples.iter().all(|[a, b, c]| a == b && b == c);
        if triples.is_empty() || !rest.is_empty() || !alike {
            return Err(wrong(&at));
        }
        Ok(MeanRotation {
            nodes: triples.iter().map(|[node, ..]| *node).collect(),
            pilot: *pilot,
            angle: SCALAR,
            at,
        })
    }

    /// The number of its last node.
    pub fn number(&self, model: &Model) -> u64 {
        let node = model.nodes.get(self.pilot as usize);
        node.map_or(0, |node| node.id)
    }

    /// The problem of a deck whose matrices have scalar points of their own.
    pub fn beside_matrices(&self) -> FileProblem {
        self.at.problem(
            "MEANROT beside *MATRIX ASSEMBLE",
            "write the mean rotation as an *EQUATION",
        )
    }

    /// The factors of each node's displacement in n φ (1/length), along the basic axes, and the nodes on the axis.
    fn factors(&self, model: &Model) -> Result<(Vec<[f64; 3]>, Vec<u32>), FileProblem> {
        let Some(axis) = unit(model.position(self.pilot)) else {
            return Err(self.at.problem(
                "the axis of MEANROT has no direction",
                "give its last node the coordinates of a vector along the axis",
            ));
        };
        let share = 1.0 / self.nodes.len() as f64;
        let mean = |vectors: &[[f64; 3]]| {
            let sum = vectors.iter().fold([0.0; 3], |sum, x| add(sum, *x));
            scale(share, sum)
        };
        let places: Vec<[f64; 3]> = self
            .nodes
            .iter()
            .map(|node| model.position(*node))
            .collect();
        let centre = mean(&places);
        let arms: Vec<[f64; 3]> = places
            .iter()
            .map(|place| subtract(*place, centre))
            .collect();
        let scatter: f64 = arms.iter().map(|arm| share * dot(*arm, *arm)).sum();
        let mut on_axis = Vec::new();
        let mut own = Vec::with_capacity(arms.len());
        for (arm, node) in arms.iter().zip(&self.nodes) {
            let across = subtract(*arm, scale(dot(*arm, axis), axis));
            let square = dot(across, across);
            if square <= ON_AXIS * scatter {
                on_axis.push(*node);
                own.push([0.0; 3]);
            } else {
                own.push(scale(1.0 / square, cross(axis, across)));
            }
        }
        if on_axis.len() == self.nodes.len() {
            return Err(self.at.problem(
                "all nodes of MEANROT lie on its axis through their mean place",
                "name nodes beside the axis",
            ));
        }
        let whole = mean(&own);
        let factors = own.iter().map(|own| subtract(*own, whole)).collect();
        Ok((factors, on_axis))
    }

    /// The equation of the angle. It depends on the others, unless another tie already makes it dependent: then the displacement with the largest factor does, of those that no tie has.
    ///
    /// # Errors
    /// An axis without direction, nodes on the axis alone, no displacement that is free of other ties.
    pub fn equation(
        &self,
        id: u64,
        (model, frames): (&Model, &[Frame]),
        dependent: &BTreeSet<(u32, u8)>,
        doubts: &mut Vec<String>,
    ) -> Result<Tie, FileProblem> {
        let (factors, on_axis) = self.factors(model)?;
        let mut terms = vec![(self.angle, 0, -(self.nodes.len() as f64))];
        for (node, factor) in self.nodes.iter().zip(factors) {
            let own = along_axes(&model.nodes, frames, *node, factor);
            for (freedom, factor) in (0..).zip(own) {
                if factor != 0.0 {
                    terms.push((*node, freedom, factor));
                }
            }
        }
        let free = |(node, freedom, _): &(u32, u8, f64)| !dependent.contains(&(*node, *freedom));
        let first = match terms.first().is_some_and(free) {
            true => Some(0),
            false => (terms.iter().enumerate())
                .filter(|(_, term)| free(term))
                .max_by(|(_, a), (_, b)| a.2.abs().total_cmp(&b.2.abs()))
                .map(|(place, _)| place),
        };
        let Some(first) = first else {
            return Err(self.at.problem(
                "other ties already move all nodes of MEANROT",
                "remove one of the ties",
            ));
        };
        terms.swap(0, first);
        if !on_axis.is_empty() {
            let id = |node: &u32| model.nodes.get(*node as usize).map_or(0, |node| node.id);
            let ids: Vec<String> = on_axis.iter().map(|node| id(node).to_string()).collect();
            doubts.push(format!(
                "{}:{}: nodes of MEANROT on its axis do not turn, as in CalculiX: {}",
                self.at.file,
                self.at.line,
                ids.join(", ")
            ));
        }
        Ok(Tie::Equation { id, terms })
    }
}

/// The freedoms that ties make dependent.
pub(super) fn dependent(ties: &[Tie]) -> BTreeSet<(u32, u8)> {
    let mut found = BTreeSet::new();
    let mut add = |node: u32, components: u8| {
        found.extend(
            (0..6)
                .filter(|k| components >> k & 1 == 1)
                .map(|k| (node, k)),
        );
    };
    for tie in ties {
        match tie {
            Tie::Rigid { dependent, .. } => {
                dependent.iter().for_each(|(node, mask)| add(*node, *mask));
            }
            Tie::Averaging {
                reference,
                reference_components,
                ..
            } => add(*reference, *reference_components),
            Tie::Equation { terms, .. } => {
                if let Some((node, freedom, _)) = terms.first() {
                    add(*node, 1 << freedom);
                }
            }
        }
    }
    found
}
