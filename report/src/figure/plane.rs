//! Paths in a plane, a square with equal axes each: what orbits and polar diagrams share.

use super::font::text_width;
use super::palette::Color;
use super::svg::{Anchor, CurveTag, Stroke, Svg, Target, TextStyle, coordinate};
use super::{decimate, ticks};

const TITLE: f64 = 22.0;
const LABEL: f64 = 15.0;
const NUMBER: f64 = 14.0;
const SMALL: f64 = 13.0;
/// Side of a square.
const BOX: f64 = 308.0;
const CELL: (f64, f64) = (392.0, 424.0);

/// Which axis points up in the picture; z points at the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Upright {
    /// x up, y to the left.
    X,
    /// y up, x to the right.
    Y,
}

/// All paths of a figure.
pub(super) struct Sheet<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    /// Angle after which the machine repeats (°).
    pub period: f64,
    pub upright: Upright,
    /// What the axes count, for the readout: `x` and `y` go before it.
    pub unit: &'a str,
    /// The key's entries besides those of the path.
    pub key: Vec<(KeyKind, String)>,
    /// What the path is called where there is but one cycle.
    pub path: &'static str,
    pub cells: Vec<Cell<'a>>,
}

/// One square.
pub(super) struct Cell<'a> {
    pub name: &'a str,
    /// Numbers above its right corner.
    pub facts: String,
    /// Stands under the name.
    pub frame: String,
    /// In the sheet's unit.
    pub x: Vec<f64>,
    /// In the sheet's unit.
    pub y: Vec<f64>,
    /// Crank angle of each sample (°), increasing; empty if there is none.
    pub angle: &'a [f64],
    /// From the middle to a side, in the sheet's unit.
    pub reach: f64,
    /// Circles about the origin.
    pub circles: Vec<(f64, Stroke)>,
}

/// From the cell's axes to pixels.
struct View {
    center: (f64, f64),
    /// Pixels a unit.
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

impl Sheet<'_> {
    /// The figure as SVG.
    pub fn draw(&self, target: Target<'_>) -> String {
        let columns = match self.cells.len() {
            0 | 1 => 1,
            2 | 4 => 2,
            n if n <= 9 => 3,
            _ => 4,
        };
        let rows = self.cells.len().div_ceil(columns).max(1);
        let width = (columns as f64 * CELL.0 + 24.0).max(800.0);
        let (key, key_rows) = self.key(width - 80.0);
        let top = 92.0 + 26.0 * key_rows as f64;
        let height = top + rows as f64 * CELL.1 + 16.0;
        let mut svg = Svg::new(width, height, self.title, target);
        svg.text_within(
            40.0,
            42.0,
            width - 80.0,
            self.title,
            TextStyle::new(TITLE, Anchor::Start).bold(),
        );
        svg.text_within(
            40.0,
            68.0,
            width - 80.0,
            self.subtitle,
            TextStyle::new(SMALL + 1.0, Anchor::Start).soft(),
        );
        for entry in &key {
            entry.draw(&mut svg);
        }
        let indent = (width - columns as f64 * CELL.0) / 2.0;
        for (index, cell) in self.cells.iter().enumerate() {
            let left = indent + (index % columns) as f64 * CELL.0;
            self.draw_cell(
                &mut svg,
                cell,
                (left, top + (index / columns) as f64 * CELL.1),
            );
        }
        svg.finish()
    }

