//! Stiffness and mass that another code wrote, over the freedoms of a mesh's nodes.
//!
//! The mesh gives places, analysis frames, ties and markers; its elements are not used. A freedom that no
//! row names is one that a tie expresses, one that nothing moves (rotations of the nodes of solids), or one
//! that the other code held.

use std::collections::BTreeMap;

use super::assemble::Assembled;
use super::check::{check_attachments, check_nodes, list};
use super::connection;
use super::freedoms::{FreedomMap, direction};
use super::mass::Mass;
use crate::error::{FlexibleError, Part};
use crate::mesh::{Mesh, SCALAR, Support, scalar_index};
use crate::sparse::SymmetricMatrix;

/// A symmetric matrix in SI, with the freedom of each row: the node's number and the component 0…5 (analysis
/// frame), or the number of a scalar point and `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct NodalMatrix {
    /// Its name in messages.
    pub(crate) title: String,
    /// Its entries (SI).
    pub(crate) matrix: SymmetricMatrix,
    /// Number of the node and component of each row.
    pub(crate) rows: Vec<(u64, Option<u8>)>,
}

/// A structure of foreign matrices.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignStructure {
    /// Matrices over the full freedoms, basic axes.
    pub structure: Assembled,
    /// Freedoms without stiffness and mass that no tie expresses: held, each in its node's analysis frame.
    pub missing: Vec<Support>,
}

/// Rows of a matrix by place in the mesh: index of the node and component.
pub(crate) fn places(mesh: &Mesh, matrix: &NodalMatrix) -> Result<Vec<(u32, u8)>, FlexibleError> {
    let title = &matrix.title;
    if matrix.rows.len() != matrix.matrix.size() {
        return Err(FlexibleError::Matrix {
            problem: format!(
                "{title} has {} rows, but the list has {} freedoms",
                matrix.matrix.size(),
                matrix.rows.len()
            ),
            advice: "give the matrix and the list of freedoms of the same run".into(),
        });
    }
    let index: BTreeMap<u64, u32> = mesh.node_index();
    let mut unknown = Vec::new();
    let mut found = Vec::with_capacity(matrix.rows.len());
    for (node, component) in &matrix.rows {
        let Some(component) = component else {
            let scalar = mesh.scalar_points.iter().position(|id| id == node);
            match scalar.and_then(|index| u32::try_from(index).ok()) {
                Some(index) => found.push((SCALAR | index, 0)),
                None => unknown.push(*node),
            }
            continue;
        };
        match index.get(node) {
            Some(node) if *component < 6 => found.push((*node, *component)),
            Some(_) => {
                return Err(FlexibleError::structure(
                    format!("{title} names component {} of node {node}", component + 1),
                    "name components from 1 to 6",
                ));
            }
            None => unknown.push(*node),
        }
    }
    unknown.dedup();
    if !unknown.is_empty() {
        return Err(FlexibleError::structure(
            format!(
                "{title} has rows of {} nodes that are not in the mesh: {}",
                unknown.len(),
                list(unknown.iter().map(u64::to_string))
            ),
            "give the mesh of the run that wrote the matrices, with all its nodes",
        ));
    }
    let mut sorted = found.clone();
    sorted.sort_unstable();
    if let Some([(node, component), ..]) = sorted.windows(2).find(|p| p.first() == p.last()) {
        return Err(FlexibleError::structure(
            format!(
                "{title} has two rows of {}",
                mesh.freedom_name(*node, *component)
            ),
            "check the order of the rows; each row must be a different freedom",
        ));
    }
    Ok(found)
}

/// The components of each node (bits 0…5) that have an entry other than zero; then those of scalar points
/// (bit 0).
pub(crate) fn moved(mesh: &Mesh, parts: [(&NodalMatrix, &[(u32, u8)]); 2]) -> Vec<u8> {
    let count = mesh.nodes.len();
    let mut moved = vec![0u8; count + mesh.scalar_points.len()];
    let mut note = |(node, component): (u32, u8)| {
        let place = scalar_index(node).map_or(node as usize, |index| count + index);
        if let Some(mask) = moved.get_mut(place) {
            *mask |= 1 << component;
        }
    };
    for (part, places) in parts {
        for (column, place) in places.iter().enumerate() {
            let (rows, values) = part.matrix.column(column);
            for (row, _) in rows.iter().zip(values).filter(|(_, x)| **x != 0.0) {
                note(*place);
                if let Some(other) = places.get(*row as usize) {
                    note(*other);
                }
            }
        }
    }
    moved
}

/// The components of each node (bits 0…5) that ties name.
fn tied(mesh: &Mesh) -> Vec<u8> {
    let mut tied = vec![0u8; mesh.nodes.len()];
    let mut note = |node: u32, mask: u8| {
        if let Some(tied) = tied.get_mut(node as usize) {
            *tied |= mask;
        }
    };
    for tie in &mesh.ties {
        tie.each(&mut note);
    }
    tied
}

