//! Characters that act on a terminal instead of being shown.

use std::borrow::Cow;
use std::fmt::Write;

/// Whether a terminal would act on a character: control characters (Unicode's class Cc) except line ends and
/// tabs, and characters that change the direction of the text or end a line invisibly.
pub(crate) fn acts(c: char) -> bool {
    match c {
        '\n' | '\t' => false,
        '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => true,
        c => c.is_control(),
    }
}

/// The text for such a character: `\u{1b}`.
pub(crate) fn shown(c: char) -> String {
    c.escape_unicode().to_string()
}

/// A text with all such characters escaped.
pub fn visible(text: &str) -> Cow<'_, str> {
    with(text, shown)
}

/// A name or an argument within a line of a message. Line ends are escaped, too.
pub(crate) fn visible_name(text: &str) -> String {
    visible(text).replace('\n', "\\n").replace('\t', "\\t")
}

/// The text of a JSON document, with JSON escapes for characters that the writer of JSON does not escape.
pub fn visible_json(text: &str) -> Cow<'_, str> {
    with(text, |c| {
        let mut escaped = String::new();
        for unit in c.encode_utf16(&mut [0; 2]) {
            // a text takes all that is written to it
            let _ = write!(escaped, "\\u{unit:04x}");
        }
        escaped
    })
}

fn with(text: &str, escape: impl Fn(char) -> String) -> Cow<'_, str> {
    if !text.contains(acts) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if acts(c) {
            out.push_str(&escape(c));
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}
