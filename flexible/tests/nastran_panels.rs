//! Shear panels of Nastran: stiffness by the formulas of NASTRAN-95, a web between two chords, sides that stretch, masses.

use std::f64::consts::PI;

use crate::nastran_deck::{mesh, problem};
use eng_flexible::mesh::Mesh;
use eng_flexible::reduce::{Request, Term, reduce};
use eng_flexible::solve::Modes;

/// A panel with E = 208 GPa, NU = 0.3 and the thickness 2 mm, so that G T = 1.6e8 N/m.
fn panel(corners: [[f64; 3]; 4], section: &str) -> Mesh {
    let mut deck =
        format!("CSHEAR,7,5,1,2,3,4\nPSHEAR,5,8,.002,{section}\nMAT1,8,2.08+11,,.3,7800.\n");
    for (i, [x, y, z]) in corners.into_iter().enumerate() {
        deck += &format!("GRID,{},,{x:?},{y:?},{z:?}\n", i + 1);
    }
    mesh(&deck)
}

/// The entry of the stiffness of the first spring.
fn entry(mesh: &Mesh, a: (u32, u8), b: (u32, u8)) -> f64 {
    let spring = &mesh.springs[0];
    let at = |(node, freedom): (u32, u8)| {
        let own = spring
            .terms
            .iter()
            .filter(|term| (term.0, term.1) == (node, freedom));
        own.map(|term| term.2).sum::<f64>()
    };
    spring.stiffness * at(a) * at(b)
}

/// The numbers are those of the four formulas of NASTRAN-95 (`mis/shears.f`), computed beside Eng: a rectangle, a
/// parallelogram, trapezoids with either pair of sides parallel, and quadrilaterals without parallel sides.
#[test]
fn stiffness_is_that_of_nastran() {
    for (x3, y3, x4, y4, x2, expected) in [
        (
            2.0,
            1.0,
            0.0,
            1.0,
            2.0,
            [80000000.0, 20000000.0, -40000000.0, 400000000.0],
        ),
        (
            2.5,
            1.0,
            0.5,
            1.0,
            2.0,
            [
                90277777.77777778,
                14444444.444444444,
                -36111111.11111111,
                303333333.3333333,
            ],
        ),
        (
            1.5,
            1.0,
            0.25,
            1.0,
            2.0,
            [
                50526315.78947367,
                22456140.350877192,
                -33684210.52631578,
                328421052.6315789,
            ],
        ),
        (
            2.0,
            1.5,
            0.0,
            0.5,
            2.0,
            [
                70909090.9090909,
                4431818.181818182,
                -17727272.727272727,
                372272727.27272725,
            ],
        ),
        (
            1.7,
            1.5,
            0.3,
            0.8,
            2.0,
            [
                51040068.22286398,
                6166727.336829773,
                -17741200.184417963,
                249581002.05241096,
            ],
        ),
        (
            2.2,
            1.0,
            -0.4,
            2.0,
            3.0,
            [
                13139726.096112533,
                19305382.694012884,
                -15926940.722560639,
                181904968.43433645,
            ],
        ),
    ] {
        let corners = [[0.0; 3], [x2, 0.0, 0.0], [x3, y3, 0.0], [x4, y4, 0.0]];
        let found = panel(corners, "");
        let trace = (0..4).flat_map(|node| (0..3).map(move |k| (node, k)));
        let own = [
            entry(&found, (0, 0), (0, 0)),
            entry(&found, (1, 1), (1, 1)),
            entry(&found, (0, 0), (1, 1)),
            trace.map(|freedom| entry(&found, freedom, freedom)).sum(),
        ];
        for (own, expected) in own.into_iter().zip(expected) {
            assert!((own / expected - 1.0).abs() < 1e-12, "{own} {expected}");
        }
    }
}

/// Rigid motions cost nothing, also where the panel is warped.
#[test]
fn a_warped_panel_resists_no_rigid_motion() {
    let corners = [[0.0; 3], [2.0, 0.1, 0.3], [1.7, 1.5, -0.1], [0.3, 0.8, 0.2]];
    let found = panel(corners, ",1.,.4");
    assert_eq!(found.springs.len(), 5);
    for spring in &found.springs {
        for axis in 0..3_usize {
            let (mut moved, mut turned) = (0.0, 0.0);
            for (node, freedom, factor) in &spring.terms {
                let [x, y, z] = corners[*node as usize];
                let turn = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]][axis];
                let freedom = usize::from(*freedom);
                moved += factor * if freedom == axis { 1.0 } else { 0.0 };
                turned += factor * turn[freedom];
            }
            assert!(
                moved.abs() < 1e-14 && turned.abs() < 1e-14,
                "{moved} {turned}"
            );
        }
    }
}

