//! Glued surfaces of NX Nastran, and glued bodies of MSC Nastran.

use crate::fe_meshes::{agrees, held, nodes_where, solve};
use crate::nastran_deck::*;
use eng_flexible::fe::{Reduction, Rules, assemble};
use eng_flexible::mesh::{Carries, Mesh, Tie};

/// A box of one hexahedron from x = 0 to 1, and beyond a gap of 0.01 a box of four from x = 1.01 to 2.01. The second
/// has a face of four parts towards the first.
fn boxes() -> String {
    let mut deck = String::from("MAT1,1,2.+5,,.3,7.8-9\nPSOLID,1,1\nPSOLID,2,1\n");
    for (first, start, cells) in [(1, 0.0, 1), (11, 1.01, 2)] {
        let side = cells + 1;
        for k in 0..side {
            for j in 0..side {
                for i in 0..2 {
                    let id = first + i + 2 * (j + side * k);
                    let [y, z] = [j, k].map(|j| f64::from(j) / f64::from(cells));
                    deck += &format!("GRID,{id},,{},{y:.3},{z:.3}\n", start + f64::from(i));
                }
            }
        }
        for k in 0..cells {
            for j in 0..cells {
                let node = |i, j, k| first + i + 2 * (j + side * k);
                let nodes = [
                    node(0, j, k),
                    node(1, j, k),
                    node(1, j + 1, k),
                    node(0, j + 1, k),
                    node(0, j, k + 1),
                    node(1, j, k + 1),
                    node(1, j + 1, k + 1),
                    node(0, j + 1, k + 1),
                ];
                let [a, b, c, d, e, f, g, h] = nodes;
                let (id, property) = (first + j + cells * k, 1 + i32::from(first > 1));
                deck += &format!("CHEXA,{id},{property},{a},{b},{c},{d},{e},{f}\n,{g},{h}\n");
            }
        }
    }
    deck
}

/// The source region of the faces of elements 11 to 14 towards the first box, and the target on it.
const REGIONS: &str =
    "BSURFS,1,,,,11,11,13,19\n,12,13,15,21,13,17,19,25\n,14,19,21,27\nBSURFS,2,,,,1,2,4,6\n";

fn glued(control: &str, cards: &str) -> String {
    format!("SOL 103\nCEND\n{control}\nBEGIN BULK\n{}{cards}", boxes())
}

/// The far end of the second box moves by F L/(E A) under a tension that is spread over it.
fn stretch(mesh: &Mesh) -> f64 {
    let structure = assemble(mesh, &Rules::default()).unwrap();
    let mut supports = held(&nodes_where(mesh, |x| x[0] < 1e-9), 0b1);
    supports.extend(held(&nodes_where(mesh, |x| x[1] < 1e-9), 0b10));
    supports.extend(held(&nodes_where(mesh, |x| x[2] < 1e-9), 0b100));
    // followers are not held
    supports.retain(|support| {
        let x = mesh.nodes[support.node as usize].position[0];
        !(1.005..1.015).contains(&x)
    });
    let reduction = Reduction::new(mesh, &structure, &supports).unwrap();
    let end = nodes_where(mesh, |x| x[0] > 2.0);
    let mut force = vec![0.0; structure.freedoms.size()];
    let share = |x: f64| if (0.1..0.9).contains(&x) { 0.5 } else { 0.25 };
    for node in &end {
        let [_, y, z] = mesh.nodes[*node as usize].position;
        force[structure.freedoms.freedom(*node, 0).unwrap()] = share(y) * share(z);
    }
    let found = solve(&structure, &reduction, &force);
    let moved = end
        .iter()
        .map(|node| found[structure.freedoms.freedom(*node, 0).unwrap()]);
    let moved: Vec<f64> = moved.collect();
    assert!(
        moved.iter().all(|x| agrees(*x, moved[0], 1e-9)),
        "{moved:?}"
    );
    moved[0]
}

