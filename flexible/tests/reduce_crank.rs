//! A crankshaft's mesh, reduced: mass, frequencies and static answers against independent solutions.

use crate::support::DATA;
use eng_flexible::fe::Rules;
use eng_flexible::markers::{MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::read::nastran::read_bulk;
use eng_flexible::reduce::{Interface, Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;
use serde_json::Value;

/// Five main journals as averaging spiders; x and y of the mesh are along and across the crank.
fn request(rules: Rules, terms: Vec<Term>) -> Request {
    let markers = (0..5)
        .map(|j| MarkerRequest {
            axes: eng_flexible::markers::MESH_AXES,
            name: format!("main[{}]", j + 1),
            place: MarkerPlace::Gathered {
                nodes: Selection::Ring {
                    center: [0.013 + 0.096 * f64::from(j), 0.0, 0.0],
                    axis: [1.0, 0.0, 0.0],
                    radius: 0.0275,
                    width: 0.026,
                    tolerance: 1e-5,
                },
                tie: Spider::Averaging,
                center: None,
            },
        })
        .collect();
    Request {
        rules,
        markers,
        support: vec![],
        terms,
        damping_ratio: 0.02,
        damping_up_to: 3000.0,
        ..Request::default()
    }
}

fn mains() -> Vec<Interface> {
    (0..5)
        .map(|marker| Interface {
            marker,
            components: 0b110,
        })
        .collect()
}

fn crank(rules: Rules, terms: Vec<Term>) -> Reduced {
    let mesh = read_bulk(&DATA, "crank_m.bdf.gz").unwrap();
    reduce(mesh, &request(rules, terms)).unwrap_or_else(|error| panic!("{error}"))
}

fn list(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

fn reference() -> Value {
    serde_json::from_str(include_str!("data/crank_m_reference.json")).unwrap()
}

#[test]
fn the_cranks_frequencies_and_mass_are_those_of_independent_solutions() {
    let reference = reference();
    for (rules, frequencies, mass, center, inertia, tolerance) in [
        (
            Rules::calculix(),
            "free_hz_calculix",
            "mass",
            "center",
            "inertia_about_origin",
            1e-8,
        ),
        (
            Rules::default(),
            "free_hz_exact_mass",
            "mass_exact",
            "center_exact",
            "inertia_exact",
            1e-8,
        ),
    ] {
        let normal = Term::Normal {
            modes: Modes::Count(20),
            fixed: vec![],
        };
        let reduced = crank(rules, vec![normal]);
        let c = &reduced.body.invariants;
        assert_eq!(
            (reduced.report.nodes, reduced.report.elements),
            (31_277, 17_384)
        );
        let expected = reference[mass].as_f64().unwrap();
        assert!((c.mass / expected - 1.0).abs() < 1e-10, "{}", c.mass);
        for (k, x) in list(&reference[center]).iter().enumerate() {
            assert!((c.first_moment[k] / c.mass - x).abs() < 1e-10, "{k}");
        }
        for i in 0..3 {
            for (j, x) in list(&reference[inertia][i]).iter().enumerate() {
                assert!(
                    (c.inertia[i][j] - x).abs() < 1e-10,
                    "{i} {j}: {} {x}",
                    c.inertia[i][j]
                );
            }
        }
        assert_eq!(reduced.body.frequencies.len(), 20);
        let worst = reduced
            .body
            .frequencies
            .iter()
            .zip(list(&reference[frequencies]))
            .map(|(found, exact)| (found / exact - 1.0).abs())
            .fold(0.0_f64, f64::max);
        println!("{frequencies}: {worst:.1e}");
        assert!(worst < tolerance, "{frequencies}: {worst:e}");
        // mean axes: no momentum, and at rest no angular momentum, in any mode
        for x in c.translation.iter().chain(&c.rotation) {
            assert!(x.abs() < 1e-9, "{x:e}");
        }
    }
}

/// Loads at the journals: the reduced crank and all its nodes give the same at its markers.
#[test]
fn static_modes_make_loads_at_the_journals_exact() {
    let set = |normal: usize| {
        crank(
            Rules::default(),
            vec![
                Term::Static(mains()),
                Term::Normal {
                    modes: Modes::Count(normal),
                    fixed: vec![],
                },
            ],
        )
    };
    // the flexibility at the markers, Φ ω⁻² Φᵀ: the same whatever normal modes are added
    let flexibility = |reduced: &Reduced| -> Vec<f64> {
        let n = reduced.body.invariants.modes;
        let rows: Vec<&[f64]> = reduced
            .body
            .markers
            .iter()
            .flat_map(|m| [&m.translation[n..2 * n], &m.translation[2 * n..3 * n]])
            .collect();
        let mut out = Vec::new();
        for a in &rows {
            for b in &rows {
                out.push(
                    (0..n)
                        .map(|i| a[i] * b[i] / reduced.body.invariants.stiffness[i * n + i])
                        .sum(),
                );
            }
        }
        out
    };
    let (few, many) = (set(1), set(12));
    assert_eq!(
        (few.body.invariants.modes, many.body.invariants.modes),
        (11, 22)
    );
    let (few, many) = (flexibility(&few), flexibility(&many));
    let scale = many.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
    for (a, b) in few.iter().zip(&many) {
        assert!((a - b).abs() < 1e-8 * scale, "{a:e} {b:e}");
    }
    // normal modes alone miss most of it
    let normal = crank(
        Rules::default(),
        vec![Term::Normal {
            modes: Modes::Count(12),
            fixed: vec![],
        }],
    );
    let miss = flexibility(&normal)
        .iter()
        .zip(&many)
        .map(|(a, b)| (a - b).abs() / scale)
        .fold(0.0_f64, f64::max);
    println!("twelve normal modes alone miss {miss:.4} of the largest flexibility");
    assert!(miss > 5e-3);
}

#[test]
fn markers_that_are_not_there_are_told() {
    let mesh = read_bulk(&DATA, "crank_m.bdf.gz").unwrap();
    let mut wrong = request(Rules::default(), vec![Term::Static(mains())]);
    wrong.markers[2].place = MarkerPlace::Node(99_999_999);
    let error = reduce(mesh.clone(), &wrong).unwrap_err();
    assert_eq!(error.to_string(), "main[3]: the mesh has no node 99999999");
    wrong.markers[2].place = MarkerPlace::Gathered {
        nodes: Selection::Set("JOURNAL".into()),
        tie: Spider::Averaging,
        center: None,
    };
    let error = reduce(mesh.clone(), &wrong).unwrap_err();
    assert!(
        error.advice().contains("its sets are"),
        "{}",
        error.advice()
    );
    // a bare node of a solid does not turn
    let id = mesh.nodes[0].id;
    wrong.markers[2].place = MarkerPlace::Node(id);
    wrong.terms = vec![Term::Static(vec![Interface {
        marker: 2,
        components: 0b1000,
    }])];
    let error = reduce(mesh, &wrong).unwrap_err();
    assert_eq!(
        error.to_string(),
        "main[3].rx: the node of a solid does not turn"
    );
}
