//! Amplitudes over speed: a waterfall of curves, and a Campbell diagram.

use super::axes::{Area, Scaled};
use super::font::text_width;
use super::palette::{Color, LEVEL_COUNT};
use super::svg::{Anchor, CurveTag, Stroke, Svg, Target, TextStyle, coordinate};
use super::{decimate, ticks};
use crate::escape::base64;
use crate::signal::{Axis, SweepMap};

const WIDTH: f64 = 1200.0;
const TITLE: f64 = 22.0;
const LABEL: f64 = 16.0;
const SMALL: f64 = 13.0;
/// Cells of a speed at most: more are merged, the largest amplitude stays.
const ROWS: usize = 320;

/// What both diagrams say of themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepFigure {
    /// Title.
    pub title: String,
    /// Stands under the title: model, analysis, window, resolution.
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

/// Spectra one behind the other, the highest speed at the back.
#[derive(Clone, Debug, PartialEq)]
pub struct Waterfall {
    /// What is shown.
    pub figure: SweepFigure,
}

/// Colours over speed and frequency, with the lines of orders and of natural frequencies.
#[derive(Clone, Debug, PartialEq)]
pub struct Campbell {
    /// What is shown.
    pub figure: SweepFigure,
    /// Orders to draw a line for.
    pub orders: Vec<f64>,
    /// Natural frequencies (Hz) with names, drawn across.
    pub natural_frequencies: Vec<(String, f64)>,
}

impl SweepFigure {
    fn axis_name(&self) -> (&'static str, &'static str) {
        match self.map.axis {
            Axis::Frequency => ("Frequency", "Hz"),
            Axis::Order => ("Order", "cycles a revolution"),
        }
    }

    fn value_label(&self) -> String {
        let frame = if self.frame.is_empty() {
            String::new()
        } else {
            format!(", axes of {}", self.frame)
        };
        format!("{} ({}){frame}", self.quantity, self.unit)
    }

    fn reach(&self) -> f64 {
        let end = self.map.positions.last().copied().unwrap_or(1.0);
        self.limit.map_or(end, |limit| limit.min(end))
    }

    fn head(&self, svg: &mut Svg<'_>, left: f64) {
        svg.text(
            left,
            42.0,
            &self.title,
            TextStyle::new(TITLE, Anchor::Start).bold(),
        );
        svg.text(
            left,
            68.0,
            &self.subtitle,
            TextStyle::new(SMALL + 1.0, Anchor::Start).soft(),
        );
    }
}

impl Waterfall {
    /// The figure as SVG, 1200 pixels wide, a file of its own.
    pub fn to_svg(&self) -> String {
        self.draw(Target::PAPER)
    }

