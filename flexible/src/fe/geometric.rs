//! Geometric stiffness: the part of the resistance against a displacement that comes from existing stresses.
//!
//! The virtual work of a stress σ on the second-order part of Green's strain, `½ ∂_i u_k ∂_j u_k`, is `δuᵀ
//! K_σ u` with
//!
//! ```text
//! solids  K_σ,ab = ∫ ∇N_aᵀ σ ∇N_b dV · I₃          beams  N ∫ v'v'ᵀ + w'w'ᵀ + (I_y + I_z)/A θ_x'θ_x'ᵀ dx
//! ```
//!
//! (O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, vol. 2; initial-stress matrix). The matrix is
//! symmetric and not definite: tension stiffens, and pressure softens. Solids use the points of their
//! stiffness, so that a rigid turn θ of a body in equilibrium gives `K_σ (θ × x) = θ × f` with the nodes'
//! loads f, to rounding. For beams only the mean tension of each element counts, and not shear forces and
//! moments. Ties are linear: their arms add nothing. Springs and shells have no geometric stiffness here.

use super::assemble::{of_beam, present};
use super::beam;
use super::check::{self, Role, role};
use super::freedoms::FreedomMap;
use super::mass::Mass;
use super::pattern::Pattern;
use super::rules::Rules;
use super::stress::ElementRecovery;
use super::vector::dot;
use crate::error::FlexibleError;
use crate::mesh::{Element, Mesh};
use crate::sparse::{SymmetricMatrix, SymmetricOperator};

/// K_σ over full freedoms (N/m, N, N m). It has the form of a mass matrix: for solids one number a pair of
/// nodes, the same in x, y and z; and a general part of beams.
#[derive(Clone, Debug, PartialEq)]
pub struct GeometricStiffness(Mass);

impl GeometricStiffness {
    /// The geometric stiffness of the stresses that full displacements (m, rad; linear) cause in a mesh
    /// in SI. Several vectors of displacements, one after the other, give one matrix each.
    ///
    /// # Errors
    /// Displacements of another mesh, a mesh that is not sound, and one without elements that have stresses.
    pub fn of_displacements(
        mesh: &Mesh,
        freedoms: &FreedomMap,
        rules: &Rules,
        full: &[f64],
    ) -> Result<Vec<Self>, FlexibleError> {
        check::check(mesh)?;
        let size = freedoms.size();
        let cases = full.len().checked_div(size).unwrap_or(0);
        if cases * size != full.len() || freedoms.node_count() != mesh.nodes.len() {
            return Err(another_mesh());
        }
        let pattern = pattern(mesh, freedoms);
        let entries = pattern.diagonal(freedoms.all_nodes() as u32);
        let mut solids = vec![vec![0.0; entries]; cases];
        let mut beams = vec![Vec::new(); cases];
        let mut stressed = false;
        for element in &mesh.elements {
            match role(mesh, element) {
                Some(Role::Solid(_)) => {
                    stressed = true;
                    if let Some(recovery) = ElementRecovery::at_points(mesh, element, rules)? {
                        let columns = full.chunks_exact(size.max(1));
                        add_solid(&recovery, freedoms, columns, &pattern, &mut solids);
                    }
                }
                Some(Role::Beam(_)) => {
                    stressed = true;
                    let columns = full.chunks_exact(size.max(1));
                    add_beam(mesh, element, freedoms, columns, &mut beams)?;
                }
                Some(Role::Shell(..)) => {
                    return Err(FlexibleError::structure(
                        format!(
                            "element {} is a shell, and Eng has no geometric stiffness of shells",
                            element.id
                        ),
                        "leave geometric stiffness out for this body, or mesh it with solids",
                    ));
                }
                Some(Role::Coat(_) | Role::Facet) | None => {}
            }
        }
        if !stressed {
            return Err(FlexibleError::structure(
                "geometric stiffness needs the stresses of solids or beams, and the mesh has none"
                    .into(),
                "leave it out; matrices of another code do not state their stresses",
            ));
        }
        solids
            .into_iter()
            .zip(beams)
            .map(|(solid, beams)| {
                let solid = pattern.node_layout().with(solid)?;
                let general = match beams.is_empty() {
                    true => None,
                    false => Some(SymmetricMatrix::from_triplets(size, &beams)?),
                };
                let form = Mass::new(freedoms.clone(), solid, general)?;
                Ok(GeometricStiffness(form))
            })
            .collect()
    }

