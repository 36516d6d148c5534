//! Spectra and orders of signals.

use super::PostError;
use super::evaluate::{Evaluator, sampled_track, window_of};
use super::sampling::{Sampled, on};
use super::track::Track;
use eng_report::readable_unit;
use eng_report::signal::{
    Amplitude, Averaging, Axis, Level, OrderTrack, Run, RunUp, Sampling, Signal, Spectrum,
    SpectrumOptions, SweepMap, order_track, order_track_of_run_up, spectrum, sweep_map,
};
use eng_system::DisplayUnit;
use eng_system::report::{self as plan, Member, SpectrumSettings};
use eng_system::system::Extent;
use std::f64::consts::TAU;

fn axis(axis: plan::Axis) -> Axis {
    match axis {
        plan::Axis::Frequency => Axis::Frequency,
        plan::Axis::Order => Axis::Order,
    }
}

/// Turns a second of a signal's shaft, above zero.
fn speed_of(sampled: &Sampled, track: &Track) -> Result<f64, PostError> {
    sampled
        .speed
        .map(f64::abs)
        .filter(|speed| *speed > 0.0 && speed.is_finite())
        .ok_or_else(|| PostError::NoSpeed(track.samples.analysis.clone()))
}

/// A spectrum, 0-peak, in the display unit or in decibels over a reference, with the shaft's mean speed (1/min) where there is
/// one. The last sample is left out: of whole cycles it is the first of the next, and one block of all is then as long as the signal.
pub(super) fn spectrum_of(
    track: &Track,
    settings: &SpectrumSettings,
    display: &DisplayUnit,
) -> Result<(Spectrum, Option<f64>), PostError> {
    let wanted = axis(settings.axis);
    let sampled = sampled_track(track, wanted)?;
    let values: Vec<f64> = track
        .values
        .iter()
        .take(sampled.count)
        // the zero of a shifted unit is no part of an amplitude
        .map(|value| value / display.scale)
        .collect();
    let block_length = match (settings.block, sampled.sampling) {
        (None, _) => None,
        (Some(Extent::Time(length)), Sampling::Time { step }) => Some(length / step),
        (Some(Extent::Angle(length)), Sampling::Angle { step }) => Some(length.to_degrees() / step),
        (Some(Extent::Time(length)), Sampling::Angle { step }) => {
            Some(length * speed_of(&sampled, track)? * 360.0 / step)
        }
        (Some(Extent::Angle(length)), Sampling::Time { step }) => {
            Some(length / TAU / speed_of(&sampled, track)? / step)
        }
    };
    let options = SpectrumOptions {
        window: window_of(settings.window),
        block_length: block_length.map(|length| length.round() as usize),
        overlap: settings.overlap,
        averaging: match settings.averaging {
            plan::Averaging::Linear => Averaging::Linear,
            plan::Averaging::RootMeanSquare => Averaging::RootMeanSquare,
            plan::Averaging::Peak => Averaging::Peak,
        },
        amplitude: Amplitude::ZeroToPeak,
        remove_mean: settings.remove_mean,
    };
    let signal = Signal {
        values: &values,
        sampling: sampled.sampling,
    };
    let found = spectrum(signal, options).map_err(|e| track.refused(e))?;
    let speed = sampled.speed.map(f64::abs);
    let mut found = on(wanted, &found, speed)
        .ok_or_else(|| PostError::NoSpeed(track.samples.analysis.clone()))?;
    if let Some(reference) = settings.reference {
        let level = Level::new(reference / display.scale, readable_unit(&display.symbol))
            .map_err(|e| track.refused(e))?;
        found.amplitudes.iter_mut().for_each(|a| *a = level.of(*a));
    }
    Ok((found, speed.map(|speed| 60.0 * speed)))
}

/// Spectra over the speeds of their runs.
pub(super) fn map_of(
    members: &[Member],
    settings: &SpectrumSettings,
    display: &DisplayUnit,
    evaluator: &Evaluator<'_>,
) -> Result<(SweepMap, String), PostError> {
    let mut runs = Vec::with_capacity(members.len());
    let mut description = String::new();
    let mut names = Vec::new();
    for member in members {
        let track = evaluator.track(&member.expression)?;
        let (found, speed) = spectrum_of(&track, settings, display)?;
        let speed = speed.ok_or_else(|| PostError::NoSpeed(member.analysis.clone()))?;
        if description.is_empty() {
            description = found.description();
        }
        names.push(member.analysis.as_str());
        // a shaft's mean speed is told to a hundredth, whatever rounding makes of it
        runs.push(((speed * 100.0).round() / 100.0, found));
    }
    let map = sweep_map(&runs).map_err(|source| PostError::Signal {
        analysis: names.join(", "),
        source,
    })?;
    Ok((map, description))
}

/// Orders of one channel over the speeds of its runs, in the order of the speeds.
pub(super) fn orders_of(
    tracks: &[Track],
    orders: &[f64],
    window: plan::Window,
) -> Result<OrderTrack, PostError> {
    let mut runs = Vec::with_capacity(tracks.len());
    for track in tracks {
        let sampled = sampled_track(track, Axis::Order)?;
        let speed = speed_of(&sampled, track)?;
        runs.push(Run {
            speed: 60.0 * speed,
            signal: Signal {
                values: track.values.get(..sampled.count).unwrap_or_default(),
                sampling: sampled.sampling,
            },
        });
    }
    runs.sort_by(|a, b| a.speed.total_cmp(&b.speed));
    order_track(&runs, orders, window_of(window)).map_err(|source| PostError::Signal {
        analysis: tracks
            .first()
            .map(|track| track.samples.analysis.clone())
            .unwrap_or_default(),
        source,
    })
}

/// Orders along one run of changing speed.
pub(super) fn orders_along(
    track: &Track,
    orders: &[f64],
    window: plan::Window,
    (revolutions, overlap): (f64, f64),
) -> Result<OrderTrack, PostError> {
    let sampled = sampled_track(track, Axis::Order)?;
    let uneven = || PostError::Uneven(track.samples.analysis.clone());
    let Sampling::Angle { step } = sampled.sampling else {
        return Err(uneven());
    };
    let speeds: Vec<f64> = track
        .samples
        .speed
        .as_ref()
        .ok_or_else(uneven)?
        .iter()
        .map(|speed| speed.abs() * 60.0 / TAU)
        .collect();
    let run = RunUp {
        values: &track.values,
        speeds: &speeds,
        step,
        revolutions,
        overlap,
    };
    order_track_of_run_up(run, orders, window_of(window)).map_err(|e| track.refused(e))
}
