//! A pair of axes: the map from values to pixels, the grid, the numbers, and the data for the script of the
//! page.

use super::font::text_width;
use super::palette::Color;
use super::svg::{Anchor, Stroke, Svg, TextStyle, coordinate};
use super::ticks::{self, Ticks};

/// Width of a figure with one column of panels. A choice of layout, as are all lengths of figures (1/1200 of
/// this width).
pub(super) const WIDTH: f64 = 1200.0;
/// Room right of the panels, wide enough for half of the last number. A choice of layout.
pub(super) const RIGHT: f64 = 36.0;
/// Sizes of the names of axes, of their numbers, and of small notes. Choices of layout.
pub(super) const LABEL: f64 = 16.0;
pub(super) const NUMBER: f64 = 15.0;
pub(super) const SMALL: f64 = 13.0;

/// The map from values to lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Scale {
    /// Equal steps.
    #[default]
    Linear,
    /// Equal ratios; values that are not above 0 are gaps.
    Logarithmic,
}

impl Scale {
    pub(super) fn name(self) -> &'static str {
        match self {
            Scale::Linear => "linear",
            Scale::Logarithmic => "log",
        }
    }

    /// The number whose equal steps have equal lengths; NaN if there is none.
    pub(super) fn even(self, value: f64) -> f64 {
        match self {
            Scale::Linear => value,
            Scale::Logarithmic if value > 0.0 => libm::log10(value),
            Scale::Logarithmic => f64::NAN,
        }
    }
}

/// One axis with its numbers.
#[derive(Clone, Debug)]
pub(super) struct Scaled {
    pub ticks: Ticks,
    /// One text for each tick.
    pub numbers: Vec<String>,
    /// The divisor of the numbers.
    pub factor: f64,
    pub scale: Scale,
    /// For the readout: quantity and unit.
    pub name: String,
    pub unit: String,
    /// `angle` for steps that divide a revolution.
    pub kind: &'static str,
}

impl Scaled {
    /// An axis with undivided numbers.
    pub fn plain(ticks: Ticks, name: &str, unit: &str) -> Self {
        Scaled {
            numbers: ticks
                .values
                .iter()
                .map(|v| ticks::number(*v, ticks.step))
                .collect(),
            ticks,
            factor: 1.0,
            scale: Scale::Linear,
            name: name.to_owned(),
            unit: unit.to_owned(),
            kind: "plain",
        }
    }

    /// An axis whose numbers are divided by a power of ten, and the exponent of this power for its label.
    pub fn divided(ticks: Ticks, name: &str, unit: &str) -> (Self, i32) {
        let exponent = ticks::exponent(ticks.range);
        let factor = libm::pow(10.0, f64::from(exponent));
        let numbers = ticks
            .values
            .iter()
            .map(|v| ticks::number(v / factor, ticks.step / factor))
            .collect();
        let scaled = Scaled {
            numbers,
            factor,
            ..Scaled::plain(ticks, name, unit)
        };
        (scaled, exponent)
    }

    /// The left edge of a panel with this vertical axis: its label and its widest number are left of it.
    pub fn left(&self) -> f64 {
        let widths = self.numbers.iter().map(|n| text_width(n, NUMBER, false));
        24.0 + LABEL + 18.0 + widths.fold(0.0, f64::max) + 12.0
    }

    /// An axis of equal ratios from `low` to `high`, both above zero.
    pub fn ratios(low: f64, high: f64, name: &str, unit: &str) -> Self {
        let (low, high) = match low > 0.0 && high > low && high.is_finite() {
            true => (low, high),
            false => (1.0, 10.0),
        };
        let values = ticks::ratios(low, high);
        Scaled {
            numbers: values.iter().map(|value| ticks::shortest(*value)).collect(),
            ticks: Ticks {
                range: (libm::log10(low), libm::log10(high)),
                values: values.into_iter().map(libm::log10).collect(),
                step: 1.0,
            },
            factor: 1.0,
            scale: Scale::Logarithmic,
            name: name.to_owned(),
            unit: unit.to_owned(),
            kind: "plain",
        }
    }

    /// An axis of powers of ten, over the last `decades` below the largest value at most.
    pub fn decades(low: f64, high: f64, decades: usize, name: &str, unit: &str) -> Self {
        let (low, high) = if high > 0.0 && high.is_finite() {
            // a value at a power of ten, up to rounding, is an end of the axis: it needs no further decade
            let top = (libm::log10(high) - 1e-9).ceil();
            let bottom = if low > 0.0 {
                (libm::log10(low) + 1e-9).floor()
            } else {
                f64::NEG_INFINITY
            };
            (bottom.clamp(top - decades.max(1) as f64, top - 1.0), top)
        } else {
            (-1.0, 0.0)
        };
        let values: Vec<f64> = (0..=(high - low) as usize)
            .map(|i| low + i as f64)
            .collect();
        Scaled {
            numbers: values
                .iter()
                .map(|v| ticks::power_of_ten(*v as i32))
                .collect(),
            ticks: Ticks {
                range: (low, high),
                values,
                step: 1.0,
            },
            factor: 1.0,
            scale: Scale::Logarithmic,
            name: name.to_owned(),
            unit: unit.to_owned(),
            kind: "plain",
        }
    }
}