    pub(crate) fn draw(&self, target: Target<'_>) -> String {
        let figure = &self.figure;
        let map = &figure.map;
        let left = 116.0;
        let spacing = (460.0 / map.speeds.len().max(1) as f64).clamp(6.0, 46.0);
        let rise = (spacing * 6.0).clamp(90.0, 220.0);
        let area = Area {
            left,
            top: 116.0,
            width: WIDTH - left - 96.0,
            height: rise + spacing * map.speeds.len().max(1) as f64,
        };
        let mut svg = Svg::new(WIDTH, area.bottom() + 78.0, &figure.title, target);
        figure.head(&mut svg, left);
        let (name, unit) = figure.axis_name();
        let x = Scaled::plain(ticks::inside(0.0, figure.reach(), 10), name, unit);
        let (low, high) = ticks::extent(map.amplitudes.iter().flatten().copied());
        // levels count from the lowest, amplitudes from 0
        let low = if low < 0.0 { low } else { 0.0 };
        let ticks = ticks::rounded(low, high, 2);
        let gain = rise / (ticks.range.1 - ticks.range.0);
        // the panel's ordinate is the amplitude over the frontmost base line
        let front = area.bottom() - spacing / 2.0;
        let y = Scaled {
            numbers: Vec::new(),
            ..Scaled::plain(
                ticks::Ticks {
                    range: (
                        ticks.range.0 - (area.bottom() - front) / gain,
                        ticks.range.0 + (front - area.top) / gain,
                    ),
                    values: Vec::new(),
                    step: ticks.step,
                },
                &figure.quantity,
                &figure.unit,
            )
        };
        area.begin_panel(
            &mut svg,
            &x,
            &y,
            &[
                ("data-front", coordinate(front)),
                ("data-fixed-y", "yes".to_owned()),
            ],
        );
        area.draw(&mut svg, &x, &y, true);
        svg.begin_clip(area.left, area.top, area.width, area.height);
        let rows: Vec<_> = map.speeds.iter().zip(&map.amplitudes).enumerate().collect();
        for (row, (speed, amplitudes)) in rows.iter().rev() {
            let base = front - *row as f64 * spacing;
            let inside = map
                .positions
                .iter()
                .take_while(|p| **p <= x.ticks.range.1 * (1.0 + 1e-9))
                .count();
            let (positions, amplitudes) = (
                map.positions.get(..inside).unwrap_or_default(),
                amplitudes.get(..inside).unwrap_or_default(),
            );
            for run in decimate::runs(positions, amplitudes, x.ticks.range, area.width as usize) {
                let mut points: Vec<(f64, f64)> = run
                    .into_iter()
                    .map(|(p, a)| (area.x(p, &x.ticks), base - gain * (a - ticks.range.0)))
                    .collect();
                let (Some(first), Some(last)) = (points.first().copied(), points.last().copied())
                else {
                    continue;
                };
                points.push((last.0, base));
                points.push((first.0, base));
                svg.polygon(&points, Color::Sheet);
                points.truncate(points.len() - 2);
                let name = format!("{speed} 1/min");
                let tag = CurveTag {
                    name: &name,
                    base: Some(base),
                    ..CurveTag::default()
                };
                svg.curve(&points, Stroke::solid(Color::Series(0), 1.3), &tag);
            }
        }
        svg.end_clip();
        // as many speeds as have room
        let every = (18.0 / spacing).ceil().max(1.0) as usize;
        for (row, (speed, _)) in &rows {
            if row % every == 0 {
                svg.text(
                    area.left - 10.0,
                    front - *row as f64 * spacing + 5.0,
                    &ticks::number(**speed, 1.0),
                    TextStyle::new(SMALL, Anchor::End),
                );
            }
        }
        svg.end_group();
        draw_measure(
            &mut svg,
            (area.right() + 14.0, area.top + 10.0),
            gain,
            &ticks,
            &figure.unit,
        );
        svg.text(
            area.right(),
            area.top - 10.0,
            &format!("upwards from each line: {}", figure.value_label()),
            TextStyle::new(SMALL + 1.0, Anchor::End),
        );
        svg.text(
            area.left + area.width / 2.0,
            area.bottom() + 56.0,
            &format!("{name} ({unit})"),
            TextStyle::new(LABEL, Anchor::Middle),
        );
        svg.text(
            40.0,
            area.top + area.height / 2.0,
            "Speed (1/min)",
            TextStyle::new(LABEL, Anchor::Middle).upwards(),
        );
        svg.finish()
    }
}

/// A bar as long as one step of the amplitudes.
fn draw_measure(
    svg: &mut Svg<'_>,
    (x, y): (f64, f64),
    gain: f64,
    ticks: &ticks::Ticks,
    unit: &str,
) {
    let length = gain * ticks.step;
    let stroke = Stroke::solid(Color::Ink, 1.5);
    svg.line((x + 8.0, y), (x + 8.0, y + length), stroke);
    svg.line((x + 4.0, y), (x + 12.0, y), stroke);
    svg.line((x + 4.0, y + length), (x + 12.0, y + length), stroke);
    let exponent = ticks::exponent((0.0, ticks.step));
    let factor = libm::pow(10.0, f64::from(exponent));
    let mut text = ticks::number(ticks.step / factor, ticks.step / factor);
    if exponent != 0 {
        text.push_str(&format!("·{}", ticks::power_of_ten(exponent)));
    }
    svg.text(
        x + 28.0,
        y + length / 2.0,
        &format!("{text} {unit}"),
        TextStyle::new(SMALL, Anchor::Middle).upwards(),
    );
}

impl Campbell {
    /// The figure as SVG, 1200 pixels wide, a file of its own.
    pub fn to_svg(&self) -> String {
        self.draw(Target::PAPER)
    }

