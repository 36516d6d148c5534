//! Arrays of NumPy (`.npy`, version 1): a head with type, order and shape, then the numbers in little-endian order.
//!
//! Source: NumPy Enhancement Proposal 1, "A simple file format for NumPy arrays".

/// Bytes before the text of the head: magic, version, length of the text.
const BEFORE: usize = 10;
/// The numbers begin at a multiple of this. The format requires it.
const ALIGNED: usize = 64;

/// A file with an array of this shape, whose last index moves fastest.
pub fn array(shape: &[usize], values: &[f64]) -> Vec<u8> {
    let lengths = shape.iter().map(|length| format!("{length}, "));
    let lengths = lengths.collect::<String>();
    // one length needs its comma, and more than one may have it
    let mut head = format!(
        "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}), }}",
        lengths.trim_end()
    );
    let whole = (BEFORE + head.len() + 1).next_multiple_of(ALIGNED);
    head.extend(std::iter::repeat_n(' ', whole - BEFORE - head.len() - 1));
    head.push('\n');
    let mut bytes = Vec::with_capacity(whole + 8 * values.len());
    bytes.extend_from_slice(b"\x93NUMPY\x01\x00");
    // the head of a few lengths is shorter than 65536 bytes
    bytes.extend_from_slice(&(head.len() as u16).to_le_bytes());
    bytes.extend_from_slice(head.as_bytes());
    for value in values {
        bytes.extend_from_slice(&value.to_le_bytes());
    }
    bytes
}
