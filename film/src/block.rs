//! Dense blocks: rows of `width` numbers one after the other.
//!
//! Their loops run over pairs of numbers, and over constant widths where those are common.

/// Calls a function with the width of the blocks, as a constant where that is common: its loops become
/// straight code.
macro_rules! with_width {
    ($width:expr, $call:expr) => {
        match $width {
            4 => $call(4),
            6 => $call(6),
            8 => $call(8),
            10 => $call(10),
            12 => $call(12),
            14 => $call(14),
            16 => $call(16),
            26 => $call(26),
            width => $call(width),
        }
    };
}
pub(crate) use with_width;

/// Adds `factor*other` to a row of equal length, pair by pair: so the compiler takes registers of two
/// numbers, also where it unrolls the loop.
#[inline(always)]
pub(crate) fn add(row: &mut [f64], factor: f64, other: &[f64]) {
    let (pairs, last) = row.as_chunks_mut::<2>();
    let (others, other) = other.as_chunks::<2>();
    for (pair, other) in pairs.iter_mut().zip(others) {
        *pair = [pair[0] + factor * other[0], pair[1] + factor * other[1]];
    }
    for (number, added) in last.iter_mut().zip(other) {
        *number += factor * added;
    }
}

/// Adds `factor*other` to several sums.
#[inline(always)]
pub(crate) fn add_lanes<const N: usize>(sums: &mut [f64; N], factor: f64, other: &[f64; N]) {
    for (sum, added) in sums.iter_mut().zip(other) {
        *sum += factor * added;
    }
}

/// Adds a combination of two others to a row, in the same way.
#[inline(always)]
fn add_two(row: &mut [f64], factors: [f64; 2], others: [&[f64]; 2]) {
    let others = others.map(|other| other.as_chunks::<2>().0);
    for ((pair, one), other) in row
        .as_chunks_mut::<2>()
        .0
        .iter_mut()
        .zip(others[0])
        .zip(others[1])
    {
        *pair = [0, 1].map(|at| pair[at] + factors[0] * one[at] + factors[1] * other[at]);
    }
}

/// Replaces a block by its inverse, by Gauß & Jordan with pivots of two rows, of which none are exchanged:
///
/// ```text
/// rows K of the pivot:  S_KK⁻¹ S          and S_KK⁻¹ in the columns K
/// the other rows i:     S_i − S_iK S_KK⁻¹ S     and −S_iK S_KK⁻¹ in the columns K
/// ```
///
/// Rows with zeros in the pivot's columns stay.
#[inline(always)]
pub(crate) fn invert(block: &mut [f64], width: usize, lines: &mut [Vec<f64>; 2]) {
    let count = block.len() / width;
    let [one, other] = lines;
    let (one, other) = (&mut one[..width], &mut other[..width]);
    for first in (0..count - 1).step_by(2) {
        let (above, rest) = block.split_at_mut(first * width);
        let (pivots, below) = rest.split_at_mut(2 * width);
        let (upper, lower) = pivots.split_at_mut(width);
        let [a, b, c, d] = [
            upper[first],
            upper[first + 1],
            lower[first],
            lower[first + 1],
        ];
        let inverse = 1.0 / (a * d - b * c);
        let [a, b, c, d] = [d * inverse, -b * inverse, -c * inverse, a * inverse];
        one.fill(0.0);
        other.fill(0.0);
        add_two(one, [a, b], [&*upper, &*lower]);
        add_two(other, [c, d], [&*upper, &*lower]);
        upper.copy_from_slice(one);
        lower.copy_from_slice(other);
        // these columns are written last: reading a pair takes longer if one of its numbers was just written
        [upper[first], upper[first + 1]] = [a, b];
        [lower[first], lower[first + 1]] = [c, d];
        // the next pivot's rows are first, so that its division begins early
        for row in below
            .chunks_exact_mut(width)
            .chain(above.chunks_exact_mut(width))
        {
            let factors = [row[first], row[first + 1]];
            if factors != [0.0; 2] {
                add_two(row, factors.map(|factor| -factor), [one, other]);
                row[first] = -factors[0] * a - factors[1] * c;
                row[first + 1] = -factors[0] * b - factors[1] * d;
            }
        }
    }
    if count % 2 == 1 {
        let last = count - 1;
        let (above, row) = block.split_at_mut(last * width);
        let inverse = 1.0 / row[last];
        one.fill(0.0);
        add(one, inverse, row);
        row.copy_from_slice(one);
        row[last] = inverse;
        for row in above.chunks_exact_mut(width) {
            let factor = row[last];
            if factor != 0.0 {
                add(row, -factor, one);
                row[last] = -factor * inverse;
            }
        }
    }
}

/// `S⁻¹ x` of several right-hand sides, from `S⁻ᵀ`.
#[inline(always)]
pub(crate) fn apply<const N: usize>(
    inverse: &[f64],
    width: usize,
    x: &[[f64; N]],
    out: &mut [[f64; N]],
) {
    out.fill([0.0; N]);
    for (row, x) in inverse.chunks_exact(width).zip(x) {
        for (out, number) in out.iter_mut().zip(row) {
            add_lanes(out, *number, x);
        }
    }
}

/// `S⁻ᵀ x` of several right-hand sides, from `S⁻ᵀ`.
#[inline(always)]
pub(crate) fn apply_transposed<const N: usize>(
    inverse: &[f64],
    width: usize,
    x: &[[f64; N]],
    out: &mut [[f64; N]],
) {
    for (row, out) in inverse.chunks_exact(width).zip(out) {
        let mut sums = [0.0; N];
        for (number, x) in row.iter().zip(x) {
            add_lanes(&mut sums, *number, x);
        }
        *out = sums;
    }
}
