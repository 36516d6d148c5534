//! Non-structural mass of Nastran: masses of the elements, by hand.

use crate::nastran_deck::{mesh, problem, unread};
use eng_flexible::fe::volume::estimate;
use eng_flexible::mesh::{Carries, Mesh, Section};

/// A square shell of 2 m, a triangle of 2 m² with a laminate, a bar and a beam of 2 m, a tapered beam of 2 m, a rod of 2 m,
/// and a CONROD of 2 m, all without a mass of their own.
const HEAD: &str = "GRID,1,,0.,0.,0.
GRID,2,,2.,0.,0.
GRID,3,,2.,2.,0.
GRID,4,,0.,2.,0.
MAT1,8,2.+11,,.3
CQUAD4,1,1,1,2,3,4
PSHELL,1,8,.1
CTRIA3,2,2,1,2,3
PCOMP,2\n,8,.1
CBAR,3,3,1,2,0.,1.,0.
PBARL,3,8,,ROD\n,.1
CBEAM,4,4,1,2,0.,1.,0.
PBEAM,4,8,1.,1.,1.
CBEAM,5,5,1,2,0.,1.,0.
PBEAM,5,8,1.,1.,1.,,1.\n,NO,1.,2.\n
CROD,6,6,1,2
PROD,6,8,1.
CONROD,7,1,2,8,1.
";

fn mass(mesh: &Mesh) -> f64 {
    estimate(mesh).map_or(0.0, |body| body.mass)
}

#[test]
fn masses_of_all_entries() {
    for (card, expected) in [
        ("NSM,3,PSHELL,1,.5,2,.25", 4.0 * 0.5 + 2.0 * 0.25),
        ("NSM1,3,PCOMP,.5,ALL", 6.0 * 0.5),
        ("NSM1,3,ELEMENT,.5,1,THRU,2", 6.0 * 0.5),
        ("NSM1,3,PBAR,.5,ALL", 2.0 * 0.5),
        ("NSM1,3,PBEAML,.5,ALL", 4.0 * 0.5),
        ("NSM1,3,PROD,.5,6", 2.0 * 0.5),
        ("NSM1,3,CONROD,.5,7", 2.0 * 0.5),
        // numbers that no element has are ignored
        ("NSM1,3,ELEMENT,.5,3,99", 2.0 * 0.5),
        ("NSML1,3,PSHELL,7.,ALL", 7.0),
        ("NSML1,3,ELEMENT,7.,3,4,5", 7.0),
        ("NSML,3,PSHELL,1,7.,2,5.", 12.0),
        ("NSM1,3,PBAR,.5,ALL\nNSM1,3,PBAR,.25,3", 2.0 * 0.75),
        ("PARAM,WTMASS,.1\nNSM1,3,PBAR,.5,ALL", 0.1),
    ] {
        let own = mass(&mesh(&format!("{HEAD}{card}\n")));
        assert!((own / expected - 1.0).abs() < 1e-12, "{card}: {own}");
    }
}

/// A mass is shared by the areas, so each square metre has as much.
#[test]
fn a_mass_is_shared_by_area() {
    let shared = mesh(&format!("{HEAD}NSML1,3,PSHELL,12.,ALL\n"));
    let mut shells = 0;
    for property in &shared.properties {
        if let Section::Shell(section) = property.section {
            assert!((section.mass_per_area - 2.0).abs() < 1e-12, "{section:?}");
            shells += 1;
        }
    }
    assert_eq!(shells, 2);
}

/// Case control selects a set, or a sum of sets; without it Nastran uses none.
#[test]
fn sets_are_selected() {
    let deck = |control: &str| {
        format!(
            "SOL 103\nCEND\n{control}\nBEGIN BULK\n{HEAD}NSM1,3,PBAR,.5,ALL\nNSM1,4,PROD,.5,ALL\nNSMADD,9,3,4\n"
        )
    };
    assert!((mass(&mesh(&deck("NSM = 3"))) - 1.0).abs() < 1e-12);
    assert!((mass(&mesh(&deck("NSM = 9"))) - 2.0).abs() < 1e-12);
    let none = mesh(&deck("METHOD = 1"));
    assert_eq!(mass(&none), 0.0);
    assert!(
        none.doubts[0].contains("no NSM = in case control selects"),
        "{:?}",
        none.doubts
    );
}

#[test]
fn wrong_masses_have_messages() {
    for (cards, message) in [
        (
            "NSM1,3,PBEND,.5,ALL",
            "TYPE is \"PBEND\", and Eng adds no mass to it",
        ),
        (
            "NSM1,3,PBAR,.5,ALL\nNSM1,4,PBAR,.5,ALL",
            "several sets of non-structural mass",
        ),
        (
            "NSML1,3,PBAR,.5,99",
            "the mass is that of no element of the deck",
        ),
        (
            "NSML1,3,PBAR,.5,3,3",
            "the list of the mass has 3 more than once",
        ),
        (
            "NSM1,3,ELEMENT,.5,1,THRU,3",
            "one value for shells and for lines",
        ),
    ] {
        let found = problem(&format!("{HEAD}{cards}\n"));
        assert!(found.problem.contains(message), "{found}");
        assert!(!found.advice.is_empty());
    }
    let missing = problem(&format!(
        "CEND\nNSM = 7\nBEGIN BULK\n{HEAD}NSM1,3,PBAR,.5,ALL\n"
    ));
    assert!(
        missing
            .problem
            .contains("NSM = 7 selects a set that is missing"),
        "{missing}"
    );
    // the centroid beside the nodes
    let beside = mesh(&format!(
        "{HEAD}CBEAM,8,8,1,2,0.,1.,0.\nPBEAM,8,8,1.,1.,1.\n,,,,,,,,\n,1.,1.,,,,,,\n,,,,,.1,.1,.1,.1\nNSM1,3,PBEAM,.5,8\n"
    ));
    assert!(
        unread(&beside)
            .iter()
            .any(|own| own.2 == Carries::Structure),
        "{:?}",
        unread(&beside)
    );
}
