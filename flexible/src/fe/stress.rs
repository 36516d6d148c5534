//! Strain and stress of solids from the displacements of their nodes, and the stress of shells.
//!
//! Components are in the order xx, yy, zz, xy, yz, zx, in basic axes; shear strains are engineering ones (γ =
//! 2 ε).

use super::check::{self, Role, role};
use super::elastic::{PlacedMaterial, isotropic};
use super::form;
use super::freedoms::FreedomMap;
use super::hexahedron;
use super::rules::{self, Rules, Table};
use super::shell::shell_stresses;
use super::solid::{Present, gradients, gradients_with_inner, inverted, lame};
use super::vector::add;
use crate::element::{MOST_NODES, Shape};
use crate::error::FlexibleError;
use crate::mesh::{Element, ElementKind, Material, Mesh};
use std::collections::BTreeMap;

/// Six components of a strain (–) or a stress (Pa).
pub type Components = [f64; 6];

/// Strain at a point as a function of the displacements of the element's nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainPoint {
    /// Place in the basic frame (m).
    pub place: [f64; 3],
    /// Volume of the integration point (m³); zero for other points.
    pub volume: f64,
    /// ∂N/∂x of each node (1/m).
    pub gradients: Vec<[f64; 3]>,
    /// Correction of the strain by the element's form, for a unit displacement of each node along each axis
    /// (1/m); empty without a correction.
    pub correction: Vec<Components>,
}

impl StrainPoint {
    /// ε = ½ (∇u + ∇uᵀ) for displacements (m) of the nodes.
    pub fn strain(&self, displacements: &[[f64; 3]]) -> Components {
        let mut strain = [0.0; 6];
        for (g, u) in self.gradients.iter().zip(displacements) {
            strain[0] += g[0] * u[0];
            strain[1] += g[1] * u[1];
            strain[2] += g[2] * u[2];
            strain[3] += g[1] * u[0] + g[0] * u[1];
            strain[4] += g[2] * u[1] + g[1] * u[2];
            strain[5] += g[0] * u[2] + g[2] * u[0];
        }
        for (correction, x) in self.correction.iter().zip(displacements.iter().flatten()) {
            for (sum, c) in strain.iter_mut().zip(correction) {
                *sum += c * x;
            }
        }
        strain
    }
}

/// Stress (Pa) of a strain at a place (m), both in basic axes: σ = λ tr ε I + 2 μ ε, or the law of an anisotropic
/// solid in its axes there ([`crate::mesh::SolidElasticity::stress`]).
pub fn stress(material: &Material, place: [f64; 3], strain: &Components) -> Components {
    if let Some(solid) = &material.solid {
        return solid.stress(place, strain);
    }
    let (lambda, mu) = lame(material);
    isotropic(lambda, mu, strain)
}

/// Von Mises' equivalent stress (Pa), √(3/2 s:s) of the deviator s.
pub fn von_mises(stress: &Components) -> f64 {
    let [x, y, z, xy, yz, zx] = *stress;
    let normal = (x - y) * (x - y) + (y - z) * (y - z) + (z - x) * (z - x);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

/// A solid element, ready for recovery.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementRecovery {
    /// Indices of its nodes.
    nodes: Vec<u32>,
    /// The start of its nodes in the mesh's connectivity, by which its inner nodes are found.
    first: u32,
    /// Its material.
    pub material: Material,
    /// Integration points of its stiffness.
    pub points: Vec<StrainPoint>,
    /// A line for each node: values at the integration points, times these, are the node's.
    extrapolation: Vec<Vec<f64>>,
}

