//! Supports: all nodes of a marker, the mean motion of an averaging one, the deck's own.

use crate::nastran_deck::mesh;
use crate::support::Data;
use eng_flexible::fe::Rules;
use eng_flexible::markers::{MESH_AXES, MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::mesh::{Code, Mesh};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::reduce::{Interface, Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;

const DATA: Data = Data("variants");

/// CalculiX 2.20 with the nodes of one edge held (Hz): bending, torsion, …
const CLAMPED: [f64; 5] = [110.6039, 268.6611, 690.7808, 860.3407, 993.5608];

fn plate() -> Mesh {
    read_inp(&DATA, "plate.inp.gz", Code::CalculiX).unwrap()
}

fn request() -> Request {
    Request {
        rules: Rules::calculix(),
        terms: vec![Term::Normal {
            modes: Modes::Count(CLAMPED.len()),
            fixed: Vec::new(),
        }],
        ..Request::default()
    }
}

fn root(tie: Spider) -> MarkerRequest {
    MarkerRequest {
        name: "root".into(),
        place: MarkerPlace::Gathered {
            nodes: Selection::Set("ROOT".into()),
            tie,
            center: None,
        },
        axes: MESH_AXES,
    }
}

const ROOT: Interface = Interface {
    marker: 0,
    components: 0b11_1111,
};

fn reduced(request: &Request) -> Reduced {
    match reduce(plate(), request) {
        Ok(reduced) => reduced,
        Err(error) => panic!("{error}"),
    }
}

fn apart(reduced: &Reduced) -> Vec<f64> {
    let pairs = reduced.body.frequencies.iter().zip(CLAMPED);
    pairs.map(|(x, y)| x / y - 1.0).collect()
}

#[test]
fn a_support_holds_its_nodes() {
    let held = reduced(&Request {
        markers: vec![root(Spider::Averaging)],
        support: vec![ROOT],
        held_nodes: vec![0],
        ..request()
    });
    assert!(held.report.supported);
    assert!(
        apart(&held).iter().all(|x| x.abs() < 1e-6),
        "{:?}",
        apart(&held)
    );
    let rigid = reduced(&Request {
        markers: vec![root(Spider::Rigid)],
        support: vec![ROOT],
        ..request()
    });
    assert!(
        apart(&rigid).iter().all(|x| x.abs() < 1e-6),
        "{:?}",
        apart(&rigid)
    );
    // the mean motion alone lets the edge twist
    let mean = reduced(&Request {
        markers: vec![root(Spider::Averaging)],
        support: vec![ROOT],
        ..request()
    });
    assert!(apart(&mean)[1] < -0.1, "{:?}", apart(&mean));
}

#[test]
fn the_decks_supports_hold() {
    let held = reduced(&Request {
        support_of_deck: true,
        ..request()
    });
    assert!(held.report.supported);
    assert!(
        apart(&held).iter().all(|x| x.abs() < 1e-6),
        "{:?}",
        apart(&held)
    );
    let cards = &plate().support_cards;
    assert_eq!((cards[0].name.as_str(), cards[0].count), ("*BOUNDARY", 1));

    let mut moved = plate();
    moved.support_cards[0].moved = Some(("plate.inp".into(), 7));
    let held = Request {
        support_of_deck: true,
        ..request()
    };
    let error = reduce(moved, &held).unwrap_err().to_string();
    assert!(error.contains("*BOUNDARY at plate.inp:7"), "{error}");
    let mut none = plate();
    none.supports.clear();
    let error = reduce(none, &held).unwrap_err().to_string();
    assert!(error.contains("holds no freedom"), "{error}");
}

/// Two rods of 1 m at 45° with a mass of 3 kg where they meet. Nothing resists its motion across their plane, and no
/// rotation has stiffness: Nastran's AUTOSPC holds these freedoms.
const TRUSS: &str = "GRID,1,,0.,0.,0.
GRID,2,,1.4142135623730951,0.,0.
GRID,3,,.70710678118654757,.70710678118654757,0.
MAT1,8,2.+11,,.3
CONROD,1,1,3,8,1.-4
CONROD,2,2,3,8,1.-4
CONM2,3,3,,3.
SPC1,1,123,1,2
";

#[test]
fn freedoms_without_stiffness_are_held_with_the_supports_of_a_deck() {
    let request = |of_deck| Request {
        support_of_deck: of_deck,
        terms: vec![Term::Normal {
            modes: Modes::Count(2),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    let found = reduce(mesh(TRUSS), &request(true)).unwrap();
    // 2 E A/L cos² 45° in both directions
    let expected = (2e7_f64 / 3.0).sqrt() / (2.0 * std::f64::consts::PI);
    for own in &found.body.frequencies {
        assert!((own / expected - 1.0).abs() < 1e-9, "{own} {expected}");
    }
    let told = found.report.warnings.join("\n");
    assert!(
        told.contains("10 freedoms have no stiffness and are held, as by Nastran's AUTOSPC"),
        "{told}"
    );
    assert!(told.contains("component 3 of node 3"), "{told}");
    for (deck, of_deck) in [
        (format!("{TRUSS}PARAM,AUTOSPC,NO\n"), true),
        (TRUSS.to_string(), false),
    ] {
        let error = match reduce(mesh(&deck), &request(of_deck)) {
            Err(error) => error.to_string(),
            Ok(_) => String::new(),
        };
        assert!(
            error.contains("have no stiffness") || !of_deck && !error.is_empty(),
            "{error}"
        );
    }
}
