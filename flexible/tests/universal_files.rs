//! Universal files: the same meshes written by gmsh in both formats; all datasets of a small file, in several
//! forms, against the same mesh in the language of Nastran; files of Salome and PERMAS; normal modes; wrong files
//! with their messages.

use std::fmt::Write as _;
use std::io::Read;
use std::path::Path;

use crate::nastran_deck::{self, Memory, element_ids, is_consistent, set_ids, unread};
use eng_flexible::fe::Rules;
use eng_flexible::markers::{MESH_AXES, MarkerRequest};
use eng_flexible::mesh::{Carries, ElementKind, Mesh, Tie};
use eng_flexible::read::matrix::{ForeignModes, ShapeFormat, read_modes};
use eng_flexible::read::universal::read_unv;
use eng_flexible::recover::Recovery;
use eng_flexible::reduce::{Interface, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::store::{Key, StoredBody};
use eng_flexible::units::MeshUnits;
use eng_flexible::{FlexibleError, MeshFormat, read_mesh};
use eng_system::flexible::{ALL_FREEDOMS, MarkerPlace, Selection, Spider};
use eng_system::mesh_files::Stated as _;

/// A file in `tests/data/universal`.
fn data(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/universal");
    let packed = std::fs::read(folder.join(format!("{name}.gz"))).unwrap();
    let mut text = String::new();
    flate2::read::GzDecoder::new(packed.as_slice())
        .read_to_string(&mut text)
        .unwrap();
    text
}

fn try_read(bytes: &[u8]) -> Result<Mesh, FlexibleError> {
    let mut files = Memory::default();
    files.0.insert("a.unv".into(), bytes.to_vec());
    read_unv(&files, "a.unv")
}

fn mesh(bytes: &[u8]) -> Mesh {
    match try_read(bytes) {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error} ({})", error.advice()),
    }
}

/// Mass and inertia, and the frequencies of free modes and of modes with held groups.
fn numbers(mut mesh: Mesh) -> Vec<f64> {
    mesh.convert(&MeshUnits::named("mm_tonne_s").unwrap());
    mesh.set_material(2.1e11, 0.3, 7850.0).unwrap();
    let marker = |name: &str| MarkerRequest {
        axes: MESH_AXES,
        name: name.into(),
        place: MarkerPlace::Gathered {
            nodes: Selection::Set(name.into()),
            tie: Spider::Averaging,
            center: None,
        },
    };
    let at = |marker| Interface {
        marker,
        components: ALL_FREEDOMS,
    };
    let request = |fixed: Vec<Interface>, more: Option<Term>| Request {
        markers: vec![marker("LEFT"), marker("RIGHT")],
        terms: std::iter::once(Term::Normal {
            modes: Modes::Count(8),
            fixed,
        })
        .chain(more)
        .collect(),
        ..Request::default()
    };
    let free = reduce(mesh.clone(), &request(Vec::new(), None)).unwrap();
    let held = request(vec![at(0)], Some(Term::Constraint(vec![at(0), at(1)])));
    let held = reduce(mesh, &held).unwrap();
    let invariants = &free.body.invariants;
    let mut found = vec![invariants.mass];
    found.extend(invariants.inertia.iter().flatten());
    found.extend(&free.body.frequencies);
    found.extend(&held.body.frequencies);
    found
}

/// Nodes of each solid by their numbers, sorted by solid.
fn solids(mesh: &Mesh) -> Vec<Vec<u64>> {
    let ids = mesh.elements.iter().map(|e| element_ids(mesh, e.id));
    let mut ids: Vec<Vec<u64>> = ids.collect();
    ids.sort();
    ids
}

/// gmsh writes each block as `.msh` and as `.unv`: the same elements, groups, mass, inertia and frequencies.
#[test]
fn blocks_of_gmsh_are_the_same_in_both_formats() {
    use ElementKind::{Hexahedron8, Hexahedron20, Tetrahedron4, Tetrahedron10, Wedge6, Wedge15};
    for (name, kind) in [
        ("tet1", Tetrahedron4),
        ("tet2", Tetrahedron10),
        ("hex1", Hexahedron8),
        ("hex2", Hexahedron20),
        ("wedge1", Wedge6),
        ("wedge2", Wedge15),
    ] {
        let own = mesh(data(&format!("{name}.unv")).as_bytes());
        is_consistent(&own);
        let text = data(&format!("{name}.msh"));
        let other =
            read_mesh(&Memory::new(&[("a.msh", &text)]), "a.msh", MeshFormat::Gmsh).unwrap();
        assert!(own.elements.iter().all(|e| e.kind == kind), "{name}");
        assert_eq!(solids(&own), solids(&other), "{name}");
        for set in ["LEFT", "RIGHT", "BLOCK"] {
            assert_eq!(set_ids(&own, set), set_ids(&other, set), "{name} {set}");
        }
        assert_eq!(set_ids(&own, "group:21"), set_ids(&own, "LEFT"));
        let faces = unread(&own);
        assert_eq!(faces.len(), 1, "{faces:?}");
        assert_eq!(
            (faces[0].0, faces[0].2),
            ("lines and surfaces on solids", Carries::Nothing)
        );
        let (found, exact) = (numbers(own), numbers(other));
        assert!(found.len() > 25, "{found:?}");
        for (x, y) in found.iter().zip(&exact) {
            let scale = y.abs().max(1e-6 * exact[0]);
            assert!((x - y).abs() <= 1e-12 * scale, "{name}: {x} {y}");
        }
    }
}

