//! Fourier coefficients of one cycle.

use super::fourier::transform_real;
use super::{SignalError, check_finite, check_length, check_positive};

/// One harmonic: cosine·cos(kθ) + sine·sin(kθ) = amplitude·cos(kθ − phase), θ from the first sample on, k the
/// order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic {
    /// Cycles per revolution: half orders for a four-stroke engine's cycle of 720°.
    pub order: f64,
    /// Coefficient of the cosine; the mean for order 0.
    pub cosine: f64,
    /// Coefficient of the sine.
    pub sine: f64,
    /// Amplitude, zero to peak.
    pub amplitude: f64,
    /// Phase (°) in (−180, 180]: the harmonic's first maximum lies at phase/order.
    pub phase: f64,
}

/// Harmonics 0…`count` of one cycle of `period` degrees, sampled uniformly without its repeated end.
/// It is exact if the signal has no orders above half the number of samples in a cycle.
///
/// # Errors
/// Fewer samples than 2·`count` + 1, values that are not finite, a period that is not a finite number above
/// 0.
pub fn harmonics(values: &[f64], period: f64, count: usize) -> Result<Vec<Harmonic>, SignalError> {
    check_positive("the period", period)?;
    check_finite("the signal", values)?;
    check_length(
        "so many harmonics",
        count.saturating_mul(2).saturating_add(1),
        values.len(),
    )?;
    let scale = 1.0 / values.len() as f64;
    Ok(transform_real(values)
        .iter()
        .take(count + 1)
        .enumerate()
        .map(|(k, line)| {
            let factor = if k == 0 { scale } else { 2.0 * scale };
            let (cosine, sine) = (factor * line.re, -factor * line.im);
            Harmonic {
                order: k as f64 * 360.0 / period,
                cosine,
                sine,
                amplitude: libm::hypot(cosine, sine),
                phase: libm::atan2(sine, cosine).to_degrees(),
            }
        })
        .collect())
}
