//! `ROT NODE` of a `*RIGID BODY` of CalculiX: a node whose three displacements are the rotations of the body.

use std::collections::BTreeMap;

use super::model::Model;
use super::shapes::Shape;
use crate::error::FileProblem;
use crate::mesh::{Carries, Code, Support, Tie};
use crate::read::source::At;
use crate::read::unread::UnreadCards;

/// The nodes whose displacements are rotations (rad) of rigid bodies.
#[derive(Debug, Default)]
pub(super) struct Rotations {
    /// The reference node of each, and the place of its `*RIGID BODY`.
    references: BTreeMap<u32, (u32, At)>,
}

impl Rotations {
    /// Those of a model of CalculiX. Another code has none. One that an element uses, or that has axes of its own, is
    /// noted.
    ///
    /// # Errors
    /// A node that is missing, or the reference node itself, or turns two bodies.
    pub fn new(model: &Model, code: Code, unread: &mut UnreadCards) -> Result<Self, FileProblem> {
        let mut references: BTreeMap<u32, (u32, At)> = BTreeMap::new();
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
                let nodes = model.row_nodes(row);
                if nodes.iter().any(|node| references.contains_key(node)) {
                    let name = "elements at a ROT NODE";
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
            tie.each(|node, _| places.extend(self.references.get(&node).map(|(_, at)| at)));
            if let Some(at) = places.first() {
                unread.note("ties of a ROT NODE", at, Carries::Structure);
            }
        }
    }

    /// Moves supports to the rotations that they hold. A `ROT NODE` has no rotations of its own.
    pub fn hold(&self, supports: &mut Vec<Support>) {
        let mut moved: BTreeMap<u32, u8> = BTreeMap::new();
        for support in std::mem::take(supports) {
            let (node, components) = match self.references.get(&support.node) {
                Some((reference, _)) => (*reference, (support.components & 0b111) << 3),
                None => (support.node, support.components),
            };
            *moved.entry(node).or_default() |= components;
        }
        let held = moved.into_iter().filter(|(_, components)| *components != 0);
        supports.extend(held.map(|(node, components)| Support { node, components }));
    }
}
