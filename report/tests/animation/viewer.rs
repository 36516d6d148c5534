//! Names of the files of a viewer.

use eng_report::internals::file_stem;

#[test]
fn file_names_are_plain() {
    assert_eq!(file_stem("Crank & \"block\""), "crank----block");
    assert_eq!(file_stem("µ"), "animation");
}
