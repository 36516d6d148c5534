//! Amplitude and phase over frequency, one above the other.

use super::axes::{Area, LABEL, RIGHT, Scaled, WIDTH};
use super::history::Ordinate;
use super::legend::{curve_stroke, draw_legend, legend_rows};
use super::svg::{Anchor, CurveTag, Svg, Target, TextStyle};
use super::{decimate, ticks};

/// Heights of the two panels, and the gap between them. Choices of layout.
const HEIGHTS: [f64; 2] = [400.0, 240.0];
const GAP: f64 = 28.0;
/// The axis of the phase ends at multiples of this (°): a mechanical resonance turns the phase by a multiple
/// of 90°.
const EIGHTH: f64 = 45.0;
/// Most decades of the amplitudes. A choice: smaller amplitudes are rounding.
const DECADES: usize = 6;
/// Points that are nearer to each other (pixels) are drawn as one. A choice: a line is wider.
const NEAR: f64 = 0.3;

/// One frequency response.
#[derive(Clone, Debug, PartialEq)]
pub struct BodeCurve {
    /// The name in the legend.
    pub name: String,
    /// Frequencies (Hz), increasing and above zero.
    pub frequency: Vec<f64>,
    /// Amplitudes, in the unit of the ordinate.
    pub amplitude: Vec<f64>,
    /// Phases (°) against the input; whole turns may be added or left out.
    pub phase: Vec<f64>,
}

/// A figure of frequency responses.
#[derive(Clone, Debug, PartialEq)]
pub struct Bode {
    /// Title.
    pub title: String,
    /// The line under the title: model, analysis.
    pub subtitle: String,
    /// The axis of the amplitudes.
    pub ordinate: Ordinate,
    /// The curves.
    pub curves: Vec<BodeCurve>,
}

impl Bode {
    pub(crate) fn draw(&self, target: Target<'_>) -> String {
        let phases: Vec<Vec<f64>> = self.curves.iter().map(|c| continued(&c.phase)).collect();
        let (low, high) = ticks::extent(self.curves.iter().flat_map(|c| &c.frequency).copied());
        let horizontal = Scaled::ratios(low, high, "Frequency", "Hz");
        let amplitudes = self.curves.iter().flat_map(|c| &c.amplitude).copied();
        let (low, high) = ticks::extent(amplitudes.filter(|amplitude| *amplitude > 0.0));
        let (name, unit) = (&self.ordinate.quantity, &self.ordinate.unit);
        let amplitude = Scaled::decades(low, high, DECADES, name, unit);
        let (low, high) = ticks::extent(phases.iter().flatten().copied());
        let (low, high) = match high - low > EIGHTH {
            true => (
                // a phase at a mark, up to a thousandth of a step, needs no further step
                EIGHTH * (low / EIGHTH + 1e-3).floor(),
                EIGHTH * (high / EIGHTH - 1e-3).ceil(),
            ),
            false => (low, high),
        };
        let phase = Scaled::plain(ticks::crank_angle(low, high, 6), "Phase", "°");
        let left = amplitude.left().max(phase.left());
        let width = WIDTH - left - RIGHT;
        let names: Vec<&str> = self.curves.iter().map(|c| c.name.as_str()).collect();
        let legend = legend_rows(&names, &[], width);
        let upper = Area {
            left,
            top: 92.0 + 26.0 * legend.len() as f64,
            width,
            height: HEIGHTS[0],
        };
        let lower = Area {
            top: upper.bottom() + GAP,
            height: HEIGHTS[1],
            ..upper
        };
        let mut svg = Svg::new(WIDTH, lower.bottom() + 78.0, &self.title, target);
        svg.head(left, width, &self.title, &self.subtitle);
        draw_legend(&mut svg, &legend, left);
        upper.begin_panel(&mut svg, &horizontal, &amplitude, &[]);
        upper.draw(&mut svg, &horizontal, &amplitude, false);
        let values = self.curves.iter().map(|curve| &curve.amplitude);
        self.draw_curves(&mut svg, &upper, values, (&horizontal, &amplitude));
        svg.end_group();
        lower.begin_panel(&mut svg, &horizontal, &phase, &[]);
        lower.draw(&mut svg, &horizontal, &phase, true);
        self.draw_curves(&mut svg, &lower, phases.iter(), (&horizontal, &phase));
        svg.end_group();
        upper.label_left(&mut svg, &self.ordinate.label(0));
        lower.label_left(&mut svg, "Phase (°)");
        let middle = lower.left + lower.width / 2.0;
        let style = TextStyle::new(LABEL, Anchor::Middle);
        svg.text(middle, lower.bottom() + 56.0, "Frequency (Hz)", style);
        svg.finish()
    }

    fn draw_curves<'c>(
        &self,
        svg: &mut Svg<'_>,
        area: &Area,
        values: impl Iterator<Item = &'c Vec<f64>>,
        (horizontal, vertical): (&Scaled, &Scaled),
    ) {
        svg.begin_clip(area.left, area.top, area.width, area.height);
        for (index, (curve, values)) in self.curves.iter().zip(values).enumerate() {
            let points: Vec<(f64, f64)> = curve
                .frequency
                .iter()
                .zip(values)
                .map(|(x, y)| (horizontal.scale.even(*x), vertical.scale.even(*y)))
                .map(|(x, y)| (area.x(x, &horizontal.ticks), area.y(y, &vertical.ticks)))
                .collect();
            // an amplitude of zero has no place on its axis
            for piece in points.split(|(x, y)| !(x.is_finite() && y.is_finite())) {
                let kept = decimate::thinned(piece, NEAR);
                let kept: Vec<(f64, f64)> = kept
                    .iter()
                    .filter_map(|at| piece.get(*at).copied())
                    .collect();
                let tag = CurveTag {
                    name: &curve.name,
                    ..CurveTag::default()
                };
                svg.curve(&kept, curve_stroke(index), &tag);
            }
        }
        svg.end_clip();
    }
}

/// Phases (°) with the whole turns that make steps of at most half a turn.
pub fn continued(phases: &[f64]) -> Vec<f64> {
    let mut before: Option<f64> = None;
    phases
        .iter()
        .map(|phase| {
            let turns = before.map_or(0.0, |before| ((phase - before) / 360.0).round());
            let here = phase - 360.0 * turns;
            if here.is_finite() {
                before = Some(here);
            }
            here
        })
        .collect()
}