    pub(crate) fn draw(&self, target: Target<'_>) -> String {
        let figure = &self.figure;
        let map = &figure.map;
        let area = Area {
            left: 116.0,
            top: 110.0,
            width: 856.0,
            height: 520.0,
        };
        let mut svg = Svg::new(WIDTH, area.bottom() + 78.0, &figure.title, target);
        figure.head(&mut svg, area.left);
        let edges = edges(&map.speeds);
        let (from, to) = match (edges.first(), edges.last()) {
            (Some(from), Some(to)) => (*from, *to),
            _ => (0.0, 1.0),
        };
        let x = Scaled::plain(ticks::inside(from, to, 9), "Speed", "1/min");
        let (name, unit) = figure.axis_name();
        let y = Scaled::plain(ticks::inside(0.0, figure.reach(), 9), name, unit);
        let cells = Cells::new(map, y.ticks.range.1);
        let (low, high) = ticks::extent(cells.values.iter().flatten().copied());
        let levels = ticks::rounded(if low < 0.0 { low } else { 0.0 }, high, 5);
        area.begin_panel(&mut svg, &x, &y, &cells.attributes(&edges, figure));
        area.draw(&mut svg, &x, &y, true);
        svg.begin_clip(area.left, area.top, area.width, area.height);
        draw_cells(&mut svg, &area, (&x, &y), &cells, &edges, levels.range);
        svg.end_clip();
        self.draw_orders(&mut svg, &area, (&x, &y));
        self.draw_natural_frequencies(&mut svg, &area, &y);
        svg.end_group();
        draw_levels(&mut svg, &area, &levels, &figure.value_label());
        svg.text(
            area.left + area.width / 2.0,
            area.bottom() + 56.0,
            "Speed (1/min)",
            TextStyle::new(LABEL, Anchor::Middle),
        );
        svg.text(
            40.0,
            area.top + area.height / 2.0,
            &format!("{name} ({unit})"),
            TextStyle::new(LABEL, Anchor::Middle).upwards(),
        );
        svg.finish()
    }

    fn draw_orders(&self, svg: &mut Svg<'_>, area: &Area, (x, y): (&Scaled, &Scaled)) {
        let stroke = Stroke {
            color: Color::OnMap,
            width: 1.2,
            dash: "6 4",
        };
        let (from, to) = x.ticks.range;
        let top = y.ticks.range.1;
        for order in &self.orders {
            let at = |speed: f64| match self.figure.map.axis {
                Axis::Frequency => order * speed / 60.0,
                Axis::Order => *order,
            };
            let end = if at(to) > top && at(to) > at(from) {
                from + (to - from) * (top - at(from)) / (at(to) - at(from))
            } else {
                to
            };
            if end <= from || at(from) > top {
                continue;
            }
            let place = |speed: f64| (area.x(speed, &x.ticks), area.y(at(speed), &y.ticks));
            let tag = CurveTag::default();
            svg.begin_clip(area.left, area.top, area.width, area.height);
            svg.curve(&[place(from), place(end)], stroke, &tag);
            svg.end_clip();
            let (right, height) = place(end);
            let beyond = end < to;
            svg.begin_group(
                "mark",
                &[
                    ("data-x", coordinate(right)),
                    ("data-y", coordinate(height)),
                ],
            );
            svg.text(
                right + if beyond { 0.0 } else { 4.0 },
                height + if beyond { -6.0 } else { 4.0 },
                &format!("order {order}"),
                TextStyle::new(
                    SMALL,
                    if beyond {
                        Anchor::Middle
                    } else {
                        Anchor::Start
                    },
                ),
            );
            svg.end_group();
        }
    }

    fn draw_natural_frequencies(&self, svg: &mut Svg<'_>, area: &Area, y: &Scaled) {
        if self.figure.map.axis != Axis::Frequency {
            return;
        }
        for (name, frequency) in &self.natural_frequencies {
            if !(y.ticks.range.0..=y.ticks.range.1).contains(frequency) {
                continue;
            }
            let at = area.y(*frequency, &y.ticks);
            svg.begin_group("mark", &[("data-y", coordinate(at))]);
            svg.line(
                (area.left, at),
                (area.right(), at),
                Stroke {
                    color: Color::Series(1),
                    width: 1.4,
                    dash: "2.5 3",
                },
            );
            svg.text(
                area.left + 6.0,
                at - 4.0,
                &format!("{name}, {frequency:.0} Hz"),
                TextStyle::new(SMALL, Anchor::Start).on_map(),
            );
            svg.end_group();
        }
    }
}

