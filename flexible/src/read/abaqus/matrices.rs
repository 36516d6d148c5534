//! `*MATRIX INPUT` and `*MATRIX ASSEMBLE`: a deck whose stiffness and mass are matrices, such as the one that
//! `eng reduce --to abaqus` writes.
//!
//! A node set with the name `MODAL_FREEDOMS`, or a name that ends so, has the nodes whose freedoms are
//! amplitudes of modes. Abaqus knows no other place for them than freedoms of nodes, and nothing else in a
//! deck tells them from displacements. Each becomes a scalar point, numbered by ten times the node and the
//! freedom.

use std::collections::{BTreeMap, BTreeSet};

use super::lines::{Keyword, Row, key};
use super::model::Model;
use super::scope::{Block, required_label};
use crate::error::FileProblem;
use crate::mesh::{Carries, DeckMatrices, DeckMatrix, Mesh, SCALAR, Set, Support, Tie};
use crate::read::unread::UnreadCards;

/// The end of the names of sets of nodes that carry amplitudes.
const MODAL: &str = "MODAL_FREEDOMS";

/// Reads the matrices into the mesh, which has all else of the deck.
///
/// # Errors
/// A matrix without name, data or an entry; one that is missing; modal nodes that elements use.
pub(super) fn make(
    model: &Model,
    mesh: &mut Mesh,
    unread: &mut UnreadCards,
) -> Result<(), FileProblem> {
    let mut inputs: BTreeMap<String, &Block> = BTreeMap::new();
    let mut assembled: Option<&Block> = None;
    for (_, block) in model.blocks() {
        match block.keyword.key.as_str() {
            "MATRIXINPUT" => {
                inputs.insert(key(block.keyword.require("NAME", "NAME")?), block);
            }
            "MATRIXASSEMBLE" => {
                let several = assembled.replace(block).is_some();
                if several || block.keyword.has("NSET") {
                    let name = "*MATRIX ASSEMBLE of several parts or other nodes";
                    unread.note(name, &block.keyword.at, Carries::Structure);
                }
            }
            _ => {}
        }
    }
    let Some(assembled) = assembled else {
        for block in inputs.values() {
            unread.note(
                "*MATRIX INPUT without *MATRIX ASSEMBLE",
                &block.keyword.at,
                Carries::Nothing,
            );
        }
        return Ok(());
    };
    let keyword = &assembled.keyword;
    if !mesh.elements.is_empty() || !mesh.point_masses.is_empty() || !mesh.springs.is_empty() {
        unread.note(
            "*MATRIX ASSEMBLE beside elements",
            &keyword.at,
            Carries::Structure,
        );
        return Ok(());
    }
    if keyword.has("VISCOUSDAMPING") || keyword.has("STRUCTURALDAMPING") {
        unread.note("damping of *MATRIX ASSEMBLE", &keyword.at, Carries::Nothing);
    }
    let modal = modal_nodes(mesh);
    if modal.is_empty()
        && mesh
            .ties
            .iter()
            .any(|tie| matches!(tie, Tie::Equation { .. }))
    {
        mesh.doubts.push(format!(
            "{}:{}: all freedoms of the matrices count as displacements and rotations; if some are amplitudes of modes, put their nodes into a node set {MODAL}",
            keyword.at.file, keyword.at.line
        ));
    }
    let read = |parameter: &str| {
        let name = keyword.require(parameter, parameter)?;
        let input = inputs.get(&key(name)).ok_or_else(|| {
            keyword.problem(
                &format!("the matrix {name} is missing"),
                "add its *MATRIX INPUT",
            )
        })?;
        matrix(input, &modal)
    };
    let matrices = DeckMatrices {
        stiffness: read("STIFFNESS")?,
        mass: read("MASS")?,
    };
    remove_modal(mesh, &modal, &matrices, keyword)?;
    mesh.matrices = Some(Box::new(matrices));
    Ok(())
}

/// Numbers of the nodes that carry amplitudes.
fn modal_nodes(mesh: &Mesh) -> BTreeSet<u64> {
    let sets = mesh.sets.iter();
    let modal = sets.filter(|(name, _)| name.to_ascii_uppercase().ends_with(MODAL));
    let nodes = modal.flat_map(|(_, set)| set.nodes().iter());
    nodes
        .filter_map(|node| mesh.nodes.get(*node as usize))
        .map(|node| node.id)
        .collect()
}

/// The number of the scalar point of a freedom 1…6 of a modal node.
fn scalar(node: u64, freedom: u8) -> u64 {
    node.saturating_mul(10).saturating_add(u64::from(freedom))
}