    fn key(&self, width: f64) -> (Vec<KeyEntry>, usize) {
        let mut kinds = self.key.clone();
        if self.cells.iter().any(|o| last_cycle(o, self.period) > 0) {
            kinds.push((KeyKind::Last, "last cycle".to_owned()));
            kinds.push((KeyKind::Earlier, "earlier".to_owned()));
        } else {
            kinds.push((KeyKind::Last, self.path.to_owned()));
        }
        if self.cells.iter().any(|o| !o.angle.is_empty()) {
            kinds.push((KeyKind::Mark, "every 90 °CA".to_owned()));
        }
        let (mut x, mut row) = (0.0, 0);
        let mut entries = Vec::new();
        for (kind, text) in kinds {
            let size = 32.0 + 8.0 + text_width(&text, NUMBER, false);
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

    fn draw_cell(&self, svg: &mut Svg<'_>, cell: &Cell<'_>, corner: (f64, f64)) {
        let (left, top) = (corner.0 + 70.0, corner.1 + 52.0);
        let half = BOX / 2.0;
        let reach = if cell.reach > 0.0 && cell.reach.is_finite() {
            cell.reach
        } else {
            1.0
        };
        let view = View {
            center: (left + half, top + half),
            scale: half / reach,
            upright: self.upright,
        };
        svg.text(
            left,
            top - 26.0,
            cell.name,
            TextStyle::new(LABEL + 1.0, Anchor::Start).bold(),
        );
        svg.text(
            left + BOX,
            top - 26.0,
            &cell.facts,
            TextStyle::new(SMALL, Anchor::End).soft(),
        );
        if !cell.frame.is_empty() {
            svg.text(
                left,
                top - 9.0,
                &cell.frame,
                TextStyle::new(SMALL, Anchor::Start).soft(),
            );
        }
        let (x_name, y_name, side) = match self.upright {
            Upright::Y => ("x", "y", reach),
            Upright::X => ("y", "x", -reach),
        };
        svg.begin_group(
            "panel",
            &[
                (
                    "data-area",
                    format!(
                        "{} {} {} {}",
                        coordinate(left),
                        coordinate(top),
                        coordinate(BOX),
                        coordinate(BOX)
                    ),
                ),
                ("data-x", format!("{} {side}", -side)),
                ("data-y", format!("{} {reach}", -reach)),
                ("data-x-name", x_name.to_owned()),
                ("data-x-unit", self.unit.to_owned()),
                ("data-y-name", y_name.to_owned()),
                ("data-y-unit", self.unit.to_owned()),
                ("data-equal", "yes".to_owned()),
            ],
        );
        self.draw_grid(svg, reach, &view, (left, top));
        svg.begin_clip(left, top, BOX, BOX);
        for (radius, stroke) in &cell.circles {
            svg.circle(view.center, view.scale * radius, None, *stroke);
        }
        let start = last_cycle(cell, self.period);
        draw_path(
            svg,
            cell,
            &view,
            0..start + 1,
            Stroke::solid(Color::Pale, 1.3),
        );
        draw_path(
            svg,
            cell,
            &view,
            start..cell.x.len(),
            Stroke::solid(Color::Series(0), 2.2),
        );
        svg.end_clip();
        self.draw_marks(svg, cell, &view, start, (left, top));
        svg.end_group();
    }

    /// Rings at multiples of 90° in the last cycle, with the angle where it finds room.
    fn draw_marks(
        &self,
        svg: &mut Svg<'_>,
        cell: &Cell<'_>,
        view: &View,
        start: usize,
        corner: (f64, f64),
    ) {
        let marks = marks(cell, start, self.period);
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
            svg.begin_group("mark", &place_of(*place));
            svg.circle(
                *place,
                4.2,
                Some(Color::Sheet),
                Stroke::solid(Color::Series(1), 1.8),
            );
            svg.end_group();
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
                svg.begin_group("mark", &place_of(place));
                svg.text(
                    (rect.left + rect.right) / 2.0,
                    rect.bottom - SMALL * 0.14,
                    &text,
                    TextStyle::new(SMALL, Anchor::Middle).halo(),
                );
                svg.end_group();
                taken.push(rect);
            }
        }
    }

    fn draw_grid(&self, svg: &mut Svg<'_>, reach: f64, view: &View, (left, top): (f64, f64)) {
        let axis = ticks::inside(-reach, reach, 7);
        let scale = view.scale;
        svg.begin_group("grid", &[]);
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
                Stroke::solid(Color::Rule, 1.0)
            } else {
                Stroke::solid(Color::Grid, 1.0)
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
        svg.end_group();
        svg.frame(left, top, BOX, BOX, Stroke::solid(Color::Rule, 1.0));
        svg.text(
            view.center.0,
            bottom + 41.0,
            &format!("{} ({})", across.0, self.unit),
            TextStyle::new(LABEL, Anchor::Middle),
        );
        svg.text(
            left - 44.0,
            view.center.1,
            &format!("{upwards} ({})", self.unit),
            TextStyle::new(LABEL, Anchor::Middle).upwards(),
        );
    }
}

pub(super) fn clearance_stroke() -> Stroke {
    Stroke::solid(Color::Ink, 1.8)
}

pub(super) fn half_stroke() -> Stroke {
    Stroke {
        color: Color::Rule,
        width: 1.2,
        dash: "5 4",
    }
}

/// Index of the first sample of the last cycle; 0 where all is one cycle or there is no angle.
pub(super) fn last_cycle(cell: &Cell<'_>, period: f64) -> usize {
    match cell.angle.last() {
        Some(end) => cell
            .angle
            .iter()
            .position(|angle| *angle >= end - period - 1e-6)
            .unwrap_or(0),
        None => 0,
    }
}

