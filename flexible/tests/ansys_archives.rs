//! Archives of ANSYS: real files against ANSYS' own frequencies and against the same meshes in the language
//! of Abaqus; all commands of a small archive; wrong files with their messages.

use std::fmt::Write as _;
use std::io::Read;
use std::path::Path;

use crate::nastran_deck::{Memory, ids, unread};
use crate::support::apart;
use eng_flexible::fe::{MassRule, Rules, assemble, form};
use eng_flexible::mesh::{Code, Element, ElementKind, Mesh, Section, Support};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::read::ansys::read_cdb;
use eng_flexible::reduce::{Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_flexible::{MeshFormat, read_mesh};
use eng_system::mesh_files::Stated as _;

/// The text of a file in `tests/data/ansys`.
fn archive(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/ansys");
    let packed = std::fs::read(folder.join(format!("{name}.cdb.gz"))).unwrap();
    let mut text = String::new();
    flate2::read::GzDecoder::new(packed.as_slice())
        .read_to_string(&mut text)
        .unwrap();
    text
}

fn mesh(text: &str) -> Mesh {
    match read_cdb(&Memory::new(&[("a.cdb", text)]), "a.cdb") {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error} ({})", error.advice()),
    }
}

fn of_abaqus(text: &str, code: Code) -> Mesh {
    match read_inp(&Memory::new(&[("a.inp", text)]), "a.inp", code) {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error} ({})", error.advice()),
    }
}

