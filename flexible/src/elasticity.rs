//! The elasticity of sheets and of anisotropic solids, each in axes of its own.

use serde::{Deserialize, Serialize};

use crate::axes::{LocalAxes, from_axes, is_rotation, product};

/// Elasticity of a sheet in its own axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SheetElasticity {
    /// Stiffness in plane stress: 11, 22, 12 of stress for those of strain, with engineering shear.
    pub plane: [[f64; 3]; 3],
    /// Stiffness of the shear across the sheet along both axes; `None`: without shear flexibility.
    pub across: Option<[[f64; 2]; 2]>,
}

impl SheetElasticity {
    /// An orthotropic sheet of E₁, E₂, ν₁₂, G₁₂, and of G₁₃, G₂₃ across it, which are both zero without shear
    /// flexibility: `Q₁₁ = E₁/(1 − ν₁₂ ν₂₁)`, `Q₁₂ = ν₂₁ Q₁₁`, `Q₂₂ = E₂/(1 − ν₁₂ ν₂₁)` with `ν₂₁ = ν₁₂ E₂/E₁` (R. M.
    /// Jones, Mechanics of Composite Materials, 2nd ed., §2.4); `None` if some strain costs nothing.
    pub fn orthotropic(
        [first, second, poisson, shear]: [f64; 4],
        [along, beside]: [f64; 2],
    ) -> Option<Self> {
        let other = poisson * second / first;
        let rest = 1.0 - poisson * other;
        let sound = [first, second, shear, rest]
            .iter()
            .all(|x| *x > 0.0 && x.is_finite());
        let flexible = match (along, beside) {
            (0.0, 0.0) => false,
            (a, b) if a > 0.0 && b > 0.0 && a.is_finite() && b.is_finite() => true,
            _ => return None,
        };
        sound.then_some(SheetElasticity {
            plane: [
                [first / rest, other * first / rest, 0.0],
                [other * first / rest, second / rest, 0.0],
                [0.0, 0.0, shear],
            ],
            across: flexible.then_some([[along, 0.0], [0.0, beside]]),
        })
    }
}

/// The rest of a stiffness by its diagonal, after elimination of the rows before, below which some strain costs
/// nothing. A choice above rounding, and below the rest of an isotropic solid with a Poisson's ratio of 0.499999999.
const SOFT: f64 = 1e-12;

/// Elasticity of an anisotropic solid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidElasticity {
    /// Stiffness in its axes: xx, yy, zz, xy, yz, zx of stress for those of strain, with engineering shear.
    pub stiffness: [[f64; 6]; 6],
    /// Its axes.
    pub axes: LocalAxes,
}

impl SolidElasticity {
    /// The stiffness of an orthotropic solid of E₁, E₂, E₃, of ν₁₂, ν₁₃, ν₂₃ and G₁₂, G₁₃, G₂₃ (Pa; –; Pa): the inverse
    /// of the compliance with 1/E_i on its diagonal, −ν_ij/E_i beside it and 1/G_ij for shear, where ν_ij is the
    /// contraction along j by a pull along i (R. M. Jones, Mechanics of Composite Materials, 2nd ed., §2.3); `None` if
    /// some strain costs nothing.
    pub fn orthotropic(
        young: [f64; 3],
        poisson: [f64; 3],
        shear: [f64; 3],
    ) -> Option<[[f64; 6]; 6]> {
        let ([e1, e2, e3], [n12, n13, n23]) = (young, poisson);
        let [n21, n31, n32] = [n12 * e2 / e1, n13 * e3 / e1, n23 * e3 / e2];
        let rest = 1.0 - n12 * n21 - n23 * n32 - n31 * n13 - 2.0 * n21 * n32 * n13;
        let normal = [
            [
                e1 * (1.0 - n23 * n32),
                e1 * (n21 + n31 * n23),
                e1 * (n31 + n21 * n32),
            ],
            [
                e1 * (n21 + n31 * n23),
                e2 * (1.0 - n13 * n31),
                e2 * (n32 + n12 * n31),
            ],
            [
                e1 * (n31 + n21 * n32),
                e2 * (n32 + n12 * n31),
                e3 * (1.0 - n12 * n21),
            ],
        ];
        let mut stiffness = [[0.0; 6]; 6];
        for (row, own) in stiffness.iter_mut().zip(normal) {
            for (entry, x) in row.iter_mut().zip(own) {
                *entry = x / rest;
            }
        }
        let [g12, g13, g23] = shear;
        for (k, modulus) in [(3, g12), (4, g23), (5, g13)] {
            stiffness[k][k] = modulus;
        }
        let sound = young.iter().chain(&shear).all(|x| *x > 0.0);
        (sound && stiffness_fault(&stiffness).is_none()).then_some(stiffness)
    }

