//! Polar diagrams: the vector of a force over a cycle, in axes of the housing or in axes that turn with the
//! journal.

use super::key::{KeyKind, limit_stroke};
use super::palette::Color;
use super::plane::{Cell, Sheet, Upright};
use super::svg::{Stroke, Target};
use super::ticks;

/// The part to which the axes are fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FixedTo {
    /// The housing: shows the loaded part of the shell.
    Housing,
    /// The journal: shows the loaded part of the pin, and possible places of an oil hole.
    Journal,
}

/// The path of a vector's tip over a cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarCurve {
    /// `main[1]`.
    pub name: String,
    /// The axes of the components: `block.main[1]`.
    pub frame: String,
    /// Components along x, in the diagram's unit.
    pub x: Vec<f64>,
    /// Components along y, in the diagram's unit.
    pub y: Vec<f64>,
    /// Crank angle of each sample (°); empty if there is none.
    pub angle: Vec<f64>,
    /// Index of the first sample of the last cycle; 0 if all samples are one cycle or have no angle.
    pub last_cycle: usize,
}

/// A figure of polar diagrams. All have one scale, so they can be compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Polar {
    /// Title.
    pub title: String,
    /// The text below the title: model, analysis, filter.
    pub subtitle: String,
    /// `Force on the pin`.
    pub quantity: String,
    /// `kN`.
    pub unit: String,
    /// The part to which the axes are fixed.
    pub fixed_to: FixedTo,
    /// Angle after which the machine repeats (°).
    pub period: f64,
    /// The axis that points up.
    pub upright: Upright,
    /// A limit to compare with, drawn as a circle: its size and name.
    pub limit: Option<(f64, String)>,
    /// The vectors.
    pub curves: Vec<PolarCurve>,
}

impl PolarCurve {
    /// The same vector in axes that turn with the journal. `turn` is the angle (°) of these axes about z from
    /// those of the housing, one for each sample: x′ = x·cos φ + y·sin φ, y′ = −x·sin φ + y·cos φ. `frame`
    /// names those axes.
    pub fn turned(&self, turn: &[f64], frame: impl Into<String>) -> PolarCurve {
        let (x, y) = self
            .x
            .iter()
            .zip(&self.y)
            .zip(turn)
            .map(|((x, y), turn)| {
                let (sine, cosine) = libm::sincos(turn.to_radians());
                (x * cosine + y * sine, y * cosine - x * sine)
            })
            .unzip();
        PolarCurve {
            name: self.name.clone(),
            frame: frame.into(),
            x,
            y,
            angle: self.angle.clone(),
            last_cycle: self.last_cycle,
        }
    }

    fn largest(&self) -> f64 {
        self.x
            .iter()
            .zip(&self.y)
            .map(|(x, y)| libm::hypot(*x, *y))
            .filter(|size| size.is_finite())
            .fold(0.0, f64::max)
    }
}

impl Polar {
    pub(crate) fn draw(&self, target: Target<'_>) -> String {
        let largest = self
            .curves
            .iter()
            .map(PolarCurve::largest)
            .chain(self.limit.iter().map(|(size, _)| *size))
            .filter(|size| size.is_finite())
            .fold(0.0, f64::max);
        let rings = ticks::rounded(0.0, largest, 4);
        // a choice: 6 % of margin beyond the outermost ring or value
        let reach = rings.range.1.max(largest) * 1.06;
        let ring = Stroke {
            color: Color::Rule,
            width: 1.0,
            dash: "2 4",
        };
        let about = match self.fixed_to {
            FixedTo::Housing => "fixed to the housing",
            FixedTo::Journal => "fixed to the journal",
        };
        let title = format!("{}, axes {about}", self.title);
        let sheet = Sheet {
            title: &title,
            subtitle: &self.subtitle,
            period: self.period,
            upright: self.upright,
            unit: &self.unit,
            key: self
                .limit
                .iter()
                .map(|(_, name)| (KeyKind::Limit, name.clone()))
                .collect(),
            path: "tip of the vector",
            cells: self
                .curves
                .iter()
                .map(|curve| Cell {
                    name: &curve.name,
                    facts: format!(
                        "{} ≤ {} {}",
                        self.quantity,
                        ticks::significant(curve.largest()),
                        self.unit
                    ),
                    frame: if curve.frame.is_empty() {
                        String::new()
                    } else {
                        format!("axes of {}", curve.frame)
                    },
                    x: curve.x.clone(),
                    y: curve.y.clone(),
                    angle: &curve.angle,
                    last_cycle: curve.last_cycle,
                    reach,
                    circles: rings
                        .values
                        .iter()
                        .filter(|radius| **radius > 0.0)
                        .map(|radius| (*radius, ring))
                        .chain(self.limit.iter().map(|(size, _)| (*size, limit_stroke())))
                        .collect(),
                })
                .collect(),
        };
        sheet.draw(target)
    }
}
