//! The weight check of Nastran in comments of a deck: its mass and centre stand beside those of the body.

use std::fmt::Write as _;

use crate::nastran_deck;
use eng_flexible::mesh::Mesh;
use eng_flexible::reduce::{Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_system::mesh_files::Stated as _;

/// A cube of 20 mm and 7.85e-9 t/mm³ with a corner at (100, 0, 0), after comments.
fn cube(comments: &str) -> Mesh {
    let mut deck =
        format!("{comments}MAT1,1,2.1+5,,.3,7.85-9\nPSOLID,1,1\nCHEXA,1,1,1,2,3,4,5,6,+\n+,7,8\n");
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]];
    let above = corners.map(|[x, y, _]| [x, y, 1]);
    for ([x, y, z], id) in corners.into_iter().chain(above).zip(1..) {
        writeln!(deck, "GRID,{id},,{}.,{}.,{}.", 100 + 20 * x, 20 * y, 20 * z).unwrap();
    }
    nastran_deck::mesh(&deck)
}

/// The table as Nastran prints it, in comments.
fn table(reference: &str, masses: [&str; 3], centre: [&str; 3]) -> String {
    let [x, y, z] = centre;
    format!(
        "$       O U T P U T   F R O M   G R I D   P O I N T   W E I G H T   G E N E R A T O R\n\
         ${reference}\n$                                    M O\n\
         $ *  6.280000E-05  0.000000E+00  0.000000E+00  0.000000E+00  6.280000E-04 -6.280000E-04 *\n\
         $                               DIRECTION\n\
         $                          MASS AXIS SYSTEM (S)     MASS              X-C.G.        Y-C.G.        Z-C.G.\n\
         $                                  X            {}      1.000000E-17  {y}  {z}\n\
         $                                  Y            {}      {x}  0.000000E+00  {z}\n\
         $                                  Z            {}      {x}  {y} -1.000000E-18\n\
         $                                            I(S)\n",
        masses[0], masses[1], masses[2]
    )
}

const MASS: [&str; 3] = ["6.280000E-05"; 3];
const CENTRE: [&str; 3] = ["1.100000E+02", "1.000000E+01", "1.000000E+01"];

#[test]
fn the_check_is_that_of_the_body() {
    let reference = "0            REFERENCE POINT =        0";
    let mut mesh = cube(&table(reference, MASS, CENTRE));
    let check = mesh.weight_check.clone().unwrap();
    assert_eq!(
        (check.mass, check.centre),
        (6.28e-5, Some([110.0, 10.0, 10.0]))
    );
    assert_eq!(check.place, ("deck.bdf".into(), 6));
    mesh.convert(&MeshUnits::named("mm_tonne_s").unwrap());
    let request = Request {
        terms: vec![Term::Normal {
            modes: Modes::Count(1),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    let report = reduce(mesh, &request).unwrap().report;
    let check = report.weight_check.unwrap();
    assert!(
        (check.mass / report.body.mass - 1.0).abs() < 1e-12,
        "{check:?}"
    );
    for (own, exact) in check.centre.unwrap().iter().zip(report.body.centre) {
        assert!((own - exact).abs() < 1e-12, "{check:?}");
    }
}

#[test]
fn the_centre_refers_to_a_grid_point() {
    let reference = |point: u32| format!("0            REFERENCE POINT =        {point}");
    let relative = ["1.000000E+01", "-1.000000E+01", "-1.000000E+01"];
    // grid point 7 is at (120, 20, 20)
    let from = |x: &str| cube(&table(&reference(7), MASS, [x, relative[1], relative[2]]));
    let check = from("-1.000000E+01").weight_check.unwrap();
    assert_eq!(check.centre, Some([110.0, 10.0, 10.0]));
    // a grid point that the deck does not have
    let check = cube(&table(&reference(70), MASS, CENTRE))
        .weight_check
        .unwrap();
    assert_eq!((check.mass, check.centre), (6.28e-5, None));
    // the mass before its scale
    let scaled = cube(&(table(&reference(0), MASS, CENTRE) + "PARAM,WTMASS,.5\n"));
    assert_eq!(scaled.weight_check.unwrap().mass, 3.14e-5);
}

#[test]
fn other_tables_are_no_check() {
    let reference = "0            REFERENCE POINT =        0";
    let whole = table(reference, MASS, CENTRE);
    for comments in [
        String::new(),
        // a mass that differs by direction
        table(
            reference,
            ["6.280000E-05", "6.280000E-05", "6.300000E-05"],
            CENTRE,
        ),
        // a row is missing, is no number, or is in another place
        whole.replace("$                                  Y ", "$  "),
        whole.replace("1.100000E+02", "********"),
        whole.replace("  Z            6", "  W            6"),
        table("", MASS, CENTRE),
        table(reference, ["0.000000E+00"; 3], CENTRE),
    ] {
        assert_eq!(cube(&comments).weight_check, None, "{comments}");
    }
}
