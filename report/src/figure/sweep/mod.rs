//! Amplitudes over speed: a waterfall of curves, and a Campbell diagram.

mod campbell;
mod cells;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Half an order is large, all other lines are small; 1 Hz from line to line.
    fn map(speeds: &[f64], lines: u32) -> SweepMap {
        let line = |speed: f64, at: u32| match (f64::from(at) - speed / 30.0).abs() < 0.5 {
            true => 7.0,
            false => 0.1,
        };
        let row = |speed: &f64| (0..lines).map(|at| line(*speed, at)).collect();
        let rows = speeds.iter().map(row).collect();
        SweepMap::new(Axis::Frequency, speeds.to_vec(), 1.0, rows).unwrap()
    }

    pub(super) fn figure() -> SweepFigure {
        SweepFigure {
            title: "Run-up <1>".to_owned(),
            subtitle: String::new(),
            quantity: "Acceleration x".to_owned(),
            unit: "m/s²".to_owned(),
            frame: "block".to_owned(),
            map: map(&[1000.0, 1500.0, 2500.0], 2000),
            limit: None,
        }
    }

    #[test]
    fn diagrams_are_drawn_whatever_the_map() {
        let mut figure = figure();
        let campbell = Campbell {
            figure: figure.clone(),
            orders: vec![2.0, 4.0, 1000.0],
            natural_frequencies: vec![("first".to_owned(), 800.0), ("far".to_owned(), 1e5)],
            modes: vec![(2500.0, 900.0), (2500.0, 1e5), (f64::NAN, 3.0)],
        };
        let svg = campbell.to_svg();
        assert!(svg.contains(">order 2<") && svg.contains(">order 4<") && !svg.contains(">far"));
        assert!(svg.contains("first, 800 Hz") && !svg.contains("NaN"));
        // one mark of two rings: the others lie outside
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(svg.contains("Acceleration x (m/s²), axes of block"));
        let waterfall = |figure| Waterfall { figure }.to_svg();
        assert_eq!(waterfall(figure.clone()).matches("<polyline").count(), 3);
        figure.map.replace(|x| if x > 1.0 { f64::NAN } else { x });
        assert!(!waterfall(figure.clone()).contains("NaN"));
        figure.map = map(&[], 0);
        let empty = Campbell {
            figure: figure.clone(),
            ..campbell
        };
        for svg in [waterfall(figure), empty.to_svg()] {
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }
}
