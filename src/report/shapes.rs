//! Simple parts that represent rigid bodies.

use super::describe::Spot;
use eng_report::animation::Part;

/// Bars from the first marker to the others. If all markers are in one place, a cylinder or box with the
/// body's mass and moments of inertia: `J_axis = m r²/2`, `J_across = m (3r² + h²)/12`, and for a box
/// `a² = 6 (J_b + J_c − J_a)/m`.
pub fn solid(mass: f64, center: [f64; 3], inertia: [f64; 3], markers: &[Spot]) -> Vec<Part> {
    let between =
        |a: [f64; 3], b: [f64; 3]| libm::sqrt((0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum());
    let mut places: Vec<[f64; 3]> = Vec::new();
    for marker in markers {
        // markers nearer than a micrometre are at one place
        if places.iter().all(|p| between(*p, marker.place) > 1e-6) {
            places.push(marker.place);
        }
    }
    if let Some((first, others)) = places.split_first()
        && !others.is_empty()
    {
        return others
            .iter()
            .map(|to| Part::Cylinder {
                from: *first,
                to: *to,
                // a choice for the eye: a rod with the thickness of an eighth of its length
                radius: 0.06 * between(*first, *to),
            })
            .collect();
    }
    let side = |i: usize| {
        let [own, one, other] = [inertia[i], inertia[(i + 1) % 3], inertia[(i + 2) % 3]];
        libm::sqrt((6.0 * (one + other - own) / mass).max(0.0))
    };
    let round = (0..3).find(|axis| {
        let (a, b) = (inertia[(axis + 1) % 3], inertia[(axis + 2) % 3]);
        // a choice: moments of a round body in a text are equal to one or two per cent
        (a - b).abs() <= 0.02 * a.max(b)
    });
    let part = match round {
        Some(axis) => {
            let across = inertia[(axis + 1) % 3];
            let square = 2.0 * inertia[axis] / mass;
            let radius = libm::sqrt(square.max(0.0));
            let height = libm::sqrt((12.0 * across / mass - 3.0 * square).max(0.0));
            // a disc without thickness would be invisible from its side
            let half = 0.5 * height.max(0.04 * radius);
            let (mut from, mut to) = (center, center);
            from[axis] -= half;
            to[axis] += half;
            Part::Cylinder { from, to, radius }
        }
        None => Part::Box {
            center,
            size: [side(0), side(1), side(2)],
        },
    };
    let finite = match &part {
        Part::Cylinder { radius, .. } => radius.is_finite() && *radius > 0.0,
        Part::Box { size, .. } => size.iter().all(|s| s.is_finite()),
        _ => true,
    };
    if finite { vec![part] } else { Vec::new() }
}

/// A cylinder whose radius is above `larger` (m) as its two rims and four lines along it, so that it hides nothing.
pub fn outlined(part: Part, larger: f64) -> Vec<Part> {
    let Part::Cylinder { from, to, radius } = part else {
        return vec![part];
    };
    let axis = (0..3).find(|i| from[*i] != to[*i]);
    let along = (0..3).filter(|i| from[*i] != to[*i]).count() == 1;
    let Some(axis) = axis.filter(|_| along && larger > 0.0 && radius > larger) else {
        return vec![Part::Cylinder { from, to, radius }];
    };
    let at = |center: [f64; 3], side: u32| {
        // 48 sides look round; a choice
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * f64::from(side) / 48.0);
        let mut point = center;
        point[(axis + 1) % 3] += radius * cosine;
        point[(axis + 2) % 3] += radius * sine;
        point
    };
    let rim = |center| Part::Line {
        points: (0..=48).map(|side| at(center, side)).collect(),
    };
    let mut lines = vec![rim(from), rim(to)];
    lines.extend([0, 12, 24, 36].map(|side| Part::Line {
        points: vec![at(from, side), at(to, side)],
    }));
    lines
}
