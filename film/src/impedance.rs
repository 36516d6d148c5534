//! The response of an aligned bearing to its one relevant velocity, as a correction of the impedance formula.
//!
//! The force of a plain, aligned film with the rule `Reynolds` is homogeneous of degree one in
//! `v_s = ė − ½ ω × e`, the velocity of the pin's centre seen from a frame that turns with the mean surface
//! speed, and depends on no other one:
//!
//! ```text
//! F = −2 μ B (R/c)³ |v_s| W (cos β u + sin β u⊥)         u = v_s/|v_s|,  u⊥ = u turned by +90°
//! ```
//!
//! W and β depend on B/D and on the components x, y of the eccentricity ratio along u and u⊥ alone. The law
//! `Reynolds` of the library stores them relative to the formula of Childs, Moes & van Leeuwen:
//!
//! ```text
//! load = W/W_m     side = (β − β_m)/y     over B/D, −ln(1 − ε) and cos α = x/ε
//! ```
//!
//! Both are even in α, the angle of e from v_s, so they are smooth in cos α, and no angle is needed. At e = 0
//! they do not depend on α.

use crate::error::FilmError;
use crate::film::Film;
use crate::inputs::Inputs;
use crate::source::{Cavitation, EdgeSlope, FilmSource, Lines};

/// Components along u and u⊥ of the response by D. W. Childs, H. Moes, H. van Leeuwen, J. Lubr. Technol. 99
/// (1977) 198, at the components x, y of the eccentricity ratio and B/D; `docs/theory.md` has the formula.
/// Dimensionless: W (cos β, sin β) of the head of this module.
#[must_use]
pub fn childs_response(x: f64, y: f64, slenderness: f64) -> [f64; 2] {
    let q = (1.0 - y * y).sqrt();
    let square = slenderness * slenderness;
    let wide = (1.0 - x * x - y * y) / square;
    // 3.60, 2.12 and 0.150 are the authors' constants, fitted between the short and the long bearing
    let full = libm::atan2(3.0 * (1.0 + 3.60 * wide) * y, 4.0 * (1.0 + 2.12 * wide) * q);
    let beta = libm::asin(y) - (1.0 - x / q) * (libm::asin(y) - full);
    let (sin, cos) = libm::sincos(beta);
    let (xi, eta) = (x * cos + y * sin, y * cos - x * sin);
    let b = (1.0 - xi) / square;
    let e = 1.0 + 2.12 * b;
    let g = 3.0 * eta * (1.0 + 3.60 * b) / (4.0 * (1.0 - xi));
    let w = 1.0 / (0.150 * (e * e + g * g).sqrt() * (1.0 - xi) * (1.0 - xi).sqrt());
    [w * cos, w * sin]
}

/// Lines from 0 to `reach`, spaced as `least sinh`: close to 0 they are denser, as a share of `least`.
fn graded(reach: f64, least: f64, cells: usize) -> Vec<f64> {
    let rate = libm::asinh(reach / least);
    let line = |at: usize| least * libm::sinh(rate * at as f64 / cells as f64);
    let mut lines: Vec<f64> = (0..cells).map(line).collect();
    lines.push(reach);
    lines
}

/// Response of the solved film on `2 around × across` cells of its half width. The cells are dense where the
/// gap is thin and at the end, over the length `√(2 (1 − ε)) R` on which the gap doubles. Dimensionless, as W
/// (cos β, sin β).
fn solved(
    slenderness: f64,
    ratio: f64,
    cosine: f64,
    cells: [usize; 2],
) -> Result<[f64; 2], FilmError> {
    let length = (2.0 * (1.0 - ratio)).sqrt();
    // the thinnest place lies at θ = π, so that lines rise from 0 to 2π
    let half = graded(std::f64::consts::PI, length, cells[0]);
    let mut around: Vec<f64> = half
        .iter()
        .rev()
        .map(|line| std::f64::consts::PI - line)
        .collect();
    around.extend(half[1..].iter().map(|line| std::f64::consts::PI + line));
    let width = 2.0 * slenderness;
    let end = width / 2.0;
    let from_end = graded(end, length.min(end), cells[1]);
    let mut source = FilmSource::plain(1.0, width, 1.0, Cavitation::Reynolds, [0, 0]);
    source.half_width = true;
    // its error is purely of second order, so the extrapolation takes almost all of it away
    source.edges = EdgeSlope::OneCell;
    source.around = Lines::At(around);
    source.across = Lines::At(from_end.iter().rev().map(|line| end - line).collect());
    let film = Film::new(source)?;
    let (mut work, mut outputs) = (film.work(), vec![0.0; film.outputs()]);
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    // e along −x; u at −α from it
    let inputs = Inputs {
        eccentricity: [-ratio, 0.0],
        rate: [-cosine, sine],
        ..Inputs::still(1.0)
    };
    film.solve(&inputs.write(), None, &[], &mut work, &mut outputs)?;
    let over = -1.0 / (2.0 * width);
    let along = -outputs[0] * cosine + outputs[1] * sine;
    let across = -outputs[0] * sine - outputs[1] * cosine;
    Ok([over * along, over * across])
}

