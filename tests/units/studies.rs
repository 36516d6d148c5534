//! Designs and scripts of studies.

use eng::internals::study::{from_text, named, quoted, whole};

#[test]
fn columns_have_paths_and_units() {
    for (header, path, unit) in [
        ("length [mm]", "length", "mm"),
        ("length[mm]", "length", "mm"),
        ("main[5].clearance [um]", "main[5].clearance", "um"),
        ("main[5]", "main[5]", ""),
        (" ratio [1] ", "ratio", ""),
        ("pull [N*m]", "pull", "N*m"),
    ] {
        assert_eq!(named(header), (path.to_owned(), unit.to_owned()));
    }
}

#[test]
fn texts_of_spreadsheets_are_read() {
    let text = "\u{feff}# made by hand\nlength [mm];load[kg];\n\n1,5;2;\n2,5;1e-3\n";
    let columns = from_text(text).unwrap();
    assert_eq!(columns[0].values, [1.5, 2.5]);
    assert_eq!(columns[1].values, [2.0, 1e-3]);
    for (text, message) in [
        ("", "the file is empty"),
        ("length [mm]\n", "there are no points"),
        ("a,b\n1\n", "line 2 has 1 cell, and"),
        (
            "a,b\n1,2\n1,2 mm\n",
            "line 3: \"2 mm\" in the column b is no number",
        ),
        (",b\n0,2\n", "column 1 has no name"),
        ("a,a [mm]\n0,2\n", "two columns of a"),
        ("a\ninf\n", "a of point 1 is not a finite number"),
    ] {
        let error = from_text(text).and_then(whole).unwrap_err();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn words_of_the_shell_are_quoted() {
    assert_eq!(quoted("a/b-1.eng"), "a/b-1.eng");
    assert_eq!(quoted("speed=5000 rpm"), "'speed=5000 rpm'");
    assert_eq!(quoted("it's"), "'it'\\''s'");
}
