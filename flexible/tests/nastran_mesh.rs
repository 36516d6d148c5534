//! Grid points, coordinate systems, elements, properties and materials of the Nastran reader, by hand.

use std::f64::consts::PI;

use crate::nastran_deck::*;
use eng_flexible::Place;
use eng_flexible::mesh::{BeamSection, Carries, ElementKind, Layup, Section, ShellAxis, Support};

/// Grid points 1 to `count` on a line that is nowhere straight, a solid property and its material.
fn grids(count: u64) -> String {
    (1..=count)
        .map(|id| format!("GRID,{id},,{id}.,{}.,{}.\n", id * id, id % 3))
        .chain(["PSOLID,3,8\nMAT1,8,2.1+11,,.3,7850.\n".to_string()])
        .collect()
}

#[test]
fn systems_by_points_in_systems() {
    // 2 is shifted by (1, 0, 0) and turned by 90° about z; 3 stands in 2; 1 stands in 3, before both
    let mesh = mesh(
        "CORD2R,1,3,0.,0.,0.,0.,0.,1.\n,1.,0.,0.
CORD2C,3,2,0.,0.,2.,0.,0.,3.\n,1.,0.,2.
CORD2R,2,,1.,0.,0.,1.,0.,1.\n,1.,5.,0.
CORD2S,4,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.
GRID,1,2,3.,4.,5.
GRID,2,3,2.,90.,1.
GRID,3,1,1.,0.,0.
GRID,4,4,2.,30.,90.
",
    );
    // x of system 2 is y, its y is −x
    close3(position(&mesh, 1), [1.0 - 4.0, 3.0, 5.0], 10.0);
    // in system 2: (0, 2, 3)
    close3(position(&mesh, 2), [1.0 - 2.0, 0.0, 3.0], 10.0);
    // the points of system 1 are cylindrical: (1, 0, 0) is on the x axis of 3
    close3(position(&mesh, 3), [1.0, 1.0, 2.0], 10.0);
    close3(
        position(&mesh, 4),
        [0.0, 2.0 * 0.5, 2.0 * 0.75_f64.sqrt()],
        10.0,
    );
}

#[test]
fn systems_by_grid_points_two_a_card() {
    let mesh = mesh(
        "CORD1R,5,1,2,3,6,4,5,6
GRID,1,,1.,1.,1.
GRID,2,,1.,1.,2.
GRID,3,,1.,2.,1.
GRID,4,5,0.,0.,0.
GRID,5,5,1.,0.,0.
GRID,6,5,0.,1.,0.
GRID,7,6,1.,2.,3.
",
    );
    // system 5: z = z, x = y, y = −x; system 6 in it: z = x, x = y, y = z
    close3(position(&mesh, 4), [1.0, 1.0, 1.0], 1.0);
    // (1, 2, 3) in 6 is (3, 1, 2) in 5
    close3(position(&mesh, 7), [1.0 - 1.0, 1.0 + 3.0, 1.0 + 2.0], 10.0);
}

#[test]
fn analysis_frames_are_evaluated_at_their_nodes() {
    let mesh = mesh(
        "CORD2R,2,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.
CORD2C,3,,0.,0.,0.,1.,0.,0.\n,0.,1.,0.
CORD2S,4,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.
GRID,1,,1.,2.,3.,2
GRID,2,,4.,2.,3.,2
GRID,3,3,2.,30.,5.,3
GRID,4,3,2.,120.,5.,3
GRID,5,,7.,0.,0.,3
GRID,6,4,2.,90.,90.,4
GRID,7,,0.,0.,0.
",
    );
    let frame = |id: u64| {
        let node = mesh.nodes[index(&mesh, id) as usize];
        node.frame.map(|frame| mesh.frames[frame as usize].rotation)
    };
    let column = |id: u64, j: usize| frame(id).expect("a frame").map(|row| row[j]);
    // one frame for both nodes of the rectangular system
    assert_eq!(mesh.nodes[0].frame, mesh.nodes[1].frame);
    close3(column(1, 0), [0.0, 1.0, 0.0], 1.0);
    close3(column(1, 1), [-1.0, 0.0, 0.0], 1.0);
    // x along the crank, angle from y
    let (s, c) = (0.5, 0.75_f64.sqrt());
    close3(position(&mesh, 3), [5.0, 2.0 * c, 2.0 * s], 10.0);
    close3(column(3, 0), [0.0, c, s], 1.0);
    close3(column(3, 1), [0.0, -s, c], 1.0);
    close3(column(3, 2), [1.0, 0.0, 0.0], 1.0);
    close3(column(4, 0), [0.0, -s, c], 1.0);
    // on the axis: as at angle zero
    close3(column(5, 0), [0.0, 1.0, 0.0], 1.0);
    // spherical, at the y axis: r, θ, φ
    close3(column(6, 0), [0.0, 1.0, 0.0], 1.0);
    close3(column(6, 1), [0.0, 0.0, -1.0], 1.0);
    close3(column(6, 2), [-1.0, 0.0, 0.0], 1.0);
    assert_eq!(frame(7), None);
    assert_eq!(mesh.frames.len(), 5);
}

