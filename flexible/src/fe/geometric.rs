//! Geometric stiffness: what stresses that are there add to the resistance against a displacement.
//!
//! The virtual work of a stress σ on the second-order part of Green's strain, `½ ∂_i u_k ∂_j u_k`, is `δuᵀ K_σ u` with
//!
//! ```text
//! solids  K_σ,ab = ∫ ∇N_aᵀ σ ∇N_b dV · I₃          beams  N ∫ v'v'ᵀ + w'w'ᵀ + (I_y + I_z)/A θ_x'θ_x'ᵀ dx
//! ```
//!
//! (O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, vol. 2; initial-stress matrix). Symmetric, not definite: tension
//! stiffens, pressure softens. Solids use the points of their stiffness, so that a rigid turn θ of a body in equilibrium gives
//! `K_σ (θ × x) = θ × f` with the nodes' loads f, to rounding. Of beams the mean tension of each element counts, not shear forces
//! and moments. Ties are linear: their arms add nothing. Springs and shells have none.

use super::assemble::of_beam;
use super::beam;
use super::check::{self, Role, role, wrong};
use super::freedoms::FreedomMap;
use super::mass::Mass;
use super::rules::Rules;
use super::stress::ElementRecovery;
use crate::error::FlexibleError;
use crate::mesh::{Element, Mesh};
use crate::sparse::{SymmetricMatrix, SymmetricOperator};

/// K_σ over full freedoms (N/m, N, N m). It has the form of a mass matrix: for solids one number a pair of nodes, alike in x, y
/// and z; and a general part of beams.
#[derive(Clone, Debug, PartialEq)]
pub struct GeometricStiffness(Mass);

impl GeometricStiffness {
    /// Of the stresses that full displacements (m, rad; linear) make in a mesh in SI.
    ///
    /// # Errors
    /// Displacements of another mesh, a mesh that is not sound, and one without elements that have stresses.
    pub fn of_displacements(
        mesh: &Mesh,
        freedoms: &FreedomMap,
        rules: &Rules,
        full: &[f64],
    ) -> Result<Self, FlexibleError> {
        check::check(mesh)?;
        if full.len() != freedoms.size() || freedoms.node_count() != mesh.nodes.len() {
            return Err(wrong("the displacements are another mesh's".into(), ""));
        }
        let (mut solids, mut beams) = (Vec::new(), Vec::new());
        let mut stressed = false;
        for element in &mesh.elements {
            match role(mesh, element) {
                Some(Role::Solid(_)) => {
                    stressed = true;
                    if let Some(recovery) = ElementRecovery::new(mesh, element, rules)? {
                        add_solid(&recovery, freedoms, full, &mut solids);
                    }
                }
                Some(Role::Beam(_)) => {
                    stressed = true;
                    add_beam(mesh, element, freedoms, full, &mut beams)?;
                }
                _ => {}
            }
        }
        if !stressed {
            return Err(wrong(
                "geometric stiffness needs the stresses of solids or beams, and the mesh has none"
                    .into(),
                "leave it out: matrices of another code don't say what their stresses are",
            ));
        }
        let solid = SymmetricMatrix::from_triplets(mesh.nodes.len(), &solids)?;
        let general = match beams.is_empty() {
            true => None,
            false => Some(SymmetricMatrix::from_triplets(freedoms.size(), &beams)?),
        };
        Ok(GeometricStiffness(Mass::new(
            freedoms.clone(),
            solid,
            general,
        )?))
    }

    /// The whole matrix over full freedoms.
    ///
    /// # Errors
    /// None that one from [`GeometricStiffness::of_displacements`] gives.
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

fn add_solid(
    recovery: &ElementRecovery,
    freedoms: &FreedomMap,
    full: &[f64],
    entries: &mut Vec<(u32, u32, f64)>,
) {
    let stresses = recovery.stresses(&recovery.displacements(freedoms, full));
    for (b, &second) in recovery.nodes.iter().enumerate() {
        for (a, &first) in recovery.nodes[..=b].iter().enumerate() {
            let mut sum = 0.0;
            for (point, [x, y, z, xy, yz, zx]) in recovery.points.iter().zip(&stresses) {
                let (g, h) = (point.gradients[a], point.gradients[b]);
                sum += point.volume
                    * (g[0] * (x * h[0] + xy * h[1] + zx * h[2])
                        + g[1] * (xy * h[0] + y * h[1] + yz * h[2])
                        + g[2] * (zx * h[0] + yz * h[1] + z * h[2]));
            }
            // two corners at one node: both halves of their pair fall on its diagonal
            let factor = if first == second && a != b { 2.0 } else { 1.0 };
            entries.push((first, second, factor * sum));
        }
    }
}

fn add_beam(
    mesh: &Mesh,
    element: &Element,
    freedoms: &FreedomMap,
    full: &[f64],
    entries: &mut Vec<(u32, u32, f64)>,
) -> Result<(), FlexibleError> {
    let unit = of_beam(mesh, element, beam::tension)?;
    let own: Vec<usize> = mesh
        .nodes_of(element)
        .iter()
        .flat_map(|&node| freedoms.of(node))
        .collect();
    let tension: f64 = own
        .iter()
        .zip(unit.tension)
        .map(|(freedom, t)| t * full[*freedom])
        .sum();
    for (i, &row) in own.iter().enumerate() {
        for (j, &column) in own.iter().enumerate().take(i + 1) {
            let value = tension * unit.stiffness[i][j];
            if value != 0.0 {
                entries.push((row as u32, column as u32, value));
            }
        }
    }
    Ok(())
}
