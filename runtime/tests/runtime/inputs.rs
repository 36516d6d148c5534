//! Inputs between their points.

use eng_runtime::inputs::Point;
use eng_runtime::internals::input_between;
use eng_system::input::Interpolation;

/// t³ − 2t over 1…3 s is its own Hermite cubic.
#[test]
fn a_cubic_follows_a_cubic() {
    let cubic = |t: f64| Point {
        value: t * t * t - 2.0 * t,
        rate: 3.0 * t * t - 2.0,
    };
    let ends = [(1.0, cubic(1.0)), (3.0, cubic(3.0))];
    for t in [1.0, 1.25, 2.0, 2.9, 3.0] {
        let found = input_between(ends, Interpolation::Cubic, t);
        assert!((found.value - cubic(t).value).abs() < 1e-13, "{t}");
        assert!((found.rate - cubic(t).rate).abs() < 1e-13, "{t}");
    }
    let line = input_between(ends, Interpolation::Linear, 2.0);
    assert_eq!(line.value, 0.5 * (cubic(1.0).value + cubic(3.0).value));
    assert_eq!(input_between(ends, Interpolation::Hold, 2.0), cubic(1.0));
}