#[test]
fn defaults_of_grid_points() {
    let mesh = mesh(
        "GRID,1,,1.,90.,3.
GRID,2,0,1.,90.,3.,0,6
GRDSET,,7,,,,8,456
CORD2C,7,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.
CORD2R,8,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.
",
    );
    close3(position(&mesh, 1), [0.0, 1.0, 3.0], 3.0);
    assert_eq!(position(&mesh, 2), [1.0, 90.0, 3.0]);
    assert!(mesh.nodes[0].frame.is_some() && mesh.nodes[1].frame.is_none());
    assert_eq!(
        mesh.supports,
        [
            Support {
                node: 0,
                components: 0b11_1000
            },
            Support {
                node: 1,
                components: 0b10_0000
            }
        ]
    );
}

#[test]
fn systems_that_cannot_be_placed() {
    for (deck, line, message) in [
        (
            "GRID,1,9,0.,0.,0.\n",
            1,
            "GRID 1 uses coordinate system 9, which is missing",
        ),
        (
            "GRID,1,,0.,0.,0.,9\n",
            1,
            "GRID 1 uses coordinate system 9, which is missing",
        ),
        (
            "CORD2R,1,2,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1\n",
            1,
            "coordinate system 1 uses coordinate system 2, which is missing",
        ),
        (
            "CORD2R,1,2,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,2,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1\n",
            3,
            "in a circle: 1 → 2 → 1",
        ),
        (
            "CORD1R,1,1,2,3\nGRID,1\nGRID,2,,1.\nGRID,3,1,0.,1.,0.\n",
            1,
            "in a circle: 1 → 1",
        ),
        (
            "CORD1R,1,1,2,4\nGRID,1\nGRID,2,,1.\n",
            1,
            "coordinate system 1 uses grid point 4, which is missing",
        ),
        (
            "CORD2R,1,,0.,0.,0.,0.,0.,1.\n,0.,0.,5.\nGRID,1\n",
            1,
            "its three points lie on one line",
        ),
        (
            "CORD2R,1,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,1,,0.,0.,0.,0.,0.,1.\n,2.,0.,0.\nGRID,1\n",
            3,
            "coordinate system 1 is defined twice",
        ),
        (
            "GRID,1,,0.,0.,0.\nGRID,2,,0.,0.,0.\nGRID,1,,0.,0.,1.\n",
            3,
            "grid point 1 is defined twice, first in deck.bdf, line 1",
        ),
    ] {
        let found = problem(deck);
        assert_eq!(found.place, Place::Line(line), "{found}");
        assert!(found.problem.contains(message), "{found}");
    }
    // the same point once more is no contradiction
    let twice = mesh("GRID,1,,1.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,1,,1.,0.,0.\nGRID,3\n");
    assert_eq!(
        twice.nodes.iter().map(|node| node.id).collect::<Vec<_>>(),
        [1, 2, 3]
    );
}

