//! The places of crank angles along a path in a plane, and the places of their numbers.

use super::font::text_width;
use super::palette::Color;
use super::plane::Cell;
use super::svg::{Anchor, Stroke, Svg, TextStyle, coordinate};

const SMALL: f64 = 13.0;

/// More than the rounding of an angle (°). A choice: samples are much farther apart.
const SLACK: f64 = 1e-6;

/// Multiples of 90° in the last cycle: angle within the cycle (°) and place, linear between samples.
pub(crate) fn marks(cell: &Cell<'_>, period: f64) -> Vec<(i64, f64, f64)> {
    let mut found: Vec<(i64, f64, f64)> = Vec::new();
    let samples = cell.angle.len().min(cell.x.len()).min(cell.y.len());
    let start = cell.last_cycle;
    let (Some(first), Some(end)) = (cell.angle.get(start), cell.angle.last()) else {
        return found;
    };
    // a shaft can turn either way: from here on, angles are counted along its way
    let sense = if end < first { -1.0 } else { 1.0 };
    let along = |index: usize| sense * cell.angle[index];
    let quarter = |angle: f64| ((angle + SLACK) / 90.0).floor();
    // a hundred revolutions are no cycle
    let period = if period > 0.0 && period <= 36_000.0 {
        period
    } else {
        360.0
    };
    let last = sense * first + period - SLACK;
    for index in start..samples {
        let here = along(index);
        // the first sample has a mark only if it is at a multiple of 90°
        let before = if index > start { index - 1 } else { index };
        let width = here - along(before);
        // there are no marks if the shaft turns back, or if the angle jumps, is no number or is so large that
        // rounding hides 90°
        if !(0.0..=period).contains(&width) || here.abs() >= 1e9 {
            continue;
        }
        let mut mark = if index > start {
            90.0 * (quarter(along(before)) + 1.0)
        } else {
            90.0 * ((here - SLACK) / 90.0).ceil()
        };
        while mark <= here + SLACK && mark < last {
            let share = if width > 0.0 {
                ((mark - along(before)) / width).clamp(0.0, 1.0)
            } else {
                1.0
            };
            let between = |v: &[f64]| v[before] + share * (v[index] - v[before]);
            let (x, y) = (between(&cell.x), between(&cell.y));
            let angle = sense * mark;
            let angle = angle - period * ((angle + SLACK) / period).floor();
            if x.is_finite() && y.is_finite() {
                found.push((angle.round() as i64, x, y));
            }
            mark += 90.0;
        }
    }
    found
}

/// Draws rings (in pixels). A ring has its angle (°) if there is room in the square of this side at `corner`.
pub(super) fn draw_marks(
    svg: &mut Svg<'_>,
    rings: &[(i64, (f64, f64))],
    corner: (f64, f64),
    side: f64,
) {
    let count = rings.len().max(1) as f64;
    let middle = rings.iter().fold((0.0, 0.0), |m, (_, p)| {
        (m.0 + p.0 / count, m.1 + p.1 / count)
    });
    let mut taken: Vec<Rect> = rings
        .iter()
        .map(|(_, p)| Rect::around(*p, 6.0, 6.0))
        .collect();
    for (_, place) in rings {
        svg.begin_group("mark", &place_of(*place));
        svg.circle(
            *place,
            4.2,
            Some(Color::Sheet),
            Stroke::solid(Color::Series(1), 1.8),
        );
        svg.end_group();
    }
    let sheet = Rect {
        left: corner.0,
        top: corner.1,
        right: corner.0 + side,
        bottom: corner.1 + side,
    };
    for &(angle, place) in rings {
        let text = format!("{angle}°");
        let size = (text_width(&text, SMALL, false) / 2.0 + 1.0, SMALL * 0.5);
        let outward = libm::atan2(place.1 - middle.1, place.0 - middle.0);
        let room = [0, 1, -1, 2, -2, 3, -3, 4].into_iter().find_map(|turn| {
            let direction = outward + f64::from(turn) * std::f64::consts::FRAC_PI_4;
            let (dx, dy) = (libm::cos(direction), libm::sin(direction));
            let center = (place.0 + dx * (9.0 + size.0), place.1 + dy * (9.0 + size.1));
            let rect = Rect::around(center, size.0, size.1);
            (rect.inside(&sheet) && !taken.iter().any(|t| t.meets(&rect))).then_some(rect)
        });
        if let Some(rect) = room {
            svg.begin_group("mark", &place_of(place));
            svg.text(
                (rect.left + rect.right) / 2.0,
                rect.bottom - SMALL * 0.14,
                &text,
                TextStyle::new(SMALL, Anchor::Middle).halo(),
            );
            svg.end_group();
            taken.push(rect);
        }
    }
}

/// The place of a mark, for the script of the page.
fn place_of(place: (f64, f64)) -> [(&'static str, String); 2] {
    [
        ("data-x", coordinate(place.0)),
        ("data-y", coordinate(place.1)),
    ]
}

/// The box of a label.
#[derive(Clone, Copy, Debug)]
struct Rect {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

impl Rect {
    fn around(center: (f64, f64), half_width: f64, half_height: f64) -> Rect {
        Rect {
            left: center.0 - half_width,
            top: center.1 - half_height,
            right: center.0 + half_width,
            bottom: center.1 + half_height,
        }
    }

    fn meets(&self, other: &Rect) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn inside(&self, other: &Rect) -> bool {
        self.left >= other.left
            && self.right <= other.right
            && self.top >= other.top
            && self.bottom <= other.bottom
    }
}
