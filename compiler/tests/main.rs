//! One program for all files of this folder: each further program would link the whole system again.
//! `cargo test --test all NAME::` runs the tests of the file NAME.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used)]

mod backend;
mod check;
mod check_diagnostics;
mod check_support;
mod code_size;
mod derivatives;
mod elaborate;
mod functions;
mod grid_tables;
mod interfaces;
mod journal_laws;
mod library;
mod library_classes;
mod points;
mod random_graphs;
mod shared_code;
mod support;
mod trees;
mod types;
