//! Eng's grammar: from text to syntax tree.
//!
//! This crate knows texts, places and messages. It looks up no name, knows no unit and reads no file.

#![forbid(unsafe_code)]
// tests compare with the standard library's functions
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod ast;
pub mod codes;
pub mod diagnostic;
pub mod span;

mod build;
mod grammar;
mod message;
mod parse;
mod strings;
mod tokens;

pub use codes::{CODES, Code};
pub use diagnostic::{Diagnostic, Diagnostics, Fix, Label, Severity};
pub use message::{MessagePart, parse_message};
pub use parse::{parse, parse_expression, parse_placeholder};
pub use span::{Source, SourceId, SourceMap, Span};
