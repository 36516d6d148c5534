//! Paths of pins in their clearance circles, one small picture a journal.

use super::font::text_width;
use super::palette::{self, GRID, INK, RULE};
use super::svg::{Anchor, Stroke, Svg, TextStyle};
use super::{decimate, ticks};

const TITLE: f64 = 22.0;
const LABEL: f64 = 15.0;
const NUMBER: f64 = 14.0;
const SMALL: f64 = 13.0;
/// Side of the square around the circle.
const BOX: f64 = 308.0;
const CELL: (f64, f64) = (392.0, 424.0);
/// The circle's share of the square.
const FILL: f64 = 0.88;
/// Earlier cycles.
const PALE: &str = "#b9cfdd";

/// Which shell axis points up in the picture; z points at the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Upright {
    /// x up, y to the left.
    X,
    /// y up, x to the right.
    Y,
}

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
    /// Crank angle of each sample (°), increasing; empty if there is none.
    pub angle: Vec<f64>,
}

/// A figure of orbits.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbits {
    /// Title.
    pub title: String,
    /// Stands under the title: model, analysis, filter.
    pub subtitle: String,
    /// Angle after which the machine repeats (°). The last cycle is drawn strongly and has marks every 90°.
    pub period: f64,
    /// Which axis points up.
    pub upright: Upright,
    /// The journals.
    pub orbits: Vec<Orbit>,
}

/// From shell axes to pixels.
struct View {
    center: (f64, f64),
    /// Pixels a metre.
    scale: f64,
    upright: Upright,
}

impl View {
    fn point(&self, x: f64, y: f64) -> (f64, f64) {
        let (right, up) = match self.upright {
            Upright::Y => (x, y),
            Upright::X => (-y, x),
        };
        (
            self.center.0 + self.scale * right,
            self.center.1 - self.scale * up,
        )
    }
}

impl Orbits {
    /// The figure as SVG.
    pub fn to_svg(&self) -> String {
        let columns = match self.orbits.len() {
            0 | 1 => 1,
            2 | 4 => 2,
            n if n <= 9 => 3,
            _ => 4,
        };
        let rows = self.orbits.len().div_ceil(columns).max(1);
        let width = (columns as f64 * CELL.0 + 24.0).max(800.0);
        let (key, key_rows) = self.key(width - 80.0);
        let top = 92.0 + 26.0 * key_rows as f64;
        let height = top + rows as f64 * CELL.1 + 16.0;
        let mut svg = Svg::new(width, height, &self.title);
        svg.text(
            40.0,
            42.0,
            &self.title,
            TextStyle::new(TITLE, Anchor::Start).bold(),
        );
        svg.text(
            40.0,
            68.0,
            &self.subtitle,
            TextStyle::new(SMALL + 1.0, Anchor::Start).soft(),
        );
        for entry in &key {
            entry.draw(&mut svg);
        }
        let indent = (width - columns as f64 * CELL.0) / 2.0;
        for (index, orbit) in self.orbits.iter().enumerate() {
            let left = indent + (index % columns) as f64 * CELL.0;
            self.draw(
                &mut svg,
                orbit,
                (left, top + (index / columns) as f64 * CELL.1),
            );
        }
        svg.finish()
    }

    fn key(&self, width: f64) -> (Vec<KeyEntry>, usize) {
        let mut kinds = vec![
            (KeyKind::Clearance, "radial clearance c"),
            (KeyKind::Half, "ε = 0.5"),
        ];
        if self.orbits.iter().any(|o| last_cycle(o, self.period) > 0) {
            kinds.push((KeyKind::Last, "last cycle"));
            kinds.push((KeyKind::Earlier, "earlier"));
        } else {
            kinds.push((KeyKind::Last, "path of the pin's centre"));
        }
        if self.orbits.iter().any(|o| !o.angle.is_empty()) {
            kinds.push((KeyKind::Mark, "every 90 °CA"));
        }
        let (mut x, mut row) = (0.0, 0);
        let mut entries = Vec::new();
        for (kind, text) in kinds {
            let size = 32.0 + 8.0 + text_width(text, NUMBER, false);
            if x > 0.0 && x + size > width {
                x = 0.0;
                row += 1;
            }
            entries.push(KeyEntry {
                kind,
                text,
                x: 40.0 + x,
                y: 98.0 + 26.0 * f64::from(row),
            });
            x += size + 26.0;
        }
        (entries, row as usize + 1)
    }

