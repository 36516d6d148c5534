//! Curves against crank angle, time, frequency, order or speed, one panel or several above each other.

use super::abscissa::{Abscissa, Second};
use super::axes::{Area, LABEL, RIGHT, SMALL, Scale, Scaled, WIDTH};
use super::legend::{curve_stroke, draw_legend, legend_rows, mark_stroke};
use super::palette::Color;
use super::svg::{Anchor, CurveTag, Stroke, Svg, Target, TextStyle, coordinate};
use super::{decimate, ticks};

/// A place on the horizontal axis with a name, such as a firing dead centre: a thin line down the panels.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Its place on the abscissa, in the unit of the abscissa.
    pub at: f64,
    /// A short text at the top of the line.
    pub label: String,
    /// The distance at which the mark repeats, up to the end of the axis.
    pub period: Option<f64>,
    /// The meaning of such marks, for the legend; may be empty.
    pub meaning: String,
}

impl Mark {
    /// The firing dead centre of a cylinder at `angle` (°). It repeats after each `period` (°; 720 for a
    /// four-stroke engine). A cylinder without a number has the label `TDC`.
    pub fn firing_tdc(cylinder: Option<usize>, angle: f64, period: f64) -> Self {
        Mark {
            at: angle,
            label: cylinder.map_or_else(|| "TDC".to_owned(), |n| format!("TDC {n}")),
            period: Some(period),
            meaning: "TDC: firing dead centre of the cylinder".to_owned(),
        }
    }

    /// Places of the mark from `low` to `high`, at most a hundred.
    fn places(&self, (low, high): (f64, f64)) -> Vec<f64> {
        let slack = 1e-9 * (high - low).abs();
        let inside = |place: &f64| *place >= low - slack && *place <= high + slack;
        match self.period {
            Some(period) if period > 0.0 => {
                let first = ((low - slack - self.at) / period).ceil();
                (0..100)
                    .map(|turn| self.at + (first + f64::from(turn)) * period)
                    .take_while(inside)
                    .collect()
            }
            _ => Some(self.at).filter(inside).into_iter().collect(),
        }
    }
}

/// The name of the curve of the journal with this index (from 0): A, B, …, Z, then A1, B1, ….
pub fn journal_letter(index: usize) -> String {
    let letter = char::from(b'A' + (index % 26) as u8);
    match index / 26 {
        0 => letter.to_string(),
        round => format!("{letter}{round}"),
    }
}

/// The vertical axis of all panels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ordinate {
    /// `Force x on the pin`.
    pub quantity: String,
    /// `kN`.
    pub unit: String,
    /// The axes of the components; empty for a scalar.
    pub frame: String,
}

/// One named curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its name in the legend. Curves with one name have one colour in all panels.
    pub name: String,
    /// One value for each abscissa of its panel, in the ordinate's unit.
    pub values: Vec<f64>,
}

/// One pair of axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The text above the axes; may be empty.
    pub title: String,
    /// Crank angle in ° or time in s, in order of time.
    pub x: Vec<f64>,
    /// The curves.
    pub curves: Vec<Curve>,
}

/// A figure of histories. The panels share their axes, so that they can be compared.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// Title.
    pub title: String,
    /// The text below the title: model, analysis, filter.
    pub subtitle: String,
    /// Horizontal axis.
    pub abscissa: Abscissa,
    /// Vertical axis.
    pub ordinate: Ordinate,
    /// Scale of the vertical axis; a logarithmic one shows six decades at most.
    pub scale: Scale,
    /// Named places on the horizontal axis.
    pub marks: Vec<Mark>,
    /// From top to bottom.
    pub panels: Vec<Panel>,
}

