//! Tables: properties of reduced bodies, summaries by interface, parts of modes.

use eng::internals::tables::{
    LENGTHS, MASSES, Unit, alike, composition, in_words, properties, summary_text, weight_check,
};
use eng::results::Column;
use eng::{
    Dimension, DisplayUnit, InterfaceSummary, Results, Statistic, SummarisedElement, SummaryColumn,
    SummaryTable,
};
use eng_flexible::mesh::WeightCheck;
use eng_flexible::reduce::BodyMass;
use std::f64::consts::PI;

#[test]
fn small_and_large_bodies_are_readable() {
    let body = |mass: f64, length: f64| BodyMass {
        mass,
        centre: [-1e-13 * length, 0.25 * length, -0.0],
        inertia: [
            [mass * length * length, -1e-14 * mass * length * length, 0.0],
            [0.0, mass * length * length, 0.02 * mass * length * length],
            [0.0, 0.0, 1e-3 * mass * length * length],
        ],
    };
    assert_eq!(
        properties(&body(2e-5, 3e-3), 3e-3),
        "mass 20.00000 mg, centre (0, 0.750000, 0) mm, inertia about it xx 0.180000, yy 0.180000, zz 0.000180000, xy 0, yz 0.00360000, zx 0 g mm²"
    );
    assert_eq!(
        properties(&body(31.25, 0.4), 0.4),
        "mass 31.25000 kg, centre (0, 100.000, 0) mm, inertia about it xx 5.00000, yy 5.00000, zz 0.00500000, xy 0, yz 0.100000, zx 0 kg m²"
    );
    assert_eq!(
        properties(&body(4e6, 60.0), 60.0),
        "mass 4000.000 t, centre (0, 15.0000, 0) m, inertia about it xx 1.44000e10, yy 1.44000e10, zz 14400000, xy 0, yz 288000000, zx 0 kg m²"
    );
}

#[test]
fn the_weight_check_stands_beside_the_mass() {
    let check = WeightCheck {
        mass: 2.0,
        centre: Some([0.0, 0.1, 0.0]),
        place: ("rod.bdf".into(), 7),
    };
    let body = BodyMass {
        mass: 2.01,
        centre: [0.0, 0.1, 0.002],
        inertia: [[0.0; 3]; 3],
    };
    assert_eq!(
        weight_check(&check, &body, 0.1),
        "weight check in rod.bdf:7: mass 2.000000 kg (Eng: +0.5000 %), centre (0, 100.000, 0) mm (Eng: 2 mm away)"
    );
}

#[test]
fn a_body_of_no_size_has_the_smallest_unit() {
    assert_eq!(Unit::for_size(LENGTHS, f64::NAN).symbol, "µm");
    assert_eq!(Unit::for_size(LENGTHS, 0.0).symbol, "µm");
    assert_eq!(Unit::for_size(MASSES, 0.1).symbol, "kg");
}

fn films() -> InterfaceSummary {
    let column = |output: &str, statistic| SummaryColumn {
        output: output.to_owned(),
        about: String::new(),
        statistic,
    };
    let element = |path: &str, pressed: bool| SummarisedElement {
        path: path.to_owned(),
        parameters: Vec::new(),
        channels: vec![
            Some(format!("{path}.load")),
            pressed.then(|| format!("{path}.pressure")),
            Some(format!("{path}.least_gap")),
            Some(format!("{path}.heat")),
        ],
    };
    InterfaceSummary {
        interface: "OwnFilm".to_owned(),
        parameters: Vec::new(),
        columns: vec![
            column("load", Statistic::Largest),
            column("pressure", Statistic::Largest),
            column("least_gap", Statistic::Least),
            column("heat", Statistic::Mean),
        ],
        elements: vec![element("main[1]", true), element("main[2]", false)],
    }
}

