//! Extremes between samples.

use eng_report::signal::{SignalError, maximum_at, minimum, rms};

#[test]
fn a_parabola_is_found_exactly_on_any_grid() {
    let x = [0.0, 0.4, 1.5, 1.9, 4.0];
    let y: Vec<f64> = x
        .iter()
        .map(|x| 3.0 - 2.0 * (x - 1.3) * (x - 1.3))
        .collect();
    let top = maximum_at(&x, &y).unwrap();
    assert!((top.position - 1.3).abs() < 1e-14 && (top.value - 3.0).abs() < 1e-14);
    assert!(top.refined && top.sample == 2);
    let low = minimum(&x, &y).unwrap();
    assert_eq!((low.position, low.sample, low.refined), (4.0, 4, false));
}

#[test]
fn a_cosine_peak_is_true_to_the_fourth_power_of_the_step() {
    let error = |step: f64| {
        let x: Vec<f64> = (0..400).map(|i| f64::from(i) * step).collect();
        let y: Vec<f64> = x.iter().map(|x| libm::cos(x - 0.3 * step - 1.0)).collect();
        (maximum_at(&x, &y).unwrap().value - 1.0).abs()
    };
    let ratio = error(0.02) / error(0.01);
    assert!((8.0..32.0).contains(&ratio), "{ratio}");
}

#[test]
fn root_mean_squares() {
    assert_eq!(rms(&[3.0, -4.0]).unwrap(), 12.5f64.sqrt());
}

#[test]
fn faults_are_named() {
    assert_eq!(
        rms(&[1.0, f64::NAN]),
        Err(SignalError::NotFinite {
            what: "the signal",
            index: 1
        })
    );
    assert_eq!(
        maximum_at(&[0.0, 0.0], &[1.0, 2.0]),
        Err(SignalError::NotIncreasing {
            what: "the abscissa",
            index: 1
        })
    );
    assert!(maximum_at(&[], &[]).is_err() && rms(&[]).is_err());
}
