//! The crankshaft and the engine block against independent solutions of the same finite-element matrices:
//! supported frequencies, flexibility at the journals, Craig–Bampton matrices and frequencies.

use crate::support::{self, DATA};
use eng_flexible::FlexibleError;
use eng_flexible::fe::mass::rigid_motions;
use eng_flexible::fe::{Reduction, Rules, assemble};
use eng_flexible::markers::{MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::mesh::{Code, Mesh};
use eng_flexible::modes::normal::normal_modes;
use eng_flexible::modes::statics::constraint_modes;
use eng_flexible::modes::{Boundary, Candidate, Load, ModeSet, Structure};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::reduce::{Interface, Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::sparse::SymmetricOperator;
use serde_json::Value;

fn mesh(model: &str) -> Mesh {
    read_inp(&DATA, &format!("{model}.inp.gz"), Code::CalculiX).unwrap()
}

fn solutions(model: &str) -> Value {
    let text = match model {
        "crank_m" => include_str!("data/crank_m_solutions.json"),
        _ => include_str!("data/block_s_solutions.json"),
    };
    serde_json::from_str(text).unwrap()
}

fn list(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

fn done<T>(result: Result<T, FlexibleError>) -> T {
    result.unwrap_or_else(|error| panic!("{error} ({})", error.advice()))
}

fn gathered(name: &str, tie: Spider) -> MarkerRequest {
    MarkerRequest {
        axes: eng_flexible::markers::MESH_AXES,
        name: name.into(),
        place: MarkerPlace::Gathered {
            nodes: Selection::Set(name.into()),
            tie,
            center: None,
        },
    }
}

fn apart(found: &[f64], exact: &[f64]) -> f64 {
    support::apart(&found[..exact.len()], exact)
}

/// Held at `feet`, with static modes of the mean motions of the journals and twenty normal modes.
fn supported(model: &str, feet: &[&str]) -> (Reduced, Value) {
    let solutions = solutions(model);
    let journals: Vec<String> = solutions["flex_sets"]
        .as_array()
        .unwrap()
        .iter()
        .map(|name| name.as_str().unwrap().to_string())
        .collect();
    let mut markers: Vec<MarkerRequest> = journals
        .iter()
        .map(|name| gathered(name, Spider::Averaging))
        .collect();
    let support = (0..feet.len())
        .map(|foot| Interface {
            marker: journals.len() + foot,
            components: 0b11_1111,
        })
        .collect();
    markers.extend(feet.iter().map(|name| gathered(name, Spider::Rigid)));
    let at = (0..journals.len())
        .map(|marker| Interface {
            marker,
            components: 0b111,
        })
        .collect();
    let request = Request {
        rules: Rules::calculix(),
        markers,
        support,
        terms: vec![
            Term::Static(at),
            Term::Normal {
                modes: Modes::Count(20),
                fixed: vec![],
            },
        ],
        damping_up_to: 3000.0,
        asked: vec![Interface {
            marker: 1,
            components: 0b11_1111,
        }],
        ..Request::default()
    };
    (done(reduce(mesh(model), &request)), solutions)
}

fn check_supported(model: &str, feet: &[&str]) {
    let (reduced, solutions) = supported(model, feet);
    let report = &reduced.report;
    assert!(report.supported && report.warnings.is_empty());
    let frequencies = apart(
        &reduced.body.frequencies[..20],
        &list(&solutions["sup_freq_hz"]),
    );
    // mean displacements (m) under 1 kN spread over each set
    let n = reduced.body.invariants.modes;
    let exact: Vec<Vec<f64>> = solutions["flex_avg_disp_m_per_kN"]
        .as_array()
        .unwrap()
        .iter()
        .map(list)
        .collect();
    let rows: Vec<&[f64]> = reduced
        .body
        .markers
        .iter()
        .flat_map(|marker| marker.translation.chunks_exact(n))
        .take(exact.len())
        .collect();
    let stiffness = |mode: usize| reduced.body.invariants.stiffness[mode * n + mode];
    let largest = exact.iter().flatten().fold(0.0_f64, |w, x| w.max(x.abs()));
    let (mut worst, mut own) = (0.0_f64, 0.0_f64);
    for (i, (a, line)) in rows.iter().zip(&exact).enumerate() {
        for (j, (b, exact)) in rows.iter().zip(line).enumerate() {
            let found: f64 = (0..n).map(|k| 1e3 * a[k] * b[k] / stiffness(k)).sum();
            worst = worst.max((found - exact).abs() / largest);
            if i == j {
                own = own.max((found / exact - 1.0).abs());
            }
        }
    }
    println!(
        "{model}: supported {frequencies:.1e}, flexibility {worst:.1e}, of a journal itself {own:.1e}"
    );
    assert!(frequencies < 1e-8, "{frequencies:e}");
    assert!(worst < 1e-8 && own < 1e-8, "{worst:e} {own:e}");
    // the same again, as it was found
    for served in report.served.iter().filter(|served| served.component < 3) {
        let line = 3 * served.marker + usize::from(served.component);
        let flexibility = 1e3 * served.flexibility.unwrap();
        assert!(served.kept);
        assert!((flexibility / exact[line][line] - 1.0).abs() < 1e-8);
    }
    // translations are served, turning is not
    let unserved: Vec<&str> = report
        .unserved(1, 0b11_1111)
        .iter()
        .map(|load| load.label.as_str())
        .collect();
    let name = &reduced.body.markers[1].name;
    assert_eq!(unserved, ["rx", "ry", "rz"].map(|c| format!("{name}.{c}")));
    assert!(report.unserved(1, 0b111).is_empty());
    for load in &report.unserved {
        assert!(load.missing > 1e-3 && load.missing < 1.0, "{load:?}");
    }
    // effective masses: of each direction no more than the body's
    for axis in 0..6 {
        let sum: f64 = report
            .modes
            .iter()
            .map(|mode| mode.effective_mass[axis])
            .sum();
        let whole = match axis {
            0..3 => report.body.mass,
            _ => report.body.inertia[axis - 3][axis - 3],
        };
        println!("{model}: effective mass {axis}: {:.3} of all", sum / whole);
        assert!(sum > 0.5 * whole && sum < whole, "{axis}: {sum} {whole}");
    }
}

#[test]
fn the_crank_held_at_its_flange() {
    check_supported("crank_m", &["FLANGE"]);
}

#[test]
fn the_block_held_at_its_mounts() {
    check_supported("block_s", &["MOUNT1", "MOUNT2", "MOUNT3", "MOUNT4"]);
}

/// Craig and Bampton's set at ten freedoms of nodes, step by step.
fn check_craig_bampton(model: &str) {
    let solutions = solutions(model);
    let mesh = mesh(model);
    let full = done(assemble(&mesh, &Rules::calculix()));
    let reduction = done(Reduction::new(&mesh, &full, &[]));
    let stiffness = done(reduction.reduce_stiffness(&full.stiffness));
    let mass = done(reduction.reduce_mass(&full.mass));
    let motions = reduction.restrict(&rigid_motions(&mesh, &full.freedoms));
    let structure = done(Structure::free(&stiffness, &mass, motions));
    let index = mesh.node_index();
    let rows: Vec<Load> = solutions["cb_boundary"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pair| {
            let (node, freedom) = (pair[0].as_u64().unwrap(), pair[1].as_u64().unwrap());
            let full = full
                .freedoms
                .freedom(index[&node], freedom as u8 - 1)
                .unwrap();
            let (free, factors) = reduction.row(full);
            Load {
                label: format!("{node}.{freedom}"),
                entries: free.iter().copied().zip(factors.iter().copied()).collect(),
            }
        })
        .collect();
    let constraint = done(constraint_modes(&structure, &rows));
    let size = structure.size();
    let product = |operator: &dyn SymmetricOperator, x: &[f64]| {
        let mut y = vec![0.0; x.len()];
        operator.apply(x.len() / size, x, &mut y);
        y
    };
    for (matrix, name, tolerance) in [
        (&stiffness as &dyn SymmetricOperator, "cb_K_boundary", 1e-8),
        (&mass, "cb_M_boundary", 1e-8),
    ] {
        let image = product(matrix, &constraint);
        let exact: Vec<Vec<f64>> = solutions[name]
            .as_array()
            .unwrap()
            .iter()
            .map(list)
            .collect();
        let largest = exact.iter().flatten().fold(0.0_f64, |w, x| w.max(x.abs()));
        let mut worst = 0.0_f64;
        for (a, line) in constraint.chunks_exact(size).zip(&exact) {
            for (b, exact) in image.chunks_exact(size).zip(line) {
                let found: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
                worst = worst.max((found - exact).abs() / largest);
            }
        }
        println!("{model}: {name} {worst:.1e}");
        assert!(worst < tolerance, "{name}: {worst:e}");
    }
    let fixed = done(normal_modes(
        None,
        &structure,
        Modes::Count(20),
        &Boundary::Fixed(rows),
    ));
    let hertz: Vec<f64> = fixed
        .eigenvalues
        .iter()
        .map(|x| x.sqrt() / (2.0 * std::f64::consts::PI))
        .collect();
    let worst = apart(&hertz, &list(&solutions["cb_fixed_freq_hz"]));
    println!("{model}: fixed {worst:.1e}");
    assert!(worst < 1e-8, "{worst:e}");
    let candidates = constraint
        .chunks_exact(size)
        .chain(fixed.vectors.chunks_exact(size))
        .enumerate()
        .map(|(i, vector)| Candidate {
            label: i.to_string(),
            vector: vector.to_vec(),
            noise: 0.0,
        })
        .collect();
    let set = done(ModeSet::new(&structure, candidates));
    assert_eq!((set.len(), set.dropped.len()), (24, 6));
    let worst = apart(&set.frequencies(), &list(&solutions["cb_freq_hz"])[6..]);
    println!("{model}: Craig–Bampton {worst:.1e}");
    assert!(worst < 1e-8, "{worst:e}");
}

#[test]
fn the_crank_by_craig_and_bampton() {
    check_craig_bampton("crank_m");
}

#[test]
fn the_block_by_craig_and_bampton() {
    check_craig_bampton("block_s");
}

/// Mean motions of five collinear journals, x and y of each: the interface leaves axial motion and spin.
#[test]
fn the_crank_by_its_journals() {
    let markers: Vec<MarkerRequest> = (1..=5)
        .map(|j| gathered(&format!("MAIN{j}"), Spider::Averaging))
        .collect();
    let at: Vec<Interface> = (0..5)
        .map(|marker| Interface {
            marker,
            components: 0b110,
        })
        .collect();
    let set = |terms: Vec<Term>| {
        let request = Request {
            rules: Rules::calculix(),
            markers: markers.clone(),
            terms,
            damping_up_to: 3000.0,
            asked: at.clone(),
            ..Request::default()
        };
        done(reduce(mesh("crank_m"), &request))
    };
    let fixed = |count: usize| Term::Normal {
        modes: Modes::Count(count),
        fixed: at.clone(),
    };
    let free = list(&solutions("crank_m")["free_freq_hz"]);
    let body = set(vec![Term::Constraint(at.clone()), fixed(20)]);
    let report = &body.report;
    println!("{:?}", report.dropped);
    // four of ten constraint modes are rigid motions
    assert_eq!((report.modes.len(), report.dropped.len()), (26, 4));
    assert_eq!(report.sturm[0].count, 22);
    for (mode, (found, exact)) in body
        .body
        .frequencies
        .iter()
        .zip(&free[6..])
        .enumerate()
        .take(8)
    {
        let miss = found / exact - 1.0;
        println!(
            "{mode}: {found:.3} Hz, {miss:.1e}, {}",
            report.modes[mode].description
        );
        assert!(miss > -1e-9 && miss < 5e-3, "{mode}: {miss:e}");
    }
    let c = &body.body.invariants;
    for x in c.translation.iter().chain(&c.rotation) {
        assert!(x.abs() < 1e-9, "{x:e}");
    }
    let mass = report.estimate.unwrap();
    println!(
        "mass {} kg, between straight edges {} kg",
        report.body.mass, mass.mass
    );
    assert!((report.body.mass / mass.mass - 1.0).abs() < 1e-2);
}
