//! Operations on signals: filters, amplitudes, other samples, and numbers of a signal.

use super::PostError;
use super::sampling::{FEWEST, Sampled, sampled};
use super::sampling_limits::limit_text;
use super::track::Track;
use crate::tables::mean;
use eng_report::signal::{
    Axis, Band, Component, Ends, Extreme, Filter, Interpolation, Sampling, Signal, Slope, Window,
    component, maximum_at, minimum, resample,
};
use eng_system::expression::{self as plan, Limit, Reduction};
use eng_system::system::Extent;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Largest distance of the number of samples in a cycle from a whole number. A choice above the rounding of a
/// stated distance.
const WHOLE: f64 = 1e-3;

/// The sampling of a signal.
pub(super) fn sampled_track(track: &Track, preferred: Axis) -> Result<Sampled, PostError> {
    let samples = &track.samples;
    if samples.time.len() < FEWEST {
        return Err(PostError::Few {
            analysis: samples.analysis.clone(),
            count: samples.time.len(),
        });
    }
    sampled(&samples.time, samples.angle.as_deref(), preferred)
        .ok_or_else(|| PostError::Uneven(samples.analysis.clone()))
}

/// A limit on the axis of the samples (Hz or orders). The mean speed converts it from the other axis. A limit
/// above half the sampling rate is refused.
fn counted(limit: Limit, sampled: &Sampled, track: &Track) -> Result<f64, PostError> {
    let place = match (limit, sampled.sampling) {
        (Limit::Frequency(hertz), Sampling::Time { .. }) => hertz,
        (Limit::Order(order), Sampling::Angle { .. }) => order,
        (Limit::Frequency(hertz), Sampling::Angle { .. }) => hertz / track.steady_speed(sampled)?,
        (Limit::Order(order), Sampling::Time { .. }) => order * track.steady_speed(sampled)?,
    };
    track.holds(sampled, place, limit)?;
    Ok(place)
}

fn axis_of(limit: Limit) -> Axis {
    match limit {
        Limit::Frequency(_) => Axis::Frequency,
        Limit::Order(_) => Axis::Order,
    }
}

/// Number of samples in a cycle, if it is a whole number.
fn period_of(sampled: &Sampled, track: &Track) -> Option<usize> {
    let period = track.samples.period?;
    let count = match sampled.sampling {
        Sampling::Angle { step } => period.to_degrees() / step,
        Sampling::Time { step } => period / TAU / sampled.speed?.abs() / step,
    };
    let whole = count.round();
    ((count - whole).abs() <= WHOLE && (1.0..1e9).contains(&whole)).then_some(whole as usize)
}

/// A filter for a signal, and the sampling of the signal.
pub(super) fn filter_of(
    filter: &plan::Filter,
    track: &Track,
) -> Result<Option<(Filter, Sampled)>, PostError> {
    let Some(one) = filter.from.or(filter.to) else {
        return Ok(None);
    };
    let sampled = sampled_track(track, axis_of(one))?;
    let count = |limit: Option<Limit>| {
        limit
            .map(|limit| counted(limit, &sampled, track))
            .transpose()
    };
    let (from, to) = (count(filter.from)?, count(filter.to)?);
    if !track.samples.whole {
        for (stated, place) in [(filter.from, from), (filter.to, to)] {
            if let (Some(stated), Some(place)) = (stated, place) {
                track.resolves(&sampled, place, limit_text(stated))?;
            }
        }
        if let (Some(low), Some(high), Some(from), Some(to)) = (filter.from, filter.to, from, to) {
            let width = format!("the width from {} to {}", limit_text(low), limit_text(high));
            track.resolves(&sampled, to - from, width)?;
        }
    }
    let band = match (from, to) {
        (Some(from), Some(to)) => Band::Between { from, to },
        (Some(from), None) => Band::High { from },
        (None, Some(to)) => Band::Low { to },
        (None, None) => return Ok(None),
    };
    let made = Filter {
        band,
        slope: match filter.butterworth {
            Some(order) => Slope::Butterworth { order },
            None => Slope::BrickWall,
        },
        ends: if track.samples.whole {
            Ends::Periodic
        } else {
            Ends::Continued {
                period: period_of(&sampled, track),
            }
        },
    };
    Ok(Some((made, sampled)))
}

pub(super) fn filtered(filter: &plan::Filter, mut track: Track) -> Result<Track, PostError> {
    if let Some((made, sampled)) = filter_of(filter, &track)? {
        track = track.first(sampled.even);
        let signal = Signal {
            values: &track.values,
            sampling: sampled.sampling,
        };
        track.values = made.apply(signal).map_err(|e| track.refused(e))?;
    }
    Ok(track)
}

