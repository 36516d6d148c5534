//! Numbers as texts.

use eng_system::significant::{fixed, short, significant, without_sign_of_zero};
use eng_system::{Dimension, DisplayUnit};

#[test]
fn zeros_at_the_end_are_left_out() {
    for (value, text) in [
        (0.0, "0"),
        (-0.0, "0"),
        (720.0, "720"),
        (0.0123456789, "0.0123457"),
        (-1234567.8, "-1234568"),
        (1e-7, "1e-7"),
        (-7.85e-9, "-7.85e-9"),
        (f64::NAN, "NaN"),
        (f64::NEG_INFINITY, "-inf"),
    ] {
        assert_eq!(short(value, 6), text);
    }
    for (value, text) in [
        (1000.0, "1000"),
        (99.5, "99.5"),
        (1234.56, "1234.6"),
        (0.012345678, "0.012346"),
        (1.5e9, "1.5e9"),
    ] {
        assert_eq!(short(value, 5), text);
    }
}

#[test]
fn digits_are_counted_and_zeros_kept() {
    for (value, text) in [
        (1.0, "1.0000"),
        (12345.6, "12346"),
        (0.00012345678, "0.00012346"),
        (-3.2e-9, "-3.2000e-9"),
        (4e12, "4.0000e12"),
        (99.999999999, "100.00"),
        (-0.00099999999, "-0.0010000"),
    ] {
        assert_eq!(significant(value, 5), text);
    }
    assert_eq!(significant(7.0, 0), "7");
}

#[test]
fn zeros_have_no_sign() {
    assert_eq!(fixed(-1e-9, 3), "0.000");
    assert_eq!(fixed(-0.0006, 3), "-0.001");
    assert_eq!(without_sign_of_zero("-0".into()), "0");
    assert_eq!(without_sign_of_zero("-0,00".into()), "0,00");
    for kept in ["-", "-.", "–", "-0.1", "-0 N", "-10"] {
        assert_eq!(without_sign_of_zero(kept.into()), kept);
    }
}

#[test]
fn numbers_of_messages_have_four_digits_and_a_unit() {
    let millimetre = DisplayUnit {
        symbol: "mm".into(),
        scale: 1e-3,
        offset: 0.0,
    };
    for (si, text) in [
        (0.0123456, "12.35 mm"),
        (-0.02, "-20 mm"),
        (12.3456789, "12346 mm"),
        (0.0, "0 mm"),
        (1.23456e-9, "1.235e-6 mm"),
        (f64::NAN, "NaN mm"),
    ] {
        assert_eq!(millimetre.text(si), text);
    }
    assert_eq!(DisplayUnit::si(Dimension::ONE).text(0.99912), "0.9991");
}
