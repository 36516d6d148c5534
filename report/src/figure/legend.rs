//! Names of curves, in rows above the panels.

use super::font::text_width;
use super::palette::{self, Color};
use super::svg::{Anchor, Stroke, Svg, TextStyle};

const NUMBER: f64 = 15.0;
/// Length of a piece of a curve.
const SAMPLE: f64 = 38.0;

/// The line of the curve with this index.
pub(super) fn curve_stroke(index: usize) -> Stroke {
    Stroke {
        color: Color::Series(index),
        width: 2.0,
        dash: palette::dash(index),
    }
}

/// Names broken into rows: for each its index and offset.
pub(super) fn legend_rows<'a>(names: &[&'a str], width: f64) -> Vec<Vec<(usize, f64, &'a str)>> {
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

/// Each name with a piece of its curve; in a page they are buttons.
pub(super) fn draw_legend(svg: &mut Svg<'_>, rows: &[Vec<(usize, f64, &str)>], left: f64) {
    for (row, entries) in rows.iter().enumerate() {
        let y = 98.0 + 26.0 * row as f64;
        for (index, offset, name) in entries {
            let x = left + offset;
            svg.begin_group(
                "legend-item",
                &[
                    ("data-name", (*name).to_owned()),
                    ("role", "button".to_owned()),
                    ("tabindex", "0".to_owned()),
                    ("aria-pressed", "true".to_owned()),
                    ("aria-label", format!("Curve {name}")),
                ],
            );
            svg.line((x, y), (x + SAMPLE, y), curve_stroke(*index));
            svg.text(
                x + SAMPLE + 8.0,
                y + NUMBER * 0.36,
                name,
                TextStyle::new(NUMBER, Anchor::Start),
            );
            svg.end_group();
        }
    }
}