/// The rectangle of the axes in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    /// Pixel of a number of [`Scale::even`].
    pub fn x(&self, value: f64, axis: &Ticks) -> f64 {
        let (low, high) = axis.range;
        self.left + (value - low) / (high - low) * self.width
    }

    /// Pixel of a number of [`Scale::even`].
    pub fn y(&self, value: f64, axis: &Ticks) -> f64 {
        let (low, high) = axis.range;
        self.top + (high - value) / (high - low) * self.height
    }

    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// The names of the axes, below and left of the panel.
    pub fn label(&self, svg: &mut Svg<'_>, below: &str, left: &str) {
        let style = TextStyle::new(LABEL, Anchor::Middle);
        let middle = self.left + self.width / 2.0;
        svg.text(middle, self.bottom() + 56.0, below, style);
        self.label_left(svg, left);
    }

    /// The name of the vertical axis.
    pub fn label_left(&self, svg: &mut Svg<'_>, left: &str) {
        let style = TextStyle::new(LABEL, Anchor::Middle);
        let middle = self.top + self.height / 2.0;
        svg.text(24.0 + LABEL, middle, left, style.upwards());
    }

    /// Begins a group with the data for the script of the page. [`Svg::end_group`] ends it.
    pub fn begin_panel(
        &self,
        svg: &mut Svg<'_>,
        x: &Scaled,
        y: &Scaled,
        more: &[(&'static str, String)],
    ) {
        let pair = |(a, b): (f64, f64)| format!("{a} {b}");
        let mut attributes = vec![
            (
                "data-area",
                format!(
                    "{} {} {} {}",
                    coordinate(self.left),
                    coordinate(self.top),
                    coordinate(self.width),
                    coordinate(self.height)
                ),
            ),
            ("data-x", pair(x.ticks.range)),
            ("data-y", pair(y.ticks.range)),
            ("data-x-name", x.name.clone()),
            ("data-x-unit", x.unit.clone()),
            ("data-y-name", y.name.clone()),
            ("data-y-unit", y.unit.clone()),
            ("data-x-kind", x.kind.to_owned()),
            ("data-y-scale", y.scale.name().to_owned()),
            ("data-y-factor", format!("{}", y.factor)),
        ];
        if x.scale == Scale::Logarithmic {
            attributes.push(("data-x-scale", x.scale.name().to_owned()));
        }
        attributes.extend(more.iter().cloned());
        svg.begin_group("panel", &attributes);
    }

    /// Draws grid lines, numbers and the frame. Numbers below the panel need `numbered`.
    pub fn draw(&self, svg: &mut Svg<'_>, x: &Scaled, y: &Scaled, numbered: bool) {
        svg.begin_group(if numbered { "grid numbered" } else { "grid" }, &[]);
        let bottom = self.bottom();
        for (value, number) in x.ticks.values.iter().zip(&x.numbers) {
            let at = self.x(*value, &x.ticks);
            svg.line(
                (at, self.top),
                (at, bottom),
                Stroke::solid(Color::Grid, 1.0),
            );
            svg.line(
                (at, bottom),
                (at, bottom + 6.0),
                Stroke::solid(Color::Rule, 1.0),
            );
            if numbered {
                svg.text(
                    at,
                    bottom + 24.0,
                    number,
                    TextStyle::new(NUMBER, Anchor::Middle),
                );
            }
        }
        for (value, number) in y.ticks.values.iter().zip(&y.numbers) {
            let at = self.y(*value, &y.ticks);
            // a sum of steps rounds, so the mark of zero is not exactly zero
            let zero = y.scale == Scale::Linear && value.abs() < 1e-9 * y.ticks.step;
            let color = if zero { Color::Rule } else { Color::Grid };
            svg.line(
                (self.left, at),
                (self.right(), at),
                Stroke::solid(color, if zero { 1.5 } else { 1.0 }),
            );
            svg.text(
                self.left - 12.0,
                at + NUMBER * 0.36,
                number,
                TextStyle::new(NUMBER, Anchor::End),
            );
        }
        svg.end_group();
        svg.frame(
            self.left,
            self.top,
            self.width,
            self.height,
            Stroke::solid(Color::Rule, 1.0),
        );
    }
}
