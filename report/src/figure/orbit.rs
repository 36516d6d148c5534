//! Paths of pins in their clearance circles, one small picture for each journal.

use super::key::{KeyKind, clearance_stroke, half_stroke};
use super::plane::{Cell, Sheet, Upright};
use super::svg::Target;
use super::ticks::significant;

/// The circle's share of the square. A choice: an orbit may leave the circle of an elastic bore.
const FILL: f64 = 0.88;

/// The path of a pin's centre in its shell.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// `main[1]`.
    pub name: String,
    /// The shell's axes: `block.main[1]`.
    pub frame: String,
    /// Radial clearance (m).
    pub clearance: f64,
    /// Displacement of the pin along the shell's x axis (m).
    pub x: Vec<f64>,
    /// Displacement of the pin along the shell's y axis (m).
    pub y: Vec<f64>,
    /// Crank angle of each sample (°); empty if there is none.
    pub angle: Vec<f64>,
    /// Index of the first sample of the last cycle; 0 if all samples are one cycle or have no angle.
    pub last_cycle: usize,
}

/// A figure of orbits.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbits {
    /// Title.
    pub title: String,
    /// The text below the title: model, analysis, filter.
    pub subtitle: String,
    /// Angle after which the machine repeats (°). The last cycle is drawn strongly and has marks every 90°.
    pub period: f64,
    /// The axis that points up.
    pub upright: Upright,
    /// The journals.
    pub orbits: Vec<Orbit>,
}

impl Orbits {
    pub(crate) fn draw(&self, target: Target<'_>) -> String {
        self.sheet().draw(target)
    }

    fn sheet(&self) -> Sheet<'_> {
        Sheet {
            title: &self.title,
            subtitle: &self.subtitle,
            period: self.period,
            upright: self.upright,
            unit: "µm",
            key: vec![
                (KeyKind::Clearance, "radial clearance c".to_owned()),
                (KeyKind::Half, "ε = 0.5".to_owned()),
            ],
            path: "path of the pin's centre",
            cells: self.orbits.iter().map(Orbit::cell).collect(),
        }
    }
}

impl Orbit {
    /// Clearance and largest eccentricity ratio.
    fn facts(&self) -> String {
        let largest = self
            .x
            .iter()
            .zip(&self.y)
            .map(|(x, y)| libm::hypot(*x, *y) / self.clearance)
            .filter(|ratio| ratio.is_finite())
            .fold(0.0, f64::max);
        format!(
            "c = {} µm, ε ≤ {largest:.3}",
            significant(self.clearance * 1e6)
        )
    }

    pub(crate) fn cell(&self) -> Cell<'_> {
        let micrometres = |values: &[f64]| values.iter().map(|v| v * 1e6).collect();
        let clearance = self.clearance * 1e6;
        Cell {
            name: &self.name,
            facts: self.facts(),
            frame: if self.frame.is_empty() {
                String::new()
            } else {
                format!("axes of {}", self.frame)
            },
            x: micrometres(&self.x),
            y: micrometres(&self.y),
            angle: &self.angle,
            last_cycle: self.last_cycle,
            reach: clearance / FILL,
            circles: vec![
                (clearance / 2.0, half_stroke()),
                (clearance, clearance_stroke()),
            ],
        }
    }
}