    /// Young's modulus along the first axis and the contraction ν₁₂ along the second: 1/S₁₁ and −S₂₁/S₁₁ of the
    /// compliance S. The stiffness must be positive definite.
    pub fn first_constants(&self) -> [f64; 2] {
        // S e₁ by elimination
        let mut work = self.stiffness;
        let mut right = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for k in 0..6 {
            let (pivot, own) = (work[k], right[k]);
            for (row, x) in work.iter_mut().zip(&mut right).skip(k + 1) {
                let factor = row[k] / pivot[k];
                *x -= factor * own;
                for (entry, p) in row.iter_mut().zip(pivot) {
                    *entry -= factor * p;
                }
            }
        }
        for k in (0..6).rev() {
            let known: f64 = (k + 1..6).map(|j| work[k][j] * right[j]).sum();
            right[k] = (right[k] - known) / work[k][k];
        }
        [1.0 / right[0], -right[1] / right[0]]
    }

    /// The stress (Pa) of a strain at a place (m), both in basic axes: `σ = R (D : (Rᵀ ε R)) Rᵀ` with the axes R there.
    /// Components are xx, yy, zz, xy, yz, zx; shear strains are engineering ones.
    pub fn stress(&self, place: [f64; 3], strain: &[f64; 6]) -> [f64; 6] {
        let axes = self.axes.at(place);
        let [a, b, c] = axes;
        let back = from_axes(a, b, c);
        let [x, y, z, xy, yz, zx] = *strain;
        let [xy, yz, zx] = [0.5 * xy, 0.5 * yz, 0.5 * zx];
        let tensor = [[x, xy, zx], [xy, y, yz], [zx, yz, z]];
        let e = product(&back, &product(&tensor, &axes));
        let own = [
            e[0][0],
            e[1][1],
            e[2][2],
            e[0][1] + e[1][0],
            e[1][2] + e[2][1],
            e[2][0] + e[0][2],
        ];
        let [x, y, z, xy, yz, zx] = self
            .stiffness
            .map(|row| row.iter().zip(own).map(|(d, e)| d * e).sum::<f64>());
        let tensor = [[x, xy, zx], [xy, y, yz], [zx, yz, z]];
        let s = product(&axes, &product(&tensor, &back));
        [s[0][0], s[1][1], s[2][2], s[0][1], s[1][2], s[2][0]]
    }

    /// The fault of its stiffness or axes, if it has one.
    pub(crate) fn fault(&self) -> Option<String> {
        let rotations = [self.axes.rotation, self.axes.turn];
        if !rotations.iter().all(is_rotation) || !self.axes.origin.iter().all(|x| x.is_finite()) {
            return Some("axes that are no rotation".into());
        }
        stiffness_fault(&self.stiffness)
    }
}

/// The fault of a stiffness of a solid, if it is not symmetric and positive definite: LDLᵀ has positive pivots.
pub(crate) fn stiffness_fault(stiffness: &[[f64; 6]; 6]) -> Option<String> {
    const NAMES: [&str; 6] = ["11", "22", "33", "12", "23", "31"];
    let symmetric = (0..6).all(|i| (0..i).all(|j| stiffness[i][j] == stiffness[j][i]));
    if !symmetric || !stiffness.as_flattened().iter().all(|x| x.is_finite()) {
        return Some("a stiffness that is not symmetric, or no number".into());
    }
    let mut rest = *stiffness;
    for (k, name) in NAMES.iter().enumerate() {
        let pivot = rest[k];
        if pivot[k].is_nan() || pivot[k] <= SOFT * stiffness[k][k].abs() {
            let before = match k {
                0 => String::new(),
                _ => format!(" together with {}", NAMES[..k].join(", ")),
            };
            return Some(format!(
                "a stiffness that is not positive definite: a strain of {name}{before} costs no energy"
            ));
        }
        for row in rest.iter_mut().skip(k + 1) {
            let factor = row[k] / pivot[k];
            for (x, p) in row.iter_mut().zip(pivot) {
                *x -= factor * p;
            }
        }
    }
    None
}