fn first_frequency(deck: &str) -> f64 {
    let request = Request {
        support_of_deck: true,
        terms: vec![Term::Normal {
            modes: Modes::Count(1),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    match reduce(mesh(deck), &request) {
        Ok(reduced) => reduced.body.frequencies[0],
        Err(error) => panic!("{error}"),
    }
}

/// A web of length L and height h between two chords of area A, clamped at one end, with a mass m at each corner of the
/// other. The corners sink by v, and the chords stretch by ±ξ: ½ G T L h (v/L − ξ/h)² + E A/L ξ².
#[test]
fn a_web_between_chords() {
    let (length, height, area, mass): (f64, f64, f64, f64) = (0.8, 0.5, 3e-4, 20.0);
    let deck = format!(
        "GRID,1,,0.,0.,0.,,123456
GRID,2,,{length},0.,0.,,3456
GRID,3,,{length},{height},0.,,3456
GRID,4,,0.,{height},0.,,123456
CSHEAR,7,5,1,2,3,4
PSHEAR,5,8,.002
MAT1,8,2.08+11,,.3,0.
CONROD,1,1,2,8,{area}
CONROD,2,4,3,8,{area}
CONROD,3,2,3,8,1.-3
CONM2,11,2,,{mass}
CONM2,12,3,,{mass}
"
    );
    let web = 1.6e8 * length * height;
    let chords = 2.0 * 2.08e11 * area / length;
    let [a, b, c]: [f64; 3] = [
        web / (length * length),
        -web / (length * height),
        web / (height * height) + chords,
    ];
    let smallest = 0.5 * (a + c - ((a - c) * (a - c) + 4.0 * b * b).sqrt());
    let expected = (smallest / (2.0 * mass)).sqrt() / (2.0 * PI);
    let found = first_frequency(&deck);
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
}

/// With F1 = 1 the panel stretches as a sheet of its height, E T h/L; with F1 = 30 each rod has the area 15 T².
#[test]
fn sides_stretch() {
    for (section, stiffness) in [
        (",1.", 2.08e11 * 0.002 * 0.5 / 0.8),
        (",30.", 2.0 * 2.08e11 * 15.0 * 0.002 * 0.002 / 0.8),
    ] {
        let deck = format!(
            "GRID,1,,0.,0.,0.,,123456
GRID,2,,.8,0.,0.,,23456
GRID,3,,.8,.5,0.,,23456
GRID,4,,0.,.5,0.,,123456
CSHEAR,7,5,1,2,3,4
PSHEAR,5,8,.002,{section}
MAT1,8,2.08+11,,.3,0.
CONM2,11,2,,6.
CONM2,12,3,,6.
RBE2,13,2,1,3
"
        );
        let expected = (stiffness / 12.0_f64).sqrt() / (2.0 * PI);
        let found = first_frequency(&deck);
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{section}: {found} {expected}"
        );
    }
}

/// NASTRAN-95 (`emastq.f`): each corner has a sixth of the area of the panel and of its own triangle.
#[test]
fn corners_share_the_mass() {
    let corners = [[0.0; 3], [2.0, 0.0, 0.0], [1.5, 1.0, 0.0], [0.25, 1.0, 0.0]];
    let found = panel(corners, "3.");
    let per_area = 7800.0 * 0.002 + 3.0;
    let area: f64 = 0.5 * (2.0 + 1.25);
    let triangles: [f64; 4] = [1.0, 1.0, 0.625, 0.625];
    let mut sum = 0.0;
    for (mass, triangle) in found.point_masses.iter().zip(triangles) {
        let expected = per_area * (area + triangle) / 6.0;
        assert!((mass.matrix[1][1] / expected - 1.0).abs() < 1e-14);
        assert_eq!(mass.matrix[4][4], 0.0);
        sum += mass.matrix[0][0];
    }
    assert!((sum / (per_area * area) - 1.0).abs() < 1e-14);
}

#[test]
fn wrong_panels_have_messages() {
    let grids = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\nGRID,9,,.2,.2,0.\nMAT1,8,2.+11,,.3\nMAT8,6,1.+11,1.+11,.3,4.+10\n";
    for (cards, message) in [
        (
            "PSHEAR,5,8,.1\nCSHEAR,1,5,1,2,9,4",
            "shear panel 1 has a corner of 180° or more",
        ),
        ("PSHEAR,5,8,.1\nCSHEAR,1,5,1,3,2,4", "crossed sides"),
        (
            "CSHEAR,1,5,1,2,3,4",
            "shear panel 1 uses property 5, which is missing",
        ),
        (
            "PSHEAR,5,6,.1\nCSHEAR,1,5,1,2,3,4",
            "the shear panel's material 6 is not isotropic",
        ),
        ("PSHEAR,5,8,0.\nCSHEAR,1,5,1,2,3,4", "T is not above zero"),
        (
            "PSHEAR,5,8,.1\nPSHEAR,5,8,.1",
            "property 5 of shear panels is defined twice",
        ),
    ] {
        let found = problem(&format!("{grids}{cards}\n"));
        assert!(found.problem.contains(message), "{found}");
        assert!(!found.advice.is_empty());
    }
}
