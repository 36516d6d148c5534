//! Colours over speed and frequency, with the lines of orders and of natural frequencies.

use super::super::axes::{Area, SMALL, Scaled, WIDTH};
use super::super::levels::draw_levels;
use super::super::palette::Color;
use super::super::svg::{Anchor, CurveTag, Stroke, Svg, Target, TextStyle, coordinate};
use super::super::ticks;
use super::SweepFigure;
use super::cells::{Cells, draw_cells, edges};
use crate::signal::Axis;

/// Colours over speed and frequency, with the lines of orders and of natural frequencies.
#[derive(Clone, Debug, PartialEq)]
pub struct Campbell {
    /// The amplitudes over speed.
    pub figure: SweepFigure,
    /// Orders with a line.
    pub orders: Vec<f64>,
    /// Natural frequencies (Hz) with names, drawn across.
    pub natural_frequencies: Vec<(String, f64)>,
    /// Speeds (rpm) and natural frequencies (Hz), each with a mark.
    pub modes: Vec<(f64, f64)>,
}

impl Campbell {
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
        let edges = edges(map.speeds());
        let (from, to) = match (edges.first(), edges.last()) {
            (Some(from), Some(to)) => (*from, *to),
            _ => (0.0, 1.0),
        };
        let x = Scaled::plain(ticks::inside(from, to, 9), "Speed", "rpm");
        let (name, unit) = figure.axis_name();
        let y = Scaled::plain(ticks::inside(0.0, figure.reach(), 9), name, unit);
        let cells = Cells::new(map, y.ticks.range.1);
        let (low, high) = ticks::extent(cells.values.iter().flatten().copied());
        // decibels have no zero to begin at
        let from_low = low < 0.0 || figure.unit.starts_with("dB");
        let levels = ticks::rounded(if from_low { low } else { 0.0 }, high, 5);
        area.begin_panel(&mut svg, &x, &y, &cells.attributes(&edges, figure));
        area.draw(&mut svg, &x, &y, true);
        svg.begin_clip(area.left, area.top, area.width, area.height);
        draw_cells(&mut svg, &area, (&x, &y), &cells, &edges, levels.range);
        svg.end_clip();
        self.draw_orders(&mut svg, &area, (&x, &y));
        self.draw_natural_frequencies(&mut svg, &area, &y);
        self.draw_modes(&mut svg, &area, (&x, &y));
        svg.end_group();
        draw_levels(&mut svg, &area, &levels, &figure.value_label());
        area.label(&mut svg, "Speed (rpm)", &format!("{name} ({unit})"));
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
            let at = |speed: f64| match self.figure.map.axis() {
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
        if self.figure.map.axis() != Axis::Frequency {
            return;
        }
        let mut named = f64::INFINITY;
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
            // of names that would overlap only one is drawn
            if (named - at).abs() > SMALL + 2.0 {
                named = at;
                svg.text(
                    area.left + 6.0,
                    at - 4.0,
                    &format!("{name}, {frequency:.0} Hz"),
                    TextStyle::new(SMALL, Anchor::Start).on_map(),
                );
            }
            svg.end_group();
        }
    }

    fn draw_modes(&self, svg: &mut Svg<'_>, area: &Area, (x, y): (&Scaled, &Scaled)) {
        for (speed, frequency) in &self.modes {
            let place = match self.figure.map.axis() {
                Axis::Frequency => *frequency,
                Axis::Order => frequency * 60.0 / speed,
            };
            let inside = |value: f64, (from, to): (f64, f64)| (from..=to).contains(&value);
            if !(inside(*speed, x.ticks.range) && inside(place, y.ticks.range)) {
                continue;
            }
            let at = (area.x(*speed, &x.ticks), area.y(place, &y.ticks));
            svg.begin_group(
                "mark",
                &[("data-x", coordinate(at.0)), ("data-y", coordinate(at.1))],
            );
            svg.circle(at, 4.5, None, Stroke::solid(Color::MapSeam, 4.0));
            svg.circle(at, 4.5, None, Stroke::solid(Color::OnMap, 1.8));
            svg.end_group();
        }
    }
}
