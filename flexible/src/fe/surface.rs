//! Mass of surfaces without stiffness: consistent, without rotary inertia.

use super::rules::Table;
use super::solid::{Present, add_mass, tangents};
use super::vector::{cross, norm};
use crate::element::MOST_NODES;

/// Adds ∫ N_a N_b m dA to the masses of zeroed `blocks`, as [`super::solid::add_matrices`] does;
/// `mass_per_area` (kg/m²).
///
/// # Errors
/// The area per unit of the reference domain (m²) at the first point where it vanishes.
pub(super) fn add_matrices(
    table: &Table,
    present: &Present,
    places: &[[f64; 3]; MOST_NODES],
    mass_per_area: f64,
    blocks: &mut [f64],
) -> Result<(), f64> {
    let mut fault = None;
    add_mass(
        table,
        (present.count, 0),
        |sample| {
            let shape = present.shape(&sample.shape);
            let [r, s, _] = tangents(&shape, places, present.count);
            let area = norm(cross(r, s));
            if area.is_nan() || area <= 1e-12 * norm(r) * norm(s) {
                fault.get_or_insert(area);
            }
            (shape.values, mass_per_area * sample.weight * area)
        },
        blocks,
    );
    fault.map_or(Ok(()), Err)
}
