//! The cells of a map: few enough to be drawn, none of the peaks lost.

use super::super::axes::{Area, Scaled};
use super::super::levels::level;
use super::super::palette::{Color, LEVEL_COUNT};
use super::super::svg::Svg;
use super::SweepFigure;
use crate::escape::base64;
use crate::signal::SweepMap;

/// Cells of a speed at most: more are merged, the largest amplitude stays. A choice: a cell is then about two
/// pixels high.
pub const ROWS: usize = 320;

/// Amplitudes merged to few enough cells.
pub(crate) struct Cells {
    /// A column a speed, each from the lowest position up.
    pub values: Vec<Vec<f64>>,
    /// Lower end and height of a cell (Hz, or orders).
    start: f64,
    step: f64,
}

impl Cells {
    pub fn new(map: &SweepMap, reach: f64) -> Cells {
        let step = match map.positions() {
            [first, second, ..] => second - first,
            _ => 1.0,
        };
        let count = map
            .positions()
            .iter()
            // positions are multiples of a step, and round
            .take_while(|p| **p <= reach * (1.0 + 1e-9))
            .count();
        let merged = count.div_ceil(ROWS).max(1);
        let values = map
            .amplitudes()
            .iter()
            .map(|row| {
                row.get(..count)
                    .unwrap_or_default()
                    .chunks(merged)
                    .map(|chunk| {
                        chunk
                            .iter()
                            .copied()
                            .filter(|v| !v.is_nan())
                            .reduce(f64::max)
                            .unwrap_or(f64::NAN)
                    })
                    .collect()
            })
            .collect();
        Cells {
            values,
            start: -step / 2.0,
            step: step * merged as f64,
        }
    }

    /// The numbers for the readout.
    pub fn attributes(&self, edges: &[f64], figure: &SweepFigure) -> Vec<(&'static str, String)> {
        let rows = self.values.iter().map(Vec::len).max().unwrap_or(0);
        let bytes: Vec<u8> = self
            .values
            .iter()
            .flatten()
            .flat_map(|v| (*v as f32).to_le_bytes())
            .collect();
        let edges: Vec<String> = edges.iter().map(|e| format!("{e}")).collect();
        let speeds: Vec<String> = figure.map.speeds().iter().map(|s| format!("{s}")).collect();
        vec![
            ("data-map", base64(&bytes)),
            ("data-map-rows", rows.to_string()),
            ("data-map-edges", edges.join(" ")),
            ("data-map-speeds", speeds.join(" ")),
            ("data-map-start", format!("{}", self.start)),
            ("data-map-step", format!("{}", self.step)),
            ("data-map-name", figure.quantity.clone()),
            ("data-map-unit", figure.unit.clone()),
        ]
    }
}

/// Halfway between speeds, and as far beyond the ends.
pub fn edges(speeds: &[f64]) -> Vec<f64> {
    match speeds {
        [] => Vec::new(),
        [only] => vec![only - 50.0, only + 50.0],
        _ => {
            let middles: Vec<f64> = speeds
                .windows(2)
                .filter_map(|pair| Some((pair.first()? + pair.last()?) / 2.0))
                .collect();
            let mut edges = Vec::with_capacity(speeds.len() + 1);
            if let (Some(speed), Some(middle)) = (speeds.first(), middles.first()) {
                edges.push(2.0 * speed - middle);
            }
            edges.extend(&middles);
            if let (Some(speed), Some(middle)) = (speeds.last(), middles.last()) {
                edges.push(2.0 * speed - middle);
            }
            edges
        }
    }
}

/// The cells, those of one level in one path, neighbours of one level as one rectangle.
pub(super) fn draw_cells(
    svg: &mut Svg<'_>,
    area: &Area,
    (x, y): (&Scaled, &Scaled),
    cells: &Cells,
    edges: &[f64],
    range: (f64, f64),
) {
    let mut paths: Vec<Vec<(f64, f64, f64, f64)>> = vec![Vec::new(); LEVEL_COUNT];
    for (column, side) in cells.values.iter().zip(edges.windows(2)) {
        let [from, to] = side else { continue };
        let (left, right) = (area.x(*from, &x.ticks), area.x(*to, &x.ticks));
        let mut row = 0;
        while let Some(value) = column.get(row) {
            let this = level(*value, range);
            let run = column
                .iter()
                .skip(row)
                .take_while(|v| level(**v, range) == this)
                .count();
            let bottom = cells.start + row as f64 * cells.step;
            let top = bottom + run as f64 * cells.step;
            if let Some(path) = this.and_then(|level| paths.get_mut(level)) {
                let (upper, lower) = (area.y(top, &y.ticks), area.y(bottom, &y.ticks));
                path.push((left, upper, right - left, lower - upper));
            }
            row += run.max(1);
        }
    }
    for (level, path) in paths.iter().enumerate() {
        svg.cells(path, Color::Level(level));
    }
}
