//! The text around a place: words, paths, and the call that a place is in.

/// A path of names with indices, such as `main[3].force`.
pub struct Path {
    /// As written, without indices that are no numbers.
    pub written: String,
    /// Its names.
    pub names: Vec<String>,
    /// The first byte of the last name.
    pub start: usize,
    /// The place after its last byte.
    pub end: usize,
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

/// The path whose last name is at a place.
pub fn path_at(text: &str, place: usize) -> Option<Path> {
    let bytes = text.as_bytes();
    let mut start = place.min(bytes.len());
    while start > 0 && is_word(bytes[start - 1]) {
        start -= 1;
    }
    let mut end = place.min(bytes.len());
    while end < bytes.len() && is_word(bytes[end]) {
        end += 1;
    }
    let word = text.get(start..end).filter(|word| !word.is_empty())?;
    if word.starts_with(|first: char| first.is_ascii_digit()) {
        return None;
    }
    let mut names = vec![word.to_owned()];
    let mut begin = start;
    while let Some((name, at)) = name_before(text, begin) {
        names.insert(0, name);
        begin = at;
    }
    Some(Path {
        written: text.get(begin..end)?.to_owned(),
        names,
        start,
        end,
    })
}

/// The names before the dot that ends at a place: `crank`, `pin` for `crank.pin[2].`.
pub fn names_before(text: &str, place: usize) -> Vec<String> {
    let mut names = Vec::new();
    let mut begin = place;
    while let Some((name, at)) = name_before(text, begin) {
        names.insert(0, name);
        begin = at;
    }
    names
}

/// The name before a dot that ends at a place, and its first byte. Indices and arguments are skipped.
fn name_before(text: &str, place: usize) -> Option<(String, usize)> {
    let bytes = text.as_bytes();
    let mut end = place
        .checked_sub(1)
        .filter(|dot| bytes.get(*dot) == Some(&b'.'))?;
    while let Some(&close @ (b']' | b')')) = end.checked_sub(1).and_then(|last| bytes.get(last)) {
        let open = if close == b']' { b'[' } else { b'(' };
        let mut depth = 0usize;
        loop {
            end = end.checked_sub(1)?;
            let byte = bytes[end];
            if byte == close {
                depth += 1;
            } else if byte == open {
                depth -= 1;
            } else if byte == b'\n' {
                return None;
            }
            if depth == 0 {
                break;
            }
        }
    }
    let mut start = end;
    while start > 0 && is_word(bytes[start - 1]) {
        start -= 1;
    }
    let name = text.get(start..end).filter(|name| !name.is_empty())?;
    Some((name.to_owned(), start))
}

/// The name of the call whose arguments a place is in.
pub fn call_around(text: &str, place: usize) -> Option<Path> {
    let bytes = text.as_bytes();
    let mut depth = 0usize;
    let mut at = place.min(bytes.len());
    // an argument list of more than some thousand characters is none
    let least = at.saturating_sub(4000);
    while at > least {
        at -= 1;
        match bytes[at] {
            b')' | b']' => depth += 1,
            b'[' => depth = depth.saturating_sub(1),
            b'(' if depth == 0 => return path_at(text, at),
            b'(' => depth -= 1,
            b'{' | b'}' if depth == 0 => return None,
            _ => {}
        }
    }
    None
}

/// Whether a place is in a comment or in a text in quotes, by the line before it.
pub fn is_quiet(line: &str) -> bool {
    let mut inside = false;
    let bytes = line.as_bytes();
    for (at, byte) in bytes.iter().enumerate() {
        match byte {
            b'"' if at == 0 || bytes[at - 1] != b'\\' => inside = !inside,
            b'/' if !inside && bytes.get(at + 1) == Some(&b'/') => return true,
            _ => {}
        }
    }
    inside
}
