//! Multipliers of a product of matrices, including those far below the largest.
//!
//! An eigenvalue of `W = X_m … X_1` that is much smaller than the largest is lost in rounding. The
//! eigenvalues ν of the cyclic matrix
//!
//! ```text
//! ⎡ 0              X_m ⎤
//! ⎢ X_1   0            ⎥      X_1 v_1 = ν v_2,  …,  X_m v_m = ν v_1,      so W v_1 = ν^m v_1
//! ⎣       …  X_{m−1} 0 ⎦
//! ```
//!
//! are the m roots of each multiplier μ. With m = 7 a root of 10⁻¹² is a μ of 10⁻⁸⁴. Of the m roots the code
//! uses the one with the angle of μ over m. m is odd, so that a negative μ has one negative root (A.
//! Bojanczyk, G. Golub, P. Van Dooren, SPIE 1770 (1992) 31, for the product's Schur form, of which this is
//! the spectrum).

use super::super::eigen::spectrum;
use crate::error::RuntimeError;
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::PI;

/// Share of the largest root below which a root is rounding. A choice: roots above it have some digits, as
/// eigenvalues of the cyclic matrix have errors of some 1e-14 of the largest.
const DROWNED: f64 = 1e-7;
/// Relative distance below which two roots are equal. A choice above the rounding of eigenvalues.
const ONE: f64 = 1e-6;

/// A multiplier.
#[derive(Clone, Debug)]
pub struct Multiplier {
    /// `ln μ` over the period, with its imaginary part from 0 to π (π for a negative μ).
    pub logarithm: Complex<f64>,
    /// Whether μ is real.
    pub real: bool,
    /// ξ at the beginning of every segment, each divided by the growth up to there.
    pub vectors: Vec<DVector<Complex<f64>>>,
}

/// The multipliers of a product.
pub struct Multipliers {
    /// One for each conjugate pair.
    pub found: Vec<Multiplier>,
    /// The number lost in rounding.
    pub lost: usize,
    /// The limit of `ln |μ|` for such a loss.
    pub floor: f64,
}

/// The multipliers of an odd number of segments in the order of time.
///
/// # Errors
/// If the eigenvalues of the cyclic matrix are not found.
pub fn multipliers(segments: &[DMatrix<f64>]) -> Result<Multipliers, RuntimeError> {
    let m = segments.len();
    let size = segments.first().map_or(0, DMatrix::nrows);
    let mut cyclic = DMatrix::zeros(m * size, m * size);
    for (k, segment) in segments.iter().enumerate() {
        let row = (k + 1) % m;
        cyclic
            .view_mut((row * size, k * size), (size, size))
            .copy_from(segment);
    }
    let pairs = spectrum(cyclic)?.pairs;
    let largest = pairs.iter().fold(0.0_f64, |w, p| w.max(p.value.norm()));
    let floor = DROWNED * largest;
    let of_m = m as f64;
    let negative: Vec<f64> = pairs
        .iter()
        .filter(|p| p.value.im == 0.0 && p.value.re < -floor)
        .map(|p| -p.value.re)
        .collect();
    let mut found = Vec::new();
    for pair in &pairs {
        let size_of = pair.value.norm();
        if size_of <= floor {
            continue;
        }
        let real = pair.value.im == 0.0;
        let angle = libm::atan2(pair.value.im, pair.value.re);
        let whole = if real {
            // one root of a positive μ is positive, one of a negative μ is negative
            if pair.value.re > 0.0 { 0.0 } else { PI }
        } else {
            let whole = angle * of_m;
            // a root beside the negative axis belongs to a real μ that was found already
            let twin = (whole - PI).abs() < ONE
                && negative.iter().any(|n| (n / size_of - 1.0).abs() < ONE);
            if whole > PI || twin {
                continue;
            }
            whole
        };
        let step = Complex::new(libm::cos(whole / of_m), libm::sin(whole / of_m));
        let vectors = if real && pair.value.re < 0.0 {
            // from the root −|ν| to the one of angle π/m, the vectors turn by one step from segment to
            // segment
            let flip = -step.conj();
            blocks(&pair.vector, size, m)
                .into_iter()
                .enumerate()
                .map(|(k, v)| v * flip.powu(k as u32))
                .collect()
        } else {
            blocks(&pair.vector, size, m)
        };
        found.push(Multiplier {
            logarithm: Complex::new(of_m * libm::log(size_of), whole),
            real,
            vectors,
        });
    }
    let counted: usize = found.iter().map(|f| if f.real { 1 } else { 2 }).sum();
    Ok(Multipliers {
        lost: size.saturating_sub(counted),
        found,
        floor: of_m * libm::log(floor.max(f64::MIN_POSITIVE)),
    })
}

fn blocks(vector: &DVector<Complex<f64>>, size: usize, count: usize) -> Vec<DVector<Complex<f64>>> {
    (0..count)
        .map(|k| vector.rows(k * size, size).into_owned())
        .collect()
}
