//! Zero-phase band filters in the frequency domain.

use super::fourier::{inverse, transform_real};
use super::{Sampling, Signal, SignalError, check_finite, check_length, check_positive};

/// What passes (Hz of time-sampled signals, orders of angle-sampled ones).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Band {
    /// Everything up to a limit, the mean included.
    Low {
        /// Upper limit.
        to: f64,
    },
    /// Everything from a limit on.
    High {
        /// Lower limit.
        from: f64,
    },
    /// What lies between two limits.
    Between {
        /// Lower limit.
        from: f64,
        /// Upper limit.
        to: f64,
    },
}

/// How sharp the limits are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slope {
    /// Gain 1 within the band, limits included, and 0 outside.
    BrickWall,
    /// The gain of a Butterworth filter run forwards and backwards, 1/(1 + (f/f₀)²ⁿ): ½ at the limit, no phase.
    Butterworth {
        /// n, the order of one run.
        order: u32,
    },
}

/// What the filter takes the signal to be beyond its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// It repeats: right for whole cycles (the last sample one step before the first one's repetition).
    Periodic,
    /// It goes on as its image turned about the end point: for signals that don't repeat.
    Reflected,
}

/// A band filter without phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// What passes.
    pub band: Band,
    /// How sharply.
    pub slope: Slope,
    /// What lies beyond the ends.
    pub ends: Ends,
}

impl Filter {
    /// The filtered signal, sample by sample.
    ///
    /// # Errors
    /// Fewer than two samples, values that are not finite, limits that are not finite numbers above 0 or change order, a
    /// slope of order 0.
    pub fn apply(&self, signal: Signal<'_>) -> Result<Vec<f64>, SignalError> {
        check_length("a filter", 2, signal.values.len())?;
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
        let extended = match self.ends {
            Ends::Periodic => signal.values.to_vec(),
            Ends::Reflected => reflected(signal.values),
        };
        let before = match self.ends {
            Ends::Periodic => 0,
            Ends::Reflected => signal.values.len() - 1,
        };
        let mut lines = transform_real(&extended);
        let length = lines.len();
        for (k, line) in lines.iter_mut().enumerate() {
            let gain = self.gain(k.min(length - k) as f64 * rate / length as f64);
            line.re *= gain;
            line.im *= gain;
        }
        Ok(inverse(&lines)
            .into_iter()
            .skip(before)
            .take(signal.values.len())
            .map(|v| v.re)
            .collect())
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

    /// Gain at a frequency (Hz) or order, 0…1.
    pub fn gain(&self, frequency: f64) -> f64 {
        match self.band {
            Band::Low { to } => self.low(frequency, to),
            Band::High { from } => self.high(frequency, from),
            Band::Between { from, to } => self.low(frequency, to) * self.high(frequency, from),
        }
    }

    fn low(&self, frequency: f64, limit: f64) -> f64 {
        match self.slope {
            // a line that rounding puts beyond the limit still counts
            Slope::BrickWall => f64::from(frequency <= limit * (1.0 + 1e-9)),
            Slope::Butterworth { order } => {
                1.0 / (1.0 + libm::pow(frequency / limit, 2.0 * f64::from(order)))
            }
        }
    }

    fn high(&self, frequency: f64, limit: f64) -> f64 {
        match self.slope {
            Slope::BrickWall => f64::from(frequency >= limit * (1.0 - 1e-9)),
            Slope::Butterworth { order } if frequency > 0.0 => {
                1.0 / (1.0 + libm::pow(limit / frequency, 2.0 * f64::from(order)))
            }
            Slope::Butterworth { .. } => 0.0,
        }
    }

    /// As printed: band, slope and ends, with the unit of the limits.
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
            Slope::BrickWall => "brick-wall".to_owned(),
            Slope::Butterworth { order } => {
                format!("Butterworth of order {order} run both ways, gain ½ at the limits")
            }
        };
        let ends = match self.ends {
            Ends::Periodic => "taken as periodic",
            Ends::Reflected => "reflected at the ends",
        };
        format!("{band}, {slope}, zero phase, {ends}")
    }
}

/// The signal with its point reflections before and after, as periodic as it can be.
fn reflected(values: &[f64]) -> Vec<f64> {
    let (Some(first), Some(last)) = (values.first(), values.last()) else {
        return Vec::new();
    };
    let inner = values.len() - 1;
    let before = values.iter().skip(1).rev().map(|v| 2.0 * first - v);
    let after = values.iter().rev().skip(1).map(|v| 2.0 * last - v);
    debug_assert_eq!(before.len(), inner);
    before.chain(values.iter().copied()).chain(after).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn wave(n: usize, cycles: f64) -> Vec<f64> {
        (0..n)
            .map(|i| libm::cos(TAU * cycles * i as f64 / n as f64 + 0.4))
            .collect()
    }

    #[test]
    fn a_brick_wall_parts_two_waves_exactly() {
        let (low, high) = (wave(720, 4.0), wave(720, 30.0));
        let values: Vec<f64> = low.iter().zip(&high).map(|(a, b)| 2.0 + a + b).collect();
        // 720 samples over two revolutions: 4 cycles are order 2, 30 are order 15
        let signal = Signal {
            values: &values,
            sampling: Sampling::Angle { step: 1.0 },
        };
        let run = |band| {
            Filter {
                band,
                slope: Slope::BrickWall,
                ends: Ends::Periodic,
            }
            .apply(signal)
            .unwrap()
        };
        for (found, expected) in run(Band::Low { to: 2.0 }).iter().zip(&low) {
            assert!((found - 2.0 - expected).abs() < 1e-12);
        }
        for (found, expected) in run(Band::High { from: 15.0 }).iter().zip(&high) {
            assert!((found - expected).abs() < 1e-12);
        }
        for (found, expected) in run(Band::Between { from: 1.0, to: 3.0 }).iter().zip(&low) {
            assert!((found - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn butterworth_halves_at_the_limit_without_phase() {
        let values = wave(500, 20.0);
        let filter = Filter {
            band: Band::Low { to: 20.0 },
            slope: Slope::Butterworth { order: 4 },
            ends: Ends::Periodic,
        };
        let signal = Signal {
            values: &values,
            sampling: Sampling::Time { step: 0.002 },
        };
        for (found, value) in filter.apply(signal).unwrap().iter().zip(&values) {
            assert!((found - value / 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_ramp_keeps_its_ends_when_reflected() {
        let ramp: Vec<f64> = (0..200).map(f64::from).collect();
        let filter = Filter {
            band: Band::Low { to: 5.0 },
            slope: Slope::Butterworth { order: 2 },
            ends: Ends::Reflected,
        };
        let signal = Signal {
            values: &ramp,
            sampling: Sampling::Time { step: 0.01 },
        };
        let found = filter.apply(signal).unwrap();
        assert!((found[100] - 100.0).abs() < 0.5 && (found[20] - 20.0).abs() < 0.5);
    }

    #[test]
    fn faults_are_named() {
        let signal = Signal {
            values: &[0.0, 1.0, 0.0],
            sampling: Sampling::Time { step: 1.0 },
        };
        let filter = Filter {
            band: Band::Between { from: 3.0, to: 2.0 },
            slope: Slope::BrickWall,
            ends: Ends::Periodic,
        };
        assert!(matches!(
            filter.apply(signal),
            Err(SignalError::Setting { .. })
        ));
    }
}
