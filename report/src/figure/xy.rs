//! Curves of one quantity over another one, such as pressure over volume.

use super::axes::{Area, RIGHT, Scaled, WIDTH};
use super::history::Ordinate;
use super::legend::{curve_stroke, draw_legend, legend_rows};
use super::svg::{CurveTag, Svg, Target};
use super::{decimate, ticks};

const HEIGHT: f64 = 640.0;
/// Points that are nearer to each other (pixels) are drawn as one. A choice: a line is wider.
const NEAR: f64 = 0.3;

/// One named curve.
#[derive(Clone, Debug, PartialEq)]
pub struct XyCurve {
    /// The name in the legend.
    pub name: String,
    /// Along the abscissa, in its unit, in order of time.
    pub x: Vec<f64>,
    /// Along the ordinate, in its unit.
    pub y: Vec<f64>,
    /// Crank angle of each sample (°); empty if there is none.
    pub angle: Vec<f64>,
}

/// A figure of curves of one quantity over another one.
#[derive(Clone, Debug, PartialEq)]
pub struct Xy {
    /// Title.
    pub title: String,
    /// The line under the title: model, analysis, filter.
    pub subtitle: String,
    /// The abscissa.
    pub x: Ordinate,
    /// The ordinate.
    pub y: Ordinate,
    /// The curves.
    pub curves: Vec<XyCurve>,
}

impl Xy {
    pub(crate) fn draw(&self, target: Target<'_>) -> String {
        let all = |of: fn(&XyCurve) -> &Vec<f64>| self.curves.iter().flat_map(of).copied();
        let (low, high) = ticks::extent(all(|curve| &curve.x));
        let ticks = ticks::rounded(low, high, 10);
        let horizontal = Scaled::plain(ticks, &self.x.quantity, &self.x.unit);
        let (low, high) = ticks::extent(all(|curve| &curve.y));
        let ticks = ticks::rounded(low, high, 8);
        let (vertical, exponent) = Scaled::divided(ticks, &self.y.quantity, &self.y.unit);
        let left = vertical.left();
        let names: Vec<&str> = self
            .curves
            .iter()
            .map(|curve| curve.name.as_str())
            .collect();
        let legend = legend_rows(&names, &[], WIDTH - left - RIGHT);
        let area = Area {
            left,
            top: 92.0 + 26.0 * legend.len() as f64,
            width: WIDTH - left - RIGHT,
            height: HEIGHT,
        };
        let mut svg = Svg::new(WIDTH, area.bottom() + 78.0, &self.title, target);
        svg.head(left, area.width, &self.title, &self.subtitle);
        draw_legend(&mut svg, &legend, left);
        area.begin_panel(&mut svg, &horizontal, &vertical, &[]);
        area.draw(&mut svg, &horizontal, &vertical, true);
        svg.begin_clip(area.left, area.top, area.width, area.height);
        for (index, curve) in self.curves.iter().enumerate() {
            draw_curve(&mut svg, &area, curve, index, (&horizontal, &vertical));
        }
        svg.end_clip();
        svg.end_group();
        area.label(&mut svg, &self.x.label(0), &self.y.label(exponent));
        svg.finish()
    }
}

/// A curve; a point that is not finite ends a piece.
fn draw_curve(
    svg: &mut Svg<'_>,
    area: &Area,
    curve: &XyCurve,
    index: usize,
    (horizontal, vertical): (&Scaled, &Scaled),
) {
    let samples: Vec<(f64, f64)> = curve
        .x
        .iter()
        .copied()
        .zip(curve.y.iter().copied())
        .collect();
    let mut from = 0;
    for piece in samples.split(|(x, y)| !(x.is_finite() && y.is_finite())) {
        let points: Vec<(f64, f64)> = piece
            .iter()
            .map(|(x, y)| (area.x(*x, &horizontal.ticks), area.y(*y, &vertical.ticks)))
            .collect();
        let kept = decimate::thinned(&points, NEAR);
        let tag = CurveTag {
            name: &curve.name,
            angles: kept
                .iter()
                .filter_map(|at| curve.angle.get(from + at).copied())
                .collect(),
            ..CurveTag::default()
        };
        let points: Vec<(f64, f64)> = kept
            .iter()
            .filter_map(|at| points.get(*at).copied())
            .collect();
        svg.curve(&points, curve_stroke(index), &tag);
        from += piece.len() + 1;
    }
}
