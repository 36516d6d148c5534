//! The change of sign of a function within a step: Hermite's cubic through its values and rates at both ends.

use super::Crossing;

/// Share of a step within which a kink counts as being at its beginning. Otherwise a function that is zero
/// there except for rounding would shorten the step to nothing. A choice above the rounding of a function
/// over its change in a step; a kink missed by it lies a millionth of a step before its end.
pub(super) const BEGIN: f64 = 1e-6;

/// Whether the cubic through values and rates at both ends of a step h keeps one sign, because its four control
/// points (Bézier) have it.
pub fn same_side([a, da]: [f64; 2], [b, db]: [f64; 2], h: f64) -> bool {
    let points = [a, a + h * da / 3.0, b - h * db / 3.0, b];
    points.iter().all(|x| *x > 0.0) || points.iter().all(|x| *x < 0.0)
}

/// The time at which the cubic through values and rates at both ends of a step h (s) is nearer to zero than `aim`
/// for the last time before it leaves its first side, if it is deeper on this side than the first limit and on the other
/// side than the second.
pub fn crossing(
    [a, da]: [f64; 2],
    [b, db]: [f64; 2],
    h: f64,
    [limit, on_other]: [f64; 2],
    aim: f64,
) -> Option<Crossing> {
    let (c1, rise) = (h * da, b - a);
    let (c2, c3) = (3.0 * rise - h * (2.0 * da + db), h * (da + db) - 2.0 * rise);
    let at = |s: f64| a + s * (c1 + s * (c2 + s * c3));
    if !(c2.is_finite() && c3.is_finite()) {
        return None;
    }
    // ends and extremes, in their order
    let mut places = vec![0.0];
    let mut extremes = roots(3.0 * c3, 2.0 * c2, c1);
    extremes.sort_by(f64::total_cmp);
    places.extend(extremes.into_iter().filter(|s| *s > 0.0 && *s < 1.0));
    places.push(1.0);
    let values: Vec<f64> = places
        .iter()
        .map(|s| if *s == 1.0 { b } else { at(*s) })
        .collect();
    let mut first = values.iter().position(|value| value.abs() > limit)?;
    let (high, other) = loop {
        let side = values[first].signum();
        let other = (first..values.len()).find(|k| -side * values[*k] > on_other)?;
        let last = (first..other).rev().find(|k| side * values[*k] > aim)?;
        let high = change(|s| at(s) - side * aim, side, places[last], places[last + 1]);
        if high > BEGIN {
            break (high, other);
        }
        first = other;
    };
    let side = -values[other].signum();
    let depth = values[other..].iter().map(|value| -side * value);
    Some(Crossing {
        time: high * h,
        item: 0,
        depth: depth.fold(0.0, f64::max),
        limit,
        inside: -side * b <= limit,
    })
}

/// The time (s) at which the tangents at both ends of a step h (s) meet beyond zero, deeper than a limit, if both ends are on
/// one side of zero.
///
/// A function that bends away from zero on this side, such as a distance, is nowhere deeper than its tangents. The cubic may stay
/// clear of zero, because it lies above the tip of a distance that falls and rises again within the step:
/// `sqrt(t² + d²)` is a hyperbola.
pub fn tip(
    [a, da]: [f64; 2],
    [b, db]: [f64; 2],
    h: f64,
    limit: impl FnOnce() -> f64,
) -> Option<f64> {
    let side = a.signum();
    if !(a * b > 0.0 && side * da < 0.0 && side * db > 0.0) {
        return None;
    }
    let time = (b - a - h * db) / (da - db);
    let deep = -side * (a + time * da);
    let within = time > BEGIN * h && time < (1.0 - BEGIN) * h;
    if !within || deep <= 0.0 {
        return None;
    }
    let limit = limit();
    // an end at the kink itself shows it
    let clear = a.abs().min(b.abs());
    (deep > limit && clear > limit).then_some(time)
}

/// The place at which a function leaves a side, between two places between which it is monotone: bisection
/// until the bracket is rounding. In the unit of the places.
fn change(at: impl Fn(f64) -> f64, side: f64, mut low: f64, mut high: f64) -> f64 {
    // some units of the last place: nearer ends have no middle between them
    while high - low > 1e-15 * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if side * at(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Real roots of `a s² + b s + c`. They come in no order; a root at infinity is left out.
pub(super) fn roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return Vec::new();
    }
    // without cancellation: the larger root first, the other by their product
    let q = -0.5 * (b + b.signum() * libm::sqrt(discriminant));
    [q / a, c / q]
        .into_iter()
        .filter(|s| s.is_finite())
        .collect()
}
