//! Zero-phase band filters in the frequency domain.

use super::continuation::continued;
use super::fourier::{inverse, transform_real};
use super::{Sampling, Signal, SignalError, check_finite, check_length, check_positive};

/// Share of the distance of lines within which a line counts as being at a limit. It allows for rounding. A
/// choice.
const AT_LIMIT: f64 = 1e-3;

/// The band that passes (Hz for signals sampled in time, orders for signals sampled in angle).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Band {
    /// Everything below a limit, the mean included.
    Low {
        /// Upper limit.
        to: f64,
    },
    /// Everything above a limit.
    High {
        /// Lower limit.
        from: f64,
    },
    /// The part between two limits.
    Between {
        /// Lower limit.
        from: f64,
        /// Upper limit.
        to: f64,
    },
}

/// The slope of the gain at the limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slope {
    /// The gain is 1 within the band, 0 outside and ½ for a line at a limit, so the parts below and above a
    /// limit add up to the whole. In a signal that repeats, a line is at a limit if it is there up to
    /// rounding. Other signals have lines between the bins. For these the gain falls from 1 to 0 linearly
    /// over one bin about the limit.
    BrickWall,
    /// The gain of a Butterworth filter run forwards and backwards, 1/(1 + (f/f₀)²ⁿ): ½ at the limit, no
    /// phase.
    Butterworth {
        /// n, the order of one run.
        order: u32,
    },
}

/// The assumption of the filter about the signal beyond its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// The signal repeats: it has whole cycles, and its last sample is the first of the next cycle. The
    /// filter is exact if this holds. The difference of the ends counts as a drift, uniform over the signal.
    Periodic,
    /// The signal continues about its line of least squares, by linear prediction, and fades over four times
    /// its length. This is exact for a line. For sums of sinusoids and decays whose frequencies differ from
    /// the limits by at least four periods in the signal, the error is 10⁻⁶ of the size with some 300 samples
    /// or more, and 5·10⁻⁴ with 120 to 200 samples.
    Continued {
        /// Samples after which it repeats, except for a change that is predicted. A shorter signal is
        /// predicted as a whole.
        period: Option<usize>,
    },
}

/// A band filter without phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// The band that passes.
    pub band: Band,
    /// The slope at its limits.
    pub slope: Slope,
    /// The assumption about the signal beyond its ends.
    pub ends: Ends,
}

impl Filter {
    /// The filtered signal, sample by sample.
    ///
    /// # Errors
    /// Fewer than three samples, values that are not finite, limits that are not finite numbers above 0 or
    /// change order, a slope of order 0.
    pub fn apply(&self, signal: Signal<'_>) -> Result<Vec<f64>, SignalError> {
        check_length("a filter", 3, signal.values.len())?;
        check_finite("the signal", signal.values)?;
        self.check()?;
        let rate = match signal.sampling {
            Sampling::Time { step } => {
                check_positive("the sampling step", step)?;
                1.0 / step
            }
            Sampling::Angle { step } => {
                check_positive("the sampling step", step)?;
                360.0 / step
            }
        };
        let trend = self.trend(signal.values);
        let rest = signal.values.iter().zip(&trend).map(|(x, line)| x - line);
        let (samples, before) = match self.ends {
            Ends::Periodic => (rest.take(signal.values.len() - 1).collect(), 0),
            Ends::Continued { period } => {
                let found = continued(&rest.collect::<Vec<f64>>(), period);
                (found.values, found.before)
            }
        };
        let mut lines = transform_real(&samples);
        let length = lines.len();
        let bin = rate / length as f64;
        for (k, line) in lines.iter_mut().enumerate() {
            let gain = self.gain(k.min(length - k) as f64 * bin, bin);
            line.re *= gain;
            line.im *= gain;
        }
        let mut passed: Vec<f64> = inverse(&lines)
            .into_iter()
            .skip(before)
            .take(signal.values.len())
            .map(|v| v.re)
            .collect();
        if self.ends == Ends::Periodic {
            passed.extend(passed.first().copied());
        }
        // the gain at zero scales the trend, because the filter has no phase
        let gain = self.gain(0.0, bin);
        Ok(passed
            .iter()
            .zip(&trend)
            .map(|(x, line)| x + gain * line)
            .collect())
    }

