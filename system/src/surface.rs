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
