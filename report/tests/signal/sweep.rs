//! Maps of spectra over speed.

use eng_report::signal::{
    Axis, Sampling, Signal, SignalError, Spectrum, SpectrumOptions, SweepMap, spectrum, sweep_map,
};

fn of(samples: usize, cycles: f64) -> Spectrum {
    let values: Vec<f64> = (0..samples)
        .map(|n| libm::cos(std::f64::consts::TAU * cycles * n as f64 / samples as f64))
        .collect();
    let signal = Signal {
        values: &values,
        sampling: Sampling::Time { step: 1e-3 },
    };
    spectrum(signal, SpectrumOptions::default()).unwrap()
}

#[test]
fn rows_share_the_coarsest_axis_and_keep_peaks() {
    let map = sweep_map(&[(3000.0, of(1000, 101.0)), (2000.0, of(500, 25.0))]).unwrap();
    assert_eq!(map.speeds(), [2000.0, 3000.0]);
    assert_eq!(map.positions()[1], 2.0);
    assert_eq!(map.positions().len(), 251);
    assert!((map.amplitudes()[0][25] - 1.0).abs() < 1e-10);
    // 101 Hz lies between the columns of 100 and 102 Hz
    assert!((map.amplitudes()[1][51] - 1.0).abs() < 1e-10);
}

#[test]
fn maps_of_mixed_axes_are_refused() {
    let orders = of(500, 25.0).in_orders(3000.0).unwrap();
    assert!(matches!(
        sweep_map(&[(1.0, of(500, 25.0)), (2.0, orders)]),
        Err(SignalError::Axes { index: 1, .. })
    ));
    assert!(sweep_map(&[]).is_err());
}

#[test]
fn rows_that_fit_no_map_are_refused() {
    let map = |speeds: &[f64], step, rows: &[&[f64]]| {
        let rows = rows.iter().map(|row| row.to_vec()).collect();
        SweepMap::new(Axis::Order, speeds.to_vec(), step, rows)
    };
    assert!(map(&[1.0, 2.0], 0.5, &[&[1.0, 2.0], &[3.0, f64::NAN]]).is_ok());
    assert!(map(&[2.0, 1.0], 0.5, &[&[1.0], &[3.0]]).is_err());
    assert!(map(&[1.0, 2.0], 0.0, &[&[1.0], &[3.0]]).is_err());
    assert!(map(&[1.0, 2.0], 0.5, &[&[1.0]]).is_err());
    assert!(map(&[1.0, 2.0], 0.5, &[&[1.0], &[3.0, 4.0]]).is_err());
}
