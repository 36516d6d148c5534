//! Forces and moments of a shell as functions of its strains.

use super::STRAINS;
use crate::element::MOST_NODES;
use crate::mesh::{Material, ShellSection};

/// Of a section without shear flexibility: the bending stiffness by the shear stiffness and the element's
/// area. The deflection of one element by shear is then 1e-5 of that by bending.
const RIGID: f64 = 1e-5 / 12.0;

/// `C` of `[N; M; Q; k δ] = C [ε; κ; γ; δ]` (N/m, N, N m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::fe) struct Law(pub [[f64; STRAINS]; STRAINS]);

/// Section and material of a shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::fe) struct Plate {
    section: ShellSection,
    material: Elastic,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Elastic {
    young: f64,
    poisson: f64,
    density: f64,
}

impl Plate {
    pub fn new(section: ShellSection, material: &Material) -> Self {
        Plate {
            section,
            material: Elastic {
                young: material.young,
                poisson: material.poisson,
                density: material.density,
            },
        }
    }

    /// Mass per area (kg/m²) and rotary inertia per area (kg) at a place with these shape functions.
    pub fn inertia(&self, _values: &[f64; MOST_NODES]) -> (f64, f64) {
        let thickness = self.section.thickness;
        let own = self.material.density * thickness;
        (
            own + self.section.mass_per_area,
            own * thickness * thickness / 12.0,
        )
    }

    /// The law of an isotropic plate in plane stress, at a place with these shape functions in an element whose
    /// size has this square (m²): membrane `E t/(1 − ν²)`, bending `b E t³/(12 (1 − ν²))` with the section's factor b,
    /// shear `k G t` with its factor k.
    pub fn law(&self, _values: &[f64; MOST_NODES], square: f64) -> Law {
        let Elastic { young, poisson, .. } = self.material;
        let thickness = self.section.thickness;
        let plane = young / (1.0 - poisson * poisson);
        let modulus = 0.5 * young / (1.0 + poisson);
        let bending = self.section.bending * thickness * thickness * thickness / 12.0;
        let mut law = [[0.0; STRAINS]; STRAINS];
        for (first, factor) in [(0, thickness), (3, bending)] {
            law[first][first] = factor * plane;
            law[first + 1][first + 1] = factor * plane;
            law[first][first + 1] = factor * plane * poisson;
            law[first + 1][first] = factor * plane * poisson;
            law[first + 2][first + 2] = factor * modulus;
        }
        let shear = match self.section.shear {
            0.0 => bending * plane / (RIGID * square),
            factor => factor * modulus * thickness,
        };
        law[6][6] = shear;
        law[7][7] = shear;
        let drilling = (thickness * thickness / square).min(1.0);
        law[8][8] = drilling * modulus * thickness;
        Law(law)
    }
}
