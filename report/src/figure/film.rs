//! Quantities over angle and width of bearings: one panel for each bearing, with the same colours.

use super::axes::{Area, LABEL, RIGHT, SMALL, Scaled, WIDTH};
use super::levels::{draw_levels, level};
use super::palette::{Color, LEVEL_COUNT};
use super::svg::{Anchor, Stroke, Svg, Target, TextStyle};
use super::ticks;

/// A turn (°).
const TURN: f64 = 360.0;
/// Height of a panel, and its distance from the next one. Choices of layout.
const PANEL: f64 = 300.0;
const APART: f64 = 118.0;

/// Maps of the films of some bearings at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmMap {
    /// Title.
    pub title: String,
    /// Stands under the title: model and analysis.
    pub subtitle: String,
    /// `Pressure`.
    pub quantity: String,
    /// `MPa`.
    pub unit: String,
    /// One for each bearing.
    pub panels: Vec<FilmPanel>,
}

/// The map of one bearing, unwrapped.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmPanel {
    /// The bearing.
    pub name: String,
    /// The moment: `372 °CA`.
    pub moment: String,
    /// The axes of the shell; angles count from its x about its z.
    pub frame: String,
    /// Lines between columns of cells (°), rising over one turn.
    pub around: Vec<f64>,
    /// Lines between rows of cells (mm), rising, from mid width.
    pub across: Vec<f64>,
    /// Cell by cell, column by column.
    pub values: Vec<f64>,
    /// Edges of openings: around (°), across (mm).
    pub openings: Vec<[[f64; 2]; 2]>,
    /// Place of the extreme (°, mm).
    pub mark: Option<(f64, f64)>,
    /// The extreme in words.
    pub facts: String,
}

impl FilmMap {
    pub(crate) fn draw(&self, target: Target<'_>) -> String {
        let count = self.panels.len().max(1) as f64;
        let height = 110.0 + count * (PANEL + APART);
        let left = 116.0;
        let mut svg = Svg::new(WIDTH, height, &self.title, target);
        svg.head(left, WIDTH - left - RIGHT, &self.title, &self.subtitle);
        let values = self.panels.iter().flat_map(|panel| &panel.values);
        let (low, high) = ticks::extent(values.copied());
        let levels = ticks::rounded(low.min(0.0), high, 5);
        for (at, panel) in self.panels.iter().enumerate() {
            let area = Area {
                left,
                top: 134.0 + at as f64 * (PANEL + APART),
                width: 856.0,
                height: PANEL,
            };
            panel.draw(&mut svg, &area, levels.range);
            let label = match self.unit.as_str() {
                "" | "1" => self.quantity.clone(),
                unit => format!("{} ({unit})", self.quantity),
            };
            draw_levels(&mut svg, &area, &levels, &label);
        }
        svg.finish()
    }
}

impl FilmPanel {
    fn draw(&self, svg: &mut Svg<'_>, area: &Area, range: (f64, f64)) {
        let x = Scaled {
            kind: "angle",
            ..Scaled::plain(ticks::crank_angle(0.0, TURN, 12), "Angle", "°")
        };
        let ends = (self.across.first().copied(), self.across.last().copied());
        let (low, high) = (ends.0.unwrap_or(-1.0), ends.1.unwrap_or(1.0));
        let y = Scaled::plain(ticks::inside(low, high, 5), "Place across", "mm");
        svg.text(
            area.left,
            area.top - 12.0,
            &format!("{}, {}", self.name, self.moment),
            TextStyle::new(LABEL, Anchor::Start).bold(),
        );
        svg.text(
            area.right(),
            area.top - 12.0,
            &self.facts,
            TextStyle::new(SMALL, Anchor::End).soft(),
        );
        area.begin_panel(svg, &x, &y, &[]);
        area.draw(svg, &x, &y, true);
        svg.begin_clip(area.left, area.top, area.width, area.height);
        self.draw_cells(svg, area, (&x, &y), range);
        let line = Stroke::solid(Color::OnMap, 1.6);
        for [around, across] in &self.openings {
            for (left, right) in within_a_turn(*around) {
                let [left, right] = [left, right].map(|angle| area.x(angle, &x.ticks));
                let (top, bottom) = (area.y(across[1], &y.ticks), area.y(across[0], &y.ticks));
                svg.frame(left, top, right - left, bottom - top, line);
            }
        }
        if let Some((angle, place)) = self.mark {
            let at = (
                area.x(angle.rem_euclid(TURN), &x.ticks),
                area.y(place, &y.ticks),
            );
            svg.circle(at, 6.0, None, Stroke::solid(Color::MapSeam, 4.0));
            svg.circle(at, 6.0, None, line);
        }
        svg.end_clip();
        svg.end_group();
        let below = match self.frame.as_str() {
            "" => "Angle from x about z of the shell (°)".to_owned(),
            axes => format!("Angle from x about z of {axes} (°)"),
        };
        area.label(svg, &below, "Across (mm)");
    }

    fn draw_cells(
        &self,
        svg: &mut Svg<'_>,
        area: &Area,
        (x, y): (&Scaled, &Scaled),
        range: (f64, f64),
    ) {
        let rows = self.across.len().saturating_sub(1).max(1);
        let mut paths: Vec<Vec<(f64, f64, f64, f64)>> = vec![Vec::new(); LEVEL_COUNT];
        for (column, sides) in self.values.chunks(rows).zip(self.around.windows(2)) {
            for (from, to) in within_a_turn([sides[0], sides[1]]) {
                let (left, right) = (area.x(from, &x.ticks), area.x(to, &x.ticks));
                for (value, ends) in column.iter().zip(self.across.windows(2)) {
                    let (upper, lower) = (area.y(ends[1], &y.ticks), area.y(ends[0], &y.ticks));
                    if let Some(path) = level(*value, range).and_then(|at| paths.get_mut(at)) {
                        path.push((left, upper, right - left, lower - upper));
                    }
                }
            }
        }
        for (at, path) in paths.iter().enumerate() {
            svg.cells(path, Color::Level(at));
        }
    }
}

/// The parts of a sector (°) within 0 to 360°.
pub fn within_a_turn([from, to]: [f64; 2]) -> Vec<(f64, f64)> {
    let turns = (from / TURN).floor();
    let (from, to) = (from - TURN * turns, to - TURN * turns);
    match to > TURN {
        true => vec![(from, TURN), (0.0, (to - TURN).min(from))],
        false => vec![(from, to)],
    }
}
