//! Amplitudes of orders over speed.

use super::fourier::Complex;
use super::{
    Sampling, Signal, SignalError, Window, check_finite, check_length, check_positive,
    check_same_length,
};
use std::f64::consts::TAU;

/// One sinusoid of a signal, amplitude·cos(2πft + phase), t = 0 at the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Amplitude, zero to peak.
    pub amplitude: f64,
    /// Phase (°).
    pub phase: f64,
}

/// A run at a steady speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run<'a> {
    /// Speed of the shaft (rpm).
    pub speed: f64,
    /// The sampled signal.
    pub signal: Signal<'a>,
}

/// A run whose speed changes, sampled by angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunUp<'a> {
    /// The signal, one value for each angle.
    pub values: &'a [f64],
    /// Speed of the shaft at the samples (rpm).
    pub speeds: &'a [f64],
    /// Angle between the samples (°).
    pub step: f64,
    /// Revolutions of a block.
    pub revolutions: f64,
    /// Share of a block that the next block repeats, 0 ≤ overlap < 1.
    pub overlap: f64,
}

/// Orders over speed.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderTrack {
    /// The wanted orders.
    pub orders: Vec<f64>,
    /// Speed (rpm) of each run or block.
    pub speeds: Vec<f64>,
    /// For each order, one component for each speed.
    pub components: Vec<Vec<Component>>,
    /// The weight of the blocks.
    pub window: Window,
}

/// The sinusoid of a frequency given in cycles a sample (0…½), which need not be the centre of a bin: the sum
/// 2·Σ w·x·exp(−2πifn)/Σw (half of that at 0 and ½), as a spectrum's line would have it.
///
/// # Errors
/// Fewer than two samples, values that are not finite, a frequency outside of 0…½.
pub fn component(
    values: &[f64],
    cycles_per_sample: f64,
    window: Window,
) -> Result<Component, SignalError> {
    check_length("a component", 2, values.len())?;
    check_finite("the signal", values)?;
    // ½ itself, but for rounding
    if !(0.0..=0.5 * (1.0 + 1e-12)).contains(&cycles_per_sample) {
        return Err(SignalError::Setting {
            what: "a frequency in cycles a sample",
            range: "from 0 to ½ (the Nyquist frequency)",
            value: cycles_per_sample,
        });
    }
    let weights = window.weights(values.len());
    let gain: f64 = weights.iter().sum();
    let mut sum = Complex::default();
    for (n, (value, weight)) in values.iter().zip(&weights).enumerate() {
        let turns = cycles_per_sample * n as f64;
        let (sine, cosine) = libm::sincos(TAU * (turns - turns.floor()));
        sum.re += value * weight * cosine;
        sum.im -= value * weight * sine;
    }
    let alone = cycles_per_sample == 0.0 || cycles_per_sample >= 0.5;
    let factor = if alone { 1.0 } else { 2.0 };
    Ok(Component {
        amplitude: factor * sum.abs() / gain,
        phase: sum.arg().to_degrees(),
    })
}

/// Amplitude and phase of orders in runs at steady speeds. Exact for runs of whole cycles and
/// [`Window::Rectangular`]; order k of a shaft at n (rpm) is the frequency k·n/60.
///
/// # Errors
/// As [`component`]; an order beyond the Nyquist frequency of a run is refused.
pub fn order_track(
    runs: &[Run<'_>],
    orders: &[f64],
    window: Window,
) -> Result<OrderTrack, SignalError> {
    let mut components = Vec::with_capacity(orders.len());
    for order in orders {
        let mut row = Vec::with_capacity(runs.len());
        for run in runs {
            check_positive("the speed of the shaft", run.speed)?;
            let cycles = match run.signal.sampling {
                Sampling::Time { step } => order * run.speed / 60.0 * step,
                Sampling::Angle { step } => order * step / 360.0,
            };
            row.push(component(run.signal.values, cycles, window)?);
        }
        components.push(row);
    }
    Ok(OrderTrack {
        orders: orders.to_vec(),
        speeds: runs.iter().map(|run| run.speed).collect(),
        components,
        window,
    })
}

/// Amplitude and phase of orders along a run of changing speed, block by block; a block's speed is the mean
/// over it.
///
/// # Errors
/// As [`component`], and for different lengths, a block of fewer than two samples or longer than the run, an
/// overlap below 0 or not below 1.
pub fn order_track_of_run_up(
    run: RunUp<'_>,
    orders: &[f64],
    window: Window,
) -> Result<OrderTrack, SignalError> {
    check_same_length("signal and speeds", run.values, run.speeds)?;
    check_positive("the angle between samples", run.step)?;
    check_positive("the revolutions of a block", run.revolutions)?;
    check_finite("the speed", run.speeds)?;
    if !(0.0..1.0).contains(&run.overlap) {
        return Err(SignalError::Setting {
            what: "the overlap",
            range: "at least 0 and below 1",
            value: run.overlap,
        });
    }
    let length = (run.revolutions * 360.0 / run.step).round() as usize;
    check_length("a block of an order track", 2, length)?;
    check_length("an order track of this block", length, run.values.len())?;
    let shift = ((length as f64 * (1.0 - run.overlap)).round() as usize).max(1);
    let mut track = OrderTrack {
        orders: orders.to_vec(),
        speeds: Vec::new(),
        components: vec![Vec::new(); orders.len()],
        window,
    };
    let mut start = 0;
    while let (Some(block), Some(speeds)) = (
        run.values.get(start..start + length),
        run.speeds.get(start..start + length),
    ) {
        track
            .speeds
            .push(speeds.iter().sum::<f64>() / length as f64);
        for (order, row) in orders.iter().zip(&mut track.components) {
            row.push(component(block, order * run.step / 360.0, window)?);
        }
        start += shift;
    }
    Ok(track)
}
