//! The shell of four nodes: MITC4 (E. N. Dvorkin, K.-J. Bathe, Eng. Comput. 1, 1984) with a membrane enhanced
//! by four strains (J. C. Simo, M. S. Rifai, Int. J. Numer. Methods Eng. 29, 1990).
//!
//! Of the covariant strains of [`super::surface`] γ_r is taken at the middles of the sides s = ±1, and γ_s at
//! those of r = ±1, linear between. So γ does not lock in thin plates. The enhanced strains (j₀/j) T₀ [r, s, (r,
//! s)] vanish in the mean over the element. So constant strains stay exact, and a rectangle bends in its plane
//! without locking. They are eliminated here.
//!
//! **Residual bending flexibility.** Linear rotations give a moment that is constant along the element, but a
//! shear force makes it linear. So one element of length l lacks the share F l³/(12 D) of the deflection F l³/(3
//! D) of a cantilever. Nastran adds l²/(12 D) to the flexibility of shear in each direction (R. H. MacNeal, Comput.
//! Struct. 8, 1978, 175–183). Here [`Rotations::Parabolic`] adds the rotations themselves: along r the director
//! has β_r = (1 − r²) a (m), eliminated like the enhanced strains,
//!
//! ```text
//! κ_rr = (j₀/j) T₀ (−2 r a)     γ_r = ⅔ a, its mean over the element
//! ```
//!
//! and likewise along s. The energy ½ (64/3) D a²/l⁴ of its moment, with the γ = 4 a/(3 l), is just the flexibility
//! l²/(12 D). The curvature vanishes in the mean, so constant curvatures stay exact. In contrast to a change of
//! the shear stiffness, the stresses have the linear moment, and a narrow strip bends with E I, not with D,
//! because the nodes follow its contraction. The part of γ_r that is linear in s has the flexibility of MacNeal's
//! element, `α l²/(36 D)` with `α = ε/(ε + (1 − ε) l²/b²)`, the lengths l along r and b along s, and his ε = 0.04.
//! With the shear stiffness S this part is so multiplied by `1/√(1 + α S l²/(36 D))`.

use super::condense::{Modes, condense};
use super::surface::{COVARIANT, Geometry, Surface};
use super::{
    STRAINS, ShellPoint, WIDTH,
    law::{Law, Plate},
};
use crate::fe::vector::{dot, norm, subtract};

/// Reference coordinates of the nodes.
pub(super) const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Number of enhanced strains.
const ENHANCED: usize = 4;

/// MacNeal's ε: the share of the residual flexibility for shear that varies linearly across a square.
const ACROSS: f64 = 0.04;

/// Number of parabolic rotations.
const PARABOLIC: usize = 2;

/// How the directors turn between the nodes of a quadrilateral of four nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::fe) enum Rotations {
    /// Linear along each direction.
    Bilinear,
    /// With a parabola along each direction, which has the residual bending flexibility.
    Parabolic,
}

/// The points of the stiffness: 2 × 2.
///
/// # Errors
/// The area for a unit of the reference domain (m²) where the element is folded or flat.
pub(super) fn points(
    geometry: &Geometry,
    plate: &Plate,
    rotations: Rotations,
) -> Result<Vec<ShellPoint>, f64> {
    let middle = geometry.middle()?;
    let directors = geometry.directors()?;
    let side = subtract(geometry.places[1], geometry.places[0]);
    // γ_r at s = −1 and s = 1, γ_s at r = −1 and r = 1
    let mut shear = [[0.0; WIDTH]; 4];
    let at = [[0.0, -1.0], [0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]];
    for (index, (row, at)) in shear.iter_mut().zip(at).enumerate() {
        *row = geometry.at(at, None)?.covariant(&directors)[6 + index / 2];
    }
    if rotations == Rotations::Parabolic {
        soften(
            &middle,
            &plate.law(&middle.shape.values, &middle.axes, side, 4.0 * middle.area),
            &mut shear,
        );
    }
    let [below, above, left, right] = &shear;
    let place = (1.0f64 / 3.0).sqrt();
    let mut found = Vec::with_capacity(4);
    let (mut enhanced, mut parabolic) = (Vec::with_capacity(4), Vec::with_capacity(4));
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
        parabolic.push(parabolic_rows(&middle, &surface, [r, s]));
    }
    match rotations {
        Rotations::Bilinear => condense(&mut found, &enhanced),
        Rotations::Parabolic => {
            let pairs = enhanced.iter().zip(&parabolic);
            let both: Vec<_> = pairs.map(|(first, second)| joined(first, second)).collect();
            condense(&mut found, &both);
        }
    }
    Ok(found)
}

/// Multiplies the parts of γ_r that are linear in s, and of γ_s that are linear in r, so that their energy is that
/// of MacNeal's flexibility.
fn soften(middle: &Surface, law: &Law, shear: &mut [[f64; WIDTH]; 4]) {
    let lengths = middle.tangent.map(|tangent| 2.0 * norm(tangent));
    let [below, above, left, right] = shear;
    for (along, [first, second]) in [(0, [below, above]), (1, [left, right])] {
        let [length, width] = [lengths[along], lengths[1 - along]];
        let direction =
            [0, 1].map(|i: usize| 2.0 * dot(middle.tangent[along], middle.axes[i]) / length);
        let bending = law.bending_along(direction);
        if bending <= 0.0 {
            continue;
        }
        let ratio = length * length / (width * width);
        let share = ACROSS / (ACROSS + (1.0 - ACROSS) * ratio);
        let flexibility = share * length * length / (36.0 * bending);
        let factor = 1.0 / (1.0 + flexibility * law.shear_along(direction)).sqrt();
        for (a, b) in first.iter_mut().zip(second) {
            let (mean, half) = (0.5 * (*a + *b), 0.5 * factor * (*b - *a));
            *a = mean - half;
            *b = mean + half;
        }
    }
}

/// Modes beside each other.
fn joined(first: &Modes<ENHANCED>, second: &Modes<PARABOLIC>) -> Modes<{ ENHANCED + PARABOLIC }> {
    std::array::from_fn(|strain| {
        std::array::from_fn(|mode| match mode.checked_sub(ENHANCED) {
            None => first[strain][mode],
            Some(mode) => second[strain][mode],
        })
    })
}

/// Strains (1/m², 1/m) of the rotations 1 − r² and 1 − s², for an amplitude of 1 m.
fn parabolic_rows(middle: &Surface, surface: &Surface, place: [f64; 2]) -> Modes<PARABOLIC> {
    let factor = middle.area / surface.area;
    let mut rows = [[0.0; PARABOLIC]; STRAINS];
    for (mode, r) in place.into_iter().enumerate() {
        for (i, line) in middle.transformation().iter().enumerate() {
            rows[3 + i][mode] = -2.0 * factor * r * line[mode];
        }
        for (i, along) in surface.dual[mode].iter().enumerate() {
            rows[6 + i][mode] = 2.0 / 3.0 * along;
        }
    }
    rows
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
