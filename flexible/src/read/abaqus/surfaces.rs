//! `*SURFACE`: faces of elements or nodes, as nodes with their shares of the area.

use std::collections::BTreeMap;

use super::lines::{Row, key};
use super::model::Model;
use super::scope::Block;
use super::shapes::Shape;
use crate::element::{around, facets};
use crate::error::FileProblem;
use crate::fe::vector::{cross, subtract};
use crate::mesh::Carries;
use crate::read::tied::Face;
use crate::read::unread::UnreadCards;
use crate::read::vector::norm;

/// A surface of faces or nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Surface {
    /// Nodes, sorted, each with its weight: its area, or the number in a surface of `TYPE=NODE`.
    pub nodes: Vec<(u32, f64)>,
    pub faces: Vec<Face>,
}

/// Corners of a face, sorted. `u32::MAX` replaces the fourth corner of a triangle.
type FaceKey = [u32; 4];

/// Fills the surfaces of all places.
pub(super) fn fill(model: &mut Model, unread: &mut UnreadCards) -> Result<(), FileProblem> {
    let mut inner = None;
    for place in 0..model.places.len() {
        let mut made = Vec::new();
        for (of, block) in model.blocks() {
            if of != place || block.keyword.key != "SURFACE" {
                continue;
            }
            if let Some(surface) = surface(model, place, block, &mut inner, unread)? {
                let name = block.keyword.require("NAME", "NAME")?;
                made.push((key(name), name.to_string(), surface));
            }
        }
        if let Some(placed) = model.places.get_mut(place) {
            for (name, written, surface) in made {
                placed.surfaces.insert(name, (written, surface));
            }
        }
    }
    Ok(())
}

fn surface(
    model: &Model,
    place: usize,
    block: &Block,
    inner: &mut Option<Vec<FaceKey>>,
    unread: &mut UnreadCards,
) -> Result<Option<Surface>, FileProblem> {
    let keyword = &block.keyword;
    let rows = block.rows.iter().filter(|row| !row.is_blank());
    let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
    let mut faces = Vec::new();
    match keyword.choice("TYPE").as_str() {
        "NODE" => {
            for row in rows {
                let weight = row.optional_real(1, "the area")?.unwrap_or(1.0);
                for node in model.nodes_of(place, row.text(0), &row.at)? {
                    weights.insert(node, weight);
                }
            }
        }
        "" | "ELEMENT" if !keyword.has("COMBINE") && !keyword.has("CROP") => {
            for row in rows {
                add_faces(model, place, row, inner, (&mut weights, &mut faces))?;
            }
        }
        _ => {
            // a keyword that uses it reports it as missing
            unread.note(
                "*SURFACE that is no list of faces or nodes",
                &keyword.at,
                Carries::Nothing,
            );
            return Ok(None);
        }
    }
    Ok(Some(Surface {
        nodes: weights.into_iter().collect(),
        faces,
    }))
}

