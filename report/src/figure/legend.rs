//! Names of curves, in rows above the panels.

use super::font::text_width;
use super::palette::{self, Color};
use super::svg::{Anchor, Stroke, Svg, TextStyle};

const NUMBER: f64 = 15.0;
/// Length of a piece of a curve. A choice of layout: the longest dash is seen whole.
const SAMPLE: f64 = 38.0;

/// The line of the curve with this index.
pub(super) fn curve_stroke(index: usize) -> Stroke {
    Stroke {
        color: Color::Series(index),
        width: 2.0,
        dash: palette::dash(index),
    }
}

/// The line of a named place on the horizontal axis.
pub(super) fn mark_stroke() -> Stroke {
    Stroke {
        color: Color::Rule,
        width: 1.2,
        dash: "2 4",
    }
}

/// A sample in the legend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sample {
    /// The curve with this index.
    Curve(usize),
    /// The line of a mark.
    Mark,
}

/// Names of curves and meanings of marks, broken into rows: for each its line, offset and text.
pub(super) fn legend_rows<'a>(
    names: &[&'a str],
    meanings: &[&'a str],
    width: f64,
) -> Vec<Vec<(Sample, f64, &'a str)>> {
    let mut rows: Vec<Vec<(Sample, f64, &str)>> = Vec::new();
    let mut offset = f64::INFINITY;
    let curves = names.iter().enumerate();
    let all = curves
        .map(|(index, name)| (Sample::Curve(index), *name))
        .chain(meanings.iter().map(|meaning| (Sample::Mark, *meaning)));
    for (sample, name) in all {
        let size = SAMPLE + 8.0 + text_width(name, NUMBER, false);
        if offset + size > width {
            rows.push(Vec::new());
            offset = 0.0;
        }
        if let Some(row) = rows.last_mut() {
            row.push((sample, offset, name));
        }
        offset += size + 28.0;
    }
    rows
}

/// Each name with a piece of its curve; in a page they are buttons.
pub(super) fn draw_legend(svg: &mut Svg<'_>, rows: &[Vec<(Sample, f64, &str)>], left: f64) {
    for (row, entries) in rows.iter().enumerate() {
        let y = 98.0 + 26.0 * row as f64;
        for (sample, offset, name) in entries {
            let x = left + offset;
            let Sample::Curve(index) = sample else {
                svg.line((x, y), (x + SAMPLE, y), mark_stroke());
                svg.text(
                    x + SAMPLE + 8.0,
                    y + NUMBER * 0.36,
                    name,
                    TextStyle::new(NUMBER, Anchor::Start).soft(),
                );
                continue;
            };
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
