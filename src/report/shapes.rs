//! Simple parts that represent rigid bodies.

use super::describe::Spot;
use eng_report::animation::Part;

/// Bars from the first marker to the others. If all markers are in one place, a cylinder or box with the
/// body's mass and moments of inertia: `J_axis = m r²/2`, `J_across = m (3r² + h²)/12`, and for a box
/// `a² = 6 (J_b + J_c − J_a)/m`.
pub(super) fn solid(mass: f64, center: [f64; 3], inertia: [f64; 3], markers: &[Spot]) -> Vec<Part> {
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
pub(super) fn outlined(part: Part, larger: f64) -> Vec<Part> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solid_has_the_bodys_mass_and_inertia() {
        // a disc of 11 kg: radius 0.15, height 0.02
        let (mass, radius, height) = (11.0, 0.15, 0.02);
        let across = mass * (3.0 * radius * radius + height * height) / 12.0;
        let inertia = [across, across, 0.5 * mass * radius * radius];
        match solid(mass, [0.0, 0.0, 0.01], inertia, &[]).as_slice() {
            [
                Part::Cylinder {
                    from,
                    to,
                    radius: r,
                },
            ] => {
                assert!((r - radius).abs() < 1e-12);
                assert!((from[2]).abs() < 1e-12 && (to[2] - 0.02).abs() < 1e-12);
            }
            other => panic!("{other:?}"),
        }
        let [a, b, c] = [0.1, 0.2, 0.3];
        let box_inertia = [b * b + c * c, a * a + c * c, a * a + b * b].map(|s| s / 12.0);
        match solid(1.0, [0.0; 3], box_inertia, &[]).as_slice() {
            [Part::Box { size, .. }] => {
                assert!(
                    size.iter()
                        .zip([a, b, c])
                        .all(|(x, y)| (x - y).abs() < 1e-12)
                );
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn large_discs_are_outlines_of_their_size() {
        let disc = |radius| Part::Cylinder {
            from: [0.0, 0.0, -0.01],
            to: [0.0, 0.0, 0.01],
            radius,
        };
        assert_eq!(outlined(disc(0.05), 0.1), [disc(0.05)]);
        let lines = outlined(disc(0.15), 0.1);
        assert_eq!(lines.len(), 6);
        for line in lines {
            let Part::Line { points } = line else {
                panic!("{line:?}");
            };
            for [x, y, z] in points {
                assert!((libm::hypot(x, y) - 0.15).abs() < 1e-12 && z.abs() == 0.01);
            }
        }
        // a bar that lies askew stays a bar
        let askew = Part::Cylinder {
            from: [0.0; 3],
            to: [1.0, 1.0, 0.0],
            radius: 0.2,
        };
        assert_eq!(outlined(askew.clone(), 0.1), [askew]);
    }
}
