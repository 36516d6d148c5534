//! Units as they are printed, and texts and bytes in markup.

use eng_report::escape::{base64, escaped};
use eng_report::readable_unit;

#[test]
fn signs_of_print() {
    for (written, read) in [
        ("m/s^2", "m/s²"),
        ("kg*m^2", "kg·m²"),
        ("N*m*s/rad", "N·m·s/rad"),
        ("um", "µm"),
        ("degC", "°C"),
        ("deg", "°"),
        ("mm^-1", "mm⁻¹"),
        ("1", "1"),
        ("rpm", "rpm"),
        ("1/min", "1/min"),
        ("", ""),
        ("%", "%"),
        ("m^10*s", "m¹⁰·s"),
    ] {
        assert_eq!(readable_unit(written), read);
    }
}

#[test]
fn text_is_escaped() {
    assert_eq!(escaped("a<b & \"c\"\u{7}"), "a&lt;b &amp; &quot;c&quot; ");
}

#[test]
fn the_vectors_of_the_rfc() {
    for (bytes, text) in [
        ("", ""),
        ("f", "Zg=="),
        ("fo", "Zm8="),
        ("foo", "Zm9v"),
        ("foob", "Zm9vYg=="),
        ("fooba", "Zm9vYmE="),
        ("foobar", "Zm9vYmFy"),
    ] {
        assert_eq!(base64(bytes.as_bytes()), text);
    }
    assert_eq!(base64(&[0xfb, 0xff]), "+/8=");
}
