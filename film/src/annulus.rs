//! A stated elastic ring around a film: a flat annulus in plane stress.

use crate::feedback::{eliminate, substitute};
use crate::film::Film;
use std::f64::consts::{PI, TAU};

/// An elastic ring whose inner surface is the bore.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticRing {
    /// Radial thickness (m).
    pub thickness: f64,
    /// Width along the axis (m).
    pub width: f64,
    /// Young's modulus (Pa).
    pub modulus: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

impl ElasticRing {
    /// Compliance of the shapes of a film without a change across (m/N; others zero), `shapes × shapes` numbers. The
    /// bore has the radius a of the film, the outer surface is free. A generalised force f of the wave k is the
    /// pressure `f/(π a w) cos kθ` over the width w of the ring, and f/(2π a w) for k = 0. The wave k = 1 moves the
    /// ring as a whole, which is the motion of the shell.
    #[must_use]
    pub fn compliance(&self, film: &Film) -> Vec<f64> {
        let shapes = &film.source().shapes;
        let radius = film.source().radius;
        let count = shapes.len();
        let mut compliance = vec![0.0; count * count];
        for (at, shape) in shapes.iter().enumerate() {
            let ratio = 1.0 + self.thickness / radius;
            let around = if shape.around == 0 { TAU } else { PI };
            compliance[at * (count + 1)] = match (shape.around, shape.across) {
                (0 | 2.., 0) => {
                    deflection(shape.around, ratio, self.poisson)
                        / (around * self.width * self.modulus)
                }
                _ => 0.0,
            };
        }
        compliance
    }
}

/// Radial deflection of the bore under a pressure `p cos kθ` on it, over `a p/E`, for the ratio β of the radii and
/// k = 0 or k ≥ 2.
///
/// k = 0: Lamé, `(β² + 1)/(β² − 1) + ν`. Else the stress function `(A r^k + B r^−k + C r^(k+2) + D r^(2−k)) cos kθ`
/// (J. H. Michell, Proc. London Math. Soc. 31 (1899) 100; Timoshenko & Goodier, Theory of Elasticity, 1970, art. 43)
/// with four conditions: the pressure at the bore, no shear there, and no stress at the outer surface. With
/// `κ = (3 − ν)/(1 + ν)` of plane stress the deflection at r = 1 is
/// `(1 + ν) (−k A + k B + (κ − k − 1) C + (κ + k − 1) D)`. The growing terms are scaled by β^−k, so that no power of a
/// high wave overflows. For β → 1 the deflection is that of the thin ring of Timoshenko.
fn deflection(waves: u32, ratio: f64, poisson: f64) -> f64 {
    let square = ratio * ratio;
    if waves == 0 {
        return (square + 1.0) / (square - 1.0) + poisson;
    }
    let k = f64::from(waves);
    let small = libm::pow(ratio, -k);
    // radial stress and shear stress at the bore, then at the outer surface
    let mut stresses = [
        [
            -k * (k - 1.0) * small,
            -k * (k + 1.0),
            -(k + 1.0) * (k - 2.0) * small,
            -(k + 2.0) * (k - 1.0),
        ],
        [
            k * (k - 1.0) * small,
            -k * (k + 1.0),
            k * (k + 1.0) * small,
            -k * (k - 1.0),
        ],
        [
            -k * (k - 1.0) / square,
            -k * (k + 1.0) * small / square,
            -(k + 1.0) * (k - 2.0),
            -(k + 2.0) * (k - 1.0) * small,
        ],
        [
            k * (k - 1.0) / square,
            -k * (k + 1.0) * small / square,
            k * (k + 1.0),
            -k * (k - 1.0) * small,
        ],
    ];
    let (mut terms, mut exchanged) = ([-1.0, 0.0, 0.0, 0.0], [0; 4]);
    let matrix = stresses.as_flattened_mut();
    if !eliminate(matrix, &mut exchanged) {
        return f64::NAN;
    }
    substitute(matrix, &exchanged, &mut terms, 1);
    let kappa = (3.0 - poisson) / (1.0 + poisson);
    let [a, b, c, d] = terms;
    (1.0 + poisson)
        * (-k * small * a + k * b + (kappa - k - 1.0) * small * c + (kappa + k - 1.0) * d)
}
