//! Writes SVG text. Coordinates have two decimals at most, so the text is stable.
//!
//! In a page the same drawing has data for the script: groups with classes and data attributes. On paper
//! these are left out.

use super::font;
use super::palette::{Color, Theme};
use crate::escape::escaped;
use std::fmt::Write;

/// The destination of a drawing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target<'a> {
    pub theme: Theme,
    /// An id that no other drawing of the page has. The ids inside the drawing begin with it.
    pub id: &'a str,
}

impl Target<'_> {
    /// A file of its own.
    pub const PAPER: Target<'static> = Target {
        theme: Theme::Paper,
        id: "",
    };
}

/// The style of a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke {
    pub color: Color,
    pub width: f64,
    /// Empty for a solid line.
    pub dash: &'static str,
}

impl Stroke {
    pub fn solid(color: Color, width: f64) -> Self {
        Stroke {
            color,
            width,
            dash: "",
        }
    }
}

/// The point of a text that is at the given place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// The style of a text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextStyle {
    pub size: f64,
    pub bold: bool,
    pub anchor: Anchor,
    pub color: Color,
    /// Turned by −90°, reading upwards.
    pub upwards: bool,
    /// A seam around the letters, for text over curves.
    pub halo: Option<Color>,
}

impl TextStyle {
    pub fn new(size: f64, anchor: Anchor) -> Self {
        TextStyle {
            size,
            bold: false,
            anchor,
            color: Color::Ink,
            upwards: false,
            halo: None,
        }
    }

    pub fn bold(mut self) -> Self {
        self.bold = true;
        self
    }

    pub fn soft(mut self) -> Self {
        self.color = Color::SoftInk;
        self
    }

    pub fn upwards(mut self) -> Self {
        self.upwards = true;
        self
    }

    pub fn halo(mut self) -> Self {
        self.halo = Some(Color::Sheet);
        self
    }

    /// The style for text on a map.
    pub fn on_map(mut self) -> Self {
        self.color = Color::OnMap;
        self.halo = Some(Color::MapSeam);
        self
    }
}

/// Data of a piece of a curve for the script of the page, besides its points.
#[derive(Clone, Debug, Default)]
pub(crate) struct CurveTag<'a> {
    /// Name of the curve. The script shows and hides curves with one name together.
    pub name: &'a str,
    /// The text of the readout, instead of the name.
    pub label: &'a str,
    /// The crank angle of each point (°).
    pub angles: Vec<f64>,
    /// The pixel from which the ordinate of this curve counts, if it differs from that of the axis.
    pub base: Option<f64>,
}

/// Sizes of the title of a figure and of the text below it. Choices of layout.
const TITLE: f64 = 22.0;
const SUBTITLE: f64 = 14.0;
/// Smallest size to which a text shrinks to fit. A choice: smaller ones are not read.
const SMALLEST: f64 = 9.0;

/// An SVG under construction.
#[derive(Debug)]
pub(crate) struct Svg<'a> {
    text: String,
    clips: u32,
    target: Target<'a>,
}

