//! Eccentricities of films, and their rates.

use crate::assembly::rows::{self, Preference};
use crate::chain::{self, MarkerKinematics};
use crate::model::Model;
use crate::rotation::V3;
use crate::state::State;
use nalgebra::DMatrix;

/// First velocity of a marker's body, and J of the marker (6 × width); `None` on ground.
pub(super) fn marker_jacobian(
    model: &Model,
    marker: usize,
    state: &State,
) -> Option<(usize, DMatrix<f64>)> {
    let body = &model.bodies[model.markers[marker].body?];
    let width = body.width();
    let mut jacobian = vec![0.0; 6 * width];
    chain::jacobian(
        body,
        &body.frame(&state.pose),
        &model.markers[marker],
        &mut jacobian,
    );
    Some((body.velocity, DMatrix::from_row_slice(6, width, &jacobian)))
}

/// Markers of a journal: pin and shell.
pub fn pin_and_shell(model: &Model, journal: usize) -> Option<(usize, usize)> {
    let info = model.compiled.system.journals.get(journal)?;
    let markers = &model.elements.get(info.element as usize)?.markers;
    Some((
        *markers.get(info.pin as usize)?,
        *markers.get(info.shell as usize)?,
    ))
}

/// The origin of a pin from its shell's, in the shell's axes (m).
fn arm(pin: &MarkerKinematics, shell: &MarkerKinematics) -> V3 {
    shell.rotation.transpose() * (pin.position - shell.position)
}

/// Each pin with its shell at a state.
fn placed(
    model: &Model,
    pins: &[Preference],
    pose: &[f64],
    velocity: &[f64],
) -> impl Iterator<Item = [MarkerKinematics; 2]> {
    let of = move |marker| rows::marker(model, marker, pose, velocity);
    pins.iter()
        .map(move |preference| [of(preference.pin), of(preference.shell)])
}

/// Eccentricities of pins, seen from their shells: x and y of each (m).
pub(super) fn places_of_pins(model: &Model, pins: &[Preference], pose: &[f64]) -> Vec<f64> {
    let rest = vec![0.0; model.velocities];
    let arms = placed(model, pins, pose, &rest).map(|[pin, shell]| arm(&pin, &shell));
    arms.flat_map(|arm| [arm.x, arm.y]).collect()
}

/// Rates of the eccentricities of pins, seen from their shells: x and y of each (m/s).
pub(super) fn rates_of_eccentricities(
    model: &Model,
    pins: &[Preference],
    pose: &[f64],
    velocity: &[f64],
) -> Vec<f64> {
    let rates = placed(model, pins, pose, velocity).map(|[pin, shell]| {
        let back = shell.rotation.transpose();
        let arm = arm(&pin, &shell);
        back * (pin.velocity - shell.velocity) - shell.angular_velocity.cross(&arm)
    });
    rates.flat_map(|rate| [rate.x, rate.y]).collect()
}

/// Rates of the axes of pins, seen from their shells: x and y of each (1/s).
pub(super) fn rates_of_axes(
    model: &Model,
    pins: &[Preference],
    pose: &[f64],
    velocity: &[f64],
) -> Vec<f64> {
    let rates = placed(model, pins, pose, velocity).map(|[pin, shell]| {
        // angular velocities are along the axes of their markers
        let turning = pin.rotation * pin.angular_velocity - shell.rotation * shell.angular_velocity;
        let axis: V3 = pin.rotation.column(2).into();
        shell.rotation.transpose() * turning.cross(&axis)
    });
    rates.flat_map(|rate| [rate.x, rate.y]).collect()
}

/// Derivative of [`rates_of_axes`] with respect to velocities: two rows (x, y) for each pin. In 1/s over the
/// velocities (SI).
pub(super) fn axis_rates(model: &Model, pins: &[Preference], state: &State) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(2 * pins.len(), model.velocities);
    let placed = placed(model, pins, &state.pose, &state.velocity);
    for (i, (preference, [pin, shell])) in pins.iter().zip(placed).enumerate() {
        let axis: V3 = pin.rotation.column(2).into();
        let sides = [
            (preference.pin, 1.0, &pin),
            (preference.shell, -1.0, &shell),
        ];
        for (marker, sign, own) in sides {
            let Some((first, jacobian)) = marker_jacobian(model, marker, state) else {
                continue;
            };
            for w in 0..jacobian.ncols() {
                let turning = V3::new(jacobian[(3, w)], jacobian[(4, w)], jacobian[(5, w)]);
                let turning = own.rotation * turning;
                let rate = shell.rotation.transpose() * turning.cross(&axis);
                matrix[(2 * i, first + w)] += sign * rate.x;
                matrix[(2 * i + 1, first + w)] += sign * rate.y;
            }
        }
    }
    matrix
}

