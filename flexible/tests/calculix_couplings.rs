//! Couplings, rigid bodies and mean rotations of CalculiX against the frequencies that it prints, and the mistakes in them.

use eng_flexible::mesh::{Carries, Code, Mesh, SCALAR, Tie};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::reduce::{Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::{Files, FlexibleError, fe::Rules};
use serde_json::Value;
use std::io::Read;
use std::path::Path;

use crate::nastran_deck::unread;

/// The decks of the folder, and one of these lines after its bar.
struct Decks(String);

impl Files for Decks {
    fn open(&self, name: &str) -> std::io::Result<Box<dyn Read>> {
        if name == "own.inp" {
            let text = format!("*INCLUDE, INPUT=bar.inc\n{}", self.0);
            return Ok(Box::new(std::io::Cursor::new(text.into_bytes())));
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/couplings");
        Ok(Box::new(std::fs::File::open(folder.join(name))?))
    }
}

fn of(lines: &str, code: Code) -> Result<Mesh, FlexibleError> {
    read_inp(&Decks(lines.to_string()), "own.inp", code)
}

fn reduced(mesh: Mesh, modes: usize) -> Result<Reduced, FlexibleError> {
    let request = Request {
        rules: Rules::calculix(),
        support_of_deck: true,
        terms: vec![Term::Normal {
            modes: Modes::Count(modes),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    reduce(mesh, &request)
}

/// Six frequencies of each deck, of which CalculiX prints seven digits.
#[test]
fn frequencies_are_those_of_calculix() {
    let mut text = String::new();
    let mut file = Decks(String::new()).open("reference.json").unwrap();
    file.read_to_string(&mut text).unwrap();
    let reference: Value = serde_json::from_str(&text).unwrap();
    let decks = reference.as_object().unwrap();
    assert_eq!(decks.len(), 9);
    for (name, printed) in decks {
        let file = format!("{name}.inp");
        let mesh = read_inp(&Decks(String::new()), &file, Code::CalculiX).unwrap();
        let structure = |card: &&(&str, u64, Carries)| card.2 != Carries::Nothing;
        assert_eq!(unread(&mesh).iter().find(structure), None, "{name}");
        let found = reduced(mesh, 6).unwrap().body.frequencies;
        let printed: Vec<f64> = printed
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect();
        assert_eq!((found.len(), printed.len()), (6, 6), "{name}");
        for (own, other) in found.iter().zip(&printed) {
            assert!((own / other - 1.0).abs() < 1e-6, "{name}: {own} {other}");
        }
    }
}

const ROUND: &str = "*ORIENTATION, NAME=ROUND, SYSTEM=CYLINDRICAL\n10., 10., 0., 10., 10., 1.\n";
const TWIST: &str =
    "*COUPLING, REF NODE=901, SURFACE=TOP, CONSTRAINT NAME=C, ORIENTATION=ROUND\n*KINEMATIC\n2\n";

/// A node on the axis has no radial direction. CalculiX chooses one, and Eng says so; Abaqus states none.
#[test]
fn directions_on_an_axis_are_told() {
    let lines = format!("{ROUND}{TWIST}");
    let mesh = of(&lines, Code::CalculiX).unwrap();
    let told = mesh.doubts.join("\n");
    assert!(
        told.contains("*COUPLING: nodes on the axis of ROUND have no radial direction"),
        "{told}"
    );
    // the middle of the top, where the four elements meet
    let middle = mesh
        .nodes
        .iter()
        .find(|node| node.position == [10.0, 10.0, 80.0]);
    let id = middle.unwrap().id;
    assert!(told.ends_with(&format!(": {id}")), "{told}");
    let error = of(&lines, Code::Abaqus).unwrap_err().to_string();
    let expected = format!("the points of the orientation ROUND give no axes at node {id}");
    assert!(error.contains(&expected), "{error}");
}

/// The reference of a partial coupling has freedoms that nothing uses. With the supports of the deck they don't
/// exist, as in CalculiX, and a warning names them; a solid's loose freedoms are no such ones.
#[test]
fn freedoms_of_references_alone_are_left_out() {
    let lines = "*COUPLING, REF NODE=901, SURFACE=TOP, CONSTRAINT NAME=C\n*KINEMATIC\n3\n";
    let found = reduced(of(lines, Code::CalculiX).unwrap(), 2).unwrap();
    let told = found.report.warnings.join("\n");
    let expected = "3 freedoms have no stiffness and belong to nodes of ties alone, so they don't exist in CalculiX and are held: \
                    component 1 of node 901, component 2 of node 901, component 6 of node 901";
    assert!(told.contains(expected), "{told}");
    let refused = |lines: &str, code| match of(lines, code).and_then(|mesh| reduced(mesh, 2)) {
        Err(error) => error.to_string(),
        Ok(_) => String::new(),
    };
    assert!(refused(lines, Code::Abaqus).contains("3 freedoms have no stiffness"));
    let mass = "*ELEMENT, TYPE=MASS, ELSET=M\n901, 901\n*MASS, ELSET=M\n1e-3\n";
    let loose = refused(&format!("{lines}{mass}"), Code::CalculiX);
    assert!(loose.contains("3 freedoms have no stiffness: "), "{loose}");
}

/// The supports of a body whose every freedom is held.
#[test]
fn a_body_that_is_held_throughout_is_refused() {
    let mesh = of("*BOUNDARY\nALL, 1, 3\n", Code::CalculiX).unwrap();
    let error = reduced(mesh, 2).map(|_| ()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("the supports hold all freedoms of the body"),
        "{error}"
    );
}

const RIGID: &str = "*RIGID BODY, NSET=TIP, REF NODE=901, ROT NODE=902\n";

/// Supports and equations of a ROT NODE are those of the rotations of its reference node.
#[test]
fn a_rotation_node_stands_for_rotations() {
    let lines =
        format!("{RIGID}*BOUNDARY\n902, 2, 3\n901, 5\n*EQUATION\n2\n902, 1, 2., 901, 3, 3.\n");
    let mesh = of(&lines, Code::CalculiX).unwrap();
    let index = |id| mesh.nodes.iter().position(|node| node.id == id).unwrap() as u32;
    let reference = index(901);
    let held = mesh.supports.iter().find(|held| held.node == reference);
    assert_eq!(held.unwrap().components, 0b11_0000);
    assert!(mesh.supports.iter().all(|held| held.node != index(902)));
    let terms = mesh.ties.iter().find_map(|tie| match tie {
        Tie::Equation { terms, .. } => Some(terms.clone()),
        _ => None,
    });
    assert_eq!(terms.unwrap(), [(reference, 3, 2.0), (reference, 2, 3.0)]);
    // freedom 5 of the reference node itself holds nothing
    assert!(
        mesh.doubts
            .iter()
            .any(|told| told.contains("*BOUNDARY holds rotations of node 901"))
    );
}

#[test]
fn mistakes_are_named() {
    let distributing =
        "*ELEMENT, TYPE=DCOUP3D, ELSET=MEAN\n901, 903\n*DISTRIBUTING COUPLING, ELSET=MEAN\n";
    for (lines, expected) in [
        (
            "*RIGID BODY, NSET=TIP, REF NODE=901, ROT NODE=901\n".to_string(),
            "its ROT NODE 901 is also its REF NODE",
        ),
        (
            format!("{RIGID}*RIGID BODY, NSET=END, REF NODE=903, ROT NODE=902\n"),
            "the ROT NODE 902 turns another rigid body, too",
        ),
        (
            format!("{RIGID}*EQUATION\n2\n902, 4, 2., 901, 3, 3.\n"),
            "freedom 4 of a ROT NODE does not exist",
        ),
        (TWIST.to_string(), "the orientation ROUND is missing"),
        (format!("{distributing}TIP, -1.\n"), "the weight is -1"),
        (distributing.to_string(), "it has no nodes"),
        (
            format!("{distributing}TIP, 1.\n*DISTRIBUTING COUPLING, ELSET=MEAN\nTIP, 1.\n"),
            "element 901 has two couplings",
        ),
        (
            "*DISTRIBUTING COUPLING, ELSET=BAR\nTIP, 1.\n".to_string(),
            "its set contains element 1, which is no DCOUP3D",
        ),
    ] {
        let error = of(&lines, Code::CalculiX)
            .map(|_| ())
            .unwrap_err()
            .to_string();
        assert!(error.contains(expected), "{lines}: {error}");
    }
}

/// What Eng can't express is listed as structure, so that a reduction stops.
#[test]
fn contents_that_are_not_read_are_listed() {
    let distributing = "*ELEMENT, TYPE=DCOUP3D, ELSET=MEAN\n901, 903\n*DISTRIBUTING COUPLING, ELSET=MEAN\nTIP, 1.\n";
    for (lines, code, expected) in [
        (RIGID.to_string(), Code::Abaqus, "*RIGID BODY, ROT NODE"),
        (
            format!("{RIGID}*ELEMENT, TYPE=MASS, ELSET=M\n901, 902\n*MASS, ELSET=M\n1.\n"),
            Code::CalculiX,
            "elements at a ROT NODE",
        ),
        (
            format!("{RIGID}*MPC\nPIN, 1, 902\n"),
            Code::CalculiX,
            "ties of a ROT NODE",
        ),
        (
            format!("{RIGID}*NSET, NSET=R\n902\n*TRANSFORM, NSET=R\n1., 1., 0., -1., 1., 0.\n"),
            Code::CalculiX,
            "*TRANSFORM of a ROT NODE",
        ),
        (
            format!("{ROUND}3, 20.\n{TWIST}"),
            Code::CalculiX,
            "*ORIENTATION of more than two points",
        ),
        (
            format!(
                "{ROUND}*COUPLING, REF NODE=901, SURFACE=TOP, CONSTRAINT NAME=C, ORIENTATION=ROUND\n*DISTRIBUTING\n6\n"
            ),
            Code::CalculiX,
            "*DISTRIBUTING of some freedoms in own axes",
        ),
        (
            "*ELEMENT, TYPE=DCOUP3D, ELSET=MEAN\n901, 903\n".to_string(),
            Code::CalculiX,
            "DCOUP3D elements without *DISTRIBUTING COUPLING",
        ),
        (
            format!("{MEAN}*ELEMENT, TYPE=MASS, ELSET=M\n901, 910\n*MASS, ELSET=M\n1.\n"),
            Code::CalculiX,
            "elements at the last node of a MEANROT",
        ),
        (
            format!("{MEAN}*MPC\nPIN, 910, 901\n"),
            Code::CalculiX,
            "ties of the last node of a MEANROT",
        ),
        (MEAN.to_string(), Code::Abaqus, "*MPC MEANROT"),
        (
            "*SURFACE, NAME=A, TYPE=NODE\nTIP\n*TIE, MULTISTAGE, NAME=T\nA, A\n".to_string(),
            Code::CalculiX,
            "*TIE of a sector or a multiplier",
        ),
    ] {
        let mesh = of(&lines, code).unwrap();
        let listed = unread(&mesh);
        let found = listed.iter().find(|card| card.0 == expected);
        assert_eq!(
            found.map(|card| card.2),
            Some(Carries::Structure),
            "{lines}: {listed:?}"
        );
    }
    // in Abaqus the node of the element also turns with the others
    let mesh = of(distributing, Code::Abaqus).unwrap();
    assert!(matches!(
        mesh.ties.as_slice(),
        [Tie::Averaging {
            reference_components: 63,
            ..
        }]
    ));
}

/// Three nodes of the tip, which lie across the axis.
const MEAN: &str =
    "*NODE\n910, 0., 0., 4.\n*MPC\nMEANROT, 112, 112, 112, 124, 124, 124, 138, 138, 138, 910\n";

/// The angle of a rigid rotation is its part along the axis, and a shift has none.
#[test]
fn a_mean_rotation_is_that_of_a_rigid_motion() {
    let mesh = of(MEAN, Code::CalculiX).unwrap();
    let [Tie::Equation { terms, .. }] = &mesh.ties[..] else {
        panic!("{:?}", mesh.ties);
    };
    assert_eq!(terms[0], (SCALAR, 0, -3.0));
    assert_eq!(mesh.scalar_points, [910]);
    let (turn, shift) = ([0.2, -0.7, 0.5], [3.0, 1.0, -2.0]);
    let sum: f64 = terms[1..]
        .iter()
        .map(|(node, freedom, factor)| {
            let x = mesh.nodes[*node as usize].position;
            let moved = [
                shift[0] + turn[1] * x[2] - turn[2] * x[1],
                shift[1] + turn[2] * x[0] - turn[0] * x[2],
                shift[2] + turn[0] * x[1] - turn[1] * x[0],
            ];
            factor * moved[usize::from(*freedom)]
        })
        .sum();
    assert!((sum / 3.0 - turn[2]).abs() < 1e-12, "{sum}");
}

#[test]
fn wrong_mean_rotations_have_messages() {
    for (lines, message) in [
        (
            "*NODE\n910, 0., 0., 1.\n*MPC\nMEANROT, 112, 112, 113, 113, 113, 113, 910\n",
            "MEANROT does not name each node three times",
        ),
        (
            "*NODE\n910, 0., 0., 1.\n*MPC\nMEANROT, 112, 112, 112, 113, 113, 113\n",
            "MEANROT does not name each node three times",
        ),
        (
            "*MPC\nMEANROT, 112, 112, 112, 113, 113, 113, 902\n",
            "the axis of MEANROT has no direction",
        ),
        (
            "*NODE\n910, 0., 0., 1.\n*MPC\nMEANROT, 112, 112, 112, 910\n",
            "all nodes of MEANROT lie on its axis",
        ),
        (
            "*NODE\n910, 0., 0., 1.\n*MPC\nMEANROT, 112, 112, 112, 113, 113, 113, 910\n\
             *MPC\nMEANROT, 124, 124, 124, 125, 125, 125, 910\n",
            "node 910 is the angle of another MEANROT, too",
        ),
        (
            "*NODE\n910, 0., 0., 1.\n*MPC\nMEANROT, 112, 112, 112, 113, 113, 113, 910\n\
             *EQUATION\n2\n910, 2, 1., 901, 1, 1.\n",
            "freedom 2 of the last node of a MEANROT does not exist",
        ),
    ] {
        let error = of(lines, Code::CalculiX).unwrap_err().to_string();
        assert!(error.contains(message), "{lines}: {error}");
    }
}
