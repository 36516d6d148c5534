//! Spectra over speed: the numbers of waterfalls and Campbell diagrams.

use super::{
    Axis, SignalError, Spectrum, check_finite, check_increasing, check_length, check_positive,
};

/// Amplitudes over speed and frequency or order.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepMap {
    axis: Axis,
    speeds: Vec<f64>,
    positions: Vec<f64>,
    amplitudes: Vec<Vec<f64>>,
}

impl SweepMap {
    /// A map with a row of amplitudes for each speed (rpm), at frequencies (Hz) or orders from 0 in equal steps.
    /// An amplitude beyond the Nyquist frequency of a run is NaN.
    ///
    /// # Errors
    /// Speeds that are not finite or do not increase, a step that is not above 0, another number of rows than
    /// speeds, rows of different lengths.
    pub fn new(
        axis: Axis,
        speeds: Vec<f64>,
        step: f64,
        amplitudes: Vec<Vec<f64>>,
    ) -> Result<SweepMap, SignalError> {
        check_increasing("the speed of the runs, put in order,", &speeds)?;
        check_positive("the step of a map", step)?;
        let lengths = |what, left, right| match left == right {
            true => Ok(()),
            false => Err(SignalError::Lengths { what, left, right }),
        };
        lengths("speeds and rows of a map", speeds.len(), amplitudes.len())?;
        let columns = amplitudes.first().map_or(0, Vec::len);
        for row in &amplitudes {
            lengths("rows of a map", columns, row.len())?;
        }
        Ok(SweepMap {
            axis,
            speeds,
            positions: (0..columns).map(|k| k as f64 * step).collect(),
            amplitudes,
        })
    }

    /// The axis of the positions.
    pub fn axis(&self) -> Axis {
        self.axis
    }

    /// Speed of each row (rpm), increasing.
    pub fn speeds(&self) -> &[f64] {
        &self.speeds
    }

    /// Frequency (Hz) or order of each column, from 0 in equal steps.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// One row for each speed, one column for each position; NaN beyond a run's Nyquist frequency.
    pub fn amplitudes(&self) -> &[Vec<f64>] {
        &self.amplitudes
    }

    /// Replaces each amplitude by a function of it.
    pub fn replace(&mut self, by: impl Fn(f64) -> f64) {
        for amplitude in self.amplitudes.iter_mut().flatten() {
            *amplitude = by(*amplitude);
        }
    }
}

/// Spectra as rows on one axis, whose step is the largest step of the spectra. A cell holds the largest line
/// within half a step of its position, so no peak is lost. Spectra with equal steps are copied line by line.
/// The rows are sorted by speed.
///
/// # Errors
/// No spectrum, axes of different kinds, speeds that are equal or not finite.
pub fn sweep_map(runs: &[(f64, Spectrum)]) -> Result<SweepMap, SignalError> {
    check_length("a map", 1, runs.len())?;
    let mut order: Vec<&(f64, Spectrum)> = runs.iter().collect();
    let speeds: Vec<f64> = runs.iter().map(|(speed, _)| *speed).collect();
    check_finite("the speeds", &speeds)?;
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let speeds: Vec<f64> = order.iter().map(|(speed, _)| *speed).collect();
    let axis = runs.first().map_or(Axis::Frequency, |(_, s)| s.axis);
    if let Some((index, (_, other))) = runs.iter().enumerate().find(|(_, (_, s))| s.axis != axis) {
        return Err(SignalError::Axes {
            expected: axis.name(),
            found: other.axis.name(),
            index,
        });
    }
    let step = order.iter().map(|(_, s)| s.step).fold(0.0, f64::max);
    let reach = |s: &Spectrum| s.step * s.amplitudes.len().saturating_sub(1) as f64;
    let end = order.iter().map(|(_, s)| reach(s)).fold(0.0, f64::max);
    // the last column is kept in spite of rounding
    let columns = (end / step + 1e-9).floor() as usize + 1;
    let amplitudes = order
        .iter()
        .map(|(_, spectrum)| {
            let mut row = vec![f64::NAN; columns];
            for (k, amplitude) in spectrum.amplitudes.iter().enumerate() {
                let column = (k as f64 * spectrum.step / step).round() as usize;
                if let Some(cell) = row.get_mut(column) {
                    *cell = if cell.is_nan() {
                        *amplitude
                    } else {
                        cell.max(*amplitude)
                    };
                }
            }
            row
        })
        .collect();
    SweepMap::new(axis, speeds, step, amplitudes)
}
