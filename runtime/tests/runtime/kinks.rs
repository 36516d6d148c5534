//! Kinks within a step and beside each other.

use eng_runtime::internals::kinks::{Neighbours, crossing, same_side, tip};

/// Both faces of a sheet of 1 µm, a function at another rate, and one of another element.
#[test]
fn faces_of_a_sheet_are_beside_each_other() {
    let mut neighbours = Neighbours::new(&[Some(1), Some(1), Some(1), Some(2), None]);
    let now = [
        [1.0, -2.0],
        [-1.000001, 2.0],
        [1.5, 3.0],
        [1.1, -2.0],
        [1.2, -2.0],
    ];
    neighbours.measure(&now, |_| 1e-6);
    assert!((neighbours.apart(0) - 1e-6).abs() < 1e-12);
    assert_eq!(neighbours.apart(0), neighbours.apart(1));
    for alone in 2..5 {
        assert_eq!(neighbours.apart(alone), f64::INFINITY);
    }
    // nearer than a ten-thousandth of the tolerance both are one
    neighbours.measure(&now, |_| 0.1);
    assert_eq!(neighbours.apart(0), f64::INFINITY);
}

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
