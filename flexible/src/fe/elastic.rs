//! The law of stress at a point of a solid.

use super::solid::lame;
use super::stress::Components;
use super::vector::add;
use crate::element::{MOST_NODES, Shape};
use crate::mesh::Material;

/// The law of stress at a point, in basic axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum PointLaw {
    /// σ = λ tr ε I + 2 μ ε, with Lamé's constants (Pa).
    Isotropic { lambda: f64, mu: f64 },
    /// σ = D ε (Pa) with engineering shear, in the axes at this point turned into basic ones.
    Anisotropic(Box<[Components; 6]>),
}

impl PointLaw {
    /// That of a material at a place (m). Column j of D is the stress of a unit strain j.
    pub fn new(material: &Material, place: [f64; 3]) -> Self {
        let Some(solid) = &material.solid else {
            let (lambda, mu) = lame(material);
            return PointLaw::Isotropic { lambda, mu };
        };
        let mut rows = Box::new([[0.0; 6]; 6]);
        for j in 0..6 {
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            for (row, x) in rows.iter_mut().zip(solid.stress(place, &unit)) {
                row[j] = x;
            }
        }
        PointLaw::Anisotropic(rows)
    }

    /// Stress (Pa) of a strain.
    pub fn stress(&self, strain: &Components) -> Components {
        match self {
            PointLaw::Isotropic { lambda, mu } => isotropic(*lambda, *mu, strain),
            PointLaw::Anisotropic(rows) => rows.map(|row| dot(&row, strain)),
        }
    }
}

/// σ = λ tr ε I + 2 μ ε (Pa).
pub(super) fn isotropic(lambda: f64, mu: f64, strain: &Components) -> Components {
    let volumetric = lambda * (strain[0] + strain[1] + strain[2]);
    [
        volumetric + 2.0 * mu * strain[0],
        volumetric + 2.0 * mu * strain[1],
        volumetric + 2.0 * mu * strain[2],
        mu * strain[3],
        mu * strain[4],
        mu * strain[5],
    ]
}

/// The sum over components: with engineering shear σ : ε.
pub(super) fn dot(a: &Components, b: &Components) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The strain ½ (∇u + ∇uᵀ) of a displacement along `axis` with this gradient (1/m); shear strains are
/// engineering ones.
pub(super) fn strain_of(gradient: [f64; 3], axis: usize) -> Components {
    let [x, y, z] = gradient;
    match axis {
        0 => [x, 0.0, 0.0, y, 0.0, z],
        1 => [0.0, y, 0.0, x, z, 0.0],
        _ => [0.0, 0.0, z, 0.0, y, x],
    }
}

/// The material of an element, and the place of its first node (m), from which its places count.
#[derive(Clone, Copy)]
pub(super) struct PlacedMaterial<'a> {
    pub material: &'a Material,
    pub origin: [f64; 3],
}

impl PlacedMaterial<'_> {
    /// The law at a point with these functions of the element's `count` nodes.
    pub fn law(&self, shape: &Shape, places: &[[f64; 3]; MOST_NODES], count: usize) -> PointLaw {
        let mut place = self.origin;
        for (value, node) in shape.values.iter().zip(places).take(count) {
            place = add(place, node.map(|x| value * x));
        }
        PointLaw::new(self.material, place)
    }
}
