//! Root mean squares and extremes.

use super::{SignalError, check_finite, check_increasing, check_length, check_same_length};

/// A largest or smallest value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// Abscissa; from the parabola if `refined`.
    pub position: f64,
    /// Ordinate; from the parabola if `refined`.
    pub value: f64,
    /// Index of the largest or smallest sample, at the extreme or beside it.
    pub sample: usize,
    /// Whether a parabola through three samples was used; the first and last sample have none.
    pub refined: bool,
}

/// Root mean square of uniform samples.
///
/// # Errors
/// No sample, or one that is not finite.
pub fn rms(values: &[f64]) -> Result<f64, SignalError> {
    check_length("a root mean square", 1, values.len())?;
    check_finite("the signal", values)?;
    let sum: f64 = values.iter().map(|v| v * v).sum();
    Ok((sum / values.len() as f64).sqrt())
}

/// The largest value and its abscissa: the top of the parabola through the first of the largest samples and
/// its neighbours (any spacing). For a smooth signal of step h the error of the abscissa is O(h²), and that
/// of the value O(h⁴).
///
/// # Errors
/// No sample, different lengths, values that are not finite, an abscissa that does not increase.
pub fn maximum_at(x: &[f64], y: &[f64]) -> Result<Extreme, SignalError> {
    extreme(x, y, |value, best| value > best)
}

/// The smallest value and its abscissa, refined as in [`maximum_at`].
///
/// # Errors
/// As [`maximum_at`].
pub fn minimum(x: &[f64], y: &[f64]) -> Result<Extreme, SignalError> {
    extreme(x, y, |value, best| value < best)
}

fn extreme(x: &[f64], y: &[f64], better: fn(f64, f64) -> bool) -> Result<Extreme, SignalError> {
    check_same_length("abscissa and signal", x, y)?;
    check_length("a signal", 1, y.len())?;
    check_increasing("the abscissa", x)?;
    check_finite("the signal", y)?;
    let mut sample = 0;
    let mut best = f64::NAN;
    for (index, value) in y.iter().enumerate() {
        if best.is_nan() || better(*value, best) {
            (sample, best) = (index, *value);
        }
    }
    let at = x.get(sample).copied().unwrap_or_default();
    let plain = Extreme {
        position: at,
        value: best,
        sample,
        refined: false,
    };
    let Some(before) = sample.checked_sub(1) else {
        return Ok(plain);
    };
    let (Some([x0, x1, x2]), Some([y0, y1, y2])) =
        (x.get(before..before + 3), y.get(before..before + 3))
    else {
        return Ok(plain);
    };
    // Newton's form about the middle sample
    let (left, right) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    let curvature = (right - left) / (x2 - x0);
    let slope = left + curvature * (x1 - x0);
    if curvature == 0.0 || !curvature.is_finite() {
        return Ok(plain);
    }
    let shift = -slope / (2.0 * curvature);
    // rounding must not move the abscissa beyond the three samples
    if !(x0 - x1..=x2 - x1).contains(&shift) {
        return Ok(plain);
    }
    Ok(Extreme {
        position: x1 + shift,
        value: y1 - curvature * shift * shift,
        sample,
        refined: true,
    })
}