/// A matrix over the full freedoms in basic axes: `Σ B_i a_ij B_jᵀ` with B_i the axes of node i's analysis
/// frame.
fn spread(
    mesh: &Mesh,
    freedoms: &FreedomMap,
    part: &NodalMatrix,
    places: &[(u32, u8)],
) -> Result<SymmetricMatrix, FlexibleError> {
    let lines: Vec<Vec<(u32, f64)>> = places
        .iter()
        .map(|&(node, component)| {
            let turned = mesh
                .nodes
                .get(node as usize)
                .is_some_and(|node| node.frame.is_some());
            let first = component / 3 * 3;
            if !turned {
                return freedoms
                    .freedom(node, component)
                    .map(|freedom| (freedom as u32, 1.0))
                    .into_iter()
                    .collect();
            }
            let axis = direction(mesh, node, component);
            (first..first + 3)
                .zip(axis)
                .filter(|(_, x)| *x != 0.0)
                .filter_map(|(k, x)| Some((freedoms.freedom(node, k)? as u32, x)))
                .collect()
        })
        .collect();
    let mut entries = Vec::with_capacity(part.matrix.values().len());
    for (column, second) in lines.iter().enumerate() {
        let (rows, values) = part.matrix.column(column);
        for (&row, &value) in rows.iter().zip(values) {
            let same = row as usize == column;
            for &(p, x) in lines.get(row as usize).map_or(&[][..], Vec::as_slice) {
                for &(q, y) in second {
                    // one triangle: of a mirrored pair, or of a block with itself
                    if same && p < q {
                        continue;
                    }
                    let twice = if !same && p == q { 2.0 } else { 1.0 };
                    entries.push((p, q, twice * value * x * y));
                }
            }
        }
    }
    SymmetricMatrix::from_triplets(freedoms.size(), &entries)
}

/// Stiffness and mass of another code as a structure of the mesh (SI).
///
/// # Errors
/// Rows of nodes that the mesh does not have, or repeated rows; nodes without stiffness; parts that nothing
/// connects; no mass.
pub fn from_matrices(
    mesh: &Mesh,
    stiffness: &NodalMatrix,
    mass: &NodalMatrix,
) -> Result<ForeignStructure, FlexibleError> {
    check_nodes(mesh)?;
    check_attachments(mesh)?;
    let stiff = places(mesh, stiffness).map_err(|error| error.of(Part::Stiffness))?;
    let heavy = places(mesh, mass).map_err(|error| error.of(Part::Mass))?;
    let moved = moved(mesh, [(stiffness, &stiff), (mass, &heavy)]);
    let (moved, moved_scalars) = moved.split_at(mesh.nodes.len());
    let count = moved
        .iter()
        .map(|mask| match mask {
            0 => 0,
            mask if mask >> 3 == 0 => 3,
            _ => 6,
        })
        .collect();
    let freedoms = FreedomMap::with_ties(mesh, count)?;
    let mut missing = Vec::new();
    for (node, (moved, tied)) in moved.iter().zip(tied(mesh)).enumerate() {
        let node = node as u32;
        let there = match freedoms.of(node).len() {
            6 => 0b11_1111,
            3 => 0b111,
            _ => 0,
        };
        let components = there & !moved & !tied;
        if components != 0 && *moved != 0 {
            missing.push(Support { node, components });
        }
    }
    for (index, _) in (0u32..)
        .zip(moved_scalars)
        .filter(|(_, moved)| **moved == 0)
    {
        let (node, components) = (SCALAR | index, 1);
        missing.push(Support { node, components });
    }
    let stiffness = spread(mesh, &freedoms, stiffness, &stiff)?;
    connection::check_matrix(mesh, &freedoms, &stiffness)?;
    let general = spread(mesh, &freedoms, mass, &heavy)?;
    let none = SymmetricMatrix::from_triplets(freedoms.all_nodes(), &[])?;
    let mass = Mass::new(freedoms.clone(), none, Some(general))?;
    let total = mass.rigid(mesh).mass;
    if total.is_nan() || total <= 0.0 {
        return Err(FlexibleError::structure(
            format!("the mass matrix gives the whole structure a mass of {total} kg"),
            "check that it is the mass matrix of this run, and check its units",
        ));
    }
    let unused_nodes = (0..mesh.nodes.len() as u32)
        .filter(|node| freedoms.of(*node).is_empty())
        .collect();
    Ok(ForeignStructure {
        structure: Assembled {
            freedoms,
            stiffness,
            mass,
            without_stiffness: Vec::new(),
            unused_nodes,
        },
        missing,
    })
}
