//! Figures of runs: families, spectra, words, names, limits of samples.

use eng::internals::figures::{
    Natural, Samples, common_frame, distinct_names, extent_text, histories, limit_text, spectrum,
    speed_text, two_digits_below,
};
use eng::post::Run;
use eng::results::Column;
use eng::{Dimension, DisplayUnit, Machine, Results};
use eng_report::figure::{Abscissa, Figure, History, Upright};
use eng_system::expression::Limit;
use eng_system::system::Extent;
use std::f64::consts::TAU;

fn machine(period: Option<f64>) -> Machine {
    Machine {
        fields: Vec::new(),
        journals: Vec::new(),
        summaries: Vec::new(),
        cycle_period: period,
        periodic: period.is_some(),
        upright: Upright::Y,
        firing: Vec::new(),
    }
}

fn column(path: &str, dimension: Dimension, values: Vec<f64>) -> Column {
    Column {
        path: path.to_owned(),
        dimension,
        display: DisplayUnit::si(dimension),
        ..Column::time(values)
    }
}

#[test]
fn families_are_the_models_outputs() {
    let mut results = Results::new("a", "M");
    results.push(Column::time(vec![0.0])).unwrap();
    for path in [
        "vertical[1]",
        "vertical[2]",
        "crank_torque",
        "main[1].force.x",
    ] {
        results
            .push(column(path, Dimension::FORCE, vec![1.0]))
            .unwrap();
    }
    let machine = machine(None);
    let found: Vec<(String, usize)> = histories(&Run::new(&results, &machine))
        .into_iter()
        .map(|wanted| (wanted.title, wanted.paths.len()))
        .collect();
    assert_eq!(
        found,
        [("Vertical".to_owned(), 2), ("Crank torque".to_owned(), 1)]
    );
}

/// One cycle of two revolutions at 3000 rpm: 5 N of the fourth order about 2 N.
#[test]
fn a_wave_stands_at_its_order_and_a_constant_has_no_spectrum() {
    let angles: Vec<f64> = (0..=720).map(|i| f64::from(i).to_radians()).collect();
    let wave = angles.iter().map(|a| 5.0 * libm::cos(4.0 * a) + 2.0);
    let (wave, still) = (wave.collect(), vec![2.0; angles.len()]);
    let times = angles.iter().map(|a| a / TAU / 50.0).collect();
    let mut results = Results::new("a", "M");
    results.push(Column::time(times)).unwrap();
    results
        .push(column("push[1]", Dimension::FORCE, wave))
        .unwrap();
    results
        .push(column("push[2]", Dimension::FORCE, still))
        .unwrap();
    results.push(Column::cycle_angle(angles)).unwrap();
    let machine = machine(Some(2.0 * TAU));
    let run = Run::new(&results, &machine);
    let history = &histories(&run)[0];
    let spectrum = spectrum(history, &run).expect("a spectrum");
    let Ok(Figure::History(History {
        panels,
        abscissa,
        subtitle,
        ..
    })) = spectrum.draw(&[run])
    else {
        panic!("{spectrum:?}");
    };
    assert_eq!(abscissa, Abscissa::OrderAt { speed: 50.0 });
    assert!(subtitle.contains("rectangular window, resolution 0.5000 orders"));
    assert_eq!(panels[0].curves.len(), 1);
    let values = &panels[0].curves[0].values;
    for (order, value) in panels[0].x.iter().zip(values) {
        let due = if *order == 4.0 { 5.0 } else { 0.0 };
        assert!((value - due).abs() < 1e-10, "{order}: {value}");
    }
    // spectra over orders end at the thirtieth
    assert!((panels[0].x.last().unwrap() - 30.0).abs() < 1e-9);
}

#[test]
fn one_speed_gives_lines_and_several_give_marks() {
    let mut natural = Natural::default();
    assert_eq!(natural.description(), None);
    let speed = 100.0 * TAU;
    natural.push("a[1]", &[50.0, 80.0, 0.0], &[0.01, 0.5, 1.0], &[speed; 3]);
    assert_eq!(natural.lines(), [("mode 1".to_owned(), 50.0)]);
    assert_eq!(
        natural.description().as_deref(),
        Some("natural frequencies of a[1] at 6000 rpm, damping below 20 %")
    );
    natural.push("a[2]", &[55.0], &[0.01], &[-2.0 * speed]);
    assert!(natural.lines().is_empty());
    assert_eq!(natural.marks().len(), 2);
    assert!((natural.marks()[1].0 - 12000.0).abs() < 1e-9);
    assert_eq!(
        natural.description().as_deref(),
        Some("natural frequencies of a[1] to a[2], damping below 20 %")
    );
}

