//! Compressed bytes of a page.

use eng_report::escape::base64;
use eng_report::internals::{deflated, packed};
use flate2::read::ZlibDecoder;
use std::io::Read;

#[test]
fn deflated_bytes_come_back() {
    let bytes: Vec<u8> = (0..10_000u32).flat_map(u32::to_le_bytes).collect();
    let small = deflated(&bytes);
    assert!(small.len() < bytes.len() / 2);
    let mut back = Vec::new();
    ZlibDecoder::new(small.as_slice())
        .read_to_end(&mut back)
        .unwrap();
    assert_eq!(back, bytes);
}

#[test]
fn planes_hold_every_fourth_byte() {
    // 0 4 | 1 5 | 2 0 | 3 0
    assert_eq!(
        packed(&[0, 1, 2, 3, 4, 5]),
        base64(&deflated(&[0, 4, 1, 5, 2, 0, 3, 0]))
    );
}
