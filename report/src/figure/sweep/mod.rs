//! Amplitudes over speed: a waterfall of curves, and a Campbell diagram.

mod campbell;
pub(crate) mod cells;
mod waterfall;

pub use campbell::Campbell;
pub use waterfall::Waterfall;

use super::axes::{RIGHT, WIDTH};
use super::svg::Svg;
use crate::signal::{Axis, SweepMap};

/// The data that both diagrams have.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepFigure {
    /// Title.
    pub title: String,
    /// The text under the title: model, analysis, window, resolution.
    pub subtitle: String,
    /// `Acceleration x of main[5]`.
    pub quantity: String,
    /// `m/s²`; of a level `dB re 1e-6 m/s²`.
    pub unit: String,
    /// The axes the component is in; empty for a scalar.
    pub frame: String,
    /// The amplitudes.
    pub map: SweepMap,
    /// The axis of frequencies or orders ends here; `None` shows all.
    pub limit: Option<f64>,
}

impl SweepFigure {
    pub(super) fn axis_name(&self) -> (&'static str, &'static str) {
        match self.map.axis() {
            Axis::Frequency => ("Frequency", "Hz"),
            Axis::Order => ("Order", "cycles a revolution"),
        }
    }

    pub(super) fn value_label(&self) -> String {
        let frame = if self.frame.is_empty() {
            String::new()
        } else {
            format!(", axes of {}", self.frame)
        };
        format!("{} ({}){frame}", self.quantity, self.unit)
    }

    pub(super) fn reach(&self) -> f64 {
        let end = self.map.positions().last().copied().unwrap_or(1.0);
        self.limit.map_or(end, |limit| limit.min(end))
    }

    pub(super) fn head(&self, svg: &mut Svg<'_>, left: f64) {
        svg.head(left, WIDTH - left - RIGHT, &self.title, &self.subtitle);
    }
}
