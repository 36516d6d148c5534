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

    fn cell(&self) -> Cell<'_> {
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

#[cfg(test)]
mod tests {
    use super::super::marks::marks;
    use super::*;

    fn small(samples: u32, upright: Upright) -> Orbits {
        let angle: Vec<f64> = (0..=samples)
            .map(|i| f64::from(i) * 720.0 / f64::from(samples))
            .collect();
        let at = |a: &f64| a.to_radians();
        Orbits {
            title: "Orbits".to_owned(),
            subtitle: "Test".to_owned(),
            period: 360.0,
            upright,
            orbits: vec![Orbit {
                name: "main[1]".to_owned(),
                frame: "block.main[1]".to_owned(),
                clearance: 27e-6,
                x: angle.iter().map(|a| 20e-6 * libm::cos(at(a))).collect(),
                y: angle.iter().map(|a| 10e-6 * libm::sin(at(a))).collect(),
                // the samples are evenly spaced over two cycles
                last_cycle: (samples as usize).div_ceil(2),
                angle,
            }],
        }
    }

    #[test]
    fn small_figure() {
        insta::assert_snapshot!(small(8, Upright::X).to_svg());
    }

    #[test]
    fn marks_lie_between_samples_and_stay_in_the_cycle() {
        let figure = small(7, Upright::Y);
        let orbit = &figure.orbits[0];
        let cell = orbit.cell();
        assert_eq!(cell.last_cycle, 4, "720·4/7 is the first angle after 360");
        let found = marks(&cell, 360.0);
        let angles: Vec<i64> = found.iter().map(|m| m.0).collect();
        assert_eq!(angles, [90, 180, 270, 0]);
        assert!((found[3].1 - cell.x[7]).abs() < 1e-9 && (found[3].2 - cell.y[7]).abs() < 1e-9);
    }

    #[test]
    fn a_whole_cycle_has_each_mark_once() {
        let figure = small(72, Upright::Y);
        let cell = figure.orbits[0].cell();
        let angles: Vec<i64> = marks(&cell, 360.0).iter().map(|m| m.0).collect();
        assert_eq!(angles, [0, 90, 180, 270]);
    }

    #[test]
    fn marks_of_a_shaft_that_turns_backwards_have_the_same_places() {
        let forwards = small(72, Upright::Y);
        let mut backwards = forwards.clone();
        let orbit = &mut backwards.orbits[0];
        for angle in &mut orbit.angle {
            *angle = -*angle;
        }
        let of = |figure: &Orbits| marks(&figure.orbits[0].cell(), 360.0);
        let (due, found) = (of(&forwards), of(&backwards));
        let angles: Vec<i64> = found.iter().map(|m| m.0).collect();
        assert_eq!(angles, [0, 270, 180, 90]);
        for (a, b) in due.iter().zip(&found) {
            assert!((a.1 - b.1).abs() < 1e-9 && (a.2 - b.2).abs() < 1e-9);
        }
        // both pictures show the part before the last cycle
        assert!(backwards.to_svg().contains(">earlier<"));
    }

    #[test]
    fn gaps_and_missing_angles_are_drawn() {
        let mut figure = small(72, Upright::Y);
        figure.orbits[0].angle.clear();
        figure.orbits[0].x[3] = f64::NAN;
        let svg = figure.to_svg();
        assert!(!svg.contains("NaN"));
        assert!(svg.matches("<polyline").count() >= 2);
    }
}
