//! Spectra and orders of signals.

use super::PostError;
use super::evaluate::Evaluator;
use super::operation::{sampled_track, window_of};
use super::sampling::{Sampled, on};
use super::sampling_limits::{limit_text, speed_text};
use super::track::Track;
use eng_report::readable_unit;
use eng_report::signal::{
    Amplitude, Averaging, Axis, Level, OrderTrack, Run, RunUp, Sampling, Signal, Spectrum,
    SpectrumOptions, SweepMap, order_track, order_track_of_run_up, spectrum, sweep_map,
};
use eng_system::DisplayUnit;
use eng_system::expression::{Limit, Member, Window as Weight};
use eng_system::figure::{self as plan, SpectrumSettings};
use eng_system::system::Extent;
use std::f64::consts::TAU;

fn axis(axis: plan::Axis) -> Axis {
    match axis {
        plan::Axis::Frequency => Axis::Frequency,
        plan::Axis::Order => Axis::Order,
    }
}

/// A spectrum of amplitudes from zero to peak, in the display unit or in decibels over a reference, and the
/// mean speed of the shaft (rpm), if it has one. The last sample is left out: in whole cycles it is the first
/// sample of the next cycle. So one block of all samples is as long as the signal.
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
        // an amplitude is a difference, so the zero of the unit does not enter
        .map(|value| value / display.scale)
        .collect();
    // the conversion to the other axis needs a steady speed
    let other = matches!(
        (wanted, sampled.sampling),
        (Axis::Frequency, Sampling::Angle { .. }) | (Axis::Order, Sampling::Time { .. })
    );
    if other {
        track.steady_speed(&sampled)?;
    }
    let block_length = match settings.block {
        None => None,
        Some(stated) => {
            let steps = match (stated, sampled.sampling) {
                (Extent::Time(length), Sampling::Time { step }) => length / step,
                (Extent::Angle(length), Sampling::Angle { step }) => length.to_degrees() / step,
                (Extent::Time(length), Sampling::Angle { step }) => {
                    length * track.steady_speed(&sampled)? * 360.0 / step
                }
                (Extent::Angle(length), Sampling::Time { step }) => {
                    length / TAU / track.steady_speed(&sampled)? / step
                }
            };
            Some(track.block(&sampled, steps, stated)?)
        }
    };
    let options = SpectrumOptions {
        window: window_of(settings.window),
        block_length,
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
    let mut runs: Vec<(f64, Spectrum)> = Vec::with_capacity(members.len());
    let mut description = String::new();
    let mut names: Vec<&str> = Vec::new();
    for member in members {
        let track = evaluator.track(&member.expression)?;
        let (found, speed) = spectrum_of(&track, settings, display)?;
        let speed = speed.ok_or_else(|| PostError::NoSpeed(member.analysis.clone()))?;
        if description.is_empty() {
            description = found.description();
        }
        let speed = rounded_speed(speed);
        names.push(member.analysis.as_str());
        runs.push((speed, found));
        of_other_speeds(runs.iter().map(|run| run.0).zip(names.iter().copied()))?;
    }
    let map = sweep_map(&runs).map_err(|source| PostError::Signal {
        analysis: names.join(", "),
        source,
    })?;
    Ok((map, description))
}

/// A mean speed rounded to 0.01 rpm, so that rounding errors do not make two speeds of one.
fn rounded_speed(speed: f64) -> f64 {
    (speed * 100.0).round() / 100.0
}

/// Refuses a last run with the speed of an earlier run. `runs` has speed (rpm) and analysis of each run.
fn of_other_speeds<'n>(
    mut runs: impl DoubleEndedIterator<Item = (f64, &'n str)> + ExactSizeIterator,
) -> Result<(), PostError> {
    let Some((speed, second)) = runs.next_back() else {
        return Ok(());
    };
    match runs.find(|(known, _)| *known == speed) {
        Some((_, first)) => Err(PostError::SameSpeed {
            first: first.to_owned(),
            second: second.to_owned(),
            speed: speed_text(speed / 60.0),
        }),
        None => Ok(()),
    }
}

/// Orders of one channel over the speeds of its runs, in the order of the speeds.
pub(super) fn orders_of(
    tracks: &[Track],
    orders: &[f64],
    window: Weight,
) -> Result<OrderTrack, PostError> {
    let mut runs = Vec::with_capacity(tracks.len());
    let mut speeds: Vec<(f64, &str)> = Vec::with_capacity(tracks.len());
    for track in tracks {
        let sampled = sampled_track(track, Axis::Order)?;
        let speed = match sampled.sampling {
            Sampling::Angle { .. } => track.mean_speed(&sampled)?,
            Sampling::Time { .. } => track.steady_speed(&sampled)?,
        };
        speeds.push((rounded_speed(60.0 * speed), &track.samples.analysis));
        of_other_speeds(speeds.iter().copied())?;
        for order in orders {
            let place = match sampled.sampling {
                Sampling::Angle { .. } => *order,
                Sampling::Time { .. } => order * speed,
            };
            track.holds(&sampled, place, Limit::Order(*order))?;
            track.resolves(&sampled, place, limit_text(Limit::Order(*order)))?;
        }
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

/// Orders along one run whose speed changes.
pub(super) fn orders_along(
    track: &Track,
    orders: &[f64],
    window: Weight,
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
        .take(sampled.even)
        .map(|speed| speed.abs() * 60.0 / TAU)
        .collect();
    let block = Extent::Angle(revolutions * TAU);
    let length = track.block(&sampled, revolutions * 360.0 / step, block)?;
    for order in orders {
        track.holds(&sampled, *order, Limit::Order(*order))?;
        let of_block = Sampled {
            count: length,
            ..sampled
        };
        track.resolves(&of_block, *order, limit_text(Limit::Order(*order)))?;
    }
    let run = RunUp {
        values: track.values.get(..sampled.even).unwrap_or_default(),
        speeds: &speeds,
        step,
        revolutions,
        overlap,
    };
    order_track_of_run_up(run, orders, window_of(window)).map_err(|e| track.refused(e))
}
