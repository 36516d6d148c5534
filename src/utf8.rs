//! The text in the bytes of a file, which must be UTF-8.

/// The text of a file.
///
/// # Errors
/// Bytes that are no UTF-8: the encoding, or the place of the first wrong byte, with the fix.
pub fn text(bytes: Vec<u8>) -> Result<String, String> {
    String::from_utf8(bytes).map_err(|error| {
        let bytes = error.as_bytes();
        if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
            return "it is not UTF-8 text, but UTF-16: save it as UTF-8".to_owned();
        }
        let end = error.utf8_error().valid_up_to();
        let before = String::from_utf8_lossy(bytes.get(..end).unwrap_or_default());
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        let byte = bytes.get(end).copied().unwrap_or_default();
        format!(
            "it is not UTF-8 text: the byte 0x{byte:02x} in line {line}, column {column} is no character; texts in Latin-1 have such bytes: save it as UTF-8"
        )
    })
}
