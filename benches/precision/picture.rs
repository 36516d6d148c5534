//! The curves as an SVG file: one panel for each model, both axes in decades. Lengths are in pixels.

use super::{Curves, NAMES, Point, TOLERANCES};
use eng_report::figure::FONT_FAMILY;
use std::fmt::{Error, Write};

const SIZE: [f64; 2] = [1260.0, 830.0];
const PANEL: [f64; 2] = [310.0, 260.0];
/// Distance of two panels.
const APART: [f64; 2] = [410.0, 385.0];
/// The corner of the first panel.
const FIRST: [f64; 2] = [100.0, 95.0];
/// Panels in a row.
const ROW: usize = 3;
const COLORS: [&str; 2] = ["#d55e00", "#0072b2"];
/// An error below this share is rounding.
const LEAST: f64 = 1e-16;

/// The picture of models with their titles.
pub fn drawn(models: &[(&str, Curves)]) -> Result<String, Error> {
    let [width, height] = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"{FONT_FAMILY}\" font-size=\"14\" fill=\"#222222\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    let [left, _] = FIRST;
    for (method, name) in NAMES.iter().enumerate() {
        let x = left + 170.0 * method as f64;
        mark(&mut svg, method, [x, 30.0], true)?;
        text(&mut svg, [x + 14.0, 35.0], "start", name)?;
    }
    let legend = "tolerances 1000 to 0.01 from left to right; filled: 1, the default";
    text(&mut svg, [left + 350.0, 35.0], "start", legend)?;
    for (index, (title, curves)) in models.iter().enumerate() {
        let place = [index % ROW, index / ROW];
        let corner = [0, 1].map(|axis| FIRST[axis] + APART[axis] * place[axis] as f64);
        panel(&mut svg, corner, title, curves)?;
    }
    Ok(svg + "</svg>\n")
}

fn text(svg: &mut String, [x, y]: [f64; 2], anchor: &str, text: &str) -> Result<(), Error> {
    writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"
    )
}

/// A mark of a method: a square, or a circle.
fn mark(svg: &mut String, method: usize, [x, y]: [f64; 2], filled: bool) -> Result<(), Error> {
    let color = COLORS[method];
    let fill = if filled { color } else { "#ffffff" };
    let (left, top, round) = (x - 5.0, y - 5.0, 5 * method);
    writeln!(
        svg,
        "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"10\" height=\"10\" rx=\"{round}\" fill=\"{fill}\" stroke=\"{color}\" \
         stroke-width=\"2\"/>"
    )
}

/// A power of ten.
fn power(decade: i32) -> String {
    let exponent = decade.to_string().replace('-', "−");
    format!("10<tspan dy=\"-6\" font-size=\"10\">{exponent}</tspan>")
}

/// The logarithms of time (s) and error.
fn place(point: &Point) -> [f64; 2] {
    [point.seconds.log10(), point.error.max(LEAST).log10()]
}

/// The whole decades around the points.
fn decades(curves: &Curves, axis: usize) -> [f64; 2] {
    let places = || curves.iter().flatten().map(|point| place(point)[axis]);
    let low = places().fold(f64::INFINITY, f64::min).floor();
    [low, places().fold(low + 1.0, f64::max).ceil()]
}

fn panel(
    svg: &mut String,
    [left, top]: [f64; 2],
    title: &str,
    curves: &Curves,
) -> Result<(), Error> {
    let [width, height] = PANEL;
    let (right, bottom) = (left + width, top + height);
    let ([first, last], [low, high]) = (decades(curves, 0), decades(curves, 1));
    let x = |time: f64| left + width * (time - first) / (last - first);
    let y = |error: f64| top + height * (high - error) / (high - low);
    let mut grid = String::new();
    for decade in first as i32..=last as i32 {
        let at = x(f64::from(decade));
        write!(grid, "M{at:.1} {top}V{bottom}")?;
        text(svg, [at, bottom + 22.0], "middle", &power(decade))?;
    }
    for decade in low as i32..=high as i32 {
        let at = y(f64::from(decade));
        write!(grid, "M{left} {at:.1}H{right}")?;
        text(svg, [left - 8.0, at + 5.0], "end", &power(decade))?;
    }
    writeln!(svg, "<path d=\"{grid}\" stroke=\"#e3e3e3\"/>")?;
    writeln!(
        svg,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"#9a9a9a\"/>"
    )?;
    let [middle, centre] = [left + 0.5 * width, top + 0.5 * height];
    let title = format!("<tspan font-weight=\"bold\">{title}</tspan>");
    text(svg, [left, top - 12.0], "start", &title)?;
    text(svg, [middle, bottom + 44.0], "middle", "Processor time (s)")?;
    let aside = left - 58.0;
    writeln!(
        svg,
        "<text transform=\"translate({aside:.1} {centre:.1}) rotate(-90)\" text-anchor=\"middle\">Error over the greatest position (–)</text>"
    )?;
    for (method, points) in curves.iter().enumerate() {
        let at = points.each_ref().map(|point| {
            let [time, error] = place(point);
            [x(time), y(error)]
        });
        let line = at.map(|[x, y]| format!("{x:.1},{y:.1}")).join(" ");
        let color = COLORS[method];
        writeln!(
            svg,
            "<polyline points=\"{line}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>"
        )?;
        for (at, tolerance) in at.into_iter().zip(TOLERANCES) {
            mark(svg, method, at, tolerance == 1.0)?;
        }
    }
    Ok(())
}
