//! Values between samples.

use eng_report::signal::{Interpolation, SignalError, resample};

#[test]
fn lines_and_parabolas_are_exact() {
    let x = [0.0, 0.3, 1.0, 1.2, 2.0];
    let grid: Vec<f64> = (0..=40).map(|i| f64::from(i) * 0.05).collect();
    let line = |x: f64| 2.0 - 3.0 * x;
    let parabola = |x: f64| 1.0 - 2.0 * x + 0.7 * x * x;
    let y: Vec<f64> = x.iter().map(|x| line(*x)).collect();
    for (g, v) in grid
        .iter()
        .zip(resample(&x, &y, &grid, Interpolation::Linear).unwrap())
    {
        assert!((v - line(*g)).abs() < 1e-14);
    }
    let y: Vec<f64> = x.iter().map(|x| parabola(*x)).collect();
    for (g, v) in grid
        .iter()
        .zip(resample(&x, &y, &grid, Interpolation::Cubic).unwrap())
    {
        assert!((v - parabola(*g)).abs() < 1e-14, "{g}");
    }
}

#[test]
fn places_outside_are_refused() {
    let x = [0.0, 1.0];
    assert!(matches!(
        resample(&x, &x, &[1.1], Interpolation::Cubic),
        Err(SignalError::Outside { .. })
    ));
}
