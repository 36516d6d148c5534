//! Meshes of gmsh in all their formats, and damaged ones.

use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

use crate::nastran_deck::{self, Memory, element_ids, is_consistent, set, set_ids, unread};
use eng_flexible::fe::Rules;
use eng_flexible::mesh::{Carries, ElementKind, Mesh};
use eng_flexible::read::{ShellGroups, read_mesh_with_shells};
use eng_flexible::reduce::{Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_flexible::{FileProblem, FlexibleError, MeshFormat, Place, read_mesh};
use eng_system::mesh_files::Stated as _;
use proptest::prelude::*;

fn try_read(bytes: &[u8]) -> Result<Mesh, FileProblem> {
    let mut files = Memory::default();
    files.0.insert("mesh.msh".into(), bytes.to_vec());
    match read_mesh(&files, "mesh.msh", MeshFormat::Gmsh) {
        Ok(mesh) => Ok(mesh),
        Err(FlexibleError::File(problem)) => Err(problem),
        Err(error) => panic!("{error}"),
    }
}

fn mesh(bytes: &[u8]) -> Mesh {
    try_read(bytes).unwrap_or_else(|problem| panic!("{problem}"))
}

fn bar20() -> String {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let file = File::open(folder.join("bar20.msh.gz")).expect("test data");
    let mut text = String::new();
    flate2::read::GzDecoder::new(file)
        .read_to_string(&mut text)
        .expect("text");
    text
}

/// Two tetrahedra of ten nodes share a face; a point, a line and a surface are in groups.
const SMALL: &str = "\
$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
3
0 1 \"corner\"
2 1 \"a face\"
3 7 \"all\"
$EndPhysicalNames
$Entities
1 1 1 2
1 0 0 0 1 1
1 0 0 0 1 0 0 1 5 2 1 -2
1 0 0 0 1 1 0 2 -1 4 1 1
1 0 0 0 1 1 1 1 7 1 1
2 0 0 0 1 1 1 0 0
$EndEntities
$Nodes
2 14 1 14
0 1 0 1
1
0 0 0
3 1 1 13
2
3
4
5
6
7
8
9
10
11
12
13
14
2 0 0 0 0 0
0 2 0 0 0 0
0 0 2 0 0 0
1 0 0 0 0 0
1 1 0 0 0 0
0 1 0 0 0 0
0 0 1 0 0 0
0 1 1 0 0 0
1 0 1 0 0 0
2 2 2 0 0 0
2 1 1 0 0 0
1 2 1 0 0 0
1 1 2 0 0 0
$EndNodes
$Elements
5 5 1 9
0 1 15 1
1 1
1 1 8 1
2 1 2 5
2 1 9 1
3 1 2 3 5 6 7
3 1 11 1
8 1 2 3 4 5 6 7 8 9 10
3 2 11 1
9 2 3 4 11 6 9 10 12 14 13
$EndElements
$Periodic
0
$EndPeriodic
";

#[test]
fn groups_and_order_of_nodes() {
    let mesh = mesh(SMALL.as_bytes());
    is_consistent(&mesh);
    assert_eq!(mesh.elements[0].kind, ElementKind::Tetrahedron10);
    // the last two mid-side nodes change places
    assert_eq!(element_ids(&mesh, 8), [1, 2, 3, 4, 5, 6, 7, 8, 10, 9]);
    assert_eq!(set_ids(&mesh, "corner"), [1]);
    assert_eq!(set_ids(&mesh, "a face"), [1, 2, 3, 5, 6, 7]);
    // groups of points and surfaces share the number 1
    assert_eq!(set_ids(&mesh, "physical:0:1"), [1]);
    assert_eq!(set_ids(&mesh, "physical:2:1"), [1, 2, 3, 5, 6, 7]);
    assert!(!mesh.sets.contains_key("physical:1"));
    assert_eq!(set_ids(&mesh, "physical:4"), [1, 2, 3, 5, 6, 7]);
    assert_eq!(set_ids(&mesh, "physical:5"), [1, 2, 5]);
    assert_eq!(set(&mesh, "all").elements(), [0]);
    assert_eq!(set(&mesh, "all").nodes().len(), 10);
    let names = mesh
        .properties
        .iter()
        .map(|property| property.name.as_str());
    assert_eq!(names.collect::<Vec<_>>(), ["all", "volumes"]);
    assert_eq!(
        unread(&mesh),
        [
            ("$Periodic", 1, Carries::Unknown),
            (
                "elements of points, lines and surfaces",
                3,
                Carries::Nothing
            ),
        ]
    );
}

/// Lines of a section of a text file.
fn section<'t>(text: &'t str, name: &str) -> Vec<&'t str> {
    text.lines()
        .skip_while(|line| *line != format!("${name}"))
        .skip(1)
        .take_while(|line| *line != format!("$End{name}"))
        .collect()
}