#[test]
fn frames_are_named_together() {
    assert_eq!(common_frame(&["ground", "ground"]), "ground");
    assert_eq!(common_frame(&["", ""]), "");
    let shells = ["block.main[1]", "block.main[2]", "block.main[5]"];
    assert_eq!(common_frame(&shells), "block.main[1…5]");
    assert_eq!(common_frame(&["a", "b"]), "a, b");
}

#[test]
fn what_is_said_is_in_the_units_of_the_text() {
    assert_eq!(extent_text(Extent::Time(2e-4)), "200 us");
    assert_eq!(extent_text(Extent::Time(0.2)), "200 ms");
    assert_eq!(extent_text(Extent::Time(2.5)), "2.5 s");
    assert_eq!(extent_text(Extent::Angle(0.5f64.to_radians())), "0.5 deg");
    assert_eq!(extent_text(Extent::Angle(2.0 * TAU)), "2 rev");
    assert_eq!(limit_text(Limit::Frequency(2500.0)), "2.5 kHz");
    assert_eq!(limit_text(Limit::Order(0.5)), "order 0.5");
    assert_eq!(speed_text(200.0 / 3.0), "4000 rpm");
    assert!((two_digits_below(1.0 / 6.0) - 0.16).abs() < 1e-15);
    // half the sampling rate itself is refused, so the hint is smaller
    assert!((two_digits_below(0.25) - 0.24).abs() < 1e-15);
    assert!((two_digits_below(121.0) - 120.0).abs() < 1e-12);
    assert!((two_digits_below(1.0) - 0.9).abs() < 1e-12);
}

fn samples(times: &[f64], angles: Option<&[f64]>) -> Samples {
    Samples {
        analysis: "a".to_owned(),
        time: times.to_vec(),
        angle: angles.map(<[f64]>::to_vec),
        speed: None,
        period: None,
        whole: false,
        shortened: false,
        shifts: None,
    }
}

#[test]
fn runs_are_alike_at_equal_angles_or_equal_times() {
    let a = samples(&[0.0, 1.0, 2.0], Some(&[0.0, 0.5, 1.0]));
    let slower = samples(&[0.0, 1.1, 2.3], Some(&[0.0, 0.5, 1.0]));
    assert_eq!(a.differ(&slower), None);
    let turned = samples(&[0.0, 1.0, 2.0], Some(&[0.0, 0.6, 1.0]));
    assert_eq!(a.differ(&turned), None);
    let other = samples(&[0.0, 1.2, 2.0], Some(&[0.0, 0.6, 1.0]));
    assert_eq!(
        a.differ(&other).as_deref(),
        Some("sample 2 at 1.000000 s against 1.200000 s, and at other crank angles")
    );
    let short = samples(&[0.0, 1.0], None);
    assert_eq!(a.differ(&short).as_deref(), Some("3 samples against 2"));
}

#[test]
fn names_are_short_and_distinct() {
    let pairs = |pairs: &[(&'static str, &'static str)]| distinct_names(pairs.iter().copied());
    assert_eq!(pairs(&[("a", "x[1]"), ("a", "x[2]")]), ["x[1]", "x[2]"]);
    let paths = [("a", "m[1].force.x"), ("a", "m[2].force.x")];
    assert_eq!(pairs(&paths), ["m[1]", "m[2]"]);
    let others = [("a", "m[1].force.x"), ("a", "m[1].force.y")];
    assert_eq!(pairs(&others), ["m[1].force.x", "m[1].force.y"]);
    let unlike = [("a", "big.force.x"), ("a", "small.force.x")];
    assert_eq!(pairs(&unlike), ["big", "small"]);
    assert_eq!(pairs(&[("a", "x"), ("b", "x")]), ["a", "b"]);
    assert_eq!(pairs(&[("a", "x"), ("b", "y")]), ["a x", "b y"]);
    let made = [
        ("a[1]", "v[1] (a[1] - a[3]) / a[3].v[1]"),
        ("a[1]", "v[2] (a[1] - a[3]) / a[3].v[2]"),
    ];
    assert_eq!(pairs(&made), ["v[1]", "v[2]"]);
    let other = [("a", "v (a - b)"), ("a", "v (c - b)")];
    assert_eq!(pairs(&other), ["a", "c"]);
    // labels of different forms do not change
    let unlike = [("a", "v (a - b)"), ("a", "v - w - z")];
    assert_eq!(pairs(&unlike), ["v (a - b)", "v - w - z"]);
}
