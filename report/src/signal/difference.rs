//! The difference of two runs.

use super::{
    Interpolation, SignalError, check_increasing, check_length, check_same_length, resample, rms,
};

/// The difference of two runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Crank angle (°) of the samples: those of the first run that the second one covers.
    pub angle: Vec<f64>,
    /// Second run minus first.
    pub values: Vec<f64>,
    /// Largest absolute difference.
    pub peak: f64,
    /// Root mean square of the difference.
    pub rms: f64,
    /// `rms` over the root mean square of the first run on the same samples; `None` if the latter is 0.
    pub relative_rms: Option<f64>,
    /// The interpolation of the second run at the angles of the first.
    pub interpolation: Interpolation,
}

/// Second run minus first at the first one's crank angles. Each run is its angles (°, increasing) and values;
/// the second one is interpolated as stated, and samples that it does not cover are left out.
///
/// # Errors
/// Different lengths within a run, values that are not finite, angles that do not increase, runs without a
/// common angle.
pub fn difference(
    first: (&[f64], &[f64]),
    second: (&[f64], &[f64]),
    interpolation: Interpolation,
) -> Result<Difference, SignalError> {
    check_same_length("angles and values of the first run", first.0, first.1)?;
    check_increasing("the angle of the first run", first.0)?;
    check_length("a difference", 2, second.0.len())?;
    let (from, to) = match (second.0.first(), second.0.last()) {
        (Some(from), Some(to)) => (*from, *to),
        _ => (0.0, 0.0),
    };
    // angles of two runs differ by rounding
    let slack = 1e-9 * (to - from);
    let (angle, base): (Vec<f64>, Vec<f64>) = first
        .0
        .iter()
        .zip(first.1)
        .filter(|(angle, _)| **angle >= from - slack && **angle <= to + slack)
        .map(|(angle, value)| (*angle, *value))
        .unzip();
    check_length("a difference over the common angles", 1, angle.len())?;
    let other = resample(second.0, second.1, &angle, interpolation)?;
    let values: Vec<f64> = other.iter().zip(&base).map(|(b, a)| b - a).collect();
    let difference = rms(&values)?;
    let size = rms(&base)?;
    Ok(Difference {
        peak: values.iter().fold(0.0, |peak, v| v.abs().max(peak)),
        rms: difference,
        relative_rms: (size > 0.0).then(|| difference / size),
        angle,
        values,
        interpolation,
    })
}
