//! Layers of a shell by the classical theory of laminates (R. M. Jones, Mechanics of Composite Materials, 2nd
//! ed., §4.2), with shear across them.
//!
//! Heights are shares ζ of the whole thickness t, from −½ to ½. With the stiffness Q of each layer, turned into
//! the section's axes, `N = t ∫ Q dζ ε + t² ∫ Q ζ dζ κ` and `M = t² ∫ Q ζ dζ ε + t³ ∫ Q ζ² dζ κ`.
//!
//! **Shear across.** For each axis of the section the shear stress in cylindrical bending follows from
//! equilibrium, `τ = V s(ζ)/(t EI)` with `s(ζ) = −∫ E (ζ − ζ₀) dζ` from the lower surface, the neutral height ζ₀
//! and `EI = ∫ E (ζ − ζ₀)² dζ`. The stiffness S t has the energy of this stress: `1/S = ∫ s²/G dζ/EI²` (the rule
//! of Nastran's PCOMP; of one isotropic layer S = 5/6 G). Layers without shear flexibility add nothing.
//! The two axes do not couple.

use super::law::{Across, Plane, Turn, elasticity};
use crate::fe::sheet::Sheet;

/// A layer in the section's axes.
pub(super) struct Ply {
    /// Heights of its lower and upper surface.
    pub height: [f64; 2],
    pub plane: Plane,
    across: Option<Across>,
    /// Density (kg/m³).
    pub density: f64,
}

impl Ply {
    /// `∫ ζᵖ dζ`.
    pub fn moment(&self, power: i32) -> f64 {
        let [low, high] = self.height;
        match power {
            0 => high - low,
            1 => 0.5 * (high * high - low * low),
            _ => (high * high * high - low * low * low) / 3.0,
        }
    }
}

/// The layers of a section, from the lower surface to the upper.
pub(super) fn layers(sheet: &Sheet<'_>) -> Vec<Ply> {
    let total: f64 = sheet.layers.iter().map(|layer| layer.thickness).sum();
    let mut found = Vec::with_capacity(sheet.layers.len());
    let mut low = 0.0;
    for layer in sheet.layers {
        let Some(material) = sheet.materials.get(layer.material as usize) else {
            continue;
        };
        let (plane, across) = elasticity(material);
        let turn = Turn(libm::cos(layer.angle), libm::sin(layer.angle));
        let isotropic = material.sheet.is_none();
        let high = low + layer.thickness;
        found.push(Ply {
            height: [low / total - 0.5, high / total - 0.5],
            plane: match isotropic {
                true => plane,
                false => turn.plane(&plane),
            },
            across: match isotropic {
                true => across,
                false => across.map(|own| turn.across(&own)),
            },
            density: material.density,
        });
        low = high;
    }
    found
}

/// `∫ Q ζᵖ dζ` (Pa).
pub(super) fn moment(layers: &[Ply], power: i32) -> Plane {
    let mut sum = [[0.0; 3]; 3];
    for layer in layers {
        let factor = layer.moment(power);
        for (row, own) in sum.iter_mut().zip(&layer.plane) {
            for (entry, x) in row.iter_mut().zip(own) {
                *entry += factor * x;
            }
        }
    }
    // of layers that lie symmetrically the first moment is rounding alone
    let most = layers.iter().flat_map(|layer| layer.plane.as_flattened());
    let most = most.fold(0.0, |most: f64, x| most.max(x.abs()));
    // some rounding units of a sum over layers
    if sum.as_flattened().iter().all(|x| x.abs() < 1e-14 * most) {
        return [[0.0; 3]; 3];
    }
    sum
}

/// S (Pa) of the shear across; `None` without shear flexibility.
pub(super) fn across(layers: &[Ply]) -> Option<Across> {
    if layers.iter().all(|layer| layer.across.is_none()) {
        return None;
    }
    let stiffness = [0, 1].map(|axis: usize| {
        let young = |layer: &Ply| layer.plane[axis][axis];
        let sum = |power: i32| {
            let own = layers
                .iter()
                .map(|layer| young(layer) * layer.moment(power));
            own.sum::<f64>()
        };
        let (whole, first) = (sum(0), sum(1));
        let neutral = first / whole;
        let inertia = sum(2) - first * neutral;
        let (mut flow, mut energy) = (0.0, 0.0);
        for layer in layers {
            let [low, high] = layer.height;
            // −∫ E (ζ − ζ₀) dζ from the layer's lower surface, of second degree
            let own = |height: f64| {
                let (a, b) = (low - neutral, height - neutral);
                0.5 * young(layer) * (a * a - b * b)
            };
            if let Some(across) = &layer.across {
                let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
                let out = libm::sqrt(0.6) * half;
                for (height, weight) in [(middle - out, 5.0), (middle, 8.0), (middle + out, 5.0)] {
                    let shear = flow + own(height);
                    energy += weight / 9.0 * half * shear * shear / across[axis][axis];
                }
            }
            flow += own(high);
        }
        inertia * inertia / energy
    });
    Some([[stiffness[0], 0.0], [0.0, stiffness[1]]])
}
