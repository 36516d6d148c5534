//! The limits of samples: frequencies that they resolve, blocks that fit, axes that the speed allows, and the
//! texts about them.

use super::PostError;
use super::sampling::Sampled;
use super::track::Track;
use crate::results::display_unit;
use eng_report::signal::Sampling;
use eng_system::expression::Limit;
use eng_system::system::Extent;
use std::f64::consts::{PI, TAU};

/// Share of a frequency or a period that counts as rounding. A choice: frequencies come from distances of
/// samples with as many digits.
const ROUNDING: f64 = 1e-6;
/// Largest deviation of the speed, as a share of the mean speed, for a conversion between frequencies and
/// orders. A choice: an order is then smeared over a tenth of itself.
const STEADY: f64 = 0.1;

/// `200 ms`, `0.5 deg`, `2 rev`.
pub fn extent_text(extent: Extent) -> String {
    match extent {
        Extent::Time(time) if time < 1e-3 => display_unit("us", 1e-6).text(time),
        Extent::Time(time) if time < 1.0 => display_unit("ms", 1e-3).text(time),
        Extent::Time(time) => display_unit("s", 1.0).text(time),
        Extent::Angle(angle) if angle < TAU => display_unit("deg", PI / 180.0).text(angle),
        Extent::Angle(angle) => display_unit("rev", TAU).text(angle),
    }
}

/// `150 Hz`, `2.5 kHz`, `order 2`.
pub fn limit_text(limit: Limit) -> String {
    match limit {
        Limit::Frequency(frequency) if frequency < 1e3 => display_unit("Hz", 1.0).text(frequency),
        Limit::Frequency(frequency) => display_unit("kHz", 1e3).text(frequency),
        Limit::Order(order) => format!("order {}", display_unit("1", 1.0).text(order)),
    }
}

/// `4000 rpm` for a speed in turns per second.
pub fn speed_text(speed: f64) -> String {
    display_unit("rpm", 1.0 / 60.0).text(speed)
}

/// A length on the axis of the samples (s, or °).
fn length(sampling: Sampling, steps: f64) -> Extent {
    match sampling {
        Sampling::Time { step } => Extent::Time(steps * step),
        Sampling::Angle { step } => Extent::Angle((steps * step).to_radians()),
    }
}

/// Half the sampling rate, per second or per turn.
pub(super) fn highest(sampling: Sampling) -> Limit {
    match sampling {
        Sampling::Time { step } => Limit::Frequency(0.5 / step),
        Sampling::Angle { step } => Limit::Order(180.0 / step),
    }
}

/// Cycles per sample of a frequency on the axis of the samples (Hz, or orders).
fn cycles_a_sample(sampling: Sampling, place: f64) -> f64 {
    match sampling {
        Sampling::Time { step } => place * step,
        Sampling::Angle { step } => place * step / 360.0,
    }
}

/// The nearest number with two digits that is less.
pub fn two_digits_below(x: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(x)) - 1.0);
    libm::floor(x / power * (1.0 - ROUNDING)) * power
}

impl Track {
    /// Refuses a frequency from half the sampling rate on, because the samples do not resolve it. `place` is
    /// on the axis of the samples.
    pub fn holds(&self, sampled: &Sampled, place: f64, stated: Limit) -> Result<(), PostError> {
        let cycles = cycles_a_sample(sampled.sampling, place);
        if cycles < 0.5 * (1.0 - ROUNDING) {
            return Ok(());
        }
        let needed = match length(sampled.sampling, 0.5 / cycles) {
            Extent::Time(time) => Extent::Time(two_digits_below(time)),
            Extent::Angle(angle) => {
                Extent::Angle(two_digits_below(angle.to_degrees()).to_radians())
            }
        };
        Err(PostError::TooFast {
            analysis: self.samples.analysis.clone(),
            stated: limit_text(stated),
            held: format!(
                "every {}, which resolve less than {}",
                extent_text(length(sampled.sampling, 1.0)),
                limit_text(highest(sampled.sampling))
            ),
            needed: extent_text(needed),
        })
    }

    /// Refuses a frequency without a whole period in the signal.
    pub fn resolves(&self, sampled: &Sampled, place: f64, stated: String) -> Result<(), PostError> {
        let cycles = cycles_a_sample(sampled.sampling, place) * sampled.count as f64;
        if cycles >= 1.0 - ROUNDING {
            return Ok(());
        }
        Err(PostError::TooSlow {
            analysis: self.samples.analysis.clone(),
            stated,
            length: extent_text(length(sampled.sampling, sampled.count as f64)),
        })
    }

    /// Samples of a block with a length in steps: at least two, and at most all.
    pub fn block(&self, sampled: &Sampled, steps: f64, stated: Extent) -> Result<usize, PostError> {
        let refused = |why: String| PostError::Block {
            analysis: self.samples.analysis.clone(),
            block: extent_text(stated),
            why,
        };
        let count = steps.round();
        if count.is_nan() || count < 2.0 {
            let step = extent_text(length(sampled.sampling, 1.0));
            return Err(refused(format!(
                "shorter than two samples, which are {step} apart"
            )));
        }
        if count > sampled.count as f64 {
            let whole = extent_text(length(sampled.sampling, sampled.count as f64));
            return Err(refused(format!("longer than the signal, {whole}")));
        }
        Ok(count as usize)
    }

    /// The magnitude of the mean speed (1/s), for the conversion between frequencies and orders. It is
    /// refused if the cycle does not turn or its speed changes too much.
    pub fn steady_speed(&self, sampled: &Sampled) -> Result<f64, PostError> {
        let speed = self.mean_speed(sampled)?;
        let speeds = self.samples.speed.iter().flatten().map(|s| s.abs() / TAU);
        let (low, high) = speeds.fold((speed, speed), |(low, high), s| (low.min(s), high.max(s)));
        if low < (1.0 - STEADY) * speed || high > (1.0 + STEADY) * speed {
            let (lie, asked, needed) = match sampled.sampling {
                Sampling::Time { .. } => ("time", "orders", "degrees"),
                Sampling::Angle { .. } => ("crank angle", "frequencies", "milliseconds"),
            };
            return Err(PostError::SpeedChanges {
                analysis: self.samples.analysis.clone(),
                speeds: format!("{} to {}", speed_text(low), speed_text(high)),
                lie,
                asked,
                needed,
            });
        }
        Ok(speed)
    }

    /// The magnitude of the mean speed (1/s).
    pub fn mean_speed(&self, sampled: &Sampled) -> Result<f64, PostError> {
        sampled
            .speed
            .map(f64::abs)
            .filter(|speed| *speed > 0.0 && speed.is_finite())
            .ok_or_else(|| PostError::NoSpeed(self.samples.analysis.clone()))
    }
}