/// A matrix of lines `node, freedom, node, freedom, value`.
fn matrix(block: &Block, modal: &BTreeSet<u64>) -> Result<DeckMatrix, FileProblem> {
    let keyword = &block.keyword;
    if keyword.choice("TYPE") == "UNSYMMETRIC" {
        return Err(keyword.problem(
            "the matrix is not symmetric",
            "write stiffness and mass of a linear elastic structure",
        ));
    }
    let factor = match keyword.get("SCALEFACTOR") {
        Some(text) => crate::read::number::real(text).ok_or_else(|| {
            keyword.problem(&format!("SCALE FACTOR is \"{text}\""), "give a number")
        })?,
        None => 1.0,
    };
    let mut pairs = Vec::with_capacity(block.rows.len());
    for row in block.rows.iter().filter(|row| !row.is_blank()) {
        let freedom = |i: usize| freedom(row, i, modal);
        pairs.push((freedom(0)?, freedom(2)?, factor * row.real(4, "an entry")?));
    }
    let name = format!(
        "*{}, NAME={}",
        keyword.name,
        keyword.get("NAME").unwrap_or("")
    );
    if pairs.is_empty() {
        return Err(keyword.problem("the matrix has no entry", "give its data or its INPUT"));
    }
    Ok(DeckMatrix {
        file: keyword.at.file.to_string(),
        name,
        pairs,
    })
}

/// Node and freedom of two fields; 0 is that of a scalar point.
fn freedom(row: &Row, i: usize, modal: &BTreeSet<u64>) -> Result<(u64, u8), FileProblem> {
    let node = required_label(row.text(i), "a node", &row.at)?;
    let freedom = row.freedom(i + 1)? + 1;
    Ok(match modal.contains(&node) {
        true => (scalar(node, freedom), 0),
        false => (node, freedom),
    })
}

/// Takes the modal nodes out of the mesh. Equations and supports name their scalar points.
fn remove_modal(
    mesh: &mut Mesh,
    modal: &BTreeSet<u64>,
    matrices: &DeckMatrices,
    keyword: &Keyword,
) -> Result<(), FileProblem> {
    if modal.is_empty() {
        return Ok(());
    }
    let pairs = matrices.stiffness.pairs.iter().chain(&matrices.mass.pairs);
    let rows = pairs.flat_map(|(row, column, _)| [*row, *column]);
    let scalars: BTreeSet<u64> = rows
        .filter(|(_, freedom)| *freedom == 0)
        .map(|(id, _)| id)
        .collect();
    mesh.scalar_points = scalars.into_iter().collect();
    let ids: Vec<u64> = mesh.nodes.iter().map(|node| node.id).collect();
    let mut kept = 0;
    let places: Vec<Option<u32>> = ids
        .iter()
        .map(|id| {
            let place = (!modal.contains(id)).then_some(kept);
            kept += u32::from(place.is_some());
            place
        })
        .collect();
    let points = &mesh.scalar_points;
    // a freedom that no matrix names does not exist
    let moved = |node: u32, component: u8| -> Option<(u32, u8)> {
        let place = places.get(node as usize)?;
        if let Some(place) = place {
            return Some((*place, component));
        }
        let id = scalar(*ids.get(node as usize)?, component + 1);
        let index = points.binary_search(&id).ok()?;
        Some((SCALAR | u32::try_from(index).ok()?, 0))
    };
    let of_nodes = |problem: &str| {
        keyword.problem(
            problem,
            format!("name only nodes of matrices and equations in the set {MODAL}"),
        )
    };
    for tie in &mut mesh.ties {
        let Tie::Equation { terms, .. } = tie else {
            return Err(of_nodes(
                "ties other than *EQUATION are beside modal freedoms",
            ));
        };
        for term in terms {
            let Some((node, component)) = moved(term.0, term.1) else {
                return Err(of_nodes(
                    "an equation names a modal freedom that no matrix has",
                ));
            };
            (term.0, term.1) = (node, component);
        }
    }
    let supports = mesh.supports.iter().flat_map(|support| {
        let components = (0..6u8).filter(|c| support.components >> c & 1 == 1);
        components.filter_map(|c| moved(support.node, c))
    });
    mesh.supports = supports
        .map(|(node, c)| Support {
            node,
            components: 1 << c,
        })
        .collect();
    if mesh.supports.is_empty() {
        mesh.support_cards.clear();
    }
    for set in mesh.sets.values_mut() {
        let nodes = set
            .nodes()
            .iter()
            .filter_map(|node| *places.get(*node as usize)?);
        *set = Set::new(nodes.collect(), set.elements().to_vec());
    }
    let mut place = places.iter();
    mesh.nodes
        .retain(|_| place.next().is_some_and(Option::is_some));
    Ok(())
}
