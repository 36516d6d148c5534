//! Differences of two runs.

use eng_report::signal::{Interpolation, SignalError, difference};

#[test]
fn runs_on_different_grids() {
    let first: Vec<f64> = (0..=720).map(f64::from).collect();
    let second: Vec<f64> = (0..=1000).map(|i| f64::from(i) * 0.5 + 100.25).collect();
    let wave = |a: &f64| libm::sin(a.to_radians());
    let shifted: Vec<f64> = second.iter().map(|a| wave(a) + 0.25).collect();
    let plain: Vec<f64> = first.iter().map(wave).collect();
    let found = difference((&first, &plain), (&second, &shifted), Interpolation::Cubic).unwrap();
    assert_eq!(found.angle.first(), Some(&101.0));
    assert_eq!(found.angle.last(), Some(&600.0));
    assert!((found.peak - 0.25).abs() < 1e-7 && (found.rms - 0.25).abs() < 1e-7);
    assert!(found.relative_rms.is_some_and(|r| (0.3..0.4).contains(&r)));
}

#[test]
fn runs_without_common_angles_are_refused() {
    let a = [0.0, 1.0];
    let b = [5.0, 6.0];
    assert!(matches!(
        difference((&a, &a), (&b, &b), Interpolation::Linear),
        Err(SignalError::TooShort { .. })
    ));
}