    fn draw(&self, svg: &mut Svg, orbit: &Orbit, corner: (f64, f64)) {
        let (left, top) = (corner.0 + 70.0, corner.1 + 52.0);
        let half = BOX / 2.0;
        let view = View {
            center: (left + half, top + half),
            scale: FILL * half / orbit.clearance,
            upright: self.upright,
        };
        svg.text(
            left,
            top - 26.0,
            &orbit.name,
            TextStyle::new(LABEL + 1.0, Anchor::Start).bold(),
        );
        svg.text(
            left + BOX,
            top - 26.0,
            &orbit.facts(),
            TextStyle::new(SMALL, Anchor::End).soft(),
        );
        if !orbit.frame.is_empty() {
            svg.text(
                left,
                top - 9.0,
                &format!("axes of {}", orbit.frame),
                TextStyle::new(SMALL, Anchor::Start).soft(),
            );
        }
        draw_grid(svg, orbit, &view, (left, top));
        svg.begin_clip(left, top, BOX, BOX);
        let start = last_cycle(orbit, self.period);
        draw_path(svg, orbit, &view, 0..start + 1, Stroke::solid(PALE, 1.3));
        draw_path(
            svg,
            orbit,
            &view,
            start..orbit.x.len(),
            Stroke::solid(palette::color(0), 2.2),
        );
        svg.end_clip();
        self.draw_marks(svg, orbit, &view, start, (left, top));
    }

