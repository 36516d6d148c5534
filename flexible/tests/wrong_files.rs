//! A wrong file beside each group of contents that the readers know, and the beginning of its message.

use std::io::{self, Cursor, Read};

use eng_flexible::fe::{Rules, assemble};
use eng_flexible::mesh::Carries;
use eng_flexible::{Files, FlexibleError, MeshFormat, read_mesh};

struct Deck(String);

impl Files for Deck {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        match name {
            "deck" => Ok(Box::new(Cursor::new(self.0.clone().into_bytes()))),
            _ => Err(io::ErrorKind::NotFound.into()),
        }
    }
}

/// The message and the advice about a deck: of its reader, of contents that it does not read, or of the assembly.
fn refusal(deck: String, format: MeshFormat) -> String {
    let told = |error: FlexibleError| format!("{error}; {}", error.advice());
    let mesh = match read_mesh(&Deck(deck), "deck", format) {
        Ok(mesh) => mesh,
        Err(error) => return told(error),
    };
    let mut lost = mesh
        .unread
        .iter()
        .filter(|unread| unread.carries != Carries::Nothing);
    if let Some(unread) = lost.next() {
        return format!("unread: {} at line {}", unread.name, unread.first.1);
    }
    match assemble(&mesh, &Rules::default()) {
        Ok(_) => "no error".into(),
        Err(error) => told(error),
    }
}

fn compare(common: &str, cases: &[(&str, &str)], format: MeshFormat) {
    for (lines, expected) in cases {
        let found = refusal(format!("{common}{lines}"), format);
        assert!(found.contains(expected), "{lines}\n{found}");
        // each message has an advice, except the list of unread contents, which gets it from the model's text
        assert!(!found.ends_with("; "), "{lines}\n{found}");
    }
}

const GRIDS: &str = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\nGRID,5,,.5,0.,0.\n\
    GRID,6,,1.,.5,0.\nGRID,7,,.5,1.,0.\nGRID,8,,0.,.5,0.\nMAT1,1,2.1e11,,.3,7800.\n";

#[test]
fn shells_of_nastran() {
    let plate = "PSHELL,1,1,.01,1\n";
    let cases = [
        (
            "CQUADR,1,1,1,2,3,4,,X",
            "deck:11: CQUADR: field ZOFFS is \"X\", not a number",
        ),
        (
            "CQUAD4,1,1,1,2,3",
            "CQUAD4: the card ends before its field G4",
        ),
        (
            "CQUAD8,1,1,1,2,3",
            "CQUAD8: the card ends before its field G4",
        ),
        (
            "CTRIA3,1,1,1,2",
            "CTRIA3: the card ends before its field G3",
        ),
        (
            "CTRIA6,1,1,1,2",
            "CTRIA6: the card ends before its field G3",
        ),
        (
            "CTRIAR,1,9,1,2,3",
            "element 1 uses property 9, which is missing; add a PSHELL card",
        ),
        (
            "CSHEAR,1,7,1,2,3,4",
            "shear panel 1 uses property 7, which is missing; add its PSHEAR card",
        ),
    ];
    compare(&format!("{GRIDS}{plate}"), &cases, MeshFormat::Nastran);
    let cases = [
        (
            "PSHELL,1,1,.01,1,-1.\nCQUAD4,1,1,1,2,3,4",
            "has a bending stiffness of -1 times that of its plate",
        ),
        (
            "PSHELL,1,1,-.01,1\nCQUAD4,1,1,1,2,3,4",
            "has a thickness of -0.01 m; it must be above zero",
        ),
        (
            "PCOMP,1\nCQUAD4,1,1,1,2,3,4",
            "PCOMP: the laminate has no layer",
        ),
        (
            "PCOMP,1,,,,,,,,+\n+,7,.01,0.\nCQUAD4,1,1,1,2,3,4",
            "PCOMP 1 uses material 7, which is missing",
        ),
        (
            "MAT8,2,1e11,-1e10,.3,5e9,,,1600.\nPSHELL,1,2,.01,2\nCQUAD4,1,1,1,2,3,4",
            "MAT8: no elastic sheet has these constants",
        ),
        (
            "MAT2,2,1e11,2e11,,1e11,,4e10,1600.\nPSHELL,1,2,.01,2\nCQUAD4,1,1,1,2,3,4",
            "which is not symmetric and positive definite",
        ),
    ];
    compare(GRIDS, &cases, MeshFormat::Nastran);
}

