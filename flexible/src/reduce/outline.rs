//! A flexible body before its reduction: its mass, and the positions of its markers.

use super::{Request, matrices, surfaces};
use crate::error::FlexibleError;
use crate::fe::mass::RigidMass;
use crate::markers::place;
use crate::mesh::Mesh;
use crate::reduce::Report;
use crate::rotary::split_offsets;
use eng_system::reduced::{Invariants, ReducedBody, ReducedMarker, ReducedSurface};
use serde::{Deserialize, Serialize};

/// Frequency (Hz) of the motions of markers in [`Outline::loose`]: that of stiff static modes. A choice: far
/// above the modes of an engine's parts, so that loops close with little bending.
const STIFF: f64 = 2e4;
/// Share of the body's inertia that one such motion has. A choice: all motions of some markers together
/// change the inertia of the body by less than a few per cent.
const SHARE: f64 = 1e-3;

/// A rigid outline of a body: the mass and inertia of its mesh, and the positions of its markers in the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outline {
    /// Mass, first moment and inertia about the frame's origin.
    mass: RigidMass,
    /// Name and position (m) of each marker.
    markers: Vec<(String, [f64; 3])>,
    /// Whether the node of each marker has rotations.
    turns: Vec<bool>,
    /// Elastic surfaces, without compliance.
    surfaces: Vec<ReducedSurface>,
}

/// The outline of a mesh in SI. It assembles elements and matrices and computes no modes.
///
/// # Errors
/// Those of [`super::reduce`] before the computation of modes: meshes that are no structure, missing markers,
/// matrices that don't fit the mesh.
pub fn outline(mut mesh: Mesh, request: &Request) -> Result<Outline, FlexibleError> {
    let nodal = super::nodal(&mut mesh, request)?;
    let places = place(&mut mesh, &request.markers)?;
    let surfaces = surfaces::prepare(&mesh, request, &places)?;
    if nodal.is_none() {
        split_offsets(&mut mesh);
    }
    let (full, _) = matrices(&mesh, request, nodal, &mut Report::default())?;
    let position = |node: &u32| mesh.nodes.get(*node as usize).map(|node| node.position);
    let names = request.markers.iter().map(|marker| marker.name.clone());
    Ok(Outline {
        mass: full.mass.rigid(&mesh),
        markers: names.zip(places.iter().filter_map(position)).collect(),
        turns: places
            .iter()
            .map(|node| full.freedoms.freedom(*node, 3).is_some())
            .collect(),
        surfaces: surfaces.iter().map(|surface| surface.stiff(0)).collect(),
    })
}

impl Outline {
    /// Whether the node of each marker has rotations.
    pub fn turns(&self) -> &[bool] {
        &self.turns
    }

    /// The outline as a rigid body, without modes.
    pub fn rigid(&self) -> ReducedBody {
        self.with_modes(0)
    }

    /// The outline as a body whose markers move and turn independently, with high stiffness. So joints do not
    /// hold more than on the flexible body, and loops that need its bending can close.
    pub fn loose(&self) -> ReducedBody {
        self.with_modes(6 * self.markers.len())
    }

    fn with_modes(&self, modes: usize) -> ReducedBody {
        let mut invariants = Invariants::zero(modes);
        invariants.mass = self.mass.mass;
        invariants.first_moment = self.mass.first_moment;
        invariants.inertia = self.mass.inertia;
        let trace: f64 = (0..3).map(|i| self.mass.inertia[i][i]).sum();
        let omega = 2.0 * std::f64::consts::PI * STIFF;
        for mode in 0..modes {
            let moved = if mode % 6 < 3 { self.mass.mass } else { trace };
            let at = mode * modes + mode;
            invariants.modal_mass[at] = SHARE * moved;
            invariants.stiffness[at] = SHARE * moved * omega * omega;
        }
        let unit = |marker: usize, first: usize| -> Vec<f64> {
            let mut rows = vec![0.0; 3 * modes];
            for component in 0..3.min(modes) {
                rows[component * modes + 6 * marker + first + component] = 1.0;
            }
            rows
        };
        let markers = self.markers.iter().enumerate();
        ReducedBody {
            frequencies: vec![STIFF; modes],
            markers: markers
                .map(|(index, (name, position))| ReducedMarker {
                    name: name.clone(),
                    position: *position,
                    translation: unit(index, 0),
                    rotation: unit(index, 3),
                })
                .collect(),
            surfaces: (self.surfaces.iter())
                .map(|surface| ReducedSurface {
                    content: vec![0.0; surface.shapes.count() * modes],
                    ..surface.clone()
                })
                .collect(),
            invariants,
        }
    }
}