/// Frequencies (Hz), with the supports of the file if it has some.
fn frequencies(mesh: Mesh, rules: Rules, count: usize) -> Vec<f64> {
    let request = Request {
        rules,
        support_of_deck: !mesh.supports.is_empty(),
        terms: vec![Term::Normal {
            modes: Modes::Count(count),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    match reduce(mesh, &request) {
        Ok(reduced) => reduced.body.frequencies,
        Err(error) => panic!("{error} ({})", error.advice()),
    }
}

/// The same nodes and elements in the language of Abaqus, with types by the kinds of the mesh.
fn in_abaqus(mesh: &Mesh, name: impl Fn(ElementKind) -> &'static str, rest: &str) -> String {
    let mut text = String::from("*NODE, NSET=ALL\n");
    for node in &mesh.nodes {
        let [x, y, z] = node.position;
        writeln!(text, "{}, {x:e}, {y:e}, {z:e}", node.id).unwrap();
    }
    for element in &mesh.elements {
        let nodes = ids(mesh, mesh.nodes_of(element));
        writeln!(text, "*ELEMENT, TYPE={}, ELSET=ALL", name(element.kind)).unwrap();
        let words: Vec<String> = nodes.iter().map(u64::to_string).collect();
        let lines: Vec<String> = std::iter::once(element.id.to_string())
            .chain(words)
            .collect::<Vec<_>>()
            .chunks(8)
            .map(|chunk| chunk.join(", "))
            .collect();
        writeln!(text, "{}", lines.join(",\n")).unwrap();
    }
    text + rest
}

/// Types of Abaqus with the mechanics of ANSYS' default elements.
fn alike(kind: ElementKind) -> &'static str {
    match kind {
        ElementKind::Hexahedron8 => "C3D8",
        ElementKind::Hexahedron20 => "C3D20R",
        ElementKind::Wedge15 => "C3D15",
        ElementKind::Pyramid13 => "C3D13",
        ElementKind::Tetrahedron10 => "C3D10",
        ElementKind::Tetrahedron4 => "C3D4",
        ElementKind::Quadrilateral4 => "S4",
        other => panic!("{other:?}"),
    }
}

/// Frequencies that ANSYS has written for its beam of 40 SOLID186 (`file.rst` beside `HexBeam.cdb` in
/// `ansys/pymapdl-reader`), which has another material than the archive.
const OF_ANSYS: [f64; 6] = [
    7366.495039686105,
    7366.495039686416,
    11504.895236637829,
    17285.704594563937,
    17285.7045945711,
    20137.192990349755,
];

#[test]
fn frequencies_are_those_of_ansys() {
    let text = archive("hexbeam")
        .replace(" 7.000000000E+10,", " 1.690000000E+07,")
        .replace(" 0.350000000    ,", " 0.310000000    ,")
        .replace("  2700.00000    ,", " 4.140800000E-04,");
    let beam = mesh(&text);
    assert_eq!(beam.materials[0].young, 16.9e6);
    let found = frequencies(beam.clone(), Rules::default(), 6);
    assert!(apart(&found, &OF_ANSYS) < 1e-10, "{found:?}");
    // mass at 3³ points, and full integration, are other elements
    let rules = Rules {
        mass: MassRule::Abaqus,
        ..Rules::default()
    };
    let cubed = frequencies(beam.clone(), rules, 6);
    assert!(apart(&cubed, &OF_ANSYS) > 3e-6, "{cubed:?}");
    let full = frequencies(beam, Rules::exact(), 6);
    assert!(apart(&full, &OF_ANSYS) > 1e-4, "{full:?}");
}

/// The beam in the language of Abaqus, with its sets.
#[test]
fn the_beam_is_the_same_in_abaqus() {
    let beam = mesh(&archive("hexbeam"));
    assert_eq!((beam.nodes.len(), beam.elements.len()), (321, 40));
    assert_eq!(beam.code, Code::Ansys);
    assert_eq!(beam.properties[0].name, "1:1:1:1");
    assert_eq!(beam.properties[0].section, Section::Solid);
    let count = |name: &str| {
        let set = &beam.sets[name];
        (set.nodes().len(), set.elements().len())
    };
    // ranges of the file: 17-18, 21-40 and 1-20, 23-24
    assert_eq!(count("ECOMP1").1, 22);
    assert_eq!(count("ECOMP2").1, 22);
    assert_eq!(count("type:1"), (321, 40));
    assert_eq!(count("material:1"), (321, 40));
    let (nodes, elements) = count("NODE_SELECTION");
    assert!(nodes > 100 && elements == 0, "{nodes}");
    let rest = "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*MATERIAL, NAME=M\n*ELASTIC\n7e10, 0.35\n*DENSITY\n2700.\n";
    let other = of_abaqus(&in_abaqus(&beam, alike, rest), Code::Abaqus);
    let exact = frequencies(other, Rules::abaqus(), 10);
    let rules = Rules {
        mass: MassRule::Abaqus,
        ..Rules::default()
    };
    let found = frequencies(beam, rules, 10);
    assert!(apart(&found, &exact) < 1e-10, "{found:?} {exact:?}");
}

/// Hexahedron, wedge, pyramid and tetrahedron of SOLID186 with repeated nodes, from a real file: the matrices
/// of C3D20R, C3D15, C3D13 and C3D10.
#[test]
fn repeated_nodes_make_other_shapes() {
    let mut solids = mesh(&archive("all_solid_cells"));
    let kinds: Vec<ElementKind> = solids.elements.iter().map(|e| e.kind).collect();
    use ElementKind::{Hexahedron20, Pyramid13, Tetrahedron10, Wedge15};
    assert_eq!(kinds, [Hexahedron20, Wedge15, Pyramid13, Tetrahedron10]);
    solids.set_material(2.1e11, 0.3, 7850.0).unwrap();
    let rest = "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*MATERIAL, NAME=M\n*ELASTIC\n2.1e11, 0.3\n*DENSITY\n7850.\n";
    let other = of_abaqus(&in_abaqus(&solids, alike, rest), Code::CalculiX);
    assert_eq!(other.elements.len(), 4);
    for (own, same) in solids.elements.iter().zip(&other.elements) {
        let alone = |mesh: &Mesh, element: &Element| {
            let mut alone = mesh.clone();
            alone.elements = vec![*element];
            assemble(&alone, &Rules::default()).unwrap()
        };
        let (found, exact) = (alone(&solids, own), alone(&other, same));
        let (a, b) = (&found.stiffness, &exact.stiffness);
        assert!(a.size() >= 30 && a.size() == b.size());
        for column in 0..a.size() {
            assert_eq!(a.column(column), b.column(column));
        }
    }
    let words = form::warnings(&solids, &Rules::default()).join("\n");
    assert!(
        words.contains("SOLID186 (KEYOPT(2) = 0, pyramid)") && words.contains("2³ points"),
        "{words}"
    );
    // a wedge of the other corners is no shape of ANSYS
    let turned = archive("all_solid_cells").replace(
        "    4488    5692    5649    5697    5697",
        "    4488    5692    5692    5649    5697",
    );
    let error = read_cdb(&Memory::new(&[("a.cdb", &turned)]), "a.cdb").unwrap_err();
    assert!(
        error.to_string().contains("element 4488 (SOLID186)"),
        "{error}"
    );
}

/// A real file of HyperMesh: SHELL181 with a thickness of constants, against S4 of the same mesh.
#[test]
fn shells_of_hypermesh() {
    let shells = mesh(&archive("hypermesh"));
    assert_eq!((shells.nodes.len(), shells.elements.len()), (105, 80));
    let Section::Shell(section) = shells.properties[0].section else {
        panic!("{:?}", shells.properties)
    };
    assert_eq!(section.thickness, 0.375);
    let rest = "*SHELL SECTION, ELSET=ALL, MATERIAL=M\n0.375, 5\n*MATERIAL, NAME=M\n*ELASTIC\n72000., 0.33\n*DENSITY\n2.57e-9\n";
    let other = of_abaqus(&in_abaqus(&shells, alike, rest), Code::Abaqus);
    let exact = frequencies(other, Rules::default(), 10);
    let found = frequencies(shells, Rules::default(), 10);
    assert!(apart(&found, &exact) < 1e-10, "{found:?} {exact:?}");
}

fn node(id: u64, place: [f64; 3], angles: &[f64]) -> String {
    let values = place.iter().chain(angles);
    let values: String = values
        .map(|x| format!("{:>21}", format!("{x:.13e}")))
        .collect();
    format!("{id:9}{:9}{:9}{values}\n", 0, 0)
}

/// An element: type, material, constants, section, number, nodes.
fn element(of: [u64; 4], id: u64, nodes: &[u64]) -> String {
    let [kind, material, real, section] = of;
    let count = nodes.len() as u64;
    let first = [material, kind, real, section, 0, 0, 0, 0, count, 0, id];
    let mut text = String::new();
    for (at, number) in first.iter().chain(nodes).enumerate() {
        if at == 19 {
            text.push('\n');
        }
        write!(text, "{number:9}").unwrap();
    }
    text + "\n"
}

const PLACES: [[f64; 3]; 14] = [
    [0.0, 0.0, 0.0],
    [20.0, 0.0, 0.0],
    [20.0, 21.0, 0.0],
    [0.0, 20.0, 0.0],
    [0.0, 0.0, 20.0],
    [20.0, 0.0, 20.0],
    [20.0, 20.0, 22.0],
    [0.0, 20.0, 20.0],
    [0.0, 0.0, 40.0],
    [20.0, 0.0, 40.0],
    [20.0, 20.0, 40.0],
    [0.0, 20.0, 40.0],
    [50.0, 0.0, 40.0],
    [50.0, 20.0, 45.0],
];

/// Two SOLID185, two SHELL181 of two layers, a mass, springs, an equation, coupled freedoms, supports, of
/// which one is in turned axes.
fn small() -> String {
    let nodes: String = PLACES
        .iter()
        .zip(1_u64..)
        .map(|(place, id)| {
            let angles: &[f64] = if id == 3 { &[30.0, 0.0, 0.0] } else { &[] };
            node(id, *place, angles)
        })
        .collect();
    let elements = [
        element([1, 1, 1, 1], 1, &[1, 2, 3, 4, 5, 6, 7, 8]),
        element([1, 1, 1, 1], 2, &[5, 6, 7, 8, 9, 10, 11, 12]),
        element([2, 1, 1, 5], 3, &[9, 10, 11, 12]),
        element([2, 1, 1, 5], 4, &[10, 13, 14, 11]),
        element([3, 1, 7, 1], 5, &[13]),
        element([4, 1, 8, 1], 6, &[2, 8]),
        element([5, 1, 8, 1], 7, &[2, 3]),
    ]
    .concat();
    format!(
        "\
/COM, a small model
/UNITS,MPA
/PREP7
ET,1,SOLID185
ET,2,181
KEYOPT,2,3,2
ET,3,MASS21
ET,4,COMBIN14
ET,5,COMBIN14,,1
NBLOCK,6,SOLID,14,14
(3i9,6e21.13e3)
{nodes}N,R5.3,LOC,       -1,
EBLOCK,19,SOLID,7,7
(19i9)
{elements}       -1
CMBLOCK,TOP     ,NODE,       2  ! a range
(8i10)
         9       -12
CMBLOCK,SHEET   ,ELEM,       1
(8i10)
         4
MPTEMP,R5.0, 1, 1,  0.00000000    ,
MPDATA,R5.0, 1,EX  ,       1, 1,  210000.000    ,
MPDATA,R5.0, 1,NUXY,       1, 1, 0.300000000    ,
MPDATA,R5.0, 1,DENS,       1, 1, 7.850000000E-09,
MP,EX,2,70000
MP,PRXY,2,0.33
MP,DENS,2,2.7e-9
SECTYPE,5,SHELL,,sheet
SECOFFSET,BOT
SECBLOCK,2
  1.500000000    ,       1,   0.00000000    ,       5
 0.5,2,45,3
RLBLOCK,       1,       7,       6,       7
(2i8,6g16.9)
(7g16.9)
       7       6 0.100000000E-04 0.100000000E-04 0.100000000E-04 0.200000000E-03 0.300000000E-03 0.400000000E-03
R,8,1500.,0,0
CE,R5.0,DEFI,       2,       1,  0.00000000
CE,R5.0,NODE,         4,UX  ,  1.00000000    ,         8,UX  , -0.50000000
CP,3,UZ,5,8
D,         1,ALL ,  0.00000000    ,  0.00000000
D,2,UZ
D,3,UY,0
FINISH
"
    )
}

/// The same in the language of Abaqus.
fn small_of_abaqus() -> String {
    let nodes: String = PLACES
        .iter()
        .zip(1..)
        .map(|([x, y, z], id)| format!("{id}, {x}, {y}, {z}\n"))
        .collect();
    format!(
        "\
*NODE
{nodes}*NSET, NSET=TURNED
3
*TRANSFORM, NSET=TURNED
0.8660254037844386, 0.5, 0., -0.5, 0.8660254037844386, 0.
*ELEMENT, TYPE=C3D8, ELSET=BLOCK
1, 1,2,3,4,5,6,7,8
2, 5,6,7,8,9,10,11,12
*ELEMENT, TYPE=S4, ELSET=SHEET
3, 9,10,11,12
4, 10,13,14,11
*ELEMENT, TYPE=MASS, ELSET=POINT
5, 13
*ELEMENT, TYPE=ROTARYI, ELSET=TURNS
15, 13
*ELEMENT, TYPE=SPRINGA, ELSET=ALONG
6, 2, 8
*ELEMENT, TYPE=SPRING2, ELSET=APART
7, 2, 3
*SOLID SECTION, ELSET=BLOCK, MATERIAL=ONE
*SHELL SECTION, ELSET=SHEET, COMPOSITE, OFFSET=SNEG
1.5, , ONE, 0.
0.5, , TWO, 45.
*MATERIAL, NAME=ONE
*ELASTIC
210000., 0.3
*DENSITY
7.85e-9
*MATERIAL, NAME=TWO
*ELASTIC
70000., 0.33
*DENSITY
2.7e-9
*MASS, ELSET=POINT
1e-5
*ROTARY INERTIA, ELSET=TURNS
2e-4, 3e-4, 4e-4, 0., 0., 0.
*SPRING, ELSET=ALONG

1500.
*SPRING, ELSET=APART
1, 1
1500.
*EQUATION
2
4, 1, 1., 8, 1, -0.5
*EQUATION
2
8, 3, 1., 5, 3, -1.
*BOUNDARY
1, 1, 6
2, 3
3, 2
"
    )
}

#[test]
fn a_small_archive_is_the_same_in_abaqus() {
    let found = mesh(&small());
    let layers: Vec<_> = found.laminates[0].iter().map(|l| l.thickness).collect();
    assert_eq!(layers, [1.5, 0.5]);
    assert_eq!(found.shell_shapes[0].offsets, [1.0; 4]);
    assert_eq!(
        found.supports[1],
        Support {
            node: 1,
            components: 4
        }
    );
    assert_eq!((found.ties.len(), found.springs.len()), (2, 2));
    assert_eq!(found.sets["TOP"].nodes(), [8, 9, 10, 11]);
    assert_eq!(found.sets["SHEET"].elements(), [3]);
    let other = of_abaqus(&small_of_abaqus(), Code::Abaqus);
    let rules = Rules {
        mass: Rules::calculix().mass,
        ..Rules::default()
    };
    let exact = frequencies(other, rules, 12);
    let frequencies = frequencies(found, Rules::default(), 12);
    assert!(
        apart(&frequencies, &exact) < 1e-9,
        "{frequencies:?} {exact:?}"
    );
}

/// Rotations about z, then about the turned x, then about the turned y.
#[test]
fn axes_of_nodes() {
    let of = |angles: [f64; 3]| {
        let turned = node(3, PLACES[2], &[30.0, 0.0, 0.0]);
        let found = mesh(&small().replace(&turned, &node(3, PLACES[2], &angles)));
        found.frames[0].rotation.map(|row| row.map(f64::round))
    };
    // rows of the matrix; its columns are the axes of the node
    assert_eq!(
        of([90.0, 0.0, 0.0]),
        [[0., -1., 0.], [1., 0., 0.], [0., 0., 1.]]
    );
    assert_eq!(
        of([0.0, 90.0, 0.0]),
        [[1., 0., 0.], [0., 0., -1.], [0., 1., 0.]]
    );
    assert_eq!(
        of([0.0, 0.0, 90.0]),
        [[0., 0., 1.], [0., 1., 0.], [-1., 0., 0.]]
    );
    assert_eq!(
        of([90.0, 90.0, 0.0]),
        [[0., 0., 1.], [1., 0., 0.], [0., 1., 0.]]
    );
}

/// `/UNITS` that differ from those of the model are doubted.
#[test]
fn units_of_the_archive() {
    for (units, doubted) in [("mm_tonne_s", false), ("m_kg_s", true)] {
        let mut found = mesh(&small());
        found.convert(&MeshUnits::named(units).unwrap());
        let doubts = found.doubts.join("\n");
        assert_eq!(
            doubts.contains("the units MPA"),
            doubted,
            "{units}: {doubts}"
        );
    }
}

/// Damaged or refused archives: a change of the small one, and the message.
#[test]
fn wrong_archives_and_their_messages() {
    let small = small();
    let mut said = String::new();
    for (from, to) in [
        ("N,R5.3,LOC,       -1,", "       14        0        0\n"),
        ("(3i9,6e21.13e3)", "(3x9)"),
        ("       -1\nCMBLOCK,TOP", "CMBLOCK,TOP"),
        ("EBLOCK,19,SOLID,7,7", "EBLOCK,10,,,8"),
        ("        8        0        1        1", "        8        0"),
        (
            "       10       13       14       11",
            "       10       13       99       11",
        ),
        (
            "       10       13       14       11",
            "       10       13       13       11",
        ),
        ("ET,2,181\nKEYOPT,2,3,2", ""),
        ("KEYOPT,2,3,2", "KEYOPT,9,3,2"),
        ("ET,2,181", "ET,TID,SHELL"),
        ("ET,1,SOLID185", "ET,1,SOLID185,,,1"),
        ("ET,1,SOLID185", "ET,1,SOLID185,,,,,,1"),
        ("KEYOPT,2,3,2", "KEYOPT,2,1,2"),
        ("ET,3,MASS21", "ET,3,MASS21,,,4"),
        ("R,8,1500.,0,0", ""),
        ("ET,4,COMBIN14", "ET,4,COMBIN14,1"),
        (
            "EX  ,       1, 1,  210000.000    ",
            "EX  ,       1, 1,  YOUNG",
        ),
        ("MPDATA,R5.0, 1,EX  ,       1, 1,  210000.000    ,", ""),
        (
            "EX  ,       1, 1,  210000.000    ",
            "EX  ,       1, 1,  2e5, 1e5",
        ),
        ("MP,EX,2,70000", "MP,EX,2,70000,-30"),
        ("MP,EX,2,70000", "MP,EX,2,70000\nMP,EY,2,7000"),
        ("MP,PRXY,2,0.33", ""),
        ("SECOFFSET,BOT", "SECOFFSET,USER,0.2"),
        ("SECBLOCK,2", "SECBLOCK,3"),
        ("SECTYPE,5,SHELL", "SECTYPE,6,SHELL"),
        (
            "DEFI,       2,       1,  0.00000000",
            "DEFI,       2,       1,  0.1",
        ),
        ("8,UX  , -0.5", "8,TEMP, -0.5"),
        ("8,UX  , -0.5", "88,UX , -0.5"),
        (
            "CMBLOCK,SHEET   ,ELEM,       1",
            "CMBLOCK,SHEET   ,ELEM,       9",
        ),
        ("N,R5.3,LOC,       -1,", "N,15,1.,2.,3."),
        ("D,2,UZ", "D,77,UZ"),
        ("D,2,UZ", "12  13"),
    ] {
        assert!(small.contains(from), "{from}");
        let changed = small.replace(from, to);
        let error = match read_cdb(&Memory::new(&[("a.cdb", &changed)]), "a.cdb") {
            Err(error) => error,
            Ok(_) => panic!("read: {from:?} → {to:?}"),
        };
        writeln!(said, "{error}\n    {}", error.advice()).unwrap();
    }
    // elements that are read, and computed by no rule here
    for (from, to) in [
        ("ET,1,SOLID185", "ET,1,SOLID185,,1"),
        ("ET,1,SOLID185", "ET,1,SOLID185,,2"),
        ("ET,1,SOLID185", "ET,1,SOLID185,,3"),
    ] {
        let error = assemble(&mesh(&small.replace(from, to)), &Rules::default()).unwrap_err();
        writeln!(said, "{error}\n    {}", error.advice()).unwrap();
    }
    let hexahedra = archive("all_solid_cells").replace("ET, 4, 186", "ET,4,186,,1");
    let mut hexahedra = mesh(&hexahedra);
    hexahedra.set_material(2.1e11, 0.3, 7850.0).unwrap();
    let error = assemble(&hexahedra, &Rules::default()).unwrap_err();
    writeln!(said, "{error}\n    {}", error.advice()).unwrap();
    insta::assert_snapshot!(said);
}

/// Contents that stop the reduction unless `ignore` names them.
#[test]
fn contents_without_reader() {
    let more = "\
SECCONTROL,0,0,0,1e-9
CERIG,1,2,ALL
RBE3,5,ALL,6
*DO,I,1,3
NSEL,ALL
F,1,FX,3
TB,ANEL,1
TB,BISO,1
LUMPM,ON
XYZZY,1
FINISH";
    let found = mesh(
        &small()
            .replace("FINISH", more)
            .replace("ET,2,181", "ET,2,188")
            .replace("ET,5,COMBIN14", "ET,5,200"),
    );
    use eng_flexible::mesh::Carries::{Nothing, Structure, Unknown};
    for (name, carries) in [
        ("BEAM188", Structure),
        ("CERIG", Structure),
        ("SECCONTROL", Structure),
        ("RBE3", Structure),
        ("TB,ANEL", Structure),
        ("*DO", Unknown),
        ("XYZZY", Unknown),
        ("MESH200", Nothing),
        ("NSEL", Nothing),
        ("F", Nothing),
        ("TB,BISO", Nothing),
    ] {
        let found = unread(&found);
        let kind = found.iter().find(|(known, ..)| *known == name);
        assert_eq!(kind.map(|(_, _, kind)| *kind), Some(carries), "{name}");
    }
    assert!(found.doubts[0].contains("lumped"), "{:?}", found.doubts);
}

#[test]
fn another_format_is_named() {
    let deck = Memory::new(&[("a.cdb", "SOL 103\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\n")]);
    let error = read_mesh(&deck, "a.cdb", MeshFormat::Ansys).unwrap_err();
    assert!(
        error.to_string().contains("holds cards of Nastran"),
        "{error}"
    );
    let archive = small();
    let archive = Memory::new(&[("a.bdf", &archive)]);
    let error = read_mesh(&archive, "a.bdf", MeshFormat::Nastran).unwrap_err();
    assert!(
        error.to_string().contains("holds commands of ANSYS"),
        "{error}"
    );
    assert!(error.advice().contains("`ansys(…)`"), "{}", error.advice());
}