#[test]
fn solids_beams_and_springs_of_nastran() {
    let cases = [
        (
            "PSOLID,1,1\nCHEXA,1,1,1,2,3,4,5,6",
            "CHEXA: the card ends before its field G7",
        ),
        (
            "PSOLID,1,1\nCPENTA,1,1,1,2,3,5,6,6",
            "1 element is inverted or degenerate",
        ),
        (
            "PBARL,1,1,,OVAL\n,.1,.2\nCBAR,1,1,1,2,0.,0.,1.",
            "element 1 uses PBARL 1, and Eng does not read",
        ),
        (
            "PBARL,1,1,,TUBE\n,.1,.2\nCBAR,1,1,1,2,0.,0.,1.",
            "PBARL: no TUBE has the dimensions [0.1, 0.2]",
        ),
        (
            "PBEAML,1,1,,BAR\n,.1\nCBEAM,1,1,1,2,0.,0.,1.",
            "PBEAML: the card ends before its field DIM2",
        ),
        (
            "PBEAML,1,1,,BAR\n,.1,.2\nCBEAM,1,1,1,2,0.,0.,1.,,+\n+,17,",
            "CBEAM: field PA is \"17\", not freedoms 1 to 6",
        ),
        (
            "PBUSH,1,K,1e6\nCBUSH,1,9,1,2",
            "bushing 1 uses property 9, which is missing; add its PBUSH card",
        ),
        (
            "CELAS1,1,9,1,1,2,1",
            "spring 1 uses property 9, which is missing; add its PELAS card",
        ),
        (
            "CELAS2,1,1e6,1,7,2,1",
            "CELAS2: field C is \"7\", not one freedom 1 to 6",
        ),
        (
            "CONM1,1,1,0,-1.",
            "point mass 1: its mass in freedom 1 is -1 kg",
        ),
        (
            "PBEND,1,1,.1,.1,.1,.1\nCBEND,1,1,1,2,0.,1.,0.,1",
            "unread: CBEND at line 11",
        ),
    ];
    compare(GRIDS, &cases, MeshFormat::Nastran);
}

#[test]
fn ties_supports_and_glue_of_nastran() {
    let cases = [
        (
            "RBAR,1,1,2,123",
            "RBAR: it has 3 independent freedoms instead of six",
        ),
        (
            "RBE1,1,1,123,,,,,,+\n+,UM,2,123456",
            "RBE1: it has 3 independent freedoms instead of six",
        ),
        (
            "RSPLINE,1,.1,1",
            "RSPLINE: no grid point between its ends has dependent freedoms",
        ),
        (
            "MPC,1,1,1,0.",
            "MPC: the first coefficient is zero or missing",
        ),
        (
            "PSHELL,1,1,.01,1\nCQUAD4,1,1,1,2,3,4\nSPC1,2,129,1",
            "SPC1: field C is \"129\", not freedoms 1 to 6",
        ),
        (
            "PSHELL,1,1,.01,1\nCQUAD4,1,1,1,2,3,4\nBGSET,1,5,6,.1",
            "BGSET 1 glues region 5, which is missing",
        ),
        (
            "PSHELL,1,1,.01,1\nCQUAD4,1,1,1,2,3,4\nBCTABLE,1,,,1",
            "unread: contact of bodies without IGLUE (BCTABLE, BCONECT) at line 12",
        ),
    ];
    compare(GRIDS, &cases, MeshFormat::Nastran);
}

const NODES: &str = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n9,.5,0,0\n10,1,.5,0\n\
    *MATERIAL,NAME=M\n*ELASTIC\n2.1e11,.3\n*DENSITY\n7800\n";
