//! Decibels.

use super::{SignalError, check_positive};

/// Levels L = 20·lg(a/a₀) of amplitudes over a stated reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    reference: f64,
    unit: String,
}

impl Level {
    /// Levels over `reference`, whose unit is that of the amplitudes.
    ///
    /// # Errors
    /// A reference that is not a finite number above 0.
    pub fn new(reference: f64, unit: impl Into<String>) -> Result<Self, SignalError> {
        check_positive("the reference of a level", reference)?;
        Ok(Level {
            reference,
            unit: unit.into(),
        })
    }

    /// Level (dB) of an amplitude; −∞ for 0. The sign of the amplitude does not count.
    pub fn of(&self, amplitude: f64) -> f64 {
        20.0 * libm::log10(amplitude.abs() / self.reference)
    }

    /// `dB re 1e-6 m/s²`: for axes, which must state the reference.
    pub fn label(&self) -> String {
        let small = self.reference < 1e-3 || self.reference >= 1e5;
        let number = if small {
            format!("{:e}", self.reference)
        } else {
            format!("{}", self.reference)
        };
        format!("dB re {number} {}", self.unit)
    }
}
