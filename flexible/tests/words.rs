//! Words, numbers and names in the files of meshes.

use eng_flexible::element::ElementKind;
use eng_flexible::internals::read::{
    AbaqusShape, Content, candidates, components, face_shares, first_word, heats_materials,
    include_operand, integer, is_card, is_real, normal, real,
};
use eng_flexible::mesh::Variant;

#[test]
fn only_include_lines_include() {
    assert_eq!(include_operand("include 'a'").as_deref(), Some("'a'"));
    assert_eq!(include_operand("INCLUDE='a b'").as_deref(), Some("'a b'"));
    assert_eq!(include_operand("INCLUDED 1"), None);
    assert_eq!(include_operand("INC"), None);
}

#[test]
fn cards_and_control_lines_are_distinguished() {
    assert!(is_card("GRID", "GRID*   1"));
    assert!(is_card("GRID", "grid,1,,0.,0.,0."));
    assert!(!is_card("SPC", "SPC = 3"));
    assert!(!is_card("PARAM", "PARAM,POST,-1"));
    assert_eq!(first_word("spc(2)=3"), "SPC");
    for used in [
        "TEMP = 3",
        "temperature(mate)=4",
        "TEMP(INIT) = 1",
        "TEMPERATURE(BOTH)=2",
    ] {
        assert!(heats_materials(used), "{used}");
    }
    for unused in [
        "TEMP(LOAD) = 3",
        "TITLE = TEMP = 3",
        "TEMPERATURE(LOAD,HTIME=1.)=2",
    ] {
        assert!(!heats_materials(unused), "{unused}");
    }
    assert_eq!(first_word("  disp(plot) = all"), "DISP");
}

#[test]
fn reals_in_all_their_forms() {
    for (text, value) in [
        ("1.5E+3", 1500.0),
        ("1.5D+3", 1500.0),
        ("1.5d3", 1500.0),
        ("1.5+3", 1500.0),
        ("1.5-3", 0.0015),
        ("-1.-3", -0.001),
        (".5", 0.5),
        ("+7.", 7.0),
        ("7", 7.0),
        ("7+2", 700.0),
        ("-.25E1", -2.5),
    ] {
        assert_eq!(real(text), Some(value), "{text}");
    }
    for text in [
        "", ".", "-", "1. 5", "1.5E", "1.5+", "1..5", "nan", "inf", "1.E999", "0x1", "1.5F3", "E5",
    ] {
        assert_eq!(real(text), None, "{text}");
    }
}

#[test]
fn integers_and_components() {
    assert_eq!(integer("-1"), Some(-1));
    assert_eq!(integer("12."), None);
    assert_eq!(integer("99999999999999999999"), None);
    assert_eq!(components("135"), Some(0b01_0101));
    assert_eq!(components("0"), Some(0));
    assert_eq!(components("12 6"), Some(0b10_0011));
    assert_eq!(components("127"), None);
    assert!(is_real("1.") && !is_real("1") && !is_real("A."));
}

#[test]
fn contents_by_their_beginning() {
    for (text, content) in [
        ("$MeshFormat\n4.1 0 8\n", Content::GmshMesh),
        ("!! by HyperMesh\n/PREP7\n", Content::AnsysArchive),
        ("NBLOCK,6,SOLID\n(3i9,6e21.13e3)\n", Content::AnsysArchive),
        ("\r\n** a mesh\r\n*Heading\r\n", Content::AbaqusDeck),
        ("$ a deck\nSOL 103\n", Content::NastranCards),
        ("grid,1,,0.,0.,0.\n", Content::NastranCards),
        ("$TITLE   =\n$EIGENVECTOR\n", Content::PunchedShapes),
        ("$TITLE   =\nDMIG    KGG  0\n", Content::NastranCards),
        ("    1C\n    1UDATE\n", Content::Frd),
        ("** k\n7,1, 8,1, -2.5e3\n", Content::MatrixByFreedoms),
        ("1 2 2.5D+03\n", Content::MatrixByRows),
        ("101, 0.5, 2, -1e-3\n", Content::Nodes),
        ("node,x,y,z\n101,0.5,2,-1e-3\n", Content::Nodes),
        ("27.1\n27.2\n", Content::Freedoms),
        (
            "       6      -6       6       2KGG     1P,3E23.16\n",
            Content::Op4,
        ),
    ] {
        assert_eq!(Content::of_text(text), Some(content), "{text}");
    }
    for text in ["", "$ nothing\n", "{\"a\": 1}", "12\n", "Some words, 1.5\n"] {
        assert_eq!(Content::of_text(text), None, "{text}");
    }
    for (bytes, content) in [
        ([4, 0, 0, 0], Content::Op2),
        ([0, 0, 0, 8], Content::Op2),
        ([24, 0, 0, 0], Content::Op4),
        ([0, 0, 0, 48], Content::Op4),
    ] {
        assert_eq!(Content::of_binary(&bytes), Some(content));
    }
    assert_eq!(
        Content::of_binary(b"\x89HDF\r\n\x1a\n"),
        Some(Content::Hdf5)
    );
    assert_eq!(Content::of_binary(b"$Mesh"), None);
    assert_eq!(Content::of_binary(b"$"), None);
}

