//! Formats of the Nastran reader: fields, continuations, comments, sections, includes.

use crate::nastran_deck::*;
use eng_flexible::Place;
use eng_flexible::mesh::{Carries, ElementKind};
use eng_flexible::read::nastran::read_bulk;

/// Four grid points and the other cards of a tetrahedron.
const CORNERS: &str = "GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,0.,1.,0.
GRID,4,,0.,0.,1.
PSOLID,1,1
MAT1,1,2.1+11,,.3,7850.
";

#[test]
fn small_large_and_free_field_say_the_same() {
    let expected = [-1.5e3, 0.25, 3.0];
    for deck in [
        "GRID          17          -1.5+3    .25     3.0",
        "GRID,17,,-1.5+3,.25,3.0",
        "grid , 17 , , -1.5D+3 , 2.5e-1 , 3",
        "GRID*                 17                         -1500.0             .25*
*                    3.0",
        "GRID*                 17                         -1500.0             .25*ABC
*ABC                 3.0",
        "GRID*,17,,-1.5+3,.25,*\n*,3.0",
        "GRID*,17,,-1.5+3,.25\n*,3.0",
        "GRID\t17\t\t-1.5+3\t.25\t3.0",
        "GRID          17          -1.5+3    .25     3.0       0$ comment",
        "$ GRID,17\r\nGRID,17,,-1.5+3,.25,3.0 $, 4\r\n\r\n",
    ] {
        let mesh = mesh(deck);
        assert_eq!(mesh.nodes.len(), 1, "{deck}");
        assert_eq!(mesh.nodes[0].id, 17);
        assert_eq!(mesh.nodes[0].position, expected, "{deck}");
        assert_eq!(mesh.nodes[0].frame, None);
    }
}

#[test]
fn fields_touch_each_other() {
    let mesh = mesh("GRID    12345678       0-1.234561.234567-1.23-12");
    assert_eq!(mesh.nodes[0].id, 12_345_678);
    assert_eq!(mesh.nodes[0].position, [-1.23456, 1.234567, -1.23e-12]);
}

#[test]
fn continuations_in_every_way() {
    for element in [
        // by name
        "CTETRA         1       1       1       2       3       4       5       6+AB
+AB            7       8       9      10",
        // plus on both
        "CTETRA         1       1       1       2       3       4       5       6+
+              7       8       9      10",
        // blank on both
        "CTETRA         1       1       1       2       3       4       5       6
               7       8       9      10",
        // free field, blank and plus
        "CTETRA,1,1,1,2,3,4,5,6\n,7,8,9,10",
        "CTETRA,1,1,1,2,3,4,5,6,+\n+,7,8,9,10",
        // all on one line, and lines cut short
        "CTETRA,1,1,1,2,3,4,5,6,7,8,9,10",
        "CTETRA,1,1,1,2,3,4,5,6,7,8,9,10,,,+,\n+",
        "CTETRA*,1,1,1,2,*\n*,3,4,5,6\n+,7,8,9,10,+\n+,,",
        "CTETRA,1,1,1,2,3,4,5,6,+X1\n+X1,7,8,9,10",
        // small field, continued in large field
        "CTETRA         1       1       1       2       3       4       5       6
*                      7               8               9              10",
        // large field, continued in small field
        "CTETRA*                1               1               1               2
*                      3               4               5               6
+              7       8       9      10",
        // free field, continued in small field, with comments between
        "CTETRA,1,1,1,2,3,4,5,6
$ the rest

+              7       8       9      10 $ end",
        // the name without its plus, as old decks have it: the first column doesn't count
        "CTETRA         1       1       1       2       3       4       5       6XAB
+AB            7       8       9      10",
    ] {
        let grids = (5..=10)
            .map(|id| format!("GRID,{id},,{id}.,0.,0.\n"))
            .collect::<String>();
        let mesh = mesh(&format!("{CORNERS}{grids}{element}\n"));
        assert_eq!(
            mesh.elements[0].kind,
            ElementKind::Tetrahedron10,
            "{element}"
        );
        assert_eq!(
            element_ids(&mesh, 1),
            (1..=10).collect::<Vec<u64>>(),
            "{element}"
        );
    }
}

