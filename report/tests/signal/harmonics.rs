//! Harmonics of a torque.

use eng_report::signal::harmonics;

#[test]
fn coefficients_of_a_known_torque() {
    let values: Vec<f64> = (0..144)
        .map(|i| {
            let angle = (f64::from(i) * 5.0).to_radians();
            7.0 + 3.0 * libm::cos(2.0 * angle) - 4.0 * libm::sin(2.0 * angle)
                + 0.5 * libm::sin(0.5 * angle)
        })
        .collect();
    let found = harmonics(&values, 720.0, 10).unwrap();
    assert!((found[0].cosine - 7.0).abs() < 1e-12);
    assert_eq!(found[1].order, 0.5);
    assert!((found[1].sine - 0.5).abs() < 1e-12);
    assert_eq!(found[4].order, 2.0);
    assert!((found[4].amplitude - 5.0).abs() < 1e-12);
    let expected = libm::atan2(-4.0, 3.0).to_degrees();
    assert!((found[4].phase - expected).abs() < 1e-10);
    assert!(found[6].amplitude < 1e-12);
    assert!(harmonics(&values, 720.0, 72).is_err());
}
