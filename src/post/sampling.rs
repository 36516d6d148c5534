//! The spacing of samples, and the axis of a spectrum.

use eng_report::signal::{Axis, Sampling, Spectrum};
use std::f64::consts::TAU;

/// Number of samples below which their spacing is not judged. A choice: of three samples two distances say
/// nothing.
pub(super) const FEWEST: usize = 4;
/// Largest distance of a spectrum's samples from their grid, as a share of the mean distance. A choice: its
/// error in the highest order is a ten-thousandth of half a turn.
const EVEN: f64 = 1e-4;

/// The spacing of samples, and the shaft's mean speed (1/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sampled {
    /// Even in angle or in time.
    pub sampling: Sampling,
    /// Number of evenly spaced samples: all, or all but the last if a run ends between two.
    pub even: usize,
    /// Number of these without the last one, which in whole cycles begins the next cycle.
    pub count: usize,
    /// Turns per second, if there is a cycle.
    pub speed: Option<f64>,
}

/// The spacing of samples: even in cycle angle (rad), otherwise in time (s). If an axis of frequencies is
/// `preferred`, the order is reversed. A run whose length is no whole number of samples has an irregular one at its
/// end, so the last sample may be uneven. `None` if the others are uneven, too.
pub(super) fn sampled(time: &[f64], angle: Option<&[f64]>, preferred: Axis) -> Option<Sampled> {
    all_sampled(time, angle, preferred).or_else(|| {
        let even = time.len().checked_sub(1).filter(|n| *n >= FEWEST)?;
        let but_last = angle.and_then(|angle| angle.get(..even));
        let found = all_sampled(time.get(..even)?, but_last, preferred)?;
        let along = match found.sampling {
            Sampling::Angle { .. } => angle?,
            Sampling::Time { .. } => time,
        };
        // a larger distance would be a gap, not an end
        ends_early(along).then_some(found)
    })
}

/// Whether the last interval is shorter than the one before.
fn ends_early(values: &[f64]) -> bool {
    match values {
        [.., a, b, c] => (c - b).abs() < (b - a).abs(),
        _ => false,
    }
}

/// See [`sampled`].
fn all_sampled(time: &[f64], angle: Option<&[f64]>, preferred: Axis) -> Option<Sampled> {
    let duration = time.last()? - time.first()?;
    let turned = angle.and_then(|a| Some(a.last()? - a.first()?));
    let speed = turned.map(|turned| turned / duration / TAU);
    let count = time.len().checked_sub(1)?;
    let by_angle = angle
        .and_then(even_step)
        // the angle may increase or decrease
        .map(|step| Sampling::Angle {
            step: step.abs().to_degrees(),
        });
    let by_time = even_step(time).map(|step| Sampling::Time { step });
    let sampling = match preferred {
        Axis::Order => by_angle.or(by_time)?,
        Axis::Frequency => by_time.or(by_angle)?,
    };
    Some(Sampled {
        sampling,
        even: time.len(),
        count,
        speed,
    })
}

/// Distance of evenly spaced values.
fn even_step(values: &[f64]) -> Option<f64> {
    let (first, last) = (values.first()?, values.last()?);
    let step = (last - first) / (values.len().checked_sub(1).filter(|n| *n > 2)? as f64);
    let even = values
        .iter()
        .zip(values.iter().skip(1))
        .all(|(before, after)| (after - before - step).abs() <= EVEN * step.abs());
    (even && step != 0.0).then_some(step)
}

/// A spectrum on another axis, by the shaft's mean speed (1/s).
pub(super) fn on(axis: Axis, spectrum: &Spectrum, speed: Option<f64>) -> Option<Spectrum> {
    let speed = speed.map(f64::abs).filter(|s| s.is_finite() && *s > 0.0);
    match (spectrum.axis, axis) {
        (Axis::Order, Axis::Frequency) => Some(Spectrum {
            axis,
            step: spectrum.step * speed?,
            ..spectrum.clone()
        }),
        (Axis::Frequency, Axis::Order) => spectrum.clone().in_orders(60.0 * speed?).ok(),
        _ => Some(spectrum.clone()),
    }
}