const PLACES: [[f64; 3]; 13] = [
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
    [10.0, 10.0, 55.5],
];

/// Whole numbers of ten columns each, eight on a line.
fn whole(numbers: &[u64]) -> String {
    let mut text = String::new();
    for line in numbers.chunks(8) {
        for number in line {
            write!(text, "{number:10}").unwrap();
        }
        text.push('\n');
    }
    text
}

/// A real number with the exponent of a double of Fortran.
fn double(value: f64) -> String {
    let plain = format!("{value:.16e}");
    let (digits, exponent) = plain.split_once('e').unwrap();
    let exponent: i32 = exponent.parse().unwrap();
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{:>25}", format!("{digits}D{sign}{:02}", exponent.abs()))
}

fn dataset(number: &str, records: &str) -> String {
    format!("    -1\n{number:>6}\n{records}    -1\n")
}

fn nodes(first: u64) -> String {
    let node =
        |(place, id): (&[f64; 3], u64)| whole(&[id, 1, 1, 11]) + &place.map(double).concat() + "\n";
    PLACES.iter().zip(first..).map(node).collect()
}

fn element(id: u64, descriptor: u64, nodes: &[u64], first: u64) -> String {
    let nodes: Vec<u64> = nodes.iter().map(|node| node + first - 1).collect();
    whole(&[id, descriptor, 4, 2, 7, nodes.len() as u64]) + &whole(&nodes)
}

/// Two hexahedra, the last of whose faces is tied to node 13 by a rigid element.
fn elements(first: u64) -> String {
    [
        element(1, 115, &[1, 2, 3, 4, 5, 6, 7, 8], first),
        element(2, 115, &[5, 6, 7, 8, 9, 10, 11, 12], first),
        element(7, 122, &[13, 9, 10, 11, 12], first),
    ]
    .concat()
}

fn units(factors: [f64; 3]) -> String {
    let factors = factors.map(double).concat();
    dataset(
        "164",
        &format!(
            "        10mm (newton)                  2\n{factors}\n{}\n",
            double(273.15)
        ),
    )
}

fn systems() -> String {
    let rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
    let rows: String = rows
        .iter()
        .map(|row| row.map(double).concat() + "\n")
        .collect();
    dataset(
        "2420",
        &format!("         1\n\n{}Global\n{rows}", whole(&[1, 0, 8])),
    )
}

/// Nodes of which the first has this number, elements, groups, and results.
fn small(first: u64) -> String {
    let top = [9, 10, 11, 12]
        .map(|node| [7, node + first - 1, 0, 0])
        .concat();
    let solid = [8, 2, 0, 0, 2, 77, 0, 0];
    [
        dataset("151", "a header\nof lines\n"),
        units([1000.0, 1.0, 1.0]),
        systems(),
        dataset("2411", &nodes(first)),
        dataset("2412", &elements(first)),
        dataset(
            "2467",
            &[
                whole(&[3, 0, 0, 0, 0, 0, 0, 4]),
                "TOP FACE\n".into(),
                whole(&top),
                whole(&[4, 0, 0, 0, 0, 0, 0, 2]),
                "\n".into(),
                whole(&solid),
            ]
            .concat(),
        ),
        dataset(
            "2430",
            &(whole(&[5, 0, 0, 0, 0, 0, 0, 1]) + "PART\n" + &whole(&[8, 1])),
        ),
        dataset("55", "results\n 1 2 3\n"),
    ]
    .concat()
}

/// The same in the language of Nastran.
fn small_of_nastran() -> String {
    let nodes: String = PLACES
        .iter()
        .zip(1..)
        .map(|([x, y, z], id)| format!("GRID,{id},,{x:?},{y:?},{z:?}\n"))
        .collect();
    format!(
        "BEGIN BULK\n{nodes}CHEXA,1,4,1,2,3,4,5,6\n,7,8\nCHEXA,2,4,5,6,7,8,9,10\n,11,12\n\
         RBE2,7,13,123456,9,10,11,12\nPSOLID,4,1\nMAT1,1,210000.,,0.3,7.85-9\nENDDATA\n"
    )
}

