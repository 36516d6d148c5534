//! Paths in a plane, each in a square with equal axes. Orbits and polar diagrams share this code.

use super::key::{self, KeyKind};
use super::marks::{draw_marks, marks};
use super::palette::Color;
use super::svg::{Anchor, CurveTag, Stroke, Svg, Target, TextStyle, coordinate};
use super::{decimate, ticks};

const LABEL: f64 = 15.0;
const NUMBER: f64 = 14.0;
const SMALL: f64 = 13.0;
/// Side of a square, and the cell with its texts. Choices of layout.
const BOX: f64 = 308.0;
const CELL: (f64, f64) = (392.0, 424.0);

/// The axis that points up in the picture; z points at the viewer.
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
    /// The unit of the axes for the readout, after `x` and `y`.
    pub unit: &'a str,
    /// The key's entries besides those of the path.
    pub key: Vec<(KeyKind, String)>,
    /// The name of the path if there is only one cycle.
    pub path: &'static str,
    pub cells: Vec<Cell<'a>>,
}

/// One square.
pub(crate) struct Cell<'a> {
    pub name: &'a str,
    /// Numbers above its right corner.
    pub facts: String,
    /// The text below the name.
    pub frame: String,
    /// Coordinates in the sheet's unit.
    pub x: Vec<f64>,
    /// Coordinates in the sheet's unit.
    pub y: Vec<f64>,
    /// Crank angle of each sample (°); empty if there is none.
    pub angle: &'a [f64],
    /// Index of the first sample of the last cycle; 0 if all samples are one cycle or have no angle.
    pub last_cycle: usize,
    /// Distance from the middle to a side, in the sheet's unit.
    pub reach: f64,
    /// Circles about the origin.
    pub circles: Vec<(f64, Stroke)>,
}

/// The map from the cell's axes to pixels.
pub(crate) struct View {
    pub center: (f64, f64),
    /// Pixels per unit.
    pub scale: f64,
    pub upright: Upright,
}

impl View {
    pub fn point(&self, x: f64, y: f64) -> (f64, f64) {
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
        let (key, key_rows) = key::laid_out(self.kinds(), width - 80.0);
        let top = 92.0 + 26.0 * key_rows as f64;
        let height = top + rows as f64 * CELL.1 + 16.0;
        let mut svg = Svg::new(width, height, self.title, target);
        svg.head(40.0, width - 80.0, self.title, self.subtitle);
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

    /// The entries of the key.
    fn kinds(&self) -> Vec<(KeyKind, String)> {
        let mut kinds = self.key.clone();
        if self.cells.iter().any(|o| o.last_cycle > 0) {
            kinds.push((KeyKind::Last, "last cycle".to_owned()));
            kinds.push((KeyKind::Earlier, "earlier".to_owned()));
        } else {
            kinds.push((KeyKind::Last, self.path.to_owned()));
        }
        if self.cells.iter().any(|o| !o.angle.is_empty()) {
            kinds.push((KeyKind::Mark, "every 90 °CA".to_owned()));
        }
        kinds
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
        let start = cell.last_cycle;
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
        let rings: Vec<(i64, (f64, f64))> = marks(cell, self.period)
            .into_iter()
            .map(|(angle, x, y)| (angle, view.point(x, y)))
            .collect();
        draw_marks(svg, &rings, (left, top), BOX);
        svg.end_group();
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
        for value in axis.values.iter().filter(|v| v.abs() <= reach) {
            let x = view.center.0 + across.1 * scale * value;
            let y = view.center.1 - scale * value;
            // a sum of steps rounds, so the mark of zero is not exactly zero
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
        // points that are nearer to each other (pixels) are drawn as one. A choice: a line is wider
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
