//! Numbers and arrays of the writers.

use eng_flexible::internals::write::{array, field, fortran};

#[test]
fn numbers_fit_into_their_fields() {
    assert_eq!(fortran(-12.5, 16, 'E'), "-1.2500000000000000E+01");
    assert_eq!(fortran(0.0, 16, 'E'), "0.0000000000000000E+00");
    assert_eq!(fortran(f64::MAX, 16, 'E'), "1.7976931348623157+308");
    for value in [1.0 / 3.0, -1e5 / 3.0, 2e-7 / 3.0, -1e-11 / 3.0, 1e100 / 3.0] {
        let text = field(value);
        assert!(text.len() <= 16 && text.len() >= 15, "{text}");
        let back: f64 = text.replace('D', "e").parse().expect("a number");
        assert!((back / value - 1.0).abs() < 1e-9, "{text}");
    }
}

#[test]
fn the_head_ends_at_a_multiple_of_64() {
    let bytes = array(&[2, 1], &[1.5, -2.0]);
    assert_eq!(bytes.len() % 64, 16);
    assert!(bytes.starts_with(b"\x93NUMPY\x01\x00\x76\x00{'descr': '<f8', "));
    assert!(bytes.ends_with(&(-2.0f64).to_le_bytes()));
}
