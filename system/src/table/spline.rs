//! Cubic splines through points on a line: second derivatives ("moments") and monotone slopes at the points.

/// The condition that closes a cubic spline at an end of its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Closing {
    /// The third derivative is continuous at the next point ("not a knot"): the error stays of fourth order up to
    /// the end. Where no next point is left, the third derivative is zero.
    Free,
    /// The slope is zero.
    Level,
    /// The second derivative is zero (a "natural" end).
    Straight,
}

/// Second derivatives at the points of the cubic spline, by the tridiagonal system
/// `h₋ M₋ + 2 (h₋ + h) M + h M₊ = 6 (d − d₋)` for the inner points (de Boor, A Practical Guide to Splines,
/// ch. IV). `widths` h are the lengths of the intervals, `secants` d the slopes across them.
pub(super) fn moments(widths: &[f64], secants: &[f64], ends: [Closing; 2]) -> Vec<f64> {
    let n = widths.len();
    match n {
        0 => return vec![0.0],
        1 => return moments_of_one_interval(secants[0] / widths[0], ends).to_vec(),
        2 if ends == [Closing::Free; 2] => {
            // the parabola through three points
            return vec![2.0 * (secants[1] - secants[0]) / (widths[0] + widths[1]); 3];
        }
        _ => {}
    }
    // an end's moment as constant + near × (moment next to it) + far × (the one after that)
    let closed = |end: Closing, h: f64, next: f64, slope: f64| match end {
        Closing::Free => (0.0, 1.0 + h / next, -h / next),
        Closing::Level => (3.0 * slope / h, -0.5, 0.0),
        Closing::Straight => (0.0, 0.0, 0.0),
    };
    let mut first = closed(ends[0], widths[0], widths[1], secants[0]);
    let mut last = closed(ends[1], widths[n - 1], widths[n - 2], -secants[n - 1]);
    if n == 2 {
        // the moment after next is that of the other end, and one end at most is free
        let (constant, near, far) = first;
        first = (constant + far * last.0, near + far * last.1, 0.0);
        let (constant, near, far) = last;
        last = (constant + far * first.0, near + far * first.1, 0.0);
    }
    let mut diagonal: Vec<f64> = widths.windows(2).map(|w| 2.0 * (w[0] + w[1])).collect();
    let mut right: Vec<f64> = secants.windows(2).map(|d| 6.0 * (d[1] - d[0])).collect();
    let mut below = widths[1..n - 1].to_vec();
    let mut above = below.clone();
    let (h, k) = (widths[0], widths[n - 1]);
    diagonal[0] += h * first.1;
    right[0] -= h * first.0;
    diagonal[n - 2] += k * last.1;
    right[n - 2] -= k * last.0;
    if n > 2 {
        above[0] += h * first.2;
        below[n - 3] += k * last.2;
    }
    let inner = tridiagonal(&below, &diagonal, &above, &right);
    let end = |(constant, near, far): (f64, f64, f64), next: f64, after: Option<&f64>| {
        constant + near * next + far * after.copied().unwrap_or(0.0)
    };
    let mut moments = Vec::with_capacity(n + 1);
    moments.push(end(first, inner[0], inner.get(1)));
    moments.extend(&inner);
    moments.push(end(last, inner[n - 2], inner.iter().rev().nth(1)));
    moments
}

/// The moments at both ends of one interval; `bend` is its secant over its length.
fn moments_of_one_interval(bend: f64, ends: [Closing; 2]) -> [f64; 2] {
    use Closing::{Free, Level, Straight};
    // slopes at the ends: d − h (2 M₀ + M₁)/6 and d + h (M₀ + 2 M₁)/6; a free end has the moment of the other
    match ends {
        [Free | Straight, Free | Straight] => [0.0, 0.0],
        [Level, Free] => [2.0 * bend, 2.0 * bend],
        [Free, Level] => [-2.0 * bend, -2.0 * bend],
        [Level, Level] => [6.0 * bend, -6.0 * bend],
        [Level, Straight] => [3.0 * bend, 0.0],
        [Straight, Level] => [0.0, -3.0 * bend],
    }
}

