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
pub fn packed(bytes: &[u8]) -> String {
    let length = bytes.len().div_ceil(4);
    let planes = (0..4).flat_map(|plane| {
        (0..length).map(move |place| bytes.get(4 * place + plane).copied().unwrap_or(0))
    });
    base64(&deflated(&planes.collect::<Vec<u8>>()))
}

/// As a zlib stream.
pub fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    // writing to a Vec cannot fail
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}
