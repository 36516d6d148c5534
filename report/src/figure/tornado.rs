//! Changes of a value as horizontal bars, the largest on top.

use super::axes::{Area, LABEL, NUMBER, RIGHT, Scaled, WIDTH};
use super::font::text_width;
use super::history::Ordinate;
use super::palette::Color;
use super::svg::{Anchor, Stroke, Svg, Target, TextStyle};
use super::ticks::{self, Ticks};

/// Height of a bar, and the distance of two bars. Choices of layout.
const BAR: f64 = 22.0;
const PITCH: f64 = 34.0;
/// Distance of a text from its bar or from the axis. A choice of layout.
const GAP: f64 = 8.0;
/// Widest name beside the bars; a longer one is drawn over the edge of the sheet. A choice of layout.
const WIDEST: f64 = 420.0;

/// One change.
#[derive(Clone, Debug, PartialEq)]
pub struct TornadoBar {
    /// The changed parameter.
    pub name: String,
    /// The change of the value, in the unit of the abscissa.
    pub value: f64,
}

/// A figure of changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Tornado {
    /// Title.
    pub title: String,
    /// The line under the title: model, analysis, changes of the parameters.
    pub subtitle: String,
    /// The axis of the changes.
    pub abscissa: Ordinate,
    /// The bars from top to bottom.
    pub bars: Vec<TornadoBar>,
}

impl Tornado {
    pub(crate) fn draw(&self, target: Target<'_>) -> String {
        let finite = || self.bars.iter().filter(|bar| bar.value.is_finite());
        let (low, high) = ticks::extent(finite().map(|bar| bar.value).chain([0.0]));
        // the numbers stand beyond the bars
        let room = 0.12 * (high - low);
        let beyond = |end: f64, room: f64| if end == 0.0 { end } else { end + room };
        let ticks = ticks::rounded(beyond(low, -room), beyond(high, room), 8);
        let name = &self.abscissa.quantity;
        let (horizontal, exponent) = Scaled::divided(ticks, name, &self.abscissa.unit);
        let widths = self
            .bars
            .iter()
            .map(|bar| text_width(&bar.name, NUMBER, false));
        let left = 24.0 + widths.fold(0.0, f64::max).min(WIDEST) + 12.0;
        let area = Area {
            left,
            top: 92.0,
            width: WIDTH - left - RIGHT,
            height: PITCH * self.bars.len().max(1) as f64,
        };
        let nothing = Ticks {
            range: (0.0, 1.0),
            values: Vec::new(),
            step: 1.0,
        };
        let vertical = Scaled::plain(nothing, "", "");
        let mut svg = Svg::new(WIDTH, area.bottom() + 78.0, &self.title, target);
        svg.head(left, area.width, &self.title, &self.subtitle);
        area.draw(&mut svg, &horizontal, &vertical, true);
        let zero = area.x(0.0, &horizontal.ticks);
        for (at, bar) in self.bars.iter().enumerate() {
            let middle = area.top + PITCH * (at as f64 + 0.5);
            let base = middle + 0.36 * NUMBER;
            let style = TextStyle::new(NUMBER, Anchor::End);
            svg.text(left - 12.0, base, &bar.name, style);
            if !bar.value.is_finite() {
                continue;
            }
            let end = area.x(bar.value, &horizontal.ticks);
            let (from, width) = (zero.min(end), (end - zero).abs());
            let (color, anchor, place) = match bar.value < 0.0 {
                true => (Color::Series(1), Anchor::End, end - GAP),
                false => (Color::Series(0), Anchor::Start, end + GAP),
            };
            svg.area(from, middle - 0.5 * BAR, width, BAR, color);
            let number = ticks::significant(bar.value / horizontal.factor).replace('-', "−");
            svg.text(place, base, &number, TextStyle::new(NUMBER, anchor).halo());
        }
        let top = (zero, area.top);
        svg.line(top, (zero, area.bottom()), Stroke::solid(Color::Ink, 1.5));
        let middle = area.left + area.width / 2.0;
        let style = TextStyle::new(LABEL, Anchor::Middle);
        svg.text(
            middle,
            area.bottom() + 56.0,
            &self.abscissa.label(exponent),
            style,
        );
        svg.finish()
    }
}
