//! Averaging ties as interfaces: to hold one is a support there, and its constraint modes span the same space
//! as its static modes.

use crate::fe_meshes;
use crate::fe_meshes::read;
use crate::support::{apart, flexibility};
use eng_flexible::markers::{MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::mesh::Mesh;
use eng_flexible::reduce::{Interface, Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;

/// A bar held at one end by a rigid spider, with an averaging one around its middle and one at the other end.
fn markers() -> Vec<MarkerRequest> {
    let gathered = |name: &str, nodes: Selection, tie: Spider| MarkerRequest {
        axes: eng_flexible::markers::MESH_AXES,
        name: name.into(),
        place: MarkerPlace::Gathered {
            nodes,
            tie,
            center: None,
        },
    };
    let ends = ["left", "right"].map(|set| Selection::Set(set.into()));
    let [left, right] = ends;
    let middle = Selection::Set("middle".into());
    vec![
        gathered("foot", left, Spider::Rigid),
        gathered("middle", middle, Spider::Averaging),
        gathered("tip", right, Spider::Averaging),
    ]
}

fn bar() -> Mesh {
    let mut mesh = read("bar20.bdf.gz");
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for node in &mesh.nodes {
        least = least.min(node.position[0]);
        most = most.max(node.position[0]);
    }
    for (name, x) in [
        ("left", least),
        ("right", most),
        ("middle", 0.5 * (least + most)),
    ] {
        let nodes = fe_meshes::nodes_where(&mesh, |p| (p[0] - x).abs() < 1e-6);
        assert!(nodes.len() > 8, "{name}: {}", nodes.len());
        mesh.sets
            .insert(name.into(), eng_flexible::mesh::Set::new(nodes, vec![]));
    }
    mesh
}

fn at(marker: usize, components: u8) -> Interface {
    Interface { marker, components }
}

fn reduced(support: Vec<Interface>, terms: Vec<Term>) -> Reduced {
    let request = Request {
        markers: markers(),
        support,
        terms,
        damping_up_to: 3000.0,
        asked: vec![at(1, 0b11_1111), at(2, 0b11_1111)],
        ..Request::default()
    };
    reduce(bar(), &request).unwrap_or_else(|error| panic!("{error} ({})", error.advice()))
}

const FOOT: u8 = 0b11_1111;

#[test]
fn an_averaging_spider_that_is_held_is_a_support() {
    for components in [0b11_1111, 0b110, 0b1001] {
        let interface = vec![at(1, 0b110), at(2, components)];
        let normal = |fixed: Vec<Interface>| Term::Normal {
            modes: Modes::Count(8),
            fixed,
        };
        let held = reduced(vec![at(0, FOOT)], vec![normal(interface.clone())]);
        let mut all = vec![at(0, FOOT)];
        all.extend(interface);
        let supported = reduced(all, vec![normal(vec![])]);
        let worst = apart(&held.body.frequencies, &supported.body.frequencies);
        println!("{components:#b}: {worst:.1e}");
        assert!(worst < 1e-10, "{worst:e}");
        // the held motions are zero
        let n = held.body.invariants.modes;
        let tip = &held.body.markers[2];
        for component in 0..6 {
            let rows = if component < 3 {
                &tip.translation
            } else {
                &tip.rotation
            };
            let row = &rows[component % 3 * n..(component % 3 + 1) * n];
            let largest = rows.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
            let moves = row.iter().any(|x| x.abs() > 1e-9 * largest.max(1.0));
            assert_eq!(moves, components >> component & 1 == 0, "{component}");
        }
    }
}

#[test]
fn constraint_modes_of_averaging_spiders_serve_their_loads() {
    let interface = vec![at(1, 0b11_1111), at(2, 0b11_1111)];
    let statics = reduced(vec![at(0, FOOT)], vec![Term::Static(interface.clone())]);
    let constraint = reduced(vec![at(0, FOOT)], vec![Term::Constraint(interface.clone())]);
    assert_eq!(constraint.body.invariants.modes, 12);
    let (found, exact) = (flexibility(&constraint, 1), flexibility(&statics, 1));
    for i in 0..12 {
        for j in 0..12 {
            let scale = (exact[i * 13] * exact[j * 13]).sqrt();
            let miss = (found[i * 12 + j] - exact[i * 12 + j]).abs() / scale;
            assert!(miss < 1e-9, "{i} {j}: {miss:e}");
        }
    }
    assert!(apart(&constraint.body.frequencies, &statics.body.frequencies) < 1e-9);
    for set in [&statics, &constraint] {
        assert!(set.report.unserved.is_empty(), "{:?}", set.report.unserved);
        assert_eq!(set.report.served.len(), 12);
        assert!(set.report.served.iter().all(|served| served.kept));
    }
    let one = &constraint.report.served[7];
    assert_eq!(
        (one.mode.as_str(), one.marker, one.component),
        ("constraint tip.y", 2, 1)
    );
    assert!((one.flexibility.unwrap() / exact[7 * 13] - 1.0).abs() < 1e-9);
    // eight normal modes serve none of these loads
    let normal = Term::Normal {
        modes: Modes::Count(8),
        fixed: vec![],
    };
    let normal = reduced(vec![at(0, FOOT)], vec![normal]);
    assert_eq!(normal.report.unserved.len(), 12);
    assert_eq!(normal.report.unserved(2, 0b10)[0].label, "tip.y");
    assert_eq!(normal.report.modes[0].description, "normal 1");
}

/// A free bar by Craig and Bampton at averaging spiders: its lowest frequencies, from above.
#[test]
fn a_free_bar_by_averaging_spiders() {
    let interface = vec![at(1, 0b11_1111), at(2, 0b11_1111)];
    let sum = |count: usize| {
        vec![
            Term::Constraint(interface.clone()),
            Term::Normal {
                modes: Modes::Count(count),
                fixed: interface.clone(),
            },
        ]
    };
    let exact = reduced(
        vec![],
        vec![Term::Normal {
            modes: Modes::Count(6),
            fixed: vec![],
        }],
    );
    let mut before = f64::INFINITY;
    for count in [4, 12, 24] {
        let found = reduced(vec![], sum(count));
        // six of twelve constraint modes are rigid motions
        assert_eq!(found.report.dropped.len(), 6);
        assert_eq!(found.report.sturm[0].count, count);
        let pairs = found.body.frequencies.iter().zip(&exact.body.frequencies);
        let misses: Vec<f64> = pairs.map(|(x, y)| x / y - 1.0).collect();
        println!("{count}: {misses:?}");
        let worst = misses.iter().copied().fold(0.0, f64::max);
        assert!(misses.iter().all(|miss| *miss > -1e-9) && worst < before);
        before = worst;
        for x in &found.body.invariants.rotation {
            assert!(x.abs() < 1e-9);
        }
    }
    assert!(before < 5e-3, "{before:e}");
}

/// Marker → mesh: turned by 0.4 rad about x, then by 0.7 rad about the new z.
fn skew() -> [f64; 9] {
    let (sx, cx) = libm::sincos(0.4);
    let (sz, cz) = libm::sincos(0.7);
    [cz, -sz, 0.0, cx * sz, cx * cz, -sx, sx * sz, sx * cz, cx]
}

fn reduced_skew(support: Vec<Interface>, terms: Vec<Term>) -> Result<Reduced, String> {
    let mut markers = markers();
    for marker in &mut markers {
        marker.axes = skew();
    }
    let request = Request {
        markers,
        support,
        terms,
        asked: vec![at(2, 0b11_1111)],
        ..Request::default()
    };
    reduce(bar(), &request).map_err(|error| error.to_string())
}

/// 3 × 3 flexibility of the tip's place, axes of the mesh, row-major.
fn of_tip(reduced: &Reduced) -> Vec<f64> {
    let n = reduced.body.invariants.modes;
    let tip = &reduced.body.markers[2].translation;
    let row = |i: usize| &tip[i * n..(i + 1) * n];
    (0..9)
        .map(|place| {
            row(place / 3)
                .iter()
                .zip(row(place % 3))
                .zip(&reduced.body.frequencies)
                .map(|((a, b), f)| a * b / (2.0 * std::f64::consts::PI * f).powi(2))
                .sum()
        })
        .collect()
}

#[test]
fn a_static_mode_is_along_the_axes_of_its_marker() {
    let foot = || vec![at(0, FOOT)];
    let exact = of_tip(&reduced(foot(), vec![Term::Static(vec![at(2, 0b11_1111)])]));
    for own in 0..3u8 {
        let terms = vec![Term::Static(vec![at(2, 1 << own)])];
        let found = reduced_skew(foot(), terms).unwrap();
        // one mode, not one for each axis of the mesh that it touches
        assert_eq!(found.body.invariants.modes, 1);
        let axes = skew();
        let along = [0, 1, 2].map(|row| axes[3 * row + usize::from(own)]);
        let answer = |flexibility: &[f64]| {
            [0, 1, 2].map(|i| -> f64 { (0..3).map(|j| flexibility[3 * i + j] * along[j]).sum() })
        };
        let (reduced, full) = (answer(&of_tip(&found)), answer(&exact));
        let size = full.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
        for (x, y) in reduced.iter().zip(&full) {
            assert!((x - y).abs() < 1e-9 * size, "{own}: {x:e} for {y:e}");
        }
        // its load is served, those across are not
        let unserved = |component: u8| !found.report.unserved(2, 1 << component).is_empty();
        for component in 0..3 {
            assert_eq!(unserved(component), component != own, "{own} {component}");
        }
    }
}

#[test]
fn what_is_held_is_along_the_axes_of_its_marker() {
    let normal = |components| {
        vec![Term::Normal {
            modes: Modes::Count(6),
            fixed: vec![at(2, components)],
        }]
    };
    let turned = reduced_skew(vec![at(0, FOOT)], normal(0b111)).unwrap();
    let straight = reduced(vec![at(0, FOOT)], normal(0b111));
    // all three directions are the same along whichever axes
    let worst = apart(&turned.body.frequencies, &straight.body.frequencies);
    assert!(worst < 1e-8, "{worst:e}");
    let one = reduced_skew(vec![at(0, FOOT)], normal(0b010)).unwrap();
    let n = one.body.invariants.modes;
    let tip = &one.body.markers[2].translation;
    let axes = skew();
    let moved = |own: usize| {
        (0..n)
            .map(|mode| -> f64 { (0..3).map(|i| axes[3 * i + own] * tip[i * n + mode]).sum() })
            .fold(0.0_f64, |w, x| w.max(x.abs()))
    };
    assert!(moved(1) < 1e-8 * moved(0).max(moved(2)));
    let refused = reduced_skew(vec![at(0, 0b010)], normal(0b111)).unwrap_err();
    assert!(
        refused.contains("foot.y: a support holds a direction"),
        "{refused}"
    );
}