/// Multiples of 90° between `start` and the end: angle within the cycle (°) and place, linear between samples.
pub(super) fn marks(cell: &Cell<'_>, start: usize, period: f64) -> Vec<(i64, f64, f64)> {
    let mut found: Vec<(i64, f64, f64)> = Vec::new();
    let samples = cell.angle.len().min(cell.x.len()).min(cell.y.len());
    let quarter = |angle: f64| ((angle + 1e-6) / 90.0).floor();
    // a hundred revolutions are no cycle
    let period = if period > 0.0 && period <= 36_000.0 {
        period
    } else {
        360.0
    };
    let last = match cell.angle.get(start) {
        Some(first) => first + period - 1e-6,
        None => return found,
    };
    for index in start..samples {
        let here = cell.angle[index];
        // the first sample has a mark only where it stands on one
        let before = if index > start { index - 1 } else { index };
        let width = here - cell.angle[before];
        // an angle that runs backwards, jumps, is no number or so large that 90° are lost in it has no marks
        if !(0.0..=period).contains(&width) || here.abs() >= 1e9 {
            continue;
        }
        let mut mark = if index > start {
            90.0 * (quarter(cell.angle[before]) + 1.0)
        } else {
            90.0 * ((here - 1e-6) / 90.0).ceil()
        };
        while mark <= here + 1e-6 && mark < last {
            let share = if width > 0.0 {
                ((mark - cell.angle[before]) / width).clamp(0.0, 1.0)
            } else {
                1.0
            };
            let between = |v: &[f64]| v[before] + share * (v[index] - v[before]);
            let (x, y) = (between(&cell.x), between(&cell.y));
            let angle = mark - period * ((mark + 1e-6) / period).floor();
            if x.is_finite() && y.is_finite() {
                found.push((angle.round() as i64, x, y));
            }
            mark += 90.0;
        }
    }
    found
}

pub(super) fn limit_stroke() -> Stroke {
    Stroke {
        color: Color::Series(1),
        width: 1.8,
        dash: "9 4",
    }
}

fn draw_path(
    svg: &mut Svg<'_>,
    cell: &Cell<'_>,
    view: &View,
    range: std::ops::Range<usize>,
    stroke: Stroke,
) {
    let end = range.end.min(cell.x.len()).min(cell.y.len());
    let mut points = Vec::new();
    let mut angles = Vec::new();
    let mut finish = |points: &mut Vec<(f64, f64)>, angles: &mut Vec<f64>| {
        let kept = decimate::thinned(points, 0.3);
        let tag = CurveTag {
            name: cell.name,
            angles: if angles.len() == points.len() {
                kept.iter()
                    .filter_map(|i| angles.get(*i).copied())
                    .collect()
            } else {
                Vec::new()
            },
            ..CurveTag::default()
        };
        let kept: Vec<(f64, f64)> = kept
            .iter()
            .filter_map(|i| points.get(*i).copied())
            .collect();
        svg.curve(&kept, stroke, &tag);
        points.clear();
        angles.clear();
    };
    for index in range.start.min(end)..end {
        let point = view.point(cell.x[index], cell.y[index]);
        if point.0.is_finite() && point.1.is_finite() {
            points.push(point);
            angles.extend(cell.angle.get(index));
        } else {
            finish(&mut points, &mut angles);
        }
    }
    finish(&mut points, &mut angles);
}

/// Where a mark belongs, for the page's script.
fn place_of(place: (f64, f64)) -> [(&'static str, String); 2] {
    [
        ("data-x", coordinate(place.0)),
        ("data-y", coordinate(place.1)),
    ]
}

/// Three digits, without trailing zeros.
pub(super) fn significant(value: f64) -> String {
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

/// What stands in the key.
#[derive(Clone, Copy, Debug)]
pub(super) enum KeyKind {
    Clearance,
    Half,
    Limit,
    Last,
    Earlier,
    Mark,
}

struct KeyEntry {
    kind: KeyKind,
    text: String,
    x: f64,
    y: f64,
}

impl KeyEntry {
    fn draw(&self, svg: &mut Svg<'_>) {
        let (from, to) = ((self.x, self.y), (self.x + 32.0, self.y));
        match self.kind {
            KeyKind::Clearance => svg.line(from, to, clearance_stroke()),
            KeyKind::Half => svg.line(from, to, half_stroke()),
            KeyKind::Limit => svg.line(from, to, limit_stroke()),
            KeyKind::Last => svg.line(from, to, Stroke::solid(Color::Series(0), 2.2)),
            KeyKind::Earlier => svg.line(from, to, Stroke::solid(Color::Pale, 1.6)),
            KeyKind::Mark => svg.circle(
                (self.x + 16.0, self.y),
                4.2,
                Some(Color::Sheet),
                Stroke::solid(Color::Series(1), 1.8),
            ),
        }
        svg.text(
            self.x + 40.0,
            self.y + NUMBER * 0.36,
            &self.text,
            TextStyle::new(NUMBER, Anchor::Start),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
