//! Tables of one argument: splines, ends, periods, bad points.

use eng_system::table::{Curve, Extrapolation, Interpolation, TableError};

fn table(x: &[f64], y: &[f64], interpolation: Interpolation, period: Option<f64>) -> Curve {
    Curve::new("t", x.to_vec(), y.to_vec(), interpolation, None, period).expect("valid points")
}

#[test]
fn natural_spline_of_four_points_has_the_hand_computed_moments() {
    // h = 1, y = 0 1 0 1: 4 M1 + M2 = -12, M1 + 4 M2 = 12, so M1 = -4, M2 = 4
    let t = table(
        &[0.0, 1.0, 2.0, 3.0],
        &[0.0, 1.0, 0.0, 1.0],
        Interpolation::Cubic,
        None,
    );
    for (x, m) in [(0.0, 0.0), (1.0, -4.0), (2.0, 4.0), (3.0, 0.0)] {
        assert!((t.evaluate(x, 2) - m).abs() < 1e-14, "{x}");
    }
    // on the first interval M = -4x, y = x + (4/6) (x - x³)
    assert!((t.evaluate(0.5, 0) - (0.5 + 4.0 / 6.0 * (0.5 - 0.125))).abs() < 1e-14);
    assert!((t.evaluate(1.0, 0) - 1.0).abs() < 1e-15);
}

#[test]
fn a_straight_line_is_kept_and_two_points_are_a_line() {
    let x = [0.0, 0.3, 1.0, 4.0];
    let y = x.map(|x| 2.0 - 3.0 * x);
    for interpolation in [Interpolation::Cubic, Interpolation::Monotone] {
        let t = table(&x, &y, interpolation, None);
        for p in [0.0, 0.1, 0.9, 2.0, 4.0] {
            assert!((t.evaluate(p, 0) - (2.0 - 3.0 * p)).abs() < 1e-13);
            assert!((t.evaluate(p, 1) + 3.0).abs() < 1e-13);
        }
        let two = table(&[1.0, 3.0], &[5.0, 9.0], interpolation, None);
        assert_eq!(two.evaluate(2.0, 0), 7.0);
    }
}

#[test]
fn periodic_spline_of_a_sine_converges_and_is_c2_over_the_closure() {
    let error = |n: usize, closed: bool| {
        let count = if closed { n + 1 } else { n };
        let x: Vec<f64> = (0..count)
            .map(|i| 0.4 + 6.0 * i as f64 / n as f64)
            .collect();
        let y: Vec<f64> = x
            .iter()
            .map(|x| libm::sin(core::f64::consts::TAU * (x - 0.4) / 6.0))
            .collect();
        let t = table(&x, &y, Interpolation::Cubic, Some(6.0));
        for order in 0..=2 {
            let left = t.evaluate(6.4 - 1e-9, order);
            let right = t.evaluate(0.4 + 1e-9, order);
            assert!((left - right).abs() < 1e-7, "order {order}: {left} {right}");
            assert!((t.evaluate(1.1, order) - t.evaluate(1.1 - 18.0, order)).abs() < 1e-12);
            assert!((t.evaluate(1.1, order) - t.evaluate(1.1 + 600.0, order)).abs() < 1e-10);
        }
        (0..1000)
            .map(|i| 0.4 + 6.0 * f64::from(i) / 1000.0)
            .map(|x| (t.evaluate(x, 0) - libm::sin(core::f64::consts::TAU * (x - 0.4) / 6.0)).abs())
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(12, true), error(24, true));
    assert!(
        coarse < 2e-3 && fine < coarse / 12.0,
        "fourth order: {coarse} {fine}"
    );
    // the end point changes nothing
    assert!((error(24, false) - fine).abs() < 1e-12);
}

#[test]
fn few_periodic_points_satisfy_the_cyclic_system() {
    for n in 1..6 {
        let x: Vec<f64> = (0..n)
            .map(|i| f64::from(i * i) * 0.2 + f64::from(i))
            .collect();
        let y: Vec<f64> = (0..n).map(|i| f64::from((i * 7) % 5)).collect();
        let period = 12.0;
        let mut x = x;
        let mut y = y;
        if n == 1 {
            x.push(12.0);
            y.push(0.0);
        }
        let t = table(&x, &y, Interpolation::Cubic, Some(period));
        for p in &x {
            for order in 0..=2 {
                let left = t.evaluate(p - 1e-10, order);
                let right = t.evaluate(p + 1e-10, order);
                assert!(
                    (left - right).abs() < 1e-7,
                    "{n} points, at {p}, order {order}: {left} {right}"
                );
            }
        }
    }
}