    /// The line that is subtracted first, one value for each sample: the drift from end to end about its
    /// middle for a signal that repeats, otherwise the line of least squares.
    fn trend(&self, values: &[f64]) -> Vec<f64> {
        let count = values.len() as f64;
        let middle = (count - 1.0) / 2.0;
        let (mean, slope) = match (self.ends, values.first(), values.last()) {
            (Ends::Periodic, Some(first), Some(last)) => (0.0, (last - first) / (count - 1.0)),
            _ => {
                let mean = values.iter().sum::<f64>() / count;
                let offset = |n: usize| n as f64 - middle;
                let squares: f64 = (0..values.len()).map(|n| offset(n) * offset(n)).sum();
                let product = values
                    .iter()
                    .enumerate()
                    .map(|(n, x)| offset(n) * (x - mean));
                (mean, product.sum::<f64>() / squares)
            }
        };
        (0..values.len())
            .map(|n| mean + slope * (n as f64 - middle))
            .collect()
    }

    fn check(&self) -> Result<(), SignalError> {
        match self.band {
            Band::Low { to: limit } | Band::High { from: limit } => {
                check_positive("the limit of a filter", limit)?;
            }
            Band::Between { from, to } => {
                check_positive("the lower limit of a filter", from)?;
                check_positive("the upper limit of a filter", to)?;
                if from >= to {
                    return Err(SignalError::Setting {
                        what: "the upper limit of a filter",
                        range: "above the lower one",
                        value: to,
                    });
                }
            }
        }
        if self.slope == (Slope::Butterworth { order: 0 }) {
            return Err(SignalError::Setting {
                what: "the order of a Butterworth filter",
                range: "at least 1",
                value: 0.0,
            });
        }
        Ok(())
    }

    /// Gain at a frequency (Hz) or order, 0…1, of a transform with lines every `bin`.
    fn gain(&self, frequency: f64, bin: f64) -> f64 {
        match (self.band, self.slope) {
            (Band::Low { to }, _) => self.low(frequency, to, bin),
            (Band::High { from }, _) => self.high(frequency, from, bin),
            // adjacent bands add up to the whole
            (Band::Between { from, to }, Slope::BrickWall) => {
                self.low(frequency, to, bin) - self.low(frequency, from, bin)
            }
            (Band::Between { from, to }, Slope::Butterworth { .. }) => {
                self.low(frequency, to, bin) * self.high(frequency, from, bin)
            }
        }
    }

    fn low(&self, frequency: f64, limit: f64, bin: f64) -> f64 {
        match self.slope {
            // the mean is below any limit
            Slope::BrickWall if frequency == 0.0 => 1.0,
            Slope::BrickWall => {
                let beyond = (frequency - limit) / bin;
                match self.ends {
                    Ends::Periodic if beyond.abs() <= AT_LIMIT => 0.5,
                    Ends::Periodic => f64::from(beyond < 0.0),
                    Ends::Continued { .. } => (0.5 - beyond).clamp(0.0, 1.0),
                }
            }
            Slope::Butterworth { order } => {
                1.0 / (1.0 + libm::pow(frequency / limit, 2.0 * f64::from(order)))
            }
        }
    }

    fn high(&self, frequency: f64, limit: f64, bin: f64) -> f64 {
        match self.slope {
            Slope::BrickWall => 1.0 - self.low(frequency, limit, bin),
            Slope::Butterworth { order } if frequency > 0.0 => {
                1.0 / (1.0 + libm::pow(limit / frequency, 2.0 * f64::from(order)))
            }
            Slope::Butterworth { .. } => 0.0,
        }
    }

    /// The text for readers: band, slope and ends, with the unit of the limits.
    pub fn description(&self, sampling: Sampling) -> String {
        let unit = match sampling {
            Sampling::Time { .. } => " Hz",
            Sampling::Angle { .. } => " orders",
        };
        let band = match self.band {
            Band::Low { to } => format!("low-pass {to}{unit}"),
            Band::High { from } => format!("high-pass {from}{unit}"),
            Band::Between { from, to } => format!("band-pass {from} to {to}{unit}"),
        };
        let slope = match self.slope {
            Slope::BrickWall => "brick-wall, gain ½ at the limits".to_owned(),
            Slope::Butterworth { order } => {
                format!("Butterworth of order {order} run both ways, gain ½ at the limits")
            }
        };
        let ends = match self.ends {
            Ends::Periodic => "taken as periodic",
            Ends::Continued { period: None } => "continued beyond the ends by linear prediction",
            Ends::Continued { period: Some(_) } => {
                "continued beyond the ends cycle by cycle, the change by linear prediction"
            }
        };
        format!("{band}, {slope}, zero phase, {ends}")
    }
}