#[test]
fn glued_boxes_stretch_as_one() {
    let deck = glued(
        "BGSET = 5",
        &format!("{REGIONS}BGADD,5,6\nBGSET,6,1,2,.1\n"),
    );
    let mesh = mesh(&deck);
    assert_eq!(unread(&mesh), []);
    // nine nodes follow in three directions
    assert_eq!(mesh.ties.len(), 27);
    let [doubt] = &mesh.doubts[..] else {
        panic!("{:?}", mesh.doubts);
    };
    assert!(
        doubt.contains("the tie of the surface 1 of BGSET 6 bridges a gap of up to 1.000e-2"),
        "{doubt}"
    );
    assert!(agrees(stretch(&mesh), 2.0 / 2e5, 1e-9));
}

/// The outer faces of a property are a region, too. Only those that face the other region follow.
#[test]
fn outer_faces_of_solids_are_regions() {
    let cards = "BCPROPS,1,2\nBCPROPS,2,1\nBGSET,6,1,2,.1\n";
    let found = mesh(&glued("BGSET = 6", cards));
    assert_eq!(found.ties.len(), 27);
    assert!(
        found.doubts[0].contains("9 of 18 nodes of the surface 1 of BGSET 6 are farther"),
        "{:?}",
        found.doubts
    );
    assert!(agrees(stretch(&found), 2.0 / 2e5, 1e-9));
}

/// A plate of two shells beyond the faces of a box: only the nodes above the box follow, and not those beside it.
#[test]
fn nodes_beside_the_target_stay_free() {
    let plate = "MAT1,9,2.+5,,.3,7.8-9\nPSHELL,9,9,.1,9,,9\nGRID,51,,0.,0.,1.1\nGRID,52,,1.,0.,1.1
GRID,53,,1.,1.,1.1\nGRID,54,,0.,1.,1.1\nGRID,55,,1.3,0.,1.1\nGRID,56,,1.3,1.,1.1
CQUAD4,51,9,51,52,53,54\nCQUAD4,52,9,52,55,56,53\n";
    for region in ["BSURF,1,51,THRU,52\n", "BCPROP,1,9\n"] {
        let cards = format!("{plate}{region}BSURFS,2,,,,1,5,6,8\nBGSET,6,1,2\n");
        let found = mesh(&glued("BGSET = 6", &cards));
        let mut followers = std::collections::BTreeSet::new();
        for tie in &found.ties {
            if let Tie::Equation { terms, .. } = tie {
                followers.insert(found.nodes[terms[0].0 as usize].id);
            }
        }
        assert_eq!(followers.into_iter().collect::<Vec<_>>(), [51, 52, 53, 54]);
        assert!(
            found.doubts[0].contains("2 of 6 nodes of the surface 1 of BGSET 6 are farther from the other surface than the search distance of 10 along its normals, and stay free"),
            "{:?}",
            found.doubts
        );
    }
}

/// Two strips of shells, one above the other, bend as one of twice the thickness.
#[test]
fn glued_shells_bend_as_one_plate() {
    let (cells, length, thickness) = (20, 1.0_f64, 0.02_f64);
    let mut deck = String::from("MAT1,1,2.+5,,0.,7.8-9\nPSHELL,1,1,.02,1,,1\n");
    for (first, height) in [(1, 0.0), (101, thickness)] {
        for i in 0..=cells {
            let x = length * f64::from(i) / f64::from(cells);
            for (j, y) in [(0, 0.0), (1, 0.05)] {
                deck += &format!("GRID,{},,{x:.4},{y},{height}\n", first + 2 * i + j);
            }
        }
        for i in 0..cells {
            let a = first + 2 * i;
            let (b, c, d) = (a + 2, a + 3, a + 1);
            deck += &format!("CQUAD4,{},1,{a},{b},{c},{d}\n", first + i);
        }
    }
    deck += "BSURF,1,1,THRU,20\nBSURF,2,101,THRU,120\nBGSET,6,1,2,.05\n";
    let mesh = mesh(&format!("CEND\nBGSET = 6\nBEGIN BULK\n{deck}"));
    assert!(
        mesh.doubts[1].contains("BGSET 6 ties the translations of region 1 alone: the rotations of the 42 nodes of its shells do not follow region 2"),
        "{:?}",
        mesh.doubts
    );
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    // the leading strip is clamped; the other one follows it
    let clamp = nodes_where(&mesh, |x| x[0] < 1e-9 && x[2] > 0.01);
    let mut supports = held(&clamp, 0b11_1111);
    supports.extend(held(
        &nodes_where(&mesh, |x| x[0] < 1e-9 && x[2] < 0.01),
        0b11_1000,
    ));
    let reduction = Reduction::new(&mesh, &structure, &supports).unwrap();
    let mut force = vec![0.0; structure.freedoms.size()];
    let tip = nodes_where(&mesh, |x| x[0] > length - 1e-9 && x[2] > 0.01);
    for node in &tip {
        force[structure.freedoms.freedom(*node, 2).unwrap()] = 0.5;
    }
    let found = solve(&structure, &reduction, &force);
    let moved = found[structure.freedoms.freedom(tip[0], 2).unwrap()];
    let inertia = 0.05 * (2.0 * thickness).powi(3) / 12.0;
    let exact = length.powi(3) / (3.0 * 2e5 * inertia);
    assert!(agrees(moved, exact, 5e-3), "{}", moved / exact);
}