/// Adds the faces of a line, which names an element or set and the face of each element. Without a face it
/// adds all faces on the outside of the model.
fn add_faces(
    model: &Model,
    place: usize,
    row: &Row,
    inner: &mut Option<Vec<FaceKey>>,
    (weights, faces): (&mut BTreeMap<u32, f64>, &mut Vec<Face>),
) -> Result<(), FileProblem> {
    let face = key(row.text(1));
    for index in model.rows_of(place, row.text(0), &row.at)? {
        let Some(element) = model.rows.get(index as usize) else {
            continue;
        };
        let (kind, solid) = match element.shape {
            Shape::Solid(kind, _) => (kind, true),
            Shape::Shell(kind) | Shape::Membrane(kind) | Shape::Facet(kind) => (kind, false),
            _ => {
                return Err(row.at.problem(
                    format!("element {} has no faces", element.label),
                    "put only solids, shells or facets into a surface",
                ));
            }
        };
        let nodes = model.row_nodes(element);
        let all = kind.description().faces;
        let wrong = || {
            row.at.problem(
                format!("element {} has no face \"{}\"", element.label, row.text(1)),
                "use S1, S2, … for a solid; SPOS, SNEG or the edges E1, E2, … for a shell",
            )
        };
        let number = |letter: char| {
            face.strip_prefix(letter)
                .and_then(|number| number.parse::<usize>().ok())
                .and_then(|number| number.checked_sub(1))
        };
        if !solid && let Some(edge) = number('E') {
            let corners = kind.description().edges.get(edge).ok_or_else(wrong)?;
            add_edge(model, &around(kind, nodes, corners), weights);
            continue;
        }
        let chosen = match (face.as_str(), solid) {
            ("", true) => {
                let inner = inner.get_or_insert_with(|| inner_faces(model));
                all.iter()
                    .copied()
                    .filter(|face| inner.binary_search(&face_key(nodes, face)).is_err())
                    .collect()
            }
            ("" | "SPOS" | "SNEG" | "S1" | "S2", false) => all.to_vec(),
            _ => vec![*number('S').and_then(|i| all.get(i)).ok_or_else(wrong)?],
        };
        for face in chosen {
            let ring = around(kind, nodes, face);
            for (node, share) in shares(&ring, |node| model.position(node)) {
                *weights.entry(node).or_insert(0.0) += share;
            }
            faces.extend(Face::new(&ring));
        }
    }
    Ok(())
}

/// Shares the length of an edge among its nodes.
fn add_edge(model: &Model, ring: &[(u32, Option<u32>)], weights: &mut BTreeMap<u32, f64>) {
    let &[(first, middle), (last, _)] = ring else {
        return;
    };
    let line = [Some(first), middle, Some(last)];
    let line = line.into_iter().flatten().collect::<Vec<_>>();
    for pair in line.windows(2) {
        if let [a, b] = *pair {
            let half = 0.5 * norm(subtract(model.position(b), model.position(a)));
            for node in [a, b] {
                *weights.entry(node).or_insert(0.0) += half;
            }
        }
    }
}

/// Faces between two solids, sorted.
fn inner_faces(model: &Model) -> Vec<FaceKey> {
    let mut all = Vec::new();
    for row in &model.rows {
        if let Shape::Solid(kind, _) = row.shape {
            let nodes = model.row_nodes(row);
            all.extend(
                kind.description()
                    .faces
                    .iter()
                    .map(|face| face_key(nodes, face)),
            );
        }
    }
    all.sort_unstable();
    let mut inner = all
        .windows(2)
        .filter_map(|pair| match pair {
            [a, b] if a == b => Some(*a),
            _ => None,
        })
        .collect::<Vec<_>>();
    inner.dedup();
    inner
}

fn face_key(nodes: &[u32], corners: &[usize]) -> FaceKey {
    let mut key = [u32::MAX; 4];
    for (place, corner) in key.iter_mut().zip(corners) {
        *place = nodes.get(*corner).copied().unwrap_or(u32::MAX);
    }
    key.sort_unstable();
    key
}

/// The share of a face's area (length²) for each of its nodes. The nodes of a facet share its area equally. So every share
/// is positive, and the sum is exact for a flat face with straight edges.
pub(crate) fn shares(
    ring: &[(u32, Option<u32>)],
    place: impl Fn(u32) -> [f64; 3],
) -> Vec<(u32, f64)> {
    let mut shares = Vec::new();
    for facet in facets(ring) {
        share(&facet, &place, &mut shares);
    }
    shares
}

/// Shares the area of a polygon equally among its corners.
fn share(polygon: &[u32], place: impl Fn(u32) -> [f64; 3], shares: &mut Vec<(u32, f64)>) {
    let Some((first, rest)) = polygon.split_first() else {
        return;
    };
    let origin = place(*first);
    let mut twice = [0.0; 3];
    for pair in rest.windows(2) {
        if let [a, b] = *pair {
            let normal = cross(subtract(place(a), origin), subtract(place(b), origin));
            for (sum, value) in twice.iter_mut().zip(normal) {
                *sum += value;
            }
        }
    }
    let each = 0.5 * norm(twice) / polygon.len() as f64;
    shares.extend(polygon.iter().map(|node| (*node, each)));
}
