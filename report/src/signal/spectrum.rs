//! One-sided linear amplitude spectra.

use super::fourier::{Complex, transform_real};
use super::{SignalError, Window, check_finite, check_length, check_positive};
use std::f64::consts::SQRT_2;

/// The sampling of a signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampling {
    /// Every `step` seconds.
    Time {
        /// Distance of the samples (s).
        step: f64,
    },
    /// Every `step` degrees of shaft angle.
    Angle {
        /// Distance of the samples (°).
        step: f64,
    },
}

/// A uniformly sampled signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal<'a> {
    /// The samples, in any unit.
    pub values: &'a [f64],
    /// The places of the samples.
    pub sampling: Sampling,
}

/// The way from the blocks of a long signal to one spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Averaging {
    /// Mean of the amplitudes.
    Linear,
    /// Root of the mean of the squared amplitudes: keeps the power.
    RootMeanSquare,
    /// The largest amplitude of each bin.
    Peak,
}

/// The number that represents a sinusoid a·cos(ωt).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Amplitude {
    /// a ("0-peak").
    ZeroToPeak,
    /// a/√2.
    RootMeanSquare,
}

/// Settings of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumOptions {
    /// Weight of a block.
    pub window: Window,
    /// Samples in a block; `None` for one block of all samples.
    pub block_length: Option<usize>,
    /// Share of a block that the next block repeats, 0 ≤ overlap < 1.
    pub overlap: f64,
    /// The way from blocks to one spectrum.
    pub averaging: Averaging,
    /// The scale of the amplitudes.
    pub amplitude: Amplitude,
    /// Whether the mean of each block is subtracted first, so that it does not leak into low bins. The line
    /// at 0 is then 0.
    pub remove_mean: bool,
}

impl Default for SpectrumOptions {
    /// One block, Hann, 0-peak, the mean kept.
    fn default() -> Self {
        SpectrumOptions {
            window: Window::Hann,
            block_length: None,
            overlap: 0.5,
            averaging: Averaging::RootMeanSquare,
            amplitude: Amplitude::ZeroToPeak,
            remove_mean: false,
        }
    }
}

/// The horizontal axis of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Hz.
    Frequency,
    /// Cycles per revolution of the shaft.
    Order,
}

impl Axis {
    /// Its name for readers.
    pub fn name(self) -> &'static str {
        match self {
            Axis::Frequency => "frequency",
            Axis::Order => "order",
        }
    }

    /// `Hz`, or `1` for orders.
    pub fn unit(self) -> &'static str {
        match self {
            Axis::Frequency => "Hz",
            Axis::Order => "1",
        }
    }
}

/// A one-sided amplitude spectrum with its settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// The horizontal axis.
    pub axis: Axis,
    /// Distance of the lines (Hz, or orders): the resolution.
    pub step: f64,
    /// Amplitudes at 0, step, 2·step, …, up to the Nyquist frequency, in the signal's unit.
    pub amplitudes: Vec<f64>,
    /// Samples in a block.
    pub block_length: usize,
    /// Number of blocks.
    pub blocks: usize,
    /// The settings.
    pub options: SpectrumOptions,
}

/// A local maximum of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Frequency (Hz) or order of the line. The true peak is at most half the resolution away.
    pub position: f64,
    /// Amplitude of the line.
    pub amplitude: f64,
}

/// The one-sided linear amplitude spectrum of a signal: `A[k] = 2·|Σ w[n]·x[n]·exp(−2πikn/N)|/Σw`, and half
/// of that for the lines at 0 and at the Nyquist frequency, which have no mirror image. Blocks that do not
/// fit whole are left out.
///
/// # Errors
/// Fewer than two samples in a block, a block longer than the signal, samples or settings that are not
/// finite, an overlap below 0 or not below 1.
pub fn spectrum(signal: Signal<'_>, options: SpectrumOptions) -> Result<Spectrum, SignalError> {
    check_finite("the signal", signal.values)?;
    let (axis, rate) = match signal.sampling {
        Sampling::Time { step } => {
            check_positive("the sampling step", step)?;
            (Axis::Frequency, 1.0 / step)
        }
        Sampling::Angle { step } => {
            check_positive("the sampling step", step)?;
            (Axis::Order, 360.0 / step)
        }
    };
    let block_length = options.block_length.unwrap_or(signal.values.len());
    check_length("a block of a spectrum", 2, block_length)?;
    check_length(
        "a spectrum of this block",
        block_length,
        signal.values.len(),
    )?;
    if !(0.0..1.0).contains(&options.overlap) {
        return Err(SignalError::Setting {
            what: "the overlap",
            range: "at least 0 and below 1",
            value: options.overlap,
        });
    }
    let weights = options.window.weights(block_length);
    let shift = ((block_length as f64 * (1.0 - options.overlap)).round() as usize).max(1);
    let mut sums = vec![0.0; block_length / 2 + 1];
    let mut blocks = 0;
    let mut start = 0;
    while let Some(block) = signal.values.get(start..start + block_length) {
        for (sum, amplitude) in sums
            .iter_mut()
            .zip(block_amplitudes(block, &weights, options))
        {
            *sum = match options.averaging {
                Averaging::Linear => *sum + amplitude,
                Averaging::RootMeanSquare => *sum + amplitude * amplitude,
                Averaging::Peak => amplitude.max(*sum),
            };
        }
        blocks += 1;
        start += shift;
    }
    let count = blocks as f64;
    for sum in &mut sums {
        match options.averaging {
            Averaging::Linear => *sum /= count,
            Averaging::RootMeanSquare => *sum = (*sum / count).sqrt(),
            Averaging::Peak => {}
        }
    }
    Ok(Spectrum {
        axis,
        step: rate / block_length as f64,
        amplitudes: sums,
        block_length,
        blocks,
        options,
    })
}

