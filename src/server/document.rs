//! An open text, and places in it as the protocol states them: lines and UTF-16 units.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// An open text.
pub struct Document {
    /// Its name at the client.
    pub uri: String,
    /// Absent for a text that is no file.
    pub path: Option<PathBuf>,
    /// The client's number of the text.
    pub version: Option<i64>,
    /// The text as it is now.
    pub text: String,
}

impl Document {
    /// A text without a number.
    pub fn new(uri: &str, text: &str) -> Document {
        Document {
            uri: uri.to_owned(),
            path: path(uri),
            version: None,
            text: text.to_owned(),
        }
    }

    /// A file with another text than on disk.
    pub fn of_file(path: &Path, text: String) -> Document {
        Document {
            uri: uri(path),
            path: Some(path.to_owned()),
            version: None,
            text,
        }
    }

    /// Makes a change of the client: of a range, or of the whole text if it states none.
    pub fn change(&mut self, change: &Value) {
        let Some(text) = change["text"].as_str() else {
            return;
        };
        if change["range"].is_object() {
            let start = self.byte(&change["range"]["start"]);
            let end = self.byte(&change["range"]["end"]).max(start);
            self.text.replace_range(start..end, text);
        } else {
            text.clone_into(&mut self.text);
        }
    }

    /// The byte at a position; the end of the line or of the text if the position is after it.
    pub fn byte(&self, position: &Value) -> usize {
        let number = |name: &str| {
            let found = position[name].as_u64().unwrap_or(0);
            usize::try_from(found).unwrap_or(usize::MAX)
        };
        let mut start = 0;
        for _ in 0..number("line") {
            match self.text.get(start..).and_then(|rest| rest.find('\n')) {
                Some(end) => start += end + 1,
                None => return self.text.len(),
            }
        }
        let rest = self.text.get(start..).unwrap_or("");
        let line = rest.split(['\n', '\r']).next().unwrap_or("");
        let mut units = number("character");
        for (at, letter) in line.char_indices() {
            match units.checked_sub(letter.len_utf16()) {
                Some(left) if units > 0 => units = left,
                _ => return start + at,
            }
        }
        start + line.len()
    }
}

/// The position of a byte.
pub fn position(text: &str, byte: usize) -> Value {
    let mut byte = byte.min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    let before = text.get(..byte).unwrap_or("");
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    let units: usize = before[start..].chars().map(char::len_utf16).sum();
    json!({ "line": before.matches('\n').count(), "character": units })
}

pub(super) fn range(text: &str, start: usize, end: usize) -> Value {
    json!({ "start": position(text, start), "end": position(text, end) })
}

/// The path of a `file:` URI, links followed.
pub fn path(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file://")?;
    let rest = rest.strip_prefix("localhost").unwrap_or(rest);
    let mut bytes = Vec::with_capacity(rest.len());
    let mut at = 0;
    while let Some(&byte) = rest.as_bytes().get(at) {
        let hex = rest.get(at + 1..at + 3).filter(|_| byte == b'%');
        match hex.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(decoded) => {
                bytes.push(decoded);
                at += 3;
            }
            None => {
                bytes.push(byte);
                at += 1;
            }
        }
    }
    let decoded = String::from_utf8(bytes).ok()?;
    // `/c:/model.eng` on Windows; elsewhere a folder may have such a name
    let drive = cfg!(windows) && decoded.as_bytes().get(2) == Some(&b':');
    let path = PathBuf::from(match drive {
        true => decoded.get(1..)?,
        false => decoded.as_str(),
    });
    // a file that is not there yet may be in a folder behind a link
    let real = path.canonicalize().or_else(|_| {
        let folder = path.parent().unwrap_or(Path::new("/")).canonicalize()?;
        Ok::<_, std::io::Error>(folder.join(path.file_name().unwrap_or_default()))
    });
    Some(real.unwrap_or(path))
}

/// The `file:` URI of a path.
pub fn uri(path: &Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    let mut uri = String::from("file://");
    if !text.starts_with('/') {
        uri.push('/');
    }
    for byte in text.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' => {
                uri.push(byte as char)
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}