impl<'a> Svg<'a> {
    /// A sheet; `title` is read by screen readers.
    pub fn new(width: f64, height: f64, title: &str, target: Target<'a>) -> Self {
        let mut svg = Svg {
            text: String::new(),
            clips: 0,
            target,
        };
        let (w, h) = (coordinate(width), coordinate(height));
        let (family, title) = (font::FAMILY, escaped(title));
        match target.theme {
            Theme::Paper => svg.put(format_args!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" font-family=\"{family}\">\n<title>{title}</title>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n",
            )),
            // no title element, which would hover over the readout
            Theme::Page => svg.put(format_args!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"drawing\" viewBox=\"0 0 {w} {h}\" font-family=\"{family}\" style=\"max-width:{w}px\" role=\"group\" tabindex=\"0\" aria-label=\"{title}\">\n",
            )),
        }
        svg
    }

    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        // writing to a String cannot fail
        let _ = self.text.write_fmt(text);
    }

    /// A group for the page's script; nothing on paper.
    pub fn begin_group(&mut self, class: &str, attributes: &[(&str, String)]) {
        if self.target.theme == Theme::Paper {
            return;
        }
        self.put(format_args!("<g class=\"{class}\""));
        for (name, value) in attributes {
            self.put(format_args!(" {name}=\"{}\"", escaped(value)));
        }
        self.put(format_args!(">\n"));
    }

    pub fn end_group(&mut self) {
        if self.target.theme == Theme::Page {
            self.put(format_args!("</g>\n"));
        }
    }

    /// All marks drawn until [`Svg::end_clip`] are cut at the rectangle, and move when a reader zooms.
    pub fn begin_clip(&mut self, x: f64, y: f64, width: f64, height: f64) {
        self.clips += 1;
        let id = format!("{}clip{}", self.target.id, self.clips);
        self.put(format_args!(
            "<clipPath id=\"{id}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n<g clip-path=\"url(#{id})\">\n",
            coordinate(x),
            coordinate(y),
            coordinate(width),
            coordinate(height)
        ));
        self.begin_group("zoom", &[]);
    }

    pub fn end_clip(&mut self) {
        self.end_group();
        self.put(format_args!("</g>\n"));
    }

    fn stroke(&mut self, stroke: Stroke) {
        self.put(format_args!(
            " stroke=\"{}\" stroke-width=\"{}\"",
            stroke.color.css(self.target.theme),
            coordinate(stroke.width)
        ));
        if !stroke.dash.is_empty() {
            self.put(format_args!(" stroke-dasharray=\"{}\"", stroke.dash));
        }
    }

    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: Stroke) {
        self.put(format_args!(
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"",
            coordinate(from.0),
            coordinate(from.1),
            coordinate(to.0),
            coordinate(to.1)
        ));
        self.stroke(stroke);
        self.put(format_args!("/>\n"));
    }

    pub fn frame(&mut self, x: f64, y: f64, width: f64, height: f64, stroke: Stroke) {
        self.put(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\"",
            coordinate(x),
            coordinate(y),
            coordinate(width),
            coordinate(height)
        ));
        self.stroke(stroke);
        self.put(format_args!("/>\n"));
    }

    /// A filled rectangle without an outline.
    pub fn area(&mut self, x: f64, y: f64, width: f64, height: f64, fill: Color) {
        self.put(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n",
            coordinate(x),
            coordinate(y),
            coordinate(width),
            coordinate(height),
            fill.css(self.target.theme)
        ));
    }

    /// Rectangles (left, top, width, height) of one colour as one path.
    pub fn cells(&mut self, cells: &[(f64, f64, f64, f64)], fill: Color) {
        if cells.is_empty() {
            return;
        }
        self.put(format_args!(
            "<path fill=\"{}\" shape-rendering=\"crispEdges\" d=\"",
            fill.css(self.target.theme)
        ));
        for (x, y, width, height) in cells {
            self.put(format_args!(
                "M{} {}h{}v{}h{}z",
                coordinate(*x),
                coordinate(*y),
                coordinate(*width),
                coordinate(*height),
                coordinate(-width)
            ));
        }
        self.put(format_args!("\"/>\n"));
    }

    /// A filled polygon without an outline.
    pub fn polygon(&mut self, points: &[(f64, f64)], fill: Color) {
        self.put(format_args!(
            "<polygon fill=\"{}\"",
            fill.css(self.target.theme)
        ));
        self.points(points);
        self.put(format_args!("/>\n"));
    }

    /// A circle, filled with a colour or not.
    pub fn circle(&mut self, center: (f64, f64), radius: f64, fill: Option<Color>, stroke: Stroke) {
        self.put(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"",
            coordinate(center.0),
            coordinate(center.1),
            coordinate(radius),
            fill.map_or("none", |color| color.css(self.target.theme))
        ));
        self.stroke(stroke);
        if self.target.theme == Theme::Page {
            self.put(format_args!(" vector-effect=\"non-scaling-stroke\""));
        }
        self.put(format_args!("/>\n"));
    }

    /// A path through the points; nothing for fewer than two.
    ///
    /// On paper it is a `polyline`. In a page it is a `path` of class `curve` with a first point and steps in
    /// hundredths of a pixel, and with a first angle and differences in hundredths of a degree. This text is
    /// less than half as long.
    pub fn curve(&mut self, points: &[(f64, f64)], stroke: Stroke, tag: &CurveTag<'_>) {
        if points.len() < 2 {
            return;
        }
        if self.target.theme == Theme::Paper {
            self.put(format_args!(
                "<polyline fill=\"none\" stroke-linejoin=\"round\""
            ));
            self.stroke(stroke);
            self.points(points);
            self.put(format_args!("/>\n"));
            return;
        }
        self.put(format_args!(
            "<path fill=\"none\" stroke-linejoin=\"round\""
        ));
        self.stroke(stroke);
        self.put(format_args!(
            " class=\"curve\" transform=\"scale(.01)\" vector-effect=\"non-scaling-stroke\" data-name=\"{}\"",
            escaped(tag.name)
        ));
        if !tag.label.is_empty() {
            self.put(format_args!(" data-label=\"{}\"", escaped(tag.label)));
        }
        if let Some(base) = tag.base {
            self.put(format_args!(" data-base=\"{}\"", coordinate(base)));
        }
        if !tag.angles.is_empty() {
            self.put(format_args!(" data-angles=\""));
            let mut before = 0;
            for (index, angle) in tag.angles.iter().enumerate() {
                let here = hundredths(*angle);
                self.step(here - before, index > 0);
                before = here;
            }
            self.put(format_args!("\""));
        }
        self.put(format_args!(" d=\"m"));
        let mut before = (0, 0);
        for (index, (x, y)) in points.iter().enumerate() {
            let here = (hundredths(*x), hundredths(*y));
            self.step(here.0 - before.0, index > 0);
            self.step(here.1 - before.1, true);
            before = here;
        }
        self.put(format_args!("\"/>\n"));
    }

    /// Writes a number of a list. A minus sign separates it from the number before, so it needs no space.
    fn step(&mut self, value: i64, parted: bool) {
        let space = if parted && value >= 0 { " " } else { "" };
        self.put(format_args!("{space}{value}"));
    }

    fn points(&mut self, points: &[(f64, f64)]) {
        self.put(format_args!(" points=\""));
        for (index, (x, y)) in points.iter().enumerate() {
            let separator = if index == 0 { "" } else { " " };
            self.put(format_args!(
                "{separator}{},{}",
                coordinate(*x),
                coordinate(*y)
            ));
        }
        self.put(format_args!("\""));
    }

    pub fn text(&mut self, x: f64, y: f64, text: &str, style: TextStyle) {
        self.put(format_args!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\"",
            coordinate(x),
            coordinate(y),
            coordinate(style.size),
            style.color.css(self.target.theme)
        ));
        match style.anchor {
            Anchor::Start => {}
            Anchor::Middle => self.put(format_args!(" text-anchor=\"middle\"")),
            Anchor::End => self.put(format_args!(" text-anchor=\"end\"")),
        }
        if style.bold {
            self.put(format_args!(" font-weight=\"bold\""));
        }
        if style.upwards {
            self.put(format_args!(
                " transform=\"rotate(-90 {} {})\"",
                coordinate(x),
                coordinate(y)
            ));
        }
        if let Some(halo) = style.halo {
            self.put(format_args!(
                " stroke=\"{}\" stroke-width=\"3.5\" stroke-linejoin=\"round\" paint-order=\"stroke\"",
                halo.css(self.target.theme)
            ));
        }
        self.put(format_args!(">{}</text>\n", escaped(text)));
    }

    /// The title of a figure and the text below it, from `left` on, each at most `width` wide.
    pub fn head(&mut self, left: f64, width: f64, title: &str, subtitle: &str) {
        let bold = TextStyle::new(TITLE, Anchor::Start).bold();
        self.text_within(left, 42.0, width, title, bold);
        let soft = TextStyle::new(SUBTITLE, Anchor::Start).soft();
        self.text_within(left, 68.0, width, subtitle, soft);
    }

    /// A text that shrinks to `width` if it is wider, down to a size that is readable.
    fn text_within(&mut self, x: f64, y: f64, width: f64, text: &str, mut style: TextStyle) {
        let wide = font::text_width(text, style.size, style.bold);
        if wide > width && wide > 0.0 {
            style.size = (style.size * width / wide).max(SMALLEST);
        }
        self.text(x, y, text, style);
    }

    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

/// In whole hundredths, within [`coordinate`]'s limits.
fn hundredths(value: f64) -> i64 {
    (100.0 * within(value)).round() as i64
}

/// Limits a coordinate: far outside of any sheet it remains far outside, and a value that is no number
/// becomes 0. So the file is always readable.
fn within(value: f64) -> f64 {
    if value.is_nan() {
        0.0
    } else {
        // a choice: thousands of sheets away, and readers with numbers of seven digits still read it
        value.clamp(-1e7, 1e7)
    }
}

/// Two decimals at most, no `-0`.
pub fn coordinate(value: f64) -> String {
    let text = format!("{:.2}", within(value));
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}