/// Derivative of the eccentricity rates of pins (seen from their shells) with respect to velocities: two rows
/// (x, y) for each pin.
pub(super) fn eccentricity_rates(
    model: &Model,
    pins: &[Preference],
    state: &State,
) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(2 * pins.len(), model.velocities);
    let placed = placed(model, pins, &state.pose, &state.velocity);
    for (i, (preference, [pin, shell])) in pins.iter().zip(placed).enumerate() {
        let back = shell.rotation.transpose();
        let arm = arm(&pin, &shell);
        for (marker, of_shell) in [(preference.pin, false), (preference.shell, true)] {
            let Some((first, jacobian)) = marker_jacobian(model, marker, state) else {
                continue;
            };
            for w in 0..jacobian.ncols() {
                let part = |from: usize| {
                    V3::new(
                        jacobian[(from, w)],
                        jacobian[(from + 1, w)],
                        jacobian[(from + 2, w)],
                    )
                };
                let velocity = back * part(0);
                let rate = if of_shell {
                    -velocity - part(3).cross(&arm)
                } else {
                    velocity
                };
                matrix[(2 * i, first + w)] += rate.x;
                matrix[(2 * i + 1, first + w)] += rate.y;
            }
        }
    }
    matrix
}

/// e of every journal (m): the pin's origin from the shell's, along the shell's x and y.
pub fn eccentricities(model: &Model, pose: &[f64]) -> Vec<[f64; 2]> {
    let rest = vec![0.0; model.velocities];
    let of = |marker| rows::marker(model, marker, pose, &rest);
    let journals = 0..model.compiled.system.journals.len();
    journals
        .map(|journal| match pin_and_shell(model, journal) {
            Some((pin, shell)) => {
                let arm = arm(&of(pin), &of(shell));
                [arm.x, arm.y]
            }
            None => [0.0; 2],
        })
        .collect()
}

/// Whether the pin of each journal may leave the circle of its clearance, because its field yields.
pub fn yielding(model: &Model) -> Vec<bool> {
    let journals = model.compiled.system.journals.iter();
    journals
        .map(|journal| {
            let kernels = model.kernels.get(journal.element as usize);
            kernels.is_some_and(|kernels| kernels.iter().any(|kernel| kernel.yields()))
        })
        .collect()
}

/// Half of the width of every journal's film (m); zero of a law without a field, which does not see a tilt.
pub(super) fn half_widths(model: &Model) -> Vec<f64> {
    let journals = model.compiled.system.journals.iter();
    let half = |element: usize| {
        let grid = model.kernels.get(element)?.first()?.grid();
        Some((grid.across.last()? - grid.across.first()?) / 2.0)
    };
    journals
        .map(|journal| half(journal.element as usize).unwrap_or(0.0))
        .collect()
}

/// The largest distance of a pin's axis from that of its shell over the width of the film, over c, of every journal. The
/// film has half of this width on both sides of the shell's origin.
pub(super) fn end_ratios(model: &Model, half_widths: &[f64], pose: &[f64]) -> Vec<f64> {
    let rest = vec![0.0; model.velocities];
    let of = |marker| rows::marker(model, marker, pose, &rest);
    let journals = model.compiled.system.journals.iter().zip(half_widths);
    journals
        .enumerate()
        .map(|(at, (journal, half))| {
            let Some((pin, shell)) = pin_and_shell(model, at) else {
                return 0.0;
            };
            let (pin, shell) = (of(pin), of(shell));
            let arm = arm(&pin, &shell);
            let axis: V3 = shell.rotation.transpose() * V3::from(pin.rotation.column(2));
            let at_end = |z: f64| {
                let along = if axis.z == 0.0 {
                    0.0
                } else {
                    (z - arm.z) / axis.z
                };
                libm::hypot(arm.x + along * axis.x, arm.y + along * axis.y)
            };
            let distance = match *half {
                0.0 => libm::hypot(arm.x, arm.y),
                half => at_end(half).max(at_end(-half)),
            };
            distance / model.slot(journal.clearance)
        })
        .collect()
}

/// |e|/c of every journal. Dimensionless.
pub fn film_ratios(model: &Model, pose: &[f64]) -> Vec<f64> {
    model
        .compiled
        .system
        .journals
        .iter()
        .zip(eccentricities(model, pose))
        .map(|(journal, [x, y])| libm::hypot(x, y) / model.slot(journal.clearance))
        .collect()
}