impl History {
    pub(crate) fn draw(&self, target: Target<'_>) -> String {
        let horizontal = self.horizontal();
        let (vertical, exponent) = self.vertical();
        let left = vertical.left();
        let width = WIDTH - left - RIGHT;
        let names = self.names();
        let meanings = self.meanings();
        let legend = legend_rows(&names, &meanings, width);
        let top = 92.0 + 26.0 * legend.len() as f64;
        let titled = self.panels.iter().any(|p| !p.title.is_empty());
        let count = self.panels.len().max(1) as f64;
        let panel_height = if self.panels.len() <= 1 { 500.0 } else { 360.0 };
        let room = if self.marks.is_empty() { 0.0 } else { 18.0 };
        let gap = room + if titled { 46.0 } else { 28.0 };
        let above = self.abscissa.second();
        let head = if above.is_some() { 48.0 } else { 0.0 };
        let first = top + head + room + if titled { 30.0 } else { 0.0 };
        let bottom = first + count * panel_height + (count - 1.0) * gap;
        let mut svg = Svg::new(WIDTH, bottom + 78.0, &self.title, target);
        svg.head(left, width, &self.title, &self.subtitle);
        draw_legend(&mut svg, &legend, left);
        for (index, panel) in self.panels.iter().enumerate() {
            let area = Area {
                left,
                top: first + index as f64 * (panel_height + gap),
                width,
                height: panel_height,
            };
            let last = index + 1 == self.panels.len();
            let mut known = vec![("data-title", panel.title.clone())];
            known.extend(
                above
                    .as_ref()
                    .map(|second| (second.key, format!("{}", second.factor))),
            );
            area.begin_panel(&mut svg, &horizontal, &vertical, &known);
            area.draw(&mut svg, &horizontal, &vertical, last);
            if !panel.title.is_empty() {
                svg.text(
                    area.left,
                    area.top - 10.0 - room,
                    &panel.title,
                    TextStyle::new(LABEL, Anchor::Start).bold(),
                );
            }
            self.draw_marks(&mut svg, &area, &horizontal);
            if let (0, Some(second)) = (index, &above) {
                draw_second(&mut svg, &area, &horizontal, second);
            }
            draw_curves(&mut svg, &area, panel, &names, (&horizontal, &vertical));
            svg.end_group();
        }
        let (name, unit) = self.abscissa.name_and_unit();
        let below = if unit.is_empty() {
            name.to_owned()
        } else {
            format!("{name} ({unit})")
        };
        let all = Area {
            left,
            top: first,
            width,
            height: bottom - first,
        };
        all.label(&mut svg, &below, &self.ordinate.label(exponent));
        svg.finish()
    }

    fn horizontal(&self) -> Scaled {
        let (low, high) = ticks::extent(self.panels.iter().flat_map(|p| p.x.iter().copied()));
        let (name, unit) = self.abscissa.name_and_unit();
        match self.abscissa {
            Abscissa::CrankAngle => Scaled {
                kind: "angle",
                ..Scaled::plain(ticks::crank_angle(low, high, 14), name, unit)
            },
            _ => Scaled::plain(ticks::inside(low, high, 10), name, unit),
        }
    }

    /// The vertical axis and the power of ten in its label.
    fn vertical(&self) -> (Scaled, i32) {
        let values = || {
            self.panels
                .iter()
                .flat_map(|p| &p.curves)
                .flat_map(|c| c.values.iter().copied())
        };
        let (name, unit) = (&self.ordinate.quantity, &self.ordinate.unit);
        if self.scale == Scale::Logarithmic {
            let (low, high) = ticks::extent(values().filter(|v| *v > 0.0));
            return (Scaled::decades(low, high, 6, name, unit), 0);
        }
        let (low, high) = ticks::extent(values());
        Scaled::divided(ticks::rounded(low, high, 7), name, unit)
    }

