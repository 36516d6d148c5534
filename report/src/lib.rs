//! What people see of results: signals, figures, animations, one page.
//!
//! Plain data in, the text or bytes of files out. May contain: arithmetic, drawing, markup. Must not contain: files, models,
//! the language. The same input gives the same bytes on every machine.

#![forbid(unsafe_code)]

pub mod animation;
mod escape;
pub mod figure;
pub mod page;
pub mod signal;
