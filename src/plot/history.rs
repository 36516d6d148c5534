//! Curves against crank angle or time, one panel or several above each other.

use super::font::text_width;
use super::palette::{self, GRID, RULE};
use super::svg::{Anchor, Stroke, Svg, TextStyle};
use super::{decimate, ticks};

const WIDTH: f64 = 1200.0;
const TITLE: f64 = 22.0;
const LABEL: f64 = 16.0;
const NUMBER: f64 = 15.0;
const SMALL: f64 = 13.0;
/// Room right of the panels, wide enough for half of the last number.
const RIGHT: f64 = 36.0;

/// What stands on the horizontal axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Abscissa {
    /// Crank angle (°).
    CrankAngle,
    /// Time (s).
    Time,
}

/// What stands on the vertical axis of all panels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ordinate {
    /// `Force x on the pin`.
    pub quantity: String,
    /// `kN`.
    pub unit: String,
    /// The axes the components are in; empty for a scalar.
    pub frame: String,
}

/// One named curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// As in the legend; curves of one name have one colour in all panels.
    pub name: String,
    /// One value an abscissa of its panel, in the ordinate's unit.
    pub values: Vec<f64>,
}

/// One pair of axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Stands above the axes; may be empty.
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
    /// Stands under the title: model, analysis, filter.
    pub subtitle: String,
    /// Horizontal axis.
    pub abscissa: Abscissa,
    /// Vertical axis.
    pub ordinate: Ordinate,
    /// From top to bottom.
    pub panels: Vec<Panel>,
}

/// The axes in pixels.
struct Area {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

impl History {
    /// The figure as SVG, 1200 pixels wide.
    pub fn to_svg(&self) -> String {
        let horizontal = self.horizontal();
        let vertical = self.vertical();
        let exponent = ticks::exponent(vertical.range);
        let factor = libm::pow(10.0, f64::from(exponent));
        let numbers: Vec<String> = vertical
            .values
            .iter()
            .map(|v| ticks::number(v / factor, vertical.step / factor))
            .collect();
        let widest = numbers
            .iter()
            .map(|n| text_width(n, NUMBER, false))
            .fold(0.0, f64::max);
        let left = 24.0 + LABEL + 18.0 + widest + 12.0;
        let names = self.names();
        let legend = legend_rows(&names, WIDTH - left - RIGHT);
        let top = 92.0 + 26.0 * legend.len() as f64;
        let titled = self.panels.iter().any(|p| !p.title.is_empty());
        let gap = if titled { 46.0 } else { 28.0 };
        let count = self.panels.len().max(1) as f64;
        let panel_height = if self.panels.len() <= 1 { 500.0 } else { 360.0 };
        let first = top + if titled { 30.0 } else { 0.0 };
        let bottom = first + count * panel_height + (count - 1.0) * gap;
        let mut svg = Svg::new(WIDTH, bottom + 78.0, &self.title);
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
        draw_legend(&mut svg, &legend, left);
        for (index, panel) in self.panels.iter().enumerate() {
            let area = Area {
                left,
                top: first + index as f64 * (panel_height + gap),
                width: WIDTH - left - RIGHT,
                height: panel_height,
            };
            let last = index + 1 == self.panels.len();
            self.draw_axes(&mut svg, &area, &horizontal, (&vertical, &numbers), last);
            svg.text(
                area.left,
                area.top - 10.0,
                &panel.title,
                TextStyle::new(LABEL, Anchor::Start).bold(),
            );
            draw_curves(&mut svg, &area, panel, &names, (&horizontal, &vertical));
        }
        svg.text(
            left + (WIDTH - left - RIGHT) / 2.0,
            bottom + 56.0,
            match self.abscissa {
                Abscissa::CrankAngle => "Crank angle (°CA)",
                Abscissa::Time => "Time (s)",
            },
            TextStyle::new(LABEL, Anchor::Middle),
        );
        svg.text(
            24.0 + LABEL,
            (first + bottom) / 2.0,
            &self.ordinate.label(exponent),
            TextStyle::new(LABEL, Anchor::Middle).upwards(),
        );
        svg.finish()
    }

    fn horizontal(&self) -> ticks::Ticks {
        let (low, high) = ticks::extent(self.panels.iter().flat_map(|p| p.x.iter().copied()));
        match self.abscissa {
            Abscissa::CrankAngle => ticks::crank_angle(low, high, 14),
            Abscissa::Time => ticks::inside(low, high, 10),
        }
    }

