//! Maps of films.

use eng_report::figure::{FilmMap, FilmPanel};
use eng_report::internals::within_a_turn;

#[test]
fn sectors_are_cut_at_the_turn() {
    assert_eq!(within_a_turn([10.0, 20.0]), [(10.0, 20.0)]);
    assert_eq!(within_a_turn([350.0, 370.0]), [(350.0, 360.0), (0.0, 10.0)]);
    assert_eq!(within_a_turn([-20.0, 15.0]), [(340.0, 360.0), (0.0, 15.0)]);
    assert_eq!(
        within_a_turn([-90.0, 270.0]),
        [(270.0, 360.0), (0.0, 270.0)]
    );
}

/// Two columns of one row: the right half of the map is high. The opening has an outline, the extreme a ring.
#[test]
fn a_map_has_its_cells_openings_and_extreme() {
    let panel = FilmPanel {
        name: "main".to_owned(),
        moment: "372 °CA".to_owned(),
        frame: "block.main".to_owned(),
        around: vec![0.0, 180.0, 360.0],
        across: vec![-10.0, 10.0],
        values: vec![0.0, 8.0],
        openings: vec![[[80.0, 100.0], [-5.0, 5.0]]],
        mark: Some((270.0, 0.0)),
        facts: "largest 8 MPa".to_owned(),
    };
    let map = FilmMap {
        title: "Film <1>".to_owned(),
        subtitle: String::new(),
        quantity: "Pressure".to_owned(),
        unit: "MPa".to_owned(),
        panels: vec![panel],
    };
    let svg = map.to_svg();
    assert!(svg.contains("Pressure (MPa)") && svg.contains("main, 372 °CA"));
    assert!(svg.contains("of block.main (°)") && svg.contains("largest 8 MPa"));
    assert_eq!(svg.matches("<circle").count(), 2);
    // two levels, and the frames of the opening and of the panel
    assert_eq!(svg.matches("crispEdges").count(), 2);
    assert_eq!(svg.matches("fill=\"none\"").count(), 2 + 2);
    let empty = FilmMap {
        panels: Vec::new(),
        ..map
    };
    assert!(!empty.to_svg().contains("NaN"));
}