#[test]
fn names_of_included_files() {
    assert_eq!(normal("./a/../b//c.bdf"), "b/c.bdf");
    assert_eq!(normal("../a"), "../a");
    assert_eq!(
        candidates(&["sub/main.bdf", "m"], "x.bdf"),
        ["sub/x.bdf", "x.bdf"]
    );
    assert_eq!(candidates(&["main.bdf"], "..\\x.bdf"), ["../x.bdf"]);
    assert_eq!(candidates(&["m"], "DIR:x.bdf"), ["DIR:x.bdf", "x.bdf"]);
    assert_eq!(candidates(&["a/m", "b/c/m"], "/x/./y"), ["/x/y"]);
}

#[test]
fn types_and_their_variants() {
    for (name, count) in [
        ("C3D4", 4),
        ("C3D10M", 10),
        ("C3D10MH", 10),
        ("C3D20RI", 20),
        ("C3D8IT", 8),
        ("C3D15", 15),
        ("C3D5", 5),
        ("S4R", 4),
        ("B32", 3),
        ("SPRINGA", 2),
        ("CPS6", 6),
    ] {
        assert_eq!(
            AbaqusShape::of(name).map(AbaqusShape::node_count),
            Some(count),
            "{name}"
        );
    }
    let variant = |name| match AbaqusShape::of(name) {
        Some(AbaqusShape::Solid(_, variant)) => Some(variant),
        _ => None,
    };
    assert_eq!(variant("C3D8T"), Some(Variant::Plain));
    assert_eq!(variant("C3D8RT"), variant("C3D20R"));
    assert_ne!(variant("C3D8I"), variant("C3D8R"));
    assert!(matches!(
        AbaqusShape::of("M3D4R"),
        Some(AbaqusShape::Membrane(_))
    ));
    assert!(matches!(
        AbaqusShape::of("SFM3D4R"),
        Some(AbaqusShape::Facet(_))
    ));
    for name in [
        "C3D27", "C3D15V", "C3D", "U1", "CONN3D2", "T3D3", "C3Dé", "", "DS",
    ] {
        assert_eq!(AbaqusShape::of(name), None, "{name}");
    }
}

#[test]
fn shares_of_a_square_of_eight_nodes() {
    let places = [
        [0.0, 0.0, 1.0],
        [2.0, 0.0, 1.0],
        [2.0, 2.0, 1.0],
        [0.0, 2.0, 1.0],
        [1.0, 0.0, 1.0],
        [2.0, 1.0, 1.0],
        [1.0, 2.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    let nodes = [0, 1, 2, 3, 4, 5, 6, 7];
    let mut sums = [0.0; 8];
    let place = |node: u32| places[node as usize];
    let found = face_shares(ElementKind::Quadrilateral8, &nodes, &[0, 1, 2, 3], place);
    for (node, share) in found {
        sums[node as usize] += share;
    }
    // corner triangles have the area 1/2, the inner square 2
    for (node, sum) in sums.iter().enumerate() {
        let expected: f64 = if node < 4 { 1.0 / 6.0 } else { 0.5 + 2.0 / 6.0 };
        assert!((sum - expected).abs() < 1e-15, "{node}: {sum}");
    }
}
