//! Points that are left out of long curves.

use eng_report::internals::{curve_runs, thinned};

#[test]
fn keeps_every_peak() {
    let n = 100_000;
    let x: Vec<f64> = (0..n).map(f64::from).collect();
    let mut y: Vec<f64> = x.iter().map(|x| libm::sin(x * 1e-4)).collect();
    y[31_234] = 5.0;
    y[77_777] = -7.0;
    let runs = curve_runs(&x, &y, (0.0, f64::from(n)), 1000);
    assert_eq!(runs.len(), 1);
    assert!(runs[0].len() <= 4000, "{}", runs[0].len());
    assert!(runs[0].contains(&(31_234.0, 5.0)) && runs[0].contains(&(77_777.0, -7.0)));
    assert!(runs[0].windows(2).all(|w| w[0].0 < w[1].0));
    assert_eq!(
        (runs[0][0].0, runs[0][runs[0].len() - 1].0),
        (0.0, 99_999.0)
    );
}

#[test]
fn gaps_stay_gaps() {
    let x = [0.0, 1.0, 2.0, 3.0, 4.0];
    let y = [0.0, 1.0, f64::NAN, 3.0, 4.0];
    assert_eq!(
        curve_runs(&x, &y, (0.0, 4.0), 10),
        vec![vec![(0.0, 0.0), (1.0, 1.0)], vec![(3.0, 3.0), (4.0, 4.0)]]
    );
}

#[test]
fn thinning_keeps_the_ends() {
    let points: Vec<(f64, f64)> = (0..=100).map(|i| (f64::from(i) * 0.1, 0.0)).collect();
    let kept = thinned(&points, 1.0);
    assert!(kept.len() <= 12 && kept[0] == 0 && kept.last() == Some(&100));
}
