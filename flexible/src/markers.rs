//! Markers on a mesh: one node, or several nodes tied to a centre.

use crate::error::{self, FlexibleError, Part, mm};
use crate::fe::vector::dot;
use crate::mesh::{Mesh, Node, Tie};
pub use eng_system::flexible::{MarkerPlace, Selection, Spider};
use std::collections::BTreeMap;

/// A marker to be made on a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerRequest {
    /// Its name in the model: `main[2]`.
    pub name: String,
    /// Its place.
    pub place: MarkerPlace,
    /// Rotation matrix marker → mesh, row-major. The columns are the directions of its freedoms.
    pub axes: [f64; 9],
}

/// Axes parallel to the mesh's.
pub const MESH_AXES: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// Indices of the nodes of a selection, ascending.
///
/// # Errors
/// A set or property that the mesh does not have (the error lists the existing ones); a ring without an axis,
/// a plane without a normal; fewer than three nodes.
pub fn select(mesh: &Mesh, name: &str, selection: &Selection) -> Result<Vec<u32>, FlexibleError> {
    match selection {
        Selection::Set(set) => match mesh.sets.get(set) {
            Some(found) if !found.nodes().is_empty() => Ok(found.nodes().to_vec()),
            _ => {
                let known: Vec<&str> = mesh.sets.keys().map(String::as_str).take(20).collect();
                Err(FlexibleError::structure(
                    format!("{name}: the mesh has no set {set} with nodes"),
                    &format!("its sets are {}", known.join(", ")),
                ))
            }
        },
        Selection::Ring {
            center,
            axis,
            radius,
            width,
            tolerance,
        } => {
            let on_ring = |height: f64, distance: f64| {
                (distance - radius).abs() <= *tolerance && height.abs() <= 0.5 * width + tolerance
            };
            let Some(nodes) = around(mesh, center, axis, on_ring) else {
                let problem = format!("{name}: the ring has no axis");
                return Err(FlexibleError::structure(problem, "give a direction"));
            };
            at_least_three(
                nodes,
                |count| {
                    format!(
                        "{name}: {count} nodes lie on the ring of radius {} mm and width {} mm around {}",
                        mm(*radius),
                        mm(*width),
                        error::place(center)
                    )
                },
                "check place, axis and the units of the mesh, or widen the tolerance",
            )
        }
        Selection::Patch {
            center,
            normal,
            radius,
            tolerance,
        } => {
            let in_plane = |height: f64, distance: f64| {
                height.abs() <= *tolerance && distance <= radius + tolerance
            };
            let Some(nodes) = around(mesh, center, normal, in_plane) else {
                let problem = format!("{name}: the plane has no normal");
                return Err(FlexibleError::structure(problem, "give a direction"));
            };
            at_least_three(
                nodes,
                |count| {
                    let at = error::place(center);
                    format!("{name}: {count} nodes lie in the plane at {at}")
                },
                "check place, normal and the units of the mesh, or widen the tolerance",
            )
        }
        Selection::Property(property) => {
            // elements of one section with axes of their own have several properties of one name
            let is_wanted = |index: u32| {
                let own = mesh.properties.get(index as usize);
                own.is_some_and(|own| own.name == *property)
            };
            if !mesh.properties.iter().any(|p| p.name == *property) {
                let known = mesh.properties.iter().map(|p| p.name.as_str());
                let known: Vec<&str> = known.take(20).collect();
                return Err(FlexibleError::structure(
                    format!("{name}: the mesh has no property {property}"),
                    &format!("its properties are {}", known.join(", ")),
                ));
            }
            let members: Vec<u32> = (0..)
                .zip(&mesh.elements)
                .filter(|(_, element)| is_wanted(element.property))
                .map(|(index, _)| index)
                .collect();
            at_least_three(
                mesh.nodes_of_all(&members),
                |_| format!("{name}: no elements have the property {property}"),
                "check its number",
            )
        }
    }
}

/// For each node its height along an axis through a point and its distance from the axis (m); `None` if the
/// axis has no direction.
fn around(
    mesh: &Mesh,
    point: &[f64; 3],
    axis: &[f64; 3],
    fits: impl Fn(f64, f64) -> bool,
) -> Option<Vec<u32>> {
    let length = libm::sqrt(dot(*axis, *axis));
    if length.is_nan() || length <= 0.0 {
        return None;
    }
    let along = axis.map(|x| x / length);
    let nodes = (0..).zip(&mesh.nodes).filter(|(_, node)| {
        let p = node.position;
        let from = [p[0] - point[0], p[1] - point[1], p[2] - point[2]];
        let height = dot(from, along);
        let square = dot(from, from) - height * height;
        fits(height, libm::sqrt(square.max(0.0)))
    });
    Some(nodes.map(|(index, _)| index).collect())
}

/// Requires at least three nodes. Fewer do not determine a mean rotation.
fn at_least_three(
    nodes: Vec<u32>,
    problem: impl Fn(usize) -> String,
    advice: &str,
) -> Result<Vec<u32>, FlexibleError> {
    match nodes.len() {
        0..3 => Err(FlexibleError::structure(problem(nodes.len()), advice)),
        _ => Ok(nodes),
    }
}

/// Index of the node with a number, which a marker names.
///
/// # Errors
/// The mesh has no such node.
pub fn numbered(index: &BTreeMap<u64, u32>, name: &str, id: u64) -> Result<u32, FlexibleError> {
    index.get(&id).copied().ok_or_else(|| {
        FlexibleError::structure(
            format!("{name}: the mesh has no node {id}"),
            "check the number; or gather nodes by a ring or a set",
        )
    })
}

/// Adds the centres and ties of markers to a mesh (in SI), and returns the node of each marker.
///
/// # Errors
/// Missing nodes and sets; fewer than three nodes in an average.
pub fn place(mesh: &mut Mesh, markers: &[MarkerRequest]) -> Result<Vec<u32>, FlexibleError> {
    let index = mesh.node_index();
    let mut next = mesh.nodes.iter().map(|node| node.id).max().unwrap_or(0);
    let mut found = Vec::with_capacity(markers.len());
    for (position, marker) in markers.iter().enumerate() {
        let name = &marker.name;
        let of_marker = |error: FlexibleError| error.of(Part::Marker(position));
        match &marker.place {
            MarkerPlace::Node(id) => {
                found.push(numbered(&index, name, *id).map_err(of_marker)?);
            }
            MarkerPlace::Gathered { nodes, tie, center } => {
                let gathered = select(mesh, name, nodes).map_err(of_marker)?;
                let middle = match (center, nodes) {
                    (Some(center), _) => *center,
                    (None, Selection::Ring { center, .. }) => *center,
                    (None, _) => {
                        let mut mean = [0.0; 3];
                        for node in &gathered {
                            for (m, x) in mean.iter_mut().zip(mesh.nodes[*node as usize].position) {
                                *m += x / gathered.len() as f64;
                            }
                        }
                        mean
                    }
                };
                next += 1;
                let node = mesh.nodes.len() as u32;
                mesh.nodes.push(Node {
                    id: next,
                    position: middle,
                    frame: None,
                });
                mesh.ties.push(match tie {
                    Spider::Averaging => Tie::Averaging {
                        id: next,
                        reference: node,
                        reference_components: 0b11_1111,
                        independent: gathered.into_iter().map(|n| (n, 1.0, 0b111)).collect(),
                    },
                    Spider::Rigid => Tie::Rigid {
                        id: next,
                        independent: node,
                        dependent: gathered.into_iter().map(|n| (n, 0b111)).collect(),
                    },
                });
                found.push(node);
            }
        }
    }
    Ok(found)
}
