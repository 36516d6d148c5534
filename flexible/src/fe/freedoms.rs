//! Numbering of the mesh's freedoms: three translations a node, six where it turns, in basic axes.

use serde::{Deserialize, Serialize};

use super::check::{Role, role};
use crate::error::FlexibleError;
use crate::mesh::{ABSENT, ElementKind, Mesh, PointMass, Tie};

/// Where each node's freedoms stand in a full vector: translations x, y, z (m), then rotations x, y, z (rad), in basic axes.
///
/// Nodes turn (have rotations) at beams, at the independent node of a rigid tie, at the reference of an averaging one, at point
/// masses with rotary inertia or an offset, and where a spring or an equation names a rotation. A node that nothing uses
/// (a point that only gives a direction) has no freedoms.
#[derive(Clone, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "Vec<u32>", into = "Vec<u32>")]
pub struct FreedomMap {
    /// First freedom of each node, and the number of all freedoms.
    first: Vec<u32>,
}

impl FreedomMap {
    /// The freedoms of a checked mesh.
    pub(super) fn new(mesh: &Mesh) -> Result<Self, FlexibleError> {
        let mut count = vec![0u32; mesh.nodes.len()];
        let mut need = |node: u32, freedoms: u32| {
            if let Some(n) = count.get_mut(node as usize) {
                *n = freedoms.max(*n);
            }
        };
        for element in &mesh.elements {
            if role(mesh, element).is_none_or(|role| role == Role::Facet) {
                continue;
            }
            let freedoms = if element.kind == ElementKind::Beam2 {
                6
            } else {
                3
            };
            for &node in mesh.nodes_of(element) {
                if node != ABSENT {
                    need(node, freedoms);
                }
            }
        }
        for point in &mesh.point_masses {
            need(point.node, if is_isotropic(point) { 3 } else { 6 });
        }
        for spring in &mesh.springs {
            for (node, component) in [Some(spring.first), spring.second].into_iter().flatten() {
                need(node, needs(component));
            }
        }
        Self::with_ties(mesh, count)
    }

    /// At least `count` freedoms a node (0, 3 or 6), and what the ties need.
    pub(super) fn with_ties(mesh: &Mesh, mut count: Vec<u32>) -> Result<Self, FlexibleError> {
        let mut need = |node: u32, freedoms: u32| {
            if let Some(n) = count.get_mut(node as usize) {
                *n = freedoms.max(*n);
            }
        };
        for tie in &mesh.ties {
            match tie {
                Tie::Rigid {
                    independent,
                    dependent,
                    ..
                } => {
                    need(*independent, 6);
                    for &(node, _) in dependent {
                        need(node, 3);
                    }
                }
                Tie::Averaging {
                    reference,
                    independent,
                    ..
                } => {
                    need(*reference, 6);
                    for &(node, ..) in independent {
                        need(node, 3);
                    }
                }
                Tie::Equation { terms, .. } => {
                    for &(node, component, _) in terms {
                        need(node, needs(component));
                    }
                }
            }
        }
        let mut first = Vec::with_capacity(count.len() + 1);
        let mut total = 0u32;
        first.push(0);
        for n in count {
            total = total
                .checked_add(n)
                .ok_or_else(|| FlexibleError::Structure {
                    problem: "the mesh has more than 4 billion freedoms".into(),
                    advice: String::new(),
                })?;
            first.push(total);
        }
        Ok(FreedomMap { first })
    }

    /// Number of freedoms.
    pub fn size(&self) -> usize {
        self.first.last().map_or(0, |&total| total as usize)
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// The freedoms of a node: 0, 3 or 6 consecutive ones; empty for an unknown node.
    pub fn of(&self, node: u32) -> std::ops::Range<usize> {
        let node = node as usize;
        match (self.first.get(node), self.first.get(node + 1)) {
            (Some(&first), Some(&end)) => first as usize..end as usize,
            _ => 0..0,
        }
    }

    /// Whether a node turns.
    pub fn has_rotation(&self, node: u32) -> bool {
        self.of(node).len() == 6
    }

    /// The freedom of a component 0…5 of a node, where there is one.
    pub fn freedom(&self, node: u32, component: u8) -> Option<usize> {
        let range = self.of(node);
        (usize::from(component) < range.len()).then(|| range.start + usize::from(component))
    }

    /// Node and component of a freedom.
    pub fn owner(&self, freedom: usize) -> Option<(u32, u8)> {
        if freedom >= self.size() {
            return None;
        }
        // the last node that starts at or before the freedom; empty nodes before it start there too
        let node = self
            .first
            .partition_point(|&first| first as usize <= freedom)
            - 1;
        Some((node as u32, (freedom - self.first[node] as usize) as u8))
    }
}

impl From<FreedomMap> for Vec<u32> {
    fn from(map: FreedomMap) -> Self {
        map.first
    }
}

impl TryFrom<Vec<u32>> for FreedomMap {
    type Error = &'static str;

    /// From the first freedom of each node and the number of all; every node has 0, 3 or 6.
    fn try_from(first: Vec<u32>) -> Result<Self, Self::Error> {
        let sound = first.first() == Some(&0)
            && first
                .windows(2)
                .all(|pair| matches!(pair[1].checked_sub(pair[0]), Some(0 | 3 | 6)));
        match sound {
            true => Ok(FreedomMap { first }),
            false => Err("a numbering of freedoms that is none"),
        }
    }
}

/// Freedoms of a node that has this component.
fn needs(component: u8) -> u32 {
    if component < 3 { 3 } else { 6 }
}

/// Whether a point mass is the same in all directions and at its node: then it needs no rotations.
pub(super) fn is_isotropic(point: &PointMass) -> bool {
    let matrix = &point.matrix;
    (0..6).all(|i| {
        (0..6).all(|j| {
            let expected = if i == j && i < 3 { matrix[0][0] } else { 0.0 };
            matrix[i][j] == expected
        })
    })
}

/// Direction in basic axes of a component 0…5 of a node of a checked mesh: an axis of its analysis frame, along which it moves
/// or about which it turns.
pub(super) fn direction(mesh: &Mesh, node: u32, component: u8) -> [f64; 3] {
    let axis = usize::from(component % 3);
    let frame = mesh
        .nodes
        .get(node as usize)
        .and_then(|node| node.frame)
        .and_then(|index| mesh.frames.get(index as usize));
    match frame {
        Some(frame) => [0, 1, 2].map(|row| frame.rotation[row][axis]),
        None => [0, 1, 2].map(|row| if row == axis { 1.0 } else { 0.0 }),
    }
}
