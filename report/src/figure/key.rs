//! The key of a plane figure: samples of its lines with words, in rows below the title.

use super::font::text_width;
use super::palette::Color;
use super::svg::{Anchor, Stroke, Svg, TextStyle};

const NUMBER: f64 = 14.0;

/// An entry of the key.
#[derive(Clone, Copy, Debug)]
pub(super) enum KeyKind {
    Clearance,
    Half,
    Limit,
    Last,
    Earlier,
    Mark,
}

pub(super) fn clearance_stroke() -> Stroke {
    Stroke::solid(Color::Ink, 1.8)
}

pub(super) fn half_stroke() -> Stroke {
    Stroke {
        color: Color::Rule,
        width: 1.2,
        dash: "5 4",
    }
}

pub(super) fn limit_stroke() -> Stroke {
    Stroke {
        color: Color::Series(1),
        width: 1.8,
        dash: "9 4",
    }
}

/// An entry with its place.
pub(super) struct KeyEntry {
    kind: KeyKind,
    text: String,
    x: f64,
    y: f64,
}

impl KeyEntry {
    pub fn draw(&self, svg: &mut Svg<'_>) {
        let (from, to) = ((self.x, self.y), (self.x + 32.0, self.y));
        match self.kind {
            KeyKind::Clearance => svg.line(from, to, clearance_stroke()),
            KeyKind::Half => svg.line(from, to, half_stroke()),
            KeyKind::Limit => svg.line(from, to, limit_stroke()),
            KeyKind::Last => svg.line(from, to, Stroke::solid(Color::Series(0), 2.2)),
            KeyKind::Earlier => svg.line(from, to, Stroke::solid(Color::Pale, 1.6)),
            KeyKind::Mark => svg.circle(
                (self.x + 16.0, self.y),
                4.2,
                Some(Color::Sheet),
                Stroke::solid(Color::Series(1), 1.8),
            ),
        }
        svg.text(
            self.x + 40.0,
            self.y + NUMBER * 0.36,
            &self.text,
            TextStyle::new(NUMBER, Anchor::Start),
        );
    }
}

/// The entries in rows of this width, and the number of rows.
pub(super) fn laid_out(kinds: Vec<(KeyKind, String)>, width: f64) -> (Vec<KeyEntry>, usize) {
    let (mut x, mut row) = (0.0, 0);
    let mut entries = Vec::new();
    for (kind, text) in kinds {
        let size = 32.0 + 8.0 + text_width(&text, NUMBER, false);
        if x > 0.0 && x + size > width {
            x = 0.0;
            row += 1;
        }
        entries.push(KeyEntry {
            kind,
            text,
            x: 40.0 + x,
            y: 98.0 + 26.0 * f64::from(row),
        });
        x += size + 26.0;
    }
    (entries, row as usize + 1)
}
