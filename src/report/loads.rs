//! The turning of pins in their shells, from the motion of the bodies.

use super::Entry;
use super::describe::MarkerAxes;
use crate::figures::TURN;
use crate::motion::{BodyMotion, moments};
use crate::results::{Column, Results, ResultsError, TIME};
use eng_runtime::rotation::{M3, matrix};
use eng_system::{Dimension, DisplayUnit};

/// Adds the angle by which each pin has turned in its shell, if the motion was kept and covers the samples.
/// Its frame is that of the pin, for loads in axes of the pin.
pub(super) fn add_turns(entry: &Entry, results: &mut Results) -> Result<(), ResultsError> {
    let (Some(time), Some(motion)) = (results.column(TIME), &entry.outcome.motion) else {
        return Ok(());
    };
    let time = time.values.clone();
    let journals = entry.described.machine.journals.iter();
    for (journal, axes) in journals.zip(&entry.described.axes) {
        if let Some(turn) = turn(motion, &axes.pin, &axes.shell, &time)? {
            results.push(Column {
                path: format!("{}.{TURN}", journal.path),
                dimension: Dimension::ANGLE,
                display: DisplayUnit::si(Dimension::ANGLE),
                frame: axes.pin.marker.clone(),
                values: turn.iter().map(|degrees| degrees.to_radians()).collect(),
            })?;
        }
    }
    Ok(())
}

/// Angle (°) from the shell's x axis to the pin's, about the shell's z, at each of `times` (s). It is unwrapped,
/// and linear between the samples of the motion. Deflections of flexible bodies turn their markers by less than
/// a degree and are left out. `None` if the motion has fewer than two samples or does not cover the times.
pub fn turn(
    motion: &Results,
    pin: &MarkerAxes,
    shell: &MarkerAxes,
    times: &[f64],
) -> Result<Option<Vec<f64>>, ResultsError> {
    let (moved, _) = moments(motion);
    let pin = orientations(motion, pin, moved.len())?;
    let shell = orientations(motion, shell, moved.len())?;
    let mut turned: Vec<f64> = Vec::with_capacity(moved.len());
    for (pin, shell) in pin.iter().zip(&shell) {
        // columns of a rotation matrix are the axes
        let along =
            |axis: usize| -> f64 { (0..3).map(|row| pin[3 * row] * shell[3 * row + axis]).sum() };
        let angle = libm::atan2(along(1), along(0)).to_degrees();
        let before = turned.last().copied().unwrap_or(angle);
        turned.push(angle + 360.0 * ((before - angle) / 360.0).round());
    }
    let ([first, second, ..], Some(last)) = (moved.as_slice(), moved.last()) else {
        return Ok(None);
    };
    // a thinned motion may begin within an interval after the cycle does
    let slack = second - first;
    let covered = |time: &f64| *time >= first - slack && *time <= last + 1e-9 * slack;
    if !times.iter().all(covered) {
        return Ok(None);
    }
    Ok(Some(
        times
            .iter()
            .map(|time| {
                let after = moved
                    .partition_point(|t| t < time)
                    .clamp(1, moved.len() - 1);
                let (from, to) = (moved[after - 1], moved[after]);
                let share = (time - from) / (to - from);
                turned[after - 1] + share * (turned[after] - turned[after - 1])
            })
            .collect(),
    ))
}

/// Rotation matrices marker → ground, row-major, at each sample of the motion.
fn orientations(
    motion: &Results,
    marker: &MarkerAxes,
    samples: usize,
) -> Result<Vec<[f64; 9]>, ResultsError> {
    let Some(body) = &marker.body else {
        return Ok(vec![marker.orientation; samples]);
    };
    let own = BodyMotion::of(motion, body)?;
    Ok(own
        .orientations
        .iter()
        .map(|q| {
            let turned = matrix(q) * M3::from_row_slice(&marker.orientation);
            std::array::from_fn(|i| turned[(i / 3, i % 3)])
        })
        .collect())
}