const CUBE: &str =
    "*ELEMENT,TYPE=C3D8,ELSET=E\n1,1,2,3,4,5,6,7,8\n*SOLID SECTION,ELSET=E,MATERIAL=M\n";

#[test]
fn elements_of_abaqus() {
    let shell = "*SHELL SECTION,ELSET=E,MATERIAL=M\n0.01\n";
    let solid = "*SOLID SECTION,ELSET=E,MATERIAL=M\n";
    for (element, section, expected) in [
        (
            "S3,ELSET=E\n1,1,2,3",
            "*SHELL SECTION,ELSET=E,MATERIAL=M\n-0.01\n",
            "has a thickness of -0.01 m",
        ),
        (
            "S4R,ELSET=E\n1,1,2,3",
            shell,
            "element 1 has 3 of the 4 nodes of S4R",
        ),
        (
            "S6,ELSET=E\n1,1,2,3,4",
            shell,
            "element 1 has 4 of the 6 nodes of S6",
        ),
        (
            "STRI3,ELSET=E\n1,1,2",
            shell,
            "element 1 has 2 of the 3 nodes of STRI3",
        ),
        (
            "S8R,ELSET=E\n1,1,2,3,4,9,10,11,12",
            shell,
            "element 1 uses node 11, which is missing",
        ),
        (
            "C3D6,ELSET=E\n1,1,2,3,5,6",
            solid,
            "element 1 has 5 of the 6 nodes of C3D6",
        ),
        (
            "C3D8R,ELSET=E\n1,1,2,3,5,6,7",
            solid,
            "element 1 has 6 of the 8 nodes of C3D8R",
        ),
        (
            "C3D10M,ELSET=E\n1,1,2,3,5",
            solid,
            "element 1 has 4 of the 10 nodes of C3D10M",
        ),
        (
            "C3D4,ELSET=E\n1,1,2,3,3",
            solid,
            "1 element is inverted or degenerate",
        ),
        (
            "C3D8I,ELSET=E\n1,1,2,3,4,5,6,7,8",
            "",
            "the mesh has no material",
        ),
    ] {
        let lines = format!("*ELEMENT,TYPE={element}\n{section}");
        compare(NODES, &[(lines.as_str(), expected)], MeshFormat::Abaqus);
    }
}

#[test]
fn joints_and_supports_of_abaqus() {
    let cases = [
        (
            "*TIE,NAME=T\nS1,S2",
            "*TIE: the surface S1 is missing; add its *SURFACE",
        ),
        (
            "*SURFACE,NAME=S\nE,S1\n*COUPLING,REF NODE=77,SURFACE=S,CONSTRAINT NAME=C\n*KINEMATIC\n1,6",
            "node 77 is missing",
        ),
        (
            "*SURFACE,NAME=S\nE,S1\n*COUPLING,REF NODE=9,SURFACE=S,CONSTRAINT NAME=C",
            "*COUPLING: neither *KINEMATIC nor *DISTRIBUTING follows",
        ),
        (
            "*SURFACE INTERACTION,NAME=I\n*SURFACE,NAME=S\nE,S1\n*CONTACT PAIR,INTERACTION=I\nS,S",
            "unread: *CONTACT PAIR at line 23",
        ),
        ("*BOUNDARY\nHUB,1,3", "the node set HUB is missing"),
        (
            "*EQUATION\n2\n1,1,0.,2,1,1.",
            "*EQUATION: its first coefficient is zero",
        ),
        (
            "*MATRIX INPUT,NAME=K,INPUT=none.mtx\n*MATRIX ASSEMBLE,STIFFNESS=K",
            "the file 'none.mtx' can't be opened",
        ),
    ];
    compare(&format!("{NODES}{CUBE}"), &cases, MeshFormat::Abaqus);
    let part = format!(
        "*PART,NAME=P\n{NODES}{CUBE}*END PART\n*ASSEMBLY,NAME=A\n*INSTANCE,NAME=I,PART=Q\n*END INSTANCE\n*END ASSEMBLY\n"
    );
    compare(
        &part,
        &[("", "*INSTANCE I: the part Q is missing; add its *PART")],
        MeshFormat::Abaqus,
    );
}
