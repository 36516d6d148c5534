//! Eight-node hexahedra with strains that differ from those of their shape functions: mean dilatation and
//! incompatible modes.
//!
//! In both the strain remains linear in the displacements of the nodes, ε = (B + C) u. B belongs to the shape
//! functions, and C is a correction, so that stiffness is ∫ (B + C)ᵀ D (B + C) dV and stresses are D (B + C)
//! u. C vanishes for displacements linear in space.

use super::elastic::{PlacedMaterial, PointLaw, dot, strain_of};
use super::rules::Table;
use super::solid::{Gradients, add_products, gradients, tangents};
use super::stress::Components;
use super::vector::determinant;
use crate::element::MOST_NODES;

/// Corners.
const NODES: usize = 8;
/// Displacements of the corners.
const FREEDOMS: usize = 3 * NODES;
/// Amplitudes of the incompatible modes.
const MODES: usize = 9;

/// Strain for a unit displacement of each corner along each axis (1/m).
pub(super) type StrainRows = [Components; FREEDOMS];

/// A point of the stiffness.
pub(super) struct EnhancedPoint {
    /// Gradients and Jacobian (m³) there.
    pub(super) gradients: Gradients,
    /// Weight times Jacobian (m³).
    pub(super) volume: f64,
    /// C.
    pub(super) correction: StrainRows,
    /// D.
    law: PointLaw,
}

/// The points of the stiffness with their corrections.
///
/// # Errors
/// The Jacobian (m³) if it is not positive.
pub(super) fn enhanced(
    table: &Table,
    places: &[[f64; 3]; MOST_NODES],
    material: PlacedMaterial<'_>,
) -> Result<Vec<EnhancedPoint>, f64> {
    let mut points = Vec::with_capacity(table.stiffness.len());
    for sample in &table.stiffness {
        let gradients = gradients(&sample.shape, places, NODES)?;
        points.push(EnhancedPoint {
            volume: sample.weight * gradients.jacobian,
            gradients,
            correction: [[0.0; 6]; FREEDOMS],
            law: material.law(&sample.shape, places, NODES),
        });
    }
    if let Some(correct) = table.form.correction() {
        correct(table, places, &mut points)?;
    }
    Ok(points)
}

/// ε + ⅓ (mean of tr ε over the element − tr ε) I: C = ⅓ (ḡ − g) on the normal strains, ḡ = ∫ g dV / V.
///
/// Abaqus Theory Guide 3.2.4 (its C3D8, to whose matrices this is equal in all digits).
///
/// # Errors
/// None.
pub(super) fn mean_dilatation(
    _: &Table,
    _: &[[f64; 3]; MOST_NODES],
    points: &mut [EnhancedPoint],
) -> Result<(), f64> {
    let volume: f64 = points.iter().map(|point| point.volume).sum();
    let mut mean = [[0.0; 3]; NODES];
    for point in points.iter() {
        for (mean, slope) in mean.iter_mut().zip(&point.gradients.slope) {
            for (x, s) in mean.iter_mut().zip(slope) {
                *x += point.volume / volume * s;
            }
        }
    }
    for point in points {
        let slopes = point.gradients.slope.iter().take(NODES).flatten();
        let rows = point.correction.iter_mut();
        for ((row, mean), slope) in rows.zip(mean.iter().flatten()).zip(slopes) {
            row[..3].fill((mean - slope) / 3.0);
        }
    }
    Ok(())
}

/// Displacements α_mk (1 − ξ_m²) e_k inside the element, m and k from 1 to 3. The amplitudes α have the
/// values of least energy: C = −G H⁻¹ L with the strains G of the modes, H = ∫ Gᵀ D G dV and L = ∫ Gᵀ D B dV.
///
/// The modes' gradients are −2 ξ_m ∂ξ_m/∂x at the middle times j₀/j, so that ∫ G dV vanishes and constant
/// strains are exact in elements of any shape (R. L. Taylor, P. J. Beresford, E. L. Wilson, Int. J. Num.
/// Meth. Eng. 10, 1976, 1211–1219). Bending of a parallelepiped is exact.
///
/// # Errors
/// None: the Jacobians of the points have been checked.
pub(super) fn incompatible(
    table: &Table,
    places: &[[f64; 3]; MOST_NODES],
    points: &mut [EnhancedPoint],
) -> Result<(), f64> {
    let Some(middle) = &table.corners else {
        return Ok(());
    };
    let rows = tangents(middle, places, NODES);
    let jacobian = determinant(&rows);
    let dual = super::solid::dual(&rows, jacobian);
    let modes: Vec<[Components; MODES]> = table
        .stiffness
        .iter()
        .zip(points.iter())
        .map(|(sample, point)| {
            let mut strains = [[0.0; 6]; MODES];
            for (mode, direction) in dual.iter().enumerate() {
                let slope = -2.0 * sample.at[mode] * jacobian / point.gradients.jacobian;
                for axis in 0..3 {
                    strains[3 * mode + axis] = strain_of(direction.map(|x| slope * x), axis);
                }
            }
            strains
        })
        .collect();
    let mut work = [[0.0; MODES + FREEDOMS]; MODES];
    for (modes, point) in modes.iter().zip(points.iter()) {
        let stresses = modes.map(|strain| point.law.stress(&strain).map(|x| point.volume * x));
        let plain = plain(point);
        for (line, stress) in work.iter_mut().zip(&stresses) {
            for (entry, strain) in line.iter_mut().zip(modes.iter().chain(&plain)) {
                *entry += dot(stress, strain);
            }
        }
    }
    eliminate(&mut work);
    for (modes, point) in modes.iter().zip(points) {
        for (line, strain) in work.iter().zip(modes) {
            for (row, x) in point.correction.iter_mut().zip(&line[MODES..]) {
                for (c, s) in row.iter_mut().zip(strain) {
                    *c -= x * s;
                }
            }
        }
    }
    Ok(())
}

/// B.
fn plain(point: &EnhancedPoint) -> StrainRows {
    let mut rows = [[0.0; 6]; FREEDOMS];
    for (freedom, row) in rows.iter_mut().enumerate() {
        *row = strain_of(point.gradients.slope[freedom / 3], freedom % 3);
    }
    rows
}

/// Solves H x = L in place by Gauss–Jordan elimination; H is positive definite.
fn eliminate(work: &mut [[f64; MODES + FREEDOMS]; MODES]) {
    for k in 0..MODES {
        let pivot = work[k];
        for (i, line) in work.iter_mut().enumerate() {
            if i == k {
                continue;
            }
            let factor = line[k] / pivot[k];
            for (x, p) in line.iter_mut().zip(&pivot) {
                *x -= factor * p;
            }
        }
    }
    for (k, line) in work.iter_mut().enumerate() {
        let pivot = line[k];
        for x in line.iter_mut() {
            *x /= pivot;
        }
    }
}

/// Adds ∫ (B + C)ᵀ D (B + C) dV (N/m) to zeroed blocks.
///
/// # Errors
/// Those of [`enhanced`].
pub(super) fn add_stiffness(
    table: &Table,
    places: &[[f64; 3]; MOST_NODES],
    material: PlacedMaterial<'_>,
    blocks: &mut [f64],
) -> Result<(), f64> {
    for point in enhanced(table, places, material)? {
        let mut rows = plain(&point);
        for (row, correction) in rows.iter_mut().zip(&point.correction) {
            for (x, c) in row.iter_mut().zip(correction) {
                *x += c;
            }
        }
        let stresses = rows.map(|row| point.law.stress(&row).map(|x| point.volume * x));
        add_products(&rows, &stresses, blocks);
    }
    Ok(())
}