/// Amplitudes merged to few enough cells.
struct Cells {
    /// A column a speed, each from the lowest position up.
    values: Vec<Vec<f64>>,
    /// Lower end and height of a cell (Hz, or orders).
    start: f64,
    step: f64,
}

impl Cells {
    fn new(map: &SweepMap, reach: f64) -> Cells {
        let step = match map.positions.as_slice() {
            [first, second, ..] => second - first,
            _ => 1.0,
        };
        let count = map
            .positions
            .iter()
            .take_while(|p| **p <= reach * (1.0 + 1e-9))
            .count();
        let merged = count.div_ceil(ROWS).max(1);
        let values = map
            .amplitudes
            .iter()
            .map(|row| {
                row.get(..count.min(row.len()))
                    .unwrap_or_default()
                    .chunks(merged)
                    .map(|chunk| {
                        chunk
                            .iter()
                            .copied()
                            .filter(|v| !v.is_nan())
                            .reduce(f64::max)
                            .unwrap_or(f64::NAN)
                    })
                    .collect()
            })
            .collect();
        Cells {
            values,
            start: -step / 2.0,
            step: step * merged as f64,
        }
    }

    /// The numbers for the readout.
    fn attributes(&self, edges: &[f64], figure: &SweepFigure) -> Vec<(&'static str, String)> {
        let rows = self.values.iter().map(Vec::len).max().unwrap_or(0);
        let bytes: Vec<u8> = self
            .values
            .iter()
            .flatten()
            .flat_map(|v| (*v as f32).to_le_bytes())
            .collect();
        let edges: Vec<String> = edges.iter().map(|e| format!("{e}")).collect();
        let speeds: Vec<String> = figure.map.speeds.iter().map(|s| format!("{s}")).collect();
        vec![
            ("data-map", base64(&bytes)),
            ("data-map-rows", rows.to_string()),
            ("data-map-edges", edges.join(" ")),
            ("data-map-speeds", speeds.join(" ")),
            ("data-map-start", format!("{}", self.start)),
            ("data-map-step", format!("{}", self.step)),
            ("data-map-name", figure.quantity.clone()),
            ("data-map-unit", figure.unit.clone()),
        ]
    }
}

/// Halfway between speeds, and as far beyond the ends.
fn edges(speeds: &[f64]) -> Vec<f64> {
    match speeds {
        [] => Vec::new(),
        [only] => vec![only - 50.0, only + 50.0],
        _ => {
            let middles: Vec<f64> = speeds
                .windows(2)
                .filter_map(|pair| Some((pair.first()? + pair.last()?) / 2.0))
                .collect();
            let mut edges = Vec::with_capacity(speeds.len() + 1);
            if let (Some(speed), Some(middle)) = (speeds.first(), middles.first()) {
                edges.push(2.0 * speed - middle);
            }
            edges.extend(&middles);
            if let (Some(speed), Some(middle)) = (speeds.last(), middles.last()) {
                edges.push(2.0 * speed - middle);
            }
            edges
        }
    }
}

/// The cells, those of one level in one path, neighbours of one level as one rectangle.
fn draw_cells(
    svg: &mut Svg<'_>,
    area: &Area,
    (x, y): (&Scaled, &Scaled),
    cells: &Cells,
    edges: &[f64],
    (low, high): (f64, f64),
) {
    let level = |value: f64| -> Option<usize> {
        let share = (value - low) / (high - low);
        share
            .is_finite()
            .then(|| (share.clamp(0.0, 1.0) * LEVEL_COUNT as f64) as usize)
            .map(|level| level.min(LEVEL_COUNT - 1))
    };
    let mut paths: Vec<Vec<(f64, f64, f64, f64)>> = vec![Vec::new(); LEVEL_COUNT];
    for (column, side) in cells.values.iter().zip(edges.windows(2)) {
        let [from, to] = side else { continue };
        let (left, right) = (area.x(*from, &x.ticks), area.x(*to, &x.ticks));
        let mut row = 0;
        while let Some(value) = column.get(row) {
            let this = level(*value);
            let run = column
                .iter()
                .skip(row)
                .take_while(|v| level(**v) == this)
                .count();
            let bottom = cells.start + row as f64 * cells.step;
            let top = bottom + run as f64 * cells.step;
            if let Some(path) = this.and_then(|level| paths.get_mut(level)) {
                let (upper, lower) = (area.y(top, &y.ticks), area.y(bottom, &y.ticks));
                path.push((left, upper, right - left, lower - upper));
            }
            row += run.max(1);
        }
    }
    for (level, path) in paths.iter().enumerate() {
        svg.cells(path, Color::Level(level));
    }
}

