//! Texts of spreadsheets and the units in their heads.

use eng_system::delimited::{Delimited, name_and_unit};

#[test]
fn texts_of_spreadsheets_are_read() {
    let text = "\u{feff}# made by hand\nlength [mm];load [kg];\n\n1,5;\"2\";\n2,5\n";
    let read = Delimited::read(text).unwrap();
    assert_eq!(read.header, ["length [mm]", "load [kg]"]);
    let rows: Vec<(usize, usize)> = read.rows.iter().map(|r| (r.line, r.cells.len())).collect();
    assert_eq!(rows, [(4, 2), (5, 1)]);
    let numbers = read.rows[0].cells.iter().map(|cell| read.number(cell));
    assert_eq!(numbers.collect::<Vec<_>>(), [Some(1.5), Some(2.0)]);
    assert_eq!(read.number("2 mm"), None);
    let english = Delimited::read("a,b\n1,2\n").unwrap();
    assert_eq!((english.header.len(), english.number("1,5")), (2, None));
    assert_eq!(Delimited::read("\n# nothing\n"), None);
}

#[test]
fn a_unit_is_no_index() {
    for (header, due) in [
        ("length [mm]", Some(("length", "mm"))),
        ("length[mm]", Some(("length", "mm"))),
        ("main[5].clearance [um]", Some(("main[5].clearance", "um"))),
        ("ratio [1]", Some(("ratio", "1"))),
        ("main[5]", None),
        ("length", None),
    ] {
        assert_eq!(name_and_unit(header), due);
    }
}