#[test]
fn solids_in_the_order_of_the_mesh() {
    let list = |ids: std::ops::RangeInclusive<u64>| {
        let ids = ids.map(|id| id.to_string()).collect::<Vec<_>>();
        let (first, rest) = ids.split_at(6);
        let mut lines = vec![first.join(",")];
        lines.extend(rest.chunks(8).map(|chunk| chunk.join(",")));
        lines.join("\n,")
    };
    let mesh = mesh(&format!(
        "{}CTETRA,1,3,1,2,3,4
CTETRA,2,3,{}
CPYRAM,3,3,1,2,3,4,5
CPYRA,4,3,{}
CPENTA,5,3,{}
CPENTA,6,3,{}
CHEXA,7,3,{}
CHEXA,8,3,{}
",
        grids(20),
        list(1..=10),
        list(1..=13),
        list(1..=6),
        list(1..=15),
        list(1..=8),
        list(1..=20),
    ));
    let kinds = mesh.elements.iter().map(|e| e.kind).collect::<Vec<_>>();
    assert_eq!(
        kinds,
        [
            ElementKind::Tetrahedron4,
            ElementKind::Tetrahedron10,
            ElementKind::Pyramid5,
            ElementKind::Pyramid13,
            ElementKind::Wedge6,
            ElementKind::Wedge15,
            ElementKind::Hexahedron8,
            ElementKind::Hexahedron20,
        ]
    );
    assert_eq!(element_ids(&mesh, 2), (1..=10).collect::<Vec<_>>());
    assert_eq!(element_ids(&mesh, 4), (1..=13).collect::<Vec<_>>());
    // vertical edges come last in the mesh, in the middle in the deck
    assert_eq!(
        element_ids(&mesh, 6),
        [1, 2, 3, 4, 5, 6, 7, 8, 9, 13, 14, 15, 10, 11, 12]
    );
    assert_eq!(
        element_ids(&mesh, 8),
        [
            1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 17, 18, 19, 20, 13, 14, 15, 16
        ]
    );
    assert_eq!(mesh.properties.len(), 1);
    assert_eq!(mesh.properties[0].name, "3");
    assert_eq!(mesh.properties[0].section, Section::Solid);
    assert_eq!(mesh.materials[0].name, "8");
    assert_eq!(set_ids(&mesh, "pid:3"), (1..=20).collect::<Vec<_>>());
    assert_eq!(set(&mesh, "pid:3").elements(), (0..8).collect::<Vec<_>>());
}

#[test]
fn mid_side_nodes_may_be_absent() {
    let mesh = mesh(&format!(
        "{}CTETRA,1,3,1,2,3,4,5,6\n,7,,9,10
CTETRA,2,3,1,2,3,4,0,0\n,0,8
CHEXA,3,3,1,2,3,4,5,6\n,7,8,,,,,13,\n,,,17
CHEXA,4,3,1,2,3,4,5,6\n,7,8,0,0,0,0,0,0
",
        grids(20)
    ));
    assert_eq!(element_ids(&mesh, 1), [1, 2, 3, 4, 5, 6, 7, 0, 9, 10]);
    assert_eq!(element_ids(&mesh, 2), [1, 2, 3, 4, 0, 0, 0, 8, 0, 0]);
    assert_eq!(
        element_ids(&mesh, 3),
        [1, 2, 3, 4, 5, 6, 7, 8, 0, 0, 0, 0, 17, 0, 0, 0, 13, 0, 0, 0]
    );
    assert_eq!(mesh.elements[3].kind, ElementKind::Hexahedron8);
    assert!(!set(&mesh, "pid:3").nodes().contains(&u32::MAX));
}