fn results(samples: &[(f64, f64, f64)]) -> Results {
    let mut results = Results::new("unfired", "Inline4");
    let column = |path: &str, symbol: &str, scale: f64, values: Vec<f64>| Column {
        path: path.to_owned(),
        dimension: Dimension::ONE,
        display: DisplayUnit {
            symbol: symbol.to_owned(),
            scale,
            offset: 0.0,
        },
        frame: String::new(),
        values,
    };
    let time: Vec<f64> = (0..samples.len()).map(|i| i as f64 * 0.01).collect();
    let angle = samples.iter().map(|s| s.0.to_radians()).collect();
    results.push(Column::time(time)).unwrap();
    results.push(Column::cycle_angle(angle)).unwrap();
    for (path, share) in [("main[1]", 1.0), ("main[2]", 0.1)] {
        let loads: Vec<f64> = samples.iter().map(|s| share * s.1).collect();
        let pressure = loads.iter().map(|f| f / 0.00108).collect();
        let gaps: Vec<f64> = samples.iter().map(|s| s.2).collect();
        let heat = gaps.iter().map(|f| f * 1e6).collect();
        for (name, symbol, scale, values) in [
            ("load", "N", 1.0, loads),
            ("pressure", "MPa", 1e6, pressure),
            ("least_gap", "um", 1e-6, gaps),
            ("heat", "W", 1.0, heat),
        ] {
            let path = format!("{path}.{name}");
            results.push(column(&path, symbol, scale, values)).unwrap();
        }
    }
    results
}

#[test]
fn takes_the_last_cycle() {
    // the start-up peak of 9 kN and the film of 1 µm lie before the last 720°
    let samples = [
        (0.0, 9e3, 1e-6),
        (360.0, 300.0, 5e-6),
        (720.0, 600.0, 4e-6),
        (900.0, 2000.0, 3e-6),
        (1080.0, 300.0, 5e-6),
    ];
    let (results, films) = (results(&samples), films());
    let table = SummaryTable::new(&results, &films, Some(4.0 * PI));
    assert!(table.last_cycle);
    let [load, pressure, gap, heat] = [0, 1, 2, 3].map(|k| table.rows[0][k].unwrap());
    assert_eq!((load.value, gap.value), (2000.0, 3e-6));
    assert!((pressure.value - 2000.0 / 0.00108).abs() < 1e-6);
    assert!((load.angle.unwrap().to_degrees() - 180.0).abs() < 1e-9);
    // trapezoid over 5, 4, 3, 5 W
    assert!((heat.value - 4.0).abs() < 1e-12);
    assert_eq!((heat.angle, table.rows[1][1]), (None, None));
    let whole = SummaryTable::new(&results, &films, Some(8.0 * PI));
    assert!(!whole.last_cycle);
    assert_eq!(whole.rows[0][0].unwrap().value, 9000.0);
    insta::assert_snapshot!(format!("{}{}", summary_text(&table), summary_text(&whole)));
}

#[test]
fn absent_columns_are_dashes() {
    let mut bare = Results::new("a", "M");
    bare.push(Column::time(vec![0.0, 1.0])).unwrap();
    let films = films();
    let text = summary_text(&SummaryTable::new(&bare, &films, None));
    assert_eq!(text.matches('–').count(), 8, "{text}");
}

#[test]
fn numbers_of_a_column_have_the_same_decimals() {
    for (values, texts) in [
        (
            vec![Some(12.3456), Some(-0.5), None],
            ["12.35", "-0.50", "–"],
        ),
        (
            vec![Some(0.0), Some(12345.6), Some(1.0)],
            ["0", "12346", "1"],
        ),
        (vec![Some(0.0), None, Some(0.0)], ["0", "–", "0"]),
        (
            vec![Some(1.5e-7), None, Some(2e-9)],
            ["1.500e-7", "–", "2.000e-9"],
        ),
    ] {
        assert_eq!(alike(&values), texts);
    }
}

#[test]
fn names_in_words() {
    for (name, words) in [
        ("JournalLaw", "journal law"),
        ("GasLaw", "gas law"),
        ("PInD", "pin d"),
        ("own_law", "own law"),
    ] {
        assert_eq!(in_words(name), words);
    }
}

#[test]
fn parts_are_named_from_columns() {
    let mut results = Results::new("modes", "M");
    for (path, value) in [
        ("kinetic.crank", 0.82),
        ("kinetic.crank.rigid", 0.2),
        ("kinetic.crank.mode[1]", 0.0),
        ("kinetic.crank.mode[2]", 0.62),
        ("kinetic.rod[1]", 0.16),
        ("kinetic.rod[2]", 0.02),
    ] {
        let share = Column {
            path: path.to_owned(),
            dimension: Dimension::ONE,
            display: DisplayUnit::si(Dimension::ONE),
            frame: String::new(),
            values: vec![value],
        };
        results.push(share).unwrap();
    }
    assert_eq!(
        composition(&results, 0),
        "62 % crank mode 2, 20 % crank rigid, 16 % rod[1]"
    );
    assert!(!results.are_modes());
}
