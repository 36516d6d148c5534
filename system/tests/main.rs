//! One program for all files of this folder: each further program would link the crate again.
//! `cargo test --test all NAME::` runs the tests of the file NAME.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used)]

mod corners;
mod curve;
mod delimited;
mod dense;
mod field;
mod grid;
mod numbers;
mod secants;
mod surface;
mod words;