#[test]
fn continuations_stand_anywhere() {
    // all parents, then all children in another order; elements keep the order of their parents
    let grids = (5..=10)
        .map(|id| format!("GRID,{id},,{id}.,0.,0.\n"))
        .collect::<String>();
    let mesh = mesh(&format!(
        "+C2            7       8       9      10
{CORNERS}{grids}CTETRA         5       1       1       2       3       4       5       6+C1
CTETRA         4       1       1       2       3       4
CTETRA         3       1       4       3       2       1       6       5+C2
+C1           10       9       8       7
"
    ));
    let order = mesh.elements.iter().map(|e| e.id).collect::<Vec<_>>();
    assert_eq!(order, [5, 4, 3]);
    assert_eq!(element_ids(&mesh, 5), [1, 2, 3, 4, 5, 6, 10, 9, 8, 7]);
    assert_eq!(element_ids(&mesh, 3), [4, 3, 2, 1, 6, 5, 7, 8, 9, 10]);
    assert_eq!(element_ids(&mesh, 4), [1, 2, 3, 4]);
}

#[test]
fn a_continuation_that_nobody_calls_belongs_to_the_card_before() {
    let mesh = mesh(&format!(
        "{CORNERS}GRID,5,,5.,0.,0.
CTETRA         1       1       1       2       3       4
+C1
CTETRA         2       1       1       2       3       4
+C2                    5
CONM2          3       1       0     2.0
+C3          1.0
"
    ));
    assert_eq!(element_ids(&mesh, 1), [1, 2, 3, 4]);
    assert_eq!(element_ids(&mesh, 2), [1, 2, 3, 4, 0, 0, 0, 5, 0, 0]);
    assert_eq!(mesh.point_masses[0].matrix[3][3], 1.0);
}

#[test]
fn numbers_of_lines_in_the_last_columns_mean_nothing() {
    let numbered = |text: &str, number: u32| format!("{text:<72}{number:08}\n");
    let deck = [
        "GRID           1              1.      2.      3.",
        "GRID           2              4.      5.      6.",
    ]
    .iter()
    .zip([10, 20])
    .map(|(text, number)| numbered(text, number))
    .collect::<String>();
    let mesh = mesh(&deck);
    assert_eq!(position(&mesh, 2), [4.0, 5.0, 6.0]);
    assert_eq!(ids(&mesh, &[0, 1]), [1, 2]);
}

#[test]
fn lost_continuations_are_told() {
    let lost = problem(&format!(
        "{CORNERS}CTETRA         1       1       1       2       3       4       5       6+AB\nGRID,9,,1.,1.,1.\n"
    ));
    assert_eq!(lost.place, Place::Line(7));
    assert!(lost.problem.contains("\"+AB\" is missing"), "{lost}");
    let lost = problem(
        "GRID*                  1                              1.              2.*\nGRID,2,,0.,0.,0.\n",
    );
    assert_eq!(lost.place, Place::Line(1));
    assert!(
        lost.problem.contains("continuation \"*\" is missing"),
        "{lost}"
    );
    let stray = problem("+AB,1,2\nGRID,2,,0.,0.,0.\n");
    assert_eq!(stray.place, Place::Line(1));
    assert!(stray.problem.contains("continues no card"), "{stray}");
    let mixed = problem(&format!(
        "{CORNERS}CTETRA         1       1       1       2       3       4       5       6+AB\n+AC            7       8       9      10\n"
    ));
    assert!(mixed.problem.contains("continues no card"), "{mixed}");
}

#[test]
fn control_sections_are_passed_over() {
    let deck = format!(
        "NASTRAN SYSTEM(151)=1
ASSIGN OUTPUT4='grid.op4',UNIT=21
ID GRID,1
SOL 103
CEND
TITLE = GRID 1, or not
SET 5 = 1 THRU 4
SPC = 7
METHOD=1
PARAM,WTMASS,2.0
SUBCASE 1
  DISP(PLOT) = ALL
BEGIN BULK
{CORNERS}CTETRA,1,1,1,2,3,4
ENDDATA
GRID,1,,this is not read
"
    );
    let problem = problem(&deck);
    assert!(
        problem
            .problem
            .contains("SPC = 7 selects a set that is missing")
    );
    assert_eq!(problem.place, Place::Line(8));
    let mesh = mesh(
        &deck
            .replace("SPC = 7\n", "SPC = 7 $ held\n")
            .replace("ENDDATA", "SPC1,7,123,1\nENDDATA now"),
    );
    assert_eq!((mesh.nodes.len(), mesh.elements.len()), (4, 1));
    assert_eq!(mesh.materials[0].density, 2.0 * 7850.0);
    assert_eq!(mesh.supports.len(), 1);
}

