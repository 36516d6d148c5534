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

#[cfg(test)]
mod tests {
    use super::super::{Sampling, Signal, SpectrumOptions, spectrum};
    use super::*;

    fn of(samples: usize, cycles: f64) -> Spectrum {
        let values: Vec<f64> = (0..samples)
            .map(|n| libm::cos(std::f64::consts::TAU * cycles * n as f64 / samples as f64))
            .collect();
        let signal = Signal {
            values: &values,
            sampling: Sampling::Time { step: 1e-3 },
        };
        spectrum(signal, SpectrumOptions::default()).unwrap()
    }

    #[test]
    fn rows_share_the_coarsest_axis_and_keep_peaks() {
        let map = sweep_map(&[(3000.0, of(1000, 101.0)), (2000.0, of(500, 25.0))]).unwrap();
        assert_eq!(map.speeds(), [2000.0, 3000.0]);
        assert_eq!(map.positions()[1], 2.0);
        assert_eq!(map.positions().len(), 251);
        assert!((map.amplitudes()[0][25] - 1.0).abs() < 1e-10);
        // 101 Hz lies between the columns of 100 and 102 Hz
        assert!((map.amplitudes()[1][51] - 1.0).abs() < 1e-10);
    }

    #[test]
    fn maps_of_mixed_axes_are_refused() {
        let orders = of(500, 25.0).in_orders(3000.0).unwrap();
        assert!(matches!(
            sweep_map(&[(1.0, of(500, 25.0)), (2.0, orders)]),
            Err(SignalError::Axes { index: 1, .. })
        ));
        assert!(sweep_map(&[]).is_err());
    }

    #[test]
    fn rows_that_fit_no_map_are_refused() {
        let map = |speeds: &[f64], step, rows: &[&[f64]]| {
            let rows = rows.iter().map(|row| row.to_vec()).collect();
            SweepMap::new(Axis::Order, speeds.to_vec(), step, rows)
        };
        assert!(map(&[1.0, 2.0], 0.5, &[&[1.0, 2.0], &[3.0, f64::NAN]]).is_ok());
        assert!(map(&[2.0, 1.0], 0.5, &[&[1.0], &[3.0]]).is_err());
        assert!(map(&[1.0, 2.0], 0.0, &[&[1.0], &[3.0]]).is_err());
        assert!(map(&[1.0, 2.0], 0.5, &[&[1.0]]).is_err());
        assert!(map(&[1.0, 2.0], 0.5, &[&[1.0], &[3.0, 4.0]]).is_err());
    }
}
