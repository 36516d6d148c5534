//! The paper's engine: its table 1 against the whole finite-element model. docs/validation.md has the numbers.

use crate::support::column;
use eng::{Program, Sources};
use eng_flexible::store::StoredBody;
use eng_system::reduced::ReducedBody;
use nalgebra::{DMatrix, DVector};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Reductions of this run: none that an older program made.
fn cache() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("paper_reductions");
        if folder.exists() {
            std::fs::remove_dir_all(&folder).expect("an old cache goes");
        }
        folder
    })
}

fn program(file: &str) -> Program {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/paper");
    let sources = Sources::folder(folder)
        .expect("the example's folder")
        .with_cache(cache());
    eng::check(&sources, file)
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
}

fn reference() -> Value {
    serde_json::from_str(include_str!("../examples/paper/mesh/reference.json")).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// The one body that is kept and has these markers.
fn kept(has: impl Fn(&ReducedBody) -> bool) -> ReducedBody {
    let mut found: Vec<ReducedBody> = std::fs::read_dir(cache())
        .expect("the cache")
        .map(|entry| entry.expect("an entry").path())
        // beside them are files that another test is writing
        .filter(|path| path.extension().is_some_and(|e| e == "reduced"))
        .map(|path| std::fs::read(path).expect("a kept body"))
        .map(|bytes| StoredBody::from_bytes(&bytes).expect("a whole body").body)
        .filter(has)
        .collect();
    assert_eq!(found.len(), 1);
    found.remove(0)
}

/// How a freedom of a marker (x y z rx ry rz at rest) moves with the six rigid motions of the frame and the modes.
fn row(body: &ReducedBody, marker: &str, freedom: usize) -> DVector<f64> {
    let n = body.invariants.modes;
    let marker = body
        .markers
        .iter()
        .find(|m| m.name == marker)
        .unwrap_or_else(|| panic!("no marker {marker}"));
    let mut row = DVector::zeros(6 + n);
    let k = freedom % 3;
    row[freedom] = 1.0;
    let shapes = if freedom < 3 {
        // θ × s along e_k is θ · (s × e_k)
        let mut axis = nalgebra::Vector3::zeros();
        axis[k] = 1.0;
        let lever = nalgebra::Vector3::from(marker.position).cross(&axis);
        row.rows_mut(3, 3).copy_from(&lever);
        &marker.translation
    } else {
        &marker.rotation
    };
    row.rows_mut(6, n)
        .copy_from_slice(&shapes[k * n..(k + 1) * n]);
    row
}

/// The reduced crank on springs, linear: displacements of the markers under the loads of the paper's kind.
#[test]
fn table_1_reduced_against_whole_finite_element_model() {
    let model = program("statics.eng")
        .model("CrankOnSprings")
        .expect("a model");
    assert_eq!(model.reductions().len(), 1);
    let crank =
        kept(|body| body.markers.iter().any(|m| m.name == "pin[4]") && body.invariants.modes == 20);
    let n = crank.invariants.modes;
    let springs = &reference()["crank"]["on_springs"];
    let radial = number(&springs["radial_n_per_m"]);
    let mut held: Vec<(String, usize, f64)> = (1..=5)
        .flat_map(|j| [0, 1].map(|k| (format!("main[{j}]"), k, radial)))
        .collect();
    held.push(("main[3]".into(), 2, number(&springs["axial_n_per_m"])));
    held.push(("flange".into(), 5, number(&springs["torsion_n_m_per_rad"])));
    let mut stiffness = DMatrix::zeros(6 + n, 6 + n);
    stiffness
        .view_mut((6, 6), (n, n))
        .copy_from(&DMatrix::from_row_slice(n, n, &crank.invariants.stiffness));
    for (marker, freedom, k) in &held {
        let row = row(&crank, marker, *freedom);
        stiffness += *k * &row * row.transpose();
    }
    let stiffness = stiffness.lu();
    for (name, case) in springs["cases"].as_object().expect("cases") {
        let mut load = DVector::zeros(6 + n);
        for (i, force) in case["pin_forces_n"]
            .as_array()
            .expect("pins")
            .iter()
            .enumerate()
        {
            for k in 0..2 {
                load += number(&force[k]) * row(&crank, &format!("pin[{}]", i + 1), k);
            }
        }
        let motion = stiffness.solve(&load).expect("held");
        let places = &case["main_m"];
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for j in 0..5 {
            for k in 0..3 {
                let exact = number(&places[j][k]);
                let found = row(&crank, &format!("main[{}]", j + 1), k).dot(&motion);
                worst = worst.max((found - exact).abs());
                largest = largest.max(exact.abs());
            }
        }
        println!(
            "{name}: {:.1e} of the largest displacement",
            worst / largest
        );
        assert!(worst < 1e-8 * largest, "{name}: {:e}", worst / largest);
        let turn = row(&crank, "flange", 5).dot(&motion);
        let exact = number(&case["flange_turn_rad"]);
        assert!(
            (turn - exact).abs() < 1e-8 * largest / 0.043,
            "{turn} {exact}"
        );
    }
}

/// Error of each journal (of the length of the displacement), and the largest displacement of all, at a share
/// of the load.
fn at_rest(program: &Program, case: &str, share: f64) -> ([f64; 5], f64) {
    let plan = program.analysis(case).expect("an analysis");
    let parameter = plan.model().parameter("share").expect("a parameter");
    let plan = plan
        .set(parameter, eng::Quantity::si(share, eng::Dimension::ONE))
        .expect("a number");
    let results = plan
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error))
        .results;
    let case = &reference()["crank"]["on_springs"]["cases"][case];
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let largest = (0..5)
        .map(|j| length([0, 1, 2].map(|k| number(&case["main_m"][j][k]))))
        .fold(0.0_f64, f64::max);
    let errors = [1, 2, 3, 4, 5].map(|j| {
        let exact = [0, 1, 2].map(|k| number(&case["main_m"][j - 1][k]));
        let found = ["x", "y", "z"].map(|axis| {
            let values = column(&results, &format!("place[{j}].{axis}"));
            let (last, before) = (values[values.len() - 1], values[values.len() - 2]);
            assert!(
                (last - before).abs() < 1e-9 * share * largest,
                "{j} moves: {before} {last}"
            );
            last / share
        });
        length([0, 1, 2].map(|k| found[k] - exact[k])) / largest
    });
    (errors, largest)
}

/// The multibody model at rest against the linear finite-element model, as a share of the case's largest
/// displacement, because a journal that hardly moves gives no scale. They differ by geometry alone: with a tenth of
/// the load the difference is a tenth. The paper has 0.054 to 0.006 % of each journal's own displacement.
#[test]
fn table_1_multibody_model_at_rest_on_springs() {
    let program = program("statics.eng");
    for case in ["dead_centre", "pin_1_across", "mixed"] {
        let (whole, largest) = at_rest(&program, case, 1.0);
        let (tenth, _) = at_rest(&program, case, 0.1);
        let percent = |errors: [f64; 5]| errors.map(|e| format!("{:.1e} %", 100.0 * e)).join(", ");
        println!(
            "{case}: up to {:.2} um; {}; a tenth of the load {}",
            1e6 * largest,
            percent(whole),
            percent(tenth)
        );
        for (w, t) in whole.iter().zip(&tenth) {
            // the paper's worst
            assert!(*w < 5.4e-4, "{case}: {whole:?}");
            assert!(*t < 0.11 * w + 1e-8, "{case}: {whole:?} {tenth:?}");
        }
    }
}