#[test]
fn decks_of_cards_alone() {
    // the first lines could be case control, the grid point couldn't
    let mesh = mesh(&format!(
        "PARAM,WTMASS,0.5\nSPC1,1,3,1\nSPC,2,2,12\nFORCE,1,1,,1.,0.,0.,1.\n{CORNERS}CTETRA,1,1,1,2,3,4\n"
    ));
    assert_eq!(mesh.materials[0].density, 0.5 * 7850.0);
    assert_eq!(mesh.supports.len(), 2);
    assert_eq!(unread(&mesh), [("FORCE", 1, Carries::Nothing)]);
}

#[test]
fn files_that_are_no_decks() {
    for (deck, message) in [
        ("", "no grid point"),
        ("*NODE\n1, 0., 0., 0.\n", "\"*NODE\" continues no card"),
        ("<html>\n</html>\n", "no grid point"),
        ("SOL 103\nCEND\nTITLE = x\n", "no BEGIN BULK"),
        ("GRID\0\u{1}\n", "no text of bulk data"),
        (
            "BEGIN BULK\nGRID,1,,0.,0.,0.\nBEGIN SUPER=2\n",
            "second part",
        ),
        (
            "=,*(1),=,*(.1),==\n",
            "repeats the card before, but that card has several lines or is missing",
        ),
        (
            "GRID,1,,0.,0.,0.\n=(3)\n",
            "no line before it states the increments",
        ),
        (
            "GRID,1,,0.,0.,0.\n=,*(1),*(1),==\n",
            "adds a number to \"\"",
        ),
    ] {
        let found = problem(deck);
        assert!(found.problem.contains(message), "{deck:?}: {found}");
        assert!(!found.advice.is_empty());
    }
}

#[test]
fn files_are_included() {
    let files = Memory::new(&[
        (
            "deck.bdf",
            "SOL 103\nCEND\nINCLUDE 'case.txt'\nBEGIN BULK\ninclude 'parts/\n   grids\n   .bdf' $ spread\nINCLUDE \"parts/solid.bdf\"\nGRID,5,,5.,0.,0.\nENDDATA\n",
        ),
        ("case.txt", "TITLE = included\nPARAM,WTMASS,3.0\n"),
        // a file beside the including one, and one beside the model
        (
            "parts/grids.bdf",
            "INCLUDE 'more.bdf'\nINCLUDE beside.bdf\nGRID,3,,0.,1.,0.\nCTETRA,1,1,1,2\n",
        ),
        (
            "parts/more.bdf",
            "GRID,1,,0.,0.,0.\nENDDATA\nGRID,1,,not read\n",
        ),
        ("beside.bdf", "GRID,2,,1.,0.,0.\n"),
        // a card may be continued beyond the end of a file
        (
            "parts/solid.bdf",
            ",3,4\nINCLUDE 'MODEL:parts\\more2.bdf'\nPSOLID,1,1\nMAT1,1,1.,,.3,1.\n",
        ),
        ("parts/more2.bdf", "GRID,4,,0.,0.,1.\n"),
    ]);
    // the continuation carries fields 9 and 10, which no 4-node tetrahedron has: corners must not come from there
    let truncated = problem_of(&files);
    assert!(truncated.problem.contains("G3"), "{truncated}");
    assert_eq!(truncated.file, "parts/grids.bdf");
    let mut files = files;
    files.0.insert(
        "parts/grids.bdf".into(),
        b"INCLUDE 'more.bdf'\nINCLUDE beside.bdf\nGRID,3,,0.,1.,0.\nCTETRA,1,1,1,2,3,4,0,0\n"
            .to_vec(),
    );
    files.0.insert(
        "parts/solid.bdf".into(),
        b",,,,5\nINCLUDE 'MODEL:parts\\more2.bdf'\nPSOLID,1,1\nMAT1,1,1.,,.3,1.\n".to_vec(),
    );
    let mesh = read_bulk(&files, "deck.bdf").expect("a mesh");
    assert_eq!(
        mesh.nodes.iter().map(|node| node.id).collect::<Vec<_>>(),
        [1, 2, 3, 4, 5]
    );
    assert_eq!(element_ids(&mesh, 1), [1, 2, 3, 4, 0, 0, 0, 0, 0, 5]);
    assert_eq!(mesh.materials[0].density, 3.0);
}