#[test]
fn glue_without_a_selection_is_not_used() {
    let found = mesh(&glued("METHOD = 1", &format!("{REGIONS}BGSET,6,1,2,.1\n")));
    assert!(found.ties.is_empty());
    assert!(
        found.doubts[0].contains("no BGSET = in case control selects the glue"),
        "{:?}",
        found.doubts
    );
    // contact is no glue
    let contact = mesh(&glued(
        "BGSET = 6",
        &format!("{REGIONS}BGSET,6,1,2,.1\nBCTSET,7,1,2\n"),
    ));
    assert_eq!(unread(&contact), [("BCTSET", 1, Carries::Structure)]);
}

/// Regions are data of contact, too: a wrong one stops a deck only if glue uses it.
#[test]
fn wrong_regions_without_glue_are_no_error() {
    let wrong = "BSURF,1,a\nBSURFS,2,,,,1,2,4\nBCPROP,3,.5\nBCPROPS,x,1\nBSURF,5,11,+LOST\nBSURF,4,11,,,,,,,+LOST\n";
    for (control, cards) in [
        ("METHOD = 1", ""),
        ("METHOD = 1", "BGSET,6,1,2,.1\n"),
        // this glue uses other regions
        (
            "BGSET = 6",
            "BSURFS,11,,,,11,11,13,19\nBSURFS,12,,,,1,2,4,6\nBGSET,6,11,12,.1\nBGSET,7,1,2\n",
        ),
    ] {
        let found = mesh(&glued(control, &format!("{wrong}{cards}")));
        assert_eq!(unread(&found), []);
        assert_eq!(found.ties.is_empty(), control != "BGSET = 6");
    }
    let used = |region: u32| {
        let cards = format!("{wrong}BSURFS,12,,,,1,2,4,6\nBGSET,6,{region},12,.1\n");
        problem(&glued("BGSET = 6", &cards)).problem
    };
    for (region, message) in [
        (1, "field EID is \"A\""),
        (2, "ends before its field G3"),
        (3, "field IP is \".5\""),
        (4, "its continuation \"+LOST\" is missing"),
        // the number of this region may be the one that cannot be read
        (9, "field ID is \"X\""),
    ] {
        let found = used(region);
        assert!(found.contains(message), "{region}: {found}");
    }
}