#[test]
fn monotone_data_never_overshoot() {
    let x = [0.0, 1.0, 1.2, 2.0, 5.0, 6.0];
    let y = [0.0, 0.0, 4.0, 4.1, 4.1, 9.0];
    let t = table(&x, &y, Interpolation::Monotone, None);
    let mut before = t.evaluate(0.0, 0);
    for i in 1..=6000 {
        let p = f64::from(i) / 1000.0;
        let value = t.evaluate(p, 0);
        assert!(value >= before - 1e-12 && value <= 9.0 + 1e-12, "{p}");
        assert!(t.evaluate(p, 1) >= -1e-12, "slope at {p}");
        before = value;
    }
    let t = table(
        &[0.0, 1.0, 2.0, 3.0],
        &[0.0, 3.0, 3.0, 0.0],
        Interpolation::Monotone,
        Some(3.0),
    );
    let slope = |x: f64| t.evaluate(x, 1);
    assert!((slope(1e-9) - slope(3.0 - 1e-9)).abs() < 1e-6);
    for i in 0..300 {
        let value = t.evaluate(f64::from(i) / 100.0, 0);
        assert!((-1e-12..=3.0 + 1e-12).contains(&value));
    }
}

#[test]
fn derivatives_agree_with_differences() {
    let x: Vec<f64> = (0..9)
        .map(|i| f64::from(i) + 0.1 * f64::from(i % 3))
        .collect();
    let y: Vec<f64> = x.iter().map(|x| x * libm::sin(*x)).collect();
    for interpolation in [Interpolation::Cubic, Interpolation::Monotone] {
        let t = table(&x, &y, interpolation, None);
        for start in x.iter().take(8) {
            let p = start + 0.4;
            let h = 1e-3;
            for order in 0..3 {
                let d = (t.evaluate(p + h, order) - t.evaluate(p - h, order)) / (2.0 * h);
                let exact = t.evaluate(p, order + 1);
                // central differences of a cubic are off by h² c3
                assert!(
                    (d - exact).abs() < 1e-5 * (1.0 + t.evaluate(p, 3).abs()),
                    "{p} {order}: {d} {exact}"
                );
            }
        }
    }
}

#[test]
fn rounding_at_an_end_is_inside() {
    let x = vec![0.0, 1e-3, 2e-3];
    let y = vec![0.0, 1.0, 4.0];
    let table = Curve::new("t", x, y, Interpolation::Cubic, None, None).unwrap();
    for (end, past) in [(2e-3, 1e-15), (0.0, -1e-15)] {
        let (at, beyond) = (table.evaluate(end, 0), table.evaluate(end + past, 0));
        // the slope of the spline, at most 4000, over the rounding
        assert!((beyond - at).abs() <= 5e-12, "{at} {beyond}");
        assert!(!table.is_outside(end + past));
        let far = end + 1e7 * past;
        assert!(table.evaluate(far, 0).is_nan() && table.is_outside(far));
    }
}

#[test]
fn outside_follows_what_is_stated() {
    let build = |e| {
        let (x, y) = (vec![0.0, 1.0, 2.0], vec![0.0, 1.0, 4.0]);
        Curve::new("t", x, y, Interpolation::Cubic, e, None).expect("valid points")
    };
    assert!(build(None).evaluate(2.1, 0).is_nan() && build(None).evaluate(-0.1, 1).is_nan());
    let hold = build(Some(Extrapolation::Hold));
    assert_eq!((hold.evaluate(3.0, 0), hold.evaluate(3.0, 1)), (4.0, 0.0));
    let linear = build(Some(Extrapolation::Linear));
    let slope = linear.evaluate(2.0, 1);
    assert_eq!(linear.evaluate(3.0, 1), slope);
    assert!((linear.evaluate(3.0, 0) - (4.0 + slope)).abs() < 1e-14);
    assert_eq!(linear.evaluate(3.0, 2), 0.0);
    assert!(hold.evaluate(f64::NAN, 0).is_nan() && hold.evaluate(f64::INFINITY, 0).is_nan());
}

#[test]
fn wrong_points_are_refused() {
    let build = |x: &[f64], y: &[f64], period| {
        Curve::new(
            "t",
            x.to_vec(),
            y.to_vec(),
            Interpolation::Cubic,
            None,
            period,
        )
    };
    assert!(matches!(
        build(&[1.0], &[1.0], None),
        Err(TableError::TooFew { count: 1, .. })
    ));
    assert!(matches!(
        build(&[1.0, 2.0], &[1.0], None),
        Err(TableError::Lengths { .. })
    ));
    assert!(matches!(
        build(&[1.0, 1.0], &[1.0, 2.0], None),
        Err(TableError::NotRising { row: 2, .. })
    ));
    assert!(matches!(
        build(&[1.0, 2.0], &[1.0, f64::NAN], None),
        Err(TableError::NotFinite { row: 2, .. })
    ));
    assert!(matches!(
        build(&[0.0, 2.0], &[1.0, 2.0], Some(2.0)),
        Err(TableError::NotPeriodic { .. })
    ));
    assert!(matches!(
        build(&[0.0, 3.0], &[1.0, 2.0], Some(2.0)),
        Err(TableError::PeriodTooShort { .. })
    ));
    assert!(matches!(
        build(&[0.0, 3.0], &[1.0, 2.0], Some(-2.0)),
        Err(TableError::PeriodTooShort { .. })
    ));
    assert!(matches!(
        build(&[0.0, 3.0], &[1.0, 2.0], Some(f64::NAN)),
        Err(TableError::PeriodTooShort { .. })
    ));
}
