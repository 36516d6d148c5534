//! Numbering of the mesh's freedoms in basic axes: three translations for each node, and three rotations if
//! the node has them.

use serde::{Deserialize, Serialize};

use super::check::{Role, role};
use super::form;
use super::rules::StiffnessRule;
use super::shell;
use crate::error::FlexibleError;
use crate::mesh::{ABSENT, Mesh, PointMass, SCALAR, Tie, scalar_index};

/// Position of each node's freedoms in a full vector: translations x, y, z (m), then rotations x, y, z (rad),
/// in basic axes.
///
/// These nodes have rotations: nodes of beams and shells, the independent node of a rigid tie, the reference node of an
/// averaging tie, nodes of point masses with rotary inertia or an offset, and nodes whose rotation occurs in
/// a spring or an equation. An unused node, such as a point that only gives a direction, has no freedoms.
///
/// Inner nodes follow those of the mesh. They belong to solids whose form has functions inside the element
/// ([`super::form::Form`]) and to shells of eight nodes, with three amplitudes (m) each. They do not move in a rigid motion, and no tie,
/// support or marker names them.
///
/// Scalar points ([`crate::mesh::Mesh::scalar_points`]) follow the inner nodes, with one freedom each. They
/// have no place, so no rigid motion moves them.
#[derive(Clone, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "Stored", into = "Stored")]
pub struct FreedomMap {
    /// First freedom of each node, including inner ones and scalar points, and the number of all freedoms.
    first: Vec<u32>,
    /// For each element with inner nodes: the start of its nodes in the mesh's connectivity (ascending), and
    /// the end of its inner nodes among all inner nodes.
    inner: Vec<(u32, u32)>,
    /// Number of scalar points.
    scalars: u32,
}

impl FreedomMap {
    /// The freedoms of a checked mesh whose solids have these forms.
    pub(super) fn new(mesh: &Mesh, rule: StiffnessRule) -> Result<Self, FlexibleError> {
        let mut count = vec![0u32; mesh.nodes.len()];
        let mut need = |node: u32, freedoms: u32| {
            if let Some(n) = count.get_mut(node as usize) {
                *n = freedoms.max(*n);
            }
        };
        for element in &mesh.elements {
            let freedoms = match role(mesh, element) {
                Some(Role::Shell(sheet)) if sheet.section.is_membrane() => 3,
                Some(Role::Beam(_) | Role::Shell(_)) => 6,
                Some(Role::Solid(_) | Role::Coat(_)) => 3,
                Some(Role::Facet) | None => continue,
            };
            for &node in mesh.nodes_of(element) {
                if node != ABSENT {
                    need(node, freedoms);
                }
            }
        }
        for point in &mesh.point_masses {
            need(point.node, if turns(point) { 6 } else { 3 });
        }
        for spring in mesh.springs.iter().chain(&mesh.inerters) {
            for &(node, component, _) in &spring.terms {
                need(node, needs(component));
            }
        }
        Self::of_nodes(mesh, count)?
            .with_inner(mesh, rule)?
            .with_scalars(mesh)
    }

    /// Adds the inner nodes of solids and shells.
    fn with_inner(mut self, mesh: &Mesh, rule: StiffnessRule) -> Result<Self, FlexibleError> {
        let mut inner = Vec::new();
        for element in &mesh.elements {
            let count = match role(mesh, element) {
                Some(Role::Solid(_)) => form::form(mesh, element, rule)?.inner_count(),
                Some(Role::Shell(sheet)) => {
                    shell::inner_count(element.kind, sheet.section.is_membrane())
                }
                _ => 0,
            };
            if count > 0 {
                inner.push((element.first, count));
            }
        }
        inner.sort_unstable();
        if inner.windows(2).any(|pair| pair[0].0 == pair[1].0) {
            return Err(FlexibleError::structure(
                "two elements share the list of their nodes, and have modes of their own inside"
                    .into(),
                "give each element a list of its own",
            ));
        }
        let mut end = 0;
        for (start, count) in inner {
            for _ in 0..count {
                let next = self.first.last().and_then(|total| total.checked_add(3));
                self.first.push(next.ok_or_else(too_many)?);
            }
            end += count;
            self.inner.push((start, end));
        }
        Ok(self)
    }