#[test]
fn wrong_glue_has_messages() {
    let pair = "BGSET,6,1,2,.1\n";
    for (control, cards, message) in [
        (
            "BGSET = 6",
            "BGSET,6,1,3\n".to_string() + REGIONS,
            "BGSET 6 glues region 3, which is missing or no surface",
        ),
        (
            "BGSET = 7",
            format!("{REGIONS}{pair}"),
            "BGSET = 7 selects a set that is missing",
        ),
        (
            "BGSET = 6",
            format!("{REGIONS}BGSET,6,1,2,-1.\n"),
            "the search distance is -1",
        ),
        (
            "BGSET = 6",
            format!("{REGIONS}BGSET,6,1,2,.001\n"),
            "no node of region 1 faces region 2 within the search distance of 0.001",
        ),
        (
            "BGSET = 6",
            format!("BSURFS,1,,,,11,11,13,20\nBSURFS,2,,,,1,2,4,6\n{pair}"),
            "the mesh has no solid 11 with a face at three grid points",
        ),
        (
            "BGSET = 6",
            format!("BSURF,1,11,THRU,14\nBSURFS,2,,,,1,2,4,6\n{pair}"),
            "region 1 has no face",
        ),
        (
            "SUBCASE 1\nBGSET = 6\nMETHOD = 1\nSUBCASE 2\nMETHOD = 1",
            format!("{REGIONS}{pair}"),
            "the sets of glue differ: subcase 1 selects BGSET = 6",
        ),
    ] {
        let found = problem(&glued(control, &cards));
        assert!(found.problem.contains(message), "{found}");
        assert!(!found.advice.is_empty());
    }
}

/// The bodies of both boxes, by their elements and by their property.
const BODIES: &str =
    "BSURF,1,11,THRU,14\nBCPROP,2,1\nBCBODY,10,,DEFORM,1\nBCBODY1,20,,3D,DEFORM,2\n";

#[test]
fn glued_bodies_stretch_as_one() {
    for cards in [
        "BCTABLE,6,,,1\n,SLAVE,10,.1,,,,1\n,MASTERS,20\n",
        "BCTABLE,6,,,1\n,SECNDRY,10,.1,,,,2\n,,1\n,,FBSH,1.+20,.9\n,PRIMARY,20\n",
        // the other direction adds nothing
        "BCTABLE,6,,,2\n,SLAVE,10,.1,,,,1\n,MASTERS,20\n,SLAVE,20,.1,,,,1\n,MASTERS,10\n",
        "BCTABL1,6,3\nBCONECT,3,7,,10,20\nBCONPRG,7,,IGLUE,1,ERROR,.1\n",
        "BCONECT,6,7\n,SECNDRY,10\n,PRIMARY,20\nBCONPRG,7,,IGLUE,1\nBCPARA,0,ERROR,.1\n",
    ] {
        let found = mesh(&glued("BCONTACT = 6", &format!("{BODIES}{cards}")));
        assert_eq!(unread(&found), [], "{cards}");
        assert_eq!(found.ties.len(), 27, "{cards}");
        let [doubt] = &found.doubts[..] else {
            panic!("{:?}", found.doubts);
        };
        assert!(
            doubt.contains("6 glues 9 nodes of body 10 to body 20, within ERROR = 0.1 and over a gap of up to 1.000e-2")
                || doubt.contains("3 glues 9 nodes of body 10 to body 20, within ERROR = 0.1 and over a gap of up to 1.000e-2"),
            "{doubt}"
        );
        assert!(agrees(stretch(&found), 2.0 / 2e5, 1e-9), "{cards}");
    }
    // bodies that are apart stay so
    let cards = "BCTABLE,6,,,1\n,SLAVE,10,.001,,,,1\n,MASTERS,20\n";
    let found = mesh(&glued("BCONTACT = 6", &format!("{BODIES}{cards}")));
    assert!(found.ties.is_empty());
    assert!(
        found.doubts[0].contains("BCTABLE 6 glues no node of body 10 to body 20"),
        "{:?}",
        found.doubts
    );
    // and those that case control does not select
    let found = mesh(&glued("METHOD = 1", &format!("{BODIES}{cards}")));
    assert!(found.ties.is_empty());
    assert!(
        found.doubts[0].contains("no BCONTACT = in case control selects bodies"),
        "{:?}",
        found.doubts
    );
}

