//! `*BOUNDARY` of the model, and `*TRANSFORM`.

use std::collections::BTreeMap;

use super::frames::Transform;
use super::lines::Keyword;
use super::model::Model;
use super::scope::Block;
use crate::error::FileProblem;
use crate::fe::check::list;
use crate::mesh::{Carries, Code, Frame, Support};
use crate::read::held::HoldingCards;
use crate::read::source::At;
use crate::read::unread::UnreadCards;
use crate::read::vector::product;

/// Gives nodes their frames and returns the frames. In CalculiX a node may lie on the axis of a cylinder, where its
/// radial direction is arbitrary; a note names such nodes.
pub(super) fn transform(
    model: &mut Model,
    code: Code,
    notes: &mut Vec<String>,
) -> Result<Vec<Frame>, FileProblem> {
    let mut frames = Vec::new();
    let mut of_node: BTreeMap<u32, u32> = BTreeMap::new();
    for (place, block) in model.blocks() {
        let keyword = &block.keyword;
        if keyword.key != "TRANSFORM" {
            continue;
        }
        let transform = Transform::read(keyword, &block.rows)?;
        let motion = model
            .places
            .get(place)
            .map_or(super::frames::STILL, |placed| placed.motion());
        let mut shared = None;
        let mut on_axis = Vec::new();
        for node in model.nodes_of(place, keyword.require("NSET", "NSET")?, &keyword.at)? {
            let local = motion.back(model.position(node));
            let id = model.nodes.get(node as usize).map_or(0, |node| node.id);
            let axes = transform.axes_at(local).or_else(|| {
                let axes = transform
                    .axes_on_axis(local)
                    .filter(|_| code == Code::CalculiX);
                on_axis.extend(axes.map(|_| id.to_string()));
                axes
            });
            let Some(axes) = axes else {
                return Err(keyword.problem(
                    &format!("its points give no axes at node {id}"),
                    "choose points that form a triangle, and no axis through the node",
                ));
            };
            let index = match shared {
                Some(index) if transform.is_rectangular() => index,
                _ => {
                    let index = frames.len() as u32; // never more than nodes
                    frames.push(Frame {
                        rotation: product(&motion.rotation, &axes),
                    });
                    index
                }
            };
            shared = Some(index);
            if of_node.insert(node, index).is_some() {
                return Err(keyword.problem(
                    &format!("node {id} has two *TRANSFORM"),
                    "remove it from one of the two sets",
                ));
            }
        }
        notes.extend(arbitrary(keyword, "its axis", on_axis));
    }
    for (node, frame) in of_node {
        if let Some(node) = model.nodes.get_mut(node as usize) {
            node.frame = Some(frame);
        }
    }
    Ok(frames)
}

/// A note about nodes on an axis, where CalculiX chooses the radial direction.
pub(super) fn arbitrary(keyword: &Keyword, axis: &str, nodes: Vec<String>) -> Option<String> {
    let (at, name) = (&keyword.at, &keyword.name);
    (!nodes.is_empty()).then(|| {
        format!(
            "{}:{}: *{name}: nodes on {axis} have no radial direction, so the one of CalculiX is used: {}",
            at.file,
            at.line,
            list(nodes)
        )
    })
}

/// The rotations among the components of a node, as bits from translation x on.
const ROTATIONS: u8 = 0b11_1000;

/// Supports named by a word.
fn named(word: &str) -> Option<u8> {
    Some(match word {
        "ENCASTRE" => 0b11_1111,
        "PINNED" => 0b00_0111,
        "XSYMM" => 0b11_0001,
        "YSYMM" => 0b10_1010,
        "ZSYMM" => 0b01_1100,
        "XASYMM" => 0b00_1110,
        "YASYMM" => 0b01_0101,
        "ZASYMM" => 0b10_0011,
        _ => return None,
    })
}

