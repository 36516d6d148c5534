//! Eng's grammar turns a text into a syntax tree.
//!
//! The crate handles texts, places and messages. It looks up no names, contains no units and reads no files.

#![forbid(unsafe_code)]
#![deny(clippy::disallowed_methods)]
// no input may end the library in a panic
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable,
    clippy::todo
)]

pub mod ast;
pub mod codes;
mod diagnostic;
mod span;

mod build;
mod format;
mod grammar;
mod message;
mod nearest;
mod parse;
mod strings;
mod tokens;
mod words;

pub use codes::{CODES, Code};
pub use diagnostic::{Diagnostic, Diagnostics, Fix, Label, Severity};
pub use format::{FormatError, format};
pub use message::{MessagePart, parse_message};
pub use nearest::{LONGEST_COMPARED, nearest};
pub use parse::{UnitWords, parse, parse_expression, parse_placeholder, parse_with_units};
pub use span::{Source, SourceId, SourceMap, Span};
pub use words::WORDS;

/// Parts for the tests in `tests/` alone. No other crate may use them.
#[doc(hidden)]
pub mod internals {
    pub use crate::build::diagnose::ITEM_WORDS;
    pub use crate::build::items::KINDS;
}
