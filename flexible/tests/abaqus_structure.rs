//! Keywords as the reader of Abaqus and CalculiX input understands them, against results made by
//! hand.

use crate::nastran_deck::{
    Memory, close, close3, element_ids, ids, index, position, set, set_ids, unread,
};
use eng_flexible::mesh::{
    BeamSection, Carries, Code, ElementKind, Mesh, SCALAR, Section, ShellAxis, ShellSection,
    Support, Tie,
};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::{FileProblem, FlexibleError, Place};

fn mesh_of(files: &[(&str, &str)]) -> Mesh {
    match read_inp(&Memory::new(files), "deck.inp", Code::Abaqus) {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error} ({})", error.advice()),
    }
}

fn mesh(deck: &str) -> Mesh {
    mesh_of(&[("deck.inp", deck)])
}

fn problem(deck: &str) -> FileProblem {
    match read_inp(
        &Memory::new(&[("deck.inp", deck)]),
        "deck.inp",
        Code::Abaqus,
    ) {
        Err(FlexibleError::File(problem)) => problem,
        Err(error) => panic!("no problem of a file: {error}"),
        Ok(mesh) => panic!("read without a problem: {mesh:?}"),
    }
}

/// A cube of side 2 (nodes 1 to 8) with a second one on top (9 to 12).
const CUBES: &str = "\
*HEADING
 two cubes
** a comment
*Node, nset=All Nodes
1, 0., 0., 0.
2, 2., 0., 0.
3, 2., 2., 0.
4, 0., 2., 0.
5, 0., 0., 2.
6, 2., 0., 2.
7, 2., 2., 2.
8, 0., 2., 2.
9, 0., 0., 4.
10, 2., 0., 4.
11, 2., 2., 4.
12, 0., 2., 4.
*Element, Type = C3D8R, ElSet=\"Low\"
1, 1,2,3,4,
5,6,7,8
*ELEMENT, TYPE=c3d8,
ELSET=High
2, 5,6,7,8,9,10,11,12
*NODE
100, 1., 1., 5.
";

