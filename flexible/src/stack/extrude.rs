//! From triangles in the plane to wedges of 15 nodes.

use super::layers;
use super::plane::Plane;
use crate::mesh::{Element, ElementKind, Mesh, Node, Property, Section, Variant};
use eng_system::stack::Stack;

/// A node that is not made yet.
const NONE: u32 = u32::MAX;

/// Extrudes the triangles of each section. A node is at each point of the plane in the faces between layers,
/// and at each corner in the middle of a layer.
pub(super) fn extrude(stack: &Stack, plane: &Plane, outline_of: &[usize]) -> Mesh {
    let mut mesh = Mesh::default();
    let axis = usize::from(stack.axis.min(2));
    let mut below = vec![NONE; plane.points.len()];
    let mut begin = stack.begin;
    for (index, (section, outline)) in stack.sections.iter().zip(outline_of).enumerate() {
        mesh.properties.push(Property {
            name: (index + 1).to_string(),
            material: None,
            section: Section::Solid,
        });
        let triangles = plane.inside.get(*outline).map(Vec::as_slice).unwrap_or(&[]);
        let count = layers(section.length, stack.size) as usize;
        let level = |step: f64| begin + section.length * step / count as f64;
        for layer in 0..count {
            let low = layer as f64;
            let mut between = vec![NONE; plane.points.len()];
            let mut above = vec![NONE; plane.points.len()];
            for triangle in triangles {
                let Some(nodes) = plane.triangles.get(*triangle as usize) else {
                    continue;
                };
                let first = mesh.connectivity.len() as u32;
                let (corners, middles) = nodes.split_at(3);
                let mut add = |points: &[u32], face: &mut [u32], step: f64| {
                    for point in points {
                        let node = node(&mut mesh, plane, face, *point, (axis, level(step)));
                        mesh.connectivity.push(node);
                    }
                };
                add(corners, &mut below, low);
                add(corners, &mut above, low + 1.0);
                add(middles, &mut below, low);
                add(middles, &mut above, low + 1.0);
                add(corners, &mut between, low + 0.5);
                mesh.elements.push(Element {
                    id: mesh.elements.len() as u64 + 1,
                    kind: ElementKind::Wedge15,
                    variant: Variant::Plain,
                    property: index as u32,
                    first,
                    beam: None,
                    shell: None,
                });
            }
            below = above;
        }
        begin += section.length;
    }
    mesh
}

/// The node of a point in a face, which is made if there is none.
fn node(
    mesh: &mut Mesh,
    plane: &Plane,
    face: &mut [u32],
    point: u32,
    (axis, along): (usize, f64),
) -> u32 {
    let Some(known) = face.get_mut(point as usize) else {
        return NONE;
    };
    if *known == NONE {
        let [first, second] = plane
            .points
            .get(point as usize)
            .copied()
            .unwrap_or_default();
        let mut position = [0.0; 3];
        position[axis] = along;
        position[(axis + 1) % 3] = first;
        position[(axis + 2) % 3] = second;
        *known = mesh.nodes.len() as u32;
        mesh.nodes.push(Node {
            id: mesh.nodes.len() as u64 + 1,
            position,
            frame: None,
        });
    }
    *known
}
