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

#[cfg(test)]
mod tests {
    use super::*;

    fn loop_of_work() -> Xy {
        let angle: Vec<f64> = (0..=360).map(f64::from).collect();
        let axis = |quantity: &str, unit: &str| Ordinate {
            quantity: quantity.to_owned(),
            unit: unit.to_owned(),
            frame: String::new(),
        };
        Xy {
            title: "Indicator".to_owned(),
            subtitle: "Test".to_owned(),
            x: axis("Volume", "cm³"),
            y: axis("Pressure", "bar"),
            curves: vec![XyCurve {
                name: "gas".to_owned(),
                x: angle
                    .iter()
                    .map(|a| 300.0 + 200.0 * libm::cos(a.to_radians()))
                    .collect(),
                y: angle
                    .iter()
                    .map(|a| 4.0 + 3.0 * libm::sin(a.to_radians()))
                    .collect(),
                angle,
            }],
        }
    }

    #[test]
    fn a_loop_returns_to_its_begin_and_keeps_its_angles() {
        let svg = Xy::to_svg(&loop_of_work());
        assert!(svg.contains("Volume (cm³)") && svg.contains("Pressure (bar)"));
        let (_, polyline) = svg.split_once("<polyline").unwrap();
        let (_, points) = polyline.split_once("points=\"").unwrap();
        let points: Vec<(f64, f64)> = points
            .split_once('"')
            .unwrap()
            .0
            .split(' ')
            .map(|point| {
                let (x, y) = point.split_once(',').unwrap();
                (x.parse().unwrap(), y.parse().unwrap())
            })
            .collect();
        assert_eq!(points.len(), 361);
        assert_eq!(points.first(), points.last());
        // a circle of the data is an ellipse of pixels: each point lies on it
        let middle = |low: f64, high: f64| (0.5 * (low + high), 0.5 * (high - low));
        let least =
            |of: fn(&(f64, f64)) -> f64| points.iter().map(of).fold(f64::INFINITY, f64::min);
        let most = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).fold(0.0, f64::max);
        let (x, a) = middle(least(|p| p.0), most(|p| p.0));
        let (y, b) = middle(least(|p| p.1), most(|p| p.1));
        for point in &points {
            let off = libm::hypot((point.0 - x) / a, (point.1 - y) / b) - 1.0;
            assert!(off.abs() < 1e-3, "{point:?}: {off}");
        }
    }

    #[test]
    fn gaps_and_nothing_are_drawn() {
        let mut figure = loop_of_work();
        figure.curves[0].y[100] = f64::NAN;
        let svg = figure.to_svg();
        assert_eq!(svg.matches("<polyline").count(), 2);
        assert!(!svg.contains("NaN"));
        figure.curves.clear();
        assert!(!figure.to_svg().contains("NaN"));
    }
}
