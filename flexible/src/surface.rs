//! The surface of a mesh, for pictures and films.

use crate::element::{around, facets};
use crate::mesh::{ElementKind, Mesh};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Triangles of the outer faces of solids and of shells and facets, and the lines of beams, as indices of
/// nodes. A face with mid-side nodes becomes a triangle at each corner and triangles of the remaining middle.
/// So the drawn face bends with all its nodes.
#[derive(Clone, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Surface {
    triangles: Vec<[u32; 3]>,
    elements: Vec<u32>,
    lines: Vec<[u32; 2]>,
}

impl Surface {
    /// Corners of each triangle, anticlockwise as seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Index of the element that each triangle belongs to.
    pub fn elements(&self) -> &[u32] {
        &self.elements
    }

    /// Ends of beams.
    pub fn lines(&self) -> &[[u32; 2]] {
        &self.lines
    }

    /// The surface of a mesh. Elements with missing nodes are left out.
    pub fn new(mesh: &Mesh) -> Surface {
        let mut surface = Surface::default();
        for element in &mesh.elements {
            if let (ElementKind::Beam2, &[a, b]) = (element.kind, mesh.nodes_of(element)) {
                let known = |node: u32| (node as usize) < mesh.nodes.len();
                if known(a) && known(b) {
                    surface.lines.push([a, b]);
                }
            }
        }
        for (index, place) in outer_faces(mesh) {
            let Some(element) = mesh.elements.get(index as usize) else {
                continue;
            };
            let all = element.kind.description().faces;
            let Some(face) = all.get(place) else { continue };
            let ring = around(element.kind, mesh.nodes_of(element), face);
            // the table lists the corners of a solid's face as seen from inside
            let inside = all.len() > 1;
            for [a, b, c] in cut(&ring) {
                let triangle = if inside { [a, c, b] } else { [a, b, c] };
                if triangle
                    .iter()
                    .all(|node| (*node as usize) < mesh.nodes.len())
                {
                    surface.triangles.push(triangle);
                    surface.elements.push(index);
                }
            }
        }
        surface
    }

    /// The nodes on the surface, ascending.
    pub fn nodes(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = self.triangles.as_flattened().to_vec();
        nodes.extend_from_slice(self.lines.as_flattened());
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}

/// The faces that belong to one element only, as element and place among its faces, ascending. Elements with
/// missing nodes are left out.
pub(crate) fn outer_faces(mesh: &Mesh) -> Vec<(u32, usize)> {
    // for each face, by its corners: number of occurrences, and the first element and face
    let mut seen: BTreeMap<Vec<u32>, (u32, u32, usize)> = BTreeMap::new();
    for (index, element) in (0..).zip(&mesh.elements) {
        let nodes = mesh.nodes_of(element);
        let corners = element.kind.corner_count();
        let known = |node: &u32| (*node as usize) < mesh.nodes.len();
        if nodes.len() < corners || !nodes.iter().take(corners).all(known) {
            continue;
        }
        for (place, face) in element.kind.description().faces.iter().enumerate() {
            let mut key: Vec<u32> = face.iter().filter_map(|c| nodes.get(*c).copied()).collect();
            key.sort_unstable();
            let entry = seen.entry(key).or_insert((0, index, place));
            entry.0 += 1;
        }
    }
    let mut outer: Vec<(u32, usize)> = seen
        .into_values()
        .filter(|(count, ..)| *count == 1)
        .map(|(_, element, face)| (element, face))
        .collect();
    outer.sort_unstable();
    outer
}

/// Triangles of a face: its facets, each cut from its first node.
fn cut(ring: &[(u32, Option<u32>)]) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for facet in facets(ring) {
        if let Some((first, rest)) = facet.split_first() {
            let pairs = rest.windows(2).filter_map(|pair| pair.as_array());
            triangles.extend(pairs.map(|[a, b]: &[u32; 2]| [*first, *a, *b]));
        }
    }
    triangles
}
