//! Elimination of an element's own strains, which no node shares.

use super::{Law, STRAINS, ShellPoint, WIDTH};

/// Share of a diagonal below which a pivot is rounding. A choice: some rounding units for the sums of an
/// element.
const ROUNDING: f64 = 1e-14;

/// Strains of the modes at a point.
pub(super) type Modes<const N: usize> = [[f64; N]; STRAINS];

/// Adds the modes with the amplitudes that minimise the energy. A mode without stiffness has no amplitude.
pub(super) fn condense<const N: usize>(points: &mut [ShellPoint], modes: &[Modes<N>]) {
    let mut own = [[0.0; N]; N];
    let mut coupling = [[0.0; WIDTH]; N];
    for (point, modes) in points.iter().zip(modes) {
        let Law(law) = &point.law;
        for a in 0..N {
            let mut forces = [0.0; STRAINS];
            for (modes, law) in modes.iter().zip(law) {
                for (force, c) in forces.iter_mut().zip(law) {
                    *force += point.area * modes[a] * c;
                }
            }
            for (strain, force) in forces.into_iter().enumerate() {
                if force == 0.0 {
                    continue;
                }
                for (sum, x) in own[a].iter_mut().zip(&modes[strain]) {
                    *sum += force * x;
                }
                for (sum, x) in coupling[a].iter_mut().zip(&point.rows[strain]) {
                    *sum += force * x;
                }
            }
        }
    }
    solve(&mut own, &mut coupling);
    for (point, modes) in points.iter_mut().zip(modes) {
        for (row, modes) in point.rows.iter_mut().zip(modes) {
            for (mode, amplitudes) in modes.iter().zip(&coupling) {
                if *mode == 0.0 {
                    continue;
                }
                for (x, amplitude) in row.iter_mut().zip(amplitudes) {
                    *x -= mode * amplitude;
                }
            }
        }
    }
}

/// Solves for all columns in place by elimination. Unknowns without stiffness are zero.
fn solve<const N: usize>(matrix: &mut [[f64; N]; N], columns: &mut [[f64; WIDTH]; N]) {
    let diagonal: [f64; N] = std::array::from_fn(|i| matrix[i][i]);
    let most = diagonal.iter().fold(0.0, |most: f64, x| most.max(*x));
    let mut solved = [false; N];
    for pivot in 0..N {
        let value = matrix[pivot][pivot];
        solved[pivot] = diagonal[pivot] > ROUNDING * most && value > ROUNDING * diagonal[pivot];
        if !solved[pivot] {
            continue;
        }
        let (row, column) = (matrix[pivot], columns[pivot]);
        for other in (0..N).filter(|other| *other != pivot) {
            let factor = matrix[other][pivot] / value;
            for (x, y) in matrix[other].iter_mut().zip(row) {
                *x -= factor * y;
            }
            for (x, y) in columns[other].iter_mut().zip(column) {
                *x -= factor * y;
            }
        }
    }
    for (i, line) in columns.iter_mut().enumerate() {
        let value = matrix[i][i];
        line.iter_mut().for_each(|x| match solved[i] {
            true => *x /= value,
            false => *x = 0.0,
        });
    }
}
