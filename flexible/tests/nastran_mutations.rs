//! Decks with all kinds of damage: the Nastran reader may refuse them, with a place, but never
//! panics.

use crate::nastran_deck::{Memory, is_consistent};
use crate::support::{changed, read_or_refused, shuffled};
use eng_flexible::read::nastran::read_bulk;
use proptest::prelude::*;

/// A deck with every card that is read.
const DECK: &str = "\
SOL 103
CEND
SPC = 1
BEGIN BULK
PARAM,WTMASS,2.
GRDSET,,,,,,,456
CORD2C,2,,0.,0.,0.,0.,0.,1.,+C2
+C2,1.,0.,0.
CORD2S         3       2      0.      0.      0.      0.      0.      1.
              1.      0.      0.
CORD1R,4,1,2,3
GRID           1              0.      0.      0.       2
GRID*                  2                              1.              0.*
*                     0.
GRID,3,,0.,1.,0.,3
GRID,4,2,1.,45.,1.,4
GRID,5,,1.,1.,1.
GRID,6,,2.,1.,1.
GRID,7,,2.,2.,1.
GRID,8,,1.,2.,3.
SPOINT,100,THRU,110
CTETRA,1,1,1,2,3,4,5,,+T1
CHEXA,2,1,1,2,3,4,5,6\n,7,8,,,1,,2,\n,,,3
CPENTA,3,1,1,2,3,4,5,6,+P1
CPYRAM,4,1,1,2,3,4,5
+T1,6,7,8
+P1,7,8,,1,,2,,3\n,4
CQUAD4,5,2,1,2,3,4,,.1\n,,,.1,.1,.1,.1
CTRIA6,6,2,1,2,3,4,5,6
CBAR,7,3,1,2,0.,1.,0.,GOG\n,45,6,.1,.2,.3
CBEAM,8,4,1,2,5
CROD,9,5,1,2
CONROD,10,1,2,1,.1,.2,,.3
BAROR,,3,,,0.,0.,1.
PSOLID,1,1
PSHELL,2,1,.1,1,,1
PBARL,3,1,,BOX\n,2.,3.,.1,.2,.5
PBEAM,4,1,1.,2.,3.,0.,4.,0.\n,,,,,,,,\n,YES,1.,2.,2.,3.,0.,4.
PROD,5,1,1.,2.
PTUBE,6,1,2.,.1
MAT1,1,2.1+11,,.3,7850.
MAT9,2
CONM2,11,1,2,3.,.1,.2,.3\n,1.,.1,2.,.2,.3,3.
CONM1,12,2,,1.,,1.,,\n,1.,1.,2.,3.
CELAS1,13,6,1,1,2,2
CELAS2,14,100.,3,3
PELAS,6,1000.
CMASS2,15,1.,4,1
RBE2,16,1,123,5,6,7,1.-5
RTRPLT,20,1,2,3,,123456,,12,+\n+,,3
RTRPLT1,21,1,2,3
RROD,22,1,2,1
RSPLINE,23,.2,1,2,123,3,,4,+
+,12,5
RBE3,17,,8,123,1.,123,1,2\n,2.5,12,3,THRU,5,UM,1,123
RBAR,18,1,2,123456
RBE1,19,1,123456\n,UM,8,123
MPC,1,1,1,1.,2,2,-1.,\n,,3,3,2.
MPCADD,2,1
SPC,1,1,123,,2,3
SPC1,1,123,1,THRU,4
SPCADD,3,1
ASET,1,123,2,456
ASET1,123456,5,6
SET1,1,1,THRU,8,EXCEPT,3
SET3,2,PROP,1,2
FORCE,1,1,,1.,0.,0.,1.
INCLUDE 'more.bdf'
ENDDATA
";

const MORE: &str = "GRID,20,,0.,0.,0.\nCTRIA3,20,2,1,2,20\n";

/// Reads a deck. A refusal names a file and a line, and the remedy.
fn try_read(deck: &[u8], more: &[u8]) {
    let mut files = Memory::default();
    files.0.insert("deck.bdf".into(), deck.to_vec());
    files.0.insert("more.bdf".into(), more.to_vec());
    read_or_refused(
        read_bulk(&files, "deck.bdf"),
        ["deck.bdf", "more.bdf"],
        ["no grid point", "no BEGIN BULK"],
    );
}

#[test]
fn the_deck_itself_is_read() {
    let files = Memory::new(&[("deck.bdf", DECK), ("more.bdf", MORE)]);
    let mesh = read_bulk(&files, "deck.bdf").unwrap_or_else(|error| panic!("{error}"));
    is_consistent(&mesh);
    assert_eq!(mesh.elements.len(), 11);
    assert_eq!(
        (mesh.point_masses.len(), mesh.springs.len(), mesh.ties.len()),
        (3, 2, 13)
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn bytes_changed(changes in prop::collection::vec((0..DECK.len(), any::<u8>()), 1..6)) {
        try_read(&changed(DECK, &changes), MORE.as_bytes());
    }

    #[test]
    fn characters_of_decks_put_anywhere(
        changes in prop::collection::vec((0..DECK.len(), prop::sample::select(b"0123456789.+-*,E$'=\t \nTHRU".to_vec())), 1..6)
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
    fn lines_cut_anywhere(line in 0..200_usize, end in 0..80_usize) {
        let mut lines = DECK.lines().collect::<Vec<_>>();
        let line = line % lines.len();
        lines[line] = &lines[line][..end.min(lines[line].len())];
        try_read(lines.join("\n").as_bytes(), MORE.as_bytes());
    }

    #[test]
    fn any_text(text in "[ -~\n\t]{0,400}") {
        try_read(text.as_bytes(), text.as_bytes());
    }
}