/// The freedoms that `*BOUNDARY` holds: `node or set, first, last, value` or `node or set, word`. Those of
/// steps after the first are counted as changing.
pub(super) fn supports(
    model: &Model,
    cards: &mut HoldingCards,
    unread: &mut UnreadCards,
) -> Result<Vec<Support>, FileProblem> {
    let mut held: BTreeMap<u32, u8> = BTreeMap::new();
    for (place, block) in model.blocks() {
        let keyword = &block.keyword;
        if keyword.key != "BOUNDARY" {
            continue;
        }
        // it moves its nodes as a larger model does
        if keyword.has("SUBMODEL") {
            cards.note("*BOUNDARY, SUBMODEL", &keyword.at, true);
            continue;
        }
        let again = keyword.choice("OP") == "NEW";
        if block.step > 1 || again {
            let name = match again {
                true => "*BOUNDARY, OP=NEW",
                false => "*BOUNDARY of a later *STEP",
            };
            cards.note(name, &keyword.at, true);
            continue;
        }
        match holding(model, place, block, unread) {
            Ok(found) => {
                for (nodes, components, moved, at) in found {
                    cards.note("*BOUNDARY", &at, moved);
                    for node in nodes {
                        *held.entry(node).or_default() |= components;
                    }
                }
            }
            // a step is no part of the mesh, so a mistake in it counts only if the model requests its
            // supports
            Err(_) if block.step > 0 => cards.note("*BOUNDARY of a *STEP", &keyword.at, true),
            Err(problem) => return Err(problem),
        }
    }
    Ok(held
        .into_iter()
        .map(|(node, components)| Support { node, components })
        .collect())
}

/// Frees the rotations of a rigid body's reference node in CalculiX: they belong to its `ROT NODE`, and CalculiX
/// 2.20 holds nothing where supports name them, with or without this node. Returns notes.
pub(super) fn free_rotations(
    model: &Model,
    supports: &mut Vec<Support>,
) -> Result<Vec<String>, FileProblem> {
    let mut notes = Vec::new();
    for (place, block) in model.blocks() {
        let keyword = &block.keyword;
        if keyword.key != "RIGIDBODY" {
            continue;
        }
        let reference = keyword.require("REFNODE", "REF NODE")?;
        let reference = model.node_of(place, reference, &keyword.at)?;
        let held = supports.iter_mut().find(|held| held.node == reference);
        if let Some(held) = held
            && held.components & ROTATIONS != 0
        {
            held.components &= !ROTATIONS;
            let id = model
                .nodes
                .get(reference as usize)
                .map_or(0, |node| node.id);
            notes.push(format!(
                "{}:{}: *BOUNDARY holds rotations of node {id}, and CalculiX leaves those of a *RIGID BODY free, as here; the displacements of a ROT NODE hold them",
                keyword.at.file, keyword.at.line
            ));
        }
    }
    supports.retain(|held| held.components != 0);
    Ok(notes)
}

/// Nodes and components of the lines of a `*BOUNDARY`, whether they are moved, and their places in the file.
#[allow(clippy::type_complexity)]
fn holding(
    model: &Model,
    place: usize,
    block: &Block,
    unread: &mut UnreadCards,
) -> Result<Vec<(Vec<u32>, u8, bool, At)>, FileProblem> {
    let mut found = Vec::new();
    for row in block.rows.iter().filter(|row| !row.is_blank()) {
        let word = super::lines::key(row.text(1));
        let components = match (named(&word), word.parse::<u8>()) {
            (Some(components), _) => components,
            // temperature and other fields
            (None, Ok(7..)) => {
                unread.note("*BOUNDARY of other fields", &row.at, Carries::Nothing);
                continue;
            }
            (None, Ok(_)) => row.freedom_range(1)?,
            (None, Err(_)) => {
                return Err(row.at.problem(
                    format!("*BOUNDARY: \"{}\" is neither a freedom nor a support", row.text(1)),
                    "give the first and the last freedom, each from 1 to 6, or a support such as ENCASTRE, PINNED or XSYMM",
                ));
            }
        };
        let moved = row.optional_real(3, "the value")?.unwrap_or(0.0) != 0.0;
        let nodes = model.nodes_of(place, row.text(0), &row.at)?;
        found.push((nodes, components, moved, row.at.clone()));
    }
    Ok(found)
}
