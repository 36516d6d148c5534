//! Spectra one behind the other.

use super::super::axes::{Area, SMALL, Scaled, WIDTH};
use super::super::palette::Color;
use super::super::svg::{Anchor, CurveTag, Stroke, Svg, Target, TextStyle, coordinate};
use super::super::{decimate, ticks};
use super::SweepFigure;

/// Spectra one behind the other, the highest speed at the back.
#[derive(Clone, Debug, PartialEq)]
pub struct Waterfall {
    /// The amplitudes over speed.
    pub figure: SweepFigure,
}

impl Waterfall {
    pub(crate) fn draw(&self, target: Target<'_>) -> String {
        let figure = &self.figure;
        let map = &figure.map;
        let left = 116.0;
        // choices: the lines share 460 pixels, few of them do not stand far apart, and many remain distinct.
        // A peak rises over some lines behind it
        let spacing = (460.0 / map.speeds().len().max(1) as f64).clamp(6.0, 46.0);
        let rise = (spacing * 6.0).clamp(90.0, 220.0);
        let area = Area {
            left,
            top: 116.0,
            width: WIDTH - left - 96.0,
            height: rise + spacing * map.speeds().len().max(1) as f64,
        };
        let mut svg = Svg::new(WIDTH, area.bottom() + 78.0, &figure.title, target);
        figure.head(&mut svg, left);
        let (name, unit) = figure.axis_name();
        let x = Scaled::plain(ticks::inside(0.0, figure.reach(), 10), name, unit);
        let (low, high) = ticks::extent(map.amplitudes().iter().flatten().copied());
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
        let rows: Vec<_> = map
            .speeds()
            .iter()
            .zip(map.amplitudes())
            .enumerate()
            .collect();
        for (row, (speed, amplitudes)) in rows.iter().rev() {
            let base = front - *row as f64 * spacing;
            let inside = map
                .positions()
                .iter()
                // positions are multiples of a step, and round
                .take_while(|p| **p <= x.ticks.range.1 * (1.0 + 1e-9))
                .count();
            let (positions, amplitudes) = (
                map.positions().get(..inside).unwrap_or_default(),
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
                let name = format!("{speed} rpm");
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
        draw_labels(&mut svg, &area, (name, unit), &figure.value_label());
        svg.finish()
    }
}

/// The names of the axes, and of the quantity that rises from each line.
fn draw_labels(svg: &mut Svg<'_>, area: &Area, (name, unit): (&str, &str), value: &str) {
    svg.text(
        area.right(),
        area.top - 10.0,
        &format!("upwards from each line: {}", value),
        TextStyle::new(SMALL + 1.0, Anchor::End),
    );
    area.label(svg, &format!("{name} ({unit})"), "Speed (rpm)");
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