#[test]
fn shells_with_their_thickness() {
    let mesh = mesh(&format!(
        "{}PSHELL,1,8,0.01,8,,8,,2.5
PSHELL,2,,,
CQUAD4,1,1,1,2,3,4
CTRIA3,2,1,1,2,3
CQUAD8,3,1,1,2,3,4,5,6\n,7,8
CTRIA6,4,1,1,2,3,4,,6
CQUAD4,5,1,1,2,3,4,,\n,,,.02,.02,.02,.02
CTRIA3,6,2,1,2,3
CQUAD4,7,1,1,2,3,4,30.,0.5
CTRIA6,8,1,1,2,3
",
        grids(8)
    ));
    let kinds = mesh.elements.iter().map(|e| e.kind).collect::<Vec<_>>();
    assert_eq!(kinds[2], ElementKind::Quadrilateral8);
    assert_eq!(kinds[3], ElementKind::Triangle6);
    assert_eq!(kinds[7], ElementKind::Triangle3);
    assert_eq!(element_ids(&mesh, 4), [1, 2, 3, 4, 0, 6]);
    let thickness = |element: usize| {
        let property = &mesh.properties[mesh.elements[element].property as usize];
        match property.section {
            Section::Shell(section) => {
                (property.material, section.thickness, section.mass_per_area)
            }
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(thickness(0), (Some(0), 0.01, 2.5));
    assert_eq!(thickness(4), (Some(0), 0.02, 2.5));
    assert_eq!(thickness(5), (None, 0.0, 0.0));
    // the angle means nothing to an isotropic shell
    let shape = mesh.shell_shapes[mesh.elements[6].shell.expect("an offset") as usize];
    assert_eq!(
        (shape.offsets, shape.axis),
        ([0.5; 4], ShellAxis::Side(0.0))
    );
    assert_eq!(unread(&mesh), []);
    assert_eq!(set(&mesh, "pid:1").elements(), [0, 1, 2, 3, 4, 6, 7]);
}

#[test]
fn beams_with_orientation_offsets_and_releases() {
    // the analysis frame of both ends: x = y, y = −x
    let mesh = mesh(
        "CORD2R,2,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.
GRID,1,,0.,0.,0.,2
GRID,2,,3.,0.,0.,2
GRID,3,,0.,5.,5.
MAT1,8,2.1+11,,.3,7850.
PBAR,4,8,1.,2.,3.,4.,5.\n\n,.8,.9,.1
PBAR,5,8,1.,2.,3.,4.,5.\n,,,,,,,,\n,.8,.9,.1
CBAR,1,5,1,2,0.,0.,1.
CBAR,2,5,1,2,3
CBAR,3,5,1,2,0.,0.,1.\n,456,5,1.,2.,3.,.5
CBAR,4,5,1,2,0.,1.,1.,BGO\n,,,1.,,,0.,2.
CBAR,5,5,1,2,0,0,1
CBEAM,6,5,1,2,1.,0.,0.
",
    );
    let beam = |i: usize| mesh.beam_axes[mesh.elements[i].beam.expect("a beam") as usize];
    close3(beam(0).orientation, [0.0, 0.0, 1.0], 1.0);
    assert_eq!(beam(1).orientation, [0.0, 5.0, 5.0]);
    // (1, 2, 3) in the analysis frame is (−2, 1, 3)
    close3(beam(2).offsets[0], [-2.0, 1.0, 3.0], 10.0);
    close3(beam(2).offsets[1], [0.0, 0.5, 0.0], 10.0);
    assert_eq!(beam(2).released, [0b11_1000, 0b01_0000]);
    // vector in the basic frame; second offset along the element's own y, (0, 1, 1)/√2
    assert_eq!(beam(3).orientation, [0.0, 1.0, 1.0]);
    close3(beam(3).offsets[0], [0.0, 1.0, 0.0], 10.0);
    let half = 2.0 * 0.5_f64.sqrt();
    close3(beam(3).offsets[1], [0.0, half, half], 10.0);
    assert_eq!(beam(4).orientation, [0.0, 0.0, 1.0]);
    // (1, 0, 0) of the analysis frame
    close3(beam(5).orientation, [0.0, 1.0, 0.0], 1.0);
    assert_eq!(
        mesh.properties[0].section,
        Section::Beam(BeamSection {
            area: 1.0,
            moment_z: 2.0,
            moment_y: 3.0,
            product: 0.1,
            torsion: 4.0,
            shear: [0.8, 0.9],
            mass_per_length: 5.0
        })
    );
}

#[test]
fn beam_sections_of_every_card() {
    let mesh = mesh(
        "GRID,1,,0.,0.,0.
GRID,2,,3.,0.,0.
MAT1,8,2.1+11,,.3,7850.
PARAM,WTMASS,2.
BAROR,,3,,,0.,1.,0.
BEAMOR,,5,,,0.,0.,1.
PBARL,3,8,,ROD\n,2.,7.
PBEAML,4,8,MSCBML0,BAR\n,2.,6.,,NO,1.,2.,6.
PBEAM,5,8,1.,2.,3.,.5,4.,6.
PBEAM,6,8,1.,2.,3.,.5,4.,6.\n,1.,1.,1.,1.,1.,1.,1.,1.\n,YES,1.,3.\n,1.,1.,1.,1.,1.,1.,1.,1.\n,.7,.6
PROD,7,8,1.5,.5,,3.
PTUBE,8,8,4.,1.
CBAR,1,,1,2
CBAR,2,3,1,2
CBEAM,3,,1,2
CBEAM,4,4,1,2
CBEAM,5,6,1,2
CROD,6,7,1,2
CTUBE,7,8,1,2
CONROD,8,1,2,8,2.5,.25,,1.
",
    );
    let sections = |id: u64| -> Vec<BeamSection> {
        let element = mesh.elements.iter().find(|e| e.id == id).expect("element");
        match mesh.properties[element.property as usize].section {
            Section::Beam(section) => vec![section],
            Section::Tapered(index) => {
                let stations = mesh.tapers[index as usize].iter();
                stations.map(|station| station.section).collect()
            }
            other => panic!("{other:?}"),
        }
    };
    let values = |own: &BeamSection| {
        let constants = [
            own.area,
            own.moment_z,
            own.moment_y,
            own.product,
            own.torsion,
        ];
        (constants, own.shear, own.mass_per_length)
    };
    let section = |id: u64| values(&sections(id)[0]);
    let (rod, shear, mass) = section(1);
    for (found, expected) in rod.iter().zip([4.0, 4.0, 4.0, 0.0, 8.0]) {
        close(*found, expected * PI, 30.0);
    }
    assert_eq!((shear, mass), ([0.9, 0.9], 14.0));
    assert_eq!(section(2), section(1));
    assert_eq!(section(3), ([1.0, 2.0, 3.0, 0.5, 4.0], [1.0, 1.0], 12.0));
    let (bar, ..) = section(4);
    assert_eq!(bar[..3], [12.0, 36.0, 4.0]);
    // from 1 to 3
    let taper: Vec<_> = sections(5).iter().map(values).collect();
    for (own, area) in taper.iter().zip([1.0, 3.0]) {
        assert_eq!(*own, ([area, 2.0, 3.0, 0.5, 4.0], [0.7, 0.6], 12.0));
    }
    assert_eq!(section(6), ([1.5, 0.0, 0.0, 0.0, 0.5], [0.0, 0.0], 6.0));
    let (tube, ..) = section(7);
    close(tube[0], PI * 3.0, 10.0);
    close(tube[4], PI * 7.5, 30.0);
    assert_eq!(section(8), ([2.5, 0.0, 0.0, 0.0, 0.25], [0.0, 0.0], 2.0));
    // a rod has some direction across
    let axes = mesh.beam_axes[mesh.elements[7].beam.expect("a rod") as usize];
    assert_eq!(axes.orientation[0], 0.0);
    assert!(unread(&mesh).is_empty());
    assert_eq!(mesh.materials[0].density, 15_700.0);
}

#[test]
fn beams_that_cannot_be() {
    let deck = |card: &str| {
        format!(
            "GRID,1,,0.,0.,0.
GRID,2,,3.,0.,0.
GRID,3,,0.,0.,0.
MAT1,8,2.1+11,,.3,7850.
PBAR,4,8,1.,2.,3.,4.
{card}
"
        )
    };
    for (card, message) in [
        (
            "CBAR,1,4,1,2,1.,0.,0.",
            "element 1: its orientation vector lies along the beam",
        ),
        ("CBAR,1,4,1,3,1.,0.,0.", "element 1 has no length"),
        ("CBAR,1,4,1,2", "the orientation vector is missing"),
        (
            "CBAR,1,4,1,2,9",
            "element 1 uses grid point 9, which is missing",
        ),
        ("CBAR,1,4,1,2,0.,1.,0.,XYZ", "field OFFT is \"XYZ\""),
        (
            "CBAR,1,9,1,2,0.,1.,0.",
            "element 1 uses property 9, which is missing",
        ),
        (
            "CROD,1,4,1,2",
            "element 1 uses property 4, which is missing",
        ),
        (
            "PBARL,5,8,,BOX\n,1.,1.,.6,.1\nCBAR,1,5,1,2,0.,1.,0.",
            "no BOX has the dimensions",
        ),
        (
            "PBARL,5,8,,DBOX\n,1.,1.,.6,.1\nCBAR,1,5,1,2,0.,1.,0.",
            "element 1 uses PBARL 5, and Eng does not read this kind",
        ),
    ] {
        let found = problem(&deck(card));
        assert!(matches!(found.place, Place::Line(6..)), "{found}");
        assert!(found.problem.contains(message), "{found}");
        assert!(!found.advice.is_empty());
    }
}

#[test]
fn one_of_three_elastic_constants_may_be_blank() {
    for card in [
        "MAT1,8,2.6,1.,.3,5.",
        "MAT1,8,2.6,,.3,5.",
        "MAT1,8,,1.,.3,5.",
        "MAT1,8,2.6,1.,,5.",
    ] {
        let mesh = mesh(
            &grids(4)
                .replace("MAT1,8,2.1+11,,.3,7850.", card)
                .replace("PSOLID", "CTETRA,1,3,1,2,3,4\nPSOLID"),
        );
        close(mesh.materials[0].young, 2.6, 3.0);
        close(mesh.materials[0].poisson, 0.3, 1.0);
        assert_eq!(mesh.materials[0].density, 5.0);
        assert_eq!(mesh.unread, []);
    }
    for (card, message) in [
        ("MAT1,8,,,.3,5.", "E is blank, and so is G or NU"),
        ("MAT1,8,2.6,,.5,5.", "no elastic material has"),
        ("MAT1,8,2.6,.8,,5.", "no elastic material has"),
        ("MAT1,8,2.6,,.3,-5.", "no elastic material has"),
        (
            "MAT9,8,2.6",
            "MAT9 8, used by PSOLID 3, has a stiffness that is not positive definite",
        ),
        ("MAT10,8,2.6", "MAT10 8, used by PSOLID 3, is not isotropic"),
        (
            "MAT1,9,2.6,,.3",
            "PSOLID 3 uses material 8, which is missing",
        ),
    ] {
        let found = problem(
            &grids(4)
                .replace("MAT1,8,2.1+11,,.3,7850.", card)
                .replace("PSOLID", "CTETRA,1,3,1,2,3,4\nPSOLID"),
        );
        assert!(found.problem.contains(message), "{found}");
    }
    let odd = mesh(
        &grids(4)
            .replace("MAT1,8,2.1+11,,.3,7850.", "MAT1,8,2.6")
            .replace("PSOLID", "CTETRA,1,3,1,2,3,4\nPSOLID"),
    );
    assert_eq!(odd.unread.len(), 1);
    assert!(odd.unread.iter().all(|u| u.carries == Carries::Structure));
}

/// E, G and NU of one card may disagree: G resists the shear of lines and shells. Solids stop the reduction.
#[test]
fn a_shear_modulus_of_its_own() {
    let deck = |cards: &str| {
        mesh(
            &grids(4)
                .replace("MAT1,8,2.1+11,,.3,7850.", "MAT1,8,2.6,2.,.3,5.")
                .replace("PSOLID", &format!("{cards}\nPSOLID")),
        )
    };
    let line = deck("CBAR,1,7,1,2,0.,0.,1.\nPBAR,7,8,1.,1.,1.,1.");
    close(line.materials[0].young, 2.6, 1.0);
    close(line.materials[0].poisson, 2.6 / 4.0 - 1.0, 1.0);
    assert_eq!(line.unread, []);
    let shell = deck("CTRIA3,1,7,1,2,3\nPSHELL,7,8,.1,8,,8");
    let sheet = shell.materials[0].sheet.unwrap();
    let plane = 2.6 / (1.0 - 0.09);
    for (found, expected) in sheet.plane.as_flattened().iter().zip([
        plane,
        0.3 * plane,
        0.0,
        0.3 * plane,
        plane,
        0.0,
        0.0,
        0.0,
        2.0,
    ]) {
        close(*found, expected, 3.0);
    }
    assert_eq!(sheet.across, Some([[2.0, 0.0], [0.0, 2.0]]));
    assert_eq!(shell.unread, []);
    let solid = deck("CTETRA,1,3,1,2,3,4\nCTETRA,2,3,1,2,3,4");
    assert_eq!(solid.unread.len(), 1);
    let unread = &solid.unread[0];
    assert_eq!(
        (unread.name.as_str(), unread.count, unread.carries),
        (
            "MAT1 of solids with G other than E/(2 (1+NU))",
            1,
            Carries::Structure
        )
    );
}

/// NU12 of a sheet has no bound but NU12² < E1/E2.
#[test]
fn a_sheet_with_a_large_ratio() {
    let sheet = mesh(&grids(4).replace(
        "PSOLID",
        "MAT8,5,4.,1.,1.5,1.,,,7.\nCTRIA3,1,7,1,2,3\nPSHELL,7,5,.1,5\nPSOLID",
    ));
    let plane = sheet.materials[0].sheet.unwrap().plane;
    // ν21 = 3/8
    close(plane[0][0], 4.0 / (1.0 - 1.5 * 0.375), 10.0);
    close(plane[0][1], 0.375 * plane[0][0], 10.0);
    assert!(eng_flexible::fe::assemble(&sheet, &eng_flexible::fe::Rules::default()).is_ok());
}

#[test]
fn elements_that_miss_something() {
    for (cards, line, message) in [
        (
            "CTETRA,17,3,1,2,3,99",
            7,
            "element 17 uses grid point 99, which is missing",
        ),
        (
            "CTETRA,17,4,1,2,3,4",
            7,
            "element 17 uses property 4, which is missing",
        ),
        (
            "CTETRA,17,3,1,2,3,4\nCHEXA,18,3,1,2,3,4,1,2\n,3,4\nCTETRA,17,3,1,2,3,4",
            10,
            "element 17 is defined twice, first in deck.bdf, line 7",
        ),
        ("PSOLID,3,8", 7, "PSOLID 3: this property is defined twice"),
        ("MAT1,8,1.,,.3", 7, "MAT1 8: this material is defined twice"),
        (
            "PSHELL,5,8\nCTRIA3,1,5,1,2,3",
            8,
            "element 1 has no thickness",
        ),
        (
            "PSHELL,5,8\nCTRIA3,1,5,1,2,3,,,\n,,,.1",
            8,
            "element 1 has no thickness at one of its grid points",
        ),
        (
            "MAT8,5,1.,2.,.9,1.",
            7,
            "no elastic sheet has these constants",
        ),
        (
            "MAT8,5,2.,1.,.3,1.\nCTETRA,17,5,1,2,3,4\nPSOLID,5,5",
            7,
            "MAT8 5, used by PSOLID 5, is not isotropic",
        ),
        (
            "SPOINT,50,THRU,60\nCTETRA,17,3,1,2,3,55",
            8,
            "uses 55, which is a scalar point",
        ),
        (
            "PSOLID,6,8,,,,,PFLUID\nCTETRA,1,6,1,2,3,4",
            7,
            "Eng does not read this kind of property",
        ),
    ] {
        let found = problem(&format!("{}{cards}\n", grids(4)));
        assert_eq!(found.place, Place::Line(line), "{found}");
        assert!(found.problem.contains(message), "{found}");
        assert!(!found.advice.is_empty());
    }
}

#[test]
fn shells_of_several_materials_thicknesses_and_axes() {
    let mesh = mesh(&format!(
        "{}MAT1,9,7.+10,,.3,2700.
MAT8,10,1.4+11,1.+10,.3,5.+9,4.+9,3.+9,1600.
MAT2,11,3.,1.,0.,2.,0.,.5,5.
CORD2R,7,,0.,0.,0.,1.,0.,0.\n,0.,0.,1.
PSHELL,1,8,.01,9,2.,,
PSHELL,2,8,.01
PSHELL,3,10,.02,10,,11,1.
PSHELL,4,8,.01,8,,8
CQUAD4,1,1,1,2,3,4
CQUAD4,2,2,1,2,3,4
CQUAD4,3,3,1,2,3,4,30.
CQUAD4,4,3,1,2,3,4,7,-.1
CTRIA3,5,4,1,2,3,,,\n,,,.02,,.04
CTRIA3,6,4,1,2,3,,,\n,,1,.5,2.,1.
",
        grids(4)
    ));
    assert_eq!(unread(&mesh), []);
    let section = |element: usize| {
        let property = &mesh.properties[mesh.elements[element].property as usize];
        match property.section {
            Section::Shell(section) => (property.material, section),
            other => panic!("{other:?}"),
        }
    };
    let name = |index: Option<u32>| index.map(|i| mesh.materials[i as usize].name.as_str());
    let apart = |element: usize| match section(element).1.layup {
        Layup::Apart { bending, shear } => [section(element).0, bending, shear].map(name),
        other => panic!("{other:?}"),
    };
    assert_eq!(apart(0), [Some("8"), Some("9"), None]);
    assert_eq!((section(0).1.bending, section(0).1.shear), (2.0, 0.0));
    assert_eq!(apart(1), [Some("8"), None, None]);
    assert!(section(1).1.is_membrane());
    assert_eq!(apart(2), [Some("10"), Some("10"), Some("11")]);
    let sheet = |index: Option<u32>| {
        mesh.materials[index.expect("one") as usize]
            .sheet
            .expect("one")
    };
    let orthotropic = sheet(section(2).0);
    let rest = 1.0 - 0.09 / 14.0;
    close(orthotropic.plane[0][0], 1.4e11 / rest, 1e12);
    close(orthotropic.plane[0][1], 0.3e10 / rest, 1e12);
    close(orthotropic.plane[1][1], 1e10 / rest, 1e12);
    assert_eq!(orthotropic.plane[2], [0.0, 0.0, 5e9]);
    assert_eq!(orthotropic.across, Some([[4e9, 0.0], [0.0, 3e9]]));
    let Layup::Apart { shear, .. } = section(2).1.layup else {
        panic!("one material");
    };
    // as MID3 a MAT2 holds the stiffness of the shear across
    assert_eq!(sheet(shear).across, Some([[3.0, 1.0], [1.0, 2.0]]));
    let shape =
        |element: usize| mesh.shell_shapes[mesh.elements[element].shell.expect("one") as usize];
    assert_eq!(mesh.elements[0].shell, None);
    assert_eq!(shape(2).axis, ShellAxis::Side(30f64.to_radians()));
    // z along x, x along z
    let ShellAxis::Direction(axis, turn) = shape(3).axis else {
        panic!("{:?}", shape(3));
    };
    close3(axis, [0.0, 0.0, 1.0], 1.0);
    assert_eq!((turn, shape(3).offsets), (0.0, [-0.1; 4]));
    assert_eq!(shape(4).thickness, Some([0.02, 0.01, 0.04, 0.0]));
    assert_eq!(shape(5).thickness, Some([0.005, 0.02, 0.01, 0.0]));
}

#[test]
fn parts_of_shell_properties_that_are_not_read_are_listed() {
    let mesh = mesh(&format!(
        "{}PSHELL,1,8,.01,-1
PSHELL,2,,.01,8,,8
PSHELL,3,8,.01,8,,8,,,\n,,,8
MAT8,10,1.4+11,1.+10,.3,5.+9
CORD2C,7,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.
PSHELL,4,10,.01,10
CTRIA3,1,4,1,2,3,7
",
        grids(4)
    ));
    assert_eq!(
        unread(&mesh),
        [
            (
                "MCID of a cylindrical or spherical system",
                1,
                Carries::Structure
            ),
            ("PSHELL of plane strain", 1, Carries::Structure),
            ("PSHELL with MID4", 1, Carries::Structure),
            ("PSHELL without MID1", 1, Carries::Structure),
        ]
    );
}

#[test]
fn layers_of_shells() {
    let mesh = mesh(&format!(
        "{}MAT8,10,1.4+11,1.+10,.3,5.+9,,,1600.
PCOMP,1,,2.,,,,,SYM\n,10,.001,45.,YES,,,-45.,\n,8,.002
PCOMPG,2,.001\n,101,10,.001,90.\n,102,10,.003,0.
PCOMP,3,,,,,,,MEM\n,8,.001
CQUAD4,1,1,1,2,3,4,30.
CQUAD4,2,2,1,2,3,4,,.1
CTRIA3,3,3,1,2,3,,,\n,,,.1,.1,.1
",
        grids(4)
    ));
    let layers = |element: usize| {
        let property = &mesh.properties[mesh.elements[element].property as usize];
        let Section::Shell(section) = property.section else {
            panic!("no shell");
        };
        let Layup::Layers(index) = section.layup else {
            panic!("no layers");
        };
        let name = |material: u32| mesh.materials[material as usize].name.as_str();
        let layers = &mesh.laminates[index as usize];
        let own = layers.iter().map(|layer| {
            (
                name(layer.material),
                layer.thickness,
                layer.angle.to_degrees().round(),
            )
        });
        (section, own.collect::<Vec<_>>())
    };
    let (section, found) = layers(0);
    let half = [("10", 0.001, 45.0), ("10", 0.001, -45.0), ("8", 0.002, 0.0)];
    let mut whole = half.to_vec();
    whole.extend(half.iter().rev());
    assert_eq!(found, whole);
    close(section.thickness, 0.008, 1.0);
    assert_eq!(section.mass_per_area, 2.0);
    let shape =
        |element: usize| mesh.shell_shapes[mesh.elements[element].shell.expect("one") as usize];
    assert_eq!(shape(0).offsets, [0.0; 4]);
    assert_eq!(shape(0).axis, ShellAxis::Side(30f64.to_radians()));
    assert_eq!(layers(1).1, [("10", 0.001, 90.0), ("10", 0.003, 0.0)]);
    // the lower surface is 1 mm above the reference plane, which is 0.1 above the nodes
    close(shape(1).offsets[0], 0.103, 1.0);
    assert_eq!(
        unread(&mesh),
        [
            ("PCOMP, LAM = MEM", 1, Carries::Structure),
            ("T1 to T4 of a shell with PCOMP", 1, Carries::Structure),
        ]
    );
    let found = problem(&format!("{}PCOMP,1,\nCTRIA3,3,1,1,2,3\n", grids(4)));
    assert!(
        found.problem.contains("PCOMP: the laminate has no layer"),
        "{found}"
    );
    let found = problem(&format!(
        "{}PCOMP,1,,,,,,,\n,8\nCTRIA3,3,1,1,2,3\n",
        grids(4)
    ));
    assert!(found.problem.contains("T1"), "{found}");
}