impl ElementRecovery {
    /// For an element of a mesh in SI that passes the assembly's checks; `None` for other elements than
    /// solids.
    ///
    /// # Errors
    /// As the assembly: a mesh that is not sound, an inverted element.
    pub fn new(
        mesh: &Mesh,
        element: &Element,
        rules: &Rules,
    ) -> Result<Option<Self>, FlexibleError> {
        check::check_element(mesh, element)?;
        let Some(mut recovery) = Self::at_points(mesh, element, rules)? else {
            return Ok(None);
        };
        let form = form::form(mesh, element, rules.stiffness)?;
        let integration = rules::stiffness_points(element.kind, form);
        let at: Vec<[f64; 3]> = integration.iter().map(|point| point.at).collect();
        recovery.extrapolation = nodal_extrapolation(element.kind, mesh.nodes_of(element), &at);
        Ok(Some(recovery))
    }

    /// As [`ElementRecovery::new`] for a checked element, without the extrapolation to the nodes.
    pub(super) fn at_points(
        mesh: &Mesh,
        element: &Element,
        rules: &Rules,
    ) -> Result<Option<Self>, FlexibleError> {
        let Some(Role::Solid(material)) = role(mesh, element) else {
            return Ok(None);
        };
        let present = Present::new(element.kind, mesh.nodes_of(element));
        let form = form::form(mesh, element, rules.stiffness)?;
        let integration = rules::stiffness_points(element.kind, form);
        let samples: Vec<([f64; 3], f64)> = integration
            .iter()
            .map(|point| (point.at, point.weight))
            .collect();
        let mut points = strain_points(mesh, element, &present, &samples)?;
        let table = || Table::new(element.kind, form, rules.mass);
        let inner = form.inner_count() as usize;
        if inner > 0 {
            let (table, places) = (table(), present.places(mesh));
            let count = (present.count + inner, inner);
            for (point, sample) in points.iter_mut().zip(&table.stiffness) {
                let gradients = gradients_with_inner(&table, &sample.shape, &places, count)
                    .map_err(|jacobian| inverted(&[(element.id, jacobian)]))?;
                point.gradients = gradients.slope[..count.0].to_vec();
            }
        }
        if form.correction().is_some() {
            let table = table();
            let placed = PlacedMaterial {
                material,
                origin: present.origin(mesh),
            };
            let enhanced = hexahedron::enhanced(&table, &present.places(mesh), placed)
                .map_err(|jacobian| inverted(&[(element.id, jacobian)]))?;
            for (point, enhanced) in points.iter_mut().zip(enhanced) {
                point.correction = enhanced.correction.to_vec();
            }
        }
        Ok(Some(ElementRecovery {
            nodes: present.nodes().to_vec(),
            first: element.first,
            material: material.clone(),
            points,
            extrapolation: Vec::new(),
        }))
    }

    /// Its nodes with the inner ones of its form, in the order of the gradients at its points.
    pub(super) fn all_nodes(&self, freedoms: &FreedomMap) -> Vec<u32> {
        let own = self.nodes.iter().copied();
        // as many as at the points: freedoms of other rules may have others
        let count = self.points.first().map_or(0, |point| point.gradients.len());
        own.chain(freedoms.inner_of(self.first))
            .take(count)
            .collect()
    }

    /// The displacements of its nodes out of a full vector, and the amplitudes of its inner ones.
    pub fn displacements(&self, freedoms: &FreedomMap, full: &[f64]) -> Vec<[f64; 3]> {
        self.all_nodes(freedoms)
            .into_iter()
            .map(|node| {
                let first = freedoms.of(node).start;
                [0, 1, 2].map(|axis| full.get(first + axis).copied().unwrap_or(0.0))
            })
            .collect()
    }

    /// Strains at the integration points.
    pub fn strains(&self, displacements: &[[f64; 3]]) -> Vec<Components> {
        self.points
            .iter()
            .map(|point| point.strain(displacements))
            .collect()
    }

    /// Stresses (Pa) at the integration points.
    pub fn stresses(&self, displacements: &[[f64; 3]]) -> Vec<Components> {
        self.points
            .iter()
            .map(|point| stress(&self.material, point.place, &point.strain(displacements)))
            .collect()
    }