    /// The whole matrix over full freedoms.
    ///
    /// # Errors
    /// None for a stiffness from [`GeometricStiffness::of_displacements`].
    pub fn assembled(&self) -> Result<SymmetricMatrix, FlexibleError> {
        self.0.assembled()
    }
}

impl SymmetricOperator for GeometricStiffness {
    fn size(&self) -> usize {
        self.0.size()
    }

    fn apply(&self, columns: usize, x: &[f64], y: &mut [f64]) {
        self.0.apply(columns, x, y);
    }
}

fn another_mesh() -> FlexibleError {
    FlexibleError::structure("the displacements are another mesh's".into(), "")
}

/// The pairs of nodes that share a solid.
fn pattern(mesh: &Mesh, freedoms: &FreedomMap) -> Pattern {
    let (mut start, mut nodes) = (vec![0], Vec::new());
    for element in &mesh.elements {
        if let Some(Role::Solid(_)) = role(mesh, element) {
            nodes.extend_from_slice(present(mesh, freedoms, element).nodes());
            start.push(nodes.len());
        }
    }
    Pattern::new(freedoms, &start, &nodes)
}

fn add_solid<'a>(
    recovery: &ElementRecovery,
    freedoms: &FreedomMap,
    columns: impl Iterator<Item = &'a [f64]>,
    pattern: &Pattern,
    solids: &mut [Vec<f64>],
) {
    let nodes = recovery.all_nodes(freedoms);
    // index of each pair of nodes; if two corners are at one node, both halves of their pair are on its
    // diagonal
    let mut places = Vec::with_capacity(nodes.len() * (nodes.len() + 1) / 2);
    for (b, &second) in nodes.iter().enumerate() {
        for (a, &first) in nodes[..=b].iter().enumerate() {
            places.push(if first == second {
                let factor = if a == b { 1.0 } else { 2.0 };
                Some((pattern.diagonal(first), factor))
            } else {
                let pair = pattern.pair(first.min(second), first.max(second));
                pair.map(|pair| (pair.entry, 1.0))
            });
        }
    }
    for (full, values) in columns.zip(solids) {
        let stresses = recovery.stresses(&recovery.displacements(freedoms, full));
        let mut places = places.iter();
        for b in 0..nodes.len() {
            // σ ∇N_b dV at each point
            let pulled: Vec<[f64; 3]> = recovery
                .points
                .iter()
                .zip(&stresses)
                .map(|(point, [x, y, z, xy, yz, zx])| {
                    let h = point.gradients[b].map(|g| g * point.volume);
                    [
                        x * h[0] + xy * h[1] + zx * h[2],
                        xy * h[0] + y * h[1] + yz * h[2],
                        zx * h[0] + yz * h[1] + z * h[2],
                    ]
                })
                .collect();
            for a in 0..=b {
                let points = recovery.points.iter().zip(&pulled);
                let sum: f64 = points.map(|(point, h)| dot(point.gradients[a], *h)).sum();
                if let Some(Some((entry, factor))) = places.next() {
                    values[*entry] += factor * sum;
                }
            }
        }
    }
}

fn add_beam<'a>(
    mesh: &Mesh,
    element: &Element,
    freedoms: &FreedomMap,
    columns: impl Iterator<Item = &'a [f64]>,
    beams: &mut [Vec<(u32, u32, f64)>],
) -> Result<(), FlexibleError> {
    let unit = of_beam(mesh, element, beam::tension)?;
    let own: Vec<usize> = mesh
        .nodes_of(element)
        .iter()
        .flat_map(|&node| freedoms.of(node))
        .collect();
    for (full, entries) in columns.zip(beams) {
        let terms = own.iter().zip(unit.tension);
        let tension: f64 = terms.map(|(freedom, t)| t * full[*freedom]).sum();
        for (i, &row) in own.iter().enumerate() {
            for (j, &column) in own.iter().enumerate().take(i + 1) {
                entries.push((row as u32, column as u32, tension * unit.stiffness[i][j]));
            }
        }
    }
    Ok(())
}