#[test]
fn includes_that_fail_are_told_with_their_place() {
    let missing = problem("GRID,1,,0.,0.,0.\nINCLUDE 'nowhere.bdf'\n");
    assert_eq!(missing.place, Place::Line(2));
    assert!(missing.problem.contains("nowhere.bdf"), "{missing}");
    let circle = problem_of(&Memory::new(&[
        ("deck.bdf", "GRID,1,,0.,0.,0.\n\nINCLUDE 'sub/a.bdf'\n"),
        ("sub/a.bdf", "INCLUDE '../b.bdf'\n"),
        ("b.bdf", "$ back\nINCLUDE './sub/../deck.bdf'\n"),
    ]));
    assert_eq!(
        (circle.file.as_str(), circle.place.clone()),
        ("b.bdf", Place::Line(2))
    );
    assert!(
        circle
            .problem
            .contains("deck.bdf → sub/a.bdf → b.bdf → deck.bdf"),
        "{circle}"
    );
    let open = problem("GRID,1,,0.,0.,0.\nINCLUDE 'never\nclosed\n");
    assert_eq!(open.place, Place::Line(2));
    assert!(open.problem.contains("closing quote"), "{open}");
    let none = read_bulk(&Memory::default(), "deck.bdf").expect_err("no file");
    assert!(
        none.to_string().contains("deck.bdf: can't be opened"),
        "{none}"
    );
}

#[test]
fn packed_files_are_unpacked() {
    use std::io::Write;
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(b"GRID,7,,1.,2.,3.\n").expect("packed");
    let bytes = packer.finish().expect("packed");
    let mut files = Memory::new(&[("deck.bdf", "INCLUDE 'grids.bdf.gz'\n")]);
    files.0.insert("grids.bdf.gz".into(), bytes.clone());
    let mesh = read_bulk(&files, "deck.bdf").expect("a mesh");
    assert_eq!(position(&mesh, 7), [1.0, 2.0, 3.0]);
    // cut in the middle
    files
        .0
        .insert("grids.bdf.gz".into(), bytes[..bytes.len() - 9].to_vec());
    let cut = problem_of(&files);
    assert_eq!(cut.file, "grids.bdf.gz");
    assert!(cut.problem.contains("reading stopped here"), "{cut}");
}

#[test]
fn numbers_and_fields_that_are_wrong() {
    for (card, message) in [
        ("GRID,9,,1. 5,0.,0.", "field X1 is \"1. 5\", not a number"),
        (
            "GRID,9,,1.E999,0.,0.",
            "field X1 is \"1.E999\", not a number",
        ),
        ("GRID,9,,nan,0.,0.", "field X1 is \"NAN\", not a number"),
        (
            "GRID,-9,,0.,0.,0.",
            "field ID is \"-9\", not a positive integer",
        ),
        ("GRID,9.,,0.,0.,0.", "field ID is \"9.\""),
        ("GRID,,,0.,0.,0.", "field ID is blank"),
        (
            "GRID,9,,0.,0.,0.,,17",
            "field PS is \"17\", not freedoms 1 to 6",
        ),
        (
            "CTETRA,9,1,1,2,3,4,5,6,ABC",
            "its continuation \"ABC\" is missing",
        ),
        ("CTETRA,9,1,1,2,3", "the card ends before its field G4"),
        ("CTETRA,9,1,1,2,,3", "field G3 is blank"),
        ("CTETRA,9,1,1,2,3,4,5,6,,8", "\"8\" is one field too many"),
        (
            "CORD2R,9,,0.,0.,0.,0.,0.,1.",
            "the card ends before its field C1",
        ),
        ("GRID,9,,0.,0.,0.,-1", "the grid point belongs to a fluid"),
    ] {
        let found = problem(&format!("{CORNERS}{card}\n"));
        assert_eq!(found.place, Place::Line(7), "{found}");
        assert!(found.problem.contains(message), "{found}");
        assert!(!found.advice.is_empty());
    }
}

