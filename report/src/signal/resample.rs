//! Values between the samples.

use super::{SignalError, check_finite, check_increasing, check_length, check_same_length};

/// The interpolation between samples; its name is printed with results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight lines: error h²/8·max|y″|.
    Linear,
    /// Cubic Hermite pieces whose slopes come from the parabola through a sample and its neighbours: exact
    /// for parabolas, error O(h³).
    Cubic,
}

impl Interpolation {
    /// Its name for readers.
    pub fn name(self) -> &'static str {
        match self {
            Interpolation::Linear => "linear interpolation",
            Interpolation::Cubic => "cubic Hermite interpolation",
        }
    }
}

/// Values at the places `grid`, which must increase and lie within the samples.
///
/// # Errors
/// Fewer than two samples, different lengths, values that are not finite, abscissae that do not increase,
/// places outside.
pub fn resample(
    x: &[f64],
    y: &[f64],
    grid: &[f64],
    interpolation: Interpolation,
) -> Result<Vec<f64>, SignalError> {
    check_same_length("abscissa and signal", x, y)?;
    check_length("interpolation", 2, x.len())?;
    check_increasing("the abscissa", x)?;
    check_finite("the signal", y)?;
    check_increasing("the grid", grid)?;
    let (Some(first), Some(last)) = (x.first(), x.last()) else {
        return Ok(Vec::new());
    };
    // a place beyond an end by a rounding error counts as the end
    let slack = 1e-9 * (last - first);
    let slopes = match interpolation {
        Interpolation::Linear => Vec::new(),
        Interpolation::Cubic => slopes(x, y),
    };
    let mut values = Vec::with_capacity(grid.len());
    let mut piece = 0;
    for place in grid {
        if *place < first - slack || *place > last + slack {
            return Err(SignalError::Outside {
                position: *place,
                from: *first,
                to: *last,
            });
        }
        let place = place.clamp(*first, *last);
        while piece + 2 < x.len() && x.get(piece + 1).is_some_and(|x| *x < place) {
            piece += 1;
        }
        let (Some([x0, x1]), Some([y0, y1])) = (x.get(piece..piece + 2), y.get(piece..piece + 2))
        else {
            continue;
        };
        let width = x1 - x0;
        let t = (place - x0) / width;
        values.push(match slopes.get(piece..piece + 2) {
            Some([m0, m1]) => {
                let u = 1.0 - t;
                y0 * u * u * (1.0 + 2.0 * t)
                    + y1 * t * t * (1.0 + 2.0 * u)
                    + width * t * u * (m0 * u - m1 * t)
            }
            _ => y0 + t * (y1 - y0),
        });
    }
    Ok(values)
}

/// Slopes of the parabolas through three neighbours, at the ends of the first and last of them.
fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let chords: Vec<f64> = x
        .windows(2)
        .zip(y.windows(2))
        .map(|(x, y)| match (x, y) {
            ([x0, x1], [y0, y1]) => (y1 - y0) / (x1 - x0),
            _ => 0.0,
        })
        .collect();
    let width = |i: usize| match x.get(i..i + 2) {
        Some([a, b]) => b - a,
        _ => 1.0,
    };
    let chord = |i: usize| chords.get(i).copied().unwrap_or_default();
    let last = x.len() - 1;
    (0..=last)
        .map(|i| {
            if last == 1 {
                return chord(0);
            }
            // the middle of the three, and the place of the slope
            let middle = i.clamp(1, last - 1);
            let (left, right) = (width(middle - 1), width(middle));
            let curvature = (chord(middle) - chord(middle - 1)) / (left + right);
            let slope = chord(middle - 1) + curvature * left;
            match i {
                0 => slope - 2.0 * curvature * left,
                i if i == last => slope + 2.0 * curvature * right,
                _ => slope,
            }
        })
        .collect()
}
