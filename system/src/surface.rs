//! The shapes of elastic round surfaces in a text: their number and their order.
//!
//! The reduction of a body finds their amplitudes, and a film on the surface has them in its gap.

use serde::{Deserialize, Serialize};

/// Shapes of the radial deflection of a round surface: `cos kθ` and `sin kθ` up to a number of waves around, times
/// Legendre's polynomials `P_l(ζ)` up to a degree across. θ counts from the x axis of the marker towards y, and ζ is −1
/// and 1 at the ends of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct SurfaceShapes {
    /// Most waves around.
    pub around: u32,
    /// Highest degree across.
    pub across: u32,
}

/// One shape of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceShape {
    /// Waves around, k.
    pub around: u32,
    /// `sin kθ` instead of `cos kθ`.
    pub sine: bool,
    /// Degree across, l.
    pub across: u32,
}

impl SurfaceShapes {
    /// The shapes in their order: degree by degree across, wave by wave around, cosine before sine.
    pub fn each(self) -> impl Iterator<Item = SurfaceShape> {
        (0..=self.across).flat_map(move |across| {
            (0..=self.around).flat_map(move |around| {
                let shape = move |sine| SurfaceShape {
                    around,
                    sine,
                    across,
                };
                [false, true]
                    .into_iter()
                    .filter(move |sine| !sine || around > 0)
                    .map(shape)
            })
        })
    }

    /// Number of shapes.
    pub fn count(self) -> usize {
        (2 * self.around as usize + 1) * (self.across as usize + 1)
    }
}

impl SurfaceShape {
    /// Its value at an angle θ (rad) and ζ.
    pub fn value(self, angle: f64, zeta: f64) -> f64 {
        let (sin, cos) = libm::sincos(f64::from(self.around) * angle);
        let (mut before, mut legendre) = (0.0, 1.0);
        for degree in 0..self.across {
            let degree = f64::from(degree);
            let next = ((2.0 * degree + 1.0) * zeta * legendre - degree * before) / (degree + 1.0);
            (before, legendre) = (legendre, next);
        }
        legendre * if self.sine { sin } else { cos }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_have_their_order_and_values() {
        let shapes = SurfaceShapes {
            around: 2,
            across: 2,
        };
        let each: Vec<SurfaceShape> = shapes.each().collect();
        assert_eq!(each.len(), shapes.count());
        let last = each[each.len() - 1];
        assert_eq!((last.around, last.sine, last.across), (2, true, 2));
        // P₂(ζ) = (3 ζ² − 1)/2
        let value = last.value(0.3, 0.8);
        assert!((value - libm::sin(0.6) * (3.0 * 0.64 - 1.0) / 2.0).abs() < 1e-15);
        assert_eq!(each[0].value(1.0, 0.5), 1.0);
    }
}
