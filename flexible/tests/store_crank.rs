//! A crankshaft of 31,000 nodes: stored, read at once, and recovered, with the time of each.

use crate::fe_meshes;
use crate::support::DATA;
use eng_flexible::fe::Rules;
use eng_flexible::fe::stress::von_mises;
use eng_flexible::markers::{MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::read::{Files, nastran::read_bulk};
use eng_flexible::recover::Recovery;
use eng_flexible::reduce::{Interface, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::store::{Key, StoredBody, content_hash};
use std::io::Read;
use std::time::Instant;

fn timed<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    println!("{what}: {:.0} ms", 1e3 * start.elapsed().as_secs_f64());
    result
}

#[test]
fn a_crankshaft_is_stored_read_and_recovered() {
    let mut file = Vec::new();
    DATA.open("crank_m.bdf.gz")
        .unwrap()
        .read_to_end(&mut file)
        .unwrap();
    let markers: Vec<MarkerRequest> = (0..5)
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
    let at = (0..5)
        .map(|marker| Interface {
            marker,
            components: 0b110,
        })
        .collect();
    let request = Request {
        rules: Rules::default(),
        markers,
        support: vec![],
        terms: vec![
            Term::Static(at),
            Term::Normal {
                modes: Modes::Count(20),
                fixed: vec![],
            },
        ],
        damping_ratio: 0.02,
        damping_up_to: 3000.0,
        geometric_stiffness: true,
        ..Request::default()
    };
    let mesh = timed("mesh", || read_bulk(&DATA, "crank_m.bdf.gz").unwrap());
    let reduced = timed("reduction with geometric stiffness", || {
        reduce(mesh, &request).unwrap()
    });
    let n = reduced.body.invariants.modes;
    assert_eq!(n, 30);
    let blocks = reduced.body.invariants.geometric.as_ref().unwrap();
    // all six at five markers
    assert_eq!(blocks.loads.len(), 30);
    // at 420 rad/s about its axis the crank stiffens by little: the spin is far below its first frequency
    let (stiffness, spin) = (reduced.body.invariants.stiffness[0], blocks.spin[0][0]);
    println!(
        "first mode: {:.2e} of its stiffness",
        420.0 * 420.0 * spin / stiffness
    );
    assert!((420.0 * 420.0 * spin / stiffness).abs() < 0.1);

    let key = Key::new(&[content_hash(&file)], &format!("{request:?}"));
    let before = StoredBody::new(reduced, request.rules, key, vec![]);
    let bytes = timed("writing", || before.to_bytes().unwrap());
    println!("{:.1} MB", bytes.len() as f64 / 1e6);
    let stored = timed("reading", || StoredBody::from_bytes(&bytes).unwrap());
    assert_eq!(stored.key, key);
    assert_eq!(stored.body, before.body);
    assert_eq!(stored.mesh, before.mesh);
    assert_eq!(stored.shapes, before.shapes);

    let recovery = Recovery::of_stored(&stored).unwrap();
    let nodes = stored.surface.nodes();
    let modal = timed("stresses of all modes on the surface", || {
        recovery.stress_at_nodes(&nodes).unwrap()
    });
    // every node of the surface is a solid's
    assert_eq!(modal.nodes().len(), nodes.len());
    let a: Vec<f64> = (0..n).map(|k| 1e-4 / (1.0 + k as f64)).collect();
    let mut values = Vec::new();
    timed("stresses of a moment", || {
        modal.stress(&a, &mut values).unwrap()
    });
    // by superposition of the same moment's displacements
    let full = recovery.displacements(&a).unwrap();
    let sum = fe_meshes::energy_of_solids(&stored.mesh, &stored.freedoms, &stored.rules, &full);
    let energy = fe_meshes::modal_energy(&stored.body, &a);
    assert!((sum / energy - 1.0).abs() < 1e-9, "{sum} {energy}");
    assert!(values.iter().map(von_mises).fold(0.0, f64::max) > 0.0);
}
