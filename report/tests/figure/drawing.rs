//! Places, curves and texts of drawings.

use eng_report::figure::Upright;
use eng_report::internals::{coordinate, page_curve, text_width, upright_point};

#[test]
fn up_is_the_stated_axis() {
    assert_eq!(upright_point(Upright::X, 1.0, 0.0), (0.0, -1.0));
    assert_eq!(upright_point(Upright::X, 0.0, 1.0), (-1.0, 0.0));
    assert_eq!(upright_point(Upright::Y, 1.0, 0.0), (1.0, 0.0));
}

#[test]
fn coordinates_are_short() {
    let cases = [
        (100.0, "100"),
        (0.1 + 0.2, "0.3"),
        (-0.001, "0"),
        (-2.346, "-2.35"),
        (f64::NEG_INFINITY, "-10000000"),
        (f64::NAN, "0"),
    ];
    for (value, text) in cases {
        assert_eq!(coordinate(value), text);
    }
}

#[test]
fn curves_of_a_page_are_steps() {
    let points = [(1.0, 2.0), (1.744, 1.0), (0.004, f64::NAN)];
    let text = page_curve(&points, vec![0.0, 0.5, 719.5]);
    assert!(text.contains(" d=\"m100 200 74-100-174-100\""), "{text}");
    assert!(text.contains(" data-angles=\"0 50 71900\""), "{text}");
}

#[test]
fn widths_add_up() {
    assert_eq!(text_width("", 16.0, false), 0.0);
    assert_eq!(text_width("00", 2048.0, false), 2606.0);
    assert!(text_width("µ", 10.0, true) > text_width("µ", 10.0, false));
}
