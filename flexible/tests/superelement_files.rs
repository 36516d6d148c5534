//! External superelements as NX Nastran wrote them (`EXTSEOUT(ASMBULK, EXTBULK, MATOP4)`), against what the same runs
//! printed. The files are tests of pyYeti (BSD licence, `tests/data/superelements/LICENSE.txt`): a frame of four feet
//! with eight modal freedoms, and a tower on it with 22.

use crate::fe_meshes::agrees;
use crate::support::Data;
use eng_flexible::FlexibleError;
use eng_flexible::foreign::{ForeignMatrices, MatrixFile};
use eng_flexible::markers::{MESH_AXES, MarkerPlace, MarkerRequest};
use eng_flexible::mesh::Mesh;
use eng_flexible::read::matrix::MatrixFormat;
use eng_flexible::read::nastran::read_bulk;
use eng_flexible::reduce::{Interface, Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_system::mesh_files::Stated as _;

const DATA: Data = Data("superelements");

fn mesh(name: &str) -> Mesh {
    read_bulk(&DATA, &format!("{name}.pch")).unwrap_or_else(|error| panic!("{error}"))
}

fn matrices(name: &str, of_mass: &str) -> Result<ForeignMatrices, FlexibleError> {
    let [stiffness, mass] = [(name, "KXX"), (of_mass, "MXX")];
    let [stiffness_file, mass_file] = [stiffness.0, mass.0].map(|name| format!("{name}.op4"));
    let file = |file, name| MatrixFile {
        file,
        format: MatrixFormat::Op4,
        name,
        freedoms: None,
    };
    ForeignMatrices::read(
        &DATA,
        file(&stiffness_file, stiffness.1),
        file(&mass_file, mass.1),
        None,
        MeshUnits::named("m_kg_s").unwrap(),
    )
}

/// The lowest modes, free or with the feet held.
fn reduced(name: &str, count: usize, held: bool) -> Result<Reduced, FlexibleError> {
    let feet = [3, 11, 19, 27];
    reduce(
        mesh(name),
        &Request {
            markers: (feet.iter())
                .map(|id| MarkerRequest {
                    axes: MESH_AXES,
                    name: format!("foot {id}"),
                    place: MarkerPlace::Node(*id),
                })
                .collect(),
            support: (0..feet.len())
                .filter(|_| held)
                .map(|marker| Interface {
                    marker,
                    components: 0b11_1111,
                })
                .collect(),
            terms: vec![Term::Normal {
                modes: Modes::Count(count),
                fixed: Vec::new(),
            }],
            matrices: Some(matrices(name, name)?),
            damping_ratio: 0.01,
            damping_up_to: f64::INFINITY,
            ..Request::default()
        },
    )
}

fn done(result: Result<Reduced, FlexibleError>) -> Reduced {
    result.unwrap_or_else(|error| panic!("{error} ({})", error.advice()))
}

/// With its feet held, a superelement has the frequencies of its component modes, which Nastran prints after it has
/// added residual vectors: seven digits.
#[test]
fn held_feet_give_the_printed_frequencies() {
    for (name, printed) in [
        (
            "inboard",
            &[
                6.129345, 6.130134, 23.63188, 70.47544, 70.78510, 104.6654, 188.0354, 208.5971,
            ][..],
        ),
        (
            "outboard",
            &[
                1.650001, 1.650249, 1.674265, 1.674687, 7.025350, 7.025411, 10.91274, 10.91454,
                13.98578, 13.99172, 25.13473, 25.13995, 42.17271, 42.19338, 46.71595, 46.89473,
                69.17287, 87.50436, 110.8525, 139.2356, 152.2261, 472.6243,
            ],
        ),
    ] {
        let found = done(reduced(name, printed.len(), true)).body.frequencies;
        assert_eq!(found.len(), printed.len());
        for (own, nastran) in found.iter().zip(printed) {
            assert!(agrees(*own, *nastran, 1e-6), "{name}: {own} {nastran}");
        }
    }
}

/// The mass, its centre and its inertia about it are those that Nastran's weight check prints. It prints products of
/// inertia with the sign that the tensor has not.
#[test]
fn a_free_superelement_has_the_printed_weight() {
    let found = done(reduced("outboard", 6, false));
    let constants = &found.body.invariants;
    let mass = constants.mass;
    assert!(agrees(mass, 1.590384, 1e-6), "{mass}");
    let centre = constants.first_moment.map(|moment| moment / mass);
    for (own, nastran) in centre.into_iter().zip([184.6398, 150.0, 150.0]) {
        assert!(agrees(own, nastran, 1e-6), "{own} {nastran}");
    }
    let [x, y, z] = centre;
    let squares = [y * y + z * z, x * x + z * z, x * x + y * y];
    let moments = [3.569328e5, 4.515897e4, 3.763282e5];
    for (i, (arm, nastran)) in squares.into_iter().zip(moments).enumerate() {
        let own = constants.inertia[i][i] - mass * arm;
        assert!(agrees(own, nastran, 1e-6), "{own} {nastran}");
    }
    let product = constants.inertia[1][2] + mass * y * z;
    assert!(agrees(product, -1.095583e2, 1e-5), "{product}");
    let warning = "its 22 modal freedoms have no place";
    let told = &found.report.warnings;
    assert!(told.iter().any(|text| text.contains(warning)), "{told:?}");
}

/// Matrices of another part, of other rows than the grid points, or under another name are refused.
#[test]
fn superelements_that_do_not_belong_together_are_refused() {
    let with = |name: &str, of_mass: &str| -> String {
        let result = matrices(name, of_mass).and_then(|matrices| {
            reduce(
                mesh("inboard"),
                &Request {
                    terms: vec![Term::Normal {
                        modes: Modes::Count(4),
                        fixed: Vec::new(),
                    }],
                    matrices: Some(matrices),
                    damping_ratio: 0.01,
                    damping_up_to: f64::INFINITY,
                    ..Request::default()
                },
            )
        });
        match result {
            Err(error) => format!("{error} ({})", error.advice()),
            Ok(_) => panic!("{name} and {of_mass} are read"),
        }
    };
    for (name, of_mass) in [("inboard", "outboard"), ("outboard", "outboard")] {
        let told = with(name, of_mass);
        println!("{told}");
        assert!(told.contains("46"), "{told}");
    }
}
