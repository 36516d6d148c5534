//! The shell of four nodes: MITC4 (E. N. Dvorkin, K.-J. Bathe, Eng. Comput. 1, 1984) with a membrane enhanced
//! by four strains (J. C. Simo, M. S. Rifai, Int. J. Numer. Methods Eng. 29, 1990).
//!
//! Of the covariant strains of [`super::surface`] γ_r is taken at the middles of the sides s = ±1, and γ_s at
//! those of r = ±1, linear between. So γ does not lock in thin plates. The enhanced strains (j₀/j) T₀ [r, s, (r,
//! s)] vanish in the mean over the element. So constant strains stay exact, and a rectangle bends in its plane
//! without locking. They are eliminated here.

use super::condense::{Modes, condense};
use super::surface::{COVARIANT, Geometry, Surface};
use super::{STRAINS, ShellPoint, WIDTH, law::Plate};
use crate::fe::vector::subtract;

/// Reference coordinates of the nodes.
pub(super) const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Number of enhanced strains.
const ENHANCED: usize = 4;

/// The points of the stiffness: 2 × 2.
///
/// # Errors
/// The area for a unit of the reference domain (m²) where the element is folded or flat.
pub(super) fn points(geometry: &Geometry, plate: &Plate) -> Result<Vec<ShellPoint>, f64> {
    let middle = geometry.middle()?;
    let directors = geometry.directors()?;
    // γ_r at s = −1 and s = 1, γ_s at r = −1 and r = 1
    let mut shear = [[0.0; WIDTH]; 4];
    let at = [[0.0, -1.0], [0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]];
    for (index, (row, at)) in shear.iter_mut().zip(at).enumerate() {
        *row = geometry.at(at, None)?.covariant(&directors)[6 + index / 2];
    }
    let [below, above, left, right] = &shear;
    let place = (1.0f64 / 3.0).sqrt();
    let side = subtract(geometry.places[1], geometry.places[0]);
    let (mut found, mut enhanced) = (Vec::with_capacity(4), Vec::with_capacity(4));
    for [r, s] in CORNERS {
        let [r, s] = [r * place, s * place];
        let surface = geometry.at([r, s], Some(middle.axes[0]))?;
        let mut covariant = surface.covariant::<WIDTH>(&directors);
        for k in 0..WIDTH {
            covariant[6][k] = 0.5 * ((1.0 - s) * below[k] + (1.0 + s) * above[k]);
            covariant[7][k] = 0.5 * ((1.0 - r) * left[k] + (1.0 + r) * right[k]);
        }
        let mut rows = [[0.0; WIDTH]; STRAINS];
        rows[..COVARIANT].copy_from_slice(&surface.along_tangents(&covariant));
        rows[8] = surface.drilling();
        found.push(ShellPoint {
            area: surface.area,
            rows,
            law: plate.law(
                &surface.shape.values,
                &surface.axes,
                side,
                4.0 * middle.area,
            ),
            axes: surface.axes,
            side,
            at: [r, s],
        });
        enhanced.push(enhanced_rows(&middle, &surface, [r, s]));
    }
    condense(&mut found, &enhanced);
    Ok(found)
}

/// `(j₀/j) T₀ E` with r in rr, s in ss, r and s in 2 rs. These strains are those of displacements 1 − r² and 1
/// − s², whose rotation ½ n·curl u is r/(2 j) and −s/(2 j) for the last two.
fn enhanced_rows(middle: &Surface, surface: &Surface, [r, s]: [f64; 2]) -> Modes<ENHANCED> {
    let factor = middle.area / surface.area;
    let modes = [(0, r), (1, s), (2, r), (2, s)];
    let mut rows = [[0.0; ENHANCED]; STRAINS];
    for (row, line) in rows.iter_mut().zip(middle.transformation()) {
        *row = modes.map(|(component, value)| factor * line[component] * value);
    }
    let turn = 0.5 / surface.area;
    rows[8] = [0.0, 0.0, -turn * r, turn * s];
    rows
}