/// The colours with their numbers.
fn draw_levels(svg: &mut Svg<'_>, area: &Area, levels: &ticks::Ticks, label: &str) {
    let (left, width) = (area.right() + 84.0, 20.0);
    let height = area.height / LEVEL_COUNT as f64;
    for level in 0..LEVEL_COUNT {
        svg.area(
            left,
            area.bottom() - (level + 1) as f64 * height,
            width,
            height + 0.3,
            Color::Level(level),
        );
    }
    let exponent = ticks::exponent(levels.range);
    let factor = libm::pow(10.0, f64::from(exponent));
    let mut widest = 0.0f64;
    for value in &levels.values {
        let at = area.y(*value, levels);
        let number = ticks::number(value / factor, levels.step / factor);
        widest = widest.max(text_width(&number, SMALL, false));
        svg.line(
            (left + width, at),
            (left + width + 5.0, at),
            Stroke::solid(Color::Rule, 1.0),
        );
        svg.text(
            left + width + 9.0,
            at + SMALL * 0.36,
            &number,
            TextStyle::new(SMALL, Anchor::Start),
        );
    }
    let label = if exponent == 0 {
        label.to_owned()
    } else {
        format!("{} · {label}", ticks::power_of_ten(exponent))
    };
    svg.text(
        left + width + 9.0 + widest + 22.0,
        area.top + area.height / 2.0,
        &label,
        TextStyle::new(LABEL - 1.0, Anchor::Middle).upwards(),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure() -> SweepFigure {
        let positions: Vec<f64> = (0..2000).map(f64::from).collect();
        let speeds = vec![1000.0, 1500.0, 2500.0];
        SweepFigure {
            title: "Run-up <1>".to_owned(),
            subtitle: String::new(),
            quantity: "Acceleration x".to_owned(),
            unit: "m/s²".to_owned(),
            frame: "block".to_owned(),
            map: SweepMap {
                axis: Axis::Frequency,
                amplitudes: speeds
                    .iter()
                    .map(|speed| {
                        positions
                            .iter()
                            .map(|p| {
                                if (p - speed / 30.0).abs() < 0.5 {
                                    7.0
                                } else {
                                    0.1
                                }
                            })
                            .collect()
                    })
                    .collect(),
                positions,
                speeds,
            },
            limit: None,
        }
    }

    #[test]
    fn edges_lie_halfway_between_speeds() {
        assert_eq!(
            edges(&[1000.0, 1500.0, 2500.0]),
            [750.0, 1250.0, 2000.0, 3000.0]
        );
        assert_eq!(edges(&[1000.0]).len(), 2);
        assert!(edges(&[]).is_empty());
    }

    #[test]
    fn merged_cells_keep_the_peaks() {
        let figure = figure();
        let cells = Cells::new(&figure.map, 1999.0);
        assert!(cells.values.iter().all(|column| column.len() <= ROWS));
        for column in &cells.values {
            assert_eq!(column.iter().copied().fold(0.0, f64::max), 7.0);
        }
    }

    #[test]
    fn diagrams_are_drawn_whatever_the_map() {
        let mut figure = figure();
        let campbell = Campbell {
            figure: figure.clone(),
            orders: vec![2.0, 4.0, 1000.0],
            natural_frequencies: vec![("first".to_owned(), 800.0), ("far".to_owned(), 1e5)],
        };
        let svg = campbell.to_svg();
        assert!(svg.contains(">order 2<") && svg.contains(">order 4<") && !svg.contains(">far"));
        assert!(svg.contains("first, 800 Hz") && !svg.contains("NaN"));
        assert!(svg.contains("Acceleration x (m/s²), axes of block"));
        let waterfall = |figure| Waterfall { figure }.to_svg();
        assert_eq!(waterfall(figure.clone()).matches("<polyline").count(), 3);
        figure.map.amplitudes[0][3] = f64::NAN;
        assert!(!waterfall(figure.clone()).contains("NaN"));
        figure.map.speeds.clear();
        figure.map.amplitudes.clear();
        figure.map.positions.clear();
        let empty = Campbell {
            figure: figure.clone(),
            ..campbell
        };
        for svg in [waterfall(figure), empty.to_svg()] {
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }
}
