//! Nodes of CalculiX whose displacements are rotations: the three of a `ROT NODE` of a `*RIGID BODY` are those of the body,
//! the first one of the last node of a `MEANROT` is its angle.

use std::collections::BTreeMap;

use super::mean_rotation::MeanRotation;
use super::model::Model;
use super::shapes::Shape;
use crate::error::FileProblem;
use crate::mesh::{Carries, Code, Support, Tie, scalar_index};
use crate::read::source::At;
use crate::read::unread::UnreadCards;

/// The nodes whose displacements are rotations (rad).
#[derive(Debug, Default)]
pub(super) struct Rotations {
    /// The reference node of each, and the place of its `*RIGID BODY`; of the last node of a `MEANROT` the scalar point of its
    /// angle.
    references: BTreeMap<u32, (u32, At)>,
}

impl Rotations {
    /// Those of a model of CalculiX. Another code has none. One that an element uses, or that has axes of its own, is
    /// noted.
    ///
    /// # Errors
    /// A node that is missing, or the reference node itself, or turns two bodies.
    pub fn new(
        model: &Model,
        code: Code,
        means: &[MeanRotation],
        unread: &mut UnreadCards,
    ) -> Result<Self, FileProblem> {
        let mut references: BTreeMap<u32, (u32, At)> = BTreeMap::new();
        for mean in means {
            let pilot = mean.pilot;
            let node = model.nodes.get(pilot as usize);
            if node.is_some_and(|node| node.frame.is_some()) {
                let name = "*TRANSFORM of the last node of a MEANROT";
                unread.note(name, &mean.at, Carries::Structure);
            }
            if references
                .insert(pilot, (mean.angle, mean.at.clone()))
                .is_some()
            {
                let id = node.map_or(0, |node| node.id);
                return Err(mean.at.problem(
                    format!("node {id} is the angle of another MEANROT, too"),
                    "give each mean rotation a last node of its own",
                ));
            }
        }
        for (place, block) in model.blocks() {
            let keyword = &block.keyword;
            if keyword.key != "RIGIDBODY" || !keyword.has("ROTNODE") {
                continue;
            }
            if code != Code::CalculiX {
                unread.note("*RIGID BODY, ROT NODE", &keyword.at, Carries::Structure);
                continue;
            }
            let rotation = keyword.require("ROTNODE", "ROT NODE")?;
            let rotation = model.node_of(place, rotation, &keyword.at)?;
            let reference = keyword.require("REFNODE", "REF NODE")?;
            let reference = model.node_of(place, reference, &keyword.at)?;
            let id = model.nodes.get(rotation as usize).map_or(0, |node| node.id);
            if rotation == reference {
                return Err(keyword.problem(
                    &format!("its ROT NODE {id} is also its REF NODE"),
                    "give a node of its own for the rotations",
                ));
            }
            let turned = model.nodes.get(rotation as usize);
            if turned.is_some_and(|node| node.frame.is_some()) {
                let name = "*TRANSFORM of a ROT NODE";
                unread.note(name, &keyword.at, Carries::Structure);
            }
            let before = references.insert(rotation, (reference, keyword.at.clone()));
            if before.is_some() {
                return Err(keyword.problem(
                    &format!("the ROT NODE {id} turns another rigid body, too"),
                    "give each rigid body a ROT NODE of its own",
                ));
            }
        }
        if !references.is_empty() {
            let used = model
                .rows
                .iter()
                .filter(|row| row.shape != Shape::Distributing);
            for row in used {
                let mut nodes = model.row_nodes(row).iter();
                if let Some((reference, _)) = nodes.find_map(|node| references.get(node)) {
                    let name = match scalar_index(*reference) {
                        Some(_) => "elements at the last node of a MEANROT",
                        None => "elements at a ROT NODE",
                    };
                    unread.note(name, &row.at, Carries::Structure);
                }
            }
        }
        Ok(Rotations { references })
    }

    /// The freedom of a node: a displacement of a `ROT NODE` is a rotation of its reference node.
    pub fn freedom(&self, node: u32, freedom: u8, at: &At) -> Result<(u32, u8), FileProblem> {
        match self.references.get(&node) {
            None => Ok((node, freedom)),
            Some((angle, _)) if scalar_index(*angle).is_some() => match freedom {
                0 => Ok((*angle, 0)),
                _ => Err(at.problem(
                    format!(
                        "freedom {} of the last node of a MEANROT does not exist",
                        freedom + 1
                    ),
                    "write 1: its first displacement is the angle",
                )),
            },
            Some((reference, _)) if freedom < 3 => Ok((*reference, freedom + 3)),
            Some(_) => Err(at.problem(
                format!("freedom {} of a ROT NODE does not exist", freedom + 1),
                "write 1, 2 or 3: the displacements of a ROT NODE are the rotations of its rigid body",
            )),
        }
    }

    /// Notes ties that name such a node as if it had a place.
    pub fn refuse_ties(&self, ties: &[Tie], unread: &mut UnreadCards) {
        if self.references.is_empty() {
            return;
        }
        for tie in ties {
            let mut places = Vec::new();
            tie.each(|node, _| {
                let found = self.references.get(&node).map(|(reference, at)| {
                    let name = match scalar_index(*reference) {
                        Some(_) => "ties of the last node of a MEANROT",
                        None => "ties of a ROT NODE",
                    };
                    (name, at)
                });
                places.extend(found);
            });
            if let Some((name, at)) = places.first() {
                unread.note(name, at, Carries::Structure);
            }
        }
    }

    /// Moves supports to the rotations that they hold. A `ROT NODE` has no rotations of its own.
    pub fn hold(&self, supports: &mut Vec<Support>) {
        let mut moved: BTreeMap<u32, u8> = BTreeMap::new();
        for support in std::mem::take(supports) {
            let (node, components) = match self.references.get(&support.node) {
                Some((angle, _)) if scalar_index(*angle).is_some() => {
                    (*angle, support.components & 1)
                }
                Some((reference, _)) => (*reference, (support.components & 0b111) << 3),
                None => (support.node, support.components),
            };
            *moved.entry(node).or_default() |= components;
        }
        let held = moved.into_iter().filter(|(_, components)| *components != 0);
        supports.extend(held.map(|(node, components)| Support { node, components }));
    }
}