#[test]
fn cards_that_are_not_read_are_counted() {
    let mesh = mesh(&format!(
        "{CORNERS}FORCE,1,1,,1.,0.,0.,1.
CBEND,5,5,1,2
FORCE,1,2,,1.,0.,0.,1.
PLOTEL,1,1,2
MYCARD,1
PARAM,POST,-1
PLOAD4,1,1,1.
"
    ));
    assert_eq!(
        unread(&mesh),
        [
            ("CBEND", 1, Carries::Structure),
            ("FORCE", 2, Carries::Nothing),
            ("MYCARD", 1, Carries::Unknown),
            ("PARAM", 1, Carries::Nothing),
            ("PLOAD4", 1, Carries::Nothing),
            ("PLOTEL", 1, Carries::Nothing),
        ]
    );
    let force = mesh.unread.iter().find(|unread| unread.name == "FORCE");
    assert_eq!(
        force.map(|unread| unread.first.clone()),
        Some(("deck.bdf".to_string(), 7))
    );
}

/// A line with a blank first field continued no equation, and its first term was a card that stopped the reduction.
#[test]
fn equations_go_on_in_lines_with_a_blank_first_field() {
    let mesh = mesh(&format!(
        "{CORNERS}DEQATN       100OBJ(X1,X2,X3,X4,X5) = RSS(X1+0.000, X2+0.103, X3+0.312,
        X4+0.565, X5+0.910)
DEQATN  101     F(A,B)=MAX(A,B,1.,2.,3.,4.,5.,6.,7.,8.,9.)
        +A
FORCE,1,1,,1.,0.,0.,1.
"
    ));
    assert_eq!(
        unread(&mesh),
        [
            ("DEQATN", 2, Carries::Nothing),
            ("FORCE", 1, Carries::Nothing)
        ]
    );
}

/// The example of the Quick Reference Guide, and the same in columns.
#[test]
fn cards_repeat_the_one_before() {
    let free = mesh(&format!(
        "{CORNERS}GRID,101,,1.0,10.5,,,3456\n=,*(1),=,*(0.2),==$\n=(3)\nSPC1,7,12 3,1\n"
    ));
    assert_eq!(position(&free, 101), [1.0, 10.5, 0.0]);
    for (k, x) in (102..=105).zip([1.2, 1.4, 1.6, 1.8]) {
        let [found, y, z] = position(&free, k);
        assert!((found - x).abs() < 1e-12, "{k}: {found}");
        assert_eq!([y, z], [10.5, 0.0]);
    }
    // freedoms of PS, repeated; freedoms with blanks between them
    assert!(free.supports.iter().any(|s| s.components == 0b11_1100));
    assert!(free.supports.iter().any(|s| s.components == 0b00_0111));
    let columns = mesh(&format!(
        "{CORNERS}GRID    101             1.0     10.5\n=       *(1)    =       *(0.2)  ==\n=3\n"
    ));
    for k in 101..=105 {
        assert_eq!(position(&columns, k), position(&free, k));
    }
}

/// Where all that a continuation could hold may be left out, a call without one is read as Nastran reads it.
#[test]
fn calls_of_nothing_are_read() {
    let deck = |call: &str| {
        format!(
            "{CORNERS}MAT1    7       2.1+11          .3      7850.                           {call}\nPBAR,3,7,1.-4,1.-8,1.-8,2.-8\nCBAR,5,3,1,2,0.,0.,1.\n"
        )
    };
    let (plain, calling) = (mesh(&deck("")), mesh(&deck("+M1")));
    assert_eq!(plain.materials, calling.materials);
    // limits of stress are all that could follow
    assert!(calling.doubts.is_empty());
    let told = mesh(&format!(
        "{CORNERS}CONM2,9,1,,2.,,,,,+C9\nGRID,9,,1.,1.,1.\n"
    ));
    assert_eq!(told.point_masses[0].matrix[0][0], 2.0);
    assert!(
        told.doubts[0].contains("\"+C9\" is missing"),
        "{:?}",
        told.doubts
    );
}