/// Contact that opens, distances that the deck does not state, and shells, whose distance is that of their surfaces.
#[test]
fn contact_of_bodies_is_listed() {
    let glue = "BCTABLE,6,,,1\n,SLAVE,10,.1,,,,1\n,MASTERS,20\n";
    for (control, cards, name) in [
        (
            "BCONTACT = 6",
            format!("{BODIES}BCTABLE,6,,,1\n,SLAVE,10,.1\n,MASTERS,20\n"),
            "contact of bodies without IGLUE (BCTABLE, BCONECT)",
        ),
        (
            "BCONTACT = 6",
            format!("{BODIES}BCTABLE,6,10,20\n"),
            "contact of bodies without IGLUE (BCTABLE, BCONECT)",
        ),
        (
            "BCONTACT = 6",
            format!("{BODIES}BCTABLE,6,,,1\n,SLAVE,10,,,,,1\n,MASTERS,20\n"),
            "glued bodies without ERROR (BCTABLE, BCONPRG, BCPARA)",
        ),
        (
            "BCONTACT = ALLBODY",
            BODIES.to_string(),
            "BCONTACT = ALLBODY",
        ),
        (
            "BCONTACT = 6",
            format!(
                "BSURF,1,11,THRU,14\nBCPROP,2,9\nMAT1,9,2.+5,,.3,7.8-9\nPSHELL,9,9,.1\nCQUAD4,51,9,1,3,7,5\n\
                 BCBODY,10,,DEFORM,1\nBCBODY,20,,,2\n{glue}"
            ),
            "glued bodies of shells (BCBODY)",
        ),
    ] {
        let found = mesh(&glued(control, &cards));
        assert_eq!(unread(&found), [(name, 1, Carries::Structure)], "{cards}");
        assert!(found.ties.is_empty(), "{cards}");
    }
    // unlike in NX Nastran, BSURF may list solids; without contact it is no error
    let found = mesh(&glued("METHOD = 1", BODIES));
    assert_eq!((unread(&found).len(), found.doubts.len()), (0, 0));
}

#[test]
fn wrong_bodies_have_messages() {
    let glue = "BCTABLE,6,,,1\n,SLAVE,10,.1,,,,1\n,MASTERS,20\n";
    for (control, cards, message) in [
        (
            "BCONTACT = 7",
            format!("{BODIES}{glue}"),
            "BCONTACT = 7 selects no pair of bodies",
        ),
        (
            "BCONTACT = 6",
            glue.to_string(),
            "BCTABLE 6 glues body 10, which is missing",
        ),
        (
            "BCONTACT = 6",
            format!("BSURF,1,11,THRU,14\nBCBODY,10,,DEFORM,1\nBCBODY,20,,RIGID,2\n{glue}"),
            "BCTABLE 6 glues body 20, which is RIGID",
        ),
        (
            "BCONTACT = 6",
            format!("BSURF,1,11,THRU,14\nBCBODY,10,,DEFORM,1\nBCBODY,20,,DEFORM,2\n{glue}"),
            "body 20 has region 2, which is missing or no surface",
        ),
        (
            "BCONTACT = 6",
            format!("BSURF,1,11,THRU,14\nBSURF,2,99\nBCBODY,10,,,1\nBCBODY,20,,,2\n{glue}"),
            "body 20 has no solid",
        ),
        (
            "BCONTACT = 6",
            format!("{BODIES}BCTABLE,6,,,1\n,SLAVE,10,-.1,,,,1\n,MASTERS,20\n"),
            "BCTABLE 6: ERROR is -0.1",
        ),
        (
            "BCONTACT = 6",
            format!("{BODIES}BCTABLE,6,,,1\n,OTHERS,10,.1\n"),
            "\"OTHERS\" begins no list of bodies",
        ),
        (
            "BCONTACT = 6",
            format!("{BODIES}BCTABLE,6,,,1\n,SLAVE,10,.1,,,,X\n"),
            "IGLUE is \"X\", no whole number",
        ),
        (
            "SUBCASE 1\nBCONTACT = 6\nMETHOD = 1\nSUBCASE 2\nMETHOD = 1",
            format!("{BODIES}{glue}"),
            "the tables of contact differ: subcase 1 selects BCONTACT = 6",
        ),
    ] {
        let found = problem(&glued(control, &cards));
        assert!(found.problem.contains(message), "{cards}: {found}");
        assert!(!found.advice.is_empty());
    }
}