fn block_amplitudes(block: &[f64], weights: &[f64], options: SpectrumOptions) -> Vec<f64> {
    let length = block.len();
    let mean = if options.remove_mean {
        block.iter().sum::<f64>() / length as f64
    } else {
        0.0
    };
    let weighted: Vec<f64> = block
        .iter()
        .zip(weights)
        .map(|(value, weight)| (value - mean) * weight)
        .collect();
    let gain: f64 = weights.iter().sum();
    let lines = transform_real(&weighted);
    lines
        .iter()
        .take(length / 2 + 1)
        .enumerate()
        .map(|(k, line)| {
            let alone = k == 0 || 2 * k == length;
            let factor = match (alone, options.amplitude) {
                (true, _) => 1.0,
                (false, Amplitude::ZeroToPeak) => 2.0,
                (false, Amplitude::RootMeanSquare) => SQRT_2,
            };
            factor * Complex::abs(*line) / gain
        })
        .collect()
}

impl Spectrum {
    /// Frequency (Hz) or order of each line.
    pub fn positions(&self) -> Vec<f64> {
        (0..self.amplitudes.len())
            .map(|k| k as f64 * self.step)
            .collect()
    }

    /// The last line: half of the sampling rate, or a step below (Hz, or orders).
    pub fn reach(&self) -> f64 {
        self.amplitudes.len().saturating_sub(1) as f64 * self.step
    }

    /// Bandwidth of white noise of one line (Hz, or orders).
    pub fn noise_bandwidth(&self) -> f64 {
        self.options.window.noise_bandwidth(self.block_length) * self.step
    }

    /// The same lines counted by orders of a shaft that turns at `speed` (rpm): order = f/(n/60).
    ///
    /// # Errors
    /// A speed that is not a finite number above 0.
    pub fn in_orders(mut self, speed: f64) -> Result<Self, SignalError> {
        check_positive("the speed of the shaft", speed)?;
        if self.axis == Axis::Frequency {
            self.step /= speed / 60.0;
            self.axis = Axis::Order;
        }
        Ok(self)
    }

    /// The `count` largest lines that are larger than both neighbours, the largest first; the line at 0 is
    /// none.
    pub fn peaks(&self, count: usize) -> Vec<Peak> {
        let mut peaks: Vec<Peak> = self
            .amplitudes
            .windows(3)
            .enumerate()
            .filter(|(_, w)| matches!(w, [a, b, c] if b > a && b >= c))
            .filter_map(|(k, w)| {
                Some(Peak {
                    position: (k + 1) as f64 * self.step,
                    amplitude: *w.get(1)?,
                })
            })
            .collect();
        peaks.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        peaks.truncate(count);
        peaks
    }

    /// Amplitude of the line nearest to a frequency or an order; `None` beyond the axis.
    pub fn nearest(&self, position: f64) -> Option<Peak> {
        let k = (position / self.step).round();
        if k.is_nan() || k < 0.0 {
            return None;
        }
        Some(Peak {
            position: k * self.step,
            amplitude: *self.amplitudes.get(k as usize)?,
        })
    }

    /// One line with all data that a reader needs to judge the amplitudes.
    pub fn description(&self) -> String {
        let unit = match self.axis {
            Axis::Frequency => " Hz",
            Axis::Order => " orders",
        };
        let amplitude = match self.options.amplitude {
            Amplitude::ZeroToPeak => "0-peak",
            Amplitude::RootMeanSquare => "rms",
        };
        let mut text = format!(
            "linear spectrum, {amplitude}; {} window, resolution {:.4}{unit}, noise bandwidth {:.4}{unit}; ",
            self.options.window.name(),
            self.step,
            self.noise_bandwidth()
        );
        if self.blocks == 1 {
            text.push_str(&format!("one block of {} samples", self.block_length));
        } else {
            let averaging = match self.options.averaging {
                Averaging::Linear => "mean",
                Averaging::RootMeanSquare => "rms",
                Averaging::Peak => "peak",
            };
            text.push_str(&format!(
                "{averaging} of {} blocks of {} samples, overlap {:.0} %",
                self.blocks,
                self.block_length,
                100.0 * self.options.overlap
            ));
        }
        if self.options.remove_mean {
            text.push_str("; mean removed");
        }
        text
    }
}