    /// Rings at multiples of 90° in the last cycle, with the angle where it finds room.
    fn draw_marks(
        &self,
        svg: &mut Svg,
        orbit: &Orbit,
        view: &View,
        start: usize,
        corner: (f64, f64),
    ) {
        let marks = marks(orbit, start, self.period);
        let mut rings = Vec::new();
        for (angle, x, y) in marks {
            rings.push((angle, view.point(x, y)));
        }
        let count = rings.len().max(1) as f64;
        let middle = rings.iter().fold((0.0, 0.0), |m, (_, p)| {
            (m.0 + p.0 / count, m.1 + p.1 / count)
        });
        let mut taken: Vec<Rect> = rings
            .iter()
            .map(|(_, p)| Rect::around(*p, 6.0, 6.0))
            .collect();
        for (_, place) in &rings {
            svg.circle(
                *place,
                4.2,
                "#ffffff",
                Stroke::solid(palette::color(1), 1.8),
            );
        }
        let sheet = Rect {
            left: corner.0,
            top: corner.1,
            right: corner.0 + BOX,
            bottom: corner.1 + BOX,
        };
        for (angle, place) in rings {
            let text = format!("{angle}°");
            let size = (text_width(&text, SMALL, false) / 2.0 + 1.0, SMALL * 0.5);
            let outward = libm::atan2(place.1 - middle.1, place.0 - middle.0);
            let room = [0, 1, -1, 2, -2, 3, -3, 4].into_iter().find_map(|turn| {
                let direction = outward + f64::from(turn) * std::f64::consts::FRAC_PI_4;
                let (dx, dy) = (libm::cos(direction), libm::sin(direction));
                let center = (place.0 + dx * (9.0 + size.0), place.1 + dy * (9.0 + size.1));
                let rect = Rect::around(center, size.0, size.1);
                (rect.inside(&sheet) && !taken.iter().any(|t| t.meets(&rect))).then_some(rect)
            });
            if let Some(rect) = room {
                svg.text(
                    (rect.left + rect.right) / 2.0,
                    rect.bottom - SMALL * 0.14,
                    &text,
                    TextStyle::new(SMALL, Anchor::Middle).halo(),
                );
                taken.push(rect);
            }
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
}

/// Index of the first sample of the last cycle; 0 where all is one cycle or there is no angle.
fn last_cycle(orbit: &Orbit, period: f64) -> usize {
    match orbit.angle.last() {
        Some(end) => orbit
            .angle
            .iter()
            .position(|angle| *angle >= end - period - 1e-6)
            .unwrap_or(0),
        None => 0,
    }
}

/// Multiples of 90° between `start` and the end: angle within the cycle (°) and place (m), linear between samples.
fn marks(orbit: &Orbit, start: usize, period: f64) -> Vec<(i64, f64, f64)> {
    let mut found: Vec<(i64, f64, f64)> = Vec::new();
    let samples = orbit.angle.len().min(orbit.x.len()).min(orbit.y.len());
    let quarter = |angle: f64| ((angle + 1e-6) / 90.0).floor();
    let period = if period > 0.0 { period } else { 360.0 };
    let last = match orbit.angle.get(start) {
        Some(first) => first + period - 1e-6,
        None => return found,
    };
    for index in start..samples {
        let here = orbit.angle[index];
        // the first sample has a mark only where it stands on one
        let before = if index > start { index - 1 } else { index };
        let width = here - orbit.angle[before];
        // an angle that runs backwards, jumps or is no number has no marks
        if !(0.0..=period).contains(&width) || !here.is_finite() {
            continue;
        }
        let mut mark = if index > start {
            90.0 * (quarter(orbit.angle[before]) + 1.0)
        } else {
            90.0 * ((here - 1e-6) / 90.0).ceil()
        };
        while mark <= here + 1e-6 && mark < last {
            let share = if width > 0.0 {
                ((mark - orbit.angle[before]) / width).clamp(0.0, 1.0)
            } else {
                1.0
            };
            let between = |v: &[f64]| v[before] + share * (v[index] - v[before]);
            let (x, y) = (between(&orbit.x), between(&orbit.y));
            let angle = mark - period * ((mark + 1e-6) / period).floor();
            if x.is_finite() && y.is_finite() {
                found.push((angle.round() as i64, x, y));
            }
            mark += 90.0;
        }
    }
    found
}

fn draw_grid(svg: &mut Svg, orbit: &Orbit, view: &View, (left, top): (f64, f64)) {
    let reach = orbit.clearance / FILL * 1e6;
    let axis = ticks::inside(-reach, reach, 7);
    let scale = view.scale * 1e-6;
    let (right, bottom) = (left + BOX, top + BOX);
    let (across, upwards) = match view.upright {
        Upright::Y => (("x", 1.0), "y"),
        Upright::X => (("y", -1.0), "x"),
    };
    for value in &axis.values {
        let x = view.center.0 + across.1 * scale * value;
        let y = view.center.1 - scale * value;
        let zero = value.abs() < 1e-9 * axis.step;
        let stroke = if zero {
            Stroke::solid(RULE, 1.0)
        } else {
            Stroke::solid(GRID, 1.0)
        };
        svg.line((x, top), (x, bottom), stroke);
        svg.line((left, y), (right, y), stroke);
        let number = ticks::number(*value, axis.step);
        svg.text(
            x,
            bottom + 19.0,
            &number,
            TextStyle::new(NUMBER, Anchor::Middle),
        );
        svg.text(
            left - 8.0,
            y + NUMBER * 0.36,
            &number,
            TextStyle::new(NUMBER, Anchor::End),
        );
    }
    svg.frame(left, top, BOX, BOX, Stroke::solid(RULE, 1.0));
    svg.text(
        view.center.0,
        bottom + 41.0,
        &format!("{} (µm)", across.0),
        TextStyle::new(LABEL, Anchor::Middle),
    );
    svg.text(
        left - 44.0,
        view.center.1,
        &format!("{upwards} (µm)"),
        TextStyle::new(LABEL, Anchor::Middle).upwards(),
    );
    let radius = view.scale * orbit.clearance;
    svg.circle(view.center, radius / 2.0, "none", half_stroke());
    svg.circle(view.center, radius, "none", clearance_stroke());
}

fn clearance_stroke() -> Stroke {
    Stroke::solid(INK, 1.8)
}

fn half_stroke() -> Stroke {
    Stroke {
        color: RULE,
        width: 1.2,
        dash: "5 4",
    }
}

fn draw_path(
    svg: &mut Svg,
    orbit: &Orbit,
    view: &View,
    range: std::ops::Range<usize>,
    stroke: Stroke,
) {
    let mut run = Vec::new();
    let end = range.end.min(orbit.x.len()).min(orbit.y.len());
    for index in range.start.min(end)..end {
        let point = view.point(orbit.x[index], orbit.y[index]);
        if point.0.is_finite() && point.1.is_finite() {
            run.push(point);
        } else {
            svg.polyline(&decimate::thinned(&run, 0.3), stroke);
            run.clear();
        }
    }
    svg.polyline(&decimate::thinned(&run, 0.3), stroke);
}

/// Three digits, without trailing zeros.
fn significant(value: f64) -> String {
    let decimals = match value.abs() {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        _ => 2,
    };
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A box that a label takes.
#[derive(Clone, Copy, Debug)]
struct Rect {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

impl Rect {
    fn around(center: (f64, f64), half_width: f64, half_height: f64) -> Rect {
        Rect {
            left: center.0 - half_width,
            top: center.1 - half_height,
            right: center.0 + half_width,
            bottom: center.1 + half_height,
        }
    }

    fn meets(&self, other: &Rect) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn inside(&self, other: &Rect) -> bool {
        self.left >= other.left
            && self.right <= other.right
            && self.top >= other.top
            && self.bottom <= other.bottom
    }
}

#[derive(Clone, Copy, Debug)]
enum KeyKind {
    Clearance,
    Half,
    Last,
    Earlier,
    Mark,
}

struct KeyEntry {
    kind: KeyKind,
    text: &'static str,
    x: f64,
    y: f64,
}

impl KeyEntry {
    fn draw(&self, svg: &mut Svg) {
        let (from, to) = ((self.x, self.y), (self.x + 32.0, self.y));
        match self.kind {
            KeyKind::Clearance => svg.line(from, to, clearance_stroke()),
            KeyKind::Half => svg.line(from, to, half_stroke()),
            KeyKind::Last => svg.line(from, to, Stroke::solid(palette::color(0), 2.2)),
            KeyKind::Earlier => svg.line(from, to, Stroke::solid(PALE, 1.6)),
            KeyKind::Mark => svg.circle(
                (self.x + 16.0, self.y),
                4.2,
                "#ffffff",
                Stroke::solid(palette::color(1), 1.8),
            ),
        }
        svg.text(
            self.x + 40.0,
            self.y + NUMBER * 0.36,
            self.text,
            TextStyle::new(NUMBER, Anchor::Start),
        );
    }
}

#[cfg(test)]
mod tests {
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
        let start = last_cycle(orbit, 360.0);
        assert_eq!(start, 4, "720·4/7 is the first angle after 360");
        let found = marks(orbit, start, 360.0);
        let angles: Vec<i64> = found.iter().map(|m| m.0).collect();
        assert_eq!(angles, [90, 180, 270, 0]);
        assert!((found[3].1 - orbit.x[7]).abs() < 1e-15 && (found[3].2 - orbit.y[7]).abs() < 1e-15);
    }

    #[test]
    fn a_whole_cycle_has_each_mark_once() {
        let figure = small(72, Upright::Y);
        let orbit = &figure.orbits[0];
        let angles: Vec<i64> = marks(orbit, last_cycle(orbit, 360.0), 360.0)
            .iter()
            .map(|m| m.0)
            .collect();
        assert_eq!(angles, [0, 90, 180, 270]);
    }

    #[test]
    fn up_is_the_stated_axis() {
        let view = |upright| View {
            center: (0.0, 0.0),
            scale: 1.0,
            upright,
        };
        assert_eq!(view(Upright::X).point(1.0, 0.0), (0.0, -1.0));
        assert_eq!(view(Upright::X).point(0.0, 1.0), (-1.0, 0.0));
        assert_eq!(view(Upright::Y).point(1.0, 0.0), (1.0, 0.0));
    }

    #[test]
    fn gaps_and_missing_angles_are_drawn() {
        let mut figure = small(72, Upright::Y);
        figure.orbits[0].angle.clear();
        figure.orbits[0].x[3] = f64::NAN;
        let svg = figure.to_svg();
        assert!(!svg.contains("NaN"));
        assert!(svg.matches("<polyline").count() >= 2);
        super::super::to_png(&svg, 0.5).unwrap();
    }
}