    /// Names of all curves in order of appearance.
    fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for curve in self.panels.iter().flat_map(|p| &p.curves) {
            if !names.contains(&curve.name.as_str()) {
                names.push(&curve.name);
            }
        }
        names
    }

    /// The meanings of the visible marks, each once.
    fn meanings(&self) -> Vec<&str> {
        let range = self.horizontal().ticks.range;
        let mut meanings: Vec<&str> = Vec::new();
        for mark in &self.marks {
            let shown = !mark.meaning.is_empty() && !mark.places(range).is_empty();
            if shown && !meanings.contains(&mark.meaning.as_str()) {
                meanings.push(&mark.meaning);
            }
        }
        meanings
    }

    fn draw_marks(&self, svg: &mut Svg<'_>, area: &Area, horizontal: &Scaled) {
        for mark in &self.marks {
            for place in mark.places(horizontal.ticks.range) {
                let at = area.x(place, &horizontal.ticks);
                svg.begin_group("mark", &[("data-x", coordinate(at))]);
                svg.line((at, area.top - 4.0), (at, area.bottom()), mark_stroke());
                svg.text(
                    at,
                    area.top - 8.0,
                    &mark.label,
                    TextStyle::new(SMALL, Anchor::Middle).soft(),
                );
                svg.end_group();
            }
        }
    }
}

/// Numbers of a second axis above the panel. They move with the curves.
fn draw_second(svg: &mut Svg<'_>, area: &Area, horizontal: &Scaled, second: &Second) {
    let (low, high) = horizontal.ticks.range;
    let factor = second.factor;
    let numbers = ticks::inside(factor * low, factor * high, 10);
    for value in &numbers.values {
        let place = value / factor;
        if !(low..=high).contains(&place) {
            continue;
        }
        let at = area.x(place, &horizontal.ticks);
        svg.begin_group("mark", &[("data-x", coordinate(at))]);
        svg.line(
            (at, area.top - 6.0),
            (at, area.top),
            Stroke::solid(Color::Rule, 1.0),
        );
        svg.text(
            at,
            area.top - 11.0,
            &ticks::number(*value, numbers.step),
            TextStyle::new(SMALL, Anchor::Middle),
        );
        svg.end_group();
    }
    svg.text(
        area.left + area.width / 2.0,
        area.top - 32.0,
        &second.title,
        TextStyle::new(SMALL + 1.0, Anchor::Middle),
    );
}

impl Ordinate {
    pub(super) fn label(&self, exponent: i32) -> String {
        let mut label = self.quantity.clone();
        let unit = match (exponent, self.unit.as_str()) {
            (0, unit) => unit.to_owned(),
            (e, "1" | "") => ticks::power_of_ten(e),
            (e, unit) => format!("{} {unit}", ticks::power_of_ten(e)),
        };
        if !unit.is_empty() {
            label.push_str(&format!(" ({unit})"));
        }
        if !self.frame.is_empty() {
            label.push_str(&format!(", axes of {}", self.frame));
        }
        label
    }
}

fn draw_curves(
    svg: &mut Svg<'_>,
    area: &Area,
    panel: &Panel,
    names: &[&str],
    (horizontal, vertical): (&Scaled, &Scaled),
) {
    svg.begin_clip(area.left, area.top, area.width, area.height);
    for curve in &panel.curves {
        let index = names.iter().position(|n| *n == curve.name).unwrap_or(0);
        let even: Vec<f64> = curve
            .values
            .iter()
            .map(|v| vertical.scale.even(*v))
            .collect();
        for run in decimate::runs(&panel.x, &even, horizontal.ticks.range, area.width as usize) {
            let mut points: Vec<(f64, f64)> = run
                .into_iter()
                .map(|(x, y)| (area.x(x, &horizontal.ticks), area.y(y, &vertical.ticks)))
                .collect();
            // a crank angle can decrease, and the readout of the page searches from left to right
            let ends = points.first().zip(points.last());
            if ends.is_some_and(|(first, last)| last.0 < first.0) {
                points.reverse();
            }
            let tag = CurveTag {
                name: &curve.name,
                ..CurveTag::default()
            };
            svg.curve(&points, curve_stroke(index), &tag);
        }
    }
    svg.end_clip();
}
