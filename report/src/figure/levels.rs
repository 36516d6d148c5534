//! The colours of a map beside it, with their numbers.

use super::axes::{Area, LABEL, SMALL};
use super::font::text_width;
use super::palette::{Color, LEVEL_COUNT};
use super::svg::{Anchor, Stroke, Svg, TextStyle};
use super::ticks::{self, Ticks};

/// The level of a value within the range of a map; `None` for a value that is no number.
pub(super) fn level(value: f64, (low, high): (f64, f64)) -> Option<usize> {
    let share = (value - low) / (high - low);
    share
        .is_finite()
        .then(|| (share.clamp(0.0, 1.0) * LEVEL_COUNT as f64) as usize)
        .map(|level| level.min(LEVEL_COUNT - 1))
}

/// The colours with their numbers.
pub(super) fn draw_levels(svg: &mut Svg<'_>, area: &Area, levels: &Ticks, label: &str) {
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