    /// Values at the integration points carried to the nodes: by the linear functions of the corners that fit
    /// them best, and as means of the corners at mid-side nodes.
    pub fn at_nodes(&self, values: &[Components]) -> Vec<Components> {
        self.extrapolation
            .iter()
            .map(|line| {
                let mut sum = [0.0; 6];
                for (factor, value) in line.iter().zip(values) {
                    for (x, y) in sum.iter_mut().zip(value) {
                        *x += factor * y;
                    }
                }
                sum
            })
            .collect()
    }
}

fn strain_points(
    mesh: &Mesh,
    element: &Element,
    present: &Present,
    samples: &[([f64; 3], f64)],
) -> Result<Vec<StrainPoint>, FlexibleError> {
    let places = present.places(mesh);
    let origin = present.origin(mesh);
    let count = present.count;
    samples
        .iter()
        .map(|&(at, weight)| {
            let shape = present.shape(&Shape::at(element.kind, at));
            let gradients = gradients(&shape, &places, count)
                .map_err(|jacobian| inverted(&[(element.id, jacobian)]))?;
            let mut place = origin;
            for (value, node) in shape.values.iter().zip(&places).take(count) {
                place = add(place, node.map(|x| value * x));
            }
            Ok(StrainPoint {
                place,
                volume: weight * gradients.jacobian,
                gradients: gradients.slope[..count].to_vec(),
                correction: Vec::new(),
            })
        })
        .collect()
}

/// For each node that is there the factors of the values at points: those of [`extrapolation`] at corners, and
/// the mean of its ends at the middle of a side.
pub(super) fn nodal_extrapolation(
    kind: ElementKind,
    nodes: &[u32],
    points: &[[f64; 3]],
) -> Vec<Vec<f64>> {
    let corner = extrapolation(kind, points);
    let edges = kind.midside_edges();
    let corners = kind.corner_count();
    let own = nodes.iter().enumerate();
    own.filter(|(_, node)| **node != crate::mesh::ABSENT)
        .map(|(local, _)| match local.checked_sub(corners) {
            None => corner[local].clone(),
            Some(edge) => {
                let [a, b] = edges[edge];
                let pairs = corner[a].iter().zip(&corner[b]);
                pairs.map(|(x, y)| 0.5 * (x + y)).collect()
            }
        })
        .collect()
}

/// For each corner the factors of the values at points: the least-squares fit of the corners' linear
/// functions, or the mean where there are fewer points than corners.
fn extrapolation(kind: ElementKind, points: &[[f64; 3]]) -> Vec<Vec<f64>> {
    let corners = kind.corner_count();
    if points.len() < corners {
        return vec![vec![1.0 / points.len().max(1) as f64; points.len()]; corners];
    }
    let linear = kind.linear();
    let values: Vec<[f64; MOST_NODES]> = points
        .iter()
        .map(|point| Shape::at(linear, *point).values)
        .collect();
    // (Nᵀ N) x = Nᵀ, by Gauss–Jordan: at most eight unknowns, positive definite
    let width = corners + points.len();
    let mut work = vec![vec![0.0; width]; corners];
    for (i, row) in work.iter_mut().enumerate() {
        for (point, n) in values.iter().enumerate() {
            for j in 0..corners {
                row[j] += n[i] * n[j];
            }
            row[corners + point] = n[i];
        }
    }
    for pivot in 0..corners {
        let divisor = work[pivot][pivot];
        let line: Vec<f64> = work[pivot].iter().map(|x| x / divisor).collect();
        for (index, row) in work.iter_mut().enumerate() {
            let factor = row[pivot];
            if index != pivot {
                for (x, y) in row.iter_mut().zip(&line) {
                    *x -= factor * y;
                }
            }
        }
        work[pivot] = line;
    }
    work.into_iter()
        .map(|row| row[corners..].to_vec())
        .collect()
}

