//! Paths of pins.

use eng_report::figure::{Orbit, Orbits, Upright};
use eng_report::internals::orbit_marks;

fn small(samples: u32, upright: Upright) -> Orbits {
    let angle: Vec<f64> = (0..=samples)
        .map(|i| f64::from(i) * 720.0 / f64::from(samples))
        .collect();
    let at = |a: &f64| a.to_radians();
    Orbits {
        title: "Orbits".to_owned(),
        subtitle: "Test".to_owned(),
        period: 360.0,
        upright,
        orbits: vec![Orbit {
            name: "main[1]".to_owned(),
            frame: "block.main[1]".to_owned(),
            clearance: 27e-6,
            x: angle.iter().map(|a| 20e-6 * libm::cos(at(a))).collect(),
            y: angle.iter().map(|a| 10e-6 * libm::sin(at(a))).collect(),
            // the samples are evenly spaced over two cycles
            last_cycle: (samples as usize).div_ceil(2),
            angle,
        }],
    }
}

#[test]
fn small_figure() {
    insta::assert_snapshot!(small(8, Upright::X).to_svg());
}

#[test]
fn marks_lie_between_samples_and_stay_in_the_cycle() {
    let figure = small(7, Upright::Y);
    let orbit = &figure.orbits[0];
    assert_eq!(orbit.last_cycle, 4, "720·4/7 is the first angle after 360");
    let found = orbit_marks(orbit, 360.0);
    let angles: Vec<i64> = found.iter().map(|m| m.0).collect();
    assert_eq!(angles, [90, 180, 270, 0]);
    let [x, y] = [orbit.x[7] * 1e6, orbit.y[7] * 1e6];
    assert!((found[3].1 - x).abs() < 1e-9 && (found[3].2 - y).abs() < 1e-9);
}

#[test]
fn a_whole_cycle_has_each_mark_once() {
    let figure = small(72, Upright::Y);
    let found = orbit_marks(&figure.orbits[0], 360.0);
    let angles: Vec<i64> = found.iter().map(|m| m.0).collect();
    assert_eq!(angles, [0, 90, 180, 270]);
}

#[test]
fn marks_of_a_shaft_that_turns_backwards_have_the_same_places() {
    let forwards = small(72, Upright::Y);
    let mut backwards = forwards.clone();
    let orbit = &mut backwards.orbits[0];
    for angle in &mut orbit.angle {
        *angle = -*angle;
    }
    let of = |figure: &Orbits| orbit_marks(&figure.orbits[0], 360.0);
    let (due, found) = (of(&forwards), of(&backwards));
    let angles: Vec<i64> = found.iter().map(|m| m.0).collect();
    assert_eq!(angles, [0, 270, 180, 90]);
    for (a, b) in due.iter().zip(&found) {
        assert!((a.1 - b.1).abs() < 1e-9 && (a.2 - b.2).abs() < 1e-9);
    }
    // both pictures show the part before the last cycle
    assert!(backwards.to_svg().contains(">earlier<"));
}

#[test]
fn gaps_and_missing_angles_are_drawn() {
    let mut figure = small(72, Upright::Y);
    figure.orbits[0].angle.clear();
    figure.orbits[0].x[3] = f64::NAN;
    let svg = figure.to_svg();
    assert!(!svg.contains("NaN"));
    assert!(svg.matches("<polyline").count() >= 2);
}
