//! Rotations of pictures.

use eng_report::internals::quaternion::{nearer, normalised, rotated};

#[test]
fn a_quarter_turn_about_z() {
    let half = std::f64::consts::FRAC_PI_8 * 2.0;
    let q = [libm::cos(half), 0.0, 0.0, libm::sin(half)];
    let turned = rotated(q, [1.0, 2.0, 3.0]);
    for (found, expected) in turned.iter().zip([-2.0, 1.0, 3.0]) {
        assert!((found - expected).abs() < 1e-15);
    }
    assert_eq!(normalised([0.0; 4]), [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(nearer(q, q.map(|c| -c)), q);
}
