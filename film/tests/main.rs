//! One program for all files of this folder: each further program would link the crate again.
//! `cargo test --test all NAME::` runs the tests of the file NAME.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used)]

mod elastic;
mod memory;
mod other_programs;
mod properties;
mod published;
mod reference_states;
mod ring;
mod states;
mod surfaces;
mod table;
mod tangent;
mod turning;
