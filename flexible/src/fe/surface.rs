//! Mass of surfaces without stiffness: consistent, without rotary inertia. The area of surfaces.

use super::rules::Table;
use super::solid::{Present, add_mass, tangents};
use super::vector::{cross, norm, subtract};
use crate::element::{ElementKind, MOST_NODES, Shape};

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
            // the cross product of parallel tangents is rounding
            if area.is_nan() || area <= 1e-12 * norm(r) * norm(s) {
                fault.get_or_insert(area);
            }
            (shape.values, mass_per_area * sample.weight * area)
        },
        blocks,
    );
    fault.map_or(Ok(()), Err)
}

/// Area of a surface, or length of a line, between the places of its nodes (square of their unit, or their unit). Where a
/// mid-side node is left out, all sides are straight.
pub(crate) fn measure(kind: ElementKind, places: &[Option<[f64; 3]>]) -> f64 {
    let kind = if places.iter().all(Option::is_some) {
        kind
    } else {
        kind.linear()
    };
    let mut own = [[0.0; 3]; MOST_NODES];
    for (own, place) in own.iter_mut().zip(places) {
        *own = place.unwrap_or_default();
    }
    let count = kind.node_count();
    if let ElementKind::Beam2 = kind {
        let [a, b, ..] = own;
        return norm(subtract(b, a));
    }
    let points = (kind.description().mass)();
    let areas = points.into_iter().map(|point| {
        let [r, s, _] = tangents(&Shape::at(kind, point.at), &own, count);
        point.weight * norm(cross(r, s))
    });
    areas.sum()
}