/// Numbers of a line.
fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace()
        .map(|word| word.parse().expect("a number"))
        .collect()
}

/// Writes numbers of the given sizes in a byte order.
struct Bytes {
    bytes: Vec<u8>,
    big: bool,
}

impl Bytes {
    fn put<const N: usize>(&mut self, mut bytes: [u8; N]) {
        if self.big {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
    }

    fn int(&mut self, value: f64) {
        self.put((value as i32).to_le_bytes());
    }

    fn size(&mut self, value: f64) {
        self.put((value as u64).to_le_bytes());
    }

    fn real(&mut self, value: f64) {
        self.put(value.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.bytes.extend(text.as_bytes());
    }
}

/// A text file of format 4.1 in binary.
fn binary4(text: &str, big: bool) -> Vec<u8> {
    let mut out = Bytes {
        bytes: Vec::new(),
        big,
    };
    out.text("$MeshFormat\n4.1 1 8\n");
    out.int(1.0);
    out.text("\n$EndMeshFormat\n$PhysicalNames\n");
    for line in section(text, "PhysicalNames") {
        out.text(line);
        out.text("\n");
    }
    out.text("$EndPhysicalNames\n$Entities\n");
    let entities = section(text, "Entities");
    let counts = numbers(entities[0]);
    counts.iter().for_each(|count| out.size(*count));
    for (i, line) in entities[1..].iter().enumerate() {
        let values = numbers(line);
        let coordinates = if (i as f64) < counts[0] { 3 } else { 6 };
        out.int(values[0]);
        values[1..=coordinates].iter().for_each(|x| out.real(*x));
        let mut rest = &values[coordinates + 1..];
        while let Some((count, after)) = rest.split_first() {
            out.size(*count);
            after[..*count as usize]
                .iter()
                .for_each(|tag| out.int(*tag));
            rest = &after[*count as usize..];
        }
    }
    out.text("\n$EndEntities\n$Nodes\n");
    let nodes = section(text, "Nodes");
    numbers(nodes[0]).iter().for_each(|x| out.size(*x));
    let mut at = 1;
    while at < nodes.len() {
        let head = numbers(nodes[at]);
        head[..3].iter().for_each(|x| out.int(*x));
        out.size(head[3]);
        let count = head[3] as usize;
        for line in &nodes[at + 1..at + 1 + count] {
            out.size(numbers(line)[0]);
        }
        for line in &nodes[at + 1 + count..at + 1 + 2 * count] {
            numbers(line).iter().for_each(|x| out.real(*x));
        }
        at += 1 + 2 * count;
    }
    out.text("\n$EndNodes\n$Elements\n");
    let elements = section(text, "Elements");
    numbers(elements[0]).iter().for_each(|x| out.size(*x));
    let mut at = 1;
    while at < elements.len() {
        let head = numbers(elements[at]);
        head[..3].iter().for_each(|x| out.int(*x));
        out.size(head[3]);
        let count = head[3] as usize;
        for line in &elements[at + 1..at + 1 + count] {
            numbers(line).iter().for_each(|x| out.size(*x));
        }
        at += 1 + count;
    }
    out.text("\n$EndElements\n");
    out.bytes
}

/// Elements of a text file of format 4.1 as format 2.2 has them: type, tags, nodes; one for each group.
fn elements2(text: &str) -> Vec<(usize, [i32; 2], Vec<u64>)> {
    let entities = section(text, "Entities");
    let counts = numbers(entities[0]);
    let mut groups = std::collections::BTreeMap::new();
    let mut line = 1;
    for (dimension, count) in counts.iter().enumerate() {
        for _ in 0..*count as usize {
            let values = numbers(entities[line]);
            let at = if dimension == 0 { 4 } else { 7 };
            let own = values[at + 1..at + 1 + values[at] as usize].to_vec();
            groups.insert((dimension, values[0] as i32), own);
            line += 1;
        }
    }
    let lines = section(text, "Elements");
    let mut found = Vec::new();
    let mut at = 1;
    while at < lines.len() {
        let head = numbers(lines[at]);
        let entity = (head[0] as usize, head[1] as i32);
        let count = head[3] as usize;
        for line in &lines[at + 1..at + 1 + count] {
            let nodes = numbers(line)[1..]
                .iter()
                .map(|node| *node as u64)
                .collect::<Vec<_>>();
            let mut own = groups[&entity].clone();
            if own.is_empty() {
                own.push(0.0);
            }
            for group in own {
                found.push((head[2] as usize, [group as i32, entity.1], nodes.clone()));
            }
        }
        at += 1 + count;
    }
    found
}

/// A text file of format 4.1 in format 2.2.
fn format2(text: &str, binary: bool) -> Vec<u8> {
    let mut out = Bytes {
        bytes: Vec::new(),
        big: false,
    };
    out.text(if binary {
        "$MeshFormat\n2.2 1 8\n"
    } else {
        "$MeshFormat\n2.2 0 8\n"
    });
    if binary {
        out.int(1.0);
        out.text("\n");
    }
    out.text("$EndMeshFormat\n$PhysicalNames\n");
    for line in section(text, "PhysicalNames") {
        out.text(line);
        out.text("\n");
    }
    out.text("$EndPhysicalNames\n$Nodes\n");
    let nodes = section(text, "Nodes");
    let total = numbers(nodes[0])[1];
    out.text(&format!("{total}\n"));
    let mut at = 1;
    while at < nodes.len() {
        let count = numbers(nodes[at])[3] as usize;
        for i in 0..count {
            let (tag, place) = (nodes[at + 1 + i], nodes[at + 1 + count + i]);
            let place = place.split_whitespace().take(3).collect::<Vec<_>>();
            if binary {
                out.int(numbers(tag)[0]);
                place.iter().for_each(|x| out.real(numbers(x)[0]));
            } else {
                out.text(&format!("{tag} {}\n", place.join(" ")));
            }
        }
        at += 1 + 2 * count;
    }
    out.text("\n$EndNodes\n$Elements\n");
    let elements = elements2(text);
    out.text(&format!("{}\n", elements.len()));
    for (number, (kind, tags, nodes)) in elements.iter().enumerate() {
        let number = number + 1;
        if binary {
            for value in [*kind, 1, 2, number] {
                out.int(value as f64);
            }
            tags.iter().for_each(|tag| out.int(f64::from(*tag)));
            nodes.iter().for_each(|node| out.int(*node as f64));
        } else {
            out.text(&format!("{number} {kind} 2 {} {}", tags[0], tags[1]));
            nodes.iter().for_each(|node| out.text(&format!(" {node}")));
            out.text("\n");
        }
    }
    out.text("\n$EndElements\n");
    out.bytes
}

#[test]
fn all_formats_are_the_same_mesh() {
    for text in [bar20(), SMALL.to_string()] {
        let expected = mesh(text.as_bytes());
        let variants = [
            ("4.1 binary", binary4(&text, false)),
            ("4.1 binary of the other byte order", binary4(&text, true)),
            ("2.2 text", format2(&text, false)),
            ("2.2 binary", format2(&text, true)),
        ];
        for (name, bytes) in variants {
            let found = try_read(&bytes).unwrap_or_else(|problem| panic!("{name}: {problem}"));
            assert_eq!(found.nodes, expected.nodes, "{name}");
            assert_eq!(found.connectivity, expected.connectivity, "{name}");
            assert_eq!(found.sets, expected.sets, "{name}");
            assert_eq!(found.properties, expected.properties, "{name}");
            let kinds = |mesh: &Mesh| mesh.elements.iter().map(|e| e.kind).collect::<Vec<_>>();
            assert_eq!(kinds(&found), kinds(&expected), "{name}");
        }
    }
}

#[test]
fn problems_tell_their_place() {
    for (from, to, text) in [
        ("4.1 0 8", "4.0 0 8", "Eng does not read format 4.0"),
        ("2 1 \"a face\"", "9 1 \"a face\"", "is no name of a group"),
        (
            "0 0 2 0 0 0\n",
            "0 0 z 0 0 0\n",
            "a coordinate of a node is \"z\"",
        ),
        ("3 2 11 1\n", "3 2 99 1\n", "elements of type 99"),
        ("12 14 13\n", "12 14 15\n", "uses node 15, which is missing"),
    ] {
        let changed = SMALL.replacen(from, to, 1);
        assert_ne!(changed, SMALL);
        let (before, _) = changed.split_once(to).expect("the change");
        let line = before.lines().count().max(1) as u64;
        let line = line + u64::from(before.ends_with('\n'));
        let problem = match try_read(changed.as_bytes()) {
            Err(problem) => problem,
            Ok(_) => panic!("{from} → {to} is read"),
        };
        assert!(!problem.advice.is_empty());
        assert!(problem.problem.contains(text), "{problem}");
        assert_eq!(problem.place, Place::Line(line), "{problem}");
    }
    let problem = try_read(b"$Comments\nof gmsh\n$EndComments\n").expect_err("no format");
    assert!(
        problem.problem.contains("does not begin with $MeshFormat"),
        "{problem}"
    );
    assert_eq!(problem.place, Place::Line(1), "{problem}");
    for (blocks, text) in [
        ("4 5 1 9", "in the place of $EndElements"),
        ("6 5 1 9", "$EndElements"),
    ] {
        let changed = SMALL.replacen("5 5 1 9", blocks, 1);
        let problem = try_read(changed.as_bytes()).expect_err("wrong counts");
        assert!(problem.problem.contains(text), "{problem}");
    }
    let bytes = binary4(SMALL, false);
    let problem = try_read(&bytes[..bytes.len() - 60]).expect_err("cut");
    assert!(
        matches!(problem.place, Place::Record { record: 5, byte } if byte > 1000),
        "{problem}"
    );
    let (surfaces, _) = SMALL.split_once("$Elements").expect("elements");
    let problem = try_read(surfaces.as_bytes()).expect_err("no volumes");
    assert!(problem.problem.contains("no volume elements"), "{problem}");
}

fn survives(bytes: &[u8]) {
    match try_read(bytes) {
        Ok(mesh) => is_consistent(&mesh),
        Err(problem) => {
            assert!(!problem.advice.is_empty(), "{problem}");
            // a changed beginning may look as that of another format
            let of_file = ["no volume elements", "but the file holds"];
            assert!(
                problem.place != Place::File
                    || of_file.iter().any(|text| problem.problem.contains(text)),
                "{problem}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn bytes_changed(
        which in 0..4_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)
    ) {
        let mut bytes = match which {
            0 => SMALL.as_bytes().to_vec(),
            1 => binary4(SMALL, false),
            2 => format2(SMALL, false),
            _ => format2(SMALL, true),
        };
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        survives(&bytes);
    }

    #[test]
    fn words_changed(changes in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(vec!["-1", "0", "1", "3", "15", "1e9", "99999999999", "x", "$EndNodes"])), 1..4)) {
        let mut words = SMALL.split_inclusive(char::is_whitespace).map(str::to_string).collect::<Vec<_>>();
        for (place, word) in changes {
            let place = place.index(words.len());
            let end = words[place].chars().last().unwrap_or(' ');
            words[place] = format!("{word}{end}");
        }
        survives(words.concat().as_bytes());
    }

    #[test]
    fn cut_anywhere(which in 0..3_usize, end in any::<prop::sample::Index>()) {
        let bytes = match which {
            0 => SMALL.as_bytes().to_vec(),
            1 => binary4(SMALL, false),
            _ => format2(SMALL, true),
        };
        survives(&bytes[..end.index(bytes.len())]);
    }

    #[test]
    fn any_text(text in "[ -~\n\t]{0,300}") {
        survives(text.as_bytes());
        survives(format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{text}").as_bytes());
    }
}

/// A plate of two quadrangles and two triangles, with an edge.
const PLATE: &str = "\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 \"EDGE\"
2 5 \"COVER\"
$EndPhysicalNames
$Nodes
8
1 0 0 0
2 10 0 0
3 20 0 0
4 30 0 0
5 0 10 0
6 10 10 0
7 20 10 0
8 30 10 0
$EndNodes
$Elements
5
1 1 2 1 1 1 5
2 3 2 5 1 1 2 6 5
3 3 2 5 1 2 3 7 6
4 2 2 5 2 3 4 8
5 2 2 5 2 3 8 7
$EndElements
";

fn with_shells(text: &str, groups: &[&str]) -> Result<Mesh, FlexibleError> {
    let groups: Vec<String> = groups.iter().map(|group| (*group).to_owned()).collect();
    let shells = ShellGroups {
        groups: &groups,
        thickness: 2.0,
    };
    let files = Memory::new(&[("mesh.msh", text)]);
    read_mesh_with_shells(&files, "mesh.msh", MeshFormat::Gmsh, shells)
}

/// Groups of surfaces as shells: the frequencies of the same shells in the language of Nastran.
#[test]
fn surfaces_are_shells_of_a_stated_thickness() {
    let units = MeshUnits::named("mm_tonne_s").unwrap();
    let frequencies = |mesh: Mesh| {
        let request = Request {
            rules: Rules::exact(),
            terms: vec![Term::Normal {
                modes: Modes::Count(6),
                fixed: Vec::new(),
            }],
            ..Request::default()
        };
        reduce(mesh, &request).unwrap().body.frequencies
    };
    let mut plate = with_shells(PLATE, &["COVER"]).unwrap();
    is_consistent(&plate);
    assert_eq!(plate.elements.len(), 4);
    assert_eq!(set(&plate, "COVER").elements(), [0, 1, 2, 3]);
    assert_eq!(set_ids(&plate, "EDGE"), [1, 5]);
    assert_eq!(plate.properties[0].name, "COVER");
    // the number of the group in place of its name
    let by_number = with_shells(PLATE, &["physical:5"]).unwrap();
    assert_eq!(by_number.properties[0].name, "physical:5");
    plate.convert(&units);
    plate.set_material(2.1e11, 0.3, 7850.0).unwrap();
    let mut deck = nastran_deck::mesh(
        "GRID,1,,0.,0.,0.\nGRID,2,,10.,0.,0.\nGRID,3,,20.,0.,0.\nGRID,4,,30.,0.,0.\n\
         GRID,5,,0.,10.,0.\nGRID,6,,10.,10.,0.\nGRID,7,,20.,10.,0.\nGRID,8,,30.,10.,0.\n\
         CQUAD4,2,5,1,2,6,5\nCQUAD4,3,5,2,3,7,6\nCTRIA3,4,5,3,4,8\nCTRIA3,5,5,3,8,7\n\
         PSHELL,5,1,2.,1,,1\nMAT1,1,210000.,,.3,7.85-9\n",
    );
    deck.convert(&units);
    let (found, expected) = (frequencies(plate), frequencies(deck));
    assert_eq!(found.len(), 6);
    for (x, y) in found.iter().zip(&expected) {
        assert!((x / y - 1.0).abs() < 1e-9, "{found:?} {expected:?}");
    }
}

#[test]
fn shells_on_a_face_of_solids() {
    let mesh = with_shells(SMALL, &["a face"]).unwrap();
    is_consistent(&mesh);
    let kinds: Vec<ElementKind> = mesh.elements.iter().map(|element| element.kind).collect();
    assert_eq!(
        kinds,
        [
            ElementKind::Triangle6,
            ElementKind::Tetrahedron10,
            ElementKind::Tetrahedron10
        ]
    );
    assert_eq!(element_ids(&mesh, 3), [1, 2, 3, 5, 6, 7]);
    assert_eq!(set_ids(&mesh, "a face"), [1, 2, 3, 5, 6, 7]);
    assert_eq!(set(&mesh, "physical:2:1").elements(), [0]);
    let names = mesh.properties.iter().map(|own| own.name.as_str());
    assert_eq!(names.collect::<Vec<_>>(), ["a face", "all", "volumes"]);
}

/// Each surface is in two groups, and format 2.2 writes it once for each of them: both groups may be stated, and one group
/// by its name and its number.
#[test]
fn groups_of_the_same_shells() {
    let twice = PLATE
        .replace("2\n1 1 \"EDGE\"", "3\n1 1 \"EDGE\"\n2 4 \"ALL\"")
        .replace("$Elements\n5\n", "$Elements\n9\n")
        .replace(
            "$EndElements",
            "6 3 2 4 1 1 2 6 5\n7 3 2 4 1 2 3 7 6\n8 2 2 4 2 3 4 8\n9 2 2 4 2 3 8 7\n$EndElements",
        );
    for groups in [["ALL", "COVER"], ["COVER", "ALL"]] {
        let plate = with_shells(&twice, &groups).unwrap();
        is_consistent(&plate);
        assert_eq!(plate.elements.len(), 4);
        for group in groups {
            assert_eq!(set(&plate, group).elements(), [0, 1, 2, 3]);
        }
        assert_eq!(plate.properties.len(), 1);
    }
    for groups in [
        ["COVER", "physical:5"],
        ["physical:5", "COVER"],
        ["physical:2:5", "physical:5"],
    ] {
        let plate = with_shells(PLATE, &groups).unwrap();
        assert_eq!(set(&plate, "COVER").elements(), [0, 1, 2, 3]);
        assert_eq!(plate.properties[0].name, groups[0]);
    }
    let error = with_shells(PLATE, &["COVER", "physical:4"]).unwrap_err();
    let message = "the group physical:4 has no triangle and no quadrangle";
    assert!(error.to_string().contains(message), "{error}");
}

/// A group of points has the number of the group of surfaces.
#[test]
fn shells_of_a_number_that_other_groups_have() {
    let mesh = with_shells(SMALL, &["physical:2:1"]).unwrap();
    assert_eq!(set(&mesh, "physical:2:1").elements(), [0]);
    assert_eq!(mesh.properties[0].name, "physical:2:1");
    let error = with_shells(SMALL, &["physical:1"]).unwrap_err();
    let message = "groups of several dimensions have the number of physical:1 in `shells`";
    assert!(error.to_string().contains(message), "{error}");
    assert_eq!(error.advice(), "write physical:2:1 for its surfaces");
    // no other group has the number 4
    let mesh = with_shells(SMALL, &["physical:4"]).unwrap();
    assert_eq!(set(&mesh, "physical:4").elements(), [0]);
}

#[test]
fn wrong_shells_and_their_messages() {
    let nine = PLATE.replace("2 3 2 5 1 1 2 6 5\n", "2 10 2 5 1 1 2 6 5 1 2 3 4 7\n");
    assert_ne!(nine, PLATE);
    let unnamed = PLATE.replace("2 5 \"COVER\"", "1 7 \"other\"");
    for (text, group, message) in [
        (
            PLATE,
            "EDGE",
            "the group EDGE has no triangle and no quadrangle; groups of surfaces are COVER",
        ),
        (
            unnamed.as_str(),
            "COVER",
            "the group COVER has no triangle and no quadrangle; no group of surfaces has a name",
        ),
        (
            nine.as_str(),
            "COVER",
            "element 2 is a surface of type 10, which Eng does not read",
        ),
    ] {
        let error = with_shells(text, &[group]).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
        assert!(!error.advice().is_empty());
    }
    let problem = try_read(PLATE.as_bytes()).unwrap_err();
    assert!(
        problem.problem.contains("the file has no volume elements"),
        "{problem}"
    );
}