/// Stresses (Pa) from several full vectors of displacements, one after the other, at the nodes that are
/// `wanted`. Integration points are carried to the nodes. A node has the mean of the elements of one material
/// that meet there; where materials meet, of the first element's material.
///
/// Returns whether each node of the mesh has a stress of solids, and 6 × vectors numbers for each node (node by node,
/// vector by vector; zero where there is none). [`surface_stresses`] has those of shells.
///
/// # Errors
/// As [`ElementRecovery::new`]; a vector of another length.
pub fn nodal_stresses(
    mesh: &Mesh,
    freedoms: &FreedomMap,
    rules: &Rules,
    full: &[f64],
    wanted: &[bool],
) -> Result<(Vec<bool>, Vec<f64>), FlexibleError> {
    let size = freedoms.size();
    let nodes = mesh.nodes.len();
    let vectors = full.len().checked_div(size).unwrap_or(0);
    if vectors * size != full.len() || freedoms.node_count() != nodes || wanted.len() != nodes {
        return Err(FlexibleError::structure(
            "the displacements are those of another mesh".into(),
            "take displacements of the freedoms of this mesh",
        ));
    }
    let mut sums = vec![0.0; 6 * vectors * nodes];
    let mut counts: Vec<Option<(Option<u32>, f64)>> = vec![None; nodes];
    for element in &mesh.elements {
        let mut own = mesh.nodes_of(element).iter();
        if !own.any(|node| wanted.get(*node as usize) == Some(&true)) {
            continue;
        }
        let Some(recovery) = ElementRecovery::new(mesh, element, rules)? else {
            continue;
        };
        let material = mesh
            .properties
            .get(element.property as usize)
            .and_then(|property| property.material);
        let takes: Vec<bool> = recovery
            .nodes
            .iter()
            .map(|&node| {
                let node = node as usize;
                let (first, count) = counts[node].get_or_insert((material, 0.0));
                let takes = wanted[node] && *first == material;
                *count += if takes { 1.0 } else { 0.0 };
                takes
            })
            .collect();
        for (vector, full) in full.chunks_exact(size.max(1)).enumerate() {
            let displacements = recovery.displacements(freedoms, full);
            let values = recovery.at_nodes(&recovery.stresses(&displacements));
            for ((&node, value), _) in recovery
                .nodes
                .iter()
                .zip(values)
                .zip(&takes)
                .filter(|(_, takes)| **takes)
            {
                let at = 6 * (node as usize * vectors + vector);
                for (x, y) in sums[at..at + 6].iter_mut().zip(value) {
                    *x += y;
                }
            }
        }
    }
    let found: Vec<bool> = counts
        .iter()
        .map(|count| count.is_some_and(|(_, count)| count > 0.0))
        .collect();
    for (own, count) in sums.chunks_exact_mut((6 * vectors).max(1)).zip(&counts) {
        if let Some((_, count)) = count
            && *count > 0.0
        {
            own.iter_mut().for_each(|x| *x /= count);
        }
    }
    Ok((found, sums))
}

/// Stresses (Pa) of shells on their surfaces from several full vectors of displacements, one after the other, at
/// the nodes that are `wanted`. A plate has a lower and an upper surface, a laminate both of each layer, and a
/// membrane one. At a fold, and where properties meet, each side has its own.
///
/// Returns for each node of a shell one list for each surface, with 6 × vectors numbers, vector by vector.
///
/// # Errors
/// A mesh that is not sound, a folded shell, vectors of another length.
pub fn surface_stresses(
    mesh: &Mesh,
    freedoms: &FreedomMap,
    rules: &Rules,
    full: &[f64],
    wanted: &[bool],
) -> Result<BTreeMap<u32, Vec<Vec<f64>>>, FlexibleError> {
    let size = freedoms.size();
    let nodes = mesh.nodes.len();
    if !full.len().is_multiple_of(size.max(1))
        || freedoms.node_count() != nodes
        || wanted.len() != nodes
    {
        return Err(FlexibleError::structure(
            "the displacements are those of another mesh".into(),
            "take displacements of the freedoms of this mesh",
        ));
    }
    shell_stresses(mesh, freedoms, rules, full, wanted)
}
