//! Evaluation of sampled results: spectra, orders, filters, extremes, differences.
//!
//! May contain: arithmetic on plain slices. Must not contain: files, pictures, units (the numbers keep
//! theirs).

pub(crate) mod continuation;
mod difference;
mod extreme;
mod filter;
pub mod fourier;
mod harmonics;
mod level;
mod order;
mod resample;
mod spectrum;
mod sweep;
mod window;

pub use difference::{Difference, difference};
pub use extreme::{Extreme, maximum_at, minimum, rms};
pub use filter::{Band, Ends, Filter, Slope};
pub use harmonics::{Harmonic, harmonics};
pub use level::Level;
pub use order::{Component, OrderTrack, Run, RunUp, component, order_track, order_track_of_run_up};
pub use resample::{Interpolation, resample};
pub use spectrum::{
    Amplitude, Averaging, Axis, Peak, Sampling, Signal, Spectrum, SpectrumOptions, spectrum,
};
pub use sweep::{SweepMap, sweep_map};
pub use window::Window;

/// The reason why a signal cannot be evaluated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SignalError {
    /// Too few samples.
    #[error("{what} needs at least {needed} samples, but there are {found}")]
    TooShort {
        /// The wanted quantity.
        what: &'static str,
        /// Number of samples that it needs.
        needed: usize,
        /// Number of samples.
        found: usize,
    },
    /// A sample is infinite or no number.
    #[error("sample {} of {what} is not a finite number", .index.saturating_add(1))]
    NotFinite {
        /// The name of the input.
        what: &'static str,
        /// Index, from 0.
        index: usize,
    },
    /// An abscissa does not increase.
    #[error("{what} must increase from sample to sample, but does not at sample {}", .index.saturating_add(1))]
    NotIncreasing {
        /// The name of the input.
        what: &'static str,
        /// Index, from 0.
        index: usize,
    },
    /// Two inputs that belong together differ in length.
    #[error("{what}: {left} samples against {right}")]
    Lengths {
        /// The names of the inputs.
        what: &'static str,
        /// Samples of the first.
        left: usize,
        /// Samples of the second.
        right: usize,
    },
    /// A setting lies outside of its range.
    #[error("{what} must be {range}, not {value}")]
    Setting {
        /// The name of the setting.
        what: &'static str,
        /// The allowed range.
        range: &'static str,
        /// The given value.
        value: f64,
    },
    /// An abscissa lies outside of the samples.
    #[error("{position} lies outside of the samples, which go from {from} to {to}")]
    Outside {
        /// The wanted abscissa.
        position: f64,
        /// First sample.
        from: f64,
        /// Last sample.
        to: f64,
    },
    /// Spectra of one map have different axes.
    #[error(
        "the spectra of a map must all have a {expected} axis, but number {index} has a {found} axis"
    )]
    Axes {
        /// Axis of the first.
        expected: &'static str,
        /// Axis of the one that differs.
        found: &'static str,
        /// Index, from 0.
        index: usize,
    },
}

fn check_finite(what: &'static str, values: &[f64]) -> Result<(), SignalError> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(SignalError::NotFinite { what, index }),
        None => Ok(()),
    }
}

fn check_length(what: &'static str, needed: usize, found: usize) -> Result<(), SignalError> {
    if found < needed {
        return Err(SignalError::TooShort {
            what,
            needed,
            found,
        });
    }
    Ok(())
}

fn check_positive(what: &'static str, value: f64) -> Result<(), SignalError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(SignalError::Setting {
        what,
        range: "a finite number above 0",
        value,
    })
}

fn check_increasing(what: &'static str, values: &[f64]) -> Result<(), SignalError> {
    check_finite(what, values)?;
    let fault = values
        .iter()
        .zip(values.iter().skip(1))
        .position(|(before, after)| after <= before);
    match fault {
        Some(index) => Err(SignalError::NotIncreasing {
            what,
            index: index + 1,
        }),
        None => Ok(()),
    }
}

fn check_same_length(what: &'static str, left: &[f64], right: &[f64]) -> Result<(), SignalError> {
    if left.len() == right.len() {
        return Ok(());
    }
    Err(SignalError::Lengths {
        what,
        left: left.len(),
        right: right.len(),
    })
}
