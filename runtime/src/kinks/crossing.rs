//! The change of sign of a function within a step: Hermite's cubic through its values and rates at both ends.

use super::Crossing;

/// Share of a step within which a kink counts as being at its beginning. Otherwise a function that is zero
/// there except for rounding would shorten the step to nothing. A choice above the rounding of a function
/// over its change in a step; a kink missed by it lies a millionth of a step before its end.
pub(super) const BEGIN: f64 = 1e-6;

/// Whether the cubic through values and rates at both ends of a step h keeps one sign, because its four control
/// points (Bézier) have it.
pub(super) fn same_side([a, da]: [f64; 2], [b, db]: [f64; 2], h: f64) -> bool {
    let points = [a, a + h * da / 3.0, b - h * db / 3.0, b];
    points.iter().all(|x| *x > 0.0) || points.iter().all(|x| *x < 0.0)
}

/// The time at which the cubic through values and rates at both ends of a step h (s) is nearer to zero than `aim`
/// for the last time before it leaves its first side, if it is deeper on this side than the first limit and on the other
/// side than the second.
pub(super) fn crossing(
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
pub(super) fn tip(
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

#[cfg(test)]
mod tests {
    use super::{crossing, same_side, tip};

    /// g = (t − 1)(t − 3) over 0…4 s: below zero between 1 and 3 s, though both ends are above.
    #[test]
    fn an_excursion_within_a_step() {
        let g = |t: f64| [(t - 1.0) * (t - 3.0), 2.0 * t - 4.0];
        assert!(!same_side(g(0.0), g(4.0), 4.0));
        let found = crossing(g(0.0), g(4.0), 4.0, [0.5; 2], 0.0).unwrap();
        assert!((found.time - 1.0).abs() < 1e-12, "{}", found.time);
        assert!((found.depth - 1.0).abs() < 1e-12 && found.inside);
        // shallower than the limit
        assert_eq!(crossing(g(0.0), g(4.0), 4.0, [1.5; 2], 0.0), None);
        // begins at the kink, within the limit: the first side is the lower one, left at 3 s
        let late = crossing(g(1.0), g(4.0), 3.0, [0.5; 2], 0.0).unwrap();
        assert!((late.time - 2.0).abs() < 1e-12 && !late.inside);
        // begins at the kink and stays on one side
        assert_eq!(crossing(g(1.0), g(2.5), 1.5, [1e-9; 2], 0.0), None);
    }

    /// A step that ends a little behind the kink ends before it instead, on the first side.
    #[test]
    fn a_step_ends_before_the_kink() {
        let g = |t: f64| [2.0 - t, -1.0];
        let found = crossing(g(0.0), g(2.001), 2.001, [0.1, 0.0], 0.025).unwrap();
        assert!((found.time - 1.975).abs() < 1e-12 && found.inside);
        assert_eq!(crossing(g(0.0), g(1.99), 1.99, [0.1, 0.0], 0.025), None);
        // as shallow behind the kink, it is no crossing for a fixed step
        assert_eq!(crossing(g(0.0), g(2.001), 2.001, [0.1, 0.1], 0.0), None);
    }

    /// g = 1 − t³ over 0…2 s changes at 1 s, whatever its size.
    #[test]
    fn a_change_between_the_ends() {
        let g = |t: f64| [1e-20 * (1.0 - t * t * t), -3e-20 * t * t];
        let found = crossing(g(0.0), g(2.0), 2.0, [1e-25; 2], 0.0).unwrap();
        assert!((found.time - 1.0).abs() < 1e-12);
        assert!((found.depth - 7e-20).abs() < 1e-32 && !found.inside);
        assert!(same_side([1.0, 0.1], [1.0, -0.1], 1.0));
        assert!(!same_side([f64::NAN, 0.0], [1.0, 0.0], 1.0));
        assert_eq!(
            crossing([f64::NAN, 0.0], [1.0, 0.0], 1.0, [0.1; 2], 0.0),
            None
        );
    }

    /// A point that moves at 1 m/s passes another one at 9.95 mm; their distance less 10 mm, from 100 mm before to 80 mm behind.
    #[test]
    fn a_tip_between_the_ends() {
        let g = |x: f64| {
            let distance = x.hypot(9.95e-3);
            [distance - 10e-3, x / distance]
        };
        let (from, to) = (g(-0.1), g(0.08));
        assert!(same_side(from, to, 0.18));
        // the tangents meet beside the tip by the difference of both slopes from 1
        let at = tip(from, to, 0.18, || 1e-6).unwrap();
        assert!((at - 0.1).abs() < 2e-4, "{at}");
        assert_eq!(tip(from, to, 0.18, || 0.011), None);
        // mirrored, and short steps on one side of the tip
        let [from, to] = [from, to].map(|end| end.map(|x| -x));
        assert_eq!(tip(from, to, 0.18, || 1e-6), Some(at));
        assert_eq!(tip(g(-0.1), g(-0.08), 0.02, || 1e-6), None);
    }
}
