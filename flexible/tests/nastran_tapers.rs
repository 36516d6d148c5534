//! Tapered beams of Nastran: closed forms of one element, mass, frequencies of a cantilever by Ritz' method.

use std::f64::consts::PI;

use crate::nastran_deck::{mesh, problem};
use eng_flexible::fe::{Rules, form};
use eng_flexible::mesh::{Mesh, Section};
use eng_flexible::reduce::{Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;

fn reduced(mesh: Mesh, count: usize, held: bool) -> Reduced {
    let request = Request {
        support_of_deck: held,
        terms: vec![Term::Normal {
            modes: Modes::Count(count),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    match reduce(mesh, &request) {
        Ok(reduced) => reduced,
        Err(error) => panic!("{error}"),
    }
}

/// ∫₀¹ (1 − x)²/(1 + c x) dx, by division.
fn bent(c: f64) -> f64 {
    0.5 / c - 2.0 / c - 1.0 / (c * c) + (1.0 + 1.0 / c).powi(2) * (1.0 + c).ln() / c
}

/// One element between a wall and a mass of 5 kg: A falls from 4 to 1 cm², I1 from 8000 to 1000 mm⁴, J from 9000 to
/// 3000 mm⁴. E = 200 GPa, G = 80 GPa.
fn on_a_wall(held: &str, tip: &str, shear: &str) -> String {
    format!(
        "GRID,1,,0.,0.,0.,,123456
GRID,2,,1.,0.,0.,,{held}
CBEAM,1,5,1,2,0.,1.,0.
PBEAM,5,8,4.-4,8.-9,6.-9,,9.-9
,NO,1.,1.-4,1.-9,6.-9,,3.-9
,{shear}
MAT1,8,2.+11,8.+10,.25
{tip}
"
    )
}

#[test]
fn one_element_is_exact() {
    let gradient = |a: f64, b: f64| (b / a).ln() / (b - a);
    let bending = bent(-7.0 / 8.0) / (2e11 * 8e-9);
    let shear = gradient(4e-4, 1e-4) / (0.5 * 8e10);
    let mass = "CONM2,3,2,,5.";
    for (held, tip, sheared, flexibility) in [
        ("23456", mass, "0.,0.", gradient(4e-4, 1e-4) / 2e11),
        ("1345", mass, "0.,0.", bending),
        ("1345", mass, ".5,0.", bending + shear),
        ("1246", mass, "0.,0.", 1.0 / (3.0 * 2e11 * 6e-9)),
        (
            "12356",
            "CONM2,3,2,,1.,,,,,\n,5.",
            "0.,0.",
            gradient(9e-9, 3e-9) / 8e10,
        ),
    ] {
        let found = reduced(mesh(&on_a_wall(held, tip, sheared)), 1, true);
        let expected = (1.0 / (5.0 * flexibility)).sqrt() / (2.0 * PI);
        let ratio = found.body.frequencies[0] / expected;
        assert!((ratio - 1.0).abs() < 1e-9, "{held}: {ratio}");
    }
}

/// A section between the ends bends the law of the section. Two elements have the same law. Blank fields are linear
/// between the ends, and end B repeats those of end A.
#[test]
fn stations_between_the_ends() {
    let head = "GRID,1,,0.,0.,0.,,123456
GRID,2,,1.,0.,0.,,1345
GRID,9,,.4,0.,0.,,1345
MAT1,8,2.+11,8.+10,.25
CONM2,3,2,,5.
";
    let one = format!(
        "{head}SPC1,1,26,9
CBEAM,1,5,1,2,0.,1.,0.
PBEAM,5,8,4.-4,8.-9,6.-9,,9.-9
,NO,.4,3.-4,2.-9
,NO,1.,,4.-9
"
    );
    let two = format!(
        "{head}CBEAM,1,5,1,9,0.,1.,0.
CBEAM,2,6,9,2,0.,1.,0.
PBEAM,5,8,4.-4,8.-9,6.-9,,9.-9
,NO,1.,3.-4,2.-9
PBEAM,6,8,3.-4,2.-9,6.-9,,9.-9
,NO,1.,4.-4,4.-9
"
    );
    let [one, two] = [one, two].map(|deck| reduced(mesh(&deck), 1, true).body.frequencies[0]);
    assert!((one / two - 1.0).abs() < 1e-10, "{one} {two}");
}

#[test]
fn mass_centre_and_inertia() {
    let deck = "GRID,1,,0.,0.,0.
GRID,2,,2.,0.,0.
CBEAM,1,5,1,2,0.,1.,0.
PBEAM,5,8,4.-4,8.-9,8.-9,,9.-9,1.
,NO,1.,1.-4,2.-9,2.-9,,3.-9,3.
MAT1,8,2.+11,8.+10,.25,7800.
";
    let found = reduced(mesh(deck), 1, false);
    let (a, b) = (7800.0 * 4e-4 + 1.0, 7800.0 * 1e-4 + 3.0);
    let mass = a + b;
    let centre = 4.0 * (a + 2.0 * b) / 6.0 / mass;
    let second = 8.0 * (a + 3.0 * b) / 12.0 - mass * centre * centre;
    // rotary inertia of the sections
    let inertia = second + 7800.0 * 1e-8;
    let report = &found.report.body;
    assert!((report.mass / mass - 1.0).abs() < 1e-12);
    assert!((report.centre[0] / centre - 1.0).abs() < 1e-12);
    assert!(
        (report.inertia[1][1] / inertia - 1.0).abs() < 1e-10,
        "{:?}",
        report.inertia
    );
}

/// A cantilever of equal elements, A and I1 linear along it, with rotary inertia: three frequencies.
fn cantilever(count: u32) -> Vec<f64> {
    let mut deck =
        String::from("MAT1,8,2.+11,8.+10,.25,7800.\nGRDSET,,,,,,,1345\nGRID,1,,0.,0.,0.,,123456\n");
    for i in 1..=count {
        let [from, to] = [i - 1, i].map(|k| f64::from(k) / f64::from(count));
        let area = |x: f64| 4e-4 - 3e-4 * x;
        let moment = |x: f64| 8e-9 - 7e-9 * x;
        deck += &format!(
            "GRID,{},,{to},0.,0.\nCBEAM,{i},{i},{i},{},0.,1.,0.\nPBEAM,{i},8,{:.8},{:.16},1.-8,,1.-8\n,NO,1.,{:.8},{:.16}\n,0.,0.\n",
            i + 1,
            i + 1,
            area(from),
            moment(from),
            area(to),
            moment(to),
        );
    }
    let mesh = mesh(&deck);
    assert!(matches!(mesh.properties[0].section, Section::Tapered(0)));
    reduced(mesh, 3, true).body.frequencies
}

/// The exact numbers are those of Ritz' method with 16 polynomials, computed beside Eng. The error falls with the fourth
/// power of the length of the elements.
#[test]
fn frequencies_of_a_tapered_cantilever() {
    let (coarse, fine) = (cantilever(8), cantilever(16));
    for ((coarse, fine), exact) in coarse
        .iter()
        .zip(&fine)
        .zip([18.2047339, 86.0724695, 219.212675])
    {
        let [coarse, fine] = [coarse, fine].map(|own| own / exact - 1.0);
        assert!(
            coarse > 0.0 && coarse < 1e-3 && fine < coarse / 12.0,
            "{coarse} {fine}"
        );
    }
}

/// The zero of a linear section is near the end: a second moment that falls to a ten thousandth.
#[test]
fn steep_tapers_are_exact() {
    let deck =
        on_a_wall("1345", "CONM2,3,2,,5.", "0.,0.").replace("1.-9,6.-9,,3.-9", "8.-13,6.-9,,3.-9");
    let flexibility = bent(1e-4 - 1.0) / (2e11 * 8e-9);
    let expected = (1.0 / (5.0 * flexibility)).sqrt() / (2.0 * PI);
    let ratio = reduced(mesh(&deck), 1, true).body.frequencies[0] / expected;
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
}

#[test]
fn the_lumped_mass_of_a_taper_is_not_public() {
    let found =
        form::warnings(&mesh(&on_a_wall("1345", "", "0.,0.")), &Rules::nastran()).join("\n");
    assert!(
        found.contains("1 × CBEAM with a taper have a consistent mass"),
        "{found}"
    );
}

#[test]
fn wrong_tapers_have_messages() {
    let head = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nMAT1,8,2.+11,,.3\nCBEAM,1,5,1,2,0.,1.,0.\n";
    for (card, message) in [
        (
            "PBEAM,5,8,4.-4,8.-9,6.-9\n,NO,.5,1.-4",
            "the last station is at X/XB = 0.5",
        ),
        (
            "PBEAM,5,8,4.-4,8.-9,6.-9\n,NO,.5,1.-4\n,NO,.5,2.-4\n,NO,1.",
            "two stations are at X/XB = 0.5",
        ),
        (
            "PBEAM,5,8,4.-4,8.-9,6.-9\n,NO,0.,1.-4\n,NO,1.",
            "two stations are at X/XB = 0",
        ),
    ] {
        let found = problem(&format!("{head}{card}\n"));
        assert!(found.problem.contains(message), "{found}");
        assert!(!found.advice.is_empty());
    }
    let vanishing = format!("{head}PBEAM,5,8,4.-4,8.-9,6.-9,,1.-9\n,NO,1.,1.-4,0.\n");
    let error = match reduce(mesh(&vanishing), &Request::default()) {
        Err(error) => error.to_string(),
        Ok(_) => String::new(),
    };
    assert!(error.contains("vanishes at one of its stations"), "{error}");
}