#[test]
fn keywords_continuations_and_sets() {
    let mesh = mesh(&format!(
        "{CUBES}*NSET, NSET=odd, GENERATE
1, 12, 2
*NSET, NSET=some
ODD, 100,
2
*nset, nset=Some
4
*ELSET, ELSET=Both
LOW, high
*NSET, NSET=of elements, ELSET=High
*NSET, NSET=lost
1, 77
"
    ));
    assert_eq!((mesh.nodes.len(), mesh.elements.len()), (13, 2));
    assert_eq!(element_ids(&mesh, 1), [1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(mesh.elements[1].kind, ElementKind::Hexahedron8);
    assert_eq!(set_ids(&mesh, "odd"), [1, 3, 5, 7, 9, 11]);
    assert_eq!(set_ids(&mesh, "some"), [1, 2, 3, 4, 5, 7, 9, 11, 100]);
    assert_eq!(set(&mesh, "Both").elements(), [0, 1]);
    assert_eq!(set(&mesh, "Both").nodes().len(), 12);
    assert_eq!(set_ids(&mesh, "of elements"), [5, 6, 7, 8, 9, 10, 11, 12]);
    assert_eq!(set_ids(&mesh, "All Nodes").len(), 12);
    assert_eq!(set(&mesh, "Low").elements(), [0]);
    assert_eq!(
        unread(&mesh),
        [("set members that are missing", 1, Carries::Nothing)]
    );
    // no section: a property without material
    assert_eq!(mesh.properties.len(), 1);
    assert_eq!(mesh.properties[0].material, None);
}

#[test]
fn surfaces_and_couplings() {
    let mesh = mesh(&format!(
        "{CUBES}*SURFACE, NAME=Top
HIGH, S2
*SURFACE, NAME=Sides, TYPE=ELEMENT
2, S3
1, S3
*SURFACE, NAME=Skin
LOW
*SURFACE, NAME=Points, TYPE=NODE
1, 2.5
2,
*COUPLING, REF NODE=100, SURFACE=TOP, CONSTRAINT NAME=a
*KINEMATIC
1, 3
*COUPLING, REF NODE=100, SURFACE=sides, CONSTRAINT NAME=b
*DISTRIBUTING
*COUPLING, REF NODE=100, SURFACE=Points, CONSTRAINT NAME=c
*DISTRIBUTING
1,3
5
"
    ));
    assert_eq!(set_ids(&mesh, "Top"), [9, 10, 11, 12]);
    assert_eq!(set_ids(&mesh, "surface:Sides"), [1, 2, 5, 6, 9, 10]);
    // the face between the cubes is inside, but its corners are on other faces
    assert_eq!(set_ids(&mesh, "Skin"), [1, 2, 3, 4, 5, 6, 7, 8]);
    let nodes = |list: &[u32]| ids(&mesh, list);
    let [
        Tie::Rigid {
            id: 1,
            independent,
            dependent,
        },
        Tie::Averaging {
            reference_components: 63,
            independent: sides,
            ..
        },
        Tie::Averaging {
            reference_components: 0b01_0111,
            independent: points,
            ..
        },
    ] = mesh.ties.as_slice()
    else {
        panic!("{:?}", mesh.ties);
    };
    assert_eq!(nodes(&[*independent]), [100]);
    assert!(dependent.iter().all(|(_, components)| *components == 7));
    // quarters of two faces of area 4
    let areas = sides
        .iter()
        .map(|(node, weight, components)| (nodes(&[*node])[0], *weight, *components));
    assert_eq!(
        areas.collect::<Vec<_>>(),
        [
            (1, 1.0, 7),
            (2, 1.0, 7),
            (5, 2.0, 7),
            (6, 2.0, 7),
            (9, 1.0, 7),
            (10, 1.0, 7)
        ]
    );
    assert_eq!(points[0].1, 2.5);
    assert_eq!(points[1].1, 1.0);
}

#[test]
fn rigid_bodies_constraints_and_equations() {
    let mesh = mesh(&format!(
        "{CUBES}*NODE\n101, 0., 0., 4.
*NSET, NSET=A\n1, 2\n*NSET, NSET=B\n5, 6
*RIGID BODY, REF NODE=100, PIN NSET=A, TIE NSET=B
*MPC
BEAM, 9, 100
TIE, 101, 9
PIN, A, B
LINK, 3, 7
*EQUATION
3
3, 1, 1., 7, 2, -2.,
11, 3, 0.5
2
A, 2, 1., 100, 2, -1.
"
    ));
    let Tie::Rigid { dependent, .. } = &mesh.ties[0] else {
        panic!("no rigid body");
    };
    let found = dependent
        .iter()
        .map(|(node, bits)| (ids(&mesh, &[*node])[0], *bits));
    assert_eq!(
        found.collect::<Vec<_>>(),
        [(1, 7), (2, 7), (5, 63), (6, 63)]
    );
    let rigid = |tie: &Tie| match tie {
        Tie::Rigid {
            independent,
            dependent,
            ..
        } => (
            ids(&mesh, &[*independent])[0],
            ids(&mesh, &[dependent[0].0])[0],
        ),
        _ => panic!("{tie:?}"),
    };
    assert_eq!(rigid(&mesh.ties[1]), (100, 9));
    // the nodes coincide
    assert_eq!(rigid(&mesh.ties[2]), (9, 101));
    let equations = mesh.ties[3..]
        .iter()
        .map(|tie| match tie {
            Tie::Equation { terms, .. } => terms
                .iter()
                .map(|(node, freedom, c)| (ids(&mesh, &[*node])[0], *freedom, *c))
                .collect::<Vec<_>>(),
            _ => panic!("{tie:?}"),
        })
        .collect::<Vec<_>>();
    assert_eq!(equations.len(), 6 + 1 + 2);
    assert_eq!(equations[0], [(1, 0, 1.0), (5, 0, -1.0)]);
    assert_eq!(equations[5], [(2, 2, 1.0), (6, 2, -1.0)]);
    assert_eq!(equations[6], [(3, 0, 1.0), (7, 1, -2.0), (11, 2, 0.5)]);
    assert_eq!(equations[8], [(2, 1, 1.0), (100, 1, -1.0)]);
    let numbers = mesh.ties.iter().map(|tie| match tie {
        Tie::Rigid { id, .. } | Tie::Averaging { id, .. } | Tie::Equation { id, .. } => *id,
    });
    assert!(numbers.eq(1..=12));
    assert_eq!(unread(&mesh), [("*MPC LINK", 1, Carries::Structure)]);
}

#[test]
fn supports_in_their_frames_and_of_the_first_step() {
    let mesh = mesh(&format!(
        "{CUBES}*TRANSFORM, NSET=C, TYPE=C
0.,0.,0., 0.,0.,1.
*NSET, NSET=C\n2, 3\n*NSET, NSET=R\n6, 7\n*NSET, NSET=S\n10
*TRANSFORM, NSET=R
0., 2., 0., -1., 1., 0.
*TRANSFORM, NSET=S, TYPE=S
0.,0.,4., 0.,0.,5.
*BOUNDARY
C, 1
4, 2, 3
4, ENCASTRE
7, XSYMM
8, 11, 11, 20.
*STEP
*STATIC
*INCLUDE, INPUT=missing.inp
*BOUNDARY
1, 1, 6
*CLOAD
1, 1, 5.
*END STEP
*STEP
*STATIC
*BOUNDARY
2, 1, 6
*END STEP
*GAP, NAME=t
a, b
*FANCY NEW KEYWORD
1, 2
"
    ));
    let held = |id: u64, components: u8| Support {
        node: index(&mesh, id),
        components,
    };
    assert_eq!(
        mesh.supports,
        [
            held(1, 63),
            held(2, 1),
            held(3, 1),
            held(4, 63),
            held(7, 0b11_0001)
        ]
    );
    let cards: Vec<_> = mesh.support_cards.iter().collect();
    assert_eq!(cards.len(), 2);
    assert_eq!((&*cards[0].name, cards[0].count), ("*BOUNDARY", 5));
    assert!(cards[0].moved.is_none());
    // a later step changes no support of the model
    assert_eq!(cards[1].name, "*BOUNDARY of a later *STEP");
    assert!(cards[1].moved.is_some());
    let frame = |id: u64| {
        let node = mesh.nodes[index(&mesh, id) as usize];
        mesh.frames[node.frame.expect("a frame") as usize].rotation
    };
    let column = |id: u64, j: usize| frame(id).map(|row| row[j]);
    let r = 0.5_f64.sqrt();
    close3(column(3, 0), [r, r, 0.0], 1.0);
    close3(column(3, 1), [-r, r, 0.0], 1.0);
    close3(column(2, 1), [0.0, 1.0, 0.0], 1.0);
    close3(column(6, 0), [0.0, 1.0, 0.0], 1.0);
    close3(column(6, 1), [-1.0, 0.0, 0.0], 1.0);
    assert_eq!(mesh.nodes[5].frame, mesh.nodes[6].frame);
    // radial, tangential, meridional towards the pole
    close3(column(10, 0), [1.0, 0.0, 0.0], 1.0);
    close3(column(10, 1), [0.0, 1.0, 0.0], 1.0);
    close3(column(10, 2), [0.0, 0.0, 1.0], 1.0);
    assert_eq!(
        unread(&mesh),
        [
            ("*BOUNDARY of other fields", 1, Carries::Nothing),
            ("*CLOAD in a *STEP", 1, Carries::Nothing),
            ("*FANCY NEW KEYWORD", 1, Carries::Unknown),
            ("*GAP", 1, Carries::Structure),
            ("*INCLUDE in a *STEP", 1, Carries::Nothing),
            ("*STATIC in a *STEP", 2, Carries::Nothing),
            ("*STEP", 2, Carries::Nothing),
        ]
    );
}

/// A square with shells of four and of three nodes.
const SHELLS: &str = "\
*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
*NSET, NSET=RIGHT
2, 3
*ELEMENT, TYPE=S4R, ELSET=FOUR
1, 1, 2, 3, 4
*ELEMENT, TYPE=S3, ELSET=THREE
2, 1, 2, 3
*MATERIAL, NAME=STEEL
*ELASTIC
2.1E11, 0.3
";

#[test]
fn shells_beside_their_nodes_and_of_thicknesses_at_nodes() {
    let mesh = mesh(&format!(
        "{SHELLS}*NODAL THICKNESS
ALL, .01
RIGHT, .03
*SHELL SECTION, ELSET=FOUR, MATERIAL=STEEL, NODAL THICKNESS, OFFSET=SPOS
*SHELL SECTION, ELSET=THREE, MATERIAL=STEEL, OFFSET=-0.25
.02
"
    ));
    assert_eq!(unread(&mesh), []);
    let shape = |i: usize| mesh.shell_shapes[mesh.elements[i].shell.expect("one") as usize];
    assert_eq!(shape(0).thickness, Some([0.01, 0.03, 0.03, 0.01]));
    // the nodes lie in the upper surface
    assert_eq!(shape(0).offsets, [-0.005, -0.015, -0.015, -0.005]);
    assert_eq!(shape(1).thickness, None);
    assert_eq!(shape(1).offsets, [0.005; 4]);
    let found = problem(&format!(
        "{SHELLS}*NODAL THICKNESS
RIGHT, .03
*SHELL SECTION, ELSET=FOUR, MATERIAL=STEEL, NODAL THICKNESS
"
    ));
    assert!(
        found
            .problem
            .contains("element 1 takes NODAL THICKNESS, but its node 1 has no thickness"),
        "{found}"
    );
}

#[test]
fn layers_of_shells() {
    let lamina = "*MATERIAL, NAME=CARBON
*ELASTIC, TYPE=LAMINA
1.4E11, 1.E10, 0.3, 5.E9, 4.E9, 3.E9
*DENSITY
1600.
";
    let deck = mesh(&format!(
        "{SHELLS}{lamina}*SHELL SECTION, ELSET=FOUR, COMPOSITE, SYMMETRIC, OFFSET=SNEG
.001, 3, CARBON, 45.
.002, , STEEL
*SHELL SECTION, ELSET=THREE, MATERIAL=CARBON
.02
"
    ));
    assert_eq!(unread(&deck), []);
    let property = |i: usize| &deck.properties[deck.elements[i].property as usize];
    let Section::Shell(section) = property(0).section else {
        panic!("no shell");
    };
    close(section.thickness, 0.006, 1.0);
    let layers = deck.laminates[0].iter().map(|layer| {
        let name = deck.materials[layer.material as usize].name.as_str();
        (name, layer.thickness, layer.angle.to_degrees().round())
    });
    let (carbon, steel) = (("CARBON", 0.001, 45.0), ("STEEL", 0.002, 0.0));
    assert_eq!(layers.collect::<Vec<_>>(), [carbon, steel, steel, carbon]);
    let shape = |i: usize| deck.shell_shapes[deck.elements[i].shell.expect("one") as usize];
    close(shape(0).offsets[0], 0.003, 1.0);
    assert_eq!(shape(0).axis, ShellAxis::Direction([1.0, 0.0, 0.0], 0.0));
    assert_eq!(shape(1).axis, ShellAxis::Direction([1.0, 0.0, 0.0], 0.0));
    let sheet = deck.materials[0].sheet.expect("a lamina");
    assert_eq!(sheet.across, Some([[4e9, 0.0], [0.0, 3e9]]));
    // other axes are listed
    let listed = mesh(&format!(
        "{SHELLS}{lamina}*SHELL SECTION, ELSET=FOUR, COMPOSITE, ORIENTATION=AXES
.001, 3, CARBON, TURNED
*SHELL SECTION, ELSET=THREE, MATERIAL=STEEL
.02
"
    ));
    assert_eq!(
        unread(&listed),
        [
            (
                "*SHELL SECTION, COMPOSITE: layers with an orientation",
                1,
                Carries::Structure
            ),
            ("*SHELL SECTION, ORIENTATION", 1, Carries::Structure),
        ]
    );
    for (section, message) in [
        (
            "*SHELL SECTION, ELSET=FOUR, COMPOSITE",
            "the laminate has no layer",
        ),
        (
            "*SHELL SECTION, ELSET=FOUR, COMPOSITE\n.1, 3",
            "the layer has no material",
        ),
        (
            "*ELEMENT, TYPE=T3D2, ELSET=ROD\n9, 1, 3\n*SOLID SECTION, ELSET=ROD, MATERIAL=CARBON\n1.",
            "a section uses the material CARBON, which has no isotropic *ELASTIC",
        ),
        (
            "*MATERIAL, NAME=WRONG\n*ELASTIC, TYPE=LAMINA\n1., 9., .9, 1., 1., 1.",
            "no elastic lamina has these constants",
        ),
    ] {
        let found = problem(&format!("{SHELLS}{lamina}{section}\n"));
        assert!(found.problem.contains(message), "{found}");
    }
}

#[test]
fn sections_and_materials() {
    let mesh = mesh(&format!(
        "{CUBES}*MATERIAL, NAME=Steel
*ELASTIC, TYPE=ISOTROPIC
2.1E11, 0.3
*EXPANSION
1.2E-5
*DENSITY
7850.
*SOLID SECTION, ELSET=LOW, MATERIAL=STEEL
*SOLID SECTION, ELSET=HIGH, MATERIAL=Steel
*ELEMENT, TYPE=B31, ELSET=beams
10, 1, 2
*ELEMENT, TYPE=B32, ELSET=bows
11, 1, 4, 3
*ELEMENT, TYPE=B33, ELSET=pipes
12, 1, 5, 100
*ELEMENT, TYPE=S4R, ELSET=shells
13, 1, 2, 3, 4
*ELEMENT, TYPE=SFM3D4, ELSET=skins
14, 1, 2, 3, 4
*ELEMENT, TYPE=T3D2, ELSET=rods
15, 1, 5
*ELEMENT, TYPE=T3D2, ELSET=nothing
16, 2, 6
*ELEMENT, TYPE=CONN3D2
17, 2, 6
*BEAM SECTION, SECTION=RECT, ELSET=beams, MATERIAL=STEEL
.2, .1
0., 1., 0.
*BEAM SECTION, SECTION=CIRC, ELSET=bows, MATERIAL=STEEL
.1
*BEAM GENERAL SECTION, SECTION=GENERAL, ELSET=pipes, DENSITY=1000.
1., 2., .5, 3., 4.
0., 1., 0.
2.6E11, 1.E11
*SHELL SECTION, ELSET=shells, MATERIAL=STEEL
.01, 5
*SOLID SECTION, ELSET=rods, MATERIAL=STEEL
.5
"
    ));
    let kinds = mesh
        .elements
        .iter()
        .map(|element| (element.id, element.kind));
    assert_eq!(
        kinds.collect::<Vec<_>>(),
        [
            (1, ElementKind::Hexahedron8),
            (2, ElementKind::Hexahedron8),
            (10, ElementKind::Beam2),
            (11, ElementKind::Beam2),
            (11, ElementKind::Beam2),
            (12, ElementKind::Beam2),
            (13, ElementKind::Quadrilateral4),
            (14, ElementKind::Quadrilateral4),
            (15, ElementKind::Beam2),
        ]
    );
    assert_eq!(ids(&mesh, mesh.nodes_of(&mesh.elements[4])), [4, 3]);
    assert_eq!(set(&mesh, "bows").elements(), [3, 4]);
    assert_eq!(set_ids(&mesh, "bows"), [1, 3, 4]);
    let property = |i: usize| &mesh.properties[mesh.elements[i].property as usize];
    let material = |i: usize| property(i).material.map(|m| &mesh.materials[m as usize]);
    let steel = material(0).expect("steel");
    assert_eq!((steel.young, steel.density), (2.1e11, 7850.0));
    assert_eq!(property(0).material, property(1).material);
    let Section::Beam(BeamSection {
        area,
        moment_z,
        moment_y,
        shear,
        ..
    }) = property(2).section
    else {
        panic!("no beam");
    };
    // a along n1, which is y: bending about z is the stiff one
    close(area, 0.02, 1.0);
    close(moment_z, 0.1 * 0.008 / 12.0, 1e-3);
    close(moment_y, 0.2 * 0.001 / 12.0, 1e-3);
    assert_eq!(shear, [0.85, 0.85]);
    let axes = |i: usize| mesh.beam_axes[mesh.elements[i].beam.expect("axes") as usize];
    assert_eq!(axes(2).orientation, [0.0, 1.0, 0.0]);
    assert_eq!(axes(3).orientation, [0.0, 0.0, -1.0]);
    // the third node points
    assert_eq!(axes(5).orientation, [1.0, 1.0, 5.0]);
    let Section::Beam(BeamSection {
        moment_z,
        moment_y,
        product,
        torsion,
        ..
    }) = property(5).section
    else {
        panic!("no beam");
    };
    assert_eq!((moment_y, product, moment_z, torsion), (2.0, 0.5, 3.0, 4.0));
    close(material(5).expect("a material").poisson, 0.3, 1.0);
    assert_eq!(material(5).expect("a material").density, 1000.0);
    assert!(
        matches!(property(6).section, Section::Shell(section) if section == ShellSection::plate(0.01))
    );
    assert_eq!(property(7).material, None);
    assert!(matches!(property(8).section, Section::Beam(BeamSection { area, .. }) if area == 0.5));
    assert_eq!(
        unread(&mesh),
        [
            ("*ELEMENT, TYPE=CONN3D2", 1, Carries::Structure),
            ("*EXPANSION", 1, Carries::Nothing),
            ("line elements without section", 1, Carries::Unknown),
        ]
    );
}

#[test]
fn masses_inertias_and_springs() {
    let mesh = mesh(&format!(
        "{CUBES}*ELEMENT, TYPE=MASS, ELSET=m
20, 100
*MASS, ELSET=m
3.
*ELEMENT, TYPE=ROTARYI, ELSET=r
21, 100
*ROTARY INERTIA, ELSET=r
1., 2., 3., -.1, -.2, -.3
*ELEMENT, TYPE=SPRING1, ELSET=s1
22, 1
*SPRING, ELSET=s1
2
100.
*ELEMENT, TYPE=SPRING2, ELSET=s2
23, 1, 2
*SPRING, ELSET=s2
1, 3
200.
*ELEMENT, TYPE=SPRINGA, ELSET=sa
24, 1, 4
25, 1, 3
*SPRING, ELSET=sa

300.
*ELEMENT, TYPE=MASS
26, 1
"
    ));
    let mass = &mesh.point_masses[0];
    assert_eq!(
        (mass.id, mass.matrix[1][1], mass.matrix[3][3]),
        (20, 3.0, 0.0)
    );
    let inertia = &mesh.point_masses[1].matrix;
    assert_eq!(inertia[3][3..], [1.0, -0.1, -0.2]);
    assert_eq!(inertia[5][3..], [-0.2, -0.3, 3.0]);
    let springs = mesh
        .springs
        .iter()
        .map(|spring| (spring.id, spring.stiffness, spring.terms.clone()));
    let [one, two, three, four] = [1, 2, 3, 4].map(|id| index(&mesh, id));
    let half = 1.0 / 2.0f64.sqrt();
    assert_eq!(
        springs.collect::<Vec<_>>(),
        [
            (22, 100.0, vec![(one, 1, 1.0)]),
            (23, 200.0, vec![(one, 0, 1.0), (two, 2, -1.0)]),
            (24, 300.0, vec![(one, 1, 1.0), (four, 1, -1.0)]),
            (
                25,
                300.0,
                vec![
                    (one, 0, half),
                    (one, 1, half),
                    (three, 0, -half),
                    (three, 1, -half)
                ]
            ),
        ]
    );
    assert_eq!(
        unread(&mesh),
        [("MASS elements without *MASS", 1, Carries::Structure),]
    );
}

#[test]
fn instances_are_placed_and_told_apart() {
    let part = CUBES.replace("*HEADING\n two cubes\n", "");
    let mesh = mesh(&format!(
        "*PART, NAME=Block
{part}*NSET, NSET=Foot\n1, 2, 3, 4
*SURFACE, NAME=Head\nHIGH, S2
*ELEMENT, TYPE=ROTARYI, ELSET=spin\n30, 100
*ROTARY INERTIA, ELSET=spin\n1., 2., 3.
*SOLID SECTION, ELSET=Low, MATERIAL=M
*SOLID SECTION, ELSET=High, MATERIAL=M
*END PART
*ASSEMBLY, NAME=Assembly
*INSTANCE, NAME=Left-1, PART=Block
*END INSTANCE
*INSTANCE, NAME=Right-1, PART=BLOCK
10., 0., 0.
10., 0., 0., 10., 0., 1., 90.
*END INSTANCE
*NODE
1, 5., 5., 5.
*NSET, NSET=Corner, INSTANCE=Right-1
2, 3
*NSET, NSET=Mixed
Left-1.1, Right-1.Foot, 1
*COUPLING, REF NODE=1, SURFACE=Right-1.Head, CONSTRAINT NAME=c
*KINEMATIC
*END ASSEMBLY
*MATERIAL, NAME=M
*ELASTIC
2.E11, .3
*DENSITY
7800.
*BOUNDARY
Left-1.Foot, 1, 3
"
    ));
    assert_eq!((mesh.nodes.len(), mesh.elements.len()), (27, 4));
    // numbers meet: 1000 is the power of ten above 100
    assert_eq!(mesh.nodes[0].id, 1);
    assert_eq!(position(&mesh, 1002), [10.0, 2.0, 0.0]);
    assert_eq!(position(&mesh, 1003), [8.0, 2.0, 0.0]);
    assert_eq!(position(&mesh, 2001), [5.0, 5.0, 5.0]);
    assert_eq!(element_ids(&mesh, 1001)[..4], [1001, 1002, 1003, 1004]);
    assert_eq!(set_ids(&mesh, "Corner"), [1002, 1003]);
    assert_eq!(set_ids(&mesh, "Mixed"), [1, 1001, 1002, 1003, 1004, 2001]);
    assert_eq!(set_ids(&mesh, "Left-1.Foot"), [1, 2, 3, 4]);
    assert!(!mesh.sets.contains_key("Foot"));
    assert_eq!(set(&mesh, "Right-1").nodes().len(), 13);
    assert_eq!(set(&mesh, "Right-1").elements(), [2, 3]);
    let Tie::Rigid { dependent, .. } = &mesh.ties[0] else {
        panic!("no rigid tie");
    };
    let nodes = dependent.iter().map(|(node, _)| *node).collect::<Vec<_>>();
    assert_eq!(ids(&mesh, &nodes), [1009, 1010, 1011, 1012]);
    assert_eq!(mesh.supports.len(), 4);
    // the quarter turn about z exchanges the moments about x and y
    let turned = &mesh.point_masses[1].matrix;
    assert_eq!([turned[3][3], turned[4][4], turned[5][5]], [2.0, 1.0, 3.0]);
    assert_eq!(mesh.materials.len(), 1);
    assert!(mesh.unread.is_empty(), "{:?}", mesh.unread);
}

#[test]
fn one_instance_keeps_names_and_numbers() {
    let part = CUBES.replace("*HEADING\n two cubes\n", "");
    let mesh = mesh(&format!(
        "*PART, NAME=P\n*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n0., 0., 1.\n{part}*NSET, NSET=N\n1\n*END INSTANCE\n*END ASSEMBLY\n"
    ));
    assert_eq!(position(&mesh, 1), [0.0, 0.0, 1.0]);
    assert_eq!(mesh.sets["N"], mesh.sets["I.N"]);
    assert_eq!(set_ids(&mesh, "N"), [1]);
}

#[test]
fn numbers_too_large_to_tell_apart() {
    let node = "*NODE\n18446744073709551615, 0., 0., 0.\n";
    let problem = problem(&format!(
        "*PART, NAME=P\n{node}*END PART\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n{node}"
    ));
    assert!(problem.problem.contains("too large"), "{problem}");
    assert_eq!(
        (problem.file.as_str(), problem.place),
        ("deck.inp", Place::File)
    );
}

#[test]
fn a_material_may_hold_what_is_not_known() {
    let mesh = mesh(&format!(
        "{CUBES}*MATERIAL, NAME=M\n*ELASTIC\n1., .3\n*NEW LAW\n1.\n*DENSITY\n2.\n*SOLID SECTION, ELSET=LOW, MATERIAL=M\n"
    ));
    assert_eq!(mesh.materials[0].density, 2.0);
    assert_eq!(unread(&mesh), [("*NEW LAW", 1, Carries::Unknown)]);
}

#[test]
fn a_missing_poissons_ratio_is_listed() {
    let mesh = mesh(&format!(
        "{CUBES}*MATERIAL, NAME=M\n*ELASTIC\n2.E11\n*DENSITY\n2.\n*SOLID SECTION, ELSET=LOW, MATERIAL=M\n"
    ));
    let name = "*ELASTIC without Poisson's ratio";
    assert_eq!(unread(&mesh), [(name, 1, Carries::Structure)]);
    assert_eq!(mesh.materials[0].poisson, 0.0);
}

#[test]
fn systems_of_nodes() {
    let mesh = mesh(
        "*SYSTEM
1., 0., 0., 1., 1., 0.
0., 0., 0.
*NODE
1, 2., 3., 4.
*NODE, SYSTEM=C
2, 2., 90., 5.
*SYSTEM
*NODE
3, 1., 2., 3.
",
    );
    // x is y, y is -x
    close3(position(&mesh, 1), [-2.0, 2.0, 4.0], 4.0);
    close3(position(&mesh, 2), [-1.0, 0.0, 5.0], 5.0);
    assert_eq!(position(&mesh, 3), [1.0, 2.0, 3.0]);
}

#[test]
fn included_files_and_files_of_nodes() {
    let files = [
        (
            "sub/deck.inp",
            "*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=C3D4, INPUT=e.txt, ELSET=E\n",
        ),
        (
            "sub/nodes.inp",
            "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n",
        ),
        ("e.txt", "1, 1, 2, 3, 4\n"),
    ];
    let mesh = match read_inp(&Memory::new(&files), "sub/deck.inp", Code::Abaqus) {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error}"),
    };
    assert_eq!(element_ids(&mesh, 1), [1, 2, 3, 4]);
    assert_eq!(set(&mesh, "E").elements(), [0]);
}

/// Constants of several temperatures count at the temperature of all nodes at the start, linear between their lines.
#[test]
fn materials_at_several_temperatures() {
    let law = "*MATERIAL, NAME=M\n*ELASTIC\n200., .3, 20.\n100., .4, 120.\n*DENSITY\n8., 20.\n6., 220.\n\
               *SOLID SECTION, ELSET=LOW, MATERIAL=M\n";
    let constants = |mesh: &Mesh| {
        let material = &mesh.materials[0];
        [material.young, material.poisson, material.density]
    };
    let hot = |t: &str| format!("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nAll Nodes, {t}\n");
    for (given, temperature, expected) in [
        // 0 unless stated, below the first line; constant beyond the last one
        (String::new(), "0", [200.0, 0.3, 8.0]),
        (hot("20."), "20", [200.0, 0.3, 8.0]),
        (hot("95."), "95", [125.0, 0.375, 7.25]),
        (hot("220."), "220", [100.0, 0.4, 6.0]),
        (hot("1000."), "1000", [100.0, 0.4, 6.0]),
        // a later line counts
        (hot("1.") + &hot("95."), "95", [125.0, 0.375, 7.25]),
    ] {
        let found = mesh(&format!("{CUBES}{law}{given}"));
        for (own, expected) in constants(&found).into_iter().zip(expected) {
            close(own, expected, 4.0);
        }
        let doubts: Vec<&String> = (found.doubts.iter())
            .filter(|doubt| doubt.contains("depends on the temperature"))
            .collect();
        assert_eq!(doubts.len(), 2, "{:?}", found.doubts);
        let said = format!("its constants at {temperature} count");
        assert!(
            doubts.iter().all(|doubt| doubt.contains(&said)),
            "{doubts:?}"
        );
        assert!(
            unread(&found)
                .iter()
                .all(|(name, ..)| !name.contains("several"))
        );
    }
    // temperatures that differ, or change, or come from another file
    for given in [
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE\n1, 95.\n",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE, FILE=hot.fil\n",
        "*STEP\n*STATIC\n*TEMPERATURE\nAll Nodes, 95.\n*END STEP\n",
        "*STEP\n*HEAT TRANSFER\n*END STEP\n",
        "*STEP\n*INCLUDE, INPUT=loads.inp\n*END STEP\n",
    ] {
        let found = mesh(&format!("{CUBES}{law}{given}"));
        let several: Vec<_> = (unread(&found).into_iter())
            .filter(|(name, ..)| name.contains("several"))
            .collect();
        assert_eq!(
            several,
            [
                ("*DENSITY at several temperatures", 1, Carries::Unknown),
                ("*ELASTIC at several temperatures", 1, Carries::Unknown),
            ],
            "{given}"
        );
    }
    // the same constants at all temperatures, and other initial conditions, change nothing
    let plain = "*MATERIAL, NAME=M\n*ELASTIC\n200., .3, 20.\n200., .3, 120.\n*SOLID SECTION, ELSET=LOW, MATERIAL=M\n";
    let heated = "*STEP\n*TEMPERATURE\nAll Nodes, 95.\n*END STEP\n";
    let found = mesh(&format!(
        "{CUBES}{plain}*INITIAL CONDITIONS, TYPE=STRESS\nLOW, 1.\n{heated}"
    ));
    assert_eq!(constants(&found), [200.0, 0.3, 0.0]);
    assert!(
        found
            .doubts
            .iter()
            .all(|doubt| !doubt.contains("temperature"))
    );
    for (deck, message) in [
        (
            "*MATERIAL, NAME=M\n*ELASTIC\n200., .3, 20.\n100., .3, 20.\n",
            "the temperature 20 does not follow a lower one",
        ),
        (
            "*MATERIAL, NAME=M\n*DENSITY\n200., 20.\n100.\n",
            "the temperature is missing",
        ),
        (
            &format!("{law}*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNOWHERE, 1.\n"),
            "NOWHERE",
        ),
        (
            &format!("{law}*INITIAL CONDITIONS, TYPE=TEMPERATURE\nAll Nodes, hot\n"),
            "the temperature is \"hot\", not a number",
        ),
    ] {
        let found = problem(&format!("{CUBES}{deck}"));
        assert!(found.problem.contains(message), "{found}");
    }
}

/// A reduction takes no damper: the damping of the body counts.
#[test]
fn dampers_are_left_out() {
    let found = mesh(&format!(
        "{CUBES}*ELEMENT, TYPE=DASHPOTA, ELSET=D\n7, 1, 9\n*DASHPOT, ELSET=D\n\n1.E-5\n*ELEMENT, TYPE=DASHPOT9\n8, 1, 9\n"
    ));
    assert_eq!(
        unread(&found),
        [
            ("*DASHPOT", 1, Carries::Nothing),
            ("*ELEMENT, TYPE=DASHPOT9", 1, Carries::Structure),
            ("*ELEMENT, TYPE=DASHPOTA", 1, Carries::Nothing),
        ]
    );
}

/// A square membrane without its section.
const SKIN: &str = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n*ELEMENT, TYPE=M3D4, ELSET=SKIN\n1, 1, 2, 3, 4\n\
                    *MATERIAL, NAME=M\n*DENSITY\n2.7e-9\n";

#[test]
fn membranes_have_a_thickness_and_no_bending() {
    let elastic = "*ELASTIC\n70000., .3\n";
    let skin = mesh(&format!(
        "{SKIN}{elastic}*MEMBRANE SECTION, ELSET=SKIN, MATERIAL=M\n0.5\n"
    ));
    let Section::Shell(section) = skin.properties[0].section else {
        panic!("{:?}", skin.properties);
    };
    assert_eq!((section.thickness, section.is_membrane()), (0.5, true));
    assert_eq!(skin.materials[0].young, 70000.0);
    assert_eq!(skin.elements[0].kind, ElementKind::Quadrilateral4);
    assert!(unread(&skin).is_empty(), "{:?}", unread(&skin));
    for (lines, message) in [
        (
            format!("{elastic}*MEMBRANE SECTION, ELSET=SKIN, MATERIAL=M\n"),
            "*MEMBRANE SECTION: its data line is missing",
        ),
        (
            "*ELASTIC, TYPE=LAMINA\n140000., 10000., .3, 5000., 4500., 3500.\n*MEMBRANE SECTION, ELSET=SKIN, MATERIAL=M\n0.5\n"
                .to_string(),
            "a section uses the material M, which has no isotropic *ELASTIC",
        ),
    ] {
        let found = problem(&format!("{SKIN}{lines}"));
        assert!(found.problem.contains(message), "{lines}: {found}");
    }
    let varying = mesh(&format!(
        "{SKIN}{elastic}*MEMBRANE SECTION, ELSET=SKIN, MATERIAL=M, MEMBRANE THICKNESS=T\n0.5\n"
    ));
    let name = "*MEMBRANE SECTION, MEMBRANE THICKNESS";
    assert!(
        unread(&varying).contains(&(name, 1, Carries::Structure)),
        "{:?}",
        unread(&varying)
    );
}

/// Only membranes have a `*MEMBRANE SECTION`, and no other section.
#[test]
fn membranes_need_their_section() {
    let membranes = mesh(SKIN);
    let Section::Shell(section) = membranes.properties[0].section else {
        panic!("{:?}", membranes.properties);
    };
    assert_eq!(section.thickness, 0.0);
    assert_eq!(
        unread(&membranes),
        [("membranes without section", 1, Carries::Structure)]
    );
    let section = "*ELASTIC\n70000., .3\n*MEMBRANE SECTION, ELSET=SKIN, MATERIAL=M\n0.5\n";
    for kind in ["SFM3D4", "CPS4", "R3D4"] {
        let skin = SKIN.replace("TYPE=M3D4", &format!("TYPE={kind}"));
        let surface = mesh(&format!("{skin}{section}"));
        assert_eq!(surface.properties[0].material, None, "{kind}");
        let name = "*MEMBRANE SECTION of plane or surface elements";
        assert_eq!(unread(&surface), [(name, 1, Carries::Structure)], "{kind}");
        assert!(unread(&mesh(&skin)).is_empty(), "{kind}");
    }
    let shells = section.replace("MEMBRANE", "SHELL");
    let found = problem(&format!("{SKIN}{shells}"));
    assert!(
        found
            .problem
            .contains("*SHELL SECTION: element 1 needs another kind of section"),
        "{found}"
    );
    assert!(found.advice.contains("membranes a *MEMBRANE SECTION"));
}

#[test]
fn problems_tell_their_place() {
    let lines = CUBES.lines().count() as u64;
    for (deck, line, text) in [
        ("*NODE\n1, 0., x, 0.\n", 2, "a coordinate is \"x\""),
        ("*NODE\n0, 0., 0.\n", 2, "the number of a node is \"0\""),
        ("1, 2\n", 1, "does not begin with a keyword"),
        (
            "*NODE\n1,0,0,0\n*ELEMENT, TYPE=C3D4\n1, 1,1,1\n*NSET, NSET=a\n",
            4,
            "has 3 of the 4 nodes",
        ),
        (
            "*NODE\n1,0,0,0\n*ELEMENT, TYPE=C3D4\n1, 1,1,1,1,1\n",
            4,
            "has 5 nodes; C3D4 has 4",
        ),
        (
            "*NODE\n1,0,0,0\n*ELEMENT, TYPE=C3D4\n1, 1,1,1,9\n",
            4,
            "uses node 9, which is missing",
        ),
        (
            "*NODE\n1,0,0,0\n1,0,0,1\n",
            3,
            "node 1 is defined twice, first in deck.inp, line 2",
        ),
        (
            "*NODE\n1,0,0,0\n*NSET, NSET=a\nb\n",
            3,
            "the node set b is missing",
        ),
        (
            "*NODE\n1,0,0,0\n*NSET\n1\n",
            3,
            "the parameter NSET is missing",
        ),
        (
            "*NODE\n1,0,0,0\n*NSET, NSET=a, GENERATE\n5, 1\n",
            4,
            "is above the last number",
        ),
        ("*NODE\n1,0,0,0\n*BOUNDARY\n1, 0\n", 4, "no freedom"),
        (
            "*NODE\n1,0,0,0\n*BOUNDARY\n1, 6, 1\n",
            4,
            "comes after freedom",
        ),
        (
            "*NODE\n1,0,0,0\n*KINEMATIC\n1, 3\n",
            3,
            "no *COUPLING precedes it",
        ),
        (
            "*NODE\n1,0,0,0\n*EQUATION\n2\n1, 1, 1.\n",
            4,
            "1 of its 2 terms",
        ),
        (
            "*NODE\n1,0,0,0\n*ELASTIC\n1., .3\n",
            3,
            "belongs to no material",
        ),
        (
            "*NODE\n1,0,0,0\n*INSTANCE, NAME=i, PART=p\n",
            3,
            "the part p is missing",
        ),
        (
            "*NODE\n1,0,0,0\n*INCLUDE, INPUT=x.inp\n",
            3,
            "can't be opened",
        ),
        ("*NODE\n1,0,0,0\n*INCLUDE, INPUT=deck.inp\n", 3, "circle"),
    ] {
        let problem = problem(deck);
        assert_eq!(problem.place, Place::Line(line), "{problem}");
        assert!(problem.problem.contains(text), "{problem}");
        assert!(!problem.advice.is_empty());
    }
    for (more, line, text) in [
        (
            "*SOLID SECTION, ELSET=LOW, MATERIAL=Q\n",
            1,
            "the material Q is missing",
        ),
        (
            "*SOLID SECTION, ELSET=Nowhere\n",
            1,
            "the element set Nowhere is missing",
        ),
        (
            "*SHELL SECTION, ELSET=LOW\n1.\n",
            1,
            "element 1 needs another kind of section",
        ),
        ("*SURFACE, NAME=a\nLOW, S7\n", 2, "no face \"S7\""),
        (
            "*COUPLING, REF NODE=100, SURFACE=z\n*KINEMATIC\n",
            1,
            "the surface z is missing",
        ),
        (
            "*NSET, NSET=a\n100\n*TRANSFORM, NSET=a, TYPE=C\n1.,1.,0.,1.,1.,1.\n",
            3,
            "its points give no axes",
        ),
    ] {
        let problem = problem(&format!("{CUBES}{more}"));
        assert_eq!(problem.place, Place::Line(lines + line), "{problem}");
        assert!(problem.problem.contains(text), "{problem}");
    }
    assert_eq!(problem("*HEADING\nempty\n").place, Place::File);
}

/// A cut by its node's displacement is closed, and told unless this displacement is held. A node of the body is no such node.
#[test]
fn sections_of_pre_tension_are_closed() {
    let read = |lines: &str| {
        let mesh = mesh(&format!("{CUBES}{lines}\n"));
        let listed = mesh.unread.into_iter();
        let lost = listed.filter(|unread| unread.carries != Carries::Nothing);
        let names: Vec<String> = lost.map(|unread| unread.name).collect();
        (names, mesh.doubts)
    };
    let keyword = "*PRE-TENSION SECTION, SURFACE=S, NODE=100\n0., 0., 1.";
    let (lost, doubts) = read(keyword);
    assert_eq!(lost, [""; 0]);
    assert!(
        doubts[0].contains(
            "*PRE-TENSION SECTION is closed, as if the displacement of its node 100 were held"
        ),
        "{doubts:?}"
    );
    let (lost, doubts) = read(&format!("{keyword}\n*BOUNDARY\n100, 1"));
    assert_eq!((lost.len(), doubts.len()), (0, 0));
    let used = "*PRE-TENSION SECTION with a node of a tie or element";
    for lines in [
        "*PRE-TENSION SECTION, SURFACE=S, NODE=1",
        "*PRE-TENSION SECTION, SURFACE=S, NODE=100\n*EQUATION\n2\n100, 1, 1., 1, 1, 1.",
    ] {
        assert_eq!(read(lines).0, [used], "{lines}");
    }
    let absent = problem(&format!(
        "{CUBES}*PRE-TENSION SECTION, SURFACE=S, NODE=999\n"
    ));
    assert!(absent.problem.contains("node 999 is missing"), "{absent}");
}

#[test]
fn absent_files_of_matrices_are_named() {
    let absent = problem(&format!(
        "{CUBES}*MATRIX INPUT, NAME=K, INPUT=missing.mtx\n"
    ));
    assert!(absent.problem.contains("missing.mtx"), "{absent}");
}

/// CalculiX 2.20 leaves the rotations of a rigid body free if no node is named for them.
#[test]
fn rotations_of_a_rigid_body_of_calculix_have_a_node_of_their_own() {
    let deck = format!(
        "{CUBES}*NSET, NSET=B\n5, 6\n*RIGID BODY, REF NODE=100, NSET=B\n*BOUNDARY\n100, 1, 6\n"
    );
    let held = |code: Code| {
        let mesh = read_inp(&Memory::new(&[("deck.inp", &deck)]), "deck.inp", code).unwrap();
        let components: Vec<u8> = mesh.supports.iter().map(|held| held.components).collect();
        (components, mesh.doubts)
    };
    assert_eq!(held(Code::Abaqus), (vec![0b11_1111], vec![]));
    let (components, doubts) = held(Code::CalculiX);
    assert_eq!(components, [0b111]);
    assert!(
        doubts[0].contains("*BOUNDARY holds rotations of node 100, and CalculiX leaves those"),
        "{doubts:?}"
    );
}

/// Two nodes with matrices, a third one whose freedoms are amplitudes, and equations between them.
const MATRICES: &str = "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 0., 0.\n*NSET, NSET=PART_MODAL_FREEDOMS\n3
*MATRIX INPUT, NAME=K\n1, 1, 1, 1, 5.\n3, 1, 3, 1, 7.\n*MATRIX INPUT, NAME=M, SCALE FACTOR=2.\n1, 1, 1, 1, 1.\n3, 1, 1, 1, .5\n3, 1, 3, 1, 4.
*MATRIX ASSEMBLE, STIFFNESS=K, MASS=M, VISCOUS DAMPING=D\n*BOUNDARY\n3, 2, 6
*EQUATION\n2\n2, 1, -1., 3, 1, .25\n";

/// The amplitudes become scalar points: 31 is freedom 1 of node 3. The node itself and its unused freedoms disappear.
#[test]
fn matrices_of_a_deck() {
    let mesh = mesh(MATRICES);
    let ids: Vec<u64> = mesh.nodes.iter().map(|node| node.id).collect();
    assert_eq!((ids, mesh.scalar_points), (vec![1, 2], vec![31]));
    assert_eq!((mesh.supports, mesh.support_cards), (vec![], vec![]));
    let terms = vec![(1, 0, -1.0), (SCALAR, 0, 0.25)];
    assert_eq!(mesh.ties, [Tie::Equation { id: 1, terms }]);
    let matrices = mesh.matrices.unwrap();
    let (first, modal) = ((1, 1), (31, 0));
    assert_eq!(
        matrices.stiffness.pairs,
        [(first, first, 5.0), (modal, modal, 7.0)]
    );
    assert_eq!(
        matrices.mass.pairs,
        [
            (first, first, 2.0),
            (modal, first, 1.0),
            (modal, modal, 8.0)
        ]
    );
    assert_eq!(mesh.doubts, Vec::<String>::new());
}

/// Wrong matrices of a deck, each with its message.
#[test]
fn wrong_matrices_of_a_deck() {
    let told = |from: &str, to: &str| {
        let deck = MATRICES.replace(from, to);
        assert_ne!(deck, MATRICES, "{from}");
        problem(&deck).problem
    };
    for (from, to, expected) in [
        ("STIFFNESS=K", "STIFFNESS=L", "the matrix L is missing"),
        (", MASS=M", "", "the parameter MASS is missing"),
        (
            "NAME=K",
            "NAME=K, TYPE=UNSYMMETRIC",
            "the matrix is not symmetric",
        ),
        (
            "SCALE FACTOR=2.",
            "SCALE FACTOR=two",
            "SCALE FACTOR is \"two\"",
        ),
        (
            "1, 1, 1, 1, 5.\n3, 1, 3, 1, 7.\n",
            "",
            "the matrix has no entry",
        ),
        (
            "1, 1, 1, 1, 5.",
            "1, 7, 1, 1, 5.",
            "\"7\" is no freedom of a structure",
        ),
        (
            "2, 1, -1., 3, 1, .25",
            "2, 1, -1., 3, 2, .25",
            "names a modal freedom that no matrix has",
        ),
    ] {
        let found = told(from, to);
        assert!(found.contains(expected), "{found}");
    }
    let plain = mesh(&MATRICES.replace("PART_MODAL_FREEDOMS", "OTHERS"));
    assert!(
        plain.doubts[0].contains("into a node set MODAL_FREEDOMS"),
        "{:?}",
        plain.doubts
    );
    assert_eq!(plain.scalar_points, Vec::<u64>::new());
    let beside = mesh(&format!(
        "{MATRICES}*ELEMENT, TYPE=MASS, ELSET=P\n9, 1\n*MASS, ELSET=P\n1.\n"
    ));
    let lost = ("*MATRIX ASSEMBLE beside elements", 1, Carries::Structure);
    assert_eq!(unread(&beside), [lost]);
}
