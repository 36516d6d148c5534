//! Rigid elements written as equations: those whose six independent freedoms are shared among several grid points
//! (`RBAR`, `RBE1`, `RTRPLT`), and the rod with pinned ends (`RROD`).
//!
//! All points move with one rigid body: the translation along e of a point at d from the origin is e·u + (d ×
//! e)·θ, its rotation about e is e·θ. The six independent freedoms give u and θ, and u and θ give every
//! dependent freedom.

use super::vector::{IDENTITY, norm};
use crate::fe::vector::{cross, dot, subtract};
use crate::mesh::{Frame, Node};

/// A freedom 0…5 of a node.
pub(super) type Freedom = (u32, u8);

/// Coefficients of each dependent freedom in the independent ones: `u_d = Σ c u_i`, a row for each dependent.
/// `None` if the independent freedoms leave a rigid motion free. Translations and rotations keep their units:
/// metres and radians in SI.
pub(super) fn dependence(
    independent: &[Freedom; 6],
    dependent: &[Freedom],
    nodes: &[Node],
    frames: &[Frame],
) -> Option<Vec<[f64; 6]>> {
    let origin = nodes.get(independent[0].0 as usize)?.position;
    let mut length = 0.0_f64;
    for (node, _) in independent.iter().chain(dependent) {
        length = length.max(norm(subtract(nodes.get(*node as usize)?.position, origin)));
    }
    if length == 0.0 {
        length = 1.0;
    }
    let row = |(node, freedom): Freedom| -> Option<[f64; 6]> {
        let node = nodes.get(node as usize)?;
        let [x, y, z] = direction(node, freedom, frames);
        if freedom >= 3 {
            return Some([0.0, 0.0, 0.0, x, y, z]);
        }
        let arm = subtract(node.position, origin).map(|d| d / length);
        let [a, b, c] = cross(arm, [x, y, z]);
        Some([x, y, z, a, b, c])
    };
    // rotations count times the length, so that all entries are of order 1
    let scale = |(_, freedom): Freedom| if freedom < 3 { 1.0 } else { length };
    let mut matrix = [[0.0; 6]; 6];
    for (j, freedom) in independent.iter().enumerate() {
        for (line, value) in matrix.iter_mut().zip(row(*freedom)?) {
            line[j] = value;
        }
    }
    dependent
        .iter()
        .map(|freedom| {
            let mut solution = solve(matrix, row(*freedom)?)?;
            for (value, given) in solution.iter_mut().zip(independent) {
                // rounding of a solution of order one
                *value = if value.abs() < 1e-12 {
                    0.0
                } else {
                    *value * scale(*given) / scale(*freedom)
                };
            }
            Some(solution)
        })
        .collect()
}

/// The axis of a freedom 0…5 of a node, in basic axes.
pub(super) fn direction(node: &Node, freedom: u8, frames: &[Frame]) -> [f64; 3] {
    let rotation = (node.frame)
        .and_then(|frame| frames.get(frame as usize))
        .map_or(IDENTITY, |frame| frame.rotation);
    let axis = usize::from(freedom % 3);
    rotation.map(|row| row.get(axis).copied().unwrap_or(0.0))
}

/// The least share of a translation along a rod for which the length of the rod decides it. Below it, small motions of
/// the other end would move this end by more than a thousand times as much.
const ALONG: f64 = 1e-3;

/// The equation n·(u_b − u_a) = 0 of a rod with pinned ends, n along it. Its first term is the dependent translation
/// (`dependent`: end 0 or 1, direction 0…2). Terms are node, freedom and coefficient, without those that are zero.
/// `None` if the ends are at one place, or if the dependent translation is perpendicular to the rod.
pub(super) fn rod(
    ends: [u32; 2],
    dependent: (usize, u8),
    nodes: &[Node],
    frames: &[Frame],
) -> Option<Vec<(u32, u8, f64)>> {
    let [a, b] = ends.map(|node| nodes.get(node as usize));
    let (a, b) = (a?, b?);
    let along = subtract(b.position, a.position);
    let length = norm(along);
    if length == 0.0 {
        return None;
    }
    let mut terms = Vec::new();
    for (end, (node, sign)) in [(a, -1.0), (b, 1.0)].into_iter().enumerate() {
        for freedom in 0..3 {
            let axis = direction(node, freedom, frames);
            let share = dot(axis, along) / length;
            if (end, freedom) == dependent {
                if share.abs() < ALONG {
                    return None;
                }
                terms.insert(0, (*ends.get(end)?, freedom, sign * share));
            // rounding of cosines
            } else if share.abs() >= 1e-12 {
                terms.push((*ends.get(end)?, freedom, sign * share));
            }
        }
    }
    Some(terms)
}

/// Solves `matrix · x = right` by elimination with row exchange; `None` if it is singular (entries are of
/// order 1).
pub(super) fn solve(mut matrix: [[f64; 6]; 6], mut right: [f64; 6]) -> Option<[f64; 6]> {
    for k in 0..6 {
        let pivot = (k..6).max_by(|i, j| matrix[*i][k].abs().total_cmp(&matrix[*j][k].abs()))?;
        // a choice above the rounding of a matrix of order one: its freedoms do not determine the motion
        if matrix[pivot][k].abs() < 1e-10 {
            return None;
        }
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        let (pivot_row, pivot_right) = (matrix[k], right[k]);
        for (i, (row, value)) in matrix.iter_mut().zip(&mut right).enumerate() {
            if i == k {
                continue;
            }
            let factor = row[k] / pivot_row[k];
            for (entry, above) in row.iter_mut().zip(pivot_row) {
                *entry -= factor * above;
            }
            *value -= factor * pivot_right;
        }
    }
    for k in 0..6 {
        right[k] /= matrix[k][k];
    }
    Some(right)
}
