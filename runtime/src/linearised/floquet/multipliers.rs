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
pub(super) struct Multiplier {
    /// `ln μ` over the period, with its imaginary part from 0 to π (π for a negative μ).
    pub logarithm: Complex<f64>,
    /// Whether μ is real.
    pub real: bool,
    /// ξ at the beginning of every segment, each divided by the growth up to there.
    pub vectors: Vec<DVector<Complex<f64>>>,
}

/// Multipliers, with one for each conjugate pair; the number lost in rounding, and the limit of `ln |μ|` for
/// such a loss.
pub(super) struct Multipliers {
    pub found: Vec<Multiplier>,
    pub lost: usize,
    pub floor: f64,
}

/// The multipliers of an odd number of segments in the order of time.
pub(super) fn multipliers(segments: &[DMatrix<f64>]) -> Result<Multipliers, RuntimeError> {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Known multipliers over 60 decades, behind a mixing that the segments share.
    #[test]
    fn small_multipliers_are_found_beside_large_ones() {
        let n = 7;
        let mix = DMatrix::from_fn(n, n, |i, j| ((i * 7 + j * 5) % 11) as f64 - 5.0)
            .qr()
            .q();
        let m = 7;
        // per segment: a turn by 0.3, one that makes μ = −0.5, 2, 1e-20, 1e-60
        let turn = 0.3_f64;
        let root = |x: f64| x.powf(1.0 / m as f64);
        let segments: Vec<DMatrix<f64>> = (0..m)
            .map(|k| {
                let mut d = DMatrix::zeros(n, n);
                d[(0, 0)] = turn.cos();
                d[(0, 1)] = -turn.sin();
                d[(1, 0)] = turn.sin();
                d[(1, 1)] = turn.cos();
                d[(2, 2)] = root(0.5) * if k == 3 { -1.0 } else { 1.0 };
                d[(3, 3)] = root(2.0);
                d[(4, 4)] = root(1e-20);
                d[(5, 5)] = 1e-9;
                d[(6, 6)] = root(0.25);
                &mix * d * mix.transpose()
            })
            .collect();
        let all = multipliers(&segments).unwrap();
        assert_eq!(all.lost, 1);
        let mut due = vec![
            (0.0, 7.0 * turn, false),
            (0.5_f64.ln(), PI, true),
            (2.0_f64.ln(), 0.0, true),
            (1e-20_f64.ln(), 0.0, true),
            (0.25_f64.ln(), 0.0, true),
        ];
        assert_eq!(all.found.len(), due.len());
        for found in &all.found {
            let place = due
                .iter()
                .position(|(re, im, real)| {
                    *real == found.real && (found.logarithm - Complex::new(*re, *im)).norm() < 1e-7
                })
                .unwrap_or_else(|| panic!("{}", found.logarithm));
            due.remove(place);
            // each segment takes one vector to the next
            let step = (found.logarithm / m as f64).exp();
            for (k, segment) in segments.iter().enumerate() {
                let (v, next) = (&found.vectors[k], &found.vectors[(k + 1) % m]);
                let moved = segment.map(|x| Complex::new(x, 0.0)) * v;
                let due = next * step;
                assert!(
                    (moved - due).norm() < 1e-7 * v.norm(),
                    "{k} {}",
                    found.logarithm
                );
            }
        }
        assert!(due.is_empty(), "{due:?}");
    }
}