/// The first signal at the samples of the second, over crank angle if both have one, otherwise over time. The
/// samples of the second must lie within those of the first.
pub(super) fn resampled(track: &Track, like: &Track) -> Result<Track, PostError> {
    let (from, to, extent): (_, _, fn(f64) -> Extent) =
        match (&track.samples.angle, &like.samples.angle) {
            (Some(from), Some(to)) => (from, to, Extent::Angle),
            _ => (&track.samples.time, &like.samples.time, Extent::Time),
        };
    let ends = |values: &[f64]| Some((*values.first()?, *values.last()?));
    let (own, asked) = (ends(from), ends(to));
    if let (Some(own), Some(asked)) = (own, asked) {
        let (low, high) = (own.0.min(own.1), own.0.max(own.1));
        // times of two runs differ by rounding
        let slack = 1e-9 * (high - low);
        let within = |place: f64| place >= low - slack && place <= high + slack;
        if !(within(asked.0) && within(asked.1)) {
            let text = |place: f64| match extent(place.abs()) {
                Extent::Angle(_) => format!("{:.6} deg", place.to_degrees()),
                Extent::Time(_) => format!("{place:.6} s"),
            };
            return Err(PostError::Outside {
                analysis: track.samples.analysis.clone(),
                other: like.samples.analysis.clone(),
                own: format!("{} to {}", text(own.0), text(own.1)),
                asked: format!("{} to {}", text(asked.0), text(asked.1)),
            });
        }
    }
    // the angle may increase or decrease
    let sense = match own {
        Some((first, last)) if last < first => -1.0,
        _ => 1.0,
    };
    let along = |values: &[f64]| values.iter().map(|x| sense * x).collect::<Vec<f64>>();
    let values = resample(
        &along(from),
        &track.values,
        &along(to),
        Interpolation::Cubic,
    )
    .map_err(|e| track.refused(e))?;
    Ok(Track {
        samples: Rc::clone(&like.samples),
        values,
    })
}

/// A sinusoid of a signal. The mean is removed as in a spectrum. The last sample is left out, because in whole cycles it is
/// the first of the next cycle.
pub(super) fn component_of(
    limit: Limit,
    window: plan::Window,
    track: &Track,
) -> Result<Component, PostError> {
    let sampled = sampled_track(track, axis_of(limit))?;
    let place = counted(limit, &sampled, track)?;
    track.resolves(&sampled, place, limit_text(limit))?;
    let cycles = match sampled.sampling {
        Sampling::Time { step } => place * step,
        Sampling::Angle { step } => place * step / 360.0,
    };
    let values = track.values.get(..sampled.count).unwrap_or_default();
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let values: Vec<f64> = values.iter().map(|x| x - mean).collect();
    component(&values, cycles, window_of(window)).map_err(|e| track.refused(e))
}

pub(super) fn window_of(window: plan::Window) -> Window {
    match window {
        plan::Window::Rectangular => Window::Rectangular,
        plan::Window::Hann => Window::Hann,
        plan::Window::FlatTop => Window::FlatTop,
        plan::Window::BlackmanHarris => Window::BlackmanHarris,
    }
}

/// A number of a signal. Extremes are those of the samples, their places those of the parabola through the
/// extreme sample and its neighbours. Mean and root mean square are over time by the trapezoidal rule: (∫y
/// dt/T), √(∫y² dt/T). For a smooth signal over whole cycles, evenly sampled, the error of this rule vanishes
/// faster than any power of the step.
pub(super) fn reduced(reduction: Reduction, track: &Track) -> Result<f64, PostError> {
    let values = &track.values;
    let analysis = || track.samples.analysis.clone();
    if values.is_empty() {
        return Err(PostError::Short {
            analysis: analysis(),
            part: "sample".to_owned(),
        });
    }
    if let Some(at) = values.iter().position(|v| !v.is_finite()) {
        return Err(PostError::NotFinite(format!(
            "{}: sample {}",
            analysis(),
            at + 1
        )));
    }
    let smallest = || values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = || values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match reduction {
        Reduction::Minimum => Ok(smallest()),
        Reduction::Maximum => Ok(largest()),
        Reduction::PeakToPeak => Ok(largest() - smallest()),
        Reduction::Mean => Ok(mean(&track.samples.time, values)),
        Reduction::RootMeanSquare => {
            let squares: Vec<f64> = values.iter().map(|v| v * v).collect();
            Ok(mean(&track.samples.time, &squares).sqrt())
        }
        Reduction::MinimumAt(by_time) | Reduction::MaximumAt(by_time) => {
            Ok(found_at(reduction, by_time, track)?.position)
        }
    }
}

/// The least or largest value of a signal with its place over time, or over the cycle angle if there is one.
pub(super) fn found_at(
    reduction: Reduction,
    by_time: bool,
    track: &Track,
) -> Result<Extreme, PostError> {
    let place = match (&track.samples.angle, by_time) {
        (Some(angle), false) => angle,
        _ => &track.samples.time,
    };
    // the angle may increase or decrease
    let sense = match (place.first(), place.last()) {
        (Some(first), Some(last)) if last < first => -1.0,
        _ => 1.0,
    };
    let along: Vec<f64> = place.iter().map(|x| sense * x).collect();
    let found = match reduction {
        Reduction::MinimumAt(_) => minimum(&along, &track.values),
        _ => maximum_at(&along, &track.values),
    };
    let found = found.map_err(|e| track.refused(e))?;
    Ok(Extreme {
        position: sense * found.position,
        ..found
    })
}
