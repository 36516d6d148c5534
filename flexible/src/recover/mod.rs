//! From amplitudes back to nodes: motion of nodes, stresses, and the surface for pictures. The shapes beside those of another
//! code.
//!
//! ```text
//! u = Φ a      σ = Σ a_k σ_k
//! ```
//!
//! σ_k is the stress of shape k, computed once. Under loads that have a static mode the stress equals that of
//! the whole finite-element model. The stress of inertia is approximate: its accuracy depends on the modes.

pub mod comparison;
pub mod motion;
pub mod stress;

pub use comparison::{ModeComparison, NearestMode};
pub use motion::{Amplitudes, Both, FrameMotion, NodeMotion, NodeShapes};
pub use stress::{Envelope, ModalStress, principal};

use crate::error::FlexibleError;
use crate::fe::{FreedomMap, Rules};
use crate::mesh::Mesh;
use crate::store::StoredBody;
pub use crate::surface::Surface;
use eng_system::reduced::ReducedBody;

/// A reduced body with its mesh and shapes.
#[derive(Clone, Copy, Debug)]
pub struct Recovery<'a> {
    mesh: &'a Mesh,
    freedoms: &'a FreedomMap,
    shapes: &'a [f64],
    rules: Rules,
    body: &'a ReducedBody,
}

fn wrong(problem: String) -> FlexibleError {
    FlexibleError::Matrix {
        problem,
        advice: String::new(),
    }
}

impl<'a> Recovery<'a> {
    /// Recovery of a stored body.
    ///
    /// # Errors
    /// When shapes, modes and mesh don't fit together.
    pub fn of_stored(stored: &'a StoredBody) -> Result<Self, FlexibleError> {
        Recovery {
            mesh: &stored.mesh,
            freedoms: &stored.freedoms,
            shapes: &stored.shapes,
            rules: stored.rules,
            body: &stored.body,
        }
        .checked()
    }

    fn checked(self) -> Result<Self, FlexibleError> {
        let modes = self.body.invariants.modes;
        let fits = self.freedoms.node_count() == self.mesh.nodes.len()
            && Some(self.shapes.len()) == modes.checked_mul(self.freedoms.size())
            && self.body.invariants.stiffness.len() == modes * modes;
        if fits {
            Ok(self)
        } else {
            Err(wrong("shapes, modes and mesh don't fit together".into()))
        }
    }

    /// Number of modes.
    pub fn modes(&self) -> usize {
        self.body.invariants.modes
    }

    /// The mesh (SI).
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    fn check_amplitudes(&self, a: &[f64]) -> Result<(), FlexibleError> {
        check_length(self.modes(), a)
    }

    /// Displacements and rotations of all nodes, Φ a, over the full freedoms (m, rad; body axes).
    ///
    /// # Errors
    /// Another number of amplitudes than modes.
    pub fn displacements(&self, a: &[f64]) -> Result<Vec<f64>, FlexibleError> {
        self.check_amplitudes(a)?;
        let size = self.freedoms.size();
        let mut full = vec![0.0; size];
        for (shape, a) in self.shapes.chunks_exact(size.max(1)).zip(a) {
            for (u, shape) in full.iter_mut().zip(shape) {
                *u += a * shape;
            }
        }
        Ok(full)
    }
}

fn check_length(modes: usize, a: &[f64]) -> Result<(), FlexibleError> {
    if a.len() == modes {
        Ok(())
    } else {
        Err(wrong(format!("{} amplitudes for {modes} modes", a.len())))
    }
}
