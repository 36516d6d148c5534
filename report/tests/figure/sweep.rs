//! Amplitudes over speed and frequency.

use eng_report::figure::{Campbell, SweepFigure, Waterfall};
use eng_report::internals::{MOST_ROWS, merged_cells, speed_edges};
use eng_report::signal::{Axis, SweepMap};

/// Half an order is large, all other lines are small; 1 Hz from line to line.
fn map(speeds: &[f64], lines: u32) -> SweepMap {
    let line = |speed: f64, at: u32| match (f64::from(at) - speed / 30.0).abs() < 0.5 {
        true => 7.0,
        false => 0.1,
    };
    let row = |speed: &f64| (0..lines).map(|at| line(*speed, at)).collect();
    let rows = speeds.iter().map(row).collect();
    SweepMap::new(Axis::Frequency, speeds.to_vec(), 1.0, rows).unwrap()
}

fn figure() -> SweepFigure {
    SweepFigure {
        title: "Run-up <1>".to_owned(),
        subtitle: String::new(),
        quantity: "Acceleration x".to_owned(),
        unit: "m/s²".to_owned(),
        frame: "block".to_owned(),
        map: map(&[1000.0, 1500.0, 2500.0], 2000),
        limit: None,
    }
}

#[test]
fn diagrams_are_drawn_whatever_the_map() {
    let mut figure = figure();
    let campbell = Campbell {
        figure: figure.clone(),
        orders: vec![2.0, 4.0, 1000.0],
        natural_frequencies: vec![("first".to_owned(), 800.0), ("far".to_owned(), 1e5)],
        modes: vec![(2500.0, 900.0), (2500.0, 1e5), (f64::NAN, 3.0)],
    };
    let svg = campbell.to_svg();
    assert!(svg.contains(">order 2<") && svg.contains(">order 4<") && !svg.contains(">far"));
    assert!(svg.contains("first, 800 Hz") && !svg.contains("NaN"));
    // one mark of two rings: the others lie outside
    assert_eq!(svg.matches("<circle").count(), 2);
    assert!(svg.contains("Acceleration x (m/s²), axes of block"));
    let waterfall = |figure| Waterfall { figure }.to_svg();
    assert_eq!(waterfall(figure.clone()).matches("<polyline").count(), 3);
    figure.map.replace(|x| if x > 1.0 { f64::NAN } else { x });
    assert!(!waterfall(figure.clone()).contains("NaN"));
    figure.map = map(&[], 0);
    let empty = Campbell {
        figure: figure.clone(),
        ..campbell
    };
    for svg in [waterfall(figure), empty.to_svg()] {
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}

#[test]
fn edges_lie_halfway_between_speeds() {
    assert_eq!(
        speed_edges(&[1000.0, 1500.0, 2500.0]),
        [750.0, 1250.0, 2000.0, 3000.0]
    );
    assert_eq!(speed_edges(&[1000.0]).len(), 2);
    assert!(speed_edges(&[]).is_empty());
}

#[test]
fn merged_cells_keep_the_peaks() {
    let figure = figure();
    let cells = merged_cells(&figure.map, 1999.0);
    assert!(cells.iter().all(|column| column.len() <= MOST_ROWS));
    for column in &cells {
        assert_eq!(column.iter().copied().fold(0.0, f64::max), 7.0);
    }
}
