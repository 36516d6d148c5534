//! Surfaces of rigid bodies.

use eng_report::animation::{Part, Surface};
use eng_report::internals::quaternion::{cross, dot};
use eng_report::internals::solid::{SIDES, Solid};

/// Volume by the divergence theorem: right only for closed surfaces that face outwards.
fn volume(surface: &Surface) -> f64 {
    surface
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|n| surface.nodes[n as usize]);
            dot(a, cross(b, c)) / 6.0
        })
        .sum()
}

#[test]
fn boxes_and_cylinders_are_closed_and_face_outwards() {
    let cuboid = Solid::of(&[Part::Box {
        center: [5.0, -1.0, 2.0],
        size: [1.0, 2.0, 3.0],
    }]);
    assert!((volume(&cuboid.surface) - 6.0).abs() < 1e-12);
    for to in [[0.0, 0.0, 2.0], [2.0, 0.0, 0.0], [0.0, -2.0, 0.0]] {
        let bar = Solid::of(&[Part::Cylinder {
            from: [0.0; 3],
            to,
            radius: 1.0,
        }]);
        let sides = f64::from(SIDES);
        let expected = sides * libm::sin(std::f64::consts::TAU / sides);
        assert!((volume(&bar.surface) - expected).abs() < 1e-12, "{to:?}");
    }
}

#[test]
fn lines_are_pieces() {
    let line = Solid::of(&[Part::Line {
        points: vec![[0.0; 3], [1.0; 3], [2.0; 3]],
    }]);
    assert_eq!(line.segments.len(), 4);
}
