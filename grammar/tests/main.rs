//! One program for all files of this folder: each further program would link the crate again.
//! `cargo test --test all NAME::` runs the tests of the file NAME.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used)]

mod common;
mod format;
mod good_files;
mod mistakes;
mod robustness;
mod trees;
mod words;
