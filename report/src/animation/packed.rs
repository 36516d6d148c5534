//! Compresses the bytes of a page's models: the first bytes of all numbers come first, then the second ones,
//! and so on; deflated (RFC 1950), in base64.
//!
//! Neighbouring floats share signs and exponents, so their first bytes are similar. Nothing is rounded.

use crate::escape::base64;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// Packs bytes in the order 0, 4, 8, …, then 1, 5, 9, …; zeros fill shorter planes. The script of the page
/// unpacks them.
pub(super) fn packed(bytes: &[u8]) -> String {
    let length = bytes.len().div_ceil(4);
    let planes = (0..4).flat_map(|plane| {
        (0..length).map(move |place| bytes.get(4 * place + plane).copied().unwrap_or(0))
    });
    base64(&deflated(&planes.collect::<Vec<u8>>()))
}

/// As a zlib stream.
pub(super) fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    // writing to a Vec cannot fail
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
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
}