    fn vertical(&self) -> ticks::Ticks {
        let values = self
            .panels
            .iter()
            .flat_map(|p| &p.curves)
            .flat_map(|c| c.values.iter().copied());
        let (low, high) = ticks::extent(values);
        ticks::rounded(low, high, 7)
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

    fn draw_axes(
        &self,
        svg: &mut Svg,
        area: &Area,
        horizontal: &ticks::Ticks,
        (vertical, numbers): (&ticks::Ticks, &[String]),
        numbered: bool,
    ) {
        let bottom = area.top + area.height;
        for x in &horizontal.values {
            let at = area.x(*x, horizontal);
            svg.line((at, area.top), (at, bottom), Stroke::solid(GRID, 1.0));
            svg.line((at, bottom), (at, bottom + 6.0), Stroke::solid(RULE, 1.0));
            if numbered {
                svg.text(
                    at,
                    bottom + 24.0,
                    &ticks::number(*x, horizontal.step),
                    TextStyle::new(NUMBER, Anchor::Middle),
                );
            }
        }
        for (y, number) in vertical.values.iter().zip(numbers) {
            let at = area.y(*y, vertical);
            let zero = y.abs() < 1e-9 * vertical.step;
            let color = if zero { RULE } else { GRID };
            svg.line(
                (area.left, at),
                (area.left + area.width, at),
                Stroke::solid(color, if zero { 1.5 } else { 1.0 }),
            );
            svg.text(
                area.left - 12.0,
                at + NUMBER * 0.36,
                number,
                TextStyle::new(NUMBER, Anchor::End),
            );
        }
        svg.frame(
            area.left,
            area.top,
            area.width,
            area.height,
            Stroke::solid(RULE, 1.0),
        );
    }
}

impl Ordinate {
    fn label(&self, exponent: i32) -> String {
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

impl Area {
    fn x(&self, value: f64, axis: &ticks::Ticks) -> f64 {
        let (low, high) = axis.range;
        self.left + (value - low) / (high - low) * self.width
    }

    fn y(&self, value: f64, axis: &ticks::Ticks) -> f64 {
        let (low, high) = axis.range;
        self.top + (high - value) / (high - low) * self.height
    }
}

fn draw_curves(
    svg: &mut Svg,
    area: &Area,
    panel: &Panel,
    names: &[&str],
    (horizontal, vertical): (&ticks::Ticks, &ticks::Ticks),
) {
    svg.begin_clip(area.left, area.top, area.width, area.height);
    for curve in &panel.curves {
        let index = names.iter().position(|n| *n == curve.name).unwrap_or(0);
        for run in decimate::runs(
            &panel.x,
            &curve.values,
            horizontal.range,
            area.width as usize,
        ) {
            let points: Vec<(f64, f64)> = run
                .into_iter()
                .map(|(x, y)| (area.x(x, horizontal), area.y(y, vertical)))
                .collect();
            svg.polyline(&points, curve_stroke(index));
        }
    }
    svg.end_clip();
}

fn curve_stroke(index: usize) -> Stroke {
    Stroke {
        color: palette::color(index),
        width: 2.0,
        dash: palette::dash(index),
    }
}

const SAMPLE: f64 = 38.0;

/// Names broken into rows: for each its index and offset.
fn legend_rows<'a>(names: &[&'a str], width: f64) -> Vec<Vec<(usize, f64, &'a str)>> {
    let mut rows: Vec<Vec<(usize, f64, &str)>> = Vec::new();
    let mut offset = f64::INFINITY;
    for (index, name) in names.iter().enumerate() {
        let size = SAMPLE + 8.0 + text_width(name, NUMBER, false);
        if offset + size > width {
            rows.push(Vec::new());
            offset = 0.0;
        }
        if let Some(row) = rows.last_mut() {
            row.push((index, offset, name));
        }
        offset += size + 28.0;
    }
    rows
}

fn draw_legend(svg: &mut Svg, rows: &[Vec<(usize, f64, &str)>], left: f64) {
    for (row, entries) in rows.iter().enumerate() {
        let y = 98.0 + 26.0 * row as f64;
        for (index, offset, name) in entries {
            let x = left + offset;
            svg.line((x, y), (x + SAMPLE, y), curve_stroke(*index));
            svg.text(
                x + SAMPLE + 8.0,
                y + NUMBER * 0.36,
                name,
                TextStyle::new(NUMBER, Anchor::Start),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> History {
        History {
            title: "Force on the pin".to_owned(),
            subtitle: "Slider, test".to_owned(),
            abscissa: Abscissa::CrankAngle,
            ordinate: Ordinate {
                quantity: "Force x".to_owned(),
                unit: "N".to_owned(),
                frame: "ground".to_owned(),
            },
            panels: vec![Panel {
                title: String::new(),
                x: vec![0.0, 180.0, 360.0],
                curves: vec![
                    Curve {
                        name: "a<1>".to_owned(),
                        values: vec![0.0, 2.5e6, -1.0e6],
                    },
                    Curve {
                        name: "b".to_owned(),
                        values: vec![1.0e6, f64::NAN, 1.0e6],
                    },
                ],
            }],
        }
    }

    #[test]
    fn small_figure() {
        insta::assert_snapshot!(small().to_svg());
    }

    #[test]
    fn same_data_same_text() {
        assert_eq!(small().to_svg(), small().to_svg());
    }

    #[test]
    fn empty_and_constant_data_are_drawn() {
        let mut figure = small();
        figure.panels[0].curves[0].values = vec![3.0; 3];
        assert!(figure.to_svg().contains("<polyline"));
        figure.panels.clear();
        let svg = figure.to_svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        super::super::to_png(&svg, 0.5).unwrap();
    }

    #[test]
    fn two_panels_share_the_axes() {
        let mut figure = small();
        figure.panels.push(figure.panels[0].clone());
        figure.panels[1].curves[0].values = vec![0.0, 9.0e6, 0.0];
        let svg = figure.to_svg();
        assert_eq!(svg.matches(">10<").count(), 2, "both reach 10·10⁶ N");
        assert_eq!(svg.matches(">a&lt;1&gt;<").count(), 1, "one legend");
    }
}
