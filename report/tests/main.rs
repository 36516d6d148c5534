//! One program for all files of this folder: each further program would link the library again.
//! `cargo test --test all NAME::` runs the tests of the file NAME.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used)]

mod animation;
mod any_data;
mod figure;
mod page;
mod report;
mod signal;
mod spectra;
mod words;
