//! Eng's grammar: from text to syntax tree.
//!
//! This crate knows texts, places and messages. It looks up no name, knows no unit and reads no file.

#![forbid(unsafe_code)]

pub mod ast;
pub mod diagnostic;
pub mod span;

pub use diagnostic::{Diagnostic, Diagnostics, Fix, Label, Severity};
pub use span::{Source, SourceId, SourceMap, Span};