    /// The numbering with at least `count` freedoms for each node (0, 3 or 6), the freedoms that ties need, and
    /// scalar points.
    pub(super) fn with_ties(mesh: &Mesh, count: Vec<u32>) -> Result<Self, FlexibleError> {
        Self::of_nodes(mesh, count)?.with_scalars(mesh)
    }

    fn with_scalars(mut self, mesh: &Mesh) -> Result<Self, FlexibleError> {
        for _ in &mesh.scalar_points {
            let next = self.first.last().and_then(|total| total.checked_add(1));
            self.first.push(next.ok_or_else(too_many)?);
            self.scalars += 1;
        }
        Ok(self)
    }

    fn of_nodes(mesh: &Mesh, mut count: Vec<u32>) -> Result<Self, FlexibleError> {
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
            total = total.checked_add(n).ok_or_else(too_many)?;
            first.push(total);
        }
        Ok(FreedomMap {
            first,
            inner: Vec::new(),
            scalars: 0,
        })
    }

    /// Number of freedoms.
    pub fn size(&self) -> usize {
        self.first.last().map_or(0, |&total| total as usize)
    }

    /// Number of nodes of the mesh.
    pub fn node_count(&self) -> usize {
        self.first_scalar().saturating_sub(self.inner_count())
    }

    fn inner_count(&self) -> usize {
        self.inner.last().map_or(0, |(_, end)| *end as usize)
    }

    /// Index of the first scalar point among all nodes.
    fn first_scalar(&self) -> usize {
        self.all_nodes().saturating_sub(self.scalars as usize)
    }

    /// Number of nodes, including inner ones and scalar points.
    pub(crate) fn all_nodes(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// The inner nodes of the element whose nodes start at `start` in the mesh's connectivity.
    pub(super) fn inner_of(&self, start: u32) -> std::ops::Range<u32> {
        let Ok(place) = self.inner.binary_search_by_key(&start, |(start, _)| *start) else {
            return 0..0;
        };
        let before = match place.checked_sub(1).and_then(|place| self.inner.get(place)) {
            Some((_, end)) => *end,
            None => 0,
        };
        let base = self.node_count() as u32;
        let end = self.inner.get(place).map_or(before, |(_, end)| *end);
        base + before..base + end
    }

    /// The freedoms of all inner nodes.
    pub(super) fn inner_freedoms(&self) -> std::ops::Range<usize> {
        let at = |node: usize| self.first.get(node).map_or(0, |first| *first as usize);
        at(self.node_count())..at(self.first_scalar())
    }

    /// The freedoms of all scalar points, one each.
    pub fn scalar_freedoms(&self) -> std::ops::Range<usize> {
        self.size().saturating_sub(self.scalars as usize)..self.size()
    }

    /// The index of a node or scalar point among all nodes, inner ones included.
    pub(crate) fn place(&self, node: u32) -> usize {
        match scalar_index(node) {
            Some(index) => self.first_scalar().saturating_add(index),
            None => node as usize,
        }
    }

    /// The freedoms of a node: 0, 3 or 6 consecutive ones; one of a [scalar point](SCALAR); none of an
    /// unknown node.
    pub fn of(&self, node: u32) -> std::ops::Range<usize> {
        let node = self.place(node);
        match (self.first.get(node), self.first.get(node + 1)) {
            (Some(&first), Some(&end)) => first as usize..end as usize,
            _ => 0..0,
        }
    }

    /// Whether a node has rotations.
    pub fn has_rotation(&self, node: u32) -> bool {
        self.of(node).len() == 6
    }

    /// The freedom of a component 0…5 of a node, if it exists.
    pub fn freedom(&self, node: u32, component: u8) -> Option<usize> {
        let range = self.of(node);
        (usize::from(component) < range.len()).then(|| range.start + usize::from(component))
    }

    /// Node and component of a freedom.
    pub fn owner(&self, freedom: usize) -> Option<(u32, u8)> {
        if freedom >= self.size() {
            return None;
        }
        // the last node that starts at or before the freedom; nodes without freedoms start there too, but
        // come earlier
        let node = self
            .first
            .partition_point(|&first| first as usize <= freedom)
            - 1;
        let component = (freedom - self.first[node] as usize) as u8;
        Some(match node.checked_sub(self.first_scalar()) {
            Some(scalar) => (SCALAR | scalar as u32, component),
            None => (node as u32, component),
        })
    }
}

