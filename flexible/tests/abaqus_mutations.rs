//! Input files with all kinds of damage: the Abaqus reader may refuse them, with a place, but never
//! panics.

use crate::nastran_deck::{Memory, is_consistent};
use crate::support::{changed, read_or_refused, shuffled};
use eng_flexible::mesh::Code;
use eng_flexible::read::abaqus::read_inp;
use proptest::prelude::*;

/// A file with every keyword that is read.
const DECK: &str = "\
*HEADING
all
*SYSTEM
0.,0.,0.,1.,0.,0.
0.,1.,0.
*PART, NAME=P
*NODE, NSET=N
1,0.,0.,0.
2,1.,0.,0.
3,1.,1.,0.
4,0.,1.,0.
5,0.,0.,1.
6,1.,0.,1.
7,1.,1.,1.
8,0.,1.,1.
*ELEMENT, TYPE=C3D8, ELSET=E
1,1,2,3,4,5,
6,7,8
*ELEMENT, TYPE=C3D4, ELSET=T
2,1,2,3,5
*ELEMENT, TYPE=B32, ELSET=B
3,1,2,3
*ELEMENT, TYPE=S4, ELSET=S
4,1,2,3,4
*NSET, NSET=G, GENERATE
1,8,2
*ELSET, ELSET=ET
E,T
*SURFACE, NAME=F
E,S2
E
*SOLID SECTION, ELSET=ET, MATERIAL=M
*BEAM SECTION, SECTION=BOX, ELSET=B, MATERIAL=M
1.,2.,.1,.2,.1,.2
0.,0.,1.
*SHELL SECTION, ELSET=S, MATERIAL=M
.1
*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=I, PART=P
1.,0.,0.
0.,0.,0.,0.,0.,1.,30.
*END INSTANCE
*INSTANCE, NAME=J, PART=P
*END INSTANCE
*NODE, SYSTEM=C
10,1.,20.,0.
30,2.,20.,0.
31,3.,20.,0.
32,4.,20.,0.
33,5.,20.,0.
*ELEMENT, TYPE=MASS, ELSET=MS
11,10
*MASS, ELSET=MS
1.
*ELEMENT, TYPE=ROTARYI, ELSET=RI
12,10
*ROTARY INERTIA, ELSET=RI
1.,2.,3.
*ELEMENT, TYPE=SPRING2, ELSET=SP
13,I.1,J.2
*SPRING, ELSET=SP
1,2
100.
*NSET, NSET=X, INSTANCE=I
1,N
*NSET, NSET=Y
I.G,J.2
*COUPLING, REF NODE=10, SURFACE=I.F, INFLUENCE RADIUS=9.
*DISTRIBUTING
1,4
*COUPLING, REF NODE=10, SURFACE=J.F
*KINEMATIC
1,3
*ORIENTATION, NAME=O, SYSTEM=CYLINDRICAL
5.,5.,0.,5.,5.,1.
*COUPLING, REF NODE=30, SURFACE=J.F, ORIENTATION=O
*KINEMATIC
1,2
*ELEMENT, TYPE=DCOUP3D, ELSET=DC
14,31
*DISTRIBUTING COUPLING, ELSET=DC
X,1.
*RIGID BODY, REF NODE=10, NSET=Y
*RIGID BODY, REF NODE=32, ROT NODE=33, NSET=Y
*MPC
BEAM,I.1,10
PIN,X,10
*EQUATION
2
I.1,1,1.,J.2,2,-1.
2
33,1,1.,J.2,2,-1.
*TRANSFORM, NSET=Y, TYPE=C
5.,5.,0.,5.,5.,1.
*BOUNDARY
Y,1,3
10,ENCASTRE
33,2
*END ASSEMBLY
*MATERIAL, NAME=M
*ELASTIC
2.1E11,.3
*DENSITY
7850.
*INCLUDE, INPUT=more.inp
*STEP
*STATIC
*END STEP
";

const MORE: &str = "*NODE\n20,0.,0.,0.\n*NSET, NSET=Z\n20\n";

/// Reads a file. A refusal names a file and a line, and the remedy.
fn try_read(deck: &[u8], more: &[u8]) {
    let mut files = Memory::default();
    files.0.insert("deck.inp".into(), deck.to_vec());
    files.0.insert("more.inp".into(), more.to_vec());
    for code in [Code::Abaqus, Code::CalculiX] {
        read_or_refused(
            read_inp(&files, "deck.inp", code),
            ["deck.inp", "more.inp"],
            ["has no node", "too large"],
        );
    }
}

#[test]
fn the_file_itself_is_read() {
    let files = Memory::new(&[("deck.inp", DECK), ("more.inp", MORE)]);
    // CalculiX has an equation for each direction of a distributing coupling, Abaqus one tie
    for (code, distributing) in [(Code::Abaqus, 1), (Code::CalculiX, 3)] {
        let mesh = read_inp(&files, "deck.inp", code).unwrap_or_else(|error| panic!("{error}"));
        is_consistent(&mesh);
        assert_eq!((mesh.nodes.len(), mesh.elements.len()), (22, 10));
        assert_eq!(mesh.point_masses.len(), 2);
        let ties = 3 + 1 + 8 * 3 + 1 + 8 * 2 + distributing + 1 + 1;
        assert_eq!(mesh.ties.len(), ties);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn bytes_changed(changes in prop::collection::vec((0..DECK.len(), any::<u8>()), 1..6)) {
        try_read(&changed(DECK, &changes), MORE.as_bytes());
    }

    #[test]
    fn characters_of_files_put_anywhere(
        changes in prop::collection::vec((0..DECK.len(), prop::sample::select(b"0123456789.+-*,E\"=\t \nIJ".to_vec())), 1..6)
    ) {
        try_read(&changed(DECK, &changes), MORE.as_bytes());
    }

    #[test]
    fn lines_lost_doubled_and_exchanged(
        changes in prop::collection::vec((0..200_usize, 0..200_usize, 0..3_u8), 1..5)
    ) {
        try_read(shuffled(DECK, &changes).as_bytes(), MORE.as_bytes());
    }

    #[test]
    fn cut_anywhere(end in 0..DECK.len(), more in 0..MORE.len()) {
        try_read(&DECK.as_bytes()[..end], &MORE.as_bytes()[..more]);
    }

    #[test]
    fn any_text(text in "[ -~\n\t]{0,400}") {
        try_read(text.as_bytes(), text.as_bytes());
    }
}
