//! One column of results.

use eng_system::{Dimension, DisplayUnit};
use std::f64::consts::PI;

/// One channel over the samples of an analysis. Values are SI; files hold them in the display unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// `main[5].force.x`.
    pub path: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its display unit.
    pub display: DisplayUnit,
    /// The axes it is in, as a path (`block.main[5]`, `ground`); empty for a scalar.
    pub frame: String,
    /// SI values.
    pub values: Vec<f64>,
}

impl Column {
    /// The column `time`, from values in s.
    pub fn time(values: Vec<f64>) -> Self {
        Column {
            path: super::TIME.to_owned(),
            dimension: Dimension::TIME,
            display: display_unit("s", 1.0),
            frame: String::new(),
            values,
        }
    }

    /// The column `cycle.angle`, shown in degrees, from values in rad.
    pub fn cycle_angle(values: Vec<f64>) -> Self {
        Column {
            path: super::CYCLE_ANGLE.to_owned(),
            dimension: Dimension::ANGLE,
            display: display_unit("deg", PI / 180.0),
            frame: String::new(),
            values,
        }
    }

    /// The column `cycle.speed`, shown in rpm, from values in rad/s.
    pub fn cycle_speed(values: Vec<f64>) -> Self {
        Column {
            path: super::CYCLE_SPEED.to_owned(),
            dimension: Dimension::ANGLE.over(Dimension::TIME),
            display: display_unit("rpm", PI / 30.0),
            frame: String::new(),
            values,
        }
    }

    /// The values in the display unit.
    pub fn shown(&self) -> Vec<f64> {
        self.values
            .iter()
            .map(|value| self.display.from_si(*value))
            .collect()
    }

    /// Smallest and largest finite value (SI).
    pub fn range(&self) -> Option<(f64, f64)> {
        finite_range(&self.values)
    }
}

/// Smallest and largest finite value.
pub(crate) fn finite_range(values: &[f64]) -> Option<(f64, f64)> {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    Some((finite().reduce(f64::min)?, finite().reduce(f64::max)?))
}

/// A unit without a shifted zero.
pub(crate) fn display_unit(symbol: &str, scale: f64) -> DisplayUnit {
    DisplayUnit {
        symbol: symbol.to_owned(),
        scale,
        offset: 0.0,
    }
}
