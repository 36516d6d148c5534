//! Writes SVG text. Coordinates have two decimals at most, so the text is stable.

use super::{font, palette};
use std::fmt::Write;

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub color: &'static str,
    pub width: f64,
    /// Empty for a solid line.
    pub dash: &'static str,
}

impl Stroke {
    pub fn solid(color: &'static str, width: f64) -> Self {
        Stroke {
            color,
            width,
            dash: "",
        }
    }
}

/// Which point of a text is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// How text is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextStyle {
    pub size: f64,
    pub bold: bool,
    pub anchor: Anchor,
    pub color: &'static str,
    /// Turned by −90°, reading upwards.
    pub upwards: bool,
    /// A white seam, for text over curves.
    pub halo: bool,
}

impl TextStyle {
    pub fn new(size: f64, anchor: Anchor) -> Self {
        TextStyle {
            size,
            bold: false,
            anchor,
            color: palette::INK,
            upwards: false,
            halo: false,
        }
    }

    pub fn bold(mut self) -> Self {
        self.bold = true;
        self
    }

    pub fn soft(mut self) -> Self {
        self.color = palette::SOFT_INK;
        self
    }

    pub fn upwards(mut self) -> Self {
        self.upwards = true;
        self
    }

    pub fn halo(mut self) -> Self {
        self.halo = true;
        self
    }
}

/// An SVG under construction.
#[derive(Debug)]
pub(super) struct Svg {
    text: String,
    clips: u32,
}

impl Svg {
    /// A white sheet; `title` is read by screen readers.
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        let mut svg = Svg {
            text: String::new(),
            clips: 0,
        };
        let (w, h) = (coordinate(width), coordinate(height));
        svg.put(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" font-family=\"{}\">\n<title>{}</title>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n",
            font::FAMILY,
            escaped(title)
        ));
        svg
    }

    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        // writing to a String cannot fail
        let _ = self.text.write_fmt(text);
    }

    /// Everything until [`Svg::end_clip`] is cut at the rectangle.
    pub fn begin_clip(&mut self, x: f64, y: f64, width: f64, height: f64) {
        self.clips += 1;
        let id = self.clips;
        self.put(format_args!(
            "<clipPath id=\"clip{id}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n<g clip-path=\"url(#clip{id})\">\n",
            coordinate(x),
            coordinate(y),
            coordinate(width),
            coordinate(height)
        ));
    }

    pub fn end_clip(&mut self) {
        self.put(format_args!("</g>\n"));
    }

    fn stroke(&mut self, stroke: Stroke) {
        self.put(format_args!(
            " stroke=\"{}\" stroke-width=\"{}\"",
            stroke.color,
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

    pub fn circle(&mut self, center: (f64, f64), radius: f64, fill: &str, stroke: Stroke) {
        self.put(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{fill}\"",
            coordinate(center.0),
            coordinate(center.1),
            coordinate(radius)
        ));
        self.stroke(stroke);
        self.put(format_args!("/>\n"));
    }

    /// A path through the points; nothing for fewer than two.
    pub fn polyline(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        if points.len() < 2 {
            return;
        }
        self.put(format_args!(
            "<polyline fill=\"none\" stroke-linejoin=\"round\""
        ));
        self.stroke(stroke);
        self.put(format_args!(" points=\""));
        for (index, (x, y)) in points.iter().enumerate() {
            let separator = if index == 0 { "" } else { " " };
            self.put(format_args!(
                "{separator}{},{}",
                coordinate(*x),
                coordinate(*y)
            ));
        }
        self.put(format_args!("\"/>\n"));
    }

    pub fn text(&mut self, x: f64, y: f64, text: &str, style: TextStyle) {
        self.put(format_args!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\"",
            coordinate(x),
            coordinate(y),
            coordinate(style.size),
            style.color
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
        if style.halo {
            self.put(format_args!(
                " stroke=\"#ffffff\" stroke-width=\"3.5\" stroke-linejoin=\"round\" paint-order=\"stroke\""
            ));
        }
        self.put(format_args!(">{}</text>\n", escaped(text)));
    }

    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

/// Two decimals at most, no `-0`.
pub(super) fn coordinate(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '"' => escaped.push_str("&quot;"),
            // XML 1.0 allows no control characters, not even as references
            c if c.is_control() || ('\u{fffe}'..='\u{ffff}').contains(&c) => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short() {
        let cases = [
            (100.0, "100"),
            (0.1 + 0.2, "0.3"),
            (-0.001, "0"),
            (-2.346, "-2.35"),
        ];
        for (value, text) in cases {
            assert_eq!(coordinate(value), text);
        }
    }

    #[test]
    fn text_is_escaped() {
        assert_eq!(escaped("a<b & \"c\"\u{7}"), "a&lt;b &amp; &quot;c&quot; ");
    }
}
