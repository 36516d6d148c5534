//! The orbit of a loaded pin in a short bearing over a four-stroke cycle, against its recomputed orbit.

use eng::Sources;
use serde_json::Value;
use std::fmt::Write;

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list").iter();
    list.map(|n| n.as_f64().expect("a number")).collect()
}

/// The load history as straight lines between its points: a table of every degree and every point.
fn table(reference: &Value) -> String {
    let angles = numbers(&reference["load_deg"]);
    let loads = numbers(&reference["load_N"]);
    let points: Vec<(f64, f64)> = angles.into_iter().zip(loads).collect();
    let (first, last) = (points[0], points[points.len() - 1]);
    let around: Vec<(f64, f64)> = std::iter::once((last.0 - 720.0, last.1))
        .chain(points.iter().copied())
        .chain(std::iter::once((first.0 + 720.0, first.1)))
        .collect();
    let load = |angle: f64| {
        let next = around.partition_point(|p| p.0 < angle).max(1);
        let ((a, x), (b, y)) = (around[next - 1], around[next]);
        x + (y - x) * (angle - a) / (b - a)
    };
    let mut at: Vec<f64> = (0..720).map(f64::from).collect();
    at.retain(|angle| points.iter().all(|p| (p.0 - angle).abs() > 0.3));
    at.extend(points.iter().map(|p| p.0).filter(|angle| *angle >= 0.0));
    at.sort_by(f64::total_cmp);
    let mut text = "theta [deg],force [N]\n".to_owned();
    for angle in at {
        writeln!(text, "{angle:?},{:?}", load(angle)).expect("text");
    }
    text
}

#[test]
fn a_loaded_pin_runs_on_the_recomputed_orbit() {
    let reference: Value =
        serde_json::from_str(include_str!("reference/bigend_orbit.json")).expect("JSON");
    let sources = Sources::from_texts([
        (
            "bearing.eng".to_owned(),
            include_str!("benchmarks/loaded_bearing.eng").to_owned(),
        ),
        ("load.csv".to_owned(), table(&reference)),
    ]);
    let program = match eng::check(&sources, "bearing.eng").into_program() {
        Ok(program) => program,
        Err(report) => panic!("{report}"),
    };
    let outcome = program
        .analysis("steady")
        .expect("an analysis")
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error));
    let results = outcome.results;
    let column = |path: &str| results.column(path).expect(path).shown();
    let [x, y, force, given] = [
        "film.eccentricity_ratio.x",
        "film.eccentricity_ratio.y",
        "film.force.x",
        "gas.given",
    ]
    .map(column);
    let orbit: Vec<Vec<f64>> = reference["results"]["booker"]["orbit"]
        .as_array()
        .expect("a list")
        .iter()
        .map(numbers)
        .collect();
    assert_eq!(results.samples(), 145);
    let mut worst: (f64, f64) = (0.0, 0.0);
    for k in 0..145 {
        let due = &orbit[k % 144];
        assert_eq!(due[0], 5.0 * (k % 144) as f64);
        let apart = (x[k] - due[1]).hypot(y[k] - due[2]);
        let unbalanced = 1e3 * force[k] + given[k];
        worst = (worst.0.max(apart), worst.1.max(unbalanced.abs()));
    }
    println!("{worst:?}");
    assert!(worst.0 < 1e-3, "{} of the clearance off", worst.0);
    assert!(
        worst.1 < 2.5,
        "the film carries {} N more or less than the load",
        worst.1
    );
}
