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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_on_different_grids() {
        let first: Vec<f64> = (0..=720).map(f64::from).collect();
        let second: Vec<f64> = (0..=1000).map(|i| f64::from(i) * 0.5 + 100.25).collect();
        let wave = |a: &f64| libm::sin(a.to_radians());
        let shifted: Vec<f64> = second.iter().map(|a| wave(a) + 0.25).collect();
        let plain: Vec<f64> = first.iter().map(wave).collect();
        let found =
            difference((&first, &plain), (&second, &shifted), Interpolation::Cubic).unwrap();
        assert_eq!(found.angle.first(), Some(&101.0));
        assert_eq!(found.angle.last(), Some(&600.0));
        assert!((found.peak - 0.25).abs() < 1e-7 && (found.rms - 0.25).abs() < 1e-7);
        assert!(found.relative_rms.is_some_and(|r| (0.3..0.4).contains(&r)));
    }

    #[test]
    fn runs_without_common_angles_are_refused() {
        let a = [0.0, 1.0];
        let b = [5.0, 6.0];
        assert!(matches!(
            difference((&a, &a), (&b, &b), Interpolation::Linear),
            Err(SignalError::TooShort { .. })
        ));
    }
}