/// Cells of the coarser of two solutions that are extrapolated: half of those around, and those of half the
/// width. A choice: the cells are dense where the gap is thin, and the extrapolation takes most of their
/// error away.
const CELLS: [usize; 2] = [48, 10];

/// Response (W cos β, W sin β) by the solved film, extrapolated from two grids with second order. ε = `ratio`
/// in 0 to 0.9995, `cosine` = cos α.
///
/// # Errors
/// As [`Film::solve`].
pub fn solved_response(slenderness: f64, ratio: f64, cosine: f64) -> Result<[f64; 2], FilmError> {
    let coarse = solved(slenderness, ratio, cosine, CELLS)?;
    let fine = solved(slenderness, ratio, cosine, CELLS.map(|cells| 2 * cells))?;
    Ok([0, 1].map(|axis| (4.0 * fine[axis] - coarse[axis]) / 3.0))
}

/// Least distance of α from 0 and 180° (rad), and least ε, at which `side` is computed. The quotient has a
/// limit beyond them and approaches it with second order. A choice: the error of the limit is about the
/// square, 4e-4, and nearer to the limit both numbers of the quotient lose their digits.
const NEAR: [f64; 2] = [0.02, 0.02];

/// `load` and `side` of the table at B/D, `u = −ln(1 − ε)` and cos α. `load` is dimensionless, `side` in rad.
///
/// # Errors
/// As [`Film::solve`].
pub fn correction(slenderness: f64, u: f64, cosine: f64) -> Result<[f64; 2], FilmError> {
    // at the centre the only direction is that of v_s
    let (ratio, cosine) = (-libm::expm1(-u), if u == 0.0 { 0.0 } else { cosine });
    let relative = |ratio: f64, cosine: f64| {
        let [along, across] = solved_response(slenderness, ratio, cosine)?;
        let y = ratio * (1.0 - cosine * cosine).max(0.0).sqrt();
        let [x_m, y_m] = childs_response(ratio * cosine, y, slenderness);
        let load = libm::hypot(along, across) / libm::hypot(x_m, y_m);
        let turned = libm::atan2(across * x_m - along * y_m, along * x_m + across * y_m);
        Ok::<_, FilmError>([load, turned / y])
    };
    let limit = libm::cos(NEAR[0]);
    let near = (ratio.max(NEAR[1]), cosine.clamp(-limit, limit));
    let at_near = relative(near.0, near.1)?;
    match near == (ratio, cosine) {
        true => Ok(at_near),
        false => Ok([relative(ratio, cosine)?[0], at_near[1]]),
    }
}

/// Points of the table: B/D, u to 6.9 (ε = 0.99899), and cos α in rising order.
#[must_use]
pub fn points() -> [Vec<f64>; 3] {
    let slenderness = [
        // a choice: lines about 25 % apart, because the correction changes smoothly between short and long
        // bearings
        0.08, 0.1, 0.125, 0.16, 0.2, 0.25, 0.32, 0.4, 0.5, 0.63, 0.8, 1.0, 1.2, 1.5,
    ];
    let u = (0..24).map(|at| f64::from(3 * at) / 10.0).collect();
    // a little denser at 90°, where the squeezed side passes the thinnest place
    let cosine = (-18..=18).map(|at| {
        let s = f64::from(at) / 18.0;
        let angle = std::f64::consts::FRAC_PI_2 * (0.8 * s + 0.2 * s * s * s);
        // the file of the table has four decimals
        (1e4 * libm::sin(angle)).round() / 1e4
    });
    [slenderness.to_vec(), u, cosine.collect()]
}

/// First line of the table's file.
pub const HEADER: &str = "B/D,u,cosine,load,side";

/// A line of the table's file.
///
/// # Errors
/// As [`Film::solve`].
pub fn line(slenderness: f64, u: f64, cosine: f64) -> Result<String, FilmError> {
    let [load, side] = correction(slenderness, u, cosine)?;
    Ok(format!("{slenderness},{u},{cosine},{load:.6},{side:.5}"))
}