fn frequencies(mesh: Mesh) -> Vec<f64> {
    let request = Request {
        rules: Rules::exact(),
        markers: vec![MarkerRequest {
            axes: MESH_AXES,
            name: "hub".into(),
            place: MarkerPlace::Node(13),
        }],
        terms: vec![Term::Normal {
            modes: Modes::Count(12),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    reduce(mesh, &request).unwrap().body.frequencies
}

#[test]
fn a_small_file_is_the_same_in_nastran() {
    let mut small = mesh(small(1).as_bytes());
    is_consistent(&small);
    assert_eq!(set_ids(&small, "TOP FACE"), [9, 10, 11, 12]);
    assert_eq!(set_ids(&small, "group:3"), [9, 10, 11, 12]);
    assert_eq!(small.sets["group:4"].elements(), [1]);
    assert_eq!(small.sets["PART"].elements(), [0]);
    assert_eq!(set_ids(&small, "PART"), [1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(small.sets["material:2"].elements(), [0, 1]);
    assert_eq!(small.properties[0].name, "4");
    assert_eq!(small.units, Some(("mm (newton)".into(), [1e-3, 1e3, 1.0])));
    assert!(
        matches!(&small.ties[0], Tie::Rigid { id: 7, independent: 12, dependent } if dependent.len() == 4)
    );
    let names: Vec<_> = unread(&small).into_iter().map(|(name, ..)| name).collect();
    assert_eq!(
        names,
        [
            "151 (header)",
            "164 (units)",
            "55 (results at nodes)",
            "members of groups that are no nodes and elements"
        ]
    );
    assert!(
        unread(&small)
            .iter()
            .all(|(.., carries)| *carries == Carries::Nothing)
    );
    let units = MeshUnits::named("mm_tonne_s").unwrap();
    small.convert(&units);
    small.set_material(2.1e11, 0.3, 7850.0).unwrap();
    let mut other = nastran_deck::mesh(&small_of_nastran());
    other.convert(&units);
    let (found, exact) = (frequencies(small), frequencies(other));
    for (x, y) in found.iter().zip(&exact) {
        assert!((x / y - 1.0).abs() < 1e-9, "{found:?} {exact:?}");
    }
}

/// The parts of a mesh that do not know their lines.
fn contents(mesh: &Mesh) -> String {
    let Mesh {
        nodes,
        elements,
        connectivity,
        ties,
        sets,
        units,
        ..
    } = mesh;
    format!("{:?}", (nodes, elements, connectivity, ties, sets, units))
}

#[test]
fn one_file_in_several_forms() {
    let plain = small(1);
    let expected = contents(&mesh(plain.as_bytes()));
    let same = |text: &str| assert_eq!(contents(&mesh(text.as_bytes())), expected);
    same(&plain.replace('\n', "\r\n"));
    same(&plain.replace("    -1\n", "-1\n\n"));
    // remarks between datasets
    same(&plain.replace(
        "    -1\n    -1\n",
        "    -1\nWorkpiece\nFile of 1 Jun\n    -1\n",
    ));
    same(&plain.replace("D+", "E+").replace("D-", "e-"));
    // one blank between the numbers
    let free: Vec<String> = plain
        .lines()
        .map(|line| match line.starts_with("        10mm") {
            true => line.into(),
            false => line.split_whitespace().collect::<Vec<_>>().join(" "),
        })
        .collect();
    same(&(free.join("\n") + "\n"));
    // without the last line end
    same(plain.trim_end());
    // dataset 781 has the form of 2411; 780 has bins
    same(&plain.replace("  2411\n", "   781\n"));
    let bins = |id: u64, kind: u64, count: u64| whole(&[id, kind, 1, 4, 1, 2, 7, count]);
    let old = plain
        .replace("  2412\n", "   780\n")
        .replace(&whole(&[1, 115, 4, 2, 7, 8]), &bins(1, 115, 8))
        .replace(&whole(&[2, 115, 4, 2, 7, 8]), &bins(2, 115, 8))
        .replace(&whole(&[7, 122, 4, 2, 7, 5]), &bins(7, 122, 5));
    same(&old);
    // groups after 2430 and before the nodes
    let (before, after) = plain.split_at(plain.find("    -1\n  2467").unwrap());
    same(&(after.to_owned() + before));
}

/// Numbers of ten digits fill their columns.
#[test]
fn numbers_that_touch_each_other() {
    let large = small(4_000_000_001);
    assert!(large.contains("40000000054000000006"), "{large}");
    let mut found = mesh(large.as_bytes());
    for node in &mut found.nodes {
        node.id -= 4_000_000_000;
    }
    assert_eq!(contents(&found), contents(&mesh(small(1).as_bytes())));
    let real = |x: f64| format!("{:>13}", format!("{x:.6e}").replace('e', "E+0"));
    let line = |id: u64, place: [f64; 3]| {
        whole(&[id, 0, 0, 11]).trim_end().to_owned() + &place.map(real).concat() + "\n"
    };
    let places = [
        [-100.5, -200.25, -300.0],
        [-90.5, -200.25, -300.0],
        [-100.5, -190.0, -300.0],
        [-100.5, -200.25, -280.0],
    ];
    let nodes: String = places
        .iter()
        .zip(1..)
        .map(|(place, id)| line(id, *place))
        .collect();
    assert!(
        nodes.contains("-1.005000E+02-2.002500E+02-3.000000E+02"),
        "{nodes}"
    );
    let one = dataset("15", &nodes) + &dataset("2412", &element(1, 111, &[1, 2, 3, 4], 1));
    let found = mesh(one.as_bytes());
    let positions: Vec<_> = found.nodes.iter().map(|node| node.position).collect();
    assert_eq!(positions, places);
}

/// Binary functions (58b) of a stated number of bytes, among which are lines that end a dataset.
#[test]
fn binary_functions_are_skipped() {
    let plain = small(1);
    let data = b"\x00\x01\xff\n    -1\n\x00\n    -1\n  2411\nx";
    let with = |count: usize| {
        let mut bytes = format!("    -1\n    58b     1     2           3{count:12}     0     0           0           0\n")
            .into_bytes();
        bytes.extend(b"one\ntwo\nthree\n");
        bytes.extend(data);
        bytes.extend(b"\n    -1\n");
        bytes.extend(plain.as_bytes());
        bytes
    };
    let found = mesh(&with(data.len()));
    assert_eq!(contents(&found), contents(&mesh(plain.as_bytes())));
    let name = unread(&found)
        .into_iter()
        .find(|(name, ..)| name.starts_with("58"));
    assert_eq!(name, Some(("58 (functions)", 1, Carries::Nothing)));
    let error = try_read(&with(1_000_000)).unwrap_err().to_string();
    assert!(
        error.contains("a.unv:2: dataset 58: the file ends inside it"),
        "{error}"
    );
    // lines of the skipped bytes count
    let broken = with(data.len());
    let text = String::from_utf8_lossy(&broken)
        .replace("2.1000000000000000D+01", "2.1000000000000000X+01");
    let lines = text
        .split('\n')
        .position(|line| line.contains("X+01"))
        .unwrap()
        + 1;
    let start = broken.len() - plain.len();
    let mut broken = broken[..start].to_vec();
    broken.extend(
        plain
            .replace("2.1000000000000000D+01", "2.1000000000000000X+01")
            .as_bytes(),
    );
    let error = try_read(&broken).unwrap_err().to_string();
    assert!(
        error.starts_with(&format!("a.unv:{lines}: dataset 2411")),
        "{error} {lines}"
    );
}

/// Damaged or refused files: a change of the small one, and the message.
#[test]
fn wrong_files_and_their_messages() {
    let small = small(1);
    let cut = small.find("TOP FACE").unwrap() + 9;
    let mut said = String::new();
    let second = whole(&[2, 115, 4, 2, 7, 8]);
    let nodes_of_second = whole(&[5, 6, 7, 8, 9, 10, 11, 12]);
    let seventh = whole(&[7, 1, 1, 11]);
    let swap = |from: &str, to: &str| {
        assert!(small.contains(from), "{from}");
        small.replacen(from, to, 1)
    };
    for changed in [
        String::new(),
        "a text\n".into(),
        "    -1\n  mesh\n".into(),
        "    -1\n".into(),
        dataset("2411", ""),
        dataset("2411", &nodes(1)),
        small[..cut].into(),
        swap("    -1\n  2412", "  2412"),
        swap(&seventh, ""),
        swap(&seventh, &whole(&[7, 1, 1])),
        swap(&seventh, "        -7         1         1        11\n"),
        swap(&seventh, "         x         1         1        11\n"),
        swap(&seventh, &whole(&[99_999_999_999, 1, 1, 11])),
        swap(&seventh, &whole(&[6, 1, 1, 11])),
        swap(&seventh, &whole(&[7, 5, 1, 11])),
        swap("2.2000000000000000D+01", "2.2000000000000000F+01"),
        swap("2.2000000000000000D+01", "2.2000000000000000D+999"),
        swap(&second, &whole(&[1, 115, 4, 2, 7, 8])),
        swap(&second, &whole(&[2, 115, 4, 2, 7, 7])),
        swap(&second, &whole(&[2, 115, 4, 2, 7])),
        swap(
            &second,
            "         2       115         4         2         7        -8\n",
        ),
        swap(&second, &whole(&[2, 116, 4, 2, 7, 20])),
        swap(&second, &whole(&[2, 24, 4, 2, 7, 3])),
        swap(&nodes_of_second, &whole(&[5, 6, 7, 8, 9, 10, 11])),
        swap(&nodes_of_second, &whole(&[5, 6, 7, 8, 9, 10, 11, 99])),
        swap(&nodes_of_second, &whole(&[5, 6, 7, 8, 9, 10, 11, 11])),
        swap(&nodes_of_second, &whole(&[5, 6, 7, 8, 9, 10, 11, 0])),
        swap("       122", "       136"),
        swap(
            &whole(&[7, 9, 0, 0, 7, 10, 0, 0]),
            &whole(&[7, 9, 0, 0, 7, 90, 0, 0]),
        ),
        swap(
            &whole(&[8, 2, 0, 0, 2, 77, 0, 0]),
            &whole(&[8, 3, 0, 0, 2, 77, 0, 0]),
        ),
        swap(
            &whole(&[3, 0, 0, 0, 0, 0, 0, 4]),
            &whole(&[3, 0, 0, 0, 0, 0, 0, 5]),
        ),
        swap(
            &whole(&[3, 0, 0, 0, 0, 0, 0, 4]),
            "         3         0         0         0         0         0         0        -4\n",
        ),
        swap(&whole(&[1, 0, 8]), &whole(&[1, 1, 8])),
        swap(&systems(), &systems().replace(&double(0.0), &double(0.5))),
        swap(&units([1000.0, 1.0, 1.0]), &units([0.0, 1.0, 1.0])),
        swap(&units([1000.0, 1.0, 1.0]), &dataset("164", "")),
        swap(
            &units([1000.0, 1.0, 1.0]),
            &(units([1.0; 3]) + &units([1000.0, 1.0, 1.0])),
        ),
        swap("    -1\n    55\n", "    -1\n    58b     1     2\n"),
        small
            .replace("       115", "        94")
            .replace("         8\n", "         4\n"),
    ] {
        match try_read(changed.as_bytes()) {
            Err(error) => writeln!(said, "{error}\n    {}", error.advice()).unwrap(),
            Ok(mesh) => writeln!(said, "READ {:?}", unread(&mesh)).unwrap(),
        }
    }
    insta::assert_snapshot!(said);
}

/// Text between datasets is a remark if a dataset follows it. Otherwise a stray -1 may have ended a dataset early.
#[test]
fn text_after_a_stray_end_of_a_dataset() {
    let small = small(1);
    let header = dataset("151", "a header\nof lines\n");
    let rest = small.strip_prefix(&header).unwrap();
    let ended = "    -1\n   151\na header\n    -1\nof lines\n";
    let lines = small.lines().count();
    for (text, line) in [
        // the end of the dataset, and the next one
        (format!("{ended}    -1\n{rest}"), 5),
        // the end of the dataset and of the file, with data and without
        (format!("{small}{ended}    -1\n"), lines + 5),
        (format!("{small}{ended} 1 2 3\n    -1\n"), lines + 5),
        (format!("{small}{ended}Remark\n\n"), lines + 5),
    ] {
        let error = try_read(text.as_bytes()).unwrap_err();
        let message = format!("a.unv:{line}: \"of lines\" is outside a dataset");
        assert!(error.to_string().contains(&message), "{error}");
        assert!(!error.advice().is_empty());
    }
}

/// Contents that stop the reduction unless `ignore` names them; shells and beams are faces and edges of solids
/// in a file without tables alone.
#[test]
fn contents_without_reader() {
    let shell = whole(&[20, 94, 1, 1, 7, 4]) + &whole(&[9, 10, 11, 12]);
    let beam = whole(&[21, 21, 1, 1, 7, 2]) + &whole(&[0, 1, 1]) + &whole(&[9, 10]);
    let free = whole(&[22, 21, 1, 1, 7, 2]) + &whole(&[0, 1, 1]) + &whole(&[9, 13]);
    let spring = whole(&[23, 136, 1, 1, 7, 2]) + &whole(&[9, 10]);
    let damper = whole(&[24, 141, 1, 1, 7, 2]) + &whole(&[9, 10]);
    let other = whole(&[25, 999, 1, 1, 7, 1]) + &whole(&[9]);
    let with = |text: &str| small(1) + text;
    let all = [&shell, &beam, &free, &spring, &damper, &other]
        .map(String::as_str)
        .concat();
    let more = dataset("2412", &all) + &dataset("4711", "any text\n1 2 3\n");
    let found = mesh(with(&more).as_bytes());
    use Carries::{Nothing, Structure, Unknown};
    let expect = |mesh: &Mesh, list: &[(&str, u64, Carries)]| {
        let found = unread(mesh);
        for wanted in list {
            assert!(found.contains(wanted), "{wanted:?}: {found:?}");
        }
    };
    expect(
        &found,
        &[
            ("lines and surfaces on solids", 2, Nothing),
            ("element 21 (linear beam)", 1, Structure),
            ("element 136 (spring between nodes)", 1, Structure),
            ("element 141 (damper between nodes)", 1, Nothing),
            ("element 999", 1, Unknown),
            ("4711 (unknown dataset)", 1, Unknown),
        ],
    );
    let tables = dataset("2448", "properties\n") + &dataset("1710", "materials\n");
    let found = mesh(with(&(more + &tables)).as_bytes());
    expect(
        &found,
        &[
            (
                "element 94 (thin shell, linear quadrilateral)",
                1,
                Structure,
            ),
            ("element 21 (linear beam)", 2, Structure),
            ("2448 (physical properties)", 1, Structure),
            ("1710 (materials)", 1, Structure),
        ],
    );
}

#[test]
fn another_format_is_named() {
    let text = small(1);
    let files = Memory::new(&[("a.bdf", &text), ("a.unv", "GRID,1,,0.,0.,0.\n")]);
    let error = read_mesh(&files, "a.bdf", MeshFormat::Nastran).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("holds datasets of a universal file"),
        "{error}"
    );
    assert!(
        error.advice().contains("`universal(…)`"),
        "{}",
        error.advice()
    );
    let error = read_mesh(&files, "a.unv", MeshFormat::Universal).unwrap_err();
    assert!(
        error.to_string().contains("holds cards of Nastran"),
        "{error}"
    );
}

/// A box of 200 × 10 × 50 mm that Salome wrote, with faces and edges in groups. The file states metres.
#[test]
fn a_box_of_salome() {
    let mut own = mesh(data("salome.unv").as_bytes());
    is_consistent(&own);
    assert_eq!(own.elements.len(), 149);
    let all = |name: &str, x: f64| {
        let nodes = own.sets[name].nodes();
        let own_x = |node: &u32| own.nodes[*node as usize].position[0];
        nodes.len() > 4 && nodes.iter().all(|node| own_x(node) == x)
    };
    assert!(all("Left_Side", 0.0) && all("Right_Side", 200.0));
    assert_eq!(
        own.units,
        Some(("SI: Meter (newton)".into(), [1.0, 1.0, 1.0]))
    );
    own.convert(&MeshUnits::named("mm_tonne_s").unwrap());
    own.set_material(2.1e11, 0.3, 7850.0).unwrap();
    let request = Request {
        terms: vec![Term::Normal {
            modes: Modes::Count(1),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    let report = reduce(own, &request).unwrap().report;
    assert!(
        (report.body.mass / 0.785 - 1.0).abs() < 1e-12,
        "{}",
        report.body.mass
    );
    for (x, expected) in report.body.centre.iter().zip([0.1, 0.005, 0.025]) {
        assert!((x - expected).abs() < 1e-13, "{x}");
    }
}

/// Real numbers of 13 columns, six on a line.
fn singles(values: &[f64]) -> String {
    let one = |value: &f64| {
        let plain = format!("{value:.5e}");
        let (digits, exponent) = plain.split_once('e').unwrap();
        let exponent: i32 = exponent.parse().unwrap();
        let sign = if exponent < 0 { '-' } else { '+' };
        format!("{:>13}", format!("{digits}E{sign}{:02}", exponent.abs()))
    };
    let lines = values.chunks(6);
    lines
        .map(|line| line.iter().map(one).collect::<String>() + "\n")
        .collect()
}

/// A shape: the values of each node.
type Values<'a> = [(u64, &'a [f64])];

fn at_nodes(values: &Values<'_>) -> String {
    let node = |(node, values): &(u64, &[f64])| whole(&[*node]) + &singles(values);
    values.iter().map(node).collect()
}

/// A mode as dataset 55.
fn mode_of_55(number: u64, frequency: f64, kind: [u64; 6], values: &Values<'_>) -> String {
    let head = [
        "NONE\n\na third line\nNONE\nNONE\n".to_owned(),
        whole(&kind),
        whole(&[2, 4, 1, number]),
        singles(&[frequency, 0.0, 0.0, 0.0]),
    ];
    dataset("55", &(head.concat() + &at_nodes(values)))
}

/// A mode as dataset 2414, at a location.
fn mode_of_2414(
    (number, frequency): (u64, f64),
    location: u64,
    kind: [u64; 6],
    values: &Values<'_>,
) -> String {
    let mut reals = [0.0; 12];
    reals[1] = frequency;
    let head = [
        whole(&[number]),
        "\n".to_owned(),
        whole(&[location]),
        "NONE\n\na third line\nNONE\nNONE\n".to_owned(),
        whole(&kind),
        whole(&[0, 0, 1, 0, 0, number, 0, 0]),
        whole(&[0, 0]),
        singles(&reals),
    ];
    dataset("2414", &(head.concat() + &at_nodes(values)))
}

fn shapes_of(text: &str) -> Result<ForeignModes, FlexibleError> {
    read_modes(
        &Memory::new(&[("a.unv", text)]),
        "a.unv",
        ShapeFormat::Universal,
    )
}

const FIRST: &Values<'_> = &[(11, &[1.0, -0.5, 0.25]), (40, &[0.0, 2.0, -3.0])];
const SECOND: &Values<'_> = &[(11, &[-1e-3, 0.5, 7.0]), (40, &[4.0, 0.0, 0.125])];
const TRANSLATIONS: [u64; 6] = [1, 2, 2, 8, 2, 3];

#[test]
fn normal_modes_of_universal_files() {
    let are_the_modes = |modes: &ForeignModes| {
        assert_eq!(modes.nodes, [11, 40]);
        assert_eq!(modes.modes.len(), 2);
        for (mode, (number, frequency, values)) in
            modes.modes.iter().zip([(1, 32.0, FIRST), (2, 0.5, SECOND)])
        {
            assert_eq!(mode.number, number);
            let angular = 2.0 * std::f64::consts::PI * frequency;
            assert_eq!(mode.eigenvalue, Some(angular * angular));
            for (row, (_, values)) in mode.shape.iter().zip(values) {
                assert_eq!(row[..3], **values);
                assert_eq!(row[3..], [0.0; 3]);
            }
        }
    };
    let old = mode_of_55(1, 32.0, TRANSLATIONS, FIRST) + &mode_of_55(2, 0.5, TRANSLATIONS, SECOND);
    are_the_modes(&shapes_of(&old).unwrap());
    let new = mode_of_2414((1, 32.0), 1, TRANSLATIONS, FIRST)
        + &mode_of_2414((2, 0.5), 1, TRANSLATIONS, SECOND);
    are_the_modes(&shapes_of(&new).unwrap());
    // beside the mesh, other results, and modes without numbers
    let others = mode_of_55(1, 9.0, [1, 5, 2, 8, 2, 3], FIRST)
        + &mode_of_55(1, 9.0, [1, 2, 2, 9, 2, 3], FIRST)
        + &mode_of_2414((1, 9.0), 2, TRANSLATIONS, FIRST)
        + &mode_of_2414((1, 9.0), 1, [1, 2, 1, 5, 2, 1], &[(11, &[1.0])]);
    let unnumbered = old
        .replace(&whole(&[2, 4, 1, 1]), &whole(&[2, 4, 0, 0]))
        .replace(&whole(&[2, 4, 1, 2]), &whole(&[2, 4, 0, 0]));
    let mesh_alone = small(1).replace(&dataset("55", "results\n 1 2 3\n"), "");
    are_the_modes(&shapes_of(&(mesh_alone + &others + &unnumbered)).unwrap());
    // complex numbers without imaginary parts
    let pairs = |values: &Values<'_>| -> Vec<(u64, Vec<f64>)> {
        let pair = |(node, values): &(u64, &[f64])| {
            let both = values.iter().flat_map(|x| [*x, -0.0]);
            (*node, both.collect())
        };
        values.iter().map(pair).collect()
    };
    let complex = |number, frequency, values: &Values<'_>| {
        let values = pairs(values);
        let values: Vec<(u64, &[f64])> = values
            .iter()
            .map(|(node, values)| (*node, values.as_slice()))
            .collect();
        mode_of_2414((number, frequency), 1, [1, 2, 2, 8, 5, 3], &values)
    };
    are_the_modes(&shapes_of(&(complex(1, 32.0, FIRST) + &complex(2, 0.5, SECOND))).unwrap());
    // rotations, and numbers that touch each other
    let six: &Values<'_> = &[(3, &[1.0, 2.0, 3.0, -4.0, 5.0, 6.0])];
    let mode = mode_of_55(1, 32.0, [1, 2, 3, 8, 2, 6], six);
    let found = shapes_of(&mode).unwrap();
    assert_eq!(found.modes[0].shape, [[1.0, 2.0, 3.0, -4.0, 5.0, 6.0]]);
    let touching = mode.replace("  3.00000E+00 -4.00000E+00", " 3.000000E+00-4.000000E+00");
    assert_ne!(touching, mode);
    assert_eq!(shapes_of(&touching).unwrap().modes, found.modes);
}

/// The type of the data says whether the values may have more than six digits, and their text whether they have them.
#[test]
fn digits_of_modes() {
    let digits = |text: &str| {
        let modes = shapes_of(text).unwrap();
        (modes.digits, modes.warnings)
    };
    let with = |data: u64| mode_of_55(1, 32.0, [1, 2, 2, 8, data, 3], FIRST);
    let long = |data: u64, value: &str| {
        let changed = with(data).replace("-3.00000E+00", value);
        assert_ne!(changed, with(data));
        changed
    };
    let six = (
        6,
        vec!["a.unv: shapes have 6 digits, so invariants and orthogonality of modes have no more digits".to_owned()],
    );
    assert_eq!(digits(&with(2)), six);
    assert_eq!(digits(&long(2, " -3.00000001")), six);
    // double precision in the columns of single precision
    assert_eq!(digits(&with(4)), six);
    let (thirteen, warnings) = digits(&long(4, " -3.000000000001E+00"));
    assert_eq!(thirteen, 13);
    assert!(
        warnings[0].contains("shapes have 13 digits"),
        "{warnings:?}"
    );
    let double = long(4, " -3.0000000000000001D+00");
    assert_eq!(digits(&double), (15, Vec::new()));
    // one mode in single precision
    let second = mode_of_55(2, 0.5, TRANSLATIONS, SECOND);
    assert_eq!(digits(&(double + &second)), six);
    let complex: &Values<'_> = &[(11, &[1.0, 0.0, 2.0, 0.0, -3.0, 0.0])];
    let complex = mode_of_55(1, 32.0, [1, 2, 2, 8, 6, 3], complex);
    let complex = complex.replace("-3.00000E+00", " -3.0000000000000001D+00");
    assert_eq!(digits(&complex), (15, Vec::new()));
}

#[test]
fn wrong_modes_and_their_messages() {
    let mode = mode_of_55(1, 32.0, TRANSLATIONS, FIRST);
    let last = singles(FIRST[1].1);
    for (text, message) in [
        (
            mode_of_55(1, 32.0, [1, 5, 2, 8, 2, 3], FIRST),
            "contains no mode shape",
        ),
        (
            mode_of_55(1, 32.0, [1, 2, 2, 8, 2, 4], FIRST),
            "a.unv:8: dataset 55: a node has 4 values",
        ),
        (
            mode_of_55(1, 32.0, TRANSLATIONS, &[(11, &[1.0, 2.0, 3.0, 4.0])]),
            "dataset 55: node 11 has 4 numbers instead of 3",
        ),
        (
            mode_of_55(
                1,
                32.0,
                [1, 2, 2, 8, 5, 3],
                &[(11, &[1.0, 0.0, 1.0, 1e-3, 0.0, 0.0])],
            ),
            "dataset 55: the shape of node 11 is complex",
        ),
        (
            mode.replace(&last, ""),
            "dataset 55: the dataset ends inside node 40",
        ),
        (
            mode[..mode.len() - 7].to_owned(),
            "dataset 55: the file ends inside it",
        ),
        (
            mode.replace("2.00000E+00", "        two"),
            "dataset 55: \"two\" is no number",
        ),
        (
            mode.replace(&whole(&[2, 4, 1, 1]), &whole(&[2, 40, 1, 1])),
            "dataset 55: the number of real numbers is not 1 to 12",
        ),
        (
            dataset("55", "results\n 1 2 3\n"),
            "a.unv:2: dataset 55: it ends inside its heading",
        ),
        (
            mode.clone() + &mode_of_55(2, 0.5, TRANSLATIONS, &SECOND[..1]),
            "mode 2 is stated at 1 nodes, which are not the 2 nodes of the modes before",
        ),
        (
            "GRID,1,,0.,0.,0.\n".to_owned(),
            "the model states `format: universal`, but the file holds cards of Nastran",
        ),
    ] {
        let error = shapes_of(&text).unwrap_err();
        assert!(error.to_string().contains(message), "{message}: {error}");
        assert!(!error.advice().is_empty(), "{error}");
    }
}

/// The cantilevered plate of 20 × 20 shells that PERMAS computed, beside the same cells of Eng. The file states neither
/// thickness nor material, which scale all frequencies of a thin plate alike.
#[test]
fn shapes_of_permas_are_those_of_the_same_plate() {
    let text = data("permas.unv");
    let given = shapes_of(&text).unwrap();
    let records = |number: &str| -> Vec<&str> {
        let head = format!("    -1\n  {number}\n");
        let (_, rest) = text.split_once(&head).unwrap();
        rest.split_once("    -1\n").unwrap().0.lines().collect()
    };
    let first = |line: &str| line.split_whitespace().next().unwrap().to_owned();
    let mut deck = "BEGIN BULK\nPSHELL,1,1,.01,1,,1\nMAT1,1,2.1+11,,.3,7850.\n".to_owned();
    for node in records("2411").chunks(2) {
        let place = node[1].replace('D', "E");
        let place: Vec<f64> = place
            .split_whitespace()
            .map(|x| x.parse().unwrap())
            .collect();
        let id = first(node[0]);
        writeln!(
            deck,
            "GRID,{id},,{:?},{:?},{:?}",
            place[0], place[1], place[2]
        )
        .unwrap();
        if place[0] == 0.0 {
            writeln!(deck, "SPC1,1,123456,{id}").unwrap();
        }
    }
    for element in records("2412").chunks(2) {
        let nodes: Vec<&str> = element[1].split_whitespace().collect();
        writeln!(deck, "CQUAD4,{},1,{}", first(element[0]), nodes.join(",")).unwrap();
    }
    let request = Request {
        rules: Rules::exact(),
        support_of_deck: true,
        terms: vec![Term::Normal {
            modes: Modes::Count(10),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    let own = reduce(nastran_deck::mesh(&(deck + "ENDDATA\n")), &request).unwrap();
    let stored = StoredBody::new(own, Rules::exact(), Key([0; 32]), Vec::new());
    let found = Recovery::of_stored(&stored)
        .unwrap()
        .compare(&given)
        .unwrap();
    assert_eq!(
        (found.common, found.nodes, found.modes.len()),
        (441, 441, 10)
    );
    let mut ratios = Vec::new();
    for (index, mode) in found.modes.iter().enumerate() {
        assert_eq!((mode.number, mode.nearest), (index as u64 + 1, index));
        assert!(mode.assurance > 0.9999 && mode.assurance <= 1.0, "{mode:?}");
        let angular = mode.eigenvalue.unwrap().sqrt();
        ratios.push(2.0 * std::f64::consts::PI * stored.body.frequencies[index] / angular);
    }
    for ratio in &ratios {
        assert!((ratio / ratios[0] - 1.0).abs() < 7e-3, "{ratios:?}");
    }
    // a part of the nodes, and none
    let mut part = given.clone();
    part.nodes[0] = 7000;
    let fewer = Recovery::of_stored(&stored)
        .unwrap()
        .compare(&part)
        .unwrap();
    assert_eq!((fewer.common, fewer.nodes), (440, 441));
    part.nodes = (7000..7441).collect();
    let error = Recovery::of_stored(&stored)
        .unwrap()
        .compare(&part)
        .unwrap_err();
    assert!(
        error
            .to_string()
            .contains("a.unv: no node of its shapes is in the mesh"),
        "{error}"
    );
}
