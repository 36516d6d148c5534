//! Corners of a table along an argument.

use eng_system::table::Corners;

const POINTS: [f64; 5] = [0.0, 1.0, 3.0, 4.0, 6.0];

#[test]
fn points_beside_an_argument() {
    let inner = Corners::new(&POINTS, None, 2, 1, [0, 2]);
    assert_eq!(inner.ends, [Some(0.0), None]);
    assert_eq!(inner.beside(2.1), [Some(4.0), Some(1.0), Some(3.0)]);
    assert_eq!(inner.beside(1.9), [None, Some(1.0), Some(3.0)]);
    assert_eq!(inner.beside(-7.0), [None, Some(1.0), Some(3.0)]);
    assert_eq!(inner.beside(f64::NAN), [None; 3]);
    assert_eq!(
        Corners::new(&POINTS, None, 1, 1, [1; 2]).beside(2.1),
        [None; 3]
    );
    assert_eq!(
        Corners::new(&[0.0, 1.0], None, 2, 1, [0; 2]).beside(0.3),
        [None; 3]
    );
}

/// With a period a point keeps its place over any number of periods, and none is left out.
#[test]
fn points_repeat_with_a_period() {
    let inner = Corners::new(&POINTS, Some(6.0), 2, 1, [2; 2]);
    assert_eq!(inner.ends, [None; 2]);
    let mut before = inner.beside(-20.0);
    let mut x = -20.0;
    let mut seen = Vec::new();
    while x < 20.0 {
        x += 0.1;
        let now = inner.beside(x);
        let moved = (0..3).filter(|k| now[*k] != before[*k]).count();
        assert!(moved <= 1, "{x}: {before:?} {now:?}");
        let within = |p: &f64| (p - x).abs() <= 1.0 + 1e-9;
        assert!(now.iter().flatten().any(within), "{x}: {now:?}");
        seen.extend(now.into_iter().flatten());
        before = now;
    }
    seen.sort_by(f64::total_cmp);
    seen.dedup();
    let due = (-4..4).flat_map(|turn| POINTS[..4].iter().map(move |p| p + 6.0 * f64::from(turn)));
    for point in due.filter(|p| p.abs() < 19.0) {
        assert!(seen.contains(&point), "{point}");
    }
}