/// The stored form of a numbering: first freedoms, the elements with inner nodes, the number of scalar points.
type Stored = (Vec<u32>, Vec<(u32, u32)>, u32);

impl From<FreedomMap> for Stored {
    fn from(map: FreedomMap) -> Self {
        (map.first, map.inner, map.scalars)
    }
}

impl TryFrom<Stored> for FreedomMap {
    type Error = &'static str;

    /// Every node has 0, 3 or 6 freedoms, an inner one 3, a scalar point 1; elements and their inner nodes
    /// ascend.
    fn try_from((all, inner, scalars): Stored) -> Result<Self, Self::Error> {
        let counts = |pair: &[u32]| pair[1].checked_sub(pair[0]);
        let (first, ones) = match all.len().checked_sub(scalars as usize) {
            Some(nodes) if nodes > 0 => (&all[..nodes], &all[nodes - 1..]),
            _ => return Err("a numbering of freedoms that is none"),
        };
        let ends = inner.last().map_or(0, |(_, end)| *end as usize);
        let ascending = |pair: &[(u32, u32)]| pair[0].0 < pair[1].0 && pair[0].1 < pair[1].1;
        let sound = first.first() == Some(&0)
            && first
                .windows(2)
                .all(|pair| matches!(counts(pair), Some(0 | 3 | 6)))
            && ones.windows(2).all(|pair| counts(pair) == Some(1))
            && ends < first.len()
            && first
                .windows(2)
                .rev()
                .take(ends)
                .all(|pair| counts(pair) == Some(3))
            && inner.first().is_none_or(|(_, end)| *end > 0)
            && inner.windows(2).all(ascending);
        match sound {
            true => Ok(FreedomMap {
                first: all,
                inner,
                scalars,
            }),
            false => Err("a numbering of freedoms that is none"),
        }
    }
}

fn too_many() -> FlexibleError {
    FlexibleError::structure(
        "the mesh has more than 4 billion freedoms".into(),
        "make a coarser mesh",
    )
}

/// Number of freedoms of a node with this component.
fn needs(component: u8) -> u32 {
    if component < 3 { 3 } else { 6 }
}

/// Whether a point mass is beside its node or has rotary inertia, so that the node's rotations move it.
pub(super) fn turns(point: &PointMass) -> bool {
    let matrix = &point.matrix;
    (0..6).any(|i| (3..6).any(|j| matrix[i][j] != 0.0 || matrix[j][i] != 0.0))
}

/// Whether a point mass is equal in all directions and is at its node.
pub(super) fn is_isotropic(point: &PointMass) -> bool {
    let matrix = &point.matrix;
    (0..6).all(|i| {
        (0..6).all(|j| {
            let expected = if i == j && i < 3 { matrix[0][0] } else { 0.0 };
            matrix[i][j] == expected
        })
    })
}

/// Direction in basic axes of a component 0…5 of a node of a checked mesh: the axis of its analysis frame for
/// this translation or rotation.
pub(crate) fn direction(mesh: &Mesh, node: u32, component: u8) -> [f64; 3] {
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
