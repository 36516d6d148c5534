//! The lumped masses of Nastran: frequencies that MSC Nastran and MYSTRAN print, and shares by hand.

use crate::nastran_deck::{mesh, problem};
use crate::support::apart;
use eng_flexible::FlexibleError;
use eng_flexible::fe::{Rules, assemble, form};
use eng_flexible::mesh::Mesh;
use eng_flexible::reduce::{Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_system::mesh_files::Stated as _;

/// Frequencies (Hz) of a deck, held at its own supports.
fn frequencies(mesh: Mesh, rules: Rules, count: usize) -> Vec<f64> {
    let request = Request {
        rules,
        support_of_deck: true,
        terms: vec![Term::Normal {
            modes: Modes::Count(count),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    match reduce(mesh, &request) {
        Ok(reduced) => reduced.body.frequencies,
        Err(error) => panic!("{error}"),
    }
}

/// One box of sides 1, 2, 3 m with density 5 and shells of area 2 m², thickness 0.1 m.
const BOX: &str = "GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,1.,2.,0.
GRID,4,,0.,2.,0.
GRID,5,,0.,0.,3.
GRID,6,,1.,0.,3.
GRID,7,,1.,2.,3.
GRID,8,,0.,2.,3.
MAT1,8,2.1+11,,.3,5.
PSOLID,3,8
PSHELL,4,8,.1,8,,8
";

/// The share of each node, by MYSTRAN's `HEXA.f90`, `TETRA.f90`, `QDEL1.f90` and `TREL1.f90`.
#[test]
fn nodes_share_a_mass_equally() {
    for (cards, nodes, mass) in [
        ("CHEXA,1,3,1,2,3,4,5,6,\n,7,8", 8, 30.0),
        // a wedge and a tetrahedron that are not boxes
        ("CPENTA,1,3,1,2,3,5,6,7", 6, 15.0),
        ("CTETRA,1,3,1,2,3,5", 4, 5.0),
        ("CQUAD4,1,4,1,2,3,4", 4, 1.0),
        ("CTRIA3,1,4,1,2,3", 3, 0.5),
        ("CBAR,1,5,1,2,0.,0.,1.\nPBAR,5,8,2.,1.,1.,1.", 2, 10.0),
    ] {
        let mesh = mesh(&format!("{BOX}{cards}\n"));
        let structure = assemble(&mesh, &Rules::nastran()).unwrap();
        let matrix = structure.mass.assembled().unwrap();
        let mut masses = 0;
        for column in 0..matrix.size() {
            let (rows, values) = matrix.column(column);
            let (_, component) = structure.freedoms.owner(column).unwrap();
            for (row, value) in rows.iter().zip(values) {
                let expected = match *row as usize == column && component < 3 {
                    true => mass / f64::from(nodes),
                    false => 0.0,
                };
                assert!(
                    (value - expected).abs() < 1e-12,
                    "{cards}: {value} {expected}"
                );
                masses += i32::from(*value > 1e-12);
            }
        }
        assert_eq!(masses, 3 * nodes, "{cards}");
        assert!(
            form::warnings(&mesh, &Rules::nastran())
                .iter()
                .all(|w| !w.contains("lumped"))
        );
    }
    // not without a message
    let cards = "CTETRA,1,3,1,2,3,5,,9\nGRID,9,,.5,1.,0.\n";
    let solid = mesh(&format!("{BOX}{cards}"));
    let told = form::warnings(&solid, &Rules::nastran()).join("\n");
    assert!(
        told.contains("1 × CTETRA (10 nodes) have a consistent mass"),
        "{told}"
    );
    let coupled = mesh(&format!("{BOX}{cards}PARAM,COUPMASS,1\n"));
    assert!(
        !form::warnings(&coupled, &Rules::nastran())
            .join("\n")
            .contains("consistent")
    );
}

/// `BAR-CC-GIV` of MYSTRAN's tests, a plane cantilever of four CBAR.
const CANTILEVER: &str = "GRDSET,,,,,,,1246
GRID,1,,0.,0.,0.
GRID,2,,25.,0.,0.
GRID,3,,50.,0.,0.
GRID,4,,75.,0.,0.
GRID,5,,100.,0.,0.
CBAR,102,25,1,2,0.,0.,1.
CBAR,203,25,2,3,0.,0.,1.
CBAR,304,25,3,4,0.,0.,1.
CBAR,405,25,4,5,0.,0.,1.
PBAR,25,20,.1,.1,.1,.1
MAT1,20,10.+06,,.3,.1
SPC1,1,35,1
PARAM,WTMASS,.002591
";

/// MYSTRAN prints seven digits.
#[test]
fn bars_have_the_frequencies_of_mystran() {
    let printed = [10.68719, 62.81653, 166.3460, 289.9396];
    let found = frequencies(mesh(CANTILEVER), Rules::nastran(), 4);
    assert!(apart(&found, &printed) < 1e-6, "{found:?}");
    // no other rule lumps, nor does this one if the deck couples, but its bars have no rotary inertia
    let consistent = frequencies(mesh(CANTILEVER), Rules::exact(), 4);
    assert!(consistent[1] > 1.09 * printed[1], "{consistent:?}");
    for (word, lumped) in [
        ("1", false),
        ("YES", false),
        ("-1", true),
        ("0", true),
        ("NO", true),
    ] {
        let deck = format!("{CANTILEVER}PARAM,COUPMASS,{word}\n");
        let found = frequencies(mesh(&deck), Rules::nastran(), 4);
        assert_eq!(mesh(&deck).lumped, lumped, "{word}");
        let coupled = frequencies(mesh(&deck), Rules::nastran(), 4);
        match lumped {
            true => assert_eq!(coupled, found, "{word}"),
            false => assert!(
                apart(&coupled, &consistent) < 1e-2 && coupled[3] > consistent[3],
                "{word}: {coupled:?}"
            ),
        }
    }
}

/// pyNastran's model `pt145`, a wing of ten CBAR with coupled masses and inertias about its axis. MSC Nastran prints seven
/// digits of all thirty frequencies.
#[test]
fn coupled_bars_have_the_frequencies_of_msc() {
    let mut deck = String::from(
        "GRDSET,,,,,,,126
SPC1,1,345,1
PBAR,1,1,7.175-2,9.83-6,,36.8-6
MAT1,1,10.4+6,3.9+6,,2.61-4
PARAM,COUPMASS,1
GRID,1,,0.,0.,0.
",
    );
    for i in 1..=10 {
        let inertia = if i == 10 { "1.4-6" } else { "2.8-6" };
        deck += &format!(
            "GRID,{},,0.,{},0.\nCBAR,{i},1,{i},{},0.,0.,1.\nCMASS2,{},{inertia},{},5\n",
            i + 1,
            0.572 * f64::from(i),
            i + 1,
            i + 20,
            i + 1
        );
    }
    let printed = [
        39.96147, 236.4137, 250.4423, 701.4011, 703.4198, 1153.105, 1375.426, 1574.398, 1956.923,
        2277.239, 2291.262, 2569.183, 2783.842, 2929.954, 3003.921, 3411.562, 4786.588, 6412.708,
        8291.552, 10307.59, 13718.95, 16574.22, 20091.81, 24249.47, 29139.32, 34850.85, 41362.55,
        48288.81, 54378.56, 68054.13,
    ];
    let found = frequencies(mesh(&deck), Rules::nastran(), 30);
    assert!(apart(&found, &printed) < 1e-6, "{found:?}");
    // with rotary inertia of the sections
    let consistent = frequencies(mesh(&deck), Rules::exact(), 30);
    assert!(consistent[29] < 0.985 * printed[29], "{consistent:?}");
}

/// A stretched CBAR with a coupled mass m has 5/12 m at each end, a rod 1/3 m.
#[test]
fn coupled_bars_stretch_between_lumped_and_consistent() {
    for (cards, share) in [
        ("CBAR,1,5,1,2,0.,0.,1.\nPBAR,5,8,2.,1.,1.,1.", 5.0 / 12.0),
        ("CONROD,1,1,2,8,2.", 1.0 / 3.0),
    ] {
        let deck = format!(
            "GRID,1,,0.,0.,0.,,123456\nGRID,2,,4.,0.,0.,,23456\nMAT1,8,2.1+11,,.3,5.\n{cards}\nPARAM,COUPMASS,1\n"
        );
        let found = frequencies(mesh(&deck), Rules::nastran(), 1);
        let (stiffness, mass): (f64, f64) = (2.1e11 * 2.0 / 4.0, 5.0 * 2.0 * 4.0);
        let expected = (stiffness / (share * mass)).sqrt() / (2.0 * std::f64::consts::PI);
        assert!(apart(&found, &[expected]) < 1e-12, "{found:?}, {expected}");
    }
}

/// pyNastran's model `beam_modes`, a shaft of nine CBAR and one CBEAM with a disk. MSC Nastran prints seven
/// digits. The fifth is torsion: CBAR has no inertia about its axis, CBEAM has it.
#[test]
fn bars_and_beams_have_the_frequencies_of_msc() {
    let printed = [
        456.6603, 456.6603, 2674.588, 2674.588, 3554.923, 4507.487, 6626.104, 6626.104,
    ];
    let mut deck: String = (0..=10)
        .map(|i| format!("GRID,{},,{i}.,0.,0.\n", i + 1))
        .collect();
    for i in 1..=9 {
        deck += &format!("CBAR,{i},1,{i},{},0.,1.,0.\n", i + 1);
    }
    deck += "CBEAM,10,3,10,11,0.,1.,0.
CONM2,21,11,,2.59-3
,2.59-3,,2.59-3,,,2.59-3
MAT1,2,3.+7,1.1628+7,.29,7.4851-4
PBARL,1,2,,ROD
,1.
PBEAML,3,2,,ROD
,1.
SPC,1,1,123456
";
    let found = frequencies(mesh(&deck), Rules::nastran(), printed.len());
    assert!(apart(&found, &printed) < 1e-6, "{found:?}");
    let bars = deck.replace("CBEAM,10,3", "CBAR,10,1");
    let found = frequencies(mesh(&bars), Rules::nastran(), printed.len());
    assert!(apart(&found[..2], &printed[..2]) < 1e-6, "{found:?}");
    assert!((found[4] / printed[4] - 1.0).abs() > 0.1, "{found:?}");
}

/// A mass in one direction moves no rotation, so it may be on a node of solids.
#[test]
fn masses_of_one_direction_are_on_nodes_of_solids() {
    let solid = |cards: &str| mesh(&format!("{BOX}CHEXA,1,3,1,2,3,4,5,6,\n,7,8\n{cards}"));
    for (cards, component) in [("CMASS2,9,2.,7,3\n", 2), ("CONM1,9,7,,2.\n", 0)] {
        let mesh = solid(cards);
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        assert_eq!(structure.freedoms.size(), 24, "{cards}");
        let bare = assemble(&solid(""), &Rules::default()).unwrap();
        let (_, along) = structure.mass.rigid_along(&mesh);
        let (_, own) = bare.mass.rigid_along(&mesh);
        for axis in 0..3 {
            let added = if axis == component { 2.0 } else { 0.0 };
            assert!(
                (along[axis] - own[axis] - added).abs() < 1e-12,
                "{cards}: {along:?}"
            );
        }
        assert!(free(mesh).is_ok(), "{cards}");
    }
    // beside the node it turns, and solids do not hold this
    let error = free(solid("CONM2,9,7,,2.,.1\n")).unwrap_err();
    assert!(
        error.advice().contains("a mass beside its node"),
        "{}",
        error.advice()
    );
    assert!(error.advice().contains("AUTOSPC"), "{}", error.advice());
}

fn free(mesh: Mesh) -> Result<Vec<f64>, FlexibleError> {
    let request = Request {
        terms: vec![Term::Normal {
            modes: Modes::Count(2),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    reduce(mesh, &request).map(|reduced| reduced.body.frequencies)
}

/// Volumes between corners follow the ends of a beam, not its nodes.
#[test]
fn the_estimate_has_the_offsets_of_beams() {
    let deck = format!("{BOX}CBAR,1,5,1,2,0.,0.,1.\n,,,0.,.5,0.,0.,.5,0.\nPBAR,5,8,2.,1.,1.,1.\n");
    let mesh = mesh(&deck);
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let estimate = eng_flexible::fe::volume::estimate(&mesh).unwrap();
    let exact = structure.mass.rigid(&mesh);
    for axis in 0..3 {
        let (found, expected) = (estimate.first_moment[axis], exact.first_moment[axis]);
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
    assert!((exact.centre()[1] - 0.5).abs() < 1e-12);
}

/// The supports of a planar bar leave three motions.
#[test]
fn supports_that_leave_rigid_motions_are_named() {
    let deck = CANTILEVER.replace("SPC1,1,35,1\n", "");
    let request = Request {
        support_of_deck: true,
        terms: vec![Term::Normal {
            modes: Modes::Count(2),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    let error = reduce(mesh(&deck), &request).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("its supports leave rigid motions, or it is a mechanism"),
        "{error}"
    );
    assert!(
        error.advice().contains("hold all six motions"),
        "{}",
        error.advice()
    );
}

/// A massless bar along x with a lump at its free end, which carries oscillators of scalar points. Each
/// direction has its own: along z a spring and a mass, along y a mass on a lever, along x a mass between the
/// end and a held scalar point.
const OSCILLATORS: &str = "GRID,1,,0.,0.,0.,,123456
GRID,2,,2.,0.,0.
CBAR,1,1,1,2,0.,1.,0.
PBAR,1,1,1.-3,2.-6,3.-6,4.-6
MAT1,1,2.+11,,.3
CONM2,5,2,,3.
SPOINT,100,200,300
CELAS2,10,4.+4,2,3,100
CMASS4,11,.5,100
MPC,1,200,0,1.,2,2,-2.
PMASS,7,.25
CMASS3,12,7,200
CMASS2,13,1.5,2,1,300
SPC1,1,,300
";

/// Closed forms of the modes of [`OSCILLATORS`]. Torsion has no mass.
#[test]
fn scalar_points_carry_springs_and_masses() {
    let (young, length, lump) = (2e11, 2.0_f64, 3.0);
    let bending = |second: f64| 3.0 * young * second / length.powi(3);
    let hertz = |square: f64| square.sqrt() / (2.0 * std::f64::consts::PI);
    // (k + c − λ M)(c − λ m) = c²
    let (stiff, spring, mass) = (bending(3e-6), 4e4, 0.5);
    let half = 0.5 * ((stiff + spring) / lump + spring / mass);
    let root = (half * half - stiff * spring / (lump * mass)).sqrt();
    let mut exact = vec![
        hertz(half - root),
        hertz(half + root),
        hertz(bending(2e-6) / (lump + 4.0 * 0.25)),
        hertz(young * 1e-3 / length / (lump + 1.5)),
    ];
    exact.sort_by(f64::total_cmp);
    for units in ["si", "mm_tonne_s"] {
        let mut mesh = mesh(OSCILLATORS);
        assert_eq!(mesh.unread, []);
        // frequencies have the unit of time of the deck, seconds in both
        mesh.convert(&MeshUnits::named(units).unwrap());
        let found = frequencies(mesh, Rules::default(), 4);
        println!("{found:?} {exact:?}");
        assert!(apart(&found, &exact) < 1e-9, "{found:?} {exact:?}");
    }
}

/// Wrong cards of scalar points, each with its message.
#[test]
fn wrong_scalar_points_are_refused() {
    for (cards, expected) in [
        ("CELAS4,20,1.\n", "the spring has no end at a grid point"),
        (
            "CMASS3,20,9,100\n",
            "mass 20 uses property 9, which is missing",
        ),
        (
            "PMASS,7,1.\n",
            "property 7 of point masses is defined twice",
        ),
        (
            "CELAS2,20,1.,2,,100\n",
            "spring 20 states no freedom of grid point 2",
        ),
        ("CMASS4,11,1.,200\n", "mass 11 is defined twice"),
    ] {
        let found = problem(&format!("{OSCILLATORS}{cards}")).problem;
        assert!(found.contains(expected), "{found}");
    }
    // a scalar point that nothing holds, and that AUTOSPC would hold
    let deck = OSCILLATORS.replace("SPC1,1,,300\n", "PARAM,AUTOSPC,NO\n");
    let request = Request {
        support_of_deck: true,
        terms: vec![Term::Normal {
            modes: Modes::Count(2),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    let error = reduce(mesh(&deck), &request).unwrap_err().to_string();
    assert!(
        error.contains("1 freedoms have no stiffness: scalar point 300"),
        "{error}"
    );
}