/// Second derivatives at the points of the periodic cubic spline; the last repeats the first. The cyclic
/// system is solved by Sherman–Morrison (Press et al., Numerical Recipes, §2.7).
pub(super) fn periodic_moments(widths: &[f64], secants: &[f64]) -> Vec<f64> {
    let n = widths.len();
    let before = |i: usize| (i + n - 1) % n;
    let diagonal: Vec<f64> = (0..n)
        .map(|i| 2.0 * (widths[before(i)] + widths[i]))
        .collect();
    let right: Vec<f64> = (0..n)
        .map(|i| 6.0 * (secants[i] - secants[before(i)]))
        .collect();
    let mut moments = match n {
        0 | 1 => vec![0.0; n],
        2 => {
            // both neighbours of the point are the same point
            let side = widths[0] + widths[1];
            let determinant = diagonal[0] * diagonal[1] - side * side;
            vec![
                (right[0] * diagonal[1] - side * right[1]) / determinant,
                (diagonal[0] * right[1] - side * right[0]) / determinant,
            ]
        }
        _ => {
            let corner = widths[n - 1];
            let shift = -diagonal[0];
            let mut core = diagonal;
            core[0] -= shift;
            core[n - 1] -= corner * corner / shift;
            let mut column = vec![0.0; n];
            column[0] = shift;
            column[n - 1] = corner;
            let side = &widths[..n - 1];
            let y = tridiagonal(side, &core, side, &right);
            let z = tridiagonal(side, &core, side, &column);
            let factor =
                (y[0] + corner * y[n - 1] / shift) / (1.0 + z[0] + corner * z[n - 1] / shift);
            y.iter().zip(&z).map(|(y, z)| y - factor * z).collect()
        }
    };
    moments.push(moments.first().copied().unwrap_or(0.0));
    moments
}

/// Solves a diagonally dominant tridiagonal system (no pivoting needed).
fn tridiagonal(below: &[f64], diagonal: &[f64], above: &[f64], right: &[f64]) -> Vec<f64> {
    let n = diagonal.len();
    let mut pivots = diagonal.to_vec();
    let mut solution = right.to_vec();
    for i in 1..n {
        let factor = below[i - 1] / pivots[i - 1];
        pivots[i] -= factor * above[i - 1];
        solution[i] -= factor * solution[i - 1];
    }
    for i in (0..n).rev() {
        if i + 1 < n {
            solution[i] -= above[i] * solution[i + 1];
        }
        solution[i] /= pivots[i];
    }
    solution
}

/// Coefficients of each interval of a cubic spline in powers of the distance from its start.
pub(super) fn pieces(
    values: &[f64],
    widths: &[f64],
    secants: &[f64],
    moments: &[f64],
) -> Vec<[f64; 4]> {
    (0..widths.len())
        .map(|i| {
            let (h, m0, m1) = (widths[i], moments[i], moments[i + 1]);
            [
                values[i],
                secants[i] - h * (2.0 * m0 + m1) / 6.0,
                0.5 * m0,
                (m1 - m0) / (6.0 * h),
            ]
        })
        .collect()
}

/// Slopes at the points that keep the interpolant monotone where the points are: mean of the neighbouring
/// secants, zero at turning points, then limited to α² + β² ≤ 9 (Fritsch & Carlson, SIAM J. Numer. Anal. 17,
/// 1980, §4, region S₂).
pub(super) fn monotone_slopes(secants: &[f64], periodic: bool) -> Vec<f64> {
    let n = secants.len();
    let mean = |a: f64, b: f64| if a * b <= 0.0 { 0.0 } else { 0.5 * (a + b) };
    let mut slopes: Vec<f64> = (0..=n)
        .map(|i| match (i, periodic) {
            (0, false) => secants[0],
            (i, false) if i == n => secants[n - 1],
            (i, _) => mean(secants[(i + n - 1) % n], secants[i % n]),
        })
        .collect();
    for (i, d) in secants.iter().enumerate() {
        // in a periodic table the last point is the first
        let next = if periodic { (i + 1) % n } else { i + 1 };
        if *d == 0.0 {
            slopes[i] = 0.0;
            slopes[next] = 0.0;
            continue;
        }
        let (alpha, beta) = (slopes[i] / d, slopes[next] / d);
        let square = alpha * alpha + beta * beta;
        if square > 9.0 {
            let factor = 3.0 / square.sqrt();
            slopes[i] *= factor;
            if next != i {
                slopes[next] *= factor;
            }
        }
    }
    if periodic {
        slopes[n] = slopes[0];
    }
    slopes
}
